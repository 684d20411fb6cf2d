"""Read a photograph in colour."""

from os import PathLike

import numpy as np
import numpy.typing as npt

from fingerpad.image._levels import eight_bit
from fingerpad.image._memory import MEMORY_LIMIT
from fingerpad.image.read import read_levels


def read_colour_image(
    path: str | PathLike[str], *, memory_limit: int = MEMORY_LIMIT
) -> npt.NDArray[np.uint8]:
    """Read a photograph from a PNG, TIFF, JPEG, BMP or PPM file as red, green, blue of 8 bits.

    Transparency is blended with white, and a camera's rotation tag is obeyed.

    Parameters
    ----------
    path : path-like
        The file.
    memory_limit : int
        The most bytes that reading and measuring may take, as for `read_image`.

    Returns
    -------
    ndarray of uint8, shape (rows, columns, 3)
        Red, green, blue.

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
    levels = eight_bit(read_levels(path, memory_limit)[0])
    return np.repeat(levels[..., None], 3, axis=2) if levels.ndim == 2 else levels
