"""Outlines of the finger's faces: joint semi-axes, their uncertainty and consistency, and the CSV reader."""

import math

import numpy as np
import pytest
from benchmarks.truth.fingertips import superellipse

from fingerpad.exceptions import FitError, ImageError
from fingerpad.image import combine_faces, face_from_outline, read_outline
from fingerpad.simulate import outline_points

PALMAR, DISTAL, RADIAL_ULNAR = 7.9, 13.8, 11.8
ARC = (-0.2, math.pi + 0.2)


def faces(seed, noise_std=0.05, **changes):
    sizes = {
        "palmar": (RADIAL_ULNAR, DISTAL),
        "distal": (RADIAL_ULNAR, PALMAR),
        "radial": (PALMAR, DISTAL),
    } | changes
    return {
        face: outline_points(*size, arc=ARC, centre=(k, -2), noise_std=noise_std, seed=10 * seed + k)
        for k, (face, size) in enumerate(sizes.items())
    }


def semi_axes_of(outlines, relative_scale_std=0.0):
    return combine_faces([face_from_outline(*one, relative_scale_std) for one in outlines.items()])


@pytest.mark.parametrize("side", ["radial", "ulnar"])
def test_two_faces_suffice(side):
    given = faces(1)
    found = semi_axes_of({"palmar": given["palmar"], side: given["radial"]})
    assert (found.palmar, found.distal, found.radial_ulnar) == pytest.approx((7.9, 13.8, 11.8), abs=0.15)
    assert found.degrees_of_freedom == 1


def clicked(exponents, seed, count=60, noise_mm=0.07):
    """Return points clicked along a drawn tip, in any order of the arc, and its true semi-axes."""
    rng = np.random.default_rng([seed, 31])
    across, along = rng.uniform(8, 12), rng.uniform(10, 15)
    tip = superellipse(exponents, across, along)
    lengths = np.append(0, np.cumsum(np.linalg.norm(np.diff(tip, axis=0), axis=1)))
    at = np.linspace(0, lengths[-1], count)
    points = np.stack([np.interp(at, lengths, tip[:, k]) for k in (0, 1)], axis=-1)
    return points[:: rng.choice([-1, 1])] + rng.normal(0, noise_mm, points.shape), np.array([across, along])


@pytest.mark.parametrize("exponents", [(2, 2), (1.7, 1.7), (2.5, 2.5), (1.8, 2.2), (1.6, 1.6)])
def test_no_outline_is_wrong_without_a_flag(exponents):
    for seed in range(2):
        points, truth = clicked(exponents, seed)
        seen = face_from_outline("palmar", points)
        off = np.abs(seen.semi_axes - truth) / np.sqrt(np.diagonal(seen.covariance))
        assert (off < 2).all() or seen.flags
        assert (off < 3).all()
        assert (np.sqrt(np.diagonal(seen.covariance)) < 0.25 * truth).all()


def test_the_order_of_points_does_not_matter():
    points, _ = clicked((1.7, 1.7), 9)
    mixed = face_from_outline("palmar", np.random.default_rng(1).permutation(points))
    np.testing.assert_allclose(mixed.semi_axes, face_from_outline("palmar", points).semi_axes, rtol=1e-6)


def test_few_points_do_not_tell_the_shape():
    points, _ = clicked((1.7, 1.7), 3, count=12)
    seen = face_from_outline("palmar", points)
    assert "few_points" in seen.flags
    assert (np.sqrt(np.diagonal(seen.covariance)) > 0.08 * seen.semi_axes).all()


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ((), "no face"),
        (("palmar",), "palmar semi-axis"),
        (("distal",), "distal semi-axis"),
        (("radial",), "radial_ulnar semi-axis"),
    ],
)
def test_unseen_axis(given, words):
    outlines = faces(0)
    with pytest.raises(FitError, match=words):
        semi_axes_of({face: outlines[face] for face in given})


def test_an_outline_without_a_residual_is_refused():
    angles = np.array([0.1, 1.0, 2.0, 3.0])
    four = np.stack([RADIAL_ULNAR * np.cos(angles), PALMAR * np.sin(angles)], axis=-1)
    with pytest.raises(FitError, match="distal face: four points leave no residual"):
        semi_axes_of(faces(0) | {"distal": four})
    five = np.append(four, [[0, 1.01 * PALMAR]], axis=0)
    assert np.isfinite(semi_axes_of(faces(0) | {"distal": five}).covariance).all()


@pytest.mark.parametrize("bad", [-0.1, math.nan, math.inf])
def test_invalid_scale_std(bad):
    with pytest.raises(FitError, match="relative_scale_std"):
        semi_axes_of(faces(0), relative_scale_std=bad)


def test_outlines_in_other_units_and_with_decimal_commas(tmp_path):
    path = tmp_path / "palmar.csv"
    path.write_text("X [µm];Y [µm]\n1500,5;-2000\n3000;4000\n", encoding="cp1252")
    np.testing.assert_allclose(read_outline(path), [[1.5005, -2], [3, 4]])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "holds no data"),
        ("x,y\n1,2\n", "no column x_mm or y_mm; found x, y"),
        ("x_mm,y_mm\n1,2\n3,four\n", "line 3, column 'y_mm': 'four' is not a finite number"),
    ],
)
def test_invalid_tables(tmp_path, text, words):
    path = tmp_path / "palmar.csv"
    path.write_text(text)
    with pytest.raises(ImageError, match=words) as caught:
        read_outline(path)
    assert str(path) in str(caught.value)


@pytest.mark.parametrize("count", [8, 80])
def test_an_unknown_face_is_refused(count):
    angles = np.linspace(0, math.pi, count)
    points = np.stack([11.8 * np.cos(angles), 13.8 * np.sin(angles)], axis=-1)
    with pytest.raises(FitError, match="face must be one of palmar, .* found 'dorsal'"):
        face_from_outline("dorsal", points)
