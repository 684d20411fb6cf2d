"""What moves the edge of a coin, on photographs of coins and washers traced by rays."""

from collections.abc import Sequence
from typing import Any, TypeAlias
from unittest.mock import patch

import numpy as np

from benchmarks.derive.fit import Compared, Problem
from benchmarks.tables import or_none
from benchmarks.truth.coins import KINDS, scene
from fingerpad.image import coin as coin_module
from fingerpad.image import measure_coin
from fingerpad.image.coin import COIN_EDGE

_NEAR = 0.1  # another circle was found: nothing is learned of the edge


# What `coin._coin` is given, and the true radius, px.
Seen: TypeAlias = tuple[tuple[Any, ...], float]


def sample(count: int, seed: int) -> list[Seen]:
    """Return the outlines of the coins that are found."""
    coins = []
    for kind in KINDS:
        for number in range(count):
            photograph = scene(kind, 1000 * seed + number)
            with patch.object(coin_module, "_coin", lambda *given: given):
                found: Any = or_none(measure_coin, photograph.pixels)
            if found and abs(coin_module._coin(*found).semi_major / photograph.semi_major - 1) < _NEAR:
                coins.append((found, photograph.semi_major))
    return coins


def compare(model: Any, coins: Sequence[Seen]) -> Compared:
    """State the uncertainty of each radius."""
    with patch.object(coin_module, "COIN_EDGE", model):
        found = [(coin_module._coin(*given), true) for given, true in coins]
    rows = [(one.semi_major / true - 1, one.semi_major_std / true) for one, true in found]
    return Compared(*np.transpose(rows))


_EFFECTS = "lens_px", "rounding", "shadow", "band"
PROBLEMS = (Problem(COIN_EDGE, "error of the radius, as a share", sample, compare, stds=_EFFECTS),)
