"""Other explanations of a loading curve, averaged with the model by Akaike weights.

None of them replaces the model: its value stays, and the uncertainty is that of all of them.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from scipy import special

from fingerpad._arrays import FloatArray
from fingerpad._display import Displayed
from fingerpad.estimate import Estimate
from fingerpad.exceptions import FitError
from fingerpad.flags import GIVE_SEMI_AXES
from fingerpad.loading.joint import FitData, JointFit, find_noise, fit_joint
from fingerpad.loading.laws import MAIN
from fingerpad.loading.least_squares import effective_count

# AICc by which a model must be ahead of another; their likelihoods are as exp(Δ/2). At 5, as 12 to one, that
# is worth a flag, while the uncertainty holds what follows in any case. At 10, as 150 to one, the other has
# next to no support (Burnham and Anderson 2002, 2.6), and what the first says may be stated.
FLAGGED, DECISIVE = 5.0, 10.0
# Deviations by which residuals of one sign follow each other too often: one in 4000 by chance.
_TOO_FEW_RUNS = -3.5
# Minimum number of residuals before contact and under load to compare, and unexplained share for a flag.
_MIN_COMPARED, MOSTLY = 10, 0.5
# Areas that are smoothed make R_g so many times as uncertain.
_CORRELATED: Final = 2.0
_MIN_AREAS = 20
FAILURES = (FitError, ArithmeticError, np.linalg.LinAlgError, ValueError)

_FIT_LAYER: Final = f"{GIVE_SEMI_AXES}, and thickness and modulus of the layer are fitted"
# What each says of the curve; all but the sphere add the parameter that the name ends with.
EXPLANATIONS: Final = {
    "area_offset": "areas with an offset at contact, as from a late camera",
    "area_growth": "an area that is not proportional to indentation",
    "stage_compliance": "a stage that yields under load",
    "inverse_thickness": "a layer of tissue on bone",
    "exact_sphere": "a sphere instead of its paraboloid",
    "hertz_stage_compliance": "one modulus, and a stage that yields under load",
    "hertz_inverse_thickness": "one modulus, and a layer of tissue on bone",
    # Bone and the sphere's shape bend the force and the areas opposite ways: together they look like neither,
    # and as one Hertzian contact of a stiffer pad.
    "hertz_sphere_inverse_thickness": "one modulus, and a sphere on a layer of tissue on bone",
}
_NO_LAW: Final = (
    "under load the force departs from the model by more than its noise before contact, as by a slip: the "
    "uncertainty holds by how much Hertz's law, a growing modulus and a power law differ"
)
# Of a pad of one modulus, β = 0, which makes room for what looks like a growing one.
_ONE_MODULUS: Final = "hertz_"
_SPHERE: Final = "sphere_"  # and of a sphere instead of its paraboloid
_WITHOUT_AREAS: Final = tuple(
    name
    for name in EXPLANATIONS
    if name.removeprefix(_ONE_MODULUS) in {"stage_compliance", "inverse_thickness"}
)
# Tissue of a finger, mm; beyond that it is as good as a half-space. A press goes no deeper than half of it.
_THINNEST_TISSUE, THICKEST_TISSUE, _DEEPEST = 1.0, 25.0, 0.5
# A zero of the force that drifts does so in no straight line: standard deviation of its bend over the press,
# as a share of the drift.
_BENT: Final = 0.4


# Half of a 95 % interval of the normal distribution, in standard deviations; deviations beyond which next to
# nothing of it lies; halvings of that range, to the last digit.
NORMAL: Final = float(special.ndtri(0.975))
_FAR, _HALVINGS = 8.0, 60


def akaike_weights(criteria: Sequence[float]) -> list[float]:
    """Return the weights exp(−Δ/2) of models, with sum 1, from their AICc (Burnham and Anderson 2002, 2.9).

    All are under one noise; a model with an infinite AICc has no weight.
    """
    likelihood = np.exp((min(criteria) - np.asarray(criteria)) / 2)
    return [float(weight) for weight in likelihood / likelihood.sum()]


def average_models(
    models: Sequence[Estimate], weights: Sequence[float], *, value: float | None = None
) -> Estimate:
    """Return a quantity with the uncertainty of all its models (Burnham and Anderson 2002, 4.3).

    Together the models θ ± u give a mixture of their distributions, each with its weight w. Its mean is
    Σ w θ, its variance Σ w (u² + (θ − value)²), and its interval lies between its 2.5 and 97.5 % points.
    `value`, such as that of one chosen model, is what the uncertainty is stated of, and the interval holds
    it; without it that is the mean. Where a model of considerable weight leaves an end of its interval open,
    this one is open too.
    """
    parts = [(one.value, one.std, one.lower, one.upper) for one in models]
    theta, std, lower, upper = np.array(parts).T
    w = np.array(weights)
    stated = float(w @ theta) if value is None else value
    below, above = (theta - lower) / NORMAL, (upper - theta) / NORMAL
    is_open = [float(w @ np.isinf(side)) / 2 >= 0.025 for side in (below, above)]
    ends = [float(mixture_point(share, w, theta, below, above)) for share in (0.025, 0.975)]
    return Estimate(
        value=stated,
        std=math.sqrt(float(w @ (std**2 + (theta - stated) ** 2))),
        interval=(
            -math.inf if is_open[0] else min(stated, ends[0]),
            math.inf if is_open[1] else max(stated, ends[1]),
        ),
    )


def mixture_point(
    share: float, weights: FloatArray, values: FloatArray, below: FloatArray, above: FloatArray
) -> FloatArray:
    """Return under which value that share of a mixture lies, by halving an interval.

    Each part, (k, ...), is normal on either side of its value, with the deviations `below` and `above`. Those
    may be infinite.
    """
    below, above = np.maximum(below, 1e-300), np.maximum(above, 1e-300)
    low, high = (
        values + way * _FAR * np.where(np.isfinite(side), side, 0.0)
        for way, side in ((-1, below), (1, above))
    )
    low, high = low.min(axis=0), high.max(axis=0)
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        apart = middle - values
        more = weights @ special.ndtr(apart / np.where(apart < 0, below, above)) < share
        low, high = np.where(more, middle, low), np.where(more, high, middle)
    return np.asarray((low + high) / 2)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Comparison(Displayed):
    """The model of a curve beside other explanations of it, by key of `EXPLANATIONS`."""

    main: JointFit  # with an offset of the areas where they have one
    rivals: Mapping[str, JointFit]  # under the same noise
    best: JointFit  # of the least AICc, with noise of its own where it is far ahead
    best_name: str  # empty for the model
    model_aicc: float  # of the model in the weights: that of one modulus where it is less
    weights: Mapping[str, float]  # of Akaike, of the rivals; what is left to one is the model's
    unexplained: float  # share of the force's residuals under load beyond noise
    doubts: Mapping[str, str]  # flags, and what they mean here in plain words

    @property
    def fits(self) -> dict[str, JointFit]:
        """The rivals, the best of them with its own noise."""
        return {key: self.best if key == self.best_name else one for key, one in self.rivals.items()}

    @property
    def too_thin(self) -> str:
        """Why no modulus is known: a layer thinner than tissue can be is far ahead; empty where none is."""
        name = "inverse_thickness"
        # Without areas a layer's shape is more easily that of something else.
        ahead = FLAGGED if self.main.record.area.size else DECISIVE
        for rival in self.rivals.values():
            at_bound = name in rival.held and name not in self.main.held
            if at_bound and self.main.aicc - rival.aicc > ahead:
                thinnest = 1 / rival.values[name]
                return (
                    f"the curve has the shape of a layer on bone thinner than {thinnest:.2g} mm and does not "
                    f"tell its modulus: {_FIT_LAYER}"
                )
        return ""

    def widened(
        self, name: str, estimate: Estimate, gradient: Mapping[str, float], spread: float = 0.0
    ) -> tuple[Estimate, float]:
        """Return a quantity with the uncertainty of all explanations, and what they add to the model's.

        It is the sum of parameters by the weights `gradient`; `spread` is by how much laws of the force
        differ in it, as a standard deviation.
        """
        if not estimate.known:
            return estimate, 0.0
        found = {key: _sum_of(fit, gradient) for key, fit in self.fits.items()}
        own = estimate.with_error(spread)
        if "correlated_area" in self.doubts and name == "loading_radius":
            own = own.stretched(_CORRELATED)
        weights = [self.weights[key] for key in found]
        whole = average_models([own, *found.values()], [1 - sum(weights), *weights], value=own.value)
        # The value stays the model's, however little weight it has, and so does its own uncertainty.
        whole = replace(whole, interval=(min(whole.lower, own.lower), max(whole.upper, own.upper)))
        return whole, math.sqrt(max(whole.std**2 - estimate.std**2, 0.0))


def _sum_of(fit: JointFit, gradient: Mapping[str, float]) -> Estimate:
    """Return a weighted sum of parameters."""
    value = sum(fit.values.get(key, 0.0) * weight for key, weight in gradient.items())
    try:
        return fit.combined(value, gradient)
    except FAILURES:  # its own uncertainty is lost in rounding
        return Estimate.symmetric(value, 0.0)


def fit_growing(record: FitData, start: Mapping[str, float], held: Mapping[str, Estimate]) -> JointFit:
    """Fit the growing modulus under the noise that areas of any offset and growth leave.

    Where force and area disagree, noise found from the model's own residuals would hold the disagreement.
    """
    if record.area.size >= _MIN_AREAS:
        free = {"area_offset": 0.0, "area_growth": 0.0}
        try:
            noise, _ = find_noise(record, MAIN, {**start, **free}, held)
            return fit_joint(record, MAIN, start, held, noise)
        except FAILURES:
            pass
    return fit_joint(record, MAIN, start, held)


def allow_for_bend(main: JointFit) -> JointFit:
    """Return a fit that allows for a force whose zero drifts in no straight line, as while a sensor warms up.

    Before contact the bend is less than the noise, and under load it looks like a change of the modulus.
    """
    std = _BENT * abs(main.values.get("force_tilt", 0.0)) * float(main.record.clock[-1])
    if not std > 0:
        return main
    start = {name: main.values[name] for name in main.fit.names}
    held = {**main.held, "force_bend": Estimate.symmetric(0.0, std)}
    return fit_joint(main.record, main.law, start, held, main.noise)


def compare(main: JointFit) -> Comparison:
    """Fit the other explanations of a curve; without areas few differ from it."""
    if not main.record.area.size:
        return _compare_without_areas(main)
    rivals = dict(_rivals(main))
    plain = [rival.aicc for _, rival in _rivals(main, (_ONE_MODULUS,))]
    reference = min([main.aicc, *plain])
    gains = {name: reference - rival.aicc for name, rival in rivals.items()}
    if any(gain > FLAGGED for name, gain in gains.items() if name.endswith("inverse_thickness")):
        # An area of any growth only describes what a layer does to it, and leaves the modulus wrong.
        for found in (rivals, gains):
            found.pop("area_growth", None)
    doubts = {}
    # Where another explains the areas far better, they are not late.
    if gains.get("area_offset", 0.0) > max(FLAGGED, max(gains.values()) - FLAGGED):
        doubts["area_offset"] = _offset_note(main, rivals["area_offset"])
    name = max(gains, key=gains.__getitem__, default="")
    best, best_name = main, ""
    if name == "area_offset" and gains[name] > FLAGGED:
        main = best = rivals.pop(name)
        reference = main.aicc
        # With an offset of their own the areas may still not be proportional to the indentation.
        both = dict(_rivals(main, ("area_growth",)))
        if both and main.aicc - both["area_growth"].aicc > FLAGGED:
            rivals |= both
            name, gains = "area_growth", {"area_growth": main.aicc - both["area_growth"].aicc}
    if name != "area_offset" and name and gains[name] > FLAGGED:
        doubts["misfit"] = (
            f"the curve fits {EXPLANATIONS[name]} better, by {gains[name]:.0f} in AICc: the "
            "uncertainty holds what follows from it"
        )
        if name.endswith("inverse_thickness"):
            doubts["misfit"] += f"; {_FIT_LAYER}"
        best, best_name = _refitted(rivals[name]), name
    unexplained = unexplained_share(best)
    if unexplained > MOSTLY:
        doubts.setdefault("misfit", _NO_LAW)
    if smoothed := smoothed_note(best.residuals()[1]):
        doubts["correlated_area"] = smoothed
    return Comparison(
        main=main,
        rivals=rivals,
        best=best,
        best_name=best_name,
        model_aicc=reference,
        weights=_weights(reference, rivals, main.held, EXPLANATIONS),
        unexplained=unexplained,
        doubts=doubts,
    )


def _weights(
    reference: float, rivals: Mapping[str, JointFit], held: Mapping[str, Estimate], names: Iterable[str]
) -> dict[str, float]:
    """Return the Akaike weights of rivals beside the model, whose AICc with β or without is `reference`.

    Before the curve is seen, late areas are as likely as the model, if their delay is not known, and so are
    all other explanations of these names together.
    """
    late = set() if "area_delay" in held else {"area_offset"}
    share = math.log(len(set(names) - late))
    criteria = [rival.aicc + (0.0 if name in late else 2 * share) for name, rival in rivals.items()]
    _, *weights = akaike_weights([reference, *criteria])
    return dict(zip(rivals, weights, strict=True))


def unexplained_share(main: JointFit) -> float:
    """Return the share of the force's residuals in contact that noise does not explain.

    Their spectral density at zero frequency, the variance over the effective number, is compared with that
    before contact; up to the 95 % point of Fisher's F it may be chance.
    """
    force = main.fit.residuals[: main.record.load.size]
    contact = main.record.attached
    if contact is None:
        contact = main.record.smooth_displacement > main.values["contact_offset"]
    before, under = force[~contact], force[contact]
    if min(before.size, under.size) < _MIN_COMPARED:
        return 0.0
    freedom = [effective_count(part) for part in (under, before)]
    density, usual = (
        float(part @ part) / count for part, count in zip((under, before), freedom, strict=True)
    )
    return max(0.0, 1 - float(special.fdtri(*freedom, 0.95)) * usual / density) if density > 0 else 0.0


def _compare_without_areas(main: JointFit) -> Comparison:
    """Compare by the force alone, which a layer and a yielding stage shape as a changing modulus does."""
    rivals = dict(_rivals(main, _WITHOUT_AREAS))
    doubts = {}
    if "loading_radius" in main.held and not {"stage_compliance", "inverse_thickness"} <= set(main.held):
        doubts["untested_without_area"] = (
            "without areas a layer on bone, or a stage that yields, looks like a modulus that changes with "
            "load: the uncertainty holds what follows from them, by how well they explain the force"
        )
    unexplained = unexplained_share(main)
    if unexplained > MOSTLY and "loading_radius" in main.held:
        doubts["misfit"] = _NO_LAW
    return Comparison(
        main=main,
        rivals=rivals,
        best=main,
        best_name="",
        model_aicc=main.aicc,
        weights=_weights(main.aicc, rivals, main.held, _WITHOUT_AREAS),
        unexplained=unexplained,
        doubts=doubts,
    )


def _rivals(main: JointFit, names: Iterable[str] = EXPLANATIONS) -> list[tuple[str, JointFit]]:
    """Return those explanations that can be fitted and are possible, under the noise of the model."""
    found = []
    for name in names:
        growing = name.removeprefix(_ONE_MODULUS)
        added = growing.removeprefix(_SPHERE)
        if added in main.held:
            continue
        law, held = main.law, main.held
        if growing != name:
            held = {**held, "load_coefficient": Estimate.symmetric(0.0, 0.0)}
        if name == "exact_sphere":
            law, added = name, ""
        elif added != growing:
            law = "exact_sphere"
        try:
            rival = _fit_added(main, added, law, held)
            if (possible := _possible(rival, added)) is not None:
                found.append((name, possible))
        except FAILURES:
            continue
    return found


def _fit_added(main: JointFit, added: str, law: str, held: Mapping[str, Estimate]) -> JointFit:
    """Fit what is added to the model from none of it, and where no minimum is found, from some of it."""
    start = {key: value for key, value in main.values.items() if key not in held}
    if not added:
        return fit_joint(main.record, law, start, held, main.noise)
    try:
        return fit_joint(main.record, law, {**start, added: 0.0}, held, main.noise)
    except FAILURES:
        load = main.top_load
        some = {"stage_compliance": 0.1 * main.depth / load, "inverse_thickness": 0.1, "area_growth": 0.1}
        start["initial_modulus"] += main.values["load_coefficient"] * load / 2
        return fit_joint(main.record, law, {**start, added: some.get(added, 0.0)}, held, main.noise)


def _possible(rival: JointFit, added: str) -> JointFit | None:
    """Return an explanation with what is added to the model in bounds; None where there is none of it."""
    value = rival.values.get(added, 0.0)
    if added == "stage_compliance":
        return rival if 0 < value * rival.top_load < rival.depth else None
    if added == "inverse_thickness":
        thinnest = thinnest_tissue(rival)
        if value * THICKEST_TISSUE < 1:
            return None
        if value * thinnest > 1:
            held = {**rival.held, added: Estimate.symmetric(1 / thinnest, 0.0)}
            start = {key: each for key, each in rival.values.items() if key not in held}
            return fit_joint(rival.record, rival.law, start, held, rival.noise)
    return rival


def thinnest_tissue(fit: JointFit) -> float:
    """Return the least thickness (mm) that the tissue of a finger can have under a press."""
    return max(_THINNEST_TISSUE, fit.depth / _DEEPEST)


def _refitted(rival: JointFit) -> JointFit:
    """Return an explanation with noise from its own residuals, without what the model left in them."""
    try:
        return fit_joint(rival.record, rival.law, rival.values, rival.held)
    except FAILURES:
        return rival


def smoothed_note(areas: FloatArray) -> str:
    """Return that neighbouring residuals of areas lie on one side too often; empty if they do not."""
    runs = runs_deviation(areas)
    if runs >= _TOO_FEW_RUNS:
        return ""
    return (
        f"neighbouring areas lie on the same side of the fit too often (runs test, {-runs:.1f} standard "
        "deviations): the areas are smoothed, or none of the models has their shape"
    )


def _offset_note(main: JointFit, wider: JointFit) -> str:
    offset, radius = wider.values["area_offset"], wider.values["loading_radius"]
    moved = wider.values["contact_offset"] - main.values["contact_offset"]
    speed = np.polyfit(main.record.clock, main.record.smooth_displacement, 1)[0]
    delay = -offset / (math.pi * radius * speed)
    late = f", as of areas {1000 * delay:.0f} ms late" if delay > 0 else ""
    return (
        f"force and area disagree on the place of contact: the areas are {offset:+.2g} mm² at the contact of "
        f"the force{late}; the place of contact is the force's, {moved:+.2g} mm from that of both"
    )


def runs_deviation(residuals: FloatArray) -> float:
    """Return how far the number of runs of one sign is from chance (Wald and Wolfowitz 1940).

    In standard deviations, negative where neighbours are alike, and 0 for fewer than twenty residuals.
    """
    signs = residuals > 0
    more, less = int(signs.sum()), int((~signs).sum())
    n = more + less
    if n < _MIN_AREAS or not more or not less:
        return 0.0
    expected = 1 + 2 * more * less / n
    variance = (expected - 1) * (expected - 2) / (n - 1)
    return float((1 + np.count_nonzero(signs[1:] != signs[:-1]) - expected) / math.sqrt(max(variance, 1e-12)))
