"""Local spectra of a picture: the ridge period, and whether its lines are the ridges of a finger.

Both look at square windows under a taper, and at the strongest peak of each. The period is asked of the
picture and of smaller copies of it, in windows of 64 px, without a scale; whether there are ridges in windows
of 2.9 mm that go with their neighbours.
"""

import math
from typing import Any, Final, NamedTuple, TypeAlias

import cv2
import numpy as np
import numpy.typing as npt
from scipy import fft

from fingerpad._arrays import BoolArray, Float32Array, FloatArray, as_float32
from fingerpad.image._masks import filled_polygon
from fingerpad.image.contact_image.background import block_means
from fingerpad.image.scale import WINDOW_RIDGE_PERIOD_MM

Pixels: TypeAlias = npt.NDArray[np.uint8] | npt.NDArray[np.float32]
Whole: TypeAlias = npt.NDArray[np.intp]

# The period.
_WINDOW: Final = 64  # px; side of the windows
_HOP: Final = 32  # px from one to the next
_FEW: Final = 12  # so many are asked first
_MANY: Final = 48  # and last
_STRIDE: Final = 4  # windows are judged by every fourth pixel
# Periods that a window shows well at one level of the pyramid, px.
_SHORTEST: Final = 4.0
_LONGEST: Final = 12.0
_MIDDLE: Final = 7.0
_LIGHT_BINS: Final = 1.5  # about the mean, which hold light and edges
_PEAK_BINS: Final = 2.5  # over which a peak spreads
_MIN_CONCENTRATION: Final = 0.14  # about the share of its power that white noise puts into one peak
_TEXTURED: Final = 0.25  # share of the variance of the most varied windows from which one is textured
_CLEARER: Final = 1.1  # by this factor a copy speaks more clearly than a finer one, to be taken
_CLEAR: Final = 0.3  # one that is clear spares coarser ones

# Of the spectrum, only what is no finer than the shortest period.
_COLUMNS = round(_WINDOW / _SHORTEST) + 1
_ROWS = np.r_[0:_COLUMNS, _WINDOW - _COLUMNS + 1 : _WINDOW]
_PLACE = np.add.outer(1j * np.fft.fftfreq(_WINDOW)[_ROWS], np.fft.rfftfreq(_WINDOW)[:_COLUMNS])
_PLACE = _PLACE.ravel().astype(np.complex64)
_FREQUENCY = np.abs(_PLACE)
_BAND = ((_FREQUENCY >= 1 / _LONGEST) & (_FREQUENCY <= 1 / _SHORTEST)).astype(np.float32)
_LOW = (_FREQUENCY <= _LIGHT_BINS / _WINDOW).astype(np.float32)
_MOMENTS = np.stack([np.ones_like(_FREQUENCY), _FREQUENCY], axis=-1)
_WINDOW_TAPER = np.outer(np.hanning(_WINDOW), np.hanning(_WINDOW)).astype(np.float32)
# Which places of the band belong to a peak at each place.
_PEAKS = (np.abs(_PLACE - _PLACE[:, None]) < _PEAK_BINS / _WINDOW) * _BAND

# Whether there are ridges.
_PITCH_MM: Final = 0.09  # of the copy that is looked at
_COARSEST_MM: Final = 0.12  # a coarser picture cannot show ridges
_SIDE: Final = 32  # px; side of the windows
_STEP: Final = 16  # px from one to the next
_ENOUGH: Final = 40  # fewer windows than this are taken at half that distance
_LOWEST: Final = 1.5  # bin below which edges and shading lie
_SPREAD: Final = 2.1  # bins over which a peak spreads
_MIN_SHARE: Final = 0.25  # of a window's power in its peak
_MIN_RIDGED: Final = 0.25  # share of such windows among those that a contact fills
_BENT: Final = 0.6  # neighbours' wave vectors differ by less than this share
# Lines more alike than these in direction and spacing are print or a grating. Ruled lines seen at a slant
# have 0.999 and 0.01 to 0.03, ridges that hardly bend up to 0.996, real prints at most 0.90 and from 0.09.
_PARALLEL: Final = 0.998
_EVEN: Final = 0.03
_TELLING_MM2: Final = 13.0  # less than this tells nothing
_BUSY_SHARE: Final = 0.08  # of the picture's range; without a scale windows of more deviation are judged
_BUSY_LEVELS: Final = 0.7  # as long as it is so many levels
_FEWEST: Final = 6

# Half of the spectrum, by the bins from the mean; its first and last column stand for themselves.
_BINS = np.add.outer(1j * fft.fftfreq(_SIDE), fft.rfftfreq(_SIDE)).ravel() * _SIDE
_BINS = _BINS.astype(np.complex64)
_TWICE = as_float32(np.where(np.isin(_BINS.real, (0, _SIDE / 2)), 1.0, 2.0))
_COUNTED = as_float32(np.abs(_BINS) >= _LOWEST)
_TAPER = as_float32(np.outer(*[np.hanning(_SIDE + 2)[1:-1]] * 2))
# The few bins that belong to a peak at each bin, or to its mirror image, and their wave vectors turned the
# peak's way; bins that only fill the table count nothing.
_NEAR = np.abs(_BINS - _BINS[:, None]) < _SPREAD
_IN_PEAK = _NEAR | (np.abs(_BINS + _BINS[:, None]) < _SPREAD)
_MEMBERS = np.argsort(~_IN_PEAK, axis=1, kind="stable")[:, : _IN_PEAK.sum(axis=1).max()]
_COUNTS = as_float32(np.take_along_axis(_IN_PEAK, _MEMBERS, axis=1) * _TWICE[_MEMBERS])
_TURNED = np.where(np.take_along_axis(_NEAR, _MEMBERS, axis=1), _BINS[_MEMBERS], -_BINS[_MEMBERS])


def ridge_period_px(pixels: Pixels, inside: BoolArray | None, expected: float) -> float:
    """Return the median ridge period, px, NaN where no ridges are found.

    Windows of 64 px, on copies that show the `expected` period, half or twice that, or else on all, vote
    for the strongest ring of their spectrum with the share of power there. Coarser copies than the expected
    one are asked only where it is not clear.
    """
    copies: list[tuple[npt.NDArray[Any], BoolArray | None]] = [(pixels, inside)]
    while min(copies[-1][0].shape) >= _WINDOW:
        fine, where = copies[-1]
        rows, columns = (n // 2 * 2 for n in fine.shape)
        small = cv2.resize(fine[:rows, :columns], None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
        copies.append((small, None if where is None else where[:rows:2, :columns:2]))
    middle = math.floor(math.log2(max(expected / _MIDDLE, 1.0)) + 0.5)
    likely = range(max(0, middle - 1), min(len(copies), middle + 2))
    for levels, count in ((likely, _FEW), (range(len(copies)), _MANY)):
        best, best_vote, rest, found = 0, 0.0, np.empty(0), (np.empty(0), np.empty(0))
        for level in levels:
            windows = _textured_windows(*copies[level])
            few = _pick_evenly(np.arange(len(windows)), count)
            periods, shares = _window_periods(windows[few])
            vote = _median_period(periods, shares)[1]
            if vote > _CLEARER * best_vote:
                best, best_vote, rest, found = level, vote, np.delete(windows, few, axis=0), (periods, shares)
            if best_vote > _CLEAR and level >= middle:
                break
        if best_vote:
            more = _window_periods(rest)
            return 2.0**best * _median_period(*map(np.append, found, more))[0]
    return math.nan


def _pick_evenly(items: npt.NDArray[Any], count: int) -> npt.NDArray[Any]:
    """Return not more than `count` of the items, evenly picked."""
    return np.asarray(items[np.linspace(0, len(items) - 1, min(count, len(items))).astype(int)])


def _textured_windows(pixels: npt.NDArray[Any], inside: BoolArray | None) -> npt.NDArray[Any]:
    """Return windows of much variance, spread over the picture, (n, 64, 64)."""
    pad = [(0, max(0, _WINDOW - n)) for n in pixels.shape]
    if np.any(pad):
        pixels = np.pad(pixels, pad, mode="reflect")
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
    quarters = block_means(sparse, _HOP // _STRIDE)
    return as_float32(cv2.blur(quarters, (2, 2), anchor=(0, 0)))[:-1, :-1]


def _median_period(periods: FloatArray, shares: FloatArray) -> tuple[float, float]:
    """Return the weighted median period of some windows, px, and how clearly they speak for it."""
    clear = shares > _MIN_CONCENTRATION
    if np.count_nonzero(clear) < 3:
        return math.nan, 0.0
    order = np.argsort(periods[clear])
    total = np.cumsum(shares[clear][order])
    median = float(periods[clear][order][np.searchsorted(total, total[-1] / 2)])
    return median, float(shares[clear].sum()) / shares.size


def _window_periods(windows: npt.NDArray[Any]) -> tuple[FloatArray, FloatArray]:
    """Return the ridge period of each window, and the share of its power in that peak.

    The edge of a smooth contact has its peak below the band: it has no share.
    """
    tapered = windows.astype(np.float32)
    tapered -= tapered.mean(axis=(1, 2), keepdims=True)
    tapered *= _WINDOW_TAPER
    spectrum = fft.fft(fft.rfft(tapered, axis=2)[:, :, :_COLUMNS], axis=1)[:, _ROWS]
    power = (spectrum.real**2 + spectrum.imag**2).reshape(-1, _FREQUENCY.size)
    # Parseval's theorem gives the power of the half of the spectrum; its first column stands for itself.
    square = np.einsum("ijk,ijk->i", tapered, tapered)
    total = (_WINDOW**2 * square + power[:, ::_COLUMNS].sum(axis=1)) / 2 - power @ _LOW + 1e-12
    power *= 1 - _LOW
    peak = power.argmax(axis=1)
    power *= _PEAKS[peak]
    weight, moment = (power @ _MOMENTS).T + 1e-12
    return weight / moment, _BAND[peak] * weight / total


def shows_ridges(copy: Float32Array, outline: FloatArray, mm_per_px: float, step: float) -> bool:
    """Return whether ridges as far apart as a finger's fill at least a quarter of an outline, (x, y).

    There a window's strongest wave holds a quarter of the power and turns into those of half of the windows
    next to it; evenly spaced straight lines are none. `step` is the picture's pixels in one of the copy. A
    picture too coarse to show ridges is given the benefit of the doubt.
    """
    if mm_per_px > _COARSEST_MM:
        return True
    pitch = mm_per_px * step
    # The windows' centres, and how far apart they are, px.
    low, high = outline.min(axis=0), outline.max(axis=0)
    apart = _STEP if np.prod(high - low) > _ENOUGH * _STEP**2 else _STEP // 2
    first = low + (high - low) % apart / 2
    x, y = (np.rint(np.arange(*ends, apart)).astype(int) for ends in zip(first, high + 1e-6, strict=True))
    columns, rows = high.astype(int) + 3
    inside = filled_polygon(outline, (rows, columns))[y[:, None], x] > 0
    count = np.count_nonzero(inside)
    if count * (apart * pitch) ** 2 < _TELLING_MM2:
        return True
    short = [max(0, _SIDE - n) for n in copy.shape]
    if any(short):
        copy = as_float32(cv2.copyMakeBorder(copy, 0, short[0], 0, short[1], cv2.BORDER_REFLECT))
    # The windows in the middle tell alone where they show ridges enough for all.
    third = len(y) // 3
    for part in (slice(third, len(y) - third), slice(None)):
        some = inside[part]
        waves = _flowing_waves(copy, (y[part], x), some, pitch, _STEP // apart)
        if len(waves) >= _MIN_RIDGED * count:
            parallel, spread = _alike(waves)
            if not (parallel > _PARALLEL and spread < _EVEN):
                return True
    return False


class LineTexture(NamedTuple):
    """Windows of a picture filled by lines of one spacing, which go on in the windows next to them."""

    share: float  # their share of the picture
    parallel: float  # 1 where all lines have one direction, about 0 where they have all
    spread: float  # standard deviation of their spacing over its mean


def line_texture(picture: Float32Array) -> LineTexture:
    """Return the lines of a picture of unknown scale: of reduced copies, those of which most are seen."""
    best = LineTexture(0.0, 0.0, 0.0)
    while min(picture.shape) >= 2 * _SIDE:
        best = max(best, _lines_of_copy(picture))
        picture = as_float32(cv2.resize(picture, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA))
    return best


def _lines_of_copy(copy: Float32Array) -> LineTexture:
    step = _STEP if copy.size > _ENOUGH * 4 * _STEP**2 else _STEP // 2
    y, x = (np.arange(_SIDE // 2, n - _SIDE // 2 + 1, step) for n in copy.shape)
    mean = cv2.blur(copy, (_SIDE, _SIDE))
    deviation = np.sqrt(np.maximum(cv2.blur(copy * copy, (_SIDE, _SIDE)) - mean * mean, 0))
    low, high = np.percentile(copy, [1, 99])
    busy = deviation[y[:, None], x] > max(_BUSY_SHARE * (high - low), _BUSY_LEVELS)
    if np.count_nonzero(busy) < _FEWEST:
        return LineTexture(0.0, 0.0, 0.0)
    waves = _flowing_waves(copy, (y, x), busy, _PITCH_MM, _STEP // step)
    if len(waves) < _FEWEST:
        return LineTexture(0.0, 0.0, 0.0)
    return LineTexture(len(waves) / busy.size, *_alike(waves))


def _flowing_waves(
    copy: Float32Array, grid: tuple[Whole, Whole], chosen: BoolArray, pitch: float, reach: int
) -> FloatArray:
    """Return waves, 1/mm, of chosen windows: each fills its own and goes on in half of those beside it.

    The grid are rows and columns of the windows' centres; neighbours are so many places apart.
    """
    windows = np.lib.stride_tricks.sliding_window_view(copy, (_SIDE, _SIDE))
    y, x = ((k - _SIDE // 2).clip(0, n - 1) for k, n in zip(grid, windows.shape[:2], strict=True))
    row, column = np.nonzero(chosen)
    some = windows[y[row], x[column]]
    middle = some.reshape(len(some), -1) @ _TAPER.ravel() / _TAPER.sum()
    spectrum = fft.rfft2((some - middle[:, None, None]) * _TAPER).reshape(len(some), -1)
    power = (spectrum.real**2 + spectrum.imag**2) * _COUNTED
    highest = power.argmax(axis=1)
    peak = np.abs(_BINS[highest])
    in_peak = np.take_along_axis(power, _MEMBERS[highest], axis=1) * _COUNTS[highest]
    total = in_peak.sum(axis=1)
    share = total / (power @ _TWICE + np.float32(1e-9))
    waves = (in_peak * _TURNED[highest]).sum(axis=1) / (total + np.float32(1e-9)) / (_SIDE * pitch)
    # Periods per window of the longest and the shortest wave that ridges may have.
    low, high = (_SIDE * pitch / period for period in WINDOW_RIDGE_PERIOD_MM[::-1])
    share *= (peak >= low) & (peak <= high)  # none where the wave is no ridge's
    rows, columns = chosen.shape
    padded = np.zeros((3, rows + 2 * reach, columns + 2 * reach), dtype=waves.dtype)
    places, ridge, here = padded[:, reach:-reach, reach:-reach]
    places[chosen], ridge[chosen], here[chosen] = waves, share > 0, 1
    # Of each chosen window the three rows and columns of windows about it, in order (windows, 3, 3).
    side = 2 * reach + 1
    around = np.lib.stride_tricks.sliding_window_view(padded, (side, side), axis=(1, 2))[
        ..., ::reach, ::reach
    ]
    other, ridged, there = around[:, chosen]
    own = waves[:, None, None]
    off = np.minimum(np.abs(other - own), np.abs(other + own))
    like = (ridged.real > 0) & (off < _BENT * np.abs(own))
    like[:, 1, 1] = False  # the window itself
    flows_on = 2 * like.sum(axis=(1, 2)) >= there.real.sum(axis=(1, 2)) - 1
    return np.asarray(waves[(share > _MIN_SHARE) & flows_on])


def _alike(waves: FloatArray) -> tuple[float, float]:
    """Return how alike waves are: 1 where all have one direction, and the spread of their lengths."""
    lengths = np.abs(waves)
    return float(abs(((waves / lengths) ** 2).mean())), float(lengths.std() / lengths.mean())
