"""The result of fitting one press: its quantities, the load it predicts, and all of it as text."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Final, Self

import numpy as np
from scipy import special

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array
from fingerpad._display import Displayed
from fingerpad._records import Recorded
from fingerpad._rounding import value_with_uncertainty
from fingerpad.estimate import Estimate, estimates_record
from fingerpad.exceptions import LoadingError
from fingerpad.flags import flags_in
from fingerpad.loading.averaging import akaike_weights
from fingerpad.loading.cycles import Cycle, Hysteresis
from fingerpad.loading.joint import FitData
from fingerpad.loading.law_fit import LawFit
from fingerpad.loading.laws import LAWS, FittedForceModel, indentation_of, load_at, secant_modulus
from fingerpad.loading.rivals import EXPLANATIONS
from fingerpad.units import KPA_PER_MPA

# The law whose quantities are stated, and the others of the force.
MAIN: Final = "load_dependent"
_MODULI: Final = ("reduced_modulus", "youngs_modulus", "initial_modulus", "load_coefficient")
# Nearer to contact than this share of the depth a row's secant modulus says nothing.
_FOOT: Final = 0.05
_NORMAL: Final = float(special.ndtri(0.975))
_HALVINGS: Final = 60


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Secant(Displayed):
    """The secant modulus of rows in contact.

    Attributes
    ----------
    load, indentation : ndarray
        W (N) and ξ (mm).
    modulus : ndarray
        E_g, MPa.
    """

    load: FloatArray
    indentation: FloatArray
    modulus: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class LawUncertainty(Displayed):
    """How well the parameters of a fitted law are known on which its load depends.

    Attributes
    ----------
    names : tuple of str
        The parameters.
    covariance : ndarray, (p, p)
        Theirs, with drifting noise, the uncertainty of the noise, and what was given from elsewhere.
    coverage_factor : float
        Half of a 95 % interval over the standard uncertainty, of the load at the largest indentation.
    weight : float
        Akaike weight of the law.
    """

    names: tuple[str, ...]
    covariance: FloatArray
    coverage_factor: float
    weight: float


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
    alternatives : mapping of str to FittedForceModel
        Other explanations of the curve under the same noise, by key of `EXPLANATIONS`: an offset or another
        growth of the areas, a stage that yields, a layer on bone, both also with one modulus, an exact
        sphere.
    uncertainty : mapping of str to LawUncertainty
        Of ``load_dependent`` and of each alternative; the weights have the sum 1.
    unexplained : float
        Share of the force's residuals under load that noise does not explain, where there is no area.
    misfit_std : mapping of str to float
        What better explanations add to the standard uncertainty of a quantity; 0 where there are none.
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
    uncertainty: Mapping[str, LawUncertainty]
    unexplained: float
    misfit_std: Mapping[str, float]
    rows: FitData
    notes: Mapping[str, str]
    flags: tuple[str, ...]
    law: LawFit | None = None

    def _shown(self) -> list[tuple[str, Any]]:
        return [(name, value) for name, value in Recorded._shown(self) if (name, value) != ("law", None)]

    @property
    def load(self) -> FloatArray:
        """Force of each row from its fitted zero, N."""
        return self.models[MAIN].corrected_load(self.rows.clock, self.rows.load)

    @property
    def indentation(self) -> FloatArray:
        """ξ of each row, mm, less what the stage yields; negative before the fitted place of contact."""
        main = self.models[MAIN]
        return indentation_of(main.values, main.law, self.rows.displacement, main.poisson_ratio)

    @property
    def preferred_model(self) -> str:
        """The law of the force of the least AICc."""
        return min(self.models, key=lambda name: self.models[name].aicc)

    @property
    def secant(self) -> Secant:
        """E_g of each row that is well in contact, against ξ and W."""
        main = self.models[MAIN]
        depth = self.indentation
        used = depth > _FOOT * depth.max()
        load, depth = self.load[used], depth[used]
        radius = main.values["loading_radius"]
        modulus = secant_modulus(load, depth, loading_radius=radius, poisson_ratio=main.poisson_ratio)
        return Secant(load=load, indentation=depth, modulus=modulus)

    def predict(self, indentation: ArrayLike) -> Estimate:
        """Return the load at indentations, with its uncertainty and 95 % interval.

        The value is that of the law with a growing modulus, on which all quantities here rest. Its
        uncertainty is that of the law's parameters, and of what else could have made the curve: the
        `alternatives` by their Akaike weights, and where there is no area the laws that depart from each
        other. Indentation counts from first contact, wherever that was: that the place of contact is
        uncertain makes the moduli uncertain, and the load with them. Neither the scale of the force nor the
        noise of a single reading is in it.

        Parameters
        ----------
        indentation : array_like
            ξ, mm, from first contact on; before it, the load is zero.

        Returns
        -------
        Estimate
            W, N: arrays of the shape of `indentation`. NaN where the law has no finite load.

        Examples
        --------
        >>> from fingerpad.loading import fit_loading_curve
        >>> from fingerpad.simulate import simulate_loading_curve
        >>> fit = fit_loading_curve(simulate_loading_curve(points=60, force_std=0.005, area_std=0.5, seed=1))
        >>> print(f"{fit.predict(1.0)} N (truth: 0.317 N)")
        0.3195 ± 0.0028 N (truth: 0.317 N)
        """
        shape = np.shape(indentation)
        xi = np.maximum(as_float_array(indentation).ravel(), 0.0)
        laws = [self.models[MAIN], *(self.alternatives[name] for name in self.uncertainty if name != MAIN)]
        weights = np.array([of.weight for of in self.uncertainty.values()])
        load, std, half = np.array(
            [_load_with_std(law, of, xi) for law, of in zip(laws, self.uncertainty.values(), strict=True)]
        ).swapaxes(0, 1)
        spread = math.sqrt(self.unexplained) * self._spread(xi, load[0])
        std[0], half[0] = np.hypot(std[0], spread), np.hypot(half[0], _NORMAL * spread)
        # About the value of the model, which stays, as the uncertainty of all quantities.
        whole = np.sqrt(weights @ (std**2 + (load - load[0]) ** 2))
        lower, upper = (_mixture_point(share, weights, load, half) for share in (0.025, 0.975))
        interval = np.minimum(lower, load[0] - half[0]), np.maximum(upper, load[0] + half[0])
        ends = tuple(end.reshape(shape)[()] for end in interval)
        return Estimate(value=load[0].reshape(shape)[()], std=whole.reshape(shape)[()], interval=ends)

    def _spread(self, xi: FloatArray, load: FloatArray) -> FloatArray:
        """Return the root mean square difference of the laws of the force from the model."""
        if not self.unexplained:
            return np.zeros_like(load)
        laws = self.models.values()
        weights = akaike_weights([(1 - self.unexplained) * law.aicc for law in laws])
        apart = np.array([_load(law, law.values, xi) - load for law in laws])
        return np.asarray(np.sqrt(np.array(weights) @ apart**2))

    def divide_by_constraint(self, coefficient: Estimate) -> Self:
        """Return the fit with all moduli divided by a constraint coefficient.

        Bone and nail make a thin pad stiffer than a half-space of the same tissue, by this factor. It is
        poorly known for fingers: its uncertainty goes into the moduli, and the result is flagged
        ``constraint_assumed``. The load that is predicted stays.

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
        divided: dict[str, Any] = {name: getattr(self, name).over(coefficient) for name in _MODULI}
        misfit = {
            name: std / (coefficient.value if name in _MODULI else 1.0)
            for name, std in self.misfit_std.items()
        }
        return replace(self, **divided, misfit_std=misfit, flags=(*self.flags, "constraint_assumed"))

    def as_record(self) -> dict[str, Any]:
        """Return the numbers by names that end in units, with ``_std`` and ``_ci95``; None if unknown."""
        quantities = {
            "loading_radius_mm": self.loading_radius,
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
            "weights": {name: of.weight for name, of in self.uncertainty.items()},
            "notes": dict(self.notes),
            "segments": [cycle.as_record() for cycle in self.cycles],
            "hysteresis_mJ": [loss.energy if loss else None for loss in self.hysteresis],
            "hysteresis_fraction": [loss.fraction if loss else None for loss in self.hysteresis],
            "flags": list(self.flags),
            **({} if self.law is None else {"law": self.law.as_record()}),
        }

    def summary(self) -> str:
        """Return the `report`."""
        return self.report()

    def report(self) -> str:
        """Return the fit as text: law, quantities, other laws and explanations, and flags in words.

        Returns
        -------
        str
            Each quantity with its unit, standard uncertainty and 95 % interval, or why it is not known.
        """
        return "\n".join(self._lines())

    def _lines(self) -> Iterator[str]:
        main = self.models[MAIN]
        low, high = self.fit_load_range
        presses = f", one of {len(self.cycles)} presses" if len(self.cycles) > 1 else ""
        yield f"{self._title}: W = 4/3 √R_g ξ^(3/2) (E_0g + β W)/(1 − ν²), ν = {main.poisson_ratio:g}"
        yield f"  {self.load.size} rows, loads from {low:.3g} to {high:.3g} N{presses}"
        yield ""
        at = f" at {self.modulus_load:.3g} N"
        quantities = {
            "loading radius R_g": (self.loading_radius, "mm"),
            f"reduced modulus E*{at}": (self.reduced_modulus.times(KPA_PER_MPA), "kPa"),
            f"Young's modulus E{at}": (self.youngs_modulus.times(KPA_PER_MPA), "kPa"),
            "initial modulus E_0g": (self.initial_modulus.times(KPA_PER_MPA), "kPa"),
            "its growth with load β": (self.load_coefficient.times(KPA_PER_MPA), "kPa/N"),
            "place of contact x₀": (self.contact_offset, "mm"),
            "exponent of load m, W ∝ ξ^m": (self.load_exponent, ""),
            "exponent of area n, A ∝ W^n": (self.area_exponent, ""),
        }
        yield from _quantity_lines(quantities)
        yield ""
        least = min(model.aicc for model in self.models.values())
        laws = [
            (LAWS[name].label, f"{model.aicc - least:.1f}")
            for name, model in sorted(self.models.items(), key=lambda pair: pair[1].aicc)
        ]
        yield from _table([("law of the force", "ΔAICc"), *laws])
        if self.alternatives:
            yield ""
            # About the model, whose criterion is that of one modulus where that is less.
            weights = sorted(((of.weight, name) for name, of in self.uncertainty.items()), reverse=True)
            rows = [
                (
                    EXPLANATIONS.get(name, "the model"),
                    f"{self.alternatives.get(name, main).aicc - main.aicc:+.1f}" if name != MAIN else "0.0",
                    f"{weight:.3f}" if weight >= 0.001 else "< 0.001",
                )
                for weight, name in weights
            ]
            yield from _table([("what else could explain the curve", "ΔAICc", "weight"), *rows])
        yield ""
        if self.law is not None:
            yield from self.law.lines()
            yield ""
        for flag in flags_in(self.flags, "curve"):
            yield f"flag {flag.code}: {self.notes.get(flag.code, flag.words)}. To do: {flag.to_do}."
        if not self.flags:
            yield "flags: none"


def _load(law: FittedForceModel, values: Mapping[str, float], xi: FloatArray) -> FloatArray:
    return load_at(values, law.law, xi, law.poisson_ratio)


def load_gradient(law: FittedForceModel, names: tuple[str, ...], xi: FloatArray) -> FloatArray:
    """Return the derivatives of the load at indentations by parameters of a law, (n, p)."""
    columns = []
    for name in names:
        value = law.values[name]
        step = 1e-5 * (abs(value) or 1.0)
        up, down = (_load(law, {**law.values, name: value + way * step}, xi) for way in (1, -1))
        columns.append((up - down) / (2 * step))
    return np.stack(columns, axis=-1)


def _load_with_std(law: FittedForceModel, of: LawUncertainty, xi: FloatArray) -> tuple[FloatArray, ...]:
    """Return the load of a law, its standard uncertainty, and half of its 95 % interval."""
    slope = load_gradient(law, of.names, xi) if of.names else np.zeros((xi.size, 0))
    std = np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", slope, of.covariance, slope), 0.0))
    return _load(law, law.values, xi), std, of.coverage_factor * std


def _mixture_point(share: float, weights: FloatArray, load: FloatArray, half: FloatArray) -> FloatArray:
    """Return below which load that share of all models lies, by halving an interval at each indentation."""
    spread = np.maximum(half / _NORMAL, 1e-300)
    low, high = (load - 8 * spread).min(axis=0), (load + 8 * spread).max(axis=0)
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        more = weights @ special.ndtr((middle - load) / spread) < share
        low, high = np.where(more, middle, low), np.where(more, high, middle)
    return np.asarray((low + high) / 2)


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
