"""Propagation by Monte Carlo (GUM Supplement 1), its comparison with the linear one, and Sobol' indices."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.special import ndtri

from fingerpad._arrays import FloatArray
from fingerpad._display import Displayed
from fingerpad.exceptions import UncertaintyError
from fingerpad.uncertainty.propagate import Propagated
from fingerpad.uncertainty.quantities import (
    Inputs,
    Model,
    Outputs,
    check_inputs,
    covariance_of,
    covariance_root,
    evaluate,
)

_BATCH = 8192  # a power of two, which balances the points; about the 10 000 of GUM-S1 7.9.4
_TAIL = 0.025
_BITS = 30
_MOST_KEPT = 2**18  # coordinates of a sequence that is kept for the next inputs: 2 MB
_REPEATS = 8


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class MonteCarloResult(Outputs):
    """Outputs of a model over draws of its inputs.

    Attributes
    ----------
    names, value, covariance, interval
        As in `Outputs`: mean and covariance of the draws, and probabilistically symmetric 95 % intervals.
    tolerance : ndarray, shape (m,)
        Twice the largest standard error among mean, standard deviation and the two ends of the interval.
    wanted_tolerance : ndarray, shape (m,)
        Half a unit of the last wanted digit of the standard uncertainty (GUM-S1 7.9.2).
    draws : int
        Number of draws with a finite output.
    undefined : int
        Number of draws for which the model had no finite output; they are left out.
    """

    tolerance: FloatArray
    wanted_tolerance: FloatArray
    draws: int
    undefined: int

    @property
    def converged(self) -> dict[str, bool]:
        """Whether the wanted digits are reached, by output."""
        reached = self.tolerance <= self.wanted_tolerance
        return dict(zip(self.names, map(bool, reached), strict=True))


@np.errstate(all="ignore")
def run_monte_carlo(
    model: Model,
    inputs: Inputs,
    *,
    digits: int = 2,
    min_draws: int = 40_000,
    max_draws: int = 1_000_000,
    seed: int = 0,
) -> MonteCarloResult:
    """Propagate normal inputs through `model` by Monte Carlo, until the wanted digits no longer change.

    The adaptive procedure of GUM-S1 7.9: batches of 8192 draws are added until twice the standard error
    of each output's mean, standard deviation and interval ends is below half a unit of the last wanted digit
    of the standard uncertainty, or `max_draws` draws are made: `MonteCarloResult.converged` says which.
    Memory does not grow with the number of draws.

    Each batch is a Sobol' sequence with a scrambling of its own (randomised quasi-Monte Carlo): its points
    fill the space of the inputs more evenly than independent draws, so that a tenth of them suffices, while
    the batches remain independent and their scatter tells the standard error.

    Parameters
    ----------
    model : callable
        As for `propagate`; it need not be analytic.
    inputs : Inputs
        Best estimates and their covariance, one set.
    digits : int
        Significant digits wanted of the standard uncertainty.
    min_draws, max_draws : int
        Smallest and largest number of draws, rounded up to whole batches.
    seed : int
        Of the scrambling: the same seed gives the same result.

    Returns
    -------
    MonteCarloResult

    Raises
    ------
    UncertaintyError
        If the model takes other inputs, the covariance is not one, there are several sets of inputs, a limit
        is out of range, or the model has no finite output for most draws.
    GeometryError
        If an input whose name ends in ``_angle`` cannot be one in radians.

    Examples
    --------
    >>> result = run_monte_carlo(lambda side: {"volume": side**3}, Inputs.of(side=(2.0, 0.1)))
    >>> print(f"{result['volume']:.1f}")
    8.1 ± 1.2
    """
    check_inputs(model, inputs)
    mean = inputs.mean
    if mean.ndim != 1:
        raise UncertaintyError(f"Monte Carlo takes one set of inputs, found the shape {mean.shape[:-1]}")
    root = covariance_root(covariance_of(inputs.covariance))
    if not (digits >= 1 and 0 < min_draws <= max_draws):
        raise UncertaintyError(
            "digits must be at least 1 and min_draws at most max_draws, "
            f"found {digits}, {min_draws}, {max_draws}"
        )
    batches: list[tuple[FloatArray, ...]] = []
    draws = 0
    while len(batches) < max(2, -(-min_draws // _BATCH)) or len(batches) * _BATCH < max_draws:
        drawn = mean + _normal_points(_BATCH, mean.size, seed, len(batches)) @ root.T
        names, outputs = evaluate(model, inputs.names, drawn)
        outputs = outputs[np.isfinite(outputs).all(axis=-1)]
        if 2 * len(outputs) < _BATCH:
            raise UncertaintyError(
                f"the model has no finite output for {_BATCH - len(outputs)} of {_BATCH} draws: "
                "are the standard uncertainties in the units of the means?"
            )
        batches.append(_batch_statistics(outputs))
        draws += len(outputs)
        if len(batches) >= max(2, -(-min_draws // _BATCH)):
            result = _combined(names, batches, draws, digits)
            if all(result.converged.values()):
                return result
    return _combined(names, batches, draws, digits)


def _normal_points(count: int, size: int, seed: int, number: int) -> FloatArray:
    """Return standard normal points of a Sobol' sequence with a scrambling of its own, shape (count, size).

    Few are kept: with one seed all contacts of a study have the same. They are to read only.
    """
    draw = _drawn_once if count * size <= _MOST_KEPT else _drawn
    return draw(count, size, seed, number)


def _drawn(count: int, size: int, seed: int, number: int) -> FloatArray:
    from scipy.stats import qmc  # noqa: PLC0415 (slow to import, seldom needed)

    random = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(number,)))
    points = qmc.Sobol(size, bits=_BITS, rng=random).random(count)
    drawn = np.asarray(ndtri(points + 0.5**_BITS / 2))  # never 0, whose quantile is infinite
    drawn.flags.writeable = False
    return drawn


_drawn_once = lru_cache(maxsize=32)(_drawn)


def _batch_statistics(outputs: FloatArray) -> tuple[FloatArray, ...]:
    """Return mean, covariance and the two interval ends of one batch."""
    rows = np.ascontiguousarray(outputs.T)
    centre = rows.mean(axis=-1)
    off = rows - centre[:, None]
    lower, upper = np.quantile(rows, (_TAIL, 1 - _TAIL), axis=-1, method="hazen")
    return centre, off @ off.T / (len(outputs) - 1), lower, upper


def _combined(
    names: tuple[str, ...], batches: list[tuple[FloatArray, ...]], draws: int, digits: int
) -> MonteCarloResult:
    """Return all batches as one result, with the scatter of the batches as its tolerance."""
    means, covariances, lower, upper = (np.stack(parts) for parts in zip(*batches, strict=True))
    stds = np.sqrt(np.diagonal(covariances, axis1=-2, axis2=-1))
    shift = means - means.mean(axis=0)
    covariance = covariances.mean(axis=0) + shift.T @ shift / len(batches)
    scatter = np.stack([x.std(axis=0, ddof=1) for x in (means, stds, lower, upper)])
    return MonteCarloResult(
        names=names,
        value=means.mean(axis=0),
        covariance=covariance,
        interval=np.stack([lower.mean(axis=0), upper.mean(axis=0)], axis=-1),
        tolerance=2 * scatter.max(axis=0) / np.sqrt(len(batches)),
        wanted_tolerance=_half_unit(np.sqrt(np.diagonal(covariance)), digits),
        draws=draws,
        undefined=len(batches) * _BATCH - draws,
    )


def _half_unit(std: FloatArray, digits: int) -> FloatArray:
    """Return half a unit of the last of `digits` significant digits of each standard uncertainty."""
    exponent = np.floor(np.log10(np.where(std > 0, std, 1.0)))
    return np.where(std > 0, 0.5 * 10.0 ** (exponent + 1 - digits), 0.0)


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Validation(Displayed):
    """The first-order 95 % interval of an output compared with the simulated one (GUM-S1, clause 8).

    Attributes
    ----------
    lower_difference, upper_difference : float
        Absolute differences of the ends of the two intervals.
    tolerance : float
        Half a unit of the last wanted digit of the standard uncertainty.
    """

    lower_difference: float
    upper_difference: float
    tolerance: float

    @property
    def valid(self) -> bool:
        """Whether the linear approximation is valid."""
        return max(self.lower_difference, self.upper_difference) <= self.tolerance


def validate_linear_approximation(
    first: Propagated, simulated: MonteCarloResult, *, digits: int = 1
) -> dict[str, Validation]:
    """Compare first-order propagation with a simulation of the same model and inputs.

    Parameters
    ----------
    first : Propagated
        From `propagate`, of one set of inputs.
    simulated : MonteCarloResult
        From `run_monte_carlo`.
    digits : int
        Significant digits of the standard uncertainty that must agree.

    Returns
    -------
    dict of str to Validation
        By output.

    Examples
    --------
    A square is linear enough 20 standard uncertainties from zero, not at zero:

    >>> from fingerpad.uncertainty import propagate
    >>> def square(x):
    ...     return {"square": x**2}
    >>> def valid(mean):
    ...     inputs = Inputs.of(x=(mean, 1.0))
    ...     first, simulated = propagate(square, inputs), run_monte_carlo(square, inputs)
    ...     return validate_linear_approximation(first, simulated)["square"].valid
    >>> valid(20.0), valid(0.0)
    (True, False)
    """
    difference = np.abs(first.interval - simulated.interval)
    columns = (*difference.T, _half_unit(first.std, digits))
    return {
        name: Validation(lower_difference=float(lower), upper_difference=float(upper), tolerance=float(most))
        for name, lower, upper, most in zip(first.names, *columns, strict=True)
    }


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class SobolIndices(Displayed):
    """Sobol indices of one output, by source.

    Attributes
    ----------
    first, total : dict of str to float
        Share of the variance that a source explains on its own, and with all its interactions.
    first_std, total_std : dict of str to float
        Their standard errors.
    """

    first: dict[str, float]
    total: dict[str, float]
    first_std: dict[str, float]
    total_std: dict[str, float]


@np.errstate(all="ignore")
def sobol_indices(
    model: Model, inputs: Inputs, *, draws: int = 2048, seed: int = 0
) -> dict[str, SobolIndices]:
    """Return the Sobol sensitivity indices of groups of normal inputs.

    First-order indices by the estimator of Saltelli et al. (2010), total ones by that of Jansen (1999), each
    from eight scrambled Sobol sequences of `draws` points, whose scatter is the standard error. Inputs may
    be correlated within a group, not between groups.

    Parameters
    ----------
    model : callable
        As for `run_monte_carlo`.
    inputs : Inputs
        One set; every input with a variance belongs to one of ``inputs.groups``.
    draws : int
        Points per sequence, a power of two.
    seed : int
        Of the scrambling.

    Returns
    -------
    dict of str to SobolIndices
        By output.

    Raises
    ------
    UncertaintyError
        If the model takes other inputs, the covariance is not one, groups overlap, leave out an input with a
        variance or correlate, or `draws` is not a power of two.
    GeometryError
        If an input whose name ends in ``_angle`` cannot be one in radians.

    Examples
    --------
    A product interacts, so that total indices exceed first-order ones:

    >>> inputs = Inputs.of(a=(0.0, 1.0), b=(1.0, 1.0))
    >>> product = sobol_indices(lambda a, b: {"product": a * b}, inputs)["product"]
    >>> {name: round(share, 2) for name, share in product.total.items()}
    {'a': 1.0, 'b': 0.5}
    >>> round(product.first["a"], 2)
    0.5
    """
    check_inputs(model, inputs)
    mean, covariance = inputs.mean, covariance_of(inputs.covariance)
    _require_independent(inputs)
    if draws < 2 or draws & (draws - 1):
        raise UncertaintyError(f"draws must be a power of two, found {draws}")
    places = [inputs.places(group) for group in inputs.groups.values()]
    root = np.zeros_like(covariance)
    for group in places:
        root[np.ix_(group, group)] = covariance_root(covariance[np.ix_(group, group)])
    size = mean.size
    outputs, _ = evaluate(model, inputs.names, mean)

    def at(points: FloatArray) -> FloatArray:
        return evaluate(model, inputs.names, points)[1]

    def once(number: int) -> tuple[FloatArray, FloatArray]:
        normal = _normal_points(draws, 2 * size, seed, number)
        inputs_a, inputs_b = mean + normal[:, :size] @ root.T, mean + normal[:, size:] @ root.T
        a, b = at(inputs_a), at(inputs_b)
        variance = np.concatenate([a, b]).var(axis=0)
        first, total = [], []
        for group in places:
            mixed = inputs_a.copy()
            mixed[:, group] = inputs_b[:, group]
            ab = a if (mixed == inputs_a).all() else at(mixed)  # a group without variance changes nothing
            first.append(((b - b.mean(axis=0)) * (ab - a)).mean(axis=0) / variance)
            total.append(0.5 * np.square(a - ab).mean(axis=0) / variance)
        return np.stack(first, axis=-1), np.stack(total, axis=-1)

    first, total = (np.stack(parts) for parts in zip(*map(once, range(_REPEATS)), strict=True))

    def by_source(shares: FloatArray) -> dict[str, float]:
        return dict(zip(inputs.groups, map(float, shares), strict=True))

    return {
        output: SobolIndices(
            first=by_source(first.mean(axis=0)[place]),
            total=by_source(total.mean(axis=0)[place]),
            first_std=by_source(first.std(axis=0, ddof=1)[place] / np.sqrt(_REPEATS)),
            total_std=by_source(total.std(axis=0, ddof=1)[place] / np.sqrt(_REPEATS)),
        )
        for place, output in enumerate(outputs)
    }


def _require_independent(inputs: Inputs) -> None:
    """Refuse groups that overlap, correlate, or leave out an input with a variance."""
    source: dict[str, str] = {}
    for name, group in inputs.groups.items():
        for each in group:
            if each in source:
                raise UncertaintyError(f"input {each!r} is in two groups, {source[each]!r} and {name!r}")
            source[each] = name
    for row, one in enumerate(inputs.names):
        if inputs.covariance[row, row] > 0 and one not in source:
            raise UncertaintyError(f"input {one!r} has a variance and belongs to no group")
        for column, other in enumerate(inputs.names[:row]):
            if inputs.covariance[row, column] != 0 and source[one] != source[other]:
                raise UncertaintyError(
                    f"inputs {other!r} and {one!r} are correlated but in different groups: "
                    "put them into one group"
                )
