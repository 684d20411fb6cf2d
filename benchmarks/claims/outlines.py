"""Outlines given as points: semi-axes of fingers that are ellipsoids or not, drawn from geometry alone.

30 to 200 points on the pad, clicked one by one, drawn by a hand that wanders, or in steps of 0.1 mm;
leaning by 1.5 degrees.
"""

import math
from collections.abc import Iterator

import numpy as np

from benchmarks.arrays import Array, Rng
from benchmarks.tables import Row, errors_table, rows_of
from fingerpad.image import Face, face_from_outline

KINDS = ("ellipse", "pointed", "blunt", "egg", "one side fuller", "bumps")
FACES: tuple[Face, ...] = ("palmar", "distal", "radial")
_T = np.radians(np.linspace(-60, 240, 6001))


def _curve(kind: str, across: float, along: float, rng: Rng) -> Array:
    c, s = np.cos(_T), np.sin(_T)
    if kind == "egg":
        c = c * np.exp(-rng.choice([-1, 1]) * rng.uniform(0.08, 0.25) * s)
    elif kind == "bumps":
        waves = [rng.normal(0, 0.025) / m * np.cos(m * _T + rng.uniform(0, 6.3)) for m in (3, 4, 5)]
        radius = 1 + np.sum(waves, axis=0)
        c, s = radius * c, radius * s
    elif kind != "ellipse":
        low, high = {"pointed": (1.7, 1.93), "blunt": (2.1, 2.6)}.get(kind, (1.75, 2.0))
        one = rng.uniform(low, high)
        exponent = np.where(c > 0, one, rng.uniform(2, 2.3) if kind == "one side fuller" else one)
        c, s = (np.sign(part) * np.abs(part) ** (2 / exponent) for part in (c, s))
    return np.stack([across * c, along * s], axis=-1)


def _extents(curve: Array, face: Face) -> Array:
    """Return half of the width and the height over it; of a side face the palmar and the distal reach."""
    x, y = curve.T
    tip = int(np.argmax(y))
    if face == "radial":
        palm = int(np.argmax(np.where((_T > -0.5) & (_T < 1.3), x, -np.inf)))
        return np.array([x[palm] - x[tip], y[tip] - y[palm]])
    right, left = int(np.argmax(x)), int(np.argmin(x))
    return np.array([(x[right] - x[left]) / 2, y[tip] - (y[right] + y[left]) / 2])


def draw(kind: str, face: Face, rng: Rng) -> tuple[Array, Array]:
    """Return the points of an outline, mm, and its true semi-axes across and along."""
    across = rng.uniform(6, 9.5) if face == "radial" else rng.uniform(8, 12)
    along = rng.uniform(6, 9.5) if face == "distal" else rng.uniform(10, 16)
    curve = _curve(kind, across, along, rng)
    first, last = ((-15, 10), (80, 130)) if face == "radial" else ((-10, 20), (160, 190))
    low, high = np.radians([rng.uniform(*first), rng.uniform(*last)])
    arc = curve[(low <= _T) & (high >= _T)]
    length = np.append(0, np.cumsum(np.linalg.norm(np.diff(arc, axis=0), axis=1)))
    count, noise = int(rng.integers(30, 200)), rng.uniform(0.03, 0.12)
    at = np.linspace(0, length[-1], count)
    points = np.stack([np.interp(at, length, part) for part in arc.T], axis=-1)
    way = rng.integers(3)
    if way == 1:
        near = np.exp(-0.5 * (at[:, None] - at) ** 2)
        root = np.linalg.cholesky(noise**2 * near + 1e-6 * np.eye(count))
        points = points + root @ rng.normal(0, 1, (count, 2)) + rng.normal(0, 0.02, (count, 2))
    else:
        points = points + rng.normal(0, noise, (count, 2)) / (1 + way / 2)
    if way == 2:
        points = np.round(points, 1)
    lean = math.radians(rng.normal(0, 1.5))
    turn = np.array([[math.cos(lean), math.sin(lean)], [-math.sin(lean), math.cos(lean)]])
    return points @ turn + rng.uniform(-20, 20, 2), _extents(curve, face)


def drawn(count: int, seed: int) -> Iterator[tuple[str, Face, Array, Array]]:
    """Yield kind, face, points and true semi-axes of so many outlines of each kind."""
    for place, kind in enumerate(KINDS):
        for number in range(count):
            face = FACES[number % len(FACES)]
            yield kind, face, *draw(kind, face, np.random.default_rng([seed, place, number]))


def report(count: int = 9, seed: int = 2) -> None:
    """Print errors, stated uncertainties and coverage by kind."""
    rows: dict[str, list[Row]] = {kind: [] for kind in KINDS}
    for kind, face, points, truth in drawn(count, seed):
        found = face_from_outline(face, points)
        rows[kind] += rows_of(found.semi_axes, truth, found.covariance, found.flags)
    errors_table("Semi-axes from outlines", rows)
