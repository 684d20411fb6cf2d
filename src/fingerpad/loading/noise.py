r"""Noise of force, displacement and area in a loading curve, and its correlations.

With :math:`e` the noise of displacement, :math:`s = dW/d\xi` and :math:`g = \pi R_g`, the residuals are
:math:`r_F = f + w + s e` and :math:`r_A = a - g e`: noise of the displacement enters both (effective
variance).
The force has white noise w and drift f with exponential correlation in time. Given :math:`r_A`, the
force's residuals have covariance :math:`B^{-1} T B^{-\mathsf T}`, with B the bidiagonal filter that makes f
white and T tridiagonal, so that the cost is linear in the number of rows.
"""

import math
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from scipy import linalg, optimize

from fingerpad._arrays import BoolArray, FloatArray
from fingerpad._display import Displayed

# Gain in log-likelihood from which the two parameters of drifting noise are believed (as by AIC).
_GAIN = 2.0
# A log-likelihood need not be known better than to a few hundredths.
_ENOUGH: Final[Any] = {"ftol": 1e-6, "gtol": 1e-3}
_WHITE: Final = ("force_std", "displacement_std", "area_std")
_DRIFT: Final = ("drift_std", "drift_time")
_LOG_STEP = 0.1


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Noise(Displayed):
    """Noise of a record of n rows, m of them with an area.

    Attributes
    ----------
    force_std, displacement_std, area_std : float
        White noise of one row, N, mm, mm².
    drift_std, drift_time : float
        Standard deviation (N) and correlation time (s, or rows) of the force's drift.
    slope : ndarray, (n,)
        dW/dξ, N/mm.
    radius : float
        R_g, mm.
    steps : ndarray, (n − 1,)
        Time from each row to the next.
    with_area : ndarray of bool, (n,)
        Rows that have an area.
    """

    force_std: float
    displacement_std: float
    area_std: float
    drift_std: float
    drift_time: float
    slope: FloatArray
    radius: float
    steps: FloatArray
    with_area: BoolArray

    def scaled(self, force: FloatArray, area: FloatArray) -> FloatArray:
        """Return columns of residuals divided by their spread, those of the area after those of the force.

        Drift counts by its density at zero frequency, where the parameters' traces lie. To filter it out
        of the fit would leave differences of neighbouring rows, which noise of the displacement biases.
        """
        white, force, area_std = self._decorrelate(force, area)
        return np.concatenate([force / np.sqrt(white + self._slow_variance)[:, None], area / area_std])

    @property
    def _slow_variance(self) -> float:
        step = float(np.median(self.steps)) / self.drift_time
        return self.drift_std**2 * (1 + math.exp(-step)) / -math.expm1(-step)

    @property
    def inflation(self) -> float:
        """Number of rows of the force before contact that carry as much information as one without drift."""
        return (self.force_std**2 + self._slow_variance) / (self.force_std**2 + self.drift_std**2)

    def parameter_covariance(self, force: FloatArray, area: FloatArray) -> FloatArray:
        """Return the covariance of the weighed fit's parameters, from derivatives of the residuals."""
        return self.covariance_of(*self.estimator(force, area))

    def estimator(self, force: FloatArray, area: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return how each parameter answers to each residual of force and of area, (n, p) and (m, p).

        These are the columns of K J (JᵀKJ)⁻¹, with the weights K of `scaled`.
        """
        scaled = self.scaled(force, area)
        length = np.linalg.norm(scaled, axis=0)
        inverse = np.linalg.inv((scaled / length).T @ (scaled / length)) / np.outer(length, length)
        answer = scaled @ inverse
        white, share_of_area, area_std = self._parts
        by_force = answer[: len(force)] / np.sqrt(white + self._slow_variance)[:, None]
        by_area = answer[len(force) :] / area_std
        return by_force, by_area + share_of_area[:, None] * by_force[self.with_area][: len(area)]

    def covariance_of(self, force: FloatArray, area: FloatArray) -> FloatArray:
        """Return the covariance of sums of residuals of force and area with weights (n, p) and (m, p)."""
        shared = self.slope[:, None] * force
        if area.size:
            shared[self.with_area] -= np.pi * self.radius * area
        total = self.force_std**2 * force.T @ force + self.area_std**2 * area.T @ area
        total += self.displacement_std**2 * shared.T @ shared
        if not self.drift_std > 0:
            return np.asarray(total)
        kept = np.exp(-self.steps / self.drift_time)
        band = np.stack([np.ones(len(force)), np.append(-kept, 0.0)])
        passed, _ = linalg.lapack.dtbtrs(band, force, uplo="L", trans="T", diag="U")
        passed *= self.drift_std * np.sqrt(np.append(1.0, 1 - kept**2))[:, None]
        return np.asarray(total + passed.T @ passed)

    def negative_log_likelihood(self, force: FloatArray, area: FloatArray) -> float:
        """Return minus the restricted log-likelihood, which allows for what the fit took up (REML).

        The first columns are the residuals, the others their derivatives by the parameters.
        """
        force, area, volume = self._whiten(force, area)
        product = force.T @ force + area.T @ area
        length = np.sqrt(np.diagonal(product)).copy()
        length[0] = 1.0
        product /= np.outer(length, length)
        try:
            triangle = np.linalg.cholesky(product[1:, 1:])
        except np.linalg.LinAlgError:
            return math.inf
        taken = linalg.solve_triangular(triangle, product[1:, 0], lower=True)
        determined = float(np.log(np.diagonal(triangle) * length[1:]).sum())
        return volume + determined + float(product[0, 0] - taken @ taken) / 2

    @property
    def _parts(self) -> tuple[FloatArray, FloatArray, float]:
        """Variances of the force given the area, weight of each area in its force, and std of the area."""
        shared, g = self.displacement_std**2, np.pi * self.radius
        area_variance = self.area_std**2 + g**2 * shared
        left = np.where(self.with_area, self.area_std**2 / area_variance, 1.0) * shared
        share_of_area = self.slope[self.with_area] * g * shared / area_variance
        return self.force_std**2 + self.slope**2 * left, share_of_area, math.sqrt(area_variance)

    def _decorrelate(self, force: FloatArray, area: FloatArray) -> tuple[FloatArray, FloatArray, float]:
        """Return variances of the force given the area, the force decorrelated, the area's std."""
        white, share_of_area, area_std = self._parts
        if area.size:
            force = force.copy()
            force[self.with_area] += share_of_area[:, None] * area
        return white, force, area_std

    def _whiten(self, force: FloatArray, area: FloatArray) -> tuple[FloatArray, FloatArray, float]:
        """Return both as independent ones of unit variance, and half the log of their determinant."""
        white, force, area_std = self._decorrelate(force, area)
        volume = len(area) * math.log(area_std)
        if not self.drift_std > 0:
            volume += 0.5 * float(np.log(white).sum())
            return force / np.sqrt(white)[:, None], area / area_std, volume
        kept = np.exp(-self.steps / self.drift_time)
        diagonal = np.append(1.0, 1 - kept**2) * self.drift_std**2 + white
        diagonal[1:] += kept**2 * white[:-1]
        pivots, below, _ = linalg.lapack.dpttrf(diagonal, -kept * white[:-1])
        filtered = force.copy()
        filtered[1:] -= kept[:, None] * force[:-1]
        band = np.stack([np.ones_like(pivots), np.append(below, 0.0)])
        solved, _ = linalg.lapack.dtbtrs(band, filtered, uplo="L", diag="U")
        return solved / np.sqrt(pivots)[:, None], area / area_std, volume + 0.5 * float(np.log(pivots).sum())


def estimate_noise(
    first: Noise,
    residuals: tuple[FloatArray, FloatArray],
    jacobians: tuple[FloatArray, FloatArray],
    *,
    drift: bool,
) -> Noise:
    """Return the noise of greatest penalised likelihood, with or without a search for drift.

    `first` gives slope, radius, steps and rows with area; its deviations are where the search begins.
    """
    white = _maximise_likelihood(
        replace(first, drift_std=0.0), residuals, jacobians, _WHITE[: 3 if residuals[1].size else 2]
    )
    if not drift:
        return white[0]
    names = _WHITE[: 3 if residuals[1].size else 2] + _DRIFT
    seen = replace(first, drift_std=first.drift_std or white[0].force_std)
    both = _maximise_likelihood(seen, residuals, jacobians, names)
    return both[0] if both[1] < white[1] - _GAIN else white[0]


def _maximise_likelihood(
    first: Noise,
    residuals: tuple[FloatArray, FloatArray],
    jacobians: tuple[FloatArray, FloatArray],
    names: tuple[str, ...],
) -> tuple[Noise, float]:
    bounds_by_name = _std_bounds(first, residuals)
    force, area = (np.column_stack(pair) for pair in zip(residuals, jacobians, strict=True))
    bounds = [(math.log(bounds_by_name[name][0]), math.log(bounds_by_name[name][1])) for name in names]
    start = [
        min(max(math.log(getattr(first, name)), low), high)
        for name, (low, high) in zip(names, bounds, strict=True)
    ]

    def negative_log_likelihood(logs: FloatArray) -> float:
        return _penalised_negative_log_likelihood(_with_logs(first, names, logs), force, area)

    found = optimize.minimize(
        negative_log_likelihood,
        np.array(start),
        method="L-BFGS-B",
        bounds=bounds,
        options=_ENOUGH,
    )
    return _with_logs(first, names, found.x), float(found.fun)


def _penalised_negative_log_likelihood(noise: Noise, force: FloatArray, area: FloatArray) -> float:
    """Return the negative log-likelihood less log σ of the displacement.

    The second term keeps that σ off zero (Chung et al. 2013).

    Few rows do not determine it, and its weights and their uncertainty would then be those of none.
    """
    return noise.negative_log_likelihood(force, area) - math.log(noise.displacement_std)


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

    def degrees_of_freedom(
        self, noise: Noise, jacobians: tuple[FloatArray, FloatArray], gradient: FloatArray
    ) -> float:
        """Return Satterthwaite's 2 v²/Var(v) for the variance v of gᵀp that the noise gives (GUM G.4)."""
        at = np.log([getattr(noise, name) for name in self.names])

        def log_variance(logs: FloatArray) -> float:
            seen = _with_logs(noise, self.names, logs)
            return math.log(float(gradient @ seen.parameter_covariance(*jacobians) @ gradient))

        moves = _LOG_STEP * np.eye(len(self.names))
        slope = np.array([log_variance(at + m) - log_variance(at - m) for m in moves]) / (2 * _LOG_STEP)
        return min(max(2 / float(slope @ self.covariance @ slope), 2.0), 1e6)

    def parameter_covariance(self, noise: Noise, jacobians: tuple[FloatArray, FloatArray]) -> FloatArray:
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
    noise: Noise, residuals: tuple[FloatArray, FloatArray], jacobians: tuple[FloatArray, FloatArray]
) -> NoiseUncertainty:
    """Return the uncertainty of a noise from the curvature of its penalised likelihood."""
    names = _WHITE[: 3 if residuals[1].size else 2] + (_DRIFT if noise.drift_std > 0 else ())
    force, area = (np.column_stack(pair) for pair in zip(residuals, jacobians, strict=True))
    at, moves = np.log([getattr(noise, name) for name in names]), _LOG_STEP * np.eye(len(names))

    def negative_log_likelihood(move: FloatArray) -> float:
        return _penalised_negative_log_likelihood(_with_logs(noise, names, at + move), force, area)

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
