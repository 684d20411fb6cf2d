"""Elliptical Hertz contact from the equations as Johnson (1985) prints them, to fifty digits."""

from functools import cache

import mpmath as mp
import numpy as np
from scipy.special import ellipe, ellipk


def exact_contact(ratio: float, smaller_radius: float, load: float, modulus: float) -> tuple[mp.mpf, ...]:
    """Return semi-axes, indentation and peak pressure, with digits enough to outlast the cancellation."""
    with mp.workdps(90):
        smaller = mp.mpf(smaller_radius)
        larger = smaller * mp.mpf(ratio)
        k, size_factor, indentation_factor = _shape(larger / smaller)
        mean_radius = mp.sqrt(larger * smaller)
        W, E = mp.mpf(load), mp.mpf(modulus)
        c = mp.cbrt(3 * W * mean_radius / (4 * E)) * size_factor
        major, minor = c / mp.sqrt(k), c * mp.sqrt(k)
        indentation = mp.cbrt(9 * W**2 / (16 * E**2 * mean_radius)) * indentation_factor
        return major, minor, indentation, 3 * W / (2 * mp.pi * major * minor)


def _shape(ratio: mp.mpf) -> tuple[mp.mpf, mp.mpf, mp.mpf]:
    """Return k, F1 and F2 from Johnson (4.26c, 4.28, 4.29)."""
    if ratio == 1:
        return mp.mpf(1), mp.mpf(1), mp.mpf(1)

    def residual(log_k: mp.mpf) -> mp.mpf:
        k = mp.exp(log_k)
        K, E = mp.ellipk(1 - k * k), mp.ellipe(1 - k * k)
        return mp.log((E / k**2 - K) / (K - E)) - mp.log(ratio)

    start = -mp.log(ratio) * mp.mpf("0.66")
    k = mp.exp(mp.findroot(residual, (start, start * mp.mpf("0.98")), tol=1e-110, maxsteps=60))
    K, E = mp.ellipk(1 - k * k), mp.ellipe(1 - k * k)
    cubed = 4 / (mp.pi * (1 - k * k)) * k ** mp.mpf("1.5") * mp.sqrt((E / k**2 - K) * (K - E))
    return k, mp.cbrt(cubed), 2 / mp.pi * mp.sqrt(k) * K / mp.cbrt(cubed)


@cache
def hertz_ellipse(curvature_ratio: float) -> tuple[float, float, float]:
    """Return k, F1 and F2 of the contact of bodies with R'/R'' of at least 1."""
    with mp.workdps(90):
        k, size, indentation = map(float, _shape(mp.mpf(curvature_ratio)))
    return k, size, indentation


def hertz_factors(k: float) -> tuple[float, float]:
    """Return F1 and F2 (4.26c, 4.29) of a contact ellipse with the axis ratio k."""
    m = 1 - k**2
    if m < 1e-6:
        return 1.0, 1.0
    K, E = ellipk(m), ellipe(m)
    size = float((4 / (np.pi * m) * k**1.5 * np.sqrt((E / k**2 - K) * (K - E))) ** (1 / 3))
    return size, float(2 / np.pi * np.sqrt(k) * K / size)
