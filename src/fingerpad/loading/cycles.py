"""Baseline, loading, hold and unloading of each cycle, from the platen's motion."""

from dataclasses import dataclass, fields
from typing import Final

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, FloatArray
from fingerpad._display import Displayed
from fingerpad._motion import FALL, REST, RISE, find_motion, runs, usual_rate
from fingerpad.exceptions import LoadingError
from fingerpad.loading.curve import LoadingCurve

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
_START_GRID, _START_ROWS, _ZOOMS = 30, 300, 3
# Shortest press, as a share of the way in, and the approach, in presses, that says where contact begins.
_SHORTEST_PRESS, _APPROACH = 0.02, 3.0
# A record is upside down where, turned about, it leaves less than this share of its sum of squares.
_UPSIDE_DOWN = 0.2
BOTH_REVERSED: Final = (
    "force and displacement are both of the wrong sign (force sign flipped, displacement too): turned about "
    "they are a press; compression is positive, and displacement grows into the pad: reverse both columns"
)


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Segment(Displayed):
    """A range of rows.

    Attributes
    ----------
    start, stop : int
        First row, and the row after the last.
    """

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
        Share of the work of loading.
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
    # Only down to where the platen was at first contact, so that both ways cover the same ground.
    back = np.arange(depth.size) < len(cycle.loading)
    kept = back | (depth >= depth[0])
    energy = float(np.trapezoid(load[kept], depth[kept]))
    work = float(np.trapezoid(load[back], depth[back]))
    return Hysteresis(energy=energy, fraction=energy / work) if work > 0 else None


def rows_in_contact(curve: LoadingCurve, cycle: Cycle) -> npt.NDArray[np.intp]:
    """Return the rows of a loading in which an area is far enough above zero not to be cut off there."""
    begin = (cycle.baseline or cycle.loading).start
    before = cycle.loading.start - begin
    smooth = moving_average(curve.indentation[begin : cycle.loading.stop])
    contact = smooth[before]
    return begin + np.flatnonzero(smooth > contact + _NEAR_CONTACT * (smooth.max() - contact))


def saturated_rows(curve: LoadingCurve, segment: Segment) -> BoolArray:
    """Return which rows of a loading lie at the sensor's limit: the very same maximum in several rows."""
    load = curve.load[segment.rows]
    at_top = load == load.max()
    many = int(at_top.sum()) >= _SATURATED_ROWS and np.ptp(curve.indentation[segment.rows][at_top]) > 0
    return np.asarray(at_top & bool(many))


def fit_contact_start(
    clock: FloatArray, load: FloatArray, displacement: FloatArray, *, tilt: bool
) -> tuple[float, FloatArray]:
    """Return the place of contact (mm) and coefficients of force = 1 (+ clock) + s + s², s = ξ^1.5.

    The law whose modulus grows with load begins like that; for a given place of contact it is linear.
    """

    def best(places: FloatArray, rows: npt.NDArray[np.intp]) -> tuple[float, FloatArray]:
        some = rows[np.unique(np.linspace(0, rows.size - 1, min(rows.size, _START_ROWS)).astype(int))]
        t, y, x = clock[some], load[some], displacement[some]
        basis = [np.ones_like(y), t] if tilt else [np.ones_like(y)]
        found = []
        for place in places:
            s = np.maximum(x - place, 0) ** 1.5
            columns = np.stack([*basis, s, s * s], axis=-1)
            parts, *_ = np.linalg.lstsq(columns, y)
            found.append((float(np.sum((y - columns @ parts) ** 2)), float(place), parts))
        return min(found, key=lambda each: each[0])[1:]

    end, rows = float(displacement.max()), np.arange(load.size)
    for _ in range(_ZOOMS):
        start = float(displacement[rows].min())
        grid = np.linspace(start, end - (end - start) * _SHORTEST_PRESS, _START_GRID)
        place, _ = best(grid, rows)
        # After a long approach few of all rows are in contact.
        near = np.flatnonzero(displacement >= place - _APPROACH * (end - place))
        if near.size == rows.size:
            break
        rows = near
    step = float(grid[1] - grid[0])
    return best(np.minimum(place + step * np.linspace(-1, 1, 11), grid[-1]), rows)


def contact_rise(
    clock: FloatArray, load: FloatArray, displacement: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the rise of the force over its zero by `fit_contact_start`, and what is left of the force."""
    place, parts = fit_contact_start(clock, load, displacement, tilt=False)
    s = np.maximum(displacement - place, 0) ** 1.5
    rise = parts[1] * s + parts[2] * s * s
    return rise, load - parts[0] - rise


def both_reversed(clock: FloatArray, load: FloatArray, displacement: FloatArray) -> bool:
    """Return whether force and displacement are a press far better with both signs reversed.

    A press grows ever steeper after a level baseline; upside down it ends in one.
    """
    _, rest = contact_rise(clock, load, displacement)
    rise, turned = contact_rise(clock, -load, -displacement)
    rising = float(rise[np.argmax(np.abs(rise))]) > 0
    return rising and float(turned @ turned) < _UPSIDE_DOWN * float(rest @ rest)


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
