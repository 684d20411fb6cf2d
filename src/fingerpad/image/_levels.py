"""Decoded levels of a picture: turned upright, blended with white, converted to luma at their own depth."""

from typing import Any, Final, TypeAlias

import numpy as np
import numpy.typing as npt
from PIL import Image

from fingerpad.exceptions import ImageError

Pixels: TypeAlias = npt.NDArray[np.uint8] | npt.NDArray[np.uint16] | npt.NDArray[np.float32]

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


def apply_orientation(array: npt.NDArray[Any], orientation: int) -> npt.NDArray[Any]:
    """Turn an array (rows, columns, ...) by its file's orientation tag."""
    return np.ascontiguousarray(_ORIENTATIONS[orientation](array)) if orientation in _ORIENTATIONS else array


def storable(array: npt.NDArray[Any]) -> Pixels:
    """Return levels as uint8, uint16 or float32, whichever holds them.

    Raises
    ------
    ImageError
        If they are not real numbers.
    """
    if array.dtype in (np.uint8, np.uint16):
        return array
    if array.dtype.kind not in "fui":
        raise ImageError(
            f"samples of type {array.dtype} are not a picture's: save it as 8-bit or 16-bit grey"
        )
    with np.errstate(over="ignore"):  # infinite values are refused with those that were so in the file
        return array.astype(np.float32)


def top_level(levels: Pixels) -> float | None:
    """Return the level of white of unsigned levels, None for others."""
    return {np.dtype(np.uint8): 255.0, np.dtype(np.uint16): 65535.0}.get(levels.dtype)


def eight_bit(levels: Pixels) -> npt.NDArray[np.uint8]:
    """Return levels of any depth as 8 bits."""
    if levels.dtype == np.uint8:
        return np.asarray(levels, dtype=np.uint8)
    top = top_level(levels) or max(1.0, float(levels.max()))
    eight = np.empty(levels.shape, dtype=np.uint8)
    for start in range(0, len(levels), _BLOCK_ROWS):
        rows = slice(start, start + _BLOCK_ROWS)
        eight[rows] = np.clip(np.rint(levels[rows] * (255 / top)), 0, 255)
    return eight


def on_white(colour: npt.NDArray[Any], alpha: npt.NDArray[Any], *, premultiplied: bool = False) -> Pixels:
    """Return levels (rows, columns[, 3]) blended with white by their alpha (rows, columns)."""
    levels = storable(colour)
    top = top_level(levels) or 1.0
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
