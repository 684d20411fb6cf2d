"""Loading, hold and unloading, told apart in a record of force or of contact area."""

import math
from typing import Final, Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array

Phase: TypeAlias = Literal["before", "loading", "hold", "unloading", "after"]
PHASES: Final[tuple[Phase, ...]] = ("before", "loading", "hold", "unloading", "after")
_BEFORE, _LOADING, _HOLD, _UNLOADING, _AFTER = range(5)

# Contact is what lies above this share of the range; its noise is smoothed over this share of its duration.
_CONTACT_LEVEL, _SMOOTHING = 0.02, 0.02
# A hold changes slower than this share of the ramp's rate, lasts this share of the contact, and is no foot
# of a ramp, which lies below this share of the range.
_HOLD_RATE, _MIN_DURATION, _FOOT = 0.2, 0.04, 0.3


def phases_of(time: ArrayLike, values: ArrayLike) -> npt.NDArray[np.int8]:
    """Tell the phase of each sample of a record, as an index into `PHASES`.

    The record is smoothed over a fiftieth of the contact. It is held where it changes at less than a fifth of
    the rate of the ramps, each ramp's rate being the mean weighted with the change; shorter stretches than
    a twenty-fifth of the contact go to their neighbours. Several presses in one record are told apart too.

    Parameters
    ----------
    time : array_like, (n,)
        Strictly increasing times.
    values : array_like, (n,)
        Force, or anything that grows with contact.

    Returns
    -------
    ndarray of int8, (n,)

    Examples
    --------
    >>> time = np.linspace(0, 5, 101)
    >>> load = np.interp(time, [0, 1, 2, 3, 4, 5], [0, 0, 2, 2, 0, 0])
    >>> [PHASES[k] for k in phases_of(time, load)][10::20]
    ['before', 'loading', 'hold', 'unloading', 'after']
    """
    time, values = as_float_array(time), as_float_array(values)
    labels = np.full(time.size, _BEFORE, dtype=np.int8)
    values = _smoothed(values, _window(values.size, _SMOOTHING / 2))
    low, high = float(values.min()), float(values.max())
    touching = np.flatnonzero(values > low + _CONTACT_LEVEL * (high - low))
    if not high > low or touching.size < 3:
        return labels
    first, last = int(touching[0]), int(touching[-1])
    labels[last + 1 :] = _AFTER
    window = _window(last - first + 1, _SMOOTHING)
    smooth = _smoothed(values, window)
    rate = _smoothed(np.gradient(smooth, time), window)[first : last + 1]
    inside = _merged(_by_rate(rate), math.ceil(_MIN_DURATION * rate.size))
    height = (smooth[first : last + 1] - low) / (high - low)
    labels[first : last + 1] = _without_feet(inside, height)
    return labels


def _window(count: int, share: float) -> int:
    """Return an odd number of samples, about a share of a count."""
    return 2 * round(share * count / 2) + 1


def _smoothed(values: FloatArray, window: int) -> FloatArray:
    padded = np.pad(values, window // 2, mode="edge")
    return np.asarray(np.convolve(padded, np.full(window, 1 / window), mode="valid"))


def _by_rate(rate: FloatArray) -> npt.NDArray[np.int8]:
    """Label samples by their rate against the rate of the ramps."""
    labels = np.full(rate.size, _HOLD, dtype=np.int8)
    for way, label in ((rate, _LOADING), (-rate, _UNLOADING)):
        rising = np.maximum(way, 0)
        if rising.any():
            labels[way > _HOLD_RATE * float(np.average(rising, weights=rising))] = label
    return labels


def _merged(labels: npt.NDArray[np.int8], least: int) -> npt.NDArray[np.int8]:
    """Give stretches shorter than `least`, shortest first, to their neighbours: half to each."""
    labels = labels.copy()
    while True:
        starts = np.flatnonzero(np.diff(labels, prepend=-1))
        ends = np.append(starts[1:], labels.size)
        k = int(np.argmin(ends - starts))
        if starts.size == 1 or ends[k] - starts[k] >= least:
            return labels
        before = labels[starts[k] - 1] if k > 0 else labels[ends[k]]
        after = labels[ends[k]] if k + 1 < starts.size else before
        middle = (starts[k] + ends[k] + 1) // 2
        labels[starts[k] : middle], labels[middle : ends[k]] = before, after


def _without_feet(labels: npt.NDArray[np.int8], height: FloatArray) -> npt.NDArray[np.int8]:
    """Turn the slow foot of a ramp into part of it."""
    labels = labels.copy()
    starts = np.flatnonzero(np.diff(labels, prepend=-1))
    ends = np.append(starts[1:], labels.size)
    for k, (start, end) in enumerate(zip(starts, ends, strict=True)):
        if labels[start] == _HOLD and height[start:end].mean() < _FOOT:
            follows = k + 1 < starts.size and labels[end] == _LOADING
            labels[start:end] = _LOADING if follows else _UNLOADING
    return labels
