"""Text of SVG drawings: its width, and simple formulas as runs of upright, slanted, low and high text."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Final, NamedTuple

import matplotlib as mpl
from PIL import ImageFont

from fingerpad.figures.style import BLACK, escaped

FONT_FAMILY: Final = "'DejaVu Sans', Verdana, sans-serif"
LINE_HEIGHT: Final = 1.2
_SCRIPT_SIZE: Final = 0.7
_LOWERED, _RAISED = 0.15, -0.38  # of the font size, downwards
_MEASURED_AT: Final = 100  # px
_ASCENT: Final = 0.76  # of digits and capitals, of the font size
_COMMANDS: Final = {"beta": "β", "ell": "ℓ", "pi": "π", "propto": " ∝ ", "tau": "τ", "xi": "ξ"}
_SPACED: Final = {"=": " = ", "±": " ± "}
_TOKEN: Final = re.compile(r"\\mathrm\{(?P<upright>[^{}]*)\}|\\(?P<command>[a-z]+)\s*|(?P<other>.)")
_SCRIPT: Final = re.compile(r"([_^])(\{(?:[^{}]|\{[^{}]*\})*\}|\\mathrm\{[^{}]*\}|\\[a-z]+|.)")


@dataclass(frozen=True, slots=True)
class Run:
    """Text of one kind: `script` is 1 for a superscript, −1 for a subscript, 0 on the line."""

    text: str
    slanted: bool = False
    script: int = 0

    def width(self, size: float) -> float:
        """Return the width at a font size, both in points."""
        return text_width(self.text, size * (_SCRIPT_SIZE if self.script else 1.0))


@cache
def runs(text: str) -> tuple[Run, ...]:
    r"""Return the runs of one line, in which formulas stand between dollar signs as in Matplotlib.

    Formulas have letters, ``\mathrm``, subscripts, superscripts, and the Greek letters of these figures.
    """
    found: list[Run] = []
    for place, part in enumerate(text.split("$")):
        if place % 2 == 0:
            found += [Run(part)] if part else []
            continue
        end = 0
        for match in _SCRIPT.finditer(part):
            found += _symbols(part[end : match.start()], 0)
            inner = match[2][1:-1] if match[2].startswith("{") else match[2]
            found += _symbols(inner, 1 if match[1] == "^" else -1)
            end = match.end()
        found += _symbols(part[end:], 0)
    return tuple(found)


def _symbols(formula: str, script: int) -> Iterator[Run]:
    """Yield the symbols of a formula without scripts: letters slanted, digits and signs upright."""
    for match in _TOKEN.finditer(formula):
        if match["upright"] is not None:
            yield Run(match["upright"], script=script)
        else:
            symbol = (
                _COMMANDS.get(match["command"], match["command"])
                if match["command"]
                else _SPACED.get(*2 * (match["other"],))
            )
            if symbol != " ":
                yield Run(symbol, slanted=symbol.isalpha(), script=script)


def line_width(text: str, size: float) -> float:
    """Return the width of the longest line of a text at a font size, both in points."""
    return max(sum(run.width(size) for run in runs(line)) for line in text.split("\n"))


@cache
def text_width(text: str, size: float) -> float:
    """Return the width of plain text at a font size, both in points."""
    return _font().getlength(text) * size / _MEASURED_AT


@cache
def _font() -> ImageFont.FreeTypeFont:
    file = Path(mpl.get_data_path(), "fonts", "ttf", "DejaVuSans.ttf")
    return ImageFont.truetype(file, _MEASURED_AT, layout_engine=ImageFont.Layout.BASIC)


@cache
def text_element(text: str, size: float, colour: str, anchor: str, extra: str = "") -> str:
    """Return a text of one line as the inner part of an element, to be placed by its x and y."""
    start = f'font-size="{size:g}" fill="{colour}"'
    start += f' text-anchor="{anchor}"' if anchor != "start" else ""
    return f"{start}{extra}>{''.join(_spans(runs(text), size))}</text>"


def _spans(of: tuple[Run, ...], size: float) -> Iterator[str]:
    """Yield the runs as spans, a superscript over the subscript before it."""
    height = 0.0
    before = Run("")
    for run in of:
        target = {0: 0.0, 1: _RAISED * size, -1: _LOWERED * size}[run.script]
        attributes = f' dy="{target - height:.2f}"' if target != height else ""
        if run.script == 1 and before.script == -1:
            attributes += f' dx="{-before.width(size):.2f}"'
        if run.script:
            attributes += f' font-size="{_SCRIPT_SIZE * size:.2f}"'
        if run.slanted:
            attributes += ' font-style="italic"'
        yield f"<tspan{attributes}>{escaped(run.text)}</tspan>" if attributes else escaped(run.text)
        height = target
        before = Run(before.text + run.text, script=run.script) if run.script == before.script == -1 else run


class TextBox(NamedTuple):
    """Text at a place, its lines separated by newlines."""

    text: str
    x: float
    y: float
    size: float
    horizontal: str = "left"
    vertical: str = "baseline"
    colour: str = BLACK
    extra: str = ""
    boxed: bool = False

    def baselines(self) -> list[float]:
        """Return y of the baseline of each line."""
        step, ascent = LINE_HEIGHT * self.size, _ASCENT * self.size
        count = self.text.count("\n")
        height = step * count + ascent
        above = {"top": 0.0, "center": height / 2, "bottom": height + 0.2 * self.size, "baseline": height}
        return [self.y - above[self.vertical] + ascent + step * number for number in range(count + 1)]

    def box(self) -> tuple[float, float, float, float]:
        """Return left, right, top and bottom."""
        width = line_width(self.text, self.size)
        left = self.x - {"left": 0.0, "center": width / 2, "right": width}[self.horizontal]
        baselines = self.baselines()
        return left, left + width, baselines[0] - _ASCENT * self.size, baselines[-1] + 0.2 * self.size

    def element(self) -> str:
        """Return the text as SVG."""
        anchor = {"left": "start", "center": "middle", "right": "end"}[self.horizontal]
        drawn = ""
        if self.boxed:
            left, right, top, bottom = self.box()
            drawn = (
                f'<rect x="{left - 1:.2f}" y="{top - 1:.2f}" width="{right - left + 2:.2f}" '
                f'height="{bottom - top + 1:.2f}" fill="#fff" fill-opacity=".7"/>'
            )
        for line, y in zip(self.text.split("\n"), self.baselines(), strict=True):
            inner = text_element(line, self.size, self.colour, anchor, self.extra)
            drawn += f'<text x="{self.x:.2f}" y="{y:.2f}" {inner}'
        return drawn
