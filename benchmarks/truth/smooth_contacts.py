"""Pictures of contacts without ridges, from the gap between an elastic body and the glass, and from optics.

The contact is an ellipse (semi-axes a ≥ b) where the gap is exactly zero. Outside it is the gap of Hertz,

    h = C ∫₀^λ (x²/(a²+s) + y²/(b²+s) − 1) ds / √(s(a²+s)(b²+s)),

with the ellipsoidal coordinate λ of the point, and with adhesion that of a flat punch,
D ∫₀^λ ds/√(s(a²+s)(b²+s)) over the same up to infinity. Grey levels near the edge are means over 6 × 6
points of a pixel; then come lens blur, light, dirt, reflections, noise, 8 bits, and for some JPEG.

What is drawn, and in which order, decides over the pictures of a seed: tests and tables depend on it.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import cv2
import numpy as np
from scipy.special import elliprd, elliprf

from benchmarks.arrays import Array, Pixels, Rng
from benchmarks.truth.true_image import jpeg

Shape: TypeAlias = tuple[int, int]

KINDS = {
    "ftir": "frustrated reflection, bright contact",
    "ftir_dark": "the same in a prism, dark contact",
    "gelsight": "gel with three coloured lamps",
    "wet": "wet, with a meniscus",
    "newton": "Newton's rings",
    "none": "no contact",
    "cut": "contact that the frame cuts",
}
DEVICES = [*KINDS][:5]
_SUB, _NEAR_PX = 6, 3.0  # points along a pixel's side, where the edge is within so many pixels
_TINTS = (1, 0.98, 0.94), (0.12, 1, 0.3), (0.12, 0.4, 1), (1, 0.22, 0.15), (1, 0.85, 0.6)


@dataclass(frozen=True)
class Picture:
    """A picture with that of the empty view, and the truth."""

    image: Pixels
    background: Pixels
    mm_per_px: float
    area: float  # mm²; 0 where nothing touches
    whole: bool  # whether the whole contact is seen


class Gap:
    """Gap, mm, around an elliptical contact with semi-axes a, b, and radius R along the major one, mm.

    The integrals are Carlson's R_F and R_D.
    """

    def __init__(self, a: float, b: float, radius: float, stretch: float) -> None:
        self.a, self.b = a, b
        # C from the curvature 1/(2R) along the major axis
        self.hertz = 0.75 / (radius * float(elliprd(0, b * b, a * a)))
        self.flat = 2 * float(elliprf(0, a * a, b * b))
        self.adhesive = stretch / self.flat

    def coordinate(self, x: Array, y: Array) -> Array:
        """Return λ, zero inside the contact."""
        a2, b2 = self.a**2, self.b**2
        total = a2 + b2 - x * x - y * y
        product = a2 * b2 - x * x * b2 - y * y * a2
        root = np.sqrt(np.maximum(total * total - 4 * product, 0))
        with np.errstate(divide="ignore", invalid="ignore"):
            found = np.where(total > 0, -2 * product / (total + root), 0.5 * (root - total))
        return np.maximum(np.nan_to_num(found), 0.0)

    def _beyond(self, x: Array, y: Array, start: Array) -> tuple[Array, Array]:
        """Return −∫ from a coordinate to infinity of Hertz, and that of a flat punch."""
        a2, b2 = self.a**2 + start, self.b**2 + start
        of_punch = 2 * elliprf(start, a2, b2)
        return of_punch - 2 / 3 * (x * x * elliprd(start, b2, a2) + y * y * elliprd(start, a2, b2)), of_punch

    def __call__(self, x: Array, y: Array) -> Array:
        """Return the gap at points in the ellipse's frame, x along its major axis."""
        (inner, _), (outer, punch) = (self._beyond(x, y, s) for s in (np.zeros(()), self.coordinate(x, y)))
        return np.maximum(self.hertz * (outer - inner) + self.adhesive * (self.flat - punch), 0.0)

    def surface(self, x: Array, y: Array) -> Array:
        """Return the depth of a surface that the body indents."""
        return self.hertz * self._beyond(x, y, self.coordinate(x, y))[0]

    def punch(self, x: Array, y: Array) -> Array:
        """Return the depth of a surface around a flat elliptical punch of unit depth."""
        return self._beyond(x, y, self.coordinate(x, y))[1] / self.flat


def _smooth_noise(rng: Rng, shape: Shape, size: float, octaves: int = 1) -> Array:
    out = np.zeros(shape, np.float32)
    for octave in range(octaves):
        s = max(round(size / 2**octave), 1)
        knots = rng.normal(0, 1, (int(shape[0] / s) + 3, int(shape[1] / s) + 3)).astype(np.float32)
        field = cv2.resize(knots, None, fx=s, fy=s, interpolation=cv2.INTER_LINEAR)[: shape[0], : shape[1]]
        out += cv2.GaussianBlur(field, (0, 0), max(0.45 * s, 0.4)) / 2**octave
    return out / max(out.std(), 1e-9)


def _grid(shape: Shape, low: float = -1) -> Array:
    return np.mgrid[low : 1 : shape[0] * 1j, low : 1 : shape[1] * 1j]


def _light(rng: Rng, shape: Shape, strength: float = 0.5) -> Array:
    """Return light of mean one: gradient, hot spot, vignetting."""
    r, c = _grid(shape)
    turn = rng.uniform(0, 2 * np.pi)
    light = 1 + strength * rng.uniform(0.3, 1) * (np.cos(turn) * c + np.sin(turn) * r) / 1.4
    height, far = rng.uniform(-0.2, 0.8), (r - rng.uniform(-1, 1)) ** 2 + (c - rng.uniform(-1, 1)) ** 2
    light *= 1 + strength * height * np.exp(-far / rng.uniform(0.4, 2))
    aspect = shape[0] / shape[1]
    light *= (1 + rng.uniform(0.05, 0.45) * strength * (c * c + (r * aspect) ** 2)) ** -2
    return np.maximum(light / light.mean(), 0.08)


def _guide(rng: Rng, shape: Shape) -> Array:
    """Return the light of a guide: it decays from lit sides, scalloped by single LEDs."""
    r, c = _grid(shape, 0)
    out = np.zeros(shape)
    for side in rng.permutation(4)[: rng.integers(1, 5)]:
        far, along = ((r, c), (1 - r, c), (c, r), (1 - c, r))[side]
        length = rng.uniform(0.4, 1.6)
        scallop = rng.uniform(0, 0.3) * np.exp(-far / 0.12)
        led = 1 + scallop * np.cos(2 * np.pi * rng.integers(4, 9) * along + rng.uniform(0, 6))
        out += rng.uniform(0.6, 1) * np.exp(-far / length) * led
    return out / out.mean()


def _line(shape: Shape, points: Array) -> Array:
    drawn = np.zeros(shape, np.float32)
    cv2.polylines(drawn, [points.astype(np.int32)], False, 1.0, 1, cv2.LINE_AA, 4)
    return drawn


def _specks(rng: Rng, shape: Shape, count: int, largest: float) -> Array:
    """Return how much dust and lint covers, in focus or not."""
    out = np.zeros(shape, np.float32)
    for _ in range(count):
        place = (int(rng.integers(0, shape[1]) * 16), int(rng.integers(0, shape[0]) * 16))
        if rng.random() < 0.8:
            radius = largest * rng.uniform(0.15, 1) ** 2
            axes = (max(int(16 * radius), 6), max(int(16 * radius * rng.uniform(0.4, 1)), 5))
            ellipse = np.array(cv2.ellipse2Poly((0, 0), axes, int(rng.integers(0, 180)), 0, 360, 20))
            points = ellipse * rng.uniform(0.75, 1.2, (len(ellipse), 1)) + place
            speck = np.zeros(shape, np.float32)
            cv2.fillPoly(speck, [points.astype(np.int32)], 1.0, cv2.LINE_AA, 4)
        else:  # lint
            turn = np.cumsum(np.cumsum(rng.normal(0, 0.25, 24)))
            step = largest * rng.uniform(0.3, 1.1)
            path = np.cumsum(np.c_[np.cos(0.3 * turn), np.sin(0.3 * turn)], 0)
            speck = _line(shape, path * step * 16 + place)
        out = np.maximum(out, speck * rng.uniform(0.3, 1))
    return cv2.GaussianBlur(out, (0, 0), rng.uniform(0.5, 1.3))


def _scratches(rng: Rng, shape: Shape, count: int) -> Array:
    out = np.zeros(shape, np.float32)
    for _ in range(count):
        middle = rng.uniform(0, 1, 2) * shape[::-1]
        turn, length = rng.uniform(0, np.pi), rng.uniform(0.05, 0.5) * max(shape)
        t = np.linspace(-1, 1, 20)[:, None]
        points = middle + t * length / 2 * [np.cos(turn), np.sin(turn)] + t**2 * rng.normal(0, 4, 2)
        out = np.maximum(out, _line(shape, points * 16) * rng.uniform(0.15, 0.8))
    return cv2.GaussianBlur(out, (0, 0), 0.7)


def _reflection(rng: Rng, shape: Shape, near: Array | None = None, kind: str | None = None) -> Array:
    """Return the soft image, 0 to 1, of a lamp, a streak or a window."""
    r, c = np.mgrid[0 : shape[0], 0 : shape[1]].astype(float)
    if near is None:
        near = rng.uniform(0.1, 0.9, 2) * shape
    kind = kind or str(rng.choice(["spot", "streak", "window"]))
    turn = rng.uniform(0, np.pi)
    x = (c - near[1]) * np.cos(turn) + (r - near[0]) * np.sin(turn)
    y = -(c - near[1]) * np.sin(turn) + (r - near[0]) * np.cos(turn)
    side = min(shape)
    if kind == "spot":
        size = side * rng.uniform(0.015, 0.05)
        far = np.sqrt((x / size) ** 2 + (y / size / rng.uniform(0.6, 1)) ** 2)
        glow = 0.18 * np.exp(-far / 2.5)
        return 1 / (1 + np.exp(np.minimum((far - 1) * rng.uniform(4, 12), 60))) + glow
    if kind == "streak":
        size, length = side * rng.uniform(0.008, 0.03), side * rng.uniform(0.15, 0.6)
        y = y + rng.normal(0, 0.15) * x**2 / length
        return np.exp(-(np.abs(y / size) ** 2)) * np.exp(-(np.abs(x / length) ** 4))
    size = side * rng.uniform(0.04, 0.1)
    far = np.maximum(np.abs(x + 0.2 * y) / size, np.abs(y) / size / rng.uniform(0.5, 1.2))
    window = 1 / (1 + np.exp(np.minimum((far - 1) * 14, 60)))
    return window * (1 - 0.6 * np.exp(-((x / size / 0.07) ** 2)))


class Camera:
    """A set-up's camera, which makes 8-bit pictures."""

    def __init__(self, rng: Rng) -> None:
        self.blur = rng.uniform(0.6, 1.6)
        self.full = np.exp(rng.uniform(np.log(1500), np.log(20000)))  # electrons at 255
        self.read = rng.uniform(0.3, 2.0)
        self.gamma = float(rng.choice([1.0, 1.0, 0.8, 0.6]))
        self.jpeg = int(rng.integers(65, 96)) if rng.random() < 0.35 else 0

    def expose(self, light: Array, rng: Rng) -> Pixels:
        """Take a picture of linear light, 0 to 1, grey or RGB, with noise of its own."""
        seen = cv2.GaussianBlur(light.astype(np.float32), (0, 0), self.blur)
        seen = np.clip(seen, 0, None) * 255
        seen = seen + rng.normal(0, 1, seen.shape) * np.sqrt(seen * 255 / self.full + self.read**2)
        seen = 255 * (np.clip(seen, 0, 255) / 255) ** self.gamma
        pixels = np.asarray(np.clip(np.round(seen), 0, 255), np.uint8)
        if not self.jpeg:
            return pixels
        if pixels.ndim == 2:
            return jpeg(pixels, self.jpeg)
        return np.ascontiguousarray(jpeg(np.ascontiguousarray(pixels[..., ::-1]), self.jpeg)[..., ::-1])


class _Scene:
    """One view of a device: contact, light, dirt and reflections.

    A view may be "cut" by the frame, or have no contact: of "none", or of a finger that "hovers". `grown` is
    the contact's size over that drawn.
    """

    def __init__(self, rng: Rng, kind: str, view: str = "", grown: float = 1.0) -> None:
        self.rng, self.cut, self.touches = rng, view == "cut", view not in {"none", "hovers"}
        height = int(rng.integers(700, 1201) if rng.random() < 0.35 else rng.integers(300, 700))
        width = int(np.clip(height * rng.choice([1, 1, 4 / 3, 4 / 3, 16 / 9]), 300, 1600))
        self.shape = (height, width)
        low, high = (0.01, 0.03) if kind == "newton" else (0.01, 0.08)
        mm = float(np.exp(rng.uniform(np.log(low), np.log(high))))
        self.a_px = rng.uniform(max(45, 0.12 * height), 0.38 * height)
        self.mm = mm = 12 / self.a_px if self.a_px * mm > 12 else mm
        ratio = float(rng.choice([1.0, rng.uniform(0.6, 1), rng.uniform(0.8, 1)]))
        self.a = a = self.a_px * mm
        b = a * ratio
        turn = np.deg2rad(float(rng.uniform(-90, 90)) if ratio < 1 else 0.0)
        self.turned = np.cos(turn), np.sin(turn)
        if self.cut:
            side = rng.integers(0, 4)
            off = self.a_px * rng.uniform(-0.4, 0.75)
            self.centre = [rng.uniform(0.3, 0.7) * height, rng.uniform(0.3, 0.7) * width]
            axis = side // 2
            self.centre[axis] = off if side % 2 == 0 else self.shape[axis] - off
        else:
            margin = self.a_px * 1.06 + 4
            self.centre = [rng.uniform(margin, height - margin), rng.uniform(margin, width - margin)]
        radius = a * rng.uniform(2.8, 8)
        if kind == "newton":  # a weak lens, whose first dark ring is 3 to 25 px beyond the edge
            radius = a * a * 1.2 * (np.exp(rng.uniform(np.log(3), np.log(25))) * mm / a) ** 1.5 / 0.27e-3
        stretch = 0.0
        if rng.random() < 0.5 and kind != "newton":  # as of JKR, √(2π a w/E*)
            stretch = np.sqrt(2 * np.pi * np.sqrt(a * b) * np.exp(rng.uniform(np.log(1e-5), np.log(4e-4))))
            stretch = min(stretch, 0.15 * a * a / radius)
        # The radius of curvature stays while the contact grows; the stretch goes with the root of its size.
        stretch = min(stretch * grown**0.5, 0.15 * (a * grown) ** 2 / radius)
        self.gap = Gap(a * grown, b * grown, radius, stretch)
        self.camera = Camera(rng)
        self.light = _light(rng, self.shape, rng.uniform(0.15, 1))
        self.dust = self.specks(rng.integers(0, 26), rng.uniform(1.5, 5))
        self.scratches = _scratches(rng, self.shape, int(rng.choice([0, 0, 2, 6])))
        self.on_glass = np.zeros(self.shape)
        for _ in range(int(rng.choice([0, 0, 1, 2]))):
            near = self._edge_point(a, b) if rng.random() < 0.6 else None
            self.on_glass += rng.uniform(0.15, 0.9) * _reflection(rng, self.shape, near)
        self.on_body = np.zeros(self.shape)  # reflections on the finger, which the empty view has not
        if rng.random() < 0.3 and kind not in {"gelsight", "newton"}:
            place = self._edge_point(a * rng.uniform(1.05, 1.35), b * rng.uniform(1.05, 1.35))
            self.on_body = rng.uniform(0.1, 0.4) * _reflection(rng, self.shape, place, "spot")
        self.drift = rng.uniform(0.97, 1.03)
        self.tint = None if rng.random() < 0.5 else _TINTS[rng.choice(len(_TINTS))]
        self.x, self.y = self._in_frame(*np.mgrid[0:height, 0:width].astype(np.float64))
        # The pad behind the glass is seen by the light of the room where the gap is small.
        self.depth = a * a / radius
        lift = self.depth * rng.uniform(0.1, 0.7) if not self.touches else 0.0
        beyond = np.maximum((self.x / self.gap.a) ** 2 + (self.y / self.gap.b) ** 2 - 1, 0)
        self.far = beyond * self.gap.a**2 / (2 * radius) + lift
        self.is_near = view != "none"

    def specks(self, count: Any, largest: float) -> Array:
        """Return so many specks; their size in pixels of a picture of 500 rows."""
        return _specks(self.rng, self.shape, int(count), largest * self.shape[0] / 500)

    def _edge_point(self, a: float, b: float) -> Array:
        t = self.rng.uniform(0, 2 * np.pi)
        x, y, (c, s) = a * np.cos(t) / self.mm, b * np.sin(t) / self.mm, self.turned
        return np.array([self.centre[0] + s * x + c * y, self.centre[1] + c * x - s * y])

    def _in_frame(self, rows: Array, columns: Array) -> tuple[Array, Array]:
        """Return places in the ellipse's frame, whose major axis is turned towards the rows."""
        y, x, (c, s) = (rows - self.centre[0]) * self.mm, (columns - self.centre[1]) * self.mm, self.turned
        return c * x + s * y, -s * x + c * y

    def seen(self, signal: Callable[[Array], Array]) -> tuple[Array, Array]:
        """Return what a gap shows, as means over pixels near the edge, and the gap."""
        if not self.touches:
            far = np.full(self.shape, 50.0)
            return signal(far), far
        gap = self.gap(self.x, self.y)
        out = signal(gap)
        rho = np.sqrt((self.x / self.gap.a) ** 2 + (self.y / self.gap.b) ** 2)
        r, c = np.nonzero(np.abs(rho - 1) * self.gap.b < _NEAR_PX * self.mm)
        total = np.zeros(len(r))
        for i in range(_SUB):
            for j in range(_SUB):
                at = r + (i + 0.5) / _SUB - 0.5, c + (j + 0.5) / _SUB - 0.5
                total += signal(self.gap(*self._in_frame(*at)))
        out[r, c] = total / _SUB**2
        return out, gap

    def haze(self, least: float, most: float, reach: float, blur: float) -> Array | float:
        """Return a share of light that a finger throws back before it touches; it falls over its depth."""
        near = np.exp(-self.far / (self.depth * reach)).astype(np.float32)
        blurred = cv2.GaussianBlur(near, (0, 0), self.shape[0] * blur)
        return np.asarray(self.rng.uniform(least, most) * blurred) if self.is_near else 0.0

    def in_colour(self, *pictures: Array) -> tuple[Array, ...]:
        """Return pictures under light of the set-up's colour."""
        return tuple(one if self.tint is None else one[..., None] * np.asarray(self.tint) for one in pictures)


def _frustrated(scene: _Scene, *, dark: bool) -> tuple[Array, ...]:
    """Return light of a prism or a light guide that the contact frustrates, and of the empty view."""
    rng, shape = scene.rng, scene.shape
    wavelength, turn = 1e-6 * rng.uniform(480, 850), np.deg2rad(rng.uniform(46, 75))
    depth = wavelength / (4 * np.pi * np.sqrt((1.5 * np.sin(turn)) ** 2 - 1))  # mm, to 1/e
    contact, _ = scene.seen(lambda gap: np.exp(-gap / depth))
    mottle = 1 + rng.uniform(0.0, 0.07) * _smooth_noise(rng, shape, rng.uniform(4, 30), 3)
    # A few spots where dust on the finger keeps the surfaces apart
    hole = scene.specks(rng.integers(0, 7), rng.uniform(2, 6)) if scene.touches else 0
    contact = contact * (1 - 0.9 * hole) * np.clip(mottle, 0.3, 1.5)
    haze = scene.haze(0.01, 0.14, rng.uniform(0.2, 0.8), 0.006)
    if dark:
        level, contrast = rng.uniform(0.4, 0.8), rng.uniform(0.25, 0.9)
        empty = level * scene.light * (1 - 0.6 * scene.dust) * (1 - 0.3 * scene.scratches)
        image = empty * (1 - contrast * np.clip(contact, 0, 1.05)) * (1 - 0.4 * haze)
        image = image + 0.4 * scene.on_glass + 0.5 * scene.on_body
        return scene.in_colour(image, empty + 0.4 * scene.on_glass)
    guide = _guide(rng, shape)
    amplitude, floor = rng.uniform(0.25, 0.8), rng.uniform(0.01, 0.09)
    stray = floor * scene.light * (1 + 0.5 * _light(rng, shape))
    dirt = 0.5 * scene.dust + 0.35 * scene.scratches
    rng.uniform()  # a number that pictures of a seed have always spent
    image = stray + (amplitude * contact + amplitude * haze) * guide + dirt * guide * 0.3
    image = image + 0.6 * scene.on_glass + 0.8 * scene.on_body * guide
    return scene.in_colour(image, stray + dirt * guide * 0.3 + 0.6 * scene.on_glass)


def _painted_gel(scene: _Scene) -> tuple[Array, ...]:
    """Return a painted gel under lamps of three colours: what is seen is its slope."""
    rng, shape, a = scene.rng, scene.shape, scene.a
    flat = bool(rng.random() < 0.35)
    depth: Array = np.zeros(shape)
    if scene.touches:
        x, y = scene.x, scene.y
        depth = -scene.gap.punch(x, y) * a * rng.uniform(0.04, 0.12) if flat else -scene.gap.surface(x, y)
        thickness = a * rng.uniform(1.0, 2.5)
        depth = depth * np.exp(-((np.sqrt(scene.gap.coordinate(x, y)) / thickness) ** 2) / 2)
    paint = rng.uniform(0.008, 0.03) * a / scene.mm  # which bends
    depth = depth + _smooth_noise(rng, shape, 60, 2) * a * 2e-4
    depth = cv2.GaussianBlur(depth, (0, 0), max(paint, 0.7)) / scene.mm
    grain = rng.uniform(0.0, 0.012) * _smooth_noise(rng, shape, 2.5)
    down, right = np.gradient(depth)
    steep = rng.uniform(1.0, 1.8)
    normals = (-steep * down + grain, -steep * right + grain[::-1]), (grain, grain[::-1])
    first = rng.uniform(0, 2 * np.pi)
    rows, columns = _grid(shape)
    order = rng.permutation(3)
    height = np.deg2rad(rng.uniform(18, 40))
    lit: tuple[list[Array], list[Array]] = ([], [])
    for number in range(3):
        turn = first + 2 * np.pi * number / 3
        lamp = np.cos(height) * np.sin(turn), np.cos(height) * np.cos(turn), np.sin(height)
        fall = np.exp(0.45 * rng.uniform(0.4, 1.2) * (np.sin(turn) * rows + np.cos(turn) * columns))
        fall = fall * rng.uniform(0.75, 1.1)
        ambient = rng.uniform(0.05, 0.15)
        for (n_rows, n_columns), channels in zip(normals, lit, strict=True):
            facing = np.maximum(lamp[0] * n_rows + lamp[1] * n_columns + lamp[2] * 1.0, 0)
            channels.append(fall * (ambient + 0.62 * facing / np.sqrt(n_rows**2 + n_columns**2 + 1)))
    image, empty = (np.stack([channels[k] for k in order], -1) for channels in lit)
    crosstalk = rng.uniform(0.0, 0.35)
    image, empty = ((1 - crosstalk) * one + crosstalk * one.mean(-1, keepdims=True) for one in (image, empty))
    level = 0.5 / empty.mean()
    image, empty = image * level, empty * level
    if rng.random() < 0.35:
        moved, marks = _markers(scene)
        image, empty = image * (1 - 0.85 * moved[..., None]), empty * (1 - 0.85 * marks[..., None])
    wear, light = 1 - 0.5 * scene.dust[..., None], _light(rng, shape, 0.35)[..., None]
    return tuple(one * wear * light + 0.35 * scene.on_glass[..., None] for one in (image, empty))


def _markers(scene: _Scene) -> tuple[Array, Array]:
    """Return a grid of dots on the gel, moved by the contact, and where they were."""
    rng, (height, width) = scene.rng, scene.shape
    pitch, radius = height / rng.uniform(9, 14), height / rng.uniform(110, 170)
    moved, still = (np.zeros(scene.shape, np.float32) for _ in range(2))

    def dot(on: Array, row: float, column: float) -> None:
        cv2.circle(on, (int(column * 16), int(row * 16)), int(radius * 16), 1.0, -1, cv2.LINE_AA, 4)

    for row in np.arange(pitch / 2, height, pitch):
        for column in np.arange(pitch / 2, width, pitch):
            down, right = row - scene.centre[0], column - scene.centre[1]
            far = np.hypot(down, right)
            of_size = max(far / scene.a_px, 0.02)
            push = 0.06 * scene.a_px * of_size * np.exp(-of_size * of_size) / max(far, 1e-6)
            push = push if scene.touches else 0
            dot(still, row, column)
            dot(moved, row + down * push, column + right * push)
    return moved, still


def _wet(scene: _Scene) -> tuple[Array, ...]:
    """Return a moist finger or glove on glass before a light field.

    Liquid fills gaps below a height, its rim is a refracting line, and droplets are left.
    """
    rng, shape = scene.rng, scene.shape
    height = scene.depth * np.exp(rng.uniform(np.log(2e-3), np.log(3e-2)))
    wobble = 1 + 0.3 * _smooth_noise(rng, shape, shape[0] / rng.uniform(6, 20), 2)
    meniscus = height * np.clip(wobble, 0.35, 2)
    level, contrast, wetness = rng.uniform(0.4, 0.75), rng.uniform(0.2, 0.6), rng.uniform(0.3, 0.7)
    is_dark = float(rng.choice([1, 1, -1])) > 0
    contact, gap = scene.seen(lambda gap: np.exp(-gap / 2e-4))
    film = rim = bubbles = np.zeros(shape)
    if scene.touches:
        film = 1 / (1 + np.exp(np.clip((gap - meniscus) / (meniscus * 0.12 + 1e-9), -40, 40)))
        rim = np.exp(-(((gap - meniscus) / (meniscus * 0.22)) ** 2))
        bubbles = scene.specks(rng.integers(0, 10), rng.uniform(2, 5))
    drops = scene.specks(rng.integers(5, 50), rng.uniform(1, 4))
    edges = np.clip(drops - cv2.GaussianBlur(drops, (0, 0), 2), 0, 1)
    cover = np.maximum(contact, wetness * film * (1 - 0.8 * bubbles))
    cover *= 1 + 0.06 * _smooth_noise(rng, shape, rng.uniform(5, 40), 3)
    haze = scene.haze(0, 0.25, 0.5, 0.008)
    empty = level * scene.light * (1 - 0.5 * scene.dust) * (1 - 0.3 * scene.scratches)
    if is_dark:
        image = empty * (1 - contrast * cover) * (1 - 0.45 * rim * contrast) * (1 - haze)
        image = image * (1 - 0.3 * drops + 0.7 * edges)
    else:
        empty = empty * 0.45
        image = empty * (1 + 1.6 * contrast * cover + 0.35 * rim + haze) * (1 - 0.2 * drops + 0.8 * edges)
    image = image + 0.4 * scene.on_glass + 0.4 * scene.on_body
    return scene.in_colour(image, empty + 0.4 * scene.on_glass)


def _fringes(scene: _Scene) -> tuple[Array, ...]:
    """Return Newton's rings of a silicone lens on glass, in light of one colour or of three."""
    rng, shape = scene.rng, scene.shape
    one_colour = rng.random() < 0.5
    waves = [rng.uniform(450, 660) * 1e-6] if one_colour else [630e-6, 540e-6, 460e-6]
    bandwidth = rng.uniform(10, 40) * 1e-6 if one_colour else rng.uniform(60, 100) * 1e-6
    of_glass, of_body = 0.04, rng.uniform(0.02, 0.04)
    floor = rng.uniform(0.0005, 0.006)
    visibility = rng.uniform(0.7, 0.95)
    scale = rng.uniform(0.35, 0.6) / (of_glass + of_body)
    channels = []
    for wave in waves:

        def signal(gap: Array, wave: float = wave) -> Array:
            coherent = np.exp(-((np.pi * gap * bandwidth / wave**2 * 1.2) ** 2))
            # At zero gap both reflections cancel to the small one of glass and silicone.
            fringe = 2 * np.sqrt(of_glass * of_body) * visibility * coherent * np.cos(4 * np.pi * gap / wave)
            return of_glass + of_body - fringe + floor

        seen, gap = scene.seen(signal)
        if scene.touches:  # a pixel averages fast fringes out
            slow = np.sinc(2 * np.hypot(*np.gradient(gap)) / wave)
            rho = np.sqrt((scene.x / scene.gap.a) ** 2 + (scene.y / scene.gap.b) ** 2)
            far = (rho - 1) * scene.gap.b > 3 * scene.mm
            mean = of_glass + of_body + floor
            seen = np.where(far, mean + (seen - of_glass - of_body - floor) * slow, seen)
        channels.append(seen)
    colour = np.array([1, 0.98, 0.93])
    image = channels[0] * scale if one_colour else np.stack(channels, -1) * scale * colour
    level = (of_glass + of_body + floor) * scale
    empty = np.full_like(image, 1.0) * (level if one_colour else level * colour)
    texture = 1 + 0.02 * _smooth_noise(rng, shape, rng.uniform(3, 8), 2)
    field = scene.light
    if rng.random() < 0.45:  # a round field stop
        rows, columns = np.mgrid[0 : shape[0], 0 : shape[1]]
        stop = rng.uniform(0.52, 0.62) * np.hypot(*shape)
        beyond = np.hypot(rows - shape[0] / 2, columns - shape[1] / 2) - stop
        field = field * (0.03 + 0.97 / (1 + np.exp(np.clip(beyond / (shape[0] * 0.006), -60, 60))))
    blurred_dust = cv2.GaussianBlur(scene.dust, (0, 0), rng.uniform(0.5, 4))
    lit, ghost = field * (1 - 0.5 * blurred_dust) * (1 - 0.2 * scene.scratches), 0.15 * scene.on_glass
    if not one_colour:
        lit, texture, ghost = lit[..., None], texture[..., None], ghost[..., None]
    return image * (lit * texture) + ghost, empty * lit + ghost


_OPTICS: dict[str, Callable[[_Scene], tuple[Array, ...]]] = {
    "ftir": lambda scene: _frustrated(scene, dark=False),
    "ftir_dark": lambda scene: _frustrated(scene, dark=True),
    "gelsight": _painted_gel,
    "wet": _wet,
    "newton": _fringes,
}


def _picture(kind: str, scene: _Scene, noise: Rng) -> Picture:
    """Return a picture; `noise` is the camera's own."""
    image, empty = _OPTICS[kind](scene)
    pixels, background = (scene.camera.expose(one, noise) for one in (image * scene.drift, empty))
    area = float(np.pi * scene.gap.a * scene.gap.b) if scene.touches else 0.0
    return Picture(pixels, background, scene.mm, area, scene.touches and not scene.cut)


def pictures(seed: int, count: int, kind: str) -> Iterator[Picture]:
    """Yield `count` pictures of a device, of contacts that the frame cuts, or of views without one."""
    for number in range(count):
        rng = np.random.default_rng([seed, number, [*KINDS].index(kind)])
        device = DEVICES[number % 5] if kind in {"none", "cut"} else kind
        view = "hovers" if kind == "none" and rng.random() < 0.4 else kind
        yield _picture(device, _Scene(rng, device, view), rng)


def loading(seed: int, count: int, kind: str) -> Iterator[Picture]:
    """Yield a press: the view before touch, then frames in which the load grows evenly.

    The contact's radius goes with the load's cube root.
    """
    for number in range(count + 1):
        rng = np.random.default_rng([seed, [*KINDS].index(kind), 99])
        scene = _Scene(rng, kind, grown=(max(number, 1) / count) ** (1 / 3))
        frame = _picture(kind, scene, np.random.default_rng([seed, number]))
        yield frame if number else replace(frame, image=frame.background, area=0.0)
