"""Radius, modulus and indentation from images against those of the finger's loading data.

What a misfit of the model adds to the uncertainty of loading data is left out: whether the model holds is
the question.
"""

import math
from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

import numpy as np
import pandas as pd

from fingerpad._arrays import FloatArray
from fingerpad.contact.fast_laws import law_form, plate_gap
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.loading import LoadingFit
from fingerpad.study.measuring.curves import CurveResult, LoadingRadius
from fingerpad.study.results.layer import LayerQuantity, curve_on_layer
from fingerpad.study.results.pooling import LayerSummary, area_noise, items_of
from fingerpad.study.results.validity.contact_checks import measured_shape
from fingerpad.study.results.validity.model_checks import (
    INDENTATION,
    MODULUS,
    NO_CURVE,
    NOTHING_COUNTS,
    RADIUS,
    ROUTES,
    SAME_LOAD,
    UNITS,
    FingerAtAngle,
    ValidityCheck,
)
from fingerpad.uncertainty import pool, pool_random_effects
from fingerpad.units import KPA_PER_MPA

_CHECKS: Final = {
    name: ValidityCheck(name=ROUTES[name], compared=words, quantities=(name,), unit=UNITS[name])
    for name, words in (
        (RADIUS, "A/(πξ) of Hertz theory for the pad, and R_g from loading data"),
        (MODULUS, "E from load and area, and from load and indentation"),
        (INDENTATION, "ξ from the area, and of the loading data"),
    )
}
_TAKEN_AS_EXACT: Final = "R_g has no stated uncertainty and is taken as exact"
_SAME_COMPARISON: Final = "from area and R_g, so the same comparison as that of the radius"
# Loads at which a curve is compared, relative to its highest.
_SMALLEST_LOAD, _LARGEST_LOAD = 0.1, 1.05
_LAW_POINTS: Final = 400


def loading_checks(case: FingerAtAngle) -> Iterator[ValidityCheck]:
    """Yield the comparisons of images with loading data."""
    yield _radius_check(case)
    yield from _curve_checks(case) if case.fits else _from_loading_radius(case)


def _without(std: float, part: float) -> float:
    """Return a standard uncertainty without a part of it."""
    return math.sqrt(max(std**2 - part**2, 0.0))


def without_misfit(loading: LoadingRadius) -> tuple[tuple[float, float], str]:
    """Return R_g with its standard uncertainty without that of a misfit, and a note."""
    if math.isnan(loading.std):
        return (loading.value, 0.0), _TAKEN_AS_EXACT
    return (loading.value, _without(loading.std, loading.misfit_std)), ""


def _radius_check(case: FingerAtAngle) -> ValidityCheck:
    loading, pooled = case.loading, case.summary.compliance_radius
    if loading is None or pooled is None:
        return _CHECKS[RADIUS].untested(NO_CURVE if loading is None else NOTHING_COUNTS)
    # Pooled on 1/H; exact Hertz theory has the geometric mean radius.
    first = case.summary.first
    factor = first["geometric_mean_radius_mm"] / first["mean_curvature_radius_mm"]
    reference, note = without_misfit(loading)
    return _CHECKS[RADIUS].of_ratio(
        (factor * pooled.value, factor * pooled.std),
        reference,
        log_std=_shared_scale_std(case, loading, pooled.std / pooled.value, reference[1]),
        note=note,
    )


def _shared_scale_std(
    case: FingerAtAngle, loading: LoadingRadius, relative_std: float, loading_std: float
) -> float | None:
    """Return that of the logarithm of a radius over R_g where outlines and areas share a scale, else None."""
    if loading.scale is None or loading.scale != case.pad.scale:
        return None
    # The pad's radius goes with the scale, R_g with its square.
    apart = relative_std**2 + (loading_std / loading.value) ** 2
    return math.sqrt(apart - (loading.area_std / loading.value) ** 2)


def _from_loading_radius(case: FingerAtAngle) -> Iterator[ValidityCheck]:
    """Compare E and ξ with those that follow from the area and R_g, where no loading curve was fitted."""
    row, loading = case.highest_row, case.loading
    # For one area and load ξ goes with 1/R and E with R.
    for name, power in ((MODULUS, 1), (INDENTATION, -1)):
        if row is None or loading is None:
            yield _CHECKS[name].untested(NO_CURVE if loading is None else NOTHING_COUNTS)
            continue
        radius = row["geometric_radius_from_compliance_mm"]
        relative = row["geometric_radius_from_compliance_mm_std"] / radius
        other = without_misfit(loading)[0][1] / loading.value
        value, std = row[name], row[f"{name}_std"]
        reference = value * (loading.value / radius) ** power
        of_area = _without(std / value, relative)
        yield _CHECKS[name].of_ratio(
            (value, std),
            (reference, reference * math.hypot(of_area, other)),
            log_std=math.hypot(relative, other),
            note=f"at {row['load_N']:.3g} N, {_SAME_COMPARISON}",
        )


def _curve_checks(case: FingerAtAngle) -> Iterator[ValidityCheck]:
    """Compare E and ξ with those of the loading curves, at the highest load of both."""
    load, top = case.summary.column("load_N"), min(fit.modulus_load for fit in case.fits)
    under = (load <= _LARGEST_LOAD * top) & (load >= _SMALLEST_LOAD * top)
    inside = case.summary.where(case.summary.column("pooled") & under)
    if inside.empty:
        yield from (
            _CHECKS[name].untested("no contact under a load of the curves") for name in (MODULUS, INDENTATION)
        )
        return
    repeats = _one_of_each(inside[inside["load_N"] >= SAME_LOAD * inside["load_N"].max()])
    common = math.exp(np.log(repeats["load_N"].to_numpy()).mean())
    factor = 1 - case.study.poisson_ratio**2  # the same in both moduli, so without its uncertainty
    # The fit takes the contact for that of a sphere of radius R_g, which makes E too large by 1/(F1 F2).
    of_ellipse = (
        repeats["geometric_radius_from_area_mm"].to_numpy()
        / repeats["geometric_radius_from_compliance_mm"].to_numpy()
    )
    reference = _at_load(case.fits, common, factor * float(of_ellipse.mean()))
    load_std = case.study.uncertainty.load_relative_std
    modulus, modulus_std = _mean_of_repeats(
        repeats, "reduced_modulus_kpa", np.hypot(1.5 * area_noise(repeats), load_std)
    )
    # The gain of the force is the same in both moduli, and in the load at which the curve is read.
    modulus_std = _without(modulus_std, case.study.uncertainty.load_gain_relative_std * modulus)
    indentation = _mean_of_repeats(repeats, INDENTATION, area_noise(repeats))
    for name, value, (log_reference, log_std) in (
        (MODULUS, (factor * modulus, factor * modulus_std), reference.modulus),
        # The curve's ξ is read at the contact's load, which is uncertain.
        (
            INDENTATION,
            indentation,
            (reference.indentation[0], math.hypot(reference.indentation[1], load_std * 2 / 3)),
        ),
    ):
        if math.isnan(log_reference):
            yield _CHECKS[name].untested("the loading curves have no areas, so no radius, which E needs")
            continue
        other = math.exp(log_reference)
        yield _CHECKS[name].of_ratio(
            value,
            (other, other * log_std),
            note=f"at {common:.3g} N",
        )


def _one_of_each(rows: pd.DataFrame) -> pd.DataFrame:
    """Return single contacts, and of each sequence the frame at the highest load."""
    rows = rows.sort_values("load_N", ascending=False, kind="stable")
    return rows.iloc[np.unique(items_of(rows), return_index=True)[1]]


def _mean_of_repeats(rows: pd.DataFrame, column: str, own: FloatArray) -> tuple[float, float]:
    """Return the mean of a column over repeats, with what they share and how they scatter."""
    relative = rows[f"{column}_std"].to_numpy() / rows[column].to_numpy()
    own = np.minimum(relative, own)
    shared = np.sqrt(relative**2 - own**2)
    pooled = pool(np.log(rows[column].to_numpy()), own, np.outer(shared, shared))
    return math.exp(pooled.value), math.exp(pooled.value) * pooled.total_std


class _Reference(NamedTuple):
    """Logarithms of ξ (mm) and E (kPa) of the loading curves, each with its standard uncertainty."""

    indentation: tuple[float, float]
    modulus: tuple[float, float]


def _at_load(fits: Sequence[LoadingFit], load: float, factor: float) -> _Reference:
    """Return ξ and E of some loading curves at a load; how far curves differ is part of the uncertainty."""
    found = []
    for fit in fits:
        law, offset = fit.models["load_dependent"], fit.contact_offset
        radius, top = fit.loading_radius, fit.reduced_modulus
        place_std = _without(offset.std, fit.misfit_std["contact_offset"])
        depth = np.linspace(0, _LARGEST_LOAD * float(fit.secant.indentation.max()), _LAW_POINTS)
        loads = law.load(depth + law.values["contact_offset"])
        xi, deepest = (float(np.interp(at, loads, depth)) for at in (load, fit.modulus_load))
        modulus = math.nan, math.nan
        if radius.known and top.known:
            e = 0.75 * KPA_PER_MPA * factor * load / (math.sqrt(radius.value) * xi**1.5)
            more = 1.5 * place_std * (1 / xi - 1 / deepest)  # of the place of contact at a smaller load
            at_top = _without(top.std, fit.misfit_std["reduced_modulus"]) / top.value
            modulus = math.log(e), math.hypot(at_top, more)
        found.append((math.log(xi), place_std / xi, *modulus))
    xi_values, xi_stds, moduli, modulus_stds = np.transpose(found)
    return _Reference(of_curves(xi_values, xi_stds), of_curves(moduli, modulus_stds))


def of_curves(values: FloatArray, stds: FloatArray) -> tuple[float, float]:
    """Return the mean of curves, with how far another one would differ from it."""
    known = np.isfinite(values) & (stds > 0)
    if not known.any():
        return math.nan, math.nan
    pooled = pool_random_effects(values[known], stds[known])
    return pooled.value, math.hypot(pooled.total_std, pooled.between_std)


_ON_LAYER: Final = ("loading_radius_on_layer_mm", "youngs_modulus_on_layer_kpa", "indentation_on_layer_mm")
_LAYER_RADIUS: Final = ValidityCheck(
    name="loading_radius_on_layer",
    compared="A/(πξ) on the layer, and R_g from loading data",
    quantities=_ON_LAYER[:1],
    unit="mm",
)
_LAYER_MODULUS: Final = ValidityCheck(
    name="modulus_on_layer",
    compared="E on the layer from load and area, and from load and indentation",
    quantities=_ON_LAYER[1:],
    unit="kPa",
)
_LAYER_SHAPE: Final = ValidityCheck(
    name="shape_on_layer",
    compared="length along the finger over that across, and of the pad on the layer",
    quantities=_ON_LAYER,
)
# A larger radius makes E from the area larger and E from the indentation smaller; thicker tissue makes both
# larger.
_OPPOSITE: Final = ("semi-axes", "pad shape", "wedge angle", "roll angle")
_ALIKE: Final = ("thickness", "Poisson's ratio")
# On a layer a slope of area against πξ and the ratio at one load differ by so much: docs/explanation/bone.md.
_READING: Final = 0.05


def layer_checks(case: FingerAtAngle, curves: Sequence[CurveResult]) -> Iterator[ValidityCheck]:
    """Yield the checks of the layer; none without a thickness, or out of the range of the laws."""
    layer = case.summary.layer
    if layer is None or layer.flag:
        return
    yield _layer_radius_check(case, layer)
    yield _modulus_check(case, layer, curves)
    yield _shape_check(case)


def _layer_radius_check(case: FingerAtAngle, layer: LayerSummary) -> ValidityCheck:
    if case.loading is None:
        return _LAYER_RADIUS.untested(NO_CURVE)
    found = layer.at_highest_load["loading_radius_on_layer"]
    (value, std), note = without_misfit(case.loading)
    std = math.hypot(std, _READING * value)
    return _LAYER_RADIUS.of_ratio(
        (found.value, found.std),
        (value, std),
        log_std=_shared_scale_std(case, case.loading, found.std / found.value, std),
        note="; ".join(filter(None, (note, f"± {100 * _READING:.0f} % for how R_g was read"))),
    )


def _modulus_check(case: FingerAtAngle, layer: LayerSummary, curves: Sequence[CurveResult]) -> ValidityCheck:
    by_curve = [
        found.quantities["youngs_modulus_from_indentation_on_layer"]
        for curve in curves
        if curve.fit in case.fits
        and (found := curve_on_layer(case.study, case.pad, curve)) is not None
        and not found.flag
    ]
    if not by_curve:
        why = "in the range of the laws" if case.fits else "of this finger at this angle"
        return _LAYER_MODULUS.untested(f"no loading curve {why}")
    own, first = layer.at_highest_load["youngs_modulus_on_layer"], by_curve[0]
    values, stds = (
        np.log([one.value for one in by_curve]),
        np.array([one.std / one.value for one in by_curve]),
    )
    log_value, std = of_curves(values, stds)
    shared = sum(_relative(own, source) * _relative(first, source) for source in _OPPOSITE)
    shared -= sum(_relative(own, source) * _relative(first, source) for source in _ALIKE)
    shared -= case.study.uncertainty.load_gain_relative_std**2  # both moduli go with the force
    variance = (own.std / own.value) ** 2 + std**2 + 2 * shared
    value = math.exp(log_value)
    return _LAYER_MODULUS.of_ratio(
        (own.value, own.std),
        (value, value * std),
        log_std=math.sqrt(max(variance, 0.0)),
    )


def _relative(quantity: LayerQuantity, source: str) -> float:
    """Return the relative standard uncertainty of a quantity from one source."""
    return quantity.std / quantity.value * math.sqrt(max(quantity.budget.get(source, 0.0), 0.0))


def _shape_check(case: FingerAtAngle) -> ValidityCheck:
    shape, row, pad = measured_shape(case), case.highest_row, case.pad
    if shape is None or row is None:
        return _LAYER_SHAPE.untested(NOTHING_COUNTS)
    placement = Placement(
        Ellipsoid(*pad.semi_axes),
        wedge_angle=math.radians(row["wedge_angle_deg"]),
        roll_angle=math.radians(row["roll_angle_deg"]),
    )
    form = law_form(
        plate_gap(placement),
        area=math.pi * row["semi_major_mm"] * row["semi_minor_mm"],
        thickness=pad.effective_thickness,
        poisson_ratio=case.study.poisson_ratio,
    )
    ratio = float(form.semi_major / form.semi_minor)
    predicted = math.log(ratio if form.along else 1 / ratio)
    return shape.against(predicted, _LAYER_SHAPE)
