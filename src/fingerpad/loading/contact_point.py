"""Estimators of the place of first contact, with uncertainty from simulation.

The joint fit finds the place of contact together with everything else. These find it from force and
displacement alone, as in manual analysis, and are late or early by amounts that depend on the noise.
"""

from collections.abc import Callable, Mapping
from typing import Final

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad.estimate import Estimate
from fingerpad.exceptions import FitError
from fingerpad.loading.cycles import fit_contact_start
from fingerpad.loading.joint import JointFit
from fingerpad.loading.least_squares import fit_least_squares

# Share of the way at the start that is taken to be free of contact, and deviations that noise does not reach.
_FREE_SHARE, _DEVIATIONS, _IN_A_ROW = 0.1, 4.0, 3
# The two lines are fitted below this share of the largest force.
_FOOT = 0.3
_TRIALS = 20


def contact_by_threshold(displacement: FloatArray, load: FloatArray) -> float:
    """Return where the force leaves the baseline by four of its deviations, three rows in a row.

    Raises
    ------
    FitError
        If it never does. So do all estimators here.
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


ESTIMATORS: Final[Mapping[str, Callable[[FloatArray, FloatArray], float]]] = {
    "contact_by_threshold": contact_by_threshold,
    "two_lines": two_lines,
    "gradient": gradient,
    "power_law": power_law,
}


def contact_by(name: str, fit: JointFit) -> Estimate:
    """Return the place of contact (mm) by an estimator, with its error on records like the fit's.

    Its root mean square error, bias included, on twenty records that are simulated from the fit with its
    noise is the standard uncertainty. The value itself is not corrected.

    Raises
    ------
    FitError
        If it finds none, or fails on half of the simulated records.
    """
    estimator, rng, errors = ESTIMATORS[name], np.random.default_rng(0), []
    try:
        value = estimator(fit.record.displacement, fit.record.load)
    except FitError as error:
        raise FitError(f"no place of contact by {name}: {error}") from error
    for _ in range(_TRIALS):
        try:
            errors.append(estimator(*fit.simulated(rng)) - fit.values["contact_offset"])
        except FitError:
            continue
    if len(errors) < _TRIALS // 2:
        failed = f"{_TRIALS - len(errors)} of {_TRIALS} simulated records like this"
        raise FitError(f"no place of contact by {name}: it fails on {failed}")
    return Estimate.symmetric(value, float(np.sqrt(np.mean(np.square(errors)))))


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
