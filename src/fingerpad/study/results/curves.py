"""Loading curves of a study, fitted, and the effective radius that they give at a placement."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad.contact import HalfSpaceContact, reduced_modulus
from fingerpad.exceptions import FingerpadError, FitError, GeometryError
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.loading import (
    Estimate,
    LoadingCurve,
    LoadingFit,
    Unknown,
    fit_contact_compliance,
    fit_loading_curve,
    read_loading_curve,
    shape_check,
)
from fingerpad.study.engine.hands import Hands
from fingerpad.study.engine.runner import records_of
from fingerpad.study.engine.task import Record, Task
from fingerpad.study.manifest import Curve, Study
from fingerpad.study.measuring.fingers import FingerResult
from fingerpad.study.words import ODDITIES, in_study
from fingerpad.uncertainty import pool

_SHAPE_LOADS, _SHAPE_POINTS = 4, 80


class Shape(NamedTuple):
    """E* from area over E* from indentation that the true ellipsoid makes, against load."""

    geometric_mean_radius: float
    load: FloatArray
    ratio: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CurveResult:
    """Loading data and what they tell.

    Attributes
    ----------
    manifest : Curve
        What the manifest says of it.
    effective_radius, effective_radius_std : float
        R_g, mm; NaN where it could not be had, and for an uncertainty that was not given.
    curve : LoadingCurve or None
        The data; None where only R_g was given or they could not be read.
    fit : LoadingFit or None
        Everything fitted to them.
    velocity : float
        Speed of the platen while loading, mm/s; NaN without times.
    shape : Shape or None
        What the true ellipsoid makes of moduli from area and from indentation, where it can be computed.
    reason : str or None
        Why there is no R_g, or why there is nothing but it.
    """

    manifest: Curve
    effective_radius: float = math.nan
    effective_radius_std: float = math.nan
    curve: LoadingCurve | None = None
    fit: LoadingFit | None = None
    velocity: float = math.nan
    shape: Shape | None = None
    reason: str | None = None

    @property
    def failed(self) -> bool:
        """Whether it gave no radius and no fit."""
        return self.fit is None and math.isnan(self.effective_radius)

    @property
    def name(self) -> str:
        """The file, or whose radius was given."""
        return (
            self.manifest.file
            or f"{self.manifest.finger} at {self.manifest.wedge_angle_deg:g}°, R_g as given"
        )


def curve_results(study: Study, fingers: Mapping[str, FingerResult], hands: Hands) -> list[CurveResult]:
    """Read and fit all loading curves of a study, in the manifest's order.

    Parameters
    ----------
    study : Study
        The manifest.
    fingers : mapping of str to FingerResult
        Semi-axes by finger.
    hands : Hands
        Who fits them.
    """
    tasks = [
        Task(
            name=str(number),
            item=curve.finger,
            file=curve.file or "",
            key="",
            work=partial(_fitted, curve, fingers[curve.finger], study.poisson_ratio),
            inputs=() if curve.file is None else (curve.file,),
        )
        for number, curve in enumerate(study.curves)
    ]
    return [
        record["curve"] if "curve" in record else CurveResult(manifest=curve, reason=record["reason"])
        for curve, record in zip(study.curves, records_of(tasks, hands), strict=True)
    ]


def _fitted(curve: Curve, finger: FingerResult, poisson_ratio: float, folder: Path, _out: Path) -> Record:
    return {"curve": curve_result(curve, finger, poisson_ratio, folder)}


def curve_result(curve: Curve, finger: FingerResult, poisson_ratio: float, folder: Path) -> CurveResult:
    """Read and fit one loading curve; one that cannot be used costs itself only.

    Where the record does not determine the whole fit, the slope of area against indentation may still give
    R_g, with the reason beside it.
    """
    radius, std = curve.effective_radius_mm, curve.effective_radius_std_mm
    given = math.nan if radius is None else radius
    if curve.file is None:
        return CurveResult(manifest=curve, effective_radius=given, effective_radius_std=std or math.nan)
    data = None
    try:
        data = read_loading_curve(
            folder / curve.file, {str(key): value for key, value in curve.columns.items()}
        )
        fit = fit_loading_curve(
            data,
            poisson_ratio=poisson_ratio,
            effective_radius=None if radius is None else Estimate.symmetric(radius, std or 0.0),
            cycle=curve.cycle,
            contact_point=curve.contact_point,
            region=None if curve.region_N is None else (curve.region_N[0], curve.region_N[1]),
        )
    except FitError as error:
        return _slope_alone(curve, data, _named(error, curve.file, folder))
    except FingerpadError as error:
        return CurveResult(manifest=curve, curve=data, reason=_named(error, curve.file, folder))
    except ODDITIES as error:
        reason = f"{curve.file}: cannot be fitted ({type(error).__name__}: {error})"
        return CurveResult(manifest=curve, curve=data, reason=reason)
    found = fit.effective_radius
    return CurveResult(
        manifest=curve,
        effective_radius=found.value if isinstance(found, Estimate) else math.nan,
        effective_radius_std=found.std if isinstance(found, Estimate) else math.nan,
        curve=data,
        fit=fit,
        velocity=_velocity(data, fit, curve.cycle),
        shape=_shape(finger, curve, fit, poisson_ratio),
        reason=f"{curve.file}: {found.reason}" if isinstance(found, Unknown) else None,
    )


def _slope_alone(curve: Curve, data: LoadingCurve | None, reason: str) -> CurveResult:
    """Return what is left where a curve cannot be fitted as a whole: R_g from its slope, if that."""
    if data is None or curve.effective_radius_mm is not None:
        return CurveResult(manifest=curve, curve=data, reason=reason)
    try:
        line = fit_contact_compliance(data)
    except FingerpadError:
        return CurveResult(manifest=curve, curve=data, reason=reason)
    return CurveResult(
        manifest=curve,
        effective_radius=line.effective_radius,
        effective_radius_std=line.effective_radius_std,
        curve=data,
        reason=f"{reason}; only the slope of area against indentation is known",
    )


def _named(error: FingerpadError, file: str, folder: Path) -> str:
    """Return an error's words, which begin with the file's name in the study."""
    words = in_study(error, folder)
    return words if words.startswith(file) else f"{file}: {words}"


def _velocity(curve: LoadingCurve, fit: LoadingFit, cycle: int) -> float:
    rows = fit.cycles[cycle].loading.rows
    if curve.time is None or not np.ptp(curve.time[rows]) > 0:
        return math.nan
    return float(np.polyfit(curve.time[rows], curve.indentation[rows], 1)[0])


def _shape(finger: FingerResult, curve: Curve, fit: LoadingFit, poisson_ratio: float) -> Shape | None:
    """Return what the pad's true shape makes of the moduli; None without a pad, a modulus or the solver."""
    initial, growth = fit.initial_modulus, fit.load_coefficient
    if finger.reason is not None or not isinstance(initial, Estimate) or not isinstance(growth, Estimate):
        return None
    pad, wedge = Ellipsoid.of(*finger.semi_axes), math.radians(curve.wedge_angle_deg)
    radius = float(Placement.of(pad, wedge_angle=wedge).curvature.geometric_mean_radius)
    loads = np.linspace(0, fit.modulus_load, _SHAPE_LOADS + 1)[1:]
    moduli = reduced_modulus(initial.value + growth.value * loads, poisson_ratio)
    try:
        pressed = [
            HalfSpaceContact.of(
                pad,
                wedge_angle=wedge,
                load=float(load),
                reduced_modulus=float(modulus),
                points=_SHAPE_POINTS,
            )
            for load, modulus in zip(loads, moduli, strict=True)
        ]
    except (GeometryError, ModuleNotFoundError):
        return None
    indentation, area = np.array([(one.indentation, one.area) for one in pressed]).T
    return Shape(radius, loads, shape_check(loads, indentation, area, effective_radius=radius).ratio)


class LoadingRadius(NamedTuple):
    """R_g of a finger at an angle, from all its curves there, mm."""

    value: float
    std: float
    synthetic: bool


def loading_radius(
    curves: Iterable[CurveResult], finger: str, wedge_angle_deg: float, *, synthetic: bool
) -> LoadingRadius | None:
    """Return R_g from loading data of a finger at its angle, pooled over its curves; None without any."""
    fitting = [
        curve
        for curve in curves
        if curve.manifest.finger == finger
        and curve.manifest.wedge_angle_deg == wedge_angle_deg
        and curve.manifest.synthetic == synthetic
        and math.isfinite(curve.effective_radius)
    ]
    if not fitting:
        return None
    values, stds = np.array([(each.effective_radius, each.effective_radius_std) for each in fitting]).T
    if not np.isfinite(stds).all():
        return LoadingRadius(float(values.mean()), math.nan, synthetic)
    pooled = pool(values, stds)
    return LoadingRadius(pooled.value, pooled.total_std, synthetic)
