"""Contact of a ridged pad with a plate on a fine grid: pressure field, touching ridges, and the true areas.

The pad's pressure p = p₀(1 − ρ²)^s is positive inside a boundary given by formula, ρ < 1: an ellipse, a
superellipse or an egg. That boundary is the gross contact. A ridge touches over a share of its period that
grows with p, as an elastic (√p) or a plastic (p) tip does, and not at all below a threshold.
"""

from dataclasses import dataclass
from functools import partial

import cv2
import numpy as np

from benchmarks.arrays import Array, Rng
from benchmarks.truth import true_image
from benchmarks.truth.ridge_growth import PIXELS_PER_PERIOD, grow_ridges


@dataclass(frozen=True)
class Press:
    """Shape of the contact, mm and mm², and of its pressure."""

    area: float
    aspect: float = 1.35
    tilt: float = 0.0  # of the major axis from straight up, rad, counter-clockwise
    exponent: float = 0.5  # s: Hertz ½, flatter below, sharper above
    power: float = 2.0  # of the superellipse
    egg: float = 0.0

    @property
    def mean_pressure(self) -> float:
        """Load over area, kPa: A = 110 mm² (W/N)^0.45, as measured on finger pads."""
        return float(1e3 * (self.area / 110) ** (1 / 0.45) / self.area)


@dataclass(frozen=True)
class Skin:
    """Ridges and their surface."""

    kind: str
    seed: int
    period: float = 0.46  # mm
    plastic: bool = False
    widest: float = 0.72  # share of the period that touches under high pressure
    half_pressure: float = 4.0  # kPa
    jump_width: float = 0.12  # share that touches at once, by adhesion
    threshold: float = 0.3  # kPa, below which a ridge of mean height does not touch
    height_spread: float = 0.3  # relative scatter of pressure between ridges
    roughness: float = 0.06  # as a share of the period
    roughness_mm: float = 0.07
    pores: float = 0.35  # share of the places along ridges that have an open pore
    creases: int = 1
    growth_periods: int = 54


@dataclass(frozen=True)
class Contact:
    """Fields on the fine grid, and the truth."""

    press: Press
    mm: float
    touching: Array
    pressure: Array
    outside: Array  # mm beyond the true boundary along the radius, negative inside
    phase: Array

    @property
    def ridge_area(self) -> float:
        """Area of the touching ridges, mm²."""
        return float(self.touching.sum() * self.mm**2)

    @property
    def semi_axes(self) -> tuple[float, float]:
        """Semi-axes of the boundary's ellipse, mm."""
        return true_image.equal_ellipse(_radius(self.press, _TURN))


_TURN = np.linspace(0, 2 * np.pi, 4096, endpoint=False)
smooth_noise = partial(true_image.smooth_noise, knots=lambda n: int(np.ceil(n)) + 2)


def _radius(press: Press, angle: Array) -> Array:
    """Distance of the boundary from the middle, mm, at angles from the major axis."""

    def shape(t: Array) -> Array:
        major, minor = np.sqrt(press.aspect), 1 / np.sqrt(press.aspect)
        sum_of_powers = np.abs(np.cos(t) / major) ** press.power + np.abs(np.sin(t) / minor) ** press.power
        return sum_of_powers ** (-1 / press.power) * (1 + press.egg * np.cos(t))

    unit_area = np.pi * np.mean(shape(_TURN) ** 2)
    return shape(angle) * np.sqrt(press.area / unit_area)


def boundary_of(press: Press) -> Array:
    """Return the boundary: points right of and below the middle, mm."""
    radius = _radius(press, _TURN)
    up, left = radius * np.cos(_TURN), radius * np.sin(_TURN)
    c, s = float(np.cos(press.tilt)), float(np.sin(press.tilt))
    return np.stack([-(up * s + left * c), -(up * c - left * s)], axis=1)


def _phase(x: Array, y: Array, press: Press, skin: Skin, rng: Rng) -> Array:
    """Ridge phase at points right of and below the middle, mm; the finger points along the major axis."""
    c, s = float(np.cos(press.tilt)), float(np.sin(press.tilt))
    right, down = x * c - y * s, x * s + y * c
    pattern = grow_ridges(skin.kind, skin.seed, skin.growth_periods)
    shift = rng.uniform(-1.2, 1.2, 2).tolist()
    for _ in range(2):
        direction, start = rng.uniform(0, 2 * np.pi, 2).tolist()
        cos, sin = 0.9 * float(np.cos(direction)), 0.9 * float(np.sin(direction))
        wave = 0.12 * np.sin(right * cos + down * sin + start)
        right, down = right + wave, down - wave
    pixels_per_mm, middle = PIXELS_PER_PERIOD / skin.period, pattern.even.shape[0] / 2
    column, row = ((v + d) * pixels_per_mm + middle for v, d in zip((right, down), shift, strict=True))
    return pattern.phase(np.asarray(column, np.float32), np.asarray(row, np.float32))


def _holes(phase: Array, skin: Skin, mm: float, rng: Rng) -> Array:
    """Pores on the crests of ridges, and creases across them."""
    holes = np.zeros(phase.shape, np.uint8)
    step = 0.75 * skin.period / mm
    grid = np.mgrid[step : phase.shape[0] : step, step : phase.shape[1] : step].reshape(2, -1).T
    points = grid + rng.normal(0, step / 4, grid.shape)
    points = points[rng.random(len(points)) < skin.pores]
    inside = ((points > 1) & (points < np.array(phase.shape) - 2)).all(axis=1)
    for row, column in points[inside].astype(int):
        if phase[row, column] < 0.3 * np.pi:
            size = np.rint(rng.uniform(0.02, 0.06, 2) / mm).astype(int).tolist()
            cv2.ellipse(holes, (int(column), int(row)), size, rng.uniform(0, 180), 0, 360, 1, -1)
    for _ in range(skin.creases):
        start = rng.uniform(0.2, 0.8, 2) * phase.shape[::-1]
        direction, length = rng.uniform(0, 2 * np.pi), rng.uniform(2, 7) / mm
        along = np.linspace(0, 1, 24)[:, None]
        heading = direction + 0.4 * np.cumsum(rng.normal(0, 0.3, 24))[:, None]
        steps = length / 24 * np.hstack([np.cos(heading), np.sin(heading)])
        path = (start + np.cumsum(steps, axis=0)).astype(np.int32)
        for k in range(23):
            width = max(1, round(rng.uniform(0.08, 0.22) / mm * np.sin(np.pi * along[k, 0] + 0.1)))
            cv2.line(holes, path[k].tolist(), path[k + 1].tolist(), 1, width)
    return holes > 0


def touching_width(pressure: Array, skin: Skin) -> Array:
    """Share of the ridge period that touches, from 0 to `widest`."""
    ratio = np.maximum(pressure, 0) / skin.half_pressure
    rise = ratio / (1 + ratio) if skin.plastic else np.sqrt(ratio / (1 + ratio))
    width = np.maximum(skin.widest * rise, skin.jump_width)
    return np.where(pressure > 0, width, -1.0)


def press_pad(press: Press, skin: Skin, *, mm: float, shape: tuple[int, int], rng: Rng) -> Contact:
    """Press the pad on a fine grid of `shape` with spacing `mm`, the contact in its middle."""
    x = (np.arange(shape[1], dtype=np.float32) - (shape[1] - 1) / 2)[None, :] * mm
    y = (np.arange(shape[0], dtype=np.float32) - (shape[0] - 1) / 2)[:, None] * mm
    c, s = float(np.cos(press.tilt)), float(np.sin(press.tilt))
    up, left = -(x * s + y * c), -(x * c - y * s)
    distance = np.hypot(up, left)
    radius = _radius(press, np.linspace(-np.pi, np.pi, 2049))
    edge = np.interp(np.arctan2(left, up), np.linspace(-np.pi, np.pi, 2049), radius).astype(np.float32)
    rho2 = np.minimum((distance / edge) ** 2, 1)
    # The mean of (1 − ρ²)^s over the region is 1/(s + 1).
    pressure = press.mean_pressure * (press.exponent + 1) * (1 - rho2) ** press.exponent
    phase = _phase(x, y, press, skin, rng)
    height = 1 + skin.height_spread * smooth_noise(rng, shape, 0.8 / mm)
    width = touching_width(pressure * np.maximum(height, 0.05) - skin.threshold, skin)
    rough = skin.roughness * smooth_noise(rng, shape, skin.roughness_mm / mm)
    touching = (phase / np.pi + rough < width) & (rho2 < 1) & ~_holes(phase, skin, mm, rng)
    return Contact(press, mm, touching, np.asarray(pressure), outside=distance - edge, phase=phase)
