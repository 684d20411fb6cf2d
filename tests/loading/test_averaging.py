"""One quantity by several models: weights, and what their disagreement adds."""

import math

import numpy as np
import pytest

from fingerpad import Estimate
from fingerpad.loading.rivals import akaike_weights, average_models


def test_akaike_weights_fall_by_exp_of_half_the_difference() -> None:
    weights = akaike_weights([100.0, 102.0, math.inf])
    assert sum(weights) == pytest.approx(1)
    assert weights[1] / weights[0] == pytest.approx(math.exp(-1))
    assert weights[2] == 0


def test_mean_variance_and_interval_are_those_of_the_mixture() -> None:
    models = [Estimate.symmetric(40.0, 1.0), Estimate.symmetric(44.0, 2.0), Estimate.symmetric(30.0, 0.5)]
    weights = [0.5, 0.3, 0.2]
    rng = np.random.default_rng(1)
    drawn = np.concatenate(
        [rng.normal(one.value, one.std, int(400_000 * w)) for one, w in zip(models, weights, strict=True)]
    )
    found = average_models(models, weights)
    assert (found.value, found.std) == pytest.approx((drawn.mean(), drawn.std()), rel=0.005)
    assert (found.lower, found.upper) == pytest.approx(tuple(np.quantile(drawn, [0.025, 0.975])), rel=0.003)
    stated = average_models(models, weights, value=40.0)
    assert stated.value == 40.0
    assert stated.std == pytest.approx(math.hypot(found.std, found.value - 40.0))


def test_an_interval_holds_the_stated_value_where_its_model_has_no_weight() -> None:
    found = average_models(
        [Estimate.symmetric(40.0, 1.0), Estimate.symmetric(60.0, 1.0)], [0.0, 1.0], value=40.0
    )
    assert (found.lower, found.value) == (40.0, 40.0)
    assert found.upper == pytest.approx(61.96, abs=0.01)
    assert found.std == pytest.approx(math.hypot(20.0, 1.0))


def test_an_end_is_open_where_a_model_of_weight_leaves_it_open() -> None:
    closed = Estimate.symmetric(8.0, 1.0)
    unbounded = Estimate(value=12.0, std=4.0, interval=(6.0, math.inf))
    assert average_models([closed, unbounded], [0.9, 0.1]).upper == math.inf
    assert average_models([closed, unbounded], [0.99, 0.01]).upper < 12
    assert average_models([closed, unbounded], [0.9, 0.1]).lower == pytest.approx(6.0, abs=0.2)


def test_exact_models_are_averaged() -> None:
    found = average_models([Estimate.symmetric(2.0, 0.0), Estimate.symmetric(4.0, 0.0)], [0.5, 0.5])
    assert (found.value, found.std) == (3.0, 1.0)
    assert (found.lower, found.upper) == pytest.approx((2.0, 4.0))
