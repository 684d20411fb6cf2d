"""Quantities of a fitted record, or why they are undetermined, and flags."""

import math
from collections.abc import Mapping

import numpy as np

from fingerpad._arrays import BoolArray, FloatArray
from fingerpad.estimate import Estimate
from fingerpad.exceptions import FitError
from fingerpad.loading.averaging import akaike_weights, average_models
from fingerpad.loading.joint import JointFit
from fingerpad.loading.least_squares import fit_least_squares
from fingerpad.loading.rivals import Comparison

# Beyond these no finger pad lies, mm and MPa: a wrong unit.
PLAUSIBLE_RADIUS, PLAUSIBLE_MODULUS = (2.0, 100.0), (0.001, 5.0)
# A given radius is doubted when the slope of the area is so many standard uncertainties away.
_CONTRADICTED, _MIN_AREAS = 4.0, 5
_PARAMETERS = ("loading_radius", "initial_modulus", "load_coefficient", "contact_offset")
_NO_RADIUS = (
    "no contact area in the curve, so its radius is not known: give a column area_mm2, or loading_radius"
)


def quantities(
    compared: Comparison, models: Mapping[str, JointFit], *, known: bool
) -> tuple[dict[str, Estimate], dict[str, float]]:
    """Return all quantities by name, and what better explanations of the curve add to their uncertainty.

    Those that need a radius are unknown where it is not `known`.
    """
    main = compared.main
    top = top_load(main)
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
    if not known:
        unknown = set(found) - {"contact_offset"}
        found |= dict.fromkeys(unknown, Estimate.unknown(_NO_RADIUS))
        added |= dict.fromkeys(unknown, 0.0)
    reduction = 1 / (1 - main.record.poisson_ratio**2)
    found |= {
        "reduced_modulus": found["youngs_modulus"].times(reduction),
        "load_exponent": (
            bounded(models["free_exponent"].estimate("load_exponent"))
            if "free_exponent" in models
            else Estimate.unknown("a power law with free exponent does not fit the curve")
        ),
        "area_exponent": _area_exponent(compared),
    }
    return found, {**added, "reduced_modulus": reduction * added["youngs_modulus"]}


def _spread_of_laws(name: str, value: float, models: Mapping[str, JointFit], unexplained: float) -> float:
    """Return the root mean square difference of laws of the force from the model in one quantity.

    They are weighed as AICc says for residuals of which noise explains that much less (Burnham and Anderson
    2002, 2.5).
    """
    found = []
    for law, model in models.items():
        values = model.values
        if law == "hertz":
            values |= {"initial_modulus": values["youngs_modulus"], "load_coefficient": 0.0}
        elif law == "free_exponent":
            values["youngs_modulus"] *= _depth(model) ** (values["load_exponent"] - 1.5)
        elif name == "youngs_modulus":
            values[name] = value
        if name in values:
            found.append(((1 - unexplained) * model.aicc, values[name] - value))
    criteria, apart = zip(*found, strict=True)
    return math.sqrt(sum(w * one**2 for w, one in zip(akaike_weights(criteria), apart, strict=True)))


def _depth(model: JointFit) -> float:
    return float(model.record.smooth_displacement.max()) - model.values["contact_offset"]


def top_load(main: JointFit) -> float:
    """Return the fitted load at the largest displacement, N."""
    return float(main.load(np.array([main.record.smooth_displacement.max()]))[0])


def bounded(estimate: Estimate) -> Estimate:
    """Return an estimate whose interval has both ends, or say that the curve does not bound it."""
    if math.isfinite(estimate.lower) and math.isfinite(estimate.upper):
        return estimate
    return Estimate.unknown(
        f"the curve does not bound it: {estimate.value:.3g} is best, but far from certain"
    )


def _area_exponent(compared: Comparison) -> Estimate:
    """Return n by the best explanation, with the uncertainty of where the areas begin."""
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
    if W.size < 5:
        return Estimate.unknown(
            _NO_RADIUS if not record.area.size else f"{W.size} areas under load; five are needed"
        )
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


def implausible(main: JointFit, given: float | Estimate | None, *, known: bool) -> tuple[str, ...]:
    """Return flags for values that no finger pad has, and for a given radius that the area contradicts."""
    radius = main.values["loading_radius"]
    modulus = main.values["initial_modulus"] + main.values["load_coefficient"] * top_load(main)
    record = main.record
    contradicted = False
    if given is not None and record.area.size >= _MIN_AREAS:
        displacement = record.smooth_displacement[record.with_area]
        (slope, _), covariance = np.polyfit(np.pi * displacement, record.area, 1, cov=True)
        given_std = given.std if isinstance(given, Estimate) else 0.0
        std = math.hypot(math.sqrt(covariance[0, 0]), given_std, 0.02 * radius)
        contradicted = abs(slope - radius) > _CONTRADICTED * std
    doubts = {
        "radius_contradicts_area": contradicted,
        "implausible_radius": known and not PLAUSIBLE_RADIUS[0] <= radius <= PLAUSIBLE_RADIUS[1],
        "implausible_modulus": known and not PLAUSIBLE_MODULUS[0] <= modulus <= PLAUSIBLE_MODULUS[1],
    }
    return tuple(name for name, seen in doubts.items() if seen)
