"""One style for every figure."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Final, Literal

import matplotlib as mpl
from matplotlib import ticker
from matplotlib.rcsetup import cycler

from fingerpad.units import MM_PER_INCH

if TYPE_CHECKING:  # slow to import, and the figures of a report are drawn without
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fingerpad.figures.marks import Axis

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

# Sizes of text, half the width of the ends of bars, and width of the lines around a halo's letters, points.
FONT_PT, TICK_PT, LEGEND_PT, CAP_PT, HALO_PT = 7.5, 7.0, 6.8, 1.8, 1.6

# Of a logarithmic axis the ticks in each decade by the ratio of its ends, such that there are three or more;
# up to the first ratio they are evenly spaced.
_EVEN_STEPS: Final = 5
_LOG_STEPS: Final = ((20, (1, 2, 3, 5, 7)), (200, (1, 2, 5)), (1000, (1, 3)))

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
    "axes.prop_cycle": cycler(color=[BLUE, ORANGE, GREEN, VERMILLION, SKY]),
    "grid.color": GRID,
    "grid.linewidth": 0.5,
    "xtick.labelsize": TICK_PT,
    "ytick.labelsize": TICK_PT,
    "xtick.color": BLACK,
    "ytick.color": BLACK,
    "legend.fontsize": LEGEND_PT,
    "legend.frameon": False,
    "legend.handlelength": 1.8,
    "legend.labelspacing": 0.25,
    "legend.columnspacing": 1.0,
    "lines.linewidth": 1.2,
    "lines.markersize": 4,
    "errorbar.capsize": CAP_PT,
    "pdf.fonttype": 42,  # fonts that a journal can edit
}


@contextmanager
def in_style() -> Iterator[None]:
    """Draw in the style of these figures, independent of the caller's settings; decorates functions, too."""
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(_STYLE)
        yield


def tick_rule(
    axis: "Axis", low: float, high: float, most: int | Literal["auto"] = "auto"
) -> tuple[ticker.Locator, ticker.Formatter]:
    """Return what places the ticks of an axis between its ends, `most` of them, and what labels them."""
    if axis.ticks is not None:
        names = [f"{tick:g}" for tick in axis.ticks] if axis.names is None else axis.names
        return ticker.FixedLocator(axis.ticks), ticker.FixedFormatter(names)
    if axis.log and high >= _EVEN_STEPS * low:
        subs = next((subs for ratio, subs in _LOG_STEPS if high < ratio * low), (1,))
        return ticker.LogLocator(subs=subs), ticker.StrMethodFormatter("{x:g}")
    numbers = ticker.ScalarFormatter(useOffset=False)
    numbers.set_scientific(False)
    labels = ticker.NullFormatter() if axis.names == () else numbers
    return ticker.MaxNLocator(5 if axis.log else most, steps=(1, 2, 2.5, 5, 10)), labels


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
