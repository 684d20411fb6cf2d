"""Baseline, loading, hold and unloading of each cycle, from the platen's motion."""

from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, FloatArray
from fingerpad._display import Displayed
from fingerpad._loading_curve import LoadingCurve
from fingerpad._motion import FALL, REST, RISE, find_motion, runs, usual_rate
from fingerpad.exceptions import LoadingError
from fingerpad.loading.estimate import Estimate

# Shortest phase, as a share of the record.
_MIN_DURATION = 0.02
# Rows at the sensor's very maximum, while the platen still moves, that show it was saturated.
_SATURATED_ROWS = 4
_SMOOTHING = 50
# A press is taken to last so many times as long as its way in.
_PRESS = 4
_START_GRID, _START_ROWS = 30, 300
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

    Examples
    --------
    >>> segment = Segment(start=18, stop=87)
    >>> len(segment), segment.rows
    (69, slice(18, 87, None))
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

    Examples
    --------
    >>> from fingerpad.simulate import simulate_loading_curve
    >>> (cycle,) = find_cycles(simulate_loading_curve(points=200))
    >>> cycle.loading, cycle.unloading
    (Segment(start=40, stop=200), None)
    """

    baseline: Segment | None
    loading: Segment
    hold: Segment | None
    unloading: Segment | None

    def as_record(self) -> dict[str, list[int] | None]:
        """Return the first and last row of each phase, counted from zero.

        Returns
        -------
        dict of str to list of int or None
            By phase; None for one that is absent.
        """
        return {
            name: None if segment is None else [segment.start, segment.stop - 1]
            for name, segment in self.phases().items()
        }

    def phases(self) -> dict[str, Segment | None]:
        """Return the phases by name, in their order.

        Returns
        -------
        dict of str to Segment or None
            None for one that is absent.
        """
        return {
            "baseline": self.baseline,
            "loading": self.loading,
            "hold": self.hold,
            "unloading": self.unloading,
        }


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Hysteresis(Displayed):
    """Energy that a cycle lost.

    Attributes
    ----------
    energy : float
        ∮W dξ, N mm = mJ.
    fraction : float
        Share of the work of loading.

    Examples
    --------
    >>> Hysteresis(energy=0.12, fraction=0.25)
    Hysteresis(energy=0.12, fraction=0.25)
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
    some = np.unique(np.linspace(0, load.size - 1, min(load.size, _START_ROWS)).astype(int))
    t, y, x = clock[some], load[some], displacement[some]
    basis = [np.ones_like(y), t] if tilt else [np.ones_like(y)]

    def best(places: FloatArray) -> tuple[float, FloatArray]:
        found = []
        for place in places:
            s = np.maximum(x - place, 0) ** 1.5
            columns = np.stack([*basis, s, s * s], axis=-1)
            parts, *_ = np.linalg.lstsq(columns, y)
            found.append((float(np.sum((y - columns @ parts) ** 2)), float(place), parts))
        return min(found, key=lambda each: each[0])[1:]

    grid = np.linspace(x.min(), x.min() + 0.8 * np.ptp(x), _START_GRID)
    place, _ = best(grid)
    return best(place + (grid[1] - grid[0]) * np.linspace(-1, 1, 11))


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
    rate = np.gradient(smooth)
    # One rate for both directions: in a record of one direction the other is noise.
    usual = usual_rate(np.abs(rate))
    least = max(2, round(_MIN_DURATION * smooth.size))
    return find_motion(rate, rising=usual, falling=usual, min_samples=least)


def _contact_row(curve: LoadingCurve, start: int, end: int) -> int:
    """Return how many rows of the way in lie before contact."""
    displacement = moving_average(curve.indentation[start:end])
    place, _ = fit_contact_start(
        curve.clock[start:end], curve.load[start:end], displacement, tilt=end - start > 12
    )
    return min(int(np.searchsorted(np.maximum.accumulate(displacement), place)), end - start - 1)


def baseline_level(curve: LoadingCurve, cycle: Cycle) -> Estimate | None:
    """Return the mean force before contact.

    Parameters
    ----------
    curve : LoadingCurve
        The record.
    cycle : Cycle
        One of its presses.

    Returns
    -------
    Estimate or None
        N, with its uncertainty; None where there is no baseline.

    Examples
    --------
    >>> from fingerpad.simulate import simulate_loading_curve
    >>> curve = simulate_loading_curve(points=200, force_offset=0.05)
    >>> round(baseline_level(curve, find_cycles(curve)[0]).value, 3)
    0.05
    """
    if cycle.baseline is None or len(cycle.baseline) < 2:
        return None
    values = curve.load[cycle.baseline.rows]
    std = float(np.std(values, ddof=1)) / np.sqrt(values.size)
    return Estimate.symmetric(float(values.mean()), float(std), values.size - 1)
