"""Other explanations of a loading curve, compared with the model by AICc.

None of them replaces the model. Where one fits better, the stated intervals are widened to hold its values.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad._display import Displayed
from fingerpad.exceptions import FitError
from fingerpad.loading.estimate import Estimate, Quantity
from fingerpad.loading.joint import FitData, JointFit, find_noise, fit_joint

# AICc by which an explanation must be ahead to count, to be named in a flag, and to exclude others.
COUNTS, FLAGGED, EXCLUDES = 2.0, 5.0, 6.0
# Every stage yields and every finger has a bone: these count unless the curve speaks against them.
_EVERYWHERE_COUNTS: Final = -0.5
# So is every camera late: for the place of contact an offset of the areas counts beyond its uncertainty.
_LATE_COUNTS: Final = -1.0
# Deviations by which residuals of one sign follow each other too often.
TOO_FEW_RUNS = -3.5
_MIN_AREAS = 20
FAILURES = (FitError, ArithmeticError, np.linalg.LinAlgError, ValueError)

# What each says of the curve; all but the sphere add the parameter of that name.
EXPLANATIONS: Final = {
    "area_offset": "areas with an offset at contact, as from a late camera",
    "area_growth": "an area that is not proportional to indentation",
    "stage_compliance": "a stage that yields under load",
    "inverse_thickness": "a layer of tissue on bone",
    "exact_sphere": "a sphere instead of its paraboloid",
    "hertz_stage_compliance": "one modulus, and a stage that yields under load",
    "hertz_inverse_thickness": "one modulus, and a layer of tissue on bone",
}
# Of a pad of one modulus, β = 0, which makes room for what looks like a growing one.
_ONE_MODULUS: Final = "hertz_"
# Below zero these say something else in disguise.
_POSITIVE: Final = {"stage_compliance", "inverse_thickness"}
_WITHOUT_AREAS: Final = tuple(name for name in EXPLANATIONS if name.removeprefix(_ONE_MODULUS) in _POSITIVE)
# A zero of the force that drifts does so in no straight line: standard deviation of its bend over the press,
# as a share of the drift.
_BENT: Final = 0.4


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Comparison(Displayed):
    """The model of a curve beside other explanations of it.

    Attributes
    ----------
    main : JointFit
        The model, with an offset of the areas where they have one.
    rivals : mapping of str to JointFit
        Other explanations under the same noise, by key of `EXPLANATIONS`.
    best : JointFit
        That of the least AICc, with noise of its own where it is far ahead.
    doubts : mapping of str to str
        Flags, and what they mean here in plain words.
    reference : float
        AICc that explanations must be ahead of: that of the model, or of a pad of one modulus if less.
    """

    main: JointFit
    rivals: Mapping[str, JointFit]
    best: JointFit
    doubts: Mapping[str, str]
    reference: float

    def widened(self, name: str, estimate: Quantity, gradient: Mapping[str, float]) -> tuple[Quantity, float]:
        """Return a quantity whose interval holds the values of better explanations, and by how much it moved.

        Parameters
        ----------
        name : str
            A parameter, for the residuals' own test.
        estimate : Quantity
            From the main fit.
        gradient : mapping of str to float
            Weights of the parameters whose sum it is.
        """
        if not isinstance(estimate, Estimate):
            return estimate, 0.0
        others = []
        for rival in self.others + (self._late if name == "contact_offset" else []):
            value = sum(rival.values.get(key, 0.0) * weight for key, weight in gradient.items())
            try:
                others.append(rival.combined(value, gradient))
            except FAILURES:  # its own uncertainty is lost in rounding
                others.append(Estimate.symmetric(value, 0.0))
        if "correlated_area" in self.doubts and name == "loading_radius":
            half = 2 * (estimate.upper - estimate.value)
            others += [
                replace(estimate, value=estimate.value + estimate.std, upper=estimate.value + half),
                replace(estimate, value=estimate.value - estimate.std, lower=estimate.value - half),
            ]
        whole = estimate.including(*others)
        return whole, math.sqrt(max(whole.std**2 - estimate.std**2, 0.0))

    @property
    def _late(self) -> list[JointFit]:
        """Areas with an offset at contact, unless the delay is given or the curve speaks against them."""
        late = self.rivals.get("area_offset")
        if late is None or "area_delay" in self.main.held:
            return []
        return [late] if late.aicc < self.main.aicc - _LATE_COUNTS else []

    def _limit(self, name: str) -> float:
        """Return the AICc below which an explanation counts."""
        if name.removeprefix(_ONE_MODULUS) in _POSITIVE:
            return self.reference - _EVERYWHERE_COUNTS
        return self.main.aicc - (0.0 if name == "area_offset" else COUNTS)

    @property
    def others(self) -> list[JointFit]:
        """The explanations that count beside the model and are not excluded by the best."""
        least = min([self.reference, *(rival.aicc for rival in self.rivals.values())])
        ahead = [
            rival
            for name, rival in self.rivals.items()
            if rival.aicc < self._limit(name) and rival.aicc < least + EXCLUDES
        ]
        return ahead if self.best is self.main else [self.best, *ahead]


def fit_growing(record: FitData, start: Mapping[str, float], held: Mapping[str, Estimate]) -> JointFit:
    """Fit the growing modulus under the noise that areas of any offset and growth leave.

    Where force and area disagree, noise found from the model's own residuals would hold the disagreement.
    """
    law = "load_dependent"
    if record.area.size >= _MIN_AREAS:
        free = {"area_offset": 0.0, "area_growth": 0.0}
        try:
            noise, _ = find_noise(record, law, {**start, **free}, held)
            return fit_joint(record, law, start, held, noise)
        except FAILURES:
            pass
    return fit_joint(record, law, start, held)


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
    doubts = {}
    if gains.get("area_offset", 0.0) > FLAGGED:
        doubts["area_offset"] = _offset_note(main, rivals["area_offset"])
    name = max(gains, key=gains.__getitem__, default="")
    best = main
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
            f"the curve fits {EXPLANATIONS[name]} better, by {gains[name]:.0f} in AICc: intervals are "
            "widened to hold what follows from it"
        )
        best = _refitted(rivals[name])
    runs = runs_deviation(best.residuals()[1])
    if runs < TOO_FEW_RUNS:
        doubts["correlated_area"] = (
            f"neighbouring areas lie on the same side of the fit too often (runs test, {-runs:.1f} standard "
            "deviations): the areas are smoothed, or none of the models has their shape"
        )
    return Comparison(main=main, rivals=rivals, best=best, doubts=doubts, reference=reference)


def _compare_without_areas(main: JointFit) -> Comparison:
    """Compare by the force alone, which a layer and a yielding stage shape as a changing modulus does."""
    rivals = dict(_rivals(main, _WITHOUT_AREAS))
    doubts = {}
    if "loading_radius" in main.held:
        doubts["untested_without_area"] = (
            "without areas a layer on bone, or a stage that yields, looks like a modulus that changes with "
            "load: where they explain the force as well, intervals are widened to hold what follows"
        )
    return Comparison(main=main, rivals=rivals, best=main, doubts=doubts, reference=main.aicc)


def _rivals(main: JointFit, names: Iterable[str] = EXPLANATIONS) -> list[tuple[str, JointFit]]:
    """Return those explanations that can be fitted, under the noise of the model."""
    found = []
    for name in names:
        added = name.removeprefix(_ONE_MODULUS)
        if added in main.held:
            continue
        sphere, held = name == "exact_sphere", main.held
        if added != name:
            held = {**held, "load_coefficient": Estimate.symmetric(0.0, 0.0)}
        start = {key: value for key, value in main.values.items() if key not in held}
        if added and not sphere:
            start[added] = 0.0
        try:
            rival = fit_joint(main.record, name if sphere else main.law, start, held, main.noise)
        except FAILURES:
            continue
        if added not in _POSITIVE or rival.values[added] > 0:
            found.append((name, rival))
    return found


def _refitted(rival: JointFit) -> JointFit:
    """Return an explanation with noise from its own residuals, without what the model left in them."""
    try:
        return fit_joint(rival.record, rival.law, rival.values, rival.held)
    except FAILURES:
        return rival


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

    Parameters
    ----------
    residuals : ndarray, (n,)
        In order.

    Returns
    -------
    float
        In standard deviations, negative where neighbours are alike; 0 for fewer than twenty residuals.

    Examples
    --------
    >>> x = np.linspace(0, 3, 100)
    >>> runs_deviation(np.sin(x) - 0.5) < -9
    True
    """
    signs = residuals > 0
    more, less = int(signs.sum()), int((~signs).sum())
    n = more + less
    if n < _MIN_AREAS or not more or not less:
        return 0.0
    expected = 1 + 2 * more * less / n
    variance = (expected - 1) * (expected - 2) / (n - 1)
    return float((1 + np.count_nonzero(signs[1:] != signs[:-1]) - expected) / math.sqrt(max(variance, 1e-12)))
