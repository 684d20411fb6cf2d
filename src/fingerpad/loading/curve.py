"""Loading curves as tables of time, force, displacement and contact area."""

from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array, set_fields
from fingerpad._columns import read_columns, unread_columns
from fingerpad._display import Displayed
from fingerpad.exceptions import LoadingError

# A step in time longer than this many usual ones is a gap.
_GAP = 10.0
_REQUIRED, _OPTIONAL = ("force", "displacement"), ("area", "time")


@dataclass(frozen=True, slots=True, init=False, eq=False, repr=False)
class LoadingCurve(Displayed):
    """One record of a finger pad pressed against a platen, row by row; it may hold several cycles.

    Attributes
    ----------
    load : array_like, shape (n,)
        Normal force W, N, positive in compression, from the sensor's own zero.
    indentation : array_like, shape (n,)
        Displacement of the platen ξ, mm, growing into the pad, from the instrument's own zero.
    area : array_like, shape (n,), or None
        Contact area A, mm², where it was measured; noise may make it negative before contact.
    time : array_like, shape (n,), or None
        Times, s, where they were recorded; without them the samples are taken to be evenly spaced.

    Raises
    ------
    LoadingError
        If there is no row, the columns differ in length, a value is not finite, or time runs backwards.

    Examples
    --------
    >>> curve = LoadingCurve(load=[0.0, 0.1, 0.4], indentation=[1.0, 1.2, 1.5], time=[0.0, 0.1, 0.2])
    >>> curve.area is None, curve.clock
    (True, array([0. , 0.1, 0.2]))
    """

    load: FloatArray
    indentation: FloatArray
    area: FloatArray | None
    time: FloatArray | None

    def __init__(
        self,
        *,
        load: ArrayLike,
        indentation: ArrayLike,
        area: ArrayLike | None = None,
        time: ArrayLike | None = None,
    ) -> None:
        given = {"load": load, "indentation": indentation, "area": area, "time": time}
        set_fields(
            self,
            **{
                name: it if it is None else as_float_array(it, name, LoadingError)
                for name, it in given.items()
            },
        )
        for name in given:
            values: FloatArray | None = getattr(self, name)
            if values is None:
                continue
            if np.ndim(values) != 1 or len(values) != len(self.load):
                raise LoadingError(
                    f"{name} has shape {np.shape(values)}; load has {np.shape(self.load)}: a curve has one "
                    "value of each quantity per row"
                )
            bad = np.flatnonzero(~np.isfinite(values))
            if bad.size:
                raise LoadingError(f"{name} is not finite in row {bad[0] + 1}: leave such rows out")
        if not len(self.load):
            raise LoadingError("a loading curve needs one row or more, found none")
        if self.time is not None and (np.diff(self.time) < 0).any():
            row = int(np.flatnonzero(np.diff(self.time) < 0)[0]) + 2
            raise LoadingError(
                f"time runs backwards at row {row}: {self.time[row - 2]:g} s is followed by "
                f"{self.time[row - 1]:g} s; sort the rows, or read each record separately"
            )

    @property
    def clock(self) -> FloatArray:
        """Times from the start, or row numbers where no times were recorded.

        Rows that share a time, as of a clock slower than the samples, are spread evenly up to the next.
        """
        rows = np.arange(float(len(self.load)))
        if self.time is None:
            return rows
        first = np.append(True, np.diff(self.time) > 0)
        if first.sum() < 2:
            raise LoadingError(f"the time is {self.time[0]:g} s in every row: leave the column out")
        step = (self.time[-1] - self.time[0]) / (rows[first][-1] - rows[0])
        ends = np.append(rows[first], rows[-1] + 1), np.append(self.time[first], self.time[-1] + step)
        return np.asarray(np.interp(rows, *ends) - self.time[0])

    @property
    def doubts(self) -> tuple[str, ...]:
        """Flags of the times: ``duplicated_time``, ``time_gap``."""
        if self.time is None or len(self.time) < 3:
            return ()
        steps = np.diff(self.time)
        found = {"duplicated_time": (steps == 0).any(), "time_gap": steps.max() > _GAP * np.median(steps)}
        return tuple(name for name, seen in found.items() if seen)


def read_loading_curve(path: str | PathLike[str], columns: Mapping[str, str] | None = None) -> LoadingCurve:
    r"""Read a loading curve from a CSV file.

    The header names a quantity and its unit, as in ``time_s, force_N, displacement_mm, area_mm2`` or
    ``Time (s), Load [mN], Disp / um``; other units are converted. Time and area may be absent. Columns of
    other names are left alone. Units may stand in a line of their own below the header. Cells are separated
    by commas, semicolons or tabs, the latter two with decimal points or commas.

    Parameters
    ----------
    path : path-like
        The CSV file, with a header line.
    columns : mapping, optional
        From a quantity (``force``, ``displacement``, ``area``, ``time``) to ``"HEADER:UNIT"`` where the
        file's own headers differ.

    Returns
    -------
    LoadingCurve
        In N, mm, mm² and s.

    Raises
    ------
    LoadingError
        If the file cannot be read, a column is missing or has an unknown unit, a cell is not a finite
        number, or time runs backwards. The message names file, column and line.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "press.csv")
    ...     _ = path.write_text("time_s,force_mN,displacement_mm\n0,0,1.0\n0.1,250,1.5\n")
    ...     read_loading_curve(path).load
    array([0.  , 0.25])
    """
    path = Path(path)
    found = read_columns(path, _REQUIRED, _OPTIONAL, columns=columns)
    try:
        return LoadingCurve(
            load=found["force"],
            indentation=found["displacement"],
            area=found.get("area"),
            time=found.get("time"),
        )
    except LoadingError as error:
        raise LoadingError(f"{path}: {error}") from error


def unread_curve_columns(path: Path, columns: Mapping[str, str] | None = None) -> dict[str, list[str]]:
    """Return the columns that `read_loading_curve` leaves alone, and that may be an area or a time."""
    return unread_columns(path, (*_REQUIRED, *_OPTIONAL), columns)
