"""A quantity with its uncertainty, or the reason why the data do not determine it."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from scipy import optimize, special

from fingerpad._arrays import FloatArray
from fingerpad._display import Displayed
from fingerpad._rounding import value_with_uncertainty


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Estimate(Displayed):
    """A value with its standard uncertainty and 95 % interval (GUM, 2.3).

    Attributes
    ----------
    value, std : float
        Estimate and standard uncertainty.
    lower, upper : float
        Ends of the 95 % interval, which need not lie evenly about the value.

    Examples
    --------
    >>> radius = Estimate.symmetric(20.5, 0.3)
    >>> print(f"{radius.lower:.2f} to {radius.upper:.2f} mm")
    19.91 to 21.09 mm
    """

    value: float
    std: float
    lower: float
    upper: float

    def __str__(self) -> str:
        return value_with_uncertainty(self.value, self.std)

    @classmethod
    def symmetric(cls, value: float, std: float, degrees_of_freedom: float = math.inf) -> "Estimate":
        """Return an estimate whose interval is the value ± t times its standard uncertainty.

        Parameters
        ----------
        value, std : float
            Estimate and standard uncertainty.
        degrees_of_freedom : float
            Of Student's t; infinite for the normal distribution.

        Returns
        -------
        Estimate
            With its 95 % interval.

        Examples
        --------
        >>> print(f"{Estimate.symmetric(20.0, 1.0).upper:.2f}")
        21.96
        """
        half = float(special.stdtrit(degrees_of_freedom, 0.975)) * std
        return cls(value=float(value), std=float(std), lower=float(value - half), upper=float(value + half))

    def including(self, *others: "Estimate") -> "Estimate":
        """Return the estimate with an interval that also holds those of others, as of other models.

        Parameters
        ----------
        *others : Estimate
            Of the same quantity.

        Returns
        -------
        Estimate
            The same value; the largest difference is added to the standard uncertainty in quadrature.

        Examples
        --------
        >>> radius = Estimate.symmetric(13.8, 0.1).including(Estimate.symmetric(15.0, 0.2))
        >>> print(f"{radius.value} ± {radius.std:.1f}, {radius.lower:.1f} to {radius.upper:.1f}")
        13.8 ± 1.2, 13.6 to 15.4
        """
        shift = max(abs(other.value - self.value) for other in (self, *others))
        return Estimate(
            value=self.value,
            std=math.hypot(self.std, shift),
            lower=min(other.lower for other in (self, *others)),
            upper=max(other.upper for other in (self, *others)),
        )

    def with_error(self, std: float) -> "Estimate":
        """Return the same value with one more independent uncertainty, combined in quadrature.

        Parameters
        ----------
        std : float
            Standard uncertainty, of a normal distribution.

        Returns
        -------
        Estimate
            Standard uncertainty and both sides of the interval widened.

        Examples
        --------
        >>> print(Estimate.symmetric(20.0, 3.0).with_error(4.0))
        20.0 ± 5.0
        """
        return Estimate(
            value=self.value,
            std=math.hypot(self.std, std),
            lower=self.value - math.hypot(self.value - self.lower, 1.96 * std),
            upper=self.value + math.hypot(self.upper - self.value, 1.96 * std),
        )

    def stretched(self, factor: float) -> "Estimate":
        """Return the same value with an uncertainty so many times as large.

        Parameters
        ----------
        factor : float
            Above zero.

        Returns
        -------
        Estimate
            Standard uncertainty and both sides of the interval multiplied.
        """
        return Estimate(
            value=self.value,
            std=factor * self.std,
            lower=self.value - factor * (self.value - self.lower),
            upper=self.value + factor * (self.upper - self.value),
        )

    def times(self, factor: float) -> "Estimate":
        """Return the estimate multiplied by an exact number, as for another unit.

        Parameters
        ----------
        factor : float
            Above zero.

        Returns
        -------
        Estimate
            Value, standard uncertainty and interval multiplied.
        """
        return Estimate(
            value=factor * self.value,
            std=factor * self.std,
            lower=factor * self.lower,
            upper=factor * self.upper,
        )

    def over(self, divisor: "Estimate") -> "Estimate":
        """Return the estimate divided by another, independent one, to first order.

        Parameters
        ----------
        divisor : Estimate
            Above zero.

        Returns
        -------
        Estimate
            The ratio, with a symmetric interval.

        Examples
        --------
        >>> ratio = Estimate.symmetric(40.0, 3.0).over(Estimate.symmetric(2.0, 0.2))
        >>> print(f"{ratio.value:.1f} ± {ratio.std:.1f}")
        20.0 ± 2.5
        """
        value = self.value / divisor.value

        def apart(own: float, other: float) -> float:
            return math.hypot(own, value * other) / divisor.value

        return Estimate(
            value=value,
            std=apart(self.std, divisor.std),
            lower=value - apart(self.value - self.lower, divisor.upper - divisor.value),
            upper=value + apart(self.upper - self.value, divisor.value - divisor.lower),
        )


@dataclass(frozen=True, slots=True)
class Undetermined:
    """A quantity that the data do not determine.

    Attributes
    ----------
    reason : str
        What is missing.

    Examples
    --------
    >>> print(Undetermined("no area was recorded").reason)
    no area was recorded
    """

    reason: str

    def times(self, factor: float) -> "Undetermined":  # noqa: ARG002
        """Return the same.

        Parameters
        ----------
        factor : float
            Without effect.

        Returns
        -------
        Undetermined
            The same.
        """
        return self

    def over(self, divisor: Estimate) -> "Undetermined":  # noqa: ARG002
        """Return the same.

        Parameters
        ----------
        divisor : Estimate
            Without effect.

        Returns
        -------
        Undetermined
            The same.
        """
        return self


Quantity: TypeAlias = Estimate | Undetermined


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
        lower=min(stated, point(0.025, lower)),
        upper=max(stated, point(0.975, upper)),
    )


def estimates_record(quantities: Mapping[str, Quantity]) -> dict[str, Any]:
    """Return quantities as flat keys: the name, name_std, name_ci95, and the reasons of those unknown.

    Examples
    --------
    >>> record = estimates_record({"loading_radius_mm": Undetermined("no area")})
    >>> record["loading_radius_mm"], record["reasons"]
    (None, {'loading_radius_mm': 'no area'})
    """
    record: dict[str, Any] = {}
    for name, found in quantities.items():
        known = found if isinstance(found, Estimate) else None
        record[name] = known and known.value
        record[f"{name}_std"] = known and known.std
        record[f"{name}_ci95"] = known and [known.lower, known.upper]
    reasons = {name: found.reason for name, found in quantities.items() if isinstance(found, Undetermined)}
    return {**record, "reasons": reasons}
