"""The figures of one loading curve."""

from collections.abc import Iterator
from typing import Literal

import numpy as np

from fingerpad import figures
from fingerpad._arrays import ArrayLike, FloatArray
from fingerpad._rounding import value_with_uncertainty
from fingerpad.exceptions import FitError
from fingerpad.figures.loading import law_lines, predicted_band
from fingerpad.figures.marks import Figure
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

    def plot(kind: str, figure: Figure, caption: str) -> Plot:
        return Plot(name=f"{name}_{kind}", figure=figure, caption=f"{caption} ({where or name}).")

    drawn = _Drawn(curve, fit, cycle)
    loading = drawn.phase == "loading"
    yield plot(
        "load_indentation",
        panel(
            figures.plot_load_indentation,
            drawn.indentation,
            drawn.load,
            phase=drawn.phase,
            fits=law_lines(fit),
            band=predicted_band(fit),
            synthetic=synthetic,
        ),
        "Load against indentation from the fitted place of contact, and the laws fitted to the loading; the "
        "band is the 95 % interval of the load at an indentation",
    )
    yield plot(
        "residuals",
        panel(figures.plot_load_residuals, fit, synthetic=synthetic),
        "Load less that of the fitted law, the 95 % interval of its load, and what else could have made the "
        "curve, with Akaike weights",
    )
    if drawn.area is not None:
        radius, with_area = fit.loading_radius, loading & np.isfinite(drawn.area)
        yield plot(
            "compliance",
            panel(
                figures.plot_contact_compliance,
                drawn.indentation[with_area],
                drawn.area[with_area],
                loading_radius=radius.value if radius.known else None,
                loading_radius_std=radius.std if radius.known else 0.0,
                synthetic=synthetic,
            ),
            "Contact area against π × indentation; its slope is the loading radius",
        )
    for figure in _secant_moduli(fit, synthetic=synthetic):
        yield plot(*figure)
    if drawn.area is not None and geometric_mean_radius is not None:
        chosen = with_area & (drawn.load > 0.05 * drawn.load.max())
        xi, area = drawn.indentation[chosen], drawn.area[chosen]
        yield plot(
            "shape",
            panel(
                figures.plot_modulus_from_area_and_indentation,
                drawn.load[chosen],
                sphere_ratio(xi, area, loading_radius=geometric_mean_radius),
                expected_ratio=expected_ratio,
                synthetic=synthetic,
            ),
            "E* read from the area over E* read from the indentation, on R_e of the undeformed pad: one for "
            "a Hertzian contact",
        )
    for figure in _relaxation(drawn, synthetic=synthetic):
        yield plot(*figure)


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


def _secant_moduli(fit: LoadingFit, *, synthetic: bool) -> Iterator[tuple[str, Figure, str]]:
    """Yield kind, figure and caption of the secant modulus against load, and against indentation."""
    secant, (low, high) = fit.secant, fit.fit_load_range
    line, label = None, "fit"
    initial, growth = fit.initial_modulus, fit.load_coefficient
    if initial.known and growth.known:
        loads = np.array([low, high])
        said = [
            value_with_uncertainty(KPA_PER_MPA * one.value, KPA_PER_MPA * one.std)
            for one in (initial, growth)
        ]
        label = rf"$E_\mathrm{{0g}}$ = {said[0]} kPa, β = {said[1]} kPa/N"
        line = loads, initial.value + growth.value * loads
    fitted = (secant.load >= low) & (secant.load <= high)
    outside = "" if fitted.all() else "; grey: not in the range of loads that was fitted"
    against: Literal["load", "indentation"]
    for against, x, shown in (("load", secant.load, line), ("indentation", secant.indentation, None)):
        yield (
            f"secant_modulus_{against}",
            panel(
                figures.plot_secant_modulus,
                x,
                secant.modulus,
                against=against,
                fitted_points=fitted,
                fit=shown,
                label=label,
                synthetic=synthetic,
            ),
            f"Secant modulus against {against}{', with the fitted line' if shown else ''}{outside}",
        )


def _relaxation(drawn: _Drawn, *, synthetic: bool) -> Iterator[tuple[str, Figure, str]]:
    """Yield kind, figure and caption of the relaxation of the hold, where there is one to fit."""
    try:
        found = fit_relaxation(drawn.zeroed, drawn.cycle, drawn.offset)
    except FitError:
        return
    hold, clock = drawn.cycle.hold, drawn.zeroed.time
    assert hold is not None and clock is not None  # noqa: PT018 (fitted only with both)
    begin, times = clock[hold.start], [term.time for term in found.terms]
    said = [f"{value_with_uncertainty(one.value, one.std)} s" if one.known else one.reason for one in times]
    constants = ", ".join(said) or "none"
    yield (
        "relaxation",
        panel(
            figures.plot_relaxation,
            clock[hold.rows] - begin,
            drawn.zeroed.load[hold.rows],
            fit=(found.time + clock[drawn.cycle.loading.start] - begin, found.load),
            label=f"Prony series of {len(times)} terms" if len(times) != 1 else "Prony series of one term",
            ramp_time=found.ramp_time,
            time_constants=[time.value for time in times if time.known],
            synthetic=synthetic,
        ),
        f"Load during the hold, with the Prony series through the recorded ramp; time constants: {constants}",
    )
