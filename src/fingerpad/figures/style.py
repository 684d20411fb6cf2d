"""One style for every figure, and files that are reproducible byte for byte."""

import hashlib
import io
import re
from collections.abc import Callable
from functools import wraps
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, ParamSpec, TypeVar

import matplotlib as mpl

from fingerpad.exceptions import FingerpadError
from fingerpad.units import MM_PER_INCH

if TYPE_CHECKING:  # slow to import, and the figures of a report are drawn without
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")

# Of PNG files: a tenth larger than by the usual 6, in half the time.
PNG_LEVEL: Final = 3

# Okabe and Ito's palette, distinguished with any kind of colour vision.
BLACK: Final = "#222222"
GREY: Final = "#7a7a7a"
ORANGE: Final = "#E69F00"
SKY: Final = "#56B4E9"
GREEN: Final = "#009E73"
YELLOW: Final = "#F0E442"
BLUE: Final = "#0072B2"
VERMILLION: Final = "#D55E00"
GRID: Final = "#e4e4e4"
# Of what is drawn, but not pooled.
FADED: Final = 0.4

# Sizes of text, and half the width of the ends of bars, points.
FONT_PT, TICK_PT, LEGEND_PT, CAP_PT = 7.5, 7.0, 6.8, 1.8

_STYLE: Final[Any] = {  # Matplotlib's types want literal keys
    "font.family": "DejaVu Sans",  # shipped with Matplotlib: the same on every machine
    "font.size": FONT_PT,
    "axes.labelsize": FONT_PT,
    "axes.titlesize": FONT_PT,
    "axes.titlelocation": "left",
    "axes.edgecolor": BLACK,
    "axes.labelcolor": BLACK,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "axes.grid": True,
    "grid.color": GRID,
    "grid.linewidth": 0.5,
    "xtick.labelsize": TICK_PT,
    "ytick.labelsize": TICK_PT,
    "xtick.color": BLACK,
    "ytick.color": BLACK,
    "legend.fontsize": LEGEND_PT,
    "legend.frameon": False,
    "legend.handlelength": 1.8,
    "lines.linewidth": 1.2,
    "lines.markersize": 4,
    "errorbar.capsize": CAP_PT,
    "mathtext.fontset": "dejavusans",
    "figure.facecolor": "white",
    "axes.facecolor": "white",
    "savefig.facecolor": "white",
    "savefig.bbox": "standard",
    "svg.fonttype": "none",
    "svg.hashsalt": "fingerpad",
}


def in_style(function: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
    """Let `function` draw in the style of these figures, independent of the caller's settings."""

    @wraps(function)
    def styled(*args: Arguments.args, **kwargs: Arguments.kwargs) -> Result:
        with mpl.rc_context():
            mpl.rcdefaults()
            mpl.rcParams.update(_STYLE)
            return function(*args, **kwargs)

    return styled


def escaped(text: str) -> str:
    """Return text as it stands in XML, also in an attribute."""
    return text.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")


def log_subs(low: float, high: float) -> tuple[float, ...]:
    """Return which numbers of each decade a logarithmic axis names: most data span little more than one."""
    if high < 100 * low:
        return (1.0, 2.0, 5.0) if high > 5 * low else (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0)
    return (1.0,)


@in_style
def new_figure(
    *, width_mm: float = 85.0, height_mm: float = 64.0, rows: int = 1, columns: int = 1
) -> tuple["Figure", list["Axes"]]:
    """Return an empty figure and its axes, without touching any global state."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width_mm / MM_PER_INCH, height_mm / MM_PER_INCH), layout="constrained")
    FigureCanvasAgg(figure)
    return figure, list(figure.subplots(rows, columns, squeeze=False).flat)


@in_style
def figure_svg(figure: "Figure", name: str, *, description: str = "") -> str:
    """Return the figure as an ``<svg>`` element that can stand in an HTML page beside others.

    Text stays text. Ids and styles carry a prefix made from `name` and the drawing, so that drawings in one
    page do not affect each other.
    """
    buffer = io.StringIO()
    nothing = dict.fromkeys(("Date", "Creator", "Format", "Type"))
    figure.savefig(buffer, format="svg", metadata=nothing)
    drawing = buffer.getvalue()
    drawing = drawing[drawing.index("<svg") :]
    digest = hashlib.sha256(f"{name}\0{drawing}".encode()).hexdigest()
    prefix = f"figure-{digest[:12]}"
    drawing = re.sub(r'\bid="([^"]+)"', rf'id="{prefix}-\1"', drawing)
    drawing = re.sub(r'href="#([^"]+)"', rf'href="#{prefix}-\1"', drawing)
    drawing = re.sub(r"url\(#([^)]+)\)", rf"url(#{prefix}-\1)", drawing)
    drawing = re.sub(r'(<style type="text/css">)\*', rf"\1#{prefix} *", drawing)
    label = f' role="img" aria-label="{escaped(description)}"' if description else ""
    return drawing.replace("<svg ", f'<svg id="{prefix}"{label} ', 1)


@in_style
def save_figure(
    figure: "Figure", path: str | PathLike[str], *, description: str = "", dpi: float = 300.0
) -> tuple[Path, Path]:
    """Write `path`.svg and `path`.png, the same bytes for the same drawing.

    Parameters
    ----------
    figure : Figure
        The figure.
    path : path-like
        File name without suffix; its last part also goes into the ids of the SVG.
    description : str
        Alternative text of the SVG.
    dpi : float
        Resolution of the PNG.

    Returns
    -------
    tuple of Path
        The SVG and the PNG.

    Raises
    ------
    FingerpadError
        If a file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> figure, axes = new_figure()
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     [path.name for path in save_figure(figure, f"{folder}/empty", dpi=50)]
    ['empty.svg', 'empty.png']
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    path = Path(path)
    svg, png = (path.with_name(f"{path.name}.{suffix}") for suffix in ("svg", "png"))
    layout = figure.get_layout_engine()
    try:
        if layout is not None:
            # Once for both: left to itself each file takes two layouts, which cost more than to draw it.
            layout.execute(figure)
            figure.set_layout_engine(None)
        packing = {"compress_level": PNG_LEVEL}
        figure.savefig(png, format="png", dpi=dpi, metadata={"Software": None}, pil_kwargs=packing)
        FigureCanvasAgg(figure)  # the one before holds ten megabytes of pixels, until the SVG is drawn
        drawing = figure_svg(figure, path.name, description=description)
        svg.write_text(f'<?xml version="1.0" encoding="utf-8"?>\n{drawing}', encoding="utf-8", newline="\n")
    except OSError as error:
        raise FingerpadError(
            f"{error.filename or path}: cannot be written ({error.strerror}): make room, or choose another"
        ) from error
    finally:
        figure.set_layout_engine(layout)
    return svg, png
