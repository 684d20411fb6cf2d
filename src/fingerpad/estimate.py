"""A number with its uncertainty, or the reason why there is none."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np
from scipy import special

from fingerpad._display import Displayed
from fingerpad._rounding import value_with_uncertainty


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Estimate(Displayed):
    """A number with its standard uncertainty and 95 % interval (GUM, 2.3), or why there is none.

    Attributes
    ----------
    value, std : float
        Best estimate and standard uncertainty, NaN where there is none. Of several results at once, as of
        `propagate` for many contacts, these and the ends of the interval are arrays of one shape.
    interval : (float, float)
        Lower and upper end of the 95 % interval, which need not lie evenly about the value; an end that is
        open is infinite.
    reason : str
        Why there is no number; empty where there is one.

    Examples
    --------
    >>> radius = Estimate.symmetric(20.5, 0.3)
    >>> print(f"{radius} mm, {radius.lower:.2f} to {radius.upper:.2f} mm")
    20.50 ± 0.30 mm, 19.91 to 21.09 mm
    >>> print(f"{radius:.1f}", Estimate.unknown("no area was recorded"), sep=", ")
    20.5 ± 0.3, unknown: no area was recorded
    """

    value: float
    std: float
    interval: tuple[float, float]
    reason: str = ""

    @classmethod
    def symmetric(cls, value: float, std: float, degrees_of_freedom: float = math.inf) -> Self:
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
        return cls(value=float(value), std=float(std), interval=(float(value - half), float(value + half)))

    @classmethod
    def unknown(cls, reason: str) -> Self:
        """Return the estimate of a quantity that the data do not determine: NaN, with the reason.

        Parameters
        ----------
        reason : str
            What is missing.

        Returns
        -------
        Estimate

        Examples
        --------
        >>> Estimate.unknown("no area was recorded").known
        False
        """
        return cls(value=math.nan, std=math.nan, interval=(math.nan, math.nan), reason=reason)

    @property
    def known(self) -> bool:
        """Whether there is a number, not a reason why there is none."""
        return not self.reason

    @property
    def lower(self) -> float:
        """Lower end of the 95 % interval."""
        return self.interval[0]

    @property
    def upper(self) -> float:
        """Upper end of the 95 % interval."""
        return self.interval[1]

    def with_error(self, std: float) -> Self:
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
        lower = self.value - np.hypot(self.value - self.lower, 1.96 * std)
        upper = self.value + np.hypot(self.upper - self.value, 1.96 * std)
        return replace(self, std=np.hypot(self.std, std), interval=(lower, upper))

    def stretched(self, factor: float) -> Self:
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
        lower = self.value - factor * (self.value - self.lower)
        upper = self.value + factor * (self.upper - self.value)
        return replace(self, std=factor * self.std, interval=(lower, upper))

    def times(self, factor: float) -> Self:
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
        interval = factor * self.lower, factor * self.upper
        return replace(self, value=factor * self.value, std=factor * self.std, interval=interval)

    def over(self, divisor: "Estimate") -> Self:
        """Return the estimate divided by another, independent one, to first order.

        Parameters
        ----------
        divisor : Estimate
            Above zero.

        Returns
        -------
        Estimate
            The ratio.

        Examples
        --------
        >>> ratio = Estimate.symmetric(40.0, 3.0).over(Estimate.symmetric(2.0, 0.2))
        >>> print(f"{ratio.value:.1f} ± {ratio.std:.1f}")
        20.0 ± 2.5
        """
        value = self.value / divisor.value

        def apart(own: float, other: float) -> float:
            quotient: float = np.hypot(own, value * other) / divisor.value
            return quotient

        lower = value - apart(self.value - self.lower, divisor.upper - divisor.value)
        upper = value + apart(self.upper - self.value, divisor.value - divisor.lower)
        return replace(self, value=value, std=apart(self.std, divisor.std), interval=(lower, upper))

    def summary(self) -> str:
        """Return the estimate as it is printed.

        Returns
        -------
        str
        """
        return str(self)

    def __format__(self, spec: str) -> str:
        one = self.known and not np.ndim(self.value)
        return f"{self.value:{spec}} ± {self.std:{spec}}" if spec and one else str(self)

    def __str__(self) -> str:
        if self.reason:
            return f"unknown: {self.reason}"
        if np.ndim(self.value):
            return repr(self)
        if not 0 < self.std < math.inf:
            return f"{self:.4g}"
        return value_with_uncertainty(self.value, self.std)


def estimates_record(quantities: Mapping[str, Estimate]) -> dict[str, Any]:
    """Return quantities as flat keys: the name, name_std, name_ci95, and the reasons of those unknown.

    Examples
    --------
    >>> record = estimates_record({"loading_radius_mm": Estimate.unknown("no area")})
    >>> record["loading_radius_mm"], record["reasons"]
    (None, {'loading_radius_mm': 'no area'})
    """
    record: dict[str, Any] = {}
    for name, found in quantities.items():
        record[name] = found.value if found.known else None
        record[f"{name}_std"] = found.std if found.known else None
        record[f"{name}_ci95"] = [*found.interval] if found.known else None
    return {**record, "reasons": {name: found.reason for name, found in quantities.items() if found.reason}}
