"""Polygons and outlines of masks, by OpenCV; points are (x, y), and pixel centres whole numbers."""

import math
from typing import Final, TypeAlias

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, Float32Array, FloatArray

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


def disk(radius: float) -> UInt8:
    """Return a disk as a kernel."""
    reach = math.floor(radius)
    rows, columns = np.ogrid[-reach : reach + 1, -reach : reach + 1]
    return np.asarray(rows**2 + columns**2 <= radius**2, dtype=np.uint8)


def distance_to(mask: BoolArray) -> Float32Array:
    """Return the distance of each pixel from the nearest set one."""
    if not mask.any():
        return np.full(mask.shape, np.inf, dtype=np.float32)
    distance = cv2.distanceTransform((~mask).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_5)
    return np.asarray(distance, dtype=np.float32)


def largest_piece(mask: BoolArray) -> BoolArray:
    """Return the largest connected piece without its holes."""
    contours, _ = cv2.findContours(mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    canvas = np.zeros(mask.shape, dtype=np.uint8)
    if contours:
        cv2.drawContours(canvas, [max(contours, key=cv2.contourArea)], -1, 1, cv2.FILLED)
    return canvas > 0
