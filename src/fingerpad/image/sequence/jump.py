"""Jumps of the contact area that the load does not explain, as where frames are lost."""

from typing import Final

import numpy as np

from fingerpad._arrays import BoolArray, FloatArray, as_float_array, robust_std

# A jump exceeds what the changes around it lead to expect.
_LEAST: Final = 0.07  # by this share of the area,
_DEVIATIONS: Final = 6.0  # by so many times the scatter of such excesses,
_TIMES_EXPECTED: Final = 1.5  # and by so many times what is expected
_LASTING: Final = 0.7  # of it; the least of three areas after it exceeds the largest of three before by this
_MIN_TESTED: Final = 4
_HERTZ: Final = 2 / 3


def find_jump(time: FloatArray, load: FloatArray, area: FloatArray, loading: BoolArray) -> int | None:
    """Return the frame in contact after which the area jumps up while the load does not; None without one.

    All frames after lost ones are late by as much, and their areas too large for their loads. Each change
    between two `loading` frames is compared with the mean rate of the two before and the two after it; where
    the load grows faster than at its own mean rate, by Hertz theory, so may the area.
    """
    if time.size < _MIN_TESTED + 5 or not load.max() > 0:
        return None
    tested, apart = np.arange(2, time.size - 3), np.diff(time)
    around = tested + np.array([[-2], [-1], [1], [2]])

    def usual_of(changes: FloatArray) -> FloatArray:
        """Return what is expected of each change from those around it."""
        return as_float_array(np.mean((changes / apart)[around], axis=0) * apart[tested])

    by_load = area.max() * (np.maximum(load, 0) / load.max()) ** _HERTZ
    grown, driven = np.diff(area), np.diff(by_load)
    middle = (area[tested] + area[tested + 1]) / 2
    faster = np.maximum(driven[tested] - usual_of(driven), 0)
    excess = (grown[tested] - usual_of(grown) - faster) / middle
    expected = usual_of(np.abs(grown)) / middle
    before, after = (np.log(area)[tested + np.array(near)[:, None]] for near in ([-2, -1, 0], [1, 2, 3]))
    both = loading[tested] & loading[tested + 1]
    if np.count_nonzero(both) < _MIN_TESTED:
        return None
    scatter = robust_std(excess - np.median(excess))
    least = np.maximum(max(_LEAST, _DEVIATIONS * scatter), _TIMES_EXPECTED * expected)
    jumps = both & (excess > least) & (after.min(axis=0) - before.max(axis=0) > _LASTING * excess)
    return int(tested[np.argmax(np.where(jumps, excess, -np.inf))]) if jumps.any() else None
