"""Contact images of elastic ridges.

Written from the physics, without a look at the measurement. A wavy elastic surface under mean pressure p
touches a plane over the share (2/π) arcsin √(p/p*) of its period (Westergaard; Johnson 1985, §13.2), and p
falls as (1 − ρ²)^s over an ellipse. The phase of the ridges is a formula: waves around cores, with spirals
for minutiae. The truth is counted on a grid at least four times finer than the image; menisci, ink that
spreads, and contact too faint to see count as errors of the measurement.
"""

from dataclasses import dataclass
from functools import partial

import cv2
import numpy as np

from benchmarks.arrays import Array, Pair, Range, Rng
from benchmarks.truth.true_image import TrueImage, eight_bit, holes, smooth_noise

_FINEST, _MARGIN_MM, _WIDEST = 0.012, 2.0, 0.82


@dataclass(frozen=True)
class Condition:
    """What a set of images has in common; each image draws from the ranges. Lengths in mm, grey as shares."""

    pixel: Range = (0.03, 0.0508)
    area: Range = (70, 220)
    exponent: float = 0.5  # s of the pressure: Hertz's ½, flatter below, a bell above
    threshold: float = 0.0  # of the mean pressure, below which a ridge of mean height does not touch
    whorl: bool = False  # always, so that ridges run along the edge
    width: Range = (0.4, 0.65)  # mean share of the period that touches
    pores: float = 0.4  # per period along a ridge
    breaks: float = 0.0  # share of the skin too dry to couple light
    grain: float = 0.15  # scatter of the contact's density over 0.04 mm
    blur: Range = (0.02, 0.05)  # standard deviation of the point spread
    disc: Range = (0.0, 0.05)  # diameter of the circle of confusion
    stray: float = 0.05  # share of the light spread over 0.8 mm
    gamma: float = 1.0
    ground: float = 0.9
    ridge: float = 0.15
    noise: float = 0.012
    sharpen: float = 0.0
    mottle: float = 0.0
    jpeg: int = 0
    spread: Range = (0.0, 0.0)  # liquid or ink beside each touching ridge
    paper: float = 0.0
    lifted: float = 0.0  # contrast of ridges that do not touch, seen through the plate beside the contact
    halo: float = 0.0  # darkness beside the contact, which fades over a mm


CONDITIONS = {
    "prism, sharp": Condition(),
    "prism, out of focus": Condition(disc=(0.1, 0.18)),
    "prism, gamma-coded": Condition(gamma=1 / 2.2),
    "prism, moist": Condition(spread=(0.01, 0.03), pores=0.15, width=(0.5, 0.7)),
    "prism, dry": Condition(breaks=0.12, grain=0.35, width=(0.3, 0.5)),
    "prism, strong stray light": Condition(stray=0.25),
    "dark field": Condition(ground=0.08, ridge=0.75, noise=0.025),
    "live-scan": Condition(pixel=(0.0508, 0.0508), sharpen=0.7, mottle=0.08, jpeg=85, ridge=0.2),
    "live-scan, dry": Condition(
        pixel=(0.0508, 0.0508), sharpen=0.7, mottle=0.1, jpeg=75, breaks=0.12, grain=0.3, ridge=0.3
    ),
    "ink, little": Condition(paper=0.35, ridge=0.25, ground=0.85, grain=0.3, spread=(-0.005, 0.01)),
    "ink, much": Condition(paper=0.2, ridge=0.1, ground=0.85, spread=(0.01, 0.03)),
    "thin ridges": Condition(width=(0.22, 0.32)),
    "wide ridges": Condition(width=(0.65, 0.78)),
    "300 ppi": Condition(pixel=(0.0847, 0.0847)),
    "1000 ppi": Condition(pixel=(0.0254, 0.0254), blur=(0.01, 0.025)),
    "noise": Condition(noise=0.08),
    "flat pressure": Condition(exponent=0.2, threshold=0.04),
    "pressure falls slowly": Condition(exponent=1.0, threshold=0.04),
    "bell-shaped pressure": Condition(exponent=1.6, threshold=0.04),
    "light touch": Condition(area=(30, 45), pixel=(0.02, 0.03), threshold=0.12),
    "light touch, ridges along the edge": Condition(area=(30, 45), whorl=True, threshold=0.25),
    "dark halo": Condition(halo=0.25),
    "plate lit from above": Condition(lifted=0.22, halo=0.18, ridge=0.4),
}


smooth = partial(smooth_noise, knots=lambda n: int(n) + 3)


def _phase(x: Array, y: Array, step: float, whorl: bool, rng: Rng) -> Array:
    """Phase of the ridges, 0 on a crest: a whorl, a loop or an arch, bent, with spirals as minutiae."""
    period = rng.uniform(0.4, 0.56)
    bend = 0.35 * smooth(rng, x.shape, 2.5 / step)
    kind = rng.integers(3)
    if whorl or kind == 0:
        distance = np.hypot(0.85 * x, y - rng.uniform(-2, 2))
    elif kind == 1:
        slope = rng.uniform(-0.5, 0.5)
        below = np.maximum(-(y - 1 + slope * x), 0)
        distance = np.hypot(x - slope * below, y + below)
    else:
        distance = y + rng.uniform(2, 5) * np.exp(-((x / rng.uniform(4, 7)) ** 2))
    phase = 2 * np.pi * (distance + bend) / period
    reach = np.array([x.max(), y.max()])
    spirals = np.ones(x.shape, np.complex64)
    places = x + 1j * y.astype(np.float64)
    for centre in rng.uniform(-1, 1, (rng.poisson(25), 2)) * reach @ [1, 1j]:
        from_it = places - centre
        spirals *= 0.125 * (from_it if rng.choice([-1, 1]) > 0 else from_it.conj())
    return phase + np.angle(spirals) + 0.25 * smooth(rng, x.shape, 0.08 / step)


def _contact(x: Array, y: Array, semi_axes: Pair, c: Condition, rng: Rng) -> tuple[Array, Array, Array]:
    """Return where ridges touch, without holes, the distance from the crest over half a period, and ρ²."""
    step = float(y[1, 0] - y[0, 0])
    width, turn = rng.uniform(*c.width), rng.normal(0, 0.3)
    u, v = x * np.cos(turn) + y * np.sin(turn), y * np.cos(turn) - x * np.sin(turn)
    level = (v / semi_axes[0]) ** 2 + (u / semi_axes[1]) ** 2
    pressure = np.maximum(1 - level, 0) ** c.exponent
    crest = np.abs((_phase(u, v, step, c.whorl, rng) / np.pi + 1) % 2 - 1)
    inside, heights = pressure > 0, np.exp(0.25 * smooth(rng, x.shape, 0.8 / step))
    # The mean of (1 − ρ²)^s is 1/(s + 1).
    pressure = np.maximum(pressure * heights - c.threshold / (c.exponent + 1), 0)
    few = pressure[::9, ::9][inside[::9, ::9]]
    low, high = 1e-3, 1e3
    for _ in range(30):  # p* that gives the mean width
        flat = np.sqrt(low * high)
        low, high = (flat, high) if _share(few / flat).mean() > width else (low, flat)
    return (crest < _share(pressure / flat)) & inside, crest, level


def _share(pressure: Array) -> Array:
    """Return the share of the period that touches; the valleys of skin are too deep to close."""
    return np.minimum(2 / np.pi * np.arcsin(np.sqrt(np.minimum(pressure, 1))), _WIDEST)


def _picture(touching: Array, beside: Array, step: float, binning: int, c: Condition, *, rng: Rng) -> Array:
    """Return the image, 0 to 1, of the touching ridges and of what is seen beside them."""
    shape, density = touching.shape, touching.astype(np.float32)
    spread = rng.uniform(*c.spread)
    if spread:
        inside = cv2.distanceTransform((density > 0).astype(np.uint8), cv2.DIST_L2, 3)
        outside = cv2.distanceTransform((density == 0).astype(np.uint8), cv2.DIST_L2, 3)
        density = (outside - inside < spread / step).astype(np.float32)
    density *= np.clip(1 + c.grain * smooth(rng, shape, 0.04 / step), 0, 1.3)
    if c.breaks:
        dry = smooth(rng, shape, 0.25 / step)
        density *= np.clip((dry - np.quantile(dry, c.breaks)) / 0.5 + 0.5, 0.1, 1)
    if c.paper:
        fibre = smooth(rng, shape, 0.05 / step) + 0.5 * smooth(rng, shape, 0.2 / step)
        density *= np.clip(1 + c.paper * fibre, 0, 1.2)
    sigma = max(rng.uniform(*c.blur) / step, 0.3)
    density = np.asarray(cv2.GaussianBlur(np.maximum(density, beside), (0, 0), sigma), np.float32)
    disc = rng.uniform(*c.disc) / 2 / step
    if disc > 1:
        reach = int(disc) + 1
        square = np.add.outer(*(np.arange(-reach, reach + 1) ** 2,) * 2)
        kernel = np.clip(disc - np.sqrt(square) + 0.5, 0, 1)
        density = np.asarray(cv2.filter2D(density, -1, kernel / kernel.sum()), np.float32)
    rows, columns = (n // binning for n in shape)
    seen: Array = np.asarray(cv2.resize(density, (columns, rows), interpolation=cv2.INTER_AREA))
    seen = (1 - c.stray) * seen + c.stray * cv2.GaussianBlur(seen, (0, 0), 0.8 / step / binning)
    grey = np.asarray(c.ground + (c.ridge - c.ground) * seen)
    down, right = np.mgrid[-1 : 1 : rows * 1j, -1 : 1 : columns * 1j]
    grey = grey * (1 + rng.uniform(-0.08, 0.08) * right + rng.uniform(-0.08, 0.08) * down)
    if c.mottle:
        grey = grey + c.mottle * smooth(rng, grey.shape, 1.2) * (grey < (c.ground + c.ridge) / 2)
    grey = grey + c.noise * np.sqrt(np.clip(grey, 0.05, None)) * rng.normal(size=grey.shape)
    grey = np.clip(grey, 0, None) ** c.gamma
    return grey + c.sharpen * (grey - cv2.GaussianBlur(grey, (0, 0), 1.2))


def render(rng: Rng, c: Condition) -> TrueImage:
    """Make an image of a condition."""
    area, aspect, pixel = rng.uniform(*c.area), rng.uniform(1.05, 1.55), rng.uniform(*c.pixel)
    semi_axes = float(np.sqrt(area * aspect / np.pi)), float(np.sqrt(area / aspect / np.pi))
    binning = max(4, int(np.ceil(pixel / _FINEST)))
    step = pixel / binning
    # half the rows and columns of the fine grid, a whole number of pixels
    halves = semi_axes[0] + _MARGIN_MM, (2 * semi_axes[1] + semi_axes[0]) / 3 + _MARGIN_MM
    down, right = ((np.arange(-n, n) + 0.5) * step for n in (int(h / pixel) * binning for h in halves))
    x, y = np.meshgrid(right.astype(np.float32), down.astype(np.float32))
    touching, crest, level = _contact(x, y, semi_axes, c, rng)
    touching &= ~holes(
        rng, crest < 0.3, step, c.pores,
        radius=(0.03, 0.06), creases=lambda: rng.poisson(1), length=(2, 6), width=(0.06, 0.15),
    )  # fmt: skip
    # what is seen beside the contact, so many mm beyond it
    beyond = np.maximum(np.sqrt(level) - 1, 0) * np.sqrt(area / np.pi)
    lifted = c.lifted * (1 + np.cos(np.pi * crest)) / 2 * np.exp(-(beyond**1.5) / 0.8)
    beside = np.asarray(np.maximum(lifted, c.halo * np.exp(-beyond)), np.float32)
    pixels = eight_bit(_picture(touching, beside, step, binning, c, rng=rng), c.jpeg)
    return TrueImage(pixels, pixel, area, float(touching.sum() * step**2), semi_axes)
