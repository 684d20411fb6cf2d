"""Ridges of a contact image: polarity, uneven lighting, local levels."""

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, Float32Array, FloatArray, as_float32
from fingerpad.image._masks import UInt8

_ROUNDS = 3
# Weight of the whole picture's levels against a window's own, as a share of the window.
_PRIOR = 0.03
# Least rise from valley to ridge, as a share of the picture's contrast.
MIN_RISE = 0.3
# Blocks and windows, and the smoothing, in ridge periods.
_BLOCK, _WINDOW, _SMOOTHING = 1.35, 3.0, 0.09
# Fewer quiet blocks than this show a level of the background, but no slope.
_MIN_QUIET = 40
# More than this are not needed.
_MAX_QUIET = 300


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Signal:
    """A contact image turned so that contact is bright on an even background of about zero.

    Attributes
    ----------
    values : ndarray of float32, (rows, columns)
    noise : float
        Standard deviation of the quiet background.
    contrast : float
        Level of the busy parts' contact above the background; the caller's where frames share one.
    dark_on_light : bool
        Whether contact was darker than the background.
    """

    values: Float32Array
    noise: float
    contrast: float
    dark_on_light: bool


def to_signal(
    values: Float32Array,
    inside: BoolArray,
    period: float,
    *,
    dark_on_light: bool | None,
    contrast: float | None,
) -> Signal:
    """Turn contact bright, and remove uneven lighting by a smooth surface through the quiet background."""
    side = max(2, round(_BLOCK * period))
    means = _block_means(values, side)
    deviations = np.sqrt(
        np.maximum(_block_means(as_float32(cv2.multiply(values, values)), side) - means * means, 0)
    )
    # Blocks that reach over the edge do not count.
    whole = np.zeros(means.shape, dtype=bool)
    whole[: values.shape[0] // side, : values.shape[1] // side] = True
    counted = whole if inside.all() else whole & (_block_means(inside * np.uint8(255), side) > 252)
    if not counted.any():
        counted = whole
    limit = otsu_threshold(deviations[counted])
    quiet, busy = counted & (deviations <= limit), counted & (deviations > limit)
    rim = _border_blocks(quiet, values.shape[0] // side, values.shape[1] // side)
    if dark_on_light is None:
        dark_on_light = _is_dark_on_light(means, rim, busy)
    sign = -1.0 if dark_on_light else 1.0
    places = _sample_blocks(quiet)
    flat = sign * values - enlarge(_background_surface(sign * means, places, rim), side, values.shape)
    noise = float(np.median(deviations.flat[places])) if places.size else 0.0
    if contrast is None:
        contrast = _contrast(
            flat, enlarge(as_float32(busy if busy.any() else counted), side, values.shape) > 0.5
        )
    return Signal(values=as_float32(flat), noise=noise, contrast=contrast, dark_on_light=dark_on_light)


def _contrast(flat: Float32Array, busy: BoolArray) -> float:
    """Return how far the contact in the busy places lies above what lies between."""
    sample = flat[::2, ::2][busy[::2, ::2]]
    threshold = otsu_threshold(sample)
    above, below = sample[sample > threshold], sample[sample <= threshold]
    return float(above.mean() - below.mean()) if above.size and below.size else 0.0


def _sample_blocks(quiet: BoolArray) -> npt.NDArray[np.intp]:
    """Return where some hundred quiet blocks are, as indices of the flat array."""
    places = np.flatnonzero(quiet)
    return places[:: max(1, places.size // _MAX_QUIET)]


def _block_means(values: Float32Array | UInt8, side: int) -> Float32Array:
    """Return the means of square blocks; the last in a row or column may reach over the edge, mirrored."""
    over = [-n % side for n in values.shape]
    whole = cv2.copyMakeBorder(values, 0, over[0], 0, over[1], cv2.BORDER_REFLECT) if any(over) else values
    rows, columns = (n // side for n in whole.shape)
    return as_float32(cv2.resize(whole, (columns, rows), interpolation=cv2.INTER_AREA))


def enlarge(
    few: Float32Array, every: int, shape: tuple[int, ...], interpolation: int = cv2.INTER_LINEAR
) -> Float32Array:
    """Return values given at every so many pixels at each pixel of an image of this shape."""
    size = (few.shape[1] * every, few.shape[0] * every)
    return as_float32(cv2.resize(few, size, interpolation=interpolation))[: shape[0], : shape[1]]


def _border_blocks(quiet: BoolArray, rows: int, columns: int) -> BoolArray:
    """Return the quiet blocks that are background for sure: those at the rim of the picture's whole blocks.

    A smooth contact is quiet too.
    """
    rim = quiet.copy()
    rim[1 : rows - 1, 1 : columns - 1] = False
    return rim if rim.any() else quiet


def _is_dark_on_light(means: Float32Array, ground: BoolArray, busy: BoolArray) -> bool:
    """Return the polarity: ridges raise the texture, and their mean differs from the quiet background's."""
    if not busy.any() or not ground.any():
        return True
    return float(means[busy].mean()) < float(np.median(means[ground]))


def _background_surface(means: Float32Array, quiet: npt.NDArray[np.intp], rim: BoolArray) -> Float32Array:
    """Return a quadratic surface through the lowest quiet blocks, and as near as those at the rim lie."""
    y, x = (np.linspace(-1, 1, n) for n in means.shape)
    if quiet.size < _MIN_QUIET:
        # With few background blocks only a constant can be estimated.
        return np.full_like(means, np.percentile(means, 20))
    places = np.union1d(quiet, np.flatnonzero(rim))
    at_rim = rim.flat[places]
    rows, columns = np.unravel_index(places, means.shape)
    design = np.stack(_quadratic_terms(y[rows], x[columns]), axis=-1)
    level = means[rows, columns].astype(np.float64)
    surface = np.array([np.percentile(level, 20), 0, 0, 0, 0, 0])
    for _ in range(6):
        off = level - design @ surface
        width = max(2 * float(np.median(np.abs(off[at_rim]))), 1e-6)
        weight = 1 / (1 + (off / width) ** 2) * np.where(off > width, 0.1, 1.0)
        weighted = design.T * weight
        surface = np.linalg.solve(weighted @ design + 1e-9 * np.eye(6), weighted @ level)
    return as_float32(sum(map(np.multiply, surface, _quadratic_terms(y[:, None], x))))


def _quadratic_terms(y: FloatArray, x: FloatArray) -> list[FloatArray]:
    return [np.ones(np.broadcast_shapes(y.shape, x.shape)), x, y, x * x, x * y, y * y]


def otsu_threshold(values: npt.NDArray[np.floating]) -> float:
    """Return the level that best parts `values` in two classes (Otsu 1979)."""
    low, high = float(values.min()), float(values.max())
    if not high > low:
        return low
    levels = np.rint((values - low) * (255 / (high - low))).astype(np.uint8)
    threshold, _ = cv2.threshold(levels.reshape(1, -1), 0, 255, cv2.THRESH_BINARY | cv2.THRESH_OTSU)
    return low + (float(threshold) + 0.5) * (high - low) / 255


def ridge_amount(
    values: Float32Array, contrast: float, period: float, threshold: float | None, *, step: int
) -> tuple[UInt8, Float32Array]:
    """Return how far each place is from its valley level (0) to its ridge level (255), and the mid level.

    The two levels are means over windows of three periods (Ridler & Calvard's two means, made local), taken
    at every `step`-th pixel; where a window lacks one, the level of the whole picture stands in. With a
    `threshold` the levels are zero and twice the threshold everywhere. Half-way, 127.5, parts ridges from
    valleys.
    """
    if threshold is not None:
        amount = cv2.convertScaleAbs(np.maximum(values, 0), alpha=255 / (2 * threshold))
        return np.asarray(amount, dtype=np.uint8), np.full((1, 1), threshold, dtype=np.float32)
    side = max(1, round(_WINDOW * period / step / 3))
    valley, rise = _levels(np.ascontiguousarray(values[::step, ::step]), side, contrast)
    above = np.subtract(values, enlarge(valley, side * step, values.shape))
    amount = cv2.multiply(above, enlarge(as_float32(255 / rise), side * step, values.shape), dtype=cv2.CV_8U)
    return np.asarray(amount, dtype=np.uint8), as_float32(valley + rise / 2)


def smoothed(values: Float32Array, period: float) -> Float32Array:
    """Return values without noise much finer than a ridge."""
    return as_float32(cv2.GaussianBlur(values, (0, 0), max(0.4, _SMOOTHING * period)))


def _levels(smooth: Float32Array, side: int, contrast: float) -> tuple[Float32Array, Float32Array]:
    """Return the local valley level and the local rise from it to the ridges, by blocks of a side.

    A window is three blocks wide.
    """
    whole = _window_means(smooth, side)
    # Where blur fills the valleys, only the local mean lies between the two levels.
    middle = np.maximum(whole, contrast / 2)
    for _ in range(_ROUNDS):
        inside = as_float32(smooth > enlarge(middle, side, smooth.shape))
        share = _window_means(inside, side)
        high = _window_means(np.multiply(inside, smooth, out=inside), side)
        valley = (whole - high) / ((1 + _PRIOR) - share)
        ridge = (high + _PRIOR * contrast) / (share + _PRIOR)
        rise = np.maximum(ridge - valley, MIN_RISE * contrast)
        middle = valley + rise / 2
    return as_float32(valley), as_float32(rise)


def _window_means(values: Float32Array, side: int) -> Float32Array:
    return as_float32(cv2.blur(_block_means(values, side), (3, 3)))
