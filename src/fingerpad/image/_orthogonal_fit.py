"""Ellipses of least orthogonal distance: foot points, distances with derivatives, and the refinement."""

import math
from typing import TypeAlias

import numpy as np
from scipy.optimize import least_squares

from fingerpad._arrays import FloatArray
from fingerpad.exceptions import FitError
from fingerpad.image.ellipse import rotation

# (x, y, semi_1, semi_2) and, unless the axes lie along x and y, the angle.
Parameters: TypeAlias = FloatArray

_STEPS = 120


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


def refine(points: FloatArray, start: Parameters) -> tuple[Parameters, FloatArray, float]:
    """Minimise the orthogonal distances; return parameters, their covariance, and the residual deviation."""

    def off(values: Parameters) -> FloatArray:
        return distances(values, points)[0]

    def slopes(values: Parameters) -> FloatArray:
        return distances(values, points)[1]

    result = least_squares(off, start, jac=slopes, xtol=1e-12, ftol=1e-12, gtol=1e-12, max_nfev=200)
    values = np.asarray(result.x, dtype=np.float64)
    values[2:4] = np.abs(values[2:4])
    design = slopes(values)
    freedom = len(points) - values.size
    variance = 2 * result.cost / freedom if freedom > 0 else math.nan
    if not np.isfinite(values).all() or values[2:4].max() > 1e3 or values[2:4].min() < 1e-3:
        raise FitError("the points do not determine an ellipse: mark a longer arc of the outline")
    covariance = variance * np.linalg.pinv(design.T @ design)
    return values, np.asarray(covariance, dtype=np.float64), math.sqrt(variance)
