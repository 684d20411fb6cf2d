"""Numbers rounded to the digits of their uncertainty."""

import math
from typing import Final

_MOST_DIGITS: Final = 5


def value_with_uncertainty(value: float | None, std: float | None = None) -> str:
    """Return ``value ± standard uncertainty``, the uncertainty with two digits (GUM 7.2.6).

    To five significant digits at most: an uncertainty that would ask for more is rounded up. Without an
    uncertainty: four significant digits; below one three decimals, and at least three digits. A dash where
    the value is unknown.
    """
    if value is None or not math.isfinite(value):
        return "–"
    if std is None or not math.isfinite(std) or std <= 0:
        return _plain(value)
    decimals = min(_decimals(std), _finest(value))
    return f"{round(value, decimals):.{max(decimals, 0)}f} ± {two_digits(std, value)}"


def positive_with_uncertainty(value: float | None, std: float | None = None) -> str:
    """Return `value_with_uncertainty` of a positive quantity, or ``value ×/÷ factor`` if it is known badly.

    That is where two standard uncertainties would reach below zero.
    """
    if value is not None and std is not None and _is_factor(value, std):
        return f"{two_digits(value)} {uncertainty_of_positive(value, std)}"
    return value_with_uncertainty(value, std)


def uncertainty_of_positive(value: float, std: float) -> str:
    """Return the second part of `positive_with_uncertainty`; a dash where it is unknown."""
    if not math.isfinite(std):
        return "–"
    if _is_factor(value, std):
        return f"×/÷ {two_digits(1 + std / value)}"
    return f"± {two_digits(std, value)}"


def _is_factor(value: float, std: float) -> bool:
    """Return whether two standard uncertainties of a positive value reach below zero."""
    return math.isfinite(std) and 2 * std > value > 0


def two_digits(std: float, value: float = 0.0) -> str:
    """Return a standard uncertainty with two digits, and that of what is exact as 0.

    Beyond the five significant digits of the `value` it belongs to, it is rounded up.
    """
    if std == 0:
        return "0"
    decimals = _decimals(std)
    if (finest := _finest(value)) < decimals:
        decimals, std = finest, math.ceil(std * 10.0**finest) / 10.0**finest
    return f"{round(std, decimals):.{max(decimals, 0)}f}"


def _plain(value: float) -> str:
    """Return a number without an uncertainty."""
    if value == 0:
        return "0"
    if abs(value) < 1:
        return f"{value:.{min(9, max(3, 2 - math.floor(math.log10(abs(value)))))}f}"
    text = f"{value:.4g}"
    return f"{float(text):.0f}" if "e" in text else text


def _finest(value: float) -> int:
    """Return the decimal place of the last of the digits that are shown of a value."""
    return _MOST_DIGITS - 1 - math.floor(math.log10(abs(value))) if value else 99


def _decimals(std: float) -> int:
    """Return the decimal place of the second digit, after rounding: 0.0996 becomes 0.10."""
    decimals = 1 - math.floor(math.log10(std))
    return decimals - 1 if round(std, decimals) >= 10 ** (2 - decimals) else decimals
