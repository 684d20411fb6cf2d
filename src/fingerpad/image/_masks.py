"""Polygons and outlines of masks, by OpenCV; points are (x, y), and pixel centres whole numbers."""

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import Any, Final, TypeAlias

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, Float32Array, FloatArray, real_array
from fingerpad.exceptions import ImageError

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


def outer_contours(mask: BoolArray | UInt8) -> Sequence[npt.NDArray[np.int32]]:
    """Return the pixels (x, y) of the outer contours, in order, (n, 1, 2) each."""
    contours, _ = cv2.findContours(mask.view(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    return contours  # type: ignore[return-value]


def longest_contour(mask: BoolArray) -> npt.NDArray[np.int32]:
    """Return the longest of the outer contours."""
    return max(outer_contours(mask), key=len)


def filled_contours(contours: Sequence[npt.NDArray[np.int32]], shape: tuple[int, ...]) -> BoolArray:
    """Return what lies inside contours or on them."""
    canvas = np.zeros(shape, dtype=np.uint8)
    cv2.drawContours(canvas, contours, -1, 1, cv2.FILLED)
    return canvas.view(bool)


def fill_holes(mask: BoolArray) -> BoolArray:
    """Fill the holes."""
    return filled_contours(outer_contours(mask), mask.shape)


def largest_piece(mask: BoolArray) -> BoolArray:
    """Return the largest connected piece without its holes."""
    contours = sorted(outer_contours(mask), key=cv2.contourArea)
    return filled_contours(contours[-1:], mask.shape)


@lru_cache(maxsize=64)
def disk(radius: float) -> UInt8:
    """Return a disk as a kernel, to read only."""
    reach = math.floor(radius)
    rows, columns = np.ogrid[-reach : reach + 1, -reach : reach + 1]
    return np.asarray(rows**2 + columns**2 <= radius**2, dtype=np.uint8)


def sample(
    image: npt.NDArray[Any], points: FloatArray, interpolation: int = cv2.INTER_LINEAR
) -> npt.NDArray[Any]:
    """Return the levels of an image at points (x, y), (rows, columns, 2)."""
    x, y = (np.ascontiguousarray(points[..., k], dtype=np.float32) for k in (0, 1))
    return cv2.remap(image, x, y, interpolation, borderMode=cv2.BORDER_REPLICATE)


def distance_to(mask: BoolArray) -> Float32Array:
    """Return the distance of each pixel from the nearest set one."""
    if not mask.any():
        return np.full(mask.shape, np.inf, dtype=np.float32)
    distance = cv2.distanceTransform((~mask).view(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_5)
    return np.asarray(distance, dtype=np.float32)


def region_window(region: Sequence[float], shape: tuple[int, int], least: int = 1) -> tuple[slice, slice]:
    """Return a region of interest, first row and column, last ones (excluded), as slices of a picture."""
    edges = real_array(region, "region_of_interest", ImageError)
    if edges.shape != (4,) or not np.isfinite(edges).all():
        raise ImageError(f"region_of_interest must be four numbers, row, column, row, column, found {region}")
    start, stop = (each.clip(0, shape).astype(int) for each in (np.floor(edges[:2]), np.ceil(edges[2:])))
    if (stop - start).min() < least:
        raise ImageError(
            f"region_of_interest {region} is empty or outside the picture of {shape[0]} rows and {shape[1]} "
            f"columns: give first row, first column, last row, last column, {least} px or more each way"
        )
    return slice(int(start[0]), int(stop[0])), slice(int(start[1]), int(stop[1]))


def bounding_box(mask: BoolArray, margin: int) -> tuple[slice, slice]:
    """Return the box round a mask with a margin, inside the picture."""
    x, y, columns, rows = cv2.boundingRect(mask.view(np.uint8))
    return slice(max(0, y - margin), y + rows + margin), slice(max(0, x - margin), x + columns + margin)


def centres_inside(corners: FloatArray, shape: tuple[int, int]) -> BoolArray:
    """Return the pixels whose centre is inside a closed polygon (row, column).

    OpenCV fills every pixel that an outline touches. Here each side flips what lies beyond it in the rows
    that it crosses: what is flipped an odd number of times is inside.
    """
    ends = np.roll(corners, -1, axis=0)
    low, high = np.minimum(corners, ends), np.maximum(corners, ends)
    first, last = (np.ceil(edge[:, 0]).astype(int).clip(0, shape[0]) for edge in (low, high))
    side = np.repeat(np.arange(len(corners)), last - first)
    row = np.arange(side.size) - np.repeat(np.cumsum(last - first) - (last - first), last - first)
    row += first[side]
    start, along = corners[side], ends[side] - corners[side]
    column = start[:, 1] + (row - start[:, 0]) * along[:, 1] / along[:, 0]
    flips = np.zeros((shape[0], shape[1] + 1), dtype=np.uint8)
    np.add.at(flips, (row, np.ceil(column).astype(int).clip(0, shape[1])), 1)
    return np.asarray((np.cumsum(flips, axis=1, dtype=np.uint8) & 1)[:, :-1] > 0)
