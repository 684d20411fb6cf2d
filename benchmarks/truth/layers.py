"""Circular contacts on a layer bonded to a rigid base, to ten digits (Lebedev and Ufliand 1958)."""

import numpy as np

from benchmarks.arrays import Array


def compliance(q: Array, nu: float) -> Array:
    """Return the layer's compliance over that of the half-space, for wavenumbers times the thickness."""
    decay = np.exp(-2 * q)
    top = (3 - 4 * nu) * -np.expm1(-4 * q) / 2 - 2 * q * decay
    return top / ((3 - 4 * nu) * (1 + decay**2) / 2 + (2 * q**2 + 5 - 12 * nu + 8 * nu**2) * decay)


def layer_spectrum(poisson_ratio: float) -> tuple[Array, Array]:
    """Return wavenumbers times thickness, and M − 1 there times the weights of Gauss' quadrature."""
    node, weight = np.polynomial.legendre.leggauss(300)
    wavenumber = 15 * (node + 1)
    return wavenumber, 15 * weight * (compliance(wavenumber, poisson_ratio) - 1)


def circular_contacts(
    sizes: Array, poisson_ratio: float, nodes: int = 48, *, thickness_over_radius: float = 0.0
) -> Array:
    """Return W/W_H and ξ/ξ_H at equal area, and p0/p0_H at equal load, for paraboloids on a bonded layer.

    With a thickness over the radius of curvature, for spheres instead.

    With the Hankel transform of the pressure ∫φ(s) cos(qs) ds over the contact's radius, φ satisfies a
    Fredholm equation of the second kind with a smooth kernel; φ vanishes at the edge. Sizes are contact radii
    over the thickness; the shape is (n, 3).
    """
    wavenumber, weight = layer_spectrum(poisson_ratio)
    node, step = np.polynomial.legendre.leggauss(nodes)
    s, step = (node + 1) / 2, step / 2
    found = []
    for size in sizes:
        wave = np.cos(wavenumber[:, None] * size * s)
        kernel = (2 / np.pi) * size * (wave.T * weight) @ wave
        at_edge = (2 / np.pi) * size * (np.cos(wavenumber * size) * weight) @ wave
        # Of a gap r²/2, or of the sphere's: s ∫₀ˢ g'(r)/√(s² − r²) dr.
        width = max(size * thickness_over_radius, 1e-9)
        gap = np.append(s, 1.0)
        gap *= np.arctanh(gap * width) / width
        sides = (2 / np.pi) * np.stack([np.ones(nodes), -gap[:-1]], axis=1)
        solved = np.linalg.solve(np.eye(nodes) + kernel * step, sides)
        edge = (2 / np.pi) * np.array([1, -gap[-1]]) - at_edge @ (step[:, None] * solved)
        indentation = -edge[1] / edge[0]
        phi = solved @ np.array([indentation, 1])
        load = np.pi * step @ phi
        found.append((0.75 * load, indentation, _central_pressure(s, phi) / (1.5 * load / np.pi)))
    return np.array(found)


def _central_pressure(s: Array, phi: Array) -> float:
    """Return −½∫φ'(s)/s ds: φ is even, so this is −2∫ dφ/d(2s² − 1) ds."""
    chebyshev = np.polynomial.chebyshev
    slope = chebyshev.chebder(chebyshev.chebfit(2 * s**2 - 1, phi, 16))
    node, weight = np.polynomial.legendre.leggauss(60)
    return float(-weight @ chebyshev.chebval(2 * ((node + 1) / 2) ** 2 - 1, slope))
