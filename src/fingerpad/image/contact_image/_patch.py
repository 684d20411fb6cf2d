"""One patch of contact, measured in px of the picture."""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, FloatArray
from fingerpad.image.contact_image._outline import (
    ContactOutline,
    axis_weights,
    contact_outline,
    edge_shift,
    outline_covariance,
)
from fingerpad.image.contact_image._region import UInt8
from fingerpad.image.contact_image._working_image import WorkingImage
from fingerpad.image.ellipse import AreaMoments, polygon_moments

# Half-way through a ramp of this many levels on each side, a pixel counts as half a ridge.
_RAMP = 64
_NEAR_HALF = slice(128 - _RAMP // 2, 128 + _RAMP // 2)
_LEVELS = np.arange(256)
_HALVES = (slice(0, 128), slice(128, 256))
# How far the level that keeps the area lies above the middle, in parts of the rise, by how the means of
# ridges and valleys lean; and its standard deviation: of each square period, as a share of the lean, and
# of the noise. Fitted to rendered contacts (`ridge_calibration` in benchmarks/contact_images.py prints them).
_ASYMMETRY_SHIFT, _LEVEL_OFFSET = 2.12, -0.026
_OWN, _ASYMMETRY_STD, _NOISY = 0.31, 0.26, 0.058
# Over windows of so many periods resolved ridges spread by more than so many levels.
_WINDOW, _MIN_SPREAD = 3.0, 76.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Patch:
    """A patch in px of the picture.

    `covariance` is of (semi_major, semi_minor, gross_area, ridge_area); ridges lie above `ridge_level`, of
    255.
    """

    moments: AreaMoments
    outline: npt.NDArray[np.float64]
    ridge_area: float
    ridge_level: float
    covariance: FloatArray
    overlap: float
    touches_border: bool
    cut_by_mask: bool


def trace_patch(
    view: WorkingImage,
    patch: BoolArray,
    closed: UInt8,
    amount: UInt8,
    noise: float,
    *,
    resolved: bool,
    by_threshold: bool,
) -> ContactOutline:
    """Trace a patch of the view, given the amount of ridge as found and as closed over the valleys.

    `resolved` is whether the ridge period was found, `by_threshold` whether the ridges' level is given.
    """
    ridges = _ridge_level(_level_histogram(amount, patch), noise, view.period, by_threshold=by_threshold)
    edge = contact_outline(
        patch, closed, amount, view.period, noise=noise, softness=ridges.softness, resolved=resolved
    )
    rows, columns = patch.shape
    outline = edge.moved(edge_shift(edge)).clip(-0.5, [columns - 0.5, rows - 0.5])
    return replace(edge, points=outline)


def measure_patch(
    view: WorkingImage, patch: BoolArray, edge: ContactOutline, amount: UInt8, *, by_threshold: bool
) -> Patch:
    """Measure a patch of the view inside its traced edge."""
    pixel = view.steps[0] * view.steps[1]
    ridges = _ridge_level(_level_histogram(amount, patch), edge.noise, view.period, by_threshold=by_threshold)
    points = view.to_picture(edge.points)
    moments = polygon_moments(points)
    covariance = np.zeros((4, 4))
    weights = axis_weights(moments, points) * pixel
    covariance[:3, :3] = outline_covariance(edge, weights)
    smeared = _blurred_ridges(amount, patch, view.period) if edge.resolved else patch
    unknown = np.count_nonzero(smeared)
    # Where ridges are not resolved any part may be ridge: half of it, uniform from none to all.
    ridge_area = float(_level_histogram(amount, patch & ~smeared) @ ridges.share) + unknown / 2
    covariance[3, 3] = (ridges.std**2 + unknown**2 / 12) * pixel**2
    if edge.by_hand.any():
        # A manual outline that includes too much skin includes its ridges.
        covariance[3, 3] += (ridge_area * pixel / moments.area) ** 2 * covariance[2, 2]
    return Patch(
        moments=moments,
        outline=points,
        ridge_area=ridge_area * pixel,
        ridge_level=ridges.level,
        covariance=covariance,
        overlap=_overlap(edge.points, polygon_moments(edge.points)),
        touches_border=view.touches_border(edge.points, edge.steps),
        cut_by_mask=view.cut_by_mask(edge.points, edge.steps),
    )


class _Ridges(NamedTuple):
    """The level above which ridges lie, of 255, and what share of a pixel of each level is ridge.

    `std` is the standard deviation of the ridges' area, pixels; `softness` the share of it that a change of
    the level by the whole rise would give or take.
    """

    level: float
    share: FloatArray
    std: float
    softness: float


def _level_histogram(amount: UInt8, where: BoolArray) -> FloatArray:
    """Return how many pixels of a place have each level."""
    return cv2.calcHist([amount], [0], where.astype(np.uint8), [256], [0, 256]).ravel().astype(np.float64)


def _ridge_level(counts: FloatArray, noise: float, period: float, *, by_threshold: bool) -> _Ridges:
    """Return the area of ridges from the levels in a patch.

    Where blur fills the valleys, or cuts the crests, the local levels lie on one side of the true ones by an
    amount that the means of what is above and below the middle show: they lean to that side.
    """
    lean = level_asymmetry(counts)
    off = 0.0 if by_threshold else _ASYMMETRY_SHIFT * lean + _LEVEL_OFFSET
    level = 127.5 + 255 * off
    share = np.clip((_LEVELS - level) / (2 * _RAMP) + 0.5, 0, 1)
    area = float(counts @ share)
    softness = float(counts[_NEAR_HALF].sum()) * 255 / _RAMP / max(area, 1.0)
    cells = counts.sum() / period**2
    doubt = math.sqrt(_OWN**2 / cells + (_ASYMMETRY_STD * lean) ** 2 + (_NOISY * noise) ** 2)
    return _Ridges(level=level, share=share, std=doubt * softness * area, softness=softness)


def level_asymmetry(counts: FloatArray) -> float:
    """Return by how much the mean ridge and the mean valley together exceed the rise, in parts of it."""
    low, high = (float(np.average(_LEVELS[part], weights=counts[part] + 1e-9)) for part in _HALVES)
    return (low + high) / 255 - 1


def _blurred_ridges(amount: UInt8, patch: BoolArray, period: float) -> BoolArray:
    """Return where in a patch ridges are blurred into one another, as a quarter of its pixels shows."""
    part = np.ascontiguousarray(amount[::2, ::2])
    side = 2 * round(_WINDOW * period / 4) + 1
    mean, square = (box(part, cv2.CV_32F, (side, side)) for box in (cv2.boxFilter, cv2.sqrBoxFilter))
    smooth = (square - mean * mean < _MIN_SPREAD**2).astype(np.uint8)
    return patch & (cv2.resize(smooth, patch.shape[::-1], interpolation=cv2.INTER_NEAREST) > 0)


def _overlap(outline: npt.NDArray[np.float64], moments: AreaMoments) -> float:
    """Return the intersection over union of an outline and its ellipse."""
    t = np.linspace(0, 2 * math.pi, 120, endpoint=False)
    along, across = moments.semi_axes[:, None, None] * moments.axes[:, None, :]
    ellipse = moments.centroid + along * np.cos(t)[:, None] + across * np.sin(t)[:, None]
    corner = np.minimum(outline.min(axis=0), ellipse.min(axis=0)) - 1
    columns, rows = np.ceil(np.maximum(outline.max(axis=0), ellipse.max(axis=0)) - corner).astype(int) + 2
    both = np.zeros((rows, columns), dtype=np.uint8)
    other = np.zeros_like(both)
    for canvas, points in ((both, outline), (other, ellipse)):
        cv2.fillPoly(canvas, [np.rint((points - corner) * 16).astype(np.int32)], 1, shift=4)
    return float(np.count_nonzero(both & other) / np.count_nonzero(both | other))
