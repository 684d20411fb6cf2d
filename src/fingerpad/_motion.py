"""Rise, rest and fall of a signal, from its rate of change."""

from typing import Final

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import FloatArray

RISE: Final = 1
REST: Final = 0
FALL: Final = -1

# A signal that changes slower than this share of the usual rate in that direction rests.
_REST_RATE: Final = 0.2


def find_motion(rate: FloatArray, min_samples: int) -> npt.NDArray[np.int8]:
    """Label each sample of a signal as RISE, REST or FALL.

    The usual rate of each direction is the mean weighted with the change. Each half of a run of fewer than
    `min_samples` samples takes the label of the run next to it.
    """
    labels = np.full(rate.size, REST, dtype=np.int8)
    for direction in (RISE, FALL):
        towards = np.maximum(direction * rate, 0)
        if towards.any():
            labels[towards > _REST_RATE * float(np.average(towards, weights=towards))] = direction
    while True:
        starts, ends = runs(labels)
        k = int(np.argmin(ends - starts))
        if starts.size == 1 or ends[k] - starts[k] >= min_samples:
            return labels
        before = labels[starts[k] - 1] if k > 0 else labels[ends[k]]
        after = labels[ends[k]] if k + 1 < starts.size else before
        middle = (starts[k] + ends[k] + 1) // 2
        labels[starts[k] : middle], labels[middle : ends[k]] = before, after


def runs(labels: npt.NDArray[np.int8]) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]:
    """Return the start and the end (excluded) of each run of equal labels."""
    starts = np.flatnonzero(np.diff(labels, prepend=np.int8(9)))
    return starts, np.append(starts[1:], labels.size)
