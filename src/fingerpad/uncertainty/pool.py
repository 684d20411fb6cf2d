"""One value from several estimates of the same quantity."""

from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
import numpy.typing as npt
from scipy import optimize, stats

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array, check_all
from fingerpad.exceptions import UncertaintyError
from fingerpad.uncertainty.covariance import covariance_of

# Steps by which a mean and the uncertainties that are in proportion to it agree.
_MOST_STEPS = 100


@dataclass(frozen=True, slots=True, kw_only=True)
class Pooled:
    """A weighted mean of estimates.

    Attributes
    ----------
    value : float
        The inverse-variance weighted mean.
    std : float
        Its standard uncertainty from the estimates' own, independent uncertainties, enlarged by the Birge
        ratio where they scatter more than they should.
    total_std : float
        The same with the shared uncertainty added: what all estimates have in common does not average away.
    birge_ratio : float
        √(χ²/(n − 1)) of the scatter about the mean, about one when the stated uncertainties explain it; NaN
        for a single estimate.
    count : int
        Number of estimates.
    weights : ndarray, shape (n,)
        Weight of each estimate; they add up to one.
    """

    value: float
    std: float
    total_std: float
    birge_ratio: float
    count: int
    weights: FloatArray = field(repr=False, compare=False)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SharedErrors:
    """What estimates share, as signed parts of their uncertainty: C = Σ p pᵀ without the matrix.

    Attributes
    ----------
    parts : ndarray, shape (n, m)
        What each of m independent errors, one standard uncertainty off, does to each estimate.
    groups : ndarray of int, broadcasting to (n, m)
        Estimates share an error where their groups in its column, counted from 0, are the same.

    Examples
    --------
    Three estimates on two scales:

    >>> import numpy as np
    >>> shared = SharedErrors(parts=np.full((3, 1), 0.2), groups=np.array([[0], [0], [1]]))
    >>> shared.variances(np.full(3, 1 / 3)).round(6)
    array([0.022222])
    """

    parts: FloatArray
    groups: npt.NDArray[np.intp]

    def variances(self, weights: FloatArray) -> FloatArray:
        """Return the variance that each error brings to the weighted sum of the estimates, shape (m,)."""
        groups = np.broadcast_to(self.groups, self.parts.shape)
        sums = (
            np.bincount(group, weights * part) for group, part in zip(groups.T, self.parts.T, strict=True)
        )
        return np.array([total @ total for total in sums])


Shared: TypeAlias = ArrayLike | SharedErrors | None


def pool(values: ArrayLike, stds: ArrayLike, shared: Shared = None, *, proportional: bool = False) -> Pooled:
    """Pool estimates by inverse variance.

    Parameters
    ----------
    values : array_like, shape (n,)
        Estimates of one quantity.
    stds : array_like, shape (n,)
        Standard uncertainty of each from what it does not share with the others.
    shared : array_like, shape (n, n), or SharedErrors, optional
        Covariance from the inputs that they share; as parts where n is large.
    proportional : bool
        Whether standard uncertainties grow in proportion to the values, as those of lengths and moduli do.
        An estimate that came out low by chance then states a small uncertainty, and weights of the stated
        ones pull the mean low: the relative ones are taken, times the mean. Values that are not all positive
        have none.

    Raises
    ------
    UncertaintyError
        If there is no estimate, a value or standard uncertainty is not finite, one is negative, or
        `shared` is no covariance of theirs.

    Examples
    --------
    >>> pooled = pool([19.5, 20.5], [0.5, 0.5])
    >>> print(f"{pooled.value:.1f} ± {pooled.std:.2f}, Birge ratio {pooled.birge_ratio:.2f}")
    20.0 ± 0.50, Birge ratio 1.41
    """
    values, stds = _estimates(values, stds)
    proportional = proportional and bool((values > 0).all())
    # No value is known better than a double holds it.
    own = np.maximum(stds, np.spacing(np.abs(values)))
    relative = own / values if proportional else own
    weights = (relative.min() / relative) ** 2
    weights /= weights.sum()
    mean = float(weights @ values)
    own = relative * mean if proportional else own
    count = values.size
    birge = float(np.sqrt(np.sum(((values - mean) / own) ** 2) / (count - 1))) if count > 1 else np.nan
    variance = np.sum((weights * own) ** 2) * max(1.0, birge if count > 1 else 1.0) ** 2
    return Pooled(
        value=mean,
        std=float(np.sqrt(variance)),
        total_std=float(np.sqrt(variance + _shared_variance(shared, weights))),
        birge_ratio=birge,
        count=count,
        weights=weights,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class RandomEffects:
    """A weighted mean of estimates that differ by more than their uncertainty, as loads or fingers do.

    Attributes
    ----------
    value : float
        The mean, weighted by 1/(u² + τ²).
    std : float
        Its standard uncertainty after Hartung and Knapp.
    total_std : float
        The same with the shared uncertainty added.
    interval : (float, float)
        95 % interval, with Student's t of n − 1 degrees of freedom for what is not shared; infinite for
        one estimate, which tells nothing of τ.
    between_std : float
        τ, the standard deviation of what differs between estimates beyond their stated uncertainty.
    count : int
        Number of estimates.
    weights : ndarray, shape (n,)
        Weight of each estimate; they add up to one.
    """

    value: float
    std: float
    total_std: float
    interval: tuple[float, float]
    between_std: float
    count: int
    weights: FloatArray = field(repr=False, compare=False)


def pool_random_effects(
    values: ArrayLike, stds: ArrayLike, shared: Shared = None, *, proportional: bool = False
) -> RandomEffects:
    r"""Pool estimates of a quantity that itself varies from one to the other.

    τ² solves Paule and Mandel's :math:`\sum w_i (y_i - \bar y)^2 = n - 1`, :math:`w_i = 1/(u_i^2 + \tau^2)`,
    and is zero where the estimates scatter less than stated. The variance of the mean is Hartung and
    Knapp's, never below :math:`1/\sum w_i`.

    Parameters
    ----------
    values, stds, shared, proportional
        As for `pool`; the standard uncertainties must be positive.

    Raises
    ------
    UncertaintyError
        As `pool`, and if a standard uncertainty is zero.

    Examples
    --------
    >>> pooled = pool_random_effects([19.0, 20.5, 22.0], [0.1, 0.1, 0.1])
    >>> print(f"{pooled.value:.1f} ± {pooled.std:.2f}, between {pooled.between_std:.1f}")
    20.5 ± 0.87, between 1.5
    """
    values, stds = _estimates(values, stds)
    check_all(stds > 0, "standard uncertainty", stds, "positive", UncertaintyError)
    count = values.size
    between_variance, value = _between_variance(values, stds)
    if proportional and (values > 0).all():
        relative = stds / values
        for _ in range(_MOST_STEPS):
            stds, before = relative * value, value
            between_variance, value = _between_variance(values, stds)
            if abs(value - before) <= 1e-12 * value:
                break
    weights = 1 / (stds**2 + between_variance)
    variance = 1 / weights.sum()
    weights /= weights.sum()
    shared_variance = _shared_variance(shared, weights)
    half = np.inf
    if count > 1:
        variance *= max(1.0, float((values - value) ** 2 @ weights) / variance / (count - 1))
        quantiles = stats.t.ppf(0.975, count - 1), stats.norm.ppf(0.975)
        half = float(np.hypot(quantiles[0] * np.sqrt(variance), quantiles[1] * np.sqrt(shared_variance)))
    return RandomEffects(
        value=value,
        std=float(np.sqrt(variance)),
        total_std=float(np.sqrt(variance + shared_variance)),
        interval=(value - half, value + half),
        between_std=float(np.sqrt(between_variance)),
        count=count,
        weights=weights,
    )


def _between_variance(values: FloatArray, stds: FloatArray) -> tuple[float, float]:
    """Return Paule and Mandel's variance between estimates, and their mean."""
    freedom = values.size - 1

    def mean_and_excess(between_variance: float) -> tuple[float, float]:
        weights = 1 / (stds**2 + between_variance)
        mean = float(weights @ values / weights.sum())
        return mean, float(weights @ (values - mean) ** 2) - freedom

    mean, excess = mean_and_excess(0.0)
    if not (freedom and excess > 0):
        return 0.0, mean
    max_draws = float(np.ptp(values) ** 2 * values.size)
    between_variance = optimize.brentq(
        lambda tried: mean_and_excess(tried)[1], 0.0, max_draws, xtol=1e-12 * max_draws, rtol=1e-12
    )
    return float(between_variance), mean_and_excess(between_variance)[0]


@dataclass(frozen=True, slots=True, kw_only=True)
class VarianceComponents:
    """How values scatter within groups, as repeats at one load do, and between them.

    Attributes
    ----------
    within_std : float
        Standard deviation within groups; NaN if no group has two values.
    between_std : float
        Standard deviation of the groups' own means, what repeats add taken off; NaN for one group or
        where `within_std` is not known.
    """

    within_std: float
    between_std: float


def variance_components(values: ArrayLike, groups: ArrayLike) -> VarianceComponents:
    """Part the scatter of values into that within groups and that between them, by analysis of variance.

    Parameters
    ----------
    values : array_like, shape (n,)
        Values of one quantity.
    groups : array_like, shape (n,)
        Which group each belongs to, as the load under which it was measured.

    Examples
    --------
    >>> scatter = variance_components([10.0, 10.2, 12.0, 12.2], [1, 1, 2, 2])
    >>> print(f"within {scatter.within_std:.2f}, between {scatter.between_std:.2f}")
    within 0.14, between 1.41
    """
    values = as_float_array(values).reshape(-1)
    _, which, sizes = np.unique(np.asarray(groups).reshape(-1), return_inverse=True, return_counts=True)
    if which.size != values.size:
        raise UncertaintyError(f"each value needs its group, found {values.size} and {which.size}")
    check_all(np.isfinite(values), "value", values, "finite", UncertaintyError)
    total, count = values.size, sizes.size
    if total <= count:
        return VarianceComponents(within_std=np.nan, between_std=np.nan)
    means = np.bincount(which, values) / sizes
    within = float(np.sum((values - means[which]) ** 2) / (total - count))
    between = np.nan
    if count > 1:
        typical_size = (total - np.sum(sizes**2) / total) / (count - 1)
        spread = float(np.sum(sizes * (means - values.mean()) ** 2) / (count - 1))
        between = np.sqrt(max(0.0, spread - within) / typical_size)
    return VarianceComponents(within_std=float(np.sqrt(within)), between_std=float(between))


def _shared_variance(shared: Shared, weights: FloatArray) -> float:
    """Return what estimates share of the variance of their weighted sum."""
    if shared is None:
        return 0.0
    if not isinstance(shared, SharedErrors):
        matrix = covariance_of(np.broadcast_to(as_float_array(shared), (weights.size, weights.size)))
        return float(weights @ matrix @ weights)
    if len(shared.parts) != weights.size:
        raise UncertaintyError(f"each estimate needs its parts, found {weights.size} and {len(shared.parts)}")
    return float(shared.variances(weights).sum())


def _estimates(values: ArrayLike, stds: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return estimates and their standard uncertainties, once they are sound."""
    values, stds = as_float_array(values).reshape(-1), as_float_array(stds).reshape(-1)
    if values.size == 0:
        raise UncertaintyError("no estimates to pool; at least one row must have been measured")
    if values.shape != stds.shape:
        raise UncertaintyError(
            f"each value needs its standard uncertainty, found {values.size} and {stds.size}"
        )
    check_all(np.isfinite(values), "value to pool", values, "finite", UncertaintyError)
    check_all(
        np.isfinite(stds) & (stds >= 0),
        "standard uncertainty",
        stds,
        "finite and not negative",
        UncertaintyError,
    )
    return values, stds
