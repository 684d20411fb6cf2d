"""How well the frames of a sequence and its force are aligned in time."""

from typing import Final

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array
from fingerpad.exceptions import LoadingError
from fingerpad.image.sequence.force import ForceSignal

_MIN_FRAMES: Final = 5
# Below this share of the largest load the zero of the sensor matters more than the time.
_LEAST_LOAD: Final = 0.02


def alignment_scatter(
    time: ArrayLike, area: ArrayLike, signal: ForceSignal, shift: ArrayLike = 0.0
) -> FloatArray:
    """Return the scatter of contact areas about a power law of the load, for frames displaced in time.

    Where frames are late, an area while the load grows is that of a smaller load, and one while it falls that
    of a greater one. A pad that creeps or dissipates does the same in part: the least scatter is where frames
    and force agree best, which is no proof that they do.

    Parameters
    ----------
    time : array_like, shape (n,)
        Times of the frames, s, on the clock of the signal.
    area : array_like, shape (n,)
        Contact areas of the frames, mm²; frames without one are left out.
    signal : ForceSignal
        The load.
    shift : array_like, shape (m,)
        Time added to all frames, s.

    Returns
    -------
    ndarray, shape (m,)
        Root mean square of the residuals of ln A, a relative standard deviation; NaN where fewer than five
        frames lie in the signal.

    Raises
    ------
    LoadingError
        If times and areas differ in length.

    Examples
    --------
    >>> signal = ForceSignal([0, 1, 2, 3], [0, 2, 2, 0])
    >>> time = np.linspace(0.1, 2.9, 50)
    >>> late = 40 * signal.load_at(time) ** 0.6
    >>> scatter = alignment_scatter(time + 0.05, late, signal, [-0.1, -0.05, 0.0])
    >>> scatter.round(3)
    array([0.088, 0.   , 0.088])
    """
    time, area = as_float_array(time), as_float_array(area)
    if time.ndim != 1 or time.shape != area.shape:
        raise LoadingError(f"time has shape {time.shape} and area {area.shape}: give one area for each frame")
    measured = np.isfinite(time) & (area > 0)
    time, grown = time[measured], np.log(area[measured])
    shifts = as_float_array(shift)
    found = [_scatter(signal.load_at(time + by), grown, signal) for by in np.atleast_1d(shifts)]
    return np.array(found).reshape(shifts.shape)


def _scatter(load: FloatArray, grown: FloatArray, signal: ForceSignal) -> float:
    used = load > _LEAST_LOAD * signal.load.max()
    if np.count_nonzero(used) < _MIN_FRAMES:
        return np.nan
    x, y = np.log(load[used]), grown[used]
    design = np.column_stack([np.ones_like(x), x])
    residuals = y - design @ np.linalg.lstsq(design, y, rcond=None)[0]
    return float(np.sqrt(np.mean(residuals**2)))
