"""Read a photograph in colour."""

import warnings
from os import PathLike
from typing import Any

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageOps, UnidentifiedImageError

from fingerpad.image.read import FORMATS, PIXEL_LIMIT, read_image


def read_colour_image(path: str | PathLike[str], *, pixel_limit: int = PIXEL_LIMIT) -> npt.NDArray[np.uint8]:
    """Read a photograph from a PNG, TIFF, JPEG, BMP or PPM file as red, green, blue of 8 bits.

    Transparency is laid on white, and a camera's rotation tag is obeyed.

    Raises
    ------
    ImageError
        If the file is missing, empty, cut short, too large or not a picture.

    Examples
    --------
    >>> read_colour_image("no_such_finger.jpg")
    Traceback (most recent call last):
    fingerpad.exceptions.ImageError: no_such_finger.jpg: no such file: check the path
    """
    # The grey reader has every check of the file, its size and its damage.
    grey = read_image(path, pixel_limit=pixel_limit).pixels
    try:
        with warnings.catch_warnings(), Image.open(path, formats=FORMATS) as image:
            warnings.simplefilter("ignore")
            if image.mode.startswith(("I", "F")):
                return _eight_bit(grey)
            upright = ImageOps.exif_transpose(image).convert("RGBA")
            white = Image.new("RGBA", upright.size, "white")
            return np.asarray(Image.alpha_composite(white, upright).convert("RGB"), dtype=np.uint8)
    except UnidentifiedImageError:
        # Kinds of TIFF that only the grey reader knows.
        return _eight_bit(grey)


def _eight_bit(pixels: npt.NDArray[Any]) -> npt.NDArray[np.uint8]:
    """Return grey of any depth as red, green, blue of 8 bits."""
    top = {"u": float(np.iinfo(pixels.dtype).max) if pixels.dtype.kind == "u" else 0.0}.get(
        pixels.dtype.kind, max(1.0, float(pixels.max()))
    )
    grey = np.clip(np.rint(pixels * (255 / top)), 0, 255).astype(np.uint8)
    return np.repeat(grey[..., None], 3, axis=2)
