"""The ridge period of a picture, from local spectra."""

import math
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray

_WINDOW = 64
_FEW, _MANY = 12, 48
# Windows are judged by every fourth pixel.
_STRIDE = 4
# Periods that a 64 px window shows well at one level of the pyramid, px.
_SHORTEST, _LONGEST, _MIDDLE = 4.0, 12.0, 7.0
# A white-noise window puts about this share of its power into one spectral peak.
_LEAST_CONCENTRATION = 0.14
_LIVELY = 0.25

# Of the spectrum, only what is no finer than the shortest period.
_COLUMNS = round(_WINDOW / _SHORTEST) + 1
_ROWS = np.r_[0:_COLUMNS, _WINDOW - _COLUMNS + 1 : _WINDOW]
_FY = np.fft.fftfreq(_WINDOW)[_ROWS, None].astype(np.float32)
_FX = np.fft.rfftfreq(_WINDOW)[None, :_COLUMNS].astype(np.float32)
_FREQUENCY = np.hypot(_FY, _FX)
_BAND = ((_FREQUENCY >= 1 / _LONGEST) & (_FREQUENCY <= 1 / _SHORTEST)).astype(np.float32)
_LOW = (_FREQUENCY <= 1.5 / _WINDOW).astype(np.float32)
_TAPER = np.outer(np.hanning(_WINDOW), np.hanning(_WINDOW)).astype(np.float32)

_Float32 = npt.NDArray[np.float32]
_Pixels = npt.NDArray[np.uint8] | npt.NDArray[np.float32]


def ridge_period_px(pixels: _Pixels, inside: BoolArray | None, expected: float) -> float:
    """Return the median ridge period, px, NaN where no ridges are found.

    Local spectra of lively 64 px windows, on the picture and on smaller copies of it; each window
    votes for its strongest ring with the share of its power found there. The copies are those that show the
    `expected` period (px) and half and twice as much, or all of them where these show nothing. The best is
    asked again with more windows.
    """
    copies = [(pixels, inside)]
    while min(copies[-1][0].shape) >= _WINDOW:
        copies.append(_halved(*copies[-1]))
    middle = math.floor(math.log2(max(expected / _MIDDLE, 1.0)) + 0.5)
    likely = range(max(0, middle - 1), min(len(copies), middle + 2))
    for levels, count in ((likely, _FEW), (range(len(copies)), _MANY)):
        best, best_vote = 0, 0.0
        for level in levels:
            vote = _median_period(*copies[level], count)[1]
            if vote > 1.1 * best_vote:
                best, best_vote = level, vote
        if best_vote:
            return 2.0**best * _median_period(*copies[best], _MANY)[0]
    return math.nan


def _halved(pixels: _Pixels, inside: BoolArray | None) -> tuple[_Pixels, BoolArray | None]:
    rows, columns = (n // 2 * 2 for n in pixels.shape)
    small = cv2.resize(pixels[:rows, :columns], None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
    return _as_pixels(small), None if inside is None else inside[:rows:2, :columns:2]


def _as_pixels(values: npt.NDArray[Any]) -> _Pixels:
    return values if values.dtype == np.uint8 else np.asarray(values, dtype=np.float32)


def _median_period(pixels: _Pixels, inside: BoolArray | None, count: int) -> tuple[float, float]:
    """Return the weighted median period of some lively windows, px, and how clearly they speak for it."""
    periods, shares = _window_periods(_lively_windows(pixels, inside, count))
    clear = shares > _LEAST_CONCENTRATION
    if np.count_nonzero(clear) < 3:
        return math.nan, 0.0
    return _weighted_median(periods[clear], shares[clear]), float(shares[clear].sum()) / shares.size


def _lively_windows(pixels: _Pixels, inside: BoolArray | None, count: int) -> _Float32:
    """Return windows of much variance, spread over the picture, (n, 64, 64)."""
    pad = [max(0, _WINDOW - n) for n in pixels.shape]
    if any(pad):
        pixels = _as_pixels(np.pad(pixels, ((0, pad[0]), (0, pad[1])), mode="reflect"))
        inside = None if inside is None else np.pad(inside, ((0, pad[0]), (0, pad[1])), mode="edge")
    sparse = pixels[::_STRIDE, ::_STRIDE].astype(np.float32)
    side, hop = _WINDOW // _STRIDE, _WINDOW // _STRIDE // 2
    # The box filter centred on each window's middle sees just that window.
    first, last = side // 2, [n - side - side // 2 + side // 2 * 2 for n in sparse.shape]
    places = tuple(slice(first, end + 1, hop) for end in last)
    mean = cv2.blur(sparse, (side, side))[places]
    variance = cv2.blur(sparse * sparse, (side, side))[places] - mean * mean
    if inside is not None:
        whole = cv2.blur(inside[::_STRIDE, ::_STRIDE].astype(np.float32), (side, side))[places]
        variance = np.where(whole > 0.9, variance, 0)
    lively = np.argwhere(variance > _LIVELY * np.percentile(variance, 95)) * (hop * _STRIDE)
    if not len(lively):
        lively = np.zeros((1, 2), dtype=np.intp)
    chosen = lively[np.linspace(0, len(lively) - 1, min(count, len(lively))).astype(int)]
    chosen = np.minimum(chosen, np.subtract(pixels.shape, _WINDOW))
    return np.stack([pixels[r : r + _WINDOW, c : c + _WINDOW] for r, c in chosen]).astype(np.float32)


def _window_periods(windows: _Float32) -> tuple[_Float32, _Float32]:
    """Return the ridge period of each window, and the share of its power in that peak."""
    level = windows.mean(axis=(1, 2), keepdims=True)
    tapered = (windows - level) * _TAPER
    spectrum = np.fft.fft(np.fft.rfft(tapered, axis=2)[:, :, :_COLUMNS], axis=1)[:, _ROWS]
    power = spectrum.real**2 + spectrum.imag**2
    low = (power * _LOW).sum(axis=(1, 2))
    # Parseval's theorem gives the power of the half of the spectrum; its first column stands for itself.
    square = np.einsum("ijk,ijk->i", tapered, tapered)
    total = (_WINDOW**2 * square + power[:, :, 0].sum(axis=1)) / 2 - low + 1e-12
    power *= 1 - _LOW
    band = power * _BAND
    peak = band.reshape(len(band), -1).argmax(axis=1)
    row, column = np.unravel_index(peak, band.shape[1:])
    # The edge of a smooth contact has its peak below the band.
    highest = power.max(axis=(1, 2)) <= band.max(axis=(1, 2))
    far = (_FY - _FY[row, 0][:, None, None]) ** 2 + (_FX - _FX[0, column][:, None, None]) ** 2
    near = band * (far < (2.5 / _WINDOW) ** 2)
    weight = near.sum(axis=(1, 2)) + 1e-12
    periods = weight / ((near * _FREQUENCY).sum(axis=(1, 2)) + 1e-12)
    return periods.astype(np.float32), (highest * weight / total).astype(np.float32)


def _weighted_median(values: _Float32, weights: _Float32) -> float:
    order = np.argsort(values)
    total = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(total, total[-1] / 2)])
