"""Edges located to a fraction of a pixel along the normals of a rough contour."""

import math
from functools import lru_cache
from typing import Literal, NamedTuple, TypeAlias

import cv2
import numpy as np
import numpy.typing as npt
from scipy.ndimage import gaussian_filter1d
from scipy.special import ndtr

from fingerpad._arrays import BoolArray, FloatArray
from fingerpad.exceptions import ImageError
from fingerpad.image.ellipse import evenly_spaced, signed_area

# Samples per pixel along a normal, and how far beyond the reach, px; blurs (standard deviation, px) tried.
_DENSITY, _BEYOND_PX = 2, 7.0
_BLURS = np.geomspace(0.5, 6.0, 13)
# Places tried along a normal, px apart.
_TRIAL_STEP = 0.25
_MIN_STEP_RATIO = 3.0
_ALONG_PX = 1.5
_MIN_VARIANCE = 1e-6
# How far a mark may be off the outline, in widths of the finger.
_MARK_REACH = 0.1

IndexArray: TypeAlias = npt.NDArray[np.intp]
Window: TypeAlias = tuple[slice, slice]


class SubpixelOutline(NamedTuple):
    """Points of an outline, evenly spaced."""

    points: FloatArray  # (n, 2); (row, column), px, in order
    found: BoolArray  # (n,); whether the edge was found there: where not, the point is the rough contour's
    blur: float  # px; standard deviation of the edges' blur
    step_ratio: FloatArray  # (n,); step across the edge over what its model leaves, both in light
    closed: bool  # whether the last point is next to the first

    def between(self, marks: FloatArray) -> IndexArray:
        """Return the indices of the outline's points from the first to the last mark, by way of all."""
        away = np.linalg.norm(self.points[:, None] - marks, axis=2)
        nearest, off = np.sort(away.argmin(axis=0)), away.min(axis=0)
        if off.max() > _MARK_REACH * float(np.ptp(self.points, axis=0).min()):
            row, column = marks[off.argmax()]
            raise ImageError(
                f"points: the mark at row {row:g}, column {column:g} is {off.max():.0f} px off "
                "the finger's outline: put marks on the edge of the pad"
            )
        count = len(self.points)
        if self.closed:
            # The arc leaves out the widest gap between marks.
            gaps = np.diff(np.append(nearest, nearest[0] + count))
            first = int((np.argmax(gaps) + 1) % len(nearest))
            return np.asarray(
                (nearest[first] + np.arange(count - int(gaps.max()) + 1)) % count, dtype=np.intp
            )
        return np.arange(nearest[0], nearest[-1] + 1)

    def within(self, window: Window) -> IndexArray:
        """Return the indices of the outline's points in the longest piece inside the region of interest."""
        rows, columns = window
        row, column = self.points.T
        inside = (row >= rows.start) & (row < rows.stop) & (column >= columns.start) & (column < columns.stop)
        if inside.all():
            return np.arange(len(inside))
        start = int(np.argmin(inside)) if self.closed else 0
        order = np.roll(np.arange(len(inside)), -start)
        pieces = np.split(order, np.flatnonzero(np.diff(inside[order].astype(int))) + 1)
        longest: IndexArray = max((piece for piece in pieces if inside[piece[0]]), key=len, default=order[:0])
        return longest


def locate_edges(
    light: npt.NDArray[np.float32], contour: FloatArray, *, reach: float, spacing: float = 1.0
) -> SubpixelOutline:
    """Locate the edge near each point of a rough contour.

    The profile along each normal is, in each channel, a blurred edge between a backdrop that changes evenly
    and a rounded body that brightens as the square root of the depth from its limb. Position by least squares
    over all channels, the blur common to all points.

    `light` is that of `opponent_light`; the contour, (row, column), is closed if its ends meet, and can be
    off by `reach`; points lie `spacing` apart, px.
    """
    closed = bool(np.linalg.norm(contour[0] - contour[-1]) < 3 * np.linalg.norm(contour[1] - contour[0]) + 2)
    points, normals = _resample(contour, spacing, closed=closed)
    offsets = _even(reach + _BEYOND_PX, 1 / _DENSITY)
    profiles = _profiles(light, points, normals, offsets, spacing, closed=closed)
    blurs, weights = _sharpness(profiles[:: max(1, len(profiles) // 150)], offsets, reach)
    places, ratio = _fit_edges(profiles, offsets, blurs, weights, reach)
    found = np.isfinite(places) & (ratio > _MIN_STEP_RATIO)
    moved = points + np.where(found, places, 0.0)[:, None] * normals
    return SubpixelOutline(moved, found, float(blurs[0]), ratio, closed)


def _resample(contour: FloatArray, spacing: float, *, closed: bool) -> tuple[FloatArray, FloatArray]:
    """Return evenly spaced points of a contour and its outward unit normals."""
    points = evenly_spaced(contour, spacing, closed=closed, min_count=8)
    turned = np.roll(points, -1, axis=0) - np.roll(points, 1, axis=0)
    tangent = turned if closed else np.gradient(points, axis=0)
    tangent /= np.maximum(np.linalg.norm(tangent, axis=1, keepdims=True), 1e-12)
    normals = np.stack([tangent[:, 1], -tangent[:, 0]], axis=-1) * math.copysign(1.0, signed_area(points))
    return points, normals


def _profiles(
    light: npt.NDArray[np.float32],
    points: FloatArray,
    normals: FloatArray,
    offsets: FloatArray,
    spacing: float,
    *,
    closed: bool,
) -> FloatArray:
    """Return the colour along each normal, (n, offsets, channels)."""
    spots = (points[:, None] + offsets[None, :, None] * normals[:, None]).astype(np.float32)
    seen = cv2.remap(light, spots[..., 1], spots[..., 0], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    samples = seen.reshape(*spots.shape[:2], -1).astype(np.float64)
    # The outline is smooth over a few pixels: neighbours share their noise.
    mode: Literal["wrap", "nearest"] = "wrap" if closed else "nearest"
    return np.asarray(gaussian_filter1d(samples, _ALONG_PX / spacing, axis=0, mode=mode), dtype=np.float64)


def _sharpness(profiles: FloatArray, offsets: FloatArray, reach: float) -> tuple[FloatArray, FloatArray]:
    """Return each channel's blur and weight, one over the variance that its own best model leaves."""
    blurs, weights = np.empty(profiles.shape[2]), np.empty(profiles.shape[2])
    freedom = len(offsets) - 5
    for k in range(profiles.shape[2]):
        left = [np.mean(_residual_squares(profiles[..., k], blur, reach)[0].min(axis=0)) for blur in _BLURS]
        blurs[k] = _BLURS[int(np.argmin(left))]
        # Rounding to 256 levels is the least noise there is.
        weights[k] = 1 / (min(left) / freedom + _MIN_VARIANCE)
    return blurs, weights


def _residual_squares(profiles: FloatArray, blur: float, reach: float) -> tuple[FloatArray, FloatArray]:
    """Return the squares that the model of one channel leaves with the edge at each place, and its step²."""
    basis, across = _edge_bases(blur, reach)
    parts = np.einsum("no,toj->tnj", profiles, basis, optimize=True)
    left = np.sum(profiles**2, axis=1) - np.sum(parts**2, axis=2)
    return np.asarray(left), np.asarray((parts @ across)[..., 0] ** 2)


@lru_cache(maxsize=32)
def _edge_bases(blur: float, reach: float) -> tuple[FloatArray, FloatArray]:
    """Return orthonormal terms of the model with the edge at each place, and what its step has of each."""
    tries, offsets = _even(reach, _TRIAL_STEP), _even(reach + _BEYOND_PX, 1 / _DENSITY)
    basis, triangle = np.linalg.qr(_model(tries[:, None] - offsets, offsets, blur))
    # Levels of the model just inside and just outside.
    ends = np.column_stack(
        [np.ones_like(tries), np.full_like(tries, math.sqrt(2 * blur + 1)), -np.ones_like(tries), -tries]
    )
    return basis, np.linalg.solve(np.swapaxes(triangle, 1, 2), ends[..., None])


def _even(half: float, step: float) -> FloatArray:
    """Return offsets along a normal from minus half to half of it, px."""
    return np.arange(-half, half + step / 2, step)


def _fit_edges(
    profiles: FloatArray, offsets: FloatArray, blurs: FloatArray, weights: FloatArray, reach: float
) -> tuple[FloatArray, FloatArray]:
    """Return each profile's edge, NaN at the end of the reach, and its step over what its model leaves."""
    each = [_residual_squares(profiles[..., k], blur, reach) for k, blur in enumerate(blurs)]
    left = np.sum([weight * squares for weight, (squares, _) in zip(weights, each, strict=True)], axis=0)
    steps = np.sum([weight * step for weight, (_, step) in zip(weights, each, strict=True)], axis=0)
    tries = _even(reach, _TRIAL_STEP)
    best = np.clip(left.argmin(axis=0), 1, len(tries) - 2)
    which = np.arange(len(profiles))
    before, here, after = left[best - 1, which], left[best, which], left[best + 1, which]
    bend = before - 2 * here + after
    with np.errstate(divide="ignore", invalid="ignore"):
        shift = np.where(bend > 0, 0.5 * (before - after) / bend, np.nan)
        places = np.where(np.abs(shift) <= 1, tries[best] + shift * _TRIAL_STEP, np.nan)
        freedom = profiles.shape[2] * (len(offsets) - 4) - 1
        ratio = np.sqrt(steps[best, which] / np.maximum(here / freedom, 1e-12))
    return places, ratio


def _model(depths: FloatArray, offsets: FloatArray, blur: float) -> FloatArray:
    """Return the terms of an edge's profile: skin, its limb's brightening, backdrop, backdrop's slope."""
    skin = ndtr(depths / blur)
    fine = np.linspace(-4, 4, 41)
    weights = np.exp(-0.5 * fine**2)
    limb = np.sqrt(np.maximum(depths[..., None] + blur * fine, 0)) @ (weights / weights.sum())
    return np.stack([skin, limb, 1 - skin, offsets * (1 - skin)], axis=-1)
