"""A sheet of friction ridges, from noise filtered repeatedly along a flow."""

import math
from functools import lru_cache
from typing import Literal, TypeAlias

import cv2
import numpy as np

from fingerpad._arrays import BoolArray, Float32Array, FloatArray, as_float32

Pattern: TypeAlias = Literal["arch", "loop", "whorl"]
Window: TypeAlias = tuple[slice, slice]

# The ridges grow on a grid of their own, so that every resolution shows the same finger.
CELLS_PER_PERIOD = 8.0
_DIRECTIONS = 16
_GENERATIONS = 14
# Cells that a filter reads on each side.
_REACH = int(1.6 * CELLS_PER_PERIOD)


def _flow(pattern: Pattern, along: FloatArray, across: FloatArray, size: float) -> FloatArray:
    """Return the direction of the ridges (Sherlock & Monro's zeros and poles), from across to along."""
    place = (across + 1j * along) / size
    cores = {"arch": [], "loop": [0.02 + 0.1j], "whorl": [0.04 + 0.22j, -0.04 - 0.12j]}[pattern]
    deltas = {"arch": [], "loop": [0.62 - 0.62j], "whorl": [0.7 - 0.6j, -0.7 - 0.62j]}[pattern]
    if pattern == "arch":
        return np.arctan2(-1.4 * place.real * np.exp(-((place.imag + 0.1) ** 2) / 0.5), 1.0)
    turns = [np.angle(place - core) for core in cores] + [-np.angle(place - delta) for delta in deltas]
    return np.asarray(np.sum(turns, axis=0) / 2, dtype=np.float64)


@lru_cache(maxsize=12)
def ridge_sheet(seed: int, pattern: Pattern, half_periods: int) -> tuple[Float32Array, Float32Array]:
    """Grow a square sheet of ridges, crests +1 and valleys −1, and the grain that makes pores and breaks."""
    rng = np.random.default_rng([seed, 7])
    side = int(2 * half_periods * CELLS_PER_PERIOD)
    middle = (side - 1) / 2
    rows, columns = np.indices((side, side), dtype=np.float64)
    direction = _flow(pattern, middle - rows, columns - middle, 17 * CELLS_PER_PERIOD)
    nearest = np.rint(direction / (math.pi / _DIRECTIONS)).astype(int) % _DIRECTIONS
    present = np.unique(nearest).tolist()
    bank = [(_gabor(k * math.pi / _DIRECTIONS), *_windows(nearest == k)) for k in present]
    sheet = rng.normal(0, 1, (side, side)).astype(np.float32)
    grown = np.empty_like(sheet)
    for _ in range(_GENERATIONS):
        for kernel, around, within, box, chosen in bank:
            np.copyto(grown[box], cv2.filter2D(sheet[around], -1, kernel)[within], where=chosen)
        sheet = np.tanh(grown / (0.6 * grown.std())).astype(np.float32)
    grain = cv2.GaussianBlur(rng.normal(0, 1, (side, side)).astype(np.float32), (0, 0), 1.1)
    return as_float32(cv2.GaussianBlur(sheet, (0, 0), 0.8)), as_float32(grain / grain.std())


def _windows(chosen: BoolArray) -> tuple[Window, Window, Window, BoolArray]:
    """Return the window that a filter reads for chosen cells, their box in it and in the sheet, and them."""
    around, within, box = [], [], []
    for axis, side in enumerate(chosen.shape):
        places = np.flatnonzero(chosen.any(axis=1 - axis))
        first, last = int(places[0]), int(places[-1]) + 1
        start = max(first - _REACH, 0)
        around.append(slice(start, min(last + _REACH, side)))
        within.append(slice(first - start, last - start))
        box.append(slice(first, last))
    return (around[0], around[1]), (within[0], within[1]), (box[0], box[1]), chosen[box[0], box[1]]


def _gabor(direction: float) -> Float32Array:
    """Return the zero-mean filter for ridges along `direction` (from right to up)."""
    y, x = np.mgrid[-_REACH : _REACH + 1, -_REACH : _REACH + 1].astype(np.float64)
    off = x * math.sin(direction) + y * math.cos(direction)
    envelope = np.exp(-(x**2 + y**2) / (2 * (0.55 * CELLS_PER_PERIOD) ** 2))
    kernel = envelope * np.cos(2 * math.pi * off / CELLS_PER_PERIOD)
    kernel -= envelope * kernel.sum() / envelope.sum()
    return as_float32(kernel)
