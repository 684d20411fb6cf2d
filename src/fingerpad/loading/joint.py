"""Force, displacement and area of a pressed pad in one fit, with the noise of all three.

Every row has F = W(ξ) + zero + tilt · t and A = π R ξ with ξ = displacement − offset; before contact W = 0.
The zero of the force, its drift and the place of contact are parameters like the moduli, so that their
uncertainty is in every result.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from fingerpad._arrays import BoolArray, FloatArray, as_float_array
from fingerpad._display import Displayed
from fingerpad.estimate import Estimate
from fingerpad.loading.laws import (
    LAWS,
    PAD_FORM,
    FittedForceModel,
    Values,
    area_at,
    force_zero,
    indentation_of,
    load_on,
    pull_off_of,
    slope_at,
)
from fingerpad.loading.least_squares import (
    Bounds,
    LeastSquaresFit,
    Residuals,
    fit_least_squares,
    minimum,
)
from fingerpad.loading.noise import KINDS, Noise, NoiseUncertainty, estimate_noise, noise_uncertainty


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FitData(Displayed):
    """The rows of one press that a fit uses: baseline and loading.

    Attributes
    ----------
    clock, load, displacement, smooth_displacement : ndarray, (n,)
        Time, force, and displacement as measured and without most of its noise, for slopes.
    area : ndarray, (m,)
        Areas, mm².
    with_area : ndarray of bool, (n,)
        Rows that have one, m in all.
    poisson_ratio : float
        ν.
    attached : ndarray of bool, (n,), or None
        Rows in which an adhesive contact has not torn off yet; None where the law says it.
    """

    clock: FloatArray
    load: FloatArray
    displacement: FloatArray
    smooth_displacement: FloatArray
    area: FloatArray
    with_area: BoolArray
    poisson_ratio: float
    attached: BoolArray | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class JointFit(Displayed):
    """A law fitted to a record, with all that its uncertainty follows from.

    Attributes
    ----------
    law : str
        Key of `LAWS`.
    fit : LeastSquaresFit
        The free parameters.
    held : mapping of str to Estimate
        Parameters given from elsewhere, whose uncertainty is carried on.
    prior : mapping of str to Estimate
        Free parameters that were also measured elsewhere: one datum each.
    noise, noise_uncertainty : Noise, NoiseUncertainty
        Of the record.
    covariance : ndarray, (p, p)
        Of the free parameters, with drifting noise and with the uncertainty of the noise itself.
    record : FitData
        What was fitted.
    response : mapping of str to ndarray
        Derivative of the free parameters by each held one that is uncertain.
    """

    law: str
    fit: LeastSquaresFit
    held: Mapping[str, Estimate]
    noise: Noise
    noise_uncertainty: NoiseUncertainty
    covariance: FloatArray
    record: FitData
    response: Mapping[str, FloatArray]
    prior: Mapping[str, Estimate]

    @property
    def values(self) -> dict[str, float]:
        """All parameters, free and held."""
        free = dict(zip(self.fit.names, map(float, self.fit.values), strict=True))
        return {**{name: given.value for name, given in self.held.items()}, **free}

    def load(self, displacement: FloatArray) -> FloatArray:
        """Return the fitted load W (N) at readings of the displacement."""
        return self.fitted_law().load(displacement)

    def corrected_load(self, clock: FloatArray, load: FloatArray) -> FloatArray:
        """Return measured forces with zero and tilt removed, N."""
        return self.fitted_law().corrected_load(clock, load)

    def fitted_law(self) -> FittedForceModel:
        """Return the law with its values alone."""
        return FittedForceModel(
            law=self.law, values=self.values, poisson_ratio=self.record.poisson_ratio, aicc=self.aicc
        )

    def simulated(self, rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
        """Return displacement and force of one more record like this, with new noise."""
        record, noise = self.record, self.noise
        load = self.load(record.smooth_displacement) + force_zero(self.values, record.clock)
        load = load + noise.force_std * rng.standard_normal(load.size)
        if noise.drift:
            load = load + noise.drift.simulated(rng)
        displacement = record.smooth_displacement + noise.displacement_std * rng.standard_normal(load.size)
        return displacement, load

    @property
    def aicc(self) -> float:
        """Corrected Akaike criterion, as `FittedForceModel` has it."""
        n = self.record.load.size + self.record.area.size + len(self.prior)
        k = self.fit.values.size
        return self.fit.sum_of_squares + 2 * k + 2 * k * (k + 1) / (n - k - 1) if n > k + 1 else math.inf

    @property
    def _jacobians(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        derivatives = _jacobians(self.record, self.law, list(self.fit.names), self.values)
        return *derivatives, _information(self.fit.names, self.prior)

    def residuals(self) -> tuple[FloatArray, FloatArray]:
        """Return the residuals of force (N) and area (mm²)."""
        return _residuals(self.record, self.law, self.values)

    def areas(self) -> FloatArray:
        """Return the measured areas, mm², from their fitted zero and without their delay."""
        values = {**self.values, "area_delay": 0.0, "area_offset": 0.0}
        return self.record.area + self.residuals()[1] - _residuals(self.record, self.law, values)[1]

    def estimator(self) -> tuple[FloatArray, FloatArray]:
        """Return how each free parameter falls with each residual of force and area, (n, p) and (m, p)."""
        return self.noise.estimator(*self._jacobians)

    def estimate(self, name: str) -> Estimate:
        """Return one parameter with a 95 % interval: its profile, widened by noise and by what is held."""
        if name in self.held:
            return self.held[name]
        own = self.fit.estimate(name)
        whole = self.combined(own.value, {name: 1.0})
        stretch = (whole.upper - whole.value) / Estimate.symmetric(
            0.0, own.std, self.fit.degrees_of_freedom
        ).upper
        return replace(own.stretched(stretch), std=whole.std)

    def combined(self, value: float, gradient: Values) -> Estimate:
        """Return a function of the parameters from its gradient, to first order (GUM Eq. 13 and G.4)."""
        slope = np.array([gradient.get(name, 0.0) for name in self.fit.names])
        freedom = self.noise_uncertainty.degrees_of_freedom(self.noise, self._jacobians, slope)
        own = Estimate.symmetric(value, math.sqrt(float(slope @ self.covariance @ slope)), freedom)
        shifts = [
            (gradient.get(key, 0.0) + float(slope @ change)) * self.held[key].std
            for key, change in self.response.items()
        ]
        return own.with_error(math.hypot(*shifts))


def fit_joint(
    record: FitData,
    law: str,
    start: Values,
    held: Mapping[str, Estimate],
    noise: Noise | None = None,
    *,
    prior: Mapping[str, Estimate] = MappingProxyType({}),
) -> JointFit:
    """Fit a law to a record; the noise is found from the residuals unless it is given.

    Noise of the displacement is carried to force and area by the slopes (effective variance), which makes
    their residuals correlate; all deviations are those of greatest restricted likelihood.
    """
    if noise is None:
        noise, start = find_noise(record, law, start, held, prior=prior)
    return _fit(record, law, start, held, noise, prior=prior)


def find_noise(
    record: FitData,
    law: str,
    start: Values,
    held: Mapping[str, Estimate],
    *,
    prior: Mapping[str, Estimate] = MappingProxyType({}),
) -> tuple[Noise, dict[str, float]]:
    """Return the noise of a record about a law, and the parameters that fit it nearly."""
    names = [name for name in start if name not in held]
    whole = {**start, **{name: given.value for name, given in held.items()}}
    noise = _first_noise(record, law, whole)
    for kinds in (("white",), KINDS, None):
        noise = replace(
            noise, slope=_slope(record, law, whole), radius=_area_slope(record, law, whole) / math.pi
        )
        jacobians = *_jacobians(record, law, names, whole), _information(names, prior)
        found = (noise.kind if noise.drift_std > 0 else "white",)
        noise = estimate_noise(noise, _residuals(record, law, whole), jacobians, kinds or found)
        if kinds:
            _, residuals = _scaled_residuals(record, law, whole, held, noise, prior=prior)
            begin = [whole[name] for name in names]
            found_values = minimum(residuals, begin, names, bounds=_bounds(law, names))
            whole |= zip(names, found_values.tolist(), strict=True)
    return noise, whole


def sum_of_squares(record: FitData, law: str, values: Values) -> float:
    """Return that of all residuals over the range of their data, infinite where undefined, for a start."""
    parts = zip(_residuals(record, law, values), (record.load, record.area), strict=True)
    total = sum(float(np.sum((rest / np.ptp(data)) ** 2)) for rest, data in parts if rest.size)
    return total if math.isfinite(total) else math.inf


def _residuals(record: FitData, law: str, values: Values) -> tuple[FloatArray, FloatArray]:
    nu = values.get("poisson_ratio", record.poisson_ratio)
    xi = indentation_of(values, law, record.displacement, nu, record.attached)
    load = load_on(values, law, xi, nu, record.attached)
    force = record.load - load - force_zero(values, record.clock)
    return force, record.area - _area(record, law, values, xi[record.with_area])


def _area(record: FitData, law: str, values: Values, xi: FloatArray) -> FloatArray:
    """Return the areas at indentations ξ of the rows that have one."""
    delay = values.get("area_delay", 0.0)
    if delay != 0:
        before = np.interp(record.clock - delay, record.clock, record.smooth_displacement)
        xi = xi - (record.smooth_displacement - before)[record.with_area]
    nu = values.get("poisson_ratio", record.poisson_ratio)
    area = values.get("area_gain", 1.0) * area_at(values, law, xi, nu)
    if "area_growth" in values and xi.size:
        middle = max(0.5 * float(xi.max()), 1e-9)
        growth = float(np.clip(values["area_growth"], -0.95, 5.0))
        area = area * np.maximum(xi / middle, 1e-6) ** growth
    if "area_edge" in values:
        area = area + 2 * values["area_edge"] * np.sqrt(np.pi * np.maximum(area, 0.0))
    return np.asarray(area + values.get("area_offset", 0.0))


def _scaled_residuals(
    record: FitData,
    law: str,
    start: Values,
    held: Mapping[str, Estimate],
    noise: Noise,
    *,
    prior: Mapping[str, Estimate],
) -> tuple[list[str], Residuals]:
    """Return the free parameters, and the residuals over their spread as a function of these."""
    names = [name for name in start if name not in held]
    given = {name: estimate.value for name, estimate in held.items()}
    scaled = noise.scaling()

    def residuals(free: FloatArray) -> FloatArray:
        force, area = _residuals(record, law, {**given, **dict(zip(names, free.tolist(), strict=True))})
        known = [(free[names.index(name)] - one.value) / one.std for name, one in prior.items()]
        return np.append(scaled(force[:, None], area[:, None])[:, 0], known)

    return names, residuals


def _fit(
    record: FitData,
    law: str,
    start: Values,
    held: Mapping[str, Estimate],
    noise: Noise,
    *,
    prior: Mapping[str, Estimate],
) -> JointFit:
    given = {name: estimate.value for name, estimate in held.items()}
    names, residuals = _scaled_residuals(record, law, start, held, noise, prior=prior)
    # A law that does not suit the record can have its minimum at infinity.
    begin = [start[name] for name in names]
    fit = fit_least_squares(residuals, begin, names, evaluations=300, bounds=_bounds(law, names))
    response: dict[str, FloatArray] = {}
    for name, estimate in held.items():
        if not estimate.std > 0:
            continue
        step = 1e-4 * max(abs(estimate.value), estimate.std) or 1e-6
        moved = [
            _scaled_residuals(
                record, law, start, {**held, name: replace(estimate, value=value)}, noise, prior=prior
            )[1](fit.values)
            for value in (estimate.value + step, estimate.value - step)
        ]
        change = (moved[0] - moved[1]) / (2 * step)
        response[name] = as_float_array(-np.linalg.lstsq(fit.jacobian, change)[0])
    whole = {**given, **dict(zip(names, map(float, fit.values), strict=True))}
    known = _information(fit.names, prior)
    jacobians = *_jacobians(record, law, names, whole), known
    of_noise = noise_uncertainty(noise, _residuals(record, law, whole), jacobians)
    inverse = noise.inverse_information(*jacobians)
    return JointFit(
        law=law,
        fit=fit,
        held=held,
        noise=noise,
        noise_uncertainty=of_noise,
        covariance=of_noise.parameter_covariance(noise, jacobians) + inverse @ known @ inverse,
        record=record,
        response=response,
        prior=prior,
    )


def _information(names: Sequence[str], prior: Mapping[str, Estimate]) -> FloatArray:
    """Return the information on the free parameters that a prior is, (p, p)."""
    return np.diag([(1 / prior[name].std if name in prior else 0.0) ** 2 for name in names])


def _slope(record: FitData, law: str, values: Values) -> FloatArray:
    """Return dW/dξ of the rows, zero before contact."""
    floor = pull_off_of(values, law, record.poisson_ratio)
    xi = np.maximum(record.smooth_displacement - values["contact_offset"], floor)
    slope = slope_at(values, law, xi, record.poisson_ratio)
    if record.attached is None:
        return slope
    # Next to the pull-off it has no end, and one row would say how large the noise of the displacement is.
    steepest = float(np.abs(slope[xi > 0]).max(initial=0.0)) or float(np.abs(slope).min())
    return np.where(record.attached, np.clip(slope, -steepest, steepest), 0.0)


def _area_slope(record: FitData, law: str, values: Values) -> float:
    """Return dA/dξ, in the mean over the areas where they are not π R ξ."""
    if not record.area.size or (PAD_FORM[0] not in values and LAWS[law].area is None):
        return math.pi * values["loading_radius"]
    xi = record.smooth_displacement[record.with_area] - values["contact_offset"]
    return float(np.ptp(_area(record, law, values, xi)) / np.ptp(xi))


def _bounds(law: str, names: Sequence[str]) -> Bounds | None:
    """Return the bounds of parameters, None for a law without any."""
    if not LAWS[law].is_bounded:
        return None
    ends = [LAWS[law].parameters.get(name, (-math.inf, math.inf)) for name in names]
    return np.array([low for low, _ in ends]), np.array([high for _, high in ends])


def _first_noise(record: FitData, law: str, values: Values) -> Noise:
    """Return deviations to begin a search with."""
    force, area = _residuals(record, law, values)
    slope, spread = _slope(record, law, values), float(np.std(force)) or 1e-12
    return Noise(
        force_std=0.7 * spread,
        displacement_std=0.3 * spread / max(float(slope.max()), 1e-12),
        area_std=0.9 * (float(np.std(area)) or 1e-12) if area.size else 1.0,
        drift_std=0.0,
        drift_time=5 * float(np.median(np.diff(record.clock))) or 1.0,
        slope=slope,
        radius=_area_slope(record, law, values) / math.pi,
        steps=np.diff(record.clock),
        with_area=record.with_area,
    )


def _jacobians(record: FitData, law: str, names: list[str], values: Values) -> tuple[FloatArray, FloatArray]:
    """Return derivatives of the residuals of force and of area, where the smooth displacement is."""
    record = replace(record, displacement=record.smooth_displacement)
    force, area = [], []
    for name in names:
        step = 1e-5 * (abs(values[name]) or 1.0)
        up, down = (_residuals(record, law, {**values, name: values[name] + way * step}) for way in (1, -1))
        force.append((up[0] - down[0]) / (2 * step))
        area.append((up[1] - down[1]) / (2 * step))
    return np.stack(force, -1), np.stack(area, -1)


def bounded(estimate: Estimate) -> Estimate:
    """Return an estimate whose interval has both ends, or say that the curve does not bound it."""
    if math.isfinite(estimate.lower) and math.isfinite(estimate.upper):
        return estimate
    return Estimate.unknown(
        f"the curve does not bound it: {estimate.value:.3g} is best, but far from certain"
    )
