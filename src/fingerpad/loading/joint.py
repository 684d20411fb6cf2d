"""Force, displacement and area of a pressed pad in one fit, with the noise of all three.

Every row has F = W(ξ) + zero + tilt · t and A = π R ξ with ξ = displacement − offset; before contact W = 0.
The zero of the force, its drift and the place of contact are parameters like the moduli, so that their
uncertainty is in every result.
"""

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np
from scipy import linalg

from fingerpad._arrays import BoolArray, FloatArray, as_float_array
from fingerpad._display import Displayed
from fingerpad.contact.contact import AnyPlacement
from fingerpad.contact.fast_laws import plate_gap
from fingerpad.estimate import Estimate
from fingerpad.exceptions import FingerpadError, FitError, LoadingError
from fingerpad.geometry.gap import Gap
from fingerpad.loading.contact_point import BOTH_REVERSED, both_reversed, contact_rise, fit_contact_start
from fingerpad.loading.curve import (
    Cycle,
    LoadingCurve,
    choose_cycle,
    clipped_areas,
    moving_average,
    rows_with_area,
    saturated_rows,
)
from fingerpad.loading.law_registry import LAWS, PAD_FORM, Values
from fingerpad.loading.laws import (
    AppliedLaw,
    FittedForceModel,
    hertz_stiffness,
)
from fingerpad.loading.least_squares import (
    Bounds,
    LeastSquaresFit,
    Linear,
    Residuals,
    differences,
    fit_least_squares,
    minimum,
)
from fingerpad.loading.noise import KINDS, Noise, NoiseUncertainty, estimate_noise, noise_uncertainty

# Rows before contact from which a zero, and a drift, can be estimated: with fewer the model says them.
_ZERO_ROWS, _TILT_ROWS = 2, 4
# Standard deviation of a drift that no baseline shows, as a share of the load over the record.
_DRIFT = 0.03
_CONTACT_DEVIATIONS = 5.0
_MIN_LOADING = 5
# Of a longer record a fit uses means of neighbouring rows: more say no more of any parameter.
_MOST_ROWS = 4000
# Parameters in which the residuals are linear.
_ZEROS: Final = frozenset({"force_zero", "force_tilt", "area_offset"})
# Of a layer that is stated, mm: beyond, the unit is wrong, or it is a half-space.
THICKEST_LAYER: Final = 200.0
NO_AREA = "no contact area in the curve"
NO_RADIUS = f"{NO_AREA}, so its radius is not known: give a column area_mm2, or loading_radius"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class FitData(Displayed):
    """The n rows of one press that a fit uses, baseline and loading; m of them have an area."""

    clock: FloatArray
    load: FloatArray
    displacement: FloatArray
    smooth_displacement: FloatArray  # without most of its noise, for slopes
    area: FloatArray  # (m,), mm²
    with_area: BoolArray  # (n,)
    poisson_ratio: float
    attached: BoolArray | None = None  # rows before an adhesive contact tears off; None where the law says it
    tilt_std: float = math.inf  # N/s, of a drift of the force's zero as far as it is known beforehand
    together: int = 1  # rows of the record of which each is the mean

    def averaged(self) -> "FitData":
        """Return means of neighbouring rows where there are too many, and of those areas that they have."""
        together = -(-self.load.size // _MOST_ROWS)
        if together == 1:
            return self
        starts = np.arange(0, self.load.size, together)

        def sums(values: FloatArray) -> FloatArray:
            return np.asarray(np.add.reduceat(values, starts))

        counts, areas = sums(np.ones(self.load.size)), np.zeros(self.load.size)
        areas[self.with_area] = self.area
        with_area = sums(self.with_area.astype(float))
        return replace(
            self,
            clock=sums(self.clock) / counts,
            load=sums(self.load) / counts,
            displacement=sums(self.displacement) / counts,
            smooth_displacement=sums(self.smooth_displacement) / counts,
            area=sums(areas)[with_area > 0] / with_area[with_area > 0],
            with_area=with_area > 0,
            together=together,
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Prior:
    """Free parameters that were also measured elsewhere: a datum each, and the covariance of their errors."""

    values: Mapping[str, float]
    covariance: FloatArray

    @property
    def weights(self) -> FloatArray:
        """What makes of the errors of its values independent standard deviations."""
        return np.linalg.inv(np.linalg.cholesky(self.covariance))

    def information(self, names: Sequence[str]) -> FloatArray:
        """Return the information that it is on the free parameters, (p, p)."""
        found = np.zeros((len(names), len(names)))
        places = [names.index(name) for name in self.values]
        found[np.ix_(places, places)] = np.linalg.inv(self.covariance)
        return found

    def with_tilt(self, std: float, names: Collection[str]) -> "Prior":
        """Return what else is known where the drift of the force's zero is one of the parameters."""
        if "force_tilt" not in names or std == math.inf:
            return self
        covariance = linalg.block_diag(self.covariance, std**2)
        return Prior(values={**self.values, "force_tilt": 0.0}, covariance=covariance)


NO_PRIOR: Final = Prior(values={}, covariance=np.empty((0, 0)))


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class JointFit(Displayed):
    """A law of `LAWS` fitted to a record, with all that its uncertainty follows from."""

    law: str
    fit: LeastSquaresFit  # of the p free parameters
    held: Mapping[str, Estimate]  # given from elsewhere; their uncertainty is carried on
    noise: Noise
    noise_uncertainty: NoiseUncertainty
    covariance: FloatArray  # (p, p), with drifting noise and with the uncertainty of the noise itself
    record: FitData
    jacobians: tuple[FloatArray, FloatArray, FloatArray]  # of force and area, and the prior's information
    response: Mapping[str, FloatArray]  # derivatives (p,) by each held parameter that is uncertain
    prior: Prior

    @property
    def values(self) -> dict[str, float]:
        """All parameters, free and held."""
        free = dict(zip(self.fit.names, map(float, self.fit.values), strict=True))
        return {**{name: given.value for name, given in self.held.items()}, **free}

    @property
    def depth(self) -> float:
        """Way of the platen from contact on, mm."""
        return float(self.record.smooth_displacement.max()) - self.values["contact_offset"]

    @property
    def top_load(self) -> float:
        """Fitted load at the largest displacement, N."""
        return float(self.load(np.array([self.record.smooth_displacement.max()]))[0])

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
        load = self.load(record.smooth_displacement) + self.fitted_law().force_zero(record.clock)
        load = load + noise.force_std * rng.standard_normal(load.size)
        if noise.drift:
            load = load + noise.drift.simulated(rng)
        displacement = record.smooth_displacement + noise.displacement_std * rng.standard_normal(load.size)
        return displacement, load

    @property
    def aicc(self) -> float:
        """Corrected Akaike criterion, as `FittedForceModel` has it."""
        n = self.record.load.size + self.record.area.size + len(self.prior.values)
        k = self.fit.values.size
        return self.fit.sum_of_squares + 2 * k + 2 * k * (k + 1) / (n - k - 1) if n > k + 1 else math.inf

    @cached_property
    def _moved_covariances(self) -> FloatArray:
        return self.noise_uncertainty.moved_covariances(self.noise, self.jacobians)

    def residuals(self) -> tuple[FloatArray, FloatArray]:
        """Return the residuals of force (N) and area (mm²)."""
        return _residuals(self.record, self.law, self.values)

    def areas(self) -> FloatArray:
        """Return the measured areas, mm², from their fitted zero and without their delay."""
        values = {**self.values, "area_delay": 0.0, "area_offset": 0.0}
        return self.record.area + self.residuals()[1] - _residuals(self.record, self.law, values)[1]

    def estimator(self) -> tuple[FloatArray, FloatArray]:
        """Return how each free parameter falls with each residual of force and area, (n, p) and (m, p)."""
        return self.noise.estimator(*self.jacobians)

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
        freedom = self.noise_uncertainty.degrees_of_freedom(self._moved_covariances, slope)
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
    prior: Prior = NO_PRIOR,
) -> JointFit:
    """Fit a law to a record; the noise is found from the residuals unless it is given.

    Noise of the displacement is carried to force and area by the slopes (effective variance), which makes
    their residuals correlate; all deviations are those of greatest restricted likelihood.
    """
    if noise is None:
        noise, start = find_noise(record, law, start, held, prior=prior)
    model = _Model.of(record, law, start, held, prior)
    names, (residuals, linear) = model.names, model.scaled_residuals(noise)
    # A law that does not suit the record can have its minimum at infinity.
    fit = fit_least_squares(
        residuals,
        [start[name] for name in names],
        names,
        evaluations=300,
        bounds=model.bounds,
        linear=linear,
    )
    response: dict[str, FloatArray] = {}
    for name, one in held.items():
        if one.std > 0:
            step = 1e-4 * max(abs(one.value), one.std) or 1e-6
            moved = (model.with_given(name, one.value + way * step) for way in (1, -1))
            up, down = (each.scaled_residuals(noise)[0](fit.values) for each in moved)
            change = (up - down) / (2 * step)
            response[name] = as_float_array(-np.linalg.lstsq(fit.jacobian, change)[0])
    whole = model.values(fit.values)
    jacobians = model.jacobians(whole)
    of_noise = noise_uncertainty(noise, _residuals(record, law, whole), jacobians)
    inverse = noise.inverse_information(*jacobians)
    return JointFit(
        law=law,
        fit=fit,
        held=held,
        noise=noise,
        noise_uncertainty=of_noise,
        covariance=of_noise.parameter_covariance(noise, jacobians) + inverse @ jacobians[-1] @ inverse,
        record=record,
        jacobians=jacobians,
        response=response,
        prior=model.prior,
    )


def find_noise(
    record: FitData,
    law: str,
    start: Values,
    held: Mapping[str, Estimate],
    *,
    prior: Prior = NO_PRIOR,
) -> tuple[Noise, dict[str, float]]:
    """Return the noise of a record about a law, and the parameters that fit it nearly."""
    model = _Model.of(record, law, start, held, prior)
    whole = {**start, **model.given}
    noise = _first_noise(record, law, whole)
    for kinds in (("white",), KINDS, None):
        noise = replace(
            noise, slope=_slope(record, law, whole), radius=_area_slope(record, law, whole) / math.pi
        )
        found = (noise.kind if noise.drift_std > 0 else "white",)
        noise = estimate_noise(noise, _residuals(record, law, whole), model.jacobians(whole), kinds or found)
        if kinds:
            begin = [whole[name] for name in model.names]
            residuals, linear = model.scaled_residuals(noise)
            nearest, _ = minimum(residuals, begin, model.names, bounds=model.bounds, linear=linear)
            whole |= model.values(nearest)
    return noise, whole


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Model:
    """A law on a record as a function of its free parameters; the others are given."""

    record: FitData
    law: str
    names: tuple[str, ...]
    given: Mapping[str, float]
    prior: Prior

    @classmethod
    def of(
        cls, record: FitData, law: str, start: Values, held: Mapping[str, Estimate], prior: Prior
    ) -> "_Model":
        names = tuple(name for name in start if name not in held)
        given = {name: one.value for name, one in held.items()}
        prior = prior.with_tilt(record.tilt_std, names)
        return cls(record=record, law=law, names=names, given=given, prior=prior)

    def with_given(self, name: str, value: float) -> "_Model":
        return replace(self, given={**self.given, name: value})

    def values(self, free: FloatArray) -> dict[str, float]:
        """Return all parameters, free and given."""
        return {**self.given, **dict(zip(self.names, free.tolist(), strict=True))}

    def scaled_residuals(self, noise: Noise) -> tuple[Residuals, Linear]:
        """Return the residuals over their spread by the free parameters, and columns that never change."""
        scaled, known, weights = noise.scaling(), self.prior.values, self.prior.weights
        expected = np.array(list(known.values()))

        def joined(force: FloatArray, area: FloatArray, apart: FloatArray) -> FloatArray:
            return np.concatenate([scaled(force[:, None], area[:, None])[:, 0], weights @ apart])

        def residuals(free: FloatArray) -> FloatArray:
            values = self.values(free)
            apart = np.array([values[name] for name in known]) - expected
            return joined(*_residuals(self.record, self.law, values), apart)

        linear = {}
        for name in _ZEROS.intersection(self.names):
            force = -_applied(self.record, self.law, {name: 1.0}).force_zero(self.record.clock)
            area = np.full_like(self.record.area, -float(name == "area_offset"))
            linear[name] = joined(
                force,
                area,
                np.array([name == each for each in known], dtype=float),
            )
        return residuals, linear

    def jacobians(self, values: Values) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return derivatives of the residuals of force and area, and what is known beforehand, (p, p).

        They are taken where the smooth displacement is.
        """
        smooth = replace(self.record, displacement=self.record.smooth_displacement)
        both = differences(
            lambda each: np.concatenate(_residuals(smooth, self.law, each)), values, self.names
        )
        count = self.record.load.size
        return both[:count], both[count:], self.prior.information(self.names)

    @property
    def bounds(self) -> Bounds | None:
        """Bounds of the free parameters, None for a law without any."""
        if not LAWS[self.law].is_bounded:
            return None
        ends = [LAWS[self.law].parameters.get(name, (-math.inf, math.inf)) for name in self.names]
        return np.array([low for low, _ in ends]), np.array([high for _, high in ends])


def sum_of_squares(record: FitData, law: str, values: Values) -> float:
    """Return that of all residuals over the range of their data, infinite where undefined, for a start."""
    parts = zip(_residuals(record, law, values), (record.load, record.area), strict=True)
    total = sum(float(np.sum((rest / np.ptp(data)) ** 2)) for rest, data in parts if rest.size)
    return total if math.isfinite(total) else math.inf


def _applied(record: FitData, law: str, values: Values) -> AppliedLaw:
    nu = values.get("poisson_ratio", record.poisson_ratio)
    return AppliedLaw(law=law, values=values, poisson_ratio=nu)


def _residuals(record: FitData, law: str, values: Values) -> tuple[FloatArray, FloatArray]:
    at = _applied(record, law, values)
    xi = at.indentation(record.displacement, record.attached)
    force = record.load - at.load_on(xi, record.attached) - at.force_zero(record.clock)
    return force, record.area - _area(record, at, xi[record.with_area])


def _area(record: FitData, at: AppliedLaw, xi: FloatArray) -> FloatArray:
    """Return the areas at indentations ξ of the rows that have one."""
    values = at.values
    delay = values.get("area_delay", 0.0)
    if delay != 0:
        before = np.interp(record.clock - delay, record.clock, record.smooth_displacement)
        xi = xi - (record.smooth_displacement - before)[record.with_area]
    area = values.get("area_gain", 1.0) * at.area_at(xi)
    if "area_growth" in values and xi.size:
        middle = max(0.5 * float(xi.max()), 1e-9)
        growth = float(np.clip(values["area_growth"], -0.95, 5.0))
        area = area * np.maximum(xi / middle, 1e-6) ** growth
    if "area_edge" in values:
        area = area + 2 * values["area_edge"] * np.sqrt(np.pi * np.maximum(area, 0.0))
    return np.asarray(area + values.get("area_offset", 0.0))


def _slope(record: FitData, law: str, values: Values) -> FloatArray:
    """Return dW/dξ of the rows, zero before contact."""
    at = AppliedLaw(law=law, values=values, poisson_ratio=record.poisson_ratio)
    xi = np.maximum(record.smooth_displacement - values["contact_offset"], at.pull_off)
    slope = at.slope_at(xi)
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
    return float(np.ptp(_area(record, _applied(record, law, values), xi)) / np.ptp(xi))


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


def bounded(estimate: Estimate) -> Estimate:
    """Return an estimate whose interval has both ends, or say that the curve does not bound it."""
    if math.isfinite(estimate.lower) and math.isfinite(estimate.upper):
        return estimate
    return Estimate.unknown(
        f"the curve does not bound it: {estimate.value:.3g} is best, but far from certain"
    )


# --- what of a record is fitted, where a search begins, and what is given ---


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Press:
    """Rows to fit, all cycles of the record, how many rows lie before contact, and doubts."""

    record: FitData
    cycles: tuple[Cycle, ...]
    baseline_rows: int
    flags: tuple[str, ...]


@contextmanager
def determined(what: str, hint: str = "") -> Iterator[None]:
    """Raise FitError where the numbers of a fit run out of range or it has no solution."""
    try:
        with np.errstate(all="ignore"):
            yield
    except FingerpadError:
        raise
    except (ArithmeticError, np.linalg.LinAlgError, ValueError) as error:
        raise FitError(f"the record does not determine {what} and its noise ({error}){hint}") from error


def prepare(curve: LoadingCurve, poisson_ratio: float, cycle: int) -> Press:
    """Choose the rows of one press. Raise LoadingError or FitError where there is nothing to fit."""
    cycles, chosen = choose_cycle(curve, cycle)
    begin = chosen.baseline.start if chosen.baseline else chosen.loading.start
    before = chosen.loading.start - begin
    rows = np.arange(begin, chosen.loading.stop)
    full = saturated_rows(curve, chosen.loading)
    repeated = _repeated(curve.load[rows], before)
    rows = rows[~np.append(repeated, full)]
    smooth = moving_average(curve.indentation[begin : chosen.loading.stop])[rows - begin]
    clipped = clipped_areas(curve, chosen)
    with_area = np.isin(rows, rows_with_area(curve, chosen))
    record = FitData(
        clock=curve.clock[rows] - curve.clock[rows[0]],
        load=np.asarray(curve.load, dtype=np.float64)[rows],
        displacement=np.asarray(curve.indentation, dtype=np.float64)[rows],
        smooth_displacement=smooth,
        area=np.zeros(0) if curve.area is None else np.asarray(curve.area, dtype=np.float64)[rows][with_area],
        with_area=with_area,
        poisson_ratio=poisson_ratio,
        tilt_std=_DRIFT * float(np.ptp(curve.load[rows]) / np.ptp(curve.clock[rows])),
    ).averaged()
    _require_contact(record)
    loaded = np.count_nonzero(~full)
    if loaded < _MIN_LOADING:
        raise FitError(
            f"{loaded} rows in contact while the load grows (saturated ones left out); at least "
            f"{_MIN_LOADING} are needed"
        )
    doubts = {
        "no_baseline": before < _ZERO_ROWS,
        "tilt_unknown": _ZERO_ROWS <= before < _TILT_ROWS,
        "rounded_force": bool(repeated.any()),
        "saturated_force": bool(full.any()),
        "clipped_area": clipped.size > 0,
    }
    flags = (*(name for name, seen in doubts.items() if seen), *curve.doubts)
    return Press(record=record, cycles=cycles, baseline_rows=before, flags=flags)


def _repeated(load: FloatArray, before: int) -> BoolArray:
    """Return which rows before contact repeat a reading, where most of them do, and some in contact.

    A force that is rounded by more than its noise is wrong in all of them by the same: they are one reading.
    """
    same = np.append(False, np.diff(load) == 0)
    rounded = np.count_nonzero(same[:before]) > before / 2 and same[before:].any()
    return same[:before] & rounded


def start_values(press: Press, radius: float | None) -> dict[str, float]:
    """Return where a search of the law with a growing modulus may begin; its names are the fitted parameters.

    `radius` (mm) is used where it is given.
    """
    record = press.record
    tilt = press.baseline_rows >= _TILT_ROWS
    place, parts = fit_contact_start(record.clock, record.load, record.smooth_displacement, tilt=tilt)
    linear, square = parts[-2:]
    top = float(np.maximum(record.smooth_displacement - place, 0).max()) ** 1.5
    if not linear > 0:
        linear, square = linear + square * top, 0.0
    growth = float(np.clip(square / linear, -0.5 / top, 0.6 / top))
    if radius is None:
        depth = record.smooth_displacement[record.with_area] - place
        radius = float(record.area @ depth) / float(np.pi * depth @ depth)
        if not radius > 0:
            raise LoadingError("contact area falls as the pad is pressed: is the sign of a column reversed?")
    stiffness = hertz_stiffness(radius, record.poisson_ratio)
    return {
        "contact_offset": place,
        "initial_modulus": float(linear) / stiffness,
        "load_coefficient": growth / stiffness,
        "loading_radius": radius,
        "force_zero": float(parts[0]),
        "force_tilt": float(parts[1]) if tilt else 0.0,
    }


def fixed_quantities(press: Press, loading_radius: float | Estimate | None) -> dict[str, Estimate]:
    """Return what is not fitted. Without area the radius is held at 1 mm: the place of contact needs none."""
    if loading_radius is None:
        return {} if press.record.area.size else {"loading_radius": Estimate.symmetric(1.0, 0.0)}
    given = loading_radius
    radius = given if isinstance(given, Estimate) else Estimate.symmetric(given, 0.0)
    if not (radius.value > 0 and math.isfinite(radius.value)):
        raise LoadingError(f"loading_radius must be positive and finite, found {radius.value} mm")
    return {"loading_radius": radius}


def known_quantities(
    curve: LoadingCurve,
    *,
    stage_compliance: float | Estimate | None = None,
    area_delay: float | Estimate | None = None,
    thickness: float | Estimate | None = None,
    area_relative_std: float = 0.0,
) -> dict[str, Estimate]:
    """Return what is known of the instrument that recorded a curve, and of the layer that it pressed."""
    check_std("area_relative_std", area_relative_std)
    given = {"stage_compliance": stage_compliance, "area_delay": area_delay, "thickness": thickness}
    found = {
        name: value if isinstance(value, Estimate) else Estimate.symmetric(value, 0.0)
        for name, value in given.items()
        if value is not None
    }
    for name, one in found.items():
        endless = name == "thickness" and one.value == math.inf and one.std == 0
        if not (endless or (math.isfinite(one.value) and 0 <= one.std < math.inf)):
            unless = " (a half-space: inf, without uncertainty)" if name == "thickness" else ""
            raise LoadingError(f"{name} must be finite{unless}, found {one.value} ± {one.std}")
    if "stage_compliance" in found and found["stage_compliance"].value < 0:
        raise LoadingError(f"stage_compliance must not be negative, found {found['stage_compliance'].value}")
    if "area_delay" in found and curve.time is None:
        raise LoadingError("area_delay is a time, and the curve has none: add its column of time")
    _require_of_curve(curve, found)
    if "thickness" in found:
        layer = found.pop("thickness")
        if not layer.value > 0:
            raise LoadingError(f"thickness must be above zero, found {layer.value} mm; inf for no layer")
        inverse = 1 / layer.value
        found["inverse_thickness"] = Estimate.symmetric(inverse, layer.std * inverse**2 if layer.std else 0.0)
    if area_relative_std:
        found["area_gain"] = Estimate.symmetric(1.0, area_relative_std)
    return found


def _require_of_curve(curve: LoadingCurve, given: Mapping[str, Estimate]) -> None:
    """Raise where what is given is in another unit, as the curve shows."""
    names = "area_delay", "stage_compliance", "thickness"
    delay, stage, layer = (given[name].value if name in given else 0.0 for name in names)
    longest = float(np.ptp(curve.clock))
    if abs(delay) > longest > 0:
        raise LoadingError(
            f"area_delay is {delay:g} s, and the whole record lasts {longest:.3g} s: give it in seconds, "
            f"{delay / 1000:g} for {delay:g} ms"
        )
    yields, travel = stage * float(np.ptp(curve.load)), float(np.ptp(curve.indentation))
    if yields > travel > 0:
        raise LoadingError(
            f"a stage_compliance of {stage:g} mm/N is {yields:.3g} mm under this load, and the platen moves "
            f"by {travel:.3g} mm: give it in mm/N, {stage / 1000:g} for {stage:g} µm/N"
        )
    if THICKEST_LAYER < layer < math.inf:
        raise LoadingError(
            f"thickness is {layer:g} mm, more than {THICKEST_LAYER:g}: give it in mm, {layer / 1000:g} for "
            f"{layer:g} µm, or inf for a half-space"
        )


def check_std(name: str, std: float) -> None:
    """Raise LoadingError for a standard uncertainty that is none."""
    if not 0 <= std < math.inf:
        raise LoadingError(f"{name} must be finite and not negative, found {std}")


def one_pad(placement: AnyPlacement) -> Gap:
    """Return the gap between one pad and a flat plate; raise LoadingError for several, or one not convex."""
    if placement.shape:
        raise LoadingError(f"a curve is that of one pad, found placements of shape {placement.shape}")
    gap = plate_gap(placement)
    first, second = float(gap.first_radius), float(gap.second_radius)
    if not (first > 0 and second > 0 and math.isfinite(first + second)):
        raise LoadingError(f"the radii of curvature must be positive, found {first} and {second} mm")
    return gap


def _require_contact(record: FitData) -> None:
    """Raise where the force does not rise out of its noise as the platen moves in, or falls."""
    rise, rest = contact_rise(record.clock, record.load, record.smooth_displacement)
    noise = float(np.std(rest))
    size = float(rise[np.argmax(np.abs(rise))])
    if both_reversed(record.clock, record.load, record.smooth_displacement):
        raise LoadingError(BOTH_REVERSED)
    if not abs(size) > _CONTACT_DEVIATIONS * noise:
        raise FitError(
            f"no contact in the record: the force changes by {abs(size):.3g} N while the platen moves in, "
            f"against noise of {noise:.3g} N"
        )
    if size < 0:
        raise LoadingError(
            "the force falls as the displacement grows: the sign of one is reversed; compression is "
            "positive, and displacement grows into the pad"
        )
