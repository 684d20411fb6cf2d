"""Photographs of three-dimensional fingertips of known curvature, from three sides.

A fingertip is a convex body given by its support function h(n), the distance of the tangent plane of normal
n. All that is asked of it follows exactly: the place of contact with normal n is the gradient of h, the
principal radii of curvature are those of its Hessian, and the outline seen along d is that of the normals
across d. Flat pads and spatulate tips are Minkowski sums with a flat ellipsoid; bulging, tapered and lopsided
ones are Firey sums with a displaced one. Written from anatomy and geometry, before what measures them was
read.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Final

import cv2
import numpy as np

from benchmarks.arrays import Array, Pixels, Rng
from benchmarks.truth.fingertips import ROUGHNESS_MM, cover, even, leaning, normals
from benchmarks.truth.true_image import jpeg, named_rng
from fingerpad.image import Face

Support = Callable[[Array], Array]

FACES: Final[tuple[Face, ...]] = ("palmar", "distal", "radial")
WEDGES_DEG: Final = (20, 30, 45)


def _ellipsoid(axes: Array, centre: tuple[float, float, float] = (0, 0, 0), turn: float = 0.0) -> Support:
    """Return the support function of an ellipsoid, turned about z from x to y."""
    c, s = math.cos(turn), math.sin(turn)
    turned = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    return lambda n: n @ np.array(centre) + np.linalg.norm((n @ turned.T) * axes, axis=-1)


def _firey(power: float, *parts: Support) -> Support:
    """Return a rounded hull of bodies that hold the origin: convex for powers from 1."""
    return lambda n: np.linalg.norm([part(n) for part in parts], ord=power, axis=0)


def _flat(axes: Array, rng: Rng, normal: int, turn: float) -> Support:
    share, thin = rng.uniform(0.25, 0.4), rng.uniform(0.1, 0.18)
    plate = np.full(3, share)
    plate[normal] = thin
    parts = _ellipsoid(axes * (1 - plate)), _ellipsoid(axes * plate, turn=turn)
    return lambda n: np.sum([part(n) for part in parts], axis=0)


def _body(name: str, axes: Array, rng: Rng) -> Support:
    a, b, c = axes
    power = rng.uniform(3, 6)
    if name == "flat pad":
        return _flat(axes, rng, 0, math.radians(rng.uniform(0, 25)))
    if name == "spatulate":
        return _flat(axes, rng, 1, 0.0)
    if name == "pulp bulge":
        bulge = _ellipsoid(0.65 * axes, (0.35 * a, rng.uniform(0.1, 0.3) * b, 0))
        return _firey(power, _ellipsoid(axes * 0.95), bulge)
    if name == "tapered":
        end = _ellipsoid(axes * rng.uniform(0.5, 0.65), (0.05 * a, 0.45 * b, 0))
        return _firey(power, _ellipsoid(axes * [1, 0.8, 1]), end)
    if name == "lopsided":
        side = _ellipsoid(0.75 * axes, (0, 0.2 * b, rng.choice([-1, 1]) * rng.uniform(0.15, 0.25) * c))
        return _firey(power, _ellipsoid(axes * 0.97), side)
    return _ellipsoid(axes)


# "bent": the shaft is bent in the last joint; "nail": it overhangs the tip.
NAMES: Final = ("ellipsoid", "flat pad", "pulp bulge", "tapered", "lopsided", "spatulate", "bent", "nail")


def _point(support: Support, normal: Array) -> Array:
    """Return the place of contact with these normals: the gradient of the support function."""
    step = 1e-4 * np.eye(3)
    n = normal[..., None, :]
    return (support(n + step) - support(n - step)) / 2e-4


def _radii(support: Support, wedge: float) -> Array:
    """Return the radii of curvature along and across the finger, and 1/H, on a wedge."""
    normal = np.array([math.cos(wedge), math.sin(wedge), 0])
    tangents = np.array([[-math.sin(wedge), math.cos(wedge), 0], [0, 0, 1]])
    ahead, behind = _point(support, normal + 1e-3 * tangents), _point(support, normal - 1e-3 * tangents)
    hessian = (ahead - behind) @ tangents.T / 2e-3
    return np.array([hessian[0, 0], hessian[1, 1], 2 / np.trace(np.linalg.inv(hessian))])


@dataclass(frozen=True, eq=False)
class AnatomicFinger:
    """A fingertip, its photographs by face, true semi-axes by face and radii on the wedges, mm."""

    name: str
    mm_per_px: float
    photographs: dict[Face, Pixels]
    semi_axes: dict[Face, tuple[float, float]]
    radii: Array


def draw(name: str, rng: Rng) -> AnatomicFinger:
    """Draw one finger and its three photographs."""
    axes = np.array([rng.uniform(6, 9), rng.uniform(10, 15), rng.uniform(8, 11)])
    support = _body(name, axes, rng)
    palm, tip, *sides = _point(support, np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, -1.0]]))
    widest = np.mean(sides, axis=0)
    half = (sides[0][2] - sides[1][2]) / 2
    reach: dict[Face, tuple[float, float]] = {
        "palmar": (half, tip[1] - widest[1]),
        "distal": (half, palm[0] - widest[0]),
        "radial": (palm[0] - tip[0], tip[1] - palm[1]),
    }
    scale = rng.uniform(0.045, 0.065)
    bend = math.radians(rng.uniform(5, 10) if name == "bent" else rng.uniform(-1, 2))
    overhang = rng.uniform(0.3, 1.0) if name == "nail" else 0.0
    parts = partial(_parts, rng, support, bend=bend, overhang=overhang)
    photographs = {face: _photograph(rng, parts(face), face, scale) for face in FACES}
    radii = np.array([_radii(support, math.radians(wedge)) for wedge in WEDGES_DEG])
    return AnatomicFinger(name, scale, photographs, reach, radii)


def _parts(
    rng: Rng, support: Support, face: Face, bend: float, overhang: float
) -> tuple[Array, Array, Array | None]:
    """Return outlines (right, up), mm, of the tip, the shaft and the nail, None where it is not seen."""
    t = np.linspace(0, 2 * math.pi, 3000, endpoint=False)
    zero = np.zeros_like(t)
    right, up = np.cos(t), np.sin(t)
    if face == "palmar":
        tip = _point(support, np.stack([zero, up, right], axis=-1))[:, [2, 1]]
    elif face == "distal":
        tip = _point(support, np.stack([up, zero, right], axis=-1))[:, [2, 0]]
    else:
        tip = _point(support, np.stack([right, up, zero], axis=-1))[:, [0, 1]]
    width = float(np.ptp(tip[:, 0]))
    top, low = tip[:, 1].max(), tip[:, 1].min()
    if face == "distal":
        level = (tip[tip[:, 0].argmax(), 1] + tip[tip[:, 0].argmin(), 1]) / 2
        back = tip[:, 1] < level
        tip[back, 1] = level + 0.65 * (tip[back, 1] - level)
        nail = 0.72 * (tip - [0, level]) * [1, 1] + [0, level - 0.22 * (level - tip[:, 1].min())]
        return tip, tip, nail - [0, overhang]
    shaft_half = width / 2 * rng.uniform(0.9, 0.99)
    if face == "palmar":
        joint = tip[tip[:, 0].argmax(), 1]
        below = low - 14.0
        shaft = np.array([[-shaft_half, joint - 4], [shaft_half, joint - 4]])
        shaft = np.concatenate([shaft, [[0.97 * shaft_half, below], [-0.97 * shaft_half, below]]])
        nail = np.stack([0.72 * width / 2 * right, top + overhang - 4.0 + 4.0 * up], axis=-1)
        return tip, shaft, nail if overhang else None
    # A side face: the pad ends in a fold, the back is flatter, the shaft may be bent to the palm.
    ridge = tip[tip[:, 1].argmax(), 0]
    back = tip[:, 0] < ridge
    tip[back, 0] = ridge + 0.7 * (tip[back, 0] - ridge)
    fold = tip[np.searchsorted(t, 2 * math.pi - math.radians(rng.uniform(45, 60)))]
    dorsal = tip[:, 0].min()
    shaft = np.array([[dorsal, 0.0], [fold[0], fold[1]], [fold[0], low - 14], [dorsal, low - 14]])
    lean = np.tan(-bend) * np.minimum(shaft[:, 1] - fold[1], 0)
    shaft[:, 0] += lean
    nail = np.array([[dorsal - 0.2, 0.3 * top], [dorsal + 0.9, 0.3 * top], [0.55 * dorsal, top + overhang]])
    return tip, shaft, nail - [0.0, 0.0 if overhang else 0.12 * top]


def _photograph(rng: Rng, parts: tuple[Array, Array, Array | None], face: Face, scale: float) -> Pixels:
    tip, shaft, nail = parts
    turn = leaning(rng)
    seen = [part @ turn for part in (tip, shaft)]
    low, high = np.concatenate(seen).min(axis=0) - 5, np.concatenate(seen).max(axis=0) + 5
    if face != "distal":
        low[1] += 8.0  # the finger leaves the frame below
    columns, rows = (int(n) for n in np.ceil((high - low) / scale))

    def share(*outlines: Array) -> Array:
        return cover(list(outlines), (low[0], high[1]), (rows, columns), scale)

    def blurred(image: Array, mm: float) -> Array:
        return np.asarray(cv2.GaussianBlur(image, (0, 0), mm / scale), dtype=np.float64)

    finger = share(*(_rough(rng, outline) for outline in seen))
    # Out of focus behind the finger: two colours of one cloth, blurred, and a soft shadow on it.
    cloth = blurred(rng.standard_normal((rows, columns)), 2.0)
    ground = np.array([[60, 90, 150], [80, 125, 95], [222, 226, 228], [40, 42, 46]][rng.integers(4)])
    by = np.eye(2, 3)
    by[:, 2] = rng.integers(-1, 2, 2) * 1.2 / scale
    moved = cv2.warpAffine(finger, by, (columns, rows), borderMode=cv2.BORDER_REPLICATE)
    dark = 1 - rng.uniform(0, 0.4) * blurred(moved, rng.uniform(0.6, 1.5))
    ground = ground * (dark * (1 + 0.08 * cloth / np.abs(cloth).max()))[..., None]
    skin = np.array([208, 162, 138]) * rng.uniform(0.65, 1.1)
    round_ = 0.8 + 0.2 * np.minimum(blurred(finger, 1.0) * 2 - 1, 1)
    mottled = blurred(rng.standard_normal((rows, columns)), 0.15)
    body = skin * (round_ * (1 + 0.03 * mottled / mottled.std()))[..., None]
    if nail is not None:
        plate = share(nail @ turn)[..., None] * (1.0 if face != "palmar" else 1 - finger[..., None])
        body = (1 - plate) * body + plate * (0.9 * skin + 30)
        finger = np.maximum(finger, plate[..., 0])
    picture = finger[..., None] * body + (1 - finger[..., None]) * ground
    picture = picture * (1 + rng.uniform(-0.12, 0.12) * np.linspace(-1, 1, columns)[None, :, None])
    picture = cv2.GaussianBlur(picture, (0, 0), rng.uniform(0.7, 1.5)) + rng.normal(0, 3, picture.shape)
    pixels = np.clip(np.rint(picture), 0, 255).astype(np.uint8)
    return jpeg(pixels, int(rng.integers(75, 96)))


def _rough(rng: Rng, outline: Array) -> Array:
    """Return the outline in even steps, roughened, alike over 0.3 mm."""
    skin = even(outline)
    noise = cv2.GaussianBlur(rng.standard_normal((len(skin), 1)), (1, 41), 0, sigmaY=6)
    return skin + ROUGHNESS_MM * noise / noise.std() * normals(skin)


def fingers(count: int, seed: int) -> list[AnatomicFinger]:
    """Return this many fingers of each kind."""
    return [draw(name, named_rng(seed, name, number)) for name in NAMES for number in range(count)]
