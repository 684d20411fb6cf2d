"""Scatter of values within groups and between them."""

from dataclasses import dataclass

import numpy as np

from fingerpad._arrays import ArrayLike, as_float_array, check_all
from fingerpad._display import Displayed
from fingerpad.exceptions import UncertaintyError


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class VarianceComponents(Displayed):
    """Standard deviations of values within groups, as of repeats at one load, and between groups.

    Attributes
    ----------
    within_std : float
        Standard deviation within groups; NaN if no group has two values.
    between_std : float
        Standard deviation of the groups' true means, the contribution of the scatter within groups
        subtracted; NaN for one group or where `within_std` is NaN.

    Examples
    --------
    >>> round(variance_components([10.0, 10.2, 12.0, 12.2], [1, 1, 2, 2]).within_std, 3)
    0.141
    """

    within_std: float
    between_std: float


def variance_components(values: ArrayLike, groups: ArrayLike) -> VarianceComponents:
    """Split the variance of values into that within groups and that between them, by analysis of variance.

    Parameters
    ----------
    values : array_like, shape (n,)
        Values of one quantity.
    groups : array_like, shape (n,)
        Group of each value, as the load under which it was measured.

    Returns
    -------
    VarianceComponents

    Raises
    ------
    UncertaintyError
        If a value is not finite or has no group.

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
