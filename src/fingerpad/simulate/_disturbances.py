"""Disturbances of a contact image that keep the contact: creases, and smears of ink or moisture."""

import math

import cv2
import numpy as np

from fingerpad._arrays import BoolArray, Float32Array, FloatArray


def creases(along: FloatArray, across: FloatArray, semi_minor: float, count: int, seed: int) -> BoolArray:
    """Return where fine lines of 0.1 to 0.3 mm keep the skin off."""
    lines = np.zeros(along.shape, dtype=bool)
    rng = np.random.default_rng([seed, 5])
    for _ in range(count):
        angle, off, width = (
            rng.uniform(0, math.pi),
            rng.uniform(-0.7, 0.7) * semi_minor,
            rng.uniform(0.1, 0.3),
        )
        lines |= np.abs(along * math.sin(angle) + across * math.cos(angle) - off) < width / 2
    return lines


def smudge(
    amount: Float32Array,
    inside: BoolArray,
    places: tuple[FloatArray, FloatArray],
    semi_axes: tuple[float, float],
    *,
    count: int,
    seed: int,
) -> Float32Array:
    """Smear ridges into one another within parts of the contact, 1.5 to 3 mm in radius.

    Each smear is a Gaussian of 0.25 to 0.5 mm along the slide and 0.1 to 0.25 mm across it; nothing is
    carried over the edge of the contact. `places` are the distances (along, across) of each pixel from the
    centre, mm.
    """
    along, across = places
    mm_per_px = math.hypot(along[0, 0] - along[1, 0], across[0, 0] - across[1, 0])
    rng = np.random.default_rng([seed, 9])
    for _ in range(count):
        slide, width = rng.uniform(0.25, 0.5), rng.uniform(0.1, 0.25)
        kernel = _gaussian(slide / mm_per_px, width / mm_per_px, rng.uniform(0, math.pi))
        carried, room = (cv2.filter2D(layer, -1, kernel) for layer in (amount, inside.astype(np.float32)))
        smear = np.where(inside, carried / np.maximum(room, 1e-6), 0)
        off = [
            place - rng.uniform(-0.8, 0.8) * semi_axis
            for place, semi_axis in zip(places, semi_axes, strict=True)
        ]
        weight = np.exp(-((np.hypot(*off) / rng.uniform(1.5, 3.0)) ** 4))
        amount = np.asarray(amount + weight * (smear - amount), dtype=np.float32)
    return amount


def _gaussian(long: float, short: float, angle: float) -> Float32Array:
    """Return an elongated Gaussian kernel of unit sum, in px."""
    reach = math.ceil(3 * long)
    y, x = np.mgrid[-reach : reach + 1, -reach : reach + 1]
    forth, aside = x * math.cos(angle) + y * math.sin(angle), y * math.cos(angle) - x * math.sin(angle)
    kernel = np.exp(-((forth / long) ** 2 + (aside / short) ** 2) / 2)
    return np.asarray(kernel / kernel.sum(), dtype=np.float32)
