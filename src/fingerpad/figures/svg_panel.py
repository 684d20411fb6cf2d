"""SVG of one panel of a figure: its axes, what is drawn on them, and its legend.

Lengths are points, 1/72 inch, from the upper left corner of the figure.
"""

import math
from collections.abc import Iterator
from typing import Any, Final, NamedTuple

import numpy as np
from matplotlib.ticker import LogLocator, MaxNLocator

from fingerpad._arrays import FloatArray
from fingerpad.figures.panels import Call, Panel, numbers
from fingerpad.figures.style import BLACK, GRID, LOG_SUBS
from fingerpad.figures.svg_axes import Limits, decimal_labels
from fingerpad.figures.svg_labels import TextBox
from fingerpad.figures.svg_paths import fill, marker_look, markers, polyline, stroke
from fingerpad.figures.svg_text import LINE_HEIGHT, line_width, text_element

_SIZE, _TICK_SIZE, _LEGEND_SIZE = 7.5, 7.0, 6.8  # of fonts
_TICK, _PAD = 3.5, 3.0
_CAP: Final = 1.8
_ROW, _HANDLE, _COLUMN_GAP = 1.45 * _LEGEND_SIZE, 1.8 * _LEGEND_SIZE, 1.4 * _LEGEND_SIZE
_MOST_TICKS: Final = 9
_BELOW, _MIDDLE, _DATA = 0.0, 1.0, 2.0  # layers: grid; bands and bars; lines


class _Sample(NamedTuple):
    """What a legend shows beside a label."""

    label: str
    line: str = ""
    marker: tuple[str, float] | None = None
    look: str = ""
    bar: str = ""


class PanelDrawing:
    """The drawing of one panel."""

    def __init__(self, panel: Panel, clip: str) -> None:
        self.panel, self.clip = panel, clip
        self.by_name: dict[str, list[Call]] = {}
        for call in panel.calls:
            self.by_name.setdefault(call.name, []).append(call)
        limits = Limits(panel, self.by_name)
        self.x, self.y = limits.scale("x"), limits.scale("y")
        self.framed = "set_axis_off" not in self.by_name
        self.equal = "set_aspect" in self.by_name
        self.layers: list[tuple[float, str]] = []
        self.texts: list[TextBox] = []
        self.samples: list[_Sample] = []

    def place(self, left: float, top: float, width: float, height: float) -> None:
        """Draw in a frame."""
        if self.equal:
            spans = self.x.high - self.x.low, self.y.high - self.y.low
            scale = min(width / spans[0], height / spans[1])
            inner = scale * spans[0], scale * spans[1]
            left, top = left + (width - inner[0]) / 2, top + (height - inner[1]) / 2
            width, height = inner
        self.left, self.right, self.top, self.bottom = left, left + width, top, top + height
        self.x.begin, self.x.end = self.left, self.right
        self.y.begin, self.y.end = self.bottom, self.top
        self.layers, self.texts, self.samples = [], [], []
        if self.framed:
            self._axes()
        for call in self.panel.calls:
            draw = getattr(self, f"_draw_{call.name.removeprefix('draw_')}", None)
            if draw is not None:
                draw(*call.args, **call.options)
        self._titles()
        self._legend()

    def margins(self) -> tuple[float, float, float, float]:
        """Return how far text and legends reach beyond the frame: left, right, top and bottom."""
        boxes = [text.box() for text in self.texts]
        if not boxes:
            return 0.0, 0.0, 0.0, 0.0
        low_x, high_x, low_y, high_y = zip(*boxes, strict=True)
        return (
            max(0.0, self.left - min(low_x)) + self._ylabel_room(),
            max(0.0, max(high_x) - self.right),
            max(0.0, self.top - min(low_y)),
            max(0.0, max(high_y) - self.bottom),
        )

    def elements(self) -> Iterator[str]:
        """Yield what is drawn, from the lowest layer up."""
        yield (
            f'<clipPath id="{self.clip}"><rect x="{self.left:.2f}" y="{self.top:.2f}" '
            f'width="{self.right - self.left:.2f}" height="{self.bottom - self.top:.2f}"/></clipPath>'
        )
        for _, element in sorted(self.layers, key=lambda layer: layer[0]):
            yield element
        for text in self.texts:
            yield text.element()
        label = self._label("set_ylabel")
        if label and self.framed:
            x, y = self.left - self._tick_room() - _SIZE * 0.45, (self.top + self.bottom) / 2
            inner = text_element(label, _SIZE, BLACK, "middle", f' transform="rotate(-90 {x:.2f} {y:.2f})"')
            yield f'<text x="{x:.2f}" y="{y:.2f}" {inner}'

    # Axes

    def _label(self, name: str) -> str:
        calls = self.by_name.get(name)
        return calls[-1].args[0] if calls else ""

    def _tick_room(self) -> float:
        labels = [label for _, label in self._ticks("y")]
        return _TICK + _PAD + max((line_width(label, _TICK_SIZE) for label in labels), default=0.0)

    def _ylabel_room(self) -> float:
        return 1.7 * _SIZE if self.framed and self._label("set_ylabel") else 0.0

    def _ticks(self, axis: str) -> list[tuple[float, str]]:
        scale = self.x if axis == "x" else self.y
        given = self.by_name.get(f"set_{axis}ticks")
        if given:
            places = given[-1].args[0]
            labels = given[-1].args[1] if len(given[-1].args) > 1 else [f"{place:g}" for place in places]
        elif scale.log:
            few = scale.high < 100 * scale.low
            subs = LOG_SUBS if few or "plain_log_ticks" in self.by_name else (1.0,)
            places = np.asarray(LogLocator(subs=subs).tick_values(scale.low, scale.high)).tolist()
            labels = [f"{place:g}" for place in places]
        else:
            size = (3 if axis == "x" else 2) * _TICK_SIZE
            most = min(max(int(abs(scale.end - scale.begin) / size), 1), _MOST_TICKS)
            ticks = MaxNLocator(most, steps=(1, 2, 2.5, 5, 10)).tick_values(scale.low, scale.high)
            places = np.asarray(ticks).tolist()
            labels = decimal_labels(places)
        room = 1e-9 * abs(scale.high - scale.low)
        return [
            (float(scale(place)), label)
            for place, label in zip(places, labels, strict=True)
            if min(scale.low, scale.high) - room <= place <= max(scale.low, scale.high) + room
        ]

    def _axes(self) -> None:
        """Draw the grid, the axes and their ticks."""
        hidden = {
            call.options.get("axis", "both")
            for call in self.by_name.get("grid", ())
            if not call.options["visible"]
        }
        grid, marks = "", f"M{self.left:.2f} {self.top:.2f}V{self.bottom:.2f}H{self.right:.2f}"
        for x, label in self._ticks("x"):
            grid += "" if hidden & {"x", "both"} else f"M{x:.2f} {self.top:.2f}V{self.bottom:.2f}"
            marks += f"M{x:.2f} {self.bottom:.2f}v{_TICK}"
            self.texts.append(TextBox(label, x, self.bottom + _TICK + _PAD, _TICK_SIZE, "center", "top"))
        for y, label in self._ticks("y"):
            grid += "" if hidden & {"y", "both"} else f"M{self.left:.2f} {y:.2f}H{self.right:.2f}"
            marks += "" if "tick_params" in self.by_name else f"M{self.left:.2f} {y:.2f}h-{_TICK}"
            self.texts.append(TextBox(label, self.left - _TICK - _PAD, y, _TICK_SIZE, "right", "center"))
        self.layers.append((_BELOW, f'<path d="{grid}" stroke="{GRID}" stroke-width=".5"/>'))
        self.layers.append((2.5, f'<path d="{marks}" fill="none" stroke="{BLACK}" stroke-width=".6"/>'))

    def _titles(self) -> None:
        label = self._label("set_xlabel")
        if label and self.framed:
            low = self.bottom + _TICK + _PAD + LINE_HEIGHT * _TICK_SIZE + 1
            self.texts.append(TextBox(label, (self.left + self.right) / 2, low, _SIZE, "center", "top"))
        if title := self._label("set_title"):
            self.texts.append(TextBox(title, self.left, self.top - 4, _SIZE))

    # What is drawn on axes, by the name of Matplotlib's method

    def _add(self, layer: float, element: str, *, clipped: bool = True) -> None:
        self.layers.append((layer, f'<g clip-path="url(#{self.clip})">{element}</g>' if clipped else element))

    def _sample(self, label: str | None, **what: Any) -> None:
        if label and not label.startswith("_"):
            self.samples.append(_Sample(label, **what))

    def _draw_plot(self, x: Any, y: Any, style: str = "-", **options: Any) -> None:
        marker, line = _split(style)
        line = options.get("linestyle", line)
        xs, ys = _paired(x, y)
        px, py = self.x(xs), self.y(ys)
        layer, colour = options.get("zorder", _DATA), options.get("color", BLACK)
        clipped = options.get("clip_on", True)
        look, spots = stroke(colour, options.get("linewidth", 1.2), line, options.get("alpha")), ""
        sample: dict[str, Any] = {"line": look} if line else {}
        if line and px.size:
            self._add(layer, f'<path d="{polyline(px, py)}" {look}/>', clipped=clipped)
        if marker:
            size = options.get("markersize", 4.0)
            spots = marker_look(options, colour)
            self._add(layer, f'<path d="{markers(px, py, marker, size)}" {spots}/>', clipped=clipped)
            sample |= {"marker": (marker, size), "look": spots}
        self._sample(options.get("label"), **sample)

    def _draw_errorbar(self, x: Any, y: Any, fmt: str = "o", **options: Any) -> None:
        xs, ys = _paired(x, y)
        path = ""
        for name, horizontal in (("xerr", True), ("yerr", False)):
            if name in options:
                std = np.broadcast_to(numbers(options[name]), xs.shape)
                path += self._bars(xs, ys, std, horizontal=horizontal)
        colour, layer = options.get("color", BLACK), options.get("zorder", _DATA)
        if path:
            look = stroke(colour, options.get("elinewidth", 1.2), "-", options.get("alpha"))
            self._add(layer, f'<path d="{path}" {look}/>')
        plain = {name: value for name, value in options.items() if name not in {"xerr", "yerr", "elinewidth"}}
        self._draw_plot(x, y, fmt, **plain)

    def _bars(self, x: FloatArray, y: FloatArray, std: FloatArray, *, horizontal: bool) -> str:
        if horizontal:
            low, high, at = self.x(x - std), self.x(x + std), self.y(y)
        else:
            low, high, at = self.y(y - std), self.y(y + std), self.x(x)
        # Below zero a logarithmic axis has no place: the bar leaves the frame.
        low = np.where(np.isnan(low) & np.isfinite(high), self.bottom + 99, low)
        parts = []
        for a, b, c in zip(low.tolist(), high.tolist(), at.tolist(), strict=True):
            if not math.isfinite(a + b + c):
                continue
            if horizontal:
                parts.append(f"M{a:.2f} {c:.2f}H{b:.2f}")
                parts += [f"M{end:.2f} {c - _CAP:.2f}v{2 * _CAP}" for end in (a, b)]
            else:
                parts.append(f"M{c:.2f} {a:.2f}V{b:.2f}")
                parts += [f"M{c - _CAP:.2f} {end:.2f}h{2 * _CAP}" for end in (a, b)]
        return "".join(parts)

    def _draw_fill_between(self, x: Any, low: Any, high: Any = 0.0, **options: Any) -> None:
        xs, below, above = np.broadcast_arrays(*map(numbers, (x, low, high)))
        known = np.isfinite(xs + below + above)
        across = np.concatenate([xs[known], xs[known][::-1]])
        outline = polyline(self.x(across), self.y(np.concatenate([below[known], above[known][::-1]])))
        self._add(_MIDDLE, f'<path d="{outline}" {fill(options)}/>')

    def _draw_barh(self, places: Any, widths: Any, **options: Any) -> None:
        half = options.get("height", 0.8) / 2
        zero = float(self.x(0.0))
        for place, end in zip(numbers(places).tolist(), self.x(numbers(widths)).tolist(), strict=True):
            top, bottom = float(self.y(place + half)), float(self.y(place - half))
            corner, size = (min(zero, end), min(top, bottom)), (abs(end - zero), abs(bottom - top))
            self._add_rectangle(*corner, *size, options)
        self._sample(options.get("label"), bar=fill(options))

    def _draw_axhline(self, y: float, **options: Any) -> None:
        line = f"M{self.left:.2f} {float(self.y(y)):.2f}H{self.right:.2f}"
        self._draw_rule(line, **options)

    def _draw_axvline(self, x: float, **options: Any) -> None:
        line = f"M{float(self.x(x)):.2f} {self.top:.2f}V{self.bottom:.2f}"
        self._draw_rule(line, **options)

    def _draw_rule(self, path: str, **options: Any) -> None:
        look = stroke(
            options.get("color", BLACK), options.get("linewidth", 1.2), options.get("linestyle", "-")
        )
        self._add(options.get("zorder", _DATA), f'<path d="{path}" {look}/>')

    def _draw_axvspan(self, low: float, high: float, **options: Any) -> None:
        left, right = float(self.x(low)), float(self.x(high))
        self._add_rectangle(left, self.top, right - left, self.bottom - self.top, options)

    def _draw_axhspan(self, low: float, high: float, **options: Any) -> None:
        top, bottom = float(self.y(high)), float(self.y(low))
        self._add_rectangle(self.left, top, self.right - self.left, bottom - top, options)

    def _add_rectangle(
        self, x: float, y: float, width: float, height: float, options: dict[str, Any]
    ) -> None:
        rectangle = f'<rect x="{x:.2f}" y="{y:.2f}" width="{width:.2f}" height="{height:.2f}"'
        self._add(_MIDDLE, f"{rectangle} {fill(options)}/>")

    def _draw_annotate(self, text: str, xy: Any, xytext: Any = None, **options: Any) -> None:
        x, y = self._position(xy, options.get("xycoords", "data"))
        right, up = xytext or (0.0, 0.0)
        extra = ' font-weight="bold"' if options.get("weight") == "bold" else ""
        extra += ' font-style="italic"' if options.get("style") == "italic" else ""
        self.texts.append(
            TextBox(
                text,
                x + right,
                y - up,
                options.get("fontsize", _SIZE),
                options.get("ha", "left"),
                options.get("va", "baseline"),
                options.get("color", BLACK),
                extra,
                "bbox" in options,
            )
        )

    def _position(self, xy: Any, coordinates: Any) -> tuple[float, float]:
        across, upwards = [coordinates] * 2 if isinstance(coordinates, str) else coordinates
        x = float(self.x(xy[0])) if across == "data" else self.left + xy[0] * (self.right - self.left)
        y = float(self.y(xy[1])) if upwards == "data" else self.bottom - xy[1] * (self.bottom - self.top)
        return x, y

    def _draw_shapes(self, x: Any, y: Any, **options: Any) -> None:
        look = f'fill="{options["face"]}" stroke="{options["edge"]}" stroke-width=".9"'
        columns = (options["widths"], options["heights"], options["angles_deg"])
        across = "axes fraction" if options["beside"] else "data"
        drawn = ""
        for place, width, height, angle in zip(zip(x, y, strict=True), *columns, strict=True):
            if None in (*place, width, height, angle):
                continue
            px, py = self._position(place, (across, "data"))
            drawn += (
                f'<ellipse rx="{width / 2:.2f}" ry="{height / 2:.2f}" '
                f'transform="translate({px:.2f} {py:.2f}) rotate({-angle:.1f})"/>'
            )
        if drawn:
            self._add(4.0, f"<g {look}>{drawn}</g>", clipped=False)

    def _draw_picture(self, png: str, extent: Any) -> None:
        left, right, bottom, top = extent
        x, y = float(self.x(left)), float(self.y(top))
        self._add(
            _BELOW,
            f'<image x="{x:.2f}" y="{y:.2f}" width="{float(self.x(right)) - x:.2f}" '
            f'height="{float(self.y(bottom)) - y:.2f}" preserveAspectRatio="none" '
            f'href="data:image/png;base64,{png}"/>',
        )

    # Legends

    def _legend(self) -> None:
        calls = [*self.by_name.get("legend_above", ()), *self.by_name.get("legend", ())]
        if not calls or not self.samples:
            return
        call, count = calls[-1], len(self.samples)
        above = call.name == "legend_above"
        columns = call.options.get("columns") or (2 if above and count > 3 else 1)
        rows = math.ceil(count / columns)
        texts = [self.samples[k : k + rows] for k in range(0, count, rows)]
        widths = [max(line_width(one.label, _LEGEND_SIZE) for one in part) for part in texts]
        step = _HANDLE + 0.8 * _LEGEND_SIZE
        if above:
            left, top = self.left - 0.02 * (self.right - self.left), self.top - rows * _ROW - 1
        elif "bbox_to_anchor" in call.options:
            left, top = (self.left + self.right - widths[0] - step) / 2, self.bottom + 4
        else:
            left, top = self.left + 5, self.top + 2
        for part, width in zip(texts, widths, strict=True):
            for row, one in enumerate(part):
                self._add_sample(one, left, top + (row + 0.55) * _ROW)
                low = top + (row + 0.55) * _ROW
                self.texts.append(TextBox(one.label, left + step, low, _LEGEND_SIZE, vertical="center"))
            left += step + width + _COLUMN_GAP

    def _add_sample(self, one: _Sample, x: float, y: float) -> None:
        drawn = f'<path d="M{x:.2f} {y:.2f}h{_HANDLE:.2f}" {one.line}/>' if one.line else ""
        if one.bar:
            drawn += f'<rect x="{x:.2f}" y="{y - 2.4:.2f}" width="{_HANDLE:.2f}" height="4.8" {one.bar}/>'
        if one.marker:
            middle = np.array([x + _HANDLE / 2]), np.array([y])
            drawn += f'<path d="{markers(*middle, *one.marker)}" {one.look}/>'
        self._add(5.0, drawn, clipped=False)


def _split(style: str) -> tuple[str, str]:
    """Return the marker and the line of a format such as ``o-``, neither of ``none``."""
    if style == "none":
        return "", ""
    marker = style[:1] if style[:1] in {"o", "s", "D", "v", "."} else ""
    return marker, style[len(marker) :]


def _paired(x: Any, y: Any) -> tuple[FloatArray, FloatArray]:
    xs, ys = np.broadcast_arrays(np.atleast_1d(numbers(x)), np.atleast_1d(numbers(y)))
    return xs.ravel(), ys.ravel()
