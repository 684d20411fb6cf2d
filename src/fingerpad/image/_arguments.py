"""Pictures given to measuring functions, as arrays."""

from typing import Any

import numpy as np
import numpy.typing as npt

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
