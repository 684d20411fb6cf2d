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


ANGLES = np.array([0.1, 1.0, 2.0, 3.0])
FOUR = np.stack([RADIAL_ULNAR * np.cos(ANGLES), PALMAR * np.sin(ANGLES)], axis=-1)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda seen: semi_axes_of({}), "no face"),
        (lambda seen: semi_axes_of({"palmar": seen["palmar"]}), "palmar semi-axis"),
        (lambda seen: semi_axes_of({"distal": seen["distal"]}), "distal semi-axis"),
        (lambda seen: semi_axes_of({"radial": seen["radial"]}), "radial_ulnar semi-axis"),
        (lambda seen: semi_axes_of(seen | {"distal": FOUR}), "distal face: four points leave no residual"),
        *(
            (lambda seen, bad=bad: semi_axes_of(seen, bad), "relative_scale_std")
            for bad in (-0.1, math.nan, math.inf)
        ),
        (
            lambda seen: face_from_outline("dorsal", FOUR.repeat(2, axis=0)),
            "one of palmar, .* found 'dorsal'",
        ),
        (lambda seen: face_from_outline("dorsal", seen["palmar"]), "one of palmar, .* found 'dorsal'"),
    ],
)
def test_outlines_that_tell_no_semi_axes_are_refused(make, words):
    with pytest.raises(FitError, match=words):
        make(faces(0))


def test_five_points_have_a_residual():
    five = np.append(FOUR, [[0, 1.01 * PALMAR]], axis=0)
    assert np.isfinite(semi_axes_of(faces(0) | {"distal": five}).covariance).all()


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
