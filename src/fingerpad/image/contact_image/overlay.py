"""Draw a measured contact image: region, ridges, ellipse with its axes, centroid and a scale bar."""

import math
from os import PathLike
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import as_float_array
from fingerpad.exceptions import ImageError
from fingerpad.image._canvas import (
    PAPER,
    Canvas,
    Colour,
    canvas_points,
    draw_dot,
    draw_line,
    draw_scale_bar,
    write_canvas,
    write_text,
)
from fingerpad.image.contact_image.result import ContactImageResult
from fingerpad.image.ellipse import ImageEllipse
from fingerpad.image.levels import picture_levels

# Okabe and Ito's colours, safe for colour-blind readers; red, green, blue.
REGION_COLOUR: Colour = (0, 158, 115)
ELLIPSE_COLOUR: Colour = (213, 94, 0)
RIDGE_COLOUR: Colour = (86, 180, 233)

_MIN_SIDE_PX, _MAX_SIDE_PX = 1000, 8000


def draw_overlay(
    pixels: npt.ArrayLike,
    contact_image: ContactImageResult,
    *,
    label: str | None = None,
    ridge_tint: float = 0.45,
) -> Canvas:
    """Draw the measurement of a contact image over the image.

    Green: the outline whose inside is the gross area. Orange: equal-area ellipse, its axes and the
    centroid. Blue tint: ridges. Small images are enlarged by a whole number, so that lines stay thin beside
    the ridges; those of more than 8000 px on a side are reduced to that.

    Parameters
    ----------
    pixels : array_like, (rows, columns)
        The picture that was measured.
    contact_image : ContactImageResult
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

    Examples
    --------
    >>> from fingerpad.image import measure_contact_image
    >>> from fingerpad.simulate import render_contact_image
    >>> truth = render_contact_image(semi_major=3.0, semi_minor=2.5, seed=1)
    >>> contact = measure_contact_image(truth.pixels, truth.mm_per_px)
    >>> truth.pixels.shape, draw_overlay(truth.pixels, contact).shape
    ((197, 177), (1182, 1062, 3))
    """
    grey = _stretch_levels(pixels)
    if grey.shape != contact_image.shape:
        raise ImageError(
            f"pixels must have the measured picture's shape {contact_image.shape}, found {grey.shape}"
        )
    longest = max(grey.shape)
    zoom = min(max(1, math.ceil(_MIN_SIDE_PX / longest)), _MAX_SIDE_PX / longest)
    canvas = _tint_ridges(grey, contact_image, zoom, ridge_tint)
    width = max(2, round(max(canvas.shape) / 600))
    outline = canvas_points(contact_image.outline, zoom)
    draw_line(canvas, np.concatenate([outline, outline[:1]]), REGION_COLOUR, width)
    _draw_ellipse(canvas, contact_image, zoom, width)
    draw_scale_bar(canvas, contact_image.mm_per_px / zoom, width)
    if label:
        write_text(canvas, label, (3 * width, 0), width)
    return canvas


def write_overlay(
    path: str | PathLike[str],
    pixels: npt.ArrayLike,
    contact_image: ContactImageResult,
    *,
    label: str | None = None,
    ridge_tint: float = 0.45,
) -> Path:
    """Draw an overlay and write it as a PNG, JPEG or TIFF file, by its ending.

    Parameters
    ----------
    path : path-like
        The file to write.
    pixels, contact_image, label, ridge_tint
        As for `draw_overlay`.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    ImageError
        If the picture is not the one measured, or the file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from fingerpad.image import measure_contact_image
    >>> from fingerpad.simulate import render_contact_image
    >>> truth = render_contact_image(semi_major=3.0, semi_minor=2.5, seed=1)
    >>> contact = measure_contact_image(truth.pixels, truth.mm_per_px)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_overlay(f"{folder}/overlay.png", truth.pixels, contact).name
    'overlay.png'
    """
    return write_canvas(path, draw_overlay(pixels, contact_image, label=label, ridge_tint=ridge_tint))


def _stretch_levels(pixels: npt.ArrayLike) -> Canvas:
    values = picture_levels(pixels, "pixels")
    if values.ndim != 2 or not values.size:
        raise ImageError(f"pixels must be a grey (rows, columns) array, found shape {values.shape}")
    if values.dtype == np.uint8:
        return np.asarray(values, dtype=np.uint8)
    low, high = float(values.min()), float(values.max())
    return np.asarray(np.rint((values - low) * (255 / max(high - low, 1e-30))), dtype=np.uint8)


def _tint_ridges(grey: Canvas, contact_image: ContactImageResult, zoom: float, strength: float) -> Canvas:
    size = (max(1, round(grey.shape[1] * zoom)), max(1, round(grey.shape[0] * zoom)))
    large = cv2.resize(grey, size, interpolation=cv2.INTER_CUBIC if zoom >= 1 else cv2.INTER_AREA)
    ridges = contact_image.ridges.view(np.uint8) * np.uint8(255)
    way = cv2.INTER_LINEAR if zoom >= 1 else cv2.INTER_AREA
    share = np.asarray(cv2.resize(ridges, size, interpolation=way), dtype=np.uint16)
    # Each pair of a share of ridge and a grey level has one colour, four bytes that are looked up at once.
    shares, levels = np.meshgrid(*[np.arange(256, dtype=np.float32)] * 2, indexing="ij")
    colours = np.zeros((256, 256, 4), dtype=np.uint8)
    for channel, colour in enumerate(RIDGE_COLOUR):
        tinted = levels + shares / 255 * np.float32(strength) * (np.float32(colour) - levels)
        colours[..., channel] = np.rint(tinted).clip(0, 255)
    pairs = np.asarray(share * np.uint16(256) + large, dtype=np.uint16)
    found = np.take(colours.view(np.uint32), pairs).view(np.uint8).reshape(*large.shape, 4)
    return np.asarray(cv2.cvtColor(found, cv2.COLOR_RGBA2RGB), dtype=np.uint8)


def _draw_ellipse(canvas: Canvas, contact_image: ContactImageResult, zoom: float, width: int) -> None:
    lengths = contact_image.ellipse.semi_major, contact_image.ellipse.semi_minor
    major, minor = (float(length) / contact_image.mm_per_px for length in lengths)
    centre, orientation = contact_image.centroid, contact_image.orientation
    ellipse = ImageEllipse(centre=centre, semi_axes=(major, minor), orientation=orientation)
    outline = canvas_points(ellipse.points(360), zoom)
    draw_line(canvas, np.concatenate([outline, outline[:1]]), ELLIPSE_COLOUR, width)
    for end in (0, 90):
        draw_line(canvas, outline[[end, end + 180]], ELLIPSE_COLOUR, max(1, width // 2))
    middle = canvas_points(as_float_array(centre), zoom)
    draw_dot(canvas, middle, 3 * width, PAPER)
    draw_dot(canvas, middle, 2 * width, ELLIPSE_COLOUR)
