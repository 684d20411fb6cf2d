"""Scatter: of repeats and of what they are nested in, and of two persons or methods about each other."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np
import numpy.typing as npt
from scipy import special

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array, check_all
from fingerpad._display import Displayed
from fingerpad.exceptions import UncertaintyError
from fingerpad.uncertainty.propagate import NORMAL_97_5

REPEAT: Final = "repeat"
# Below these degrees of freedom a standard deviation is known to no better than a factor of four or six.
MIN_REPEAT_FREEDOM: Final = 3
MIN_LEVEL_FREEDOM: Final = 2
# Two values differ by no more standard deviations in 95 % of cases.
LIMIT_FACTOR: Final = NORMAL_97_5 * 2**0.5

# With fewer pairs a standard deviation says nothing.
MIN_PAIRS: Final = 3

_LEVELS: Final = (0.025, 0.975)
_DRAWS: Final = 5_000


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class ScatterComponent(Displayed):
    """The standard deviation that one level adds.

    Attributes
    ----------
    std : float
        The standard deviation; NaN without enough degrees of freedom.
    interval : (float, float)
        Its 95 % confidence interval; NaN with `std`.
    freedom : int
        Degrees of freedom.
    groups, count : int
        Groups of two and more members, and members of these groups.
    includes : tuple of str
        Levels below that cannot be separated from this one.
    """

    std: float
    interval: tuple[float, float]
    freedom: int
    groups: int
    count: int
    includes: tuple[str, ...] = ()

    @property
    def known(self) -> bool:
        """Whether there are enough degrees of freedom."""
        return bool(np.isfinite(self.std))

    @property
    def limit_of_agreement(self) -> float:
        """By how much two members of a group differ at most in 95 % of cases: 1.96 √2 standard deviations."""
        return LIMIT_FACTOR * self.std


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class NestedScatter(Displayed):
    """Variance components of nested values.

    Attributes
    ----------
    components : dict of str to ScatterComponent
        By level, the outermost first, with ``"repeat"`` last.
    icc : float
        Intraclass correlation: share of the outer levels in the variance of one value; NaN if not known, or
        if one of them has groups to compare, and too few.
    icc_interval : (float, float)
        Its 95 % confidence interval.
    """

    components: dict[str, ScatterComponent]
    icc: float
    icc_interval: tuple[float, float]


def nested_scatter(
    values: ArrayLike,
    levels: Mapping[str, ArrayLike],
    conditions: ArrayLike | None = None,
    between: tuple[str, ...] = (),
    *,
    least_freedom: tuple[int, int] = (MIN_REPEAT_FREEDOM, MIN_LEVEL_FREEDOM),
) -> NestedScatter:
    r"""Split the variance of values into that of repeats and of the levels in which they are nested.

    Analysis of variance with unweighted means (Thomas and Hultquist): the mean square :math:`S_l^2` of the
    means at a level has the expectation :math:`\sigma_l^2 + \sum_{j<l} a_{lj}\sigma_j^2`, where the
    :math:`a_{lj}` follow from the numbers of members. Intervals are those of the generalised pivotal
    quantities :math:`\nu_l S_l^2/\chi^2_{\nu_l} - \sum_{j<l} a_{lj}\sigma_j^2`, exact for repeats. A
    variance that comes out negative is stated as zero.

    Parameters
    ----------
    values : array_like, shape (n,)
        Values that scatter alike at all levels: logarithms, where it is their ratio that does.
    levels : mapping of str to array_like, shape (n,)
        Group of each value at each level, the outermost first; a group is one of the group above it.
    conditions : array_like, shape (n,), optional
        Condition of each value, such as its load; only values of one condition are compared. A level other
        than that of repeats has the degrees of freedom of its groups, in however many conditions these are.
    between : tuple of str, optional
        Levels that count as wanted differences in the intraclass correlation; by default all.
    least_freedom : (int, int)
        Degrees of freedom below which the scatter of repeats, and that of a level, is not stated.

    Returns
    -------
    NestedScatter
        A level with too few groups is not known, and part of the level above it; without enough repeats
        nothing is known.

    Raises
    ------
    UncertaintyError
        If a value is not finite or lacks a group.

    Examples
    --------
    >>> scatter = nested_scatter(
    ...     [0.0, 0.1, 0.1, 1.0, 1.1, 1.0, 2.0, 2.1, 2.1], {"finger": [0, 0, 0, 1, 1, 1, 2, 2, 2]}
    ... )
    >>> for level, one in scatter.components.items():
    ...     print(f"{level}: {one.std:.2f}, 95 % {one.interval[0]:.2f} to {one.interval[1]:.1f}")
    finger: 1.00, 95 % 0.52 to 6.3
    repeat: 0.06, 95 % 0.04 to 0.1
    """
    values = as_float_array(values).reshape(-1)
    check_all(np.isfinite(values), "value", values, "finite", UncertaintyError)
    groups = [_numbers(conditions if conditions is not None else np.zeros(values.size), values.size)]
    units = []
    for of in levels.values():
        units.append(_numbers(of, values.size))
        groups.append(_within(groups[-1], units[-1]))
    squares = [_Squares.of_level(REPEAT, values, {}, groups[-1], np.bincount(groups[-1]))]
    mean, spread = _means(values, groups[-1]), {REPEAT: 1 / np.bincount(groups[-1])}
    for depth in range(len(units), 0, -1):
        inner, outer = groups[depth], groups[depth - 1]
        parent = np.empty(mean.size, dtype=np.intp)
        parent[inner] = outer
        name = tuple(levels)[depth - 1]
        above = units[depth - 2] if depth > 1 else np.zeros(values.size, dtype=np.intp)
        squares.append(_Squares.of_level(name, mean, spread, parent, _members(units[depth - 1], above)))
        size = np.bincount(parent)
        mean = np.bincount(parent, mean) / size
        spread = {key: np.bincount(parent, of) / size**2 for key, of in spread.items()} | {name: 1 / size}
    return _solved(squares, between or tuple(levels), least_freedom)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Squares:
    """The mean square of one level, and what lower levels add to its expectation."""

    level: str
    mean_square: float
    freedom: int
    groups: int
    count: int
    added: dict[str, float]

    @classmethod
    def of_level(
        cls,
        level: str,
        mean: FloatArray,
        spread: Mapping[str, FloatArray],
        parent: npt.NDArray[np.intp],
        members: npt.NDArray[np.intp],
    ) -> _Squares:
        """Return those of means within their parents; `members` counts the distinct units of each group."""
        size = np.bincount(parent)
        compared = int(mean.size - size.size)
        weight = (size - 1) / size / max(compared, 1)
        squares = float(np.sum((mean - _means(mean, parent)[parent]) ** 2))
        return cls(
            level=level,
            mean_square=squares / max(compared, 1),
            freedom=min(compared, int(np.sum(members - 1))),
            groups=int(np.sum(members > 1)),
            count=int(members[members > 1].sum()),
            added={key: float(weight @ np.bincount(parent, of)) for key, of in spread.items()},
        )


def _solved(
    squares: list[_Squares], between: tuple[str, ...], least_freedom: tuple[int, int]
) -> NestedScatter:
    """Return the components from the mean squares, the innermost first."""
    random = np.random.default_rng(0)
    variance: dict[str, float] = {}
    pivots: dict[str, FloatArray] = {}
    components: dict[str, ScatterComponent] = {}
    unknown: tuple[str, ...] = ()
    for one in squares:
        std, interval, includes = np.nan, (np.nan, np.nan), unknown
        enough = one.freedom >= least_freedom[one.level != REPEAT]
        if enough and REPEAT not in unknown:
            below = {level: by for level, by in one.added.items() if level in variance}
            expected = float(sum(by * variance[level] for level, by in below.items()))
            inner = np.asarray(sum(by * pivots[level] for level, by in below.items()))
            variance[one.level] = one.mean_square - expected
            chi_square = random.permutation(_chi_squares(one.freedom))
            pivots[one.level] = one.freedom * one.mean_square / chi_square - inner
            std = float(np.sqrt(max(0.0, variance[one.level])))
            interval = _exact_interval(one) if one.level == REPEAT else _interval(pivots[one.level])
            if interval[1] <= 0:  # of a mean square far too small no pivot is left: that of zero
                interval = _interval(one.freedom * expected / chi_square - inner)
            unknown = ()
        else:
            includes, unknown = (), (*unknown, one.level)
        components[one.level] = ScatterComponent(
            std=std,
            interval=interval,
            freedom=one.freedom,
            groups=one.groups,
            count=one.count,
            includes=includes,
        )
    outer = [level for level in variance if level in between]
    icc, ends_of_icc = np.nan, (np.nan, np.nan)
    if outer and not any(components[level].groups for level in unknown):
        icc, ends_of_icc = _intraclass_correlation(variance, pivots, outer)
    return NestedScatter(components=dict(reversed(components.items())), icc=icc, icc_interval=ends_of_icc)


@lru_cache(maxsize=256)
def _chi_squares(freedom: int) -> FloatArray:
    """Return quantiles of χ² at the middles of equal shares: what takes the time of a component."""
    return as_float_array(special.chdtri(freedom, (np.arange(_DRAWS) + 0.5) / _DRAWS))


def _interval(pivot: FloatArray) -> tuple[float, float]:
    """Return the interval of a standard deviation from draws of its square."""
    low, high = np.sqrt(np.maximum(np.quantile(pivot, _LEVELS), 0))
    return float(low), float(high)


def _exact_interval(one: _Squares) -> tuple[float, float]:
    low, high = np.sqrt(one.freedom * one.mean_square / special.chdtri(one.freedom, _LEVELS))
    return float(low), float(high)


def _intraclass_correlation(
    variance: Mapping[str, float], pivots: Mapping[str, FloatArray], outer: Sequence[str]
) -> tuple[float, tuple[float, float]]:
    """Return the share of the outer levels in the whole variance, with its interval."""
    found = {level: max(0.0, of) for level, of in variance.items()}
    drawn = {level: np.maximum(of, 0) for level, of in pivots.items()}
    total = sum(found.values())
    if total == 0:
        return np.nan, (np.nan, np.nan)
    shares = sum(drawn[level] for level in outer) / sum(drawn.values())
    low, high = np.quantile(shares, _LEVELS)
    return sum(found[level] for level in outer) / total, (float(low), float(high))


def _numbers(groups: ArrayLike, size: int) -> npt.NDArray[np.intp]:
    """Return groups as numbers from 0."""
    numbers = np.unique(np.asarray(groups).reshape(-1), return_inverse=True)[1].reshape(-1)
    if numbers.size != size:
        raise UncertaintyError(f"each value needs its group, found {size} and {numbers.size}")
    return numbers


def _within(outer: npt.NDArray[np.intp], inner: npt.NDArray[np.intp]) -> npt.NDArray[np.intp]:
    """Return the number of each pair of groups."""
    pairs = outer * (inner.max(initial=0) + 1) + inner
    return np.unique(pairs, return_inverse=True)[1].reshape(-1)


def _means(values: FloatArray, group: npt.NDArray[np.intp]) -> FloatArray:
    return as_float_array(np.bincount(group, values) / np.bincount(group))


def _members(unit: npt.NDArray[np.intp], above: npt.NDArray[np.intp]) -> npt.NDArray[np.intp]:
    """Return the number of distinct units in each group of the level above."""
    pairs = np.unique(np.stack([above, unit], axis=-1), axis=0)
    return np.unique(pairs[:, 0], return_counts=True)[1]


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
