"""Radius, moduli, contact point and exponents of one loading curve, in one call."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np

from fingerpad._records import Recorded
from fingerpad.estimate import Estimate, estimates_record
from fingerpad.exceptions import FitError, LoadingError
from fingerpad.loading._prepare import (
    Press,
    determined,
    fixed_quantities,
    known_quantities,
    prepare,
    start_values,
)
from fingerpad.loading.contact_point import ESTIMATORS, estimated_places
from fingerpad.loading.curve import LoadingCurve
from fingerpad.loading.joint import JointFit, fit_joint
from fingerpad.loading.laws import FittedForceModel
from fingerpad.loading.modulus_range import Secant, increasing_range, modulus_range, secant_of
from fingerpad.loading.quantities import implausible, quantities, top_load
from fingerpad.loading.rivals import allow_for_bend, compare, fit_growing
from fingerpad.loading.segments import Cycle, Hysteresis, hysteresis
from fingerpad.units import KPA_PER_MPA

_MODULI = {"reduced_modulus", "youngs_modulus", "initial_modulus", "load_coefficient"}
# AICc by which the law with a growing modulus must be ahead before the modulus is said to depend on the load.
_DECISIVE = 10.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class LoadingFit(Recorded):
    """Results of fitting one press. A quantity that is not known has the reason.

    Attributes
    ----------
    loading_radius : Estimate
        R_g, mm: from the slope of area against πξ, in the joint fit; or as given.
    reduced_modulus, youngs_modulus : Estimate
        E* and E, MPa, secant at `modulus_load`; for a Hertzian pad the same at every load.
    contact_offset : Estimate
        Displacement at first contact, mm.
    initial_modulus, load_coefficient : Estimate
        E_0g (MPa) and β (MPa/N) of E_g = E_0g + β W.
    load_exponent : Estimate
        m of W ∝ ξ^m; 3/2 for Hertz.
    area_exponent : Estimate
        n of A ∝ W^n; 2/3 for Hertz.
    modulus_load : float
        Largest load fitted, N.
    fit_load_range : (float, float)
        Loads between which E_g was taken to increase, N.
    cycles : tuple of Cycle
        All presses in the record.
    hysteresis : tuple of (Hysteresis or None)
        Of each cycle.
    models : mapping of str to FittedForceModel
        ``load_dependent``, ``hertz``, ``free_exponent``, under one noise.
    preferred_model : str
        That of the least AICc.
    alternatives : mapping of str to FittedForceModel
        Other explanations of the curve under the same noise, by key of `EXPLANATIONS`: an offset or another
        growth of the areas, a stage that yields, a layer on bone, both also with one modulus, an exact
        sphere.
    misfit_std : mapping of str to float
        What better explanations add to the standard uncertainty of a quantity; 0 where there are none.
    secant : Secant
        E_g of each row against ξ and W.
    notes : mapping of str to str
        What a flag means for this curve.
    flags : tuple of str
        Doubts.

    Examples
    --------
    >>> from fingerpad.simulate import simulate_loading_curve
    >>> fit = fit_loading_curve(simulate_loading_curve(points=60, force_std=0.005, area_std=0.5, seed=1))
    >>> print(f"E_0g = {1000 * fit.initial_modulus.value:.0f} kPa (truth: 40), {fit.preferred_model}")
    E_0g = 40 kPa (truth: 40), load_dependent
    """

    _title: ClassVar[str] = "Fit of a loading curve"

    loading_radius: Estimate
    reduced_modulus: Estimate
    youngs_modulus: Estimate
    contact_offset: Estimate
    initial_modulus: Estimate
    load_coefficient: Estimate
    load_exponent: Estimate
    area_exponent: Estimate
    modulus_load: float
    fit_load_range: tuple[float, float]
    cycles: tuple[Cycle, ...]
    hysteresis: tuple[Hysteresis | None, ...]
    models: Mapping[str, FittedForceModel]
    preferred_model: str
    alternatives: Mapping[str, FittedForceModel]
    misfit_std: Mapping[str, float]
    secant: Secant
    notes: Mapping[str, str]
    flags: tuple[str, ...]

    def divide_by_constraint(self, coefficient: Estimate) -> Self:
        """Return the fit with all moduli divided by a constraint coefficient.

        Bone and nail make a thin pad stiffer than a half-space of the same tissue, by this factor. It is
        poorly known for fingers: its uncertainty goes into the moduli, and the result is flagged
        ``constraint_assumed``.

        Parameters
        ----------
        coefficient : Estimate
            The factor, independent of the fit.

        Returns
        -------
        LoadingFit
            With moduli and β divided.

        Raises
        ------
        LoadingError
            If the coefficient is not positive and finite.
        """
        if not (coefficient.value > 0 and math.isfinite(coefficient.value) and coefficient.std >= 0):
            raise LoadingError(
                f"the constraint coefficient must be positive, found {coefficient.value} ± {coefficient.std}"
            )
        return replace(
            self,
            reduced_modulus=self.reduced_modulus.over(coefficient),
            youngs_modulus=self.youngs_modulus.over(coefficient),
            initial_modulus=self.initial_modulus.over(coefficient),
            load_coefficient=self.load_coefficient.over(coefficient),
            misfit_std={
                name: std / (coefficient.value if name in _MODULI else 1.0)
                for name, std in self.misfit_std.items()
            },
            flags=(*self.flags, "constraint_assumed"),
        )

    def as_record(self) -> dict[str, Any]:
        """Return the numbers by names that end in units.

        Returns
        -------
        dict
            Each with ``_std`` and ``_ci95``; None where unknown.
        """
        quantities = {
            "effective_radius_mm": self.loading_radius,
            "reduced_modulus_kpa": self.reduced_modulus.times(KPA_PER_MPA),
            "youngs_modulus_kpa": self.youngs_modulus.times(KPA_PER_MPA),
            "contact_offset_mm": self.contact_offset,
            "initial_modulus_kpa": self.initial_modulus.times(KPA_PER_MPA),
            "load_coefficient_kpa_per_N": self.load_coefficient.times(KPA_PER_MPA),
            "load_exponent": self.load_exponent,
            "area_exponent": self.area_exponent,
        }
        return {
            **estimates_record(quantities),
            "modulus_load_N": self.modulus_load,
            "region_N": list(self.fit_load_range),
            "preferred_model": self.preferred_model,
            "aicc": {name: model.aicc for name, model in self.models.items()},
            "aicc_alternatives": {name: model.aicc for name, model in self.alternatives.items()},
            "notes": dict(self.notes),
            "segments": [cycle.as_record() for cycle in self.cycles],
            "hysteresis_mJ": [loss.energy if loss else None for loss in self.hysteresis],
            "hysteresis_fraction": [loss.fraction if loss else None for loss in self.hysteresis],
            "flags": list(self.flags),
        }


def fit_loading_curve(
    curve: LoadingCurve,
    *,
    poisson_ratio: float = 0.5,
    loading_radius: float | Estimate | None = None,
    cycle: int = 0,
    contact_point: str = "joint",
    fit_load_range: tuple[float, float] | None = None,
    stage_compliance: float | Estimate | None = None,
    area_delay: float | Estimate | None = None,
    thickness: float | Estimate | None = None,
    area_relative_std: float = 0.0,
) -> LoadingFit:
    """Fit radius, modulus and its growth with load, place of contact and exponents to one press.

    Baseline and loading are fitted together: F = W(ξ) + zero + tilt t and A = π R_g ξ, with
    W = 4/3 R_g^{1/2} ξ^{3/2} (E_0g + β W)/(1 − ν²). Zero, tilt and place of contact are parameters, so that
    their uncertainty is in all results; noise of force, displacement and area is estimated.

    Parameters
    ----------
    curve : LoadingCurve
        The record.
    poisson_ratio : float
        ν of the pad.
    loading_radius : float or Estimate, optional
        R_g (mm) from elsewhere, used as it is and with its uncertainty; needed where there is no area.
    cycle : int
        Which press of the record to fit.
    contact_point : str
        ``joint``, or a name of `ESTIMATORS`, whose place of contact is then held.
    fit_load_range : (float, float), optional
        Loads (N) between which E_g increases linearly; found from the curve without it.
    stage_compliance : float or Estimate, optional
        By how much stage and support yield under load, mm/N; the indentation is corrected for it.
    area_delay : float or Estimate, optional
        By how much the areas are late, s; the curve needs its times.
    thickness : float or Estimate, optional
        Of the layer on a rigid base that is pressed, mm; infinite for a half-space. R_g and the moduli are
        then those on this layer. Without it tissue of a finger on bone, 3 to 25 mm thick and at least twice
        as thick as it is indented, is one of the explanations.
    area_relative_std : float
        Relative standard uncertainty of the areas that is common to all of them, as of their scale.

    Returns
    -------
    LoadingFit
        The fitted quantities with uncertainty.

    Raises
    ------
    LoadingError
        If the curve or an argument cannot be used: no range, reversed signs, no such cycle.
    FitError
        If the record shows no contact, or does not determine the model.

    Examples
    --------
    >>> from fingerpad.simulate import simulate_loading_curve
    >>> curve = simulate_loading_curve(points=200, force_std=0.005, area_std=0.5, seed=1)
    >>> fit = fit_loading_curve(curve)
    >>> radius = fit.loading_radius
    >>> radius.lower < 15 < radius.upper
    True
    """
    if not isinstance(curve, LoadingCurve):
        raise LoadingError(
            f"curve must be a LoadingCurve, found {type(curve).__name__}: `read_loading_curve` reads a file, "
            "LoadingCurve(load=…, indentation=…) takes arrays in N and mm"
        )
    _require_options(poisson_ratio, contact_point)
    with determined("the model", ": is it rounded, repeated, or of the wrong sign?"):
        known_parts = known_quantities(
            curve,
            stage_compliance=stage_compliance,
            area_delay=area_delay,
            thickness=thickness,
            area_relative_std=area_relative_std,
        )
        press = prepare(curve, poisson_ratio, cycle)
        held = fixed_quantities(press, loading_radius) | known_parts
        main, limits, doubts = _main_fit(press, held, contact_point, fit_load_range)
        compared = compare(allow_for_bend(main))
        main = compared.main
        models = _models(main)
        preferred = min(models, key=lambda name: models[name].aicc)
        grows = "hertz" in models and models["hertz"].aicc > main.aicc + _DECISIVE
        known = press.record.area.size > 0 or loading_radius is not None
        found, added = quantities(compared, models, known=known)
        return LoadingFit(
            **found,
            misfit_std=added,
            modulus_load=top_load(main),
            fit_load_range=limits,
            cycles=press.cycles,
            hysteresis=tuple(hysteresis(curve, each) for each in press.cycles),
            models={name: model.fitted_law() for name, model in models.items()},
            preferred_model=preferred,
            alternatives={name: rival.fitted_law() for name, rival in compared.rivals.items()},
            notes=dict(compared.doubts),
            secant=secant_of(main),
            flags=(
                *implausible(main, loading_radius, known=known),
                *press.flags,
                *doubts,
                *compared.doubts,
                *(("modulus_depends_on_load",) if grows else ()),
            ),
        )


def contact_points(
    curve: LoadingCurve,
    *,
    poisson_ratio: float = 0.5,
    loading_radius: float | Estimate | None = None,
    cycle: int = 0,
) -> dict[str, Estimate]:
    """Return the place of contact by each estimator of `ESTIMATORS`, and by the joint fit.

    The error of each is estimated from twenty records simulated from the joint fit with its noise: the root
    mean square error, bias included, is the standard uncertainty. The value itself is not corrected.

    Parameters
    ----------
    curve : LoadingCurve
        The record.
    poisson_ratio : float
        ν of the pad.
    loading_radius : float or Estimate, optional
        R_g (mm) from elsewhere; needed where there is no area.
    cycle : int
        Which press of the record, counted from 0.

    Returns
    -------
    dict of str to Estimate
        Displacement at first contact, mm, by estimator.

    Raises
    ------
    LoadingError, FitError
        As `fit_loading_curve`.

    Examples
    --------
    >>> from fingerpad.simulate import simulate_loading_curve
    >>> places = contact_points(simulate_loading_curve(points=200, force_std=0.005, area_std=0.5, seed=1))
    >>> places["joint"].std < places["contact_by_threshold"].std
    True
    """
    press = prepare(curve, poisson_ratio, cycle)
    held = fixed_quantities(press, loading_radius)
    return estimated_places(_growing_fit(press, held))


def _require_options(poisson_ratio: float, contact_point: str) -> None:
    if not -1 < poisson_ratio <= 0.5:
        raise LoadingError(f"poisson_ratio must be above -1 and at most 0.5, found {poisson_ratio}")
    if contact_point != "joint" and contact_point not in ESTIMATORS:
        raise LoadingError(f"contact_point must be joint, {', '.join(ESTIMATORS)}; found {contact_point!r}")


def _growing_fit(press: Press, held: Mapping[str, Estimate]) -> JointFit:
    """Return the fit of the growing modulus over the whole press."""
    radius = held["loading_radius"].value if "loading_radius" in held else None
    start = start_values(press, radius)
    if "inverse_thickness" in held and held["inverse_thickness"].value > 0:
        # The layer explains part of the load, and of its growth.
        start |= {"initial_modulus": start["initial_modulus"] / 2, "load_coefficient": 0.0}
    return fit_growing(press.record, start, held)


def _main_fit(
    press: Press,
    held: Mapping[str, Estimate],
    contact_point: str,
    fit_load_range: tuple[float, float] | None,
) -> tuple[JointFit, tuple[float, float], list[str]]:
    """Return the fit of the growing modulus over its range of loads, that range, and doubts."""
    main = _growing_fit(press, held)
    if contact_point != "joint":
        place = estimated_places(main)[contact_point]
        if not place.known:
            raise FitError(f"no place of contact by {contact_point}: {place.reason}")
        held = {**held, "contact_offset": place}
        main = fit_growing(press.record, main.values, held)
    doubts = []
    limits, record = modulus_range(main, fit_load_range)
    if record.load.size < press.record.load.size:
        part = fit_growing(record, main.values, held)
        # Without the place of contact that the other rows gave, E_g may not fall at all.
        whole = (0.0, float(part.load(press.record.smooth_displacement).max()))
        if fit_load_range is not None:
            doubts.append("region_given")
            main = part
        elif increasing_range(part, press.record) != whole:
            doubts.append("modulus_partly_decreases")
            main = part
        else:
            limits = (0.0, top_load(main))
    before = np.count_nonzero(record.smooth_displacement < main.values["contact_offset"])
    if before < 2 and "no_baseline" not in press.flags:
        doubts.append("no_baseline")
    return main, limits, doubts


def _models(main: JointFit) -> dict[str, JointFit]:
    """Return the laws fitted under one noise, those that can be."""
    start = {**main.values, "load_exponent": 1.5}
    start["youngs_modulus"] = start.pop("initial_modulus") + start.pop("load_coefficient") * top_load(main)
    found = {"load_dependent": main}
    for law in ("hertz", "free_exponent"):
        unused = {"load_exponent"} if law == "hertz" else set()
        begin = {name: value for name, value in start.items() if name not in unused}
        try:
            found[law] = fit_joint(main.record, law, begin, main.held, main.noise)
        except FitError:
            continue
    return found
