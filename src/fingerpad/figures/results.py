"""Figures of results: radii, areas and shapes against load.

Arrays are in mm, mm² and N; a `_std` is a standard uncertainty and is drawn as an error bar of that length
to either side. `synthetic` marks data that were rendered or simulated, for all points or one by one.
"""

from dataclasses import replace
from typing import Any, Final, Literal, TypeAlias

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array, broadcast, check_radians
from fingerpad._rounding import value_with_uncertainty
from fingerpad.figures.marks import (
    Axis,
    Band,
    Dash,
    Ellipses,
    Line,
    Panel,
    Points,
    Rule,
    Text,
    measured,
    synthetic_tag,
)
from fingerpad.figures.mpl import on_axes
from fingerpad.figures.style import BLUE, FADED, GREY, ORANGE, VERMILLION
from fingerpad.published.dzidek2017 import PublishedWedge

Side: TypeAlias = Literal["top", "center", "bottom"]
_SHAPE_POINTS: Final = 13.0
_FADED_EDGE: Final = "#a3c7dd"


@on_axes
def plot_corrected_radius(
    axes: Panel,
    load: ArrayLike,
    corrected_radius: ArrayLike,
    *,
    corrected_radius_std: ArrayLike | None = None,
    fixed_geometry_std: ArrayLike | None = None,
    compliance_radius: ArrayLike | None = None,
    measured_radius: float | None = None,
    measured_radius_std: float | None = None,
    mean_curvature_radius: float | None = None,
    printed: PublishedWedge | None = None,
    synthetic: ArrayLike = False,
    left_out: ArrayLike = False,
) -> None:
    """Draw R_g^corr against load, as in Fig. 6 of Dzidek et al. (2017)."""
    axes.add(
        *measured(
            load,
            corrected_radius,
            y_std=corrected_radius_std,
            synthetic=synthetic,
            left_out=left_out,
            label=r"$R_\mathrm{g}^\mathrm{corr}$",
        )
    )
    if fixed_geometry_std is not None:
        x, y, inner, out = broadcast(load, corrected_radius, fixed_geometry_std, left_out)
        for mask, alpha, kind in ((out == 0, 1.0, ""), (out != 0, FADED, ", left out")):
            if mask.any():
                bars: dict[str, Any] = {
                    "y_std": inner[mask],
                    "marker": "",
                    "bar_width": 2.4,
                    "colour": BLUE,
                    "alpha": alpha,
                }
                label = f"_geometry held exact{kind}"  # not in the legend
                axes.add(Points(x[mask], y[mask], **bars, label=label))
    axes.add(*synthetic_tag(synthetic))
    if compliance_radius is not None:
        label = r"$R_{A\xi}$, to compare with $R_\mathrm{g}$"
        x, y, out = broadcast(load, compliance_radius, left_out)
        hidden = "_left out: " if (out == 0).any() else "left out: "
        for mask, alpha, kind in ((out == 0, 1.0, ""), (out != 0, FADED, hidden)):
            if mask.any():
                look: dict[str, Any] = {"marker": "s", "colour": GREY, "size": 3, "alpha": alpha}
                axes.add(Points(x[mask], y[mask], **look, label=f"{kind}{label}"))
    if printed is not None:
        at = printed.load_N, printed.corrected_radius_mm.value
        label = r"$R_\mathrm{g}^\mathrm{corr}$, printed in Dzidek et al. (2017)"
        axes.add(Points(*at, marker="D", colour=VERMILLION, size=4.5, label=label))
    if measured_radius is not None and measured_radius_std is not None and np.isfinite(measured_radius_std):
        band = (measured_radius - measured_radius_std, measured_radius + measured_radius_std)
        axes.add(Rule("y", *band, alpha=0.12))
    _mark_levels(
        axes, [(r"$R_\mathrm{g}$", measured_radius, "--"), (r"$R_\mathrm{0g}$", mean_curvature_radius, ":")]
    )
    axes.x = Axis("normal load W (N)", low=0)
    axes.y = Axis("corrected radius of curvature (mm)", margin=0.15)
    axes.legend = "above"


def _mark_levels(axes: Panel, levels: list[tuple[str, float | None, Dash]]) -> None:
    """Draw horizontal lines named at their right end, the higher name above its line, the lower below."""
    given = sorted(((value, name, dash) for name, value, dash in levels if value is not None), reverse=True)
    for place, (value, name, dash) in enumerate(given):
        side: Side = "center" if len(given) == 1 else ("top" if place else "bottom")
        axes.add(
            Rule("y", value, dash=dash, width=1.0), _level_name(value, f"{name}\n{value:.4g} mm", side=side)
        )


def _level_name(value: float, name: str, *, side: Side = "center", gap: float = 3) -> Text:
    """Return the name of a horizontal line to the right of the frame, `gap` points off."""
    return Text(name, 1.0, value, right=gap, frame="x", vertical=side, size=6.8)


@on_axes
def plot_area_against_load(
    axes: Panel,
    load: ArrayLike,
    area: ArrayLike,
    *,
    area_std: ArrayLike | None = None,
    exponent: float | None = None,
    exponent_std: float | None = None,
    synthetic: ArrayLike = False,
    left_out: ArrayLike = False,
) -> None:
    """Draw contact area against load in logarithmic axes, with the fitted power law and Hertz's 2/3.

    Both lines pass through the mean of the logarithms, about which the band of the exponent turns. Points
    without a positive load and area are left out.
    """
    W, A, std, flags, out = broadcast(
        load, area, np.nan if area_std is None else area_std, synthetic, left_out
    )
    good = (W > 0) & (A > 0)
    W, A = W[good], A[good]
    shown = None if area_std is None else std[good]
    flags, out = flags[good] != 0, out[good] != 0
    axes.x, axes.y = Axis("normal load W (N)", log=True), Axis("contact area A (mm²)", log=True)
    axes.legend = "inside"
    if W.size:
        line = np.geomspace(W.min() / 1.15, W.max() * 1.15, 50)
        axes.x = replace(axes.x, low=float(line[0]), high=float(line[-1]))

        def power_law(slope: float) -> FloatArray:
            return as_float_array(np.exp(np.log(A).mean() + slope * (np.log(line) - np.log(W).mean())))

        if exponent is not None and np.isfinite(exponent):
            if exponent_std is not None and np.isfinite(exponent_std):
                turned = (power_law(exponent - exponent_std), power_law(exponent + exponent_std))
                axes.add(Band(line, *turned, colour=BLUE, alpha=0.2))
            said = value_with_uncertainty(exponent, exponent_std)
            axes.add(Line(line, power_law(exponent), colour=BLUE, label=rf"fit, $A \propto W^{{{said}}}$"))
        label = r"Hertz, $A \propto W^{2/3}$"
        axes.add(Line(line, power_law(2 / 3), dash="--", colour=ORANGE, label=label))
    axes.add(*measured(W, A, y_std=shown, synthetic=flags, left_out=out, label="area"), *synthetic_tag(flags))


@on_axes
def plot_aspect_ratio(
    axes: Panel,
    load: ArrayLike,
    aspect_ratio: ArrayLike,
    *,
    aspect_ratio_std: ArrayLike | None = None,
    long_axis_angle: ArrayLike = 0.0,
    predicted_aspect_ratio: float | None = None,
    predicted_long_axis_angle: float = 0.0,
    synthetic: ArrayLike = False,
    left_out: ArrayLike = False,
) -> None:
    """Draw the aspect ratio ℓd/ℓe of contacts against load, each as an ellipse of its own shape.

    The ellipses stand as seen through the platen with the fingertip upwards, so that they show the direction
    of the long axis too.
    """
    W, ratio, angle, flags, out = (
        array.ravel()
        for array in broadcast(
            load, aspect_ratio, check_radians("long_axis_angle", long_axis_angle), synthetic, left_out
        )
    )
    axes.add(
        *measured(W, ratio, y_std=aspect_ratio_std, synthetic=flags, left_out=out), *synthetic_tag(flags)
    )
    for hollow, face in ((flags == 0, "#cfe3f1"), (flags != 0, "white")):
        for faded, edge in ((out == 0, BLUE), (out != 0, _FADED_EDGE)):
            mask = hollow & faded
            if mask.any():
                axes.add(_shapes(W[mask], ratio[mask], ratio[mask], angle[mask], face=face, edge=edge))
    if predicted_aspect_ratio is not None:
        at, turn = predicted_aspect_ratio, predicted_long_axis_angle
        axes.add(
            Rule("y", at, colour=ORANGE, dash="--"),
            _shapes(1.06, at, at, turn, edge=ORANGE, beside=True),
            _level_name(at, f"Hertz\n{at:.2f}", gap=22),
        )
    axes.x = Axis("normal load W (N)\nshapes as seen through the platen, fingertip up", low=0)
    axes.y = Axis(r"aspect ratio $\ell_\mathrm{d}/\ell_\mathrm{e}$ (–)", margin=0.25)


def _shapes(
    x: ArrayLike,
    y: ArrayLike,
    aspect_ratio: ArrayLike,
    angle: ArrayLike,
    *,
    edge: str,
    face: str = "white",
    beside: bool = False,
) -> Ellipses:
    """Return ellipses of one length and true shape; `beside` takes x in fractions of the frame."""
    size: dict[str, Any] = {"widths": _SHAPE_POINTS, "heights": _SHAPE_POINTS / as_float_array(aspect_ratio)}
    return Ellipses(x, y, **size, angles_deg=90 + np.degrees(angle), colour=edge, face=face, beside=beside)
