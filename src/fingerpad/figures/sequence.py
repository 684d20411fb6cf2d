"""The figure of one press: contact area and semi-axes against time and against force."""

from collections.abc import Sequence
from typing import Any, Final, Literal

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import ArrayLike, BoolArray, FloatArray, broadcast
from fingerpad.figures.marks import Axis, Line, Panel, Points, Text, synthetic_tag
from fingerpad.figures.mpl import AnyAxes, on_axes, place
from fingerpad.figures.style import BLUE, GREY, VERMILLION

# Distinguished by colour and by shape.
_PHASES: Final[tuple[tuple[str, str, Literal["o", "s", "v"]], ...]] = (
    ("loading", BLUE, "o"),
    ("hold", GREY, "s"),
    ("unloading", VERMILLION, "v"),
)


def plot_press(
    axes: Sequence[AnyAxes],
    *,
    time: ArrayLike,
    load: ArrayLike,
    phase: npt.ArrayLike,
    area: ArrayLike,
    semi_major: ArrayLike,
    semi_minor: ArrayLike,
    synthetic: bool = False,
) -> Sequence[AnyAxes]:
    """Draw area and semi-axes against time and force on four axes, phases marked differently."""
    t, W, A, major, minor = broadcast(time, load, area, semi_major, semi_minor)
    phases = np.asarray(phase)
    below = min(0.0, float(W.min())) if W.size else 0.0
    panels = [Panel() for _ in axes]
    for number, panel in enumerate(panels):
        x, panel.x = (W, Axis("normal load W (N)", low=below)) if number % 2 else (t, Axis("time (s)"))
        panel.y = Axis("semi-axes (mm)" if number > 1 else "contact area A (mm²)", low=0, margin=0.12)
        _draw(panel, x, major if number > 1 else A, phases, hollow=synthetic)
        if number > 1:
            _draw(panel, x, minor, phases, hollow=synthetic, named=False)
    panels[0].legend, panels[0].columns = "above", 3
    panels[1].add(*synthetic_tag(synthetic))
    if t.size:
        side: Literal["bottom", "top"]
        for y, name, side in ((major, "d", "bottom"), (minor, "e", "top")):
            k = int(np.argmax(y))
            up = 4 if side == "bottom" else -4
            label = rf"$\ell_\mathrm{{{name}}}$"
            panels[2].add(Text(label, t[k], y[k], up=up, horizontal="center", vertical=side))
    for each, panel in zip(axes, panels, strict=True):
        place(panel, each)
    return axes


@on_axes
def plot_area_against_indentation(
    axes: Panel,
    indentation: ArrayLike,
    area: ArrayLike,
    *,
    phase: npt.ArrayLike,
    synthetic: bool = False,
) -> None:
    """Draw the contact area of the frames of a press against the measured indentation."""
    xi, A = broadcast(indentation, area)
    _draw(axes, xi, A, np.asarray(phase), hollow=synthetic)
    axes.x = Axis("measured indentation ξ (mm)", low=min(0.0, float(xi.min())) if xi.size else 0.0)
    axes.y = Axis("contact area A (mm²)", low=0, margin=0.12)
    axes.legend, axes.columns = "above", 3
    axes.add(*synthetic_tag(synthetic))


def _draw(
    axes: Panel,
    x: FloatArray,
    y: FloatArray,
    phase: npt.NDArray[np.str_],
    *,
    hollow: bool,
    named: bool = True,
) -> None:
    crowded = x.size > 80
    look: dict[str, Any] = {"size": 1.8 if crowded else 3.6, "edge_width": 0.5 if crowded else 0.9}
    axes.add(Line(x, y, colour="#c9c9c9", width=0.7))
    for name, colour, marker in _PHASES:
        chosen: BoolArray = phase == name
        if chosen.any():
            face, label = "white" if hollow else "", name if named else f"_{name}"
            axes.add(
                Points(x[chosen], y[chosen], marker=marker, colour=colour, face=face, label=label, **look)
            )
