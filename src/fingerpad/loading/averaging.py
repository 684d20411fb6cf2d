"""One quantity by several models: their weights, and the average with the uncertainty of the choice."""

import math
from collections.abc import Sequence

import numpy as np
from scipy import optimize, special

from fingerpad._arrays import FloatArray
from fingerpad.estimate import Estimate


def akaike_weights(criteria: Sequence[float]) -> list[float]:
    """Return the weights exp(−Δ/2) of models, with sum 1, from their AICc (Burnham and Anderson 2002, 2.9).

    Parameters
    ----------
    criteria : sequence of float
        AICc of each model, under one noise; infinite for one without weight, but not for all.

    Returns
    -------
    list of float
        In the same order.

    Examples
    --------
    >>> [round(weight, 3) for weight in akaike_weights([100.0, 102.0, 110.0])]
    [0.727, 0.268, 0.005]
    """
    likelihood = np.exp((min(criteria) - np.asarray(criteria)) / 2)
    return [float(weight) for weight in likelihood / likelihood.sum()]


def average_models(
    models: Sequence[Estimate], weights: Sequence[float], *, value: float | None = None
) -> Estimate:
    """Return a quantity with the uncertainty of all its models (Burnham and Anderson 2002, 4.3).

    Together the models give a mixture of their distributions, each with its weight w. Its mean is Σ w θ,
    its variance Σ w (u² + (θ − value)²), and its interval lies between its 2.5 and 97.5 % points.

    Parameters
    ----------
    models : sequence of Estimate
        The quantity θ ± u by each model.
    weights : sequence of float
        Of the models, as `akaike_weights`; their sum is 1.
    value : float, optional
        What the uncertainty is stated of, as the value of one chosen model; the mean without it. Variance and
        interval are then those about it: the interval holds it.

    Returns
    -------
    Estimate
        Where a model of considerable weight leaves an end of its interval open, this one is open too.

    Examples
    --------
    >>> models = [Estimate.symmetric(40.0, 1.0), Estimate.symmetric(44.0, 1.0)]
    >>> both = average_models(models, [0.75, 0.25])
    >>> print(f"{both}, {both.lower:.1f} to {both.upper:.1f}")
    41.0 ± 2.0, 38.2 to 45.3
    >>> chosen = average_models(models, [0.75, 0.25], value=40.0)
    >>> print(f"{chosen}, {chosen.lower:.1f} to {chosen.upper:.1f}")
    40.0 ± 2.2, 38.2 to 45.3
    """
    theta, std, lower, upper, w = np.array(
        [
            (one.value, one.std, one.lower, one.upper, weight)
            for one, weight in zip(models, weights, strict=True)
        ]
    ).T
    stated = float(w @ theta) if value is None else value
    # Each distribution is normal on either side of its value, as wide there as its interval.
    half = float(special.ndtri(0.975))
    below, above = (np.maximum(width / half, 1e-300) for width in (theta - lower, upper - theta))

    def share(at: float) -> float:
        """Return how much of the mixture lies below."""
        apart = at - theta
        return float(w @ special.ndtr(apart / np.where(apart < 0, below, above)))

    def point(wanted: float, ends: FloatArray) -> float:
        """Return where that share is reached, between the ends of the models' own intervals."""
        out = 1.0 if wanted > 0.5 else -1.0
        is_open = np.isinf(ends)
        if float(w @ is_open) / 2 >= 0.025:
            return out * math.inf
        near, far = float(np.min(out * ends)), float(np.max(out * ends, where=~is_open, initial=-math.inf))
        step = far - near or abs(far) or 1.0
        while out * (share(out * far) - wanted) < 0:
            far, step = far + step, 2 * step
        while out * (share(out * near) - wanted) > 0:
            near, step = near - step, 2 * step
        return float(optimize.brentq(lambda at: share(at) - wanted, out * near, out * far))

    return Estimate(
        value=stated,
        std=math.sqrt(float(w @ (std**2 + (theta - stated) ** 2))),
        interval=(min(stated, point(0.025, lower)), max(stated, point(0.975, upper))),
    )
