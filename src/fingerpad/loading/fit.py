"""Radius, moduli, contact point and exponents of one loading curve, in one call."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from fingerpad._arrays import BoolArray, FloatArray
from fingerpad._plausible import PLAUSIBLE_MODULUS_KPA
from fingerpad.contact.contact import AnyPlacement
from fingerpad.contact.elliptic import factor_products, solve_contact_ellipse
from fingerpad.estimate import Estimate
from fingerpad.exceptions import FitError, LoadingError
from fingerpad.loading.contact_point import ESTIMATORS
from fingerpad.loading.curve import (
    LoadingCurve,
    choose_cycle,
    hysteresis,
    moving_average,
    rows_with_area,
)
from fingerpad.loading.joint import (
    NO_AREA,
    NO_RADIUS,
    FitData,
    JointFit,
    Press,
    bounded,
    check_std,
    determined,
    fixed_quantities,
    known_quantities,
    one_pad,
    prepare,
    start_values,
)
from fingerpad.loading.law_fit import fit_adhesion, fit_law, fits_under
from fingerpad.loading.law_registry import ContactLaw, find_law
from fingerpad.loading.laws import MAIN, secant_modulus
from fingerpad.loading.least_squares import fit_least_squares
from fingerpad.loading.result import MODULI, LawUncertainty, LoadingFit, load_gradient
from fingerpad.loading.rivals import (
    DECISIVE,
    FAILURES,
    Comparison,
    akaike_weights,
    allow_for_bend,
    average_models,
    compare,
    fit_growing,
)
from fingerpad.units import KPA_PER_MPA

# Beyond these no finger pad lies, mm: a wrong unit.
PLAUSIBLE_RADIUS = (2.0, 100.0)
# A given radius is doubted when the slope of the area is so many standard uncertainties away.
_CONTRADICTED = 4.0
_PARAMETERS = ("loading_radius", "initial_modulus", "load_coefficient", "contact_offset")
_BINS, _MIN_ROWS = 12, 5
# Nearer to contact than this share of the depth its place decides the modulus.
_NEAR_CONTACT = 0.2
# A fall counts that is both this share of the modulus and this many standard uncertainties.
_FALL, _DEVIATIONS = 0.1, 3.0
# Simulated records from which the error of a place of contact is found.
_SIMULATED = 20
# An area that grows by less than this share of itself does not grow.
_FLAT = 1e-9
_FEWEST_AREAS = 5
HERTZ_EXPONENT = 1.5
# Share of the work lost by the way out from which the modulus depends on speed, in linear viscoelasticity by
# some 20 % for ten times the speed; the stage's friction of 2 % of the load loses a tenth. A pull deeper than
# this share of the load may be adhesion that loses as much.
_LOST, _PULL = 0.2, 0.05
# Standard uncertainties and distance by which the exponent of a pad that relaxes is below Hertz's.
_SURE, _SLOWER = 3.0, 0.025
# Weight below which an explanation cannot move an end of a 95 % interval.
_NEGLIGIBLE = 0.005


def fit_loading_curve(
    curve: LoadingCurve,
    *,
    poisson_ratio: float = 0.5,
    placement: AnyPlacement | None = None,
    loading_radius: float | Estimate | None = None,
    cycle: int = 0,
    contact_point: str = "joint",
    fit_load_range: tuple[float, float] | None = None,
    stage_compliance: float | Estimate | None = None,
    area_delay: float | Estimate | None = None,
    thickness: float | Estimate | None = None,
    area_relative_std: float = 0.0,
    load_relative_std: float = 0.0,
    poisson_ratio_std: float = 0.0,
    law: str | ContactLaw | None = None,
) -> LoadingFit:
    """Fit radius, modulus and its growth with load, place of contact and exponents to one press.

    Baseline and loading are fitted together: F = W(ξ) + zero + tilt t and A = π R_g ξ, with
    W = 4/3 R_g^{1/2} ξ^{3/2} (E_0g + β W)/(1 − ν²). Zero, tilt and place of contact are parameters, so that
    their uncertainty is in all results; noise of force, displacement and area is estimated. Of a press of
    more than 4000 rows means of neighbouring rows are fitted.

    Parameters
    ----------
    curve : LoadingCurve
        The record.
    poisson_ratio : float
        ν of the pad.
    placement : Placement or Paraboloid, optional
        Where the pad touches a flat plate, or its two radii of curvature there. All moduli are then those of
        its elliptical contact, F1 F2 ≤ 1 times those of a sphere with the same area at each indentation.
    loading_radius : float or Estimate, optional
        R_g (mm) from elsewhere, used as it is and with its uncertainty; needed where there is no area.
    cycle : int
        Which press of the record to fit.
    contact_point : str
        ``joint``, or by which method it is found and then held: ``contact_by_threshold``, ``two_lines``,
        ``gradient`` or ``power_law``.
    fit_load_range : (float, float), optional
        Loads (N) between which E_g increases linearly; found from the curve without it.
    stage_compliance : float or Estimate, optional
        By how much stage and support yield under load, mm/N; the indentation is corrected for it.
    area_delay : float or Estimate, optional
        By how much the areas are late, s; the curve needs its times.
    thickness : float or Estimate, optional
        Of the layer on a rigid base that is pressed, mm; infinite for a half-space. R_g and the moduli are
        then those on this layer. Without it tissue of a finger on bone, 1 to 25 mm thick and at least twice
        as thick as it is indented, is one of the explanations.
    area_relative_std : float
        Relative standard uncertainty of the areas that is common to all of them, as of their scale.
    load_relative_std, poisson_ratio_std : float
        Relative standard uncertainty of the forces that is common to all of them, as of the sensor's gain,
        and standard uncertainty of ν. Those of the moduli contain them.
    law : str or ContactLaw, optional
        A contact law to fit as well and to compare with ours: one's own (`contact_law`) or its name, also as
        ``my_laws.py:ogden``; or ``jkr``, which is fitted to the way out.

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
    >>> power_law = fit_loading_curve(curve, law="free_exponent").law
    >>> power_law.preferred_model
    'load_dependent'
    """
    if not isinstance(curve, LoadingCurve):
        raise LoadingError(
            f"curve must be a LoadingCurve, found {type(curve).__name__}: `read_loading_curve` reads a file, "
            "LoadingCurve(load=…, indentation=…) takes arrays in N and mm"
        )
    _require_options(poisson_ratio, contact_point)
    check_std("load_relative_std", load_relative_std)
    check_std("poisson_ratio_std", poisson_ratio_std)
    chosen = None if law is None else find_law(law)
    if chosen is not None and chosen.pull_off is not None and thickness is not None:
        raise LoadingError(f"{chosen.name} is a law of a half-space: leave the thickness out, or the law")
    shape_factor = 1.0 if placement is None else _shape_factor(placement)
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
        known = press.record.area.size > 0 or loading_radius is not None
        found, added = _quantities(compared, models, known=known)
        of_poisson_ratio = 2 * poisson_ratio / (1 - poisson_ratio**2) * poisson_ratio_std
        for name, std in (
            ("reduced_modulus", load_relative_std),
            ("youngs_modulus", math.hypot(load_relative_std, of_poisson_ratio)),
            ("initial_modulus", math.hypot(load_relative_std, of_poisson_ratio)),
        ):
            found[name] = found[name].over(Estimate.symmetric(1.0, std))
        for name in MODULI:
            found[name], added[name] = found[name].times(shape_factor), added[name] * shape_factor
        of_force = _force_doubts(
            models, relaxes=_relaxation_note(curve, press, cycle, compared, found["load_exponent"])
        )
        by_law = None
        if chosen is not None and chosen.pull_off is not None:
            by_law = fit_adhesion(
                curve,
                law=chosen,
                poisson_ratio=poisson_ratio,
                loading_radius=loading_radius,
                cycle=cycle,
                stage_compliance=stage_compliance,
                area_delay=area_delay,
                area_relative_std=area_relative_std,
            )
        elif chosen is not None:
            by_law = fit_law(main, models, chosen, known=known)
        return LoadingFit(
            **found,
            misfit_std=added,
            shape_factor=shape_factor,
            modulus_load=main.top_load,
            fit_load_range=limits,
            cycles=press.cycles,
            hysteresis=tuple(hysteresis(curve, each) for each in press.cycles),
            models={name: model.fitted_law() for name, model in models.items()},
            alternatives={name: rival.fitted_law() for name, rival in compared.rivals.items()},
            model_aicc=compared.model_aicc,
            uncertainty=_uncertainties(compared),
            unexplained=compared.unexplained,
            rows=main.record,
            law=by_law,
            notes={
                **compared.doubts,
                **{flag: words for flag, words in of_force.items() if words},
                **({} if by_law is None else by_law.notes),
            },
            flags=(
                *_implausible(main, loading_radius, known=known),
                *press.flags,
                *doubts,
                *compared.doubts,
                *of_force,
                *(() if by_law is None else (flag for flag in by_law.flags if flag in by_law.notes)),
            ),
        )


def fit_contact_compliance(curve: LoadingCurve, *, cycle: int = 0) -> Estimate:
    """Fit R_g (mm), the slope of contact area against πξ ("contact compliance"), to one loading.

    The rows are those from where the area is well above zero and not cut off, and the zero of displacement is
    free. A smooth sphere or ellipse gives R = A/(πξ) at every load, whatever its modulus and however it
    varies with load.
    """
    if curve.area is None:
        raise FitError("the loading curve has no contact area; R_g needs a column area_mm2")
    _, press = choose_cycle(curve, cycle)
    rows = rows_with_area(curve, press)
    if rows.size < 3:
        raise FitError(f"{rows.size} rows in contact while the load grows; at least 3 are needed for a line")
    x, y = np.pi * curve.indentation[rows], curve.area[rows]
    (slope, _), covariance = np.polyfit(x, y, 1, cov=True)
    if not slope * np.ptp(x) > _FLAT * np.abs(y).max():
        raise FitError(
            f"contact area falls as the displacement grows (slope {slope:.3g} mm); is its sign reversed?"
        )
    return Estimate.symmetric(slope, math.sqrt(covariance[0, 0]), rows.size - 2)


def _require_options(poisson_ratio: float, contact_point: str) -> None:
    if not -1 < poisson_ratio <= 0.5:
        raise LoadingError(f"poisson_ratio must be above -1 and at most 0.5, found {poisson_ratio}")
    if contact_point != "joint" and contact_point not in ESTIMATORS:
        raise LoadingError(f"contact_point must be joint, {', '.join(ESTIMATORS)}; found {contact_point!r}")


def _shape_factor(placement: AnyPlacement) -> float:
    """Return F1 F2 of the contact ellipse: E* from W, ξ and R = A/(πξ) over what a sphere makes of them."""
    gap = one_pad(placement)
    axis_ratio, *_ = solve_contact_ellipse(gap.first_radius, gap.second_radius)
    return float(factor_products(axis_ratio)[1])


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
        held = {**held, "contact_offset": contact_by(contact_point, main)}
        main = fit_growing(press.record, main.values, held)
    doubts = []
    limits, record = _modulus_range(main, fit_load_range)
    if record.load.size < press.record.load.size:
        part = fit_growing(record, main.values, held)
        # Without the place of contact that the other rows gave, E_g may not fall at all.
        whole = (0.0, float(part.load(press.record.smooth_displacement).max()))
        if fit_load_range is not None:
            doubts.append("region_given")
            main = part
        elif _increasing_range(part, press.record) != whole:
            doubts.append("modulus_partly_decreases")
            main = part
        else:
            limits = (0.0, main.top_load)
    before = np.count_nonzero(record.smooth_displacement < main.values["contact_offset"])
    if before < 2 and {"no_baseline", "rounded_force"}.isdisjoint(press.flags):
        doubts.append("no_baseline")
    return main, limits, doubts


def _relaxation_note(
    curve: LoadingCurve, press: Press, chosen: int, compared: Comparison, exponent: Estimate
) -> str:
    """Return how the record shows that the pad relaxes; empty where it does not.

    Work is lost to adhesion as well, which a pull shows, and to friction of the stage, less than the limit.
    """
    cycle = press.cycles[chosen]
    lost = hysteresis(curve, cycle)
    if lost is not None and cycle.unloading is not None and lost.fraction > _LOST:
        zero = curve.load[cycle.baseline.rows].mean() if cycle.baseline else 0.0
        way_out = moving_average(curve.load[cycle.unloading.rows]) - zero
        back = np.ptp(curve.indentation[cycle.unloading.rows])
        if way_out.min() > -_PULL * compared.main.top_load and back > compared.main.depth / 2:
            share = 100 * max(1 - lost.fraction, 0.0)
            return (
                f"the way out gives back {share:.0f} % of the work of the way in, as of a pad that relaxes: "
                "its modulus is that of this speed"
            )
    on_layer = compared.main.values.get("inverse_thickness", 0.0) > 0
    without_areas = not compared.main.record.area.size
    if on_layer or (without_areas and compared.unexplained) or not exponent.known:
        return ""
    sure = exponent.value + _SURE * exponent.std < HERTZ_EXPONENT
    if sure and exponent.upper < HERTZ_EXPONENT - _SLOWER:
        return (
            f"the force grows as ξ^{exponent.value:.2f}, more slowly than by Hertz's law and all that was "
            "compared, as of a pad that relaxes while it is pressed: its modulus is that of this speed"
        )
    return ""


def _force_doubts(models: Mapping[str, JointFit], relaxes: str) -> dict[str, str]:
    """Return flags of a force that no Hertzian pad has, and what they mean here where that is more."""
    main = models[MAIN]
    varies = "hertz" in models and models["hertz"].aicc > main.aicc + DECISIVE
    falls = main.values["load_coefficient"] < 0
    doubts = {
        "relaxes": (bool(relaxes), relaxes),
        "modulus_depends_on_load": (varies and not falls, ""),
        # A pad that relaxes says why.
        "modulus_falls_with_load": (varies and falls and not relaxes, ""),
    }
    return {flag: words for flag, (seen, words) in doubts.items() if seen}


def _uncertainties(compared: Comparison) -> dict[str, LawUncertainty]:
    """Return how well the model and the other explanations are known, as far as their loads depend on it."""
    main_weight = 1 - sum(compared.weights[key] for key in compared.fits)
    return {
        MAIN: _uncertainty(compared.main, main_weight),
        **{key: _uncertainty(one, compared.weights[key]) for key, one in compared.fits.items()},
    }


def _uncertainty(fit: JointFit, weight: float) -> LawUncertainty:
    law, free = fit.fitted_law(), fit.fit.names
    given = [name for name in fit.response if name in law.values]
    shifts = np.array([fit.response[name] * fit.held[name].std for name in given]).reshape(-1, len(free)).T
    own = np.diag([fit.held[name].std for name in given])
    root = np.vstack([shifts, own])
    whole = root @ root.T
    whole[: len(free), : len(free)] += fit.covariance
    names = (*free, *given)
    depth = np.array([0.5, 1.0]) * (fit.record.smooth_displacement.max() - fit.values["contact_offset"])
    slope = load_gradient(law, names, depth)
    acts = np.flatnonzero(slope.any(axis=0))
    gradient = dict(zip(names, slope[-1].tolist(), strict=True))
    try:
        top = fit.combined(0.0, gradient)
        factor = top.upper / top.std
    except FAILURES:  # its own uncertainty is lost in rounding
        whole, factor = 0 * whole, 1.0
    return LawUncertainty(
        names=tuple(names[k] for k in acts),
        covariance=whole[np.ix_(acts, acts)],
        coverage_factor=factor,
        weight=float(weight),
    )


def _models(main: JointFit, laws: Iterable[str] = ("hertz", "free_exponent")) -> dict[str, JointFit]:
    """Return a fit of the growing modulus and other laws under its noise, those that can be fitted."""
    start = {**main.values, "load_exponent": HERTZ_EXPONENT}
    start["youngs_modulus"] = start.pop("initial_modulus") + start.pop("load_coefficient") * main.top_load
    begins = {"hertz": {**start}, "free_exponent": start}
    del begins["hertz"]["load_exponent"]
    begins = {law: begins[law] for law in laws}
    return {MAIN: main, **dict(fits_under(main.noise, main.record, begins, main.held))}


def _quantities(
    compared: Comparison, models: Mapping[str, JointFit], *, known: bool
) -> tuple[dict[str, Estimate], dict[str, float]]:
    """Return all quantities by name, and what better explanations of the curve add to their uncertainty.

    Those that need a radius are unknown where it is not `known`, and moduli where only a layer that is
    thinner than tissue can be has the curve's shape.
    """
    main = compared.main
    top = main.top_load
    whole = {"initial_modulus": 1.0, "load_coefficient": top}
    value = sum(main.values[name] * weight for name, weight in whole.items())
    found: dict[str, Estimate] = {"youngs_modulus": main.combined(value, whole)}
    found |= {name: bounded(main.estimate(name)) for name in _PARAMETERS}
    added = {}
    for name in found:
        gradient = whole if name == "youngs_modulus" else {name: 1.0}
        own = value if name == "youngs_modulus" else main.values[name]
        spread = _spread_of_laws(name, own, models, compared.unexplained)
        found[name], added[name] = compared.widened(name, found[name], gradient, spread)
    unknown, why = set[str](), compared.too_thin
    if not known:
        unknown, why = found.keys() - {"contact_offset"}, NO_RADIUS
    elif why:
        unknown = {"youngs_modulus", "initial_modulus", "load_coefficient"}
    found |= dict.fromkeys(unknown, Estimate.unknown(why))
    added |= dict.fromkeys(unknown, 0.0)
    reduction = 1 / (1 - main.record.poisson_ratio**2)
    found |= {
        "reduced_modulus": found["youngs_modulus"].times(reduction),
        "load_exponent": load_exponent(compared, models),
        "area_exponent": area_exponent(compared, models) if known else Estimate.unknown(NO_RADIUS),
    }
    return found, {**added, "reduced_modulus": reduction * added["youngs_modulus"]}


def _spread_of_laws(name: str, value: float, models: Mapping[str, JointFit], unexplained: float) -> float:
    """Return the root mean square difference of laws of the force from the model in one quantity."""
    found = []
    for law, model in models.items():
        values = model.values
        if law == "hertz":
            values |= {"initial_modulus": values["youngs_modulus"], "load_coefficient": 0.0}
        elif law == "free_exponent":
            values["youngs_modulus"] *= model.depth ** (values["load_exponent"] - HERTZ_EXPONENT)
        elif name == "youngs_modulus":
            values[name] = value
        if name in values:
            found.append((model.aicc, values[name] - value))
    return _root_mean_square(found, unexplained)


def _root_mean_square(differences: Iterable[tuple[float, float]], unexplained: float) -> float:
    """Return that of differences of laws from the model, each after its AICc.

    They are weighed as AICc says for residuals of which noise explains that much less (Burnham and Anderson
    2002, 2.5).
    """
    criteria, apart = zip(*differences, strict=True)
    weights = akaike_weights([(1 - unexplained) * each for each in criteria])
    return math.sqrt(sum(w * one**2 for w, one in zip(weights, apart, strict=True)))


def _implausible(main: JointFit, given: float | Estimate | None, *, known: bool) -> tuple[str, ...]:
    """Return flags for values that no finger pad has, and for a given radius that the area contradicts."""
    radius = main.values["loading_radius"]
    modulus = main.values["initial_modulus"] + main.values["load_coefficient"] * main.top_load
    record = main.record
    contradicted = False
    if given is not None and record.area.size >= _FEWEST_AREAS:
        displacement = record.smooth_displacement[record.with_area]
        (slope, _), covariance = np.polyfit(np.pi * displacement, record.area, 1, cov=True)
        given_std = given.std if isinstance(given, Estimate) else 0.0
        std = math.hypot(math.sqrt(covariance[0, 0]), given_std, 0.02 * radius)
        contradicted = abs(slope - radius) > _CONTRADICTED * std
    least, most = PLAUSIBLE_MODULUS_KPA
    doubts = {
        "radius_contradicts_area": contradicted,
        "implausible_radius": known and not PLAUSIBLE_RADIUS[0] <= radius <= PLAUSIBLE_RADIUS[1],
        "implausible_modulus": known and not least <= KPA_PER_MPA * modulus <= most,
    }
    return tuple(name for name, seen in doubts.items() if seen)


def _modulus_range(
    fit: JointFit, given: tuple[float, float] | None = None
) -> tuple[tuple[float, float], FitData]:
    """Return the loads (N) between which E_g increases, and the record's rows before contact and in between.

    E_g is averaged in up to twelve bins along the curve. The range ends at its last maximum and starts at the
    last minimum before, within noise.
    """
    record = fit.record
    load = fit.load(record.smooth_displacement)
    low, high = given if given is not None else _increasing_range(fit, record)
    keep = (load <= 0) | ((load >= low) & (load <= high))
    if not (low < high and np.count_nonzero(keep & (load > 0)) >= _MIN_ROWS):
        raise LoadingError(
            f"fit_load_range must be two rising loads with at least {_MIN_ROWS} rows between, "
            f"found {low:g} to {high:g} N"
        )
    if keep.all():
        return (float(low), float(high)), record
    return (float(low), float(high)), replace(
        record,
        clock=record.clock[keep],
        load=record.load[keep],
        displacement=record.displacement[keep],
        smooth_displacement=record.smooth_displacement[keep],
        area=record.area[keep[record.with_area]],
        with_area=record.with_area[keep],
    )


def _increasing_range(fit: JointFit, record: FitData) -> tuple[float, float]:
    """Return the loads (N) between which E_g of a record increases, with the place of contact of a fit."""
    load, values = fit.load(record.smooth_displacement), fit.values
    whole = (0.0, float(load.max()))
    depth = record.smooth_displacement - values["contact_offset"]
    rows = np.flatnonzero(depth > _NEAR_CONTACT * depth.max())
    if rows.size < 3 * _MIN_ROWS:
        return whole
    bins = np.array_split(rows, min(_BINS, rows.size // _MIN_ROWS))
    # The zero of the rows before contact: where the law fails, the fitted tilt makes up for it.
    before = depth <= 0
    zero = float(record.load[before].mean()) if before.sum() > 1 else values.get("force_zero", 0.0)
    measured = secant_modulus(
        record.load[rows] - zero,
        depth[rows],
        loading_radius=values["loading_radius"],
        poisson_ratio=record.poisson_ratio,
    )
    at = np.split(measured, np.cumsum([part.size for part in bins])[:-1])
    mean = np.array([part.mean() for part in at])
    std = np.array([part.std(ddof=1) / np.sqrt(part.size) for part in at])
    slack = np.maximum(_FALL * np.abs(mean).max(), _DEVIATIONS * std)
    last, end = int(np.argmax(mean)), len(bins) - 1
    last = last if (mean[last:] < mean[last] - slack[last:]).any() else end
    first = int(np.argmin(mean[: last + 1]))
    first = first if (mean[:first] > mean[first] + slack[:first]).any() else 0
    if last - first < 2:
        return whole
    low = 0.0 if first == 0 else float(load[bins[first][0]])
    high = whole[1] if last == end else float(load[bins[last][-1]])
    return low, high


# --- exponents of load and area, and place of contact by other methods ---


def load_exponent(compared: Comparison, models: Mapping[str, JointFit]) -> Estimate:
    """Return m of the power law, with the uncertainty of what else could explain the curve.

    A layer that is not stated is what the exponent describes, and a sphere has the paraboloid's here.
    """
    if "free_exponent" not in models:
        return Estimate.unknown("a power law with free exponent does not fit the curve")
    own = bounded(models["free_exponent"].estimate("load_exponent"))
    if not own.known:
        return own
    found, weights = [own], [1.0]
    for name, fit in compared.fits.items():
        weight = compared.weights[name]
        if weight < _NEGLIGIBLE or name == "exact_sphere" or name.endswith("inverse_thickness"):
            continue
        if name == "hertz_stage_compliance":
            other = Estimate.symmetric(HERTZ_EXPONENT, 0.0)
        else:
            other = _exponent_by(fit)
        if other.known and math.isfinite(other.std):
            found.append(other)
            weights.append(weight)
    weights[0] -= sum(weights[1:])
    # The value stays the model's, and so does its own uncertainty.
    whole = average_models(found, weights, value=own.value)
    return replace(whole, interval=(min(whole.lower, own.lower), max(whole.upper, own.upper)))


def _exponent_by(rival: JointFit) -> Estimate:
    """Return m of the power law in place of the growing modulus in an explanation, with its stage."""
    held, stage = dict(rival.held), "stage_compliance"
    if stage in rival.values:
        # A power law leaves the stage open.
        held[stage] = rival.estimate(stage)
    law = _models(replace(rival, held=held), ("free_exponent",)).get("free_exponent")
    return (
        Estimate.unknown("a power law does not fit it")
        if law is None
        else bounded(law.estimate("load_exponent"))
    )


def area_exponent(compared: Comparison, models: Mapping[str, JointFit]) -> Estimate:
    """Return n by the best explanation, with the uncertainty of where the areas begin and of the force's law.

    A law that does not suit the force moves the force's zero, and with it n.
    """
    found = _averaged_exponent(compared)
    by_law = [(law.aicc, _exponent(law, law.areas(), zeroed=True)) for law in models.values()]
    own = by_law[0][1]
    if not (found.known and own.known):
        return found
    apart = [(aicc, each.value - own.value) for aicc, each in by_law if each.known]
    return found.with_error(_root_mean_square(apart, compared.unexplained))


def _averaged_exponent(compared: Comparison) -> Estimate:
    best, name = compared.best, "area_offset"
    found = _exponent(best, best.areas(), zeroed=True)
    if not found.known:
        return found
    if name in best.values:
        other, weight = _exponent(best, best.record.area, zeroed=False), 0.5
    elif name in compared.rivals:
        late = compared.rivals[name]
        other, weight = _exponent(late, late.areas(), zeroed=True), compared.weights[name]
    else:
        return found
    if not other.known:
        return found
    return average_models([found, other], [1 - weight, weight], value=found.value)


def _exponent(main: JointFit, areas: FloatArray, *, zeroed: bool) -> Estimate:
    """Fit A = a W^n to what was measured, with the noise of both and the uncertainty of their zeros."""
    record, noise = main.record, main.noise
    load = main.corrected_load(record.clock, record.load)[record.with_area]
    smooth = main.load(record.smooth_displacement)[record.with_area]
    used = smooth > max(
        0.05 * float(smooth.max(initial=0.0)), 5 * math.hypot(noise.force_std, noise.drift_std)
    )
    W, A = load[used], areas[used]
    if W.size < _FEWEST_AREAS:
        few = f"{W.size} areas under load" if record.area.size else NO_AREA
        return Estimate.unknown(f"{few}: give a column area_mm2 with {_FEWEST_AREAS} or more under load")
    spread = np.hypot(noise.area_std, 0.5 * A * math.hypot(noise.force_std, noise.drift_std) / smooth[used])

    def residuals(p: FloatArray) -> FloatArray:
        grown = np.maximum(W / W.max(), 1e-9) ** float(np.clip(p[1], 0.02, 5.0))
        return np.asarray((A - p[0] * grown) / spread)

    try:
        fit = fit_least_squares(residuals, [A.max(), 0.5], ["area", "area_exponent"])
    except FitError as error:
        return Estimate.unknown(str(error))
    by_area = -np.linalg.pinv(fit.jacobian)[1] / spread
    exponent = fit.value("area_exponent")
    std = _exponent_std(main, used, by_area, -exponent * A / smooth[used] * by_area, zeroed=zeroed)
    return Estimate.symmetric(exponent, std, fit.degrees_of_freedom)


def _exponent_std(
    main: JointFit, used: BoolArray, by_area: FloatArray, by_load: FloatArray, *, zeroed: bool
) -> float:
    """Return the standard uncertainty of a sum over the used areas and loads, with their fitted zeros."""
    record = main.record
    rows = np.flatnonzero(record.with_area)[used]
    force, area = np.zeros((record.load.size, 1)), np.zeros((record.area.size, 1))
    force[rows, 0], area[used, 0] = by_load, by_area
    zeros = {
        "force_zero": by_load.sum(),
        "force_tilt": by_load @ record.clock[rows],
        "area_offset": by_area.sum() if zeroed else 0.0,
    }
    gradient = np.array([zeros.get(name, 0.0) for name in main.fit.names])[:, None]
    of_force, of_area = (answer @ gradient for answer in main.estimator())
    # Noise of the displacement is in the residuals, to which the parameters answer, but not in the data.
    shared = main.noise.of_displacement(of_force, of_area)
    variance = main.noise.covariance_of_sums(force + of_force, area + of_area, shared)
    return math.sqrt(float(variance[0, 0]))


def contact_by(name: str, fit: JointFit) -> Estimate:
    """Return the place of contact (mm) by an estimator, with its error on records like the fit's.

    Its root mean square error, bias included, on twenty records that are simulated from the fit with its
    noise is the standard uncertainty. The value itself is not corrected.
    """
    estimator, rng, errors = ESTIMATORS[name], np.random.default_rng(0), []
    try:
        value = estimator(fit.record.displacement, fit.record.load)
    except FitError as error:
        raise FitError(f"no place of contact by {name}: {error}") from error
    for _ in range(_SIMULATED):
        try:
            errors.append(estimator(*fit.simulated(rng)) - fit.values["contact_offset"])
        except FitError:
            continue
    if len(errors) < _SIMULATED // 2:
        failed = f"{_SIMULATED - len(errors)} of {_SIMULATED} simulated records like this"
        raise FitError(f"no place of contact by {name}: it fails on {failed}")
    return Estimate.symmetric(value, float(np.sqrt(np.mean(np.square(errors)))))
