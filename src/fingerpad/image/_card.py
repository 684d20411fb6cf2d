"""What part of a picture shows anything, and whether a region reaches its edge."""

import math

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray
from fingerpad.image._region import filled, largest, outline

_LEAST_BORDER = 0.02
# Lossy compression leaves ripples in an even border.
_TOLERANCE = 4 / 255
_LEAST_CONVEXITY = 0.96
# An even ground behind a print also has one level, but a print has no straight sides.
_LEAST_STRAIGHTNESS = 0.7
_LONG_SIDE = 0.2
_WORKING_SIDE = 400


def card_of(pixels: npt.NDArray[np.float32]) -> BoolArray:
    """Return where the picture shows anything: all but the even border that a rotation or a crop has added.

    The border has one level, holds at least three corners, and leaves a convex polygon of long sides.
    """
    # A copy of a few hundred px is fine enough for a border.
    step = max(1, round(max(pixels.shape) / _WORKING_SIDE))
    small = pixels[::step, ::step]
    corners = small[[0, 0, -1, -1], [0, -1, 0, -1]]
    level, width = float(np.median(corners)), _TOLERANCE * float(np.ptp(small))
    even = (np.abs(small - level) <= width).astype(np.uint8)
    if np.count_nonzero(np.abs(corners - level) <= width) >= 3 and even.mean() >= _LEAST_BORDER:
        even = np.asarray(cv2.morphologyEx(even, cv2.MORPH_OPEN, np.ones((5, 5), np.uint8)), dtype=np.uint8)
        _, labels = cv2.connectedComponents(np.pad(even, 1, constant_values=1), connectivity=4)
        card = _smoothed((labels != labels[0, 0])[1:-1, 1:-1])
        if card.any() and card.mean() < 1 - _LEAST_BORDER and _is_polygon(card):
            size = pixels.shape[::-1]
            return cv2.resize(card.astype(np.uint8), size, interpolation=cv2.INTER_NEAREST) > 0
    return np.ones(pixels.shape, dtype=bool)


def _smoothed(card: BoolArray) -> BoolArray:
    """Close grain that runs into the border and drop letters that stick out."""
    pad, disk = 32, cv2.MORPH_ELLIPSE
    mask = np.pad(card.astype(np.uint8), pad)
    grown = cv2.morphologyEx(mask, cv2.MORPH_CLOSE, cv2.getStructuringElement(disk, (15, 15)))
    plain = cv2.morphologyEx(grown, cv2.MORPH_OPEN, cv2.getStructuringElement(disk, (41, 41)))
    return filled(largest(np.asarray(plain[pad:-pad, pad:-pad] > 0)))


def _is_polygon(card: BoolArray) -> bool:
    hull = cv2.convexHull(outline(card).astype(np.float32))
    if np.count_nonzero(card) < _LEAST_CONVEXITY * cv2.contourArea(hull):
        return False
    corners = cv2.approxPolyDP(hull, 2.0, True).reshape(-1, 2)
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1)
    straight = sides[sides > _LONG_SIDE * math.sqrt(card.size)].sum()
    return bool(straight > _LEAST_STRAIGHTNESS * sides.sum())


def touches_edge(region: BoolArray, card: BoolArray, period: float) -> bool:
    """Tell whether a region reaches the frame or an added border, or runs along one close by.

    Scanners leave a blank margin of a few px: ten periods of outline within one of the edge are a cut too.
    """
    on_edge = _outline_near(region, card, frame=2, border=math.ceil(period / 2)) > 2 * period
    return on_edge or _outline_near(region, card, frame=round(period), border=round(period)) > 10 * period


def _outline_near(region: BoolArray, card: BoolArray, *, frame: int, border: int) -> int:
    """Return how many px of a region's outline lie this near to the frame or to an added border."""
    disk = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * border + 1, 2 * border + 1))
    inside = cv2.erode(card.astype(np.uint8), disk, borderType=cv2.BORDER_REPLICATE)
    inside[:frame] = inside[-frame:] = 0
    inside[:, :frame] = inside[:, -frame:] = 0
    inner = cv2.erode(np.pad(region, 1).astype(np.uint8), np.ones((3, 3), np.uint8))[1:-1, 1:-1]
    return int(np.count_nonzero(region & (inner == 0) & (inside == 0)))
