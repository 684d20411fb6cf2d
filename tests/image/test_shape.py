"""Outlines that are no ellipses: what is stated of them; see benchmarks/claims/fingertips.py."""

import math
from dataclasses import replace

import numpy as np
import pytest
from benchmarks.truth import fingertips
from benchmarks.truth.fingertips import photograph_outline, superellipse

from fingerpad.exceptions import GeometryError
from fingerpad.image import Scale, measure_photograph
from fingerpad.image.ellipse import PlaneEllipse
from fingerpad.image.photograph.arc import FaceArc, fit_arc_ellipse, outline_points
from fingerpad.image.photograph.calibration import LENGTHS
from fingerpad.image.photograph.result import face_from_arc
from fingerpad.image.photograph.shape import (
    average_over_shapes,
    contradicted,
    is_significant,
    radius_of_outline,
)
from fingerpad.simulate import render_finger

ACROSS, ALONG = 180.0, 250.0
TILT = (0.0, math.radians(2))


def arc_of(shape, half_deg, seed=0, noise_px=0.15):
    """Return points, px, of a drawn tip whose normals are within so many degrees of the tip's."""
    tip = superellipse(shape, ACROSS, ALONG)
    lengths = np.append(0, np.cumsum(np.linalg.norm(np.diff(tip, axis=0), axis=1)))
    at = np.arange(0, lengths[-1], 1.5)
    points = np.stack([np.interp(at, lengths, tip[:, k]) for k in (0, 1)], axis=-1)
    angles = np.degrees(np.arctan2(points[:, 1] / ALONG, points[:, 0] / ACROSS))
    points = points[np.abs(angles - 90) < half_deg]
    return points + np.random.default_rng(seed).normal(0, noise_px, points.shape)


def face_arc(points, face, tilt=TILT):
    """Return all points as the arc of a face; that of a side face is compared without its width."""
    frame, start = (np.eye(2), np.zeros(2)), np.array([0.0, 0.0, ACROSS, ALONG, 0.0])
    return FaceArc(
        face=face, points=outline_points(points), scale=Scale(0.05), frame=frame, tilt=tilt, start=start
    )


def compared(points):
    fit = fit_arc_ellipse(points, TILT)
    return fit, average_over_shapes(face_arc(points, "radial"), fit)


def found(shape, half_deg, seed=0):
    return compared(arc_of(shape, half_deg, seed))


def off_truth(ellipse):
    return np.array([ellipse.semi_x - ACROSS, ellipse.semi_y - ALONG])


@pytest.mark.parametrize("half_deg", [60, 85])
def test_an_ellipse_stays_what_it_is(half_deg):
    fit, average = found((2.0, 2.0), half_deg)
    assert average.exponent == pytest.approx(2, abs=4 * average.exponent_std)
    assert not is_significant(average.exponent, average.exponent_std)
    stds = np.sqrt(np.diagonal(average.covariance))
    # Another curve is not excluded, but all but.
    assert stds[1] < math.hypot(2 * np.sqrt(fit.covariance[3, 3]), 0.0015 * ALONG)
    assert average.ellipse.semi_y == pytest.approx(fit.ellipse.semi_y, abs=stds[1] / 2)


@pytest.mark.parametrize(("exponent", "half_deg"), [(1.7, 75), (1.85, 85), (2.2, 75), (2.5, 85)])
def test_the_semi_axes_of_a_superellipse_are_found(exponent, half_deg):
    fit, average = found((exponent, exponent), half_deg)
    assert average.exponent == pytest.approx(exponent, abs=0.05)
    assert is_significant(average.exponent, average.exponent_std)
    assert (np.abs(off_truth(fit.ellipse)) > 1.96 * np.sqrt(np.diagonal(fit.covariance)[2:4])).any()
    off = off_truth(average.ellipse)
    assert (np.abs(off) < 1.96 * np.sqrt(np.diagonal(average.covariance))).all()
    assert np.linalg.norm(off) < 0.3 * np.linalg.norm(off_truth(fit.ellipse))


def test_a_tip_fuller_on_one_side_needs_two_exponents():
    fit, average = found((1.8, 2.2), 80)
    assert average.exponent == pytest.approx(2, abs=0.06)
    off = off_truth(average.ellipse)
    assert (np.abs(off) < 1.96 * np.sqrt(np.diagonal(average.covariance))).all()
    assert np.linalg.norm(off) < np.linalg.norm(off_truth(fit.ellipse))


def test_few_points_tell_nothing():
    points = arc_of((1.7, 1.7), 75)
    fit, _ = compared(points)
    few = average_over_shapes(face_arc(points[:60], "radial", (0.0, 1.0)), fit)
    assert few.weight == 0
    assert math.isnan(few.exponent)


@pytest.mark.parametrize("exponents", [(1.85, 1.85), (2.5, 2.5), (1.8, 2.2)])
def test_photographs_of_fingers_that_are_no_ellipses(exponents):
    across, along, mm_per_px = 9.5, 12.5, 0.057
    tip = superellipse(exponents, across, along)
    body = np.concatenate([tip, [[-across, -34], [across, -34]]])
    pixels = photograph_outline(np.random.default_rng(1), body, "palmar", mm_per_px)
    seen = measure_photograph(pixels, "palmar", Scale(mm_per_px))
    assert ("not_an_ellipse" in seen.flags) == (exponents != (1.8, 2.2))
    assert (np.abs(seen.semi_axes - (across, along)) < 1.96 * np.sqrt(np.diagonal(seen.covariance))).all()
    np.testing.assert_allclose(seen.semi_axes, (across, along), rtol=0.06)
    # The ellipse drawn reaches where the finger does: the tip, and its sides.
    top = min(seen.points[:, 0])
    assert seen.handles[2][0] == pytest.approx(top, abs=0.04 * along / mm_per_px)


def ellipse_arc(first_deg, last_deg):
    t = np.linspace(math.radians(first_deg), math.radians(last_deg), 900)
    return np.stack([ACROSS * np.cos(t), ALONG * np.sin(t)], axis=-1)


@pytest.mark.parametrize("angle_deg", [15, 30, 60])
def test_the_outlines_radius_is_the_ellipses_whatever_ellipse_is_given(angle_deg):
    angle = math.radians(angle_deg)
    true = (ACROSS * ALONG) ** 2 / math.hypot(ACROSS * math.cos(angle), ALONG * math.sin(angle)) ** 3
    exact, _ = radius_of_outline(ellipse_arc(-70, 160), (ACROSS, ALONG), angle, 0.0)
    assert exact == pytest.approx(true, rel=3e-3)
    wrong, std = radius_of_outline(ellipse_arc(-70, 160), (1.2 * ACROSS, 0.9 * ALONG), angle, 0.0)
    assert wrong == pytest.approx(true, abs=1.96 * std)
    assert wrong == pytest.approx(true, rel=0.08)


def test_an_outline_that_ends_short_of_the_place_shows_no_radius():
    assert np.isnan(radius_of_outline(ellipse_arc(40, 160), (ACROSS, ALONG), math.radians(15), 0.0)).all()
    assert np.isnan(radius_of_outline(np.empty((0, 2)), (ACROSS, ALONG), 0.5, 0.0)).all()


def test_a_side_face_tells_its_own_curvature_from_the_ellipses():
    truth = fingertips.render("three circles", np.random.default_rng([3, 9]), "radial")
    seen = measure_photograph(truth.pixels, "radial", Scale(truth.mm_per_px), palmar="right")
    angle = math.radians(30)
    radius, std = seen.outline_radius(angle)
    for of in (seen.outline_radius, seen.ellipse_radius):
        with pytest.raises(GeometryError, match="radians"):
            of(30.0)
    assert abs(radius - truth.radius(angle)) < 1.96 * std
    assert 0.02 < std / radius < 0.25
    (at_30, *_), palmar = seen.side_radii(), replace(seen, face="palmar")
    assert (at_30["outline_mm"], at_30["ellipse_mm"]) == (radius, seen.ellipse_radius(angle))
    assert "outline_radius_mm_30deg" in seen.summary()
    assert palmar.side_radii() == []


def length_stds(points, face, semi_axes=(ACROSS, ALONG)):
    """Return what an outline's lengths add to semi-axes, relatively, and whether it is no ellipse then."""
    more, _ = contradicted(face_arc(points, face), PlaneEllipse(0.0, 0.0, *semi_axes), 0.001, 1.0)
    return LENGTHS.added * more, bool((more > LENGTHS.no_ellipse).any())


@pytest.mark.parametrize(
    ("face", "arc"), [("radial", (-60, 150)), ("distal", (-20, 200)), ("palmar", (-10, 190))]
)
def test_the_lengths_of_an_ellipses_outline_are_its_semi_axes(face, arc):
    added, contradicted = length_stds(ellipse_arc(*arc), face)
    assert added.max() < 0.002
    assert not contradicted
    # Of other semi-axes the outline itself says by how much they are wrong, and the flag that it is none.
    (_, along), contradicted = length_stds(ellipse_arc(*arc), face, (ACROSS, 0.85 * ALONG))
    assert 0.5 * 0.15 < along * 0.85 < 0.15
    assert contradicted


def shaft(wider):
    """An ellipse with a shaft wider than the pad by a share, from a fifth of the height on."""
    points = ellipse_arc(-25, 205)
    low = np.clip(0.2 - points[:, 1] / ALONG, 0, 0.4)[:, None] / 0.4
    straight = np.stack([np.copysign(ACROSS * (1 + wider), points[:, 0]), points[:, 1]], axis=-1)
    return (1 - low) * points + low * straight


def test_lengths_come_in_smoothly_as_the_shaft_widens():
    every = np.array([length_stds(shaft(wider), "palmar")[0] for wider in np.arange(0, 0.1, 0.002)])
    # A shaft a few percent wider than the pad is common; wider ones are doubted by and by.
    assert every[:20].max() < 0.04
    assert np.abs(np.diff(every, axis=0)).max() < 0.01


def test_a_shaft_much_wider_than_the_ellipse_shows_that_it_is_not_the_pad():
    added, contradicted = length_stds(shaft(0.5), "palmar")
    assert (added > 0.25).all()
    assert contradicted


def test_an_ellipse_that_leans_otherwise_than_the_finger_is_doubted():
    """Of a photograph whose shaft leans otherwise than its pad's ellipse."""
    truth = render_finger("radial", semi_axes=(8, 12), palmar="right", mm_per_px=0.1, seed=1)
    arc = measure_photograph(truth.pixels, "radial", Scale(truth.mm_per_px), palmar="right")._arc
    straight, turned = (
        face_from_arc(replace(arc, tilt=(arc.tilt[0] + lean, arc.tilt[1]))) for lean in (0.0, 0.3)
    )
    assert "not_an_ellipse" not in straight.flags
    assert "not_an_ellipse" in turned.flags
    assert turned.tilt_std > 0.05 > straight.tilt_std
    assert (np.sqrt(np.diagonal(turned.covariance)) > 0.05 * turned.semi_axes).all()
