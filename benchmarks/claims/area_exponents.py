"""The exponent of the area over the frames of a press, whose errors change smoothly from frame to frame.

Areas grow with the 2/3 power of the load, from 0.1 to 2 N over 200 frames, times an error of 2 %. Frames
state it, or a quarter of it.
"""

import math
from collections.abc import Callable, Iterator
from functools import cache, partial
from itertools import product
from typing import Final

import numpy as np

from benchmarks.arrays import Array, Rng
from benchmarks.tables import share, table
from fingerpad.uncertainty.press_slope import PressSlope

EXPONENT: Final = 2 / 3
ERROR: Final = 0.02
LOG_LOAD: Final = np.log(np.linspace(0.1, 2, 200))


@cache
def _correlated(length: float, size: int) -> Array:
    """Return what makes a smooth error of independent numbers."""
    x = np.linspace(0, 1, size)
    covariance = np.exp(-((x[:, None] - x) ** 2) / (2 * length**2)) + 1e-9 * np.eye(size)
    return np.linalg.cholesky(covariance)


def smooth(length: float, rng: Rng, size: int = LOG_LOAD.size) -> Array:
    """Return an error of unit size that changes over a share of the press."""
    return _correlated(length, size) @ rng.normal(size=size)


def independent(rng: Rng) -> Array:
    """Return an error of unit size of each frame."""
    return rng.normal(size=LOG_LOAD.size)


def autoregressive(rng: Rng) -> Array:
    """Return an error of unit size of which each frame keeps 0.95."""
    error = independent(rng)
    for k in range(1, error.size):
        error[k] = 0.95 * error[k - 1] + math.sqrt(1 - 0.95**2) * error[k]
    return error


ERRORS: Final[dict[str, Callable[[Rng], Array]]] = {
    "of each frame": independent,
    "each frame keeps 0.95": autoregressive,
    **{f"smooth over {length} of the press": partial(smooth, length) for length in (0.1, 0.2, 0.4, 0.8)},
}


def held(kind: str, presses: int, repeats: int, stated: float = ERROR) -> tuple[Array, Array]:
    """Return whether ± 2 standard uncertainties hold the exponent, ours and those of independent frames."""
    load, item = np.tile(LOG_LOAD, presses), np.repeat(np.arange(presses), LOG_LOAD.size)
    found = []
    for seed in range(repeats):
        rng = np.random.default_rng(seed)
        errors = [rng.normal(0, 0.05) + ERROR * ERRORS[kind](rng) for _ in range(presses)]
        area = EXPONENT * load + np.concatenate(errors)
        slope = PressSlope.of(load, area, np.full(load.size, stated), item)
        assert slope is not None  # frames enough
        naive = stated * np.linalg.norm(slope.weights)
        found.append(np.abs(slope.value - EXPONENT) < 2 * np.array([slope.std, naive]))
    ours, naively = np.array(found, dtype=float).T
    return ours, naively


def report(repeats: int = 200) -> None:
    """Print how often ± 2 standard uncertainties hold the exponent, of one press and of three."""

    def cells(kind: str) -> Iterator[str]:
        yield kind
        for stated, presses in product((ERROR, ERROR / 4), (1, 3)):
            ours, naively = held(kind, presses, repeats, stated)
            yield f"{share(ours)} ({share(naively)})"

    columns = map(", ".join, product(("stated", "a quarter stated"), ("one press", "three")))
    title = f"{repeats} simulations each: held (with frames taken as independent)"
    table(("errors of 2 %", *columns), map(list, map(cells, ERRORS)), title)
