"""The pad's model over all contacts of a study: values, uncertainty, and what of it contacts share.

Every uncertain input is a source. What a source does to a contact's radii is kept as signed parts, one for
each independent way in which it can be off, so that contacts which share a source can be pooled as such.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from typing import Final, NamedTuple, Self

import numpy as np

from fingerpad._arrays import BoolArray, FloatArray
from fingerpad.study.fingers import FingerResult
from fingerpad.study.manifest import Contact, Study
from fingerpad.study.measure import Measurement
from fingerpad.uncertainty import (
    PAD_INPUTS,
    PAD_OUTPUTS,
    PAD_SOURCES,
    factor_of,
    pad_model,
    propagate,
    simulate,
)

# Radii that are pooled over the contacts of a finger at one angle.
POOLED_OUTPUTS: Final = ("radius_from_indentation", "radius_from_compliance")

# Sources that belong to the finger on its wedge. A scale is shared by the contacts that name it.
OF_THE_PLACEMENT: Final = ("semi-axes", "wedge angle", "roll angle", "Poisson's ratio")
GEOMETRY: Final = ("semi-axes", "wedge angle", "roll angle")

_AT_ONCE: Final = 1000
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
    """Mean and covariance of `PAD_INPUTS` for one contact."""

    mean: FloatArray
    covariance: FloatArray


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
    def of(cls, inputs: Iterable[Inputs], method: str) -> Self:
        """Apply the model to some contacts at a time: its derivatives are far larger than the results."""
        rest = iter(inputs)
        some = [METHODS[method](list(islice(rest, _AT_ONCE)))]
        while batch := list(islice(rest, _AT_ONCE)):
            some.append(METHODS[method](batch))
        value, std, parts = (np.concatenate(arrays) for arrays in zip(*some, strict=True))
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


def pad_inputs(study: Study, contact: Contact, finger: FingerResult, measured: Measurement) -> Inputs:
    """Return mean and covariance of the model's inputs for one contact."""
    angles = np.radians([contact.wedge_angle_deg, contact.roll_angle_deg])
    axes = np.array([measured.semi_major, measured.semi_minor])
    size = float(np.sqrt(axes.prod()))
    elongation = float(np.log(axes[0] / axes[1]))
    mean = np.array([*finger.semi_axes, *angles, study.poisson_ratio, 1.0, measured.load, size, elongation])
    given = study.uncertainty
    scale_std = measured.relative_scale_std
    stds = [
        *np.radians([given.wedge_angle_std_deg, given.roll_angle_std_deg]),
        given.poisson_ratio_std,
        scale_std,
        given.load_relative_std * measured.load,
    ]
    covariance = np.zeros((len(PAD_INPUTS), len(PAD_INPUTS)))
    covariance[:3, :3] = finger.covariance
    covariance[range(3, 8), range(3, 8)] = np.square(stds)
    # The scale is an input of its own: what it does to the axes is taken out of theirs.
    own = measured.covariance - scale_std**2 * np.outer(axes, axes)
    to_size_and_elongation = np.array([0.5 * size / axes, [1 / axes[0], -1 / axes[1]]])
    covariance[8:, 8:] = _nearest_covariance(to_size_and_elongation @ own @ to_size_and_elongation.T)
    if finger.scale is not None and finger.scale == measured.scale:
        covariance[:3, _SCALE] = covariance[_SCALE, :3] = scale_std**2 * finger.semi_axes
    return Inputs(mean, covariance)


def _nearest_covariance(matrix: FloatArray) -> FloatArray:
    """Return a matrix without the negative eigenvalues that a difference of covariances may be left with."""
    if not np.isfinite(matrix).all():
        return matrix
    size, direction = np.linalg.eigh(matrix)
    nearest: FloatArray = direction * np.maximum(size, 0) @ direction.T
    return nearest


def _first_order(inputs: Sequence[Inputs]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return values, standard uncertainties and parts by first-order propagation."""
    count, size = len(inputs), len(PAD_INPUTS)
    mean = np.reshape([one.mean for one in inputs], (count, size))
    covariance = np.reshape([one.covariance for one in inputs], (count, size, size))
    with np.errstate(all="ignore"):
        sound = np.isfinite(mean).all(axis=-1) & np.isfinite(covariance).all(axis=(-2, -1))
        propagated = propagate(pad_model, mean, np.where(sound[:, None, None], covariance, 0.0))
        first = propagated.jacobian[:, _POOLED] @ _by_source(np.where(sound[:, None, None], covariance, 0.0))
        parts = np.concatenate([first, propagated.second_order[:, _POOLED]], axis=-1)
    answered = sound & np.isfinite(propagated.value).all(axis=-1) & np.isfinite(propagated.std).all(axis=-1)
    value, std = (np.where(answered[:, None], x, np.nan) for x in (propagated.value, propagated.std))
    return value, std, np.where(answered[:, None, None], parts, np.nan)


def _monte_carlo(inputs: Sequence[Inputs]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the same with standard uncertainties by Monte Carlo; parts stay those of the first order."""
    value, std, parts = _first_order(inputs)
    for place in np.flatnonzero(np.isfinite(std).all(axis=-1)):
        std[place] = simulate(pad_model, *inputs[int(place)], most=_MOST_DRAWS).std
    return value, std, parts


METHODS: Final[dict[str, Callable[[Sequence[Inputs]], tuple[FloatArray, FloatArray, FloatArray]]]] = {
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
            factor[:, block, block] = factor_of(rest[:, block, block])
    return factor
