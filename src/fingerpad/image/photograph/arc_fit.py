"""Ellipses fitted to ordered points of an outline, with correlated errors.

Neighbouring points of a located edge share the skin's texture, the picture's noise and what the finger
differs from an ellipse by. Their correlation length is estimated from the residuals, and the covariance
widened accordingly.

Beyond the ends of the elliptic arc the outline continues without a corner, and its curvature changes by about
its own size. Points just beyond the ends are weighted accordingly.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import special
from scipy.linalg import solve_triangular
from scipy.optimize import least_squares

from fingerpad._arrays import ArrayLike, BoolArray, FloatArray, as_float_array
from fingerpad.exceptions import FitError
from fingerpad.image.ellipse import PlaneEllipse, rotation
from fingerpad.image.ellipse_fit import (
    EllipseFit,
    Parameters,
    correlation_length,
    distances,
    fit_aligned_ellipse,
    normalise,
)

_ROUNDS = 2
# Farther beyond the arc, in radii of curvature, the outline can be 3 percent of one off, and is not used.
_REACH = 0.25
_REJECTION = 4.0
_MIN_FREEDOM = 3.0
_TWO_SIDED_95 = 1.959964


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ArcFit(EllipseFit):
    """An ellipse fitted to ordered points whose errors are correlated; all is in the unit of the points."""

    correlation: float  # number of neighbouring points that count as one


def fit_arc_ellipse(
    points: ArrayLike,
    tilt: tuple[float, float] = (0.0, math.radians(2)),
    *,
    places: ArrayLike | None = None,
    start: ArrayLike | None = None,
    beyond: ArrayLike | None = None,
) -> ArcFit:
    """Fit the ellipse of least orthogonal distance to ordered, evenly spaced points (x, y) of an outline.

    `tilt` is the turn of the finger's axis from x towards y as known beforehand, and its std, radians.
    `places` are those of the points in the outline, where some are left out. `start` is (x, y, semi_x,
    semi_y, tilt). `beyond` is how far each point lies past an end of the arc: negative before the first,
    positive after the last.
    """
    points = as_float_array(points)
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < 8 or not np.isfinite(points).all():
        raise FitError(f"an outline needs at least eight finite points (x, y), found shape {points.shape}")
    rows = np.asarray(np.arange(len(points)) if places is None else places, dtype=np.int64)
    past = np.zeros(len(points)) if beyond is None else as_float_array(beyond)
    on_arc = past == 0
    local, shift, size = normalise(points)
    past, unit = past / size, np.array([size, size, size, size, 1.0])
    if start is None:
        values = conic_start(local[on_arc], tilt[0])
    else:
        values = (as_float_array(start) - [*shift, 0, 0, 0]) / unit
    values = _refine(local[on_arc], values, (tilt[0], math.inf), np.asarray)
    for _ in range(_ROUNDS):
        variance, correlation = _noise(distances(values, local[on_arc])[0], rows[on_arc])
        spread = bend_covariance(past[~on_arc], _radii_of_curvature(values, local[on_arc][[0, -1]]))
        whitened = _whitening(on_arc, variance * correlation, spread)
        values = _refine(local, values, tilt, whitened)
    residuals, design = distances(values, local)
    white = whitened(design)
    information = white.T @ white
    information[4, 4] += 1 / tilt[1] ** 2
    # So that 1.96 deviations hold 95 %, whatever the degrees of freedom.
    freedom = max(on_arc.sum() / correlation - values.size, _MIN_FREEDOM)
    widening = (special.stdtrit(freedom, 0.975) / _TWO_SIDED_95) ** 2
    covariance = widening * np.linalg.pinv(information, hermitian=True) * np.outer(unit, unit)
    values = values * unit + [*shift, 0, 0, 0]
    return ArcFit(
        ellipse=PlaneEllipse(*values.tolist()),
        covariance=np.asarray(covariance, dtype=np.float64),
        residual_std=float(np.std(residuals[on_arc])) * size,
        correlation=correlation,
    )


def extend_arc(
    points: FloatArray, used: npt.NDArray[np.intp], fit: ArcFit, tilt: tuple[float, float]
) -> ArcFit:
    """Fit an arc's ellipse again, with the outline just beyond the ends of the points used."""
    values, (first, last) = fit.ellipse.parameters, used[[0, -1]]
    places, spacing = outline_places(points)
    beyond = spacing * (np.minimum(places - places[first], 0) + np.maximum(places - places[last], 0))
    flanks = (
        _flank(points, side, np.abs(beyond[side]), fit, radius)
        for side, radius in zip(
            (np.arange(first)[::-1], np.arange(last + 1, len(points))),
            _radii_of_curvature(values, points[[first, last]]),
            strict=True,
        )
    )
    order = np.sort(np.concatenate([used, *flanks]))
    return fit_arc_ellipse(points[order], tilt, places=places[order], start=values, beyond=beyond[order])


def _flank(
    points: FloatArray, order: npt.NDArray[np.intp], away: FloatArray, fit: ArcFit, radius: float
) -> npt.NDArray[np.intp]:
    """Return the points beyond one end, outwards, as far as they can belong to the finger."""
    order, away = order[away <= _REACH * radius], away[away <= _REACH * radius]
    if not len(order):
        return order
    spread = np.diagonal(bend_covariance(away, (radius, radius)))
    off = np.abs(distances(fit.ellipse.parameters, points[order])[0])
    good: BoolArray = off < _REJECTION * np.sqrt(spread + fit.residual_std**2)
    # What stands out is a hair, a nail or the frame, and so may be all that follows.
    return np.asarray(order[np.logical_and.accumulate(good)], dtype=np.intp)


def _whitening(on_arc: BoolArray, density: float, bends: FloatArray) -> Callable[[FloatArray], FloatArray]:
    """Return what scales values, one row for each point, to independent unit errors.

    The points' errors are independent on the arc and run together beyond its ends.
    """
    root = np.linalg.cholesky(bends + density * np.eye(len(bends)))

    def whitened(values: FloatArray) -> FloatArray:
        out = values / math.sqrt(density)
        if len(root):
            out[~on_arc] = solve_triangular(root, values[~on_arc], lower=True)
        return out

    return whitened


def bend_covariance(beyond: FloatArray, radii: tuple[float, ...]) -> FloatArray:
    """Return the covariance of an outline's distance from the ellipse beyond the ends of its arc.

    The outline has no corner. Its curvature, in units of the ellipse's at the end, jumps there by a normal
    deviate and then follows a random walk, both of standard deviation one (the walk's after one radian).
    Integrated twice along the outline, with s and t the lesser and greater of two distances in radii of
    curvature R, the covariance is
    R² [s² t² / 4 + (s⁵/5 + (t − s) s⁴/2 + (t − s)² s³/3) / 4]; the two ends are independent.

    `beyond` is the distance beyond the arc, negative before its first end; `radii` are those of the ellipse
    at the first and the last end, in the same unit.
    """
    radius = np.where(beyond < 0, *radii)
    angle = np.abs(beyond) / radius
    near, far = np.minimum(angle[:, None], angle), np.maximum(angle[:, None], angle)
    gap = far - near
    spread = (near * far) ** 2 / 4 + near**3 * (near**2 / 5 + gap * near / 2 + gap**2 / 3) / 4
    same = np.sign(beyond)[:, None] == np.sign(beyond)
    return np.asarray(np.where(same, spread, 0) * np.outer(radius, radius), dtype=np.float64)


def _radii_of_curvature(values: Parameters, points: FloatArray) -> tuple[float, ...]:
    """Return the ellipse's radius of curvature (a² sin² t + b² cos² t)^(3/2) / (a b) at each point."""
    angles = parametric_angles(points, values)
    speed = np.hypot(values[2] * np.sin(angles), values[3] * np.cos(angles))
    return tuple((speed**3 / (values[2] * values[3])).tolist())


def parametric_angles(points: FloatArray, values: Parameters) -> FloatArray:
    """Return the parametric angle of points seen from an ellipse's centre, radians in (−π, π]."""
    local = (points - values[:2]) @ rotation(values[4])
    return np.asarray(np.arctan2(local[:, 1] / values[3], local[:, 0] / values[2]), dtype=np.float64)


def turns_from(middle: float, points: FloatArray, values: Parameters) -> FloatArray:
    """Return how far the parametric angles of points lie beyond a middle one, radians in [−π, π)."""
    return (parametric_angles(points, values) - middle + math.pi) % (2 * math.pi) - math.pi


def outline_places(points: FloatArray) -> tuple[npt.NDArray[np.int64], float]:
    """Return the place of each point along its outline, in steps of it, and the length of a step.

    Points are evenly spaced but for gaps, where some were left out; no two have one place.
    """
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    step = float(np.median(lengths[lengths > 0])) if (lengths > 0).any() else 1.0
    steps = np.maximum(np.rint(lengths / step), 1)
    return np.concatenate([[0], np.cumsum(steps)]).astype(np.int64)[: len(points)], step


def conic_start(points: FloatArray, tilt: float) -> Parameters:
    """Return the conic of least squares through points, its axis turned by a tilt."""
    turn = rotation(tilt)
    x, y, semi_x, semi_y, _ = fit_aligned_ellipse(points @ turn).ellipse.parameters
    return np.array([*(turn @ (x, y)), semi_x, semi_y, tilt])


def _refine(
    points: FloatArray,
    start: Parameters,
    tilt: tuple[float, float],
    whitened: Callable[[FloatArray], FloatArray],
) -> Parameters:
    """Minimise the orthogonal distances, whitened, together with the distance from the known tilt."""
    prior = np.array([[0.0, 0.0, 0.0, 0.0, 1 / tilt[1]]])

    def off(values: Parameters) -> FloatArray:
        return np.append(whitened(distances(values, points)[0]), (values[4] - tilt[0]) / tilt[1])

    def slopes(values: Parameters) -> FloatArray:
        return np.concatenate([whitened(distances(values, points)[1]), prior])

    result = least_squares(off, start, jac=slopes, xtol=1e-9, ftol=1e-9, gtol=1e-12, max_nfev=60)
    values = np.asarray(result.x, dtype=np.float64)
    values[2:4] = np.abs(values[2:4])
    if not np.isfinite(values).all() or values[2:4].max() > 50 or values[2:4].min() < 0.02:
        raise FitError("the points do not determine an ellipse: mark a longer arc of the outline")
    return values


def _noise(residuals: FloatArray, places: npt.NDArray[np.int64]) -> tuple[float, float]:
    """Return the variance of single points and the number of neighbours that count as one.

    The fit has taken five degrees of freedom from the residuals, each worth one correlation length.
    """
    mean_square = float(np.mean(residuals**2))
    if not mean_square > 0:
        return 1e-24, 1.0
    correlation = correlation_length(residuals, places)
    independent = len(residuals) / correlation
    return mean_square * (independent / max(independent - 5, _MIN_FREEDOM)), correlation
