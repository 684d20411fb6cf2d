"""Arguments of measuring functions as arrays, or an error that names them."""

from typing import Any

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import FloatArray, as_float_array
from fingerpad.exceptions import ImageError


def picture_array(value: npt.ArrayLike, name: str) -> npt.NDArray[Any]:
    """Return a picture as an array of any type.

    Raises
    ------
    ImageError
        If it is none, such as rows of different lengths.
    """
    try:
        return np.asarray(value)
    except (TypeError, ValueError, OverflowError) as error:
        raise ImageError(f"{name} must be an array of grey levels or colours: {error}") from error


def number_array(value: Any, name: str) -> FloatArray:
    """Return numbers as an array of doubles, None as NaN.

    Raises
    ------
    ImageError
        If they are not real numbers.
    """
    try:
        array = as_float_array(value)
    except (TypeError, ValueError, OverflowError) as error:
        raise ImageError(f"{name} must be numbers, found {value!r:.100}") from error
    if np.iscomplexobj(array):
        raise ImageError(f"{name} must be real numbers, found {value!r:.100}")
    return array
