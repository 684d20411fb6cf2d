"""A pad, its frictionless contact with a flat plate, and laws of load and area, all for E* = 1."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import TypeAlias

import numpy as np
from scipy import fft, interpolate, ndimage, optimize, special

from benchmarks.arrays import Array
from benchmarks.truth.layers import compliance

# The gap at points along and across the finger.
Surface: TypeAlias = Callable[[Array, Array], Array]

CELLS = 128
DIRECTIONS = 72


@dataclass(frozen=True)
class Pad:
    """Body ((x/a)^p + (y/b)^p)^(2/p) + (z/c)² = 1; the dorsal half is photographed only."""

    palmar: float
    distal: float
    radial_ulnar: float
    exponent: float = 2.0
    dorsal_ratio: float = 1.0

    def level(self, x: Array, y: Array, z: Array) -> tuple[Array, Array, Array, Array]:
        """Return the body's norm at points (1 on the surface), and its gradient."""
        p = self.exponent
        u, v = np.abs(x) / self.palmar + 1e-12, np.abs(y) / self.distal + 1e-12
        plane = (u**p + v**p) ** (1 / p)
        norm = np.hypot(plane, z / self.radial_ulnar)
        share = plane / norm * plane ** (1 - p)
        gradient_x = share * u ** (p - 1) / self.palmar * np.sign(x)
        gradient_y = share * v ** (p - 1) / self.distal * np.sign(y)
        return norm, gradient_x, gradient_y, z / self.radial_ulnar**2 / norm


@dataclass(frozen=True)
class Gap:
    """Distance of a pad from the plate that touches it, at points along and across the finger."""

    pad: Pad
    wedge_deg: float
    roll_deg: float = 0.0

    def frame(self) -> tuple[Array, Array, Array, Array]:
        """Return place of contact, normal, and directions along and across the finger in the plate."""
        wedge, roll = np.radians([self.wedge_deg, self.roll_deg])
        normal = np.array([np.cos(wedge) * np.cos(roll), np.sin(wedge), np.cos(wedge) * np.sin(roll)])
        along = np.array([-np.sin(wedge) * np.cos(roll), np.cos(wedge), -np.sin(wedge) * np.sin(roll)])
        across = np.array([-np.sin(roll), 0.0, np.cos(roll)])
        pad, q = self.pad, self.pad.exponent / (self.pad.exponent - 1)
        plane = ((pad.palmar * normal[0]) ** q + (pad.distal * normal[1]) ** q) ** (1 / q)
        support = np.hypot(plane, pad.radial_ulnar * normal[2])
        scale = plane ** (2 - q) / support
        x = scale * pad.palmar**q * normal[0] ** (q - 1)
        y = scale * pad.distal**q * normal[1] ** (q - 1)
        return np.array([x, y, pad.radial_ulnar**2 * normal[2] / support]), normal, along, across

    def __call__(self, along: Array, across: Array) -> Array:
        """Return the gap, infinite where the pad's outline lies inside."""
        point, normal, t1, t2 = self.frame()
        start = point + along[..., None] * t1 + across[..., None] * t2
        depth = np.zeros(along.shape)
        for _ in range(60):
            at = start - depth[..., None] * normal
            norm, gx, gy, gz = self.pad.level(at[..., 0], at[..., 1], at[..., 2])
            slope = -(gx * normal[0] + gy * normal[1] + gz * normal[2])
            # The norm is convex along a ray: Newton's steps from outside never pass the surface.
            step = np.where(slope < -1e-9, (norm - 1) / np.minimum(slope, -1e-9), np.inf)
            depth = np.where(np.isfinite(step), np.minimum(depth - step, 1e3), 1e3)
            if np.all((np.abs(step) < 1e-12) | (depth >= 1e3)):
                break
        return np.where(depth < 50, depth, np.inf)

    def curvatures(self) -> tuple[float, float]:
        """Return the principal curvatures at the place of contact, by differences."""
        step = 0.05
        s, t = np.meshgrid([-step, 0, step], [-step, 0, step], indexing="ij")
        h = self(s, t)
        ss, tt = (h[2, 1] + h[0, 1]) / step**2, (h[1, 2] + h[1, 0]) / step**2
        st = (h[2, 2] + h[0, 0] - h[2, 0] - h[0, 2]) / (4 * step**2)
        low, high = np.linalg.eigvalsh([[ss, st], [st, tt]])
        return float(low), float(high)

    def mean_curvature_radius(self) -> float:
        """Return 1/H, mm."""
        return 2 / sum(self.curvatures())


@lru_cache(maxsize=8)
def _layer_excess(poisson: float) -> interpolate.CubicSpline:
    """Return t π E* times the layer's surface displacement less that of a half-space, against r/t."""
    x = np.linspace(0, 30, 6001)
    distance = np.linspace(0, 16, 1601)
    kernel = (compliance(x, poisson) - 1) * special.j0(np.outer(distance, x))
    return interpolate.CubicSpline(distance, np.trapezoid(kernel, x, axis=1))


def _cell_kernel(n: int, size: float, thickness: float, poisson: float) -> Array:
    """Return displacements of a square cell under unit pressure on a 2n × 2n cyclic grid (Love)."""
    index = np.minimum(np.arange(2 * n), 2 * n - np.arange(2 * n)) * size
    x, y = np.meshgrid(index, index, indexing="ij")

    kernel = np.zeros_like(x)
    for sx in (-1, 1):
        for sy in (-1, 1):
            u, v = x + sx * size / 2, y + sy * size / 2
            # ∫∫ dA / r from the origin to a corner, odd in u and v
            kernel += sx * sy * (u * np.arcsinh(v / np.abs(u)) + v * np.arcsinh(u / np.abs(v)))
    if np.isfinite(thickness):
        excess = _layer_excess(poisson)
        kernel = kernel + size**2 * excess(np.minimum(np.hypot(x, y) / thickness, 16)) / thickness
    return kernel / np.pi


@dataclass(frozen=True)
class Contact:
    """One contact: load, radii of its outline about its centroid, and mean pressure against radius."""

    load: float
    outline: Array
    profile: Array

    @property
    def area(self) -> float:
        """Area inside the outline, mm²."""
        return float(np.mean(self.outline**2) * np.pi)


PROFILE_AT = np.linspace(0, 1, 21)


def press(gap: Surface, indentation: float, thickness: float, poisson: float, cells: int = CELLS) -> Contact:
    """Press a plate onto a pad to an indentation, by conjugate gradients with pressures kept positive."""
    along = np.linspace(-15, 15, 121)
    coarse_s, coarse_t = np.meshgrid(along, along, indexing="ij")
    inside = gap(coarse_s, coarse_t) < indentation
    extent = max(np.abs(coarse_s[inside]).max(), np.abs(coarse_t[inside]).max()) + 0.25
    for factor in (1.15, 1.5):
        half = factor * extent if extent > 1 else factor * 1.6 * np.sqrt(indentation * 16)
        size = 2 * half / cells
        centre = (np.arange(cells) - (cells - 1) / 2) * size
        s, t = np.meshgrid(centre, centre, indexing="ij")
        target = indentation - np.minimum(gap(s, t), 100 * indentation)
        pressure = _pressures(target, size, thickness, poisson)
        rim = np.concatenate([pressure[:2].ravel(), pressure[-2:].ravel(), pressure[:, :2].ravel()])
        if not rim.any() and not pressure[:, -2:].any():
            break
    outline, profile = _outline(pressure, size)
    return Contact(float(pressure.sum()) * size**2, outline, profile)


def _pressures(target: Array, size: float, thickness: float, poisson: float) -> Array:
    n = len(target)
    kernel = fft.rfft2(_cell_kernel(n, size, thickness, poisson))

    def displaced(pressure: Array) -> Array:
        spectrum = fft.rfft2(pressure, s=(2 * n, 2 * n)) * kernel
        return fft.irfft2(spectrum, s=(2 * n, 2 * n))[:n, :n]

    pressure = np.sqrt(np.maximum(target, 0))
    pressure *= (pressure * target).sum() / (pressure * displaced(pressure)).sum()
    direction, before, restart = np.zeros_like(target), 1.0, True
    for _ in range(500):
        active = pressure > 0
        residual = displaced(pressure) - target
        square = float((residual[active] ** 2).sum())
        direction = np.where(active, residual + (0 if restart else square / before) * direction, 0)
        before = square
        step = float((residual * direction)[active].sum() / (displaced(direction) * direction)[active].sum())
        new = np.maximum(pressure - step * direction, 0)
        overlap = (new == 0) & (residual < 0)
        restart = bool(overlap.any())
        new[overlap] -= step * residual[overlap]
        change = np.abs(new - pressure).sum() / new.sum()
        pressure = new
        if change < 1e-6 and not restart:
            break
    return pressure


def _outline(pressure: Array, size: float) -> tuple[Array, Array]:
    """Return radii of the contact in mm, where p² falls to zero, and the mean pressure against radius."""
    n = len(pressure)
    at = np.arange(n)
    row, column = pressure.sum(axis=1) @ at / pressure.sum(), pressure.sum(axis=0) @ at / pressure.sum()
    square = pressure**2
    angles = 2 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    inside = ndimage.binary_erosion(pressure > 0)  # cells at the rim are only partly in contact
    radii = np.empty(DIRECTIONS)
    steps = np.arange(0, n / 2, 0.25)
    for k, angle in enumerate(angles):
        points = np.array([row + steps * np.cos(angle), column + steps * np.sin(angle)])
        kept = ndimage.map_coordinates(inside.astype(float), points, order=1) > 0.999
        last = int(np.argmin(kept)) - 1
        first = max(0, last - max(20, last // 6))
        value = ndimage.map_coordinates(square, points[:, first : last + 1], order=3)
        # p² is quadratic in r for an ellipsoidal pressure, and nearly so otherwise.
        curve = np.polynomial.Polynomial.fit(steps[first : last + 1], value, 2)
        roots = curve.roots()
        real = roots[np.abs(roots.imag) < 1e-9].real
        radii[k] = min(real[real > steps[last]], default=steps[last] + 1.0)
    profile = np.empty(len(PROFILE_AT))
    for k, fraction in enumerate(PROFILE_AT):
        at = fraction * radii
        points = np.array([row + at * np.cos(angles), column + at * np.sin(angles)])
        profile[k] = ndimage.map_coordinates(pressure, points, order=1).mean()
    # Cells touch as a whole: Hertz contacts come out 0.04 cells too wide, those on a layer 0.03 to 0.07.
    return (radii - 0.045) * size, profile / profile.max()


class Law:
    """Load, area and outline of a pad against indentation, interpolated between solved contacts (E* = 1).

    Contacts are solved at depths that are even in √ξ.
    """

    def __init__(self, gap: Gap, deepest: float, thickness: float, poisson: float) -> None:
        self.deepest, roots = deepest, np.sqrt(deepest) * np.arange(1, 12) / 11
        solved = [(root, press(gap, root**2, thickness, poisson)) for root in roots]
        rows = [(np.log(c.load / r**3), np.log(c.area / r**2), c.outline / r, c.profile) for r, c in solved]
        # ln(W/ξ^1.5), ln(A/ξ), r/√ξ and the profile against √ξ
        columns = (interpolate.CubicSpline(roots, one) for one in zip(*rows, strict=True))
        self.load_over, self.area_over, self.outline_over, self.profile = columns

    def load(self, indentation: Array | float) -> Array:
        """Return W/E*."""
        xi = np.maximum(indentation, 0)
        return xi**1.5 * np.exp(self.load_over(np.sqrt(xi)))

    def area(self, indentation: Array | float) -> Array:
        """Return A, mm²."""
        xi = np.maximum(indentation, 0)
        return xi * np.exp(self.area_over(np.sqrt(xi)))

    def indentation(self, load: float) -> float:
        """Return ξ at W/E*."""
        return float(optimize.brentq(lambda xi: float(self.load(xi)) - load, 1e-6, self.deepest))

    def outline(self, indentation: float) -> Array:
        """Return radii of the contact about its centroid."""
        return self.outline_over(np.sqrt(indentation)) * np.sqrt(indentation)
