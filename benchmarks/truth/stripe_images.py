"""Contact images of ridges grown as stripe patterns.

Written from the physics, without a look at the measurement. Ridges are level lines of a phase that follows
an orientation field as well as it can (Knöppel et al., ACM Trans. Graph. 34, 2015); its zeros are the
minutiae. The skin overlaps the glass by t, which vanishes on the outline and rises over some tenths of a
mm to 1.5 mm; a ridge of profile |sin φ/2|^e touches where this is less than t, in units of its height.

The gross area is that inside the outline, where overlap and so mean pressure vanish. The ridge area is what
touches inside it, without pores, on a grid of at least four lines per pixel; sweat beside a ridge is none.
Semi-axes are those of equal second moments: the ellipse's own where the outline is one.
"""

from dataclasses import dataclass
from functools import lru_cache, partial

import cv2
import numpy as np

from benchmarks.arrays import Array, Range, Rng
from benchmarks.truth.true_image import TrueImage, eight_bit, holes, smooth_noise

_FINEST, _MARGIN_MM, _PER_PERIOD = 0.013, 2.0, 5.0


@dataclass(frozen=True)
class Condition:
    """What images have in common; each draws from the ranges. Lengths in mm, grey levels from 0 to 1."""

    scanner: bool = False  # clipped and sharpened, in place of a camera behind a prism
    bright: bool = False  # ridges brighter than the ground
    ppi: float = 500
    area: Range = (70, 190)
    fade: Range = (0.2, 0.5)  # over which the overlap rises, and with it the width of ridges
    order: Range = (0.8, 1.2)  # exponent of its rise; 2 for a bell
    tips: float = 0.0  # relative difference of the fade between tips and sides
    lean: float = 0.15  # relative difference of the overlap from one side to the other
    dim: Range = (0.05, 0.2)  # over which the contrast rises
    width: Range = (0.4, 0.65)  # share of the period that touches in the middle
    exponent: float = 2.0  # of a superellipse
    egg: float = 0.0
    turn: float = 0.2  # standard deviation of the outline's angle
    film: Range = (0.0, 0.02)  # gap that sweat fills, as a share of the ridge's height
    dry: float = 0.1  # scatter of the coupling along ridges
    pores: float = 0.5  # per period along a ridge
    rim: float = 0.0  # darkness along the outline; negative is lighter
    blur: Range = (0.02, 0.05)
    contrast: Range = (0.4, 0.7)
    vignette: float = 0.1
    dirt: float = 0.02  # specks per mm²
    noise: float = 0.012
    jpeg: int = 0


CONDITIONS = {
    "prism": Condition(),
    "prism, width fades over 0.3 mm": Condition(fade=(0.3, 0.3), dim=(0.01, 0.02)),
    "prism, width fades over 0.8 mm": Condition(fade=(0.8, 0.8), dim=(0.01, 0.02)),
    "prism, width fades over 1.5 mm": Condition(fade=(1.5, 1.5), dim=(0.01, 0.02)),
    "prism, contrast fades over 0.4 mm": Condition(fade=(0.05, 0.1), dim=(0.4, 0.4)),
    "prism, contrast fades over 1.2 mm": Condition(fade=(0.05, 0.1), dim=(1.2, 1.2)),
    "prism, both fade over 0.6 mm": Condition(fade=(0.6, 0.6), dim=(0.6, 0.6)),
    "prism, bell": Condition(fade=(0.3, 0.6), order=(1.6, 2.2)),
    "prism, tips fade slowly": Condition(fade=(0.5, 0.9), tips=0.6, order=(1.0, 1.5)),
    "prism, dark rim": Condition(rim=0.5),
    "prism, light rim": Condition(rim=-0.25, contrast=(0.35, 0.5)),
    "prism, moist": Condition(film=(0.05, 0.25), width=(0.5, 0.7), pores=0.1, dry=0.03),
    "prism, dry": Condition(dry=0.35, width=(0.25, 0.45), contrast=(0.3, 0.5)),
    "prism, bright ridges": Condition(bright=True, noise=0.025),
    "prism, vignetting and dirt": Condition(vignette=0.4, dirt=0.15),
    "prism, noise": Condition(noise=0.07, contrast=(0.3, 0.5)),
    "prism, superellipse": Condition(exponent=2.6),
    "prism, egg, oblique, leaning": Condition(egg=0.12, turn=0.6, lean=0.5),
    "scanner": Condition(scanner=True, jpeg=90),
    "scanner, JPEG 60": Condition(scanner=True, jpeg=60),
    "scanner, 1000 ppi": Condition(scanner=True, ppi=1000, blur=(0.015, 0.03)),
    "scanner, 300 ppi": Condition(scanner=True, ppi=300, blur=(0.03, 0.06)),
    "scanner, moist": Condition(scanner=True, film=(0.05, 0.25), width=(0.5, 0.7), dry=0.03, jpeg=85),
    "scanner, dry": Condition(scanner=True, dry=0.35, width=(0.25, 0.45), jpeg=85, dim=(0.1, 0.4)),
}


smooth = partial(smooth_noise, knots=lambda n: int(np.ceil(n)) + 4, per_length=2.5)


@lru_cache(maxsize=16)
def grow_stripes(number: int, rows: int = 340, columns: int = 280, steps: int = 260) -> tuple[Array, Array]:
    """Return cosine and magnitude of a stripe pattern with five samples per period.

    A complex number at each sample turns with the distance across the ridges; each step replaces it by the
    mean of what its neighbours expect. Where the chosen sense of the orientation differs, a neighbour counts
    as its complex conjugate.
    """
    rng = np.random.default_rng([77, number])
    y, x = np.mgrid[:rows, :columns].astype(np.float32)
    z = x - columns / 2 - 1j * (y - rows / 2)
    reach = columns / 2
    cores = [complex(*rng.normal(0, 0.15, 2)) + 0.2j, complex(*rng.normal(0, 0.15, 2)) - 0.2j][: number % 3]
    deltas = [rng.choice([-1, 1]) * 0.75 - 0.8j, 0.75 - 0.85j, -0.75 - 0.85j]
    deltas = deltas[:1] if number % 3 < 2 else deltas[1:]
    along = sum(np.angle(z / reach - c) for c in cores) / 2
    along = along - sum(np.angle((z / reach - d) * 1j) for d in deltas[: len(cores)]) / 2
    across = along + np.pi / 2 + 0.25 * smooth(rng, (rows, columns), 60)
    if not cores:
        across = np.pi / 2 + 0.6 * np.sin(2.2 * z.real / reach) * np.exp(-((z.imag / reach) ** 2))
    turn = 2 * np.pi / _PER_PERIOD * np.exp(0.06 * smooth(rng, (rows, columns), 40))
    wave = np.stack([turn * np.cos(across), turn * np.sin(across)])  # right and up
    field = np.exp(2j * np.pi * rng.random((rows, columns))).astype(np.complex64)
    links = []
    for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
        for sense in (1, -1):
            move = (sense * down, sense * right)
            other = np.roll(wave, move, axis=(1, 2))
            same = np.sign((wave * other).sum(axis=0))
            mean = (wave + same * other) / 2
            advance = np.exp(1j * (mean[0] * move[1] - mean[1] * move[0])).astype(np.complex64)
            links.append((move, same < 0, advance / np.hypot(*move)))
    for _ in range(steps):
        total = np.zeros_like(field)
        for move, flipped, advance in links:
            moved = np.roll(field, move, axis=(0, 1))
            np.conjugate(moved, out=moved, where=flipped)
            total += moved * advance
        size = np.abs(total)
        field = total / (size + 0.3)
    return np.asarray(field.real), np.asarray(np.abs(field))


def _ridge_phase(x: Array, y: Array, period: float, turn: float, rng: Rng) -> Array:
    """Return |φ|, from 0 on a crest to π in a valley."""
    cosine, size = grow_stripes(int(rng.integers(8)))
    scale = _PER_PERIOD / period
    middle = np.array(cosine.shape[::-1]) / 2 + rng.uniform(-6, 6, 2)
    u, v = np.cos(turn) * x + np.sin(turn) * y, np.cos(turn) * y - np.sin(turn) * x
    columns, rows = (np.asarray(m + scale * w, np.float32) for m, w in zip(middle, (u, v), strict=True))
    real, whole = (
        cv2.remap(f.astype(np.float32), columns, rows, cv2.INTER_LANCZOS4, borderMode=cv2.BORDER_REFLECT)
        for f in (cosine, size)
    )
    return np.arccos(np.clip(real / np.maximum(whole, 0.3), -1, 1))


def _outline(x: Array, y: Array, semi: Range, turn: float, c: Condition) -> tuple[Array, Array]:
    """Return the distance inside the outline, mm, and the angle around it from the major axis."""
    u, v = np.cos(turn) * x + np.sin(turn) * y, np.cos(turn) * y - np.sin(turn) * x
    v, u = v / semi[0], u / semi[1]
    u = u / (1 + c.egg * v)
    level = (np.abs(u) ** c.exponent + np.abs(v) ** c.exponent) ** (1 / c.exponent)
    down, right = np.gradient(level, float(y[1, 0] - y[0, 0]))
    return (1 - level) / np.maximum(np.hypot(down, right), 1e-3), np.arctan2(u, v)


def _contact(x: Array, y: Array, semi: Range, c: Condition, rng: Rng) -> dict[str, Array]:
    """Return what touches, the gap as a share of the ridge's height, distance inside, and the contrast."""
    step = float(y[1, 0] - y[0, 0])
    turn, side = rng.normal(0, c.turn), rng.uniform(0, 2 * np.pi)
    inside, angle = _outline(x, y, semi, turn, c)
    depth = np.maximum(inside, 0)
    uneven = (1 + c.tips * np.cos(2 * angle)) * np.exp(0.1 * smooth(rng, x.shape, 3 / step))
    rise = np.minimum(depth / (rng.uniform(*c.fade) * uneven), 1) ** rng.uniform(*c.order)
    heights = np.exp(0.15 * smooth(rng, x.shape, 0.6 / step) + c.lean * np.sin(angle - side) * 0.5)
    profile = rng.uniform(1.7, 3)
    phase = _ridge_phase(x, y, rng.uniform(0.4, 0.55), turn + rng.normal(0, 0.1), rng)
    height = np.sin(phase / 2) ** profile
    full = np.sin(np.pi / 2 * rng.uniform(*c.width)) ** profile
    overlap = np.where(inside > 0, np.minimum(full * rise * heights, 0.85), -1.0)
    gap = height - overlap
    touching = (gap < 0) & (inside > 0)
    touching &= ~holes(
        rng, phase < 0.4, step, c.pores,
        radius=(0.025, 0.05), creases=lambda: int(rng.integers(0, 4)), length=(1, 5), width=(0.05, 0.12),
    )  # fmt: skip
    contrast = np.minimum(depth / (rng.uniform(*c.dim) * uneven), 1)
    return {"touching": touching, "gap": gap, "inside": inside, "contrast": contrast}


def _darkness(parts: dict[str, Array], step: float, c: Condition, rng: Rng) -> Array:
    """Return what the glass shows on the fine grid: 1 for a usual ridge, 0 for clean glass."""
    shape = parts["gap"].shape
    film = rng.uniform(*c.film) * np.clip(0.7 + 0.5 * smooth(rng, shape, 2 / step), 0, 1.5)
    wet = (parts["gap"] < film) & (parts["inside"] > 0) & ((parts["gap"] > 0) | parts["touching"])
    patches = 1 + c.dry * (smooth(rng, shape, 0.05 / step) + smooth(rng, shape, 0.3 / step)) / np.sqrt(2)
    dark = np.maximum(wet * 0.95, parts["touching"]) * parts["contrast"] * np.clip(patches, 0.05, 1.2)
    if c.rim:
        wide = rng.uniform(0.1, 0.25)
        band = np.exp(-0.5 * ((parts["inside"] + rng.uniform(0, 0.1)) / wide) ** 2)
        band = c.rim * band * np.clip(0.8 + 0.4 * smooth(rng, shape, 1.5 / step), 0, 1.4)
        dark = 1 - (1 - dark) * (1 - band) if c.rim > 0 else dark + band
    return np.asarray(dark, np.float32)


def _dirt(shape: tuple[int, int], step: float, density: float, rng: Rng) -> Array:
    """Return specks and fibres anywhere on the glass, from 0 to 0.8."""
    dirt = np.zeros(shape, np.float32)
    count = rng.poisson(density * dirt.size * step**2)
    for row, column in rng.uniform(0, shape, (count, 2)):
        size = np.clip(0.05 * np.exp(rng.normal(0, 0.5)), 0.02, 0.25) / step
        at, axes = (int(column), int(row)), (max(1, round(size)), max(1, round(size * rng.uniform(0.4, 1))))
        cv2.ellipse(dirt, at, axes, rng.uniform(0, 180), 0, 360, rng.uniform(0.2, 0.8), -1)
    for row, column in rng.uniform(0, shape, (count // 25, 2)):
        way = np.cumsum(rng.normal(0, 0.05 / step, (40, 2)) + rng.normal(0, 0.06 / step, 2), axis=0)
        path = (way + np.array((column, row))).astype(np.int32)
        cv2.polylines(dirt, [path], False, 0.5, max(1, round(0.03 / step)))
    return dirt


def _picture(dark: Array, step: float, binning: int, c: Condition, rng: Rng) -> Array:
    dark = 1 - (1 - dark) * (1 - _dirt(dark.shape, step, c.dirt, rng))
    dark = cv2.GaussianBlur(dark.astype(np.float32), (0, 0), rng.uniform(*c.blur) / step)
    dark = 0.95 * dark + 0.05 * cv2.GaussianBlur(dark, (0, 0), 0.6 / step)
    rows, columns = (n // binning for n in dark.shape)
    dark = cv2.resize(dark, (columns, rows), interpolation=cv2.INTER_AREA)
    contrast = rng.uniform(*c.contrast)
    down, right = np.mgrid[-1 : 1 : rows * 1j, -1 : 1 : columns * 1j]
    ground = 0.1 if c.bright else rng.uniform(0.8, 0.92)
    light = (1 - c.vignette * (down**2 + right**2) / 2) * (1 + rng.uniform(-0.06, 0.06) * right)
    grey = (ground + (contrast if c.bright else -contrast) * dark) * light
    if c.scanner:
        grey = (grey - ground + contrast) / contrast
        grey = 0.12 + 0.86 * np.clip(grey, -0.2, 1.2)
        grey = grey + 0.6 * (grey - cv2.GaussianBlur(grey, (0, 0), 1.3))
    grey = grey + c.noise * np.sqrt(np.clip(grey, 0.1, 1)) * rng.normal(size=grey.shape)
    return grey + 0.3 * c.noise * rng.normal(size=(rows, 1)) + 0.5 * c.noise * smooth(rng, grey.shape, 0.9)


def render(rng: Rng, c: Condition) -> TrueImage:
    """Make an image of a condition."""
    area, aspect, pixel = rng.uniform(*c.area), rng.uniform(1.05, 1.6), 25.4 / c.ppi
    semi = float(np.sqrt(area * aspect / np.pi)), float(np.sqrt(area / aspect / np.pi))
    binning = max(4, int(np.ceil(pixel / _FINEST)))
    step = pixel / binning
    margins = _MARGIN_MM + rng.uniform(0, 1, 2)
    lengths = (semi[0] + margins[0], (2 * semi[1] + semi[0]) / 3 + c.turn * 2 + margins[1])
    down, right = ((np.arange(-n, n) + 0.5) * step for n in (int(h / pixel) * binning for h in lengths))
    x, y = np.meshgrid(right.astype(np.float32), down.astype(np.float32))
    parts = _contact(x, y, semi, c, rng)
    pixels = eight_bit(_picture(_darkness(parts, step, c, rng), step, binning, c, rng), c.jpeg)
    within, touching = parts["inside"] > 0, parts["touching"]
    gross, ridge = (float(part.sum() * step**2) for part in (within, touching))
    moments = cv2.moments(within.astype(np.uint8), binaryImage=True)
    second = [[moments["mu20"], moments["mu11"]], [moments["mu11"], moments["mu02"]]]
    minor, major = 2 * step * np.sqrt(np.linalg.eigvalsh(second) / moments["m00"])
    return TrueImage(pixels, pixel, gross, ridge, (float(major), float(minor)))
