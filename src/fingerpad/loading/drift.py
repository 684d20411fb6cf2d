r"""Slow noise of a force: a sum of processes that forget exponentially, at a cost linear in the rows.

One of them is an Ornstein–Uhlenbeck process. Several of equal variance, with correlation times in even
ratios, have a power spectrum of 1/f from the shortest time to the longest. With :math:`P` the precision of
all of them in all rows, which is banded, H their sum, and D white noise, the covariance
:math:`V = D + H P^{-1} H^{\mathsf T}` has
:math:`V^{-1} = D^{-1} - D^{-1} H (P + H^{\mathsf T} D^{-1} H)^{-1} H^{\mathsf T} D^{-1}`.
"""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy import linalg

from fingerpad._arrays import FloatArray, as_float_array
from fingerpad._display import Displayed

# Ratio of correlation times: the spectrum then departs from 1/f by some per cent.
_RATIO = 10.0
# A random walk is a process whose correlation time is so many records.
_FORGOTTEN = 10.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Drift(Displayed):
    """Slow noise of n rows.

    Attributes
    ----------
    stds, times : ndarray, (k,)
        Standard deviation (N) and correlation time of each process.
    steps : ndarray, (n − 1,)
        Time from each row to the next.
    """

    stds: FloatArray
    times: FloatArray
    steps: FloatArray

    @classmethod
    def exponential(cls, std: float, time: float, steps: FloatArray) -> Self:
        """Return one process, which forgets within `time`."""
        return cls(stds=np.array([std]), times=np.array([time]), steps=steps)

    @classmethod
    def long_range(cls, std: float, steps: FloatArray) -> Self:
        """Return 1/f noise, from the rows' own rate to the record's, of standard deviation `std`."""
        shortest, whole = float(np.median(steps)), float(steps.sum())
        count = 1 + math.ceil(math.log(whole / shortest, _RATIO))
        times = as_float_array(shortest * _RATIO ** np.arange(count))
        return cls(stds=np.full(count, std / math.sqrt(count)), times=times, steps=steps)

    @classmethod
    def random_walk(cls, std: float, steps: FloatArray) -> Self:
        """Return noise that moves by `std` over the record, and forgets nothing of it."""
        longest = _FORGOTTEN * float(steps.sum())
        return cls.exponential(std * math.sqrt(_FORGOTTEN / 2), longest, steps)

    @property
    def slow_variance(self) -> float:
        """Return the variance of white noise with the same density at the record's own frequency."""
        step, whole = float(np.median(self.steps)), float(self.steps.sum())
        kept = np.exp(-step / self.times)
        # At one period in two records; without it the density at zero, which 1/f noise has not.
        cosine = math.cos(math.pi * step / whole)
        density = self.stds**2 * -np.expm1(-2 * step / self.times) / (1 - 2 * kept * cosine + kept**2)
        return float(density.sum())

    def covariance_of(self, weights: FloatArray) -> FloatArray:
        """Return the covariance of sums of the rows with weights (n, p), (p, p)."""
        total = np.zeros((weights.shape[1], weights.shape[1]))
        for std, time in zip(self.stds, self.times, strict=True):
            band = np.stack([np.ones(len(weights)), np.append(-np.exp(-self.steps / time), 0.0)])
            passed, _ = linalg.lapack.dtbtrs(band, weights, uplo="L", trans="T", diag="U")
            passed *= std * np.sqrt(np.append(1.0, -np.expm1(-2 * self.steps / time)))[:, None]
            total += passed.T @ passed
        return total

    def information(self, white: FloatArray, columns: FloatArray) -> tuple[FloatArray, float]:
        """Return CᵀV⁻¹C of columns C (n, p), with white noise of these variances added, and ½ log |V|."""
        count = self.times.size
        kept = np.exp(-self.steps[:, None] / self.times)
        new = self.stds**2 * np.vstack([np.ones(count), -np.expm1(-2 * self.steps[:, None] / self.times)])
        band = np.zeros((count + 1, new.size))
        diagonal = 1 / new + 1 / white[:, None]
        diagonal[:-1] += kept**2 / new[1:]
        band[0] = diagonal.ravel()
        for apart in range(1, count):
            band[apart].reshape(-1, count)[:, : count - apart] = 1 / white[:, None]
        band[count, :-count] = (-kept / new[1:]).ravel()
        root, _ = linalg.lapack.dpbtrf(band, lower=1, overwrite_ab=1)
        scaled = columns / white[:, None]
        solved, _ = linalg.lapack.dtbtrs(root, np.repeat(scaled, count, axis=0), uplo="L")
        volume = np.log(root[0]).sum() + (np.log(white).sum() + np.log(new).sum()) / 2
        return columns.T @ scaled - solved.T @ solved, float(volume)

    def simulated(self, rng: np.random.Generator) -> FloatArray:
        """Return one record of it."""
        kept = np.vstack([np.zeros(self.times.size), np.exp(-self.steps[:, None] / self.times)])
        new = self.stds * np.sqrt(1 - kept**2) * rng.standard_normal(kept.shape)
        for row in range(1, len(new)):
            new[row] += kept[row] * new[row - 1]
        return np.asarray(new.sum(axis=1))
