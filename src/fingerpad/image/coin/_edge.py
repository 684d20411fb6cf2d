"""The edge of a disc on the full picture: where it is, what of it is another's, and what lies beside it."""

import math

import cv2
import numpy as np

from fingerpad._arrays import BoolArray, Float32Array, FloatArray, as_float_array
from fingerpad.image.coin._disc import Rim, parabolic_peak
from fingerpad.image.ellipse_fit import EllipseFit, fit_ellipse

_PROFILE_STEP = 0.25
_STEEP, _CLIMB = 0.3, 6
_SHADOW_SECTORS = 36


def edge_points(smooth: Float32Array, rim: Rim, reach: float) -> tuple[FloatArray, BoolArray]:
    """Return the steepest place across the rim on each of many normals, and where there is a steep one."""
    count = int(np.clip(2 * math.pi * rim.size / 2, 120, 1440))
    t = as_float_array(np.arange(count) * (2 * math.pi / count))
    x, y, normal_x, normal_y = rim.points(t)
    out = np.arange(-reach, reach + _PROFILE_STEP / 2, _PROFILE_STEP)
    profile = cv2.remap(
        smooth,
        (x[:, None] + out * normal_x[:, None]).astype(np.float32),
        (y[:, None] + out * normal_y[:, None]).astype(np.float32),
        cv2.INTER_CUBIC,
        borderMode=cv2.BORDER_REPLICATE,
    )
    slope = np.abs(np.gradient(profile, axis=1))
    # Of several edges a steep one near the rim: one far from it may be the shadow's.
    likely = slope * np.exp(-2 * (out / reach) ** 2)
    at = np.clip(likely.argmax(axis=1), 1, out.size - 2)
    every = np.arange(count)
    for _ in range(_CLIMB):
        uphill = slope[every[:, None], at[:, None] + np.array([-1, 0, 1])].argmax(axis=1) - 1
        at = np.clip(at + uphill, 1, out.size - 2)
    place = out[at] + _PROFILE_STEP * parabolic_peak(*(slope[every, at + k] for k in (-1, 0, 1)))
    steep = slope[every, at]
    summit = (steep >= slope[every, at - 1]) & (steep >= slope[every, at + 1])
    found = summit & (steep > _STEEP * np.median(steep))
    return np.stack([x + place * normal_x, y + place * normal_y], axis=-1), np.asarray(found)


def without_outliers(points: FloatArray, found: BoolArray) -> tuple[EllipseFit, BoolArray]:
    """Fit an ellipse, and again without the points far from it."""
    kept = found
    fit = fit_ellipse(points[kept])
    for _ in range(3):
        off = np.abs(offsets_from(points, rim_of(fit)))
        spread = 1.4826 * float(np.median(off[kept]))
        kept = found & (off < max(3 * spread, 0.15))
        fit = fit_ellipse(points[kept])
    return fit, np.asarray(kept)


def offsets_from(points: FloatArray, rim: Rim) -> FloatArray:
    """Return the distances of points outside an ellipse, to first order."""
    u, v = rim.frame(points[:, 0], points[:, 1])
    distance = np.hypot(u, v)
    gradient = np.hypot(u / rim.first, v / rim.second) / distance
    return np.asarray((distance - 1) / gradient, dtype=np.float64)


def rim_of(fit: EllipseFit) -> Rim:
    return Rim(float(fit.centre[0]), float(fit.centre[1]), fit.semi_major, fit.semi_minor, fit.angle)


def correlation_length(offsets: FloatArray, kept: BoolArray) -> float:
    """Return how many neighbours along the edge share one error: the sum of their correlations."""
    values = np.where(kept, offsets, 0.0)
    power = np.abs(np.fft.fft(values)) ** 2
    pairs = np.fft.ifft(np.abs(np.fft.fft(kept.astype(float))) ** 2).real
    correlation = np.fft.ifft(power).real / np.maximum(pairs, 1)
    correlation = correlation[1 : kept.size // 8] / max(correlation[0], 1e-30)
    negative = np.flatnonzero(correlation <= 0.05)
    return float(1 + 2 * correlation[: negative[0] if negative.size else correlation.size].sum())


def shadow_beside(smooth: Float32Array, rim: Rim) -> float:
    """Return how far the level beside the rim is from the ground's further out, over the contrast."""
    t = as_float_array(np.arange(_SHADOW_SECTORS * 8) * (2 * math.pi / (_SHADOW_SECTORS * 8)))
    levels = []
    for factor in (0.97, 1.03, 1.05, 1.3):
        x, y, _, _ = rim.scaled(factor).points(t)
        ring = cv2.remap(
            smooth,
            x.astype(np.float32),
            y.astype(np.float32),
            cv2.INTER_LINEAR,
            borderMode=cv2.BORDER_REPLICATE,
        )
        levels.append(np.median(ring.reshape(_SHADOW_SECTORS, 8), axis=1))
    coin, near, beside, ground = levels
    contrast = max(float(np.median(np.abs(ground - coin))), 1e-6)
    depth = np.maximum(np.abs(ground - near), np.abs(ground - beside))
    return float(np.max(depth)) / contrast
