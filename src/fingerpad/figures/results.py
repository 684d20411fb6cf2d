"""Figures of results: radii, areas and shapes against load, bone, uncertainty, agreement of two persons.

Arrays are in mm, mm² and N; a `_std` is a standard uncertainty and is drawn as an error bar of that length
to either side. `synthetic` marks data that were rendered or simulated, for all points or one by one.
"""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Final, Literal, TypeAlias

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array, broadcast, check_radians
from fingerpad._rounding import value_with_uncertainty
from fingerpad.figures.marks import (
    Axis,
    Band,
    Bars,
    Dash,
    Ellipses,
    Frame,
    Line,
    Panel,
    Points,
    Rule,
    Text,
    measured,
    synthetic_tag,
)
from fingerpad.figures.mpl import on_axes
from fingerpad.figures.style import BLUE, GREY, ORANGE, VERMILLION
from fingerpad.published.dzidek2017 import PublishedWedge
from fingerpad.uncertainty import Agreement

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
    """Draw R_g^corr against load, as in Fig. 6 of Dzidek et al. (2017).

    Thick bars are `fixed_geometry_std`, the part of the uncertainty that remains with the pad held exact;
    squares are `compliance_radius`, R_Aξ, to compare with R_g.
    """
    if fixed_geometry_std is not None:
        thick: dict[str, Any] = {"marker": "", "bar_width": 2.4, "label": "_geometry held exact"}
        axes.add(*measured(load, corrected_radius, y_std=fixed_geometry_std, left_out=left_out, **thick))
    label, made = r"$R_\mathrm{g}^\mathrm{corr}$", {"synthetic": synthetic, "left_out": left_out}
    axes.add(*measured(load, corrected_radius, y_std=corrected_radius_std, label=label, **made))
    axes.add(*synthetic_tag(synthetic))
    if compliance_radius is not None:
        # An outline wider than the circle, which would hide a square of nearly the same value.
        squares: dict[str, Any] = {"marker": "s", "size": 6.5, "colour": GREY, "face": "none"}
        label = r"$R_{A\xi}$, to compare with $R_\mathrm{g}$"
        axes.add(*measured(load, compliance_radius, left_out=left_out, label=label, **squares))
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
    axes.y = Axis("corrected radius (mm)", margin=0.15)
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
    columns = broadcast(load, area, np.nan if area_std is None else area_std, synthetic, left_out)
    good = (columns[0] > 0) & (columns[1] > 0)
    W, A, std, made, out = (column[good] for column in columns)
    axes.x, axes.y = Axis("normal load W (N)", log=True), Axis("contact area A (mm²)", log=True)
    axes.legend = "inside"
    if W.size:
        line = np.geomspace(W.min() / 1.15, W.max() * 1.15, 50)
        axes.x = replace(axes.x, low=float(line[0]), high=float(line[-1]))

        def power_law(slope: float) -> FloatArray:
            return as_float_array(np.exp(np.log(A).mean() + slope * (np.log(line) - np.log(W).mean())))

        if exponent is not None and np.isfinite(exponent):
            if exponent_std is not None and np.isfinite(exponent_std):
                turned = [power_law(exponent - exponent_std), power_law(exponent + exponent_std)]
                axes.add(Band(line, *np.sort(turned, axis=0), colour=BLUE, alpha=0.2))
            said = value_with_uncertainty(exponent, exponent_std)
            axes.add(Line(line, power_law(exponent), colour=BLUE, label=rf"fit, $A \propto W^{{{said}}}$"))
        label = r"Hertz, $A \propto W^{2/3}$"
        axes.add(Line(line, power_law(2 / 3), dash="--", colour=ORANGE, label=label))
    shown = None if area_std is None else std
    axes.add(*measured(W, A, y_std=shown, synthetic=made, left_out=out, label="area"), *synthetic_tag(made))


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
    of the long axis too: its angle is from the finger's axis, counter-clockwise, radians.
    """
    check_radians("long_axis_angle", long_axis_angle)
    W, ratio, angle, made, out = map(
        np.ravel, broadcast(load, aspect_ratio, long_axis_angle, synthetic, left_out)
    )
    axes.add(*measured(W, ratio, y_std=aspect_ratio_std, synthetic=made, left_out=out))
    for hollow, faded in itertools.product((False, True), repeat=2):
        mask = ((made != 0) == hollow) & ((out != 0) == faded)
        face, edge = "white" if hollow else "#cfe3f1", _FADED_EDGE if faded else BLUE
        if mask.any():
            axes.add(_shapes(W[mask], ratio[mask], angle[mask], face=face, edge=edge))
    axes.add(*synthetic_tag(synthetic))
    if predicted_aspect_ratio is not None:
        at, turn = predicted_aspect_ratio, predicted_long_axis_angle
        axes.add(
            Rule("y", at, colour=ORANGE, dash="--"),
            _shapes(1.06, at, turn, edge=ORANGE, frame="x"),
            _level_name(at, f"Hertz\n{at:.2f}", gap=22),
        )
    axes.x = Axis("normal load W (N)\nshapes as seen through the platen, fingertip up", low=0)
    axes.y = Axis(r"aspect ratio $\ell_\mathrm{d}/\ell_\mathrm{e}$ (–)", margin=0.25)


def _shapes(
    x: ArrayLike, ratio: ArrayLike, angle: ArrayLike, *, edge: str, face: str = "white", frame: Frame = ""
) -> Ellipses:
    """Return ellipses of one length, each at its ratio."""
    turn, width = 90 + np.degrees(angle), np.full(np.shape(ratio), _SHAPE_POINTS)
    look: dict[str, Any] = {"colour": edge, "face": face, "frame": frame}
    return Ellipses(x, ratio, widths=width, heights=width / ratio, angles_deg=turn, **look)


_THICKNESS_TICKS: Final = (3, 4, 6, 8, 12, 16)


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
    ratios = [np.atleast_1d(as_float_array(ratio)) for ratio in (modulus_ratio, radius_ratio)]
    radius = r"$R_\mathrm{g} = A/(\pi\xi)$"
    for values, (colour, label, side) in zip(
        ratios, ((BLUE, "E from load and area", -1), (VERMILLION, radius, 1)), strict=True
    ):
        axes.add(Line(at, values, colour=colour, label=label))
        _mark_ratios(axes, at, values, as_float_array(marked), colour=colour, side=side)
    axes.x = Axis("assumed effective thickness of the tissue (mm)", log=True, ticks=_THICKNESS_TICKS)
    axes.y = Axis(
        "ratio to Hertz theory (–)", low=0, high=1.2 * float(np.nanmax(np.concatenate([[1.0], *ratios])))
    )
    axes.legend = "above"
    axes.add(*synthetic_tag(synthetic))


def _mark_ratios(
    axes: Panel, at: FloatArray, values: FloatArray, marked: FloatArray, *, colour: str, side: int
) -> None:
    """Mark some thicknesses, their ratios with two digits."""
    chosen = np.isin(at, marked) & np.isfinite(values)
    if chosen.any():
        axes.add(Points(at[chosen], values[chosen], colour=colour))
    for x, y in zip(at[chosen].tolist(), values[chosen].tolist(), strict=True):
        vertical: Literal["bottom", "top"] = "bottom" if side > 0 else "top"
        axes.add(Text(f"{y:#.2g}", x, y, up=6 * side, horizontal="center", vertical=vertical, colour=colour))


@on_axes
def plot_uncertainty_budget(
    axes: Panel,
    first_order: Mapping[str, float],
    *,
    total: Mapping[str, float] | None = None,
    synthetic: bool = False,
) -> None:
    """Draw the contribution of each source to the variance of a result, as bars from the largest down."""
    names = sorted(first_order, key=lambda name: first_order[name])
    places = np.arange(len(names))
    label = "first order" if total is not None else ""
    axes.add(Bars(places, [100 * first_order[name] for name in names], colour=BLUE, height=0.6, label=label))
    if total is not None:
        shares = [100 * total[name] for name in names]
        axes.add(Bars(places, shares, colour=ORANGE, height=0.18, label="Sobol, total"))
        axes.legend = "above"
    for place, name in enumerate(names):
        share = 100 * max(first_order[name], 0.0 if total is None else total[name])
        words = f"{100 * first_order[name]:.1f} %"
        axes.add(Text(words, max(share, 0), place, right=3, vertical="center", size=6.8))
    lowest = min([0.0, *(100 * share for share in first_order.values())])
    axes.x = Axis("share of the variance (%)", low=lowest, high=118)
    axes.y = Axis(ticks=tuple(places), names=tuple(names), lines=False)
    axes.add(*synthetic_tag(synthetic))


@on_axes
def plot_agreement(
    axes: Panel,
    first: ArrayLike,
    second: ArrayLike,
    found: Agreement,
    *,
    quantity: str,
    names: Sequence[str] = ("first", "second"),
    synthetic: ArrayLike = False,
) -> None:
    """Draw the relative difference of pairs against their geometric mean, with bias and limits of agreement.

    The limits are dashed, the 95 % interval of the bias is a band.
    """
    one, other = as_float_array(first), as_float_array(second)
    axes.add(
        *measured(np.sqrt(one * other), 100 * (other / one - 1), synthetic=synthetic),
        *synthetic_tag(synthetic),
        Rule("y", 0, colour=GREY, width=0.6),
        Rule("y", 100 * found.bias, width=1.0),
    )
    lines = [("bias", found.bias)]
    if np.isfinite(found.std):
        axes.add(Rule("y", *(100 * end for end in found.bias_interval), colour=BLUE, alpha=0.15))
        axes.add(*(Rule("y", 100 * end, dash="--", width=1.0) for end in found.limits))
        lines += [("limit", end) for end in found.limits if np.isfinite(end)]
    for words, value in lines:
        percent = f"{100 * value:+.1f}".replace("-", "−")
        axes.add(_level_name(100 * value, f"{words} {percent} %"))
    axes.x = Axis(f"{quantity}, mean of both", margin=0.1)
    axes.y = Axis(f"{names[1]}, difference from {names[0]} (%)", margin=0.2)
