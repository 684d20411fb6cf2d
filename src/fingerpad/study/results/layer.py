"""The whole pad on a layer of tissue over bone: contacts and loading curves of fingers of known thickness."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any, Final, NamedTuple

import numpy as np
from scipy.optimize import minimize_scalar

from fingerpad import uncertainty
from fingerpad._arrays import ArrayLike, FloatArray, as_float_array
from fingerpad.contact.fast_laws import find_modulus, plate_gap, press
from fingerpad.exceptions import UncertaintyError
from fingerpad.geometry import Gap
from fingerpad.image import SEMI_AXES
from fingerpad.loading import LoadingFit, Secant
from fingerpad.study.manifest.models import Study, Uncertainty
from fingerpad.study.measuring.curves import CurveResult
from fingerpad.study.measuring.fingers import FingerResult, pad_placement
from fingerpad.study.results.model import MOST_DRAWS, part_sources, parts_of
from fingerpad.study.results.summary_file import CurveOnLayerRecord, Quantities
from fingerpad.study.results.table import COLUMNS, ColumnArray
from fingerpad.uncertainty.models import indentation_model
from fingerpad.units import KPA_PER_MPA

# Outputs of the layer with those of Hertz theory that they stand beside.
HERTZ_OF: Final = {
    "youngs_modulus_on_layer": "youngs_modulus",
    "indentation_on_layer": "indentation",
    "loading_radius_on_layer": "geometric_radius_from_compliance",
}
# Outputs that are pooled over the contacts of a finger at one angle.
POOLED_ON_LAYER: Final = ("youngs_modulus", "youngs_modulus_on_layer", "loading_radius_on_layer")
LAYER_PART_SOURCES: Final = part_sources(uncertainty.LAYER_SOURCES)
# The value is in the range of the laws, a standard uncertainty away is not.
UNCERTAINTY_OUT_OF_RANGE: Final = "uncertainty_out_of_range"

_MOST_UNDEFINED: Final = 1e-3  # of the draws of a Monte Carlo


def unit_of(output: str) -> tuple[str, float]:
    """Return the unit of an output in tables, as names end with it, and its factor."""
    of_stress = "modulus" in output or "pressure" in output
    return ("kpa", KPA_PER_MPA) if of_stress else ("mm", 1.0)


def both_models(**inputs: FloatArray) -> dict[str, FloatArray]:
    """Return what `layer_model` says on the layer, and what Hertz theory says of the same."""
    outputs = uncertainty.layer_model(**inputs)
    return {name: outputs[name] for name in (*HERTZ_OF.values(), *uncertainty.LAYER_OUTPUTS)}


def with_thickness(
    inputs: uncertainty.Inputs, thickness: ArrayLike, thickness_std: ArrayLike
) -> uncertainty.Inputs:
    """Return the inputs of `layer_model` from those of `pad_model`; the thickness is independent of them."""
    shape = np.broadcast_shapes(inputs.mean.shape[:-1], np.shape(thickness), np.shape(thickness_std))
    count = len(inputs.names)
    mean, covariance = np.empty((*shape, count + 1)), np.zeros((*shape, count + 1, count + 1))
    mean[..., :count], mean[..., count] = inputs.mean, thickness
    covariance[..., :count, :count] = inputs.covariance
    covariance[..., count, count] = as_float_array(thickness_std) ** 2
    names = (*inputs.names, *uncertainty.LAYER_SOURCES["thickness"])
    return uncertainty.Inputs(names=names, mean=mean, covariance=covariance, groups=uncertainty.LAYER_SOURCES)


class Layered:
    """Contacts on a layer, by their inputs with the thickness; NaN where they are flagged."""

    def __init__(self, inputs: uncertainty.Inputs, method: str) -> None:
        with np.errstate(all="ignore"):
            self.propagated = uncertainty.propagate(both_models, inputs)  # by first order
            # By the study's method; NaN beyond the range of the laws.
            self.std = self.propagated.std if method == "first_order" else _simulated_std(self.propagated)
        flag, known = uncertainty.layer_flag(inputs), np.isfinite(self.std).all(axis=-1)
        # What is out of that range; empty where nothing is.
        self.flag = np.where((flag == "") & ~known, UNCERTAINTY_OUT_OF_RANGE, flag)


def _simulated_std(propagated: uncertainty.Propagated) -> FloatArray:
    """Return standard uncertainties by Monte Carlo, NaN where draws leave the range of the laws."""
    std = np.full(propagated.value.shape, np.nan)
    for place in np.flatnonzero(np.isfinite(propagated.value).all(axis=-1)).tolist():
        try:
            drawn = uncertainty.run_monte_carlo(
                both_models, propagated.inputs.at(place), max_draws=MOST_DRAWS
            )
        except UncertaintyError:  # most draws are out of range
            continue
        if drawn.undefined <= _MOST_UNDEFINED * drawn.draws:
            std[place] = drawn.std
    return std


def layer_columns(
    pads: Sequence[FingerResult], inputs: uncertainty.Inputs, given: Uncertainty
) -> tuple[dict[str, ColumnArray], FloatArray]:
    """Return the columns of the layer for contacts on `pads`, and their parts, NaN without a thickness.

    Parts are signed contributions to `POOLED_ON_LAYER` of the sources `LAYER_PART_SOURCES`.
    """
    thickness = COLUMNS["effective_thickness_mm"].array(pad.manifest.effective_thickness_mm for pad in pads)
    std = COLUMNS["effective_thickness_mm_std"].array(pad.manifest.effective_thickness_mm_std for pad in pads)
    stated = np.flatnonzero(np.isfinite(thickness))
    flags = COLUMNS["layer_flag"].unknown(len(pads))
    parts = np.full((len(pads), len(POOLED_ON_LAYER), LAYER_PART_SOURCES.size), np.nan)
    columns: dict[str, ColumnArray] = {
        "effective_thickness_mm": thickness,
        "effective_thickness_mm_std": std,
        "layer_flag": flags,
    }
    if not stated.size:
        return columns, parts
    found = Layered(
        with_thickness(inputs.at(stated), thickness[stated], np.nan_to_num(std[stated])), given.method
    )
    flags[stated] = [flag or None for flag in found.flag.tolist()]
    for name in uncertainty.LAYER_OUTPUTS:
        place, (unit, factor) = found.propagated.place(name), unit_of(name)
        for end, outputs in (("", found.propagated.value), ("_std", found.std)):
            columns[f"{name}_{unit}{end}"] = COLUMNS[f"{name}_{unit}{end}"].unknown(len(pads))
            columns[f"{name}_{unit}{end}"][stated] = factor * outputs[:, place]
    with np.errstate(all="ignore"):
        parts[stated] = parts_of(found.propagated, POOLED_ON_LAYER, given)
    return columns, parts


class LayerQuantity(NamedTuple):
    """A quantity with its uncertainty, in the unit of the tables."""

    value: float  # kPa or mm; NaN, as its uncertainty, where it is out of the range of the laws
    std: float
    budget: Mapping[str, float]  # share of each source in the variance

    @classmethod
    def of(cls, record: Quantities, name: str) -> "LayerQuantity":
        """Return an output as a record has it."""
        return cls(*(getattr(record, key) for key in _keys_of(name)))


def _keys_of(name: str) -> tuple[str, str, str]:
    unit, _ = unit_of(name)
    return f"{name}_{unit}", f"{name}_{unit}_std", f"{name}_variance_shares"


def as_keys(name: str, *quantity: object) -> dict[str, Any]:
    """Return a `LayerQuantity`, or three times None, by the keys that records have for it."""
    return dict(zip(_keys_of(name), quantity, strict=True))


def outputs_by_key(propagated: uncertainty.Propagated, names: Iterable[str]) -> dict[str, Any]:
    """Return outputs of one contact by the keys that records have for them."""
    found: dict[str, Any] = {}
    for name in names:
        (_, factor), place = unit_of(name), propagated.place(name)
        value, std = (factor * float(of[0, place]) for of in (propagated.value, propagated.std))
        budget = {source: float(share[0]) for source, share in propagated.budget(name).items()}
        found |= as_keys(name, value, std, budget)
    return found


_SOURCES: Final = {
    **{
        name: uncertainty.LAYER_SOURCES[name]
        for name in ("semi-axes", "wedge angle", "roll angle", "Poisson's ratio", "load")
    },
    "place of contact": ("indentation",),
    "thickness": ("thickness", "contact_shift"),
}
_MOST_ROWS: Final = 200
_EARLIEST, _LATEST = 0.3, 0.04  # shifts of the place of contact, of the largest indentation


def curve_on_layer(study: Study, finger: FingerResult, curve: CurveResult) -> CurveOnLayerRecord | None:
    """Return a loading curve on its finger's layer; None without thickness, semi-axes or a fit."""
    fit, thickness = curve.fit, finger.manifest.effective_thickness_mm
    if fit is None or not math.isfinite(fit.contact_offset.std):
        return None
    if thickness is None or not finger.has_semi_axes:
        return None
    gap = plate_gap(pad_placement(finger.semi_axes, curve.manifest.wedge_angle_deg))
    inputs = _inputs(study, finger, curve.manifest.wedge_angle_deg, gap, fit)
    found = uncertainty.propagate(indentation_model, inputs)
    indentation, shift = inputs.mean[0, inputs.places(["indentation", "contact_shift"])].tolist()
    _, contact = find_modulus(
        gap,
        thickness=thickness,
        poisson_ratio=study.poisson_ratio,
        load=fit.modulus_load,
        indentation=indentation + shift,
    )
    known = bool(np.isfinite(found.std).all())
    return CurveOnLayerRecord.of(
        load_N=fit.modulus_load,
        indentation_mm=indentation,
        indentation_mm_std=fit.contact_offset.std,
        contact_shift_mm=shift,
        layer_flag=str(contact.flags) or ("" if known else UNCERTAINTY_OUT_OF_RANGE),
        **outputs_by_key(found, found.names),
    )


def _inputs(
    study: Study, finger: FingerResult, wedge_angle_deg: float, gap: Gap, fit: LoadingFit
) -> uncertainty.Inputs:
    """Return the inputs of `indentation_model` at the highest load, as one contact."""
    given, secant, load = study.uncertainty, fit.secant, fit.modulus_load
    thickness = finger.manifest.effective_thickness_mm or math.nan
    thickness_std = finger.manifest.effective_thickness_mm_std or 0.0
    shift, *ends = (
        _contact_shift(gap, secant, at, study.poisson_ratio)
        for at in (thickness, thickness - thickness_std, thickness + thickness_std)
    )
    # Signed: it goes with the thickness. Where a shift is unknown, the highest load is out of range.
    shift_std = (ends[1] - ends[0]) / 2 if np.isfinite(ends).all() else 0.0
    one: dict[str, Any] = dict(zip(SEMI_AXES, finger.semi_axes.tolist(), strict=True))
    inputs = uncertainty.Inputs.of(
        **one,
        wedge_angle=([math.radians(wedge_angle_deg)], math.radians(given.wedge_deg_std)),
        roll_angle=(0.0, math.radians(given.roll_angle_deg_std)),
        poisson_ratio=(study.poisson_ratio, given.poisson_ratio_std),
        load=(load, given.load_std * load),
        indentation=(float(secant.indentation.max()), fit.contact_offset.std),
        contact_shift=(shift if math.isfinite(shift) else 0.0, 0.0),
        thickness=(thickness, 0.0),
    )
    inputs = inputs.with_covariance(SEMI_AXES, finger.covariance)
    both = np.outer(*2 * ([thickness_std, shift_std],))
    return replace(inputs.with_covariance(("thickness", "contact_shift"), both), groups=_SOURCES)


def _contact_shift(gap: Gap, secant: Secant, thickness: float, poisson_ratio: float) -> float:
    """Return by how much the law of the layer puts the place of contact earlier than Hertz theory does."""
    places = np.linspace(0, secant.load.size - 1, min(secant.load.size, _MOST_ROWS)).round().astype(int)
    load, indentation = secant.load[places], secant.indentation[places]

    def misfit(shift: float) -> float:
        law: FloatArray = press(
            gap,
            indentation=indentation + shift,
            reduced_modulus=1.0,
            thickness=thickness,
            poisson_ratio=poisson_ratio,
        ).load
        return float(np.sum((load - law * (load @ law) / (law @ law)) ** 2))

    largest = float(indentation.max())
    if not math.isfinite(misfit(0.0)):
        return math.nan
    return float(
        minimize_scalar(misfit, bounds=(-_LATEST * largest, _EARLIEST * largest), method="bounded").x
    )
