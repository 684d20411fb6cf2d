"""Repeats of contacts: nominal loads, and by how much ellipses scatter beyond the noise of their images."""

from dataclasses import dataclass
from typing import Final, Self

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array
from fingerpad._words import counted
from fingerpad.uncertainty.quantities import covariance_root
from fingerpad.uncertainty.scatter import MIN_REPEAT_FREEDOM

# Loads within this share of the middle of them are one nominal load.
SAME_LOAD: Final = 0.05
_GAP: Final = (1 + SAME_LOAD) / (1 - SAME_LOAD) * (1 + 1e-9)


def nominal_loads(loads: ArrayLike) -> npt.NDArray[np.intp]:
    """Return a number for the nominal load of each of some loads, counted from 0 upwards.

    Loads are one nominal load if they are within `SAME_LOAD` of their middle, and the next one is not. Where
    they run on without such a gap, as those of a ramp, only equal loads are.
    """
    distinct, place = np.unique(as_float_array(loads), return_inverse=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        chain = np.cumsum(np.append(False, distinct[1:] > _GAP * distinct[:-1])[: distinct.size])
    for number in np.unique(chain):
        low, high = distinct[chain == number][[0, -1]]
        if high > _GAP * low:
            chain = np.where(chain == number, chain.max() + 1 + np.arange(chain.size), chain)
    _, first = np.unique(chain, return_index=True)
    rank = np.searchsorted(np.sort(first), [int(np.flatnonzero(chain == of)[0]) for of in chain])
    return np.asarray(rank[place.reshape(-1)], dtype=np.intp)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ContactRepeatability:
    """By how much the ellipses of repeats scatter beyond the noise of their images."""

    covariance: FloatArray  # of ln √(ℓd ℓe) and ln(ℓd/ℓe) of one impression; zero if it is not known
    freedom: int  # degrees of freedom from which it is known
    groups: int  # contacts that were repeated
    count: int  # their repeats in all

    @property
    def known(self) -> bool:
        """Whether there are repeats: how far even two lie apart says more of the next than nothing."""
        return self.freedom > 0

    @property
    def area_std(self) -> float:
        """Relative standard deviation of the area that it amounts to."""
        return float(2 * np.sqrt(self.covariance[0, 0]))

    @property
    def aspect_ratio_std(self) -> float:
        """Relative standard deviation of the aspect ratio that it amounts to."""
        return float(np.sqrt(self.covariance[1, 1]))

    @property
    def missing(self) -> str:
        """Why it is not known, in words; empty where it is."""
        return "" if self.known else too_few_repeats(self.groups, self.freedom)

    @classmethod
    def of(cls, axes: ArrayLike, noise: ArrayLike, group: ArrayLike) -> Self:
        """Return that of ln √(ℓd ℓe) and ln(ℓd/ℓe), shape (n, 2), of known noise, by `group` of repeats."""
        axes = as_float_array(axes)
        _, place, size = np.unique(group, return_inverse=True, return_counts=True)
        freedom = len(axes) - size.size
        covariance = np.zeros((2, 2))
        if freedom:
            means = np.stack([np.bincount(place, of) / size for of in axes.T], axis=-1)
            off = axes - means[place]
            found, share = off.T @ off / freedom, (1 - 1 / size[place]) / freedom
            covariance = _excess(found, np.einsum("n,nij->ij", share, as_float_array(noise)))
        repeated = size[size > 1]
        return cls(covariance=covariance, freedom=freedom, groups=repeated.size, count=int(repeated.sum()))


def _excess(found: FloatArray, noise: FloatArray) -> FloatArray:
    """Return by how much a covariance exceeds that of noise; zero in directions in which it does not.

    The directions are those in which both are independent (Amemiya 1985): those of the difference itself
    depend on units, and can turn a lack of scatter along one axis into scatter along the other.
    """
    root = covariance_root(found + noise)
    inverse = np.linalg.pinv(root)
    size, direction = np.linalg.eigh(inverse @ (found - noise) @ inverse.T)
    half = root @ direction * np.sqrt(np.maximum(size, 0))
    return as_float_array(half @ half.T)


def too_few_repeats(groups: int, freedom: int) -> str:
    """Return why a scatter of repeats is not known, in words."""
    if groups == 0:
        return "no contact was repeated"
    return f"{counted(freedom, 'degree')} of freedom; {MIN_REPEAT_FREEDOM} are needed"
