"""Read a photograph in colour."""

from os import PathLike

import numpy as np
import numpy.typing as npt

from fingerpad.image._levels import Pixels, top_level
from fingerpad.image._memory import MEMORY_LIMIT
from fingerpad.image.read import read_levels

# Rows converted at a time, so that copies in single precision stay small.
_BLOCK_ROWS = 64


def read_colour_image(
    path: str | PathLike[str], *, memory_limit: int = MEMORY_LIMIT
) -> npt.NDArray[np.uint8]:
    """Read a photograph from a PNG, TIFF, JPEG, BMP or PPM file as red, green, blue of 8 bits.

    Transparency is laid on white, and a camera's rotation tag is obeyed.

    Parameters
    ----------
    path, memory_limit
        As for `read_image`.

    Raises
    ------
    ImageError
        If the file is missing, empty, cut short, too large or not a picture.

    Examples
    --------
    >>> read_colour_image("no_such_finger.jpg")
    Traceback (most recent call last):
    fingerpad.exceptions.ImageError: no_such_finger.jpg: no such file or folder: check the path
    """
    levels = _eight_bit(read_levels(path, memory_limit)[0])
    return np.repeat(levels[..., None], 3, axis=2) if levels.ndim == 2 else levels


def _eight_bit(levels: Pixels) -> npt.NDArray[np.uint8]:
    """Return levels of any depth as 8 bits."""
    if levels.dtype == np.uint8:
        return np.asarray(levels, dtype=np.uint8)
    top = top_level(levels) or max(1.0, float(levels.max()))
    eight = np.empty(levels.shape, dtype=np.uint8)
    for start in range(0, len(levels), _BLOCK_ROWS):
        rows = slice(start, start + _BLOCK_ROWS)
        eight[rows] = np.clip(np.rint(levels[rows] * (255 / top)), 0, 255)
    return eight
