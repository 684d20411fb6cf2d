"""Grey levels out of decoded arrays: luma of colour at its own depth, brought upright."""

from typing import Any, Final, TypeAlias

import numpy as np
import numpy.typing as npt

from fingerpad.exceptions import ImageError

Pixels: TypeAlias = npt.NDArray[np.uint8] | npt.NDArray[np.uint16] | npt.NDArray[np.float32]

_LUMA: Final = np.array([0.299, 0.587, 0.114], dtype=np.float32)
# How an array is brought upright, by the value of the EXIF and TIFF tag "Orientation".
_UPRIGHT: Final = {
    2: lambda array: array[:, ::-1],
    3: lambda array: array[::-1, ::-1],
    4: lambda array: array[::-1],
    5: lambda array: array.swapaxes(0, 1),
    6: lambda array: array.swapaxes(0, 1)[:, ::-1],
    7: lambda array: array[::-1, ::-1].swapaxes(0, 1),
    8: lambda array: array.swapaxes(0, 1)[::-1],
}


def upright(array: npt.NDArray[Any], orientation: int) -> npt.NDArray[Any]:
    """Turn an array (rows, columns, ...) as its file's orientation tag says."""
    return np.ascontiguousarray(_UPRIGHT[orientation](array)) if orientation in _UPRIGHT else array


def grey_of_array(array: npt.NDArray[Any]) -> Pixels:
    """Return the grey levels of a decoded picture, (rows, columns) or (rows, columns, RGB or RGBA).

    Raises
    ------
    ImageError
        If the array has another shape, or a type that is no picture's.
    """
    if array.ndim == 2 and array.dtype in (np.uint8, np.uint16):
        return array
    if array.ndim == 2 and array.dtype.kind in "fui":
        return array.astype(np.float32)
    if array.ndim == 3 and array.shape[2] in (3, 4) and array.dtype.kind in "fu":
        return _luma(array)
    raise ImageError(
        f"an array of shape {array.shape} and type {array.dtype} is not a picture: save it as grey"
    )


def _luma(array: npt.NDArray[Any]) -> Pixels:
    top = float(np.iinfo(array.dtype).max) if array.dtype.kind == "u" else 1.0
    grey = array[..., :3].astype(np.float32) @ _LUMA
    if array.shape[2] == 4:
        alpha = array[..., 3].astype(np.float32) / top
        grey = alpha * grey + (1 - alpha) * top
    return grey.round().astype(array.dtype) if array.dtype in (np.uint8, np.uint16) else grey
