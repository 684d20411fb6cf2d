"""What every overlay shares: colours, the length of its scale bar, and how it is written."""

import math
from os import PathLike
from pathlib import Path
from typing import Final, TypeAlias

import numpy as np
import numpy.typing as npt
from PIL import Image

from fingerpad.exceptions import ImageError

Colour: TypeAlias = tuple[int, int, int]
Canvas: TypeAlias = npt.NDArray[np.uint8]

INK: Final[Colour] = (20, 20, 20)
PAPER: Final[Colour] = (255, 255, 255)


def scale_bar_length(canvas: Canvas, mm_per_px: float) -> float:
    """Return the longest of the round lengths, mm, that takes at most a quarter of the picture's width."""
    most = canvas.shape[1] * mm_per_px / 4
    decade = 10.0 ** math.floor(math.log10(most))
    return max(step * decade for step in (1, 2, 5) if step * decade <= most)


def write_canvas(path: str | PathLike[str], canvas: Canvas) -> Path:
    """Write an overlay as a PNG, JPEG or TIFF file, by its ending.

    Raises
    ------
    ImageError
        If the file cannot be written.
    """
    path = Path(path)
    try:
        Image.fromarray(canvas).save(path)
    except (OSError, ValueError) as error:
        raise ImageError(
            f"{path}: cannot be written ({error}): check the folder and end the name in .png"
        ) from error
    return path
