"""Loading, hold and unloading in a record of force or of contact area."""

import math
from typing import Final, Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array
from fingerpad._motion import FALL, REST, RISE, find_motion, runs, usual_rate

Phase: TypeAlias = Literal["before", "loading", "hold", "unloading", "after"]
PHASES: Final[tuple[Phase, ...]] = ("before", "loading", "hold", "unloading", "after")
_BEFORE, _LOADING, _HOLD, _UNLOADING, _AFTER = range(5)

# Contact is what lies above this share of the range; its noise is smoothed over this share of its duration.
_CONTACT_LEVEL, _SMOOTHING = 0.02, 0.02
# A hold lasts this share of the contact; the foot of a ramp lies below this share of the range.
_MIN_DURATION, _FOOT = 0.04, 0.3


def phases_of(time: ArrayLike, values: ArrayLike) -> npt.NDArray[np.int8]:
    """Return the phase of each sample of a record, as an index into `PHASES`.

    The record is smoothed over a fiftieth of the contact. It is held where it changes at less than a fifth of
    the rate of the ramps, each ramp's rate being the mean weighted with the change; stretches shorter than
    a twenty-fifth of the contact are merged with their neighbours. A record may hold several presses.

    Parameters
    ----------
    time : array_like, (n,)
        Strictly increasing times.
    values : array_like, (n,)
        Force, or anything that grows with contact.

    Returns
    -------
    ndarray of int8, shape (n,)
        Indices into `PHASES`.

    Examples
    --------
    >>> time = np.linspace(0, 5, 101)
    >>> load = np.interp(time, [0, 1, 2, 3, 4, 5], [0, 0, 2, 2, 0, 0])
    >>> [PHASES[k] for k in phases_of(time, load)][10::20]
    ['before', 'loading', 'hold', 'unloading', 'after']
    """
    time, values = as_float_array(time), as_float_array(values)
    labels = np.full(time.size, _BEFORE, dtype=np.int8)
    values = _moving_average(values, _window(values.size, _SMOOTHING / 2))
    low, high = float(values.min()), float(values.max())
    touching = np.flatnonzero(values > low + _CONTACT_LEVEL * (high - low))
    if not high > low or touching.size < 3:
        return labels
    first, last = int(touching[0]), int(touching[-1])
    labels[last + 1 :] = _AFTER
    window = _window(last - first + 1, _SMOOTHING)
    smooth = _moving_average(values, window)
    rate = _moving_average(np.gradient(smooth, time), window)[first : last + 1]
    motion = find_motion(
        rate,
        rising=usual_rate(np.maximum(rate, 0)),
        falling=usual_rate(np.maximum(-rate, 0)),
        min_samples=math.ceil(_MIN_DURATION * rate.size),
    )
    height = (smooth[first : last + 1] - low) / (high - low)
    for start, end in zip(*runs(motion), strict=True):
        # The slow foot of a ramp belongs to the ramp.
        if motion[start] == REST and height[start:end].mean() < _FOOT:
            motion[start:end] = RISE if end < motion.size and motion[end] == RISE else FALL
    labels[first : last + 1] = np.select([motion == RISE, motion == REST], [_LOADING, _HOLD], _UNLOADING)
    return labels


def _window(count: int, share: float) -> int:
    """Return an odd number of samples, about a share of a count."""
    return 2 * round(share * count / 2) + 1


def _moving_average(values: FloatArray, window: int) -> FloatArray:
    padded = np.pad(values, window // 2, mode="edge")
    return np.asarray(np.convolve(padded, np.full(window, 1 / window), mode="valid"))
