"""Outlines of fingers as polygons, and how much of each pixel they cover."""

import math

import cv2
import numpy as np

from benchmarks.arrays import Array, Rng
from fingerpad.image import Face

ROUGHNESS_MM = 0.012
# Least and greatest semi-axes across and along.
SIZES_MM: dict[Face, tuple[tuple[float, float], tuple[float, float]]] = {
    "palmar": ((8, 11), (10, 15)),
    "distal": ((8, 11), (6, 9)),
    "radial": ((6, 9), (10, 15)),
}


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
