"""The figure of a pad's law in simulators."""

from collections.abc import Mapping
from typing import Final

from fingerpad._arrays import ArrayLike, as_float_array
from fingerpad.figures.marks import Axis, Band, Dash, Line, Panel, Points, synthetic_tag
from fingerpad.figures.mpl import on_axes
from fingerpad.figures.style import BLACK, BLUE, GREEN, ORANGE, SKY, VERMILLION

_STYLES: Final[tuple[tuple[str, Dash], ...]] = ((ORANGE, "--"), (GREEN, "-."), (VERMILLION, ":"), (SKY, "--"))


@on_axes
def plot_simulated_load(
    axes: Panel,
    indentation: ArrayLike,
    load: ArrayLike,
    *,
    load_std: ArrayLike = 0.0,
    simulated: Mapping[str, ArrayLike] | None = None,
    measured: tuple[ArrayLike, ArrayLike] | None = None,
    synthetic: bool = False,
) -> None:
    """Draw the law of a pad, what simulators make of it, and the loading curve that it is of."""
    xi, force, std = as_float_array(indentation), as_float_array(load), as_float_array(load_std)
    if measured is not None:
        axes.add(Points(*measured, marker=".", colour=BLUE, size=2.2, label="measured"))
        axes.add(*synthetic_tag(synthetic))
    if std.any():
        axes.add(Band(xi, force - std, force + std, colour=BLACK, alpha=0.15))
    axes.add(Line(xi, force, colour=BLACK, label="law of the pad"))
    for (name, loads), (colour, dash) in zip((simulated or {}).items(), _STYLES, strict=False):
        axes.add(Line(xi, loads, dash=dash, colour=colour, label=name))
    axes.x, axes.y = Axis("indentation ξ (mm)"), Axis("normal load W (N)")
    axes.legend = "above"
