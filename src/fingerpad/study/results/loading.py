"""The loading radius R_g that loading curves give at a placement."""

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from fingerpad.study.measuring.curves import CurveResult
from fingerpad.uncertainty import pool, proportional_stds


class LoadingRadius(NamedTuple):
    """R_g of a finger at an angle, from all its curves there, mm, with flags of their fits.

    What a wrong model and the scale of the areas leave uncertain is common to curves: pooling does not reduce
    it. `misfit_std` is the former part of `std`.
    """

    value: float
    std: float
    synthetic: bool
    flags: tuple[str, ...] = ()
    misfit_std: float = 0.0


def loading_radius(curves: Iterable[CurveResult], place: tuple[str, float, bool]) -> LoadingRadius | None:
    """Return R_g from loading data of a finger at its angle, pooled over its curves; None without any."""
    fitting = [one for one in curves if one.manifest.place == place and math.isfinite(one.loading_radius)]
    if not fitting:
        return None
    *_, synthetic = place
    values, stds = np.array([(each.loading_radius, each.loading_radius_std) for each in fitting]).T
    misfits = np.array([each.fit.misfit_std["loading_radius"] if each.fit else 0.0 for each in fitting])
    flags = tuple(sorted({flag for each in fitting if each.fit for flag in each.fit.notes}))
    if not np.isfinite(stds).all():
        return LoadingRadius(float(values.mean()), math.nan, synthetic, flags)
    of_areas = values * [each.area_relative_std for each in fitting]
    own = np.sqrt(np.maximum(stds**2 - misfits**2 - of_areas**2, 0.0))
    pooled = pool(values, proportional_stds(values, own))
    misfit = float(misfits.max())
    std = math.hypot(pooled.total_std, misfit, float(of_areas.max()))
    return LoadingRadius(pooled.value, std, synthetic, flags, misfit)
