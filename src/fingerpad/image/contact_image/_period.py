"""The ridge period of a picture, from local spectra."""

import math
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
from scipy import fft

from fingerpad._arrays import BoolArray, Float32Array
from fingerpad.image.contact_image._cropping import Pixels

_WINDOW, _HOP = 64, 32
_FEW, _MANY = 12, 48
# Windows are judged by every fourth pixel.
_STRIDE = 4
# Periods that a 64 px window shows well at one level of the pyramid, px.
_SHORTEST, _LONGEST, _MIDDLE = 4.0, 12.0, 7.0
# A white-noise window puts about this share of its power into one spectral peak.
_MIN_CONCENTRATION = 0.14
_TEXTURED = 0.25

# Of the spectrum, only what is no finer than the shortest period.
_COLUMNS = round(_WINDOW / _SHORTEST) + 1
_ROWS = np.r_[0:_COLUMNS, _WINDOW - _COLUMNS + 1 : _WINDOW]
_PLACE = np.add.outer(1j * np.fft.fftfreq(_WINDOW)[_ROWS], np.fft.rfftfreq(_WINDOW)[:_COLUMNS])
_PLACE = _PLACE.ravel().astype(np.complex64)
_FREQUENCY = np.abs(_PLACE)
_BAND = ((_FREQUENCY >= 1 / _LONGEST) & (_FREQUENCY <= 1 / _SHORTEST)).astype(np.float32)
_LOW = (_FREQUENCY <= 1.5 / _WINDOW).astype(np.float32)
_MOMENTS = np.stack([np.ones_like(_FREQUENCY), _FREQUENCY], axis=-1)
_TAPER = np.outer(np.hanning(_WINDOW), np.hanning(_WINDOW)).astype(np.float32)


def ridge_period_px(pixels: Pixels, inside: BoolArray | None, expected: float) -> float:
    """Return the median ridge period, px, NaN where no ridges are found.

    Local spectra of textured 64 px windows, on the picture and on smaller copies of it; each window
    votes for its strongest ring with the share of its power found there. The copies are those that show the
    `expected` period (px) and half and twice as much, or all of them where these show nothing. The best is
    asked again with more windows.
    """
    copies = [(pixels, inside)]
    while min(copies[-1][0].shape) >= _WINDOW:
        copies.append(_halve(*copies[-1]))
    middle = math.floor(math.log2(max(expected / _MIDDLE, 1.0)) + 0.5)
    likely = range(max(0, middle - 1), min(len(copies), middle + 2))
    for levels, count in ((likely, _FEW), (range(len(copies)), _MANY)):
        best, best_vote, windows = 0, 0.0, np.empty(0)
        for level in levels:
            textured = _textured_windows(*copies[level])
            vote = _median_period(_pick_evenly(textured, count))[1]
            if vote > 1.1 * best_vote:
                best, best_vote, windows = level, vote, textured
        if best_vote:
            return 2.0**best * _median_period(windows)[0]
    return math.nan


def _halve(pixels: Pixels, inside: BoolArray | None) -> tuple[Pixels, BoolArray | None]:
    rows, columns = (n // 2 * 2 for n in pixels.shape)
    small = cv2.resize(pixels[:rows, :columns], None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
    return _as_pixels(small), None if inside is None else inside[:rows:2, :columns:2]


def _as_pixels(values: npt.NDArray[Any]) -> Pixels:
    return values if values.dtype == np.uint8 else np.asarray(values, dtype=np.float32)


def _pick_evenly(items: npt.NDArray[Any], count: int) -> npt.NDArray[Any]:
    """Return not more than `count` of the items, evenly picked."""
    return np.asarray(items[np.linspace(0, len(items) - 1, min(count, len(items))).astype(int)])


def _textured_windows(pixels: Pixels, inside: BoolArray | None) -> npt.NDArray[Any]:
    """Return windows of much variance, spread over the picture, (n, 64, 64)."""
    pad = [(0, max(0, _WINDOW - n)) for n in pixels.shape]
    if np.any(pad):
        pixels = _as_pixels(np.pad(pixels, pad, mode="reflect"))
        inside = None if inside is None else np.pad(inside, pad, mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(pixels, (_WINDOW, _WINDOW))[::_HOP, ::_HOP]
    some = tuple(slice(0, n // _HOP * _HOP, _STRIDE) for n in pixels.shape)
    sparse = pixels[some].astype(np.float32)
    mean = _window_means(sparse)
    variance = _window_means(sparse * sparse) - mean * mean
    if inside is not None:
        variance[_window_means(inside[some].astype(np.float32)) < 0.9] = 0
    high = np.sort(variance, axis=None)[int(0.95 * (variance.size - 1))]
    textured = np.argwhere(variance > _TEXTURED * high)
    rows, columns = _pick_evenly(textured if len(textured) else np.zeros((1, 2), dtype=np.intp), _MANY).T
    return np.asarray(windows[rows, columns])


def _window_means(sparse: Float32Array) -> Float32Array:
    """Return the mean of each window, half a window apart, of a picture given by every fourth pixel."""
    side = _HOP // _STRIDE
    rows, columns = (n // side for n in sparse.shape)
    quarters = cv2.resize(sparse, (columns, rows), interpolation=cv2.INTER_AREA)
    return np.asarray(cv2.blur(quarters, (2, 2), anchor=(0, 0))[:-1, :-1], dtype=np.float32)


def _median_period(windows: npt.NDArray[Any]) -> tuple[float, float]:
    """Return the weighted median period of some windows, px, and how clearly they speak for it."""
    periods, shares = _window_periods(windows.astype(np.float32))
    clear = shares > _MIN_CONCENTRATION
    if np.count_nonzero(clear) < 3:
        return math.nan, 0.0
    return _weighted_median(periods[clear], shares[clear]), float(shares[clear].sum()) / shares.size


def _window_periods(windows: Float32Array) -> tuple[Float32Array, Float32Array]:
    """Return the ridge period of each window, and the share of its power in that peak.

    The edge of a smooth contact has its peak below the band: it has no share.
    """
    tapered = (windows - windows.mean(axis=(1, 2), keepdims=True)) * _TAPER
    spectrum = fft.fft(fft.rfft(tapered, axis=2)[:, :, :_COLUMNS], axis=1)[:, _ROWS]
    power = (spectrum.real**2 + spectrum.imag**2).reshape(len(windows), -1)
    # Parseval's theorem gives the power of the half of the spectrum; its first column stands for itself.
    square = np.einsum("ijk,ijk->i", tapered, tapered)
    total = (_WINDOW**2 * square + power[:, ::_COLUMNS].sum(axis=1)) / 2 - power @ _LOW + 1e-12
    power *= 1 - _LOW
    peak = power.argmax(axis=1)
    power *= (np.abs(_PLACE - _PLACE[peak, None]) < 2.5 / _WINDOW) * _BAND
    weight, moment = (power @ _MOMENTS).T + 1e-12
    return weight / moment, _BAND[peak] * weight / total


def _weighted_median(values: Float32Array, weights: Float32Array) -> float:
    order = np.argsort(values)
    total = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(total, total[-1] / 2)])
