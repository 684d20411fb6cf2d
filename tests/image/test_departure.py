"""Outlines that are no ellipses: what is stated of their semi-axes; see benchmarks/finger_shapes.py."""

import math
import zlib

import numpy as np
import pytest
from benchmarks.finger_shapes import SHAPES, SIDES, render, tip_outline

from fingerpad.image import Scale, measure_photograph
from fingerpad.image.photograph._departure import departure_of, is_significant
from fingerpad.image.photograph.outline_fit import fit_outline_ellipse

ACROSS, ALONG = 180.0, 250.0


def arc_of(shape, half_deg, seed=0, noise_px=0.15):
    """Return points, px, of a drawn tip whose normals are within so many degrees of the tip's."""
    tip = tip_outline(shape, ACROSS, ALONG)
    lengths = np.append(0, np.cumsum(np.linalg.norm(np.diff(tip, axis=0), axis=1)))
    at = np.arange(0, lengths[-1], 1.5)
    points = np.stack([np.interp(at, lengths, tip[:, k]) for k in (0, 1)], axis=-1)
    angles = np.degrees(np.arctan2(points[:, 1] / ALONG, points[:, 0] / ACROSS))
    points = points[np.abs(angles - 90) < half_deg]
    return points + np.random.default_rng(seed).normal(0, noise_px, points.shape)


def found(shape, half_deg, seed=0):
    points = arc_of(shape, half_deg, seed)
    lean = (0.0, math.radians(2))
    fit = fit_outline_ellipse(points, lean=lean[0], lean_std=lean[1])
    return fit, departure_of(points, fit.ellipse, lean)


@pytest.mark.parametrize("half_deg", [60, 75, 85])
def test_an_ellipse_is_told_from_other_curves(half_deg):
    fit, departure = found((2.0, 2.0), half_deg)
    assert departure.exponent == pytest.approx(2, abs=4 * departure.exponent_std)
    assert not is_significant(departure.exponent, departure.exponent_std)
    assert np.sqrt(departure.covariance[1, 1]) < 2 * np.sqrt(fit.covariance[3, 3])


@pytest.mark.parametrize("exponent", [1.7, 1.85, 2.2, 2.5])
@pytest.mark.parametrize("half_deg", [75, 85])
def test_the_exponent_of_a_superellipse_is_found_and_its_semi_axes_are_held(exponent, half_deg):
    fit, departure = found((exponent, exponent), half_deg)
    assert departure.exponent == pytest.approx(exponent, abs=0.05)
    assert is_significant(departure.exponent, departure.exponent_std)
    off = np.array([fit.ellipse.semi_x - ACROSS, fit.ellipse.semi_y - ALONG])
    assert (np.abs(off) > 1.96 * np.sqrt(np.diagonal(fit.covariance)[2:4])).any()
    assert (np.abs(off) < 1.96 * np.sqrt(np.diagonal(fit.covariance[2:4, 2:4] + departure.covariance))).all()


def test_a_tip_fuller_on_one_side_needs_two_exponents():
    fit, departure = found((1.8, 2.2), 80)
    assert departure.exponent == pytest.approx(2, abs=0.06)
    off = np.array([fit.ellipse.semi_x - ACROSS, fit.ellipse.semi_y - ALONG])
    assert (np.abs(off) < 1.96 * np.sqrt(np.diagonal(fit.covariance[2:4, 2:4] + departure.covariance))).all()


def test_the_unit_and_the_spacing_of_points_do_not_matter():
    fit, departure = found((1.8, 1.8), 75)
    fewer = departure_of(arc_of((1.8, 1.8), 75)[::2], fit.ellipse, (0.0, math.radians(2)))
    assert fewer.exponent == pytest.approx(departure.exponent, abs=0.02)
    np.testing.assert_allclose(
        np.sqrt(np.diagonal(fewer.covariance)), np.sqrt(np.diagonal(departure.covariance)), rtol=0.3
    )


def test_few_points_tell_nothing():
    assert (
        departure_of(arc_of((1.7, 1.7), 75)[:60], fit_outline_ellipse(arc_of((1.7, 1.7), 75)).ellipse, (0, 1))
        is None
    )


@pytest.mark.parametrize("name", ["slightly pointed", "blunt", "one side fuller"])
def test_photographs_of_fingers_that_are_no_ellipses(name):
    rng = np.random.default_rng([1, zlib.crc32(name.encode())])
    truth = render(rng, SHAPES[name], "palmar")
    seen = measure_photograph(truth.pixels, "palmar", Scale(truth.mm_per_px), palmar=SIDES["palmar"])
    assert ("not_an_ellipse" in seen.flags) == (name != "one side fuller")
    assert (np.abs(seen.semi_axes - truth.semi_axes) < 1.96 * np.sqrt(np.diagonal(seen.covariance))).all()
