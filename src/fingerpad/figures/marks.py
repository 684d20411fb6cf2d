"""Figures as data: eight kinds of marks on axes, from which SVG, PDF, PNG and CSV are made.

`fingerpad.figures.svg` draws them in a millisecond or two, `fingerpad.figures.mpl` by Matplotlib. Both draw
marks in their order, one above the other.
"""

import itertools
import json
import math
import re
from collections.abc import Iterator
from dataclasses import KW_ONLY, dataclass, field, fields, replace
from types import NoneType
from typing import Annotated, Any, Final, Literal, Self, TypeAlias, get_args, get_origin

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array, broadcast
from fingerpad.figures.style import BLACK, BLUE, FADED, FONT_PT, ORANGE, VERMILLION

# Whatever makes an array when given, an array of one axis when read; NaN where a number is missing.
Numbers: TypeAlias = Annotated[Any, "numbers"]
Colour: TypeAlias = Annotated[str, re.compile(r"#?\w*")]
Base64: TypeAlias = Annotated[str, re.compile(r"[\w+/]*=*")]
Dash: TypeAlias = Literal["-", "--", ":", "-."]
Marker: TypeAlias = Literal["o", "s", "D", "v", ".", ""]
AxisName: TypeAlias = Literal["x", "y"]
Side: TypeAlias = Literal["left", "center", "right"]
Frame: TypeAlias = Literal["", "x", "xy"]  # in which directions places are fractions of it
Legend: TypeAlias = Literal["", "above", "inside", "below"]

# Of the numbers kept: far more than a drawing shows.
_DIGITS: Final = 7


class _Record:
    """Data that say what is wrong with them, and read themselves from JSON."""

    __slots__ = ()

    def __post_init__(self) -> None:
        found = {one.name: _checked(one.name, one.type, getattr(self, one.name)) for one in fields(self)}  # type: ignore[arg-type]
        arrays = {name: value for name, value in found.items() if isinstance(value, np.ndarray)}
        found |= dict(zip(arrays, np.broadcast_arrays(*arrays.values()), strict=True))
        for name, value in found.items():
            object.__setattr__(self, name, value)


def _checked(name: str, kind: Any, value: Any) -> Any:
    """Return a value of a kind; refuse another, as of a file that comes with somebody else's study."""
    origin, options = get_origin(kind), get_args(kind)
    if kind is Numbers:
        flat = np.atleast_1d(as_float_array(value)).ravel().tolist()
        return np.array([float(f"{one:.{_DIGITS}g}") if math.isfinite(one) else math.nan for one in flat])
    if NoneType in options:
        return None if value is None else _checked(name, options[0], value)
    if kind is float and not isinstance(value, str):
        return float(value)
    if origin is list or (origin is tuple and (options[-1] is ... or len(value) == len(options))):
        return origin(_checked(name, options[0], one) for one in value)
    if kind in {Axis, Panel} and isinstance(value, dict):
        value = kind(**value)
    elif kind is AnyMark and isinstance(value, list):
        value = KINDS[value[0]](**value[1])
    if origin is Literal:
        good = value in options
    elif origin is Annotated:
        good = isinstance(value, str) and options[1].fullmatch(value) is not None
    else:
        good = isinstance(value, options if kind is AnyMark else origin or kind)
    if not good:
        raise ValueError(f"{name}: a figure takes no {value!r:.40} here")
    return value


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Mark(_Record):
    """What is drawn on axes."""

    colour: Colour = BLACK
    alpha: float = 1.0
    label: str = ""  # in legend and CSV, which marks may share; with "_" at its front in the CSV alone


@dataclass(frozen=True, slots=True, eq=False)
class Points(Mark):
    """Points with bars of one standard uncertainty; `marker` "" leaves the bars alone."""

    x: Numbers
    y: Numbers
    _: KW_ONLY
    x_std: Numbers | None = None
    y_std: Numbers | None = None
    marker: Marker = "o"
    size: float = 4.0
    face: Colour = ""
    edge: Colour = ""
    edge_width: float = 0.9
    bar_width: float = 0.8


@dataclass(frozen=True, slots=True, eq=False)
class Line(Mark):
    """A line, broken where a number is missing; with a `face` it is filled, but where it turns backwards."""

    x: Numbers
    y: Numbers
    _: KW_ONLY
    width: float = 1.2
    dash: Dash = "-"
    face: Colour = ""
    clipped: bool = True


@dataclass(frozen=True, slots=True, eq=False)
class Band(Mark):
    """The area between two lines."""

    x: Numbers
    low: Numbers
    high: Numbers


@dataclass(frozen=True, slots=True, eq=False)
class Rule(Mark):
    """A line through the whole frame at a value of an axis; with an end `to` a band."""

    axis: AxisName
    at: float
    to: float | None = None
    _: KW_ONLY
    width: float = 1.2
    dash: Dash = "-"


@dataclass(frozen=True, slots=True, eq=False)
class Bars(Mark):
    """Bars from zero to the right."""

    place: Numbers
    length: Numbers
    _: KW_ONLY
    height: float = 0.8


@dataclass(frozen=True, slots=True, eq=False)
class Ellipses(Mark):
    """Ellipses of sizes on paper, points, at places that may be in fractions of the frame."""

    x: Numbers
    y: Numbers
    _: KW_ONLY
    widths: Numbers
    heights: Numbers
    angles_deg: Numbers
    face: Colour = "white"
    frame: Frame = ""


@dataclass(frozen=True, slots=True, eq=False)
class Text(Mark):
    """Text, moved by some points from its place, which may be in fractions of the frame.

    A `tag` is boxed; a `halo` keeps text readable over what is drawn.
    """

    text: str
    x: float
    y: float
    _: KW_ONLY
    right: float = 0.0
    up: float = 0.0
    frame: Frame = ""
    size: float = FONT_PT
    horizontal: Side = "left"
    vertical: Literal["baseline", "top", "center", "bottom"] = "baseline"
    tag: bool = False
    halo: Colour = ""


@dataclass(frozen=True, slots=True, eq=False)
class Picture(Mark):
    """A PNG file, in base64, stretched over a part of the axes."""

    png: Base64
    left: float
    right: float
    bottom: float
    top: float


AnyMark: TypeAlias = Points | Line | Band | Rule | Bars | Ellipses | Text | Picture
KINDS: Final = {kind.__name__.lower(): kind for kind in get_args(AnyMark)}


@dataclass(frozen=True, slots=True)
class Axis(_Record):
    """One of two axes; ends that are None follow the data with a margin.

    Without `lines` only names show, with empty `names` only lines.
    """

    label: str = ""
    _: KW_ONLY
    log: bool = False
    low: float | None = None
    high: float | None = None
    margin: float = 0.05
    ticks: tuple[float, ...] | None = None
    names: tuple[str, ...] | None = None
    lines: bool = True


@dataclass(slots=True, kw_only=True, eq=False)
class Panel(_Record):
    """Axes with what is drawn on them."""

    marks: list[AnyMark] = field(default_factory=list)
    x: Axis = field(default_factory=Axis)
    y: Axis = field(default_factory=Axis)
    title: str = ""
    legend: Legend = ""
    columns: int = 0  # of the legend; 0 for two from four entries on, else one
    equal: bool = False
    framed: bool = True
    # Of its frame left, bottom, width and height in fractions of the figure; else that follows from the text.
    place: tuple[float, float, float, float] | None = None

    def add(self, *marks: AnyMark) -> None:
        """Draw marks above those that are there."""
        self.marks += marks

    def legend_columns(self, count: int) -> int:
        """Return the number of columns of a legend of so many names."""
        return self.columns or (2 if self.legend == "above" and count > 3 else 1)

    def limits(self, name: AxisName) -> tuple[float, float]:
        """Return the ends of an axis: those given, else round the data."""
        axis: Axis = getattr(self, name)
        every = np.concatenate([np.empty(0), *(one for mark in self.marks for one in _extent(mark, name))])
        every = every[np.isfinite(every) & ((every > 0) | (not axis.log))]
        every = np.log10(every) if axis.log else every
        low, high = (float(every.min()), float(every.max())) if every.size else (0.0, 1.0)
        if low == high:
            room = math.log10(2) if axis.log else 0.05 * abs(low) or 1.0
            low, high = low - room, high + room
        room = axis.margin * (high - low)
        low, high = low - room, high + room
        if axis.log:
            low, high = 10**low, 10**high
        if axis.ticks:
            low, high = min(low, *axis.ticks), max(high, *axis.ticks)
        return (low if axis.low is None else axis.low), (high if axis.high is None else axis.high)


# Fields of marks with data, by their columns in a CSV.
_DATA: Final[dict[type, dict[str, str]]] = {
    Points: {"x": "x", "y": "y", "x_std": "x_std", "y_std": "y_std"},
    Line: {"x": "x", "y": "y"},
    Band: {"x": "x", "y_low": "low", "y_high": "high"},
    Bars: {"x": "length", "y": "place"},
}


def data_of(mark: AnyMark) -> dict[str, FloatArray]:
    """Return the data that a mark shows, by their columns in a CSV."""
    if isinstance(mark, Rule) and mark.to is None:
        return {mark.axis: np.array([mark.at])}
    found = {column: getattr(mark, name) for column, name in _DATA.get(type(mark), {}).items()}
    return {column: data for column, data in found.items() if data is not None}


def _extent(mark: AnyMark, axis: str) -> Iterator[FloatArray]:
    """Yield the numbers that an axis has to hold."""
    data = data_of(mark)
    std = np.nan_to_num(data.get(f"{axis}_std", 0.0))
    for name in (axis, f"{axis}_low", f"{axis}_high"):
        if name in data:
            yield from (data[name] - std, data[name] + std)
    if isinstance(mark, Bars):
        half = mark.height / 2
        yield from (np.zeros(1),) if axis == "x" else (mark.place - half, mark.place + half)
    if isinstance(mark, Rule) and mark.axis == axis and mark.to is not None:
        yield np.array([mark.at, mark.to])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Figure(_Record):
    """A figure as data."""

    width_mm: float
    height_mm: float
    rows: int
    columns: int
    panels: list[Panel]  # row by row
    font_pt: float = FONT_PT  # of labels; that of other text follows

    def __post_init__(self) -> None:
        _Record.__post_init__(self)
        if len(self.panels) != self.rows * self.columns:
            raise ValueError(f"{len(self.panels)} panels are not {self.rows} × {self.columns}")
        if not all(0 < size < math.inf for size in (self.width_mm, self.height_mm, self.font_pt)):
            raise ValueError("a figure has a size")

    def to_json(self) -> str:
        """Return the figure as JSON, the same text for the same figure."""
        return json.dumps(self, default=_plain, ensure_ascii=False, separators=(",", ":"), allow_nan=False)

    @classmethod
    def of_json(cls, text: str) -> Self:
        """Return a figure that was written as JSON, or raise ValueError."""
        try:
            return cls(**json.loads(text))
        except (LookupError, TypeError, AttributeError) as error:
            raise ValueError(f"not a figure: {error}") from error


def _plain(part: Any) -> Any:
    """Return what JSON holds of a part of a figure: of its fields those that differ from the usual."""
    if isinstance(part, np.ndarray):
        return [None if math.isnan(one) else one for one in part.tolist()]
    values = {one.name: (getattr(part, one.name), one.default) for one in fields(part)}
    changed = {key: value for key, (value, usual) in values.items() if np.ndim(value) or value != usual}
    return [type(part).__name__.lower(), changed] if isinstance(part, Mark) else changed


def new_panels(
    *, width_mm: float = 85.0, height_mm: float = 64.0, rows: int = 1, columns: int = 1
) -> tuple[Figure, list[Panel]]:
    """Return an empty figure as data and its panels, as `new_figure` does of Matplotlib's."""
    panels = [Panel() for _ in range(rows * columns)]
    return Figure(width_mm=width_mm, height_mm=height_mm, rows=rows, columns=columns, panels=panels), panels


def measured(
    x: ArrayLike,
    y: ArrayLike,
    *,
    x_std: ArrayLike | None = None,
    y_std: ArrayLike | None = None,
    synthetic: ArrayLike = False,
    left_out: ArrayLike = False,
    label: str = "measured",
    **look: Any,
) -> Iterator[Points]:
    """Yield points with bars of one standard uncertainty, synthetic ones hollow, left-out ones faded.

    They are small where there are many; `look` has other fields of `Points`.
    """
    usual = {"size": 1.8, "edge_width": 0.5} if max(np.size(x), np.size(y)) > 80 else {"size": 4.2}
    every = Points(x, y, x_std=x_std, y_std=y_std, **({"colour": BLUE} | usual | look))
    data = data_of(every)
    hollow, faded, _ = broadcast(np.ravel(synthetic), np.ravel(left_out), every.x)
    for out, made in itertools.product((False, True), repeat=2):
        chosen = ((faded != 0) == out) & ((hollow != 0) == made)
        if chosen.any():
            yield replace(
                every,
                **{name: column[chosen] for name, column in data.items()},
                face=every.face or ("white" if made else ""),
                label=f"{label}{', left out' if out else ''}{' (synthetic)' if made else ''}",
                alpha=FADED if out else 1.0,
            )


def fitted(
    x: ArrayLike, y: ArrayLike, std: ArrayLike = 0.0, *, label: str, colour: str = ORANGE
) -> Iterator[Band | Line]:
    """Yield a line, in a band of one standard uncertainty to either side."""
    x, y, std = broadcast(x, y, std)
    if std.any():
        yield Band(x, y - std, y + std, colour=colour, alpha=0.25)
    yield Line(x, y, colour=colour, label=label)


def synthetic_tag(synthetic: ArrayLike, *, above: bool = False) -> Iterator[Text]:
    """Yield "synthetic", if anything is, in the lower right corner, where a growing curve leaves room.

    Of a falling one that is `above`.
    """
    if np.any(synthetic):
        place: dict[str, Any] = {"frame": "xy", "horizontal": "right"}
        place["vertical"] = "top" if above else "bottom"
        yield Text("synthetic", 0.99, 0.98 if above else 0.02, **place, colour=VERMILLION, tag=True)


def arrow(start: FloatArray, end: FloatArray, *, colour: str = BLACK) -> Iterator[Line]:
    """Yield an arrow between two points of axes with equal scales."""
    back = 0.2 * (start - end)
    barbs = [end + 0.9 * back + turn * back[::-1] * (-1, 1) for turn in (-0.35, 0.35)]
    yield Line(*np.transpose([start, end]), colour=colour, width=0.9)
    yield Line(*np.transpose([barbs[0], end, barbs[1]]), colour=colour, face=colour, width=0.6)
