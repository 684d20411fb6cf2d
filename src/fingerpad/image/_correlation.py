"""Correlated errors along an outline."""

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import FloatArray

# The window of the sum of autocorrelations, in correlation lengths (Sokal 1997, section 3).
_WINDOW: Final = 5.0


def correlation_length(residuals: FloatArray, places: npt.NDArray[np.integer]) -> float:
    """Return how many neighbouring residuals count as one.

    The integrated autocorrelation 1 + 2 Σ ρ_k, summed over a window of five correlation lengths and
    limited to an eighth of the number of residuals.

    Parameters
    ----------
    residuals : ndarray, (n,)
        Distances from a fit, in order.
    places : ndarray of int, (n,)
        Place of each along the outline, rising; gaps are points that were left out.
    """
    span = int(places[-1] - places[0]) + 1
    values, present = np.zeros(span), np.zeros(span)
    values[places - places[0]] = residuals - residuals.mean()
    present[places - places[0]] = 1
    max_lag = max(2, span // 3)
    pairs = np.maximum(_lagged_products(present, max_lag), 1)
    covariance = _lagged_products(values, max_lag) / pairs
    if not covariance[0] > 0:
        return 1.0
    length = 1 + 2 * np.cumsum(covariance[1:] / covariance[0])
    enough = np.arange(1, len(length) + 1) >= _WINDOW * np.maximum(length, 1) / 2
    last = int(np.argmax(enough)) if enough.any() else len(length) - 1
    return float(np.clip(length[: last + 1].max(), 1, len(residuals) / 8))


def _lagged_products(values: FloatArray, max_lag: int) -> FloatArray:
    """Return the sums of products of values at lags 0 to max_lag."""
    size = 2 ** math.ceil(math.log2(2 * len(values)))
    power = np.abs(np.fft.rfft(values, size)) ** 2
    return np.asarray(np.fft.irfft(power, size)[: max_lag + 1], dtype=np.float64)
