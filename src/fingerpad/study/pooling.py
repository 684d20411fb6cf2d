"""One radius from the contacts of a finger at one angle, with what they share counted as shared."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad.study.model import GEOMETRY, OF_THE_PLACEMENT, PART_SOURCES, POOLED_OUTPUTS
from fingerpad.study.rows import Rows
from fingerpad.uncertainty import (
    PAD_OUTPUTS,
    PAD_SOURCES,
    Pooled,
    RandomEffects,
    Scatter,
    pool,
    pool_random_effects,
    scatter_of,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class PooledRadius:
    """A radius pooled over contacts.

    Attributes
    ----------
    fixed : Pooled
        All contacts taken to have one radius; the scatter beyond their uncertainties widens it (Birge).
    given_geometry : float
        Its standard uncertainty with semi-axes and angles held exact, as the source does.
    random : RandomEffects
        Contacts taken to have radii of their own about a mean.
    scatter : Scatter
        Of contacts under one load, and between loads.
    budget : dict of str to float
        Share of each source in the variance of `fixed`, with ``"scatter"`` for what Birge's ratio adds.
    """

    fixed: Pooled
    given_geometry: float
    random: RandomEffects
    scatter: Scatter
    budget: dict[str, float]

    @property
    def value(self) -> float:
        """The pooled radius, mm."""
        return self.fixed.value

    @property
    def std(self) -> float:
        """Its standard uncertainty, with everything that contacts share, mm."""
        return self.fixed.total_std

    @property
    def count(self) -> int:
        """Number of contacts, a film counting as one."""
        return self.fixed.count

    @classmethod
    def of(cls, rows: Rows, estimates: Sequence[Sequence[int]], output: str) -> Self:
        """Pool one of `POOLED_OUTPUTS`.

        Parameters
        ----------
        rows : Rows
            All rows.
        estimates : sequence of sequences of int
            Places among the good rows: single contacts, and all frames of a film together. The frames show
            the same skin, pressed once: their errors are taken to be the same error, so that their mean is
            no better known than a frame is, however many there are.
        output : str
            The radius.
        """
        parts = rows.modelled.parts[:, POOLED_OUTPUTS.index(output)]
        values = rows.modelled.value[:, PAD_OUTPUTS.index(output)]
        shared = np.isin(PART_SOURCES, OF_THE_PLACEMENT)
        scale = PART_SOURCES == "image scale"
        own_std = np.sqrt(np.sum(parts[:, ~shared & ~scale] ** 2, axis=-1))
        weights = np.zeros((len(estimates), len(values)))
        for row, places in zip(weights, estimates, strict=True):
            row[places] = own_std[places] ** -2.0 if len(places) > 1 else 1.0
            row[places] /= row[places].sum()
        value, own, mean_parts = weights @ values, weights @ own_std, weights @ parts
        same_scale = _same([rows.scales[places[0]] for places in estimates])
        covariances = {
            source: _covariance(mean_parts[:, source == PART_SOURCES], source, same_scale)
            for source in (*OF_THE_PLACEMENT, "image scale")
        }
        loads = [rows.rows[rows.good[places[-1]]]["load_N"] for places in estimates]
        fixed = pool(value, own, sum(covariances.values()))
        exact = sum(covariances[source] for source in covariances if source not in GEOMETRY)
        return cls(
            fixed=fixed,
            given_geometry=pool(value, own, exact).total_std,
            random=pool_random_effects(value, np.maximum(own, np.spacing(value)), sum(covariances.values())),
            scatter=scatter_of(value, loads),
            budget=_budget(fixed, own, covariances, mean_parts),
        )


def _same(scales: Sequence[str | None]) -> FloatArray:
    """Return which estimates share a scale, as a matrix of ones and zeros."""
    names = [place if scale is None else scale for place, scale in enumerate(scales)]
    return np.array([[float(one == other) for other in names] for one in names])


def _covariance(parts: FloatArray, source: str, same_scale: FloatArray) -> FloatArray:
    """Return the covariance of the estimates that comes from one source."""
    covariance: FloatArray = parts @ parts.T
    return covariance * same_scale if source == "image scale" else covariance


def _budget(
    fixed: Pooled, own: FloatArray, covariances: dict[str, FloatArray], parts: FloatArray
) -> dict[str, float]:
    """Return each source's share in the variance of the pooled value."""
    own = np.maximum(own, np.finfo(float).tiny)
    weights = (own.min() / own) ** 2 / np.sum((own.min() / own) ** 2)
    variance = {source: float(weights @ covariances[source] @ weights) for source in covariances}
    for source in PAD_SOURCES:
        if source not in variance:
            columns = parts[:, source == PART_SOURCES]
            variance[source] = float(weights**2 @ np.sum(columns**2, axis=-1))
    variance["scatter"] = max(0.0, fixed.total_std**2 - sum(variance.values()))
    total = sum(variance.values())
    names = (*PAD_SOURCES, "scatter")
    return {name: variance[name] / total if total > 0 else 0.0 for name in names}
