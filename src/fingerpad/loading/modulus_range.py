"""The secant modulus of each row, and the loads between which it increases."""

from dataclasses import dataclass, replace

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad._display import Displayed
from fingerpad.exceptions import LoadingError
from fingerpad.loading.joint import FitData, JointFit
from fingerpad.loading.laws import secant_modulus

_BINS, _MIN_ROWS = 12, 5
# Nearer to contact than this share of the depth its place decides the modulus.
_NEAR_CONTACT = 0.2
# A fall counts that is both this share of the modulus and this many standard uncertainties.
_FALL, _DEVIATIONS = 0.1, 3.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Secant(Displayed):
    """The secant modulus of rows in contact.

    Attributes
    ----------
    load, indentation : ndarray
        W (N) and ξ (mm).
    modulus : ndarray
        E_g, MPa.

    Examples
    --------
    >>> load, indentation = np.array([1.0, 2.0]), np.array([1.3, 1.8])
    >>> modulus = secant_modulus(load, indentation, loading_radius=20.5)
    >>> Secant(load=load, indentation=indentation, modulus=modulus).modulus.round(4)
    array([0.0838, 0.1029])
    """

    load: FloatArray
    indentation: FloatArray
    modulus: FloatArray


def secant_of(fit: JointFit) -> Secant:
    """Return the secant modulus of each row that is well in contact."""
    record, values = fit.record, fit.values
    depth = record.displacement - values["contact_offset"]
    load = fit.corrected_load(record.clock, record.load)
    used = depth > 0.05 * depth.max()
    modulus = secant_modulus(
        load[used],
        depth[used],
        loading_radius=values["loading_radius"],
        poisson_ratio=record.poisson_ratio,
    )
    return Secant(load=load[used], indentation=depth[used], modulus=modulus)


def modulus_range(
    fit: JointFit, given: tuple[float, float] | None = None
) -> tuple[tuple[float, float], FitData]:
    """Return the loads (N) between which E_g increases, and the record's rows before contact and in between.

    E_g is averaged in up to twelve bins along the curve. The range ends at its last maximum and
    starts at the last minimum before, within noise.

    Raises
    ------
    LoadingError
        If `given` is not two rising loads with at least five rows between.
    """
    record = fit.record
    load = fit.load(record.smooth_displacement)
    low, high = given if given is not None else increasing_range(fit, record)
    keep = (load <= 0) | ((load >= low) & (load <= high))
    if not (low < high and np.count_nonzero(keep & (load > 0)) >= _MIN_ROWS):
        raise LoadingError(
            f"fit_load_range must be two rising loads with at least {_MIN_ROWS} rows between, "
            f"found {low:g} to {high:g} N"
        )
    if keep.all():
        return (float(low), float(high)), record
    return (float(low), float(high)), replace(
        record,
        clock=record.clock[keep],
        load=record.load[keep],
        displacement=record.displacement[keep],
        smooth_displacement=record.smooth_displacement[keep],
        area=record.area[keep[record.with_area]],
        with_area=record.with_area[keep],
    )


def increasing_range(fit: JointFit, record: FitData) -> tuple[float, float]:
    """Return the loads (N) between which E_g of a record increases, with the place of contact of a fit."""
    load, values = fit.load(record.smooth_displacement), fit.values
    whole = (0.0, float(load.max()))
    depth = record.smooth_displacement - values["contact_offset"]
    rows = np.flatnonzero(depth > _NEAR_CONTACT * depth.max())
    if rows.size < 3 * _MIN_ROWS:
        return whole
    bins = np.array_split(rows, min(_BINS, rows.size // _MIN_ROWS))
    # The zero of the rows before contact: where the law fails, the fitted tilt makes up for it.
    before = depth <= 0
    zero = float(record.load[before].mean()) if before.sum() > 1 else values.get("force_zero", 0.0)
    measured = secant_modulus(
        record.load[rows] - zero,
        depth[rows],
        loading_radius=values["loading_radius"],
        poisson_ratio=record.poisson_ratio,
    )
    at = np.split(measured, np.cumsum([part.size for part in bins])[:-1])
    mean = np.array([part.mean() for part in at])
    std = np.array([part.std(ddof=1) / np.sqrt(part.size) for part in at])
    slack = np.maximum(_FALL * np.abs(mean).max(), _DEVIATIONS * std)
    last, end = int(np.argmax(mean)), len(bins) - 1
    last = last if (mean[last:] < mean[last] - slack[last:]).any() else end
    first = int(np.argmin(mean[: last + 1]))
    first = first if (mean[:first] > mean[first] + slack[:first]).any() else 0
    if last - first < 2:
        return whole
    low = 0.0 if first == 0 else float(load[bins[first][0]])
    high = whole[1] if last == end else float(load[bins[last][-1]])
    return low, high
