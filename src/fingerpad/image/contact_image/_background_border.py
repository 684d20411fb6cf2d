"""The part of an image inside an empty border."""

import math

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray
from fingerpad.image._masks import longest_contour
from fingerpad.image.contact_image._region import distance_to, largest

_MIN_BORDER = 0.02
# Lossy compression leaves ripples in an even border.
_TOLERANCE = 4 / 255
_MIN_CONVEXITY = 0.96
# An even background behind a print also has one level, but a print has no straight sides.
_MIN_STRAIGHTNESS = 0.7
_LONG_SIDE = 0.2
_BLUNTNESS = 0.005
_WORKING_SIDE = 400


def content_mask(
    pixels: npt.NDArray[np.uint8] | npt.NDArray[np.float32], shape: tuple[int, int]
) -> BoolArray:
    """Return where the picture shows anything: all but the even border that a rotation or a crop has added.

    The border has one level, holds at least three corners, and leaves a convex polygon of long sides.
    The answer has the given shape.
    """
    # A copy of a few hundred px is fine enough for a border.
    step = max(1, round(max(pixels.shape) / _WORKING_SIDE))
    small = pixels[::step, ::step].astype(np.float32)
    corners = small[[0, 0, -1, -1], [0, -1, 0, -1]].astype(np.float32)
    low, high, _, _ = cv2.minMaxLoc(small)
    level, width = float(np.median(corners)), _TOLERANCE * (high - low)
    if np.count_nonzero(np.abs(corners - level) <= width) >= 3:
        even = cv2.inRange(small, level - width, level + width)
        # Noise that comes near one level here and there leaves no even piece.
        even = cv2.morphologyEx(even, cv2.MORPH_OPEN, np.ones((5, 5), np.uint8))
        if cv2.countNonZero(even) < _MIN_BORDER * even.size:
            return np.ones(shape, dtype=bool)
        _, labels = cv2.connectedComponents(np.pad(even, 1, constant_values=1), connectivity=4)
        card = _smooth_mask((labels != labels[0, 0])[1:-1, 1:-1])
        if card.any() and card.mean() < 1 - _MIN_BORDER and _is_polygon(card):
            return cv2.resize(card.astype(np.uint8), shape[::-1], interpolation=cv2.INTER_NEAREST) > 0
    return np.ones(shape, dtype=bool)


def _smooth_mask(card: BoolArray) -> BoolArray:
    """Close grain that runs into the border and drop letters that stick out."""
    pad = 32
    mask = np.pad(card, pad)
    # In a small picture a print must not be rounded into a polygon.
    scale = min(1.0, max(card.shape) / _WORKING_SIDE)
    grain, letter = 7 * scale, 20 * scale
    grown = distance_to(~(distance_to(mask) <= grain)) > grain
    plain = distance_to(distance_to(~grown) > letter) <= letter
    return largest(np.asarray(plain[pad:-pad, pad:-pad]))


def _is_polygon(card: BoolArray) -> bool:
    hull = cv2.convexHull(longest_contour(card))
    if np.count_nonzero(card) < _MIN_CONVEXITY * cv2.contourArea(hull):
        return False
    # As a share of the picture: a print in a small one must not be straightened into a polygon.
    corners = cv2.approxPolyDP(hull, _BLUNTNESS * max(card.shape), True).reshape(-1, 2)
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1)
    straight = sides[sides > _LONG_SIDE * math.sqrt(card.size)].sum()
    return bool(straight > _MIN_STRAIGHTNESS * sides.sum())
