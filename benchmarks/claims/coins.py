"""Coins and washers in photographs traced by rays, against their truth."""

import time

import cv2
import numpy as np
from tests.image.coin_scenes import KINDS, NOT_ONE_COIN, scene

from fingerpad.exceptions import CalibrationError
from fingerpad.image import measure_coin


def report(count: int = 22, first_seed: int = 1000) -> None:
    """Print how often the diameter is found, refused, flagged or wrong, and what its interval holds."""
    print(f"\nPhotographs of coins and washers, {count} of each kind; errors of the diameter")
    print("    kind               refused  flagged  over 2 %, unflagged  median  95 % within  covered     ms")
    rows = []
    for kind in (*KINDS, *NOT_ONE_COIN):
        found = [_error(kind, first_seed + seed) for seed in range(count)]
        rows += found if kind in KINDS else []
        _print_row(kind, np.array(found))
    _print_row("all with a coin", np.array(rows))


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


def _print_row(kind: str, rows: np.ndarray) -> None:
    found = np.isfinite(rows[:, 0])
    size, pulls = 100 * np.abs(rows[found, 0]), np.abs(rows[found, 1])
    flagged = rows[found, 2] > 0
    median, max_draws = np.quantile(size, [0.5, 0.95]) if size.size else (np.nan, np.nan)
    held = 100 * np.mean(pulls < 1.96) if pulls.size else np.nan
    print(
        f"    {kind:<18} {np.count_nonzero(~found):7d}  {np.count_nonzero(flagged):7d}  "
        f"{np.count_nonzero((size > 2) & ~flagged):19d}  {median:4.2f} %  {max_draws:9.2f} %  {held:5.0f} %  "
        f"{1e3 * rows[:, 3].mean():6.0f}"
    )
