"""Pictures given to measuring functions, as arrays."""

from typing import Any

import numpy as np
import numpy.typing as npt

from fingerpad.exceptions import FingerpadError, ImageError
from fingerpad.image._levels import Pixels, storable


def picture_array(
    value: npt.ArrayLike, name: str, error: type[FingerpadError] = ImageError
) -> npt.NDArray[Any]:
    """Return a picture as an array of any type.

    Raises
    ------
    FingerpadError
        Of the given kind, if it is none, such as rows of different lengths.
    """
    try:
        return np.asarray(value)
    except (TypeError, ValueError, OverflowError) as cause:
        raise error(f"{name} must be an array of grey levels or colours: {cause}") from cause


def picture_levels(value: npt.ArrayLike, name: str, error: type[FingerpadError] = ImageError) -> Pixels:
    """Return a picture's levels as uint8, uint16 or float32, whichever holds them.

    Raises
    ------
    FingerpadError
        Of the given kind, if it is no picture, or holds anything but finite real numbers.
    """
    array = picture_array(value, name, error)
    if array.dtype.kind not in "buif":
        raise error(f"{name} must hold grey levels or colours, found {array.dtype}")
    levels = storable(array.view(np.uint8) if array.dtype == bool else array)
    if not np.isfinite(levels).all():
        raise error(f"{name} holds NaN or infinite values: fill them first")
    return levels
