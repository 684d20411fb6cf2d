"""Local spectra of a picture: the ridge period, and whether its lines are the ridges of a finger.

Both look at windows of 32 px under a taper, and at the strongest wave of each. The period is asked of the
picture or of a copy reduced by halves, without a scale; whether there are ridges in windows that go with
their neighbours.
"""

import math
from typing import Final, NamedTuple, TypeAlias

import cv2
import numpy as np
import numpy.typing as npt
from scipy import fft

from fingerpad._arrays import BoolArray, Float32Array, as_float32
from fingerpad.image.contact_image.background import quantile
from fingerpad.image.scale import WINDOW_RIDGE_PERIOD_MM

# Windows, and how far apart they are, px.
_SIDE: Final = 32
_STEP: Final = 16

# The period: how many windows are asked, and the periods that they show well, px.
_MANY: Final = 96
_SHORTEST: Final = 2.5
_LONGEST: Final = 8.0
_MIDDLE: Final = 4.5
# Fewer clear windows than this, or of many windows than twice as many, tell nothing: noise makes some.
_FEWEST_CLEAR: Final = 3
# Share of the variance of the most varied windows from which one is textured.
_TEXTURED: Final = 0.25
# Other copies must speak more clearly by this factor; where the expected one is this clear, none is asked.
_CLEARER: Final = 3.0
_CLEAR: Final = 0.25

# A copy of this pitch is looked at; a coarser picture than the last cannot show ridges.
_PITCH_MM: Final = 0.09
_COARSEST_MM: Final = 0.12
# Fewer windows than this that far apart are taken at half the distance.
_ENOUGH: Final = 60
# Bins: below the least lie edges and shading, and a peak spreads so far.
_LOWEST: Final = 1.5
_SPREAD: Final = 2.1
# Least share of a window's power in its peak, and least share of such windows that ridges fill.
_MIN_SHARE: Final = 0.25
_MIN_RIDGED: Final = 0.25
# Neighbours' wave vectors differ by less than this share.
_BENT: Final = 0.6
# Lines more alike than these in direction and spacing are print or a grating. Ruled lines seen at a slant
# have 0.999 and 0.01 to 0.03, ridges that hardly bend up to 0.996, real prints at most 0.90 and from 0.09.
_PARALLEL: Final = 0.998
_EVEN: Final = 0.03
# Less than this tells nothing.
_TELLING_MM2: Final = 13.0
# Without a scale, windows are judged by their deviation: this share of the picture's range, so many levels.
_BUSY_SHARE: Final = 0.08
_BUSY_LEVELS: Final = 0.7
_FEWEST: Final = 6

Pixels: TypeAlias = npt.NDArray[np.uint8] | Float32Array
# Strongest waves of windows, as complex numbers.
Waves: TypeAlias = npt.NDArray[np.complex64]

# Half of the spectrum, by the bins from the mean; its first and last column stand for themselves.
_BINS = np.add.outer(1j * fft.fftfreq(_SIDE), fft.rfftfreq(_SIDE)).ravel() * _SIDE
_BINS = _BINS.astype(np.complex64)
_WEIGHTS = as_float32(np.where(np.isin(_BINS.real, (0, _SIDE / 2)), 1.0, 2.0) * (np.abs(_BINS) >= _LOWEST))
_TAPER = as_float32(np.outer(*[np.hanning(_SIDE + 2)[1:-1]] * 2))
# The few bins that belong to a peak at each bin, or to its mirror image, and their wave vectors turned the
# peak's way; bins that only fill the table count nothing.
_NEAR = np.abs(_BINS - _BINS[:, None]) < _SPREAD
_IN_PEAK = _NEAR | (np.abs(_BINS + _BINS[:, None]) < _SPREAD)
_MEMBERS = np.argsort(~_IN_PEAK, axis=1, kind="stable")[:, : _IN_PEAK.sum(axis=1).max()]
_COUNTS = as_float32(np.take_along_axis(_IN_PEAK, _MEMBERS, axis=1) * _WEIGHTS[_MEMBERS])
_TURNED = np.where(np.take_along_axis(_NEAR, _MEMBERS, axis=1), _BINS[_MEMBERS], -_BINS[_MEMBERS])
_LENGTHS = np.abs(_TURNED)


def ridge_period_px(pixels: Pixels, inside: BoolArray | None, expected: float) -> float:
    """Return the median ridge period, px, NaN where no ridges are found.

    Windows of the copy that shows the `expected` period best vote for the strongest wave of each with its
    share of the power; where few are clear, those of copies half and twice as large do, too, or else of all.
    """
    copies: list[tuple[Pixels, BoolArray | None]] = [(pixels, inside)]
    while min(copies[-1][0].shape) >= 2 * _SIDE:
        fine, where = copies[-1]
        rows, columns = (n // 2 * 2 for n in fine.shape)
        small = cv2.resize(fine[:rows, :columns], None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
        half: Pixels = small  # type: ignore[assignment]  # of the same depth
        copies.append((half, None if where is None else where[:rows:2, :columns:2]))
    middle = min(math.floor(math.log2(max(expected / _MIDDLE, 1.0)) + 0.5), len(copies) - 1)
    levels = sorted(range(len(copies)), key=lambda level: abs(level - middle))
    found, clearest = math.nan, 0.0
    for level in levels:
        if clearest > 0 and abs(level - middle) > 1:
            break
        period, vote = _median_period(*copies[level])
        if vote > clearest:
            # The expected copy counts more.
            found, clearest = 2.0**level * period, vote * (_CLEARER if level == middle else 1)
        if level == middle and vote > _CLEAR:
            break
    return found


def _median_period(pixels: Pixels, inside: BoolArray | None) -> tuple[float, float]:
    """Return the weighted median period of textured windows, px, and how clearly they speak for it."""
    copy = _at_least_a_window(as_float32(pixels))
    share, waves = _waves(copy, _textured_windows(copy, inside), (_SIDE / _LONGEST, _SIDE / _SHORTEST))
    clear = share > _MIN_SHARE
    if np.count_nonzero(clear) < max(_FEWEST_CLEAR, share.size / _MANY * 2 * _FEWEST_CLEAR):
        return math.nan, 0.0
    periods, shares = _SIDE / np.abs(waves[clear]), share[clear]
    order = np.argsort(periods)
    total = np.cumsum(shares[order])
    return float(periods[order][np.searchsorted(total, total[-1] / 2)]), float(total[-1]) / share.size


def _at_least_a_window(copy: Float32Array) -> Float32Array:
    short = [max(0, _SIDE - n) for n in copy.shape]
    if any(short):
        copy = as_float32(cv2.copyMakeBorder(copy, 0, short[0], 0, short[1], cv2.BORDER_REFLECT))
    return copy


def _textured_windows(copy: Float32Array, inside: BoolArray | None) -> npt.NDArray[np.intp]:
    """Return the first (row, column) of windows of much variance, evenly picked, (n, 2)."""
    mean = _window_means(copy)
    variance = _window_means(as_float32(copy * copy)) - mean * mean
    if inside is not None:
        variance[_window_means(_at_least_a_window(as_float32(inside))) < 0.9] = 0
    textured = np.argwhere(variance > _TEXTURED * quantile(variance.ravel(), 0.95))
    if not len(textured):
        return np.zeros((1, 2), dtype=np.intp)
    few = np.linspace(0, len(textured) - 1, min(_MANY, len(textured))).astype(int)
    return np.asarray(textured[few] * _STEP)


def _window_means(values: Float32Array) -> Float32Array:
    """Return the mean of each window, half a window apart."""
    rows, columns = (n // _STEP for n in values.shape)
    part = values[: rows * _STEP, : columns * _STEP]
    quarters = cv2.resize(part, (columns, rows), interpolation=cv2.INTER_AREA)
    return as_float32(cv2.blur(quarters, (2, 2), anchor=(0, 0)))[:-1, :-1]


def shows_ridges(copy: Float32Array, patch: BoolArray, mm_per_px: float, step: float) -> bool:
    """Return whether ridges as far apart as a finger's fill at least a quarter of a patch.

    There a window's strongest wave holds a quarter of the power and turns into those of half of the windows
    next to it; evenly spaced straight lines are none. `step` is the picture's pixels in one of the copy. A
    picture too coarse to show ridges is given the benefit of the doubt.
    """
    if mm_per_px > _COARSEST_MM:
        return True
    pitch = mm_per_px * step
    # The windows' centres, and how far apart they are, px.
    left, top, columns, rows = cv2.boundingRect(patch.view(np.uint8))
    apart = min(max(round(math.sqrt(columns * rows / _ENOUGH)), _STEP // 2), _STEP * 5 // 4)
    x, y = (np.arange(a + (n - 1) % apart // 2, a + n, apart) for a, n in ((left, columns), (top, rows)))
    inside = patch[y[:, None], x]
    if np.count_nonzero(inside) * (apart * pitch) ** 2 < _TELLING_MM2:
        return True
    row, column = np.nonzero(inside)
    corners = np.stack([y[row], x[column]], axis=-1) - _SIDE // 2
    share, waves = _waves(_at_least_a_window(copy), corners, _ridges_per_window(pitch))
    ridged = (share > _MIN_SHARE) & _flows_on(waves, share, inside, max(1, _STEP // apart))
    if ridged.mean() < _MIN_RIDGED:
        return False
    parallel, spread = _alike(waves[ridged])
    return not (parallel > _PARALLEL and spread < _EVEN)


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
    row, column = np.nonzero(busy)
    if row.size < _FEWEST:
        return LineTexture(0.0, 0.0, 0.0)
    corners = np.stack([y[row], x[column]], axis=-1) - _SIDE // 2
    share, waves = _waves(copy, corners, _ridges_per_window(_PITCH_MM))
    lined = (share > _MIN_SHARE) & _flows_on(waves, share, busy, _STEP // step)
    if np.count_nonzero(lined) < _FEWEST:
        return LineTexture(0.0, 0.0, 0.0)
    return LineTexture(float(np.count_nonzero(lined) / busy.size), *_alike(waves[lined]))


def _ridges_per_window(pitch: float) -> tuple[float, float]:
    """Return the fewest and the most periods that a finger's ridges have in a window of this pitch, mm."""
    longest, shortest = WINDOW_RIDGE_PERIOD_MM[::-1]
    return _SIDE * pitch / longest, _SIDE * pitch / shortest


def _waves(
    copy: Float32Array, corners: npt.NDArray[np.intp], band: tuple[float, float]
) -> tuple[Float32Array, Waves]:
    """Return the share of the power in each window's strongest wave, and that wave, periods per window.

    The share is 0 where the wave is beyond the band of periods per window.
    """
    windows = np.lib.stride_tricks.sliding_window_view(copy, (_SIDE, _SIDE))
    row, column = corners.T
    some = windows[row.clip(0, windows.shape[0] - 1), column.clip(0, windows.shape[1] - 1)]
    middle = some.reshape(len(some), -1) @ _TAPER.ravel() / _TAPER.sum()
    spectrum = fft.rfft2((some - middle[:, None, None]) * _TAPER).reshape(len(some), -1)
    power = (spectrum.real**2 + spectrum.imag**2) * (_WEIGHTS > 0)
    highest = power.argmax(axis=1)
    in_peak = np.take_along_axis(power, _MEMBERS[highest], axis=1) * _COUNTS[highest]
    total = in_peak.sum(axis=1)
    share = total / (power @ _WEIGHTS + np.float32(1e-9))
    # Ridges that turn within a window would have too short a mean: it gets the mean length.
    waves = (in_peak * _TURNED[highest]).sum(axis=1)
    waves *= (in_peak * _LENGTHS[highest]).sum(axis=1) / (np.abs(waves) * total + np.float32(1e-9))
    peak = np.abs(_BINS[highest])
    return share * ((peak >= band[0]) & (peak <= band[1])), waves


def _flows_on(waves: Waves, share: Float32Array, inside: BoolArray, reach: int) -> BoolArray:
    """Return for each window inside whether half of its neighbours on the grid have waves like its own."""
    rows, columns = inside.shape
    padded = np.zeros((3, rows + 2 * reach, columns + 2 * reach), dtype=waves.dtype)
    grid, ridge, here = padded[:, reach:-reach, reach:-reach]
    grid[inside], ridge[inside], here[inside] = waves, share > 0, 1
    # Of each window inside the three rows and columns of windows about it, in order (windows, 3, 3).
    side = 2 * reach + 1
    around = np.lib.stride_tricks.sliding_window_view(padded, (side, side), axis=(1, 2))[
        ..., ::reach, ::reach
    ]
    other, ridged, there = around[:, inside]
    own = waves[:, None, None]
    off = np.minimum(np.abs(other - own), np.abs(other + own))
    like = (ridged.real > 0) & (off < _BENT * np.abs(own))
    like[:, 1, 1] = False  # the window itself
    return np.asarray(2 * like.sum(axis=(1, 2)) >= there.real.sum(axis=(1, 2)) - 1)


def _alike(waves: Waves) -> tuple[float, float]:
    """Return how alike waves are: 1 where all have one direction, and the spread of their lengths."""
    lengths = np.abs(waves)
    return float(abs(((waves / lengths) ** 2).mean())), float(lengths.std() / lengths.mean())
