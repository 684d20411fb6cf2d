"""From a contact image to how much each place is a ridge: polarity, even light, local levels."""

from dataclasses import dataclass
from typing import TypeAlias

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray

Float32: TypeAlias = npt.NDArray[np.float32]
UInt8: TypeAlias = npt.NDArray[np.uint8]

# Levels are taken every so many pixels.
_LEVEL_STEP = 2
_ROUNDS = 3
# Weight of the whole picture's levels against a window's own, as a share of the window.
_PRIOR = 0.03
# Least rise from valley to ridge, as a share of the picture's contrast.
_LEAST_RISE = 0.3
# Blocks and windows, and the smoothing, in ridge periods.
_BLOCK, _WINDOW, _SMOOTHING = 1.35, 3.0, 0.09
# Fewer quiet blocks than this show a level of the ground, but no slope.
_LEAST_QUIET = 40
# More than this are not needed.
_MOST_QUIET = 300


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Signal:
    """A contact image turned so that contact is bright on an even ground of about zero.

    Attributes
    ----------
    values : ndarray of float32, (rows, columns)
    noise : float
        Standard deviation of the quiet ground.
    contrast : float
        Level of the busy parts' contact above the ground.
    dark_on_light : bool
        Whether contact was darker than the ground.
    """

    values: Float32
    noise: float
    contrast: float
    dark_on_light: bool


def signal_of(values: Float32, inside: BoolArray, period: float, *, dark_on_light: bool | None) -> Signal:
    """Turn contact bright, and take the uneven light away by a smooth surface through the quiet ground."""
    rows, columns = (max(1, round(n / (_BLOCK * period))) for n in values.shape)
    means, deviations = _blocks(values, (rows, columns))
    counted = cv2.resize(inside.astype(np.float32), (columns, rows), interpolation=cv2.INTER_AREA) > 0.99
    if not counted.any():
        counted = np.ones_like(counted)
    limit = otsu_threshold(deviations[counted])
    quiet, busy = counted & (deviations <= limit), counted & (deviations > limit)
    if dark_on_light is None:
        dark_on_light = _is_dark_on_light(means, quiet, busy)
    sign = -1.0 if dark_on_light else 1.0
    flat = sign * values - _ground(sign * means, quiet, values.shape)
    noise = float(np.median(deviations[quiet])) if quiet.any() else 0.0
    everywhere = cv2.resize(busy.astype(np.uint8), values.shape[::-1], interpolation=cv2.INTER_NEAREST) > 0
    sample = flat[::2, ::2][everywhere[::2, ::2]] if busy.any() else flat[::2, ::2].ravel()
    threshold = otsu_threshold(sample)
    above, below = sample[sample > threshold], sample[sample <= threshold]
    contrast = float(above.mean() - below.mean()) if above.size and below.size else 0.0
    return Signal(values=_single(flat), noise=noise, contrast=contrast, dark_on_light=dark_on_light)


def _blocks(values: Float32, shape: tuple[int, int]) -> tuple[Float32, Float32]:
    """Return the mean and standard deviation of small square blocks."""
    mean = cv2.resize(values, shape[::-1], interpolation=cv2.INTER_AREA)
    square = cv2.resize(values * values, shape[::-1], interpolation=cv2.INTER_AREA)
    return _single(mean), _single(np.sqrt(np.maximum(square - mean * mean, 0)))


def _is_dark_on_light(means: Float32, quiet: BoolArray, busy: BoolArray) -> bool:
    """Tell the polarity: ridges raise the texture, and their mean differs from the quiet ground's."""
    if not busy.any() or not quiet.any():
        return True
    return float(means[busy].mean()) < float(np.median(means[quiet]))


def _ground(means: Float32, quiet: BoolArray, shape: tuple[int, ...]) -> Float32:
    """Return a quadratic surface through the lowest quiet blocks, at the size of the picture."""
    rows, columns = means.shape
    y, x = np.meshgrid(np.linspace(-1, 1, rows), np.linspace(-1, 1, columns), indexing="ij")
    terms = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=-1)
    enough = np.count_nonzero(quiet) >= _LEAST_QUIET
    chosen = quiet if enough else np.ones_like(quiet)
    if enough:
        chosen = np.zeros_like(quiet)
        chosen.flat[np.flatnonzero(quiet)[:: max(1, np.count_nonzero(quiet) // _MOST_QUIET)]] = True
    design, level = terms[chosen], means[chosen].astype(np.float64)
    surface = np.array([np.percentile(level, 20), 0, 0, 0, 0, 0])
    # With little ground to see, a constant is all that can be told.
    for _ in range(6 if enough else 0):
        off = level - design @ surface
        width = max(2 * float(np.median(np.abs(off))), 1e-6)
        weight = 1 / (1 + (off / width) ** 2) * np.where(off > width, 0.1, 1.0)
        weighted = design.T * weight
        surface = np.linalg.solve(weighted @ design + 1e-9 * np.eye(6), weighted @ level)
    coarse = (terms @ surface).astype(np.float32)
    return _single(cv2.resize(coarse, shape[::-1], interpolation=cv2.INTER_LINEAR))


def otsu_threshold(values: npt.NDArray[np.floating]) -> float:
    """Return the level that best parts `values` in two classes (Otsu 1979)."""
    low, high = float(values.min()), float(values.max())
    if not high > low:
        return low
    levels = np.rint((values - low) * (255 / (high - low))).astype(np.uint8)
    threshold, _ = cv2.threshold(levels.reshape(1, -1), 0, 255, cv2.THRESH_BINARY | cv2.THRESH_OTSU)
    return low + (float(threshold) + 0.5) * (high - low) / 255


def ridge_amount(signal: Signal, period: float, threshold: float | None) -> tuple[UInt8, Float32]:
    """Return how far each place is from its valley level (0) to its ridge level (255), and the mid level.

    The two levels are means over windows of three periods (Ridler & Calvard's two means, made local); where a
    window lacks one, the level of the whole picture stands in. With a `threshold` the levels are zero and
    twice the threshold everywhere. Half-way, 127.5, parts ridges from valleys.
    """
    smooth = cv2.GaussianBlur(signal.values, (0, 0), max(0.4, _SMOOTHING * period))
    if threshold is not None:
        amount = cv2.convertScaleAbs(np.maximum(smooth, 0), alpha=255 / (2 * threshold))
        return np.asarray(amount, dtype=np.uint8), np.full((1, 1), threshold, dtype=np.float32)
    step = _LEVEL_STEP if period >= 2 * _LEVEL_STEP else 1
    valley, rise = _levels(_single(smooth[::step, ::step]), _WINDOW * period / step, signal.contrast)
    size = smooth.shape[::-1]
    offset = cv2.resize(valley, size, interpolation=cv2.INTER_LINEAR)
    slope = cv2.resize(255 / rise, size, interpolation=cv2.INTER_LINEAR)
    amount = np.multiply(np.subtract(smooth, offset, out=smooth), slope, out=smooth)
    return np.clip(amount, 0, 255, out=amount).astype(np.uint8), _single(valley + rise / 2)


def _levels(smooth: Float32, window: float, contrast: float) -> tuple[Float32, Float32]:
    """Return the local valley level and the local rise from it to the ridges."""
    side = 2 * round(window / 2) + 1
    whole = cv2.blur(smooth, (side, side))
    # Where blur fills the valleys, only the local mean lies between the two levels.
    middle = np.maximum(whole, contrast / 2)
    for _ in range(_ROUNDS):
        inside = (smooth > middle).astype(np.float32)
        share = cv2.blur(inside, (side, side))
        np.multiply(inside, smooth, out=inside)
        high = cv2.blur(inside, (side, side))
        valley = (whole - high) / ((1 + _PRIOR) - share)
        ridge = (high + _PRIOR * contrast) / (share + _PRIOR)
        rise = np.maximum(ridge - valley, _LEAST_RISE * contrast)
        middle = valley + rise / 2
    return _single(valley), _single(rise)


def _single(values: npt.ArrayLike) -> Float32:
    return np.asarray(values, dtype=np.float32)
