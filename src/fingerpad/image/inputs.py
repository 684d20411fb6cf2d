"""Images and scales as arguments of measuring functions."""

from os import PathLike
from typing import TypeAlias

import numpy.typing as npt

from fingerpad.image.colour import read_colour_image
from fingerpad.image.read import Picture, read_image
from fingerpad.image.scale import Scale

# An array, the path of a file, or a picture that was read before. A string is a path.
ImageLike: TypeAlias = npt.ArrayLike | PathLike[str] | Picture
ScaleLike: TypeAlias = Scale | float


def grey_levels(image: ImageLike) -> npt.ArrayLike:
    """Return the grey levels of a picture, read if it is a path.

    Raises
    ------
    ImageError
        If the file cannot be read.
    """
    if isinstance(image, str | PathLike):
        return read_image(image).pixels
    return image.pixels if isinstance(image, Picture) else image


def colour_levels(image: ImageLike) -> npt.ArrayLike:
    """Return the colours of a picture, read if it is a path; a `Picture` is grey.

    Raises
    ------
    ImageError
        If the file cannot be read.
    """
    return read_colour_image(image) if isinstance(image, str | PathLike) else grey_levels(image)


def as_scale(scale: ScaleLike) -> Scale:
    """Return a scale; a number is millimetres per pixel, of no uncertainty.

    Raises
    ------
    CalibrationError
        If the number is no length of a pixel.
    """
    return scale if isinstance(scale, Scale) else Scale(scale)
