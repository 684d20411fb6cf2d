"""Pooling: textbook cases, invariants, and what must not average away."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from fingerpad.exceptions import FitError
from fingerpad.uncertainty import pool


def test_equal_weights_are_the_mean() -> None:
    pooled = pool([10.0, 10.2, 9.8, 10.0], np.full(4, 0.5))
    assert_allclose(pooled.value, 10.0)
    assert_allclose(pooled.std, 0.25)  # no more scatter than stated: σ/√n
    assert pooled.birge_ratio < 1


def test_birge_ratio_enlarges_what_scatters() -> None:
    values, std = np.array([9.0, 11.0, 10.0]), 0.1
    pooled = pool(values, np.full(3, std))
    assert_allclose(pooled.birge_ratio, values.std(ddof=1) / std)
    assert_allclose(pooled.std, values.std(ddof=1) / np.sqrt(3))


@given(
    st.lists(st.tuples(st.floats(-100, 100), st.floats(0.1, 10)), min_size=1, max_size=8), st.floats(0.1, 9)
)
def test_units_do_not_matter(estimates: list[tuple[float, float]], factor: float) -> None:
    values, stds = np.array(estimates).T
    one, other = pool(values, stds), pool(factor * values, factor * stds)
    assert_allclose(other.value, factor * one.value, rtol=1e-9, atol=1e-9)
    assert_allclose(other.std, factor * one.std, rtol=1e-6)
    assert values.min() - 1e-9 <= one.value <= values.max() + 1e-9


def test_shared_uncertainty_does_not_average_away() -> None:
    many = pool(np.full(1000, 5.0), np.full(1000, 0.1), np.full((1000, 1000), 0.2**2))
    assert many.std < 0.01
    assert_allclose(many.total_std, np.hypot(many.std, 0.2))


def test_one_estimate_is_itself() -> None:
    pooled = pool([5.0], [0.3])
    assert (pooled.value, pooled.std, pooled.count) == (5.0, pytest.approx(0.3), 1)
    assert np.isnan(pooled.birge_ratio)


def test_exact_and_tiny_uncertainties_do_not_overflow() -> None:
    pooled = pool([1.0, 2.0], [0.0, 0.1])
    assert pooled.value == pytest.approx(1.0)
    assert np.isfinite(pooled.std)
    assert pool([1.0, 1.0], [1e-200, 1.0]).value == 1.0


@pytest.mark.parametrize(
    ("values", "stds", "message"),
    [
        ([], [], "no estimates to pool"),
        ([1.0, 2.0], [0.1], "each value needs its standard uncertainty"),
        ([1.0, 2.0], [0.1, np.inf], "standard uncertainty must be finite and not negative, found inf"),
        ([1.0, 2.0], [0.1, -1.0], "found -1 at index 1"),
        ([1.0, np.nan], [0.1, 0.1], "value to pool must be finite, found nan at index 1"),
    ],
)
def test_refuses(values: list[float], stds: list[float], message: str) -> None:
    with pytest.raises(FitError, match=message):
        pool(values, stds)
