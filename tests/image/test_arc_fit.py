"""Ellipses on outlines: correlated errors, short arcs, tilt, and a second implementation."""

import math

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d
from skimage.measure import EllipseModel

from fingerpad.image.ellipse_fit import distances
from fingerpad.image.photograph.arc import bend_covariance, fit_arc_ellipse
from fingerpad.simulate import outline_points


def noisy(seed, *, arc_deg=140.0, std=0.01, reach=6.0, tilt=0.0, count=240):
    """Return points whose radial errors run together over `reach` neighbours."""
    half = math.radians(arc_deg) / 2
    points = outline_points(11.8, 13.8, count=count, arc=(math.pi / 2 - half, math.pi / 2 + half), angle=tilt)
    rough = gaussian_filter1d(np.random.default_rng(seed).normal(0, 1, count), reach)
    rough *= std / rough.std()
    out = points / np.linalg.norm(points, axis=1, keepdims=True)
    return points + rough[:, None] * out


@pytest.mark.parametrize("arc_deg", [40, 90, 180])
@pytest.mark.parametrize("tilt", [-0.15, 0.0, 0.1])
def test_exact_points(arc_deg, tilt):
    fit = fit_arc_ellipse(noisy(0, arc_deg=arc_deg, std=1e-12, tilt=tilt), (tilt, math.radians(2)))
    assert fit.ellipse.parameters[2:] == pytest.approx((11.8, 13.8, tilt), rel=1e-4, abs=1e-5)


def test_correlation_estimate():
    alone = np.median([fit_arc_ellipse(noisy(seed, reach=0.3)).correlation for seed in range(9)])
    joined = np.median([fit_arc_ellipse(noisy(seed, reach=6.0)).correlation for seed in range(9)])
    assert alone < 2
    # A Gaussian filter of deviation s leaves an integrated correlation of 2 s sqrt(pi).
    assert joined == pytest.approx(2 * 6 * math.sqrt(math.pi), rel=0.4)


def test_agrees_with_a_second_implementation():
    points = noisy(1, arc_deg=200, std=0.02, tilt=0.1)
    # In the frame of the tilt, and with no prior to speak of: the same five parameters.
    fit = fit_arc_ellipse(points, (0.1, 2 * math.pi))
    model = EllipseModel.from_estimate(points)
    x, y, first, second, theta = (*model.center, *model.axis_lengths, model.theta)
    assert sorted(fit.ellipse.semi_axes) == pytest.approx(sorted((first, second)), rel=2e-3)
    np.testing.assert_allclose(fit.ellipse.parameters[:2], (x, y), atol=0.03)
    assert math.sin(2 * (fit.ellipse.angle - theta)) == pytest.approx(0, abs=0.03)
    # Orthogonal distance: ours leaves no more.
    assert np.sum(distances(fit.ellipse.parameters, points)[0] ** 2) <= np.sum(
        model.residuals(points) ** 2
    ) * (1 + 1e-6)


def test_known_axis_reduces_uncertainty():
    points = noisy(2, arc_deg=100, tilt=0.05)[:300]
    strict = fit_arc_ellipse(points, (0.05, 0.005))
    loose = fit_arc_ellipse(points, (0.05, 0.3))
    assert strict.covariance[4, 4] < loose.covariance[4, 4] / 4
    assert strict.covariance[4, 4] <= 1.5 * 0.005**2


def test_missing_places():
    points = noisy(3)
    kept = np.ones(len(points), dtype=bool)
    kept[150:200] = False
    whole = fit_arc_ellipse(points)
    broken = fit_arc_ellipse(points[kept], places=np.flatnonzero(kept))
    assert broken.ellipse.semi_y == pytest.approx(
        whole.ellipse.semi_y, abs=4 * math.sqrt(broken.covariance[3, 3])
    )
    assert broken.correlation == pytest.approx(whole.correlation, rel=0.4)


def test_bend_covariance():
    beyond = np.array([-2.0, -1.0, 0.0, 1.0, 2.0])
    spread = bend_covariance(beyond, (10.0, 4.0))
    assert np.linalg.eigvalsh(spread).min() > -1e-12
    assert not spread[2].any()
    assert not spread[:2, 3:].any()
    # Drawn: a jump of the curvature and a walk from there, summed twice over fine steps.
    rng = np.random.default_rng(0)
    step, count = 0.005, 100
    walk = np.cumsum(rng.normal(0, math.sqrt(step), (20000, count)), axis=1)
    bend = rng.normal(0, 1, (20000, 1)) + walk
    drawn = 4.0 * np.cumsum(np.cumsum(bend, axis=1), axis=1)[:, [49, 99]] * step**2
    np.testing.assert_allclose(np.cov(drawn.T), spread[3:, 3:], rtol=0.1)
