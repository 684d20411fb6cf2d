"""Least squares for every nonlinear model here: values, covariance, profile intervals, AICc, correlation."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from types import MappingProxyType
from typing import Final, TypeAlias

import numpy as np
from scipy import linalg, optimize, special

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array
from fingerpad._display import Displayed
from fingerpad.estimate import Estimate
from fingerpad.exceptions import FitError

Residuals: TypeAlias = Callable[[FloatArray], FloatArray]
# Lower and upper ends of all parameters.
Bounds: TypeAlias = tuple[FloatArray, FloatArray]

# Columns of a Jacobian that do not change, by the names of the parameters in which the residuals are linear.
Linear: TypeAlias = Mapping[str, FloatArray]

_NONE: Final[Linear] = MappingProxyType({})
_STEP = np.finfo(float).eps ** (1 / 3)
# A parameter below this is zero but for rounding: a step in proportion would be lost in the data.
_ZERO = 1e-8
# Singular values of the Jacobian, its columns scaled to one, below which parameters are indistinguishable.
_SINGULAR = 1e-12
_HIGHEST_ORDER = 3
_FARTHEST = 50.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class LeastSquaresFit(Displayed):
    """Parameters that minimise a sum of squares."""

    names: tuple[str, ...]
    values: FloatArray  # (p,)
    residuals: FloatArray  # (n,)
    jacobian: FloatArray  # (n, p)
    effective_count: float  # of independent residuals that carry as much information
    _function: Residuals
    _linear: Linear

    @property
    def sum_of_squares(self) -> float:
        """Least sum of squares S."""
        return float(self.residuals @ self.residuals)

    @property
    def degrees_of_freedom(self) -> float:
        """Effective count less the number of parameters."""
        return self.effective_count - self.values.size

    @property
    def residual_std(self) -> float:
        """Standard deviation of the residuals, √(S/(n − p))."""
        return math.sqrt(self.sum_of_squares / (self.residuals.size - self.values.size))

    @property
    def covariance(self) -> FloatArray:
        """Covariance of the parameters, (JᵀJ)⁻¹ S/(n_eff − p), (p, p)."""
        return _inverse_information(self.jacobian) * (self.sum_of_squares / self.degrees_of_freedom)

    @property
    def aicc(self) -> float:
        """Corrected Akaike criterion n ln(S/n) + 2k + 2k(k+1)/(n−k−1), with n effective and k = p + 1."""
        n, k = self.effective_count, self.values.size + 1
        if not n > k + 1:
            return math.inf
        tiny = np.finfo(float).tiny
        return n * math.log(max(self.sum_of_squares, tiny) / n) + 2 * k + 2 * k * (k + 1) / (n - k - 1)

    def value(self, name: str) -> float:
        """Return the estimate of one parameter."""
        return float(self.values[self.names.index(name)])

    def with_effective_count(self, count: float) -> "LeastSquaresFit":
        """Return the same fit for correlated residuals. Raise FitError where `count` is too small."""
        if not count > self.values.size:
            raise FitError(
                f"the residuals are so correlated that they count as {count:.1f} independent ones, for "
                f"{self.values.size} parameters ({', '.join(self.names)}): record for longer, or fit less"
            )
        return replace(self, effective_count=float(count))

    def derived(self, value: float, gradient: ArrayLike) -> Estimate:
        """Return a function of the parameters with its first-order uncertainty (GUM Eq. 13).

        `gradient` is its derivative by the parameters, `value` what it is at the estimates.
        """
        slope = as_float_array(gradient)
        std = math.sqrt(float(slope @ self.covariance @ slope))
        return Estimate.symmetric(value, std, self.degrees_of_freedom)

    def estimate(self, name: str) -> Estimate:
        """Return one parameter with its 95 % interval by profile likelihood.

        The parameter is moved and all others are fitted again, until S has grown by t² S/(n_eff − p)
        (Bates & Watts 1988, ch. 6). An end that is never reached is infinite.
        """
        place = self.names.index(name)
        std = math.sqrt(self.covariance[place, place])
        interval = _profile_end(self, place, -std), _profile_end(self, place, std)
        return Estimate(value=self.value(name), std=std, interval=interval)


def fit_least_squares(
    residuals: Residuals,
    start: ArrayLike,
    names: Sequence[str],
    *,
    evaluations: int = 2000,
    bounds: Bounds | None = None,
    linear: Linear = _NONE,
) -> LeastSquaresFit:
    """Minimise a sum of squares by the Levenberg–Marquardt method.

    `residuals` takes parameters (p,) and returns residuals (n,), each divided by its relative standard
    deviation; their derivatives are found by differences but for those in `linear`. A trust region keeps the
    parameters within `bounds`, where they are given.
    """
    names = tuple(names)
    values, left = minimum(residuals, start, names, evaluations=evaluations, bounds=bounds, linear=linear)
    fit = LeastSquaresFit(
        names=names,
        values=values,
        residuals=left,
        jacobian=_jacobian(residuals, names, linear, values),
        effective_count=float(left.size),
        _function=residuals,
        _linear=linear,
    )
    _require_determined(fit)
    return fit


def effective_count(residuals: ArrayLike) -> float:
    """Return the number of independent values that carry as much information as correlated residuals.

    An autoregression, of an order up to three by AICc, gives the spectral density at zero frequency over the
    variance, by which the count is divided. It is never raised: apparent anticorrelation narrows nothing.
    """
    values = as_float_array(residuals) - float(np.mean(as_float_array(residuals)))
    n = values.size
    variance = float(values @ values) / n
    if n < 8 or not variance > 0:
        return float(n)
    lags = min(_HIGHEST_ORDER, n // 8)
    correlation = np.array([float(values[k:] @ values[: n - k]) / n / variance for k in range(lags + 1)])
    best, inflation = math.inf, 1.0
    for order in range(lags + 1):
        weights = (
            linalg.solve_toeplitz(correlation[:order], correlation[1 : order + 1]) if order else np.zeros(0)
        )
        innovation = max(1 - float(weights @ correlation[1 : order + 1]), 1 / n**2)
        k = order + 1
        criterion = n * math.log(innovation) + 2 * k + 2 * k * (k + 1) / (n - k - 1)
        if criterion < best:
            best, inflation = criterion, innovation / max(1 - float(weights.sum()), 1 / n) ** 2
    return float(n / max(inflation, 1.0))


def minimum(
    residuals: Residuals,
    start: ArrayLike,
    names: Sequence[str],
    *,
    tolerance: float = 1e-14,
    evaluations: int = 300,
    bounds: Bounds | None = None,
    linear: Linear = _NONE,
) -> tuple[FloatArray, FloatArray]:
    """Return the parameters of least squares and the residuals there. Raise FitError where there are none."""
    start = as_float_array(start)
    if bounds is not None:
        low, high = bounds
        inside = 1e-6 * np.where(np.isfinite(high - low), high - low, np.maximum(np.abs(start), 1e-6))
        start = np.clip(start, low + inside, high - inside)
    first = residuals(start)
    if not first.size > start.size:
        raise FitError(
            f"{first.size} data for {start.size} parameters ({', '.join(names)}): record more points"
        )
    if not np.isfinite(first).all():
        raise FitError(f"the model is not finite at {dict(zip(names, start.tolist(), strict=True))}")
    found = optimize.least_squares(
        residuals,
        start,
        jac=partial(_jacobian, residuals, names, linear),
        method="lm" if bounds is None else "trf",
        bounds=(-np.inf, np.inf) if bounds is None else bounds,
        x_scale="jac",
        ftol=tolerance,
        xtol=tolerance,
        gtol=tolerance,
        max_nfev=evaluations,
    )
    if not (found.success and np.isfinite(found.x).all() and math.isfinite(found.cost)):
        raise FitError(f"the fit of {', '.join(names)} found no minimum: {found.message}")
    return np.asarray(found.x), np.asarray(found.fun)


def differences(
    function: Callable[[dict[str, float]], ArrayLike], values: Mapping[str, float], names: Sequence[str]
) -> FloatArray:
    """Return the derivatives of a function of named values by some of them, along a new last axis."""
    columns = []
    for name in names:
        step = 1e-5 * (abs(values[name]) or 1.0)
        up, down = (np.asarray(function({**values, name: values[name] + way * step})) for way in (1, -1))
        columns.append((up - down) / (2 * step))
    return np.stack(columns, axis=-1)


def _jacobian(residuals: Residuals, names: Sequence[str], linear: Linear, values: FloatArray) -> FloatArray:
    """Return known columns, else central differences: they err by 1e-10, one-sided ones by 1e-8."""
    columns = []
    for k, (name, value) in enumerate(zip(names, values, strict=True)):
        if name in linear:
            columns.append(linear[name])
            continue
        step = _STEP * (abs(value) if abs(value) > _ZERO else 1.0)
        upper, lower = values.copy(), values.copy()
        upper[k], lower[k] = value + step, value - step
        columns.append((residuals(upper) - residuals(lower)) / (upper[k] - lower[k]))
    return np.asarray(np.nan_to_num(np.stack(columns, axis=-1)))


def _inverse_information(jacobian: FloatArray) -> FloatArray:
    """Return (JᵀJ)⁻¹ from the singular values of J with columns of length one, for least rounding error."""
    length = np.linalg.norm(jacobian, axis=0)
    _, singular, right = np.linalg.svd(jacobian / length, full_matrices=False)
    root = right.T / singular / length[:, None]
    return np.asarray(root @ root.T)


def _require_determined(fit: LeastSquaresFit) -> None:
    length = np.linalg.norm(fit.jacobian, axis=0)
    if not (length > 0).all():
        idle = [name for name, size in zip(fit.names, length, strict=True) if not size > 0]
        raise FitError(f"the data do not depend on {', '.join(idle)}: nothing was fitted")
    singular = np.linalg.svd(fit.jacobian / length, compute_uv=False)
    if not singular[-1] > _SINGULAR * singular[0]:
        raise FitError(
            f"the data do not determine {', '.join(fit.names)} separately: record a wider range, or fit less"
        )


def _profile_end(fit: LeastSquaresFit, place: int, step: float) -> float:
    """Return where the profile of a parameter, as a signed root, reaches the 95 % point of Student's t."""
    target = float(special.stdtrit(fit.degrees_of_freedom, 0.975))
    scale = fit.sum_of_squares / fit.degrees_of_freedom
    if not (scale > 0 and step != 0):
        return float(fit.values[place])
    others = np.arange(fit.values.size) != place
    trend = fit.covariance[others, place] / fit.covariance[place, place]
    names = [name for name in fit.names if name != fit.names[place]]

    def root(moved: float) -> float:
        """Return how far, in standard uncertainties, the data resist the move."""

        def whole(part: FloatArray) -> FloatArray:
            values = np.empty(fit.values.size)
            values[others], values[place] = part, fit.values[place] + moved * step
            return values

        part = fit.values[others] + trend * moved * step
        if not others.any():
            rest = fit._function(whole(part))
        else:
            try:
                _, rest = minimum(
                    lambda p: fit._function(whole(p)), part, names, tolerance=1e-8, linear=fit._linear
                )
            except FitError:
                return math.nan
        return math.sqrt(max(float(rest @ rest) - fit.sum_of_squares, 0.0) / scale)

    near, far = (0.0, 0.0), (target, root(target))
    if math.isnan(far[1]):
        return math.copysign(math.inf, step)
    for _ in range(25):
        if abs(far[1] - target) < 0.002 * target:
            break
        if far[0] == near[0]:  # the others' minimum is not found from one place to the next
            return math.copysign(math.inf, step)
        rise = (far[1] - near[1]) / (far[0] - near[0])
        ahead = far[0] + (target - far[1]) / rise if rise > 0 else 2 * far[0]
        ahead = min(max(ahead, 0.3 * far[0]), 3 * far[0])
        if ahead > _FARTHEST * target:
            return math.copysign(math.inf, step)
        near, far = far, (ahead, root(ahead))
        if math.isnan(far[1]):
            return math.copysign(math.inf, step)
    return float(fit.values[place] + far[0] * step)
