"""Photographs of fingers that are not ellipsoids, drawn from geometry alone.

Superellipses, pointed and blunt tips, ogives, tips fuller on one side. The true semi-axes are half of the
width and the height of the tip above the widest section.
"""

import math
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
# By name: exponents right and left of the tip, or another curve.
SHAPES: Final[dict[str, tuple[float, float] | str]] = {
    "ellipse": (2.0, 2.0),
    "slightly pointed": (1.85, 1.85),
    "pointed": (1.7, 1.7),
    "slightly blunt": (2.2, 2.2),
    "blunt": (2.5, 2.5),
    "one side fuller": (1.8, 2.2),
    "ogive": "ogive",
    "offset ellipse": "offset",
}
_SHAFT = 1.6


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
        places = (
            np.stack([outline[:, 0] - corner[0], corner[1] - outline[:, 1]], axis=-1) / scale * fine - 0.5
        )
        cv2.fillPoly(canvas, [np.rint(places * 16).astype(np.int32)], 255, cv2.LINE_AA, shift=4)
    small = cv2.resize(canvas, shape[::-1], interpolation=cv2.INTER_AREA)
    return np.asarray(small / 255.0, dtype=np.float64)


@dataclass(frozen=True, eq=False)
class ShapedFinger:
    """A photograph of a finger, its true semi-axes across and along, and the outline of its tip, mm."""

    pixels: Pixels
    face: Face
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


def tip_outline(shape: tuple[float, float] | str, across: float, along: float) -> Array:
    """Return points (x, y), mm, of a tip's outline from the right end of its widest section to the left."""
    t = np.linspace(0, math.pi / 2, 4001)
    if shape == "ogive":
        nose = 0.45 * across
        half, height = across - nose, along - nose
        radius = (half**2 + height**2) / (2 * half)
        turn = np.linspace(0, math.asin(height / radius), 4001)
        side = np.stack([radius * np.cos(turn) - (radius - half), radius * np.sin(turn)], axis=-1)
        side = side + nose * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
        cap = np.linspace(turn[-1], math.pi / 2, 2001)
        right = np.concatenate([side, [0, height] + nose * np.stack([np.cos(cap), np.sin(cap)], axis=-1)])
    elif shape == "offset":
        nose = 0.55 * across
        inner = np.array([across - nose, along - nose])
        normal = np.stack([np.cos(t) / inner[0], np.sin(t) / inner[1]], axis=-1)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        right = inner * np.stack([np.cos(t), np.sin(t)], axis=-1) + nose * normal
    else:
        assert isinstance(shape, tuple)
        right, left = (
            np.stack([across * np.cos(t) ** (2 / p), along * np.sin(t) ** (2 / p)], axis=-1) for p in shape
        )
        return np.concatenate([right, left[-2::-1] * [-1, 1]])
    return np.concatenate([right, right[-2::-1] * [-1, 1]])


def _body(tip: Array, face: Face, proximal: float) -> Array:
    """Return a closed outline: the tip, and what follows below it."""
    across, along = tip[0, 0], tip[:, 1].max()
    low = -_SHAFT * across - (1.5 * along if face != "distal" else 0)
    if face == "distal":
        # The back of the finger: flatter than the pad, and no part of it.
        t = np.linspace(math.pi, 2 * math.pi, 4001)
        return np.concatenate([tip, np.stack([across * np.cos(t), 0.7 * across * np.sin(t)], axis=-1)])
    if face == "palmar":
        return np.concatenate([tip, [[-across, low], [across, low]]])
    # The pad bulges on the palmar side, the right one, down to a fold; below it the finger is straight.
    t = np.linspace(0, math.radians(55), 2001)
    pad = np.stack([across * np.cos(t) ** (2 / proximal), -along * np.sin(t) ** (2 / proximal)], axis=-1)
    return np.concatenate([pad[::-1], tip[1:], [[-across, low], [0.95 * pad[-1, 0], low]]])


def render(shape: tuple[float, float] | str, rng: Rng, face: Face) -> ShapedFinger:
    """Draw one finger before a backdrop, with rough skin, blur, pixels and noise."""
    scale = rng.uniform(0.045, 0.07)
    across, along = (rng.uniform(*limits) for limits in SIZES_MM[face])
    if isinstance(shape, tuple) and rng.uniform() < 0.5:
        shape = shape[::-1]
    tip = tip_outline(shape, across, along)
    # Of a side face the palmar half is the right one: below the tip it goes on as it began.
    proximal = shape[0] if isinstance(shape, tuple) else 2.0
    body = _body(tip, face, proximal)
    return ShapedFinger(photograph_outline(rng, body, face, scale), face, scale, (across, along), tip)


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
