"""Labels of SVG drawings: text at a place, the room that it takes, and its element."""

from typing import Final, NamedTuple

from fingerpad.figures.style import BLACK
from fingerpad.figures.svg_text import LINE_HEIGHT, line_width, text_element

_ASCENT: Final = 0.76  # of digits and capitals, of the font size


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
        above = {
            "top": 0.0,
            "center": height / 2,
            "bottom": height + 0.2 * self.size,
            "baseline": height,
        }[self.vertical]
        return [self.y - above + ascent + step * number for number in range(count + 1)]

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
