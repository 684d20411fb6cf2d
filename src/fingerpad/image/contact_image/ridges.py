"""Ridges of a contact image, separated from valleys: roughly in the copy, and finely in the picture.

In the copy, windows of three periods give the levels of valleys and ridges; closed over the valleys, these
ridges show the region of the contact. In the picture, extremes around each place do, in means along the
ridges, and narrow ridges and valleys are seen apart: those ridges make the ridge area.
"""

import math
from dataclasses import dataclass
from typing import Any, Final

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, Float32Array, FloatArray, as_float32
from fingerpad.image._masks import UInt8, disk, filled_polygon
from fingerpad.image.contact_image.background import block_means, enlarge
from fingerpad.image.contact_image.calibration import PRINTED_MARKS, RIDGE_LEVEL
from fingerpad.image.contact_image.view import View

HALF: Final = 128  # amount of ridge that parts ridges from valleys, 0 to 255
CLOSING_RADIUS: Final = 1.1  # radius of the disk over which ridges are closed, ridge periods
_WINDOW: Final = 3.0  # ridge periods; side of the windows of local levels
_SMOOTHING: Final = 0.09  # ridge periods; before
_ROUNDS: Final = 3  # the levels are found so often
_PRIOR: Final = 0.03  # weight of the whole picture's levels against a window's own, as a share of the window
LEAST_RISE: Final = 0.3  # from valley to ridge, as a share of the picture's contrast
CLEAR_RISE: Final = 0.5  # smears have less
_LEAST_FOR_STEP: Final = 4  # levels are taken from every other pixel where a period has more than so many
_MOST_PER_PERIOD: Final = 12  # pixels to a ridge period; more tell nothing more
_PLACES_PER_PERIOD: Final = 5  # fewer places tell the ridges' share
_HALF_SIZE: Final = 2
_ENOUGH_PLACES: Final = 10_000  # so many show how the levels of ridges are spread
_NEIGHBOURS = np.array([[1, 1, 1], [1, 0, 1], [1, 1, 1]], dtype=np.uint8)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Ridges:
    """Ridges in the copy."""

    amount: UInt8  # (rows, columns); how far each place is from its valley level (0) to its ridge level (255)
    closed: UInt8  # (rows, columns); the same without specks, closed over the valleys
    level: Float32Array  # level half-way, above the ground, at some places spread over the copy
    rise: Float32Array  # from valley to ridge, there
    threshold: float | None  # that level where the caller gives it

    def within(self, patch: BoolArray) -> tuple[Float32Array, Float32Array]:
        """Return level and rise at the places in a patch, at all of them where none is."""
        size = self.level.shape[::-1]
        inside = cv2.resize(patch.view(np.uint8), size, interpolation=cv2.INTER_NEAREST) > 0
        chosen = inside if inside.any() else np.s_[:]
        return self.level[chosen].ravel(), self.rise[chosen].ravel()


def find_ridges(view: View, threshold: float | None, least_rise: float = LEAST_RISE) -> Ridges:
    """Tell ridges from valleys in the copy.

    The two levels are Ridler & Calvard's means over windows of three periods, or the whole picture's where a
    window lacks one; with a `threshold` zero and twice that everywhere. A rise of less than `least_rise`, in
    parts of the picture's contrast, is taken for as much.
    """
    values = smoothed(view)
    if threshold is not None:
        amount = np.asarray(cv2.convertScaleAbs(np.maximum(values, 0), alpha=255 / (2 * threshold)), np.uint8)
        valley, rise = np.zeros((1, 1), np.float32), np.full((1, 1), 2 * threshold, dtype=np.float32)
    else:
        step = 2 if view.period >= _LEAST_FOR_STEP else 1
        side = max(1, round(_WINDOW * view.period / step / 3))
        valley, rise = _levels(np.ascontiguousarray(values[::step, ::step]), side, view.contrast, least_rise)
        above = np.subtract(values, enlarge(valley, side * step, values.shape))
        scale = enlarge(as_float32(255 / rise), side * step, values.shape)
        amount = np.asarray(cv2.multiply(above, scale, dtype=cv2.CV_8U), np.uint8)
    counted = view.shown & view.inside
    if not counted.all():
        amount = np.where(counted, amount, np.uint8(0))
    closed = _closed(amount, view.period)
    level = as_float32(valley + rise / 2)
    return Ridges(amount=amount, closed=closed, level=level, rise=rise, threshold=threshold)


def smoothed(view: View) -> Float32Array:
    """Return the copy without noise much finer than a ridge."""
    return as_float32(cv2.GaussianBlur(view.contact, (0, 0), max(0.4, _SMOOTHING * view.period)))


def _levels(
    smooth: Float32Array, side: int, contrast: float, least_rise: float
) -> tuple[Float32Array, Float32Array]:
    """Return the local valley level and the local rise from it to the ridges, by blocks of a side.

    A window is three blocks wide.
    """
    whole = _window_means(smooth, side)
    # Where blur fills the valleys, only the local mean lies between the two levels.
    middle = np.maximum(whole, contrast / 2)
    for _ in range(_ROUNDS):
        inside = as_float32(smooth > enlarge(middle, side, smooth.shape))
        share = _window_means(inside, side)
        high = _window_means(np.multiply(inside, smooth, out=inside), side)
        valley = (whole - high) / ((1 + _PRIOR) - share)
        ridge = (high + _PRIOR * contrast) / (share + _PRIOR)
        rise = np.maximum(ridge - valley, least_rise * contrast)
        middle = valley + rise / 2
    return as_float32(valley), as_float32(rise)


def _window_means(values: Float32Array, side: int) -> Float32Array:
    return as_float32(cv2.blur(block_means(values, side), (3, 3)))


def _closed(amount: UInt8, period: float) -> UInt8:
    """Return the amount of ridge without specks, closed over the valleys."""
    closed = np.zeros_like(amount)
    x, y, columns, rows = cv2.boundingRect((amount >= HALF).astype(np.uint8))
    if not columns:
        return closed
    box = np.s_[max(0, y - 2) : y + rows + 2, max(0, x - 2) : x + columns + 2]
    # A lone pixel is a speck; what is below half may be the flank of a ridge: it stays.
    _, most = cv2.threshold(cv2.dilate(amount[box], _NEIGHBOURS), HALF - 1, 255, cv2.THRESH_BINARY)
    plain = np.minimum(amount[box], np.maximum(most, HALF - 1))
    radius = CLOSING_RADIUS * period
    pad = math.ceil(radius) + 1
    padded = cv2.copyMakeBorder(plain, pad, pad, pad, pad, cv2.BORDER_CONSTANT, value=0)
    closed[box] = cv2.morphologyEx(padded, cv2.MORPH_CLOSE, disk(radius), borderValue=0)[pad:-pad, pad:-pad]
    return closed


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RidgeMap:
    """Ridges in the box round a contact, at places some five to a ridge period."""

    above: Float32Array  # (rows, columns); by how much each place exceeds the ridges' level; 0 and less: none
    inside: BoolArray  # (rows, columns); what is inside the outline
    ridges: BoolArray  # (rows, columns); ridges inside the outline
    pitch: int  # pixels of the picture between neighbouring places
    of_picture: FloatArray  # (2, 3); affine map to places (x, y) from pixels of the whole picture
    to_copy: FloatArray  # (2, 3); from places to pixels of the copy
    softness: float  # relative change of the ridges' area for a change of their level, in parts of the rise
    grain: float  # how much ridges vary along themselves, beyond noise, of the rise
    has_print: bool  # whether letters, or other marks darker than ridges, are counted as ridges

    def in_picture(self, shape: tuple[int, int]) -> BoolArray:
        """Return the ridges in a picture of this shape; outside the box they mean nothing."""
        return np.asarray(_warped(self.above, self.of_picture, shape[::-1]) > 0)

    def area(self, smeared: BoolArray) -> tuple[float, float]:
        """Return the ridges' area inside the outline, and that of unresolved parts, px of the picture.

        `smeared` are the unresolved parts in the copy: half of them counts as ridge.
        """
        known, unknown = int(np.count_nonzero(self.ridges)), 0
        if smeared.any():
            in_map = _warped(smeared.view(np.uint8), self.to_copy, self.inside.shape[::-1], cv2.INTER_NEAREST)
            half = self.inside & (in_map > 0)
            unknown = int(np.count_nonzero(half))
            known = int(np.count_nonzero(self.ridges & ~half))
        return (known + unknown / 2) * float(self.pitch**2), unknown * float(self.pitch**2)

    def border(self) -> float:
        """Return the length of the ridges' borders inside the outline, px of the picture.

        By Cauchy and Crofton's formula, from crossings along the rows, the columns and both diagonals.
        """
        ridges = self.ridges
        pairs = (
            (ridges[1:], ridges[:-1]),
            (ridges[:, 1:], ridges[:, :-1]),
            (ridges[1:, 1:], ridges[:-1, :-1]),
            (ridges[1:, :-1], ridges[:-1, 1:]),
        )
        down, across, *diagonal = (np.count_nonzero(one != other) for one, other in pairs)
        return float(math.pi / 8 * (down + across + sum(diagonal) / math.sqrt(2)) * self.pitch)


def ridge_map(view: View, edge: FloatArray, threshold: float | None) -> RidgeMap:
    """Find the ridges inside an outline (x, y) of the copy, in the picture, where narrow ones are seen apart.

    Where no threshold is given, a ridge is what lies, in means along the ridges, about half-way between the
    levels of the valleys and the ridges around. Some five places to a period, each seen at the picture's own
    resolution, tell the ridges' share as well as all pixels do.
    """
    period = view.period * view.step
    step = max(1, int(period // _MOST_PER_PERIOD))
    every = max(1, round(period / step / _PLACES_PER_PERIOD))
    outline = view.to_picture(edge) - view.part.corner[::-1]
    low = np.maximum(np.floor(outline.min(axis=0) - period), 0).astype(int)
    high = np.minimum(np.ceil(outline.max(axis=0) + period) + 1, view.part.pixels.shape[::-1]).astype(int)
    columns, rows = ((high - low) // step * step).tolist()
    box = as_float32(view.part.pixels[low[1] : low[1] + rows, low[0] : low[0] + columns])
    if step > 1:
        box = as_float32(cv2.resize(box, (columns // step, rows // step), interpolation=cv2.INTER_AREA))
    # Pixels of the box are `step` of the picture where that has very many, and every so many of them a place.
    pitch, steps = step * every, np.array(view.steps[::-1])
    of_picture = np.column_stack([np.eye(2), (1 - step) / 2 - low - view.part.corner[::-1]]) / pitch
    to_copy = np.column_stack([np.diag(pitch / steps), (low + step / 2) / steps - 0.5])
    few = np.ascontiguousarray(box[::every, ::every])
    sign = np.float32(-1 if view.dark_on_light else 1)
    inside = filled_polygon((outline - low + 0.5) / step - 0.5, box.shape)[::every, ::every] > 0
    places = np.flatnonzero(inside)
    places = places[:: max(1, places.size // _ENOUGH_PLACES)]
    period /= pitch
    values = as_float32(sign * few - _warped(view.ground, to_copy, few.shape[::-1]))
    level, grain = 0.5, 0.0
    if threshold is not None:
        amount = as_float32(values / np.float32(2 * threshold))
        within = amount.take(places)
    else:
        # The ground is even over a ridge, and moves levels as much as what is compared with them.
        means = as_float32(_mean_along_ridges(box, few, period, every) * sign)
        valley, rise = _local_levels(means, view.contrast, period)
        amount = as_float32((means - valley) / rise)
        within = amount.take(places)
        grain = _grain((sign * few - means).take(places) / rise.take(places), within)
        # Blur lowers the crest of ridges narrower than half a period, and raises the floor of narrow valleys.
        off = 0.5 - np.count_nonzero(within > 0.5) / max(within.size, 1)
        change = _change_with_level(within, 0.5) / max(within.size, 1)
        level += RIDGE_LEVEL.filled + RIDGE_LEVEL.by_blur * (off + RIDGE_LEVEL.cubic * off**3) * change
        level -= RIDGE_LEVEL.by_grain * max(0.0, grain - RIDGE_LEVEL.usual_grain)
    above = as_float32(amount - np.float32(level))
    ridges = (above > 0) & inside
    return RidgeMap(
        above=above,
        inside=inside,
        ridges=ridges,
        pitch=pitch,
        of_picture=of_picture,
        to_copy=to_copy,
        softness=_change_with_level(within, level) / max(int(np.count_nonzero(within > level)), 1),
        grain=grain,
        has_print=_has_print(values, ridges, inside, period),
    )


def _warped(
    image: npt.NDArray[Any], turn: FloatArray, size: tuple[int, ...], interpolation: int = cv2.INTER_LINEAR
) -> npt.NDArray[Any]:
    flags = interpolation | cv2.WARP_INVERSE_MAP
    return cv2.warpAffine(image, turn, size, flags=flags, borderMode=cv2.BORDER_REPLICATE)


def _has_print(values: Float32Array, ridges: BoolArray, inside: BoolArray, period: float) -> bool:
    """Return whether places darker than the ridges around are as large, and as many, as letters."""
    # Blocks of four places show means over so much more.
    side = [2 * round(PRINTED_MARKS.around * period / 8) + 1] * 2
    chosen = as_float32(ridges)
    total, count = (cv2.blur(block_means(each, 4), side) for each in (values * chosen, chosen))
    usual = np.where(count > 0, total / np.maximum(count, np.float32(1e-6)), np.float32(np.inf))
    dark = values > enlarge(as_float32(PRINTED_MARKS.darker * usual), 4, values.shape)
    stroke = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, [max(2, round(PRINTED_MARKS.stroke * period))] * 2)
    strokes = np.asarray(cv2.morphologyEx(dark.view(np.uint8), cv2.MORPH_OPEN, stroke), np.uint8)
    reach = PRINTED_MARKS.reach * period
    # Shorter labels are twice as fast; so few places cannot hold more strokes than they count.
    kind = cv2.CV_16U if strokes.size < 2**19 else cv2.CV_32S
    _, labels, stats, centres = cv2.connectedComponentsWithStats(strokes, ltype=kind)
    letters = 0
    for number in np.flatnonzero(stats[1:, [cv2.CC_STAT_WIDTH, cv2.CC_STAT_HEIGHT]].min(axis=1) > reach) + 1:
        x, y, columns, rows, _ = stats[number]
        stroke = cv2.findNonZero((labels[y : y + rows, x : x + columns] == number).view(np.uint8))
        x, y = centres[number].astype(int)
        letters += bool(inside[y, x]) and min(cv2.minAreaRect(stroke)[1]) > reach
    return letters >= PRINTED_MARKS.minimum


def _grain(off: Float32Array, amount: Float32Array) -> float:
    """Return by how much ridges vary along themselves, beyond noise, in parts of the rise.

    `off` is what lies above the means along the ridges. Valleys show the noise.
    """
    squares, variances = off * off, []
    for where in (amount > RIDGE_LEVEL.crest, amount < 1 - RIDGE_LEVEL.crest):
        chosen, count = as_float32(where), max(int(np.count_nonzero(where)), 1)
        variances.append(float(squares @ chosen) / count - (float(off @ chosen) / count) ** 2)
    ridges, valleys = variances
    return math.sqrt(max(0.0, ridges - valleys))


def _change_with_level(amount: Float32Array, level: float) -> float:
    """Return how many pixels fewer would be ridge for each unit of their level."""
    near = RIDGE_LEVEL.near_half
    return np.count_nonzero((amount > level - near) & (amount <= level + near)) / (2 * near)


def _mean_along_ridges(box: Float32Array, few: Float32Array, period: float, every: int) -> Float32Array:
    """Return means of three samples along the ridges, `RIDGE_LEVEL.sample` apart, at every so many pixels.

    They leave the width of ridges as it is, while noise, mottle and grain no longer count as gaps.
    """
    x, y = cv2.Sobel(few, cv2.CV_32F, 1, 0, ksize=5), cv2.Sobel(few, cv2.CV_32F, 0, 1, ksize=5)
    cos2, sin2 = (_blurred(each, RIDGE_LEVEL.direction * period) for each in (y * y - x * x, -2 * x * y))
    # The direction is half that of (cos2, sin2). Of both formulas, the one without a difference is exact.
    length = np.maximum(cv2.magnitude(cos2, sin2), np.float32(1e-30))
    longer = length + np.abs(cos2)
    more = np.sqrt(longer / length) * np.float32(RIDGE_LEVEL.sample * period * every / math.sqrt(2))
    less, flat = sin2 / longer * more, cos2 >= 0
    # How far rightward and downward the next sample lies, px.
    right, down = (
        enlarge(as_float32(each), _HALF_SIZE, few.shape, cv2.INTER_NEAREST)
        for each in (np.where(flat, more, less), np.where(flat, less, more))
    )
    row, column = (np.arange(n, dtype=np.float32) * every for n in few.shape)
    total = few.copy()
    for move in (np.add, np.subtract):  # one way, then the other
        x, y = move(column, right), move(row[:, None], down)
        total += cv2.remap(box, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    total /= 3
    return total


def _local_levels(values: Float32Array, contrast: float, period: float) -> tuple[Float32Array, Float32Array]:
    """Return the level of the valleys and the rise from it to the ridges around each place.

    The extremes within a disk of about a period depend little on mottle and the ridges' width; means do.
    """
    around = disk(RIDGE_LEVEL.reach * period / 2)
    low, high = (
        _blurred(as_float32(extreme(values, around)), RIDGE_LEVEL.smoothing * period)
        for extreme in (cv2.erode, cv2.dilate)
    )
    rise = np.maximum(high - low, np.float32(LEAST_RISE * contrast))
    low, rise = (enlarge(as_float32(each), _HALF_SIZE, values.shape) for each in (low, rise))
    return low, rise


def _blurred(values: Float32Array, sigma: float) -> Float32Array:
    """Return values blurred over some places, at half the size: less shows all that is left."""
    return as_float32(cv2.GaussianBlur(block_means(values, _HALF_SIZE), (0, 0), sigma / _HALF_SIZE))
