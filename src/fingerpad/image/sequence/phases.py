"""Loading, hold and unloading in a record of force or of contact area."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array, real_array, set_fields
from fingerpad._display import Displayed
from fingerpad._motion import FALL, REST, RISE, find_motion, runs, usual_rate
from fingerpad.exceptions import LoadingError

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

    Raises
    ------
    LoadingError
        If the record is not as described.

    Examples
    --------
    >>> time = np.linspace(0, 5, 101)
    >>> load = np.interp(time, [0, 1, 2, 3, 4, 5], [0, 0, 2, 2, 0, 0])
    >>> [PHASES[k] for k in phases_of(time, load)][10::20]
    ['before', 'loading', 'hold', 'unloading', 'after']
    """
    time = real_array(time, "time", LoadingError)
    values = real_array(values, "values", LoadingError)
    if time.ndim != 1 or time.shape != values.shape:
        raise LoadingError(
            f"time and values must have one entry a sample, found shapes {time.shape} and {values.shape}"
        )
    if not (np.isfinite(time).all() and np.isfinite(values).all() and (np.diff(time) > 0).all()):
        raise LoadingError("time must be finite and strictly increasing, and values finite")
    if not time.size:
        return np.empty(0, dtype=np.int8)
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


@dataclass(frozen=True, slots=True, init=False, eq=False, repr=False)
class PhaseIntervals(Displayed):
    """Phases one after the other, each by the time after which it begins.

    Attributes
    ----------
    start : array_like, (n,)
        Times after which the phases begin, s, not decreasing; up to the first it is ``before``.
    phase : sequence of {"before", "loading", "hold", "unloading", "after"}, (n,)
        The phases. One that begins with the next is empty.

    Raises
    ------
    LoadingError
        If the lengths differ, a time is not finite, times decrease, or a phase is none of `PHASES`.

    Examples
    --------
    >>> phases = PhaseIntervals([1.0, 2.0], ["loading", "hold"])
    >>> [phases.at(time) for time in (1.0, 1.5, 2.5)]
    ['before', 'loading', 'hold']
    """

    start: FloatArray
    phase: tuple[Phase, ...]

    def __init__(self, start: ArrayLike, phase: Sequence[Phase]) -> None:
        start = real_array(start, "start", LoadingError)
        unknown = [one for one in phase if one not in PHASES]
        if unknown:
            raise LoadingError(f"phase must be one of {', '.join(PHASES)}, found {unknown[0]!r}")
        if start.ndim != 1 or start.size != len(phase):
            raise LoadingError(f"start has shape {start.shape} for {len(phase)} phases: give each its start")
        if not np.isfinite(start).all() or (np.diff(start) < 0).any():
            raise LoadingError(f"starts of phases must be finite and not decrease, found {start.tolist()}")
        set_fields(self, start=start, phase=tuple(phase))

    def at(self, time: float) -> Phase:
        """Return the phase at a time.

        Parameters
        ----------
        time : float
            s.

        Returns
        -------
        {"before", "loading", "hold", "unloading", "after"}
        """
        place = int(np.searchsorted(self.start, time)) - 1
        return "before" if place < 0 else self.phase[place]


def phase_intervals(time: ArrayLike, values: ArrayLike) -> PhaseIntervals:
    """Return the phases that `phases_of` finds in a record, each with the last time before its first sample.

    Parameters
    ----------
    time, values : array_like, (n,)
        As for `phases_of`.

    Returns
    -------
    PhaseIntervals

    Examples
    --------
    >>> time = np.linspace(0, 5, 101)
    >>> phases = phase_intervals(time, np.interp(time, [0, 1, 2, 3, 4, 5], [0, 0, 2, 2, 0, 0]))
    >>> phases.phase
    ('loading', 'hold', 'unloading', 'after')
    """
    time, labels = as_float_array(time), phases_of(time, values)
    changes = np.flatnonzero(np.diff(labels, prepend=np.int8(_BEFORE)))
    earlier = np.concatenate([[-np.inf], time])[changes]
    # A record that begins in contact has no time before.
    start = np.where(np.isfinite(earlier), earlier, np.nextafter(time[:1], -np.inf))
    return PhaseIntervals(start, [PHASES[label] for label in labels[changes]])


def _window(count: int, share: float) -> int:
    """Return an odd number of samples, about a share of a count."""
    return 2 * round(share * count / 2) + 1


def _moving_average(values: FloatArray, window: int) -> FloatArray:
    padded = np.pad(values, window // 2, mode="edge")
    return np.asarray(np.convolve(padded, np.full(window, 1 / window), mode="valid"))
