"""Drawing on overlays: lines, dots, text and a scale bar, all at one line width, and writing the file."""

import math
from os import PathLike
from pathlib import Path
from typing import Final, TypeAlias

import cv2
import numpy as np
import numpy.typing as npt
from PIL import Image

from fingerpad._arrays import FloatArray
from fingerpad.exceptions import ImageError

Colour: TypeAlias = tuple[int, int, int]
Canvas: TypeAlias = npt.NDArray[np.uint8]

INK: Final[Colour] = (20, 20, 20)
PAPER: Final[Colour] = (255, 255, 255)

_SUBPIXEL_BITS: Final = 4
# A third of the time of zlib's default, 6, for files an eighth larger. JPEG and TIFF have no such level.
_PNG_LEVEL: Final = 2


def canvas_points(points: FloatArray, zoom: float) -> FloatArray:
    """Return points (x, y) of a canvas for (row, column) of the image that it enlarges."""
    # Pixel centres are whole numbers: enlarging keeps edges in place, not centres.
    return np.asarray((points[..., ::-1] + 0.5) * zoom - 0.5, dtype=np.float64)


def draw_line(canvas: Canvas, points: FloatArray, colour: Colour, width: int) -> None:
    """Draw straight lines from point to point (x, y)."""
    fixed = np.rint(points * 2**_SUBPIXEL_BITS).astype(np.int32).reshape(-1, 1, 2)
    cv2.polylines(canvas, [fixed], False, colour, width, cv2.LINE_AA, _SUBPIXEL_BITS)


def draw_dot(canvas: Canvas, centre: FloatArray, radius: int, colour: Colour) -> None:
    """Draw a filled circle round a point (x, y)."""
    x, y = np.rint(centre * 2**_SUBPIXEL_BITS).astype(int).tolist()
    cv2.circle(canvas, (x, y), radius * 2**_SUBPIXEL_BITS, colour, cv2.FILLED, cv2.LINE_AA, _SUBPIXEL_BITS)


def write_text(canvas: Canvas, text: str, corner: tuple[int, int], width: int, colour: Colour = INK) -> None:
    """Write text on a pale patch, its lower left corner at (x, y), moved inside the image where needed."""
    font, size, thickness = cv2.FONT_HERSHEY_SIMPLEX, 0.31 * width, max(1, width // 2)
    (columns, rows), base = cv2.getTextSize(text, font, size, thickness)
    margin = 2 * width
    x = max(margin, min(corner[0], canvas.shape[1] - columns - 2 * margin))
    y = max(rows + margin, min(corner[1], canvas.shape[0] - base - margin))
    patch = canvas[max(0, y - rows - margin) : y + base + width, max(0, x - margin) : x + columns + margin]
    patch[:] = np.rint(0.15 * patch + 0.85 * 255).astype(np.uint8)
    cv2.putText(canvas, text, (x, y), font, size, colour, thickness, cv2.LINE_AA)


def draw_scale_bar(canvas: Canvas, mm_per_px: float, width: int) -> None:
    """Draw a bar of a round length, at most a quarter of the image's width, in the lower right corner."""
    limit = canvas.shape[1] * mm_per_px / 4
    decade = 10.0 ** math.floor(math.log10(limit))
    length = max(step * decade for step in (1, 2, 5) if step * decade <= limit)
    pixels = round(length / mm_per_px)
    right, bottom = canvas.shape[1] - 6 * width, canvas.shape[0] - 6 * width
    cv2.rectangle(
        canvas, (right - pixels - width, bottom - 3 * width), (right + width, bottom + width), PAPER, -1
    )
    cv2.rectangle(canvas, (right - pixels, bottom - 2 * width), (right, bottom), INK, cv2.FILLED)
    write_text(canvas, f"{length:g} mm", (right - pixels, bottom - 8 * width), width)


def write_canvas(path: str | PathLike[str], canvas: Canvas) -> Path:
    """Write an overlay as a PNG, JPEG or TIFF file, by its ending."""
    path = Path(path)
    try:
        Image.fromarray(canvas).save(path, compress_level=_PNG_LEVEL)
    except (OSError, ValueError) as error:
        raise ImageError(
            f"{path}: cannot be written ({error}): check the folder and end the name in .png"
        ) from error
    return path
