"""Coins and washers in photographs traced by rays, against their truth."""

import cv2
import numpy as np

from benchmarks.arrays import Array
from benchmarks.tables import or_none, percent, share, table
from benchmarks.truth.coins import KINDS, NOT_ONE_COIN, scene
from fingerpad.image import measure_coin

COLUMNS = "kind", "n", "refused", "flagged", "rms error", "held", "without a flag: rms error"


def report(count: int = 22, first_seed: int = 1000) -> None:
    """Print how often the diameter is found, refused, flagged or wrong, and what its interval holds."""
    cv2.setNumThreads(1)
    seeds = range(first_seed, first_seed + count)
    found = {kind: np.array([_error(kind, seed) for seed in seeds]) for kind in (*KINDS, *NOT_ONE_COIN)}
    found["all with a coin"] = np.concatenate([found[kind] for kind in KINDS])
    table((*COLUMNS, "over 1 % off", "over 2 % off"), (_row(kind, rows) for kind, rows in found.items()))


def _error(kind: str, seed: int) -> tuple[float, float, bool]:
    """Return the relative error, the error over the standard uncertainty, and if it is flagged."""
    photograph = scene(kind, seed)
    if (coin := or_none(measure_coin, photograph.pixels)) is None:
        return np.nan, np.nan, False
    error = coin.semi_major - photograph.semi_major
    return error / photograph.semi_major, error / coin.semi_major_std, bool(coin.flags)


def _row(kind: str, rows: Array) -> tuple[object, ...]:
    errors, pulls, flagged = rows[np.isfinite(rows[:, 0])].T
    plain = np.abs(errors[flagged == 0])
    rms, rms_plain = (
        percent(float(np.sqrt(np.mean(some**2)))) if some.size else "–" for some in (errors, plain)
    )
    refused, over = len(rows) - len(errors), [int((plain > limit).sum()) for limit in (0.01, 0.02)]
    return kind, len(rows), refused, int(flagged.sum()), rms, share(np.abs(pulls) < 1.96), rms_plain, *over
