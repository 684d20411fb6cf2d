"""The renderers of known truth: what they promise can be seen in their pixels, and what they refuse."""

import math

import cv2
import numpy as np
import pytest

from fingerpad.exceptions import GeometryError, ImageError
from fingerpad.simulate import outline_points, render_coin, render_contact_image, render_finger


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


def test_outline_points_on_arc():
    points = outline_points(3, 2, count=50, arc=(0, math.pi), centre=(10, 20))
    assert (points[:, 1] >= 20 - 1e-9).all()
    # The two foci see every point of an ellipse at one total distance.
    focus = math.sqrt(5)
    total = sum(np.linalg.norm(points - (10 + sign * focus, 20), axis=1) for sign in (-1, 1))
    np.testing.assert_allclose(total, 6)


FACES = ("palmar", "distal", "radial", "ulnar")


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


INVALID = [
    *((render_contact_image, bad) for bad in ({"semi_major": -1}, {"semi_major": 5, "semi_minor": 6})),
    *((render_contact_image, bad) for bad in ({"ppi": 0}, {"ridge_period": math.nan})),
    *((render_finger, {"arc_deg": bad}) for bad in (10, 200)),
    *((render_finger, bad) for bad in ({"semi_axes": (-1.0, 5.0)}, {"mm_per_px": 0.0}, {"departure": 2.0})),
    (render_finger, {"face": "radial", "palmar": "down"}),
    *((render_coin, bad) for bad in ({"radius": 0}, {"radius": math.nan}, {"tilt": 2.0})),
]


@pytest.mark.parametrize(("render", "bad"), INVALID)
def test_what_cannot_be_rendered_is_refused(render, bad):
    with pytest.raises((GeometryError, ImageError), match="must be|positive radius|palmar side is"):
        render(**bad)
