"""Agreement of two persons, or two methods, on the same things: bias and limits of agreement."""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy import special

from fingerpad._arrays import ArrayLike, as_float_array, check_all
from fingerpad._display import Displayed
from fingerpad.exceptions import UncertaintyError
from fingerpad.uncertainty.propagate import NORMAL_97_5

# With fewer pairs a standard deviation says nothing.
MIN_PAIRS: Final = 3


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Agreement(Displayed):
    """Relative differences of the second of two values from the first; NaN where there are too few pairs.

    Attributes
    ----------
    count : int
        Number of pairs.
    bias : float
        Mean difference, relative: 0.01 is 1 %.
    bias_interval : (float, float)
        Its 95 % confidence interval, by Student's t.
    std : float
        Standard deviation of the differences.
    limits : (float, float)
        Limits of agreement: 95 % of differences lie between them.
    limits_interval : (float, float)
        Outer ends of the 95 % confidence intervals of the two limits.

    Examples
    --------
    >>> found = agreement([100, 120, 140, 90, 110], [101, 119, 143, 91, 111])
    >>> print(f"{found.count} pairs: {100 * found.bias:.1f} %, within {100 * found.limits[1]:.1f} %")
    5 pairs: 0.9 %, within 3.0 %
    """

    count: int
    bias: float
    bias_interval: tuple[float, float]
    std: float
    limits: tuple[float, float]
    limits_interval: tuple[float, float]


def agreement(first: ArrayLike, second: ArrayLike) -> Agreement:
    r"""Compare pairs of positive values as Bland and Altman (1986, 1999) do, on logarithms.

    The differences are :math:`d = \ln(x_2/x_1)`, whose scatter does not grow with the size of what is
    measured; they are stated as :math:`e^d - 1`. The limits are :math:`\bar d \pm 1.96\,s`; their intervals
    are exact for normal differences, by the noncentral t distribution (Carkeet 2015).

    Parameters
    ----------
    first, second : array_like, shape (n,)
        The same quantities by either person.

    Returns
    -------
    Agreement

    Raises
    ------
    UncertaintyError
        If the arrays differ in shape, or a value is not positive and finite.

    Examples
    --------
    >>> found = agreement([1.0, 2.0, 4.0], [1.1, 2.2, 4.4])
    >>> round(found.bias, 3), round(found.std, 3)
    (0.1, 0.0)
    """
    one, other = as_float_array(first), as_float_array(second)
    if one.ndim != 1 or one.shape != other.shape:
        raise UncertaintyError(
            f"first and second must be pairs of values, found shapes {one.shape} and {other.shape}"
        )
    for name, values in {"first": one, "second": other}.items():
        good = np.isfinite(values) & (values > 0)
        check_all(good, name, values, "positive and finite", UncertaintyError)
    count = one.size
    difference = np.log(other / one)
    mean = float(difference.mean()) if count else math.nan
    nothing = (math.nan, math.nan)
    if count < MIN_PAIRS:
        return Agreement(
            count=count,
            bias=math.expm1(mean),
            bias_interval=nothing,
            std=math.nan,
            limits=nothing,
            limits_interval=nothing,
        )
    std = float(difference.std(ddof=1))
    quantile = float(special.stdtrit(count - 1, 0.975))
    of_mean = quantile * std / math.sqrt(count)
    limit = NORMAL_97_5 * std
    far = float(special.nctdtrit(count - 1, NORMAL_97_5 * math.sqrt(count), 0.975)) * std / math.sqrt(count)
    around = {"bias_interval": of_mean, "limits": limit, "limits_interval": far}
    return Agreement(
        count=count,
        bias=math.expm1(mean),
        std=std,
        **{name: (math.expm1(mean - half), math.expm1(mean + half)) for name, half in around.items()},
    )
