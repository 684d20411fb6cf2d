"""Read a force signal and the times of frames from tables."""

from collections.abc import Mapping
from os import PathLike
from pathlib import Path

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad._columns import read_columns, unread_columns
from fingerpad.exceptions import LoadingError
from fingerpad.image.sequence.force import ForceSignal, FrameStamps

# A signal that goes so many times further below zero than above has the wrong sign.
_REVERSED = 2.0
_REQUIRED, _OPTIONAL = ("time", "force"), ("trigger", "displacement")


def read_force_signal(path: str | PathLike[str], columns: Mapping[str, str] | None = None) -> ForceSignal:
    r"""Read a force signal from a table with columns like ``time_s, force_N`` or ``Time (s), Load [mN]``.

    ``trigger_V`` and ``displacement_mm`` may stand beside them.

    Parameters
    ----------
    path : path-like
        A CSV, XLSX or MAT file, with a header line or names of vectors that names quantities and units.
    columns : mapping, optional
        From a quantity (``time``, ``force``, ``trigger``, ``displacement``) to ``"HEADER:UNIT"`` where
        headers differ.

    Returns
    -------
    ForceSignal
        In s, N, V and mm.

    Raises
    ------
    LoadingError
        If the file cannot be read, a column is missing or has an unknown unit, a cell is not a finite
        number, time does not increase, there are fewer than two rows, or force or displacement has no range
        or the wrong sign.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "force.csv")
    ...     _ = path.write_text("time_s,force_mN\n0,0\n0.1,500\n0.2,2000\n")
    ...     read_force_signal(path).load
    array([0. , 0.5, 2. ])
    """
    path = Path(path)
    found = read_columns(path, _REQUIRED, _OPTIONAL, columns=columns)
    try:
        signal = ForceSignal(
            found["time"], found["force"], found.get("trigger"), displacement=found.get("displacement")
        )
    except LoadingError as error:
        raise LoadingError(f"{path}: {error}") from error
    low, high = float(signal.load.min()), float(signal.load.max())
    if low == high:
        raise LoadingError(f"{path}: the force is {low:g} N throughout; a press needs a range of it")
    if -low > _REVERSED * max(high, 0.0):
        raise LoadingError(
            f"{path}: the force goes down to {low:g} N and up to {high:g} N only; it is positive in "
            "compression: reverse its sign"
        )
    if signal.displacement is not None:
        _require_pressing(path, signal.load, signal.displacement)
    return signal


def unread_force_columns(path: Path, columns: Mapping[str, str] | None = None) -> dict[str, list[str]]:
    """Return the columns that `read_force_signal` leaves alone, and that may be a trigger or displacement."""
    return unread_columns(path, (*_REQUIRED, *_OPTIONAL), columns)


def _require_pressing(path: Path, load: FloatArray, displacement: FloatArray) -> None:
    """Raise if a displacement cannot be that of a platen that presses a pad."""
    if np.ptp(displacement) == 0:
        raise LoadingError(
            f"{path}: the displacement is {displacement[0]:g} mm throughout: give the column another name "
            "if nothing was recorded"
        )
    if np.dot(load - load.mean(), displacement - displacement.mean()) < 0:
        raise LoadingError(
            f"{path}: the displacement falls while the force rises; it grows into the pad: reverse its sign"
        )


def read_frame_stamps(path: str | PathLike[str], columns: Mapping[str, str] | None = None) -> FrameStamps:
    r"""Read the time of each frame from a table with a column like ``time_s``, one row for each frame.

    Parameters
    ----------
    path : path-like
        A CSV, XLSX or MAT file.
    columns : mapping, optional
        ``{"time": "HEADER:UNIT"}`` where the header differs.

    Returns
    -------
    FrameStamps
        In s.

    Raises
    ------
    LoadingError
        If the file cannot be read, has no such column, or time does not increase.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "stamps.csv")
    ...     _ = path.write_text("time_ms\n0\n40\n80\n")
    ...     read_frame_stamps(path).time
    array([0.  , 0.04, 0.08])
    """
    path = Path(path)
    try:
        return FrameStamps(read_columns(path, ("time",), columns=columns)["time"])
    except LoadingError as error:
        raise LoadingError(str(error) if str(path) in str(error) else f"{path}: {error}") from error
