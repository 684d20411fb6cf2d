"""Epidermal ridges grown by an activator and a fast inhibitor, with loops, deltas and dislocations.

    ∂u/∂t = D:∇∇u + αu − u³ − v,    v − d∇²v = u

The activator u diffuses faster along the ridges than across them; the inhibitor v is everywhere in
equilibrium. Ridges start at the core, the fingertip and the joint, as in the embryo, and meet in minutiae.
"""

from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np
from scipy import fft

from benchmarks.arrays import Array, Rng

PIXELS_PER_PERIOD = 8.0
# Loops (cores) and deltas, in ridge periods right of and above the middle.
SINGULARITIES = {
    "left loop": ([(-1.0, 3.0)], [(15.0, -17.0)]),
    "right loop": ([(1.0, 3.0)], [(-14.0, -18.0)]),
    "whorl": ([(0.0, 5.0), (1.5, -4.0)], [(-16.0, -19.0), (17.0, -18.0)]),
    "double loop": ([(-3.0, 6.0), (4.0, -5.0)], [(-18.0, -17.0), (16.0, -21.0)]),
    "arch": ([(0.0, -9.0)], [(0.0, -15.0)]),
}


@dataclass(frozen=True)
class RidgePattern:
    """Ridges as one oscillation: u is even about each ridge's crest, its Riesz transform odd."""

    even: Array
    odd: tuple[Array, Array]

    def phase(self, column: Array, row: Array) -> Array:
        """Phase at pattern pixels: 0 on the crest of a ridge, π on the floor of a valley."""
        even, first, second = (
            cv2.remap(part, column, row, cv2.INTER_CUBIC, borderMode=cv2.BORDER_WRAP)
            for part in (self.even, *self.odd)
        )
        return np.arctan2(np.hypot(first, second), even)


def ridge_directions(kind: str, periods: int, rng: Rng) -> Array:
    """Angle of the ridges from rightward, by Sherlock and Monro's zeros and poles, gently disturbed."""
    size = round(periods * PIXELS_PER_PERIOD)
    axis = (np.arange(size) - size / 2) / PIXELS_PER_PERIOD
    z = axis[None, :] - 1j * axis[:, None]
    cores, deltas = SINGULARITIES[kind]
    jitter = rng.normal(0, 0.7, (len(cores) + len(deltas), 2)) @ np.array([1, 1j])
    angle = np.zeros(z.shape)
    for (x, y), shift in zip(cores, jitter, strict=False):
        # The cut of a core's angle points down, where a whole turn of 2π is half a turn of ridges: the same.
        angle += np.angle((z - complex(x, y) - shift) * 1j) / 2 - np.pi / 4
    for (x, y), shift in zip(deltas, jitter[len(cores) :], strict=True):
        angle -= np.angle((z - complex(x, y) - shift) * 1j) / 2 - np.pi / 4
    noise = np.asarray(rng.normal(size=z.shape))
    disturbance = cv2.GaussianBlur(noise, (0, 0), 6 * PIXELS_PER_PERIOD)
    return angle + 0.12 * disturbance / disturbance.std()


def _seeds(size: int, rng: Rng) -> Array:
    """Where ridges start: weak noise everywhere, strong at the core, the tip and the joint."""
    axis = np.linspace(-1, 1, size, dtype=np.float32)
    x, y = axis[None, :], axis[:, None]
    core = np.exp(-(x**2 + y**2) / 0.02)
    tip = np.exp(-((np.hypot(x, y - 0.1) - 0.85) ** 2) / 0.005) * (y < 0.2)
    joint = np.exp(-((y - 0.85) ** 2) / 0.005)
    noise = rng.normal(size=(size, size))
    return np.asarray((0.03 + 0.2 * (core + tip + joint)) * noise, np.float32)


@lru_cache(maxsize=16)
def grow_ridges(kind: str, seed: int, periods: int = 54, steps: int = 360) -> RidgePattern:
    """Grow a square of ridges, `periods` wide."""
    rng = np.random.default_rng(seed)
    angle = ridge_directions(kind, periods, rng)
    wave_number2 = (2 * np.pi / PIXELS_PER_PERIOD) ** 2
    # The fastest-growing wave number q has 1 + dq² = √(d/D).
    ratio = 20.0
    diffusion = (np.sqrt(ratio) - 1) / ratio / wave_number2
    along, across = 3.0 * diffusion, diffusion
    cos2, sin2 = np.cos(2 * angle), np.sin(2 * angle)
    mean, half = (along + across) / 2, (along - across) / 2
    # Rows run downward: the mixed derivative changes sign.
    d_xx, d_yy, d_xy = (
        np.asarray(d, np.float32) for d in (mean + half * cos2, mean - half * cos2, -2 * half * sin2)
    )
    size = angle.shape[0]
    q2 = (2 * np.pi) ** 2 * (fft.fftfreq(size)[:, None] ** 2 + fft.rfftfreq(size) ** 2)
    inhibition = np.asarray(1 / (1 + ratio * diffusion * q2), np.float32)
    u = _seeds(size, rng)
    step = 0.36
    xx = np.array([[1, -2, 1]], np.float32)
    mixed = np.array([[1, 0, -1], [0, 0, 0], [-1, 0, 1]], np.float32) / 4
    for _ in range(steps):
        v = fft.irfft2(fft.rfft2(u) * inhibition, u.shape)
        padded = cv2.copyMakeBorder(u, 1, 1, 1, 1, cv2.BORDER_WRAP)
        u_xx, u_yy, u_xy = (cv2.filter2D(padded, -1, k)[1:-1, 1:-1] for k in (xx, xx.T, mixed))
        u = u + np.float32(step) * (d_xx * u_xx + d_yy * u_yy + d_xy * u_xy + 0.52 * u - u * u * u - v)
    return _with_odd_parts(u)


def _with_odd_parts(u: Array) -> RidgePattern:
    spectrum = fft.fft2(u)
    row, column = fft.fftfreq(u.shape[0])[:, None], fft.fftfreq(u.shape[1])[None, :]
    frequency = np.hypot(row, column)
    # Harmonics and slow drifts are no ridges.
    band = np.exp(-((np.log(np.maximum(frequency, 1e-9) * PIXELS_PER_PERIOD) / 0.6) ** 4))
    spectrum *= band
    safe = np.maximum(frequency, 1e-9)
    even, first, second = (
        np.asarray(fft.ifft2(spectrum * part).real, np.float32)
        for part in (1, -1j * row / safe, -1j * column / safe)
    )
    return RidgePattern(even, (first, second))
