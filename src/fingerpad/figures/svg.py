"""SVG of figures that are kept as data, in the style of `fingerpad.figures.style`, some fifty times as fast.

Lengths are points, 1/72 inch, from the upper left corner.
"""

import hashlib
import math
from collections.abc import Iterable
from dataclasses import dataclass
from html import escape
from typing import Any, Final, assert_never

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array
from fingerpad.figures import marks, style
from fingerpad.figures.style import CAP_PT, FONT_PT
from fingerpad.figures.svg_text import FONT_FAMILY, LINE_HEIGHT, TextBox, line_width
from fingerpad.units import MM_PER_INCH

_POINTS_PER_MM: Final = 72 / MM_PER_INCH
_EDGE: Final = 3.0  # free of anything beside and between panels
_TICK, _PAD = 3.5, 3.0
_MOST_TICKS: Final = 9
_LEAST: Final = 1e-30
_DASHES: Final = {"--": (3.7, 1.6), ":": (1.0, 1.65), "-.": (6.4, 1.6, 1.0, 1.6)}  # of the line's width
# Of the size of a marker, from its centre; others are round.
_CORNERS: Final = {
    "s": ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)),
    "D": ((0.0, -0.707), (0.707, 0.0), (0.0, 0.707), (-0.707, 0.0)),
    "v": ((-0.5, -0.5), (0.5, -0.5), (0.0, 0.5)),
}


def svg(figure: marks.Figure, name: str, *, description: str = "") -> str:
    """Return a figure as an ``<svg>`` element that can stand in an HTML page beside others.

    The `name` tells it from others that look the same.
    """
    width, height = _POINTS_PER_MM * figure.width_mm, _POINTS_PER_MM * figure.height_mm
    factor = figure.font_pt / FONT_PT
    drawings = [_Drawing(panel, f"@clip{number}", factor) for number, panel in enumerate(figure.panels)]
    _place(drawings, figure, width, height)
    body = "".join(drawing.element() for drawing in drawings)
    digest = hashlib.sha256(f"{name}\0{body}".encode()).hexdigest()
    prefix = f"figure-{digest[:12]}"  # no other drawing in a page has such ids
    said = f' role="img" aria-label="{escape(description)}"' if description else ""
    return (
        f'<svg id="{prefix}"{said} xmlns="http://www.w3.org/2000/svg" width="{width:.2f}pt" '
        f'height="{height:.2f}pt" viewBox="0 0 {width:.2f} {height:.2f}" font-family="{FONT_FAMILY}">'
        f'<rect width="100%" height="100%" fill="#fff"/>{body.replace("@clip", f"{prefix}-")}</svg>\n'
    )


def _place(drawings: list["_Drawing"], figure: marks.Figure, width: float, height: float) -> None:
    """Give all panels frames of one size, such that all that stands outside of the frames has room."""
    shape = figure.rows, figure.columns
    margins = np.zeros((*shape, 4))
    for final in (False, False, True):  # what stands beside a frame moves with it
        left, right = margins[..., 0].max(axis=0), margins[..., 1].max(axis=0)
        top, bottom = margins[..., 2].max(axis=1), margins[..., 3].max(axis=1)
        size = (width - (left + right).sum()) / shape[1], (height - (top + bottom).sum()) / shape[0]
        size = max(size[0], 0.1 * width / shape[1]), max(size[1], 0.1 * height / shape[0])
        x = np.cumsum(left + np.append(0.0, right[:-1] + size[0]))
        y = np.cumsum(top + np.append(0.0, bottom[:-1] + size[1]))
        for place, drawing in zip(np.ndindex(shape), drawings, strict=True):
            box = float(x[place[1]]), float(y[place[0]]), *size
            if drawing.panel.place is not None:
                left, bottom, across, up = drawing.panel.place
                box = left * width, (1 - bottom - up) * height, across * width, up * height
            drawing.place(*box, final=final)
            margins[place] = drawing.margins() + _EDGE


@dataclass(slots=True)
class _Scale:
    """From data to points along one axis."""

    axis: marks.Axis
    low: float
    high: float
    begin: float = 0.0
    end: float = 1.0

    def __call__(self, values: Any) -> Any:
        """Return places on paper."""
        low, high = self.low, self.high
        if self.axis.log:  # what is not above zero lies far outside
            values, low, high = (np.log10(np.maximum(one, _LEAST)) for one in (values, low, high))
        return self.begin + (values - low) / (high - low) * (self.end - self.begin)

    def ticks(self, room: float) -> list[tuple[float, str]]:
        """Return places of ticks with their labels, one for each `room` points at most."""
        low, high = sorted((self.low, self.high))
        most = min(max(int(abs(self.end - self.begin) / room), 1), _MOST_TICKS)
        locator, formatter = style.tick_rule(self.axis, low, high, most)
        values = list(locator.tick_values(low, high))
        edge = 1e-9 * (high - low)
        return [
            (float(self(value)), label)
            for value, label in zip(values, formatter.format_ticks(values), strict=True)
            if low - edge <= value <= high + edge
        ]


class _Drawing:
    """The drawing of one panel."""

    def __init__(self, panel: marks.Panel, clip: str, factor: float) -> None:
        self.panel, self.clip = panel, clip
        self.factor, self.size, self.tick_size = factor, factor * FONT_PT, factor * style.TICK_PT
        self.x, self.y = (_Scale(getattr(panel, name), *panel.limits(name)) for name in ("x", "y"))

    def place(self, left: float, top: float, width: float, height: float, *, final: bool) -> None:
        """Draw in a frame; until it is the final one, only what takes room beside it."""
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
        self.samples: list[tuple[float, float, float, float]] = []  # of the legend, as boxes of texts
        if self.panel.framed:
            self._axes()
        for mark in self.panel.marks:
            if final or isinstance(mark, marks.Text):
                self._draw(mark)
        self._write(self.panel.title, self.left, self.top - 4, self.size)
        if self.panel.legend:
            self._legend()

    def margins(self) -> FloatArray:
        """Return how far text and legends reach beyond the frame: left, right, top and bottom."""
        boxes = np.reshape([*self.samples, *(text.box() for text in self.texts)], (-1, 4))
        beyond = (boxes - (self.left, self.right, self.top, self.bottom)) * (-1, 1, -1, 1)
        return as_float_array(beyond.max(axis=0, initial=0.0))

    def element(self) -> str:
        """Return what is drawn, from the lowest up."""
        frame = _rectangle((self.left, self.right), (self.top, self.bottom))
        texts = "".join(text.element() for text in self.texts)
        return f'<clipPath id="{self.clip}">{frame}</clipPath>{"".join(self.drawn)}{texts}'

    def _axes(self) -> None:
        """Draw the grid, the axes, their ticks and their labels."""
        left, right, top, bottom = self.left, self.right, self.top, self.bottom
        below, beside, far = bottom + _TICK + _PAD, left - _TICK - _PAD, 0.0
        grid, ticks = "", f"M{left:.2f} {top:.2f}V{bottom:.2f}H{right:.2f}"
        for x, label in self.x.ticks(3 * self.tick_size):
            if self.panel.x.lines:
                grid += f"M{x:.2f} {top:.2f}V{bottom:.2f}"
                ticks += f"M{x:.2f} {bottom:.2f}v{_TICK}"
            self._write(label, x, below, self.tick_size, horizontal="center", vertical="top")
        for y, label in self.y.ticks(2 * self.tick_size):
            if self.panel.y.lines:
                grid += f"M{left:.2f} {y:.2f}H{right:.2f}"
                ticks += f"M{left:.2f} {y:.2f}h-{_TICK}"
            self._write(label, beside, y, self.tick_size, horizontal="right", vertical="center")
            far = max(far, line_width(label, self.tick_size))
        self._add(f'<path d="{grid}" stroke="{style.GRID}" stroke-width=".5"/>')
        self._add(f'<path d="{ticks}" fill="none" stroke="{style.BLACK}" stroke-width=".6"/>')
        x, y = (left + right) / 2, below + LINE_HEIGHT * self.tick_size + 1
        self._write(self.panel.x.label, x, y, self.size, horizontal="center", vertical="top")
        x, y = beside - far - 0.45 * self.size, (top + bottom) / 2
        self._write(self.panel.y.label, x, y, self.size, horizontal="center", turned=True)

    def _write(self, text: str, x: float, y: float, size: float, **look: Any) -> None:
        if text:
            self.texts.append(TextBox(text, x, y, size, **look))

    def _add(self, element: str, *, clipped: bool = False) -> None:
        self.drawn.append(f'<g clip-path="url(#{self.clip})">{element}</g>' if clipped else element)

    def _draw(self, mark: marks.AnyMark) -> None:
        match mark:
            case marks.Points():
                bars = self._bars(mark, "x") + self._bars(mark, "y")
                lines = f'<path d="{bars}" {_stroke(mark, mark.bar_width)}/>' if bars else ""
                self._add(lines + _spots(self.x(mark.x), self.y(mark.y), mark), clipped=True)
            case marks.Line():
                line = _polyline(self.x(mark.x), self.y(mark.y))
                self._add(f'<path d="{line}" {_stroke(mark, mark.width, mark.dash)}/>', clipped=mark.clipped)
            case marks.Band():
                known = np.isfinite(mark.x + mark.low + mark.high)
                x, y = mark.x[known], np.append(mark.low[known], mark.high[known][::-1])
                outline = _polyline(self.x(np.append(x, x[::-1])), self.y(y))
                self._add(f'<path d="{outline}" {_fill(mark)}/>', clipped=True)
            case marks.Rule():
                x, y = np.array([self.left, self.right]), np.array([self.top, self.bottom])
                ends = np.array([mark.at, mark.at if mark.to is None else mark.to])
                x, y = (self.x(ends), y) if mark.axis == "x" else (x, self.y(ends))
                line = f'<path d="{_polyline(x, y)}" {_stroke(mark, mark.width, mark.dash)}/>'
                self._add(line if mark.to is None else _rectangle(x, y, _fill(mark)), clipped=True)
            case marks.Bars():
                for place, length in zip(mark.place, mark.length, strict=True):
                    sides = place - mark.height / 2, place + mark.height / 2
                    x, y = self.x(np.array([0.0, length])), self.y(np.array(sides))
                    self._add(_rectangle(x, y, _fill(mark)), clipped=True)
            case marks.Ellipses():
                self._ellipses(mark)
            case marks.Text():
                self._text(mark)
            case marks.Picture():
                x, y = self.x(np.array([mark.left, mark.right])), self.y(np.array([mark.top, mark.bottom]))
                source = f'preserveAspectRatio="none" href="data:image/png;base64,{mark.png}"'
                self._add(_rectangle(x, y, source, tag="image"), clipped=True)
            case _:
                assert_never(mark)

    def _bars(self, mark: marks.Points, axis: str) -> str:
        """Return the path of the bars along an axis, each with a line at its ends."""
        data, other = marks.data_of(mark), {"x": "y", "y": "x"}[axis]
        if f"{axis}_std" not in data:
            return ""
        scale, at, std = getattr(self, axis), data[axis], data[f"{axis}_std"]
        low, high, place = scale(at - std), scale(at + std), getattr(self, other)(data[other])
        gap, before, after = np.full(low.shape, np.nan), place - CAP_PT, place + CAP_PT
        along = np.stack([low, high, gap, low, low, gap, high, high, gap], axis=-1).ravel()
        across = np.stack([place, place, gap, before, after, gap, before, after, gap], axis=-1).ravel()
        return _polyline(along, across) if axis == "x" else _polyline(across, along)

    def _in_frame(self, x: Any) -> Any:
        return self.left + x * (self.right - self.left)

    def _at(self, mark: marks.Ellipses | marks.Text) -> tuple[Any, Any]:
        x = self._in_frame(mark.x) if mark.frame else self.x(mark.x)
        y = self.bottom - mark.y * (self.bottom - self.top) if mark.frame == "xy" else self.y(mark.y)
        return x, y

    def _ellipses(self, mark: marks.Ellipses) -> None:
        shapes = np.stack([mark.widths / 2, mark.heights / 2, *self._at(mark), -mark.angles_deg], axis=-1)
        drawn = "".join(
            f'<ellipse rx="{a:.2f}" ry="{b:.2f}" transform="translate({x:.2f} {y:.2f}) rotate({turn:.1f})"/>'
            for a, b, x, y, turn in shapes[np.isfinite(shapes).all(axis=1)].tolist()
        )
        self._add(f'<g fill="{mark.face}" stroke="{mark.colour}" stroke-width=".9">{drawn}</g>')

    def _text(self, mark: marks.Text) -> None:
        x, y = self._at(mark)
        look = {name: getattr(mark, name) for name in ("horizontal", "vertical", "colour", "tag", "halo")}
        self._write(mark.text, x + mark.right, y - mark.up, self.size * mark.size / FONT_PT, **look)

    def _legend(self) -> None:
        """Draw the legend, marks of one name by one sample."""
        samples: dict[str, list[marks.AnyMark]] = {}
        for mark in self.panel.marks:
            if mark.label and not mark.label.startswith("_"):
                samples.setdefault(mark.label, []).append(mark)
        if not samples:
            return
        size = self.factor * style.LEGEND_PT
        handle, row = 1.8 * size, 1.45 * size
        rows = math.ceil(len(samples) / self.panel.legend_columns(len(samples)))
        names, step = list(samples), handle + 0.8 * size
        parts = [names[k : k + rows] for k in range(0, len(names), rows)]
        widths = [max(line_width(name, size) for name in part) for part in parts]
        left, top = {
            "above": (self._in_frame(-0.02), self.top - rows * row - 1),
            "inside": (self.left + 5, self.top + 2),
            "below": ((self.left + self.right - widths[0] - step) / 2, self.bottom + 4),
        }[self.panel.legend]
        for part, width in zip(parts, widths, strict=True):
            for number, name in enumerate(part):
                low = top + (number + 0.55) * row
                self.samples.append((left, left + handle, low - row / 2, low + row / 2))
                for mark in samples[name]:
                    self._add(_sample(mark, left, low, handle))
                self._write(name, left + step, low, size, vertical="center")
            left += step + width + 1.4 * size


def _sample(mark: marks.AnyMark, x: float, y: float, width: float) -> str:
    """Return what a legend shows of a mark."""
    match mark:
        case marks.Points():
            return _spots([x + width / 2], [y], mark)
        case marks.Line() | marks.Rule(to=None):
            return f'<path d="M{x:.2f} {y:.2f}h{width:.2f}" {_stroke(mark, mark.width, mark.dash)}/>'
        case _:
            return _rectangle((x, x + width), (y - 2.4, y + 2.4), _fill(mark))


def _stroke(mark: marks.Mark, width: float, dash: str = "-") -> str:
    """Return the attributes of a line."""
    face = mark.face if isinstance(mark, marks.Line) and mark.face else "none"
    look = f'fill="{face}" stroke="{mark.colour}" stroke-width="{width:g}"'
    if dash in _DASHES:
        look += f' stroke-dasharray="{" ".join(f"{part * width:.2g}" for part in _DASHES[dash])}"'
    return look + _unless_opaque(mark, "stroke-opacity")


def _fill(mark: marks.Mark) -> str:
    """Return the attributes of an area."""
    return f'fill="{mark.colour}" fill-opacity="{mark.alpha:g}"'


def _rectangle(x: Iterable[float], y: Iterable[float], look: str = "", *, tag: str = "rect") -> str:
    """Return an element between two places along x and two along y."""
    (left, right), (top, bottom) = sorted(x), sorted(y)
    size = f'width="{right - left:.2f}" height="{bottom - top:.2f}"'
    return f'<{tag} x="{left:.2f}" y="{top:.2f}" {size} {look}/>'


def _polyline(x: FloatArray, y: FloatArray) -> str:
    """Return the path of a line, broken where a point is missing."""
    parts, command = [], "M"
    for a, b in zip(x.tolist(), y.tolist(), strict=True):
        known = math.isfinite(a + b)
        parts += [f"{command}{a:.2f} {b:.2f}"] if known else []
        command = "L" if known else "M"
    return "".join(parts)


def _spots(x: ArrayLike, y: ArrayLike, mark: marks.Points) -> str:
    """Return the markers of points."""
    if not mark.marker:
        return ""
    if mark.marker in _CORNERS:
        steps = mark.size * np.diff(_CORNERS[mark.marker], axis=0, prepend=0)
        shape = f"m{'l'.join(f'{right:.2f} {down:.2f}' for right, down in steps.tolist())}z"
    else:
        r = mark.size / (4 if mark.marker == "." else 2)
        shape = f"m{-r:.2f} 0a{r:.2f} {r:.2f} 0 1 0 {2 * r:.2f} 0a{r:.2f} {r:.2f} 0 1 0 {-2 * r:.2f} 0z"
    places = np.column_stack([x, y]).tolist()
    spots = "".join(f"M{a:.2f} {b:.2f}{shape}" for a, b in places if math.isfinite(a + b))
    look = f'fill="{mark.face or mark.colour}" stroke="{mark.edge or mark.colour}"'
    look += f' stroke-width="{mark.edge_width:g}"' + _unless_opaque(mark, "opacity")
    return f'<path d="{spots}" {look}/>'


def _unless_opaque(mark: marks.Mark, name: str) -> str:
    return "" if mark.alpha == 1 else f' {name}="{mark.alpha:g}"'
