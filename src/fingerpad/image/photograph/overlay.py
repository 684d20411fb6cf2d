"""Draw a measured photograph: the outline's points, the ellipse, its named semi-axes and a scale bar."""

import math
from os import PathLike
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import FloatArray
from fingerpad.exceptions import ImageError
from fingerpad.image._canvas import INK, PAPER, Canvas, Colour, scale_bar_length, write_canvas
from fingerpad.image.photograph.measure import PhotographFit

# Okabe & Ito's colours, told apart by colour-blind readers too; red, green, blue.
POINT_COLOUR: Colour = (0, 158, 115)
OUTLIER_COLOUR: Colour = (230, 60, 160)
ELLIPSE_COLOUR: Colour = (240, 200, 20)

_SIDE_PX = 1100
_BITS = 4
_AXIS_LABELS = {"palmar": "palmar", "distal": "distal", "radial_ulnar": "radial-ulnar"}


def draw_photograph_overlay(
    pixels: npt.ArrayLike, found: PhotographFit, *, label: str | None = None
) -> Canvas:
    """Draw a photograph's measurement over it.

    Green points: the arc that was used. Pink crosses: points left out. Yellow: the fitted ellipse, solid over
    the arc and dashed beyond it, with the semi-axes by name, their lengths and standard uncertainties. The
    picture is brought to 1100 px, so that lines and letters are the same in all.

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
    """
    colour = _eight_bit_colour(np.asarray(pixels))
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
    _draw_scale_bar(canvas, found.scale.mm_per_px / zoom)
    _write_lines(canvas, _legend(found, label))
    return canvas


def write_photograph_overlay(
    path: str | PathLike[str], pixels: npt.ArrayLike, found: PhotographFit, *, label: str | None = None
) -> Path:
    """Draw a photograph's overlay (see `draw_photograph_overlay`) and write it, as its name ends.

    Raises
    ------
    ImageError
        If the picture is not the one measured, or the file cannot be written.
    """
    return write_canvas(path, draw_photograph_overlay(pixels, found, label=label))


def _eight_bit_colour(values: npt.NDArray[Any]) -> Canvas:
    if values.ndim not in (2, 3) or not values.size:
        raise ImageError(f"pixels must be grey or colour, found shape {values.shape}")
    if values.dtype != np.uint8:
        top = (
            float(np.iinfo(values.dtype).max) if values.dtype.kind in "ui" else max(1.0, float(values.max()))
        )
        values = np.clip(np.rint(values * (255 / top)), 0, 255).astype(np.uint8)
    if values.ndim == 2:
        values = np.repeat(values[..., None], 3, axis=2)
    return np.asarray(values[..., :3], dtype=np.uint8)


def _placed(points: FloatArray, zoom: float) -> FloatArray:
    """Return points (x, y) of the canvas for (row, column) of the photograph; pixel centres are whole."""
    return np.asarray((points[..., ::-1] + 0.5) * zoom - 0.5, dtype=np.float64)


def _draw_ellipse(canvas: Canvas, found: PhotographFit, zoom: float) -> None:
    t = np.linspace(0, 2 * math.pi, 721)
    place = _placed(found.ellipse_points(t.size), zoom)
    solid = (t - found.arc[0]) % (2 * math.pi) <= found.arc[1] - found.arc[0]
    for k in range(len(t) - 1):
        if solid[k] or (k // 8) % 2:
            _line(canvas, place[k], place[k + 1], INK, 4 if solid[k] else 3)
    for k in range(len(t) - 1):
        if solid[k] or (k // 8) % 2:
            _line(canvas, place[k], place[k + 1], ELLIPSE_COLOUR, 2 if solid[k] else 1)


def _draw_points(canvas: Canvas, found: PhotographFit, zoom: float) -> None:
    """Draw about sixty points used, and all crosses of those left out."""
    used = _placed(found.points[:: max(1, len(found.points) // 60)], zoom)
    for point in used:
        _dot(canvas, point, 4, PAPER)
        _dot(canvas, point, 3, POINT_COLOUR)
    for x, y in _placed(found.outliers[:: max(1, len(found.outliers) // 80)], zoom):
        for dx, dy in ((5, 5), (5, -5)):
            _line(canvas, np.array([x - dx, y - dy]), np.array([x + dx, y + dy]), OUTLIER_COLOUR, 2)


def _draw_axes(canvas: Canvas, found: PhotographFit, zoom: float) -> None:
    """Draw the semi-axes, then their names, which no line shall cross."""
    middle, *sides = _placed(found.handles, zoom)
    ends = np.array(sides)
    for end in ends:
        _line(canvas, middle, end, INK, 5)
        _line(canvas, middle, end, PAPER, 2)
        _dot(canvas, end, 6, INK)
        _dot(canvas, end, 4, PAPER)
    _dot(canvas, middle, 7, INK)
    _dot(canvas, middle, 5, ELLIPSE_COLOUR)
    stds = found.semi_axes_mm_std
    for end, (name, length) in zip(ends, found.semi_axes_mm.items(), strict=True):
        text = f"{_AXIS_LABELS[name]} {length:.2f} +/- {stds[name]:.2f} mm"
        x, y = middle + 0.55 * (end - middle)
        level = abs(end[1] - middle[1]) < abs(end[0] - middle[0])
        # Beside an upright axis, and below a level one, on the side away from the other.
        below = 30 if ends[:, 1].sum() < 2 * middle[1] else -14
        _write(canvas, text, (round(x) + (-90 if level else 12), round(y) + (below if level else 0)))


def _legend(found: PhotographFit, label: str | None) -> list[tuple[str, Colour]]:
    lines = [(label, INK)] if label else []
    lean = f"lean {math.degrees(found.lean):.1f} deg"
    if len(found.points):
        lines += [
            (f"{found.face} face, arc {found.arc_deg:.0f} deg, {lean}", INK),
            (f"{len(found.points)} points used", POINT_COLOUR),
            (f"{len(found.outliers)} left out ({found.outlier_fraction:.0%})", OUTLIER_COLOUR),
        ]
    else:
        lines.append((f"{found.face} face, ellipse placed by hand, {lean}", INK))
    if found.flags:
        lines.append((", ".join(sorted(found.flags)), (200, 30, 30)))
    return lines


def _write_lines(canvas: Canvas, lines: list[tuple[str, Colour]]) -> None:
    for k, (text, colour) in enumerate(lines):
        _write(canvas, text, (14, 30 + 30 * k), colour)


def _draw_scale_bar(canvas: Canvas, mm_per_px: float) -> None:
    """Draw a bar of a round length in the lower right corner."""
    length = scale_bar_length(canvas, mm_per_px)
    pixels = round(length / mm_per_px)
    right, bottom = canvas.shape[1] - 20, canvas.shape[0] - 20
    cv2.rectangle(canvas, (right - pixels - 3, bottom - 11), (right + 3, bottom + 3), PAPER, cv2.FILLED)
    cv2.rectangle(canvas, (right - pixels, bottom - 8), (right, bottom), INK, cv2.FILLED)
    _write(canvas, f"{length:g} mm", (right - pixels, bottom - 20))


def _line(canvas: Canvas, start: FloatArray, end: FloatArray, colour: Colour, width: int) -> None:
    first, last = (tuple(np.rint(point * 2**_BITS).astype(int).tolist()) for point in (start, end))
    cv2.line(canvas, first, last, colour, width, cv2.LINE_AA, _BITS)


def _dot(canvas: Canvas, centre: FloatArray, radius: int, colour: Colour) -> None:
    x, y = np.rint(centre * 2**_BITS).astype(int).tolist()
    cv2.circle(canvas, (x, y), radius * 2**_BITS, colour, cv2.FILLED, cv2.LINE_AA, _BITS)


def _write(canvas: Canvas, text: str, corner: tuple[int, int], colour: Colour = INK) -> None:
    """Write text on a paper patch, its lower left corner at `corner` (x, y), inside the picture."""
    font, size = cv2.FONT_HERSHEY_SIMPLEX, 0.62
    (columns, rows), base = cv2.getTextSize(text, font, size, 1)
    x = max(4, min(corner[0], canvas.shape[1] - columns - 8))
    y = max(rows + 4, min(corner[1], canvas.shape[0] - base - 4))
    patch = canvas[max(0, y - rows - 5) : y + base + 3, max(0, x - 5) : x + columns + 5]
    patch[:] = np.rint(0.15 * patch + 0.85 * 255).astype(np.uint8)
    cv2.putText(canvas, text, (x, y), font, size, colour, 1, cv2.LINE_AA)
