"""One value from several estimates of the same quantity."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
import numpy.typing as npt
from scipy import optimize, special

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array, check_all
from fingerpad._display import Displayed
from fingerpad.exceptions import UncertaintyError
from fingerpad.uncertainty.quantities import covariance_of


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Pooled(Displayed):
    """A weighted mean of estimates.

    Attributes
    ----------
    value : float
        The inverse-variance weighted mean.
    std : float
        Its standard uncertainty from the estimates' own, independent uncertainties, multiplied by the Birge
        ratio where that exceeds one.
    total_std : float
        The same with the shared uncertainty added, which does not average out.
    birge_ratio : float
        √(χ²/(n − 1)) of the scatter about the mean, near one where the stated uncertainties explain it; NaN
        for a single estimate.
    count : int
        Number of estimates.
    weights : ndarray, shape (n,)
        Weight of each estimate; they add up to one.

    Examples
    --------
    >>> pooled = pool([19.5, 20.5], [0.5, 0.5], shared=np.full((2, 2), 0.4**2))
    >>> print(f"{pooled.value:.1f} ± {pooled.total_std:.2f}")
    20.0 ± 0.64
    """

    value: float
    std: float
    total_std: float
    birge_ratio: float
    count: int
    weights: FloatArray = field(compare=False)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SharedErrors(Displayed):
    """Errors that estimates share, as signed contributions: C = Σ p pᵀ without the matrix.

    Attributes
    ----------
    sources : tuple of str, of length m
        Name for each of m independent errors; several may have the same.
    parts : ndarray, shape (n, m)
        Change of each estimate by one standard uncertainty of each error.
    groups : ndarray of int, broadcasting to (n, m)
        Estimates share an error where their groups in its column, counted from 0, are the same.

    Raises
    ------
    UncertaintyError
        If the shapes do not fit each other, or a group is negative.

    Examples
    --------
    Three estimates on two scales:

    >>> import numpy as np
    >>> shared = SharedErrors(
    ...     sources=("scale",), parts=np.full((3, 1), 0.2), groups=np.array([[0], [0], [1]])
    ... )
    >>> {name: round(variance, 6) for name, variance in shared.variances(np.full(3, 1 / 3)).items()}
    {'scale': 0.022222}
    """

    sources: tuple[str, ...]
    parts: FloatArray
    groups: npt.NDArray[np.intp]

    def __post_init__(self) -> None:
        shape, count = np.shape(self.parts), len(self.sources)
        if len(shape) != 2 or shape[1] != count:
            raise UncertaintyError(
                f"parts of {count} sources must have the shape (n, {count}), found {shape}"
            )
        try:
            groups = np.broadcast_to(self.groups, shape)
        except ValueError:
            raise UncertaintyError(
                f"groups must broadcast to the shape {shape}, found {np.shape(self.groups)}"
            ) from None
        check_all(groups >= 0, "groups", groups, "counted from 0", UncertaintyError)

    def variances(self, weights: FloatArray) -> dict[str, float]:
        """Return the variance of the weighted sum of the estimates from each source.

        Parameters
        ----------
        weights : ndarray, shape (n,)
            Weight of each estimate.

        Returns
        -------
        dict of str to float
        """
        variance = dict.fromkeys(self.sources, 0.0)
        groups = np.broadcast_to(self.groups, self.parts.shape)
        for source, group, part in zip(self.sources, groups.T, self.parts.T, strict=True):
            sums = np.bincount(group, weights * part)
            variance[source] += float(sums @ sums)
        return variance


Shared: TypeAlias = ArrayLike | SharedErrors | None


def proportional_stds(values: ArrayLike, stds: ArrayLike) -> FloatArray:
    """Return standard uncertainties that are proportional to the values, at the common mean of these.

    Where standard uncertainties are proportional to the values, an estimate that is low by chance states a
    small one, and weights from these bias the mean low; weights from the returned ones do not.

    Parameters
    ----------
    values, stds : array_like, shape (n,)
        Estimates of one quantity, and the standard uncertainty of each.

    Returns
    -------
    ndarray, shape (n,)
        `stds` unchanged if a value is not positive: it has no relative uncertainty.

    Raises
    ------
    UncertaintyError
        As `pool`.

    Examples
    --------
    >>> proportional_stds([9.0, 11.0], [0.9, 1.1])
    array([1., 1.])
    """
    values, stds = _estimates(values, stds)
    if not (values > 0).all():
        return stds
    relative = _representable(values, stds) / values
    return relative * (_inverse_variance_weights(relative) @ values)


def pool(values: ArrayLike, stds: ArrayLike, shared: Shared = None) -> Pooled:
    """Pool estimates by inverse variance: ȳ = Σ wᵢ yᵢ with wᵢ ∝ 1/uᵢ².

    Parameters
    ----------
    values : array_like, shape (n,)
        Estimates of one quantity.
    stds : array_like, shape (n,)
        Standard uncertainty of each from what it does not share with the others.
    shared : array_like, shape (n, n), or SharedErrors, optional
        Covariance from the inputs that they share; as `SharedErrors` where n is large.

    Returns
    -------
    Pooled

    Raises
    ------
    UncertaintyError
        If there is no estimate, a value or standard uncertainty is not finite, one is negative, or
        `shared` is not a covariance of these estimates.

    Examples
    --------
    >>> pooled = pool([19.5, 20.5], [0.5, 0.5])
    >>> print(f"{pooled.value:.1f} ± {pooled.std:.2f}, Birge ratio {pooled.birge_ratio:.2f}")
    20.0 ± 0.50, Birge ratio 1.41
    """
    values, stds = _estimates(values, stds)
    own = _representable(values, stds)
    weights = _inverse_variance_weights(own)
    mean = float(weights @ values)
    count = values.size
    birge = float(np.sqrt(np.sum(((values - mean) / own) ** 2) / (count - 1))) if count > 1 else np.nan
    variance = np.sum((weights * own) ** 2) * np.fmax(1.0, birge) ** 2
    return Pooled(
        value=mean,
        std=float(np.sqrt(variance)),
        total_std=float(np.sqrt(variance + _shared_variance(shared, weights))),
        birge_ratio=birge,
        count=count,
        weights=weights,
    )


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class RandomEffects(Displayed):
    """A weighted mean of estimates of a quantity that varies, as between loads or fingers.

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
        one estimate, which does not determine τ.
    between_std : float
        τ, the standard deviation between estimates beyond their stated uncertainty.
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
    weights: FloatArray = field(compare=False)


def pool_random_effects(values: ArrayLike, stds: ArrayLike, shared: Shared = None) -> RandomEffects:
    r"""Pool estimates of a quantity that varies from estimate to estimate.

    τ² solves Paule and Mandel's :math:`\sum w_i (y_i - \bar y)^2 = n - 1`, :math:`w_i = 1/(u_i^2 + \tau^2)`,
    and is zero where the estimates scatter less than stated. The variance of the mean is
    :math:`1/\sum w_i`, which for this τ² is Hartung and Knapp's.

    Parameters
    ----------
    values, stds, shared
        As for `pool`; the standard uncertainties u must be positive.

    Returns
    -------
    RandomEffects

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
    weights = 1 / (stds**2 + between_variance)
    variance = 1 / weights.sum()
    weights /= weights.sum()
    shared_variance = _shared_variance(shared, weights)
    half = np.inf
    if count > 1:
        quantiles = special.stdtrit(count - 1, 0.975), special.ndtri(0.975)
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
    upper = float(np.ptp(values) ** 2 * values.size)
    between_variance = optimize.brentq(
        lambda variance: mean_and_excess(variance)[1], 0.0, upper, xtol=1e-12 * upper, rtol=1e-12
    )
    return float(between_variance), mean_and_excess(between_variance)[0]


def _representable(values: FloatArray, stds: FloatArray) -> FloatArray:
    """Return standard uncertainties not below the spacing of doubles at the values, so that none is zero.

    It is the same for all, as exact values weigh the same.
    """
    return as_float_array(np.maximum(stds, np.spacing(np.abs(values).max())))


def _inverse_variance_weights(stds: FloatArray) -> FloatArray:
    """Return weights that add up to one, scaled before squaring against overflow."""
    weights = (stds.min() / stds) ** 2
    return as_float_array(weights / weights.sum())


def _shared_variance(shared: Shared, weights: FloatArray) -> float:
    """Return the variance of a weighted sum of estimates from the errors that they share."""
    if shared is None:
        return 0.0
    if not isinstance(shared, SharedErrors):
        matrix, shape = as_float_array(shared, "shared", UncertaintyError), (weights.size, weights.size)
        if matrix.shape not in ((), shape):
            raise UncertaintyError(f"shared must have the shape {shape}, found {matrix.shape}")
        matrix = covariance_of(np.broadcast_to(matrix, shape))
        return float(weights @ matrix @ weights)
    if len(shared.parts) != weights.size:
        raise UncertaintyError(f"each estimate needs its parts, found {weights.size} and {len(shared.parts)}")
    return sum(shared.variances(weights).values())


def _estimates(values: ArrayLike, stds: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return estimates and their standard uncertainties as arrays, checked."""
    values = as_float_array(values, "values to pool", UncertaintyError).reshape(-1)
    stds = as_float_array(stds, "standard uncertainties", UncertaintyError).reshape(-1)
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
