"""Pooling: textbook cases, invariants, and what must not average away."""

from typing import Any

import numpy as np
import pytest
import scipy
from numpy.testing import assert_allclose

from fingerpad.uncertainty import SharedErrors, pool, pool_random_effects, proportional_stds


def test_weights_are_inverse_variances() -> None:
    pooled = pool([10.0, 13.0], [1.0, 0.5])
    assert_allclose(pooled.weights, [0.2, 0.8])
    assert_allclose(pooled.value, 12.4)
    assert_allclose(pooled.birge_ratio, 3 / np.hypot(1.0, 0.5))
    assert_allclose(pooled.std, pooled.birge_ratio / np.sqrt(1 / 1.0 + 1 / 0.25))


def test_exact_and_tiny_uncertainties() -> None:
    pooled = pool([1.0, 2.0], [0.0, 0.1])
    assert pooled.value == pytest.approx(1.0)
    assert np.isfinite(pooled.std)
    assert pool([1.0, 1.0], [1e-200, 1.0]).value == 1.0
    exact = pool([1.0, 2.0], [0.0, 0.0])  # which weigh the same, however far apart
    assert (exact.value, exact.std) == pytest.approx((1.5, 0.5))


@pytest.mark.parametrize("seed", range(4))
def test_random_effects_agree_with_statsmodels(seed: int) -> None:
    rng = np.random.default_rng(seed)
    stds = rng.uniform(0.1, 0.6, 7)
    values = 14 + rng.normal(0, 1.0, 7) + stds * rng.normal(size=7)
    ours = pool_random_effects(values, stds)
    analysis = pytest.importorskip("statsmodels.stats.meta_analysis")
    theirs = analysis.combine_effects(values, stds**2, method_re="iterated", use_t=True, atol=1e-12)
    assert ours.between_std > 0
    assert_allclose(ours.between_std**2, theirs.tau2, rtol=1e-6)
    assert_allclose(ours.value, theirs.mean_effect_re, rtol=1e-8)
    assert_allclose(ours.std, theirs.sd_eff_w_re_hksj, rtol=1e-6)
    assert_allclose(ours.interval, theirs.conf_int()[3], rtol=1e-6)


def test_random_effects_without_excess_scatter() -> None:
    values, stds = [10.0, 10.01, 9.99], [0.5, 0.4, 0.6]
    random, fixed = pool_random_effects(values, stds), pool(values, stds)
    assert random.between_std == 0
    assert_allclose((random.value, random.std), (fixed.value, fixed.std))


@pytest.mark.parametrize("seed", range(3))
def test_shared_errors_equal_matrix(seed: int) -> None:
    rng = np.random.default_rng(seed)
    values, stds, parts = rng.normal(20, 1, 7), rng.uniform(0.1, 0.6, 7), rng.normal(0, 0.3, (7, 3))
    groups = np.column_stack([np.zeros(7, dtype=int), [0, 0, 1, 1, 1, 2, 0], np.arange(7)])
    matrix = np.array(
        [[np.sum(parts[i] * parts[j] * (groups[i] == groups[j])) for j in range(7)] for i in range(7)]
    )
    shared = SharedErrors(sources=("axes", "scale", "axes"), parts=parts, groups=groups)
    for way in (pool, pool_random_effects):
        one, other = way(values, stds, shared), way(values, stds, matrix)
        assert_allclose(one.total_std, other.total_std, rtol=1e-12)
        assert one.total_std > one.std
    half = np.hypot(scipy.stats.t.ppf(0.975, 6) * one.std, 1.959964 * np.sqrt(one.total_std**2 - one.std**2))
    assert_allclose(one.interval, [one.value - half, one.value + half], rtol=1e-7)
    variances = shared.variances(np.eye(7)[2])
    assert variances == pytest.approx(
        {"axes": parts[2, 0] ** 2 + parts[2, 2] ** 2, "scale": parts[2, 1] ** 2}
    )


def test_memory_with_100_000_estimates() -> None:
    count = 100_000  # whose matrix would take 80 GB
    parts = np.full((count, 1), 0.2)
    shared = SharedErrors(sources=("wedge",), parts=parts, groups=np.zeros((1, 1), int))
    pooled = pool(np.full(count, 5.0), np.full(count, 0.1), shared)
    assert_allclose(pooled.total_std, np.hypot(0.1 / np.sqrt(count), 0.2))
    assert pool(np.full(count, 5.0), np.full(count, 0.1)).count == count


@pytest.mark.parametrize("values", [(10.0, 10.4, 11.0), (8.0, 12.0, 16.0)])
def test_proportional_stds_at_mean(values: Any) -> None:
    relative = np.array([0.02, 0.05, 0.03])
    stds = proportional_stds(values, relative * values)
    pooled = pool(values, stds)
    assert_allclose(stds, relative * pooled.value, rtol=1e-14)
    assert_allclose(pooled.value, np.average(values, weights=relative**-2.0), rtol=1e-14)


def test_proportional_stds_of_nonpositive_values() -> None:
    assert_allclose(proportional_stds([-1.0, 0.0, 2.0], [0.5, 0.5, 1.0]), [0.5, 0.5, 1.0])
