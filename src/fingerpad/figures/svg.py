"""SVG of figures that are kept as data, in the style of `fingerpad.figures.style`, some fifty times as fast.

Lengths are points, 1/72 inch, from the upper left corner.
"""

import hashlib
from os import PathLike
from pathlib import Path
from typing import Final

import numpy as np

from fingerpad.exceptions import FingerpadError
from fingerpad.figures.panels import PanelFigure
from fingerpad.figures.svg_panel import PanelDrawing
from fingerpad.figures.svg_text import FONT_FAMILY, escaped
from fingerpad.units import MM_PER_INCH

_POINTS_PER_MM: Final = 72 / MM_PER_INCH
_EDGE: Final = 3.0  # free of anything beside and between panels


def panels_svg(figure: PanelFigure, name: str, *, description: str = "") -> str:
    """Return a figure as an ``<svg>`` element that can stand in an HTML page beside others.

    Parameters
    ----------
    figure : PanelFigure
        The figure.
    name : str
        Distinguishes this figure from others that look the same.
    description : str
        Alternative text.

    Returns
    -------
    str
        The element, the same bytes for the same figure.

    Examples
    --------
    >>> from fingerpad.figures import plot_uncertainty_budget
    >>> from fingerpad.figures.panels import new_panels
    >>> figure, (panel,) = new_panels()
    >>> _ = plot_uncertainty_budget(panel, {"load": 0.1, "scale": 0.9})
    >>> panels_svg(figure, "budget").count("<rect") > 2
    True
    """
    width, height = _POINTS_PER_MM * figure.width_mm, _POINTS_PER_MM * figure.height_mm
    drawings = [PanelDrawing(panel, f"@clip{number}") for number, panel in enumerate(figure.panels)]
    _place(drawings, figure, width, height)
    body = "".join(element for drawing in drawings for element in drawing.elements())
    digest = hashlib.sha256(f"{name}\0{body}".encode()).hexdigest()
    prefix = f"figure-{digest[:12]}"
    label = f' role="img" aria-label="{escaped(description)}"' if description else ""
    return (
        f'<svg id="{prefix}"{label} xmlns="http://www.w3.org/2000/svg" width="{width:.2f}pt" '
        f'height="{height:.2f}pt" viewBox="0 0 {width:.2f} {height:.2f}" font-family="{FONT_FAMILY}">'
        f'<rect width="100%" height="100%" fill="#fff"/>{body.replace("@clip", f"{prefix}-")}</svg>\n'
    )


def save_panels(
    figure: PanelFigure, path: str | PathLike[str], *, description: str = ""
) -> tuple[Path, Path]:
    """Write `path`.svg, and `path`.json to draw it from again; the same bytes for the same figure.

    Parameters
    ----------
    figure : PanelFigure
        The figure.
    path : path-like
        File name without suffix; its last part also goes into the ids of the SVG.
    description : str
        Alternative text of the SVG.

    Returns
    -------
    tuple of Path
        The SVG and the JSON.

    Raises
    ------
    FingerpadError
        If a file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from fingerpad.figures.panels import new_panels
    >>> figure, panels = new_panels()
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     [path.name for path in save_panels(figure, f"{folder}/empty")]
    ['empty.svg', 'empty.json']
    """
    path = Path(path)
    svg, data = (path.with_name(f"{path.name}.{suffix}") for suffix in ("svg", "json"))
    drawing = panels_svg(figure, path.name, description=description)
    try:
        svg.write_text(f'<?xml version="1.0" encoding="utf-8"?>\n{drawing}', encoding="utf-8", newline="\n")
        data.write_text(f"{figure.to_json()}\n", encoding="utf-8", newline="\n")
    except OSError as error:
        raise FingerpadError(
            f"{error.filename or path}: cannot be written ({error.strerror}): make room, or choose another"
        ) from error
    return svg, data


def _place(drawings: list[PanelDrawing], figure: PanelFigure, width: float, height: float) -> None:
    """Give all panels frames of one size, such that all that stands outside of the frames has room."""
    shape = figure.rows, figure.columns
    margins = np.zeros((*shape, 4))
    for _ in range(2):  # what stands beside a frame moves with it
        left, right = margins[..., 0].max(axis=0), margins[..., 1].max(axis=0)
        top, bottom = margins[..., 2].max(axis=1), margins[..., 3].max(axis=1)
        size = (width - (left + right).sum()) / shape[1], (height - (top + bottom).sum()) / shape[0]
        size = max(size[0], 0.1 * width / shape[1]), max(size[1], 0.1 * height / shape[0])
        x = np.cumsum(left + np.append(0.0, right[:-1] + size[0]))
        y = np.cumsum(top + np.append(0.0, bottom[:-1] + size[1]))
        for place, drawing in zip(np.ndindex(shape), drawings, strict=True):
            drawing.place(float(x[place[1]]), float(y[place[0]]), *size)
            margins[place] = np.add(drawing.margins(), _EDGE)
