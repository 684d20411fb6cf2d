"""Loading curves from the physics alone: no model of fingerpad is used here.

Spheres are those of Hertz and Sneddon, ellipses Johnson's, a layer on bone is solved as a Fredholm equation
(Lebedev and Ufliand 1958), and noise is made in the frequency domain.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

from benchmarks.arrays import Array, Rng

# Indentations ξ (mm) that increase, with load W (N) and contact area (mm²).
Contact = tuple[Array, Array, Array]

# Incompressible: E* = E/(1 − ν²).
POISSON = 0.5


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
    """Press a paraboloid with R'/R'' = ratio and geometric mean R (Johnson 1985, Eqs 4.25–4.28)."""

    def curvatures(k: float) -> tuple[float, float]:
        # 1/(2R') and 1/(2R'') over p0 k/(E* a).
        m = 1 - k**2
        return (ellipk(m) - ellipe(m)) / m, (ellipe(m) / k**2 - ellipk(m)) / m

    def excess(k: float) -> float:
        along, across = curvatures(k)
        return across / along - ratio

    k = brentq(excess, 0.05, 1 - 1e-6, xtol=1e-12)
    mean = float(np.sqrt(np.prod(curvatures(k))))

    def contact(pad: Pad, top: float) -> Contact:
        load = 1.05 * top * np.linspace(0, 1, 4000) ** 1.5
        # 1/(2R) = p0 k mean/(E* a), with p0 = 3W/(2π k a²).
        semi_major = (3 * load * pad.radius * mean / (np.pi * pad.reduced)) ** (1 / 3)
        peak = 1.5 * load[1:] / (np.pi * k * semi_major[1:] ** 2)
        xi = np.append(0, peak * k * semi_major[1:] * ellipk(1 - k**2) / pad.reduced)
        return xi, load, np.pi * k * semi_major**2

    return contact


def exact_sphere(pad: Pad, top: float) -> Contact:
    """Press a rigid sphere, not its paraboloid (Sneddon 1965)."""
    a = pad.radius * np.linspace(0, 0.85, 4000)
    log = np.log((pad.radius + a) / (pad.radius - a))
    load = pad.reduced / 2 * ((a**2 + pad.radius**2) * log - 2 * a * pad.radius)
    keep = load < 1.1 * top
    return (a / 2 * log)[keep], load[keep], (np.pi * a**2)[keep]


def layer(thickness: float) -> Callable[[Pad, float], Contact]:
    """Press a paraboloid on an incompressible layer bonded to bone, without friction at the platen."""

    def contact(pad: Pad, top: float) -> Contact:
        a = np.linspace(0, min(2.5 * thickness, 1.5 * pad.radius), 6000)
        indentation, force = (spline(a / thickness) for spline in _layer_ratios())
        load = force * 4 * pad.reduced * a**3 / (3 * pad.radius)
        keep = load < 1.1 * top
        return (indentation * a**2 / pad.radius)[keep], load[keep], (np.pi * a**2)[keep]

    return contact


@cache
def _layer_ratios() -> tuple[CubicSpline, CubicSpline]:
    """Indentation and load over Hertz's at the same contact radius a, against a/t."""
    ratio = np.linspace(0, 2.5, 51)
    found = np.array([(1.0, 1.0), *(layer_ratios(one) for one in ratio[1:])])
    return CubicSpline(ratio, found[:, 0]), CubicSpline(ratio, found[:, 1])


def layer_ratios(a: float, nodes: int = 40) -> tuple[float, float]:
    """Return ξ R/a² and 3 W R/(4 E* a³) on a layer of thickness one; both are one on a half-space.

    With M(q) the layer's compliance over the half-space's, and P(q) = ∫ φ(s) cos qs ds for the pressure,

        φ(s) + (2/π) ∫₀ᵃ φ(s') ∫₀^∞ (M(q) − 1) cos qs cos qs' dq ds' = (E*/π)(ξ − s²/R),

    where ξ follows from φ(a) = 0, and W = 2π ∫ φ ds.
    """
    point, weight = np.polynomial.legendre.leggauss(nodes)
    s, weight = np.append(a * (point + 1) / 2, a), np.append(a * weight / 2, 0.0)
    q, q_weight = np.polynomial.legendre.leggauss(200)
    q, q_weight = 20 * (q + 1), 20 * q_weight
    nu = POISSON
    decay = np.exp(-2 * q)
    top = (3 - 4 * nu) * (1 - decay**2) / 2 - 2 * q * decay
    bottom = (3 - 4 * nu) * (1 + decay**2) / 2 + (2 * q**2 + 5 - 12 * nu + 8 * nu**2) * decay
    cosine = np.cos(np.outer(s, q))
    kernel = (cosine * (q_weight * (top / bottom - 1))) @ cosine.T
    matrix = np.eye(len(s)) + 2 / np.pi * kernel * weight
    of_indentation, of_curvature = np.linalg.solve(matrix, np.array([np.ones(len(s)), -(s**2)]).T).T / np.pi
    xi = -of_curvature[-1] / of_indentation[-1]
    load = 2 * np.pi * float(weight @ (xi * of_indentation + of_curvature))
    return float(xi / a**2), float(0.75 * load / a**3)


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
