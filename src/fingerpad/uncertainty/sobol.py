"""Sobol sensitivity indices: how much of an output's variance each source explains, without linearity."""

from dataclasses import dataclass

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad._display import Displayed
from fingerpad.exceptions import UncertaintyError
from fingerpad.uncertainty.covariance import covariance_of, covariance_root
from fingerpad.uncertainty.inputs import Inputs, Model, check_inputs, evaluate
from fingerpad.uncertainty.monte_carlo import normal_points

_REPEATS = 8


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class SobolIndices(Displayed):
    """Sobol indices of one output, by source.

    Attributes
    ----------
    first, total : dict of str to float
        Share of the variance that a source explains on its own, and with all its interactions.
    first_std, total_std : dict of str to float
        Their standard errors.

    Examples
    --------
    A sum has no interactions: the first-order indices sum to one.

    >>> inputs = Inputs.of(a=(0.0, 1.0), b=(0.0, 2.0))
    >>> indices = sobol_indices(lambda a, b: {"sum": a + b}, inputs, draws=256)["sum"]
    >>> {name: round(share, 2) for name, share in indices.first.items()}
    {'a': 0.2, 'b': 0.8}
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

    random = np.random.default_rng(seed)

    def once() -> tuple[FloatArray, FloatArray]:
        normal = normal_points(draws, 2 * size, random)
        inputs_a, inputs_b = mean + normal[:, :size] @ root.T, mean + normal[:, size:] @ root.T
        a, b = at(inputs_a), at(inputs_b)
        variance = np.concatenate([a, b]).var(axis=0)
        first, total = [], []
        for group in places:
            mixed = inputs_a.copy()
            mixed[:, group] = inputs_b[:, group]
            ab = at(mixed)
            first.append(((b - b.mean(axis=0)) * (ab - a)).mean(axis=0) / variance)
            total.append(0.5 * np.square(a - ab).mean(axis=0) / variance)
        return np.stack(first, axis=-1), np.stack(total, axis=-1)

    first, total = (np.stack(parts) for parts in zip(*(once() for _ in range(_REPEATS)), strict=True))

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
