"""Figures for publication: width, fonts, axes and colours of one's choice, as SVG, PDF, PNG and CSV."""

import csv
import io
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from threading import Lock
from typing import Any, Final, Literal, TypeAlias, get_args

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import is_color_like, to_hex
from matplotlib.figure import Figure

from fingerpad.exceptions import FigureError
from fingerpad.figures import style
from fingerpad.figures.panels import Call, Panel, PanelFigure, numbers
from fingerpad.figures.svg_text import runs

Format: TypeAlias = Literal["svg", "pdf", "png", "csv"]
Scale: TypeAlias = Literal["linear", "log"]
# Either end of an axis, None where it follows the data.
Range: TypeAlias = tuple[float | None, float | None]

FORMATS: Final[tuple[Format, ...]] = get_args(Format)
CSV_COLUMNS: Final = ("panel", "x_name", "y_name", "series", "x", "y", "x_std", "y_std", "y_low", "y_high")

_BASE_PT: Final = 7.5
_SIZE_MM, _FONT_PT, _DPI = (20.0, 500.0), (3.0, 30.0), (50.0, 1200.0)
_LARGEST_PX: Final = 12_000
_FONT_KEYS: Final = (
    "font.size",
    "axes.labelsize",
    "axes.titlesize",
    "xtick.labelsize",
    "ytick.labelsize",
    "legend.fontsize",
)
_COLOUR_KEYS: Final = ("color", "markerfacecolor", "markeredgecolor", "edge", "face")
# Of text, axes and paper: not of data.
_NEUTRAL: Final = frozenset({style.BLACK, "white", "none"})
_HELPERS: Final = {one.__name__: one for one in (style.legend_above, style.draw_shapes, style.draw_picture)}
_WITH_ARRAYS: Final = frozenset({"plot", "errorbar", "fill_between", "barh", "draw_shapes"})
_SERIES: Final = {"axhline": "level", "axvline": "level", "fill_between": "band", "plot": "line"}
_DRAWING: Final = Lock()  # Matplotlib's settings are global


@dataclass(frozen=True, slots=True, kw_only=True)
class FigureSettings:
    """How a figure is drawn for publication; what is None stays as in the report.

    Attributes
    ----------
    width_mm, height_mm : float or None
        Size on paper. Without a height the figure keeps its proportions.
    font_pt : float or None
        Size of labels; that of ticks and legends follows.
    x_range, y_range : (float or None, float or None)
        Ends of the axes.
    x_scale, y_scale : {"linear", "log"} or None
        Scales of the axes.
    colours : tuple of str
        Colours of the data, in the order in which they are drawn, each a name or ``#rrggbb``.
    dpi : float
        Resolution of PNG.

    Raises
    ------
    FigureError
        If a value cannot be used.

    Examples
    --------
    >>> FigureSettings(width_mm=90, x_range=(0, 2)).x_range
    (0, 2)
    >>> FigureSettings(width_mm=9)
    Traceback (most recent call last):
    fingerpad.exceptions.FigureError: width_mm: a figure is 20 to 500 mm wide and high, found 9
    """

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


def figure_file(figure: PanelFigure, kind: Format, settings: FigureSettings) -> bytes:
    """Return a figure as a file: SVG, PDF or PNG, or the data behind it as CSV; the same bytes each time.

    Parameters
    ----------
    figure : PanelFigure
        As the report keeps it, ``figures/NAME.json``.
    kind : {"svg", "pdf", "png", "csv"}
        Format of the file.
    settings : FigureSettings
        How to draw it. The CSV has all data, whatever the axes show.

    Raises
    ------
    FigureError
        If it cannot be drawn so.

    Examples
    --------
    >>> from fingerpad.figures import new_panels, plot_layer_effect
    >>> figure, (panel,) = new_panels()
    >>> _ = plot_layer_effect(panel, [4, 8], modulus_ratio=[0.5, 0.7], radius_ratio=[2.0, 1.5], marked=())
    >>> figure_file(figure, "pdf", FigureSettings(width_mm=90))[:5]
    b'%PDF-'
    """
    if kind == "csv":
        return figure_csv(figure).encode()
    with _DRAWING:
        return _file(figure, kind, settings)


@style.in_style
def _file(figure: PanelFigure, kind: Format, settings: FigureSettings) -> bytes:
    factor = (settings.font_pt or _BASE_PT) / _BASE_PT
    mpl.rcParams.update({key: factor * mpl.rcParams[key] for key in _FONT_KEYS})
    mpl.rcParams["pdf.fonttype"] = 42  # fonts that a journal can edit
    drawn = draw_figure(figure, settings)
    if kind == "svg":
        return f'<?xml version="1.0" encoding="utf-8"?>\n{style.figure_svg(drawn, "figure")}'.encode()
    buffer = io.BytesIO()
    if kind == "pdf":
        nothing = dict.fromkeys(("CreationDate", "Creator", "Producer"))
        drawn.savefig(buffer, format="pdf", metadata=nothing)
        return buffer.getvalue()
    pixels = [round(settings.dpi * float(inches)) for inches in drawn.get_size_inches()]
    if max(pixels) > _LARGEST_PX:
        raise FigureError(f"dpi: {max(pixels)} pixels are too many: take fewer dots per inch")
    across, down = (
        (count + 0.01) / settings.dpi for count in pixels
    )  # Matplotlib cuts off, and may lose one
    drawn.set_size_inches(across, down)
    drawn.savefig(buffer, format="png", dpi=settings.dpi, metadata={"Software": None})
    return buffer.getvalue()


def draw_figure(figure: PanelFigure, settings: FigureSettings) -> Figure:
    """Return Matplotlib's figure of a figure that is kept as data, drawn as the settings say."""
    for axis in "xy":
        _require_one_axis(figure, axis, settings)
    width = settings.width_mm or figure.width_mm
    height = settings.height_mm or figure.height_mm * width / figure.width_mm
    drawn, every = style.empty_figure(width, height, figure.rows, figure.columns)
    colours = dict(zip(figure_colours(figure), map(to_hex, settings.colours), strict=False))
    for axes, panel in zip(every, figure.panels, strict=True):
        _draw_panel(axes, panel, settings, colours)
    return drawn


def _draw_panel(axes: Axes, panel: Panel, settings: FigureSettings, colours: Mapping[str, str]) -> None:
    factor = (settings.font_pt or _BASE_PT) / _BASE_PT
    scales = {"x": settings.x_scale, "y": settings.y_scale}
    for axis, scale in scales.items():
        if scale is not None:
            getattr(axes, f"set_{axis}scale")(scale)
    for call in panel.calls:
        match call.name:
            case "set_xscale" | "set_yscale" if scales[call.name[4]] is not None:
                continue
            case "plain_log_ticks":
                names = "".join(name for name in call.args[0] if scales[name] != "linear")
                style.plain_log_ticks(axes, names)
            case "set_xlim" | "set_ylim" if scales[call.name[4]] == "log":
                continue  # as they may be at zero
            case name if name in _HELPERS:
                args, options = _drawable(call, colours, factor)
                _HELPERS[name](axes, *args, **options)
            case name:
                args, options = _drawable(call, colours, factor)
                getattr(axes, name)(*args, **options)
    for axis, scale in scales.items():
        if scale == "log":
            style.plain_log_ticks(axes, axis)
    _set_range(axes, "x", settings.x_range)
    _set_range(axes, "y", settings.y_range)


def _set_range(axes: Axes, axis: str, ends: Range) -> None:
    """Set the ends of an axis that are given; the other one stays."""
    turned = getattr(axes, f"{axis}axis_inverted")()
    getattr(axes, f"set_{axis}lim")(*ends)
    if None in ends and getattr(axes, f"{axis}axis_inverted")() != turned:
        low, high = sorted(getattr(axes, f"get_{axis}lim")())
        raise FigureError(
            f"{axis}_range: the axis would end at {low:g} and begin at {high:g}: give both ends"
        )


def _drawable(call: Call, colours: Mapping[str, str], factor: float) -> tuple[list[Any], dict[str, Any]]:
    """Return arguments and keywords for Matplotlib."""
    convert = _array if call.name in _WITH_ARRAYS else _tuple
    options = {name: convert(value) for name, value in call.options.items()}
    for name in _COLOUR_KEYS:
        if name in options and options.get("gid") != "synthetic":
            options[name] = colours.get(options[name], options[name])
    if "fontsize" in options:
        options["fontsize"] *= factor
    return [convert(value) for value in call.args], options


def _array(value: Any) -> Any:
    return numbers(value) if isinstance(value, list) else value


def _tuple(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


def figure_colours(figure: PanelFigure) -> list[str]:
    """Return the colours of the data of a figure, in the order in which they are drawn."""
    found = (
        call.options[name]
        for panel in figure.panels
        for call in panel.calls
        if call.name in _WITH_ARRAYS
        for name in _COLOUR_KEYS
        if name in call.options
    )
    return [colour for colour in dict.fromkeys(found) if colour not in _NEUTRAL]


def figure_csv(figure: PanelFigure) -> str:
    """Return the data behind a figure as CSV: a line for each point, with its panel and series."""
    file = io.StringIO()
    table = csv.DictWriter(file, CSV_COLUMNS, restval="", lineterminator="\n")
    table.writeheader()
    for number, panel in enumerate(figure.panels, start=1):
        names = {f"{axis}_name": plain_text(label(panel, axis)) for axis in "xy"}
        for call in panel.calls:
            series = plain_text(call.options.get("label") or _SERIES.get(call.name, "")).lstrip("_")
            for point in _points(call):
                known = {key: value for key, value in point.items() if not _missing(value)}
                table.writerow({"panel": number, **names, "series": series, **known})
    return file.getvalue()


def _points(call: Call) -> Iterator[dict[str, Any]]:
    """Yield the points that a call draws."""
    if call.name in {"plot", "errorbar"}:
        stds = {f"{axis}_std": call.options[f"{axis}err"] for axis in "xy" if f"{axis}err" in call.options}
        columns = {"x": call.args[0], "y": call.args[1], **stds}
    elif call.name == "fill_between":
        columns = dict(zip(("x", "y_low", "y_high"), call.args, strict=True))
    elif call.name == "barh":
        columns = {"x": call.args[1], "y": call.args[0]}
    elif call.name == "axhline":
        columns = {"y": call.args[0]}
    elif call.name == "axvline":
        columns = {"x": call.args[0]}
    else:
        return
    arrays = np.broadcast_arrays(*(np.atleast_1d(numbers(value)) for value in columns.values()))
    for row in zip(*(array.tolist() for array in arrays), strict=True):
        if not all(map(_missing, row)):
            yield dict(zip(columns, row, strict=True))


def _missing(value: Any) -> bool:
    return isinstance(value, float) and math.isnan(value)


def label(panel: Panel, axis: str) -> str:
    """Return the label of an axis, ``x`` or ``y``."""
    return next(iter(panel.last(f"set_{axis}label").args), "")


def figure_scale(panel: Panel, axis: str) -> Scale:
    """Return the scale of an axis, ``x`` or ``y``."""
    return "log" if panel.last(f"set_{axis}scale").args == ("log",) else "linear"


def plain_text(text: str) -> str:
    r"""Return a label without the signs of formulas.

    Examples
    --------
    >>> plain_text(r"$R_\mathrm{g}^\mathrm{corr}$ (mm)")
    'Rgcorr (mm)'
    """
    return " ".join("".join(run.text for run in runs(line)) for line in text.split("\n"))


def _require_one_axis(figure: PanelFigure, axis: str, settings: FigureSettings) -> None:
    """Raise if an axis is to be set in panels that show different quantities on it."""
    low_high, scale = getattr(settings, f"{axis}_range"), getattr(settings, f"{axis}_scale")
    labels = {label(panel, axis) for panel in figure.panels}
    if (scale or low_high != (None, None)) and len(labels) > 1:
        raise FigureError(
            f"{axis}_range, {axis}_scale: the panels of this figure show {len(labels)} quantities on this "
            "axis: leave both as they are"
        )


def _require(name: str, value: float | None, limits: Range, words: str) -> None:
    low, high = limits
    if value is not None and not low <= value <= high:  # type: ignore[operator]
        raise FigureError(f"{name}: {words.format(f'{low:g}', f'{high:g}')}, found {value:g}")
