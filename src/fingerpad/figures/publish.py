"""Figures for publication: width, fonts, axes and colours of one's choice, as SVG, PDF, PNG and CSV."""

import csv
import io
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING, Any, Final, Literal, TypeAlias, get_args

from matplotlib import text as mpl_text
from matplotlib.colors import is_color_like, to_hex

from fingerpad._files import explain_write_errors
from fingerpad.exceptions import FigureError
from fingerpad.figures import style
from fingerpad.figures.marks import AnyMark, Axis, Band, Figure, Line, Panel, Picture, Rule, Text, data_of
from fingerpad.figures.mpl import draw
from fingerpad.figures.svg import svg
from fingerpad.figures.svg_text import runs

if TYPE_CHECKING:  # slow to import, and the figures of a report are drawn without
    from matplotlib.figure import Figure as Drawn

Format: TypeAlias = Literal["svg", "pdf", "png", "csv"]
Scale: TypeAlias = Literal["linear", "log"]
# Either end of an axis, None where it follows the data.
Range: TypeAlias = tuple[float | None, float | None]

FORMATS: Final[tuple[Format, ...]] = get_args(Format)
CSV_COLUMNS: Final = ("panel", "x_name", "y_name", "series", "x", "y", "x_std", "y_std", "y_low", "y_high")

# The least and the largest of each setting, in words.
_LIMITS: Final = {
    "width_mm": (20.0, 500.0, "a figure is 20 to 500 mm wide and high"),
    "height_mm": (20.0, 500.0, "a figure is 20 to 500 mm wide and high"),
    "font_pt": (3.0, 30.0, "labels have 3 to 30 points"),
    "dpi": (50.0, 1200.0, "a PNG has 50 to 1200 dots per inch"),
}
_LARGEST_PX: Final = 12_000
# Of data without a label, in the CSV.
_SERIES: Final[dict[type, str]] = {Line: "line", Band: "band", Rule: "level"}
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
        for name, (least, largest, words) in _LIMITS.items():
            value = getattr(self, name)
            if value is not None and not least <= value <= largest:
                raise FigureError(f"{name}: {words}, found {value:g}")
        for axis, ends, scale in (("x", self.x_range, self.x_scale), ("y", self.y_range, self.y_scale)):
            if scale not in {None, "linear", "log"}:
                raise FigureError(f"{axis}_scale: an axis is linear or log, found {scale!r}")
            given = [end for end in ends if end is not None]
            if not all(map(math.isfinite, given)) or (len(given) == 2 and not given[0] < given[1]):
                raise FigureError(
                    f"{axis}_range: an axis goes from a smaller to a larger number, "
                    f"found {given[0]:g} to {given[-1]:g}"
                )
            if scale == "log" and any(end <= 0 for end in given):
                raise FigureError(f"{axis}_range: a logarithmic axis has no zero, found {min(given):g}")
        for colour in self.colours:
            if not is_color_like(colour):
                raise FigureError(f"colours: give names or #rrggbb, found {colour!r}")


@style.in_style()
def save_figure(
    figure: "Figure | Drawn", path: str | PathLike[str], *, description: str = "", dpi: float = 300.0
) -> tuple[Path, ...]:
    """Write `path`.svg and `path`.png, the same bytes for the same drawing.

    Of a figure that is kept as data, `path`.json takes the place of the PNG: `fingerpad figure` draws it.

    Parameters
    ----------
    figure : Figure
        Matplotlib's, or one that is kept as data.
    path : path-like
        File name without suffix; its last part also goes into the ids of the SVG.
    description : str
        Alternative text of the SVG.
    dpi : float
        Resolution of the PNG.

    Returns
    -------
    tuple of Path
        The SVG and the other file.

    Raises
    ------
    FingerpadError
        If a file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> figure, axes = style.new_figure()
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     [path.name for path in save_figure(figure, f"{folder}/empty", dpi=50)]
    ['empty.svg', 'empty.png']
    """
    path = Path(path)
    if isinstance(figure, Figure):
        drawing, other = svg(figure, path.name, description=description), "json"
        content = f"{figure.to_json()}\n".encode()
    else:
        layout, other = figure.get_layout_engine(), "png"
        if layout is not None:  # once for both: left to itself each file takes two, longer than to draw it
            layout.execute(figure)
            figure.set_layout_engine("none")
        content = style.render(figure, "png", dpi=dpi, pil_kwargs={"compress_level": style.PNG_LEVEL})
        drawing = style.figure_svg(figure, path.name, description=description)
        figure.set_layout_engine(layout)
    files = {path.with_name(f"{path.name}.svg"): (style.XML + drawing).encode()}
    files[path.with_name(f"{path.name}.{other}")] = content
    with explain_write_errors(path, "make room, or choose another"):
        for file, of_file in files.items():
            file.write_bytes(of_file)
    return tuple(files)


def figure_file(figure: Figure, kind: Format, settings: FigureSettings) -> bytes:
    """Return a figure as a file: SVG, PDF or PNG, or the data behind it as CSV; the same bytes each time.

    The CSV has all data, whatever the axes show.
    """
    if kind == "csv":
        return figure_csv(figure).encode()
    wanted = with_settings(figure, settings)
    if kind == "svg":
        return (style.XML + svg(wanted, "figure")).encode()
    with _DRAWING:
        drawn = draw_figure(wanted)
        return style.render(drawn, "pdf") if kind == "pdf" else _png(drawn, settings.dpi)


def _png(drawn: "Drawn", dpi: float) -> bytes:
    pixels = [round(dpi * float(inches)) for inches in drawn.get_size_inches()]
    if max(pixels) > _LARGEST_PX:
        raise FigureError(f"dpi: {max(pixels)} pixels are too many: take fewer dots per inch")
    # Matplotlib cuts off, and may lose one.
    across, down = ((count + 0.01) / dpi for count in pixels)
    drawn.set_size_inches(across, down)
    return style.render(drawn, "png", dpi=dpi)


@style.in_style()
def draw_figure(figure: Figure) -> "Drawn":
    """Return Matplotlib's figure of a figure that is kept as data."""
    shape = {name: getattr(figure, name) for name in ("width_mm", "height_mm", "rows", "columns")}
    drawn, every = style.new_figure(**shape)
    for axes, panel in zip(every, figure.panels, strict=True):
        draw(panel, axes)
        axes.set_xlim(*panel.limits("x"))
        axes.set_ylim(*panel.limits("y"))
    factor = figure.font_pt / style.FONT_PT
    for words in drawn.findobj(mpl_text.Text):
        words.set_fontsize(factor * float(words.get_fontsize()))
    for axes in every:
        axes.tick_params(labelsize=factor * style.TICK_PT)  # of ticks that are not yet there
    return drawn


def with_settings(figure: Figure, settings: FigureSettings) -> Figure:
    """Return a figure as the settings want it."""
    colours = dict(zip(figure_colours(figure), map(to_hex, settings.colours), strict=False))
    width = settings.width_mm or figure.width_mm
    return replace(
        figure,
        width_mm=width,
        height_mm=settings.height_mm or figure.height_mm * width / figure.width_mm,
        font_pt=settings.font_pt or figure.font_pt,
        panels=[
            replace(
                panel,
                marks=[_recoloured(mark, colours) for mark in panel.marks],
                x=_set_axis(figure, panel, "x", settings.x_range, settings.x_scale),
                y=_set_axis(figure, panel, "y", settings.y_range, settings.y_scale),
            )
            for panel in figure.panels
        ],
    )


def _recoloured(mark: AnyMark, colours: Mapping[str, str]) -> AnyMark:
    if isinstance(mark, Text) and mark.tag:
        return mark
    new: dict[str, Any] = {name: colours.get(old, old) for name, old in _colours(mark).items()}
    return replace(mark, **new)


def _colours(mark: AnyMark) -> dict[str, str]:
    return {name: getattr(mark, name) for name in ("colour", "face", "edge") if hasattr(mark, name)}


def _set_axis(
    figure: Figure, panel: Panel, name: Literal["x", "y"], ends: Range, scale: Scale | None
) -> Axis:
    """Return an axis with the scale and the ends that are given; what is left out stays."""
    axis: Axis = getattr(panel, name)
    low, high = ends
    labels = {getattr(one, name).label for one in figure.panels}
    if (scale or ends != (None, None)) and len(labels) > 1:
        raise FigureError(
            f"{name}_range, {name}_scale: the panels of this figure show {len(labels)} quantities on this "
            "axis: leave both as they are"
        )
    if scale is not None:
        least = -math.inf if scale == "linear" else 0.0
        kept = [end if end is not None and end > least else None for end in (axis.low, axis.high)]
        axis = replace(axis, log=scale == "log", low=kept[0], high=kept[1])
    old = panel.limits(name, axis)
    axis = replace(axis, low=axis.low if low is None else low, high=axis.high if high is None else high)
    new = panel.limits(name, axis)
    if None in ends and (new[0] < new[1]) != (old[0] < old[1]):
        raise FigureError(
            f"{name}_range: the axis would end at {min(new):g} and begin at {max(new):g}: give both ends"
        )
    return axis


def figure_colours(figure: Figure) -> list[str]:
    """Return the colours of the data of a figure, in the order in which they are drawn."""
    other = Rule | Text | Picture
    marks = (mark for panel in figure.panels for mark in panel.marks if not isinstance(mark, other))
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
            series = plain_text(mark.label or _SERIES.get(type(mark), "")).lstrip("_")
            data = data_of(mark)
            for row in zip(*(column.tolist() for column in data.values()), strict=True):
                known = {name: value for name, value in zip(data, row, strict=True) if not math.isnan(value)}
                if known:
                    table.writerow({"panel": number, **names, "series": series, **known})
    return file.getvalue()


def plain_text(text: str) -> str:
    r"""Return a label without the signs of formulas."""
    return " ".join("".join(run.text for run in runs(line)) for line in text.split("\n"))
