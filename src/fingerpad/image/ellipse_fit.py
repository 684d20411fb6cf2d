"""Ellipses fitted to points.

Points are fitted in two steps: the direct least-squares ellipse, which always is one, then that of least
orthogonal distance from there, with the covariance of its parameters.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, TypeAlias

import cv2
import numpy as np
import numpy.typing as npt
from scipy.optimize import least_squares

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array
from fingerpad._display import Displayed
from fingerpad.exceptions import FitError
from fingerpad.image.ellipse import PlaneEllipse, half_turn, rotation

# (x, y, semi_1, semi_2) and, unless the axes lie along x and y, the angle.
Parameters: TypeAlias = FloatArray

_STEPS: Final = 120
# An angle of which nothing is known is uniform over half a turn.
_ANGLE_VARIANCE_LIMIT = math.pi**2 / 12
# The window of the sum of autocorrelations, in correlation lengths (Sokal 1997, section 3).
_WINDOW: Final = 5.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class EllipseFit(Displayed):
    """An ellipse fitted to points (x, y), in their unit."""

    ellipse: PlaneEllipse
    covariance: FloatArray  # (5, 5); of x, y, semi_x, semi_y, angle, zero for an angle that was not fitted
    residual_std: float  # of the orthogonal distances
    correlation: float | None = None  # so many neighbouring points count as one; None where not asked


def fit_ellipse(points: ArrayLike) -> EllipseFit:
    """Fit the ellipse of least orthogonal distance to five points or more; `semi_x` is the major one."""
    values, covariance, residual_std = _fitted(points, 5, direct_ellipse)
    if values[2] < values[3]:
        order = [0, 1, 3, 2, 4]
        values, covariance = values[order], covariance[np.ix_(order, order)]
        values[4] += math.pi / 2
    covariance[4, 4] = min(covariance[4, 4], _ANGLE_VARIANCE_LIMIT)
    values[4] = half_turn(values[4])
    ellipse = PlaneEllipse(*values.tolist())
    return EllipseFit(ellipse=ellipse, covariance=covariance, residual_std=residual_std)


def fit_aligned_ellipse(points: ArrayLike) -> EllipseFit:
    """Fit the ellipse of least orthogonal distance whose axes lie along x and y to four or more points."""
    values, covariance, residual_std = _fitted(points, 4, _direct_aligned)
    ellipse = PlaneEllipse(*values.tolist())
    return EllipseFit(ellipse=ellipse, covariance=np.pad(covariance, (0, 1)), residual_std=residual_std)


def _fitted(
    points: ArrayLike, min_count: int, direct: Callable[[FloatArray], Parameters]
) -> tuple[Parameters, FloatArray, float]:
    """Return the parameters from a direct fit, their covariance, and the residual deviation."""
    points = _check_points(points, min_count)
    local, shift, size = normalise(points)
    values = refine(local, direct(local))
    off, design = distances(values, local)
    freedom = len(local) - values.size
    variance = float(off @ off) / freedom if freedom > 0 else math.nan
    covariance = variance * np.linalg.pinv(design.T @ design)
    units = np.array([size, size, size, size, 1.0])[: values.size]
    values *= units
    values[:2] += shift
    return values, as_float_array(covariance * np.outer(units, units)), math.sqrt(variance) * size


def _check_points(points: ArrayLike, min_count: int) -> FloatArray:
    points = as_float_array(points, "points", FitError)
    if points.ndim != 2 or points.shape[1] != 2:
        raise FitError(f"points must have shape (n, 2), found {points.shape}")
    if not np.isfinite(points).all():
        row = int(np.argwhere(~np.isfinite(points))[0, 0])
        raise FitError(f"points must be finite, found {points[row]} at row {row}: remove it")
    if len(np.unique(points, axis=0)) < min_count:
        raise FitError(
            f"an ellipse needs at least {min_count} different points, found {len(np.unique(points, axis=0))}"
        )
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    if spread[1] < 1e-6 * spread[0]:
        raise FitError("the points lie on a straight line: mark points round the outline")
    return points


def normalise(points: FloatArray) -> tuple[FloatArray, FloatArray, float]:
    """Return points about their centroid in units of their spread, which conditions a fit, and these two."""
    shift = points.mean(axis=0)
    size = float(np.sqrt(np.mean((points - shift) ** 2)))
    return (points - shift) / size, shift, size


def direct_ellipse(points: FloatArray) -> Parameters:
    """Return (x, y, semi_1, semi_2, angle) of the direct least-squares ellipse (Fitzgibbon et al. 1999)."""
    (x, y), (width, height), degrees = cv2.fitEllipseDirect(points.astype(np.float32))
    start = np.array([x, y, width / 2, height / 2, math.radians(degrees)])
    if not (np.isfinite(start).all() and start[2:4].min() > 0):
        raise FitError("the points do not lie on an ellipse: mark points round one outline")
    return start


def _direct_aligned(points: FloatArray) -> Parameters:
    """Return (x, y, semi_x, semi_y) of the least-squares conic x² + c y² + d x + e y + f = 0, c > 0."""
    x, y = points.T
    design = np.stack([y * y, x, y, np.ones_like(x)], axis=-1)
    c, d, e, f = np.linalg.lstsq(design, -x * x, rcond=None)[0]
    if not c > 0:
        raise FitError(
            "the points do not lie on an ellipse along x and y: check that x_mm and y_mm are not mixed"
        )
    level = d * d / 4 + e * e / (4 * c) - f
    if not level > 0:
        raise FitError("the points do not lie on an ellipse: mark points round one outline")
    return np.array([-d / 2, -e / (2 * c), math.sqrt(level), math.sqrt(level / c)])


def foot_points(points: FloatArray, semi_x: float, semi_y: float) -> FloatArray:
    """Return the nearest point of the ellipse x²/semi_x² + y²/semi_y² = 1 to each of `points`, (n, 2).

    Newton's method on Eberly's distance equation, which falls and is convex beyond its last pole: from below
    its one root no step can overshoot, so it cannot fail.
    """
    if semi_x < semi_y:
        return foot_points(points[:, ::-1], semi_y, semi_x)[:, ::-1]
    x, y = np.abs(points).T / semi_y
    y = np.maximum(y, 1e-14)
    stretch = (semi_x / semi_y) ** 2
    # Either term alone reaches one here, so that both together are not yet below it.
    root = np.maximum(y - 1, math.sqrt(stretch) * x - stretch)
    for _ in range(_STEPS):
        first, second = stretch * (x / (root + stretch)) ** 2, (y / (root + 1)) ** 2
        step = (first + second - 1) / (2 * (first / (root + stretch) + second / (root + 1)))
        root = root + np.maximum(step, 0)
        if (step <= 1e-15 * (1 + np.abs(root))).all():
            break
    cosine = np.minimum(math.sqrt(stretch) * x / (root + stretch), 1.0)
    foot = np.stack([semi_x * cosine, semi_y * np.sqrt(1 - cosine**2)], axis=-1)
    return np.asarray(np.copysign(foot, points), dtype=np.float64)


def distances(values: Parameters, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return signed orthogonal distances and their derivatives by (x, y, semi_1, semi_2, angle)."""
    x, y, semi_1, semi_2 = values[:4]
    angle = values[4] if values.size == 5 else 0.0
    turn = rotation(angle)
    local = (points - (x, y)) @ turn
    foot = foot_points(local, abs(semi_1), abs(semi_2))
    normal = foot / (semi_1**2, semi_2**2)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    distance = np.sum((local - foot) * normal, axis=1)
    # The distance changes only by how far the curve moves along its normal at the foot.
    to_centre = normal @ turn.T
    to_axes = normal * foot / (semi_1, semi_2)
    to_angle = normal[:, 0] * -foot[:, 1] + normal[:, 1] * foot[:, 0]
    return distance, -np.column_stack([to_centre, to_axes, to_angle][: 3 if values.size == 5 else 2])


def refine(
    points: FloatArray,
    start: Parameters,
    *,
    whitened: Callable[[FloatArray], FloatArray] = np.asarray,
    tilt: tuple[float, float] | None = None,
    sizes: tuple[float, float] = (1e-3, 1e3),
    tolerance: float = 1e-12,
    max_steps: int = 200,
) -> Parameters:
    """Minimise the orthogonal distances, as independent unit errors, and that from a tilt with its std.

    Ellipses of semi-axes beyond `sizes` are refused.
    """

    def off(values: Parameters) -> FloatArray:
        own = whitened(distances(values, points)[0])
        return own if tilt is None else np.append(own, (values[4] - tilt[0]) / tilt[1])

    def slopes(values: Parameters) -> FloatArray:
        own = whitened(distances(values, points)[1])
        return own if tilt is None else np.vstack([own, [0.0, 0.0, 0.0, 0.0, 1 / tilt[1]]])

    limits = {"xtol": tolerance, "ftol": tolerance, "gtol": 1e-12, "max_nfev": max_steps}
    values = as_float_array(least_squares(off, start, jac=slopes, **limits).x)
    values[2:4] = np.abs(values[2:4])
    if not np.isfinite(values).all() or values[2:4].min() < sizes[0] or values[2:4].max() > sizes[1]:
        raise FitError("the points do not determine an ellipse: mark a longer arc of the outline")
    return values


def correlation_length(residuals: FloatArray, places: npt.NDArray[np.integer]) -> float:
    """Return how many neighbouring residuals, at rising places along the outline, count as one.

    The integrated autocorrelation 1 + 2 Σ ρ_k over five correlation lengths, at most an eighth of the number.
    """
    span = int(places[-1] - places[0]) + 1
    values, present = np.zeros(span), np.zeros(span)
    values[places - places[0]] = residuals - residuals.mean()
    present[places - places[0]] = 1
    max_lag = max(2, span // 3)
    pairs = np.maximum(_lagged_products(present, max_lag), 1)
    covariance = _lagged_products(values, max_lag) / pairs
    if not covariance[0] > 0:
        return 1.0
    length = 1 + 2 * np.cumsum(covariance[1:] / covariance[0])
    enough = np.arange(1, len(length) + 1) >= _WINDOW * np.maximum(length, 1) / 2
    last = int(np.argmax(enough)) if enough.any() else len(length) - 1
    return float(np.clip(length[: last + 1].max(), 1, len(residuals) / 8))


def _lagged_products(values: FloatArray, max_lag: int) -> FloatArray:
    """Return the sums of products of values at lags 0 to max_lag."""
    size = 2 ** math.ceil(math.log2(2 * len(values)))
    power = np.abs(np.fft.rfft(values, size)) ** 2
    return np.asarray(np.fft.irfft(power, size)[: max_lag + 1], dtype=np.float64)
