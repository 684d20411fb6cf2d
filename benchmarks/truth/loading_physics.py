"""Loading curves from the physics alone: no model of fingerpad is used here.

Spheres are those of Hertz and Sneddon, ellipses Johnson's, layers on bone those of `benchmarks.truth.layers`;
noise is made in the frequency domain.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.interpolate import CubicSpline

from benchmarks.arrays import Array, Rng
from benchmarks.truth.hertz import hertz_ellipse
from benchmarks.truth.layers import circular_contacts

# Indentations ξ (mm) that increase, with load W (N) and contact area (mm²).
Contact = tuple[Array, Array, Array]

# Incompressible: E* = E/(1 − ν²).
POISSON = 0.5
_WIDEST = 0.85  # contact radius of a sphere, over that of curvature


@dataclass(frozen=True, kw_only=True)
class Pad:
    """A pad: radius R (mm), E_0g (MPa) and β (MPa/N) of its secant modulus E_0g + β W."""

    radius: float
    modulus: float
    slope: float = 0.0

    @property
    def reduced(self) -> float:
        """E* at no load."""
        return self.modulus / (1 - POISSON**2)


def hertz(pad: Pad, top: float) -> Contact:
    """Press a paraboloid on a half-space whose secant modulus grows with load (Dzidek et al. 2017)."""
    load = 1.05 * top * np.linspace(0, 1, 4000) ** 1.5
    secant = pad.modulus + pad.slope * load
    xi = (0.75 * load * (1 - POISSON**2) / (secant * np.sqrt(pad.radius))) ** (2 / 3)
    return xi, load, np.pi * pad.radius * xi


def free_area(exponent: float) -> Callable[[Pad, float], Contact]:
    """Keep Hertz's load, but let the area grow as W^n: it is Hertz's at half the greatest load."""

    def contact(pad: Pad, top: float) -> Contact:
        xi, load, area = hertz(pad, top)
        return xi, load, np.interp(top / 2, load, area) * (load / (top / 2)) ** exponent

    return contact


def ellipsoid(ratio: float) -> Callable[[Pad, float], Contact]:
    """Press a paraboloid with R'/R'' = ratio and geometric mean R (Johnson 1985, ch. 4)."""
    _, F1, F2 = hertz_ellipse(ratio)

    def contact(pad: Pad, top: float) -> Contact:
        load = 1.05 * top * np.linspace(0, 1, 4000) ** 1.5
        round_ = (0.75 * load * pad.radius / pad.reduced) ** (1 / 3)
        return round_**2 / pad.radius * F2, load, np.pi * (round_ * F1) ** 2

    return contact


def exact_sphere(pad: Pad, top: float) -> Contact:
    """Press a rigid sphere, not its paraboloid (Sneddon 1965)."""
    a = pad.radius * np.linspace(0, _WIDEST, 4000)
    log = np.log((pad.radius + a) / (pad.radius - a))
    load = pad.reduced / 2 * ((a**2 + pad.radius**2) * log - 2 * a * pad.radius)
    keep = load < 1.1 * top
    return (a / 2 * log)[keep], load[keep], (np.pi * a**2)[keep]


def layer(thickness: float, *, sphere: bool = False) -> Callable[[Pad, float], Contact]:
    """Press a paraboloid, or a sphere, on an incompressible layer bonded to bone, without friction."""

    def contact(pad: Pad, top: float) -> Contact:
        a = np.linspace(0, min(2.5 * thickness, (_WIDEST if sphere else 1.5) * pad.radius), 6000)
        ratios = _layer_ratios(thickness / pad.radius if sphere else 0.0)
        indentation, force = (spline(a / thickness) for spline in ratios)
        load = force * 4 * pad.reduced * a**3 / (3 * pad.radius)
        keep = load < 1.1 * top
        return (indentation * a**2 / pad.radius)[keep], load[keep], (np.pi * a**2)[keep]

    return contact


@cache
def _layer_ratios(thickness_over_radius: float) -> tuple[CubicSpline, CubicSpline]:
    """Indentation and load over Hertz's at the same contact radius a, against a/t; of a sphere of t/R."""
    ratio = np.linspace(0, min(2.5, _WIDEST / max(thickness_over_radius, 1e-9)), 51)
    found = circular_contacts(ratio[1:], POISSON, thickness_over_radius=thickness_over_radius)
    load, indentation, _ = np.vstack([np.ones(3), found]).T
    return CubicSpline(ratio, indentation), CubicSpline(ratio, load)


def coloured_noise(rng: Rng, count: int, step: float, power: Callable[[Array], Array]) -> Array:
    """Return Gaussian noise of a power spectrum, its variance one in the frequencies of the record."""
    length = 8 * count
    frequency = np.fft.rfftfreq(length, step)[1:]
    amplitude: Array = np.sqrt(power(np.asarray(frequency, dtype=np.float64)))
    # Slower ones only move its level: they are there, but do not count.
    amplitude /= np.sqrt((amplitude[frequency >= 1 / (count * step)] ** 2).sum())
    spectrum = amplitude * (rng.normal(size=len(frequency)) + 1j * rng.normal(size=len(frequency)))
    return np.fft.irfft(np.append(0, spectrum), length)[:count] * length / 2


def pink(frequency: Array) -> Array:
    """Return the spectrum of 1/f noise."""
    return 1 / frequency


def short_memory(frequency: Array) -> Array:
    """Return the spectrum of noise that forgets exponentially within 20 ms."""
    return 1 / (1 + (2 * np.pi * frequency * 0.02) ** 2)
