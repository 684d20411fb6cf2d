"""The place of first contact from force and displacement alone.

The joint fit finds it together with everything else, and begins at `fit_contact_start`. The others are those
of manual analysis, late or early by amounts that depend on the noise.
"""

from collections.abc import Callable, Mapping
from typing import Final

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import FloatArray
from fingerpad.exceptions import FitError, LoadingError
from fingerpad.loading.least_squares import fit_least_squares

# Share of the way at the start that is taken to be free of contact, and deviations that noise does not reach.
_FREE_SHARE, _DEVIATIONS, _IN_A_ROW = 0.1, 4.0, 3
# The two lines are fitted below this share of the largest force.
_FOOT = 0.3
_WAY_IN, _WAY_IN_ROWS = 0.5, 6
_START_GRID, _START_ROWS, _ZOOMS = 30, 300, 3
# Shortest press, as a share of the way in, and the approach, in presses, that says where contact begins.
_SHORTEST_PRESS, _APPROACH = 0.02, 3.0
# A record is upside down where, turned about, it leaves less than this share of its sum of squares.
_UPSIDE_DOWN = 0.2
BOTH_REVERSED: Final = (
    "force and displacement are both of the wrong sign (force sign flipped, displacement too): turned about "
    "they are a press; compression is positive, and displacement grows into the pad: reverse both columns"
)


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


def contact_by_threshold(displacement: FloatArray, load: FloatArray) -> float:
    """Return where the force leaves the baseline by four of its deviations, three rows in a row.

    Raises FitError if it never does; so do all estimators here.
    """
    free = _free_rows(load)
    level, spread = float(np.mean(load[:free])), float(np.std(load[:free], ddof=1))
    return float(displacement[_first_beyond(load, level + _DEVIATIONS * spread)])


def two_lines(displacement: FloatArray, load: FloatArray) -> float:
    """Return the corner of the best pair of joined lines through the foot of the curve."""
    x, y = _foot(displacement, load)
    places = np.linspace(x.min(), x.max(), 62)[1:-1]
    rest = []
    for place in places:
        columns = np.stack([np.ones_like(x), x, np.maximum(x - place, 0)], axis=-1)
        rest.append(np.sum((y - columns @ np.linalg.lstsq(columns, y)[0]) ** 2))
    return float(places[int(np.argmin(rest))])


def gradient(displacement: FloatArray, load: FloatArray) -> float:
    """Return where the smoothed slope of the force leaves that of the baseline."""
    from scipy import signal  # noqa: PLC0415 (slow to import, not needed for images)

    window = 2 * (load.size // 40) + 3
    if load.size <= window:
        raise FitError(f"{load.size} rows: a gradient needs more than {window}")
    slope = np.gradient(signal.savgol_filter(load, window, 1))
    free = _free_rows(load)
    level, spread = float(np.median(slope[:free])), float(np.std(slope[:free], ddof=1))
    return float(displacement[_first_beyond(slope, level + _DEVIATIONS * spread)])


def power_law(displacement: FloatArray, load: FloatArray) -> float:
    """Return the start of the best power law, with free exponent and baseline, through the foot."""
    displacement, load = _foot(displacement, load)
    place, parts = fit_contact_start(np.arange(float(load.size)), load, displacement, tilt=False)
    top = float(np.ptp(load)) / max(float(displacement.max()) - place, 1e-9) ** 1.5

    def residuals(p: FloatArray) -> FloatArray:
        rise = np.maximum(displacement - p[0], 0.0)
        return np.asarray(load - p[1] - p[2] * rise ** float(np.clip(p[3], 0.2, 10.0)))

    fit = fit_least_squares(residuals, [place, parts[0], top, 1.5], ["place", "level", "size", "exponent"])
    return fit.value("place")


def first_contact(clock: FloatArray, load: FloatArray, displacement: FloatArray | None) -> float:
    """Return the displacement at which the force of a press begins to rise, for a rigid stage.

    A level and a Hertzian rise that stiffens, W = W₀ + a s + b s² with s = (x − x₀)^(3/2), are fitted to the
    first press, up to half of the largest force, beyond which tissue stiffens more.
    """
    if displacement is None:
        raise LoadingError("no displacement was recorded beside the force")
    low = float(load.min())
    stop = int(np.argmax(load >= low + _WAY_IN * (float(load.max()) - low))) + 1
    if stop < _WAY_IN_ROWS:
        raise LoadingError(
            f"the place of contact is unknown: the force passes half of its largest value after {stop} rows; "
            f"{_WAY_IN_ROWS} are needed"
        )
    place, _ = fit_contact_start(clock[:stop], load[:stop], displacement[:stop], tilt=False)
    if not place > displacement[:stop].min():
        raise LoadingError(
            "the place of contact is unknown: the record begins in contact; record some of the approach"
        )
    return place


ESTIMATORS: Final[Mapping[str, Callable[[FloatArray, FloatArray], float]]] = {
    "contact_by_threshold": contact_by_threshold,
    "two_lines": two_lines,
    "gradient": gradient,
    "power_law": power_law,
}


def _foot(displacement: FloatArray, load: FloatArray) -> tuple[FloatArray, FloatArray]:
    level = float(np.mean(load[: _free_rows(load)]))
    beyond = np.flatnonzero(load > level + _FOOT * (load.max() - level))
    last = int(beyond[0]) if beyond.size else load.size
    if last < 6:
        raise FitError(f"{last} rows below {100 * _FOOT:.0f} % of the largest force: its foot needs 6")
    return displacement[:last], load[:last]


def _free_rows(load: FloatArray) -> int:
    free = max(round(_FREE_SHARE * load.size), 3)
    if load.size < free + _IN_A_ROW:
        raise FitError(f"{load.size} rows are too few to separate a baseline from contact")
    return free


def _first_beyond(values: FloatArray, limit: float) -> int:
    run = np.convolve(values > limit, np.ones(_IN_A_ROW), mode="valid") == _IN_A_ROW
    if not run.any():
        raise FitError("the force never leaves its baseline")
    return int(np.argmax(run))
