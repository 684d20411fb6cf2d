"""What bone below the pad would change, by the thickness of the tissue over it."""

from typing import Final, Literal

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array
from fingerpad.figures.marks import Axis, Line, Panel, Points, Rule, Text, synthetic_tag
from fingerpad.figures.mpl import on_axes
from fingerpad.figures.style import BLUE, VERMILLION

_TICKS: Final = (3, 4, 6, 8, 12, 16)


@on_axes
def plot_layer_effect(
    axes: Panel,
    thickness: ArrayLike,
    *,
    modulus_ratio: ArrayLike,
    radius_ratio: ArrayLike,
    marked: ArrayLike = (4.0, 8.0, 12.0),
    synthetic: bool = False,
) -> None:
    """Draw modulus and loading radius over those of Hertz theory, against the thickness of tissue over bone.

    `thickness` ascends, mm; those that are `marked`, among them, are named with their ratios.
    """
    at = as_float_array(thickness)
    axes.add(
        Rule("y", 1.0, width=0.8, dash=":"),
        Text("Hertz", 1, 1, right=-2, up=2, frame="x", horizontal="right"),
    )
    ratios: list[FloatArray] = [
        np.atleast_1d(as_float_array(ratio)) for ratio in (modulus_ratio, radius_ratio)
    ]
    for values, colour, label, side in zip(
        ratios,
        (BLUE, VERMILLION),
        ("E from load and area", r"$R_\mathrm{g} = A/(\pi\xi)$"),
        (-1, 1),
        strict=True,
    ):
        axes.add(Line(at, values, colour=colour, label=label))
        _mark(axes, at, values, as_float_array(marked), colour=colour, side=side)
    axes.x = Axis("assumed effective thickness of the tissue (mm)", log=True, ticks=_TICKS)
    axes.y = Axis("over Hertz theory", low=0, high=1.2 * float(np.nanmax(np.concatenate([[1.0], *ratios]))))
    axes.legend = "above"
    axes.add(*synthetic_tag(synthetic))


def _mark(
    axes: Panel, at: FloatArray, values: FloatArray, marked: FloatArray, *, colour: str, side: int
) -> None:
    """Mark some thicknesses, their ratios with two digits."""
    chosen = np.isin(at, marked) & np.isfinite(values)
    if chosen.any():
        axes.add(Points(at[chosen], values[chosen], colour=colour))
    for x, y in zip(at[chosen].tolist(), values[chosen].tolist(), strict=True):
        vertical: Literal["bottom", "top"] = "bottom" if side > 0 else "top"
        axes.add(Text(f"{y:#.2g}", x, y, up=6 * side, horizontal="center", vertical=vertical, colour=colour))
