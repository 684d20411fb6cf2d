"""Figures for publication: width, fonts, axes and colours of one's choice, as SVG, PDF, PNG and CSV."""

import csv
import io
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from threading import Lock
from typing import Any, Final, Literal, TypeAlias, get_args

import matplotlib as mpl
import numpy as np
from matplotlib import figure as mpl_figure
from matplotlib.colors import is_color_like, to_hex
from matplotlib.text import Text

from fingerpad.exceptions import FigureError
from fingerpad.figures import style
from fingerpad.figures.marks import (
    AnyMark,
    Axis,
    Band,
    Bars,
    Ellipses,
    Figure,
    Line,
    Numbers,
    Panel,
    Points,
    Rule,
)
from fingerpad.figures.mpl import draw
from fingerpad.figures.svg import svg
from fingerpad.figures.svg_text import runs

Format: TypeAlias = Literal["svg", "pdf", "png", "csv"]
Scale: TypeAlias = Literal["linear", "log"]
# Either end of an axis, None where it follows the data.
Range: TypeAlias = tuple[float | None, float | None]

FORMATS: Final[tuple[Format, ...]] = get_args(Format)
CSV_COLUMNS: Final = ("panel", "x_name", "y_name", "series", "x", "y", "x_std", "y_std", "y_low", "y_high")

_SIZE_MM, _FONT_PT, _DPI = (20.0, 500.0), (3.0, 30.0), (50.0, 1200.0)
_LARGEST_PX: Final = 12_000
# Of text, axes and paper: not of data.
_NEUTRAL: Final = frozenset({style.BLACK, "white", "none", ""})
_DRAWING: Final = Lock()  # Matplotlib's settings are global


@dataclass(frozen=True, slots=True, kw_only=True)
class FigureSettings:
    """How a figure is drawn for publication; what is None stays as in the report."""

    width_mm: float | None = None
    height_mm: float | None = None
    font_pt: float | None = None
    x_range: Range = (None, None)
    y_range: Range = (None, None)
    x_scale: Scale | None = None
    y_scale: Scale | None = None
    colours: tuple[str, ...] = ()
    dpi: float = 300.0

    def __post_init__(self) -> None:
        _require("width_mm", self.width_mm, _SIZE_MM, "a figure is {} to {} mm wide and high")
        _require("height_mm", self.height_mm, _SIZE_MM, "a figure is {} to {} mm wide and high")
        _require("font_pt", self.font_pt, _FONT_PT, "labels have {} to {} points")
        _require("dpi", self.dpi, _DPI, "a PNG has {} to {} dots per inch")
        for name, (low, high), scale in (
            ("x_range", self.x_range, self.x_scale),
            ("y_range", self.y_range, self.y_scale),
        ):
            if scale not in {None, "linear", "log"}:
                raise FigureError(
                    f"{name.replace('range', 'scale')}: an axis is linear or log, found {scale!r}"
                )
            ends = [end for end in (low, high) if end is not None]
            if not all(map(math.isfinite, ends)) or (len(ends) == 2 and not ends[0] < ends[1]):
                raise FigureError(
                    f"{name}: an axis goes from a smaller to a larger number, "
                    f"found {ends[0]:g} to {ends[-1]:g}"
                )
            if scale == "log" and any(end <= 0 for end in ends):
                raise FigureError(f"{name}: a logarithmic axis has no zero, found {min(ends):g}")
        for colour in self.colours:
            if not is_color_like(colour):
                raise FigureError(f"colours: give names or #rrggbb, found {colour!r}")


def figure_file(figure: Figure, kind: Format, settings: FigureSettings) -> bytes:
    """Return a figure as a file: SVG, PDF or PNG, or the data behind it as CSV; the same bytes each time.

    The CSV has all data, whatever the axes show.
    """
    if kind == "csv":
        return figure_csv(figure).encode()
    wanted = with_settings(figure, settings)
    if kind == "svg":
        return f'<?xml version="1.0" encoding="utf-8"?>\n{svg(wanted, "figure")}'.encode()
    with _DRAWING:
        return _drawn(wanted, kind, settings.dpi)


@style.in_style
def _drawn(figure: Figure, kind: Format, dpi: float) -> bytes:
    drawn, buffer = draw_figure(figure), io.BytesIO()
    if kind == "pdf":
        mpl.rcParams["pdf.fonttype"] = 42  # fonts that a journal can edit
        nothing = dict.fromkeys(("CreationDate", "Creator", "Producer"))
        drawn.savefig(buffer, format="pdf", metadata=nothing)
        return buffer.getvalue()
    pixels = [round(dpi * float(inches)) for inches in drawn.get_size_inches()]
    if max(pixels) > _LARGEST_PX:
        raise FigureError(f"dpi: {max(pixels)} pixels are too many: take fewer dots per inch")
    # Matplotlib cuts off, and may lose one.
    across, down = ((count + 0.01) / dpi for count in pixels)
    drawn.set_size_inches(across, down)
    drawn.savefig(buffer, format="png", dpi=dpi, metadata={"Software": None})
    return buffer.getvalue()


def draw_figure(figure: Figure) -> mpl_figure.Figure:
    """Return Matplotlib's figure of a figure that is kept as data."""
    shape = {name: getattr(figure, name) for name in ("width_mm", "height_mm", "rows", "columns")}
    drawn, every = style.new_figure(**shape)
    for axes, panel in zip(every, figure.panels, strict=True):
        draw(panel, axes)
        axes.set_xlim(*panel.limits("x"))
        axes.set_ylim(*panel.limits("y"))
    factor = figure.font_pt / style.FONT_PT
    for text in drawn.findobj(Text):
        text.set_fontsize(factor * float(text.get_fontsize()))
    for axes in every:
        axes.tick_params(labelsize=factor * style.TICK_PT)  # of ticks that are not yet there
    return drawn


def with_settings(figure: Figure, settings: FigureSettings) -> Figure:
    """Return a figure as the settings want it."""
    colours = dict(zip(figure_colours(figure), map(to_hex, settings.colours), strict=False))
    width = settings.width_mm or figure.width_mm
    for name in "xy":
        _require_one_axis(figure, name, settings)
    return replace(
        figure,
        width_mm=width,
        height_mm=settings.height_mm or figure.height_mm * width / figure.width_mm,
        font_pt=settings.font_pt or figure.font_pt,
        panels=[
            replace(
                panel,
                marks=[_recoloured(mark, colours) for mark in panel.marks],
                x=_set_axis(panel, "x", settings.x_range, settings.x_scale),
                y=_set_axis(panel, "y", settings.y_range, settings.y_scale),
            )
            for panel in figure.panels
        ],
    )


def _recoloured(mark: AnyMark, colours: Mapping[str, str]) -> AnyMark:
    old = {} if getattr(mark, "tag", False) else _colours(mark)
    new: dict[str, Any] = {name: colours[colour] for name, colour in old.items() if colour in colours}
    return replace(mark, **new)


def _colours(mark: AnyMark) -> dict[str, str]:
    return {name: getattr(mark, name) for name in ("colour", "face", "edge") if hasattr(mark, name)}


def _set_axis(panel: Panel, name: Literal["x", "y"], ends: Range, scale: Scale | None) -> Axis:
    """Return an axis with the scale and the ends that are given; what is left out stays."""
    axis: Axis = getattr(panel, name)
    if scale is not None:
        kept = [
            end if end is not None and (scale == "linear" or end > 0) else None
            for end in (axis.low, axis.high)
        ]
        axis = replace(axis, low=kept[0], high=kept[1], log=scale == "log")
    old = panel.limits(name, axis)
    low, high = ends
    axis = replace(axis, low=axis.low if low is None else low, high=axis.high if high is None else high)
    new = panel.limits(name, axis)
    if None in ends and (new[0] < new[1]) != (old[0] < old[1]):
        raise FigureError(
            f"{name}_range: the axis would end at {min(new):g} and begin at {max(new):g}: give both ends"
        )
    return axis


def figure_colours(figure: Figure) -> list[str]:
    """Return the colours of the data of a figure, in the order in which they are drawn."""
    data = Points | Line | Band | Bars | Ellipses
    marks = (mark for panel in figure.panels for mark in panel.marks if isinstance(mark, data))
    found = dict.fromkeys(colour for mark in marks for colour in _colours(mark).values())
    return [colour for colour in found if colour not in _NEUTRAL]


def figure_csv(figure: Figure) -> str:
    """Return the data behind a figure as CSV: a line for each point, with its panel and series."""
    file = io.StringIO()
    table = csv.DictWriter(file, CSV_COLUMNS, restval="", lineterminator="\n")
    table.writeheader()
    for number, panel in enumerate(figure.panels, start=1):
        names = {f"{axis}_name": plain_text(getattr(panel, axis).label) for axis in "xy"}
        for mark in panel.marks:
            series, columns = _data(mark)
            line = {"panel": number, **names, "series": plain_text(mark.label or series).lstrip("_")}
            for row in zip(*(column.tolist() for column in columns.values()), strict=True):
                known = {
                    name: value for name, value in zip(columns, row, strict=True) if not math.isnan(value)
                }
                if known:
                    table.writerow(line | known)
    return file.getvalue()


def _data(mark: AnyMark) -> tuple[str, dict[str, Numbers]]:
    """Return the usual name of a mark's data, and their columns."""
    match mark:
        case Points():
            stds = {"x_std": mark.x_std, "y_std": mark.y_std}
            return "", {
                "x": mark.x,
                "y": mark.y,
                **{name: std for name, std in stds.items() if std is not None},
            }
        case Line():
            return "line", {"x": mark.x, "y": mark.y}
        case Band():
            return "band", {"x": mark.x, "y_low": mark.low, "y_high": mark.high}
        case Bars():
            return "", {"x": mark.length, "y": mark.place}
        case Rule() if mark.to is None:
            return "level", {mark.axis: np.array([mark.at])}
        case _:
            return "", {}


def plain_text(text: str) -> str:
    r"""Return a label without the signs of formulas."""
    return " ".join("".join(run.text for run in runs(line)) for line in text.split("\n"))


def _require_one_axis(figure: Figure, axis: str, settings: FigureSettings) -> None:
    """Raise if an axis is to be set in panels that show different quantities on it."""
    low_high, scale = getattr(settings, f"{axis}_range"), getattr(settings, f"{axis}_scale")
    labels = {getattr(panel, axis).label for panel in figure.panels}
    if (scale or low_high != (None, None)) and len(labels) > 1:
        raise FigureError(
            f"{axis}_range, {axis}_scale: the panels of this figure show {len(labels)} quantities on this "
            "axis: leave both as they are"
        )


def _require(name: str, value: float | None, limits: Range, words: str) -> None:
    low, high = limits
    if value is not None and not low <= value <= high:  # type: ignore[operator]
        raise FigureError(f"{name}: {words.format(f'{low:g}', f'{high:g}')}, found {value:g}")
