"""From a contact image to its ridges: polarity, even light, ridge period, ridge mask."""

from dataclasses import dataclass
from typing import TypeAlias

import cv2
import numpy as np
import numpy.typing as npt
from scipy import fft

from fingerpad._arrays import BoolArray

Float32: TypeAlias = npt.NDArray[np.float32]

_BLOCK = 12
_WINDOW = 64
_MOST_WINDOWS = 120
# Periods that a 64 px window shows well at one level of the pyramid, px.
_SHORTEST, _LONGEST = 4.0, 12.0
# A white-noise window puts about this share of its power into one spectral peak.
_LEAST_CONCENTRATION = 0.14
_ROUNDS = 6
# Weight of the whole picture's levels against a window's own, as a share of the window.
_PRIOR = 0.03
# Least rise from valley to ridge, as a share of the picture's contrast.
_LEAST_RISE = 0.3


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
    """

    values: Float32
    noise: float
    contrast: float


def signal_of(values: Float32, *, dark_on_light: bool | None) -> Signal:
    """Turn contact bright, and take the uneven light away by a smooth surface through the quiet ground."""
    means, deviations = _blocks(values)
    quiet = _quiet(deviations)
    if dark_on_light is None:
        dark_on_light = _is_dark_on_light(means, deviations, quiet)
    sign = -1.0 if dark_on_light else 1.0
    ground = _ground(sign * means, quiet, values.shape)
    flat = (sign * values - ground).astype(np.float32)
    noise = float(np.median(deviations[quiet])) if quiet.any() else 0.0
    busy = cv2.resize((~quiet).astype(np.uint8), values.shape[::-1], interpolation=cv2.INTER_NEAREST) > 0
    sample = flat[busy] if busy.any() else flat.ravel()
    threshold = otsu_threshold(sample)
    above, below = sample[sample > threshold], sample[sample <= threshold]
    contrast = float(above.mean() - below.mean()) if above.size and below.size else 0.0
    return Signal(values=flat, noise=noise, contrast=contrast)


def _blocks(values: Float32) -> tuple[Float32, Float32]:
    """Return the mean and standard deviation of small square blocks."""
    rows, columns = (max(1, round(n / _BLOCK)) for n in values.shape)
    mean = cv2.resize(values, (columns, rows), interpolation=cv2.INTER_AREA)
    square = cv2.resize(values * values, (columns, rows), interpolation=cv2.INTER_AREA)
    return _single(mean), _single(np.sqrt(np.maximum(square - mean * mean, 0)))


def _quiet(deviations: Float32) -> BoolArray:
    """Return the blocks without texture: ground, or smooth contact."""
    return np.asarray(deviations <= otsu_threshold(deviations.ravel()))


def _is_dark_on_light(means: Float32, deviations: Float32, quiet: BoolArray) -> bool:
    """Tell the polarity: ridges raise the texture, and their mean differs from the quiet ground's."""
    if quiet.all() or not quiet.any():
        return True
    texture = float(np.average(means[~quiet], weights=deviations[~quiet]))
    return texture < float(np.median(means[quiet]))


def _ground(means: Float32, quiet: BoolArray, shape: tuple[int, ...]) -> Float32:
    """Return a quadratic surface through the lowest quiet blocks, at the size of the picture."""
    rows, columns = means.shape
    y, x = np.meshgrid(np.linspace(-1, 1, rows), np.linspace(-1, 1, columns), indexing="ij")
    terms = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=-1)
    chosen = quiet if np.count_nonzero(quiet) >= 40 else np.ones_like(quiet)
    design, level = terms[chosen], means[chosen].astype(np.float64)
    surface = np.array([np.percentile(level, 20), 0, 0, 0, 0, 0])
    # With little ground to see, a constant is all that can be told.
    for _ in range(8 if quiet.sum() >= 40 else 0):
        off = level - design @ surface
        width = max(2 * float(np.median(np.abs(off))), 1e-6)
        weight = 1 / (1 + (off / width) ** 2) * np.where(off > width, 0.1, 1.0)
        surface = np.linalg.lstsq(design * np.sqrt(weight)[:, None], level * np.sqrt(weight), rcond=None)[0]
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


def ridge_period_px(signal: Float32) -> float:
    """Return the median ridge period, px, NaN where no ridges are found.

    Local spectra of 64 px windows, on the picture and on smaller copies of it; each window votes for its
    strongest ring with the share of its power found there.
    """
    best, best_vote, step = np.nan, 0.0, 1.0
    while min(signal.shape) >= _WINDOW // 2:
        periods, shares = _window_periods(signal)
        clear = shares > _LEAST_CONCENTRATION
        vote = float(shares[clear].sum()) / max(1, shares.size)
        if np.count_nonzero(clear) >= 3 and vote > 1.1 * best_vote:
            best, best_vote = step * _weighted_median(periods[clear], shares[clear]), vote
        signal = _single(cv2.resize(signal, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA))
        step *= 2
    return best


def _window_periods(signal: Float32) -> tuple[Float32, Float32]:
    """Return the ridge period of each of the liveliest windows, and the share of its power in that peak."""
    pad = [max(0, _WINDOW - n) for n in signal.shape]
    padded = np.pad(signal, ((0, pad[0]), (0, pad[1])), mode="reflect") if any(pad) else signal
    windows = np.lib.stride_tricks.sliding_window_view(padded, (_WINDOW, _WINDOW))[
        :: _WINDOW // 2, :: _WINDOW // 2
    ]
    windows = windows.reshape(-1, _WINDOW, _WINDOW)
    variance = windows[:, ::3, ::3].var(axis=(1, 2))
    lively = np.flatnonzero(variance > 0.25 * np.percentile(variance, 95))
    lively = lively[np.argsort(variance[lively])[::-1][:_MOST_WINDOWS]]
    chosen = windows[lively] - windows[lively].mean(axis=(1, 2), keepdims=True)
    taper = np.hanning(_WINDOW).astype(np.float32)
    power = np.abs(fft.rfft2(chosen * np.outer(taper, taper), workers=1)) ** 2
    fy, fx = fft.fftfreq(_WINDOW)[:, None], fft.rfftfreq(_WINDOW)[None, :]
    frequency = np.hypot(fy, fx).astype(np.float32)
    power *= frequency > 1.5 / _WINDOW
    total = power.sum(axis=(1, 2)) + 1e-12
    band = power * ((frequency >= 1 / _LONGEST) & (frequency <= 1 / _SHORTEST))
    peak = band.reshape(len(band), -1).argmax(axis=1)
    row, column = np.unravel_index(peak, power.shape[1:])
    # The edge of a smooth contact has its peak below the band.
    highest = power.max(axis=(1, 2)) <= band.max(axis=(1, 2))
    far = np.hypot(fy - fy[row, 0][:, None, None], fx - fx[0, column][:, None, None])
    near = band * (far < 2.5 / _WINDOW)
    weight = near.sum(axis=(1, 2)) + 1e-12
    periods = weight / ((near * frequency).sum(axis=(1, 2)) + 1e-12)
    return periods.astype(np.float32), (highest * weight / total).astype(np.float32)


def _weighted_median(values: Float32, weights: Float32) -> float:
    order = np.argsort(values)
    total = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(total, total[-1] / 2)])


def ridge_mask(signal: Signal, period: float, fraction: float = 0.5) -> BoolArray:
    """Return the ridges: above `fraction` of the way from the local valley level to the local ridge level.

    The two levels are means over windows of three periods (Ridler & Calvard's two means, made local); where a
    window lacks one, the level of the whole picture stands in.
    """
    smooth = cv2.GaussianBlur(signal.values, (0, 0), max(0.6, 0.09 * period))
    # The levels vary slowly: every few pixels are enough to find them.
    step = max(1, round(period / 5))
    valley, rise = _levels(_single(smooth[::step, ::step]), 3 * period / step, signal.contrast)
    threshold = cv2.resize(valley + fraction * rise, smooth.shape[::-1], interpolation=cv2.INTER_LINEAR)
    return np.asarray(smooth > threshold)


def _levels(smooth: Float32, window: float, contrast: float) -> tuple[Float32, Float32]:
    """Return the local valley level and the local rise from it to the ridges."""
    side = 2 * round(window / 2) + 1
    whole = cv2.blur(smooth, (side, side))
    valley, rise = np.zeros_like(smooth), np.full_like(smooth, contrast)
    for _ in range(_ROUNDS):
        inside = (smooth > valley + 0.5 * rise).astype(np.float32)
        share = cv2.blur(inside, (side, side))
        high_sum = cv2.blur(smooth * inside, (side, side))
        high = (high_sum + _PRIOR * contrast) / (share + _PRIOR)
        valley = _single((whole - high_sum) / (1 - share + _PRIOR))
        rise = _single(np.maximum(high - valley, _LEAST_RISE * contrast))
    return valley, rise


def _single(values: npt.ArrayLike) -> Float32:
    return np.asarray(values, dtype=np.float32)
