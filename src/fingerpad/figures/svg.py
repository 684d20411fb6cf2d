"""SVG of figures that are kept as data, in the style of `fingerpad.figures.style`, some fifty times as fast.

Lengths are points, 1/72 inch, from the upper left corner.
"""

import hashlib
import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, Final, assert_never

import numpy as np
from matplotlib.ticker import LogLocator, MaxNLocator

from fingerpad._arrays import FloatArray
from fingerpad.exceptions import FingerpadError
from fingerpad.figures.marks import (
    AnyMark,
    Axis,
    Band,
    Bars,
    Ellipses,
    Figure,
    Line,
    Mark,
    Panel,
    Picture,
    Points,
    Rule,
    Text,
)
from fingerpad.figures.style import BLACK, CAP_PT, FONT_PT, GRID, LEGEND_PT, TICK_PT, escaped, log_subs
from fingerpad.figures.svg_text import FONT_FAMILY, LINE_HEIGHT, TextBox, line_width, text_element
from fingerpad.units import MM_PER_INCH

_POINTS_PER_MM: Final = 72 / MM_PER_INCH
_EDGE: Final = 3.0  # free of anything beside and between panels
_TICK, _PAD = 3.5, 3.0
_MOST_TICKS: Final = 9
_DASHES: Final = {"--": (3.7, 1.6), ":": (1.0, 1.65), "-.": (6.4, 1.6, 1.0, 1.6)}  # of the line's width


def svg(figure: Figure, name: str, *, description: str = "") -> str:
    """Return a figure as an ``<svg>`` element that can stand in an HTML page beside others.

    The `name` tells it from others that look the same.
    """
    width, height = _POINTS_PER_MM * figure.width_mm, _POINTS_PER_MM * figure.height_mm
    factor = figure.font_pt / FONT_PT
    drawings = [_Drawing(panel, f"@clip{number}", factor) for number, panel in enumerate(figure.panels)]
    _place(drawings, figure, width, height)
    body = "".join(element for drawing in drawings for element in drawing.elements())
    digest = hashlib.sha256(f"{name}\0{body}".encode()).hexdigest()
    prefix = f"figure-{digest[:12]}"
    label = f' role="img" aria-label="{escaped(description)}"' if description else ""
    return (
        f'<svg id="{prefix}"{label} xmlns="http://www.w3.org/2000/svg" width="{width:.2f}pt" '
        f'height="{height:.2f}pt" viewBox="0 0 {width:.2f} {height:.2f}" font-family="{FONT_FAMILY}">'
        f'<rect width="100%" height="100%" fill="#fff"/>{body.replace("@clip", f"{prefix}-")}</svg>\n'
    )


def save_panels(figure: Figure, path: str | PathLike[str], *, description: str = "") -> tuple[Path, Path]:
    """Write `path`.svg, and `path`.json to draw it from again; the same bytes for the same figure."""
    path = Path(path)
    drawing, data = (path.with_name(f"{path.name}.{suffix}") for suffix in ("svg", "json"))
    text = svg(figure, path.name, description=description)
    try:
        drawing.write_text(f'<?xml version="1.0" encoding="utf-8"?>\n{text}', encoding="utf-8", newline="\n")
        data.write_text(f"{figure.to_json()}\n", encoding="utf-8", newline="\n")
    except OSError as error:
        raise FingerpadError(
            f"{error.filename or path}: cannot be written ({error.strerror}): make room, or choose another"
        ) from error
    return drawing, data


def _place(drawings: list["_Drawing"], figure: Figure, width: float, height: float) -> None:
    """Give all panels frames of one size, such that all that stands outside of the frames has room."""
    shape = figure.rows, figure.columns
    margins = np.zeros((*shape, 4))
    for _ in range(2):  # what stands beside a frame moves with it
        left, right = margins[..., 0].max(axis=0), margins[..., 1].max(axis=0)
        top, bottom = margins[..., 2].max(axis=1), margins[..., 3].max(axis=1)
        size = (width - (left + right).sum()) / shape[1], (height - (top + bottom).sum()) / shape[0]
        size = max(size[0], 0.1 * width / shape[1]), max(size[1], 0.1 * height / shape[0])
        x = np.cumsum(left + np.append(0.0, right[:-1] + size[0]))
        y = np.cumsum(top + np.append(0.0, bottom[:-1] + size[1]))
        for place, drawing in zip(np.ndindex(shape), drawings, strict=True):
            drawing.place(float(x[place[1]]), float(y[place[0]]), *size)
            margins[place] = np.add(drawing.margins(), _EDGE)


@dataclass(slots=True)
class _Scale:
    """From data to points along one axis."""

    low: float
    high: float
    log: bool
    begin: float = 0.0
    end: float = 1.0

    def __call__(self, values: Any) -> Any:
        """Return places on paper."""
        low, high = self.low, self.high
        if self.log:
            with np.errstate(all="ignore"):
                values, low, high = np.log10(values), math.log10(low), math.log10(high)
        return self.begin + (values - low) / (high - low) * (self.end - self.begin)

    def ticks(self, axis: Axis, room: float) -> list[tuple[float, str]]:
        """Return places of ticks with their labels, one for each `room` points at most."""
        low, high = sorted((self.low, self.high))
        if axis.ticks is not None:
            places = list(axis.ticks)
            labels = [f"{place:g}" for place in places] if axis.names is None else axis.names
        elif self.log:
            places = np.asarray(LogLocator(subs=log_subs(low, high)).tick_values(low, high)).tolist()
            labels = [f"{place:g}" for place in places]
        else:
            most = min(max(int(abs(self.end - self.begin) / room), 1), _MOST_TICKS)
            places = np.asarray(MaxNLocator(most, steps=(1, 2, 2.5, 5, 10)).tick_values(low, high)).tolist()
            labels = decimal_labels(places)
        edge = 1e-9 * (high - low)
        return [
            (float(self(place)), label)
            for place, label in zip(places, labels, strict=True)
            if low - edge <= place <= high + edge
        ]


class _Drawing:
    """The drawing of one panel."""

    def __init__(self, panel: Panel, clip: str, factor: float) -> None:
        self.panel, self.clip = panel, clip
        self.size, self.tick_size, self.legend_size = factor * FONT_PT, factor * TICK_PT, factor * LEGEND_PT
        self.x = _Scale(*panel.limits("x"), panel.x.log)
        self.y = _Scale(*panel.limits("y"), panel.y.log)

    def place(self, left: float, top: float, width: float, height: float) -> None:
        """Draw in a frame."""
        if self.panel.equal:
            spans = abs(self.x.high - self.x.low), abs(self.y.high - self.y.low)
            scale = min(width / spans[0], height / spans[1])
            left, width = left + (width - scale * spans[0]) / 2, scale * spans[0]
            top, height = top + (height - scale * spans[1]) / 2, scale * spans[1]
        self.left, self.right, self.top, self.bottom = left, left + width, top, top + height
        self.x.begin, self.x.end = self.left, self.right
        self.y.begin, self.y.end = self.bottom, self.top
        self.drawn: list[str] = []
        self.texts: list[TextBox] = []
        if self.panel.framed:
            self._axes()
        for mark in self.panel.marks:
            self._draw(mark)
        if self.panel.title:
            self.texts.append(TextBox(self.panel.title, self.left, self.top - 4, self.size))
        if self.panel.legend:
            self._legend()

    def margins(self) -> tuple[float, float, float, float]:
        """Return how far text and legends reach beyond the frame: left, right, top and bottom."""
        boxes = [text.box() for text in self.texts]
        if not boxes:
            return 0.0, 0.0, 0.0, 0.0
        low_x, high_x, low_y, high_y = zip(*boxes, strict=True)
        label = 1.7 * self.size if self.panel.framed and self.panel.y.label else 0.0
        return (
            max(0.0, self.left - min(low_x)) + label,
            max(0.0, max(high_x) - self.right),
            max(0.0, self.top - min(low_y)),
            max(0.0, max(high_y) - self.bottom),
        )

    def elements(self) -> Iterator[str]:
        """Yield what is drawn, from the lowest up."""
        frame = _rectangle(self.left, self.top, self.right, self.bottom)
        yield f'<clipPath id="{self.clip}">{frame}/></clipPath>'
        yield from self.drawn
        for text in self.texts:
            yield text.element()

    def _axes(self) -> None:
        """Draw the grid, the axes, their ticks and their labels."""
        left, right, top, bottom = self.left, self.right, self.top, self.bottom
        grid, ticks, far = "", f"M{left:.2f} {top:.2f}V{bottom:.2f}H{right:.2f}", 0.0
        for x, label in self.x.ticks(self.panel.x, 3 * self.tick_size):
            if self.panel.x.lines:
                grid += f"M{x:.2f} {top:.2f}V{bottom:.2f}"
                ticks += f"M{x:.2f} {bottom:.2f}v{_TICK}"
            self.texts.append(TextBox(label, x, bottom + _TICK + _PAD, self.tick_size, "center", "top"))
        for y, label in self.y.ticks(self.panel.y, 2 * self.tick_size):
            if self.panel.y.lines:
                grid += f"M{left:.2f} {y:.2f}H{right:.2f}"
                ticks += f"M{left:.2f} {y:.2f}h-{_TICK}"
            self.texts.append(TextBox(label, left - _TICK - _PAD, y, self.tick_size, "right", "center"))
            far = max(far, line_width(label, self.tick_size))
        self.drawn.append(f'<path d="{grid}" stroke="{GRID}" stroke-width=".5"/>')
        self.drawn.append(f'<path d="{ticks}" fill="none" stroke="{BLACK}" stroke-width=".6"/>')
        if self.panel.x.label:
            low = bottom + _TICK + _PAD + LINE_HEIGHT * self.tick_size + 1
            self.texts.append(
                TextBox(self.panel.x.label, (left + right) / 2, low, self.size, "center", "top")
            )
        if self.panel.y.label:
            x, y = left - _TICK - _PAD - far - 0.45 * self.size, (top + bottom) / 2
            turned = f' transform="rotate(-90 {x:.2f} {y:.2f})"'
            inner = text_element(self.panel.y.label, self.size, BLACK, "middle", turned)
            self.drawn.append(f'<text x="{x:.2f}" y="{y:.2f}" {inner}')

    def _add(self, element: str, *, clipped: bool = True) -> None:
        self.drawn.append(f'<g clip-path="url(#{self.clip})">{element}</g>' if clipped else element)

    def _draw(self, mark: AnyMark) -> None:  # noqa: PLR0912 (one branch for each kind)
        match mark:
            case Points():
                path = self._bars(mark, "x") + self._bars(mark, "y")
                if path:
                    self._add(f'<path d="{path}" {_stroke(mark, mark.bar_width)}/>')
                if mark.marker:
                    spots = _spots(self.x(mark.x), self.y(mark.y), mark)
                    self._add(f'<path d="{spots}" {_marker_look(mark)}/>')
            case Line():
                if mark.x.size:
                    line = _polyline(self.x(mark.x), self.y(mark.y))
                    look = _stroke(mark, mark.width, mark.dash)
                    self._add(f'<path d="{line}" {look}/>', clipped=mark.clipped)
            case Band():
                known = np.isfinite(mark.x + mark.low + mark.high)
                x, y = mark.x[known], np.concatenate([mark.low[known], mark.high[known][::-1]])
                outline = _polyline(self.x(np.concatenate([x, x[::-1]])), self.y(y))
                self._add(f'<path d="{outline}" {_fill(mark)}/>')
            case Rule():
                self._rule(mark)
            case Bars():
                for place, length in zip(mark.place.tolist(), mark.length.tolist(), strict=True):
                    ends = sorted((float(self.x(0.0)), float(self.x(length))))
                    sides = sorted(float(self.y(place + half * mark.height)) for half in (-0.5, 0.5))
                    self._add(f"{_rectangle(ends[0], sides[0], ends[1], sides[1])} {_fill(mark)}/>")
            case Ellipses():
                self._ellipses(mark)
            case Text():
                self._text(mark)
            case Picture():
                place = float(self.x(mark.left)), float(self.y(mark.top))
                corner = float(self.x(mark.right)), float(self.y(mark.bottom))
                area = _rectangle(*place, *corner).replace("<rect", "<image")
                self._add(f'{area} preserveAspectRatio="none" href="data:image/png;base64,{mark.png}"/>')
            case _:
                assert_never(mark)

    def _bars(self, mark: Points, axis: str) -> str:
        """Return the path of the bars along an axis."""
        along, across = (self.x, self.y) if axis == "x" else (self.y, self.x)
        std, at, beside = (mark.x_std, mark.x, mark.y) if axis == "x" else (mark.y_std, mark.y, mark.x)
        if std is None:
            return ""
        low, high, place = along(at - std), along(at + std), across(beside)
        # Below zero a logarithmic axis has no place: the bar leaves the frame.
        low = np.where(
            np.isnan(low) & np.isfinite(high), along.begin + math.copysign(99, along.begin - along.end), low
        )
        path = ""
        for a, b, c in zip(low.tolist(), high.tolist(), place.tolist(), strict=True):
            if not math.isfinite(a + b + c):
                continue
            lines = [(a, c, b, c), *((end, c - CAP_PT, end, c + CAP_PT) for end in (a, b))]
            if axis == "y":
                lines = [(y0, x0, y1, x1) for x0, y0, x1, y1 in lines]
            path += "".join(f"M{x0:.2f} {y0:.2f}L{x1:.2f} {y1:.2f}" for x0, y0, x1, y1 in lines)
        return path

    def _rule(self, mark: Rule) -> None:
        scale = self.x if mark.axis == "x" else self.y
        low, high = sorted(float(scale(end)) for end in (mark.at, mark.at if mark.to is None else mark.to))
        if mark.axis == "x":
            line, sides = f"M{low:.2f} {self.top:.2f}V{self.bottom:.2f}", (low, self.top, high, self.bottom)
        else:
            line, sides = f"M{self.left:.2f} {low:.2f}H{self.right:.2f}", (self.left, low, self.right, high)
        if mark.to is None:
            self._add(f'<path d="{line}" {_stroke(mark, mark.width, mark.dash)}/>')
        else:
            self._add(f"{_rectangle(*sides)} {_fill(mark)}/>")

    def _in_frame(self, x: float) -> float:
        return self.left + x * (self.right - self.left)

    def _ellipses(self, mark: Ellipses) -> None:
        x = [self._in_frame(at) for at in mark.x.tolist()] if mark.beside else self.x(mark.x).tolist()
        shapes = zip(x, self.y(mark.y), mark.widths, mark.heights, mark.angles_deg, strict=True)
        drawn = "".join(
            f'<ellipse rx="{width / 2:.2f}" ry="{height / 2:.2f}" '
            f'transform="translate({at:.2f} {y:.2f}) rotate({-angle:.1f})"/>'
            for at, y, width, height, angle in shapes
            if math.isfinite(at + y + width + height + angle)
        )
        if drawn:
            look = f'fill="{mark.face}" stroke="{mark.colour}" stroke-width=".9"'
            self._add(f"<g {look}>{drawn}</g>", clipped=False)

    def _text(self, mark: Text) -> None:
        x = self._in_frame(mark.x) if mark.frame else float(self.x(mark.x))
        y = self.bottom - mark.y * (self.bottom - self.top) if mark.frame == "xy" else float(self.y(mark.y))
        extra = ' font-weight="bold" font-style="italic"' if mark.tag else ""
        size = self.size * mark.size / FONT_PT
        x, y = x + mark.right, y - mark.up
        sides = mark.horizontal, mark.vertical
        self.texts.append(TextBox(mark.text, x, y, size, *sides, mark.colour, extra, mark.tag))

    def _legend(self) -> None:
        """Draw the legend, marks of one name by one sample."""
        samples: dict[str, list[AnyMark]] = {}
        for mark in self.panel.marks:
            if mark.label and not mark.label.startswith("_"):
                samples.setdefault(mark.label, []).append(mark)
        if not samples:
            return
        size, handle, row = self.legend_size, 1.8 * self.legend_size, 1.45 * self.legend_size
        columns = legend_columns(self.panel, len(samples))
        rows = math.ceil(len(samples) / columns)
        names = list(samples)
        parts = [names[k : k + rows] for k in range(0, len(names), rows)]
        widths = [max(line_width(name, size) for name in part) for part in parts]
        step = handle + 0.8 * size
        if self.panel.legend == "above":
            left, top = self._in_frame(-0.02), self.top - rows * row - 1
        elif self.panel.legend == "below":
            left, top = (self.left + self.right - widths[0] - step) / 2, self.bottom + 4
        else:
            left, top = self.left + 5, self.top + 2
        for part, width in zip(parts, widths, strict=True):
            for number, name in enumerate(part):
                low = top + (number + 0.55) * row
                for mark in samples[name]:
                    self._add(_sample(mark, left, low, handle), clipped=False)
                self.texts.append(TextBox(name, left + step, low, size, vertical="center"))
            left += step + width + 1.4 * size


def legend_columns(panel: Panel, count: int) -> int:
    """Return the number of columns of a legend of so many names."""
    return panel.columns or (2 if panel.legend == "above" and count > 3 else 1)


def _sample(mark: AnyMark, x: float, y: float, width: float) -> str:
    """Return what a legend shows of a mark."""
    match mark:
        case Points():
            spot = _spots(np.array([x + width / 2]), np.array([y]), mark)
            return f'<path d="{spot}" {_marker_look(mark)}/>' if mark.marker else ""
        case Line() | Rule(to=None):
            return f'<path d="M{x:.2f} {y:.2f}h{width:.2f}" {_stroke(mark, mark.width, mark.dash)}/>'
        case _:
            return f"{_rectangle(x, y - 2.4, x + width, y + 2.4)} {_fill(mark)}/>"


def _stroke(mark: Mark, width: float, dash: str = "-") -> str:
    """Return the attributes of a line."""
    face = mark.face if isinstance(mark, Line) and mark.face else "none"
    look = f'fill="{face}" stroke="{mark.colour}" stroke-width="{width:g}"'
    if dash in _DASHES:
        look += f' stroke-dasharray="{" ".join(f"{part * width:.2g}" for part in _DASHES[dash])}"'
    return look if mark.alpha == 1 else f'{look} stroke-opacity="{mark.alpha:g}"'


def _fill(mark: Mark) -> str:
    """Return the attributes of an area."""
    return f'fill="{mark.colour}" fill-opacity="{mark.alpha:g}"'


def _marker_look(mark: Points) -> str:
    """Return the attributes of markers."""
    look = f'fill="{mark.face or mark.colour}" stroke="{mark.edge or mark.colour}"'
    look += f' stroke-width="{mark.edge_width:g}"'
    return look if mark.alpha == 1 else f'{look} opacity="{mark.alpha:g}"'


def _rectangle(left: float, top: float, right: float, bottom: float) -> str:
    """Return an element that is still open."""
    return f'<rect x="{left:.2f}" y="{top:.2f}" width="{right - left:.2f}" height="{bottom - top:.2f}"'


def _polyline(x: FloatArray, y: FloatArray) -> str:
    """Return the path of a line, broken where a point is missing."""
    parts, command = [], "M"
    for a, b in zip(x.tolist(), y.tolist(), strict=True):
        known = math.isfinite(a + b)
        parts += [f"{command}{a:.2f} {b:.2f}"] if known else []
        command = "L" if known else "M"
    return "".join(parts)


def _spots(x: FloatArray, y: FloatArray, mark: Points) -> str:
    """Return the path of markers."""
    size, half = mark.size, mark.size / 2
    match mark.marker:
        case "s":
            shape = f"m{-half:.2f} {-half:.2f}h{size:.2f}v{size:.2f}h{-size:.2f}z"
        case "D":
            d = size / math.sqrt(2)
            shape = f"m0 {-d:.2f}l{d:.2f} {d:.2f}l{-d:.2f} {d:.2f}l{-d:.2f} {-d:.2f}z"
        case "v":
            shape = f"m{-half:.2f} {-half:.2f}h{size:.2f}l{-half:.2f} {size:.2f}z"
        case _:
            r = half / 2 if mark.marker == "." else half
            shape = f"m{-r:.2f} 0a{r:.2f} {r:.2f} 0 1 0 {2 * r:.2f} 0a{r:.2f} {r:.2f} 0 1 0 {-2 * r:.2f} 0z"
    places = zip(x.tolist(), y.tolist(), strict=True)
    return "".join(f"M{a:.2f} {b:.2f}{shape}" for a, b in places if math.isfinite(a + b))


def decimal_labels(places: Iterable[float]) -> list[str]:
    """Return numbers with as many decimals as the finest of them needs."""
    every = list(places)
    for decimals in range(8):
        words = [f"{place + 0.0:.{decimals}f}" for place in every]
        step = abs(every[1] - every[0]) if len(every) > 1 else 1.0
        if all(abs(float(word) - place) <= 1e-3 * step for word, place in zip(words, every, strict=True)):
            break
    return [word.replace("-", "−") if float(word) else word.lstrip("-") for word in words]
