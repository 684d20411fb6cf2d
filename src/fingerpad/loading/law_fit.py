"""The fit of a contact law that is asked for: of a lab's on the way in, of an adhesive one on the way out."""

import itertools
import math
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from typing import Final, TypeAlias

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, FloatArray
from fingerpad.estimate import Estimate
from fingerpad.exceptions import FitError, LoadingError
from fingerpad.loading.curve import LoadingCurve, choose_cycle, moving_average, saturated_rows
from fingerpad.loading.joint import (
    NO_RADIUS,
    FitData,
    JointFit,
    Press,
    bounded,
    determined,
    fit_joint,
    fixed_quantities,
    known_quantities,
    sum_of_squares,
)
from fingerpad.loading.law_registry import LAWS, ContactLaw, Law, Values, evaluate, find_law, start_of
from fingerpad.loading.laws import MAIN
from fingerpad.loading.least_squares import differences
from fingerpad.loading.noise import Noise
from fingerpad.loading.result import LawFit
from fingerpad.loading.rivals import DECISIVE, FAILURES, MOSTLY, allow_for_bend, unexplained_share

IntArray: TypeAlias = npt.NDArray[np.intp]

# Parameters of laws, which are no start of another one.
_OF_OUR_LAWS: Final = (
    "youngs_modulus",
    "initial_modulus",
    "load_coefficient",
    "load_exponent",
    "work_of_adhesion",
)
# How near to its bound a parameter has to be, in standard uncertainties, to be no result.
_AT_BOUND: Final = 0.05
_AT_ITS_BOUND: Final = "the fit lies at its bound"
# Factors on a start, or shares of the way between two bounds, from which a search may begin; how many of
# these are compared, and how many tried.
_FACTORS, _SHARES, _TRIALS, _SEARCHES = (1.0, 0.3, 3.0), (0.2, 0.5, 0.8), 256, 3
# A law that leaves less than this share of the noise that ours leave has found what they call noise.
_FAR_LESS: Final = 0.7
# A pull-off is that many deviations of the noise deep, and ends where less than this share of it is left.
_DEVIATIONS, _TORN = 6.0, 0.35
_WINDOWS: Final = (1, 5, 15)
_FEWEST_FREE, _FEWEST_ATTACHED = 4, 8
NO_PULL_OFF: Final = (
    "no pull-off in the record: on the way out the force does not fall below its zero by more than its noise "
    "and come back to it; record the way out until the contact is lost, and some rows more"
)


def fit_law(main: JointFit, others: Mapping[str, JointFit], law: ContactLaw, *, known: bool) -> LawFit:
    """Fit a law to the rows of a fit of ours, and compare it with ours under one noise.

    That is the noise which our model leaves, or that which the law leaves, where it is far less: what a wrong
    law leaves looks like a drift of the force.
    """
    shared = {name: value for name, value in main.values.items() if name not in {*_OF_OUR_LAWS, "force_bend"}}
    start = shared | start_of(law, main.values, main.top_load)
    held = {name: given for name, given in main.held.items() if name != "force_bend"}
    try:
        with determined(f"the contact law {law.name}"):
            fit = allow_for_bend(_search(main.record, law, start, held))
            if _strength(fit.noise) < _FAR_LESS * _strength(main.noise):
                begins = {name: one.values for name, one in others.items()}
                others = dict(fits_under(fit.noise, main.record, begins, main.held))
            else:
                near = {name: fit.values[name] for name in fit.fit.names}
                at_bound = {name: one for name, one in fit.held.items() if name in law.parameters}
                fit = allow_for_bend(fit_joint(main.record, law.name, near, {**held, **at_bound}, main.noise))
            return _found(fit, law, {law.name: fit, **others}, "loading", known=known)
    except FAILURES as fault:
        return _not_found(law, others, "loading", str(fault), "law_not_fitted")


def _strength(noise: Noise) -> float:
    """Return the variance of the force's noise, drift included."""
    return noise.force_std**2 + noise.slow_variance


def fits_under(
    noise: Noise, record: FitData, begins: Mapping[str, Values], held: Mapping[str, Estimate]
) -> Iterator[tuple[str, JointFit]]:
    """Yield those laws that can be fitted under one noise, each from where it begins."""
    for law, begin in begins.items():
        with suppress(*FAILURES):
            yield law, fit_joint(record, law, begin, held, noise)


def fit_adhesion(
    curve: LoadingCurve,
    *,
    law: str | ContactLaw = "jkr",
    poisson_ratio: float = 0.5,
    loading_radius: float | Estimate | None = None,
    cycle: int = 0,
    stage_compliance: float | Estimate | None = None,
    area_delay: float | Estimate | None = None,
    area_relative_std: float = 0.0,
) -> LawFit:
    """Fit an adhesive law to the way out of a press, and compare it there with Hertz and the growing modulus.

    The way in needs not be one that `fit_loading_curve` can fit. Where the record has no pull-off, nothing is
    fitted, and the reason is given.

    Parameters
    ----------
    curve : LoadingCurve
        The record, with the way out until the contact is lost.
    law : str or ContactLaw
        One with a `pull_off`.
    poisson_ratio, loading_radius, cycle, stage_compliance, area_delay, area_relative_std
        As for `fit_loading_curve`.

    Returns
    -------
    LawFit
        Its parameters, as the work of adhesion, with uncertainty.

    Raises
    ------
    LoadingError
        If the curve or an argument cannot be used, or the law is not adhesive.

    Examples
    --------
    >>> from fingerpad.simulate import simulate_loading_curve
    >>> curve = simulate_loading_curve(points=200, unloading=True, force_std=0.005, area_std=0.5, seed=1)
    >>> fit_adhesion(curve).flags
    ('no_pull_off',)
    """
    law = find_law(law)
    if law.pull_off is None:
        raise LoadingError(f"{law.name} is not adhesive: `fit_loading_curve` fits it to the way in")
    given = known_quantities(
        curve, stage_compliance=stage_compliance, area_delay=area_delay, area_relative_std=area_relative_std
    )
    try:
        way_out = prepare_retraction(curve, poisson_ratio, cycle)
    except FitError as fault:
        return _not_found(law, {}, "unloading", str(fault), "no_pull_off")
    record = way_out.record
    held = {**fixed_quantities(way_out, loading_radius), **given}
    known = record.area.size > 0 or loading_radius is not None
    try:
        with determined(f"the contact law {law.name}"):
            start = start_on_way_out(record, held)
            shared = {name: value for name, value in start.items() if name not in _OF_OUR_LAWS}
            fit = allow_for_bend(_search(record, law, shared | start_of(law, start, 0.0), held))
            begins = {
                name: shared | start_of(LAWS[name], {"load_coefficient": 0.0, **start}, 0.0)
                for name in ("hertz", MAIN)
            }
            others = dict(fits_under(fit.noise, record, begins, fit.held))
            models = {law.name: fit, **others}
            if others and min(one.aicc for one in others.values()) < fit.aicc + DECISIVE:
                return _not_found(law, models, "unloading", NO_PULL_OFF, "no_pull_off")
            found = _found(fit, law, models, "unloading", known=known)
    except FAILURES as fault:
        return _not_found(law, {}, "unloading", str(fault), "law_not_fitted")
    return replace(found, flags=(*way_out.flags, *found.flags))


def _search(
    record: FitData,
    law: ContactLaw,
    start: Mapping[str, float],
    held: Mapping[str, Estimate],
) -> JointFit:
    """Fit a law from the likeliest of some starts that leads to a minimum."""
    choices = []
    for name, (low, high) in law.parameters.items():
        if math.isfinite(low) and math.isfinite(high):
            choices.append([start[name], *(low + share * (high - low) for share in _SHARES)])
        else:
            choices.append([factor * start[name] for factor in _FACTORS])
    begins = [
        {**start, **dict(zip(law.parameters, each, strict=True))} for each in itertools.product(*choices)
    ]
    begins = begins[:_TRIALS]
    given = {name: one.value for name, one in held.items()}
    costs = [sum_of_squares(record, law.name, {**begin, **given}) for begin in begins]
    faults, found = [], []
    for place in np.argsort(costs, kind="stable")[:_SEARCHES]:
        try:
            return fit_joint(record, law.name, begins[place], held)
        except FAILURES as fault:
            faults.append(fault)
    for name, ends in law.parameters.items():
        for end in filter(math.isfinite, ends):
            # At its bound a parameter moves nothing, and the data would not determine it.
            stuck = {**held, name: Estimate.symmetric(end, 0.0)}
            begin = begins[int(np.argmin(costs))]
            with suppress(*FAILURES):
                found.append(fit_joint(record, law.name, {**begin, name: end}, stuck))
    if not found:
        raise faults[0]
    # Each has its own noise: their AICc cannot be compared.
    return min(found, key=lambda fit: sum_of_squares(record, law.name, fit.values))


def _found(
    fit: JointFit, law: ContactLaw, models: Mapping[str, JointFit], phase: str, *, known: bool
) -> LawFit:
    """Return what a law that was fitted says, beside others on the same rows."""
    notes: dict[str, str] = {}
    parameters = {name: _inside(fit.estimate(name), ends) for name, ends in law.parameters.items()}
    radius = fit.estimate("loading_radius")
    derived = {name: _derived(fit, function, law) for name, function in law.derived.items()}
    if not known:
        radius = Estimate.unknown(NO_RADIUS)
        parameters, derived = dict.fromkeys(parameters, radius), dict.fromkeys(derived, radius)
    at_bound = [name for name, one in parameters.items() if one.reason.startswith(_AT_ITS_BOUND)]
    if at_bound:
        notes["law_at_bound"] = f"{', '.join(at_bound)}: {parameters[at_bound[0]].reason}"
    if unexplained_share(fit) > MOSTLY:
        notes["law_misfit"] = (
            f"the force departs from {law.label} by more than its noise without contact: its parameters are "
            "less certain than stated"
        )
    said = ""
    if law.verdict is not None and known and not at_bound:
        radius_and_ratio = {
            "loading_radius": fit.values["loading_radius"],
            "poisson_ratio": fit.record.poisson_ratio,
        }
        holds, said = evaluate(law, law.verdict, fit.values, **radius_and_ratio)
        if not holds:
            notes["law_out_of_range"] = said
    return LawFit(
        law=law.name,
        parameters=parameters,
        derived=derived,
        units=law.units,
        loading_radius=radius,
        contact_offset=fit.estimate("contact_offset"),
        phase=phase,
        displacement=fit.record.displacement,
        load=fit.corrected_load(fit.record.clock, fit.record.load),
        models={name: one.fitted_law() for name, one in models.items()},
        verdict=said,
        notes=notes,
        flags=tuple(notes),
    )


def _not_found(law: ContactLaw, models: Mapping[str, JointFit], phase: str, reason: str, flag: str) -> LawFit:
    """Return that nothing is known of a law, and why."""
    unknown = Estimate.unknown(reason)
    return LawFit(
        law=law.name,
        parameters=dict.fromkeys(law.parameters, unknown),
        derived=dict.fromkeys(law.derived, unknown),
        units=law.units,
        loading_radius=unknown,
        contact_offset=unknown,
        phase=phase,
        displacement=np.zeros(0),
        load=np.zeros(0),
        models={name: one.fitted_law() for name, one in models.items()},
        verdict="",
        notes={flag: reason},
        flags=(flag,),
    )


def _inside(found: Estimate, ends: tuple[float, float]) -> Estimate:
    """Return a parameter with its interval cut off at its bounds; unknown at one of them."""
    for end in filter(math.isfinite, ends):
        if abs(found.value - end) <= max(_AT_BOUND * found.std, 1e-4 * abs(end)):
            return Estimate.unknown(
                f"{_AT_ITS_BOUND} {end:g}: the curve does not determine it, or the law does not suit it"
            )
    low, high = (min(max(one, ends[0]), ends[1]) for one in found.interval)
    return bounded(replace(found, interval=(low, high)))


def _derived(fit: JointFit, function: Law, law: ContactLaw) -> Estimate:
    """Return a function of the parameters and the radius, to first order."""

    def at(values: Values) -> float:
        given = {"loading_radius": values["loading_radius"], "poisson_ratio": fit.record.poisson_ratio}
        return float(evaluate(law, function, values, **given))

    names = (*law.parameters, "loading_radius")
    slopes = differences(at, fit.values, names).tolist()
    return fit.combined(at(fit.values), dict(zip(names, slopes, strict=True)))


# --- the way out of a record, up to the pull-off ---


def prepare_retraction(curve: LoadingCurve, poisson_ratio: float, cycle: int) -> Press:
    """Choose the rows on the way out, up to the pull-off, and those without contact before and after it."""
    cycles, chosen = choose_cycle(curve, cycle)
    if chosen.unloading is None:
        raise FitError("the record has no way out, and adhesion is seen where the contact tears off")
    out = np.arange(chosen.unloading.start, chosen.unloading.stop)
    displacement = moving_average(curve.indentation[out])
    # Before contact no row is in touch that lies farther out than where the contact tore off.
    begin = chosen.baseline.start if chosen.baseline else chosen.loading.start
    before = np.arange(begin, chosen.loading.start)
    smooth_before = moving_average(curve.indentation[before]) if before.size else np.zeros(0)
    drift = _drift(curve.clock, curve.load, before, out)
    last, unsure = _last_attached(curve.load[out] - drift * curve.clock[out])
    free = smooth_before < displacement[last]
    # Of the two rows about the jump one may be half of it.
    kept = np.append(np.arange(last - unsure), np.arange(last + unsure + 2, out.size))
    full = saturated_rows(curve, chosen.unloading)
    kept = kept[~full[kept]]
    rows = np.concatenate([before[free], out[kept]])
    attached = np.concatenate([np.zeros(int(free.sum()), dtype=bool), kept < last])
    if np.count_nonzero(attached) < _FEWEST_ATTACHED:
        raise FitError(
            f"{np.count_nonzero(attached)} rows on the way out to the pull-off; {_FEWEST_ATTACHED} needed"
        )
    with_area: BoolArray = attached & (curve.area is not None)
    if curve.area is not None:
        with_area = attached & (curve.area[rows] > 0)
    record = FitData(
        clock=curve.clock[rows] - curve.clock[rows[0]],
        load=curve.load[rows],
        displacement=curve.indentation[rows],
        smooth_displacement=np.concatenate([smooth_before[free], displacement[kept]]),
        area=np.zeros(0) if curve.area is None else curve.area[rows][with_area],
        with_area=with_area,
        poisson_ratio=poisson_ratio,
        attached=attached,
    )
    return Press(
        record=record,
        cycles=cycles,
        baseline_rows=int(np.count_nonzero(~attached)),
        flags=(*(("saturated_force",) if full.any() else ()), *curve.doubts),
    )


def start_on_way_out(record: FitData, held: Mapping[str, Estimate]) -> dict[str, float]:
    """Return where a search of an adhesive law may begin, from the pull-off and where the force passes zero.

    With JKR the pull-off lies at −3 a_f²/R, and the zero of the force (t³ = 6) at 3.634 a_f²/R.
    """
    assert record.attached is not None  # of a way out
    x, load = record.smooth_displacement[record.attached], record.load[record.attached]
    zero = float(record.load[~record.attached].mean())
    pull = max(zero - float(load.min()), 1e-6 * float(np.ptp(load)))
    lost = float(x.min())
    pulled = x[load < zero]
    apart = max(float(pulled.max(initial=lost)) - lost, 0.02 * (float(x.max()) - lost))
    place = lost + 3 / 6.634 * apart
    depth = max(float(x.max()) - place, 1e-9)
    if "loading_radius" in held:
        radius = held["loading_radius"].value
    else:
        radius = float(record.area.max()) / (np.pi * (depth + 2 * apart))
    work = pull / (1.5 * np.pi * radius)
    modulus = np.pi * work * radius**2 / (8 * (apart * radius / 6.634) ** 1.5) * (1 - record.poisson_ratio**2)
    start = {
        "contact_offset": place,
        "loading_radius": radius,
        "youngs_modulus": float(modulus),
        "work_of_adhesion": work,
        "force_zero": zero,
        "force_tilt": 0.0,
    }
    return {name: value for name, value in start.items() if name not in held}


def _drift(clock: FloatArray, load: FloatArray, before: IntArray, out: IntArray) -> float:
    """Return the drift of the force from before contact to the end of the way out; 0 where it is unknown."""
    end = out[-max(out.size // 10, _FEWEST_FREE) :]
    if before.size < _FEWEST_FREE:
        return 0.0
    return float(np.mean(load[end]) - np.mean(load[before])) / float(
        np.mean(clock[end]) - np.mean(clock[before])
    )


def _last_attached(load: FloatArray) -> tuple[int, int]:
    """Return the last row on the way out that the force still pulls in, and how many rows it may be off.

    A pull that is weak beside the noise is looked for in means of a few rows.
    """
    for window in _WINDOWS:
        mean = np.convolve(load, np.full(window, 1 / window), mode="valid")
        lowest = int(np.argmin(mean)) + window // 2
        zero = float(np.median(load[lowest + (load.size - lowest) // 2 :]))
        depth = zero - float(mean.min())
        # The likeliest row at which a pull of two thirds of its depth gives way to none.
        last = lowest + int(np.argmax(np.cumsum(zero - _TORN * depth - load[lowest:])))
        after = mean[last + window :]
        enough = load.size - last >= _FEWEST_FREE + 2 and after.size >= _FEWEST_FREE
        if enough and depth > _DEVIATIONS * float(np.std(after, ddof=1)):
            return last, window // 2
    raise FitError(NO_PULL_OFF)
