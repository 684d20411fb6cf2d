"""Draw a measured photograph: the outline's points, the ellipse, its named semi-axes and a scale bar."""

import math
from os import PathLike
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad.exceptions import ImageError
from fingerpad.image._canvas import (
    INK,
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
from fingerpad.image.levels import eight_bit, storable
from fingerpad.image.photograph.result import PhotographFit

# Okabe and Ito's colours, safe for colour-blind readers; red, green, blue.
POINT_COLOUR: Colour = (0, 158, 115)
OUTLIER_COLOUR: Colour = (230, 60, 160)
ELLIPSE_COLOUR: Colour = (240, 200, 20)

_SIDE_PX = 1100
# The report shows the picture about 300 px wide: letters are as large as that needs.
_WIDTH = 3
_LINE_PX, _LETTER_PX = 40, 14
# Before OpenCV 5, its fonts had ASCII only.
_ASCII = str.maketrans({} if int(cv2.__version__.partition(".")[0]) >= 5 else {"±": "+/-", "°": " deg"})
_AXIS_LABELS = {"palmar": "palmar", "distal": "distal", "radial_ulnar": "radial-ulnar"}


def draw_photograph_overlay(
    pixels: npt.ArrayLike, found: PhotographFit, *, label: str | None = None
) -> Canvas:
    """Draw a photograph's measurement over it.

    Green points: the arc that was used. Pink crosses: points left out. Yellow: the fitted ellipse, solid over
    the arc and dashed beyond it, with the semi-axes by name, their lengths and standard uncertainties. The
    picture is scaled to 1100 px, so that lines and letters have one size.

    Parameters
    ----------
    pixels : array_like, (rows, columns) or (rows, columns, 3)
        The photograph that was measured.
    found : PhotographFit
        Its measurement.
    label : str, optional
        Text for the upper left corner, such as ``synthetic``. Latin letters, digits and signs only.

    Returns
    -------
    ndarray of uint8, (rows, columns, 3)
        Red, green, blue.

    Raises
    ------
    ImageError
        If the points measured do not lie in the picture.

    Examples
    --------
    >>> from fingerpad.image import Scale, photograph_from_ellipse
    >>> fit = photograph_from_ellipse("palmar", Scale(0.1), centre=(200, 160), semi_axes=(118, 138))
    >>> draw_photograph_overlay(np.full((400, 320), 128, np.uint8), fit).shape
    (1100, 880, 3)
    """
    values = np.asarray(pixels)
    if values.ndim not in (2, 3) or not values.size:
        raise ImageError(f"pixels must be grey or colour, found shape {values.shape}")
    levels = eight_bit(storable(values))
    colour = levels[..., :3] if levels.ndim == 3 else np.repeat(levels[..., None], 3, axis=2)
    if len(found.points) and (found.points.max(axis=0) > np.array(colour.shape[:2])).any():
        raise ImageError(
            f"pixels must be the photograph that was measured, found {colour.shape[0]} rows and "
            f"{colour.shape[1]} columns, and points beyond them"
        )
    zoom = _SIDE_PX / max(colour.shape[:2])
    size = (round(colour.shape[1] * zoom), round(colour.shape[0] * zoom))
    way = cv2.INTER_AREA if zoom < 1 else cv2.INTER_CUBIC
    canvas = np.ascontiguousarray(cv2.resize(colour, size, interpolation=way), dtype=np.uint8)
    _draw_ellipse(canvas, found, zoom)
    _draw_points(canvas, found, zoom)
    _draw_axes(canvas, found, zoom)
    draw_scale_bar(canvas, found.scale.mm_per_px / zoom, _WIDTH)
    for k, (text, text_colour) in enumerate(_legend(found, label)):
        write_text(canvas, text.translate(_ASCII), (14, _LINE_PX * (k + 1)), _WIDTH, text_colour)
    return canvas


def write_photograph_overlay(
    path: str | PathLike[str], pixels: npt.ArrayLike, found: PhotographFit, *, label: str | None = None
) -> Path:
    """Draw a photograph's overlay and write it as a PNG, JPEG or TIFF file, by its ending.

    Parameters
    ----------
    path : path-like
        The file to write.
    pixels, found, label
        As for `draw_photograph_overlay`.

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
    >>> from fingerpad.image import photograph_from_ellipse
    >>> fit = photograph_from_ellipse("palmar", 0.1, centre=(200, 160), semi_axes=(118, 138))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_photograph_overlay(f"{folder}/palmar.png", np.full((400, 320), 128, np.uint8), fit).name
    'palmar.png'
    """
    return write_canvas(path, draw_photograph_overlay(pixels, found, label=label))


def _draw_ellipse(canvas: Canvas, found: PhotographFit, zoom: float) -> None:
    t = np.linspace(0, 2 * math.pi, 721)
    points = canvas_points(found.ellipse_points(t.size), zoom)
    solid = (t - found.arc[0]) % (2 * math.pi) <= found.arc[1] - found.arc[0]
    drawn = [k for k in range(len(t) - 1) if solid[k] or (k // 8) % 2]
    for colour, margin in ((INK, 2), (ELLIPSE_COLOUR, 0)):
        for k in drawn:
            draw_line(canvas, points[k : k + 2], colour, margin + 1 + int(solid[k]))


def _draw_points(canvas: Canvas, found: PhotographFit, zoom: float) -> None:
    """Draw about sixty of the points used and eighty of those left out."""
    for point in canvas_points(found.points[:: max(1, len(found.points) // 60)], zoom):
        draw_dot(canvas, point, 4, PAPER)
        draw_dot(canvas, point, 3, POINT_COLOUR)
    for point in canvas_points(found.outliers[:: max(1, len(found.outliers) // 80)], zoom):
        for diagonal in ((5, 5), (5, -5)):
            draw_line(canvas, np.stack([point - diagonal, point + diagonal]), OUTLIER_COLOUR, 2)


def _draw_axes(canvas: Canvas, found: PhotographFit, zoom: float) -> None:
    """Draw the semi-axes, then their names over them."""
    middle, *sides = canvas_points(found.handles, zoom)
    ends = np.array(sides)
    for end in ends:
        draw_line(canvas, np.stack([middle, end]), INK, 5)
        draw_line(canvas, np.stack([middle, end]), PAPER, 2)
        draw_dot(canvas, end, 6, INK)
        draw_dot(canvas, end, 4, PAPER)
    draw_dot(canvas, middle, 7, INK)
    draw_dot(canvas, middle, 5, ELLIPSE_COLOUR)
    stds = found.semi_axes_mm_std
    for end, (name, length) in zip(ends, found.semi_axes_mm.items(), strict=True):
        text = f"{_AXIS_LABELS[name]} {length:.2f} ± {stds[name]:.2f} mm".translate(_ASCII)
        x, y = middle + 0.45 * (end - middle)
        level = abs(end[1] - middle[1]) < abs(end[0] - middle[0])
        # Across an upright axis, so that the outline stays free; beside a level one, away from the other.
        below = 44 if ends[:, 1].sum() < 2 * middle[1] else -20
        corner = round(x) - _LETTER_PX * len(text) // 2, round(y) + (below if level else 0)
        write_text(canvas, text, corner, _WIDTH)


def _legend(found: PhotographFit, label: str | None) -> list[tuple[str, Colour]]:
    lines = [(label, INK)] if label else []
    tilt = f"tilt {math.degrees(found.tilt):z.1f}°"
    if len(found.points):
        lines += [
            (f"{found.face} face, arc {found.arc_deg:.0f}°, {tilt}", INK),
            (f"{len(found.points)} points used", POINT_COLOUR),
            (f"{len(found.outliers)} left out ({found.outlier_fraction:.0%})", OUTLIER_COLOUR),
        ]
    else:
        lines.append((f"{found.face} face, ellipse placed manually, {tilt}", INK))
    lines += [(flag.replace("_", " "), (200, 30, 30)) for flag in sorted(found.flags)]
    return lines
