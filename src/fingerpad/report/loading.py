"""The figures of one loading curve."""

from collections.abc import Iterator
from typing import Literal

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray
from fingerpad._rounding import value_with_uncertainty
from fingerpad.estimate import Estimate
from fingerpad.exceptions import FitError
from fingerpad.figures import (
    plot_contact_compliance,
    plot_load_indentation,
    plot_load_residuals,
    plot_modulus_from_area_and_indentation,
    plot_relaxation,
    plot_secant_modulus,
)
from fingerpad.figures.loading import law_lines, predicted_band
from fingerpad.loading import LoadingCurve, LoadingFit, Relaxation, fit_relaxation, sphere_ratio
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
    """Draw the figures of a loading curve."""
    where = where or name
    drawn = _Drawn(curve, fit, cycle)
    yield Plot(
        name=f"{name}_load_indentation",
        figure=panel(
            plot_load_indentation,
            drawn.indentation,
            drawn.load,
            phase=drawn.phase,
            fits=law_lines(fit),
            band=predicted_band(fit),
            synthetic=synthetic,
        ),
        caption=f"Load against indentation from the fitted place of contact, and the laws fitted to the "
        f"loading; the band is the 95 % interval of the load at an indentation ({where}).",
    )
    yield Plot(
        name=f"{name}_residuals",
        figure=panel(plot_load_residuals, fit, synthetic=synthetic),
        caption="Load less that of the fitted law, the 95 % interval of its load, and what else could have "
        f"made the curve, with Akaike weights ({where}).",
    )
    if drawn.area is not None:
        radius = fit.loading_radius
        fitted = drawn.phase == "loading"
        yield Plot(
            name=f"{name}_compliance",
            figure=panel(
                plot_contact_compliance,
                drawn.indentation[fitted],
                drawn.area[fitted],
                loading_radius=radius.value if radius.known else None,
                loading_radius_std=radius.std if radius.known else 0.0,
                synthetic=synthetic,
            ),
            caption=f"Contact area against π × indentation; its slope is the loading radius ({where}).",
        )
    yield from _secant_plots(name, where, fit, synthetic=synthetic)
    if drawn.area is not None and geometric_mean_radius is not None:
        yield _shape(name, where, drawn, geometric_mean_radius, expected_ratio, synthetic=synthetic)
    relaxation = drawn.relaxation()
    if relaxation is not None:
        yield _relaxation(name, where, drawn, relaxation, synthetic=synthetic)


class _Drawn:
    """The press that was fitted, from its fitted zeros of force and displacement."""

    def __init__(self, curve: LoadingCurve, fit: LoadingFit, cycle: int) -> None:
        self.fit, self.cycle = fit, fit.cycles[cycle]
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

    def relaxation(self) -> Relaxation | None:
        """Return the relaxation of the hold, None where there is none to fit."""
        try:
            return fit_relaxation(self.zeroed, self.cycle, self.offset)
        except FitError:
            return None


def _secant_plots(name: str, where: str, fit: LoadingFit, *, synthetic: bool) -> Iterator[Plot]:
    secant, (low, high) = fit.secant, fit.fit_load_range
    line, label = None, "fit"
    initial, growth = fit.initial_modulus, fit.load_coefficient
    if initial.known and growth.known:
        loads = np.array([low, high])
        line = (loads, initial.value + growth.value * loads)
        label = rf"$E_\mathrm{{0g}}$ = {_in_kpa(initial)} kPa, β = {_in_kpa(growth)} kPa/N"
    fitted = (secant.load >= low) & (secant.load <= high)
    against: Literal["load", "indentation"]
    outside = "" if fitted.all() else "; grey: not in the range of loads that was fitted"
    for against, abscissa in (("load", secant.load), ("indentation", secant.indentation)):
        drawn = ", with the fitted line" if line is not None and against == "load" else ""
        yield Plot(
            name=f"{name}_secant_modulus_{against}",
            figure=panel(
                plot_secant_modulus,
                abscissa,
                secant.modulus,
                against=against,
                fitted_points=fitted,
                fit=line if against == "load" else None,
                label=label,
                synthetic=synthetic,
            ),
            caption=f"Secant modulus against {against}{drawn}{outside} ({where}).",
        )


def _in_kpa(estimate: Estimate) -> str:
    return value_with_uncertainty(KPA_PER_MPA * estimate.value, KPA_PER_MPA * estimate.std)


def _shape(
    name: str,
    where: str,
    drawn: _Drawn,
    radius: float,
    expected: tuple[ArrayLike, ArrayLike] | None,
    *,
    synthetic: bool,
) -> Plot:
    fitted = (drawn.phase == "loading") & (drawn.load > 0.05 * drawn.load.max())
    assert drawn.area is not None  # drawn only with areas
    ratio = sphere_ratio(drawn.indentation[fitted], drawn.area[fitted], loading_radius=radius)
    return Plot(
        name=f"{name}_shape",
        figure=panel(
            plot_modulus_from_area_and_indentation,
            drawn.load[fitted],
            ratio,
            expected_ratio=expected,
            synthetic=synthetic,
        ),
        caption="E* read from the area over E* read from the indentation, on R_e of the undeformed pad: "
        f"one for a Hertzian contact ({where}).",
    )


def _relaxation(name: str, where: str, drawn: _Drawn, found: Relaxation, *, synthetic: bool) -> Plot:
    loading, hold = drawn.cycle.loading, drawn.cycle.hold
    assert hold is not None and drawn.zeroed.time is not None  # noqa: PT018 (fitted only with both)
    begin = drawn.zeroed.time[hold.start]
    times = [term.time for term in found.terms]
    said = ", ".join(
        f"{value_with_uncertainty(each.value, each.std)} s" if each.known else each.reason for each in times
    )
    return Plot(
        name=f"{name}_relaxation",
        figure=panel(
            plot_relaxation,
            drawn.zeroed.time[hold.rows] - begin,
            drawn.zeroed.load[hold.rows],
            fit=(found.time + drawn.zeroed.time[loading.start] - begin, found.load),
            label=f"Prony series of {len(times)} terms" if len(times) != 1 else "Prony series of one term",
            ramp_time=found.ramp_time,
            time_constants=[time.value for time in times if time.known],
            synthetic=synthetic,
        ),
        caption=f"Load during the hold, with the Prony series through the recorded ramp; time constants: "
        f"{said or 'none'} ({where}).",
    )
