"""Figures of loading data: curves with their fits, moduli, relaxation, sequences, laws for simulators.

Arrays are in s, mm, mm², N and MPa; moduli are drawn in kPa. A `_std` is a standard uncertainty, drawn as a
bar or band of that length to either side. `synthetic` marks data that were simulated.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any, Final, Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import ArrayLike, BoolArray, FloatArray, as_float_array, broadcast
from fingerpad._rounding import value_with_uncertainty
from fingerpad.figures.marks import (
    Axis,
    Band,
    Dash,
    Line,
    Marker,
    Panel,
    Points,
    Rule,
    Text,
    fitted,
    measured,
    synthetic_tag,
)
from fingerpad.figures.mpl import AnyAxes, draw, on_axes
from fingerpad.figures.style import BLACK, BLUE, GREEN, GREY, ORANGE, SKY, VERMILLION
from fingerpad.loading import FittedForceModel, LoadingFit
from fingerpad.loading.law_registry import LAWS
from fingerpad.units import KPA_PER_MPA

_Styles: TypeAlias = tuple[tuple[str, Dash], ...]
Curve: TypeAlias = tuple[ArrayLike, ArrayLike]

# Alternatives as legends give them, from this Akaike weight on.
_SHORT: Final = {
    "area_offset": "areas offset",
    "area_growth": "areas not ∝ ξ",
    "stage_compliance": "yielding stage",
    "inverse_thickness": "layer on bone",
    "exact_sphere": "exact sphere",
    "hertz_stage_compliance": "Hertz, yielding stage",
    "hertz_inverse_thickness": "Hertz, layer on bone",
    "hertz_sphere_inverse_thickness": "sphere, layer on bone",
}
_SHOWN_WEIGHT: Final = 0.01
_LINE_POINTS: Final = 200
_PHASE_COLOURS: Final = {"baseline": GREY, "loading": BLUE, "hold": GREEN, "unloading": VERMILLION}
_LINE_STYLES: Final[_Styles] = (
    (ORANGE, "-"),
    (BLACK, "--"),
    (SKY, "-."),
    (VERMILLION, ":"),
    (GREEN, "--"),
)
_RIVAL_STYLES: Final[_Styles] = ((BLACK, "--"), (GREEN, "-."), (VERMILLION, ":"), (SKY, "--"))
_MILLI: Final = 1000.0
# Of the largest indentation, how much of the approach is shown.
_APPROACH: Final = 0.4
# A band is drawn up to this share of the range of loads beyond it, and to so many times the usual residual.
_ROOM, _WIDEST = 0.3, 10.0


@on_axes
def plot_load_indentation(
    axes: Panel,
    indentation: ArrayLike,
    load: ArrayLike,
    *,
    phase: npt.ArrayLike,
    fits: Mapping[str, Curve] | None = None,
    band: tuple[ArrayLike, ArrayLike, ArrayLike] | None = None,
    synthetic: ArrayLike = False,
) -> None:
    """Draw load against indentation, its loop by phase, and fitted force models.

    `phase` is ``baseline``, ``loading``, ``hold`` or ``unloading`` of each point; `fits` has (ξ, W) by the
    name of a force model, `band` ξ and both ends of the 95 % interval of the load by the first of them.
    """
    xi, W, phases = as_float_array(indentation), as_float_array(load), np.asarray(phase)
    for name, colour in _PHASE_COLOURS.items():
        chosen = phases == name
        if chosen.any():
            axes.add(Points(xi[chosen], W[chosen], marker=".", colour=colour, size=2.2, label=name))
    axes.add(*synthetic_tag(synthetic))
    if band is not None and W.size:
        # Where a law has a pole its band has no end, which must not set the scale.
        room = _ROOM * float(np.ptp(W))
        lower, upper = (np.clip(as_float_array(end), W.min() - room, W.max() + room) for end in band[1:])
        axes.add(_interval(band[0], lower, upper))
    for (name, line), (colour, dash) in zip((fits or {}).items(), _LINE_STYLES, strict=False):
        axes.add(Line(*line, dash=dash, colour=colour, label=name))
    axes.x, axes.y = _without_approach(Axis("indentation ξ (mm)"), xi), Axis("normal load W (N)")
    axes.legend = "above"


def _without_approach(axis: Axis, xi: FloatArray) -> Axis:
    """Leave out of view what a long approach has before contact."""
    if xi.size and xi.min() < -_APPROACH * xi.max():
        return replace(axis, low=-_APPROACH * float(xi.max()), high=1.05 * float(xi.max()))
    return axis


def _interval(depth: ArrayLike, lower: ArrayLike, upper: ArrayLike) -> Band:
    return Band(depth, lower, upper, colour=ORANGE, alpha=0.25, label="95 % interval")


@on_axes
def plot_load_residuals(axes: Panel, fit: LoadingFit, *, synthetic: bool = False) -> None:
    """Draw measured load less that of the fitted law, the band of the law, and what else explains the curve.

    Lines and points count from the fitted zeros of force and displacement; the band is that of
    `LoadingFit.predict`, of the load at an indentation.
    """
    depth = _depths(fit)
    found = fit.predict(depth)
    law, lower, upper = map(as_float_array, (found.value, found.lower, found.upper))
    off = _MILLI * (fit.load - fit.main.load(fit.rows.displacement))
    axes.add(
        _interval(depth, _MILLI * (lower - law), _MILLI * (upper - law)),
        Points(fit.indentation, off, marker=".", colour=BLUE, size=2.2, label="measured"),
        Rule("y", 0.0, colour=ORANGE),
    )
    shown = sorted(
        (name for name, of in fit.uncertainty.items() if name != fit.main.law and of.weight >= _SHOWN_WEIGHT),
        key=lambda name: -fit.uncertainty[name].weight,
    )
    for name, (colour, dash) in zip(shown, _RIVAL_STYLES, strict=False):
        apart = _MILLI * (_load_among_points(fit, fit.alternatives[name], depth) - law)
        label = f"{_SHORT.get(name, name)} ({fit.uncertainty[name].weight:.2f})"
        axes.add(Line(depth, apart, dash=dash, colour=colour, label=label))
    axes.add(*synthetic_tag(synthetic))
    band = np.append(lower, upper) - np.append(law, law)
    # Rows far off at the platen's turn, and a band without end at a pole, must not set the scale.
    usual = float(np.percentile(np.abs(off), 99))
    largest = 1.1 * max(1.3 * usual, min(_MILLI * float(np.nanmax(np.abs(band))), _WIDEST * usual))
    axes.x = _without_approach(Axis("indentation ξ (mm)"), fit.indentation)
    axes.y = Axis("W less the fitted law (mN)", low=-largest, high=largest)
    axes.legend, axes.columns = "above", 2


def _depths(fit: LoadingFit) -> FloatArray:
    return np.linspace(0, float(fit.indentation.max()), _LINE_POINTS)


def predicted_band(fit: LoadingFit) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return indentations up to the largest, and the ends of the 95 % interval of the load there."""
    depth = _depths(fit)
    found = fit.predict(depth)
    return depth, as_float_array(found.lower), as_float_array(found.upper)


def law_lines(fit: LoadingFit) -> dict[str, Curve]:
    """Return each law of the force as a line from the zeros of the points, the one that is stated first."""
    depth = _depths(fit)
    laws = sorted(fit.models.values(), key=lambda model: (model is not fit.main, model.aicc))
    own = fit.law
    way_out: dict[str, Curve] = {}
    if own is not None and own.law in own.models:
        if own.phase == "loading":
            laws.insert(1, own.models[own.law])
        else:
            # On the way out, from its own zeros.
            law = own.models[own.law]
            place = np.linspace(float(fit.indentation.min()), depth[-1], 2 * _LINE_POINTS)
            way_out[LAWS[law.law].label] = place, law.load(place + fit.main.values["contact_offset"])
    lines: dict[str, Curve] = {
        LAWS[law.law].label: (depth, _load_among_points(fit, law, depth)) for law in laws
    }
    return lines | way_out


def _load_among_points(fit: LoadingFit, law: FittedForceModel, depth: FloatArray) -> FloatArray:
    """Return the load of a law where the points have that indentation, less their zero of the force."""
    main, rows = fit.main, fit.rows
    displacement = main.values["contact_offset"] + depth
    compliance = main.values.get("stage_compliance", 0.0)
    if compliance:
        displacement += compliance * as_float_array(fit.predict(depth).value)
    clock = np.interp(displacement, np.maximum.accumulate(rows.smooth_displacement), rows.clock)
    measured = law.load(displacement) - law.corrected_load(clock, np.zeros(depth.size))
    return main.corrected_load(clock, measured)


@on_axes
def plot_contact_compliance(
    axes: Panel,
    indentation: ArrayLike,
    area: ArrayLike,
    *,
    area_std: ArrayLike | None = None,
    loading_radius: float | None = None,
    loading_radius_std: float = 0.0,
    synthetic: ArrayLike = False,
) -> None:
    """Draw contact area against πξ, with the line whose slope is R_g and the fan of its uncertainty.

    The fan turns about the mean of the points.
    """
    x = np.pi * as_float_array(indentation)
    axes.add(*measured(x, area, y_std=area_std, synthetic=synthetic), *synthetic_tag(synthetic))
    if loading_radius is not None and np.isfinite(x).any():
        line = np.array([min(np.nanmin(x), 0), np.nanmax(x)])
        spread = loading_radius_std * np.abs(line - np.nanmean(x))
        said = value_with_uncertainty(loading_radius, loading_radius_std)
        label = rf"slope $R_\mathrm{{g}}$ = {said} mm"
        axes.add(*fitted(line, loading_radius * line, spread, label=label))
    axes.x, axes.y = Axis("π × indentation, πξ (mm)"), Axis("contact area A (mm²)")
    axes.legend = "above"


@on_axes
def plot_secant_modulus(
    axes: Panel,
    abscissa: ArrayLike,
    secant_modulus: ArrayLike,
    *,
    against: Literal["indentation", "load"],
    fitted_points: ArrayLike | None = None,
    fit: Curve | None = None,
    label: str = "fit",
    synthetic: bool = False,
) -> None:
    """Draw the secant modulus E_g against indentation or load, with the points that were fitted."""
    modulus = KPA_PER_MPA * as_float_array(secant_modulus)
    x, modulus, kept = broadcast(abscissa, modulus, True if fitted_points is None else fitted_points)
    chosen = kept != 0
    if not chosen.all():
        out = Points(x[~chosen], modulus[~chosen], marker=".", colour=GREY, size=2.5, label="not in the fit")
        axes.add(out)
    axes.add(Points(x[chosen], modulus[chosen], marker=".", colour=BLUE, size=3.2, label=r"$E_\mathrm{g}$"))
    if fit is not None:
        axes.add(*fitted(fit[0], KPA_PER_MPA * as_float_array(fit[1]), label=label))
    axes.add(*synthetic_tag(synthetic))
    axes.x = Axis("indentation ξ (mm)" if against == "indentation" else "normal load W (N)", low=0)
    axes.y = Axis("secant modulus $E_\\mathrm{g}$ (kPa)")
    # The first points after contact divide by nearly nothing; they must not set the scale.
    if chosen.any():
        axes.y = replace(axes.y, low=0, high=1.6 * float(np.nanpercentile(modulus[chosen], 99)))
    axes.legend = "above"


@on_axes
def plot_initial_modulus(
    axes: Panel,
    velocity: ArrayLike,
    initial_modulus: ArrayLike,
    *,
    initial_modulus_std: ArrayLike | None = None,
    synthetic: ArrayLike = False,
) -> None:
    """Draw E_0g against the velocity of loading, on a logarithmic axis."""
    std = None if initial_modulus_std is None else KPA_PER_MPA * as_float_array(initial_modulus_std)
    modulus = KPA_PER_MPA * as_float_array(initial_modulus)
    axes.add(*measured(velocity, modulus, y_std=std, synthetic=synthetic), *synthetic_tag(synthetic))
    axes.x = Axis("velocity of loading (mm/s)", log=True, margin=0.15)
    axes.y = Axis(r"initial modulus $E_\mathrm{0g}$ (kPa)", low=0)


@on_axes
def plot_relaxation(
    axes: Panel,
    time: ArrayLike,
    load: ArrayLike,
    *,
    fit: Curve | None = None,
    label: str = "fit",
    ramp_time: float | None = None,
    time_constants: ArrayLike = (),
    synthetic: bool = False,
) -> None:
    """Draw the load against time since the hold began, s, on a logarithmic axis; what is before is left out.

    Nothing faster than the ramp, which lasted `ramp_time`, can be resolved.
    """
    t, y = broadcast(time, load)
    after = t > 0
    if ramp_time is not None and after.any() and ramp_time > t[after].min():
        begin, words = float(t[after].min()), "hidden by the ramp"
        axes.add(Rule("x", begin, ramp_time, colour=GREY, alpha=0.15, label=words))
    axes.add(Points(t[after], y[after], marker=".", colour=BLUE, size=2.5, label="measured"))
    if fit is not None:
        line, found = broadcast(*fit)
        shown = line >= (t[after].min() if after.any() else 0)
        axes.add(Line(line[shown], found[shown], colour=ORANGE, label=label))
    for number, constant in enumerate(np.atleast_1d(as_float_array(time_constants)).tolist()):
        label = f"{'_' * (number > 0)}time constants"
        axes.add(Rule("x", constant, colour=GREEN, dash=":", width=0.9, label=label))
    axes.add(*synthetic_tag(synthetic, above=True))
    axes.x = Axis("time since the hold began (s)", log=True)
    axes.y = Axis("normal load W (N)")
    axes.legend = "above"


@on_axes
def plot_modulus_from_area_and_indentation(
    axes: Panel,
    load: ArrayLike,
    ratio: ArrayLike,
    *,
    expected_ratio: Curve | None = None,
    synthetic: bool = False,
) -> None:
    """Draw E* from the area over E* from the indentation, against load: one where Hertz theory holds."""
    W, ratio = broadcast(load, ratio)
    axes.add(Points(W, ratio, marker=".", colour=BLUE, size=3, label="measured"), Rule("y", 1.0, width=0.8))
    if expected_ratio is not None:
        label = "expected of the true ellipsoid"
        axes.add(Line(*expected_ratio, dash="--", colour=ORANGE, label=label))
    axes.add(*synthetic_tag(synthetic))
    axes.x = Axis("normal load W (N)", low=0)
    axes.y = Axis("E* from area / E* from indentation (–)")
    if np.isfinite(ratio).any():
        axes.y = replace(axes.y, low=0, high=max(1.6, 1.3 * float(np.nanpercentile(ratio, 98))))
    axes.legend = "above"


# Distinguished by colour and by shape.
_PHASE_MARKS: Final[tuple[tuple[str, str, Marker], ...]] = (
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
    every: Sequence[Any] = axes
    panels = [each if isinstance(each, Panel) else Panel() for each in every]
    for number, panel in enumerate(panels):
        x, panel.x = (W, Axis("normal load W (N)", low=below)) if number % 2 else (t, Axis("time (s)"))
        panel.y = Axis("semi-axes (mm)" if number > 1 else "contact area A (mm²)", low=0, margin=0.12)
        _draw_phases(panel, x, major if number > 1 else A, phases, hollow=synthetic)
        if number > 1:
            _draw_phases(panel, x, minor, phases, hollow=synthetic, named=False)
    panels[0].legend, panels[0].columns = "above", 3
    panels[1].add(*synthetic_tag(synthetic))
    if t.size:
        side: Literal["bottom", "top"]
        for y, name, side in ((major, "d", "bottom"), (minor, "e", "top")):
            k = int(np.argmax(y))
            up = 4 if side == "bottom" else -4
            label = rf"$\ell_\mathrm{{{name}}}$"
            panels[2].add(Text(label, t[k], y[k], up=up, horizontal="center", vertical=side))
    for each, panel in zip(every, panels, strict=True):
        if not isinstance(each, Panel):
            draw(panel, each)
    return axes


@on_axes
def plot_area_against_indentation(
    axes: Panel, indentation: ArrayLike, area: ArrayLike, *, phase: npt.ArrayLike, synthetic: bool = False
) -> None:
    """Draw the contact area of the frames of a press against the measured indentation."""
    xi, A = broadcast(indentation, area)
    _draw_phases(axes, xi, A, np.asarray(phase), hollow=synthetic)
    axes.x = Axis("measured indentation ξ (mm)", low=min(0.0, float(xi.min())) if xi.size else 0.0)
    axes.y = Axis("contact area A (mm²)", low=0, margin=0.12)
    axes.legend, axes.columns = "above", 3
    axes.add(*synthetic_tag(synthetic))


def extremes(load: FloatArray, steps: int = 1000) -> npt.NDArray[np.intp]:
    """Return the samples of least and greatest load in each step of time, all that a drawing shows."""
    if load.size <= 2 * steps:
        return np.arange(load.size)
    ends = np.linspace(0, load.size, steps + 1).astype(int)
    parts = [(start, load[start:stop]) for start, stop in pairwise(ends)]
    return np.unique([start + end(part) for start, part in parts for end in (np.argmin, np.argmax)])


def _draw_phases(
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
    for name, colour, marker in _PHASE_MARKS:
        chosen: BoolArray = phase == name
        if chosen.any():
            face, label = "white" if hollow else "", name if named else f"_{name}"
            axes.add(
                Points(x[chosen], y[chosen], marker=marker, colour=colour, face=face, label=label, **look)
            )


_SIMULATOR_STYLES: Final[_Styles] = ((ORANGE, "--"), *_RIVAL_STYLES[1:])


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
    xi = as_float_array(indentation)
    if measured is not None:
        axes.add(Points(*measured, marker=".", colour=BLUE, size=2.2, label="measured"))
        axes.add(*synthetic_tag(synthetic))
    axes.add(*fitted(xi, load, load_std, colour=BLACK, label="law of the pad"))
    for (name, loads), (colour, dash) in zip((simulated or {}).items(), _SIMULATOR_STYLES, strict=False):
        axes.add(Line(xi, loads, dash=dash, colour=colour, label=name))
    axes.x, axes.y = Axis("indentation ξ (mm)"), Axis("normal load W (N)")
    axes.legend = "above"
