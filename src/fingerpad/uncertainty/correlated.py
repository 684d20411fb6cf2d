"""Values with uncertainty from and for the `uncertainties` package, where that is installed."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array
from fingerpad.exceptions import UncertaintyError
from fingerpad.uncertainty.covariance import covariance_of


def mean_and_covariance(values: Iterable[Any]) -> tuple[FloatArray, FloatArray]:
    """Return means and covariance of numbers, some of which may be objects of `uncertainties`.

    Correlations between the objects are kept; a plain number is exact.

    Parameters
    ----------
    values : iterable
        Numbers, `uncertainties.ufloat` and what was computed from them.

    Returns
    -------
    mean : ndarray, shape (n,)
    covariance : ndarray, shape (n, n)

    Examples
    --------
    >>> from uncertainties import ufloat
    >>> scale = ufloat(1.0, 0.01)
    >>> mean, covariance = mean_and_covariance([7.4 * scale, 5.0 * scale, 2.0])
    >>> print(mean, covariance[0, 1].round(6))
    [7.4 5.  2. ] 0.0037
    """
    from uncertainties import UFloat, covariance_matrix, nominal_value

    items = list(values)
    uncertain = [place for place, item in enumerate(items) if isinstance(item, UFloat)]
    covariance = np.zeros((len(items), len(items)))
    if uncertain:
        covariance[np.ix_(uncertain, uncertain)] = covariance_matrix([items[place] for place in uncertain])
    return as_float_array([nominal_value(item) for item in items]), covariance


def correlated_values(value: ArrayLike, covariance: ArrayLike) -> tuple[Any, ...]:
    """Return values as objects of `uncertainties` that know of their correlations.

    Parameters
    ----------
    value : array_like, shape (m,)
        As in `Propagated.value` or `Simulated.value` of one set of inputs.
    covariance : array_like, shape (m, m)
        Their covariance.

    Raises
    ------
    UncertaintyError
        If the shapes do not fit or `covariance` is none.

    Examples
    --------
    >>> radius, depth = correlated_values([13.8, 2.1], [[0.04, 0.02], [0.02, 0.04]])
    >>> print(f"{radius * depth:.2u}")
    29.0+/-3.0
    """
    import uncertainties

    value, covariance = as_float_array(value), covariance_of(covariance)
    if value.ndim != 1 or covariance.shape != (value.size, value.size):
        raise UncertaintyError(f"values of shape {value.shape} do not fit a covariance of {covariance.shape}")
    return tuple(uncertainties.correlated_values(value, covariance))
