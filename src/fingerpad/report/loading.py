"""The figures of one loading curve."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from fingerpad import figures
from fingerpad._arrays import ArrayLike, FloatArray
from fingerpad._rounding import value_with_uncertainty
from fingerpad.exceptions import FitError
from fingerpad.figures.loading import law_lines, predicted_band
from fingerpad.loading import LoadingCurve, LoadingFit, fit_relaxation, sphere_ratio
from fingerpad.report.plot import Plot, panel
from fingerpad.units import KPA_PER_MPA


def loading_plots(
    name: str,
    curve: LoadingCurve,
    fit: LoadingFit,
    *,
    where: str = "",
    cycle: int = 0,
    geometric_mean_radius: float | None = None,
    expected_ratio: tuple[ArrayLike, ArrayLike] | None = None,
    synthetic: bool = False,
) -> Iterator[Plot]:
    """Draw the figures of a loading curve.

    With `geometric_mean_radius`, R_e of the pad in mm, moduli from area and from indentation are compared;
    `expected_ratio`, loads and ratios, is what the true ellipsoid makes of that.
    """

    def plot(kind: str, caption: str, draw: Callable[..., object], *args: Any, **options: Any) -> Plot:
        figure = panel(draw, *args, **options, synthetic=synthetic)
        return Plot(name=f"{name}_{kind}", figure=figure, caption=f"{caption} ({where or name}).")

    drawn = _Drawn(curve, fit, cycle)
    loading = drawn.phase == "loading"
    yield plot(
        "load_indentation",
        "Load against indentation from the fitted place of contact, and the laws fitted to the loading; the "
        "band is the 95 % interval of the load at an indentation",
        figures.plot_load_indentation,
        drawn.indentation,
        drawn.load,
        phase=drawn.phase,
        fits=law_lines(fit),
        band=predicted_band(fit),
    )
    yield plot(
        "residuals",
        "Load less that of the fitted law, the 95 % interval of its load, and what else could have made the "
        "curve, with Akaike weights",
        figures.plot_load_residuals,
        fit,
    )
    if drawn.area is not None:
        radius = fit.loading_radius
        yield plot(
            "compliance",
            "Contact area against π × indentation; its slope is the loading radius",
            figures.plot_contact_compliance,
            drawn.indentation[loading],
            drawn.area[loading],
            loading_radius=radius.value if radius.known else None,
            loading_radius_std=radius.std if radius.known else 0.0,
        )
    yield from _secant_plots(plot, fit)
    if drawn.area is not None and geometric_mean_radius is not None:
        chosen = loading & (drawn.load > 0.05 * drawn.load.max())
        xi, area = drawn.indentation[chosen], drawn.area[chosen]
        yield plot(
            "shape",
            "E* read from the area over E* read from the indentation, on R_e of the undeformed pad: one for "
            "a Hertzian contact",
            figures.plot_modulus_from_area_and_indentation,
            drawn.load[chosen],
            sphere_ratio(xi, area, loading_radius=geometric_mean_radius),
            expected_ratio=expected_ratio,
        )
    yield from _relaxation_plot(plot, drawn)


class _Drawn:
    """The press that was fitted, from its fitted zeros of force and displacement."""

    def __init__(self, curve: LoadingCurve, fit: LoadingFit, cycle: int) -> None:
        self.cycle = fit.cycles[cycle]
        main = fit.models["load_dependent"]
        self.offset = main.values["contact_offset"]
        segments = [(part, phase) for phase, part in self.cycle.phases().items() if part is not None]
        rows = np.concatenate([np.arange(part.start, part.stop) for part, _ in segments])
        self.phase = np.concatenate([np.full(len(part), phase) for part, phase in segments])
        # The force's drift is known over the rows fitted; carried on through a hold it would bend the rest.
        begin = segments[0][0].start
        clock = np.minimum(curve.clock, curve.clock[self.cycle.loading.stop - 1]) - curve.clock[begin]
        load = main.corrected_load(clock, curve.load)
        self.zeroed = LoadingCurve(load=load, indentation=curve.indentation, area=curve.area, time=curve.time)
        self.load: FloatArray = load[rows]
        self.indentation: FloatArray = curve.indentation[rows] - self.offset
        self.area = None if curve.area is None else curve.area[rows]


def _secant_plots(plot: Callable[..., Plot], fit: LoadingFit) -> Iterator[Plot]:
    secant, (low, high) = fit.secant, fit.fit_load_range
    line: dict[str, Any] = {}
    initial, growth = fit.initial_modulus, fit.load_coefficient
    if initial.known and growth.known:
        loads = np.array([low, high])
        said = [
            value_with_uncertainty(KPA_PER_MPA * one.value, KPA_PER_MPA * one.std)
            for one in (initial, growth)
        ]
        label = rf"$E_\mathrm{{0g}}$ = {said[0]} kPa, β = {said[1]} kPa/N"
        line = {"fit": (loads, initial.value + growth.value * loads), "label": label}
    fitted = (secant.load >= low) & (secant.load <= high)
    outside = "" if fitted.all() else "; grey: not in the range of loads that was fitted"
    for against, x, shown in (("load", secant.load, line), ("indentation", secant.indentation, {})):
        yield plot(
            f"secant_modulus_{against}",
            f"Secant modulus against {against}{', with the fitted line' if shown else ''}{outside}",
            figures.plot_secant_modulus,
            x,
            secant.modulus,
            against=against,
            fitted_points=fitted,
            **shown,
        )


def _relaxation_plot(plot: Callable[..., Plot], drawn: _Drawn) -> Iterator[Plot]:
    """Draw the relaxation of the hold, where there is one to fit."""
    try:
        found = fit_relaxation(drawn.zeroed, drawn.cycle, drawn.offset)
    except FitError:
        return
    hold, clock = drawn.cycle.hold, drawn.zeroed.time
    assert hold is not None and clock is not None  # noqa: PT018 (fitted only with both)
    begin, times = clock[hold.start], [term.time for term in found.terms]
    said = [f"{value_with_uncertainty(one.value, one.std)} s" if one.known else one.reason for one in times]
    yield plot(
        "relaxation",
        "Load during the hold, with the Prony series through the recorded ramp; time constants: "
        f"{', '.join(said) or 'none'}",
        figures.plot_relaxation,
        clock[hold.rows] - begin,
        drawn.zeroed.load[hold.rows],
        fit=(found.time + clock[drawn.cycle.loading.start] - begin, found.load),
        label=f"Prony series of {len(times)} terms" if len(times) != 1 else "Prony series of one term",
        ramp_time=found.ramp_time,
        time_constants=[time.value for time in times if time.known],
    )
