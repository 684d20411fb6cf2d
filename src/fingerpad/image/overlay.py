"""Draw what was measured over contact images and photographs, and write it as a file."""

from __future__ import annotations

import math
from os import PathLike
from pathlib import Path
from typing import Final, TypeAlias

import cv2
import imagecodecs
import numpy as np
import numpy.typing as npt
from PIL import Image

from fingerpad._arrays import FloatArray, as_float_array
from fingerpad.exceptions import ImageError
from fingerpad.image._masks import BITS, to_fixed_point
from fingerpad.image.contact_image.result import ContactImageResult
from fingerpad.image.levels import picture_levels, stretched
from fingerpad.image.photograph.result import PhotographFit
from fingerpad.image.read import ImageLike, in_colour, levels_of

Colour: TypeAlias = tuple[int, int, int]
Canvas: TypeAlias = npt.NDArray[np.uint8]

INK: Final[Colour] = (20, 20, 20)
PAPER: Final[Colour] = (255, 255, 255)

# Level 2 of zlib, and the one filter SUB of PNG in place of the best of five for each row: a fifth of the
# time of level 6, for files a tenth larger.
_PNG_LEVEL: Final = 2
_PNG_FILTER: Final = 16
# Okabe and Ito's colours, safe for colour-blind readers; red, green, blue.
REGION_COLOUR: Colour = (0, 158, 115)
ELLIPSE_COLOUR: Colour = (213, 94, 0)
RIDGE_COLOUR: Colour = (86, 180, 233)
POINT_COLOUR: Colour = (0, 158, 115)
OUTLIER_COLOUR: Colour = (230, 60, 160)
FITTED_COLOUR: Colour = (240, 200, 20)

_MIN_SIDE_PX, _MAX_SIDE_PX = 1000, 8000
_TINT = 0.45  # strength of the ridges' tint, 0 to 1
_SIDE_PX = 1100
_WIDTH = 3  # the report shows the picture about 300 px wide: letters are as large as that needs
_LINE_PX, _LETTER_PX = 40, 14
# Before OpenCV 5, its fonts had ASCII only.
_ASCII = str.maketrans({} if int(cv2.__version__.partition(".")[0]) >= 5 else {"±": "+/-", "°": " deg"})


def draw_overlay(
    image: ImageLike, found: ContactImageResult | PhotographFit, *, label: str | None = None
) -> Canvas:
    """Draw the measurement of a contact image or a photograph over the picture.

    A contact image. Green: the outline whose inside is the gross area. Orange: equal-area ellipse, its axes
    and the centroid. Blue tint: ridges. Small images are enlarged by a whole number; those of more than
    8000 px on a side are reduced to that.

    A photograph, scaled to 1100 px. Green points: the arc that was used. Pink crosses: points left out.
    Yellow: the fitted ellipse, solid over the arc and dashed beyond it, with the semi-axes by name.

    Parameters
    ----------
    image : path-like, Picture, or array_like (rows, columns) or (rows, columns, 3)
        The picture that was measured.
    found : ContactImageResult or PhotographFit
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
        If the picture is not the one that was measured, or `found` is no measurement.

    Examples
    --------
    >>> from fingerpad.image import measure_contact_image
    >>> from fingerpad.simulate import render_contact_image
    >>> truth = render_contact_image(semi_major=3.0, semi_minor=2.5, seed=1)
    >>> contact = measure_contact_image(truth.pixels, truth.mm_per_px)
    >>> truth.pixels.shape, draw_overlay(truth.pixels, contact).shape
    ((197, 177), (1182, 1062, 3))
    """
    if not isinstance(found, ContactImageResult | PhotographFit):
        raise ImageError(f"found must be a ContactImageResult or PhotographFit, found {type(found).__name__}")
    levels = picture_levels(levels_of(image, colour=True), "pixels", colour=True)
    levels = levels[..., :3] if levels.ndim == 3 else levels
    if isinstance(found, PhotographFit):
        return _draw_photograph(in_colour(levels), found, label)
    return _draw_contact_image(stretched(levels), found, label)


def write_overlay(
    path: str | PathLike[str],
    image: ImageLike,
    found: ContactImageResult | PhotographFit,
    *,
    label: str | None = None,
) -> Path:
    """Draw an overlay and write it as a PNG, JPEG or TIFF file, by its ending.

    Parameters
    ----------
    path : path-like
        The file to write.
    image, found, label
        As for `draw_overlay`.

    Returns
    -------
    Path

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
    ...     write_overlay(f"{folder}/palmar.png", np.full((400, 320), 128, np.uint8), fit).name
    'palmar.png'
    """
    path = Path(path)
    canvas = draw_overlay(image, found, label=label)
    try:
        if path.suffix.lower() == ".png":
            path.write_bytes(imagecodecs.png_encode(canvas, level=_PNG_LEVEL, filter=_PNG_FILTER))
        else:
            Image.fromarray(canvas).save(path)
    except (OSError, ValueError) as error:
        raise ImageError(
            f"{path}: cannot be written ({error}): check the folder and end the name in .png"
        ) from error
    return path


def _draw_contact_image(levels: Canvas, found: ContactImageResult, label: str | None) -> Canvas:
    shape = levels.shape[:2]
    if shape != found.shape:
        raise ImageError(f"pixels must have the measured picture's shape {found.shape}, found {shape}")
    zoom = min(max(1, math.ceil(_MIN_SIDE_PX / max(shape))), _MAX_SIDE_PX / max(shape))
    large = _zoomed(levels, zoom)
    canvas = large if large.ndim == 3 else _tint_ridges(large, found, enlarged=zoom >= 1)
    width = max(2, round(max(canvas.shape) / 600))
    outline = canvas_points(found.outline, zoom)
    ellipse = canvas_points(found.ellipse_px.points(360), zoom)
    for curve, colour in ((outline, REGION_COLOUR), (ellipse, ELLIPSE_COLOUR)):
        draw_line(canvas, np.concatenate([curve, curve[:1]]), colour, width)
    for end in (0, 90):
        draw_line(canvas, ellipse[[end, end + 180]], ELLIPSE_COLOUR, max(1, width // 2))
    middle = canvas_points(as_float_array(found.centroid), zoom)
    draw_dot(canvas, middle, 3 * width, PAPER)
    draw_dot(canvas, middle, 2 * width, ELLIPSE_COLOUR)
    draw_scale_bar(canvas, found.mm_per_px / zoom, width)
    if label:
        write_text(canvas, label, (3 * width, 0), width)
    return canvas


def _zoomed(levels: Canvas, zoom: float) -> Canvas:
    """Return a picture enlarged or reduced."""
    size = [max(1, round(side * zoom)) for side in levels.shape[1::-1]]
    way = cv2.INTER_CUBIC if zoom >= 1 else cv2.INTER_AREA
    return np.asarray(cv2.resize(levels, size, interpolation=way), dtype=np.uint8)


def _tint_ridges(large: Canvas, contact_image: ContactImageResult, *, enlarged: bool) -> Canvas:
    ridges = contact_image.ridges.view(np.uint8) * np.uint8(round(255 * _TINT))
    way = cv2.INTER_LINEAR if enlarged else cv2.INTER_AREA
    # One block of memory for all planes: the system gives out large ones at a fraction of the time.
    *channels, share, rest = np.empty((5, *large.shape), dtype=np.uint8)
    cv2.resize(ridges, large.shape[::-1], share, interpolation=way)
    cv2.subtract(large, cv2.multiply(large, share, rest, 1 / 255), rest)
    for channel, colour in zip(channels, RIDGE_COLOUR, strict=True):
        cv2.addWeighted(rest, 1, share, colour / 255, 0, channel)
    return np.asarray(cv2.merge(channels), dtype=np.uint8)


def _draw_photograph(colour: Canvas, found: PhotographFit, label: str | None) -> Canvas:
    rows, columns = colour.shape[:2]
    measured = None if found.picture is None else found.picture.shape[:2]
    if measured not in (None, (rows, columns)) or (found.points > (rows, columns)).any():
        what = "points beyond them" if measured is None else f"measured were {measured[0]} × {measured[1]}"
        raise ImageError(
            f"pixels must be the photograph that was measured, found {rows} × {columns} pixels, {what}"
        )
    zoom = _SIDE_PX / max(rows, columns)
    canvas = _zoomed(colour, zoom)
    _draw_fitted_ellipse(canvas, found, zoom)
    # About sixty of the points used, and eighty of those left out.
    for point in canvas_points(found.points[:: max(1, len(found.points) // 60)], zoom):
        draw_dot(canvas, point, 4, PAPER)
        draw_dot(canvas, point, 3, POINT_COLOUR)
    for point in canvas_points(found.outliers[:: max(1, len(found.outliers) // 80)], zoom):
        for diagonal in ((5, 5), (5, -5)):
            draw_line(canvas, np.stack([point - diagonal, point + diagonal]), OUTLIER_COLOUR, 2)
    _draw_axes(canvas, found, zoom)
    draw_scale_bar(canvas, found.scale.mm_per_px / zoom, _WIDTH)
    for k, (text, text_colour) in enumerate(_legend(found, label)):
        write_text(canvas, text.translate(_ASCII), (14, _LINE_PX * (k + 1)), _WIDTH, text_colour)
    return canvas


def _draw_fitted_ellipse(canvas: Canvas, found: PhotographFit, zoom: float) -> None:
    t = np.linspace(0, 2 * math.pi, 721)
    points = canvas_points(found.ellipse_points(t.size), zoom)
    solid = (t - found.arc[0]) % (2 * math.pi) <= found.arc[1] - found.arc[0]
    drawn = [k for k in range(len(t) - 1) if solid[k] or (k // 8) % 2]
    for colour, margin in ((INK, 2), (FITTED_COLOUR, 0)):
        for k in drawn:
            draw_line(canvas, points[k : k + 2], colour, margin + 1 + int(solid[k]))


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
    draw_dot(canvas, middle, 5, FITTED_COLOUR)
    stds = found.semi_axes_mm_std
    for end, (name, length) in zip(ends, found.semi_axes_mm.items(), strict=True):
        text = f"{name.replace('_', '-')} {length:.2f} ± {stds[name]:.2f} mm".translate(_ASCII)
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
            (f"{len(found.outliers)} left out ({100 * found.outlier_fraction:.0f} %)", OUTLIER_COLOUR),
        ]
    else:
        lines.append((f"{found.face} face, ellipse placed manually, {tilt}", INK))
    lines += [(flag.replace("_", " "), (200, 30, 30)) for flag in sorted(found.flags)]
    return lines


def canvas_points(points: FloatArray, zoom: float) -> FloatArray:
    """Return points (x, y) of a canvas for (row, column) of the image that it enlarges."""
    # Pixel centres are whole numbers: enlarging keeps edges in place, not centres.
    return np.asarray((points[..., ::-1] + 0.5) * zoom - 0.5, dtype=np.float64)


def draw_line(canvas: Canvas, points: FloatArray, colour: Colour, width: int) -> None:
    """Draw straight lines from point to point (x, y)."""
    cv2.polylines(canvas, [to_fixed_point(points)], False, colour, width, cv2.LINE_AA, BITS)


def draw_dot(canvas: Canvas, centre: FloatArray, radius: int, colour: Colour) -> None:
    """Draw a filled circle round a point (x, y)."""
    place = to_fixed_point(centre).tolist()
    cv2.circle(canvas, place, radius * 2**BITS, colour, cv2.FILLED, cv2.LINE_AA, BITS)


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
    # The logarithm of what lies just below a power of ten rounds to the whole number.
    length = max(step * decade for step in (0.5, 1, 2, 5) if step * decade <= limit)
    pixels = round(length / mm_per_px)
    right, bottom = canvas.shape[1] - 6 * width, canvas.shape[0] - 6 * width
    cv2.rectangle(
        canvas, (right - pixels - width, bottom - 3 * width), (right + width, bottom + width), PAPER, -1
    )
    cv2.rectangle(canvas, (right - pixels, bottom - 2 * width), (right, bottom), INK, cv2.FILLED)
    write_text(canvas, f"{length:g} mm", (right - pixels, bottom - 8 * width), width)
