"""Photographs of fingers that are not ellipsoids: bias, stated uncertainty and coverage of the semi-axes.

The outlines are drawn from geometry alone: superellipses, pointed and blunt tips, ogives, tips fuller on one
side. The true semi-axes are half of the width and the height of the tip above the widest section.
"""

import math
import zlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Final, TypeAlias

import cv2
import numpy as np
import numpy.typing as npt

from benchmarks.tables import Row, errors_table, off, share, stated, table
from fingerpad.exceptions import FitError, ImageError
from fingerpad.image import Face, PhotographFit, Scale, measure_photograph
from fingerpad.image.photograph.faces import Direction

Array = npt.NDArray[np.float64]

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
SIDES: Final[dict[Face, Direction | None]] = {"palmar": None, "distal": "up", "radial": "right"}
# Least and greatest semi-axes across and along.
SIZES_MM: Final[dict[Face, tuple[tuple[float, float], tuple[float, float]]]] = {
    "palmar": ((8, 11), (10, 15)),
    "distal": ((8, 11), (6, 9)),
    "radial": ((6, 9), (10, 15)),
}
_SHAFT = 1.6


@dataclass(frozen=True, eq=False)
class ShapedFinger:
    """A photograph of a finger, its true semi-axes across and along, and the outline of its tip, mm."""

    pixels: npt.NDArray[np.uint8]
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


def render(rng: np.random.Generator, shape: tuple[float, float] | str, face: Face) -> ShapedFinger:
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


def photograph_outline(
    rng: np.random.Generator, body: Array, face: Face, scale: float
) -> npt.NDArray[np.uint8]:
    """Draw a closed outline as rough skin before a backdrop."""
    even = _even(body, 0.05)
    even = even + _normals(even) * _rough(rng, len(even))[:, None]
    lean = math.radians(rng.uniform(-3, 3))
    turned = even @ np.array([[math.cos(lean), math.sin(lean)], [-math.sin(lean), math.cos(lean)]])
    return _photograph(rng, turned, scale, cut=face != "distal")


def _even(points: Array, step: float) -> Array:
    closed = np.concatenate([points, points[:1]])
    place = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(closed, axis=0), axis=1))])
    at = np.arange(0, place[-1], step)
    return np.stack([np.interp(at, place, closed[:, k]) for k in (0, 1)], axis=-1)


def _normals(points: Array) -> Array:
    tangent = np.roll(points, -3, axis=0) - np.roll(points, 3, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    return np.stack([tangent[:, 1], -tangent[:, 0]], axis=-1)


def _rough(rng: np.random.Generator, count: int) -> Array:
    """Return the skin's roughness: 0.012 mm, alike over 0.3 mm."""
    kernel = np.exp(-0.5 * (np.arange(-20, 21) / 6) ** 2)
    noise = np.convolve(rng.standard_normal(count + 40), kernel, mode="valid")
    return np.asarray(0.012 * noise / noise.std())


def _photograph(
    rng: np.random.Generator, outline: Array, scale: float, *, cut: bool
) -> npt.NDArray[np.uint8]:
    fine = 4
    low, high = outline.min(axis=0) - 4, outline.max(axis=0) + 4
    if cut:
        low[1] = outline[:, 1].min() + 1.5  # the finger leaves the frame below
    columns, rows = np.ceil((high - low) / scale).astype(int)
    places = np.stack([outline[:, 0] - low[0], high[1] - outline[:, 1]], axis=-1) / scale * fine - 0.5
    canvas = np.zeros((rows * fine, columns * fine), np.uint8)
    cv2.fillPoly(canvas, [np.rint(places * 16).astype(np.int32)], 255, cv2.LINE_AA, shift=4)
    share = cv2.resize(canvas, (int(columns), int(rows)), interpolation=cv2.INTER_AREA) / 255.0
    share = cv2.GaussianBlur(np.asarray(share, dtype=np.float64), (0, 0), rng.uniform(0.7, 1.4))
    skin = np.array([205, 160, 135]) * rng.uniform(0.7, 1.1)
    ground = np.array([[60, 90, 150], [70, 130, 80], [235, 238, 240]][rng.integers(3)])
    light = 1 + 0.1 * np.linspace(-1, 1, columns)[None, :, None] * rng.uniform(-1, 1)
    colour = light * (share[..., None] * skin + (1 - share[..., None]) * ground)
    noisy = colour + rng.normal(0, rng.uniform(1, 4), colour.shape)
    return np.asarray(np.clip(np.rint(noisy), 0, 255), dtype=np.uint8)


def measured(
    count: int, seed: int, faces: tuple[Face, ...] = ("palmar", "distal", "radial")
) -> Iterator[tuple[str, ShapedFinger, PhotographFit | None]]:
    """Yield each shape's name, a finger of it and its measurement, None where that is refused."""
    for name, shape in SHAPES.items():
        for number in range(count):
            rng = np.random.default_rng([seed, zlib.crc32(name.encode()), number])
            face = faces[number % len(faces)]
            if name == "ogive" and face == "distal":
                face = "palmar"  # an ogive is higher than wide
            yield name, *measure_one(render(rng, shape, face))


def measure_one(truth: ShapedFinger) -> tuple[ShapedFinger, PhotographFit | None]:
    """Return a finger and its measurement, None where that is refused."""
    try:
        scale, palmar = Scale(truth.mm_per_px), SIDES[truth.face]
        return truth, measure_photograph(truth.pixels, truth.face, scale, palmar=palmar)
    except (FitError, ImageError):
        return truth, None


Finger: TypeAlias = tuple[str, ShapedFinger, PhotographFit | None]


def print_accuracy(fingers: Iterable[Finger]) -> None:
    """Print how well semi-axes and radii at the place of contact are found."""
    done = list(fingers)
    print_semi_axes(done)
    print_radii(done)


def print_radii(fingers: Iterable[Finger], wedges_deg: tuple[int, ...] = (15, 30, 45, 60)) -> None:
    """Print errors of the radius of curvature in the plane of a side face, where wedges touch."""
    rows: dict[str, list[tuple[float, float, float]]] = {}
    for name, truth, found in fingers:
        if found is None or truth.face != "radial":
            continue
        for angle in np.radians(wedges_deg):
            true, (radius, std) = truth.radius(angle), found.outline_radius(angle)
            ellipse = found.ellipse_radius(angle)
            rows.setdefault(name, []).append((radius / true - 1, std / radius, ellipse / true - 1))
    rows["all"] = [row for some in rows.values() for row in some]
    table(
        ("shape", "n", "seen", "bias, rms error", "stated, held", "of the ellipse: bias, rms error"),
        (
            (name, len(some), share(seen), off(e[seen]), stated(e[seen], s[seen]), off(by_ellipse))
            for name, some in rows.items()
            for e, s, by_ellipse in [np.array(some).T]
            for seen in [np.isfinite(e)]
        ),
        "Radius of curvature where a wedge touches, in the plane of a side face: outline alone",
    )


def print_semi_axes(fingers: Iterable[Finger]) -> None:
    """Print bias, spread, stated uncertainty and coverage of each shape's semi-axes."""
    rows: dict[str, list[Row]] = {}
    refused = 0
    for name, truth, found in fingers:
        if found is None:
            refused += 1
            continue
        errors = found.semi_axes / np.array(truth.semi_axes) - 1
        stds = np.sqrt(np.diagonal(found.covariance)) / found.semi_axes
        flagged = "not_an_ellipse" in found.flags
        rows.setdefault(name, []).extend((e, s, flagged) for e, s in zip(errors, stds, strict=True))
    errors_table(f"Semi-axes; {refused} photographs refused", rows)


def report(count: int = 24, seed: int = 5) -> None:
    """Print errors, stated uncertainty and coverage by shape."""
    print_accuracy(measured(count, seed))
