"""Figures for publication: width, fonts, axes and colours of one's choice, as SVG, PDF, PNG and CSV."""

import csv
import io
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import Any, Final, Literal, TypeAlias, get_args

from matplotlib.colors import is_color_like, to_hex

from fingerpad._files import explain_write_errors
from fingerpad.exceptions import FigureError
from fingerpad.figures.marks import AnyMark, AxisName, Band, Figure, Line, Panel, Picture, Rule, Text, data_of
from fingerpad.figures.mpl import render
from fingerpad.figures.style import BLACK
from fingerpad.figures.svg import svg
from fingerpad.figures.svg_text import runs

Format: TypeAlias = Literal["svg", "pdf", "png", "csv", "json"]
Scale: TypeAlias = Literal["linear", "log"]

FORMATS: Final[tuple[Format, ...]] = get_args(Format)
_AXES: Final[tuple[AxisName, ...]] = get_args(AxisName)
CSV_COLUMNS: Final = ("panel", "x_name", "y_name", "series", "x", "y", "x_std", "y_std", "y_low", "y_high")

# The least and the largest of each setting, in words.
_LIMITS: Final = {
    "width_mm": (20.0, 500.0, "a figure is 20 to 500 mm wide and high"),
    "height_mm": (20.0, 500.0, "a figure is 20 to 500 mm wide and high"),
    "font_pt": (3.0, 30.0, "labels have 3 to 30 points"),
    "dpi": (50.0, 1200.0, "a PNG has 50 to 1200 dots per inch"),
}
# Of data without a label, in the CSV.
_SERIES: Final[dict[type, str]] = {Line: "line", Band: "band", Rule: "level"}
# Of text, axes and paper: not of data.
_NEUTRAL: Final = frozenset({BLACK, "white", "none", ""})
_XML: Final = '<?xml version="1.0" encoding="utf-8"?>\n'


@dataclass(frozen=True, slots=True, kw_only=True)
class FigureSettings:
    """How a figure is drawn for publication; what is None stays as in the report."""

    width_mm: float | None = None
    height_mm: float | None = None
    font_pt: float | None = None
    x_low: float | None = None
    x_high: float | None = None
    y_low: float | None = None
    y_high: float | None = None
    x_scale: Scale | None = None
    y_scale: Scale | None = None
    colours: str = ""  # separated by commas
    dpi: float = 300.0

    def __post_init__(self) -> None:
        for name, (least, largest, words) in _LIMITS.items():
            value = getattr(self, name)
            if value is not None and not least <= value <= largest:
                raise FigureError(f"{name}: {words}, found {value:g}")
        for axis in _AXES:
            low, high, scale = self.of_axis(axis)
            if scale not in {None, "linear", "log"}:
                raise FigureError(f"{axis}_scale: an axis is linear or log, found {scale!r}")
            given = [end for end in (low, high) if end is not None]
            if not all(map(math.isfinite, given)) or (len(given) == 2 and not given[0] < given[1]):
                raise FigureError(
                    f"{axis}_range: an axis goes from a smaller to a larger number, "
                    f"found {given[0]:g} to {given[-1]:g}"
                )
            if scale == "log" and any(end <= 0 for end in given):
                raise FigureError(f"{axis}_range: a logarithmic axis has no zero, found {min(given):g}")
        for colour in self.each_colour():
            if not is_color_like(colour):
                raise FigureError(f"colours: give names or #rrggbb, found {colour!r}")

    def of_axis(self, name: AxisName) -> tuple[float | None, float | None, Scale | None]:
        """Return both ends and the scale of an axis."""
        low, high, scale = (getattr(self, f"{name}_{one}") for one in ("low", "high", "scale"))
        return low, high, scale

    def each_colour(self) -> list[str]:
        """Return the colours one by one."""
        return list(filter(None, self.colours.split(",")))


def save_figure(
    figure: Figure,
    path: str | PathLike[str],
    *,
    settings: FigureSettings | None = None,
    description: str = "",
) -> Path:
    """Write a figure as SVG, PDF, PNG, CSV or JSON, by the ending of the file; the same bytes each time.

    The CSV has all data, whatever the axes show. What is written as JSON, `fingerpad figure` draws.

    Parameters
    ----------
    figure : Figure
        As data: from `new_panels`, and from functions that return a figure.
    path : path-like
        The file.
    settings : FigureSettings, optional
        Width, fonts, axes, colours and resolution, where they are not those of the figure.
    description : str
        Alternative text of an SVG.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    FigureError
        If there is no such format, or the settings do not fit the figure.
    FingerpadError
        If the file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from fingerpad.figures import new_panels
    >>> figure, (axes,) = new_panels()
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     save_figure(figure, f"{folder}/empty.svg").name
    'empty.svg'
    """
    path, settings = Path(path), settings or FigureSettings()
    kind = path.suffix.lower().removeprefix(".")
    if kind not in FORMATS:
        raise FigureError(f"a figure is written as .svg, .pdf, .png, .csv or .json, found {path.name}")
    content = figure_file(figure, kind, settings, name=path.stem, description=description)
    with explain_write_errors(path, "make room, or choose another"):
        path.write_bytes(content)
    return path


def figure_file(
    figure: Figure, kind: Format, settings: FigureSettings, *, name: str = "figure", description: str = ""
) -> bytes:
    """Return the content of a file of a figure; its name also goes into the ids of an SVG."""
    if kind == "csv":
        return figure_csv(figure).encode()
    wanted = with_settings(figure, settings)
    if kind == "svg":
        return f"{_XML}{svg(wanted, name, description=description)}".encode()
    return f"{wanted.to_json()}\n".encode() if kind == "json" else render(wanted, kind, settings.dpi)


def with_settings(figure: Figure, settings: FigureSettings) -> Figure:
    """Return a figure as the settings want it."""
    if settings == FigureSettings():
        return figure
    colours = dict(zip(figure_colours(figure), map(to_hex, settings.each_colour()), strict=False))
    panels = [replace(one, marks=[_recoloured(mark, colours) for mark in one.marks]) for one in figure.panels]
    for name in _AXES:
        if (wanted := settings.of_axis(name)) == (None, None, None):
            continue
        labels = {getattr(panel, name).label for panel in panels}
        if len(labels) > 1:
            raise FigureError(
                f"{name}_range, {name}_scale: the panels of this figure show {len(labels)} quantities on "
                "this axis: leave both as they are"
            )
        for panel in panels:
            _set_axis(panel, name, *wanted)
    width = settings.width_mm or figure.width_mm
    return replace(
        figure,
        width_mm=width,
        height_mm=settings.height_mm or figure.height_mm * width / figure.width_mm,
        font_pt=settings.font_pt or figure.font_pt,
        panels=panels,
    )


def _recoloured(mark: AnyMark, colours: Mapping[str, str]) -> AnyMark:
    new: dict[str, Any] = {name: colours.get(old, old) for name, old in _colours(mark).items()}
    return mark if isinstance(mark, Text) and mark.tag else replace(mark, **new)


def _colours(mark: AnyMark) -> dict[str, str]:
    return {name: getattr(mark, name) for name in ("colour", "face", "edge") if hasattr(mark, name)}


def _set_axis(
    panel: Panel, name: AxisName, low: float | None, high: float | None, scale: Scale | None
) -> None:
    """Give an axis the ends and the scale that are given; what is left out stays."""
    axis, before = getattr(panel, name), panel.limits(name)
    log = axis.log if scale is None else scale == "log"
    # Ends of a linear axis may be none of a logarithmic one.
    kept = [None if log and end is not None and end <= 0 else end for end in (axis.low, axis.high)]
    ends = kept[0] if low is None else low, kept[1] if high is None else high
    setattr(panel, name, replace(axis, log=log, low=ends[0], high=ends[1]))
    new = panel.limits(name)
    if None in {low, high} and (new[0] < new[1]) != (before[0] < before[1]):
        raise FigureError(
            f"{name}_range: the axis would end at {min(new):g} and begin at {max(new):g}: give both ends"
        )


def figure_colours(figure: Figure) -> list[str]:
    """Return the colours of the data of a figure, in the order in which they are drawn.

    What fills a line is not among them: each area between contours has its own.
    """
    every = [
        colour
        for panel in figure.panels
        for mark in panel.marks
        for name, colour in _colours(mark).items()
        if not isinstance(mark, Rule | Text | Picture) and (name != "face" or not isinstance(mark, Line))
    ]
    return [colour for colour in dict.fromkeys(every) if colour not in _NEUTRAL]


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
