"""One radius from the contacts of a finger at one angle, with their shared errors."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Self

import numpy as np
import pandas as pd

from fingerpad._arrays import FloatArray, as_float_array
from fingerpad.study.results.model import (
    GEOMETRY,
    OF_THE_DEVICE,
    OF_THE_PLACEMENT,
    PART_SOURCES,
    POOLED_OUTPUTS,
)
from fingerpad.study.results.rows import Rows
from fingerpad.study.results.table import Places, numbered
from fingerpad.uncertainty import (
    PAD_SOURCES,
    NestedScatter,
    Pooled,
    RandomEffects,
    SharedErrors,
    nested_scatter,
    pool,
    pool_random_effects,
)

# Parts that a contact shares with no other, and parts of second order.
_OWN: Final = ~np.isin(PART_SOURCES, (*OF_THE_PLACEMENT, *OF_THE_DEVICE))
_SECOND: Final = np.arange(PART_SOURCES.size) >= PART_SOURCES.size // 2


@dataclass(frozen=True, slots=True, kw_only=True)
class PooledRadius:
    """A radius pooled over contacts.

    Attributes
    ----------
    random : RandomEffects
        Contacts taken to have different radii about a mean: the pooled radius.
    fixed_geometry : float
        Its standard uncertainty with semi-axes and angles held exact, as in Dzidek et al. (2017).
    fixed : Pooled
        All contacts taken to have one radius; the scatter beyond their uncertainties widens it (Birge).
    scatter : NestedScatter
        Of contacts under one load (``"repeat"``), and between loads (``"load"``), if only of two.
    budget : dict of str to float
        Share of each source in the variance of `random`, with ``"scatter"`` for what the difference between
        contacts adds.
    """

    random: RandomEffects
    fixed_geometry: float
    fixed: Pooled
    scatter: NestedScatter
    budget: dict[str, float]

    @property
    def value(self) -> float:
        """The pooled radius, mm."""
        return self.random.value

    @property
    def std(self) -> float:
        """Its standard uncertainty, with everything that contacts share, mm."""
        return self.random.total_std

    @property
    def count(self) -> int:
        """Number of contacts, a sequence counting as one."""
        return self.random.count

    @property
    def largest_weight(self) -> float:
        """The largest weight of a contact."""
        return float(self.random.weights.max())

    @property
    def effective_count(self) -> float:
        """Number of contacts of equal weight that would make as much of a mean: 1/Σw²."""
        return float(1 / np.sum(self.random.weights**2))

    @classmethod
    def of(cls, rows: Rows, pooled: pd.DataFrame, estimate: Places, output: str) -> Self:
        """Pool one of `POOLED_OUTPUTS`.

        A radius changes with the square of its contact's elongation, and its stated uncertainty with the
        elongation: weights from the stated ones would be largest for contacts that are round by chance, and
        bias the mean. So one slope is used for all contacts; and the pooled radius is that at the mean
        elongation, to second order, without the bias of a mean of squares. The weights contain repeatability
        and the variance between contacts, so that one of little noise does not count for all.

        Parameters
        ----------
        rows : Rows
            All rows.
        pooled : DataFrame
            Those of them to pool; all must count.
        estimate : ndarray of int
            Which estimate each belongs to, counted from 0: one for a single contact, one for all frames of
            a sequence. The frames show the same skin, pressed once: their errors are taken to be the same
            error, so that their mean has the uncertainty of one frame, however many there are.
        output : str
            The radius.
        """
        places = np.searchsorted(rows.pooled, pooled.index.to_numpy())
        parts = rows.parts[places, POOLED_OUTPUTS.index(output)]
        bias = np.sum(parts[:, _OWN & _SECOND], axis=-1) / np.sqrt(2)
        own_std = _own_std(parts, rows.elongation_std[places])
        mean = mean_within(estimate, own_std)
        value, own = mean(pooled[f"{output}_mm"].to_numpy()), mean(own_std)
        own = np.maximum(own, np.spacing(value))
        value -= (1 - pool_random_effects(value, own).weights) * mean(bias)
        parts = np.stack([mean(part) for part in parts.T], axis=-1)
        first = np.unique(estimate, return_index=True)[1]
        last = estimate.size - 1 - np.unique(estimate[::-1], return_index=True)[1]
        shared = shared_errors(
            parts[:, ~_OWN], PART_SOURCES[~_OWN].tolist(), pooled["scale"].to_numpy()[first]
        )
        random = pool_random_effects(value, own, shared)
        variances = shared.variances(random.weights)
        exact = sum(variance for source, variance in variances.items() if source not in GEOMETRY)
        return cls(
            random=random,
            fixed_geometry=float(np.hypot(random.std, np.sqrt(exact))),
            fixed=pool(value, own, shared),
            scatter=nested_scatter(value, {"load": pooled["load_N"].to_numpy()[last]}, least_freedom=(1, 1)),
            budget=_budget(random, variances, parts[:, _OWN], own),
        )


def _own_std(parts: FloatArray, elongation_std: FloatArray) -> FloatArray:
    """Return the standard uncertainty from contacts' own errors, with one slope for all of them."""
    variance = np.sum(elongation_std**2)
    slope = np.sum(parts[:, _OWN & ~_SECOND] ** 2) / variance if variance > 0 else 0.0
    return as_float_array(np.sqrt(slope * elongation_std**2 + np.sum(parts[:, _OWN & _SECOND] ** 2, axis=-1)))


def mean_within(estimate: Places, own_std: FloatArray) -> Callable[[FloatArray], FloatArray]:
    """Return the mean over the rows of each estimate, weighted by their own errors where they are several."""
    weights = np.where(np.bincount(estimate)[estimate] > 1, own_std**-2.0, 1.0)
    weights /= np.bincount(estimate, weights)[estimate]
    return lambda of: as_float_array(np.bincount(estimate, weights * of))


def shared_errors(parts: FloatArray, sources: Sequence[str], scales: Iterable[str | None]) -> SharedErrors:
    """Return the errors that estimates share: of the placement all, of scale and edge those of one scale.

    Images that name no scale have one each, but are taken to be of one device, whose edge they share.

    Parameters
    ----------
    parts : ndarray, shape (estimates, parts)
        Signed contributions to the uncertainty of each.
    sources : sequence of str
        Source of each part.
    scales : iterable of str or None
        Name of the scale of each estimate, None where it has its own.
    """
    scales = list(scales)
    scale = numbered((place,) if name is None else name for place, name in enumerate(scales))
    groups = {"image scale": scale, "contact edge": numbered(scales)}
    everything = np.zeros(len(parts), dtype=np.intp)
    return SharedErrors(
        sources=tuple(sources),
        parts=parts,
        groups=np.stack([groups.get(source, everything) for source in sources], axis=-1),
    )


def _budget(
    pooled: RandomEffects, shared: Mapping[str, float], own_parts: FloatArray, own_std: FloatArray
) -> dict[str, float]:
    """Return the share of each source in the variance of the pooled value."""
    own = pooled.weights**2 @ own_parts**2
    total = own.sum()
    own *= pooled.weights**2 @ own_std**2 / total if total > 0 else 1.0
    variance = {
        source: shared.get(source, float(own[source == PART_SOURCES[_OWN]].sum())) for source in PAD_SOURCES
    }
    variance["scatter"] = max(0.0, pooled.total_std**2 - sum(variance.values()))
    total = sum(variance.values())
    return {source: each / total if total > 0 else each for source, each in variance.items()}
