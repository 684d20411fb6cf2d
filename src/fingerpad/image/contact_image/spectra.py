"""Local spectra of a picture: the ridge period, and whether its lines are the ridges of a finger.

Both look at square windows under a taper, and at the strongest peak of each. The period is asked of smaller
copies of the picture, without a scale; whether there are ridges in windows of 2.9 mm that go with their
neighbours.
"""

import math
from typing import Any, Final, NamedTuple, TypeAlias

import cv2
import numpy as np
import numpy.typing as npt
from numpy.lib.stride_tricks import sliding_window_view
from scipy import fft

from fingerpad._arrays import BoolArray, Float32Array, FloatArray, as_float32
from fingerpad.image._masks import filled_polygon
from fingerpad.image.contact_image.background import block_means
from fingerpad.image.scale import WINDOW_RIDGE_PERIOD_MM

Pixels: TypeAlias = npt.NDArray[np.uint8] | npt.NDArray[np.float32]
Whole: TypeAlias = npt.NDArray[np.intp]

_SIDE: Final = 32  # px; side of the windows
_STEP: Final = 16  # px from one to the next
_LOWEST: Final = 1.5  # bin below which edges and shading lie
_SPREAD: Final = 2.1  # bins over which a peak spreads

# The period.
_MOST: Final = 48  # windows that are asked
_STRIDE: Final = 2  # windows are judged by every other pixel
# Periods that a window shows well in one of the copies, px.
_SHORTEST: Final = 2.0
_LONGEST: Final = 6.6
_MIDDLE: Final = 3.5
_MIN_CONCENTRATION: Final = 0.22  # about the share of its power that white noise puts into one peak
_TEXTURED: Final = 0.25  # share of the variance of the most varied windows from which one is textured
_CLEARER: Final = 1.1  # by this factor a copy speaks more clearly than a finer one, to be taken
_CLEAR: Final = 0.3  # one that is clear spares coarser ones

# Whether there are ridges.
_PITCH_MM: Final = 0.09  # of the copy that is looked at
_COARSEST_MM: Final = 0.12  # a coarser picture cannot show ridges
_ENOUGH: Final = 20  # fewer windows than this are taken at half that distance
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
# What each bin counts: area means, of which copies are made, weaken short waves by both cosines.
_WEAKENED = np.cos(np.pi / 2 * np.stack([_BINS.real, _BINS.imag]) / _SIDE).prod(axis=0) ** 2
_COUNTED = as_float32((np.abs(_BINS) >= _LOWEST) / _WEAKENED)
_TAPER = as_float32(np.outer(*[np.hanning(_SIDE + 2)[1:-1]] * 2))
# The few bins that belong to a peak at each bin, or to its mirror image, and their wave vectors turned the
# peak's way; bins that only fill the table count nothing.
_NEAR = np.abs(_BINS - _BINS[:, None]) < _SPREAD
_IN_PEAK = _NEAR | (np.abs(_BINS + _BINS[:, None]) < _SPREAD)
_MEMBERS = np.argsort(~_IN_PEAK, axis=1, kind="stable")[:, : _IN_PEAK.sum(axis=1).max()]
_COUNTS = as_float32(np.take_along_axis(_IN_PEAK, _MEMBERS, axis=1) * _TWICE[_MEMBERS])
_TURNED = np.where(np.take_along_axis(_NEAR, _MEMBERS, axis=1), _BINS[_MEMBERS], -_BINS[_MEMBERS])
_LENGTHS = np.abs(_TURNED)


class _Peaks(NamedTuple):
    """The strongest peak of the spectrum of each window, (n,)."""

    share: Float32Array  # of the window's power
    place: Float32Array  # where it is highest, periods per window
    length: Float32Array  # its mean place
    wave: npt.NDArray[np.complex64]  # mean wave vector, periods per window


def _peaks(windows: npt.NDArray[Any]) -> _Peaks:
    """Return the strongest peaks of some windows, (n, 32, 32), but for what edges and shading make."""
    some = as_float32(windows)
    middle = some.reshape(-1, _SIDE**2) @ _TAPER.ravel() / _TAPER.sum()
    spectrum = fft.rfft2((some - middle[:, None, None]) * _TAPER).reshape(-1, _BINS.size)
    power = (spectrum.real**2 + spectrum.imag**2) * _COUNTED
    highest = power.argmax(axis=1)
    in_peak = np.take_along_axis(power, _MEMBERS[highest], axis=1) * _COUNTS[highest]
    total = in_peak.sum(axis=1) + np.float32(1e-9)
    return _Peaks(
        share=total / (power @ _TWICE + np.float32(1e-9)),
        place=np.abs(_BINS[highest]),
        length=(in_peak * _LENGTHS[highest]).sum(axis=1) / total,
        wave=(in_peak * _TURNED[highest]).sum(axis=1) / total,
    )


def ridge_period_px(pixels: Pixels, inside: BoolArray | None, expected: float) -> float:
    """Return the median ridge period, px, NaN where no ridges are found.

    Windows of copies that show the `expected` period, half or twice that, or else of all, vote for the
    period of their peak with its share of their power. Coarser copies than the expected one are asked only
    where it is not clear.
    """
    copies = [_halved(pixels, inside)]
    while min(copies[-1][0].shape) >= _SIDE:
        copies.append(_halved(*copies[-1]))
    middle = math.floor(math.log2(max(expected / 2 / _MIDDLE, 1.0)) + 0.5)
    likely = range(max(0, middle - 1), min(len(copies), middle + 2))
    for levels in (likely, range(len(copies))):
        best, best_vote = math.nan, 0.0
        for level in levels:
            period, vote = _median_period(_textured_windows(*copies[level]))
            if vote > _CLEARER * best_vote:
                best, best_vote = 2.0 ** (level + 1) * period, vote
            if best_vote > _CLEAR and level >= middle:
                break
        if best_vote:
            return best
    return math.nan


def _halved(pixels: npt.NDArray[Any], inside: BoolArray | None) -> tuple[npt.NDArray[Any], BoolArray | None]:
    rows, columns = (n // 2 * 2 for n in pixels.shape)
    small = cv2.resize(pixels[:rows, :columns], None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
    return small, None if inside is None else inside[:rows:2, :columns:2]


def _textured_windows(pixels: npt.NDArray[Any], inside: BoolArray | None) -> npt.NDArray[Any]:
    """Return windows of much variance, spread over the picture, (n, 32, 32)."""
    pad = [(0, max(0, _SIDE - n)) for n in pixels.shape]
    if np.any(pad):
        pixels = np.pad(pixels, pad, mode="reflect")
        inside = None if inside is None else np.pad(inside, pad, mode="edge")
    windows = sliding_window_view(pixels, (_SIDE, _SIDE))[::_STEP, ::_STEP]
    some = tuple(slice(0, n // _STEP * _STEP, _STRIDE) for n in pixels.shape)
    sparse = pixels[some].astype(np.float32)
    mean = _window_means(sparse)
    variance = _window_means(sparse * sparse) - mean * mean
    if inside is not None:
        variance[_window_means(inside[some].astype(np.float32)) < 0.9] = 0
    high = np.sort(variance, axis=None)[int(0.95 * (variance.size - 1))]
    textured = np.argwhere(variance >= _TEXTURED * high)
    count = min(_MOST, len(textured))
    rows, columns = textured[np.linspace(0, len(textured) - 1, count).astype(int)].T
    return np.asarray(windows[rows, columns])


def _window_means(sparse: Float32Array) -> Float32Array:
    """Return the mean of each window, half a window apart, of a picture given by every other pixel."""
    quarters = block_means(sparse, _STEP // _STRIDE)
    return as_float32(cv2.blur(quarters, (2, 2), anchor=(0, 0)))[:-1, :-1]


def _median_period(windows: npt.NDArray[Any]) -> tuple[float, float]:
    """Return the median ridge period of windows, px, by the shares of their power, and how clear it is.

    The edge of a smooth contact has its peak below the band: it has no share.
    """
    peaks = _peaks(windows)
    seen = (peaks.place >= _SIDE / _LONGEST) & (peaks.place <= _SIDE / _SHORTEST)
    clear = seen & (peaks.share > _MIN_CONCENTRATION)
    if np.count_nonzero(clear) < 3:
        return math.nan, 0.0
    order = np.argsort(-peaks.length[clear])
    total = np.cumsum(peaks.share[clear][order])
    median = peaks.length[clear][order][np.searchsorted(total, total[-1] / 2)]
    return _SIDE / float(median), float(total[-1]) / len(windows)


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
    windows = sliding_window_view(copy, (_SIDE, _SIDE))
    y, x = ((k - _SIDE // 2).clip(0, n - 1) for k, n in zip(grid, windows.shape[:2], strict=True))
    row, column = np.nonzero(chosen)
    peaks = _peaks(windows[y[row], x[column]])
    waves = peaks.wave / (_SIDE * pitch)
    # Periods per window of the longest and the shortest wave that ridges may have: no others count.
    low, high = (_SIDE * pitch / period for period in WINDOW_RIDGE_PERIOD_MM[::-1])
    share = peaks.share * ((peaks.place >= low) & (peaks.place <= high))
    rows, columns = chosen.shape
    padded = np.zeros((3, rows + 2 * reach, columns + 2 * reach), dtype=waves.dtype)
    places, ridge, here = padded[:, reach:-reach, reach:-reach]
    places[chosen], ridge[chosen], here[chosen] = waves, share > 0, 1
    # Of each chosen window the three rows and columns of windows about it, in order (windows, 3, 3).
    steps = reach * np.arange(3)
    other, ridged, there = padded[:, row[:, None, None] + steps[:, None], column[:, None, None] + steps]
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
