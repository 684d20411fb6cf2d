"""Whether the place measured shows the ridges of a finger."""

import math
from typing import Final, NamedTuple

import cv2
import numpy as np
from scipy import fft

from fingerpad._arrays import BoolArray, Float32Array, FloatArray, as_float32
from fingerpad.image._masks import filled_polygon
from fingerpad.image.contact_image._working_image import WorkingImage

# Fingers' ridges are 0.3 to 0.7 mm apart; a window's spectrum resolves that to a tenth.
_PERIODS_MM: Final = (0.28, 0.75)
# A copy of this pitch is looked at, in square windows; a coarser picture cannot show ridges.
_PITCH_MM, _COARSEST_MM = 0.09, 0.12
_SIDE, _STEP, _MANY = 32, 16, 40
# Spectral bins: below the least lie edges and shading, and a peak spreads so far.
_LOWEST, _SPREAD = 1.5, 2.1
# Least share of a window's power in its peak, and least share of such windows that ridges fill.
_MIN_SHARE, _MIN_RIDGED = 0.25, 0.25
# Neighbours' wave vectors differ by less than this share.
_BENT = 0.6
# Lines more alike than these in direction and spacing are print or a grating.
_PARALLEL, _EVEN = 0.98, 0.03
# Fewer windows than this, some 10 mm², tell nothing.
_TELLING = 20

# Without a scale, windows are judged by their deviation: this share of the picture's range, so many levels.
_BUSY_SHARE, _BUSY_LEVELS, _FEWEST = 0.08, 0.7, 6

# Half of the spectrum, by the bins from the mean; its first and last column stand for themselves.
_BINS = np.add.outer(1j * fft.fftfreq(_SIDE), fft.rfftfreq(_SIDE)).ravel() * _SIDE
_BINS = _BINS.astype(np.complex64)
_TWICE = as_float32(np.where(np.isin(_BINS.real, (0, _SIDE / 2)), 1.0, 2.0))
_TAPER = as_float32(np.outer(*[np.hanning(_SIDE + 2)[1:-1]] * 2))


def shows_ridges(view: WorkingImage, outline: FloatArray, mm_per_px: float) -> bool:
    """Return whether ridges as far apart as a finger's fill at least a quarter of an outline.

    Local spectra, as those that the ridge period is found from, but at the scale of the picture: where a
    window's strongest wave is 0.28 to 0.75 mm long, holds a quarter of the power and turns into the waves of
    half of the windows next to it, there are ridges. Straight lines evenly spaced are none. A picture too
    coarse to show ridges is given the benefit of the doubt.

    Parameters
    ----------
    view : WorkingImage
        The picture.
    outline : ndarray, (n, 2)
        (x, y), px of the picture.
    mm_per_px : float
        Its scale.
    """
    if mm_per_px > _COARSEST_MM:
        return True
    pitch = max(_PITCH_MM, mm_per_px)
    copy, places = _copy_of(view, outline, pitch / mm_per_px)
    centres, step = _centres(places)
    inside = _is_inside(places, centres)
    if np.count_nonzero(inside) < _TELLING:
        return True
    share, waves = _waves(copy, centres[inside], pitch)
    ridged = (share > _MIN_SHARE) & _flows_on(waves, share, inside, _STEP // step)
    if ridged.mean() < _MIN_RIDGED:
        return False
    return not _is_grating(waves[ridged])


class LineTexture(NamedTuple):
    """Windows of a picture that are filled by lines of one spacing, which go on in the windows next to them.

    Attributes
    ----------
    share : float
        Their share of the picture.
    parallel : float
        1 where all lines have one direction, about 0 where they have all.
    spread : float
        Standard deviation of their spacing over its mean.
    """

    share: float
    parallel: float
    spread: float


def line_texture(picture: Float32Array) -> LineTexture:
    """Return the lines of a picture of unknown scale: of reduced copies, those of which most are seen."""
    best = LineTexture(0.0, 0.0, 0.0)
    while min(picture.shape) >= 2 * _SIDE:
        best = max(best, _lines_of_copy(picture))
        picture = as_float32(cv2.resize(picture, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA))
    return best


def _lines_of_copy(copy: Float32Array) -> LineTexture:
    step = _STEP if copy.size > _MANY * 4 * _STEP**2 else _STEP // 2
    y, x = (np.arange(_SIDE / 2, n - _SIDE / 2 + 1, step) for n in copy.shape)
    centres = np.stack(np.meshgrid(x, y), axis=-1)
    mean = cv2.blur(copy, (_SIDE, _SIDE))
    deviation = np.sqrt(np.maximum(cv2.blur(copy * copy, (_SIDE, _SIDE)) - mean * mean, 0))
    low, high = np.percentile(copy, [1, 99])
    busy = deviation[np.ix_(y.astype(int), x.astype(int))] > max(_BUSY_SHARE * (high - low), _BUSY_LEVELS)
    if np.count_nonzero(busy) < _FEWEST:
        return LineTexture(0.0, 0.0, 0.0)
    share, waves = _waves(copy, centres[busy], _PITCH_MM)
    lined = (share > _MIN_SHARE) & _flows_on(waves, share, busy, _STEP // step)
    if np.count_nonzero(lined) < _FEWEST:
        return LineTexture(0.0, 0.0, 0.0)
    lengths = np.abs(waves[lined])
    parallel = abs(((waves[lined] / lengths) ** 2).mean())
    filled = float(np.count_nonzero(lined) / busy.size)
    return LineTexture(filled, float(parallel), float(lengths.std() / lengths.mean()))


def _copy_of(view: WorkingImage, outline: FloatArray, reduction: float) -> tuple[Float32Array, FloatArray]:
    """Return the outline's box with half a window round it, reduced, and the outline in it."""
    rows, columns = view.picture.shape
    places = outline - view.corner[::-1]
    margin = math.ceil(_SIDE / 2 * reduction) + 1
    low = np.floor(places.min(axis=0)).astype(int)
    high = np.ceil(places.max(axis=0)).astype(int) + 1
    low, high = low.clip(0, [columns - 1, rows - 1]), high.clip(1, [columns, rows])
    first, last = np.maximum(low - margin, 0), np.minimum(high + margin, [columns, rows])
    box = view.picture[first[1] : last[1], first[0] : last[0]]
    over = np.maximum(margin - (low - first), 0), np.maximum(margin - (last - high), 0)
    top, bottom, left, right = (int(n[k]) for k in (1, 0) for n in over)
    whole = cv2.copyMakeBorder(box, top, bottom, left, right, cv2.BORDER_REFLECT)
    size = [max(_SIDE + 1, round(n / reduction)) for n in whole.shape[::-1]]
    steps = np.array(whole.shape[::-1]) / size
    return as_float32(cv2.resize(whole, size, interpolation=cv2.INTER_AREA)), (
        places - (first - over[0]) + 0.5
    ) / steps - 0.5


def _centres(places: FloatArray) -> tuple[FloatArray, int]:
    """Return the centres of the windows, (rows, columns, 2), and how far apart they are, px."""
    low, high = places.min(axis=0), places.max(axis=0)
    step = _STEP if np.prod(high - low) > _MANY * _STEP**2 else _STEP // 2
    x, y = (np.arange(a + (b - a) % step / 2, b + 1e-6, step) for a, b in zip(low, high, strict=True))
    return np.stack(np.meshgrid(x, y), axis=-1), step


def _is_inside(places: FloatArray, centres: FloatArray) -> BoolArray:
    size = np.ceil(np.maximum(places.max(axis=0), centres.max(axis=(0, 1)))).astype(int) + 2
    canvas = filled_polygon(places, (int(size[1]), int(size[0])))
    x, y = np.moveaxis(np.rint(centres).astype(int).clip(0), -1, 0)
    return np.asarray(canvas[y, x] > 0)


def _waves(copy: Float32Array, centres: FloatArray, pitch: float) -> tuple[FloatArray, FloatArray]:
    """Return each window's strongest wave, 1/mm, and its share of the power, 0 where it is no ridge's."""
    windows = np.lib.stride_tricks.sliding_window_view(copy, (_SIDE, _SIDE))
    x, y = np.rint(centres - _SIDE / 2).astype(int).T
    some = windows[y.clip(0, windows.shape[0] - 1), x.clip(0, windows.shape[1] - 1)]
    middle = np.einsum("ijk,jk->i", some, _TAPER) / _TAPER.sum()
    spectrum = fft.rfft2((some - middle[:, None, None]) * _TAPER).reshape(len(some), -1)
    power = spectrum.real**2 + spectrum.imag**2
    power[:, np.abs(_BINS) < _LOWEST] = 0
    peak = _BINS[power.argmax(axis=1)]
    power *= _TWICE
    near = np.abs(_BINS - peak[:, None]) < _SPREAD
    opposite = np.abs(_BINS + peak[:, None]) < _SPREAD
    in_peak = power * (near | opposite)
    total = in_peak.sum(axis=1)
    share = total / (power.sum(axis=1) + 1e-9)
    waves = (in_peak * np.where(near, _BINS, -_BINS)).sum(axis=1) / (total + 1e-9) / (_SIDE * pitch)
    # Periods per window of the longest and the shortest wave that ridges may have.
    low, high = (_SIDE * pitch / period for period in _PERIODS_MM[::-1])
    return share * ((np.abs(peak) >= low) & (np.abs(peak) <= high)), waves


def _flows_on(waves: FloatArray, share: FloatArray, inside: BoolArray, reach: int) -> BoolArray:
    """Return for each window inside whether half of its neighbours on the grid have waves like its own."""
    grid, ridge = np.zeros(inside.shape, dtype=waves.dtype), np.zeros(inside.shape, dtype=bool)
    grid[inside], ridge[inside] = waves, share > 0
    pad = [np.pad(each, reach) for each in (grid, ridge, inside)]
    like, count = np.zeros(inside.shape), np.zeros(inside.shape)
    rows, columns = inside.shape
    for down in (0, reach, 2 * reach):
        for right in (0, reach, 2 * reach):
            if down == right == reach:
                continue
            other, ridged, there = (each[down : down + rows, right : right + columns] for each in pad)
            off = np.minimum(np.abs(other - grid), np.abs(other + grid))
            like += ridged & (off < _BENT * np.abs(grid))
            count += there
    return np.asarray((like >= count / 2)[inside])


def _is_grating(waves: FloatArray) -> bool:
    """Return whether all waves have one direction and one length."""
    lengths = np.abs(waves)
    parallel = abs(((waves / lengths) ** 2).mean())
    return bool(parallel > _PARALLEL and lengths.std() < _EVEN * lengths.mean())
