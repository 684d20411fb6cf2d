"""Loading curves of a study, read and fitted."""

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property, partial
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np

from fingerpad import loading
from fingerpad._arrays import FloatArray
from fingerpad._columns import columns_in_toml, columns_named_by
from fingerpad._records import fields_from
from fingerpad.contact import Tissue, solve_contact
from fingerpad.contact.contact import reduced_modulus
from fingerpad.estimate import Estimate
from fingerpad.exceptions import ConvergenceError, FingerpadError, FitError, GeometryError, reason_of
from fingerpad.flags import FLAGS
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.image import SEMI_AXES
from fingerpad.study.engine.task import Record, Work, in_study, versions_of
from fingerpad.study.manifest.models import Curve, Finger, Study, Uncertainty
from fingerpad.study.measuring.context import FoundScale, OneTaskItem, cache_key, require_scale
from fingerpad.study.measuring.fingers import FingerResult, PhotographItem, pad_of, photograph_item
from fingerpad.uncertainty import Inputs, placement_model, pool, propagate, proportional_stds

# A curve can be damaged in unforeseen ways, which cost it alone.
_RECOVERABLE_ERRORS: Final = (ArithmeticError, MemoryError, OSError, ValueError)
_SHAPE_LOADS, _SHAPE_POINTS = 4, 80


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Shape:
    """E* from area over E* from indentation that the true ellipsoid makes, against load (N); radius in mm."""

    geometric_mean_radius: float
    load: FloatArray
    ratio: FloatArray


_IMPLAUSIBLE: Final = frozenset(flag.code for flag in FLAGS["curve"].values() if flag.excludes)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CurveResult:
    """Loading data and what they tell."""

    manifest: Curve  # what the manifest says of it
    # mm; NaN where it is unknown, and for an uncertainty that was not given.
    loading_radius: float = math.nan
    loading_radius_std: float = math.nan
    area_relative_std: float = 0.0  # the part of the scale of areas, relative to R_g
    curve: loading.LoadingCurve | None = None  # None where only R_g was given
    fit: loading.LoadingFit | None = None
    velocity: float = math.nan  # of the platen while loading, mm/s; NaN without times
    shape: Shape | None = None
    layer: loading.LayerThicknessFit | None = None  # with areas and semi-axes, where no thickness is stated
    reason: str | None = None  # why there is no R_g, or why there is nothing but it

    @property
    def failed(self) -> bool:
        """Whether it gave no radius and no fit."""
        return self.fit is None and math.isnan(self.loading_radius)

    @property
    def is_plausible(self) -> bool:
        """Whether R_g and modulus can be a finger pad's: if not, one of its units is another."""
        return self.fit is None or _IMPLAUSIBLE.isdisjoint(self.fit.flags)

    @property
    def name(self) -> str:
        """The file, or whose radius was given."""
        of = self.manifest
        return of.file or f"{of.finger} at {of.wedge_angle_deg:g}°, R_g as given"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CurveItem(OneTaskItem[Curve]):
    """A loading curve; nothing is measured of one without a file, whose radius was found elsewhere."""

    finger: Finger
    photographs: Sequence[PhotographItem]  # needed before the curve is compared with the pad

    @cached_property
    def key(self) -> str:
        """Digest of all that its result depends on, the shape of the pad among it."""
        context, pad = self.context, self.finger
        faces = [
            (photograph.face, context.key(photograph, context.edits(item), context.is_rejected(item)))
            for item, photograph in ((photograph_item(pad, one), one) for one in pad.photographs)
        ]
        axes = pad.model_dump(mode="json", include={"semi_axes_mm", "semi_axes_mm_std"})
        given = context.study.uncertainty
        # What is not stated is no part of the key: results of manifests that are older hold.
        unstated = {
            name for name in ("jig_angle_deg_std", "load_gain_relative_std") if not getattr(given, name)
        }
        stds = given.model_dump(mode="json", exclude={"method", *unstated})
        fitted = context.key(self.table, self.table.wedge_angle_deg, context.study.poisson_ratio)
        return cache_key(fitted, stds, axes, faces, versions_of("loading"))

    def work(self) -> Work:
        """Return what fits it."""
        pad, given = pad_of(self.finger, self.photographs, self.context), self.context.study.uncertainty
        return RecordedCurve(
            manifest=self.table,
            poisson_ratio=self.context.study.poisson_ratio,
            given=given,
            scale=self.scale,
            placed=PlacedPad(pad, self.table.wedge_angle_deg, given) if pad.has_semi_axes else None,
        ).record

    def result(self) -> CurveResult:
        """Return what was found, here or elsewhere."""
        if not self.file:
            radius, std = self.table.loading_radius_mm, self.table.loading_radius_mm_std
            assert radius is not None  # the manifest's own rule
            return CurveResult(manifest=self.table, loading_radius=radius, loading_radius_std=std or math.nan)
        record = self.record
        if "curve" not in record:
            return CurveResult(manifest=self.table, reason=record["reason"])
        return CurveResult(manifest=self.table, **fields_from(CurveResult, record["curve"]))


def curve_names(study: Study) -> list[str | None]:
    """Return the name of each curve as an item, finger and file; None for one without a file."""
    seen: Counter[str] = Counter()
    names: list[str | None] = []
    for curve in study.curves:
        item = f"{curve.finger}/{curve.file}"
        seen[item] += 1
        names.append(curve.file and (item if seen[item] == 1 else f"{item} ({seen[item]})"))
    return names


class PlacedPad:
    """The pad where a curve presses it, its radius as uncertain as R_0g of the study's contacts."""

    def __init__(self, finger: FingerResult, wedge_angle_deg: float, stds: Uncertainty) -> None:
        along, along_std, across_std = finger.shape_deviation(wedge_angle_deg, 0.0)
        wedge_angle = math.radians(wedge_angle_deg)
        axes: dict[str, Any] = dict(zip(SEMI_AXES, finger.semi_axes.tolist(), strict=True))
        inputs = Inputs.of(
            **axes,
            wedge_angle=(wedge_angle, math.radians(stds.wedge_deg_std)),
            roll_angle=(0.0, math.radians(stds.roll_angle_deg_std)),
            in_plane_deviation=(along, along_std),
            transverse_deviation=(0.0, across_std),
        )
        known = propagate(_radii, inputs.with_covariance(SEMI_AXES, finger.covariance))
        self.pad = Ellipsoid(*finger.semi_axes)
        # Of a pad that is larger as a whole both radii are larger by as much.
        larger = Ellipsoid(*(finger.semi_axes * math.exp(along / 2)))
        self.placement = Placement(larger, wedge_angle=wedge_angle)
        # Standard uncertainties of 1/H, mm, and of R1/R2.
        self.radius_std, self.radius_ratio_std = float(known["radius"].std), float(known["ratio"].std)
        self.scale = finger.scale  # of all its photographs


def _radii(**inputs: FloatArray) -> dict[str, FloatArray]:
    """Return 1/H and R1/R2 of a pad where it touches a plate."""
    placed = placement_model(**inputs)
    ratio = placed["in_plane_radius"] / placed["transverse_radius"]
    return {"radius": placed["mean_curvature_radius"], "ratio": ratio}


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordedCurve:
    """A loading curve in a file, and what is known of the press."""

    manifest: Curve
    poisson_ratio: float
    given: Uncertainty
    scale: FoundScale | str | None = None  # of its areas, or why there is none
    placed: PlacedPad | None = None  # the pad that was pressed

    def record(self, folder: Path, _out: Path) -> Record:
        """Fit it, and with areas and a pad a layer of tissue too: the work of its task."""
        curve, placed, scale = self.manifest, self.placed, self.scale
        found = self.fitted(folder, None if placed is None else placed.pad)
        data = found.curve
        if data is not None and data.area is not None and placed is not None and curve.thickness_mm is None:
            known = self._instrument()
            if isinstance(scale, FoundScale) and scale.name is not None and scale.name == placed.scale:
                known["shared_scale_std"] = scale.scale.relative_std
            try:
                layer = loading.fit_layer_thickness(
                    data,
                    placement=placed.placement,
                    radius_std=placed.radius_std,
                    radius_ratio_std=placed.radius_ratio_std,
                    poisson_ratio=self.poisson_ratio,
                    poisson_ratio_std=self.given.poisson_ratio_std,
                    load_relative_std=self.given.load_std,
                    cycle=curve.cycle,
                    **known,
                )
            except FingerpadError as error:
                layer = loading.LayerThicknessFit.undetermined(str(error))
            found = replace(found, layer=layer)
        values = {one.name: getattr(found, one.name) for one in fields(found) if one.name != "manifest"}
        return {"curve": values, "reason": found.reason if found.failed else None}

    def fitted(self, folder: Path, pad: Ellipsoid | None) -> CurveResult:
        """Read and fit it; one that cannot be used costs itself only.

        Where the record does not determine the whole fit, the slope of area against indentation may still
        give R_g, with the reason beside it.
        """
        curve = self.manifest
        radius, std, loads = curve.loading_radius_mm, curve.loading_radius_mm_std, curve.fit_load_range_N
        assert curve.file is not None  # what was found elsewhere is not fitted
        nothing, data = CurveResult(manifest=curve), None
        placement = None if pad is None else Placement(pad, wedge_angle=math.radians(curve.wedge_angle_deg))
        known: dict[str, Any] = {}
        try:
            known = self._instrument()
            with columns_named_by(partial(columns_in_toml, "file_columns")):
                data = loading.read_loading_curve(
                    folder / curve.file, {str(key): value for key, value in curve.file_columns.items()}
                )
            fit = loading.fit_loading_curve(
                data,
                poisson_ratio=self.poisson_ratio,
                placement=placement,
                loading_radius=None if radius is None else Estimate.symmetric(radius, std or 0.0),
                cycle=curve.cycle,
                contact_point=curve.contact_point,
                fit_load_range=(loads[0], loads[1]) if loads else None,
                load_relative_std=self.given.load_gain_relative_std,
                poisson_ratio_std=self.given.poisson_ratio_std,
                **known,
                **_stated("thickness", curve.thickness_mm, curve.thickness_mm_std),
            )
        except (FingerpadError, *_RECOVERABLE_ERRORS) as error:
            words = in_study(reason_of(error, f"{curve.file}: cannot be fitted"), folder)
            reason = words if words.startswith(curve.file) else f"{curve.file}: {words}"
            failed = replace(nothing, curve=data, reason=reason)
            return _slope_alone(failed, known) if isinstance(error, FitError) else failed
        found = fit.loading_radius
        return replace(
            nothing,
            loading_radius=found.value,
            loading_radius_std=found.std,
            area_relative_std=known.get("area_relative_std", 0.0) if radius is None else 0.0,
            curve=data,
            fit=fit,
            velocity=_velocity(data, fit, curve.cycle),
            shape=_shape(placement, fit, self.poisson_ratio),
            reason=f"{curve.file}: {found.reason}" if found.reason else None,
        )

    def _instrument(self) -> dict[str, Any]:
        """Return what the manifest states of the instrument, as the fits take it."""
        of, scale = self.manifest, self.scale
        area = of.area_relative_std if scale is None else 2 * require_scale(scale).scale.relative_std
        return {
            **_stated("stage_compliance", of.stage_compliance_mm_per_N, of.stage_compliance_mm_per_N_std),
            **_stated("area_delay", of.area_delay_s, of.area_delay_s_std),
            **({} if area is None else {"area_relative_std": area}),
        }


def _stated(name: str, value: float | None, std: float | None) -> dict[str, Any]:
    return {} if value is None else {name: Estimate.symmetric(value, std or 0.0)}


def _slope_alone(failed: CurveResult, known: Mapping[str, Any]) -> CurveResult:
    """Return what is left where a curve cannot be fitted as a whole: R_g from its slope, if that."""
    if failed.curve is None or failed.manifest.loading_radius_mm is not None:
        return failed
    try:
        radius = loading.fit_contact_compliance(failed.curve, cycle=failed.manifest.cycle)
    except FingerpadError:
        return failed
    area_std = known.get("area_relative_std", 0.0)
    return replace(
        failed,
        loading_radius=radius.value,
        loading_radius_std=math.hypot(radius.std, area_std * radius.value),
        area_relative_std=area_std,
        reason=f"{failed.reason}; only the slope of area against indentation is known",
    )


def _velocity(curve: loading.LoadingCurve, fit: loading.LoadingFit, cycle: int) -> float:
    rows = fit.cycles[cycle].loading.rows
    if curve.time is None or not np.ptp(curve.time[rows]) > 0:
        return math.nan
    return float(np.polyfit(curve.time[rows], curve.indentation[rows], 1)[0])


def _shape(placement: Placement | None, fit: loading.LoadingFit, poisson_ratio: float) -> Shape | None:
    """Return what the pad's true shape makes of the moduli; None without a pad, a modulus or a contact."""
    initial, growth = fit.initial_modulus, fit.load_coefficient
    if placement is None or not (initial.known and growth.known):
        return None
    radius = float(placement.curvature.geometric_mean_radius)
    loads = np.linspace(0, fit.modulus_load, _SHAPE_LOADS + 1)[1:]
    moduli = reduced_modulus(initial.value + growth.value * loads, poisson_ratio)
    try:
        pressed = [
            solve_contact(
                placement, Tissue.of_reduced_modulus(float(modulus)), load=float(load), points=_SHAPE_POINTS
            )
            for load, modulus in zip(loads, moduli, strict=True)
        ]
    except (GeometryError, ConvergenceError):
        return None
    indentation, area = np.array([(one.indentation, one.area) for one in pressed]).T
    ratio = loading.sphere_ratio(indentation, area, loading_radius=radius)
    return Shape(geometric_mean_radius=radius, load=loads, ratio=ratio)


class LoadingRadius(NamedTuple):
    """R_g of a finger at an angle, from all its curves there, mm, with flags of their fits.

    What a wrong model and the scale of the areas leave uncertain is common to curves: pooling does not reduce
    it. `misfit_std` is the former part of `std`, `area_std` the latter, from the scale of this name where all
    curves have one.
    """

    value: float
    std: float
    flags: tuple[str, ...] = ()
    misfit_std: float = 0.0
    area_std: float = 0.0
    scale: str | None = None


def each_press_once(curves: Iterable[CurveResult]) -> list[CurveResult]:
    """Return curves without those of a press that has been given before, as with another fit."""
    presses: dict[object, CurveResult] = {}
    for one in curves:
        presses.setdefault(one.manifest.press or id(one), one)
    return list(presses.values())


def loading_radius(curves: Iterable[CurveResult], pressed: tuple[str, float, bool]) -> LoadingRadius | None:
    """Return R_g from loading data of a finger at its angle, pooled over its curves; None without any.

    A press that is given twice counts once, and none without an uncertainty beside others that have one.
    """
    presses = each_press_once(
        one
        for one in curves
        if one.manifest.finger_and_wedge == pressed
        and math.isfinite(one.loading_radius)
        and not (one.fit and "implausible_radius" in one.fit.flags)
    )
    if not presses:
        return None
    fitting = [one for one in presses if math.isfinite(one.loading_radius_std)] or presses
    values, stds = np.array([(each.loading_radius, each.loading_radius_std) for each in fitting]).T
    misfits = np.array([each.fit.misfit_std["loading_radius"] if each.fit else 0.0 for each in fitting])
    flags = tuple(sorted({flag for each in fitting if each.fit for flag in each.fit.notes}))
    if not np.isfinite(stds).all():
        return LoadingRadius(float(values.mean()), math.nan, flags)
    of_areas = values * [each.area_relative_std for each in fitting]
    own = np.sqrt(np.maximum(stds**2 - misfits**2 - of_areas**2, 0.0))
    pooled = pool(values, proportional_stds(values, own))
    misfit = float(misfits.max())
    area_std = float(of_areas.max())
    std = math.hypot(pooled.total_std, misfit, area_std)
    scales = [each.manifest.scale for each in fitting]
    scale = scales[0] if isinstance(scales[0], str) and scales.count(scales[0]) == len(scales) else None
    return LoadingRadius(pooled.value, std, flags, misfit, area_std, scale)
