"""A contact law of a lab, or that of JKR, fitted to a record and compared with ours."""

import itertools
import math
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Final

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad._records import Recorded
from fingerpad._rounding import value_with_uncertainty
from fingerpad.estimate import Estimate
from fingerpad.exceptions import FitError, LoadingError
from fingerpad.loading.adhesion import NO_PULL_OFF, prepare_retraction, start_on_way_out
from fingerpad.loading.areas import NO_RADIUS
from fingerpad.loading.averaging import akaike_weights
from fingerpad.loading.curve import LoadingCurve
from fingerpad.loading.joint import FitData, JointFit, bounded, fit_joint, sum_of_squares
from fingerpad.loading.laws import LAWS, ContactLaw, FittedForceModel, Law, evaluate, start_of
from fingerpad.loading.noise import Noise
from fingerpad.loading.press import determined, fixed_quantities
from fingerpad.loading.rivals import FAILURES, MOSTLY, allow_for_bend, unexplained_share

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
# AICc by which an adhesive law must be ahead of ours on the way out: less is no pull-off.
_MUST_PULL: Final = 10.0
# Units of a law's parameters as they are printed and stored.
_SHOWN: Final = {"MPa": ("kPa", 1e3), "MPa/N": ("kPa/N", 1e3), "mJ/mm²": ("mJ/m²", 1e6)}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class LawFit(Recorded):
    """A contact law fitted to one press.

    Attributes
    ----------
    law : str
        Its name.
    parameters, derived : mapping of str to Estimate
        Its own parameters and what follows from them, in `units`; unknown with the reason.
    units : mapping of str to str
        Of both.
    loading_radius, contact_offset : Estimate
        R_g and the place of contact by this law, mm.
    phase : str
        ``loading``, or ``unloading`` for an adhesive law.
    displacement, load : ndarray
        Rows that it was fitted to: readings (mm), and forces without their zero and drift (N).
    models : mapping of str to FittedForceModel
        The law, and ours on the same rows under the same noise, whose `aicc` compares them.
    verdict : str
        Whether the law holds at these parameters, in its own words; empty where it does not say.
    notes : mapping of str to str
        What a flag means here.
    flags : tuple of str
        Doubts.

    Examples
    --------
    >>> from fingerpad.loading import fit_loading_curve
    >>> from fingerpad.simulate import simulate_loading_curve
    >>> curve = simulate_loading_curve(points=60, force_std=0.005, area_std=0.5, seed=1)
    >>> fit = fit_loading_curve(curve, law="free_exponent").law
    >>> print(f"m = {fit.parameters['load_exponent']}, preferred: {fit.preferred_model}")
    m = 2.639 ± 0.041, preferred: load_dependent
    """

    _title: ClassVar[str] = "Fit of a contact law"

    law: str
    parameters: Mapping[str, Estimate]
    derived: Mapping[str, Estimate]
    units: Mapping[str, str]
    loading_radius: Estimate
    contact_offset: Estimate
    phase: str
    displacement: FloatArray
    load: FloatArray
    models: Mapping[str, FittedForceModel]
    verdict: str
    notes: Mapping[str, str]
    flags: tuple[str, ...]

    @property
    def aicc(self) -> dict[str, float]:
        """Corrected Akaike criterion of each law."""
        return {name: model.aicc for name, model in self.models.items()}

    @property
    def weights(self) -> dict[str, float]:
        """Akaike weight of each law; their sum is 1."""
        if not self.models:
            return {}
        return dict(zip(self.models, akaike_weights(list(self.aicc.values())), strict=True))

    @property
    def preferred_model(self) -> str:
        """That of the least AICc; empty where nothing was fitted."""
        return min(self.aicc, key=self.aicc.__getitem__, default="")

    @property
    def conclusion(self) -> str:
        """Whether the law explains the curve better than ours, as text."""
        label, aicc = LAWS[self.law].label, self.aicc
        if self.law not in aicc:
            return f"{label} was not fitted: {next(iter(self.notes.values()))}"
        others = {name: value for name, value in aicc.items() if name != self.law}
        if not others:
            return f"{label} alone could be fitted"
        best = min(others, key=others.__getitem__)
        gain = others[best] - aicc[self.law]
        word = "better" if gain > 0 else "worse"
        weight = f"Akaike weight {self.weights[self.law]:.2g}"
        return (
            f"{label} explains the {self.phase} {word} than {LAWS[best].label}, the best of the others, by "
            f"{abs(gain):.3g} in AICc ({weight})"
        )

    def lines(self) -> Iterator[str]:
        """Return the parameters with units, uncertainty and interval, and how the law compares with ours.

        Yields
        ------
        str
            Line by line.
        """
        record = self.as_record()
        if self.law not in self.models:
            yield self.conclusion
            return
        yield f"law {LAWS[self.law].label}, fitted to the {self.phase}"
        shown = [*record["parameters"], record["loading_radius"], record["contact_offset"]]
        width = max(len(each["name"]) for each in shown)
        for each in shown:
            if each["value"] is None:
                yield f"  {each['name']:<{width}}  unknown: {each['reason']}"
            else:
                low, high = each["ci95"]
                unit = "" if each["unit"] == "1" else each["unit"]
                value = f"{value_with_uncertainty(each['value'], each['std'])} {unit}"
                yield f"  {each['name']:<{width}}  {value:<24}  95 %: {low:.4g} to {high:.4g}"
        yield self.conclusion
        if self.verdict:
            yield self.verdict

    def as_record(self) -> dict[str, Any]:
        """Return the numbers by name, each with its unit.

        Returns
        -------
        dict
            Moduli in kPa, works of adhesion in mJ/m²; None where unknown.
        """
        return {
            "law": self.law,
            "parameters": [
                _shown(name, found, self.units[name])
                for name, found in {**self.parameters, **self.derived}.items()
            ],
            "loading_radius": _shown("loading_radius", self.loading_radius, "mm"),
            "contact_offset": _shown("contact_offset", self.contact_offset, "mm"),
            "phase": self.phase,
            "aicc": self.aicc,
            "weights": self.weights,
            "preferred_model": self.preferred_model,
            "conclusion": self.conclusion,
            "verdict": self.verdict,
            "notes": dict(self.notes),
            "flags": list(self.flags),
        }


def _shown(name: str, found: Estimate, unit: str) -> dict[str, Any]:
    unit, factor = _SHOWN.get(unit, (unit, 1.0))
    if not found.known:
        return {"name": name, "unit": unit, "value": None, "std": None, "ci95": None, "reason": found.reason}
    found = found.times(factor)
    return {"name": name, "unit": unit, "value": found.value, "std": found.std, "ci95": list(found.interval)}


def fit_law(main: JointFit, others: Mapping[str, JointFit], law: ContactLaw, *, known: bool) -> LawFit:
    """Fit a law to the rows of a fit of ours, and compare it with ours under one noise.

    That is the noise which our model leaves, or that which the law leaves, where it is far less: what a wrong
    law leaves looks like a drift of the force.
    """
    load = float(main.load(main.record.smooth_displacement).max())
    start = {name: value for name, value in main.values.items() if name not in {*_OF_OUR_LAWS, "force_bend"}}
    start |= start_of(law, main.values, load)
    try:
        with determined(f"the contact law {law.name}"):
            held = {name: given for name, given in main.held.items() if name != "force_bend"}
            fit = allow_for_bend(_search(main.record, law, start, held, None))
            if _strength(fit.noise) < _FAR_LESS * _strength(main.noise):
                others = dict(_under(fit.noise, others))
            else:
                near = {name: fit.values[name] for name in fit.fit.names}
                at_bound = {name: one for name, one in fit.held.items() if name in law.parameters}
                fit = allow_for_bend(fit_joint(main.record, law.name, near, {**held, **at_bound}, main.noise))
            models = {law.name: fit, **others}
            compared = {name: each.fitted_law() for name, each in models.items()}
            return _result(fit, law, compared, "loading", known=known)
    except FAILURES as fault:
        compared = {name: each.fitted_law() for name, each in others.items()}
        return _failed(law, compared, "loading", str(fault), "law_not_fitted")


def _strength(noise: Noise) -> float:
    """Return the variance of the force's noise, drift included."""
    return noise.force_std**2 + noise.slow_variance


def _under(noise: Noise, fits: Mapping[str, JointFit]) -> Iterator[tuple[str, JointFit]]:
    """Fit again under another noise what can be."""
    for name, fit in fits.items():
        with suppress(*FAILURES):
            yield name, fit_joint(fit.record, fit.law, fit.values, fit.held, noise)


def fit_adhesive_law(
    curve: LoadingCurve,
    law: ContactLaw,
    held: Mapping[str, Estimate],
    *,
    poisson_ratio: float,
    loading_radius: float | Estimate | None,
    cycle: int,
) -> LawFit:
    """Fit an adhesive law to the way out of a press, and compare it there with Hertz and the growing modulus.

    Where the record has no pull-off, nothing is fitted, and the reason is given.
    """
    if "inverse_thickness" in held:
        raise LoadingError(f"{law.name} is a law of a half-space: leave the thickness out, or the law")
    try:
        way_out = prepare_retraction(curve, poisson_ratio, cycle)
    except FitError as fault:
        return _failed(law, {}, "unloading", str(fault), "no_pull_off")
    record = way_out.record
    held = {**fixed_quantities(way_out, loading_radius), **held}
    known = record.area.size > 0 or loading_radius is not None
    try:
        with determined(f"the contact law {law.name}"):
            start = start_on_way_out(record, held)
            shared = {name: value for name, value in start.items() if name not in _OF_OUR_LAWS}
            fit = allow_for_bend(_search(record, law, {**shared, **start_of(law, start, 0.0)}, held, None))
            models = {law.name: fit.fitted_law()}
            for other in ("hertz", "load_dependent"):
                begin = {**start, **start_of(LAWS[other], {"load_coefficient": 0.0, **start}, 0.0)}
                begin = {
                    key: one for key, one in begin.items() if key in shared or key in LAWS[other].parameters
                }
                with suppress(*FAILURES):
                    models[other] = fit_joint(record, other, begin, fit.held, fit.noise).fitted_law()
            others = [one.aicc for name, one in models.items() if name != law.name]
            if others and min(others) < fit.aicc + _MUST_PULL:
                return _failed(law, models, "unloading", NO_PULL_OFF, "no_pull_off")
            found = _result(fit, law, models, "unloading", known=known)
    except FAILURES as fault:
        return _failed(law, {}, "unloading", str(fault), "law_not_fitted")
    return replace(found, flags=(*way_out.flags, *found.flags))


def _search(
    record: FitData,
    law: ContactLaw,
    start: Mapping[str, float],
    held: Mapping[str, Estimate],
    noise: Noise | None,
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
            return fit_joint(record, law.name, begins[place], held, noise)
        except FAILURES as fault:
            faults.append(fault)
    for name, ends in law.parameters.items():
        for end in filter(math.isfinite, ends):
            # At its bound a parameter moves nothing, and the data would not determine it.
            stuck = {**held, name: Estimate.symmetric(end, 0.0)}
            begin = begins[int(np.argmin(costs))]
            with suppress(*FAILURES):
                found.append(fit_joint(record, law.name, {**begin, name: end}, stuck, noise))
    if not found:
        raise faults[0]
    # Each has its own noise: their AICc cannot be compared.
    return min(found, key=lambda fit: sum_of_squares(record, law.name, fit.values))


def _result(
    fit: JointFit, law: ContactLaw, models: Mapping[str, FittedForceModel], phase: str, *, known: bool
) -> LawFit:
    names = list(law.parameters)
    notes: dict[str, str] = {}
    parameters = {name: _inside(fit.estimate(name), law.parameters[name]) for name in names}
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
        holds, said = evaluate(law, law.verdict, fit.values, **_given(fit))
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
        models=dict(models),
        verdict=said,
        notes=notes,
        flags=tuple(notes),
    )


def _given(fit: JointFit) -> dict[str, float]:
    return {"loading_radius": fit.values["loading_radius"], "poisson_ratio": fit.record.poisson_ratio}


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
    values, nu = fit.values, fit.record.poisson_ratio

    def at(changed: Mapping[str, float]) -> float:
        return float(
            evaluate(law, function, changed, loading_radius=changed["loading_radius"], poisson_ratio=nu)
        )

    gradient = {}
    for name in (*law.parameters, "loading_radius"):
        step = 1e-5 * (abs(values[name]) or 1.0)
        up, down = (at({**values, name: values[name] + way * step}) for way in (1, -1))
        gradient[name] = (up - down) / (2 * step)
    return fit.combined(at(values), gradient)


def _failed(
    law: ContactLaw, models: Mapping[str, FittedForceModel], phase: str, reason: str, flag: str
) -> LawFit:
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
        models=dict(models),
        verdict="",
        notes={flag: reason},
        flags=(flag,),
    )
