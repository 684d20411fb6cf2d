"""A finger at one angle on its layer of tissue: contacts pooled, and the one at the highest load."""

import math
from dataclasses import dataclass
from typing import Final, Self

import numpy as np
import pandas as pd

from fingerpad.study.results.layer import (
    HERTZ_OF,
    LAYER_PART_SOURCES,
    POOLED_ON_LAYER,
    Layered,
    unit_of,
    with_thickness,
)
from fingerpad.study.results.model import OF_THE_DEVICE, OF_THE_PLACEMENT
from fingerpad.study.results.pooling import mean_within, shared_errors
from fingerpad.study.results.rows import HighestLoad, Rows
from fingerpad.study.results.table import Places, numbered
from fingerpad.uncertainty import (
    LAYER_SOURCES,
    Propagated,
    pool,
    proportional_stds,
)

# Parts that a contact shares with no other.
_OWN: Final = ~np.isin(LAYER_PART_SOURCES, (*OF_THE_PLACEMENT, *OF_THE_DEVICE, "thickness"))


@dataclass(frozen=True, slots=True, kw_only=True)
class LayerQuantity:
    """A quantity with its uncertainty, in the unit of the tables.

    Attributes
    ----------
    value, std : float
        In kPa or mm; NaN where it is out of the range of the laws.
    budget : dict of str to float
        Share of each source in the variance.
    """

    value: float
    std: float
    budget: dict[str, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class PooledOnLayer(LayerQuantity):
    """A quantity pooled over contacts, all of which are taken to have one value.

    Attributes
    ----------
    birge_ratio : float
        Of the scatter; the uncertainty is widened by it where it exceeds one.
    count : int
        Number of contacts, a sequence counting as one.
    """

    birge_ratio: float
    count: int

    @classmethod
    def of(cls, rows: Rows, pooled: pd.DataFrame, estimate: Places, output: str) -> Self | None:
        """Pool one of `POOLED_ON_LAYER` over the contacts in the range of the laws; None where none is.

        Parameters
        ----------
        rows : Rows
            All rows.
        pooled : DataFrame
            Those of them to pool; all must count.
        estimate : ndarray of int
            Which estimate each belongs to: one for a single contact, one for all frames of a sequence.
        output : str
            The quantity.
        """
        parts = rows.layer_parts[np.searchsorted(rows.pooled, pooled.index.to_numpy())]
        known = np.asarray(np.isfinite(parts).all(axis=(-2, -1)))  # the same contacts for all outputs
        if not known.any():
            return None
        unit, factor = unit_of(output)
        pooled, estimate = pooled[known], numbered(estimate[known])
        parts = factor * parts[known, POOLED_ON_LAYER.index(output)]
        own_std = np.sqrt(np.sum(parts[:, _OWN] ** 2, axis=-1))
        mean = mean_within(estimate, own_std)
        value, parts = (
            mean(pooled[f"{output}_{unit}"].to_numpy()),
            np.stack(list(map(mean, parts.T)), axis=-1),
        )
        first = np.unique(estimate, return_index=True)[1]
        sources = LAYER_PART_SOURCES[~_OWN].tolist()
        shared = shared_errors(parts[:, ~_OWN], sources, pooled["scale"].iloc[first])
        found = pool(value, proportional_stds(value, mean(own_std)), shared)
        variance = dict.fromkeys(LAYER_SOURCES, 0.0) | shared.variances(found.weights)
        for source in np.unique(LAYER_PART_SOURCES[_OWN]).tolist():
            own = parts[:, _OWN & (source == LAYER_PART_SOURCES)]
            variance[source] = float(np.sum(found.weights**2 @ own**2))
        variance["scatter"] = max(0.0, found.total_std**2 - sum(variance.values()))
        total = sum(variance.values())
        return cls(
            value=found.value,
            std=found.total_std,
            budget={source: each / total if total else 0.0 for source, each in variance.items()},
            birge_ratio=found.birge_ratio,
            count=found.count,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class LayerSummary:
    """What the contacts of a finger at one angle tell of it on its layer of tissue.

    Attributes
    ----------
    thickness, thickness_std : float
        Effective thickness as stated, mm; the uncertainty is NaN where none is stated.
    observation : str
        The contact at the highest load that is in the range of the laws, if any is.
    load : float
        Its load, N.
    flag : str
        What takes it out of the range of the laws; empty where nothing does.
    at_highest_load : dict of str to LayerQuantity
        Its quantities on the layer, and those of Hertz theory.
    pooled : dict of str to (PooledOnLayer or None)
        `POOLED_ON_LAYER` over all contacts that count.
    """

    thickness: float
    thickness_std: float
    observation: str
    load: float
    flag: str
    at_highest_load: dict[str, LayerQuantity]
    pooled: dict[str, PooledOnLayer | None]

    @classmethod
    def of(cls, rows: Rows, pooled: pd.DataFrame, estimate: Places, highest: HighestLoad) -> Self | None:
        """Summarise the rows that count at one placement; None where the finger has no thickness."""
        thickness, std = (
            float(pooled[name].to_numpy()[0])
            for name in ("effective_thickness_mm", "effective_thickness_mm_std")
        )
        if math.isnan(thickness):
            return None
        inputs = with_thickness(highest.inputs, [thickness], 0.0 if math.isnan(std) else std)
        found = Layered.of(inputs, "first_order")
        return cls(
            thickness=thickness,
            thickness_std=std,
            observation=highest.observation,
            load=highest.load,
            flag=str(found.flag[0]),
            at_highest_load={
                name: quantity_of(found.propagated, name) for name in (*HERTZ_OF, *HERTZ_OF.values())
            },
            pooled={name: PooledOnLayer.of(rows, pooled, estimate, name) for name in POOLED_ON_LAYER},
        )


def quantity_of(propagated: Propagated, name: str) -> LayerQuantity:
    """Return an output of one contact in the unit of the tables."""
    _, factor = unit_of(name)
    place = propagated.place(name)
    return LayerQuantity(
        value=factor * float(propagated.value[0, place]),
        std=factor * float(propagated.std[0, place]),
        budget={source: float(share[0]) for source, share in propagated.budget(name).items()},
    )
