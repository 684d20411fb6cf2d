"""The pad's model over all contacts of a study: values and uncertainty, with the parts that contacts share.

Every uncertain input belongs to a source. The effect of a source on a contact's radii is kept as signed
parts, one for each of its independent errors, so that contacts which share a source can be pooled as such.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from types import MappingProxyType
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from fingerpad import uncertainty
from fingerpad._arrays import BoolArray, FloatArray, as_float_array
from fingerpad.image import SEMI_AXES
from fingerpad.study.manifest.models import Contact, Study, Uncertainty
from fingerpad.study.measuring.contacts import Measurement
from fingerpad.study.measuring.fingers import FingerResult
from fingerpad.uncertainty.models import pad_inputs

# Radii that are pooled over the contacts of a finger at one angle.
POOLED_OUTPUTS: Final = ("radius_from_indentation", "radius_from_compliance")

# Sources that belong to the finger on its wedge. A scale is shared by the contacts that name it, and so is
# the place of their edges.
GEOMETRY: Final = ("semi-axes", "pad shape", "wedge angle", "jig angle", "roll angle")
OF_THE_PLACEMENT: Final = (*GEOMETRY, "Poisson's ratio")
OF_THE_DEVICE: Final = ("image scale", "contact edge", "force gain")

# Parts of an uncertainty that have columns of their own, with their sources.
STATED_APART: Final[Mapping[str, tuple[str, ...]]] = {
    "edge": ("contact edge",),
    "noise": ("contact ellipse", "load"),
    "repeatability": ("repeatability",),
}

# Errors of one input that a whole study shares, beside the error of it that each has, with that input.
COMMON: Final[Mapping[str, str]] = {"force gain": "load", "jig angle": "wedge_angle"}


def part_sources(sources: Mapping[str, Sequence[str]]) -> npt.NDArray[np.str_]:
    """Return the source of each part: first-order ones, then those of second order, then `COMMON`."""
    return np.array([*2 * [source for source, names in sources.items() for _ in names], *COMMON])


PART_SOURCES: Final = part_sources(uncertainty.PAD_SOURCES)
# Most draws for a row's own interval.
MOST_DRAWS: Final = 200_000


class Modelled:
    """Outputs of the model for those of a thousand contacts at most for which it has any.

    Its derivatives are far larger than that.
    """

    def __init__(self, inputs: uncertainty.Inputs, given: Uncertainty) -> None:
        finite: BoolArray = np.asarray(
            np.isfinite(inputs.mean).all(axis=-1) & np.isfinite(inputs.covariance).all(axis=(-2, -1))
        )
        covariance = np.where(finite[:, None, None], inputs.covariance, 0.0)
        with np.errstate(all="ignore"):
            propagated = uncertainty.propagate(uncertainty.pad_model, replace(inputs, covariance=covariance))
            parts = parts_of(propagated, POOLED_OUTPUTS, given)
        known: BoolArray = finite & np.isfinite([propagated.value, propagated.std]).all(axis=(0, -1))
        std = propagated.std
        if given.method == "monte_carlo":
            for row in np.flatnonzero(known).tolist():
                one = propagated.inputs.at(row)
                std[row] = uncertainty.run_monte_carlo(uncertainty.pad_model, one, max_draws=MOST_DRAWS).std
        answered: BoolArray = known & np.isfinite(std).all(axis=-1)

        def by_output(outputs: FloatArray) -> dict[str, FloatArray]:
            return dict(zip(propagated.names, outputs[answered].T, strict=True))

        self.answered = answered  # of all contacts, whether there are outputs
        # By output, shape (contacts,); the last from one of `STATED_APART` alone.
        self.value, self.std = by_output(propagated.value), by_output(std)
        self.std_from = {
            part: by_output(_std_from(propagated, of, given)) for part, of in STATED_APART.items()
        }
        # Signed contributions to the uncertainty of `POOLED_OUTPUTS`, of the sources `PART_SOURCES`, of shape
        # (contacts, pooled outputs, parts); their squares add up to the variance.
        self.parts = parts[answered]


def contact_inputs(
    study: Study,
    fingers: Mapping[str, FingerResult],
    seen: Sequence[tuple[Contact, Measurement]],
    repeatability: Mapping[bool, FloatArray] = MappingProxyType({}),
) -> uncertainty.Inputs:
    """Return the inputs of `pad_model` for some contacts."""
    given, count = study.uncertainty, len(seen)
    pads = [fingers[contact.finger] for contact, _ in seen]
    same_scale = [
        pad.scale is not None and pad.scale == one.scale for pad, (_, one) in zip(pads, seen, strict=True)
    ]
    semi_axes = np.reshape([pad.semi_axes for pad in pads], (count, 3))
    wedge, roll = np.radians([(one.wedge_angle_deg, one.roll_angle_deg) for one, _ in seen]).reshape(-1, 2).T
    load, scale_std, edge_std = np.reshape(
        [(one.load_N, one.relative_scale_std, one.edge_offset_mm_std) for _, one in seen], (count, 3)
    ).T
    axes = np.reshape([(one.semi_major_mm, one.semi_minor_mm) for _, one in seen], (count, 2))
    deviation = cache(FingerResult.shape_deviation)  # a sequence has thousands of rows at one angle
    along, along_std, across_std = np.reshape(
        [
            deviation(pad, one.wedge_angle_deg, one.roll_angle_deg)
            for pad, (one, _) in zip(pads, seen, strict=True)
        ],
        (count, 3),
    ).T
    geometry = np.zeros((count, 4, 4))
    geometry[:, :3, :3] = np.reshape([pad.covariance for pad in pads], (count, 3, 3))
    geometry[:, 3, 3] = scale_std**2
    geometry[:, :3, 3] = geometry[:, 3, :3] = np.where(same_scale, scale_std**2, 0.0)[:, None] * semi_axes
    with np.errstate(all="ignore"):
        # Scale and edge are inputs of their own: what they add to the covariance of the axes is subtracted.
        own = np.reshape([one.covariance_mm2 for _, one in seen], (count, 2, 2))
        own = own - (scale_std**2)[:, None, None] * axes[:, :, None] * axes[:, None, :]
        own = own - (edge_std**2)[:, None, None]
        root = uncertainty.covariance_root(own)  # without the negative eigenvalues that a difference can have
    lengths: dict[str, Any] = {name: (of, 0.0) for name, of in zip(SEMI_AXES, semi_axes.T, strict=True)}
    measured = uncertainty.Inputs.of(
        **lengths,
        image_scale=(np.ones(count), 0.0),
        edge_offset=(0.0, edge_std),
        wedge_angle=(wedge, np.radians(given.wedge_deg_std)),
        roll_angle=(roll, np.radians(given.roll_angle_deg_std)),
        poisson_ratio=(study.poisson_ratio, given.poisson_ratio_std),
        load=(load, given.load_std * load),
        semi_major=(axes[:, 0], 0.0),
        semi_minor=(axes[:, 1], 0.0),
        radius_deviation=(np.zeros(count), 0.0),
        elongation_deviation=(0.0, 0.0),
        in_plane_deviation=(along, along_std),
        transverse_deviation=(0.0, across_std),
    )
    if repeatability:
        synthetic = [one.synthetic or pad.synthetic for (one, _), pad in zip(seen, pads, strict=True)]
        deviations = np.reshape([repeatability[each] for each in synthetic], (count, 2, 2))
        measured = measured.with_covariance(uncertainty.PAD_SOURCES["repeatability"], deviations)
    measured = measured.with_covariance((*SEMI_AXES, "image_scale"), geometry)
    return pad_inputs(
        measured.with_covariance(("semi_major", "semi_minor"), root @ np.swapaxes(root, -1, -2))
    )


def _common_shares(given: Uncertainty) -> dict[str, float]:
    """Return of each input in `COMMON` the share of its standard uncertainty that the whole study shares."""
    return {
        "load": given.load_gain_relative_std / (given.load_std or 1.0),
        "wedge_angle": given.jig_angle_deg_std / (given.wedge_deg_std or 1.0),
    }


def _std_from(propagated: uncertainty.Propagated, sources: Sequence[str], given: Uncertainty) -> FloatArray:
    """Return first-order standard uncertainties from what is a contact's own of some sources."""
    names = [name for source in sources for name in uncertainty.PAD_SOURCES[source]]
    places = propagated.inputs.places(names)
    common = _common_shares(given)
    slopes = propagated.jacobian[..., places] * [math.sqrt(1 - common.get(name, 0.0) ** 2) for name in names]
    covariance = propagated.inputs.covariance[..., np.array(places)[:, None], places]
    variance = np.einsum("...oi,...ij,...oj->...o", slopes, covariance, slopes)
    return as_float_array(np.sqrt(np.maximum(variance, 0)))


def parts_of(propagated: uncertainty.Propagated, outputs: Sequence[str], given: Uncertainty) -> FloatArray:
    """Return the parts of some outputs, in the order of `part_sources`."""
    pooled = [propagated.place(name) for name in outputs]
    first = propagated.jacobian[:, pooled] @ _root_by_source(propagated.inputs)
    places, shares = propagated.inputs.places(list(COMMON.values())), _common_shares(given)
    common = np.array([shares[name] for name in COMMON.values()])
    shared = first[..., places] * common
    first[..., places] *= np.sqrt(1 - common**2)
    return np.concatenate([first, propagated.second_order[:, pooled], shared], axis=-1)


def _root_by_source(inputs: uncertainty.Inputs) -> FloatArray:
    """Return F with F Fᵀ = covariance, each column of one input; the scale has what axes share with it."""
    covariance = inputs.covariance
    (scale,) = inputs.places(["image_scale"])
    root = np.zeros_like(covariance)
    scale_std = np.sqrt(covariance[:, scale, scale])
    column = covariance[:, :, scale] / np.where(scale_std > 0, scale_std, 1.0)[:, None]
    rest = covariance - column[:, :, None] * column[:, None, :]
    for names in inputs.groups.values():
        places = inputs.places(names)
        block = slice(places[0], places[-1] + 1)
        root[:, block, block] = uncertainty.covariance_root(rest[:, block, block])
    root[:, :, scale] = column
    return root
