"""Ridged contacts of exactly known outline and area, which share no model with the library.

A contact is a set of smooth functions of position: the level ρ² of the outline, the pressure p, which
vanishes where ρ = 1, a ridge pattern h, and the losses of ridge width to pores, creases, breaks and uneven
ridge tops. They are cubic splines on a fine grid and have no pixels.

- **Gross area**: the area inside the smooth closed curve ρ = 1, the envelope where ridge tops reach zero
  pressure. It is the outermost locus of touching ridges, whichever part of the pattern lies there. The convex
  hull of all points that touch holds 99–100 % of it where ridges keep their width up to the outline, and
  94–99 % where their width fades.
- **Ridge area**: the area of the points inside it that touch, before blur, contrast and noise.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import fft, interpolate, ndimage, sparse

from benchmarks.arrays import Array, Pair, Rng

GRID_STEP = 0.05
AREA_STEP = 0.008
MARGIN = 1.2


@dataclass(frozen=True)
class Outline:
    """Closed curve about the origin: an ellipse whose polar radius is multiplied by a Fourier series.

    With X and Y the coordinates along and across the axis, in mm, (X, Y) = s(t) (a cos t, b sin t) on the
    curve, s(t) = 1 + Σ cₖ cos(k t − φₖ), k = 2, 3, …; without terms it is exactly an ellipse.
    """

    a: float
    b: float
    axis: float  # angle of the axis of a from straight up in the image, counter-clockwise as seen, radians
    terms: tuple[tuple[float, float], ...] = ()  # amplitudes cₖ and phases φₖ

    def radius(self, t: Array) -> Array:
        """Return s(t)."""
        terms = (c * np.cos(k * t - phase) for k, (c, phase) in enumerate(self.terms, 2))
        return 1 + sum(terms, np.zeros_like(t))

    def along_across(self, x: Array, y: Array) -> tuple[Array, Array]:
        """Return the coordinates along (distal) and across (to the right of it) for x right and y down."""
        sin, cos = np.sin(self.axis), np.cos(self.axis)
        return -sin * x - cos * y, cos * x - sin * y

    def level(self, x: Array, y: Array) -> Array:
        """Return ρ², which is 1 on the outline and proportional to the squared distance along each ray."""
        along, across = self.along_across(x, y)
        s = self.radius(np.arctan2(across / self.b, along / self.a))
        return ((along / self.a) ** 2 + (across / self.b) ** 2) / s**2

    def pressure_at(self, distance: float) -> float:
        """Return √(1 − ρ²) at a distance in mm inside a circle of radius √(a b), and at least 10⁻⁶."""
        inside = min(distance / np.sqrt(self.a * self.b), 1)
        return max(float(np.sqrt(1 - (1 - inside) ** 2)), 1e-6)

    def points(self, count: int = 2000) -> Array:
        """Return points (count, 2) of the curve, x right and y down."""
        t = 2 * np.pi * np.arange(count) / count
        along, across = self.a * self.radius(t) * np.cos(t), self.b * self.radius(t) * np.sin(t)
        sin, cos = np.sin(self.axis), np.cos(self.axis)
        return np.stack([-sin * along + cos * across, -cos * along - sin * across], axis=-1)

    def moments(self) -> tuple[float, Array, float, float]:
        """Return area, centroid (x, y) and semi-axes of the ellipse of equal second moments.

        The integrals over the interior reduce to ∫s² dt, ∫s³ dt and ∫s⁴ dt, which the trapezoidal rule on a
        period gives to rounding. The semi-axes are twice the roots of the central second moments per area:
        they are those of the outline if it is an ellipse.
        """
        t = 2 * np.pi * np.arange(512) / 512
        s, (unit_x, unit_y) = self.radius(t), Outline(self.a, self.b, self.axis).points(512).T
        area = np.pi * self.a * self.b * np.mean(s**2)
        weight = np.pi * self.a * self.b / area
        centre = weight * 2 / 3 * np.array([np.mean(s**3 * unit_x), np.mean(s**3 * unit_y)])
        directions = np.stack([unit_x, unit_y])
        second = weight / 2 * (s**4 * directions) @ directions.T / s.size - np.outer(centre, centre)
        values, _ = np.linalg.eigh(second)
        return float(area), centre, 2 * float(np.sqrt(values[1])), 2 * float(np.sqrt(values[0]))


@dataclass(frozen=True, eq=False)
class RidgedContact:
    """Contact of ridges with a plane: cubic splines through values on a grid about the origin.

    A point touches where ρ < 1 and the ridge pattern h exceeds the level that leaves the fraction
    w [g (1 − loss) − dip (1 − g)] of the interior above it, where g = min(1, p/p₀) and p is the pressure.
    Pressures are relative to the centre.
    """

    outline: Outline  # envelope of the touching ridges
    ridges: Array  # h
    loss: Array  # fraction of the width lost
    dip: Array  # what the depth of tops below their envelope takes of the width at low pressure
    pressure_squared: Array  # p², negative outside
    width_fraction: float  # width of a ridge over the period under full pressure, w
    full_width_pressure: float  # p₀, above which ridges have their full width

    @cached_property
    def coefficients(self) -> tuple[Array, ...]:
        """Coefficients of the splines of ridges, loss, dip and squared pressure."""
        fields, known = (self.ridges, self.loss, self.dip, self.pressure_squared), {"mode": "mirror"}
        return tuple(ndimage.spline_filter(field, order=3, output=np.float32, **known) for field in fields)

    @cached_property
    def levels(self) -> Array:
        """Level of h above which the fraction i/256 of the gross area lies, i = 0 … 256."""
        inside = self.ridges[self.pressure_squared > 0]
        return np.asarray(np.quantile(inside, np.linspace(1, 0, 257)), dtype=np.float32)

    def touching(self, x: Array, y: Array) -> tuple[Array, Array]:
        """Return where the ridges touch and the pressure, on a grid within MARGIN of the outline."""
        rows, columns = map(_spline_weights, (y, x), self.ridges.shape)
        ridges, loss, dip, squared = ((columns @ (rows @ c).T).T for c in self.coefficients)
        pressure = np.sqrt(np.maximum(squared, 0))
        grown = np.minimum(pressure / np.float32(self.full_width_pressure), 1)
        fraction = np.float32(self.width_fraction) * (grown * (1 - loss) - dip * (1 - grown))
        at = 256 * np.clip(fraction, 0, 1)
        low = np.minimum(at.astype(np.int32), 255)
        level = self.levels[low] + (at - low) * (self.levels[low + 1] - self.levels[low])
        return (ridges > level) & (fraction > 0) & (squared > 0), pressure

    def ridge_area(self, step: float = AREA_STEP, offset: tuple[float, float] = (0.37, 0.61)) -> float:
        """Return the area where the ridges touch, in mm², by samples a step in mm apart, offset in steps."""
        reach = np.abs(self.outline.points()).max(axis=0)
        x, y = (
            (np.arange(-np.ceil(r / step) - 1, np.ceil(r / step) + 1) + o) * step
            for r, o in zip(reach, offset, strict=True)
        )
        count = sum(np.count_nonzero(self.touching(x, part)[0]) for part in np.array_split(y, 20))
        return float(count * step**2)


def grid_for(outline: Outline, step: float = GRID_STEP) -> tuple[Array, Array]:
    """Return x (1, n) and y (m, 1) of a grid about the origin that holds the outline and MARGIN around it."""
    half = np.ceil((np.abs(outline.points()).max(axis=0) + MARGIN) / step).astype(int)
    x, y = (step * np.arange(-n, n + 1) for n in half)
    return x[None, :], y[:, None]


def _spline_weights(at: Array, size: int) -> sparse.csr_array:
    """Return the matrix (at.size, size) that evaluates a cubic B-spline of a grid about the origin."""
    index, knots = at / GRID_STEP + size // 2, np.arange(-2.0, size + 2)
    return interpolate.BSpline.design_matrix(index, knots, 3).astype(np.float32)


def smooth_noise(rng: Rng, shape: tuple[int, ...], sigma: float) -> Array:
    """Return Gaussian noise of zero mean and unit variance, smoothed over sigma samples."""
    noise = ndimage.gaussian_filter(rng.standard_normal(shape), sigma, mode="wrap")
    return noise / noise.std()


def grow_gabor(rng: Rng, outline: Outline, kind: str, period: float) -> Array:
    """Return a ridge pattern grown from noise by iterated oriented filters along an orientation field.

    The kind is loop, whorl or arch, the period in mm; the outline's axis is the finger's. The pattern, on the
    grid of step GRID_STEP, is positive on ridges.
    """
    step, bands = 2 * GRID_STEP, 16
    x, y = grid_for(outline, step)
    normal = _ridge_direction(rng, outline, kind, x, y) + np.pi / 2
    kx, ky = fft.rfftfreq(x.size, step)[None, :], fft.fftfreq(y.size, step)[:, None]
    size, angle = np.hypot(kx, ky), np.arctan2(ky, kx)
    ring = np.exp(-0.5 * ((size - 1 / period) * period / 0.22) ** 2)
    centres = np.pi * np.arange(bands) / bands
    filters = [(ring * np.exp(-0.5 * (np.sin(angle - c) / 0.22) ** 2)).astype(np.float32) for c in centres]
    apart = [np.abs((normal - c + np.pi / 2) % np.pi - np.pi / 2) * bands / np.pi for c in centres]
    shares = [np.maximum(1 - far, 0).astype(np.float32) for far in apart]
    pattern = rng.standard_normal(normal.shape).astype(np.float32)
    for _ in range(9):
        spectrum = fft.rfft2(pattern)
        pattern = sum(
            s * fft.irfft2(f * spectrum, s=pattern.shape) for s, f in zip(shares, filters, strict=True)
        )
        pattern = np.tanh(1.5 * pattern / pattern.std())
    return _refined(pattern, outline)


def grow_swift_hohenberg(rng: Rng, outline: Outline, kind: str, period: float) -> Array:
    """Return a ridge pattern grown by the Swift–Hohenberg equation u̇ = εu − (1 + ∇²/k²)²u − u³.

    Fronts that start from the core and from the crease, as in embryonic skin, are the initial state; where
    they meet a triradius forms, and noise gives minutiae. Linear terms are integrated implicitly in Fourier
    space. Parameters and the result are those of `grow_gabor`.
    """
    step, step_time = 2 * GRID_STEP, 0.5
    x, y = grid_for(outline, step)
    along, across = outline.along_across(x, y)
    core = rng.normal([0.05 * outline.a, 0], 0.08 * outline.b)
    p, q = along - core[0], across - core[1]
    lean = rng.choice([-1, 1]) * rng.uniform(0.2, 0.7)
    down = np.maximum(-p * np.cos(lean) + q * np.sin(lean), 0)
    if kind == "whorl":
        front = np.hypot(p * rng.uniform(0.88, 1), q)
    elif kind == "loop":
        front = np.hypot(p + down * np.cos(lean), q - down * np.sin(lean))
    else:
        front = np.hypot(along + 1.5 * outline.a, across)
    bend = smooth_noise(rng, p.shape, 2.5 / step)
    crease = along + 0.06 * across**2 + 0.3 * bend
    low = -0.55 * outline.a + 0.6 * bend + 0.03 * across**2 * np.sign(lean)
    phase = np.where(along < low, crease, front + 0.15 * bend)
    u = 0.4 * np.cos(2 * np.pi * phase / period) + ndimage.gaussian_filter(rng.normal(0, 1.3, p.shape), 1)
    squared = (fft.rfftfreq(x.size, step)[None, :] ** 2 + fft.fftfreq(y.size, step)[:, None] ** 2) * period**2
    implicit = (1 / (1 - step_time * (0.35 - (1 - squared) ** 2))).astype(np.float32)
    u = np.clip(u, -1, 1).astype(np.float32)
    for _ in range(60):
        u = fft.irfft2(implicit * fft.rfft2(u - np.float32(step_time) * u**3), s=u.shape)
    return _refined(u, outline)


def _refined(pattern: Array, outline: Outline) -> Array:
    """Return the pattern over its local amplitude, on the grid of half the step."""
    amplitude = np.sqrt(2 * ndimage.gaussian_filter(pattern**2, 4))
    x, y = grid_for(outline)
    scaled = pattern / (amplitude + 0.1 * amplitude.mean())
    places = (
        one.ravel() / (2 * GRID_STEP) + size // 2 for one, size in zip((y, x), pattern.shape, strict=True)
    )
    at = np.meshgrid(*places, indexing="ij")
    return np.asarray(ndimage.map_coordinates(scaled, at, order=3, mode="mirror"), dtype=np.float32)


def _ridge_direction(rng: Rng, outline: Outline, kind: str, x: Array, y: Array) -> Array:
    """Return the angle of the ridges from x towards y: cores, deltas and an arch towards the sides."""
    along, across = outline.along_across(x, y)
    z = across + 1j * along
    a, b = outline.a, outline.b
    at = rng.normal([0.1 * a, 0], [0.08 * a, 0.06 * b])
    core = at[1] + 1j * at[0]
    side = rng.choice([-1, 1])
    cores: list[complex] = []
    deltas: list[complex] = []
    arch = 1.1
    if kind == "whorl":
        cores = [core + 0.5j, core - rng.uniform(0.5, 2.5) * 1j + rng.normal(0, 0.3)]
        deltas = [-0.75 * b - 0.75j * a, 0.75 * b - 0.75j * a + rng.normal(0, 0.5)]
        arch = 0.1
    elif kind == "loop":
        cores, deltas = [core], [side * 0.7 * b - 0.65j * a + rng.normal(0, 0.4)]
        arch = 0.6
    angle = sum((np.angle((z - c) * 1j) for c in cores), np.zeros(z.shape))
    angle = 0.5 * (angle - sum((np.angle((z - d) * 1j) for d in deltas), np.zeros(z.shape)))
    angle += np.pi / 4 * (len(deltas) - len(cores))
    angle -= arch * np.tanh(across / (0.6 * b)) / (1 + np.exp(-(along + 0.45 * a) / (0.12 * a)))
    angle += 0.08 * smooth_noise(rng, z.shape, 2 / (2 * GRID_STEP))
    return -(angle + outline.axis)


def draw_contact(
    rng: Rng, *, growth: str, width_fade: float, shape: float, features: float, uneven: float
) -> RidgedContact:
    """Return a contact of 60–300 mm², ratio of axes 1–1.6, ridge period 0.4–0.6 mm and width 0.4–0.75 of it.

    The parameters are those of a condition in `benchmarks.truth.independent_images`.
    """
    outline = _draw_outline(rng, shape)
    period, width = rng.uniform(0.4, 0.6), rng.uniform(0.4, 0.75)
    kind = str(rng.choice(["loop", "whorl", "arch"], p=[0.6, 0.3, 0.1]))
    grow = grow_gabor if growth == "gabor" else grow_swift_hohenberg
    ridges = grow(rng, outline, kind, period)
    x, y = grid_for(outline)
    lean, direction = 0.4 * uneven * rng.uniform(), rng.uniform(0, 2 * np.pi)
    leaning = 1 + lean * (np.cos(direction) * x + np.sin(direction) * y) / outline.a
    return RidgedContact(
        outline=outline,
        ridges=ridges,
        loss=_lost_width(rng, ridges, outline, features, width),
        dip=0.6 * uneven * np.maximum(smooth_noise(rng, ridges.shape, 4), 0),
        pressure_squared=(1 - outline.level(x, y)) * np.maximum(leaning, 0.2),
        width_fraction=width,
        full_width_pressure=outline.pressure_at(width_fade),
    )


def _draw_outline(rng: Rng, shape: float) -> Outline:
    area, ratio, axis = rng.uniform(60, 300), rng.uniform(1, 1.6), rng.uniform(-np.pi / 2, np.pi / 2)
    amplitudes = shape * rng.uniform(0.5, 1, 4) * rng.choice([-1, 1], 4) / np.array([2, 1, 2, 4])
    phases = rng.normal(0, 0.4, 4)
    terms = tuple(zip(amplitudes.tolist(), phases.tolist(), strict=True)) if shape else ()
    b = np.sqrt(area / Outline(ratio, 1, axis, terms).moments()[0])
    return Outline(float(ratio * b), float(b), float(axis), terms)


def _lost_width(rng: Rng, ridges: Array, outline: Outline, density: float, width: float) -> Array:
    """Return the fraction of the ridge width that uneven edges, pores, broken ridges and creases take."""
    x, y = grid_for(outline)
    lost = 0.15 * min(density, 1) * smooth_noise(rng, ridges.shape, 2)
    extent = ridges.size * GRID_STEP**2
    tops = np.argwhere(ridges > np.quantile(ridges, 1 - 0.3 * width))
    for mean, spread, deep in ((0.6, (0.04, 0.07), 1.3), (0.3, (0.06, 0.13), 1.5)):
        for row, column in rng.choice(tops, rng.poisson(mean * density * extent)):
            size, height = rng.uniform(*spread), deep * rng.uniform(0.6, 1.2)
            stamp(lost, (row, column), (size, size), angle=0, height=height, step=GRID_STEP)
    for _ in range(rng.poisson(1.5 * density)):
        angle, bend = rng.uniform(0, np.pi), rng.normal(0, 0.02)
        from_row, from_column = rng.choice(y.ravel()[20:-20]), rng.choice(x.ravel()[20:-20])
        p = np.cos(angle) * (x - from_column) + np.sin(angle) * (y - from_row)
        q = np.cos(angle) * (y - from_row) - np.sin(angle) * (x - from_column) + bend * p**2
        lost += 1.5 * np.exp(-0.5 * (q / rng.uniform(0.05, 0.13)) ** 2 - 0.5 * (p / rng.uniform(1, 3)) ** 4)
    return lost


def stamp(image: Array, centre: Pair, sizes: Pair, *, angle: float, height: float, step: float) -> None:
    """Add a Gaussian spot of the given standard deviations, in mm, at a place in pixels."""
    reach = int(np.ceil(3.5 * max(sizes) / step)) + 1
    top, left = (max(round(c) - reach, 0) for c in centre)
    part = image[top : max(round(centre[0]) + reach + 1, 0), left : max(round(centre[1]) + reach + 1, 0)]
    v = step * (np.arange(part.shape[0])[:, None] + top - centre[0])
    u = step * (np.arange(part.shape[1])[None, :] + left - centre[1])
    p, q = np.cos(angle) * u + np.sin(angle) * v, np.cos(angle) * v - np.sin(angle) * u
    part += height * np.exp(-0.5 * ((p / sizes[0]) ** 2 + (q / sizes[1]) ** 2))
