"""The result of fitting one press: its quantities, the load it predicts, and all of it as text."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Final, Self

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array
from fingerpad._display import Displayed, Recorded
from fingerpad._rounding import value_with_uncertainty
from fingerpad.estimate import Estimate, estimates_record
from fingerpad.exceptions import LoadingError
from fingerpad.flags import flags_in
from fingerpad.loading.curve import Cycle, Hysteresis
from fingerpad.loading.joint import FitData
from fingerpad.loading.law_registry import LAWS
from fingerpad.loading.laws import MAIN, FittedForceModel, secant_modulus
from fingerpad.loading.least_squares import differences
from fingerpad.loading.rivals import EXPLANATIONS, NORMAL, akaike_weights, mixture_point
from fingerpad.units import KPA_PER_MPA

MODULI: Final = ("reduced_modulus", "youngs_modulus", "initial_modulus", "load_coefficient")
# Nearer to contact than this share of the depth a row's secant modulus says nothing.
_FOOT: Final = 0.05
# Units of a law's parameters as they are printed and stored.
_SHOWN: Final = {"MPa": ("kPa", 1e3), "MPa/N": ("kPa/N", 1e3), "mJ/mm²": ("mJ/m²", 1e6)}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Secant(Displayed):
    """The secant modulus E_g (MPa) of rows in contact, with their W (N) and ξ (mm)."""

    load: FloatArray
    indentation: FloatArray
    modulus: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class LawUncertainty(Displayed):
    """How well the parameters of a fitted law are known on which its load depends."""

    names: tuple[str, ...]
    covariance: FloatArray  # with drifting noise, the uncertainty of the noise, and what was given
    coverage_factor: float  # half of a 95 % interval over the std, of the load at the largest indentation
    weight: float  # of Akaike


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
        """Yield the parameters with units, uncertainty and interval, and how the law compares with ours."""
        if self.law not in self.models:
            yield self.conclusion
            return
        yield f"law {LAWS[self.law].label}, fitted to the {self.phase}"
        yield from _quantity_lines(self._quantities())
        yield self.conclusion
        if self.verdict:
            yield self.verdict

    def summary(self) -> str:
        """Return the `lines`, and the flags in words."""
        return "\n".join([*self.lines(), "", *_flag_lines(self.flags, self.notes)])

    def _quantities(self) -> dict[str, tuple[Estimate, str]]:
        """Return all of them with the units that they are printed and stored in."""
        found = {}
        for name, one in {**self.parameters, **self.derived}.items():
            unit, factor = _SHOWN.get(self.units[name], (self.units[name], 1.0))
            found[name] = (one.times(factor), unit)
        return {
            **found,
            "loading_radius": (self.loading_radius, "mm"),
            "contact_offset": (self.contact_offset, "mm"),
        }

    def as_record(self) -> dict[str, Any]:
        """Return the numbers by name, each with its unit: moduli in kPa, works of adhesion in mJ/m²."""
        shown = {name: _shown(name, *one) for name, one in self._quantities().items()}
        radius, place = shown.pop("loading_radius"), shown.pop("contact_offset")
        return {
            "law": self.law,
            "parameters": list(shown.values()),
            "loading_radius": radius,
            "contact_offset": place,
            "phase": self.phase,
            "aicc": self.aicc,
            "weights": self.weights,
            "preferred_model": self.preferred_model,
            "conclusion": self.conclusion,
            "verdict": self.verdict,
            "notes": dict(self.notes),
            "flags": list(self.flags),
        }


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
        m of W ∝ ξ^m; 3/2 for Hertz. With a thickness, of W over the layer's factor; n is the record's.
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
    alternatives : mapping of str to FittedForceModel
        Other explanations of the curve under the same noise, by key of `EXPLANATIONS`: an offset or another
        growth of the areas, a stage that yields, a layer on bone, both also with one modulus, an exact
        sphere.
    model_aicc : float
        Criterion that the alternatives are compared with: that of `main`, or of one modulus where it is less.
    uncertainty : mapping of str to LawUncertainty
        Of `main` and of each alternative; the weights have the sum 1.
    unexplained : float
        Share of the force's residuals under load that noise does not explain.
    misfit_std : mapping of str to float
        What better explanations add to the standard uncertainty of a quantity; 0 where there are none.
    shape_factor : float
        F1 F2 of the contact ellipse, which is in all moduli; 1 where the pad's shape was not given.
    rows : FitData
        What was fitted.
    notes : mapping of str to str
        What a flag means for this curve.
    flags : tuple of str
        Doubts.
    law : LawFit or None
        The contact law that was asked for; its parameters by name.
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
    alternatives: Mapping[str, FittedForceModel]
    model_aicc: float = field(repr=False)
    uncertainty: Mapping[str, LawUncertainty]
    unexplained: float
    misfit_std: Mapping[str, float]
    shape_factor: float = field(repr=False)
    rows: FitData
    notes: Mapping[str, str]
    flags: tuple[str, ...]
    law: LawFit | None = None

    @property
    def main(self) -> FittedForceModel:
        """The law whose quantities these are, that of a growing modulus."""
        return self.models[MAIN]

    @property
    def load(self) -> FloatArray:
        """Force of each row from its fitted zero, N."""
        return self.main.corrected_load(self.rows.clock, self.rows.load)

    @property
    def indentation(self) -> FloatArray:
        """ξ of each row, mm, less what the stage yields; negative before the fitted place of contact."""
        return self.main.indentation(self.rows.displacement)

    @property
    def preferred_model(self) -> str:
        """The law of the force of the least AICc."""
        return min(self.models, key=lambda name: self.models[name].aicc)

    @property
    def secant(self) -> Secant:
        """E_g of each row that is well in contact, against ξ and W."""
        main = self.main
        depth = self.indentation
        used = depth > _FOOT * depth.max()
        load, depth = self.load[used], depth[used]
        radius = main.values["loading_radius"]
        modulus = secant_modulus(load, depth, loading_radius=radius, poisson_ratio=main.poisson_ratio)
        return Secant(load=load, indentation=depth, modulus=self.shape_factor * modulus)

    def predict(self, indentation: ArrayLike) -> Estimate:
        """Return the load W (N) at indentations ξ (mm), with its uncertainty and 95 % interval.

        The value is that of the law with a growing modulus, on which all quantities here rest; NaN where it
        has no finite load. Its uncertainty is that of the law's parameters, and of what else could have made
        the curve: the `alternatives` by their Akaike weights, and the laws of the force, which depart from
        each other. Indentation counts from first contact, wherever that was; before it, the load is
        zero. Neither the scale of the force nor the noise of a single reading is in the uncertainty.
        """
        shape = np.shape(indentation)
        xi = np.maximum(as_float_array(indentation, "indentation", LoadingError).ravel(), 0.0)
        laws = [self.main, *(self.alternatives[name] for name in self.uncertainty if name != MAIN)]
        weights = np.array([of.weight for of in self.uncertainty.values()])
        load, std, half = np.array(
            [_load_with_std(law, of, xi) for law, of in zip(laws, self.uncertainty.values(), strict=True)]
        ).swapaxes(0, 1)
        spread = self._spread(xi, load[0])
        std[0], half[0] = np.hypot(std[0], spread), np.hypot(half[0], NORMAL * spread)
        # About the value of the model, which stays, as the uncertainty of all quantities.
        whole = np.sqrt(weights @ (std**2 + (load - load[0]) ** 2))
        two = (half / NORMAL, half / NORMAL)
        lower, upper = (mixture_point(share, weights, load, *two) for share in (0.025, 0.975))
        interval = np.minimum(lower, load[0] - half[0]), np.maximum(upper, load[0] + half[0])
        ends = tuple(end.reshape(shape)[()] for end in interval)
        return Estimate(value=load[0].reshape(shape)[()], std=whole.reshape(shape)[()], interval=ends)

    def _spread(self, xi: FloatArray, load: FloatArray) -> FloatArray:
        """Return the root mean square difference of the laws of the force from the model."""
        laws = self.models.values()
        weights = akaike_weights([(1 - self.unexplained) * law.aicc for law in laws])
        apart = np.array([law.load_at(xi) - load for law in laws])
        return np.asarray(np.sqrt(np.array(weights) @ apart**2))

    def divide_by_constraint(self, coefficient: Estimate) -> Self:
        """Return the fit with all moduli divided by a constraint coefficient, flagged ``constraint_assumed``.

        Bone and nail make a thin pad stiffer than a half-space of the same tissue by this factor, which is
        poorly known for fingers. The load that is predicted stays.
        """
        if not (coefficient.value > 0 and math.isfinite(coefficient.value) and coefficient.std >= 0):
            raise LoadingError(
                f"the constraint coefficient must be positive, found {coefficient.value} ± {coefficient.std}"
            )
        divided: dict[str, Any] = {name: getattr(self, name).over(coefficient) for name in MODULI}
        misfit = {
            name: std / (coefficient.value if name in MODULI else 1.0)
            for name, std in self.misfit_std.items()
        }
        return replace(self, **divided, misfit_std=misfit, flags=(*self.flags, "constraint_assumed"))

    def as_record(self) -> dict[str, Any]:
        """Return the numbers by names that end in units, with ``_std`` and ``_ci95``; None if unknown."""
        quantities = {key: found for key, _, found, _ in self._quantities()}
        return {
            **estimates_record(quantities),
            "modulus_load_N": self.modulus_load,
            "region_N": list(self.fit_load_range),
            "preferred_model": self.preferred_model,
            "aicc": {name: model.aicc for name, model in self.models.items()},
            "aicc_alternatives": {name: model.aicc for name, model in self.alternatives.items()},
            "weights": {name: of.weight for name, of in self.uncertainty.items()},
            "notes": dict(self.notes),
            "segments": [cycle.as_record() for cycle in self.cycles],
            "hysteresis_mJ": [loss.energy if loss else None for loss in self.hysteresis],
            "hysteresis_fraction": [loss.fraction if loss else None for loss in self.hysteresis],
            "flags": list(self.flags),
            **({} if self.law is None else {"law": self.law.as_record()}),
        }

    def _quantities(self) -> Iterator[tuple[str, str, Estimate, str]]:
        """Return key, words, estimate and unit of each quantity, moduli in kPa."""
        at = f" at {self.modulus_load:.3g} N"
        layer = " × layer's factor" if self.main.values.get("inverse_thickness") else ""
        for name, unit, words in (
            ("loading_radius", "mm", "loading radius R_g"),
            ("reduced_modulus", "kPa", f"reduced modulus E*{at}"),
            ("youngs_modulus", "kPa", f"Young's modulus E{at}"),
            ("initial_modulus", "kPa", "initial modulus E_0g"),
            ("load_coefficient", "kPa/N", "its growth with load β"),
            ("contact_offset", "mm", "place of contact x₀"),
            ("load_exponent", "", f"exponent of load m, W ∝ ξ^m{layer}"),
            ("area_exponent", "", "exponent of area n, A ∝ W^n"),
        ):
            found = getattr(self, name)
            ending = unit.replace("kPa", "kpa").replace("/", "_per_")
            key = f"{name}_{ending}" if unit else name
            yield key, words, found.times(KPA_PER_MPA) if name in MODULI else found, unit

    def summary(self) -> str:
        """Return the fit as text: law, quantities, other laws and explanations, and flags in words."""
        return "\n".join(self._lines())

    def _answer(self) -> str:
        """Return the answer in one line: Young's modulus with its load, and whether it is in doubt."""
        found = self.youngs_modulus.times(KPA_PER_MPA)
        if not found.known:
            return "E is not known; why stands below"
        value = value_with_uncertainty(found.value, found.std)
        doubt = f", doubtful: {', '.join(self.flags)}" if self.flags else ""
        inverse = self.main.values.get("inverse_thickness", 0.0)
        of = f"on a layer of {1 / inverse:.3g} mm" if inverse else "of a half-space"
        return f"E = {value} kPa at {self.modulus_load:.3g} N, {of}{doubt}"

    def _lines(self) -> Iterator[str]:
        main = self.main
        low, high = self.fit_load_range
        presses = f", one of {len(self.cycles)} presses" if len(self.cycles) > 1 else ""
        ellipse = f"/{self.shape_factor:.3f}" if self.shape_factor < 1 else ""
        law = f"W = 4/3 √R_g ξ^(3/2) (E_0g + β W)/(1 − ν²){ellipse}"
        yield f"{self._title}: {law}, ν = {main.poisson_ratio:g}"
        means = f", each the mean of {self.rows.together}" if self.rows.together > 1 else ""
        yield f"  {self.load.size} rows{means}, loads from {low:.3g} to {high:.3g} N{presses}"
        yield f"  {self._answer()}"
        yield ""
        yield from _quantity_lines({words: (found, unit) for _, words, found, unit in self._quantities()})
        yield ""
        least = min(model.aicc for model in self.models.values())
        laws = [
            (LAWS[name].label, f"{model.aicc - least:.1f}")
            for name, model in sorted(self.models.items(), key=lambda pair: pair[1].aicc)
        ]
        yield from _table([("law of the force", "ΔAICc"), *laws])
        if self.alternatives:
            yield ""
            weights = sorted(((of.weight, name) for name, of in self.uncertainty.items()), reverse=True)
            rows = [
                (
                    EXPLANATIONS.get(name, "the model"),
                    "0.0" if name == MAIN else f"{self.alternatives[name].aicc - self.model_aicc:+.1f}",
                    f"{weight:.3f}" if weight >= 0.001 else "< 0.001",
                )
                for weight, name in weights
            ]
            yield from _table([("what else could explain the curve", "ΔAICc", "weight"), *rows])
        yield ""
        if self.law is not None:
            yield from self.law.lines()
            yield ""
        yield from _flag_lines(self.flags, self.notes)


def load_gradient(law: FittedForceModel, names: tuple[str, ...], xi: FloatArray) -> FloatArray:
    """Return the derivatives of the load at indentations by parameters of a law, (n, p)."""
    return differences(lambda values: replace(law, values=values).load_at(xi), law.values, names)


def _load_with_std(law: FittedForceModel, of: LawUncertainty, xi: FloatArray) -> tuple[FloatArray, ...]:
    """Return the load of a law, its standard uncertainty, and half of its 95 % interval."""
    slope = load_gradient(law, of.names, xi) if of.names else np.zeros((xi.size, 0))
    std = np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", slope, of.covariance, slope), 0.0))
    return law.load_at(xi), std, of.coverage_factor * std


def _shown(name: str, found: Estimate, unit: str) -> dict[str, Any]:
    if not found.known:
        return {"name": name, "unit": unit, "value": None, "std": None, "ci95": None, "reason": found.reason}
    return {"name": name, "unit": unit, "value": found.value, "std": found.std, "ci95": list(found.interval)}


def _flag_lines(flags: Sequence[str], notes: Mapping[str, str]) -> Iterator[str]:
    for flag in flags_in(flags, "curve", notes=notes):
        yield f"flag {flag.code}: {flag.words}. To do: {flag.to_do}."
    if not flags:
        yield "flags: none"


def _quantity_lines(quantities: Mapping[str, tuple[Estimate, str]]) -> Iterator[str]:
    """Return a table of what is known, and below it why the others are not."""
    rows = [("quantity", "value", "95 % interval")]
    reasons: dict[str, list[str]] = {}
    for name, (found, unit) in quantities.items():
        if not found.known:
            reasons.setdefault(found.reason, []).append(name)
            continue
        value = value_with_uncertainty(found.value, found.std)
        digits = len(value.partition(" ")[0].partition(".")[2])
        ends = (f"{end:.{digits}f}" for end in found.interval)
        interval = f"{' to '.join(ends)} {unit}" if found.std > 0 else "given, without uncertainty"
        rows.append((name, f"{value} {unit}".rstrip(), interval.rstrip()))
    yield from _table(rows)
    for reason, names in reasons.items():
        yield f"  not known: {', '.join(names)}: {reason}"


def _table(rows: Sequence[tuple[str, ...]]) -> Iterator[str]:
    """Return rows of texts below each other, the first of them the heading."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for k, row in enumerate(rows):
        first, *others = (text.ljust(width) for text, width in zip(row, widths, strict=True))
        yield "  ".join([first + "  " if k == 0 else "  " + first, *others]).rstrip()
