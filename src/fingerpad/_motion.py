"""Rise, rest and fall of a signal, from its rate of change."""

from typing import Final

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import FloatArray

RISE: Final = 1
REST: Final = 0
FALL: Final = -1

# A signal that changes slower than this share of the usual rate rests.
_REST_RATE: Final = 0.2


def usual_rate(rate: FloatArray, step: FloatArray | float = 1.0) -> float:
    """Return the mean of non-negative rates, weighted with the change that each makes in its step of time."""
    return float(np.average(rate, weights=rate * step)) if rate.any() else 0.0


def find_motion(rate: FloatArray, *, rising: float, falling: float, min_samples: int) -> npt.NDArray[np.int8]:
    """Label each sample of a signal as RISE, REST or FALL.

    `rising` and `falling` are the usual rates in the two directions. Each half of a run of fewer than
    `min_samples` samples takes the label of the run next to it.
    """
    labels = np.where(rate > _REST_RATE * rising, RISE, np.where(-rate > _REST_RATE * falling, FALL, REST))
    while True:
        starts, ends = runs(labels)
        k = int(np.argmin(ends - starts))
        if starts.size == 1 or ends[k] - starts[k] >= min_samples:
            return labels.astype(np.int8)
        before = labels[starts[k] - 1] if k > 0 else labels[ends[k]]
        after = labels[ends[k]] if k + 1 < starts.size else before
        middle = (starts[k] + ends[k] + 1) // 2
        labels[starts[k] : middle], labels[middle : ends[k]] = before, after


def runs(labels: npt.NDArray[np.integer]) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]:
    """Return the start and the end (excluded) of each run of equal labels."""
    starts = np.flatnonzero(np.diff(labels, prepend=9))
    return starts, np.append(starts[1:], labels.size)
