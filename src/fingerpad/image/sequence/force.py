"""A force signal: its samples, the clock of the frames on its time, and how well both are aligned."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from types import UnionType
from typing import Final, TypeAlias

import numpy as np

from fingerpad._arrays import (
    ArrayLike,
    FloatArray,
    as_float_array,
    finite_number,
    positive_number,
    real_array,
    real_number,
    set_fields,
)
from fingerpad._columns import read_columns, unread_columns
from fingerpad._display import Displayed
from fingerpad.exceptions import LoadingError
from fingerpad.image.sequence.phases import phase_intervals

_MIN_SAMPLES = 2
_MIN_FRAMES: Final = 5  # fewer frames do not tell how well they are aligned with the force
_LEAST_LOAD: Final = 0.02  # of the largest; at less the zero of the sensor matters more than the time
_REVERSED = 2.0  # a signal that goes so many times further below zero than above has the wrong sign
_STAYS_ABOVE: Final = 0.8  # of the samples from first contact until the force is clear of its noise
_LEVELS_APART: Final = 5.0  # standard deviations, of a trigger; halves of noise are 3 apart, of a sine wave 4
# The zero of a force without contact.
_MIN_BEFORE: Final = 4  # frames or samples, or more, show it
_WELL_BEFORE: Final = 2 / 3  # of the time before contact, from its beginning
_STEADY: Final = 0.25  # of it; its halves agree to this
_DEVIATIONS: Final = 5.0  # standard deviations that it is from zero
_LEAST_ZERO: Final = 0.005  # of the largest load; it is more
_LEAST_CONTACT: Final = 0.05  # of the range above the lowest values; a hold is further up
_SEEN_OF_LARGEST: Final = 0.05  # of the largest area; such a touch is surely seen,
_SEEN_OF_FIRST: Final = 1.2  # or of that of the first frame in contact
FORCE_KIND: Final = "a ForceSignal, as read_force_signal reads it"
# Required, and optional.
FORCE_COLUMNS: Final = (("time", "force"), ("trigger", "displacement"))


@dataclass(frozen=True, slots=True, init=False, eq=False, repr=False)
class ForceSignal(Displayed):
    """Normal force against time, at its own sampling rate.

    Attributes
    ----------
    time : array_like, (n,)
        Times of the samples, s, strictly increasing.
    load : array_like, (n,)
        Normal force W, N, from the instrument's own zero, positive in compression.
    trigger : array_like or None, (n,)
        Level of the line that starts the camera, V, where it was recorded.
    displacement : array_like or None, (n,)
        Displacement of the platen, mm, growing into the pad, from the instrument's own zero, where it was
        recorded.

    Raises
    ------
    LoadingError
        If there are fewer than two samples, the lengths differ, a value is not finite, or time does not
        increase from each sample to the next.

    Examples
    --------
    >>> signal = ForceSignal([0.0, 0.1, 0.2], [0.0, 1.0, 2.0])
    >>> signal.load_at([0.05, 0.25])
    array([0.5, nan])
    """

    time: FloatArray
    load: FloatArray
    trigger: FloatArray | None
    displacement: FloatArray | None

    def __init__(
        self,
        time: ArrayLike,
        load: ArrayLike,
        trigger: ArrayLike | None = None,
        displacement: ArrayLike | None = None,
    ) -> None:
        given = {"time": time, "load": load, "trigger": trigger, "displacement": displacement}
        channels = {
            name: real_array(values, name, LoadingError)
            for name, values in given.items()
            if values is not None or name in ("time", "load")
        }
        time = channels["time"]
        if time.ndim == 1 and time.size < _MIN_SAMPLES:
            raise LoadingError(f"a signal over time needs {_MIN_SAMPLES} samples or more, found {time.size}")
        for name, values in channels.items():
            if values.ndim != 1 or values.size < _MIN_SAMPLES or values.shape != time.shape:
                raise LoadingError(
                    f"{name} must be a row of {max(time.size, _MIN_SAMPLES)} samples like time, "
                    f"found shape {values.shape}"
                )
            if not np.isfinite(values).all():
                at = int(np.argmin(np.isfinite(values)))
                raise LoadingError(f"{name} is not finite at sample {at}: fill it or cut it off")
        _require_increasing(time, "time")
        set_fields(self, **{name: channels.get(name) for name in given})

    @property
    def span(self) -> tuple[float, float]:
        """First and last time, s."""
        return float(self.time[0]), float(self.time[-1])

    def load_at(self, time: ArrayLike) -> FloatArray:
        """Return the load at some times by linear interpolation.

        Parameters
        ----------
        time : array_like
            s.

        Returns
        -------
        ndarray
            N, NaN outside the signal.
        """
        return self._at(time, self.load)

    def displacement_at(self, time: ArrayLike) -> FloatArray:
        """Return the displacement at some times by linear interpolation.

        Parameters
        ----------
        time : array_like
            s.

        Returns
        -------
        ndarray
            mm, NaN outside the signal and where none was recorded.
        """
        return self._at(time, self.displacement)

    def _at(self, time: ArrayLike, values: FloatArray | None) -> FloatArray:
        known = np.full_like(self.time, np.nan) if values is None else values
        return np.asarray(np.interp(as_float_array(time), self.time, known, left=np.nan, right=np.nan))[()]


@dataclass(frozen=True, slots=True)
class FrameRate:
    """A camera's steady clock on the time of the force signal.

    Attributes
    ----------
    frames_per_second : float
        Rate at which the frames were taken.
    anchor_time : float
        Time of the anchor frame on the signal's clock, s.
    anchor_frame : int or None
        Number of the anchor frame; None for the first-contact frame, found in the pictures.
    numbers : tuple of int or None
        Place of each frame on the camera's count where some are missing, as `Frames.numbers`.

    Raises
    ------
    LoadingError
        If the rate is not positive and finite, the time not finite, or the frame not a whole number, or none
        of those with `numbers`.

    Examples
    --------
    >>> FrameRate(1000, anchor_time=0.5).time_of(250, first_contact=None)
    0.75
    """

    frames_per_second: float
    anchor_time: float = field(default=0.0, kw_only=True)
    anchor_frame: int | None = field(default=0, kw_only=True)
    numbers: tuple[int, ...] | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        frame = self.anchor_frame
        if frame is not None:
            number = real_number(frame, "anchor_frame", LoadingError)
            if not number.is_integer():
                raise LoadingError(f"anchor_frame must be a whole number or None, found {number:g}")
            frame = int(number)
            if self.numbers is not None and not 0 <= frame < len(self.numbers):
                raise LoadingError(
                    f"anchor_frame must be one of the {len(self.numbers)} frames, from 0, found {frame}"
                )
        set_fields(
            self,
            frames_per_second=positive_number(self.frames_per_second, "frames_per_second", LoadingError),
            anchor_time=finite_number(self.anchor_time, "anchor_time", LoadingError),
            anchor_frame=frame,
        )

    def time_of(self, index: int, first_contact: int | None) -> float:
        """Return the time of a frame.

        Parameters
        ----------
        index : int
            Number of the frame.
        first_contact : int or None
            Number of the first-contact frame, where it is known.

        Returns
        -------
        float
            s, NaN while the anchor is unknown, and past the last of `numbers`.
        """
        anchor = first_contact if self.anchor_frame is None else self.anchor_frame
        if anchor is None or (self.numbers is not None and index >= len(self.numbers)):
            return math.nan
        passed = index - anchor if self.numbers is None else self.numbers[index] - self.numbers[anchor]
        return self.anchor_time + passed / self.frames_per_second


@dataclass(frozen=True, slots=True, init=False, eq=False, repr=False)
class FrameStamps(Displayed):
    """Times of the frames on the clock of the force signal, s, strictly increasing."""

    time: FloatArray

    def __init__(self, time: ArrayLike) -> None:
        time = as_float_array(time, "time", LoadingError)
        if time.ndim != 1 or not time.size or not np.isfinite(time).all():
            raise LoadingError(f"time stamps must be a row of finite times, found shape {time.shape}")
        _require_increasing(time, "time of the frames")
        set_fields(self, time=time)

    def time_of(self, index: int, first_contact: int | None) -> float:  # noqa: ARG002
        """Return the time of a frame, s, NaN past the last stamp."""
        return float(self.time[index]) if index < self.time.size else math.nan


FrameClock: TypeAlias = FrameRate | FrameStamps


def check_kind(name: str, value: object, kind: type | UnionType, wanted: str) -> None:
    """Refuse an argument that is given and of another kind than wanted."""
    if not isinstance(value, kind | None):
        raise LoadingError(f"{name} must be {wanted}, found {type(value).__name__}")


def level_before_contact(force: ForceSignal, before: FloatArray) -> float:
    """Return the level of a force without contact, N; 0 where it hardly differs from zero, or is not known.

    `before` are times of frames or samples without contact. The level is that of the first two thirds, since
    a touch may be too light to be seen at the end.
    """
    if before.size < _MIN_BEFORE:
        return 0.0
    start, stop = before[0], before[0] + _WELL_BEFORE * (before[-1] - before[0])
    level = force.load[(force.time >= start) & (force.time <= stop)]
    if level.size < _MIN_BEFORE:
        return 0.0
    zero, low, high = float(np.median(level)), *np.quantile(force.load, [0.01, 1.0])
    early, late = (float(np.median(half)) for half in np.array_split(level, 2))
    steady = abs(early - late) < _STEADY * abs(zero)
    clear = abs(zero) > _DEVIATIONS * float(level.std()) / math.sqrt(level.size)
    matters = abs(zero) > _LEAST_ZERO * (high - zero) and zero < low + _LEAST_CONTACT * (high - low)
    return zero if steady and clear and matters else 0.0


def zero_before_contact(force: ForceSignal, before: FloatArray, time: FloatArray, area: FloatArray) -> float:
    """Return what `level_before_contact` finds, N; 0 where it may be a touch too light to be seen.

    `time` and `area` are of the first frames in contact. A touch of that load all the way would have been
    seen: by Hertz theory its area is a twentieth of the largest or more, or, by the last of these frames,
    larger than in the first.
    """
    zero = level_before_contact(force, before)
    if zero <= 0:
        return zero
    of_largest, of_last = (zero / np.maximum([force.load.max(), force.load_at(time[-1])], zero)) ** (2 / 3)
    seen = of_largest > _SEEN_OF_LARGEST or of_last * area[-1] > _SEEN_OF_FIRST * area[0]
    return zero if seen else 0.0


def frame_clock(
    frames_per_second: float,
    force: ForceSignal | None = None,
    *,
    start_time: float | None = None,
    contact_load: float | None = None,
    numbers: tuple[int, ...] | None = None,
) -> FrameRate:
    """Return the clock of frames taken at a steady rate, on the force's time.

    Parameters
    ----------
    frames_per_second : float
        Their rate.
    force : ForceSignal, optional
        The force: the first frame lies where its trigger first rises through half of its range, or at its
        start where there is no trigger.
    start_time : float, optional
        Where the first frame lies in its place, s.
    contact_load : float, optional
        N; the frame of first contact lies where the force first rises through it for at least three samples,
        and for most of those until it is clearly in contact; from its own zero where that lies below zero.
    numbers : tuple of int, optional
        Place of each frame on the camera's count where some are missing, as `Frames.numbers`.

    Returns
    -------
    FrameRate

    Raises
    ------
    LoadingError
        If both `start_time` and `contact_load` are given, `contact_load` without a force or not positive, or
        the trigger or the force never rises.

    Examples
    --------
    >>> signal = ForceSignal(time=np.arange(5) / 10, load=[0, 0, 0.2, 0.4, 0.6])
    >>> round(frame_clock(100, signal, contact_load=0.1).time_of(7, first_contact=7), 3)
    0.15
    """
    if start_time is not None and contact_load is not None:
        raise LoadingError("give either the time of the first frame or the load of first contact, not both")
    check_kind("force", force, ForceSignal, FORCE_KIND)
    if contact_load is not None:
        if force is None:
            raise LoadingError("the load of first contact aligns frames with a force: give the force too")
        # Pictures show contact from some ridges on: the frame is late by that and up to one frame more, and
        # so are all times.
        low, high = float(force.load.min()), float(force.load.max())
        # A level below zero is the sensor's own and comes off all loads; one above it may be a light touch.
        first = phase_intervals(force.time, force.load).start[:1]
        zero = min(0.0, level_before_contact(force, force.time[force.time < first])) if first.size else 0.0
        contact = _first_rise(
            force.time,
            force.load - zero,
            positive_number(contact_load, "contact_load", LoadingError),
            f"the force never rises through {contact_load:g} N: it starts at {force.load[0]:g} N and lies "
            f"between {low:g} and {high:g} N; tare it or choose another threshold",
            surely_from=int(np.searchsorted(force.time, first[0])) if first.size else 0,
        )
        return FrameRate(frames_per_second, anchor_time=contact, anchor_frame=None, numbers=numbers)
    if force is not None and start_time is None:
        start_time = force.span[0]
        if force.trigger is not None:
            low, high = float(force.trigger.min()), float(force.trigger.max())
            never = f"the trigger never rises: it stays between {low:g} and {high:g} V"
            level = (low + high) / 2
            upper, lower = force.trigger[force.trigger >= level], force.trigger[force.trigger < level]
            # Noise rises, too.
            if lower.size and upper.mean() - lower.mean() < _LEVELS_APART * max(upper.std(), lower.std()):
                raise LoadingError(f"{never}, with no step between two levels")
            start_time = _first_rise(force.time, force.trigger, level, never)
    return FrameRate(frames_per_second, anchor_time=start_time or 0.0, numbers=numbers)


def alignment_scatter(
    time: ArrayLike, area: ArrayLike, signal: ForceSignal, shift: ArrayLike = 0.0
) -> FloatArray:
    """Return the scatter of ln(area) about a power law of the load, for frames displaced by each shift, s.

    It is the root mean square of the residuals, NaN where fewer than five frames lie in the signal, and least
    where frames and force agree best: no proof, since a pad that creeps or dissipates also seems late.
    """
    time, area = as_float_array(time, "time", LoadingError), as_float_array(area, "area", LoadingError)
    if time.ndim != 1 or time.shape != area.shape:
        raise LoadingError(f"time has shape {time.shape} and area {area.shape}: give one area for each frame")
    measured = np.isfinite(time) & (area > 0)
    time, grown = time[measured], np.log(area[measured])
    shifts = as_float_array(shift, "shift", LoadingError)
    found = np.full(shifts.size, np.nan)
    for k, by in enumerate(shifts.flat):
        load = signal.load_at(time + by)
        used = load > _LEAST_LOAD * signal.load.max()
        if np.count_nonzero(used) >= _MIN_FRAMES:
            x, y = np.log(load[used]), grown[used]
            design = np.column_stack([np.ones_like(x), x])
            found[k] = np.sqrt(np.mean((y - design @ np.linalg.lstsq(design, y, rcond=None)[0]) ** 2))
    return found.reshape(shifts.shape)


def _require_increasing(time: FloatArray, name: str) -> None:
    steps = np.diff(time)
    if (steps > 0).all():
        return
    at = int(np.argmin(steps > 0))
    what = "is repeated" if steps[at] == 0 else f"falls to {time[at + 1]:g} s"
    raise LoadingError(
        f"{name} must increase from row to row: after row {at + 1} ({time[at]:g} s) it {what}: "
        "sort the rows and drop repeated ones"
    )


def _first_rise(
    time: FloatArray, values: FloatArray, level: float, never: str, *, surely_from: int = 0
) -> float:
    """Return when `values` first passes a level upwards and stays above for three samples, s.

    Up to the sample `surely_from` most are above, too: noise passes a small load well before contact.
    """
    above = values >= level
    stays = above.copy()
    for ahead in (1, 2):
        stays[:-ahead] &= above[ahead:]
    rises = np.flatnonzero(~above[:-1] & stays[1:]) + 1
    ends, counts = np.maximum(rises + 1, surely_from), np.cumsum(np.concatenate([[0], above]))
    rises = rises[counts[ends] - counts[rises] >= _STAYS_ABOVE * (ends - rises)]
    if not rises.size:
        raise LoadingError(never)
    k = int(rises[0])
    share = (level - values[k - 1]) / (values[k] - values[k - 1])
    return float(time[k - 1] + share * (time[k] - time[k - 1]))


def read_force_signal(path: str | PathLike[str], columns: Mapping[str, str] | None = None) -> ForceSignal:
    r"""Read a force signal from a table with columns like ``time_s, force_N`` or ``Time (s), Load [mN]``.

    ``trigger_V`` and ``displacement_mm`` may stand beside them.

    Parameters
    ----------
    path : path-like
        A CSV, XLSX, MAT or TDMS file, with a header line or names of vectors that names quantities and units.
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
    found = read_columns(path, *FORCE_COLUMNS, columns=columns)
    try:
        signal = ForceSignal(found["time"], found["force"], found.get("trigger"), found.get("displacement"))
        _check_press(signal)
    except LoadingError as error:
        raise LoadingError(f"{path}: {error}") from error
    return signal


def _check_press(signal: ForceSignal) -> None:
    """Refuse a force or a displacement that has no range, or the wrong sign."""
    load, depth = signal.load, signal.displacement
    low, high = float(load.min()), float(load.max())
    if low == high:
        raise LoadingError(f"the force is {low:g} N throughout; a press needs a range of it")
    if -low > _REVERSED * max(high, 0.0):
        raise LoadingError(
            f"the force goes down to {low:g} N and up to {high:g} N only; it is positive in compression: "
            "reverse its sign"
        )
    if depth is not None and np.ptp(depth) == 0:
        raise LoadingError(
            f"the displacement is {depth[0]:g} mm throughout: give the column another name if nothing was "
            "recorded"
        )
    if depth is not None and np.dot(load - load.mean(), depth - depth.mean()) < 0:
        raise LoadingError(
            "the displacement falls while the force rises; it grows into the pad: reverse its sign"
        )


def unread_force_columns(path: Path, columns: Mapping[str, str] | None = None) -> dict[str, list[str]]:
    """Return the columns that `read_force_signal` leaves alone, and that may be a trigger or displacement."""
    return unread_columns(path, sum(FORCE_COLUMNS, ()), columns)


def read_frame_stamps(path: str | PathLike[str], columns: Mapping[str, str] | None = None) -> FrameStamps:
    r"""Read the time of each frame from a table with a column like ``time_s``, one row for each frame.

    Parameters
    ----------
    path : path-like
        A CSV, XLSX, MAT or TDMS file.
    columns : mapping, optional
        ``{"time": "HEADER:UNIT"}`` where the header differs.

    Returns
    -------
    FrameStamps

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
    time = read_columns(path, ("time",), columns=columns)["time"]
    try:
        return FrameStamps(time)
    except LoadingError as error:
        raise LoadingError(f"{path}: {error}") from error
