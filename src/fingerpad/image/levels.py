"""Levels of a picture: their memory, as arguments, upright, on white, as luma, as light, and their ground."""

from os import PathLike
from typing import Any, Final, TypeAlias

import cv2
import numpy as np
import numpy.typing as npt
from PIL import Image

from fingerpad._arrays import FloatArray
from fingerpad.exceptions import FingerpadError, ImageError

Pixels: TypeAlias = npt.NDArray[np.uint8] | npt.NDArray[np.uint16] | npt.NDArray[np.float32]

MEMORY_LIMIT: Final = 2_000_000_000
# Six copies in single precision are more than measuring holds at a time.
_MEASURING_BYTES: Final = 24
# ITU-R BT.601, as in JPEG.
LUMA: Final = np.array([0.299, 0.587, 0.114], dtype=np.float32)
# Rows converted at a time, so that copies in single precision stay small.
_BLOCK_ROWS: Final = 64
# How an array is brought upright, by the value of the EXIF and TIFF tag "Orientation".
_ORIENTATIONS: Final = {
    2: lambda array: array[:, ::-1],
    3: lambda array: array[::-1, ::-1],
    4: lambda array: array[::-1],
    5: lambda array: array.swapaxes(0, 1),
    6: lambda array: array.swapaxes(0, 1)[:, ::-1],
    7: lambda array: array[::-1, ::-1].swapaxes(0, 1),
    8: lambda array: array.swapaxes(0, 1)[::-1],
}


def check_memory(
    path: str | PathLike[str], size: tuple[int, int], memory_limit: int, *, channels: int, sample_bytes: int
) -> None:
    """Refuse a picture of (columns, rows) that is too large by its header."""
    columns, rows = size
    if not (columns > 0 and rows > 0):
        raise ImageError(f"{path}: has {columns} × {rows} pixels, the file is damaged: copy it again")
    # Two copies as decoded, and those for measuring.
    needed = columns * rows * (2 * channels * sample_bytes + _MEASURING_BYTES)
    if needed > memory_limit:
        raise ImageError(
            f"{path}: {columns} × {rows} pixels of {channels} × {8 * sample_bytes} bits take "
            f"{needed / 1e9:.2g} GB to read and measure, more than the limit of {memory_limit / 1e9:.2g} GB: "
            "crop or shrink the picture, or raise memory_limit (bytes)"
        )


def picture_array(
    value: npt.ArrayLike, name: str, error: type[FingerpadError] = ImageError
) -> npt.NDArray[Any]:
    """Return a picture as an array of any type."""
    try:
        return np.asarray(value)
    except (TypeError, ValueError, OverflowError) as cause:
        raise error(f"{name} must be an array of grey levels or colours: {cause}") from cause


def checked_picture(
    value: npt.ArrayLike, name: str, error: type[FingerpadError] = ImageError, *, colour: bool = False
) -> npt.NDArray[Any]:
    """Return a grey picture, or with `colour` either kind, as an array of any real type."""
    array = picture_array(value, name, error)
    if not array.size or not (array.ndim == 2 or (colour and array.ndim == 3 and array.shape[2] in {3, 4})):
        way_out = ""
        if array.ndim == 3 and not colour:
            of_colours = "of a colour picture give the file, one channel, or the mean, pixels.mean(axis=-1)"
            way_out = f": {of_colours if array.shape[-1] in {3, 4} else 'one picture at a time'}"
        wanted = "grey (rows, columns)" + colour * " or colour (rows, columns, 3)"
        raise error(f"{name} must be {wanted}, found shape {array.shape}{way_out}")
    if array.dtype.kind not in "buif":
        raise error(f"{name} must hold grey levels or colours, found {array.dtype}: read it as either")
    return array


def picture_levels(
    value: npt.ArrayLike, name: str, error: type[FingerpadError] = ImageError, *, colour: bool = False
) -> Pixels:
    """Return a grey picture's levels, or with `colour` either kind's, as uint8, uint16 or float32."""
    array = checked_picture(value, name, error, colour=colour)
    levels = storable(array.view(np.uint8) if array.dtype == bool else array)
    check_finite(levels, name, error)
    return levels


def check_finite(levels: npt.NDArray[Any], name: object, error: type[FingerpadError] = ImageError) -> None:
    """Refuse levels that are NaN or infinite."""
    if levels.dtype.kind == "f" and not np.isfinite(levels).all():
        bad = np.count_nonzero(~np.isfinite(levels))
        raise error(f"{name}: {bad} levels are NaN or infinite: fill them before measuring")


def apply_orientation(array: npt.NDArray[Any], orientation: int) -> npt.NDArray[Any]:
    """Turn an array (rows, columns, ...) by its file's orientation tag."""
    return np.ascontiguousarray(_ORIENTATIONS[orientation](array)) if orientation in _ORIENTATIONS else array


def storable(array: npt.NDArray[Any]) -> Pixels:
    """Return levels as uint8, uint16 or float32, whichever holds them."""
    if array.dtype in (np.uint8, np.uint16):
        return array
    if array.dtype.kind not in "fui":
        raise ImageError(
            f"samples of type {array.dtype} are not a picture's: save it as 8-bit or 16-bit grey"
        )
    with np.errstate(over="ignore"):  # infinite values are refused with those that were so in the file
        return array.astype(np.float32)


def top_level(levels: npt.NDArray[Any]) -> float:
    """Return the level of white: the top of a type of integers, of others the largest level or 1."""
    return float(np.iinfo(levels.dtype).max if levels.dtype.kind in "ui" else max(1.0, levels.max()))


def eight_bit(levels: Pixels) -> npt.NDArray[np.uint8]:
    """Return levels of any depth as 8 bits."""
    if levels.dtype == np.uint8:
        return np.asarray(levels, dtype=np.uint8)
    # In one pass and without copies in single precision; `cv2.multiply` would scale the first channel alone.
    scaled = cv2.addWeighted(levels, 255 / top_level(levels), levels, 0, 0, dtype=cv2.CV_8U)
    return np.asarray(scaled, dtype=np.uint8)


def stretched(levels: Pixels) -> npt.NDArray[np.uint8]:
    """Return levels in 8 bits; deeper ones from the darkest, as black, to the brightest, as white."""
    if levels.dtype == np.uint8:
        return np.asarray(levels, dtype=np.uint8)
    low, high = float(levels.min()), float(levels.max())
    return np.asarray(np.rint((levels - low) * (255 / max(high - low, 1e-30))), dtype=np.uint8)


def reduced(pixels: npt.NDArray[Any], longest_px: int) -> npt.NDArray[Any]:
    """Return a picture of at most `longest_px` on its longer side."""
    zoom = longest_px / max(pixels.shape[:2])
    if zoom >= 1:
        return pixels
    size = [max(2, round(side * zoom)) for side in pixels.shape[1::-1]]
    return np.asarray(cv2.resize(pixels, size, interpolation=cv2.INTER_AREA))


def on_white(colour: npt.NDArray[Any], alpha: npt.NDArray[Any], *, premultiplied: bool = False) -> Pixels:
    """Return levels (rows, columns[, 3]) blended with white by their alpha (rows, columns)."""
    levels = storable(colour)
    top = top_level(levels) if levels.dtype.kind == "u" else 1.0
    laid = np.empty_like(levels)
    for start in range(0, len(levels), _BLOCK_ROWS):
        rows = slice(start, start + _BLOCK_ROWS)
        share = alpha[rows].astype(np.float32) / np.float32(top)
        share = share.reshape(share.shape + (1,) * (levels.ndim - 2))
        part = levels[rows].astype(np.float32)
        part = (part if premultiplied else share * part) + (1 - share) * np.float32(top)
        laid[rows] = part if levels.dtype == np.float32 else np.clip(part.round(), 0, top)
    return laid


def luma(levels: Pixels) -> Pixels:
    """Return the grey (rows, columns) of levels (rows, columns[, 3]): ITU-R BT.601."""
    if levels.ndim == 2:
        return levels
    grey: Pixels = np.empty(levels.shape[:2], levels.dtype)
    for start in range(0, len(levels), _BLOCK_ROWS):
        part = levels[start : start + _BLOCK_ROWS].astype(np.float32) @ LUMA
        grey[start : start + _BLOCK_ROWS] = part if levels.dtype == np.float32 else part.round()
    return grey


def levels_of_image(image: Image.Image) -> Pixels:
    """Return the levels of a Pillow image of any mode."""
    if image.mode == "F":
        return np.asarray(image, dtype=np.float32)
    if image.mode.startswith("I"):
        levels = np.asarray(image)
        deep = levels.min() < 0 or levels.max() > np.iinfo(np.uint16).max
        return levels.astype(np.float32) if deep else levels.astype(np.uint16)
    if image.has_transparency_data:
        image = image.convert("RGBA")
        image = Image.alpha_composite(Image.new("RGBA", image.size, "white"), image)
    return np.asarray(image.convert("L" if image.mode in {"1", "L"} else "RGB"), dtype=np.uint8)


def quadratic_terms(x: FloatArray, y: FloatArray) -> FloatArray:
    """Return the terms of a surface of second degree at places, (n, 6)."""
    return np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=-1)


def quadratic_surface(factors: FloatArray, shape: tuple[int, ...]) -> FloatArray:
    """Return a surface of second degree over a picture, in which rows and columns run from -1 to 1."""
    y, x = np.linspace(-1, 1, shape[0])[:, None], np.linspace(-1, 1, shape[1])
    a, b, c, d, e, f = factors
    return np.asarray((a + b * x + d * x**2) + (c + e * x) * y + f * y**2)


def linear_light(pixels: npt.NDArray[Any]) -> npt.NDArray[np.float32]:
    """Return the light that sRGB levels stand for, 1 at the top of the type's range.

    A blurred edge lies where half the light is, not half the level.
    """
    if pixels.dtype.kind in "ui" and (top := np.iinfo(pixels.dtype).max) <= 0xFFFF:
        return np.asarray(_decode(np.arange(top + 1) / top)[np.maximum(pixels, 0)], dtype=np.float32)
    return _decode(shares_of_top(pixels))


def shares_of_top(pixels: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return levels as shares of the top of their type, those of floating point of the largest, or of 1."""
    return np.asarray(np.maximum(pixels, 0) / top_level(pixels))


def srgb_levels(light: npt.NDArray[Any]) -> npt.NDArray[np.float32]:
    """Return the sRGB levels of light, 0 to 255, not rounded."""
    light = np.clip(light, 0, 1)
    level = np.where(light <= 0.0031308, 12.92 * light, 1.055 * np.maximum(light, 1e-9) ** (1 / 2.4) - 0.055)
    return np.asarray(255 * level, dtype=np.float32)


def _decode(level: npt.NDArray[Any]) -> npt.NDArray[np.float32]:
    light = np.where(level <= 0.04045, level / 12.92, ((level + 0.055) / 1.055) ** 2.4)
    return np.asarray(light, dtype=np.float32)
