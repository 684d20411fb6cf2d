"""Ellipses that may outline a disc: through contours at many grey levels, then through the edge itself."""

import math
from typing import NamedTuple

import cv2
import numpy as np

from fingerpad._arrays import BoolArray, Float32Array, FloatArray, as_float32, as_float_array
from fingerpad.image.ellipse import PlaneEllipse

MIN_AXIS_RATIO = 0.6
_LEVELS = 16
_MIN_RADIUS_PX = 10.0
_DRAWS = 25
_PROFILE_STEP, _CLIMB = 0.25, 8
_SAME = 0.025
_WEAKEST = 0.35


class Outline(NamedTuple):
    """An ellipse through an edge: the edge's points, how steep they are, and which of them lie on it."""

    ellipse: PlaneEllipse
    points: FloatArray
    slope: FloatArray
    kept: BoolArray

    @property
    def support(self) -> float:
        """Share of the circumference on which the edge lies on the ellipse."""
        return float(self.kept.mean())

    @property
    def strength(self) -> float:
        """Slope of the edge that most of the circumference exceeds."""
        return float(np.quantile(np.where(self.kept, self.slope, 0.0), _WEAKEST))


def contour_ellipses(image: Float32Array) -> list[PlaneEllipse]:
    """Return the different ellipses through contours at many grey levels."""
    smooth = cv2.GaussianBlur(image, (0, 0), 1.5)
    slope = np.hypot(*(cv2.Sobel(smooth, cv2.CV_32F, *order, scale=1 / 8) for order in ((1, 0), (0, 1))))
    steep = slope > 2 * np.median(slope)
    low, high = np.percentile(smooth, [0.5, 99.5])
    rng = np.random.default_rng(0)
    found: list[PlaneEllipse] = []
    for level in np.linspace(low, high, _LEVELS + 2)[1:-1]:
        contours, _ = cv2.findContours(
            (smooth > level).astype(np.uint8), cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE
        )
        for contour in contours:
            points = contour[steep[contour[:, 0, 1], contour[:, 0, 0]], 0]
            if len(points) < 2 * math.pi * _MIN_RADIUS_PX:
                continue
            ellipse = _through_contour(points.astype(np.float64), rng)
            if ellipse and all(difference(ellipse, other) > _SAME for other in found):
                found.append(ellipse)
    return found


def _through_contour(points: FloatArray, rng: np.random.Generator) -> PlaneEllipse | None:
    """Return the ellipse that most points of a contour lie on: it may run round a neighbour as well."""
    points = points[:: max(1, len(points) // 100)]
    best, most = None, 0.0
    for draw in range(_DRAWS + 1):
        chosen = points if draw == 0 else points[rng.choice(len(points), 6, replace=False)]
        ellipse = ellipse_through(chosen)
        if ellipse is None:
            continue
        near = np.abs(ellipse.offsets(points)) < max(1.0, 0.015 * ellipse.size)
        share = min(1.0, np.count_nonzero(near) / len(points))
        if share > most:
            best, most = ellipse_through(points[near]) or ellipse, share
        if most > 0.85:
            break
    return best if most > 0.4 else None


def ellipse_through(points: FloatArray) -> PlaneEllipse | None:
    """Return the least-squares ellipse through points, None where it cannot be a disc's image."""
    if len(points) < 6:
        return None
    (x, y), (first, second), degrees = cv2.fitEllipseDirect(points.astype(np.float32))
    if not (math.isfinite(x + y + first + second) and min(first, second) > 2 * _MIN_RADIUS_PX):
        return None
    if min(first, second) < MIN_AXIS_RATIO * max(first, second):
        return None
    return PlaneEllipse(x, y, first / 2, second / 2, math.radians(degrees))


def difference(ellipse: PlaneEllipse, other: PlaneEllipse) -> float:
    """Return the largest distance between two ellipses over their size."""
    return float(np.abs(gaps(ellipse, other)).max())


def gaps(ellipse: PlaneEllipse, other: PlaneEllipse) -> FloatArray:
    """Return the distance of `ellipse` outside `other` round the circumference, over their size."""
    return as_float_array(other.offsets(ellipse.points(72)[0]) / other.size)


def fit_edge(image: Float32Array, ellipse: PlaneEllipse, reach: float, closest: float) -> Outline | None:
    """Fit an ellipse to the steepest places near another one, from within `reach` down to `closest`, px."""
    while True:
        points, slope, found = edge_points(image, ellipse, reach)
        kept = found
        for _ in range(3):
            fitted = ellipse_through(points[kept])
            if fitted is None:
                return None
            off = np.abs(fitted.offsets(points))
            spread = 1.4826 * float(np.median(off[kept]))
            kept = np.asarray(found & (off < np.clip(3 * spread, 0.3, 0.5 + 0.006 * fitted.size)))
        fitted = ellipse_through(points[kept])
        if fitted is None:
            return None
        if reach <= closest:
            return Outline(fitted, points, slope, kept)
        ellipse, reach = fitted, max(closest, 0.6 * reach)


def edge_points(
    image: Float32Array, ellipse: PlaneEllipse, reach: float
) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Return the steepest place across the ellipse on each of many normals, and where it is an edge."""
    count = int(np.clip(math.pi * ellipse.size, 120, 1440))
    points, normals = ellipse.points(count)
    out = np.arange(-reach, reach + _PROFILE_STEP / 2, _PROFILE_STEP)
    x, y = (as_float32(points[:, k, None] + out * normals[:, k, None]) for k in (0, 1))
    profile = cv2.remap(image, x, y, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)
    slope = np.abs(np.gradient(profile, axis=1))
    # Of several edges a steep one near the ellipse is the likely one.
    best = (slope * np.exp(-((out / reach) ** 2)))[:, 1:-1].argmax(axis=1) + 1
    every = np.arange(count)
    for _ in range(_CLIMB):
        uphill = slope[every[:, None], best[:, None] + np.array([-1, 0, 1])].argmax(axis=1) - 1
        best = np.clip(best + uphill, 1, out.size - 2)
    before, here, after = (slope[every, best + k] for k in (-1, 0, 1))
    peak = np.clip(0.5 * (before - after) / np.minimum(before - 2 * here + after, -1e-12), -1, 1)
    rows, columns = image.shape
    inside = (np.abs(points - (columns / 2, rows / 2)) < (columns / 2 - 2, rows / 2 - 2)).all(axis=1)
    found = inside & (here >= before) & (here >= after) & (here > 0.3 * np.median(here))
    return (
        points + (out[best] + _PROFILE_STEP * peak)[:, None] * normals,
        as_float_array(here),
        np.asarray(found),
    )
