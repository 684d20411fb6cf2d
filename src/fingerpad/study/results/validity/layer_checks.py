"""The whole pad on the finger's layer of tissue against loading data and the contact's shape."""

import math
from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from fingerpad.contact.fast_laws import law_form, plate_gap
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.study.measuring.curves import CurveResult
from fingerpad.study.results.layer_curve import curve_on_layer
from fingerpad.study.results.layer_summary import LayerQuantity, LayerSummary
from fingerpad.study.results.model_checks import ValidityCheck, compare_ratio
from fingerpad.study.results.validity.geometry_checks import measured_shape
from fingerpad.study.results.validity.loading_checks import of_curves, without_misfit
from fingerpad.study.results.validity.place import NO_CURVE, NOTHING_COUNTS, Place, missing

_RADIUS, _MODULUS, _SHAPE = "loading_radius_on_layer", "modulus_on_layer", "shape_on_layer"
_WORDS: Final = {
    _RADIUS: "A/(πξ) on the layer, and R_g from loading data",
    _MODULUS: "E on the layer from load and area, and from load and indentation",
    _SHAPE: "length along the finger over that across, and of the pad on the layer",
}
_ON_LAYER: Final = ("loading_radius_on_layer_mm", "youngs_modulus_on_layer_kpa", "indentation_on_layer_mm")
# A larger radius makes E from the area larger and E from the indentation smaller; thicker tissue makes both
# larger.
_OPPOSITE: Final = ("semi-axes", "pad shape", "wedge angle", "roll angle")
_ALIKE: Final = ("thickness", "Poisson's ratio")
# On a layer a slope of area against πξ and the ratio at one load differ by so much: docs/explanation/bone.md.
_READING: Final = 0.05


def layer_checks(place: Place, curves: Sequence[CurveResult]) -> Iterator[ValidityCheck]:
    """Yield the checks of the layer; none without a thickness, or out of the range of the laws."""
    layer = place.summary.layer
    if layer is None or layer.flag:
        return
    yield _radius_check(place, layer)
    yield _modulus_check(place, layer, curves)
    yield _shape_check(place)


def _radius_check(place: Place, layer: LayerSummary) -> ValidityCheck:
    if place.loading is None:
        return missing(_RADIUS, _WORDS[_RADIUS], _ON_LAYER[:1], NO_CURVE)
    found = layer.at_highest_load["loading_radius_on_layer"]
    (value, std), note = without_misfit(place.loading)
    return compare_ratio(
        _RADIUS,
        _WORDS[_RADIUS],
        _ON_LAYER[:1],
        (found.value, found.std),
        (value, math.hypot(std, _READING * value)),
        unit="mm",
        note="; ".join(filter(None, (note, f"± {100 * _READING:.0f} % for how R_g was read"))),
    )


def _modulus_check(place: Place, layer: LayerSummary, curves: Sequence[CurveResult]) -> ValidityCheck:
    of = _ON_LAYER[1:]
    by_curve = [
        found.quantities["youngs_modulus_from_indentation_on_layer"]
        for curve in curves
        if curve.fit in place.fits
        and (found := curve_on_layer(place.study, place.pad, curve)) is not None
        and not found.flag
    ]
    if not by_curve:
        why = "in the range of the laws" if place.fits else "of this finger at this angle"
        return missing(_MODULUS, _WORDS[_MODULUS], of, f"no loading curve {why}")
    own, first = layer.at_highest_load["youngs_modulus_on_layer"], by_curve[0]
    values, stds = (
        np.log([one.value for one in by_curve]),
        np.array([one.std / one.value for one in by_curve]),
    )
    log_value, std = of_curves(values, stds)
    shared = sum(_relative(own, source) * _relative(first, source) for source in _OPPOSITE)
    shared -= sum(_relative(own, source) * _relative(first, source) for source in _ALIKE)
    variance = (own.std / own.value) ** 2 + std**2 + 2 * shared
    value = math.exp(log_value)
    return compare_ratio(
        _MODULUS,
        _WORDS[_MODULUS],
        of,
        (own.value, own.std),
        (value, value * std),
        unit="kPa",
        log_std=math.sqrt(max(variance, 0.0)),
    )


def _relative(quantity: LayerQuantity, source: str) -> float:
    """Return the relative standard uncertainty of a quantity from one source."""
    return quantity.std / quantity.value * math.sqrt(max(quantity.budget.get(source, 0.0), 0.0))


def _shape_check(place: Place) -> ValidityCheck:
    shape, row, pad = measured_shape(place), place.highest_row, place.pad
    if shape is None or row is None:
        return missing(_SHAPE, _WORDS[_SHAPE], _ON_LAYER, NOTHING_COUNTS)
    placement = Placement(
        Ellipsoid(*pad.semi_axes),
        wedge_angle=math.radians(row["wedge_angle_deg"]),
        roll_angle=math.radians(row["roll_angle_deg"]),
    )
    form = law_form(
        plate_gap(placement),
        area=math.pi * row["semi_major_mm"] * row["semi_minor_mm"],
        thickness=pad.effective_thickness,
        poisson_ratio=place.study.poisson_ratio,
    )
    ratio = float(form.semi_major / form.semi_minor)
    predicted = math.log(ratio if form.along else 1 / ratio)
    return shape.check(_SHAPE, _WORDS[_SHAPE], _ON_LAYER, predicted)
