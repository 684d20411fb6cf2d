"""Contact images of known truth that share no model with the library, to test its measurements.

`benchmarks.truth.independent_ridges` gives the contact and defines the gross and the ridge area. Here the
contact is seen by a device: a scanner's platen, a camera behind a prism, or ink on paper.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy import ndimage

from benchmarks.arrays import Array, Range, Rng
from benchmarks.truth.independent_ridges import Outline, RidgedContact, draw_contact, smooth_noise, stamp
from benchmarks.truth.true_image import TrueImage

SUBPIXEL = 0.0135
FWHM = 2.3548


@dataclass(frozen=True)
class Condition:
    """What images have in common; each draws from the pairs. Lengths in mm, grey as a share of white."""

    growth: str = "gabor"  # or "swift-hohenberg"
    # Mean distance inside the outline over which ridges reach their full width and contrast, both in
    # proportion to the pressure √(1 − ρ²)
    width_fade: float = 0.8
    contrast_fade: float = 0.2
    shape: float = 0.0  # relative amplitude of the outline's perturbation; 0 for an exact ellipse
    features: float = 1.0  # density of pores, broken ridges and creases
    uneven: float = 1.0  # variation of darkness, of the lean of the pressure, of the heights of ridge tops
    ppi: float = 500
    blur: Range = (0.03, 0.1)  # full width at half maximum of the point-spread function
    contrast: Range = (0.45, 0.75)  # grey of a ridge below the ground
    ground: Range = (0.82, 0.95)  # grey of untouched glass; of bright ridges 1 less that
    noise: float = 0.012  # standard deviation; half of the variance is correlated over a pixel
    haze: float = 0.06  # darkness of valleys and of a halo around the contact, relative to the ridges
    lighting: float = 0.04  # relative variation of the light over the image
    glare: float = 0.0  # grey that it adds at one side
    bright: bool = False  # ridges brighter than the ground (dark-field prism)
    dirt: float = 0.01  # specks per mm² of glass; fibres come with them
    smears: int = 0  # latent smears outside the contact
    rim: float = 0.0  # darkness of a sweat meniscus along the outline, over that of ridges
    bits: int = 8


_CLEAN = Condition(
    width_fade=0, contrast_fade=0, features=0, uneven=0, haze=0, dirt=0, lighting=0, noise=0.005
)

CONDITIONS: dict[str, Condition] = {
    "clean, sharp edge": _CLEAN,
    "width fades over 0.5 mm": Condition(width_fade=0.5, contrast_fade=0),
    "width fades over 1 mm": Condition(width_fade=1, contrast_fade=0),
    "width fades over 1.5 mm": Condition(width_fade=1.5, contrast_fade=0),
    "contrast fades over 0.5 mm": Condition(width_fade=0, contrast_fade=0.5),
    "contrast fades over 1 mm": Condition(width_fade=0, contrast_fade=1),
    "contrast fades over 1.5 mm": Condition(width_fade=0, contrast_fade=1.5),
    "both fade over 0.5 mm": Condition(width_fade=0.5, contrast_fade=0.5),
    "both fade over 1.5 mm": Condition(width_fade=1.5, contrast_fade=1.5),
    "dirt": Condition(dirt=0.12),
    "smears": Condition(smears=5),
    "low contrast": Condition(contrast=(0.08, 0.15), bits=16),
    "noise": Condition(noise=0.1),
    "uneven light and glare": Condition(lighting=0.25, glare=0.2),
    "bright ridges": Condition(bright=True),
    "300 ppi": Condition(ppi=300, blur=(0.08, 0.15)),
    "1000 ppi": Condition(ppi=1000, blur=(0.02, 0.06), bits=16),
    "dark rim": Condition(rim=0.6),
    "light rim": Condition(rim=-0.25),
    "breaks, pores and creases": Condition(features=4, uneven=1.5),
    "not an ellipse": Condition(shape=0.06),
    "Swift–Hohenberg, clean": replace(_CLEAN, growth="swift-hohenberg"),
    "Swift–Hohenberg, both fade over 1 mm": Condition("swift-hohenberg", width_fade=1, contrast_fade=1),
    "everything": Condition(
        "swift-hohenberg", shape=0.04, features=2, dirt=0.05, smears=3, noise=0.04, lighting=0.15, haze=0.12
    ),
}


def render(rng: Rng, condition: Condition) -> TrueImage:
    """Return an image of a random contact under a condition.

    The contact is drawn from one stream of random numbers and the device from another, so that the truth is
    the same for every device. Semi-axes are those of the ellipse of equal second moments: if the outline is
    none, π times both differs from the gross area.
    """
    of_contact, of_device = rng.spawn(2)
    of_skin = ("growth", "width_fade", "shape", "features", "uneven")
    contact = draw_contact(of_contact, **{name: getattr(condition, name) for name in of_skin})
    pixels, (area, _, *axes) = _photograph(of_device, contact, condition), contact.outline.moments()
    return TrueImage(pixels, 25.4 / condition.ppi, area, contact.ridge_area(), (axes[0], axes[1]))


def _photograph(rng: Rng, contact: RidgedContact, condition: Condition) -> Array:
    step = 25.4 / condition.ppi
    low, high = contact.outline.points().min(axis=0), contact.outline.points().max(axis=0)
    before, after = rng.uniform(1.5, 4, (2, 2))
    origin = before - low
    columns, rows = np.ceil((origin + high + after) / step).astype(int)
    x, y = (np.arange(columns) + 0.5) * step - origin[0], (np.arange(rows) + 0.5) * step - origin[1]
    shape = (int(rows), int(columns))
    light, glare = _lighting(rng, shape, condition)
    darkness = _darkness(rng, contact, condition, x, y)
    darkness = ndimage.gaussian_filter(darkness, rng.uniform(*condition.blur) / FWHM / step)
    contrast, ground = rng.uniform(*condition.contrast), rng.uniform(*condition.ground)
    if condition.bright:
        contrast, ground = -contrast, 1 - ground
    fine = smooth_noise(rng, shape, 1e-3) + smooth_noise(rng, shape, 0.8)
    grey = light * (ground - contrast * darkness) + glare + condition.noise / np.sqrt(2) * fine
    full = 2**condition.bits - 1
    return np.round(full * np.clip(grey, 0, 1)).astype(np.uint8 if condition.bits == 8 else np.uint16)


def _lighting(rng: Rng, shape: tuple[int, int], condition: Condition) -> tuple[Array, Array]:
    """Return the relative light and the grey of the glare over the image."""
    v, u = np.linspace(-1, 1, shape[0])[:, None], np.linspace(-1, 1, shape[1])[None, :]
    slope, turn = rng.uniform(0, 2 * np.pi, 2)
    light = 0.5 * (np.cos(slope) * u + np.sin(slope) * v) - 0.5 * rng.uniform() * (u**2 + v**2) / 2
    glare = np.exp(2.2 * (np.cos(turn) * u + np.sin(turn) * v - abs(np.cos(turn)) - abs(np.sin(turn))))
    return 1 + condition.lighting * light, condition.glare * glare


def _darkness(rng: Rng, contact: RidgedContact, condition: Condition, x: Array, y: Array) -> Array:
    """Return the darkness of pixels before the blur: 0 for clean glass, 1 for a usual ridge."""
    step, shape = x[1] - x[0], (y.size, x.size)
    rho = np.sqrt(contact.outline.level(x[None, :], y[:, None]))
    inside = (1 - rho) * step / np.maximum(np.hypot(*np.gradient(rho)), 1e-3 * step)
    grain = smooth_noise(rng, shape, 0.05 / step)
    moisture = _slow_noise(rng, shape, step, 2.5)
    ridges = _ridge_darkness(contact, contact.outline.pressure_at(condition.contrast_fade), x, y)
    ridges *= np.clip(1 + condition.uneven * (0.12 * moisture + 0.18 * grain), 0.3, 1.3)
    halo = np.where(inside > 0, 1, np.exp(np.minimum(inside, 0) / 0.4))
    haze = condition.haze * halo * np.clip(1 + 0.4 * moisture + 0.5 * grain, 0, None)
    dirt = _dirt(rng, shape, step, condition.dirt)
    latent = _smears(rng, contact.outline, condition.smears, x, y) * np.clip(-inside / 0.1, 0, 1)
    width = rng.uniform(0.1, 0.3)
    band = condition.rim * np.exp(-0.5 * (inside * FWHM / width) ** 2)
    wet = np.clip(0.7 + 0.6 * _slow_noise(rng, shape, step, 1.5), 0, 1.3)
    clear = (1 - ridges) * (1 - haze) * (1 - dirt) * (1 - latent) * (1 - band * wet)
    return 1 - clear


def _ridge_darkness(contact: RidgedContact, full_contrast_pressure: float, x: Array, y: Array) -> Array:
    """Return the mean over each pixel of the contrast of what touches in it."""
    step = x[1] - x[0]
    parts = int(np.ceil(step / SUBPIXEL))
    reach = np.abs(contact.outline.points()).max(axis=0) + step
    rows, columns = (np.flatnonzero(np.abs(at) < r) for at, r in zip((y, x), reach[::-1], strict=True))
    within = ((np.arange(parts) + 0.5) / parts - 0.5) * step
    fine_x, fine_y = (x[columns, None] + within).ravel(), (y[rows, None] + within).ravel()
    touching, pressure = contact.touching(fine_x, fine_y)
    contrast = touching * np.minimum(pressure / np.float32(full_contrast_pressure), 1)
    darkness = np.zeros((y.size, x.size))
    blocks = contrast.reshape(rows.size, parts, columns.size, parts)
    darkness[np.ix_(rows, columns)] = blocks.mean(axis=(1, 3))
    return darkness


def _slow_noise(rng: Rng, shape: tuple[int, int], step: float, length: float) -> Array:
    """Return smooth noise of unit variance that varies over a length in mm."""
    knots = rng.standard_normal([int(n * step / length) + 4 for n in shape])
    noise = ndimage.zoom(knots, np.array(shape) / knots.shape, order=3, mode="nearest", grid_mode=True)
    return noise / noise.std()


def _dirt(rng: Rng, shape: tuple[int, int], step: float, density: float) -> Array:
    """Return the darkness of specks and fibres that lie anywhere on the glass."""
    dirt = np.zeros(shape)
    area = dirt.size * step**2
    for _ in range(rng.poisson(density * area)):
        size = np.clip(0.06 * np.exp(rng.normal(0, 0.6)), 0.02, 0.3)
        sizes = (size, size * rng.uniform(0.4, 1))
        angle, height = rng.uniform(0, np.pi), rng.uniform(0.3, 1.5)
        stamp(dirt, tuple(rng.uniform(0, shape)), sizes, angle=angle, height=height, step=step)
    for _ in range(rng.poisson(0.03 * density * area)):
        at, angle, turn = rng.uniform(0, shape), rng.uniform(0, 2 * np.pi), rng.normal(0, 0.03)
        for _ in range(int(rng.uniform(30, 120))):
            angle += turn
            at = at + np.array([np.sin(angle), np.cos(angle)]) * 0.03 / step
            stamp(dirt, (at[0], at[1]), (0.03, 0.03), angle=0, height=0.35, step=step)
    return np.clip(dirt, 0, 0.9)


def _smears(rng: Rng, outline: Outline, count: int, x: Array, y: Array) -> Array:
    """Return the darkness of streaky or ridged remains of earlier contacts around an outline."""
    total = np.zeros((y.size, x.size))
    for place in outline.points()[rng.integers(2000, size=count)] * rng.uniform(1.05, 1.5, (count, 1)):
        angle, wave = rng.uniform(0, 2 * np.pi, 2)
        u, v = x[None, :] - place[0], y[:, None] - place[1]
        p, q = np.cos(angle) * u + np.sin(angle) * v, np.cos(angle) * v - np.sin(angle) * u
        length, width, period = rng.uniform(0.8, 2.2), rng.uniform(0.4, 1.1), rng.uniform(0.3, 0.6)
        streaks = np.interp(q, np.arange(-30, 30, 0.15), rng.uniform(0, 1, 400))
        ridged = 0.5 + 0.5 * np.tanh(2 * np.cos(2 * np.pi * (q + 0.03 * p**2) / period + wave))
        texture = streaks if rng.uniform() < 0.5 else ridged
        total += rng.uniform(0.15, 0.5) * texture * np.exp(-0.5 * ((p / length) ** 2 + (q / width) ** 2) ** 2)
    return np.clip(total, 0, 0.8)
