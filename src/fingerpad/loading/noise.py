r"""Noise of force, displacement and area in a loading curve, and its correlations.

With :math:`e` the noise of displacement, :math:`s = dW/d\xi` and :math:`g = \pi R_g`, the residuals are
:math:`r_F = f + w + s e` and :math:`r_A = a - g e`: noise of the displacement enters both (effective
variance). The force has white noise w and drift f. Given :math:`r_A`, the force's residuals have a covariance
of white noise and drift.

The drift is a sum of processes that forget exponentially, at a cost linear in the rows. One of them is an
Ornstein–Uhlenbeck process. Several of equal variance, with correlation times in even ratios, have a power
spectrum of 1/f from the shortest time to the longest. With :math:`P` the precision of all of them in all
rows, which is banded, H their sum, and D white noise, the covariance :math:`V = D + H P^{-1} H^{\mathsf T}`
has :math:`V^{-1} = D^{-1} - D^{-1} H (P + H^{\mathsf T} D^{-1} H)^{-1} H^{\mathsf T} D^{-1}`.
"""

import math
import operator
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Any, Final, Self

import numpy as np
from scipy import linalg, optimize

from fingerpad._arrays import BoolArray, FloatArray, as_float_array
from fingerpad._display import Displayed

# Its derivatives come from differences: by smaller steps rounding decides where the search ends.
_STEP: Final = 1e-4
_SEARCH: Final[Any] = {"ftol": 1e-12, "gtol": 1e-5}
_WHITE: Final = ("force_std", "displacement_std", "area_std")
_DRIFT: Final = ("drift_std", "drift_time")
_LOG_STEP = 0.1
KINDS: Final = ("white", "exponential", "long_range", "random_walk")
# Of kinds of drift that are as likely within this, in logarithms, that of the greatest uncertainty is taken.
_MARGIN = 2.0
# Ratio of correlation times: the spectrum then departs from 1/f by some per cent.
_RATIO = 10.0
# A random walk is a process whose correlation time is so many records.
_FORGOTTEN = 10.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Drift(Displayed):
    """Slow noise of n rows: k processes of standard deviations `stds` (N) and correlation times `times`."""

    stds: FloatArray
    times: FloatArray
    steps: FloatArray

    @classmethod
    def of(cls, kind: str, std: float, time: float, steps: FloatArray) -> Self:
        """Return the slow noise of a kind, of a standard deviation (N) over the record.

        ``exponential`` forgets within `time`, a ``random_walk`` moves by `std` and forgets nothing, and
        ``long_range`` is 1/f noise from the rows' own rate to the record's.
        """
        whole, count = float(steps.sum()), 1
        if kind == "long_range":
            shortest = float(np.median(steps))
            count = 1 + math.ceil(math.log(whole / shortest, _RATIO))
            time = shortest
        elif kind == "random_walk":
            std, time = std * math.sqrt(_FORGOTTEN / 2), _FORGOTTEN * whole
        times = as_float_array(time * _RATIO ** np.arange(count))
        return cls(stds=np.full(count, std / math.sqrt(count)), times=times, steps=steps)

    @property
    def slow_variance(self) -> float:
        """Return the variance of white noise with the same density at the record's own frequency."""
        step, whole = float(np.median(self.steps)), float(self.steps.sum())
        kept = np.exp(-step / self.times)
        # At one period in two records; without it the density at zero, which 1/f noise has not.
        cosine = math.cos(math.pi * step / whole)
        density = self.stds**2 * -np.expm1(-2 * step / self.times) / (1 - 2 * kept * cosine + kept**2)
        return float(density.sum())

    def covariance_of(self, weights: FloatArray) -> FloatArray:
        """Return the covariance of sums of the rows with weights (n, p), (p, p)."""
        total = np.zeros((weights.shape[1], weights.shape[1]))
        for std, time in zip(self.stds, self.times, strict=True):
            band = np.stack([np.ones(len(weights)), np.append(-np.exp(-self.steps / time), 0.0)])
            passed, _ = linalg.lapack.dtbtrs(band, weights, uplo="L", trans="T", diag="U")
            passed *= std * np.sqrt(np.append(1.0, -np.expm1(-2 * self.steps / time)))[:, None]
            total += passed.T @ passed
        return total

    def information(self, white: FloatArray, columns: FloatArray) -> tuple[FloatArray, float]:
        """Return CᵀV⁻¹C of columns C (n, p), with white noise of these variances added, and ½ log |V|."""
        count = self.times.size
        lost = np.expm1(-self.steps[:, None] / self.times)
        kept, new = 1 + lost, np.empty((len(white), count))
        new[0], new[1:] = self.stds**2, -(self.stds**2) * lost * (2 + lost)
        weights = 1 / white[:, None]
        tied = kept / new[1:]
        band = np.zeros((count + 1, new.size))
        diagonal = band[0].reshape(-1, count)
        diagonal[:] = 1 / new + weights
        diagonal[:-1] += kept * tied
        for apart in range(1, count):
            band[apart].reshape(-1, count)[:, : count - apart] = weights
        band[count, :-count] = -tied.ravel()
        root, _ = linalg.lapack.dpbtrf(band, lower=1, overwrite_ab=1)
        scaled = columns * weights
        solved, _ = linalg.lapack.dtbtrs(root, np.repeat(scaled, count, axis=0), uplo="L")
        volume = (np.log(root[0] ** 2 * new.ravel()).sum() + np.log(white).sum()) / 2
        return columns.T @ scaled - solved.T @ solved, float(volume)

    def simulated(self, rng: np.random.Generator) -> FloatArray:
        """Return one record of it."""
        kept = np.vstack([np.zeros(self.times.size), np.exp(-self.steps[:, None] / self.times)])
        new = self.stds * np.sqrt(1 - kept**2) * rng.standard_normal(kept.shape)
        for row in range(1, len(new)):
            new[row] += kept[row] * new[row - 1]
        return np.asarray(new.sum(axis=1))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Noise(Displayed):
    """Noise of a record of n rows, m of them with an area: white in all columns, and a drift of the force."""

    force_std: float  # N
    displacement_std: float  # mm
    area_std: float  # mm²
    drift_std: float  # N
    drift_time: float  # correlation time, s, or rows
    slope: FloatArray  # dW/dξ, (n,), N/mm
    radius: float  # R_g, mm
    steps: FloatArray  # time from each row to the next, (n − 1,)
    with_area: BoolArray  # (n,)
    kind: str = "exponential"  # or without a time of its own: long_range (1/f), random_walk

    @property
    def drift(self) -> Drift | None:
        """Return the slow noise, None where there is none."""
        if not self.drift_std > 0:
            return None
        return Drift.of(self.kind, self.drift_std, self.drift_time, self.steps)

    def scaling(self) -> Callable[[FloatArray, FloatArray], FloatArray]:
        """Return what divides columns of residuals of force and area by their spread, one below the other.

        Drift counts by its density at low frequency, where the parameters' traces lie. To filter it out
        of the fit would leave differences of neighbouring rows, which noise of the displacement biases.
        """
        force_std, share_of_area, area_std = self._spreads
        places, share = np.flatnonzero(self.with_area), share_of_area[:, None]
        # A slice is added to faster than places are.
        together = places.size and places[-1] - places[0] < places.size
        rows = slice(places[0], places[-1] + 1) if together else places

        def divided(force: FloatArray, area: FloatArray) -> FloatArray:
            both = np.concatenate([force, area])
            if area.size:
                both[rows] += share * area
            both[: len(force)] /= force_std
            both[len(force) :] /= area_std
            return both

        return divided

    @property
    def slow_variance(self) -> float:
        """Return the variance of white noise that is as strong as the drift at low frequency."""
        drift = self.drift
        return drift.slow_variance if drift else 0.0

    def parameter_covariance(
        self, force: FloatArray, area: FloatArray, known: FloatArray | float = 0.0
    ) -> FloatArray:
        """Return what noise adds to the covariance of the weighed fit's parameters."""
        return self.covariance_of(*self.estimator(force, area, known))

    def estimator(
        self, force: FloatArray, area: FloatArray, known: FloatArray | float = 0.0
    ) -> tuple[FloatArray, FloatArray]:
        """Return how each parameter answers to each residual of force and of area, (n, p) and (m, p).

        These are the columns of K J (JᵀKJ + P)⁻¹, with the derivatives J of the residuals, the weights K of
        `scaling`, and the information P that is known of the parameters beforehand, (p, p).
        """
        force_std, share_of_area, area_std = self._spreads
        scaled = self.scaling()(force, area)
        answer = scaled @ _inverse_information(scaled, known)
        by_force, by_area = answer[: len(force)] / force_std, answer[len(force) :] / area_std
        return by_force, by_area + share_of_area[:, None] * by_force[self.with_area][: len(area)]

    def inverse_information(
        self, force: FloatArray, area: FloatArray, known: FloatArray | float = 0.0
    ) -> FloatArray:
        """Return (JᵀKJ + P)⁻¹, as `estimator` has them."""
        return _inverse_information(self.scaling()(force, area), known)

    def covariance_of(self, force: FloatArray, area: FloatArray) -> FloatArray:
        """Return the covariance of sums of residuals of force and area with weights (n, p) and (m, p)."""
        return self.covariance_of_sums(force, area, self.of_displacement(force, area))

    def of_displacement(self, force: FloatArray, area: FloatArray) -> FloatArray:
        """Return the weights of the displacement's noise in such sums."""
        shared = self.slope[:, None] * force
        if area.size:
            shared[self.with_area] -= np.pi * self.radius * area
        return shared

    def covariance_of_sums(self, force: FloatArray, area: FloatArray, shared: FloatArray) -> FloatArray:
        """Return the covariance of sums of the noise of force, area and displacement with these weights."""
        total = self.force_std**2 * force.T @ force + self.area_std**2 * area.T @ area
        total += self.displacement_std**2 * shared.T @ shared
        drift = self.drift
        return np.asarray(total + drift.covariance_of(force) if drift else total)

    def negative_log_likelihood(
        self, force: FloatArray, area: FloatArray, known: FloatArray | float = 0.0
    ) -> float:
        """Return minus the restricted log-likelihood, which allows for what the fit took up (REML).

        The first columns are the residuals, the others their derivatives by the parameters, of which `known`
        is the information beforehand.
        """
        product, volume = self._information(force, area)
        product[1:, 1:] += known
        triangle, fault = linalg.lapack.dpotrf(product[1:, 1:], lower=1)
        if fault:
            return math.inf
        taken, _ = linalg.lapack.dtrtrs(triangle, product[1:, 0], lower=1)
        determined = float(np.log(np.diagonal(triangle)).sum())
        return volume + determined + float(product[0, 0] - taken @ taken) / 2

    @property
    def _parts(self) -> tuple[FloatArray, FloatArray, float]:
        """Variances of the force given the area, weight of each area in its force, and std of the area."""
        shared, g = self.displacement_std**2, np.pi * self.radius
        area_variance = self.area_std**2 + g**2 * shared
        left = np.where(self.with_area, self.area_std**2 / area_variance, 1.0) * shared
        share_of_area = self.slope[self.with_area] * g * shared / area_variance
        return self.force_std**2 + self.slope**2 * left, share_of_area, math.sqrt(area_variance)

    @property
    def _spreads(self) -> tuple[FloatArray, FloatArray, float]:
        """Those parts as `scaling` has them: standard deviations (n, 1) of the force, drift included."""
        white, share_of_area, area_std = self._parts
        return np.sqrt(white + self.slow_variance)[:, None], share_of_area, area_std

    def _given_area(self, force: FloatArray, area: FloatArray, share_of_area: FloatArray) -> FloatArray:
        """Return the force without what its noise shares with the area's."""
        if area.size:
            force, rows = force.copy(), np.flatnonzero(self.with_area)
            force[rows] += share_of_area[:, None] * area
        return force

    def _information(self, force: FloatArray, area: FloatArray) -> tuple[FloatArray, float]:
        """Return CᵀV⁻¹C of columns of both with the covariance V of the noise, and ½ log |V|."""
        white, share_of_area, area_std = self._parts
        force = self._given_area(force, area, share_of_area)
        drift = self.drift
        if drift:
            product, volume = drift.information(white, force)
        else:
            product, volume = force.T @ (force / white[:, None]), 0.5 * float(np.log(white).sum())
        return product + area.T @ area / area_std**2, volume + len(area) * math.log(area_std)


def _inverse_information(scaled: FloatArray, known: FloatArray | float) -> FloatArray:
    length = np.sqrt(np.sum(scaled**2, axis=0) + np.diagonal(known + np.zeros(2 * scaled.shape[1:])))
    whole = (scaled / length).T @ (scaled / length) + known / np.outer(length, length)
    return np.asarray(np.linalg.inv(whole) / np.outer(length, length))


def estimate_noise(
    first: Noise,
    residuals: tuple[FloatArray, FloatArray],
    jacobians: tuple[FloatArray, ...],
    kinds: Iterable[str] = KINDS,
) -> Noise:
    """Return the noise of greatest penalised likelihood among kinds of drift, by Akaike's criterion.

    `first` gives slope, radius, steps and rows with area; its deviations are where the search begins.
    """
    found = []
    for kind in kinds:
        std = 0.0 if kind == "white" else first.drift_std or first.force_std
        start = replace(first, drift_std=std, kind=kind)
        found.append(_maximise_likelihood(start, residuals, jacobians, _names(start, residuals[1])))
    best, criterion = min(found, key=operator.itemgetter(1))
    rivals = [noise for noise, other in found if other < criterion + _MARGIN and noise.drift_std > 0]
    return max(rivals, key=lambda noise: noise.slow_variance) if best.drift_std > 0 else best


def _names(noise: Noise, area: FloatArray) -> tuple[str, ...]:
    """Return which numbers of a noise are estimated."""
    names = _WHITE[: 3 if area.size else 2]
    if not noise.drift_std > 0:
        return names
    return names + _DRIFT if noise.kind == "exponential" else (*names, "drift_std")


def _maximise_likelihood(
    first: Noise,
    residuals: tuple[FloatArray, FloatArray],
    jacobians: tuple[FloatArray, ...],
    names: tuple[str, ...],
) -> tuple[Noise, float]:
    """Return the likeliest noise, and half its Akaike criterion, by which kinds of drift are compared."""
    bounds_by_name = _std_bounds(first, residuals)
    force, area = (np.column_stack(pair) for pair in zip(residuals, jacobians[:2], strict=True))
    bounds = [(math.log(bounds_by_name[name][0]), math.log(bounds_by_name[name][1])) for name in names]
    highest = np.array(bounds)[:, 1]
    start = [
        min(max(math.log(getattr(first, name)), low), high)
        for name, (low, high) in zip(names, bounds, strict=True)
    ]

    def negative_log_likelihood(logs: FloatArray) -> float:
        return _penalised_negative_log_likelihood(_with_logs(first, names, logs), force, area, *jacobians[2:])

    def with_slope(logs: FloatArray) -> tuple[float, FloatArray]:
        value = negative_log_likelihood(logs)
        steps = np.where(logs + _STEP > highest, -_STEP, _STEP)
        moved = logs + np.diag(steps)
        raised = np.array([negative_log_likelihood(one) for one in moved])
        return value, (raised - value) / (np.diagonal(moved) - logs)

    found = optimize.minimize(
        with_slope, np.array(start), jac=True, method="L-BFGS-B", bounds=bounds, options=_SEARCH
    )
    return _with_logs(first, names, found.x), float(found.fun) + len(names)


def _penalised_negative_log_likelihood(noise: Noise, *columns: FloatArray) -> float:
    """Return the negative log-likelihood less log σ of the displacement, which keeps that σ off zero.

    Few rows do not determine it, and its weights and their uncertainty would be those of none (Chung et al.
    2013).
    """
    return noise.negative_log_likelihood(*columns) - math.log(noise.displacement_std)


def _std_bounds(first: Noise, residuals: tuple[FloatArray, FloatArray]) -> dict[str, tuple[float, float]]:
    """Return the least and the largest deviation that residuals can show: below, one is as good as zero."""
    force, area = (float(np.std(part)) if part.size else 1.0 for part in residuals)
    displacement = force / max(float(first.slope.max()), 1e-12)
    usual, whole = float(np.median(first.steps)), float(first.steps.sum())
    tiny = 1e-12
    return {
        "force_std": (0.02 * force + tiny, 3 * force + tiny),
        "displacement_std": (0.02 * displacement + tiny, 3 * displacement + tiny),
        "area_std": (0.02 * area + tiny, 3 * area + tiny),
        "drift_std": (0.02 * force + tiny, 3 * force + tiny),
        "drift_time": (0.5 * usual + tiny, max(0.1 * whole, usual) + tiny),
    }


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class NoiseUncertainty(Displayed):
    """Uncertainty of a noise model: names of its estimated deviations, covariance of their logarithms."""

    names: tuple[str, ...]
    covariance: FloatArray

    def moved_covariances(self, noise: Noise, jacobians: tuple[FloatArray, ...]) -> FloatArray:
        """Return the covariances of the parameters with each deviation larger, then smaller, (k, 2, p, p)."""
        at = np.log([getattr(noise, name) for name in self.names])
        return np.array(
            [
                [
                    _with_logs(noise, self.names, at + way * move).parameter_covariance(*jacobians)
                    for way in (1, -1)
                ]
                for move in _LOG_STEP * np.eye(len(self.names))
            ]
        )

    def degrees_of_freedom(self, moved: FloatArray, gradient: FloatArray) -> float:
        """Return Satterthwaite's 2 v²/Var(v) for the variance v of gᵀp that the noise gives (GUM G.4).

        `moved` are the `moved_covariances`.
        """
        variances = (gradient @ moved @ gradient).tolist()
        slope = np.array([math.log(up) - math.log(down) for up, down in variances]) / (2 * _LOG_STEP)
        return min(max(2 / float(slope @ self.covariance @ slope), 2.0), 1e6)

    def parameter_covariance(self, noise: Noise, jacobians: tuple[FloatArray, ...]) -> FloatArray:
        """Return the covariance of the parameters, with what it costs that their weights are estimated.

        A wrong weight adds the variance Λ = Σ C_ij (∂G/∂θ_i) V (∂G/∂θ_j)ᵀ to parameters p = G y, and the
        deviations found make the plain covariance look smaller by Λ again (Kenward & Roger 1997).
        """
        at = np.log([getattr(noise, name) for name in self.names])
        added = noise.parameter_covariance(*jacobians)
        values, vectors = np.linalg.eigh(self.covariance)
        for move in _LOG_STEP * (vectors * np.sqrt(np.maximum(values, 0.0))).T:
            up, down = (_with_logs(noise, self.names, at + m).estimator(*jacobians) for m in (move, -move))
            changes = [(u - d) / (2 * _LOG_STEP) for u, d in zip(up, down, strict=True)]
            added = added + 2 * noise.covariance_of(*changes)
        return added


def noise_uncertainty(
    noise: Noise, residuals: tuple[FloatArray, FloatArray], jacobians: tuple[FloatArray, ...]
) -> NoiseUncertainty:
    """Return the uncertainty of a noise from the curvature of its penalised likelihood.

    Derivatives of the residuals of force and area may be followed by the information that is known of the
    parameters beforehand.
    """
    names = _names(noise, residuals[1])
    force, area = (np.column_stack(pair) for pair in zip(residuals, jacobians[:2], strict=True))
    at, moves = np.log([getattr(noise, name) for name in names]), _LOG_STEP * np.eye(len(names))

    def negative_log_likelihood(move: FloatArray) -> float:
        return _penalised_negative_log_likelihood(
            _with_logs(noise, names, at + move), force, area, *jacobians[2:]
        )

    middle, single = (
        negative_log_likelihood(0 * at),
        [negative_log_likelihood(m) + negative_log_likelihood(-m) for m in moves],
    )
    curvature = np.diag([s - 2 * middle for s in single])
    for i in range(len(names)):
        for k in range(i):
            pair = negative_log_likelihood(moves[i] + moves[k]) + negative_log_likelihood(
                -moves[i] - moves[k]
            )
            curvature[i, k] = curvature[k, i] = (pair - single[i] - single[k] + 2 * middle) / 2
    values, vectors = np.linalg.eigh(curvature / _LOG_STEP**2)
    # What the data hardly show is held to a factor of a few: it then hardly matters either.
    return NoiseUncertainty(names=names, covariance=(vectors / np.maximum(values, 0.5)) @ vectors.T)


def _with_logs(noise: Noise, names: tuple[str, ...], logs: FloatArray) -> Noise:
    return replace(noise, **dict(zip(names, np.exp(logs).tolist(), strict=True)))
