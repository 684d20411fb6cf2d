"""Loading curves: tables of time, force, displacement and contact area, and the presses in them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from os import PathLike
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import ArrayLike, BoolArray, FloatArray, as_float_array, set_fields
from fingerpad._columns import read_columns, unread_columns
from fingerpad._display import Displayed
from fingerpad._motion import FALL, REST, RISE, find_motion, runs, usual_rate
from fingerpad.exceptions import LoadingError
from fingerpad.loading.contact_point import BOTH_REVERSED, both_reversed, fit_contact_start

# A step in time longer than this many usual ones is a gap.
_GAP = 10.0
# Shortest phase, and shortest way back or forth, as shares of the record.
_MIN_DURATION, _MIN_WAY = 0.02, 0.03
# Rise of the force, as a share of all, by which the pad is surely touched.
_TOUCHED = 0.1
# Rows at the sensor's very maximum, while the platen still moves, that show it was saturated.
_SATURATED_ROWS = 4
_SMOOTHING = 50
# An area this near to contact, as a share of the depth, may be cut off at zero by its noise.
_NEAR_CONTACT = 0.1
# A press is taken to last so many times as long as its way in.
_PRESS = 4
# Required, and optional.
CURVE_COLUMNS: Final = (("force", "displacement"), ("area", "time"))


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
        Contact area A, mm²; noise may make it negative before contact. NaN in rows without one, as where
        the camera is slower than the force.
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
            bad = np.flatnonzero(np.isinf(values) if name == "area" else ~np.isfinite(values))
            if name == "area" and np.isnan(values).all():
                raise LoadingError("area is unknown in every row: leave it out")
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
    r"""Read a loading curve from a CSV, XLSX, MAT or TDMS file.

    The header names a quantity and its unit, as in ``time_s, force_N, displacement_mm, area_mm2`` or
    ``Time (s), Load [mN], Disp / um``; other units are converted. Time and area may be absent. Columns of
    other names are left alone. Units may stand in a line of their own below the header. Cells are separated
    by commas, semicolons or tabs, the latter two with decimal points or commas. Of a workbook the first sheet
    is read, or the only one with force and displacement; of a MAT file (version 7 or below) the vectors,
    named as headers are. Cells of the area may be empty.

    Parameters
    ----------
    path : path-like
        The file, with a header line.
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
    found = read_columns(path, *CURVE_COLUMNS, columns=columns)
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
    return unread_columns(path, sum(CURVE_COLUMNS, ()), columns)


# --- the presses of a record, from the platen's motion ---


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Segment(Displayed):
    """The rows from `start` to `stop`, the latter left out."""

    start: int
    stop: int

    @property
    def rows(self) -> slice:
        """The rows as a slice."""
        return slice(self.start, self.stop)

    def __len__(self) -> int:
        return self.stop - self.start


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Cycle(Displayed):
    """One press.

    Attributes
    ----------
    baseline, hold, unloading : Segment or None
        Rows before contact, at rest in contact and on the way back, where there are any.
    loading : Segment
        Rows in contact on the way in.
    """

    baseline: Segment | None
    loading: Segment
    hold: Segment | None
    unloading: Segment | None

    def as_record(self) -> dict[str, list[int] | None]:
        """Return the first and last row of each phase, counted from zero."""
        return {
            name: None if segment is None else [segment.start, segment.stop - 1]
            for name, segment in self.phases().items()
        }

    def phases(self) -> dict[str, Segment | None]:
        """Return the phases by name, in their order; None for one that is absent."""
        return {field.name: getattr(self, field.name) for field in fields(self)}


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Hysteresis(Displayed):
    """Energy that a cycle lost.

    Attributes
    ----------
    energy : float
        ∮W dξ, N mm = mJ.
    fraction : float
        Share of the work of loading, where the platen came back.
    """

    energy: float
    fraction: float


def moving_average(values: FloatArray, rows: int | None = None) -> FloatArray:
    """Return a moving average over a fiftieth of `rows`, all of them without it, straight at its ends."""
    window = 2 * ((len(values) if rows is None else rows) // (2 * _SMOOTHING)) + 1
    if window < 3:
        return np.asarray(values, dtype=np.float64)
    from scipy import signal  # noqa: PLC0415 (slow to import, not needed for images)

    return np.asarray(signal.savgol_filter(values, window, 1))


def find_cycles(curve: LoadingCurve) -> tuple[Cycle, ...]:
    """Find baseline, loading, hold and unloading of each cycle.

    The platen's motion shows the phases: it moves into the pad, rests, or moves away. On the way in, contact
    begins where a line followed by a Hertzian rise fits the force best.

    Parameters
    ----------
    curve : LoadingCurve
        The record.

    Returns
    -------
    tuple of Cycle
        In order of time.

    Raises
    ------
    LoadingError
        If there are fewer than six rows, the force or the displacement is the same in all, or the platen
        never moves into the pad.

    Examples
    --------
    >>> from fingerpad.simulate import simulate_loading_curve
    >>> (cycle,) = find_cycles(simulate_loading_curve(points=200, hold=0.5, unloading=True))
    >>> len(cycle.baseline), len(cycle.loading), len(cycle.hold), len(cycle.unloading)
    (18, 69, 26, 87)
    """
    _require_usable(curve)
    phases = _phases(curve)
    starts, ends = runs(phases)
    cycles = []
    for k, (start, end) in enumerate(zip(starts, ends, strict=True)):
        if phases[start] != RISE:
            continue
        later = [
            (int(phases[a]), Segment(start=int(a), stop=int(b)))
            for a, b in zip(starts[k + 1 :], ends[k + 1 :], strict=True)
        ]
        hold = later[0][1] if later and later[0][0] == REST else None
        after = later[1:] if hold else later
        unloading = after[0][1] if after and after[0][0] == FALL else None
        before = start - 1 if k and phases[start - 1] == REST else start
        begin = int(starts[k - 1]) if before < start else int(start)
        contact = begin + _contact_row(curve, begin, int(end))
        cycles.append(
            Cycle(
                baseline=Segment(start=begin, stop=contact) if contact > begin else None,
                loading=Segment(start=contact, stop=int(end)),
                hold=hold,
                unloading=unloading,
            )
        )
    if not cycles:
        if both_reversed(curve.clock, curve.load, curve.indentation):
            raise LoadingError(BOTH_REVERSED)
        few = max(1, curve.load.size // _SMOOTHING)
        if curve.load[:few].mean() - curve.load[-few:].mean() > np.ptp(curve.load) / 2:
            raise LoadingError(
                "the displacement never grows, and the force falls with it: the record holds the way out "
                "alone; record the way in, from before contact"
            )
        raise LoadingError("the displacement never grows: it must grow into the pad; reverse its sign")
    return tuple(cycles)


def choose_cycle(curve: LoadingCurve, cycle: int) -> tuple[tuple[Cycle, ...], Cycle]:
    """Return all cycles of a record and one of them, counted from zero. Raise LoadingError without it."""
    cycles = find_cycles(curve)
    if not 0 <= cycle < len(cycles):
        raise LoadingError(f"the record has {len(cycles)} cycles, numbered from 0; there is no {cycle}")
    return cycles, cycles[cycle]


def hysteresis(curve: LoadingCurve, cycle: Cycle) -> Hysteresis | None:
    """Return the energy lost between loading and unloading.

    The force's zero is the mean of the baseline, where there is one.

    Parameters
    ----------
    curve : LoadingCurve
        The record.
    cycle : Cycle
        One of its presses.

    Returns
    -------
    Hysteresis or None
        None where the cycle has no unloading.

    Examples
    --------
    >>> from fingerpad.simulate import simulate_loading_curve
    >>> curve = simulate_loading_curve(points=200, unloading=True, hysteresis=0.3)
    >>> lost = hysteresis(curve, find_cycles(curve)[0])
    >>> print(f"{lost.energy:.2f} mJ, {lost.fraction:.0%}")
    0.11 mJ, 8%
    """
    if cycle.unloading is None:
        return None
    zero = float(np.mean(curve.load[cycle.baseline.rows])) if cycle.baseline else 0.0
    last = cycle.unloading.stop
    depth, load = curve.indentation[cycle.loading.start : last], curve.load[cycle.loading.start : last] - zero
    # Only where both ways were, which is not before first contact.
    kept = depth >= max(depth[0], depth[len(cycle.loading) :].min())
    way_in = kept & (np.arange(depth.size) < len(cycle.loading))
    energy = float(np.trapezoid(load[kept], depth[kept]))
    work = float(np.trapezoid(load[way_in], depth[way_in]))
    return Hysteresis(energy=energy, fraction=energy / work) if work > 0 else None


def rows_in_contact(curve: LoadingCurve, cycle: Cycle) -> npt.NDArray[np.intp]:
    """Return the rows of a loading in which an area is far enough above zero not to be cut off there."""
    begin = (cycle.baseline or cycle.loading).start
    before = cycle.loading.start - begin
    smooth = moving_average(curve.indentation[begin : cycle.loading.stop])
    contact = smooth[before]
    return begin + np.flatnonzero(smooth > contact + _NEAR_CONTACT * (smooth.max() - contact))


def saturated_rows(curve: LoadingCurve, segment: Segment, values: FloatArray | None = None) -> BoolArray:
    """Return which rows of a loading lie at the sensor's limit: the very same maximum in several rows.

    A force that is rounded stands still at every step; at the limit it does so for as long as at several.
    Other `values` of the curve may be looked at, such as its areas.
    """
    seen = (curve.load if values is None else values)[segment.rows]
    at_top = seen == np.fmax.reduce(seen)
    step = int(np.count_nonzero(seen == np.fmax.reduce(seen[~at_top], initial=-np.inf)))
    many = not at_top.all() and int(at_top.sum()) >= _SATURATED_ROWS * max(step, 1)
    return np.asarray(at_top & bool(many and np.ptp(curve.indentation[segment.rows][at_top]) > 0))


def rows_with_area(curve: LoadingCurve, cycle: Cycle) -> npt.NDArray[np.intp]:
    """Return the rows in contact while the load grows whose area was measured and is no limit."""
    if curve.area is None:
        return np.zeros(0, dtype=np.intp)
    rows = np.setdiff1d(rows_in_contact(curve, cycle), clipped_areas(curve, cycle))
    return rows[np.isfinite(curve.area[rows])]


def clipped_areas(curve: LoadingCurve, cycle: Cycle) -> npt.NDArray[np.intp]:
    """Return the rows in contact whose area is none: exactly zero, or the limit of the camera's frame."""
    if curve.area is None:
        return np.zeros(0, dtype=np.intp)
    contact = rows_in_contact(curve, cycle)
    limit = cycle.loading.start + np.flatnonzero(saturated_rows(curve, cycle.loading, curve.area))
    return np.union1d(contact[curve.area[contact] == 0], np.intersect1d(contact, limit))


def _require_usable(curve: LoadingCurve) -> None:
    if curve.load.size < 6:
        raise LoadingError(f"{curve.load.size} rows in the curve; at least 6 are needed")
    for name, unit, values in (("force", "N", curve.load), ("displacement", "mm", curve.indentation)):
        if not np.ptp(values) > 0:
            raise LoadingError(
                f"the {name} is {values[0]:g} {unit} in every row; a curve needs a range of it"
            )


def _phases(curve: LoadingCurve) -> npt.NDArray[np.int8]:
    """Return the phase of each row; a way in that is short beside holds is looked at more finely."""
    phases = _phases_over(curve, len(curve.load))
    edges = np.flatnonzero(np.diff(phases == RISE, prepend=False, append=False))
    shortest = int(np.min(edges[1::2] - edges[::2])) if edges.size else len(curve.load)
    few = _PRESS * shortest
    return _phases_over(curve, few) if few < len(curve.load) else phases


def _phases_over(curve: LoadingCurve, rows: int) -> npt.NDArray[np.int8]:
    smooth = moving_average(curve.indentation, rows)
    # Times are smoothed alike, for clocks that jitter.
    step = np.gradient(moving_average(curve.clock, rows))
    rate = np.gradient(smooth) / step
    least = max(2, round(_MIN_DURATION * smooth.size))
    level = float(np.mean(curve.load[:least]))
    touched = curve.load > level + _TOUCHED * np.ptp(curve.load)

    def usual(sign: int, counted: BoolArray) -> float:
        return usual_rate(np.maximum(sign * rate, 0)[counted], step[counted])

    whole = np.ones_like(touched)
    # An approach may be faster than the press, and a way out than either.
    rising, falling = usual(RISE, touched) or usual(RISE, whole), usual(FALL, whole)
    out = np.maximum.accumulate(smooth) - smooth
    into = smooth - np.minimum.accumulate(smooth)
    # In a record of one direction the other is noise.
    shortest = _MIN_WAY * float(np.ptp(smooth))
    falling = falling if out.max() > shortest else max(rising, falling)
    rising = rising if into.max() > shortest else max(rising, falling)
    labels = find_motion(rate, rising=rising, falling=falling, min_samples=least)
    # Until the pad is touched the platen may go in at any speed, and rest.
    for start, end in zip(*runs((labels == FALL).astype(np.int8)), strict=True):
        if labels[start] != FALL and touched[start:end].any():
            labels[start : start + int(np.argmax(touched[start:end]))] = RISE
    # Smoothing moves the top, and hides a way out of a few rows.
    starts, ends = runs(labels)
    for k, (start, end) in enumerate(zip(starts, ends, strict=True)):
        turns = k + 1 < starts.size and labels[end] == FALL
        stop = ends[k + 1] if turns else end
        if labels[start] == RISE:
            way = curve.indentation[start:stop]
            last = int(np.argmax(way)) + 1
            if turns or way[last - 1] - way[-1] > shortest:
                labels[start : start + last], labels[start + last : stop] = RISE, FALL
    return labels


def _contact_row(curve: LoadingCurve, start: int, end: int) -> int:
    """Return how many rows of the way in lie before contact."""
    displacement = moving_average(curve.indentation[start:end])
    place, _ = fit_contact_start(
        curve.clock[start:end], curve.load[start:end], displacement, tilt=end - start > 12
    )
    return min(int(np.searchsorted(np.maximum.accumulate(displacement), place)), end - start - 1)
