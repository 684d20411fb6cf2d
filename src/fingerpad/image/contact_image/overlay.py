"""Draw a measured imprint: region, ridges, ellipse with its axes, centroid and a scale bar."""

import math
from os import PathLike
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad.exceptions import ImageError
from fingerpad.image._canvas import INK, PAPER, Canvas, Colour, scale_bar_length, write_canvas
from fingerpad.image.contact_image.result import ContactImageResult

# Okabe & Ito's colours, told apart by colour-blind readers too; red, green, blue.
REGION_COLOUR: Colour = (0, 158, 115)
ELLIPSE_COLOUR: Colour = (213, 94, 0)
RIDGE_COLOUR: Colour = (86, 180, 233)

_LEAST_SIDE_PX, _MOST_SIDE_PX = 1000, 8000
_SUBPIXEL_BITS = 4


def draw_overlay(
    pixels: npt.ArrayLike,
    contact_image: ContactImageResult,
    *,
    label: str | None = None,
    ridge_tint: float = 0.45,
) -> Canvas:
    """Draw an imprint's measurement over its picture.

    Green outline: contact region. Orange: equal-area ellipse, its axes and the centroid. Blue tint: ridges.
    Small pictures are enlarged by a whole number, so that lines stay thin beside the ridges; those of more
    than 8000 px on a side are reduced to that.

    Parameters
    ----------
    pixels : array_like, (rows, columns)
        The picture that was measured.
    imprint : ContactImageResult
        Its measurement.
    label : str, optional
        Text for the upper left corner, such as ``synthetic``. Latin letters, digits and signs only.
    ridge_tint : float
        Strength of the ridges' tint, 0 to 1.

    Returns
    -------
    ndarray of uint8, (rows, columns, 3)
        Red, green, blue.

    Raises
    ------
    ImageError
        If the picture is not the one that was measured.
    """
    grey = _eight_bit(pixels)
    if grey.shape != contact_image.region.shape:
        raise ImageError(
            f"pixels must have the measured picture's shape {contact_image.region.shape}, found {grey.shape}"
        )
    longest = max(grey.shape)
    zoom = min(max(1, math.ceil(_LEAST_SIDE_PX / longest)), _MOST_SIDE_PX / longest)
    canvas = _tinted(grey, contact_image, zoom, ridge_tint)
    width = max(2, round(max(canvas.shape) / 600))
    _draw_region(canvas, contact_image, width)
    _draw_ellipse(canvas, contact_image, zoom, width)
    _draw_scale_bar(canvas, _mm_per_px(contact_image) / zoom, width)
    if label:
        _write(canvas, label, (3 * width, 3 * width), width, below=True)
    return canvas


def write_overlay(
    path: str | PathLike[str],
    pixels: npt.ArrayLike,
    contact_image: ContactImageResult,
    *,
    label: str | None = None,
    ridge_tint: float = 0.45,
) -> Path:
    """Draw an overlay (see `draw_overlay`) and write it as a PNG, JPEG or TIFF file, by its ending.

    Raises
    ------
    ImageError
        If the picture is not the one measured, or the file cannot be written.
    """
    return write_canvas(path, draw_overlay(pixels, contact_image, label=label, ridge_tint=ridge_tint))


def _eight_bit(pixels: npt.ArrayLike) -> Canvas:
    values = np.asarray(pixels)
    if values.ndim != 2 or not values.size:
        raise ImageError(f"pixels must be a grey (rows, columns) array, found shape {values.shape}")
    if values.dtype == np.uint8:
        return values
    low, high = float(values.min()), float(values.max())
    return np.rint((values - low) * (255 / max(high - low, 1e-30))).astype(np.uint8)


def _mm_per_px(contact_image: ContactImageResult) -> float:
    return math.sqrt(contact_image.gross_area / np.count_nonzero(contact_image.region))


def _tinted(grey: Canvas, contact_image: ContactImageResult, zoom: float, strength: float) -> Canvas:
    size = (max(1, round(grey.shape[1] * zoom)), max(1, round(grey.shape[0] * zoom)))
    large = cv2.resize(grey, size, interpolation=cv2.INTER_CUBIC if zoom >= 1 else cv2.INTER_AREA)
    share = _resized(contact_image.ridges, size) * np.float32(strength)
    tinted = np.empty((*large.shape, 3), dtype=np.uint8)
    for channel, colour in enumerate(RIDGE_COLOUR):
        level = np.subtract(np.float32(colour), large, dtype=np.float32)
        level *= share
        level += large
        tinted[..., channel] = np.clip(np.rint(level, out=level), 0, 255, out=level)
    return tinted


def _resized(mask: npt.NDArray[np.bool_], size: tuple[int, int]) -> npt.NDArray[np.float32]:
    """Return the share of a mask in each pixel of a picture of this size (columns, rows)."""
    way = cv2.INTER_LINEAR if size[0] >= mask.shape[1] else cv2.INTER_AREA
    reduced = cv2.resize(mask.view(np.uint8) * np.uint8(255), size, interpolation=way)
    return np.asarray(reduced, dtype=np.float32) / np.float32(255)


def _draw_region(canvas: Canvas, contact_image: ContactImageResult, width: int) -> None:
    smooth = _resized(contact_image.region, (canvas.shape[1], canvas.shape[0])) > 0.5
    contours, _ = cv2.findContours(smooth.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    cv2.drawContours(canvas, contours, -1, REGION_COLOUR, width, cv2.LINE_AA)


def _draw_ellipse(canvas: Canvas, contact_image: ContactImageResult, zoom: float, width: int) -> None:
    size = _mm_per_px(contact_image) / zoom
    major, minor = (
        float(contact_image.ellipse.semi_major) / size,
        float(contact_image.ellipse.semi_minor) / size,
    )
    # Pixel centres are whole numbers: enlarging keeps edges in place, not centres.
    row, column = ((place + 0.5) * zoom - 0.5 for place in contact_image.centroid)
    cosine, sine = math.cos(contact_image.orientation), math.sin(contact_image.orientation)
    along, across = np.array([sine, cosine]), np.array([cosine, -sine])
    t = np.linspace(0, 2 * np.pi, 361)[:, None]
    centre = np.array([column, row])
    _polyline(canvas, centre + major * np.cos(t) * along + minor * np.sin(t) * across, ELLIPSE_COLOUR, width)
    for axis in (major * along, minor * across):
        _polyline(canvas, np.stack([centre - axis, centre + axis]), ELLIPSE_COLOUR, max(1, width // 2))
    _dot(canvas, centre, 3 * width, PAPER)
    _dot(canvas, centre, 2 * width, ELLIPSE_COLOUR)


def _polyline(canvas: Canvas, points: npt.NDArray[np.float64], colour: Colour, width: int) -> None:
    fixed = np.rint(points * 2**_SUBPIXEL_BITS).astype(np.int32).reshape(-1, 1, 2)
    cv2.polylines(canvas, [fixed], False, colour, width, cv2.LINE_AA, _SUBPIXEL_BITS)


def _dot(canvas: Canvas, centre: npt.NDArray[np.float64], radius: int, colour: Colour) -> None:
    column, row = (round(float(place) * 2**_SUBPIXEL_BITS) for place in centre)
    cv2.circle(
        canvas, (column, row), radius * 2**_SUBPIXEL_BITS, colour, cv2.FILLED, cv2.LINE_AA, _SUBPIXEL_BITS
    )


def _draw_scale_bar(canvas: Canvas, mm_per_px: float, width: int) -> None:
    """Draw a bar of a round length in the lower right corner."""
    length = scale_bar_length(canvas, mm_per_px)
    pixels = round(length / mm_per_px)
    right, bottom = canvas.shape[1] - 6 * width, canvas.shape[0] - 6 * width
    cv2.rectangle(
        canvas, (right - pixels - width, bottom - 3 * width), (right + width, bottom + width), PAPER, -1
    )
    cv2.rectangle(canvas, (right - pixels, bottom - 2 * width), (right, bottom), INK, cv2.FILLED)
    _write(canvas, f"{length:g} mm", (right - pixels, bottom - 5 * width), width, below=False)


def _write(canvas: Canvas, text: str, corner: tuple[int, int], width: int, *, below: bool) -> None:
    """Write text on a paper patch, below or above `corner` (x, y)."""
    font, size = cv2.FONT_HERSHEY_SIMPLEX, 0.4 * width
    (columns, rows), base = cv2.getTextSize(text, font, size, max(1, width // 2))
    x = max(width, min(corner[0], canvas.shape[1] - columns - 2 * width))
    y = corner[1] + rows + width if below else corner[1] - base
    cv2.rectangle(
        canvas, (x - width, y - rows - width), (x + columns + width, y + base + width), PAPER, cv2.FILLED
    )
    cv2.putText(canvas, text, (x, y), font, size, INK, max(1, width // 2), cv2.LINE_AA)
