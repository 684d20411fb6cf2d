"""Uncertainty budgets: which group of inputs contributes how much of an output's variance."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import qmc

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array
from fingerpad.exceptions import UncertaintyError
from fingerpad.uncertainty.covariance import covariance_of, covariance_root
from fingerpad.uncertainty.propagate import Model, Propagated

_REPEATS = 8


def variance_shares(
    propagated: Propagated, covariance: ArrayLike, groups: Mapping[str, Sequence[int]]
) -> FloatArray:
    """Return the share of each output's first-order variance that each group of inputs contributes.

    A group takes its own variance and half of its covariance with others, so that the shares of all inputs
    sum to one. A share is negative where a correlation makes the input reduce the variance.

    Parameters
    ----------
    propagated : Propagated
        From `propagate`.
    covariance : array_like, shape (..., n, n)
        The covariance that was propagated.
    groups : mapping
        From a group's name to the places of its inputs.

    Returns
    -------
    ndarray, shape (..., m, groups)
        NaN for an output without variance.

    Examples
    --------
    >>> import numpy as np
    >>> from fingerpad.uncertainty import propagate
    >>> covariance = np.diag([3.0, 1.0])
    >>> total = propagate(lambda x: x.sum(-1, keepdims=True), [0.0, 0.0], covariance)
    >>> variance_shares(total, covariance, {"first": [0], "second": [1]})
    array([[0.75, 0.25]])
    """
    jacobian = propagated.jacobian
    by_input = jacobian * (jacobian @ covariance_of(covariance)) + propagated.second_order**2
    with np.errstate(all="ignore"):
        shares = by_input / by_input.sum(axis=-1, keepdims=True)
    return np.stack([shares[..., list(places)].sum(axis=-1) for places in groups.values()], axis=-1)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SobolIndices:
    """Shares of the variance that need no linearity.

    Attributes
    ----------
    first, total : ndarray, shape (m, groups)
        Share of the variance that a group explains by itself, and with all its interactions.
    first_std, total_std : ndarray, shape (m, groups)
        Their standard errors.
    """

    first: FloatArray
    total: FloatArray
    first_std: FloatArray
    total_std: FloatArray


@np.errstate(all="ignore")
def sobol_indices(
    model: Model,
    mean: ArrayLike,
    covariance: ArrayLike,
    groups: Mapping[str, Sequence[int]],
    *,
    draws: int = 2048,
    seed: int = 0,
) -> SobolIndices:
    """Return Sobol's sensitivity indices of groups of normal inputs.

    First-order indices by the estimator of Saltelli et al. (2010), total ones by that of Jansen (1999), each
    from eight scrambled Sobol sequences of `draws` points, whose scatter is the standard error. Inputs may
    be correlated within a group, not between groups.

    Parameters
    ----------
    model, mean, covariance
        As for `run_monte_carlo`.
    groups : mapping
        From a group's name to the places of its inputs; every input with a variance belongs to one.
    draws : int
        Points per sequence, a power of two.
    seed : int
        Of the scrambling.

    Raises
    ------
    UncertaintyError
        If `covariance` is none, groups overlap, leave out an input that varies or correlate, or `draws` is
        not a power of two.

    Examples
    --------
    Ishigami's function in miniature: the product interacts, so that total exceeds first.

    >>> import numpy as np
    >>> product = sobol_indices(
    ...     lambda x: x.prod(-1, keepdims=True), [0.0, 1.0], np.eye(2), {"first": [0], "second": [1]}
    ... )
    >>> product.first.round(2) + 0.0, product.total.round(2)
    (array([[0.5, 0. ]]), array([[1. , 0.5]]))
    """
    mean, covariance = as_float_array(mean), covariance_of(covariance)
    places = [list(group) for group in groups.values()]
    _require_independent(covariance, groups)
    if draws < 2 or draws & (draws - 1):
        raise UncertaintyError(f"draws must be a power of two, found {draws}")
    factor = np.zeros_like(covariance)
    for group in places:
        factor[np.ix_(group, group)] = covariance_root(covariance[np.ix_(group, group)])
    size = mean.size

    def once(random: np.random.Generator) -> tuple[FloatArray, FloatArray]:
        normal = qmc.MultivariateNormalQMC(np.zeros(2 * size), rng=random).random(draws)
        inputs_a, inputs_b = mean + normal[:, :size] @ factor.T, mean + normal[:, size:] @ factor.T
        a, b = model(inputs_a), model(inputs_b)
        variance = np.concatenate([a, b]).var(axis=0)
        first, total = [], []
        for group in places:
            mixed = inputs_a.copy()
            mixed[:, group] = inputs_b[:, group]
            ab = model(mixed)
            first.append(((b - b.mean(axis=0)) * (ab - a)).mean(axis=0) / variance)
            total.append(0.5 * np.square(a - ab).mean(axis=0) / variance)
        return np.stack(first, axis=-1), np.stack(total, axis=-1)

    seeds = np.random.default_rng(seed).spawn(_REPEATS)
    first, total = (np.stack(parts) for parts in zip(*map(once, seeds), strict=True))
    return SobolIndices(
        first=first.mean(axis=0),
        total=total.mean(axis=0),
        first_std=first.std(axis=0, ddof=1) / np.sqrt(_REPEATS),
        total_std=total.std(axis=0, ddof=1) / np.sqrt(_REPEATS),
    )


def _require_independent(covariance: FloatArray, groups: Mapping[str, Sequence[int]]) -> None:
    owner = np.full(len(covariance), -1)
    for number, (name, group) in enumerate(groups.items()):
        taken = owner[list(group)] >= 0
        if taken.any():
            raise UncertaintyError(f"group {name!r} holds an input that another group holds already")
        owner[list(group)] = number
    left = (owner < 0) & (np.diagonal(covariance) > 0)
    if left.any():
        raise UncertaintyError(f"input {np.argmax(left)} varies and belongs to no group")
    between = (covariance != 0) & (owner[:, None] != owner[None, :])
    if between.any():
        row, column = np.argwhere(between)[0]
        raise UncertaintyError(
            f"inputs {row} and {column} are correlated but in different groups: put them into one"
        )
