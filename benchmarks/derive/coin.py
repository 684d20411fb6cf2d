"""What moves the edge of a coin, on photographs of coins and washers traced by rays."""

from collections.abc import Sequence
from typing import Any, NamedTuple
from unittest.mock import patch

import numpy as np

from benchmarks.derive.fit import Compared, Problem
from benchmarks.tables import or_none
from benchmarks.truth.coins import KINDS, scene
from fingerpad.image import coin as coin_module
from fingerpad.image import measure_coin
from fingerpad.image.coin import COIN_EDGE

_NEAR = 0.1  # another circle was found: nothing is learned of the edge


class Seen(NamedTuple):
    """What `coin._coin` is given, and the true radius, px."""

    found: tuple[Any, ...]
    radius: float


def sample(count: int, seed: int) -> list[Seen]:
    """Return the outlines of the coins that are found."""
    coins = []
    for kind in KINDS:
        for number in range(count):
            photograph = scene(kind, 1000 * seed + number)
            with patch.object(coin_module, "_coin", lambda *given: given):
                found: Any = or_none(measure_coin, photograph.pixels)
            if found and abs(coin_module._coin(*found).semi_major / photograph.semi_major - 1) < _NEAR:
                coins.append(Seen(found, photograph.semi_major))
    return coins


def compare(model: Any, coins: Sequence[Seen]) -> Compared:
    """State the uncertainty of each radius."""
    with patch.object(coin_module, "COIN_EDGE", model):
        found = [coin_module._coin(*one.found) for one in coins]
    true = np.array([one.radius for one in coins])
    sizes, stds = np.array([(one.semi_major, one.semi_major_std) for one in found]).T
    return Compared(sizes / true - 1, stds / true)


PROBLEMS = (
    Problem(
        model=COIN_EDGE,
        of="error of the radius, as a share",
        stds=("lens_px", "rounding", "shadow", "band"),
        sample=sample,
        compare=compare,
    ),
)
