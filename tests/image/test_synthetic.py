"""The renderers of known truth: what they promise can be seen in their pixels."""

import math

import cv2
import numpy as np
import pytest

from fingerpad.exceptions import GeometryError, ImageError
from fingerpad.simulate import outline_points, render_contact_image, render_finger


def test_seed_determines_picture():
    first, again, other = (render_contact_image(semi_major=6, semi_minor=5, seed=seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(first.pixels, again.pixels)
    assert (first.pixels != other.pixels).any()


@pytest.mark.parametrize("pattern", ["arch", "loop", "whorl"])
def test_ink_fills_true_ellipse(pattern):
    truth = render_contact_image(
        semi_major=8, semi_minor=6, orientation=0.4, pattern=pattern, noise_std=0, seed=3
    )
    dark = np.argwhere(truth.pixels < 140)[:, ::-1].astype(np.float32)
    hull = cv2.convexHull(dark)
    assert cv2.contourArea(hull) * truth.mm_per_px**2 == pytest.approx(math.pi * 48, rel=0.02)
    assert np.abs(dark.mean(axis=0)[::-1] - truth.centroid).max() < 8


@pytest.mark.parametrize(
    "bad", [{"semi_major": -1}, {"semi_major": 5, "semi_minor": 6}, {"ppi": 0}, {"ridge_period": math.nan}]
)
def test_invalid_contact_images(bad):
    with pytest.raises(GeometryError):
        render_contact_image(**bad)


def test_outline_points_on_arc():
    points = outline_points(3, 2, count=50, arc=(0, math.pi), centre=(10, 20))
    assert (points[:, 1] >= 20 - 1e-9).all()
    # The two foci see every point of an ellipse at one total distance.
    focus = math.sqrt(5)
    total = sum(np.linalg.norm(points - (10 + sign * focus, 20), axis=1) for sign in (-1, 1))
    np.testing.assert_allclose(total, 6)


def test_truth_of_irregular_outline():
    # A blur wider than a ridge leaves the print as even as its outline.
    truth = render_contact_image(
        semi_major=9, semi_minor=7, orientation=0.5, irregularity=0.05, noise_std=0, seed=4, blur=0.25
    )
    plain = render_contact_image(semi_major=9, semi_minor=7, orientation=0.5, noise_std=0, seed=4, blur=0.25)
    shapes = []
    for item in (truth, plain):
        rows, columns = np.nonzero(item.pixels < 190)
        covariance = np.cov(np.stack([rows, columns]))
        small, large = np.sqrt(np.linalg.eigvalsh(covariance)) * item.mm_per_px * 2
        shapes.append((large, small))
        assert math.dist((rows.mean(), columns.mean()), item.centroid) < 3
        angle = 0.5 * math.atan2(2 * covariance[0, 1], covariance[0, 0] - covariance[1, 1])
        assert math.sin(angle - item.orientation) == pytest.approx(0, abs=0.05)
    assert shapes[0][0] / shapes[1][0] == pytest.approx(float(truth.ellipse.semi_major) / 9, rel=0.015)
    assert shapes[0][1] / shapes[1][1] == pytest.approx(float(truth.ellipse.semi_minor) / 7, rel=0.015)
    assert float(plain.ellipse.semi_major) == 9


def test_creases_and_compression():
    plain, creased, packed = (
        render_contact_image(semi_major=6, semi_minor=5, seed=3, noise_std=0, **extra)
        for extra in ({}, {"creases": 3}, {"jpeg_quality": 40})
    )
    assert creased.ridge_area < 0.97 * plain.ridge_area
    assert creased.gross_area == plain.gross_area
    assert (packed.pixels != plain.pixels).any()
    assert packed.pixels.shape == plain.pixels.shape


def test_smudges_keep_truth():
    plain, smudged = (render_contact_image(seed=4, smudges=count, noise_std=0) for count in (0, 4))
    assert smudged.ridge_area == plain.ridge_area
    assert smudged.gross_area == plain.gross_area
    changed = np.abs(smudged.pixels.astype(int) - plain.pixels) > 20
    assert 0.02 < changed.mean() < 0.4
    # Where they smear, black and white become grey.
    assert np.ptp(smudged.pixels[changed]) < np.ptp(plain.pixels[changed])
    rows, columns = np.indices(plain.pixels.shape)
    row, column = plain.centroid
    semi_major, semi_minor = (
        float(axis) / plain.mm_per_px for axis in (plain.ellipse.semi_major, plain.ellipse.semi_minor)
    )
    outside = ((rows - row) / (semi_major + 3)) ** 2 + ((columns - column) / (semi_minor + 3)) ** 2 > 1
    np.testing.assert_array_equal(smudged.pixels[outside], plain.pixels[outside])


FACES = ("palmar", "distal", "radial", "ulnar")


def test_seed_determines_photograph():
    first, again, other = (render_finger(mm_per_px=0.15, seed=seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(first.pixels, again.pixels)
    assert (first.pixels != other.pixels).any()


@pytest.mark.parametrize("face", FACES)
@pytest.mark.parametrize("tip", ["up", "left"])
def test_edge_on_true_arc(face, tip):
    even = {"noise_std": 0, "jpeg_quality": None, "shadow": 0, "texture_mm": 0, "skin": 0}
    turned = {"tip": tip, "tilt_deg": 3, "arc_deg": 120}
    truth = render_finger(face, mm_per_px=0.08, backdrop="black", seed=4, **even, **turned)
    luma = truth.pixels.astype(float).sum(axis=-1)
    points = truth.arc_points(40)
    out = points - truth.centre
    out /= np.linalg.norm(out, axis=1, keepdims=True)
    inside, outside = (points + step * out for step in (-6, 6))
    bright, dark = (luma[tuple(np.rint(place).astype(int).T)] for place in (inside, outside))
    # A fingertip is dimmer at its limb, and still far lighter than the black behind it.
    assert (bright > dark + 60).all()


@pytest.mark.parametrize(
    "changes",
    [{"semi_axes": (-1.0, 5.0)}, {"mm_per_px": 0.0}, {"arc_deg": 10}, {"arc_deg": 200}, {"departure": 2.0}],
)
def test_invalid_fingers(changes):
    with pytest.raises(GeometryError, match="must be"):
        render_finger(**changes)


def test_invalid_directions():
    with pytest.raises(ImageError, match="palmar side is"):
        render_finger("radial", palmar="down")
