"""Bias and limits of agreement, against differences of known distribution and a worked example."""

import math

import numpy as np
import pytest

from fingerpad.exceptions import UncertaintyError
from fingerpad.uncertainty import agreement


def test_intervals_and_limits_hold_as_often_as_they_say() -> None:
    rng = np.random.default_rng(7)
    bias, std, count = 0.03, 0.05, 12
    hits = np.zeros(3)
    for _ in range(600):
        first = rng.uniform(50, 200, count)
        found = agreement(first, first * np.exp(rng.normal(bias, std, count)))
        low, high = found.bias_interval
        hits[0] += low < math.expm1(bias) < high
        # The limits' intervals hold where 95 % of all differences lie, at either end.
        hits[1] += found.limits_interval[1] > math.expm1(bias + 1.96 * std)
        hits[2] += found.limits_interval[0] < math.expm1(bias - 1.96 * std)
    assert hits[0] / 600 == pytest.approx(0.95, abs=0.03)
    assert hits[1:] / 600 == pytest.approx(0.975, abs=0.025)


def test_against_sums_by_hand() -> None:
    """Differences of −0.02, 0, 0.02 and 0.04: mean 0.01, standard deviation √(0.002/3)."""
    found = agreement(np.ones(4), np.exp([-0.02, 0.0, 0.02, 0.04]))
    std = math.sqrt(0.002 / 3)
    assert found.std == pytest.approx(std)
    assert found.bias == pytest.approx(math.expm1(0.01))
    assert found.bias_interval[1] == pytest.approx(math.expm1(0.01 + 3.182446 * std / 2))
    assert found.limits == pytest.approx(
        (math.expm1(0.01 - 1.959964 * std), math.expm1(0.01 + 1.959964 * std))
    )


def test_too_few_pairs_say_so() -> None:
    found = agreement([1.0, 1.0], [1.1, 1.3])
    assert found.bias == pytest.approx(math.sqrt(1.1 * 1.3) - 1)
    assert math.isnan(found.std)
    assert math.isnan(found.limits[0])
    assert math.isnan(agreement([], []).bias)


@pytest.mark.parametrize(
    ("first", "second", "words"),
    [([1, 2], [1], "pairs"), ([1, 0], [1, 1], "first must be positive"), ([1.0], [math.inf], "second")],
)
def test_bad_values(first: list, second: list, words: str) -> None:
    with pytest.raises(UncertaintyError, match=words):
        agreement(first, second)
