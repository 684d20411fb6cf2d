"""One style for every figure, and files that are reproducible byte for byte."""

import hashlib
import io
import re
from collections.abc import Iterator
from contextlib import contextmanager
from html import escape
from typing import TYPE_CHECKING, Any, Final, Literal

import matplotlib as mpl
from matplotlib import ticker

from fingerpad.units import MM_PER_INCH

if TYPE_CHECKING:  # slow to import, and the figures of a report are drawn without
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fingerpad.figures.marks import Axis

XML: Final = '<?xml version="1.0" encoding="utf-8"?>\n'
# Of files, what would differ from one writing to the next.
_VARYING: Final = {
    "svg": ("Date", "Creator", "Format", "Type"),
    "pdf": ("CreationDate", "Creator", "Producer"),
    "png": ("Software",),
}
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
    "pdf.fonttype": 42,  # fonts that a journal can edit
    "svg.fonttype": "none",
    "svg.hashsalt": "fingerpad",
}


@contextmanager
def in_style() -> Iterator[None]:
    """Draw in the style of these figures, independent of the caller's settings; decorates functions, too."""
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(_STYLE)
        yield


def tick_rule(
    axis: "Axis", low: float, high: float, most: int = 9
) -> tuple[ticker.Locator, ticker.Formatter]:
    """Return what places the ticks of an axis between its ends, `most` of them, and what labels them."""
    if axis.ticks is not None:
        return ticker.FixedLocator(axis.ticks), ticker.FixedFormatter(axis.tick_labels())
    if axis.log:
        # Most data span little more than a decade: one tick in each would be too few.
        subs = (1,) if high >= 100 * low else (1, 2, 5) if high > 5 * low else (1, 1.5, 2, 3, 4, 5, 7)
        return ticker.LogLocator(subs=subs), ticker.StrMethodFormatter("{x:g}")
    numbers = ticker.ScalarFormatter(useOffset=False)
    numbers.set_scientific(False)
    return ticker.MaxNLocator(most, steps=(1, 2, 2.5, 5, 10)), numbers


@in_style()
def new_figure(
    *, width_mm: float = 85.0, height_mm: float = 64.0, rows: int = 1, columns: int = 1
) -> tuple["Figure", list["Axes"]]:
    """Return an empty figure and its axes, without touching any global state."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width_mm / MM_PER_INCH, height_mm / MM_PER_INCH), layout="constrained")
    FigureCanvasAgg(figure)
    return figure, list(figure.subplots(rows, columns, squeeze=False).flat)


@in_style()
def render(figure: "Figure", kind: Literal["svg", "pdf", "png"], **options: Any) -> bytes:
    """Return Matplotlib's figure as a file, the same bytes for the same drawing."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format=kind, metadata=dict.fromkeys(_VARYING[kind]), **options)
    return buffer.getvalue()


def figure_svg(figure: "Figure", name: str, *, description: str = "") -> str:
    """Return the figure as an ``<svg>`` element that can stand in an HTML page beside others.

    Text stays text. Ids and styles carry a prefix made from `name` and the drawing, so that drawings in one
    page do not affect each other.
    """
    drawing = render(figure, "svg").decode()
    drawing = drawing[drawing.index("<svg") :]
    prefix, attributes = svg_attributes(name, drawing, description)
    drawing = re.sub(r'(\bid="|href="#|url\(#)', rf"\1{prefix}-", drawing)
    drawing = re.sub(r'(<style type="text/css">)\*', rf"\1#{prefix} *", drawing)
    return drawing.replace("<svg ", f"<svg {attributes} ", 1)


def svg_attributes(name: str, drawing: str, description: str) -> tuple[str, str]:
    """Return an id that no other drawing in a page has, and the attributes of one that is read aloud."""
    digest = hashlib.sha256(f"{name}\0{drawing}".encode()).hexdigest()
    own = f"figure-{digest[:12]}"
    return own, f'id="{own}"' + (f' role="img" aria-label="{escape(description)}"' if description else "")
