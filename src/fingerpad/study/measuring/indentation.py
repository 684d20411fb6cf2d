"""Indentation during a sequence: the platen's displacement from the place of contact."""

from typing import Final

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad.exceptions import LoadingError
from fingerpad.image import ForceSignal
from fingerpad.loading.cycles import fit_contact_start

_MIN_ROWS: Final = 6
# The way in is fitted up to this share of the largest force, beyond which tissue stiffens.
_FITTED: Final = 0.5


def first_contact_displacement(signal: ForceSignal) -> float:
    """Return the displacement at which the force begins to rise.

    A level and a Hertzian rise that stiffens, W = W₀ + a s + b s² with s = (x − x₀)^(3/2), are fitted to the
    first press, up to half of the largest force. The stage is taken as rigid.

    Parameters
    ----------
    signal : ForceSignal
        With a displacement.

    Returns
    -------
    float
        x₀, mm.

    Raises
    ------
    LoadingError
        If no displacement was recorded, there are fewer than six rows of the way in, or contact is made
        before the record begins.

    Examples
    --------
    >>> time = np.linspace(0, 1, 101)
    >>> load = 2 * np.maximum(time - 0.2, 0) ** 1.5
    >>> signal = ForceSignal(time, load, displacement=5 + time)
    >>> round(first_contact_displacement(signal), 2)
    5.2
    """
    if signal.displacement is None:
        raise LoadingError("no displacement was recorded beside the force")
    low = float(signal.load.min())
    level = low + _FITTED * (float(signal.load.max()) - low)
    stop = int(np.argmax(signal.load >= level)) + 1
    if stop < _MIN_ROWS:
        raise LoadingError(
            f"the place of contact is unknown: the force passes half of its largest value after {stop} rows; "
            f"{_MIN_ROWS} are needed"
        )
    way_in: FloatArray = signal.displacement[:stop]
    place, _ = fit_contact_start(signal.time[:stop], signal.load[:stop], way_in, tilt=False)
    if not place > way_in.min():
        raise LoadingError(
            "the place of contact is unknown: the record begins in contact; record some of the approach"
        )
    return place
