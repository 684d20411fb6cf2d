"""One value from several estimates of the same quantity."""

from dataclasses import dataclass

import numpy as np

from fingerpad._arrays import ArrayLike, floats, require
from fingerpad.exceptions import FitError


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
    """

    value: float
    std: float
    total_std: float
    birge_ratio: float
    count: int


def pool(values: ArrayLike, stds: ArrayLike, shared_covariance: ArrayLike = 0.0) -> Pooled:
    """Pool estimates by inverse variance.

    Parameters
    ----------
    values : array_like, shape (n,)
        Estimates of one quantity.
    stds : array_like, shape (n,)
        Standard uncertainty of each from what it does not share with the others.
    shared_covariance : array_like, shape (n, n)
        Covariance from the inputs that they share.

    Raises
    ------
    FitError
        If there is no estimate, or a value or standard uncertainty is not finite, or one is negative.

    Examples
    --------
    >>> pooled = pool([19.5, 20.5], [0.5, 0.5])
    >>> print(f"{pooled.value:.1f} ± {pooled.std:.2f}, Birge ratio {pooled.birge_ratio:.2f}")
    20.0 ± 0.50, Birge ratio 1.41
    """
    values, stds = floats(values).reshape(-1), floats(stds).reshape(-1)
    if values.size == 0:
        raise FitError("no estimates to pool; at least one row must have been measured")
    if values.shape != stds.shape:
        raise FitError(f"each value needs its standard uncertainty, found {values.size} and {stds.size}")
    require(np.isfinite(values), "value to pool", values, "finite", FitError)
    require(
        np.isfinite(stds) & (stds >= 0), "standard uncertainty", stds, "finite and not negative", FitError
    )
    own = np.maximum(stds, np.spacing(np.abs(values)))  # no value is known better than a double holds it
    least = own.min()
    weights = (least / own) ** 2 / np.sum((least / own) ** 2)
    mean = float(weights @ values)
    count = values.size
    birge = float(np.sqrt(np.sum(((values - mean) / own) ** 2) / (count - 1))) if count > 1 else np.nan
    variance = least**2 / np.sum((least / own) ** 2) * max(1.0, birge if count > 1 else 1.0) ** 2
    shared = weights @ np.broadcast_to(floats(shared_covariance), (count, count)) @ weights
    return Pooled(
        value=mean,
        std=float(np.sqrt(variance)),
        total_std=float(np.sqrt(variance + shared)),
        birge_ratio=birge,
        count=count,
    )
