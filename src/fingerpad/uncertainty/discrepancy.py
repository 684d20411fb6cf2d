"""By how much a model is wrong, as two ways through it to one quantity show."""

import math
from dataclasses import dataclass

import numpy as np
from scipy import optimize

from fingerpad._arrays import ArrayLike, as_float_array, check_all
from fingerpad._display import Displayed
from fingerpad.exceptions import UncertaintyError


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class ModelDiscrepancy(Displayed):
    """By how much a model is wrong, as two ways through it to one quantity show."""

    # standard deviation that each of the two ways needs beside its stated uncertainty, relative to its value;
    # zero where the stated uncertainties explain the differences
    relative_std: float
    between_std: float  # standard deviation s of the logarithm of their ratio, beyond chance
    count: int  # number of comparisons, which are the degrees of freedom


def model_discrepancy(log_ratios: ArrayLike, stds: ArrayLike) -> ModelDiscrepancy:
    r"""Estimate the discrepancy of a model from pairs of values that would agree if it held.

    s² solves :math:`\sum_i r_i^2/(u_i^2 + s^2) = n`, Paule and Mandel's equation about a mean that is known
    to be zero: with s, the differences are as large as their uncertainties. Nothing tells which of the two
    ways is wrong, so that each has s/√2 of the logarithm, which is up to exp(s/√2) − 1 of the value (Kennedy
    and O'Hagan's discrepancy, as one number).
    """
    ratio, std = np.atleast_1d(as_float_array(log_ratios)), np.atleast_1d(as_float_array(stds))
    check_all(np.isfinite(ratio), "log_ratios", ratio, "finite", UncertaintyError)
    check_all(std >= 0, "standard uncertainty", std, "at least zero", UncertaintyError)
    if not ratio.size or ratio.shape != std.shape:
        raise UncertaintyError(
            f"as many standard uncertainties as ratios are needed, and one at least; found {ratio.size} and "
            f"{std.size}"
        )

    def excess(variance: float) -> float:
        return float(np.sum(ratio**2 / (std**2 + variance))) - ratio.size

    upper = float(np.sum(ratio**2))
    smallest = 1e-12 * upper
    between = optimize.brentq(excess, smallest, upper) if upper > 0 and excess(smallest) > 0 else 0.0
    return ModelDiscrepancy(
        relative_std=math.expm1(math.sqrt(between / 2)), between_std=math.sqrt(between), count=ratio.size
    )
