"""Marks on Matplotlib's axes, and figures as PDF and PNG."""

import base64
import io
from collections.abc import Callable
from functools import wraps
from threading import Lock
from typing import TYPE_CHECKING, Any, Concatenate, Final, Literal, ParamSpec, TypeVar, assert_never

import numpy as np
from matplotlib.ticker import NullLocator
from PIL import Image

from fingerpad.exceptions import FigureError
from fingerpad.figures import marks
from fingerpad.figures.style import FONT_PT, HALO_PT, TICK_PT, in_style, new_figure, tick_rule

if TYPE_CHECKING:  # slow to import, and the figures of a report are drawn without
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Drawn

Arguments = ParamSpec("Arguments")
# What is drawn on; it is returned.
AnyAxes = TypeVar("AnyAxes", "Axes", marks.Panel)

_LOWEST: Final = 2.6  # just over the axes
_LARGEST_PX: Final = 12_000
# Of files, what would differ from one writing to the next.
_VARYING: Final = {"pdf": ("CreationDate", "Creator", "Producer"), "png": ("Software",)}
_DRAWING: Final = Lock()  # Matplotlib's settings are global
_LEGENDS: Final[dict[str, dict[str, Any]]] = {
    "above": {"loc": "lower left", "bbox_to_anchor": (-0.02, 1.0), "borderaxespad": 0.1},
    "inside": {"loc": "upper left"},
    "below": {"loc": "upper center", "bbox_to_anchor": (0.5, 0.0)},
}


def on_axes(
    plot: Callable[Concatenate[marks.Panel, Arguments], None],
) -> Callable[Concatenate[AnyAxes, Arguments], AnyAxes]:
    """Let a function that adds marks to a panel draw on Matplotlib's axes too, and return what it drew on."""

    @wraps(plot)
    def drawn(axes: Any, *args: Arguments.args, **options: Arguments.kwargs) -> Any:
        panel = axes if isinstance(axes, marks.Panel) else marks.Panel()
        plot(panel, *args, **options)
        if not isinstance(axes, marks.Panel):
            draw(panel, axes)
        return axes

    return drawn  # type: ignore[return-value]  # Concatenate knows no names


def render(figure: marks.Figure, kind: Literal["pdf", "png"], dpi: float) -> bytes:
    """Return a figure as a file, the same bytes each time."""
    with _DRAWING, in_style():
        drawn = draw_figure(figure)
        if kind == "png":
            width, height = (round(dpi * float(inches)) for inches in drawn.get_size_inches())
            if max(width, height) > _LARGEST_PX:
                raise FigureError(f"dpi: {max(width, height)} pixels are too many: take fewer dots per inch")
            # Matplotlib cuts off, and may lose one.
            drawn.set_size_inches((width + 0.01) / dpi, (height + 0.01) / dpi)
        buffer = io.BytesIO()
        drawn.savefig(buffer, format=kind, metadata=dict.fromkeys(_VARYING[kind]), dpi=dpi)
        return buffer.getvalue()


@in_style()
def draw_figure(figure: marks.Figure) -> "Drawn":
    """Return Matplotlib's figure of a figure that is kept as data."""
    shape = {name: getattr(figure, name) for name in ("width_mm", "height_mm", "rows", "columns")}
    drawn, every = new_figure(**shape)
    for axes, panel in zip(every, figure.panels, strict=True):
        draw(panel, axes)
        axes.set_xlim(*panel.limits("x"))
        axes.set_ylim(*panel.limits("y"))
        if panel.place is not None:
            axes.set_position(panel.place)
    from matplotlib.text import Text as DrawnText

    factor = figure.font_pt / FONT_PT
    for words in drawn.findobj(DrawnText):
        words.set_fontsize(factor * float(words.get_fontsize()))
    for axes in every:
        axes.tick_params(labelsize=factor * TICK_PT)  # of ticks that are not yet there
    return drawn


@in_style()
def draw(panel: marks.Panel, axes: "Axes") -> None:
    """Draw a panel on Matplotlib's axes, in the style of these figures."""
    axes.set(**{f"{name}scale": "log" for name in "xy" if getattr(panel, name).log})
    for number, mark in enumerate(panel.marks):
        _draw(mark, axes, _LOWEST + number)
    axes.margins(x=panel.x.margin, y=panel.y.margin)
    _set_axis(panel.x, axes, "x")
    _set_axis(panel.y, axes, "y")
    if panel.equal:
        axes.set_aspect("equal")
    if not panel.framed:
        axes.set_axis_off()
    if panel.title:
        axes.set_title(panel.title)
    samples: dict[str, list[Any]] = {}
    for sample, label in zip(*axes.get_legend_handles_labels(), strict=True):
        samples.setdefault(label, []).append(sample)
    if panel.legend and samples:
        handles, columns = map(tuple, samples.values()), panel.legend_columns(len(samples))
        axes.legend(list(handles), list(samples), ncols=columns, **_LEGENDS[panel.legend])


def _set_axis(wanted: marks.Axis, axes: "Axes", name: marks.AxisName) -> None:
    axis = getattr(axes, f"{name}axis")
    if wanted.ticks is not None:
        axis.set_ticks(wanted.ticks)  # which are in view then
    if (wanted.low, wanted.high) != (None, None):
        getattr(axes, f"set_{name}lim")(wanted.low, wanted.high)
    locator, formatter = tick_rule(wanted, *axis.get_view_interval())
    axis.set_major_locator(locator)
    axis.set_major_formatter(formatter)
    axis.set_minor_locator(NullLocator())
    if not wanted.lines:
        axes.grid(visible=False, axis=name)
        axes.tick_params(axis=name, length=0)
    if wanted.label:
        axis.set_label_text(wanted.label)


def _draw(mark: marks.AnyMark, axes: "Axes", order: float) -> None:
    from matplotlib import collections, patheffects

    places = {"": axes.transData, "x": axes.get_yaxis_transform(), "xy": axes.transAxes}
    look: dict[str, Any] = {"alpha": mark.alpha, "zorder": order, "label": mark.label or "_nolegend_"}
    coloured = {**look, "color": mark.colour}
    match mark:
        case marks.Points():
            spots: dict[str, Any] = {"markerfacecolor": mark.face or mark.colour, "markersize": mark.size}
            spots |= {"markeredgecolor": mark.edge or mark.colour, "markeredgewidth": mark.edge_width}
            bars: dict[str, Any] = {"xerr": mark.x_std, "yerr": mark.y_std, "elinewidth": mark.bar_width}
            spots = spots if mark.marker else {}
            axes.errorbar(mark.x, mark.y, **bars, fmt=mark.marker or "none", **spots, **coloured)
        case marks.Line() if mark.face:
            look |= {"facecolor": mark.face, "edgecolor": (mark.colour, mark.alpha), "alpha": None}
            axes.fill(mark.x, mark.y, linewidth=mark.width, **look)
        case marks.Line():
            look = {**coloured, "linewidth": mark.width, "clip_on": mark.clipped, "solid_capstyle": "butt"}
            axes.plot(mark.x, mark.y, mark.dash, **look)
        case marks.Band():
            axes.fill_between(mark.x, mark.low, mark.high, linewidth=0, **coloured)
        case marks.Rule():
            line, span = (axes.axhline, axes.axhspan) if mark.axis == "y" else (axes.axvline, axes.axvspan)
            if mark.to is None:
                line(mark.at, linewidth=mark.width, linestyle=mark.dash, **coloured)
            else:
                span(mark.at, mark.to, linewidth=0, **coloured)
        case marks.Bars():
            axes.barh(mark.place, mark.length, height=mark.height, **coloured)
        case marks.Ellipses():
            shapes = collections.EllipseCollection(
                mark.widths,
                mark.heights,
                mark.angles_deg,
                units="points",
                offsets=np.column_stack([mark.x, mark.y]),
                offset_transform=places[mark.frame],
                **look | {"facecolors": mark.face, "edgecolors": mark.colour, "linewidths": 0.9},
            )
            axes.add_collection(shapes, autolim=False)
            shapes.set_clip_on(False)
        case marks.Text():
            halo = patheffects.withStroke(linewidth=HALO_PT, foreground=mark.halo)
            box = {"facecolor": "white", "edgecolor": "none", "alpha": 0.7, "pad": 1.0}
            tag: dict[str, Any] = {"bbox": box, "style": "italic", "weight": "bold"} if mark.tag else {}
            axes.annotate(
                mark.text,
                (mark.x, mark.y),
                (mark.right, mark.up),
                xycoords=places[mark.frame],
                textcoords="offset points",
                ha=mark.horizontal,
                va=mark.vertical,
                color=mark.colour,
                fontsize=mark.size,
                annotation_clip=False,
                zorder=order,
                path_effects=[halo] if mark.halo else [],
                **tag,
            )
        case marks.Picture():
            with Image.open(io.BytesIO(base64.b64decode(mark.png))) as picture:
                pixels = np.asarray(picture)
            extent = (mark.left, mark.right, mark.bottom, mark.top)
            axes.imshow(pixels, extent=extent, interpolation="bilinear", zorder=order)
        case _:
            assert_never(mark)
