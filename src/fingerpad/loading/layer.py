"""Effective thickness of the tissue over bone, with its modulus, from one loading curve with areas."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, ClassVar, Final, Self

import numpy as np

from fingerpad._display import Recorded
from fingerpad._json import plain
from fingerpad.contact.contact import AnyPlacement
from fingerpad.estimate import Estimate, estimates_record
from fingerpad.exceptions import LoadingError
from fingerpad.flags import flags_in
from fingerpad.loading.curve import LoadingCurve
from fingerpad.loading.joint import (
    FitData,
    JointFit,
    Press,
    Prior,
    bounded,
    check_std,
    determined,
    find_noise,
    fit_joint,
    known_quantities,
    one_pad,
    prepare,
    start_values,
)
from fingerpad.loading.law_registry import PAD_FORM
from fingerpad.loading.laws import MAIN, THINNEST
from fingerpad.loading.noise import Noise
from fingerpad.loading.rivals import (
    FAILURES,
    FLAGGED,
    THICKEST_TISSUE,
    akaike_weights,
    average_models,
    smoothed_note,
    thinnest_tissue,
)
from fingerpad.units import KPA_PER_MPA

# Flag of a thickness that no finger has.
THICKER_THAN_FINGER: Final = "thicker_than_finger"
# Akaike weight from which on models explain a curve as well as others.
_EXPLAINS: Final = 0.05
# What is pressed, and what may be added to it: nothing, β of a modulus that grows with load, an offset of the
# areas.
_BODIES: Final = ("layer", "half_space", "paraboloid")
_ADDED: Final[Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {"": (), "_load_dependent": ("load_coefficient",), "_area_offset": ("area_offset",)}
)
_FEWEST_AREAS: Final = 5
_CONTRADICTED: Final = 3.0
_NARROWED: Final = 1 / 3
# Standard uncertainties of what is not stated. No finger is an ellipsoid: its gap departs from the paraboloid
# by half as much more or less.
_PAD_FORM_STD: Final = 0.5
_EDGE_STD: Final = 0.05  # mm, of the edge of the areas, as of contact images
_COMPLIANCE_STD: Final = 0.01  # mm/N, of a stage
_OF_ONE_SCALE: Final = ("loading_radius", "area_gain")
# Of two errors that are the same; one would leave no density to both.
_MOST_CORRELATED: Final = 0.9999
_NO_AREA: Final = (
    "no contact area in the curve: load and indentation alone cannot tell a layer from a modulus that grows "
    "with load"
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class LayerThicknessFit(Recorded):
    """Thickness and modulus of a layer of tissue over bone that explain one loading curve.

    Attributes
    ----------
    thickness : Estimate
        Effective thickness t, mm. The upper end of its interval and its value are infinite where the curve
        says only how thick the tissue is at least.
    youngs_modulus : Estimate
        E of the tissue, MPa.
    contact_offset : Estimate
        Displacement at first contact, mm. Hertz theory finds it later, where there is bone.
    radius : Estimate
        1/H of the pad, mm: the given one, improved by the curve.
    contact_over_thickness : float
        a/t at the largest area, by the best thickness; 0 on a half-space.
    correlation : float
        Of the errors of 1/t and E.
    aicc : mapping of str to float
        Corrected Akaike criterion of the pad on a ``layer`` and on a ``half_space``, and of the
        ``paraboloid`` of Hertz theory on a half-space, its radius as uncertain as the pad's; each also
        ``_load_dependent`` (a modulus that grows with load) and ``_area_offset`` (areas with a zero of their
        own), under one noise.
    weights : mapping of str to float
        Akaike weights of the same models; their sum is 1.
    notes : mapping of str to str
        What a flag means for this curve.
    flags : tuple of str
        Doubts.
    """

    _title: ClassVar[str] = "Layer of tissue over bone"

    thickness: Estimate
    youngs_modulus: Estimate
    contact_offset: Estimate
    radius: Estimate
    contact_over_thickness: float
    correlation: float
    aicc: Mapping[str, float]
    weights: Mapping[str, float]
    notes: Mapping[str, str]
    flags: tuple[str, ...]

    @property
    def preferred_model(self) -> str:
        """That of the least AICc; empty where nothing was fitted."""
        return min(self.aicc, key=self.aicc.__getitem__, default="")

    @property
    def layer_weight(self) -> float:
        """Akaike weight of all models with a layer, against those of a half-space."""
        return _weight_of("layer", self.weights)

    @property
    def hertz_weight(self) -> float:
        """Akaike weight of all models of Hertz theory: of a paraboloid on a half-space."""
        return _weight_of("paraboloid", self.weights)

    @property
    def conclusion(self) -> str:
        """Thickness and modulus with their intervals and the evidence, or why they are unknown, as text."""
        t, modulus = self.thickness, self.youngs_modulus.times(KPA_PER_MPA)
        if not t.known:
            return f"thickness of the tissue undetermined: {t.reason}"
        if THICKER_THAN_FINGER in self.notes:
            said = (
                f"this curve tells no thickness of the tissue: the best fit, {t.value:.3g} mm "
                f"(95 %: {t.lower:.3g} to {t.upper:.3g} mm), is thicker than a finger"
            )
        elif t.upper < math.inf and t.lower > 0:
            said = f"tissue {t.value:.3g} mm thick (95 %: {t.lower:.3g} to {t.upper:.3g} mm)"
        elif t.lower > 0:
            said = f"tissue thicker than {t.lower:.3g} mm (95 %)"
        else:
            said = f"tissue thinner than {t.upper:.3g} mm (95 %)"
        if modulus.known:
            said += f", E = {modulus.value:.3g} kPa (95 %: {modulus.lower:.3g} to {modulus.upper:.3g} kPa)"
        if self.contact_offset.known:
            said += f", contact at {self.contact_offset} mm"
        weight = self.layer_weight
        certain = "above 0.999" if weight > 0.999 else "below 0.001" if weight < 0.001 else f"{weight:.3f}"
        return f"{said}; Akaike weight of a layer against a half-space {certain}"

    @property
    def advice(self) -> str:
        """Which modulus to believe, that of the layer or that of Hertz theory, and why, as text."""
        t = self.thickness
        if not (t.known and self.youngs_modulus.known):
            if self.hertz_weight > self.layer_weight:
                return (
                    "believe E and the place of contact of Hertz theory: nothing in the curve speaks for bone"
                )
            return (
                "E of Hertz theory is that of a half-space: bone, which the curve neither shows nor "
                "excludes, would make it too high"
            )
        if t.upper < math.inf and THICKER_THAN_FINGER not in self.notes:
            if self.layer_weight > 1 - _EXPLAINS:
                return (
                    "believe the layer's E and place of contact, not those of Hertz theory, which takes the "
                    "tissue for a half-space: bone makes its E too high and its contact late"
                )
            return (
                "believe the layer's E, whose uncertainty holds what is not known of the bone; that of Hertz "
                "theory is right only if there is none"
            )
        return (
            "believe the layer's E: it allows for the pad's form, which Hertz theory takes for a paraboloid, "
            "and for bone, of which the curve shows none"
        )

    @classmethod
    def undetermined(cls, reason: str, flags: tuple[str, ...] = ()) -> Self:
        """Return a result that nothing could be fitted for, with the reason for every quantity."""
        unknown = Estimate.unknown(reason)
        return cls(
            **dict.fromkeys(("thickness", "youngs_modulus", "contact_offset", "radius"), unknown),
            contact_over_thickness=0.0,
            correlation=0.0,
            aicc={},
            weights={},
            notes={},
            flags=flags,
        )

    def summary(self) -> str:
        """Return thickness and modulus in words, and what to do about each flag.

        Returns
        -------
        str
            One line each.
        """
        flags = (
            f"flag {flag.code}: of the layer, {flag.words}. To do: {flag.to_do}."
            for flag in flags_in(self.notes, "curve", notes=self.notes)
        )
        return "\n".join([f"layer: {self.conclusion}", f"modulus: {self.advice}", *flags])

    def as_record(self) -> dict[str, Any]:
        """Return the numbers by names that end in units; None where unknown, or infinite."""
        record = estimates_record(
            {
                "thickness_mm": self.thickness,
                "youngs_modulus_kpa": self.youngs_modulus.times(KPA_PER_MPA),
                "contact_offset_mm": self.contact_offset,
                "radius_mm": self.radius,
            }
        )
        return {
            **plain(record),
            "contact_over_thickness": self.contact_over_thickness,
            "correlation": plain(self.correlation),
            "preferred_model": self.preferred_model or None,
            "layer_weight": self.layer_weight if self.weights else None,
            "hertz_weight": self.hertz_weight if self.weights else None,
            "advice": self.advice,
            "aicc": dict(self.aicc),
            "weights": dict(self.weights),
            "notes": dict(self.notes),
            "flags": list(self.flags),
        }


def fit_layer_thickness(
    curve: LoadingCurve,
    *,
    placement: AnyPlacement,
    radius_std: float = 0.0,
    radius_ratio_std: float = 0.0,
    poisson_ratio: float = 0.5,
    poisson_ratio_std: float = 0.0,
    load_relative_std: float = 0.0,
    area_relative_std: float = 0.02,
    shared_scale_std: float = 0.0,
    cycle: int = 0,
    stage_compliance: float | Estimate | None = None,
    area_delay: float | Estimate | None = None,
) -> LayerThicknessFit:
    """Fit the effective thickness of the tissue over bone, and its modulus, to one press with areas.

    Force and area follow the fast laws of the pad on a layer bonded to rigid bone (`fast_contact`), of one
    modulus. Fitted are 1/t, E, the place of contact, zero and tilt of the force, the pad's radius 1/H, and
    scale and edge of the areas, of which what is known beforehand is one more datum each. Uncertainties of ν,
    of the ratio of the radii, of the pad's form and of the stage are carried on. Intervals are profile
    likelihood; 1/t may be fitted below zero, so that they are right where the tissue is deep, and a
    half-space within them leaves t open above.

    A modulus that grows with load and areas with an offset are fitted as well, and averaged by Akaike
    weights. The half-space, and the paraboloid of Hertz theory on one, compete: `weights` has the evidence.
    Where that paraboloid explains the curve no thickness is given.

    What is not stated is allowed for: a pad that departs from its paraboloid by half as much more or less
    than its ellipsoid, an edge of the areas known to 0.05 mm, and a stage that yields by 0.01 mm/N.

    Parameters
    ----------
    curve : LoadingCurve
        The record.
    placement : Placement or Paraboloid
        Where one pad touches a flat plate, or its two radii of curvature there.
    radius_std : float
        Standard uncertainty of its mean-curvature radius 1/H, mm, from all sources: semi-axes, angles, and
        that no finger is an ellipsoid. A whole pad is larger or smaller with it.
    radius_ratio_std : float
        Of the ratio of its radii of curvature, at the same 1/H.
    poisson_ratio : float
        ν of the tissue, 0.3 to 0.5.
    poisson_ratio_std : float
        Its standard uncertainty.
    load_relative_std, area_relative_std : float
        Relative standard uncertainties of the scales of force and area, common to the whole curve.
    shared_scale_std : float
        Relative standard uncertainty of the scale of lengths by which both the pad and the areas were
        measured: one error, of the radius and twice of the areas. `radius_std` and `area_relative_std`
        contain it.
    cycle : int
        Which press of the record to fit.
    stage_compliance, area_delay : float or Estimate, optional
        As for `fit_loading_curve`. A compliance that is not given is 0.00 ± 0.01 mm/N.

    Returns
    -------
    LayerThicknessFit
        Quantities with their intervals, or the reasons why there are none.

    Raises
    ------
    LoadingError
        If the curve or an argument cannot be used.
    FitError
        If the record shows no contact, or does not determine the model.

    Examples
    --------
    >>> import numpy as np
    >>> from fingerpad.contact import Tissue, fast_contact
    >>> from fingerpad.geometry import Paraboloid
    >>> pad, rng = Paraboloid(14.0, 14.0), np.random.default_rng(1)
    >>> travel = np.linspace(-0.3, 1.5, 100)
    >>> tissue = Tissue(youngs_modulus=0.0375, thickness=6.0)
    >>> contact = fast_contact(pad, tissue, indentation=np.maximum(travel, 1e-6))
    >>> curve = LoadingCurve(
    ...     load=contact.load + rng.normal(0, 0.005, 100),
    ...     indentation=travel,
    ...     area=contact.area + rng.normal(0, 0.5, 100),
    ...     time=travel + 0.3,
    ... )
    >>> fit = fit_layer_thickness(curve, placement=pad, radius_std=0.4)
    >>> thickness = fit.thickness
    >>> thickness.lower < 6 < thickness.upper < 9, fit.layer_weight > 0.99
    (True, True)
    """
    held, known = _geometry(placement, radius_std, radius_ratio_std)
    if not 0.3 <= poisson_ratio <= 0.5:
        raise LoadingError(f"poisson_ratio must be 0.3 to 0.5 on a layer, found {poisson_ratio}")
    for name, std in (
        ("poisson_ratio_std", poisson_ratio_std),
        ("load_relative_std", load_relative_std),
        ("area_relative_std", area_relative_std),
        ("shared_scale_std", shared_scale_std),
    ):
        check_std(name, std)
    held |= {
        "poisson_ratio": Estimate.symmetric(poisson_ratio, poisson_ratio_std),
        "pad_form": Estimate.symmetric(1.0, _PAD_FORM_STD),
        "stage_compliance": Estimate.symmetric(0.0, _COMPLIANCE_STD),
        **known_quantities(curve, stage_compliance=stage_compliance, area_delay=area_delay),
    }
    known["area_edge"] = Estimate.symmetric(0.0, _EDGE_STD)
    if area_relative_std:
        known["area_gain"] = Estimate.symmetric(1.0, area_relative_std)
    press = prepare(curve, poisson_ratio, cycle)
    if press.record.area.size < _FEWEST_AREAS:
        found = press.record.area.size
        reason = f"{found} areas under load; five are needed" if found else _NO_AREA
        return LayerThicknessFit.undetermined(reason, press.flags)
    radius = (held | known)["loading_radius"].value
    prior = _prior(known, shared_scale_std)
    if radius_std > radius / 3:
        return LayerThicknessFit.undetermined(
            f"the pad's radius of {radius:.3g} mm is not known to a third: another one looks like a layer",
            press.flags,
        )
    with determined("a layer"):
        models = _fit(press, radius, held, prior)
        return _result(press, models, known, Estimate.symmetric(1.0, load_relative_std))


def _prior(known: Mapping[str, Estimate], shared_scale_std: float) -> Prior:
    """Return what is known beforehand; an error of the scale is in the radius once and in the areas twice."""
    covariance = np.diag([one.std**2 for one in known.values()])
    if shared_scale_std:
        radius, gain = (known.get(name, Estimate.symmetric(1.0, 0.0)) for name in _OF_ONE_SCALE)
        least = min(radius.std / radius.value, gain.std / 2)
        if shared_scale_std > least * (1 + 1e-9):
            raise LoadingError(
                "shared_scale_std must be no more than radius_std over the radius and half of "
                f"area_relative_std, which contain it: {least:.3g}; found {shared_scale_std:.3g}"
            )
        stds = radius.std * gain.std
        shared = min(2 * radius.value * shared_scale_std**2, _MOST_CORRELATED * stds)
        places = [list(known).index(name) for name in _OF_ONE_SCALE]
        covariance[places, places[::-1]] = shared
    return Prior(values={name: one.value for name, one in known.items()}, covariance=covariance)


def _geometry(
    placement: AnyPlacement, radius_std: float, radius_ratio_std: float
) -> tuple[dict[str, Estimate], dict[str, Estimate]]:
    """Return what the geometry fixes, and its radius where that is uncertain."""
    gap = one_pad(placement)
    first, second = float(gap.first_radius), float(gap.second_radius)
    for name, std in (("radius_std", radius_std), ("radius_ratio_std", radius_ratio_std)):
        check_std(name, std)
    radius = 2 / (1 / first + 1 / second)
    numbers = (
        first / second,
        *(radius * float(one) for one in (gap.first_skewness, gap.second_skewness, gap.flatness)),
    )
    held = {name: Estimate.symmetric(value, 0.0) for name, value in zip(PAD_FORM, numbers, strict=True)}
    held[PAD_FORM[0]] = Estimate.symmetric(numbers[0], radius_ratio_std)
    known = {"loading_radius": Estimate.symmetric(radius, radius_std)}
    return (held, known) if radius_std else (held | known, {})


def _fit(press: Press, radius: float, held: Mapping[str, Estimate], prior: Prior) -> dict[str, JointFit]:
    """Return all models that can be fitted, by name, under one noise."""
    record = press.record
    start = start_values(press, radius)
    modulus = start.pop("initial_modulus")
    start.pop("load_coefficient")
    start |= {"youngs_modulus": 0.7 * modulus, "inverse_thickness": 0.5 / _widest(record)}
    start |= {"loading_radius": radius, **prior.values}
    noise, start = _noise(record, start, held, prior)
    models: dict[str, JointFit] = {}
    for body in _BODIES:
        given = {**held, "pad_form": Estimate.symmetric(0.0, 0.0)} if body == "paraboloid" else held
        for added, names in _ADDED.items():
            begin = {name: value for name, value in start.items() if body == "layer" or "thick" not in name}
            begin |= dict.fromkeys(names, 0.0)
            law = "hertz"
            if "load_coefficient" in names:
                law = MAIN
                begin["initial_modulus"] = begin.pop("youngs_modulus")
            try:
                models[body + added] = fit_joint(record, law, begin, given, noise, prior=prior)
            except FAILURES:
                if body + added == "layer":
                    raise
    return models


def _widest(record: FitData) -> float:
    """Return the radius of the largest contact, mm."""
    return math.sqrt(record.area.max() / math.pi)


def _noise(
    record: FitData, start: Mapping[str, float], held: Mapping[str, Estimate], prior: Prior
) -> tuple[Noise, dict[str, float]]:
    """Return the noise that a layer leaves with areas of any offset, and parameters that fit nearly."""
    try:
        noise, near = find_noise(record, "hertz", {**start, "area_offset": 0.0}, held, prior=prior)
    except FAILURES:
        noise, near = find_noise(record, "hertz", start, held, prior=prior)
    return noise, {name: near[name] for name in start}


def _result(
    press: Press, models: Mapping[str, JointFit], known: Mapping[str, Estimate], load_gain: Estimate
) -> LayerThicknessFit:
    main, widest = models["layer"], _widest(press.record)
    aicc = {name: model.aicc for name, model in models.items()}
    weights = dict(zip(aicc, akaike_weights(list(aicc.values())), strict=True))
    layered = [models[name] for name in models if name.startswith("layer") and _possible(models[name], main)]
    shares = akaike_weights([model.aicc for model in layered])
    inverse, modulus = (
        average_models([of(model, exact=model is main) for model in layered], shares)
        for of in (_inverse_thickness, _modulus)
    )
    offset = average_models([_first_order(model, "contact_offset") for model in layered], shares)
    modulus = modulus.over(load_gain)
    reason = _hertz_explains(inverse, weights)
    notes = {} if reason else _notes(main, models, known, inverse, widest)
    reason = reason or _reason(main, inverse, widest)
    unknown = Estimate.unknown(reason)
    return LayerThicknessFit(
        thickness=unknown if reason else _thickness(inverse, widest),
        youngs_modulus=unknown if reason else bounded(modulus),
        contact_offset=offset,
        radius=_first_order(main, "loading_radius"),
        contact_over_thickness=widest * max(inverse.value, 0.0),
        correlation=_correlation(main, "youngs_modulus"),
        aicc=aicc,
        weights=weights,
        notes=notes,
        flags=(*press.flags, *notes),
    )


def _possible(model: JointFit, main: JointFit) -> bool:
    """Return whether a finger can have a rival's tissue: the fit without additions always counts."""
    return model is main or 0 <= model.values["inverse_thickness"] < 1 / thinnest_tissue(model)


def _inverse_thickness(model: JointFit, *, exact: bool) -> Estimate:
    return model.estimate("inverse_thickness") if exact else _first_order(model, "inverse_thickness")


def _modulus(model: JointFit, *, exact: bool) -> Estimate:
    """Return E of a model; a growing one at the largest load."""
    if "youngs_modulus" in model.values:
        return model.estimate("youngs_modulus") if exact else _first_order(model, "youngs_modulus")
    whole = {"initial_modulus": 1.0, "load_coefficient": model.top_load}
    return model.combined(sum(model.values[name] * weight for name, weight in whole.items()), whole)


def _thickness(inverse: Estimate, widest: float) -> Estimate:
    """Return t from 1/t, with an end beyond the range of the laws open; infinite on a possible half-space."""
    value = 1 / inverse.value if inverse.lower > 0 else math.inf
    return Estimate(
        value=value,
        std=inverse.std * value**2,
        interval=(
            1 / inverse.upper if inverse.upper * widest < THINNEST else 0.0,
            1 / inverse.lower if inverse.lower > 0 else math.inf,
        ),
    )


def _first_order(fit: JointFit, name: str) -> Estimate:
    """Return a parameter whose profile is a parabola: of little interest, and not worth its time."""
    return fit.held[name] if name in fit.held else fit.combined(fit.values[name], {name: 1.0})


def _correlation(fit: JointFit, name: str) -> float:
    """Return the correlation of the errors of 1/t and of another parameter; 0 where it is not fitted."""
    names = fit.fit.names
    if name not in names:
        return 0.0
    one, other = names.index("inverse_thickness"), names.index(name)
    covariance = fit.covariance
    return float(covariance[one, other] / math.sqrt(covariance[one, one] * covariance[other, other]))


def _hertz_explains(inverse: Estimate, weights: Mapping[str, float]) -> str:
    """Return why there need be no bone, if a paraboloid on a half-space explains the curve; else nothing."""
    hertz = _weight_of("paraboloid", weights)
    if hertz < _EXPLAINS or (inverse.lower <= 0 and hertz < 1 - _EXPLAINS):
        return ""
    return (
        "Hertz theory, a paraboloid on a half-space, explains the curve with a radius that the geometry "
        f"allows (Akaike weight {hertz:.2g}); an ellipsoid, which curves away from it, looks like a layer"
    )


def _reason(fit: JointFit, inverse: Estimate, widest: float) -> str:
    """Return why the curve does not tell the thickness; empty where it does."""
    if inverse.upper <= 0:
        return (
            "the area grows less with indentation than on a half-space, which no layer explains: check the "
            "radius, the areas and the zero of the displacement"
        )
    if inverse.lower > 0 or inverse.upper * widest < 1:
        return ""
    wide = f"a half-space fits as well as tissue thinner than the contact's radius of {widest:.1f} mm: "
    words = {
        "loading_radius": "the pad's radius is not known well enough, and another radius looks like a layer",
        "contact_offset": "the place of contact is not known well enough",
        "youngs_modulus": "thickness and modulus cannot be separated",
    }
    shares = {name: _correlation(fit, name) for name in words}
    name = max(shares, key=lambda one: abs(shares[one]))
    if shares[name] ** 2 < 0.5:
        return f"{wide}the areas are too few or too uncertain, or the press too shallow"
    return f"{wide}{words[name]} (correlation {shares[name]:.2f} with 1/t)"


def _notes(
    main: JointFit,
    models: Mapping[str, JointFit],
    prior: Mapping[str, Estimate],
    inverse: Estimate,
    widest: float,
) -> dict[str, str]:
    """Return flags with their meaning."""
    notes = {}
    grown = models.get("layer_load_dependent")
    falls = grown is not None and grown.values["load_coefficient"] < 0
    varies, way = ("modulus_falls_with_load", "falls") if falls else ("modulus_depends_on_load", "grows")
    for added, flag, words in (
        ("_load_dependent", varies, f"a modulus that {way} with load"),
        ("_area_offset", "area_offset", "areas with an offset at contact, as from a late camera,"),
    ):
        rival = models.get(f"layer{added}")
        gain = main.aicc - rival.aicc if rival else 0.0
        if gain > FLAGGED:
            notes[flag] = f"{words} fits better than a layer alone, by {gain:.0f} in AICc"
    known = prior.get("loading_radius")
    if known is not None:
        found = _first_order(main, "loading_radius")
        moved = abs(found.value - known.value) / known.std
        if moved > _CONTRADICTED:
            notes["radius_contradicts_curve"] = (
                f"the curve asks for a radius of {found.value:.3g} mm, {moved:.0f} standard uncertainties "
                f"from the geometry's {known.value:.3g} mm"
            )
        if found.std < _NARROWED * known.std:
            notes["radius_narrowed"] = (
                f"the curve claims to know the radius to {found.std:.2g} mm, less than a third of the "
                f"geometry's {known.std:.2g} mm"
            )
    if inverse.upper * widest >= THINNEST:
        notes["layer_too_thin"] = "the layer may be thinner than a third of the contact's radius"
    if inverse.lower > 0 and inverse.value * THICKEST_TISSUE < 1:
        notes[THICKER_THAN_FINGER] = (
            "a layer thicker than a finger hardly differs from a half-space: some other departure from the "
            "model can look like it"
        )
    if smoothed := smoothed_note(main.residuals()[1]):
        notes["correlated_area"] = smoothed
    return notes


def _weight_of(body: str, weights: Mapping[str, float]) -> float:
    """Return the Akaike weight of all models of what is pressed, a ``layer`` or ``paraboloid``, say."""
    return sum(weight for name, weight in weights.items() if name.startswith(body))
