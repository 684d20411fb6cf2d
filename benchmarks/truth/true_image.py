"""What images of contacts of known truth have in common."""

import zlib
from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np

from benchmarks.arrays import Array, Pixels, Range, Rng


@dataclass(frozen=True, eq=False)
class TrueImage:
    """Contact image with its true gross area and ridge area, mm², and semi-axes, mm."""

    pixels: Array
    mm_per_px: float
    gross_area: float
    ridge_area: float
    semi_axes: tuple[float, float]


def named_rng(seed: int, name: str, number: int) -> Rng:
    """Return random numbers that depend on nothing else."""
    return np.random.default_rng([seed, zlib.crc32(name.encode()), number])


def eight_bit(grey: Array, jpeg_quality: int = 0) -> Pixels:
    """Round a picture from 0 to 1 to grey levels, and compress it by JPEG unless its quality is 0."""
    pixels = np.asarray(np.rint(255 * np.clip(grey, 0, 1)), np.uint8)
    return jpeg(pixels, jpeg_quality) if jpeg_quality else pixels


def jpeg(pixels: Pixels, quality: int) -> Pixels:
    """Compress a picture, grey or in the order of OpenCV's colours."""
    _, encoded = cv2.imencode(".jpg", pixels, [cv2.IMWRITE_JPEG_QUALITY, quality])
    return np.asarray(cv2.imdecode(encoded, cv2.IMREAD_UNCHANGED), np.uint8)


def smooth_noise(
    rng: Rng, shape: tuple[int, ...], length: float, knots: Callable[[float], int], per_length: float = 3.0
) -> Array:
    """Return noise of unit variance, smooth over a length in samples, drawn at fewer knots and enlarged."""
    coarse = max(length / per_length, 1.0)
    white = rng.normal(size=[knots(n / coarse) for n in shape]).astype(np.float32)
    noise = cv2.GaussianBlur(white, (0, 0), length / coarse)
    enlarged = cv2.resize(noise / noise.std(), None, fx=coarse, fy=coarse, interpolation=cv2.INTER_CUBIC)
    return np.asarray(enlarged[: shape[0], : shape[1]])


def holes(
    rng: Rng, crests: Array, step: float, pores: float, *, creases: Callable[[], int], **mm: Range
) -> Array:
    """Return where pores open on crests, so many per period along a ridge, and creases cross the skin.

    In mm are given the radius of pores, and length and width of creases.
    """
    drawn = np.zeros(crests.shape, np.uint8)
    tops = np.argwhere(crests)
    count = rng.poisson(pores * crests.size * step**2 / 0.48**2)
    for row, column in tops[rng.integers(len(tops), size=count)]:
        cv2.circle(drawn, (int(column), int(row)), max(1, round(rng.uniform(*mm["radius"]) / step)), 1, -1)
    for _ in range(creases()):
        start, angle = rng.uniform(0.3, 0.7, 2) * crests.shape[::-1], rng.uniform(0, np.pi)
        end = start + rng.uniform(*mm["length"]) / step * np.array([np.cos(angle), np.sin(angle)])
        wide = max(1, round(rng.uniform(*mm["width"]) / step))
        cv2.line(drawn, start.astype(int).tolist(), end.astype(int).tolist(), 1, wide)
    return drawn > 0


def equal_ellipse(radius: Array) -> Range:
    """Return semi-axes of the ellipse of equal area and of the same shape of second moments.

    The region is given by radii about a point inside, at even angles.
    """
    angle = 2 * np.pi * np.arange(len(radius)) / len(radius)
    c, s, w = np.cos(angle), np.sin(angle), radius
    area = np.mean(w**2) * np.pi
    mean = 2 * np.pi / 3 * np.array([np.mean(w**3 * c), np.mean(w**3 * s)]) / area
    mixed = np.mean(w**4 * c * s)
    second = np.array([[np.mean(w**4 * c * c), mixed], [mixed, np.mean(w**4 * s * s)]])
    minor, major = np.sqrt(np.linalg.eigvalsh(np.pi / 2 * second / area - np.outer(mean, mean)))
    scale = np.sqrt(area / (np.pi * minor * major))
    return float(major * scale), float(minor * scale)
