"""Photographs of fingertips of known curvature: semi-axes, and the radius at the place of contact.

Each outline is drawn from its radius of curvature as a function of its normal's angle, R(psi), so that the
radius at every place is known without any fit: eggs, flattened and narrow tips, shoulders, arches of three
circles, sides that differ, pads flatter near the middle, and smooth random departures. Written from geometry
alone. The true semi-axes are half of the width and the height of the tip above its widest places; of a side
face, whose other half is the nail's side, what the palmar half reaches out from the tip and down from it.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import cv2
import numpy as np

from benchmarks.arrays import Array, Pixels, Rng
from fingerpad.image import Face

ROUGHNESS_MM = 0.012
# Least and greatest semi-axes across and along.
SIZES_MM: dict[Face, tuple[tuple[float, float], tuple[float, float]]] = {
    "palmar": ((8, 11), (10, 15)),
    "distal": ((8, 11), (6, 9)),
    "radial": ((6, 9), (10, 15)),
}
# Normals from the fold below the pad of a side face, over the tip, to the widest place on the other side.
_PSI: Final = np.linspace(math.radians(-50), math.pi, 8001)


def even(points: Array, step: float = 0.05) -> Array:
    """Return points at even steps, mm, along a closed outline."""
    closed = np.concatenate([points, points[:1]])
    place = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(closed, axis=0), axis=1))])
    at = np.arange(0, place[-1], step)
    return np.stack([np.interp(at, place, closed[:, k]) for k in (0, 1)], axis=-1)


def normals(points: Array) -> Array:
    """Return the outward normals of an even outline that turns anticlockwise."""
    tangent = np.roll(points, -3, axis=0) - np.roll(points, 3, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    return np.stack([tangent[:, 1], -tangent[:, 0]], axis=-1)


def leaning(rng: Rng) -> Array:
    """Return a matrix that turns points, as rows, by up to three degrees."""
    lean = math.radians(rng.uniform(-3, 3))
    return np.array([[math.cos(lean), math.sin(lean)], [-math.sin(lean), math.cos(lean)]])


def cover(outlines: list[Array], corner: tuple[float, float], shape: tuple[int, int], scale: float) -> Array:
    """Return how much of each pixel outlines cover; the corner is the upper left one, mm, y up."""
    fine = 4
    canvas = np.zeros((shape[0] * fine, shape[1] * fine), np.uint8)
    for outline in outlines:
        from_corner = np.stack([outline[:, 0] - corner[0], corner[1] - outline[:, 1]], axis=-1)
        places = from_corner / scale * fine - 0.5
        cv2.fillPoly(canvas, [np.rint(places * 16).astype(np.int32)], 255, cv2.LINE_AA, shift=4)
    small = cv2.resize(canvas, shape[::-1], interpolation=cv2.INTER_AREA)
    return np.asarray(small / 255.0, dtype=np.float64)


@dataclass(frozen=True, eq=False)
class ShapedFinger:
    """A photograph of a finger, its true semi-axes across and along, and the outline of its tip, mm."""

    pixels: Pixels
    mm_per_px: float
    semi_axes: tuple[float, float]
    tip: Array

    def radius(self, angle: float) -> float:
        """Return the radius of curvature, mm, where the normal is at this angle from the right, rad."""
        step = np.diff(self.tip, axis=0)
        length = np.linalg.norm(step, axis=1)
        turn = np.unwrap(np.arctan2(-step[:, 0], step[:, 1]))
        place = np.cumsum(length) - length / 2
        low, high = np.interp([angle - 0.01, angle + 0.01], turn, place)
        return float(high - low) / 0.02


def _ellipse(psi: Array, across: float, along: float) -> Array:
    support = np.sqrt((across * np.cos(psi)) ** 2 + (along * np.sin(psi)) ** 2)
    return (across * along) ** 2 / support**3


def _bump(psi: Array, centre_deg: float, width_deg: float) -> Array:
    return np.exp(-0.5 * ((psi - math.radians(centre_deg)) / math.radians(width_deg)) ** 2)


def _step(psi: Array, at_deg: float, width_deg: float) -> Array:
    """Return a smooth step from -1 to 1."""
    return np.tanh((psi - math.radians(at_deg)) / math.radians(width_deg))


def _egg(psi: Array, across: float, along: float, rng: Rng) -> Array:
    """Return the radii of an egg: an ellipse whose support function has a third harmonic; it stays convex."""
    ellipse = _ellipse(psi, across, along)
    share = rng.choice([-1, 1]) * rng.uniform(0.2, 0.45) * ellipse.min()
    return ellipse + share * np.sin(3 * psi)


def _arch(psi: Array, across: float, along: float, rng: Rng) -> Array:
    """Return the radii of an arch of three circles, run into one another over 12 degrees."""
    ends = np.log(_ellipse(np.radians([0.0, 90.0]), across, along))
    side, tip = ends.mean() + rng.uniform(0.55, 0.75) * (ends - ends.mean())
    at = rng.uniform(38, 52)
    inside = 0.5 * (_step(psi, at, 12) - _step(psi, 180 - at, 12))
    return np.exp(side + (tip - side) * inside)


def _random(psi: Array, across: float, along: float, rng: Rng) -> Array:
    order = np.arange(1, 5)
    phase, size = rng.uniform(0, 2 * math.pi, 4), rng.normal(0, 0.16, 4) / np.sqrt(order)
    return _ellipse(psi, across, along) * np.exp(np.cos(psi[:, None] * order + phase) @ size)


def _scaled(factor: Callable[[Array, Rng], Array]) -> Callable[..., Array]:
    def radii(psi: Array, across: float, along: float, rng: Rng) -> Array:
        return _ellipse(psi, across, along) * factor(psi, rng)

    return radii


SHAPES: Final[dict[str, Callable[..., Array]]] = {
    "ellipse": lambda psi, across, along, _: _ellipse(psi, across, along),
    "egg": _egg,
    "flattened tip": _scaled(lambda psi, rng: 1 + rng.uniform(0.4, 1.0) * _bump(psi, 90, 25)),
    "narrow tip": _scaled(lambda psi, rng: 1 - rng.uniform(0.2, 0.45) * _bump(psi, 90, 25)),
    "shoulders": _scaled(
        lambda psi, rng: 1 - rng.uniform(0.2, 0.4) * (_bump(psi, 45, 15) + _bump(psi, 135, 15))
    ),
    "three circles": _arch,
    "sides differ": _scaled(
        lambda psi, rng: np.exp(rng.choice([-1, 1]) * rng.uniform(0.15, 0.35) * _step(psi, 90, 30))
    ),
    "flat pad": _scaled(lambda psi, rng: 1 + rng.uniform(0.3, 0.8) * _bump(psi, 10, 25)),
    "random": _random,
}


def superellipse(exponents: tuple[float, float], across: float, along: float) -> Array:
    """Return points (x, y) of a tip from right to left, with an exponent for each side."""
    t = np.linspace(0, math.pi / 2, 4001)
    right, left = (
        np.stack([across * np.cos(t) ** (2 / p), along * np.sin(t) ** (2 / p)], axis=-1) for p in exponents
    )
    return np.concatenate([right, left[-2::-1] * [-1, 1]])


def render(name: str, rng: Rng, face: Face) -> ShapedFinger:
    """Draw one finger before a backdrop, with rough skin, blur, pixels and noise."""
    scale = rng.uniform(0.045, 0.07)
    across, along = (rng.uniform(*limits) for limits in SIZES_MM[face])
    radii = SHAPES[name](_PSI, across, along, rng)
    pace = radii[:, None] * np.stack([-np.sin(_PSI), np.cos(_PSI)], axis=-1)
    steps = np.diff(_PSI)[:, None] * (pace[1:] + pace[:-1]) / 2
    curve = np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])
    right = np.searchsorted(_PSI, 0.0)
    # The origin is midway between the widest places.
    curve = curve - (curve[right] + curve[-1]) / 2
    tip = curve[right:]
    shaft = _shaft(rng, tip, face, curve if face == "radial" else tip)
    top = tip[tip[:, 1].argmax()]
    reach = (tip[0, 0] - top[0], top[1] - tip[0, 1]) if face == "radial" else (tip[0, 0], top[1])
    return ShapedFinger(photograph_outline(rng, shaft, face, scale), scale, reach, tip)


def _shaft(rng: Rng, tip: Array, face: Face, seen: Array) -> Array:
    """Return a closed outline: the tip, and a finger that narrows by up to three degrees below it."""
    across, along = tip[0, 0], tip[:, 1].max()
    if face == "distal":
        t = np.linspace(0, math.pi, 2001)[1:-1, None]
        back = 0.7 * across * np.sin(t) * [0, -1] + (tip[-1] + (tip[0] - tip[-1]) * (1 - np.cos(t)) / 2)
        return np.concatenate([tip, back])
    low = -1.6 * across - 1.5 * along
    in_by = math.tan(math.radians(rng.uniform(0, 3))) * -low
    first = seen[0, 0] * (0.95 if face == "radial" else 1) - in_by
    return np.concatenate([seen, [[-across + in_by, low], [first, low]]])


def photograph_outline(rng: Rng, body: Array, face: Face, scale: float) -> Pixels:
    """Draw a closed outline as rough skin before a backdrop."""
    skin = even(body)
    outline = (skin + normals(skin) * _rough(rng, len(skin))[:, None]) @ leaning(rng)
    low, high = outline.min(axis=0) - 4, outline.max(axis=0) + 4
    if face != "distal":
        low[1] = outline[:, 1].min() + 1.5  # the finger leaves the frame below
    columns, rows = (int(n) for n in np.ceil((high - low) / scale))
    share = cover([outline], (low[0], high[1]), (rows, columns), scale)
    share = np.asarray(cv2.GaussianBlur(share, (0, 0), rng.uniform(0.7, 1.4)))
    skin_colour = np.array([205, 160, 135]) * rng.uniform(0.7, 1.1)
    ground = np.array([[60, 90, 150], [70, 130, 80], [235, 238, 240]][rng.integers(3)])
    light = 1 + 0.1 * np.linspace(-1, 1, columns)[None, :, None] * rng.uniform(-1, 1)
    colour = light * (share[..., None] * skin_colour + (1 - share[..., None]) * ground)
    noisy = colour + rng.normal(0, rng.uniform(1, 4), colour.shape)
    return np.asarray(np.clip(np.rint(noisy), 0, 255), dtype=np.uint8)


def _rough(rng: Rng, count: int) -> Array:
    """Return the skin's roughness, alike over 0.3 mm."""
    kernel = np.exp(-0.5 * (np.arange(-20, 21) / 6) ** 2)
    noise = np.convolve(rng.standard_normal(count + 40), kernel, mode="valid")
    return ROUGHNESS_MM * noise / noise.std()
