"""The whole pad on a layer of tissue over bone, for contacts of fingers whose thickness is stated."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Self

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array
from fingerpad.exceptions import UncertaintyError
from fingerpad.study.measuring.fingers import FingerResult
from fingerpad.study.results.columns import COLUMNS, ColumnArray
from fingerpad.study.results.model import MOST_DRAWS, parts_of
from fingerpad.uncertainty import (
    LAYER_OUTPUTS,
    LAYER_SOURCES,
    Inputs,
    Propagated,
    layer_flag,
    layer_model,
    propagate,
    run_monte_carlo,
)
from fingerpad.units import KPA_PER_MPA

# Outputs of the layer with those of Hertz theory that they stand beside.
HERTZ_OF: Final = {
    "youngs_modulus_on_layer": "youngs_modulus",
    "indentation_on_layer": "indentation",
    "loading_radius_on_layer": "geometric_radius_from_compliance",
}
# Outputs that are pooled over the contacts of a finger at one angle.
POOLED_ON_LAYER: Final = ("youngs_modulus", "youngs_modulus_on_layer", "loading_radius_on_layer")
# Names of the columns of parts: first-order ones, then those of second order.
LAYER_PART_SOURCES: Final = np.array(2 * [source for source, names in LAYER_SOURCES.items() for _ in names])
# The value is in the range of the laws, a standard uncertainty away is not.
UNCERTAINTY_OUT_OF_RANGE: Final = "uncertainty_out_of_range"

_MOST_UNDEFINED: Final = 1e-3  # of the draws of a Monte Carlo


def unit_of(output: str) -> tuple[str, float]:
    """Return the unit of an output in tables, as names end with it, and its factor."""
    return ("kpa", KPA_PER_MPA) if "modulus" in output else ("mm", 1.0)


def both_models(**inputs: FloatArray) -> dict[str, FloatArray]:
    """Return what `layer_model` says on the layer, and what Hertz theory says of the same."""
    outputs = layer_model(**inputs)
    return {name: outputs[name] for name in (*HERTZ_OF.values(), *LAYER_OUTPUTS)}


def with_thickness(inputs: Inputs, thickness: ArrayLike, thickness_std: ArrayLike) -> Inputs:
    """Return the inputs of `layer_model` from those of `pad_model`; the thickness is independent of them."""
    shape = np.broadcast_shapes(inputs.mean.shape[:-1], np.shape(thickness), np.shape(thickness_std))
    count = len(inputs.names)
    mean, covariance = np.empty((*shape, count + 1)), np.zeros((*shape, count + 1, count + 1))
    mean[..., :count], mean[..., count] = inputs.mean, thickness
    covariance[..., :count, :count] = inputs.covariance
    covariance[..., count, count] = as_float_array(thickness_std) ** 2
    names = (*inputs.names, *LAYER_SOURCES["thickness"])
    return Inputs(names=names, mean=mean, covariance=covariance, groups=LAYER_SOURCES)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Layered:
    """Contacts on a layer; NaN where they are flagged.

    Attributes
    ----------
    propagated : Propagated
        `both_models` at the contacts' inputs, by first order.
    std : ndarray, shape (contacts, outputs)
        Standard uncertainties, by the study's method; NaN beyond the range of the laws.
    flag : ndarray of str, shape (contacts,)
        What is out of that range; empty where nothing is.
    """

    propagated: Propagated
    std: FloatArray
    flag: npt.NDArray[np.str_]

    @classmethod
    def of(cls, inputs: Inputs, method: str) -> Self:
        """Apply the model to the inputs of some contacts, thickness included."""
        with np.errstate(all="ignore"):
            propagated = propagate(both_models, inputs)
            std = propagated.std if method == "first_order" else _simulated_std(propagated)
        flag = layer_flag(inputs)
        known = np.isfinite(std).all(axis=-1)
        return cls(
            propagated=propagated,
            std=std,
            flag=np.where((flag == "") & ~known, UNCERTAINTY_OUT_OF_RANGE, flag),
        )

    @property
    def parts(self) -> FloatArray:
        """Signed contributions to `POOLED_ON_LAYER` of the sources `LAYER_PART_SOURCES`."""
        with np.errstate(all="ignore"):
            return parts_of(self.propagated, POOLED_ON_LAYER)

    def columns(self) -> dict[str, FloatArray]:
        """Return the columns of the layer that follow from the model."""
        columns = {}
        for name in LAYER_OUTPUTS:
            place, (unit, factor) = self.propagated.place(name), unit_of(name)
            columns[f"{name}_{unit}"] = factor * self.propagated.value[:, place]
            columns[f"{name}_{unit}_std"] = factor * self.std[:, place]
        return columns


def _simulated_std(propagated: Propagated) -> FloatArray:
    """Return standard uncertainties by Monte Carlo, NaN where draws leave the range of the laws."""
    std = np.full(propagated.value.shape, np.nan)
    for place in np.flatnonzero(np.isfinite(propagated.value).all(axis=-1)).tolist():
        try:
            drawn = run_monte_carlo(both_models, propagated.inputs.at(place), max_draws=MOST_DRAWS)
        except UncertaintyError:  # most draws are out of range
            continue
        if drawn.undefined <= _MOST_UNDEFINED * drawn.draws:
            std[place] = drawn.std
    return std


def layer_columns(
    pads: Sequence[FingerResult], inputs: Inputs, method: str
) -> tuple[dict[str, ColumnArray], FloatArray]:
    """Return the columns of the layer for contacts on `pads`, and their parts, NaN without a thickness.

    Parameters
    ----------
    pads : sequence of FingerResult
        The finger of each contact.
    inputs : Inputs
        Those of `pad_model` for each contact.
    method : str
        Of propagation.
    """
    thickness = COLUMNS["effective_thickness_mm"].array(pad.effective_thickness for pad in pads)
    std = COLUMNS["effective_thickness_mm_std"].array(pad.effective_thickness_std for pad in pads)
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
    found = Layered.of(
        with_thickness(inputs.at(stated), thickness[stated], np.nan_to_num(std[stated])), method
    )
    flags[stated] = [flag or None for flag in found.flag.tolist()]
    for name, values in found.columns().items():
        columns[name] = COLUMNS[name].unknown(len(pads))
        columns[name][stated] = values
    parts[stated] = found.parts
    return columns, parts
