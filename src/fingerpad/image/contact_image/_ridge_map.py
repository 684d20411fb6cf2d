"""Where ridges touch, at the resolution of the picture."""

import math
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, Float32Array, FloatArray, as_float32
from fingerpad.image._masks import filled_polygon
from fingerpad.image.contact_image._region import disk
from fingerpad.image.contact_image._ridges import MIN_RISE, Signal, enlarge
from fingerpad.image.contact_image._working_image import WorkingImage

# More pixels to a ridge period than this tell nothing more; directions and levels need fewer.
_MOST_PER_PERIOD, _FEWER_PER_PERIOD = 12, 5
# All lengths in ridge periods. The direction of the ridges is that of gradients smoothed over `_GRADIENT`,
# averaged over `_DIRECTION`; samples along it are `_SAMPLE` apart.
_GRADIENT, _DIRECTION, _SAMPLE = 0.1, 0.6, 0.35
# Valley and ridge levels are the extremes within `_REACH`, smoothed over `_LEVELS`.
_REACH, _LEVELS = 1.1, 1.0
# What a device clips to white, or black, would lie a seventh of the rise beyond, give or take, and less where
# few pixels are clipped: half of that is the shift of the half level.
_BY_CLIPPING = 0.07
# Grain is what ridges, above `_CREST`, vary more than valleys; `_USUAL_GRAIN` are pores and blur. The level
# falls with what is more, as if half of it were faint contact; the rest may be gaps.
_CREST, _USUAL_GRAIN, _BY_GRAIN = 0.7, 0.12, 0.4
# Shift of the level by blur, for how far the share of ridges is from half and how it changes with the level:
# near that of a square wave under a Gaussian of 0.1 periods, and of pictures of known truth.
_BY_BLUR, _CUBIC = 0.45, 30.0
# Letters are darker than the ridges within `_AROUND` periods, by so much, in strokes of `_STROKE` or wider,
# and reach further than `_LETTER` along and across. Real prints have no such place of more than 1.2 periods.
_DARKER, _AROUND, _STROKE, _LETTER, _FEWEST_LETTERS = 1.1, 10.0, 0.4, 2.2, 2
# The change with the level is taken between levels so far from half.
_NEAR_HALF = 0.1


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RidgeMap:
    """Ridges in the box round a contact.

    Attributes
    ----------
    is_ridge : ndarray of bool, (rows, columns)
    corner : (int, int)
        (row, column) of the box in the picture.
    step : int
        Pixels of the picture in one of the map.
    softness : float
        Relative change of the ridges' area for a change of their level, in parts of the rise.
    grain : float
        By how much ridges vary along themselves, beyond noise and what is usual, in parts of the rise.
    clipped : float
        Share of the valleys that the device shows as white, or as black where ridges are bright.
    has_print : bool
        Whether letters, or other marks darker than ridges, are counted as ridges.
    """

    is_ridge: BoolArray
    corner: tuple[int, int]
    step: int
    softness: float
    grain: float
    clipped: float
    has_print: bool

    def in_picture(self, shape: tuple[int, int]) -> BoolArray:
        """Return the ridges in a picture of this shape, none outside the box."""
        whole = np.zeros(shape, dtype=bool)
        fine = self.is_ridge.repeat(self.step, axis=0).repeat(self.step, axis=1)
        row, column = self.corner
        part = whole[row : row + fine.shape[0], column : column + fine.shape[1]]
        part[:] = fine[: part.shape[0], : part.shape[1]]
        return whole

    def area_within(self, outline: FloatArray, half: BoolArray) -> tuple[float, float]:
        """Return the ridges' area inside an outline (x, y) of the picture, and that of unresolved parts, px.

        `half` are the unresolved parts, as an image of the map's box: half of them counts as ridge.
        """
        inside = self._filled(outline)
        unknown = np.count_nonzero(half & inside)
        known = np.count_nonzero(self.is_ridge & ~half & inside)
        return (known + unknown / 2) * float(self.step**2), unknown * float(self.step**2)

    def border_within(self, outline: FloatArray) -> float:
        """Return the length of the ridges' borders inside an outline (x, y) of the picture, px.

        By Cauchy and Crofton's formula, from crossings along the rows, the columns and both diagonals.
        """
        ridges = self.is_ridge & self._filled(outline)
        straight = np.count_nonzero(ridges[1:] != ridges[:-1]) + np.count_nonzero(
            ridges[:, 1:] != ridges[:, :-1]
        )
        diagonal = np.count_nonzero(ridges[1:, 1:] != ridges[:-1, :-1]) + np.count_nonzero(
            ridges[1:, :-1] != ridges[:-1, 1:]
        )
        return float(math.pi / 8 * (straight + diagonal / math.sqrt(2)) * self.step)

    def _filled(self, outline: FloatArray) -> BoolArray:
        """Return the inside of an outline (x, y) of the picture, as an image of the map's box."""
        places = (outline + 0.5 - self.corner[::-1]) / self.step - 0.5
        return np.asarray(filled_polygon(places, self.is_ridge.shape) > 0)

    def sampled(self, mask: BoolArray, view: WorkingImage) -> BoolArray:
        """Return a mask of the working copy as an image of the map's box."""
        turn = _to_copy(self.corner, self.step, view)
        size = self.is_ridge.shape[::-1]
        return _warped(mask.astype(np.uint8), turn, size, cv2.INTER_NEAREST) > 0


def _to_copy(corner: tuple[int, int], step: int, view: WorkingImage) -> FloatArray:
    """Return the affine map from the map's pixels (x, y) to those of the working copy."""
    along = step / np.array(view.steps[::-1])
    start = (np.array(corner[::-1]) - view.corner[::-1] + step / 2) / view.steps[::-1] - 0.5
    return np.array([[along[0], 0, start[0]], [0, along[1], start[1]]])


def _warped(
    image: npt.NDArray[Any], turn: FloatArray, size: tuple[int, ...], interpolation: int
) -> npt.NDArray[Any]:
    return cv2.warpAffine(
        image, turn, size, flags=interpolation | cv2.WARP_INVERSE_MAP, borderMode=cv2.BORDER_REPLICATE
    )


def ridge_map(view: WorkingImage, signal: Signal, edge: FloatArray, threshold: float | None) -> RidgeMap:
    """Find the ridges inside an outline (x, y) of the working copy.

    Where no threshold is given, a ridge is what lies, in means along the ridges, about half-way between the
    levels of the valleys and the ridges around. At the resolution of the working copy, narrow ridges and
    narrow valleys blur into one another.
    """
    period = view.period * math.sqrt(view.steps[0] * view.steps[1])
    step = max(1, int(period // _MOST_PER_PERIOD))
    outline = view.to_picture(edge) - view.corner[::-1]
    low = np.maximum(np.floor(outline.min(axis=0) - period), 0).astype(int)
    high = np.minimum(np.ceil(outline.max(axis=0) + period) + 1, view.picture.shape[::-1]).astype(int)
    columns, rows = ((high - low) // step * step).tolist()
    box = as_float32(view.picture[low[1] : low[1] + rows, low[0] : low[0] + columns])
    if step > 1:
        box = as_float32(cv2.resize(box, (columns // step, rows // step), interpolation=cv2.INTER_AREA))
    sign = -1.0 if signal.dark_on_light else 1.0
    row, column = (int(k) for k in low[::-1] + view.corner)
    turn = _to_copy((row, column), step, view)
    ground = as_float32(sign * view.values - signal.values)
    values = as_float32(sign * box - _warped(ground, turn, box.shape[::-1], cv2.INTER_LINEAR))
    inside = filled_polygon((outline - low + 0.5) / step - 0.5, box.shape) > 0
    level, grain, clipped = 0.5, 0.0, 0.0
    if threshold is not None:
        amount = as_float32(values / np.float32(2 * threshold))
    else:
        means = mean_along_ridges(values, period / step)
        valley, rise = local_levels(means, signal.contrast, period / step)
        amount = as_float32((means - valley) / rise)
        grain = _excess_grain(as_float32((values - means) / rise), amount, inside)
        clipped = _clipped_share(box, inside & (amount < level), dark_on_light=signal.dark_on_light)
        level += _blur_shift(amount[inside]) - _BY_GRAIN * grain - _BY_CLIPPING * clipped**2
    within, is_ridge = amount[inside], np.asarray(amount > level)
    return RidgeMap(
        is_ridge=is_ridge,
        corner=(row, column),
        step=step,
        softness=_change_with_level(within, level) / max(int(np.count_nonzero(within > level)), 1),
        grain=grain,
        clipped=clipped,
        has_print=_has_print(values, is_ridge & inside, inside, period / step),
    )


def _has_print(values: Float32Array, ridges: BoolArray, inside: BoolArray, period: float) -> bool:
    """Return whether places darker than the ridges around are as large, and as many, as letters."""
    side = 2 * round(_AROUND * period / 2) + 1
    share = as_float32(ridges)
    level, count = (cv2.blur(each, (side, side)) for each in (values * share, share))
    dark = (values * count > np.float32(_DARKER) * level) & (count > 0)
    stroke = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, [max(2, round(_STROKE * period))] * 2)
    strokes = cv2.morphologyEx(dark.astype(np.uint8), cv2.MORPH_OPEN, stroke)
    contours, _ = cv2.findContours(strokes, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    letters = 0
    for contour in contours:
        if len(contour) > 2 * _LETTER * period and min(cv2.minAreaRect(contour)[1]) > _LETTER * period:
            x, y = contour.reshape(-1, 2).mean(axis=0).astype(int)
            letters += bool(inside[y, x])
    return letters >= _FEWEST_LETTERS


def _excess_grain(off: Float32Array, amount: Float32Array, inside: BoolArray) -> float:
    """Return by how much ridges vary along themselves, beyond noise and what is usual, in parts of the rise.

    `off` is what lies above the means along the ridges. Valleys show the noise.
    """
    ridges, valleys = (
        float(cv2.meanStdDev(off, mask=(where & inside).astype(np.uint8))[1][0, 0])
        for where in (amount > _CREST, amount < 1 - _CREST)
    )
    return max(0.0, math.sqrt(max(0.0, ridges**2 - valleys**2)) - _USUAL_GRAIN)


def _change_with_level(amount: Float32Array, level: float) -> float:
    """Return how many pixels fewer would be ridge for each unit of their level."""
    between = np.count_nonzero((amount > level - _NEAR_HALF) & (amount <= level + _NEAR_HALF))
    return between / (2 * _NEAR_HALF)


def _blur_shift(amount: Float32Array) -> float:
    """Return how far the level at the border of blurred ridges lies above half.

    Blur lowers the crest of ridges narrower than half a period, and raises the floor of narrow valleys.
    """
    pixels = max(amount.size, 1)
    off = 0.5 - np.count_nonzero(amount > 0.5) / pixels
    return _BY_BLUR * (off + _CUBIC * off**3) * _change_with_level(amount, 0.5) / pixels


def _clipped_share(box: Float32Array, valleys: BoolArray, *, dark_on_light: bool) -> float:
    """Return the share of valleys at the end of the range of 8 or 16 bits."""
    end = float(box.max()) if dark_on_light else 0.0
    if end not in {0.0, 255.0, 65535.0}:
        return 0.0
    return int(np.count_nonzero((box == end) & valleys)) / max(int(np.count_nonzero(valleys)), 1)


def mean_along_ridges(values: Float32Array, period: float) -> Float32Array:
    """Return means of three samples along the ridges, `_SAMPLE` apart.

    They leave the width of ridges as it is, while noise, mottle and grain no longer count as gaps.
    """
    along = _ridge_direction(values, period)
    columns, rows = np.meshgrid(*(np.arange(n, dtype=np.float32) for n in values.shape[::-1]), sparse=True)
    total = values.copy()
    for way in (-_SAMPLE * period, _SAMPLE * period):
        x, y = (start + np.float32(way) * part for start, part in zip((columns, rows), along, strict=True))
        total += cv2.remap(values, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return as_float32(total / 3)


def _ridge_direction(values: Float32Array, period: float) -> list[Float32Array]:
    """Return cosine and sine of the angle of the ridges from rightward to downward."""
    every = max(1, round(period / _FEWER_PER_PERIOD))
    few = period / every
    smooth = cv2.GaussianBlur(values[::every, ::every], (0, 0), max(0.5, _GRADIENT * few))
    x, y = cv2.Scharr(smooth, cv2.CV_32F, 1, 0), cv2.Scharr(smooth, cv2.CV_32F, 0, 1)
    cos2, sin2 = (cv2.GaussianBlur(each, (0, 0), _DIRECTION * few) for each in (y * y - x * x, -2 * x * y))
    angle = np.arctan2(sin2, cos2) / 2
    return [enlarge(each, every, values.shape, cv2.INTER_NEAREST) for each in (np.cos(angle), np.sin(angle))]


def local_levels(values: Float32Array, contrast: float, period: float) -> tuple[Float32Array, Float32Array]:
    """Return the level of the valleys and the rise from it to the ridges around each pixel.

    They are the extremes within a disk of about a period, which depend little on mottle and on how wide the
    ridges are, while means of all that is above and below half move with both.
    """
    every = max(1, round(period / _FEWER_PER_PERIOD))
    few = np.ascontiguousarray(values[::every, ::every])
    around = disk(_REACH * period / every / 2)
    sigma = _LEVELS * period / every
    low, high = (
        enlarge(as_float32(cv2.GaussianBlur(extreme(few, around), (0, 0), sigma)), every, values.shape)
        for extreme in (cv2.erode, cv2.dilate)
    )
    return low, as_float32(np.maximum(high - low, MIN_RISE * contrast))
