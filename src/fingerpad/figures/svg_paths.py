"""Lines, areas and markers of SVG drawings, as paths and their attributes."""

import math
from typing import Any, Final

from fingerpad._arrays import FloatArray

_DASHES: Final = {"--": (3.7, 1.6), ":": (1.0, 1.65), "-.": (6.4, 1.6, 1.0, 1.6)}  # of the line's width


def stroke(colour: str, width: float, line: str, alpha: float | None = None) -> str:
    """Return the attributes of a line."""
    look = f'fill="none" stroke="{colour}" stroke-width="{width:g}"'
    if line in _DASHES:
        look += f' stroke-dasharray="{" ".join(f"{part * width:.2g}" for part in _DASHES[line])}"'
    return look if alpha is None else f'{look} stroke-opacity="{alpha:g}"'


def fill(options: dict[str, Any]) -> str:
    """Return the attributes of an area."""
    return f'fill="{options["color"]}" fill-opacity="{options.get("alpha", 1.0):g}"'


def marker_look(options: dict[str, Any], colour: str) -> str:
    """Return the attributes of markers."""
    face = options.get("markerfacecolor", colour)
    edge = options.get("markeredgecolor", colour)
    look = f'fill="{face}" stroke="{edge}" stroke-width="{options.get("markeredgewidth", 1.0):g}"'
    return look if "alpha" not in options else f'{look} opacity="{options["alpha"]:g}"'


def polyline(x: FloatArray, y: FloatArray) -> str:
    """Return the path of a line, broken where a point is missing."""
    parts, command = [], "M"
    for a, b in zip(x.tolist(), y.tolist(), strict=True):
        if math.isfinite(a + b):
            parts.append(f"{command}{a:.2f} {b:.2f}")
            command = "L"
        else:
            command = "M"
    return "".join(parts)


def markers(x: FloatArray, y: FloatArray, marker: str, size: float) -> str:
    """Return the path of markers of a size, points."""
    half = size / 2
    match marker:
        case "s":
            shape = f"m{-half:.2f} {-half:.2f}h{size:.2f}v{size:.2f}h{-size:.2f}z"
        case "D":
            d = size / math.sqrt(2)
            shape = f"m0 {-d:.2f}l{d:.2f} {d:.2f}l{-d:.2f} {d:.2f}l{-d:.2f} {-d:.2f}z"
        case "v":
            shape = f"m{-half:.2f} {-half:.2f}h{size:.2f}l{-half:.2f} {size:.2f}z"
        case _:
            r = half / 2 if marker == "." else half
            shape = f"m{-r:.2f} 0a{r:.2f} {r:.2f} 0 1 0 {2 * r:.2f} 0a{r:.2f} {r:.2f} 0 1 0 {-2 * r:.2f} 0z"
    return "".join(
        f"M{a:.2f} {b:.2f}{shape}"
        for a, b in zip(x.tolist(), y.tolist(), strict=True)
        if math.isfinite(a + b)
    )
