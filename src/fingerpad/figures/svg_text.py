"""Text of SVG drawings: its width, and simple formulas as runs of upright, slanted, low and high text."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from html import escape
from pathlib import Path
from typing import Final, NamedTuple

import matplotlib as mpl
from PIL import ImageFont

from fingerpad.figures.style import BLACK, HALO_PT

FONT_FAMILY: Final = "'DejaVu Sans', Verdana, sans-serif"
LINE_HEIGHT: Final = 1.2
_SCRIPT_SIZE: Final = 0.7
_LOWERED, _RAISED = 0.15, -0.38  # of the font size, downwards
_ANCHORS: Final = {"left": "", "center": ' text-anchor="middle"', "right": ' text-anchor="end"'}
_MEASURED_AT: Final = 100  # px
_ASCENT: Final = 0.76  # of digits and capitals, of the font size
_GREEK: Final = {"beta": "β", "ell": "ℓ", "pi": "π", "propto": " ∝ ", "tau": "τ", "xi": "ξ"}
_SYMBOLS: Final = _GREEK | {"=": " = ", "±": " ± "}
# A script, a command or a group, and other single letters and signs.
_TOKEN: Final = re.compile(
    r"(?P<script>[_^]?)(?P<upright>(?:\\mathrm)?)"
    r"(?:\{(?P<group>(?:[^{}]|\{[^{}]*\})*)\}|\\(?P<command>[a-z]+)\s*|(?P<sign>.))"
)
_SCRIPTS: Final = {"^": 1, "_": -1}


@dataclass(frozen=True, slots=True)
class Run:
    """Text of one kind: `script` is 1 for a superscript, −1 for a subscript, 0 on the line."""

    text: str
    slanted: bool = False
    script: int = 0

    def width(self, size: float) -> float:
        """Return the width at a font size, both in points."""
        return _font().getlength(self.text) * size * (_SCRIPT_SIZE if self.script else 1.0) / _MEASURED_AT


@cache
def runs(text: str) -> tuple[Run, ...]:
    r"""Return the runs of one line, in which formulas stand between dollar signs as in Matplotlib.

    Formulas have letters, ``\mathrm``, subscripts, superscripts, and the Greek letters of these figures.
    """
    parts = ([Run(part)] if place % 2 == 0 else _symbols(part) for place, part in enumerate(text.split("$")))
    return tuple(run for part in parts for run in part if run.text)


def _symbols(formula: str, script: int = 0) -> Iterator[Run]:
    """Yield the symbols of a formula: letters slanted, digits and signs upright."""
    for match in _TOKEN.finditer(formula):
        here = _SCRIPTS.get(match["script"], script)
        if match["group"] is not None and match["upright"]:
            yield Run(match["group"], script=here)
        elif match["group"] is not None:
            yield from _symbols(match["group"], here)
        else:
            name = match["command"] or match["sign"].strip()
            symbol = _SYMBOLS.get(name, name)
            yield Run(symbol, slanted=symbol.isalpha(), script=here)


@cache
def line_width(text: str, size: float) -> float:
    """Return the width of the longest line of a text at a font size, both in points."""
    return max(sum(run.width(size) for run in runs(line)) for line in text.split("\n"))


@cache
def _font() -> ImageFont.FreeTypeFont:
    file = Path(mpl.get_data_path(), "fonts", "ttf", "DejaVuSans.ttf")
    return ImageFont.truetype(file, _MEASURED_AT, layout_engine=ImageFont.Layout.BASIC)


@cache
def _line(text: str, size: float) -> str:
    """Return a line with the symbols of formulas as spans, a superscript over the subscript before it."""
    spans, height, before = "", 0.0, Run("")
    for run in runs(text):
        target = {0: 0.0, 1: _RAISED * size, -1: _LOWERED * size}[run.script]
        attributes = f' dy="{target - height:.2f}"' if target != height else ""
        if run.script == 1 and before.script == -1:
            attributes += f' dx="{-before.width(size):.2f}"'
        if run.script:
            attributes += f' font-size="{_SCRIPT_SIZE * size:.2f}"'
        if run.slanted:
            attributes += ' font-style="italic"'
        shown = escape(run.text, quote=False)
        spans += f"<tspan{attributes}>{shown}</tspan>" if attributes else shown
        height = target
        before = Run(before.text + run.text, script=run.script) if run.script == before.script == -1 else run
    return spans


class TextBox(NamedTuple):
    """Text at a place, its lines separated by newlines."""

    text: str
    x: float
    y: float
    size: float
    horizontal: str = "left"
    vertical: str = "baseline"
    colour: str = BLACK
    tag: bool = False
    halo: str = ""
    turned: bool = False  # to read upwards

    def baselines(self) -> list[float]:
        """Return y of the baseline of each line."""
        step, ascent = LINE_HEIGHT * self.size, _ASCENT * self.size
        count = self.text.count("\n")
        height = step * count + ascent
        above = {"top": 0.0, "center": height / 2, "bottom": height + 0.2 * self.size, "baseline": height}
        return [self.y - above[self.vertical] + ascent + step * number for number in range(count + 1)]

    def box(self) -> tuple[float, float, float, float]:
        """Return left, right, top and bottom."""
        width, baselines = line_width(self.text, self.size), self.baselines()
        left = self.x - {"left": 0.0, "center": width / 2, "right": width}[self.horizontal]
        top, bottom = baselines[0] - _ASCENT * self.size, baselines[-1] + 0.2 * self.size
        if not self.turned:
            return left, left + width, top, bottom
        across, down = self.x - self.y, self.x + self.y
        return top + across, bottom + across, down - left - width, down - left

    def element(self) -> str:
        """Return the text as SVG."""
        look = f'font-size="{self.size:g}" fill="{self.colour}"{_ANCHORS[self.horizontal]}'
        drawn = ""
        if self.turned:
            look += f' transform="rotate(-90 {self.x:.2f} {self.y:.2f})"'
        if self.halo:
            look += f' stroke="{self.halo}" stroke-width="{HALO_PT}" paint-order="stroke"'
        if self.tag:
            look += ' font-weight="bold" font-style="italic"'
            left, right, top, bottom = self.box()
            drawn = (
                f'<rect x="{left - 1:.2f}" y="{top - 1:.2f}" width="{right - left + 2:.2f}" '
                f'height="{bottom - top + 1:.2f}" fill="#fff" fill-opacity=".7"/>'
            )
        for line, y in zip(self.text.split("\n"), self.baselines(), strict=True):
            drawn += f'<text x="{self.x:.2f}" y="{y:.2f}" {look}>{_line(line, self.size)}</text>'
        return drawn
