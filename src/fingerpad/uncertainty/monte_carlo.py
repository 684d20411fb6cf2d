"""Propagation by Monte Carlo, and validation of the linear approximation (GUM Supplement 1)."""

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri

from fingerpad._arrays import FloatArray
from fingerpad._display import Displayed
from fingerpad.exceptions import UncertaintyError
from fingerpad.uncertainty.covariance import covariance_of, covariance_root
from fingerpad.uncertainty.inputs import Inputs, Model, check_inputs, evaluate
from fingerpad.uncertainty.outputs import Outputs
from fingerpad.uncertainty.propagate import Propagated

_BATCH = 8192  # a power of two, which balances the points; about the 10 000 of GUM-S1 7.9.4
_TAIL = 0.025
_BITS = 30


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

    Examples
    --------
    >>> result = run_monte_carlo(lambda side: {"volume": side**3}, Inputs.of(side=(2.0, 0.1)), seed=1)
    >>> print(np.round(result["volume"].interval, 1), result.converged)
    [ 5.9 10.6] {'volume': True}
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
    random = np.random.default_rng(seed)
    batches: list[tuple[FloatArray, ...]] = []
    draws = 0
    while len(batches) < max(2, -(-min_draws // _BATCH)) or len(batches) * _BATCH < max_draws:
        drawn = mean + normal_points(_BATCH, mean.size, random) @ root.T
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


def normal_points(count: int, size: int, random: np.random.Generator) -> FloatArray:
    """Return standard normal points of a Sobol' sequence with a new scrambling, shape (count, size)."""
    from scipy.stats import qmc  # noqa: PLC0415 (slow to import, seldom needed)

    points = qmc.Sobol(size, bits=_BITS, rng=random.spawn(1)[0]).random(count)
    return np.asarray(ndtri(points + 0.5**_BITS / 2))  # never 0, whose quantile is infinite


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

    Examples
    --------
    >>> from fingerpad.uncertainty import propagate
    >>> inputs = Inputs.of(side=(2.0, 0.1))
    >>> def volume(side):
    ...     return {"volume": side**3}
    >>> checked = validate_linear_approximation(propagate(volume, inputs), run_monte_carlo(volume, inputs))
    >>> checked["volume"].valid, checked["volume"].tolerance
    (True, 0.5)
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
