"""Find discs in a picture: votes of edges for centres, ellipses through the edges, and those about it."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, Float32Array, FloatArray, as_float_array

SECTORS = 180
LEAST_AXIS_RATIO = 0.75
_LEAST_RADIUS_PX = 10.0
_RADIUS_STEP = 1.05
_LEAST_VOTE = 0.28
_MOST_CANDIDATES = 12
_DRAWS = 120
# A sharp edge loses more of its slope to a wider blur than a soft one; px.
_FINE, _COARSE, _SHARP = 1.2, 3.0, 0.85
# An edge belongs to an ellipse when it lies this near to it, in semi-axes, and crosses it at this angle.
_NEAR, _ALIGNED = 0.006, math.cos(math.radians(22))


class Rim(NamedTuple):
    """An ellipse in a picture: centre (x, y), semi-axes along and across `angle` (from x towards y), px."""

    x: float
    y: float
    first: float
    second: float
    angle: float

    @property
    def size(self) -> float:
        """Geometric mean of the semi-axes."""
        return math.sqrt(self.first * self.second)

    @property
    def axis_ratio(self) -> float:
        """Shorter over longer semi-axis."""
        return min(self.first, self.second) / max(self.first, self.second)

    def scaled(self, factor: float) -> "Rim":
        """Return the concentric ellipse of `factor` times the size."""
        return self._replace(first=self.first * factor, second=self.second * factor)

    def frame(self, x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return points in units of the semi-axes, along the first and the second."""
        cosine, sine = math.cos(self.angle), math.sin(self.angle)
        right, down = x - self.x, y - self.y
        return (right * cosine + down * sine) / self.first, (down * cosine - right * sine) / self.second

    def points(self, t: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Return x, y and the outward unit normal at parametric angles t."""
        cosine, sine = math.cos(self.angle), math.sin(self.angle)
        u, v = self.first * np.cos(t), self.second * np.sin(t)
        nu, nv = np.cos(t) / self.first, np.sin(t) / self.second
        length = np.hypot(nu, nv)
        nu, nv = nu / length, nv / length
        return (
            self.x + u * cosine - v * sine,
            self.y + u * sine + v * cosine,
            nu * cosine - nv * sine,
            nu * sine + nv * cosine,
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Edges:
    """Edge pixels of a picture: places (x, y), unit gradients, and the picture's (rows, columns)."""

    x: FloatArray
    y: FloatArray
    gradient_x: FloatArray
    gradient_y: FloatArray
    shape: tuple[int, int]

    def chosen(self, keep: BoolArray) -> "Edges":
        """Return some of the edges."""
        return Edges(
            x=self.x[keep],
            y=self.y[keep],
            gradient_x=self.gradient_x[keep],
            gradient_y=self.gradient_y[keep],
            shape=self.shape,
        )


def edges_of(values: Float32Array) -> Edges:
    """Return the edges of a picture that stand out of its noise and are sharp, as a shadow's are not."""
    right, down, strength = _gradient(values, _FINE)
    floor = max(3.0 * float(np.median(strength)), 1e-3 * float(np.ptp(values)))
    scale = 2000 / max(float(strength.max()), 1e-9)
    canny = cv2.Canny(
        (right * scale).astype(np.int16),
        (down * scale).astype(np.int16),
        floor * scale,
        1.7 * floor * scale,
        L2gradient=True,
    )
    sharpness = strength / (_gradient(values, _COARSE)[2] + 1e-6)
    strong = (canny > 0) & (strength > 2 * floor)
    sharp = _SHARP * float(np.median(sharpness[strong])) if strong.any() else 0.0
    y, x = np.nonzero((canny > 0) & (sharpness > sharp))
    length = strength[y, x].astype(np.float64)
    across_x, across_y = right[y, x] / length, down[y, x] / length
    shift = parabolic_peak(*(_sampled(strength, x + k * across_x, y + k * across_y) for k in (-1, 0, 1)))
    return Edges(
        x=x + shift * across_x,
        y=y + shift * across_y,
        gradient_x=across_x,
        gradient_y=across_y,
        shape=(values.shape[0], values.shape[1]),
    )


def _gradient(values: Float32Array, blur: float) -> tuple[Float32Array, Float32Array, Float32Array]:
    """Return the gradient to the right, down, and its length, of the blurred picture."""
    smooth = cv2.GaussianBlur(values, (0, 0), blur)
    right, down = (
        np.asarray(cv2.Sobel(smooth, cv2.CV_32F, *order, scale=1 / 8), dtype=np.float32)
        for order in ((1, 0), (0, 1))
    )
    return right, down, np.hypot(right, down)


def _sampled(values: Float32Array, x: FloatArray, y: FloatArray) -> FloatArray:
    if not x.size:
        return np.empty(0)
    return as_float_array(
        cv2.remap(values, x.astype(np.float32), y.astype(np.float32), cv2.INTER_LINEAR)
    ).ravel()


def parabolic_peak(before: FloatArray, here: FloatArray, after: FloatArray) -> FloatArray:
    """Return where a parabola through three neighbours is highest, from the middle one, at most one step."""
    bend = np.minimum(before - 2 * here + after, -1e-12)
    return np.clip(0.5 * (before - after) / bend, -1, 1)


def candidates(edges: Edges) -> list[Rim]:
    """Return circles for whose centres many edges vote, best first."""
    found: list[tuple[float, Rim]] = []
    radius = max(_LEAST_RADIUS_PX, 0.04 * min(edges.shape))
    while radius < 0.75 * max(edges.shape):
        found += _voted(edges, radius)
        radius *= _RADIUS_STEP
    found.sort(key=lambda pair: -pair[0])
    kept: list[Rim] = []
    for _, rim in found:
        if all(
            math.hypot(rim.x - k.x, rim.y - k.y) > 0.12 * k.first
            or abs(math.log(rim.first / k.first)) > 1.5 * math.log(_RADIUS_STEP)
            for k in kept
        ):
            kept.append(rim)
    return kept[:_MOST_CANDIDATES]


def _voted(edges: Edges, radius: float) -> list[tuple[float, Rim]]:
    """Return the best centres of one radius, with the share of the circumference that votes for each."""
    step = max(1.0, radius / 16)
    rows, columns = (math.ceil(n / step) for n in edges.shape)
    votes = np.zeros(rows * columns)
    for side in (-radius, radius):
        column = ((edges.x + side * edges.gradient_x) / step).astype(int)
        row = ((edges.y + side * edges.gradient_y) / step).astype(int)
        inside = (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
        votes += np.bincount(row[inside] * columns + column[inside], minlength=votes.size)
    share = cv2.boxFilter(votes.reshape(rows, columns), -1, (3, 3), normalize=False) / (2 * math.pi * radius)
    peaks = (share > _LEAST_VOTE) & (share >= cv2.dilate(as_float_array(share), np.ones((7, 7))))
    return [
        (float(share[r, c]), Rim((c + 0.5) * step, (r + 0.5) * step, radius, radius, 0.0))
        for r, c in np.argwhere(peaks)
    ]


def support(edges: Edges, rim: Rim) -> tuple[float, float]:
    """Return the share of the visible sectors of a rim that hold an edge of it, and the share visible."""
    t = as_float_array((np.arange(SECTORS) + 0.5) * (2 * math.pi / SECTORS))
    x, y, _, _ = rim.points(t)
    rows, columns = edges.shape
    visible = (x > 1) & (x < columns - 2) & (y > 1) & (y < rows - 2)
    held = np.zeros(SECTORS, dtype=bool)
    held[_sector(edges, rim, _on_rim(edges, rim))] = True
    seen = np.count_nonzero(visible)
    return (np.count_nonzero(held & visible) / seen if seen else 0.0), seen / SECTORS


def _on_rim(edges: Edges, rim: Rim, near: float = _NEAR) -> BoolArray:
    """Tell which edges lie on an ellipse and cross it."""
    u, v = rim.frame(edges.x, edges.y)
    distance = np.hypot(u, v)
    close = np.abs(distance - 1) < max(near, 0.6 / rim.size)
    cosine, sine = math.cos(rim.angle), math.sin(rim.angle)
    nu, nv = u / rim.first, v / rim.second
    length = np.hypot(nu, nv) + 1e-12
    dot = (
        edges.gradient_x * (nu * cosine - nv * sine) + edges.gradient_y * (nu * sine + nv * cosine)
    ) / length
    return np.asarray(close & (np.abs(dot) > _ALIGNED))


def _sector(edges: Edges, rim: Rim, keep: BoolArray) -> npt.NDArray[np.intp]:
    u, v = rim.frame(edges.x[keep], edges.y[keep])
    turn = (np.arctan2(v, u) / (2 * math.pi)) % 1
    return np.minimum((turn * SECTORS).astype(np.intp), SECTORS - 1)


def circles(edges: Edges, start: Rim, least: float) -> list[Rim]:
    """Return the circles near a voted one, and about its centre further out, that the edges support.

    A circle is told from the outline of a coin with its shadow, which an ellipse would follow.
    """
    near = edges.chosen(_between(edges, start, 0.85, 1.45))
    found: list[Rim] = []
    for factor in np.arange(0.95, 1.35, 0.01):
        rim: Rim | None = start.scaled(float(factor))
        for width in (0.025, 0.012, _NEAR):
            rim = rim and _circle_through(near.chosen(_on_rim(near, rim, near=width)))
        if rim and support(near, rim)[0] >= least and all(_differ(rim, other) for other in found):
            found.append(rim)
            start = rim.scaled(1 / float(factor))
    return found


def _between(edges: Edges, rim: Rim, inner: float, outer: float) -> BoolArray:
    distance = np.hypot(*rim.frame(edges.x, edges.y))
    return np.asarray((distance > inner) & (distance < outer))


def _differ(rim: Rim, other: Rim) -> bool:
    return abs(rim.size - other.size) + math.hypot(rim.x - other.x, rim.y - other.y) > 0.01 * rim.size


def _circle_through(edges: Edges) -> Rim | None:
    """Return the least-squares circle through edges (Kåsa)."""
    if edges.x.size < 12:
        return None
    x0, y0 = edges.x.mean(), edges.y.mean()
    x, y = edges.x - x0, edges.y - y0
    design = np.stack([x, y, np.ones_like(x)], axis=-1)
    (a, b, c), *_ = np.linalg.lstsq(design, x * x + y * y, rcond=None)
    square = c + (a * a + b * b) / 4
    if not square > 4:
        return None
    radius = math.sqrt(square)
    return Rim(float(x0 + a / 2), float(y0 + b / 2), radius, radius, 0.0)


def ellipses(edges: Edges, start: Rim, rng: np.random.Generator, least: float) -> list[Rim]:
    """Return the ellipse near a voted circle that most sectors support, and those further out about it."""
    near = edges.chosen(_between(edges, start, 0.75, 1.6))
    rim = _drawn_through(near, start, rng)
    return [] if rim is None or support(near, rim)[0] < least else _concentric(near, rim, least)


def _drawn_through(edges: Edges, start: Rim, rng: np.random.Generator) -> Rim | None:
    """Return the best supported ellipse near a circle: a few edges drawn again and again."""
    near = edges.chosen(_on_rim(edges, start, near=0.16))
    if near.x.size < 30:
        return None
    points = np.stack([near.x, near.y], axis=-1).astype(np.float32)
    best, best_share = None, 0.0
    for _ in range(_DRAWS):
        rim = _through(points[rng.choice(len(points), 6, replace=False)])
        if rim is None or not 0.7 < rim.size / start.size < 1.4:
            continue
        share = support(near, rim)[0]
        if share > best_share:
            best, best_share = rim, share
    for width in (0.012, _NEAR, _NEAR):
        if best is None:
            return None
        best = _through(points[_on_rim(near, best, near=width)]) or best
    return best


def _through(points: Float32Array) -> Rim | None:
    """Return the least-squares ellipse through points, None where it is no disc's."""
    if len(points) < 6:
        return None
    (x, y), (first, second), degrees = cv2.fitEllipseDirect(points)
    if not (math.isfinite(x + y + first + second) and min(first, second) > 2):
        return None
    rim = Rim(x, y, first / 2, second / 2, math.radians(degrees))
    return rim if rim.axis_ratio > LEAST_AXIS_RATIO else None


def _concentric(edges: Edges, rim: Rim, least: float) -> list[Rim]:
    """Return the supported ellipses about one centre, from `rim` outward."""
    points = np.stack([edges.x, edges.y], axis=-1).astype(np.float32)
    found = [rim]
    for factor in np.arange(1.01, 1.4, 0.01):
        grown: Rim | None = rim.scaled(float(factor))
        for width in (0.02, _NEAR):
            grown = grown and _through(points[_on_rim(edges, grown, near=width)])
        if grown and grown.size > 1.005 * found[-1].size and support(edges, grown)[0] >= least:
            found.append(grown)
    return found
