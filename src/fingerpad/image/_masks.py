"""Polygons and outlines of masks, by OpenCV; points are (x, y), and pixel centres whole numbers."""

from typing import Final, TypeAlias

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, FloatArray

UInt8: TypeAlias = npt.NDArray[np.uint8]

BITS: Final = 4


def to_fixed_point(points: FloatArray) -> npt.NDArray[np.int32]:
    """Return points in whole sixteenths of a pixel."""
    return np.asarray(np.rint(points * 2**BITS), dtype=np.int32)


def filled_polygon(points: FloatArray, shape: tuple[int, ...]) -> UInt8:
    """Return a picture with 1 inside a polygon (x, y) and on its border; pixel centres are whole numbers."""
    canvas = np.zeros(shape, dtype=np.uint8)
    cv2.fillPoly(canvas, [to_fixed_point(points)], 1, shift=BITS)
    return canvas


def fill_holes(mask: BoolArray) -> BoolArray:
    """Fill the holes."""
    contours, _ = cv2.findContours(mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    canvas = np.zeros(mask.shape, dtype=np.uint8)
    cv2.drawContours(canvas, contours, -1, 1, cv2.FILLED)
    return canvas > 0


def longest_contour(patch: BoolArray) -> npt.NDArray[np.int32]:
    """Return the pixels (x, y) of the longest outer contour, in order, (n, 1, 2)."""
    contours, _ = cv2.findContours(patch.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    return np.asarray(max(contours, key=len), dtype=np.int32)
