"""What is no contact: an even border round the picture, and the ground with its uneven light."""

import math
from typing import Final

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, Float32Array, FloatArray, as_float32
from fingerpad.image._masks import bounding_box, distance_to, largest_piece, longest_contour
from fingerpad.image.levels import quadratic_terms

_MIN_BORDER: Final = 0.02  # of the picture; an added border is no less
_RIPPLE: Final = 4 / 255  # of the range; lossy compression leaves such ripples in it
# An even background behind a print also has one level, but a print is not convex and has no straight sides.
_MIN_CONVEXITY: Final = 0.96
_MIN_STRAIGHTNESS: Final = 0.7  # share of the outline in sides
_LONG_SIDE: Final = 0.2  # of the picture's; a side is no shorter
_SAME: Final = 0.5  # of a border, but less of a ground in uneven light, has its level without a ripple
_SLACK: Final = 0.1  # these limits are so much wider where letters stick out of a card, or grain runs into it
_BLUNTNESS: Final = 0.005  # of the longest side; corners may be so far off: small prints stay as they are
_BORDER_PX: Final = 240  # longer side of a copy that is fine enough for a border
_GRAIN_PX: Final = 4  # of it; grain that runs into the border
_LETTER_PX: Final = 12  # of it; letters that stick out

_BLOCK: Final = 1.35  # side of the blocks that are busy with ridges or quiet, ridge periods
_MIN_QUIET: Final = 40  # fewer quiet blocks show a level of the ground, but no slope
_MAX_QUIET: Final = 300  # more are not needed
_SURFACE_ROUNDS: Final = 2
_TINY: Final = 1e-9 * np.eye(6)  # keeps the surface through few blocks defined


def without_added_border(
    pixels: npt.NDArray[np.uint8] | npt.NDArray[np.float32], shape: tuple[int, int]
) -> BoolArray:
    """Return where the picture, at a shape, shows anything: all but an even border that was added.

    The border has one level, holds at least three corners, and leaves a convex polygon of long sides.
    """
    step = max(1, round(max(pixels.shape) / _BORDER_PX))
    small = pixels[::step, ::step].astype(np.float32)
    corners = np.sort(small[[0, 0, -1, -1], [0, -1, 0, -1]])
    low, high, _, _ = cv2.minMaxLoc(small)
    level, width = float(corners[1:3].mean()), _RIPPLE * (high - low)
    if np.count_nonzero(np.abs(corners - level) <= width) >= 3:
        near = cv2.inRange(small, level - width, level + width)
        # Noise that comes near one level here and there leaves no even piece.
        opened = cv2.morphologyEx(near, cv2.MORPH_OPEN, np.ones((5, 5), np.uint8))
        enough = cv2.countNonZero(opened) >= _MIN_BORDER * opened.size
        filled = cv2.copyMakeBorder(opened, 1, 1, 1, 1, cv2.BORDER_CONSTANT, value=255)
        cv2.floodFill(filled, None, (0, 0), 1)
        card = np.asarray(filled[1:-1, 1:-1] != 1)
        # A print on an even ground shows that it is no card before grain and letters are looked at, or when
        # they are at half the size.
        if enough and _is_card(card, _SLACK) and _is_card(_plain_card(card[::2, ::2]), _SLACK / 5):
            card = _plain_card(card)
            border = small[~card]
            if _is_card(card) and np.mean(np.abs(border - np.median(border)) <= width / 8) > _SAME:
                return cv2.resize(card.view(np.uint8), shape[::-1], interpolation=cv2.INTER_NEAREST) > 0
    return np.ones(shape, dtype=bool)


def _plain_card(card: BoolArray) -> BoolArray:
    """Return what an even border leaves: grain that runs into it closed, letters that stick out dropped."""
    # In a small picture a print must not be rounded into a polygon.
    scale = min(1.0, max(card.shape) / _BORDER_PX)
    grain, letter = _GRAIN_PX * scale, _LETTER_PX * scale
    # All happens within its box, if that is padded by what is grown.
    box, pad = bounding_box(card, margin=0), math.ceil(grain) + 2
    grown = distance_to(~(distance_to(np.pad(card[box], pad)) <= grain)) > grain
    plain = distance_to(distance_to(~grown) > letter) <= letter
    smooth = np.zeros_like(card)
    smooth[box] = largest_piece(np.asarray(plain[pad:-pad, pad:-pad]))
    return smooth


def _is_card(card: BoolArray, slack: float = 0.0) -> bool:
    """Return whether what is left is a convex polygon of long sides, smaller than the picture."""
    if not card.any() or not card.mean() < 1 - _MIN_BORDER + slack:
        return False
    hull = cv2.convexHull(longest_contour(card))
    if np.count_nonzero(card) < (_MIN_CONVEXITY - slack) * cv2.contourArea(hull):
        return False
    corners = cv2.approxPolyDP(hull, _BLUNTNESS * max(card.shape), True).reshape(-1, 2)
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1)
    straight = sides[sides > _LONG_SIDE * math.sqrt(card.size)].sum()
    return bool(straight > (_MIN_STRAIGHTNESS - 2 * slack) * sides.sum())


def flattened(
    values: Float32Array, inside: BoolArray, period: float, dark_on_light: bool | None, contrast: float | None
) -> tuple[Float32Array, float, float, bool]:
    """Turn contact bright, and remove uneven lighting by a smooth surface through the quiet ground.

    Return that, as `View` has it, with its noise, its contrast and whether contact was darker.
    """
    side = max(2, round(_BLOCK * period))
    means = block_means(values, side)
    deviations = np.sqrt(
        np.maximum(block_means(as_float32(cv2.multiply(values, values)), side) - means * means, 0)
    )
    # Blocks that reach over the edge do not count.
    whole = np.zeros(means.shape, dtype=bool)
    whole[: values.shape[0] // side, : values.shape[1] // side] = True
    counted = whole if inside.all() else whole & (block_means(inside * np.uint8(255), side) > 252)
    if not counted.any():
        counted = whole
    limit = _otsu_threshold(deviations[counted])
    quiet, busy = counted & (deviations <= limit), counted & (deviations > limit)
    # A smooth contact is quiet too: ground for sure is what is quiet at the rim of the whole blocks.
    rim = quiet.copy()
    rim[1 : values.shape[0] // side - 1, 1 : values.shape[1] // side - 1] = False
    rim = rim if rim.any() else quiet
    if dark_on_light is None:
        dark_on_light = True
        if busy.any() and rim.any():
            # Ridges raise the texture, and their mean differs from the quiet ground's.
            dark_on_light = float(means[busy].mean()) < quantile(means[rim], 0.5)
    sign = -1.0 if dark_on_light else 1.0
    places = np.flatnonzero(quiet)
    places = places[:: max(1, places.size // _MAX_QUIET)]
    flat = sign * values - enlarge(_ground_surface(sign * means, places, rim), side, values.shape)
    noise = quantile(deviations.flat[places], 0.5) if places.size else 0.0
    if contrast is None:
        # How far the contact in the busy places lies above what lies between.
        contact = enlarge(as_float32(busy if busy.any() else counted), side, values.shape) > 0.5
        sample = flat[::2, ::2][contact[::2, ::2]]
        threshold = _otsu_threshold(sample)
        above, below = sample[sample > threshold], sample[sample <= threshold]
        contrast = float(above.mean() - below.mean()) if above.size and below.size else 0.0
    return as_float32(flat), noise, contrast, dark_on_light


def block_means(values: Float32Array | npt.NDArray[np.uint8], side: int) -> Float32Array:
    """Return the means of square blocks; the last in a row or column may reach over the edge, mirrored."""
    over = [-n % side for n in values.shape]
    whole = cv2.copyMakeBorder(values, 0, over[0], 0, over[1], cv2.BORDER_REFLECT) if any(over) else values
    rows, columns = (n // side for n in whole.shape)
    return as_float32(cv2.resize(whole, (columns, rows), interpolation=cv2.INTER_AREA))


def enlarge(
    few: Float32Array, every: int, shape: tuple[int, ...], interpolation: int = cv2.INTER_LINEAR
) -> Float32Array:
    """Return values given at every so many pixels at each pixel of an image of this shape."""
    size = (few.shape[1] * every, few.shape[0] * every)
    return as_float32(cv2.resize(few, size, interpolation=interpolation))[: shape[0], : shape[1]]


def _ground_surface(means: Float32Array, quiet: npt.NDArray[np.intp], rim: BoolArray) -> Float32Array:
    """Return a quadratic surface through the lowest quiet blocks, and as near as those at the rim lie."""
    if quiet.size < _MIN_QUIET:
        # With few ground blocks only a constant can be estimated.
        return np.full_like(means, quantile(means.ravel(), 0.2))
    chosen = rim.copy()
    chosen.flat[quiet] = True
    at_rim = rim[chosen]
    y, x = (
        grid.ravel() for grid in np.meshgrid(*(np.linspace(-1, 1, n) for n in means.shape), indexing="ij")
    )
    whole = quadratic_terms(x, y).T
    terms = whole[:, chosen.ravel()]
    level = means[chosen].astype(np.float64)
    surface = np.array([quantile(level, 0.2), 0, 0, 0, 0, 0])
    for _ in range(_SURFACE_ROUNDS):
        off = level - surface @ terms
        width = max(2 * quantile(np.abs(off[at_rim]), 0.5), 1e-6)
        weighted = terms * (np.where(off > width, 0.1, 1.0) / (1 + (off / width) ** 2))
        surface = np.linalg.solve(weighted @ terms.T + _TINY, weighted @ level)
    return as_float32(surface @ whole).reshape(means.shape)


def quantile(values: FloatArray | Float32Array, share: float) -> float:
    """Return a quantile of some hundred values, without the checks of `np.quantile`."""
    place = share * (values.size - 1)
    low, high = math.floor(place), math.ceil(place)
    ordered = np.partition(values, (low, high))
    return float(ordered[low] + (place - low) * (ordered[high] - ordered[low]))


def _otsu_threshold(values: npt.NDArray[np.floating]) -> float:
    """Return the level that best parts `values` in two classes (Otsu 1979)."""
    low, high = float(values.min()), float(values.max())
    if not high > low:
        return low
    levels = np.rint((values - low) * (255 / (high - low))).astype(np.uint8)
    threshold, _ = cv2.threshold(levels.reshape(1, -1), 0, 255, cv2.THRESH_BINARY | cv2.THRESH_OTSU)
    return low + (float(threshold) + 0.5) * (high - low) / 255
