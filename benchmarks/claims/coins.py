"""Coins and washers in photographs traced by rays, against their truth."""

import time

import cv2
import numpy as np
from tests.image.coin_scenes import KINDS, NOT_ONE_COIN, scene

from benchmarks.tables import percent, share, table
from fingerpad.exceptions import CalibrationError
from fingerpad.image import measure_coin

COLUMNS = "kind", "n", "refused", "flagged", "over 2 % off, no flag", "rms error", "held", "ms"


def report(count: int = 22, first_seed: int = 1000) -> None:
    """Print how often the diameter is found, refused, flagged or wrong, and what its interval holds."""
    found = {
        kind: np.array([_error(kind, first_seed + seed) for seed in range(count)])
        for kind in (*KINDS, *NOT_ONE_COIN)
    }
    found["all with a coin"] = np.concatenate([found[kind] for kind in KINDS])
    table(COLUMNS, (_row(kind, rows) for kind, rows in found.items()))


def _error(kind: str, seed: int) -> tuple[float, float, bool, float]:
    """Return the relative error, the error over the standard uncertainty, if it is flagged, and the time."""
    photograph = scene(kind, seed)
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    start = time.perf_counter()
    try:
        coin = measure_coin(photograph.pixels)
    except CalibrationError:
        return np.nan, np.nan, False, time.perf_counter() - start
    finally:
        cv2.setNumThreads(threads)
    error = coin.semi_major - photograph.semi_major
    spent = time.perf_counter() - start
    return error / photograph.semi_major, error / coin.semi_major_std, bool(coin.flags), spent


def _row(kind: str, rows: np.ndarray) -> tuple[object, ...]:
    errors, pulls, flagged, _ = rows[np.isfinite(rows[:, 0])].T
    silent = (np.abs(errors) > 0.02) & (flagged == 0)
    rms = percent(float(np.sqrt(np.mean(errors**2)))) if errors.size else "–"
    held, spent = share(np.abs(pulls) < 1.96), f"{1e3 * rows[:, 3].mean():.0f}"
    refused = len(rows) - len(errors)
    return kind, len(rows), refused, int(flagged.sum()), int(silent.sum()), rms, held, spent
