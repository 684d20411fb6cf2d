"""Axis ratio, load and indentation of Hertz theory by polynomials, where the radii differ little."""

from functools import cache

import numpy as np
from numpy.polynomial.chebyshev import cheb2poly, chebfit

from fingerpad._arrays import FloatArray, as_float_array
from fingerpad.contact.elliptic import contact_ellipse_kernel, polynomial

_RANGE, _TERMS = 1.2, 10  # of |ln(R1/R2)|, and of its square's polynomials


def hertz_units(first: FloatArray, second: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the axis ratio of Hertz theory, load over E* a³ and indentation over a².

    By polynomials where the radii differ little enough: to the last digits, in a fraction of the time.
    """
    x = np.log(first / second)
    if not (np.abs(x.real) <= _RANGE).all():
        return _exact_units(first, second)
    x = np.where(x.real < 0, -x, x)
    at, mean = (2 / _RANGE**2) * (x * x) - 1, np.sqrt(first * second)
    slope, load, depth = (polynomial(each, at) for each in _polynomials())
    return np.exp(x * slope), load / mean, depth / mean


def _exact_units(first: FloatArray, second: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    k, integral, D = contact_ellipse_kernel(first, second)
    radius_D = np.maximum(first, second) * D * k
    return k, (np.pi / 3) / (radius_D * np.sqrt(k)), 0.5 * integral / radius_D


@cache
def _polynomials() -> tuple[FloatArray, ...]:
    """Return ln(k)/x, load and indentation of R1 R2 = 1 as polynomials in x² = ln²(R1/R2)."""
    at = np.cos((np.arange(_TERMS) + 0.5) * np.pi / _TERMS)
    x = _RANGE * np.sqrt((1 + at) / 2)
    k, load, depth = _exact_units(np.exp(x / 2), np.exp(-x / 2))
    fitted = (cheb2poly(chebfit(at, values, _TERMS - 1)) for values in (np.log(k) / x, load, depth))
    return tuple(map(as_float_array, fitted))
