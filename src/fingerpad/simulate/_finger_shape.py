"""Outlines of a synthetic finger, an arc of an ellipse that runs on into its sides, and noisy points."""

import math
from dataclasses import dataclass

import numpy as np

from fingerpad._arrays import FloatArray, check_radians
from fingerpad.image.ellipse import outward_normals, rotation
from fingerpad.image.photograph.faces import Face

_STEP_MM = 0.02
_LENGTH_MM = 75.0
# Heading left to turn below which the curvature eases off, radians.
_EASE = 0.35
_TEXTURE_PERIOD_MM = 0.45


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FingerShape:
    """An outline in a face's frame, mm, x across and y along."""

    points: FloatArray  # (n, 2); evenly dense, anticlockwise; closed for the distal face only
    normals: FloatArray  # (n, 2); outward, of unit length
    nail: FloatArray  # (n,); how much of the nail's thickness shows, 0 to 1


def pad_arc(face: Face, extent: float) -> tuple[float, float]:
    """Return the first and last parametric angle of a pad's arc of the given extent, radians."""
    if face in ("palmar", "distal"):
        return math.pi / 2 - extent / 2, math.pi / 2 + extent / 2
    # From just past the fingertip round to the pad.
    last = math.pi / 2 + min(math.radians(10), 0.1 * extent)
    return last - extent, last


def finger_shape(
    face: Face,
    semi_axes: tuple[float, float],
    *,
    extent: float,
    departure: float,
    texture: float,
    rng: np.random.Generator,
) -> FingerShape:
    """Return the outline of one face, of semi-axes across and along, mm.

    `extent` is that of the elliptic arc, parametric radians; `departure` the relative change of the curvature
    beyond it, negative blunter; `texture` the standard deviation of the skin's roughness, mm.
    """
    arc = pad_arc(face, extent)
    if face == "distal":
        points, normals, nail = _closed(semi_axes, *arc, departure)
    else:
        points, normals, nail = _open(face, semi_axes, arc, departure, rng)
    rough = _roughness(len(points), rng) * texture
    return FingerShape(points=points + rough[:, None] * normals, normals=normals, nail=nail)


def _open(
    face: Face,
    semi_axes: tuple[float, float],
    arc: tuple[float, float],
    departure: float,
    rng: np.random.Generator,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the outline of a finger that runs out of the frame, from its right side round to its left."""
    first, last = arc
    t = np.linspace(first, last, math.ceil((last - first) * max(semi_axes) / _STEP_MM))
    ellipse = np.stack([semi_axes[0] * np.cos(t), semi_axes[1] * np.sin(t)], axis=-1)
    # Walking clockwise from the first angle, and its mirror image from the last.
    right = _walk(semi_axes, first, departure, rng)
    # The dorsal side is blunter, and so the finger has its thickness.
    other = 0.6 * departure if face == "palmar" else min(0.5 * departure - 0.4, -0.2)
    left = _walk(semi_axes, math.pi - last, other, rng)
    left[:, 0] *= -1
    points = np.concatenate([right[::-1], ellipse[1:-1], left])
    normals = outward_normals(points, closed=False)
    nail = np.zeros(len(points))
    if face != "palmar":
        along = np.arange(len(left), dtype=np.float64) * _STEP_MM
        start, end = 0.25 * semi_axes[1], 0.25 * semi_axes[1] + 9.0
        nail[-len(left) :] = _plateau(along, start, end, 0.4)
    return points, normals, nail


def _walk(semi_axes: tuple[float, float], t: float, departure: float, rng: np.random.Generator) -> FloatArray:
    """Walk clockwise on from an ellipse's point until the heading is the finger's, straight down."""
    a, b = semi_axes
    slope = (a * math.sin(t), -b * math.cos(t))
    curvature = a * b / math.hypot(*slope) ** 3
    heading = math.atan2(slope[1], slope[0])
    final = -math.pi / 2 + math.radians(rng.normal(0, 1.5))
    steps = round(_LENGTH_MM / _STEP_MM)
    headings = np.empty(steps)
    reach = 0.5 * math.sqrt(a * b)
    for k in range(steps):
        headings[k] = heading
        grown = min(1.0, k * _STEP_MM / reach)
        bend = curvature * (1 + departure * grown**2 * (3 - 2 * grown))
        heading -= _STEP_MM * bend * min(1.0, max(-1.0, (heading - final) / _EASE))
    points = np.cumsum(np.stack([np.cos(headings), np.sin(headings)], axis=-1), axis=0) * _STEP_MM
    points += (a * math.cos(t), b * math.sin(t))
    below = -points[:, 1]
    for depth in (1.0 * b + 2 + rng.uniform(0, 2), 1.0 * b + 3.5 + rng.uniform(0, 3)):
        points[:, 0] -= rng.uniform(0.1, 0.35) * np.exp(-0.5 * ((below - depth) / 0.5) ** 2)
    points[:, 0] += rng.uniform(0, 0.6) / (1 + np.exp(-(below - b - 9) / 2))
    return points


def _closed(
    semi_axes: tuple[float, float], first: float, last: float, departure: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the fingertip end on: the palmar arc blended into a flatter dorsal side with the nail."""
    a, b = semi_axes
    t = np.linspace(-math.pi / 2, 1.5 * math.pi, math.ceil(2 * math.pi * a / _STEP_MM), endpoint=False)
    cosine, sine = np.cos(t), np.sin(t)
    wide, high = a * (1 - 0.12 * departure), 0.72 * b
    power = 2 / (2.5 - 0.4 * departure)
    tall = np.where(sine > 0, b * (1 - 0.1 * departure), high)
    x, y = (np.sign(part) * np.abs(part) ** power for part in (cosine, sine))
    other = np.stack([wide * x, tall * y], axis=-1)
    past = np.maximum(np.maximum(first - t, t - last), 0) / math.radians(70)
    share = np.clip(past, 0, 1)
    share = share**3 * (10 - 15 * share + 6 * share**2)
    ellipse = np.stack([a * cosine, b * sine], axis=-1)
    points = _evenly((1 - share)[:, None] * ellipse + share[:, None] * other)
    angle = np.arctan2(points[:, 1] / b, points[:, 0] / a)
    nail = _plateau(angle, -math.pi / 2 - 1.0, -math.pi / 2 + 1.0, 0.15)
    return points, outward_normals(points), nail


def _evenly(points: FloatArray) -> FloatArray:
    """Return a closed curve with points at even distances."""
    loop = np.concatenate([points, points[:1]])
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(loop, axis=0), axis=1))])
    places = np.arange(0, along[-1], _STEP_MM)
    return np.stack([np.interp(places, along, loop[:, k]) for k in (0, 1)], axis=-1)


def _plateau(values: FloatArray, start: float, end: float, ramp: float) -> FloatArray:
    """Return 1 between start and end, 0 outside, with soft ramps."""
    rise = 1 / (1 + np.exp(-np.clip((values - start) / (ramp / 4), -50, 50)))
    fall = 1 / (1 + np.exp(-np.clip((end - values) / (ramp / 4), -50, 50)))
    return np.asarray(rise * fall, dtype=np.float64)


def _roughness(count: int, rng: np.random.Generator) -> FloatArray:
    """Return noise of unit deviation with the period of the skin's ridges."""
    frequency = np.fft.rfftfreq(count, _STEP_MM)
    weight = np.exp(-0.5 * ((frequency - 1 / _TEXTURE_PERIOD_MM) / 0.8) ** 2)
    weight += 0.5 * np.exp(-0.5 * (frequency / 0.8) ** 2)
    noise = np.fft.irfft(np.fft.rfft(rng.normal(0, 1, count)) * weight, count)
    return np.asarray(noise / noise.std(), dtype=np.float64)


def outline_points(
    semi_x: float,
    semi_y: float,
    *,
    count: int = 60,
    arc: tuple[float, float] = (0.0, 2 * math.pi),
    centre: tuple[float, float] = (0.0, 0.0),
    angle: float = 0.0,
    noise_std: float = 0.0,
    seed: int = 0,
) -> FloatArray:
    """Return noisy points (x, y), evenly spaced in the parametric angle, on an arc of an ellipse.

    `arc` is first and last angle, the last left out; `angle` the turn from x towards y, radians.
    """
    check_radians("angle", angle)
    check_radians("arc", arc)
    t = np.linspace(*arc, count, endpoint=False)
    turned = np.stack([semi_x * np.cos(t), semi_y * np.sin(t)], axis=-1) @ rotation(angle).T
    return turned + centre + np.random.default_rng(seed).normal(0, noise_std, turned.shape)
