"""The pad's model over all contacts of a study: values, uncertainty, and what of it contacts share.

Every uncertain input is a source. What a source does to a contact's radii is kept as signed parts, one for
each independent way in which it can be off, so that contacts which share a source can be pooled as such.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, NamedTuple, Self

import numpy as np

from fingerpad._arrays import BoolArray, FloatArray
from fingerpad.study.manifest import Contact, Study
from fingerpad.study.measuring.fingers import FingerResult
from fingerpad.study.measuring.measure import Measurement
from fingerpad.uncertainty import (
    PAD_INPUTS,
    PAD_OUTPUTS,
    PAD_SOURCES,
    covariance_root,
    pad_model,
    propagate,
    run_monte_carlo,
)

# Radii that are pooled over the contacts of a finger at one angle.
POOLED_OUTPUTS: Final = ("radius_from_indentation", "radius_from_compliance")

# Sources that belong to the finger on its wedge. A scale is shared by the contacts that name it.
GEOMETRY: Final = ("semi-axes", "wedge angle", "roll angle")
OF_THE_PLACEMENT: Final = (*GEOMETRY, "Poisson's ratio")

_SCALE: Final = PAD_INPUTS.index("image_scale")
_POOLED: Final = [PAD_OUTPUTS.index(name) for name in POOLED_OUTPUTS]
_SOURCE_OF_INPUT: Final = [
    next(name for name, places in PAD_SOURCES.items() if place in places) for place in range(len(PAD_INPUTS))
]
# Names of the columns of parts: first-order ones, then those of second order.
PART_SOURCES: Final = np.array(2 * _SOURCE_OF_INPUT)
# Draws for a row's own interval; GUM-S1 asks for 10⁶ where two digits must stand.
_MOST_DRAWS: Final = 200_000


class Inputs(NamedTuple):
    """Mean, shape (..., inputs), and covariance, shape (..., inputs, inputs), of `PAD_INPUTS`."""

    mean: FloatArray
    covariance: FloatArray

    def at(self, place: int) -> "Inputs":
        """Return those of one of several contacts, which need not be kept for it."""
        return Inputs(self.mean[place].copy(), self.covariance[place].copy())


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Modelled:
    """The model's answer for some contacts, NaN where it has none.

    Attributes
    ----------
    value, std : ndarray, shape (contacts, outputs)
        Model outputs and their standard uncertainties.
    parts : ndarray, shape (contacts, pooled outputs, parts)
        Signed contributions to the uncertainty of `POOLED_OUTPUTS`, of the sources `PART_SOURCES`; their
        squares add up to the variance.
    """

    value: FloatArray
    std: FloatArray
    parts: FloatArray

    @classmethod
    def of(cls, inputs: Inputs, method: str) -> Self:
        """Apply the model to some contacts, a thousand at most: its derivatives are far larger than that."""
        value, std, parts = METHODS[method](inputs)
        return cls(value=value, std=std, parts=parts)

    @property
    def answered(self) -> BoolArray:
        """Whether the model has an answer, shape (contacts,)."""
        return np.asarray(np.isfinite(self.std).all(axis=-1))

    def only(self, chosen: BoolArray) -> Self:
        """Return some of the contacts."""
        return replace(self, value=self.value[chosen], std=self.std[chosen], parts=self.parts[chosen])

    def std_of(self, output: str, sources: Sequence[str]) -> FloatArray:
        """Return the standard uncertainty of a pooled output from some sources alone, shape (contacts,)."""
        parts = self.parts[:, POOLED_OUTPUTS.index(output), np.isin(PART_SOURCES, sources)]
        return np.asarray(np.sqrt(np.sum(parts**2, axis=-1)))


def pad_inputs(
    study: Study, fingers: Mapping[str, FingerResult], seen: Sequence[tuple[Contact, Measurement]]
) -> Inputs:
    """Return mean and covariance of the model's inputs for some contacts."""
    given, count = study.uncertainty, len(seen)
    pads = [fingers[contact.finger] for contact, _ in seen]
    same_scale = [
        pad.scale is not None and pad.scale == one.scale for pad, (_, one) in zip(pads, seen, strict=True)
    ]
    semi_axes = np.reshape([pad.semi_axes for pad in pads], (count, 3))
    angles = np.reshape(
        [(contact.wedge_angle_deg, contact.roll_angle_deg) for contact, _ in seen], (count, 2)
    )
    load, scale_std = np.reshape([(one.load, one.relative_scale_std) for _, one in seen], (count, 2)).T
    axes = np.reshape([(one.semi_major, one.semi_minor) for _, one in seen], (count, 2))
    of_axes = np.reshape([one.covariance for _, one in seen], (count, 2, 2))
    covariance = np.zeros((count, len(PAD_INPUTS), len(PAD_INPUTS)))
    covariance[:, :3, :3] = np.reshape([pad.covariance for pad in pads], (count, 3, 3))
    covariance[:, 3, 3] = np.radians(given.wedge_angle_deg_std) ** 2
    covariance[:, 4, 4] = np.radians(given.roll_angle_deg_std) ** 2
    covariance[:, 5, 5] = given.poisson_ratio_std**2
    covariance[:, _SCALE, _SCALE] = scale_std**2
    covariance[:, 7, 7] = (given.load_relative_std * load) ** 2
    with np.errstate(all="ignore"):
        size, elongation = np.sqrt(axes.prod(axis=-1)), np.log(axes[:, 0] / axes[:, 1])
        # The scale is an input of its own: what it does to the axes is taken out of theirs.
        own = of_axes - (scale_std**2)[:, None, None] * axes[:, :, None] * axes[:, None, :]
        to_size_and_elongation = np.stack([0.5 * size[:, None] / axes, [1, -1] / axes], axis=-2)
        turned = to_size_and_elongation @ own @ np.swapaxes(to_size_and_elongation, -1, -2)
    covariance[:, 8:, 8:] = _nearest_covariance(turned)
    shared = np.where(np.array(same_scale, dtype=bool), scale_std**2, 0.0)[:, None] * semi_axes
    covariance[:, :3, _SCALE] = covariance[:, _SCALE, :3] = shared
    given_or_one = [np.full(count, study.poisson_ratio), np.ones(count)]
    mean = np.column_stack([semi_axes, np.radians(angles), *given_or_one, load, size, elongation])
    return Inputs(mean, covariance)


def _nearest_covariance(matrices: FloatArray) -> FloatArray:
    """Return matrices without the negative eigenvalues that a difference of covariances may be left with."""
    nearest = matrices.copy()
    sound = np.isfinite(matrices).all(axis=(-2, -1))
    size, direction = np.linalg.eigh(matrices[sound])
    nearest[sound] = direction * np.maximum(size, 0)[:, None, :] @ np.swapaxes(direction, -1, -2)
    return nearest


def _first_order(inputs: Inputs) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return values, standard uncertainties and parts by first-order propagation."""
    mean = inputs.mean
    with np.errstate(all="ignore"):
        finite = np.isfinite(mean).all(axis=-1) & np.isfinite(inputs.covariance).all(axis=(-2, -1))
        sound = np.asarray(finite)
        covariance = np.where(sound[:, None, None], inputs.covariance, 0.0)
        propagated = propagate(pad_model, mean, covariance)
        first = propagated.jacobian[:, _POOLED] @ _by_source(covariance)
        parts = np.concatenate([first, propagated.second_order[:, _POOLED]], axis=-1)
    answers = np.isfinite(propagated.value) & np.isfinite(propagated.std)
    answered = sound & np.asarray(answers.all(axis=-1))
    value, std = (np.where(answered[:, None], x, np.nan) for x in (propagated.value, propagated.std))
    return value, std, np.where(answered[:, None, None], parts, np.nan)


def _monte_carlo(inputs: Inputs) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the same with standard uncertainties by Monte Carlo; parts stay those of the first order."""
    value, std, parts = _first_order(inputs)
    for place in np.flatnonzero(np.isfinite(std).all(axis=-1)):
        std[place] = run_monte_carlo(pad_model, *inputs.at(int(place)), max_draws=_MOST_DRAWS).std
    return value, std, parts


METHODS: Final[dict[str, Callable[[Inputs], tuple[FloatArray, FloatArray, FloatArray]]]] = {
    "first_order": _first_order,
    "monte_carlo": _monte_carlo,
}


def _by_source(covariance: FloatArray) -> FloatArray:
    """Return F with F Fᵀ = `covariance`, each column of which belongs to one input's source.

    Inputs of different sources do not correlate, but for the semi-axes where their photographs share the
    contact's scale: that part is the scale's.
    """
    factor = np.zeros_like(covariance)
    rest = covariance.copy()
    scale_std = np.sqrt(covariance[:, _SCALE, _SCALE])
    column = covariance[:, :, _SCALE] / np.where(scale_std > 0, scale_std, 1.0)[:, None]
    factor[:, :, _SCALE] = column
    rest -= column[:, :, None] * column[:, None, :]
    for places in PAD_SOURCES.values():
        if places != (_SCALE,):
            block = slice(places[0], places[-1] + 1)
            factor[:, block, block] = covariance_root(rest[:, block, block])
    return factor
