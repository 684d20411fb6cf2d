"""Preparation of one press for the fit: rows, flags, and initial values."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np

from fingerpad.estimate import Estimate
from fingerpad.exceptions import FingerpadError, FitError, LoadingError
from fingerpad.loading.curve import LoadingCurve
from fingerpad.loading.cycles import (
    BOTH_REVERSED,
    Cycle,
    both_reversed,
    choose_cycle,
    contact_rise,
    fit_contact_start,
    moving_average,
    rows_in_contact,
    saturated_rows,
)
from fingerpad.loading.joint import FitData
from fingerpad.loading.laws import hertz_stiffness

# Rows before contact from which a drift, or a zero, can be estimated.
_TILT_ROWS, _ZERO_ROWS = 4, 2
_CONTACT_DEVIATIONS = 5.0
_MIN_LOADING = 5


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Press:
    """Rows to fit, all cycles of the record, how many rows lie before contact, and doubts."""

    record: FitData
    cycles: tuple[Cycle, ...]
    baseline_rows: int
    flags: tuple[str, ...]


@contextmanager
def determined(what: str, hint: str = "") -> Iterator[None]:
    """Raise FitError where the numbers of a fit run out of range or it has no solution."""
    try:
        with np.errstate(all="ignore"):
            yield
    except FingerpadError:
        raise
    except (ArithmeticError, np.linalg.LinAlgError, ValueError) as error:
        raise FitError(f"the record does not determine {what} and its noise ({error}){hint}") from error


def prepare(curve: LoadingCurve, poisson_ratio: float, cycle: int) -> Press:
    """Choose the rows of one press. Raise LoadingError or FitError where there is nothing to fit."""
    cycles, chosen = choose_cycle(curve, cycle)
    begin = chosen.baseline.start if chosen.baseline else chosen.loading.start
    before = chosen.loading.start - begin
    rows = np.arange(begin, chosen.loading.stop)
    full = saturated_rows(curve, chosen.loading)
    rows = rows[np.append(np.zeros(before, dtype=bool), full) == 0]
    smooth = moving_average(curve.indentation[begin : chosen.loading.stop])[rows - begin]
    with_area = np.isin(rows, rows_in_contact(curve, chosen)) & (curve.area is not None)
    record = FitData(
        clock=curve.clock[rows] - curve.clock[rows[0]],
        load=np.asarray(curve.load, dtype=np.float64)[rows],
        displacement=np.asarray(curve.indentation, dtype=np.float64)[rows],
        smooth_displacement=smooth,
        area=np.zeros(0) if curve.area is None else np.asarray(curve.area, dtype=np.float64)[rows][with_area],
        with_area=with_area,
        poisson_ratio=poisson_ratio,
    )
    _require_contact(record)
    if rows.size - before < _MIN_LOADING:
        raise FitError(
            f"{rows.size - before} rows in contact while the load grows (saturated ones left out); at least "
            f"{_MIN_LOADING} are needed"
        )
    doubts = {
        "no_baseline": before < _ZERO_ROWS,
        "tilt_unknown": _ZERO_ROWS <= before < _TILT_ROWS,
        "saturated_force": bool(full.any()),
    }
    flags = (*(name for name, seen in doubts.items() if seen), *curve.doubts)
    return Press(record=record, cycles=cycles, baseline_rows=before, flags=flags)


def start_values(press: Press, radius: float | None) -> dict[str, float]:
    """Return where a search of the law with a growing modulus may begin; its names are the fitted parameters.

    `radius` (mm) is used where it is given.
    """
    record = press.record
    tilt = press.baseline_rows >= _TILT_ROWS
    place, parts = fit_contact_start(record.clock, record.load, record.smooth_displacement, tilt=tilt)
    linear, square = parts[-2:]
    top = float(np.maximum(record.smooth_displacement - place, 0).max()) ** 1.5
    if not linear > 0:
        linear, square = linear + square * top, 0.0
    growth = float(np.clip(square / linear, -0.5 / top, 0.6 / top))
    if radius is None:
        depth = record.smooth_displacement[record.with_area] - place
        radius = float(record.area @ depth) / float(np.pi * depth @ depth)
        if not radius > 0:
            raise LoadingError("contact area falls as the pad is pressed: is the sign of a column reversed?")
    stiffness = hertz_stiffness(radius, record.poisson_ratio)
    start = {
        "contact_offset": place,
        "initial_modulus": float(linear) / stiffness,
        "load_coefficient": growth / stiffness,
        "loading_radius": radius,
    }
    if press.baseline_rows >= _ZERO_ROWS:
        start["force_zero"] = float(parts[0])
    if tilt:
        start["force_tilt"] = float(parts[1])
    return start


def fixed_quantities(press: Press, loading_radius: float | Estimate | None) -> dict[str, Estimate]:
    """Return what is not fitted. Without area the radius is held at 1 mm: the place of contact needs none."""
    if loading_radius is None:
        return {} if press.record.area.size else {"loading_radius": Estimate.symmetric(1.0, 0.0)}
    given = loading_radius
    radius = given if isinstance(given, Estimate) else Estimate.symmetric(given, 0.0)
    if not (radius.value > 0 and math.isfinite(radius.value)):
        raise LoadingError(f"loading_radius must be positive and finite, found {radius.value} mm")
    return {"loading_radius": radius}


def known_quantities(
    curve: LoadingCurve,
    *,
    stage_compliance: float | Estimate | None = None,
    area_delay: float | Estimate | None = None,
    thickness: float | Estimate | None = None,
    area_relative_std: float = 0.0,
) -> dict[str, Estimate]:
    """Return what is known of the instrument that recorded a curve, and of the layer that it pressed."""
    check_std("area_relative_std", area_relative_std)
    given = {"stage_compliance": stage_compliance, "area_delay": area_delay, "thickness": thickness}
    found = {
        name: value if isinstance(value, Estimate) else Estimate.symmetric(value, 0.0)
        for name, value in given.items()
        if value is not None
    }
    for name, one in found.items():
        endless = name == "thickness" and one.value == math.inf and one.std == 0
        if not (endless or (math.isfinite(one.value) and 0 <= one.std < math.inf)):
            unless = " (a half-space: inf, without uncertainty)" if name == "thickness" else ""
            raise LoadingError(f"{name} must be finite{unless}, found {one.value} ± {one.std}")
    if "stage_compliance" in found and found["stage_compliance"].value < 0:
        raise LoadingError(f"stage_compliance must not be negative, found {found['stage_compliance'].value}")
    if "area_delay" in found and curve.time is None:
        raise LoadingError("area_delay is a time, and the curve has none: add its column of time")
    if "thickness" in found:
        layer = found.pop("thickness")
        if not layer.value > 0:
            raise LoadingError(f"thickness must be above zero, found {layer.value} mm; inf for no layer")
        inverse = 1 / layer.value
        found["inverse_thickness"] = Estimate.symmetric(inverse, layer.std * inverse**2 if layer.std else 0.0)
    if area_relative_std:
        found["area_gain"] = Estimate.symmetric(1.0, area_relative_std)
    return found


def check_std(name: str, std: float) -> None:
    """Raise LoadingError for a standard uncertainty that is none."""
    if not 0 <= std < math.inf:
        raise LoadingError(f"{name} must be finite and not negative, found {std}")


def _require_contact(record: FitData) -> None:
    """Raise where the force does not rise out of its noise as the platen moves in, or falls."""
    rise, rest = contact_rise(record.clock, record.load, record.smooth_displacement)
    noise = float(np.std(rest))
    size = float(rise[np.argmax(np.abs(rise))])
    if both_reversed(record.clock, record.load, record.smooth_displacement):
        raise LoadingError(BOTH_REVERSED)
    if not abs(size) > _CONTACT_DEVIATIONS * noise:
        raise FitError(
            f"no contact in the record: the force changes by {abs(size):.3g} N while the platen moves in, "
            f"against noise of {noise:.3g} N"
        )
    if size < 0:
        raise LoadingError(
            "the force falls as the displacement grows: the sign of one is reversed; compression is "
            "positive, and displacement grows into the pad"
        )
