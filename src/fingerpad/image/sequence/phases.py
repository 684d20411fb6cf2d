"""Loading, hold and unloading in a record of force or of contact area."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal, TypeAlias

import numpy as np
import numpy.typing as npt
from scipy.ndimage import uniform_filter1d

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
    """Return the phase of each sample of a record, as an index into `PHASES`; it may hold several presses.

    The record, force or what grows with contact, is smoothed over a fiftieth of the contact. It is held where
    it changes at less than a fifth of the ramps' rates (means weighted with the change); what lasts less than
    a twenty-fifth of the contact is merged with its neighbours.
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
    values = _running_mean(values, _SMOOTHING / 2 * values.size)
    low, high = float(values.min()), float(values.max())
    touching = np.flatnonzero(values > low + _CONTACT_LEVEL * (high - low))
    if not high > low or touching.size < 3:
        return labels
    first, last = int(touching[0]), int(touching[-1])
    labels[last + 1 :] = _AFTER
    count = _SMOOTHING * (last - first + 1)
    smooth = _running_mean(values, count)
    rate = _running_mean(np.gradient(smooth, time), count)[first : last + 1]
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
    """Phases, each by the time after which it begins, s; up to the first it is ``before``."""

    start: FloatArray  # (n,); not decreasing: a phase that begins with the next is empty
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
        """Return the phase at a time, s."""
        place = int(np.searchsorted(self.start, time)) - 1
        return "before" if place < 0 else self.phase[place]


def phase_intervals(time: ArrayLike, values: ArrayLike) -> PhaseIntervals:
    """Return the phases that `phases_of` finds, each with the last time before its first sample."""
    time, labels = as_float_array(time), phases_of(time, values)
    changes = np.flatnonzero(np.diff(labels, prepend=np.int8(_BEFORE)))
    earlier = np.concatenate([[-np.inf], time])[changes]
    # A record that begins in contact has no time before.
    start = np.where(np.isfinite(earlier), earlier, np.nextafter(time[:1], -np.inf))
    return PhaseIntervals(start, [PHASES[label] for label in labels[changes]])


def _running_mean(values: FloatArray, count: float) -> FloatArray:
    """Return means over the odd number of samples next to a count."""
    return np.asarray(uniform_filter1d(values, 2 * round(count / 2) + 1, mode="nearest"))
