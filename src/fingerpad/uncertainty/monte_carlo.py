"""Propagation by Monte Carlo, and the check of the first order against it (GUM Supplement 1)."""

from dataclasses import dataclass

import numpy as np

from fingerpad._arrays import ArrayLike, BoolArray, FloatArray, as_float_array
from fingerpad.exceptions import UncertaintyError
from fingerpad.uncertainty.covariance import covariance_of, covariance_root
from fingerpad.uncertainty.propagate import Model, Propagated

_BATCH = 10_000  # GUM-S1 7.9.4, for a 95 % interval
_TAIL = 0.025


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MonteCarloResult:
    """A model's outputs over draws of its inputs.

    Attributes
    ----------
    value : ndarray, shape (m,)
        Mean of the draws.
    covariance : ndarray, shape (m, m)
        Their covariance.
    interval : ndarray, shape (m, 2)
        Ends of the probabilistically symmetric 95 % interval.
    tolerance : ndarray, shape (m,)
        Twice the standard error of the least well known of mean, standard deviation and the two ends.
    wanted_tolerance : ndarray, shape (m,)
        Half a unit of the last wanted digit of the standard uncertainty (GUM-S1 7.9.2).
    draws : int
        Number of draws with an answer.
    undefined : int
        Number of draws for which the model had no finite answer; they are left out.
    """

    value: FloatArray
    covariance: FloatArray
    interval: FloatArray
    tolerance: FloatArray
    wanted_tolerance: FloatArray
    draws: int
    undefined: int

    @property
    def std(self) -> FloatArray:
        """Standard uncertainty of each output, shape (m,)."""
        return np.sqrt(np.diagonal(self.covariance))

    @property
    def converged(self) -> BoolArray:
        """Whether the wanted digits of each output are reached, shape (m,)."""
        return self.tolerance <= self.wanted_tolerance


@np.errstate(all="ignore")
def run_monte_carlo(
    model: Model,
    mean: ArrayLike,
    covariance: ArrayLike,
    *,
    digits: int = 2,
    min_draws: int = 20_000,
    max_draws: int = 1_000_000,
    seed: int = 0,
) -> MonteCarloResult:
    """Propagate normal inputs through `model` by Monte Carlo, until the wanted digits stand still.

    The adaptive procedure of GUM-S1 7.9: batches of 10 000 draws are added until twice the standard error
    of each output's mean, standard deviation and interval ends is below half a unit of the last wanted digit
    of the standard uncertainty, or `max_draws` draws are made: `MonteCarloResult.converged` says which.
    Memory does not grow with the number of draws.

    Parameters
    ----------
    model : callable
        As for `propagate`; it need not be analytic.
    mean : array_like, shape (n,)
        Best estimates of the inputs.
    covariance : array_like, shape (n, n)
        Their covariance.
    digits : int
        Significant digits wanted of the standard uncertainty.
    min_draws, max_draws : int
        Fewest and most draws, in whole batches.
    seed : int
        Of the random numbers: the same seed gives the same result.

    Returns
    -------
    Simulated

    Raises
    ------
    UncertaintyError
        If `covariance` is none, a limit is not sensible, or the model has no answer for most draws.

    Examples
    --------
    >>> import numpy as np
    >>> cube = run_monte_carlo(lambda x: x**3, [2.0], [[0.1**2]])
    >>> print(f"{cube.value[0]:.1f} ± {cube.std[0]:.1f}")
    8.1 ± 1.2
    """
    mean, factor = as_float_array(mean), covariance_root(covariance_of(covariance))
    if mean.ndim != 1 or factor.shape != (mean.size, mean.size):
        raise UncertaintyError(f"means of shape {mean.shape} do not fit a covariance of {factor.shape}")
    if not (digits >= 1 and 0 < min_draws <= max_draws):
        raise UncertaintyError(
            "digits must be at least 1 and min_draws at most max_draws, "
            f"found {digits}, {min_draws}, {max_draws}"
        )
    random = np.random.default_rng(seed)
    batches: list[tuple[FloatArray, ...]] = []
    draws = 0
    while len(batches) < max(2, -(-min_draws // _BATCH)) or len(batches) * _BATCH < max_draws:
        outputs = model(mean + random.standard_normal((_BATCH, mean.size)) @ factor.T)
        outputs = outputs[np.isfinite(outputs).all(axis=-1)]
        if 2 * len(outputs) < _BATCH:
            raise UncertaintyError(
                f"the model has no answer for {_BATCH - len(outputs)} of {_BATCH} draws: "
                "are the standard uncertainties in the units of the means?"
            )
        batches.append(_described(outputs))
        draws += len(outputs)
        if len(batches) >= max(2, -(-min_draws // _BATCH)):
            result = _summed(batches, draws, digits)
            if result.converged.all():
                return result
    return _summed(batches, draws, digits)


def _described(outputs: FloatArray) -> tuple[FloatArray, ...]:
    """Return mean, covariance and the two interval ends of one batch."""
    rows = np.ascontiguousarray(outputs.T)
    centre = rows.mean(axis=-1)
    off = rows - centre[:, None]
    ordered = np.sort(rows, axis=-1)
    lower, upper = round(_TAIL * len(outputs)), round((1 - _TAIL) * len(outputs)) - 1
    return centre, off @ off.T / (len(outputs) - 1), ordered[:, lower], ordered[:, upper]


def _summed(batches: list[tuple[FloatArray, ...]], draws: int, digits: int) -> MonteCarloResult:
    """Return all batches as one result, with the scatter of the batches as its tolerance."""
    means, covariances, lower, upper = (np.stack(parts) for parts in zip(*batches, strict=True))
    stds = np.sqrt(np.diagonal(covariances, axis1=-2, axis2=-1))
    shift = means - means.mean(axis=0)
    covariance = covariances.mean(axis=0) + shift.T @ shift / len(batches)
    scatter = np.stack([x.std(axis=0, ddof=1) for x in (means, stds, lower, upper)])
    return MonteCarloResult(
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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Validation:
    """The first-order 95 % interval held against the simulated one (GUM-S1, clause 8).

    Attributes
    ----------
    lower_difference, upper_difference : ndarray, shape (m,)
        By how much the ends of the two intervals differ.
    tolerance : ndarray, shape (m,)
        Half a unit of the last wanted digit of the standard uncertainty.
    """

    lower_difference: FloatArray
    upper_difference: FloatArray
    tolerance: FloatArray

    @property
    def valid(self) -> BoolArray:
        """Whether the first order will do for each output, shape (m,)."""
        return np.maximum(self.lower_difference, self.upper_difference) <= self.tolerance


def validate_linear_approximation(
    first: Propagated, simulated: MonteCarloResult, *, digits: int = 1
) -> Validation:
    """Compare first-order propagation with a simulation of the same model and inputs.

    Parameters
    ----------
    first : Propagated
        From `propagate`, of one set of inputs.
    simulated : Simulated
        From `run_monte_carlo`.
    digits : int
        Significant digits of the standard uncertainty that must agree.

    Examples
    --------
    A square is linear enough 20 standard uncertainties from zero, not at zero:

    >>> import numpy as np
    >>> from fingerpad.uncertainty import propagate
    >>> def valid(mean):
    ...     first = propagate(np.square, [mean], [[1.0]])
    ...     drawn = run_monte_carlo(np.square, [mean], [[1.0]])
    ...     return bool(validate_linear_approximation(first, drawn).valid[0])
    >>> valid(20.0), valid(0.0)
    (True, False)
    """
    difference = np.abs(first.interval - simulated.interval)
    return Validation(
        lower_difference=difference[..., 0],
        upper_difference=difference[..., 1],
        tolerance=_half_unit(first.std, digits),
    )
