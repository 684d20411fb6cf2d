"""One style for every figure, and files that are reproducible byte for byte."""

import base64
import hashlib
import io
import re
from collections.abc import Callable, Sequence
from functools import wraps
from os import PathLike
from pathlib import Path
from typing import Any, Final, ParamSpec, TypeVar

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import EllipseCollection
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator
from PIL import Image

from fingerpad._arrays import ArrayLike, BoolArray, FloatArray, as_float_array, broadcast
from fingerpad.exceptions import FingerpadError
from fingerpad.figures.panels import Panel
from fingerpad.figures.svg_text import escaped
from fingerpad.units import MM_PER_INCH

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

# Labelled in each decade: most data span little more than one.
LOG_SUBS: Final = (1.0, 2.0, 5.0)

_STYLE: Final[Any] = {  # Matplotlib's types want literal keys
    "font.family": "DejaVu Sans",  # shipped with Matplotlib: the same on every machine
    "font.size": 7.5,
    "axes.labelsize": 7.5,
    "axes.titlesize": 7.5,
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
    "xtick.labelsize": 7,
    "ytick.labelsize": 7,
    "xtick.color": BLACK,
    "ytick.color": BLACK,
    "legend.fontsize": 6.8,
    "legend.frameon": False,
    "legend.handlelength": 1.8,
    "lines.linewidth": 1.2,
    "lines.markersize": 4,
    "errorbar.capsize": 1.8,
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
        if args and isinstance(args[0], Panel):  # has no settings
            return function(*args, **kwargs)
        with mpl.rc_context():
            mpl.rcdefaults()
            mpl.rcParams.update(_STYLE)
            return function(*args, **kwargs)

    return styled


@in_style
def new_figure(
    *, width_mm: float = 85.0, height_mm: float = 64.0, rows: int = 1, columns: int = 1
) -> tuple[Figure, list[Axes]]:
    """Return an empty figure and its axes, without touching any global state.

    Parameters
    ----------
    width_mm, height_mm : float
        Size on paper; 85 mm is one column of a journal.
    rows, columns : int
        Number of axes.

    Returns
    -------
    figure : Figure
        The figure.
    axes : list of Axes
        Row by row.

    Examples
    --------
    >>> figure, axes = new_figure(rows=2, columns=2)
    >>> len(axes), (figure.get_size_inches() * 25.4).round(1).tolist()
    (4, [85.0, 64.0])
    """
    return empty_figure(width_mm, height_mm, rows, columns)


def empty_figure(width_mm: float, height_mm: float, rows: int, columns: int) -> tuple[Figure, list[Axes]]:
    """Return an empty figure and its axes, in the style that is set."""
    figure = Figure(figsize=(width_mm / MM_PER_INCH, height_mm / MM_PER_INCH), layout="constrained")
    FigureCanvasAgg(figure)
    return figure, list(figure.subplots(rows, columns, squeeze=False).flat)


@in_style
def figure_svg(figure: Figure, name: str, *, description: str = "") -> str:
    """Return the figure as an ``<svg>`` element that can stand in an HTML page beside others.

    Text stays text. Ids and styles carry a prefix made from `name` and the drawing, so that drawings in one
    page do not affect each other.

    Parameters
    ----------
    figure : Figure
        The figure.
    name : str
        Distinguishes this figure from others that look the same.
    description : str
        Alternative text.

    Returns
    -------
    str
        The element.

    Examples
    --------
    >>> figure, axes = new_figure()
    >>> figure_svg(figure, "empty").startswith("<svg ")
    True
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
    figure: Figure, path: str | PathLike[str], *, description: str = "", dpi: float = 300.0
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


def pair(point: ArrayLike) -> tuple[float, float]:
    """Return a point of the plane as Matplotlib's text wants it."""
    x, y = as_float_array(point)
    return float(x), float(y)


def mark_synthetic(axes: Axes | Panel, synthetic: ArrayLike) -> None:
    """Write "synthetic", if anything is, into the lower right corner, where a growing curve leaves room."""
    if not np.any(synthetic):
        return
    axes.annotate(
        "synthetic",
        (0.99, 0.02),
        xycoords="axes fraction",
        ha="right",
        va="bottom",
        zorder=10,
        bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.7, "pad": 1.0},
        color=VERMILLION,
        style="italic",
        weight="bold",
        gid="synthetic",
    )


def draw_points(
    axes: Axes | Panel,
    x: ArrayLike,
    y: ArrayLike,
    *,
    x_std: ArrayLike | None = None,
    y_std: ArrayLike | None = None,
    synthetic: ArrayLike = False,
    left_out: ArrayLike = False,
    colour: str = BLUE,
    label: str = "measured",
) -> None:
    """Draw points with error bars of one standard uncertainty, synthetic ones hollow, left-out ones faded."""
    x, y, flags, out = (array.ravel() for array in broadcast(x, y, synthetic, left_out))
    hollow, faded = flags != 0, out != 0
    crowded = x.size > 80
    for mask, face, kind, alpha in (
        (~hollow & ~faded, colour, "", None),
        (hollow & ~faded, "white", " (synthetic)", None),
        (~hollow & faded, colour, ", left out", FADED),
        (hollow & faded, "white", ", left out (synthetic)", FADED),
    ):
        if mask.any():
            axes.errorbar(
                x[mask],
                y[mask],
                xerr=_selected(x_std, mask),
                yerr=_selected(y_std, mask),
                fmt="o",
                color=colour,
                markerfacecolor=face,
                markersize=1.8 if crowded else 4.2,
                markeredgewidth=0.5 if crowded else 0.9,
                elinewidth=0.8,
                label=f"{label}{kind}",
                alpha=alpha,
                zorder=3,
            )


def _selected(std: ArrayLike | None, mask: BoolArray) -> FloatArray | None:
    if std is None:
        return None
    return broadcast(as_float_array(std).ravel() if as_float_array(std).ndim else std, mask)[0][mask]


def legend_above(axes: Axes | Panel, *, columns: int | None = None) -> None:
    """Put the legend over the frame, where no data can be; by default in two columns from four entries on."""
    if isinstance(axes, Panel):
        axes.record("legend_above", columns=columns)
        return
    count = len(axes.get_legend_handles_labels()[0])
    if count:
        axes.legend(
            loc="lower left",
            bbox_to_anchor=(-0.02, 1.0),
            borderaxespad=0.1,
            labelspacing=0.25,
            columnspacing=1.0,
            ncols=columns or (1 if count <= 3 else 2),
        )


def plain_log_ticks(axes: Axes | Panel, names: str) -> None:
    """Label 1, 2, 5 of each decade of the axes named, ``"x"``, ``"y"`` or ``"xy"``, with plain numbers."""
    if isinstance(axes, Panel):
        axes.record("plain_log_ticks", names)
        return
    for name in names:
        axis = {"x": axes.xaxis, "y": axes.yaxis}[name]
        axis.set_major_locator(LogLocator(subs=LOG_SUBS))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_locator(NullLocator())


def draw_shapes(
    axes: Axes | Panel,
    x: ArrayLike,
    y: ArrayLike,
    *,
    widths: ArrayLike,
    heights: ArrayLike,
    angles_deg: ArrayLike,
    edge: str,
    face: str,
    beside: bool,
) -> None:
    """Draw ellipses of sizes on paper, points; `beside` takes x in fractions of the frame."""
    options = {"widths": widths, "heights": heights, "angles_deg": angles_deg}
    if isinstance(axes, Panel):
        axes.record("draw_shapes", x, y, **options, edge=edge, face=face, beside=beside)
        return
    shapes = EllipseCollection(
        as_float_array(widths),
        as_float_array(heights),
        as_float_array(angles_deg),
        units="points",
        offsets=np.column_stack([x, y]),
        offset_transform=axes.get_yaxis_transform() if beside else axes.transData,
        facecolors=face,
        edgecolors=edge,
        linewidths=0.9,
        clip_on=False,
        zorder=4,
    )
    axes.add_collection(shapes, autolim=False)


def draw_picture(axes: Axes | Panel, png: str, extent: Sequence[float]) -> None:
    """Draw a PNG file, given in base64, from left to right and from bottom to top of an extent."""
    if isinstance(axes, Panel):
        axes.record("draw_picture", png, extent)
        return
    with Image.open(io.BytesIO(base64.b64decode(png))) as picture:
        pixels = np.asarray(picture)
    left, right, bottom, top = extent
    axes.imshow(pixels, extent=(left, right, bottom, top), interpolation="bilinear", zorder=1)
