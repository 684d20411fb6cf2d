"""The part of an image that is measured: validated grey levels, cropped, and a mask."""

from dataclasses import dataclass
from typing import TypeAlias

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, as_float_array, real_array
from fingerpad.exceptions import ImageError
from fingerpad.image._arguments import picture_array
from fingerpad.image._masks import filled_polygon

Pixels: TypeAlias = npt.NDArray[np.uint8] | npt.NDArray[np.float32]

_MIN_SIDE_PX = 16
# Squares of levels, and 1 over them, stay within single precision.
_MAX_LEVEL, _MIN_RANGE = 1e15, 1e-15
# Corners of a polygon become whole sixteenths of a pixel, of 32 bits.
_FARTHEST_CORNER_PX = 1e6


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CroppedImage:
    """The part of a picture that is measured.

    Attributes
    ----------
    pixels : ndarray of uint8 or float32, (rows, columns)
        Grey levels of the part.
    inside : ndarray of bool, (rows, columns), or None
        Where the part counts; None means everywhere.
    corner : (int, int)
        (row, column) of its first pixel in the whole picture.
    shape : (int, int)
        Of the whole picture.
    """

    pixels: Pixels
    inside: BoolArray | None
    corner: tuple[int, int]
    shape: tuple[int, int]


def crop_image(
    pixels: npt.ArrayLike,
    *,
    background: npt.ArrayLike | None,
    mask: npt.ArrayLike | None,
    region_of_interest: tuple[int, int, int, int] | None,
) -> CroppedImage:
    """Check the picture and what limits it, and crop it; it may be blank.

    Raises
    ------
    ImageError
        If one is not as `measure_contact_image` requires.
    """
    values = _grey(pixels, "pixels")
    shape = (values.shape[0], values.shape[1])
    inside = None if mask is None else _inside(mask, shape)
    box = _box(region_of_interest, shape)
    if inside is not None:
        box = _crop_to_mask(box, inside)
        inside = inside[box]
    part = _finite(values[box], "pixels")
    if background is not None:
        ground = _grey(background, "background")
        if ground.shape != shape:
            raise ImageError(f"background must have the picture's shape {shape}, found {ground.shape}")
        part = _divide_by_background(part, _finite(ground[box], "background"))
    return CroppedImage(pixels=part, inside=inside, corner=(box[0].start, box[1].start), shape=shape)


def check_not_blank(pixels: Pixels) -> None:
    """Refuse a picture of one level.

    Raises
    ------
    ImageError
        If it is blank.
    """
    low, high, _, _ = cv2.minMaxLoc(pixels)
    if not high - low > _MIN_RANGE:
        raise ImageError(f"no contact found: every pixel has the same level, {low:g}")


def _grey(pixels: npt.ArrayLike, name: str) -> npt.NDArray[np.number]:
    array = picture_array(pixels, name)
    if array.ndim != 2 or array.dtype.kind not in "buif":
        raise ImageError(f"{name} must be a grey (rows, columns) array of numbers, found shape {array.shape}")
    if min(array.shape) < _MIN_SIDE_PX:
        raise ImageError(
            f"{name}: {array.shape[0]} × {array.shape[1]} px is too small to hold a contact: "
            f"{_MIN_SIDE_PX} px a side are the least"
        )
    return array


def _finite(values: npt.NDArray[np.number], name: str) -> Pixels:
    if values.dtype == np.uint8:
        return np.ascontiguousarray(values)
    with np.errstate(over="ignore"):
        single = np.ascontiguousarray(values, dtype=np.float32)
    if not np.isfinite(values).all():
        raise ImageError(f"{name} holds NaN or infinite values: fill them before measuring")
    if max(abs(float(single.min())), abs(float(single.max()))) > _MAX_LEVEL:
        raise ImageError(f"{name} holds levels beyond ±{_MAX_LEVEL:g}: divide them by a constant")
    return single


def _divide_by_background(part: Pixels, ground: Pixels) -> npt.NDArray[np.float32]:
    light = ground.astype(np.float32)
    middle = np.float32(np.median(light))
    if not (light > _MIN_RANGE * middle).all() or middle < _MIN_RANGE:
        raise ImageError("background must be positive everywhere, found zero: it cannot divide the picture")
    return np.asarray(part.astype(np.float32) / light * middle, dtype=np.float32)


def _inside(mask: npt.ArrayLike, shape: tuple[int, int]) -> BoolArray:
    """Return where a mask, or a polygon of (row, column) corners, lets the picture count."""
    array = picture_array(mask, "mask")
    if array.shape == shape and array.dtype.kind in "bui":
        inside = array > 0
    elif array.ndim == 2 and array.shape[1] == 2 and len(array) >= 3 and array.dtype.kind in "uif":
        if not (np.abs(array) <= _FARTHEST_CORNER_PX).all():
            raise ImageError(
                f"mask: the corners of the polygon must be finite and within ±{_FARTHEST_CORNER_PX:g} px"
            )
        inside = filled_polygon(as_float_array(array[:, ::-1]), shape) > 0
    else:
        raise ImageError(
            f"mask must be a bool array of the picture's shape {shape}, or a polygon of three or more "
            f"(row, column) corners, found shape {array.shape}"
        )
    if not inside.any():
        raise ImageError("mask leaves nothing of the picture")
    return np.asarray(inside)


def _box(region: tuple[int, int, int, int] | None, shape: tuple[int, int]) -> tuple[slice, slice]:
    if region is None:
        return slice(0, shape[0]), slice(0, shape[1])
    edges = real_array(region, "region_of_interest", ImageError)
    if edges.shape != (4,) or not np.isfinite(edges).all():
        raise ImageError(f"region_of_interest must be (row0, column0, row1, column1), found {region}")
    row0, column0 = (max(0, int(edge)) for edge in edges[:2])
    row1, column1 = (min(n, int(edge)) for n, edge in zip(shape, edges[2:], strict=True))
    if min(row1 - row0, column1 - column0) < _MIN_SIDE_PX:
        raise ImageError(
            f"region_of_interest {region} leaves less than {_MIN_SIDE_PX} px of the picture of {shape}"
        )
    return slice(row0, row1), slice(column0, column1)


def _crop_to_mask(box: tuple[slice, slice], inside: BoolArray) -> tuple[slice, slice]:
    """Crop to what a mask leaves of a box, at least the least side where the picture has room."""
    part = inside[box]
    if not part.any():
        raise ImageError("mask and region_of_interest have nothing in common")
    narrow = []
    for axis, whole in enumerate(box):
        hits = np.flatnonzero(part.any(axis=1 - axis))
        start, stop = whole.start + int(hits[0]), whole.start + int(hits[-1]) + 1
        spare = max(0, _MIN_SIDE_PX - (stop - start))
        start = max(whole.start, start - spare)
        narrow.append(slice(start, min(whole.stop, max(stop, start + _MIN_SIDE_PX))))
    return narrow[0], narrow[1]
