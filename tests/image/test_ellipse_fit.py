"""Ellipse fits: recovery, a second implementation, covariance against scatter, and bad points."""

import math

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fingerpad.exceptions import FitError
from fingerpad.image import fit_aligned_ellipse, fit_ellipse
from fingerpad.image.ellipse import half_turn
from fingerpad.image.ellipse_fit import foot_points
from fingerpad.image.photograph.arc import fit_arc_ellipse, initial_ellipse
from fingerpad.simulate import outline_points

semi_axes = st.floats(1.0, 20.0)
angles = st.floats(-1.5, 1.5)


@given(semi_axes, semi_axes, angles, st.floats(-100, 100), st.floats(-100, 100))
@settings(max_examples=20)
def test_exact_points(first, second, angle, x, y):
    fit = fit_ellipse(outline_points(first, second, count=40, centre=(x, y), angle=angle))
    assert fit.ellipse.semi_x == pytest.approx(max(first, second), rel=1e-6)
    assert fit.ellipse.semi_y == pytest.approx(min(first, second), rel=1e-6)
    np.testing.assert_allclose(fit.ellipse.parameters[:2], (x, y), atol=1e-6)
    if abs(first - second) > 0.01:
        true = angle if first > second else angle + math.pi / 2
        assert math.sin(fit.ellipse.angle - true) == pytest.approx(0, abs=1e-5)
    assert -math.pi / 2 < fit.ellipse.angle <= math.pi / 2


def test_agrees_with_a_second_implementation():
    points = outline_points(7.4, 5.0, count=80, angle=0.4, centre=(3, 2), noise_std=0.02, seed=2)
    (x, y), full_axes, _ = cv2.fitEllipseDirect(points.astype(np.float32))
    first, second = (full / 2 for full in full_axes)
    fit = fit_ellipse(points)
    assert fit.ellipse.semi_x == pytest.approx(max(first, second), rel=2e-3)
    assert fit.ellipse.semi_y == pytest.approx(min(first, second), rel=2e-3)
    np.testing.assert_allclose(fit.ellipse.parameters[:2], (x, y), atol=0.01)


@pytest.mark.parametrize(
    ("fit", "of", "outline"),
    [
        (fit_ellipse, slice(5), {"semi_x": 8, "semi_y": 5, "count": 60, "arc": (0.2, 3.6), "angle": 0.5}),
        (fit_aligned_ellipse, slice(4), {"semi_x": 11.8, "semi_y": 13.8, "arc": (0, math.pi)}),
    ],
)
def test_covariance_predicts_scatter(fit, of, outline):
    fits = [fit(outline_points(**outline, noise_std=0.05, seed=seed)) for seed in range(150)]
    found = np.array([one.ellipse.parameters[of] for one in fits])
    predicted = np.sqrt(np.mean([np.diagonal(one.covariance)[of] for one in fits], axis=0))
    np.testing.assert_allclose(found.std(axis=0, ddof=1), predicted, rtol=0.25)
    np.testing.assert_allclose(
        found.mean(axis=0)[:4], [0, 0, outline["semi_x"], outline["semi_y"]], atol=0.03
    )
    assert np.mean([one.residual_std for one in fits]) == pytest.approx(0.05, rel=0.05)


def test_aligned_axes_not_sorted():
    tall = fit_aligned_ellipse(outline_points(3, 8))
    wide = fit_aligned_ellipse(outline_points(8, 3))
    assert (tall.ellipse.semi_x, tall.ellipse.semi_y) == pytest.approx((3, 8))
    assert (wide.ellipse.semi_x, wide.ellipse.semi_y) == pytest.approx((8, 3))


def test_direction_of_circle_undetermined():
    fit = fit_ellipse(outline_points(5, 5, noise_std=0.05, seed=1))
    assert fit.ellipse.semi_x == pytest.approx(5, abs=0.05)
    assert 0.1 < math.sqrt(fit.covariance[4, 4]) <= math.pi / math.sqrt(12) + 1e-12


@given(st.floats(0.1, 10), st.floats(0.1, 10), st.floats(-20, 20), st.floats(-20, 20))
@settings(max_examples=100)
def test_foot_points_are_nearest(semi_x, semi_y, x, y):
    foot = foot_points(np.array([[x, y]]), semi_x, semi_y)[0]
    assert (foot[0] / semi_x) ** 2 + (foot[1] / semi_y) ** 2 == pytest.approx(1, abs=1e-9)
    curve = outline_points(semi_x, semi_y, count=4000)
    nearest = np.linalg.norm(curve - (x, y), axis=1).min()
    assert np.linalg.norm(foot - (x, y)) <= nearest + 1e-7


def test_the_direction_of_an_axis_is_never_straight_down():
    assert half_turn(math.nextafter(math.pi / 2, 4)) == math.pi / 2
    assert half_turn(-math.pi / 2) == math.pi / 2


RUN, FOUR = np.arange(9.0), outline_points(3, 2, count=4)


@pytest.mark.parametrize(
    ("fit", "points", "words"),
    [
        (fit_ellipse, FOUR, "5 different points"),
        (fit_ellipse, np.repeat(FOUR, 3, axis=0), "5 different points"),
        (fit_ellipse, np.column_stack([RUN, 2 * RUN]), "straight line"),
        (fit_ellipse, np.column_stack([RUN, [*RUN[:8], math.nan]]), "row 8"),
        (fit_ellipse, np.column_stack([RUN, [*RUN[:8], math.inf]]), "finite"),
        (fit_ellipse, np.zeros((9, 3)), "shape"),
        (fit_aligned_ellipse, np.transpose([np.cosh(RUN / 4 - 1), np.sinh(RUN / 4 - 1)]), "ellipse"),
        (fit_arc_ellipse, np.zeros((5, 2)), "eight"),
        (fit_arc_ellipse, np.full((20, 2), np.nan), "eight"),
        (fit_arc_ellipse, np.zeros((20, 3)), "eight"),
        (fit_arc_ellipse, np.column_stack([np.arange(20.0)] * 2), "straight line"),
        (
            initial_ellipse,
            np.vstack([outline_points(12, 14, arc=(0.4, 2.7)), (0, 900)]),
            "far beyond the tip",
        ),
        *((fit, "abc", "must be numeric, found 'abc'") for fit in (fit_ellipse, fit_aligned_ellipse)),
    ],
)
def test_points_of_no_ellipse_are_refused(fit, points, words):
    with pytest.raises(FitError, match=words):
        fit(points, *(["palmar"] if fit is initial_ellipse else []))
