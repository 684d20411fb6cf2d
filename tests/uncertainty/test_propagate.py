"""First-order propagation against closed forms and a Monte Carlo of its own."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from fingerpad.uncertainty import PAD_INPUTS, PAD_OUTPUTS, first_order, pad_model


@given(st.lists(st.floats(-5, 5), min_size=6, max_size=6), st.floats(0.01, 2))
def test_linear_models_are_exact(entries: list[float], scale: float) -> None:
    matrix = np.reshape(entries, (2, 3))
    covariance = scale * np.array([[1.0, 0.3, 0.0], [0.3, 2.0, -0.5], [0.0, -0.5, 1.5]])
    result = first_order(lambda x: x @ matrix.T, [1.0, -2.0, 0.0], covariance)
    assert_allclose(result.covariance, matrix @ covariance @ matrix.T, atol=1e-7)
    assert_allclose(result.jacobian, matrix, atol=1e-8)


def test_products_add_relative_variances() -> None:
    mean = np.array([3.0, 0.2, 50.0])
    relative = np.array([0.01, 0.02, 0.03])
    result = first_order(lambda x: x.prod(-1, keepdims=True), mean, np.diag((relative * mean) ** 2))
    assert_allclose(result.std[0] / result.value[0], np.sqrt(np.sum(relative**2)), rtol=1e-9)


def test_many_at_once_equal_one_by_one() -> None:
    rng = np.random.default_rng(3)
    means = np.array([7.9, 13.8, 11.8, 0.5, 0.1, 2.0, 7.4, 5.0]) * rng.uniform(0.95, 1.05, (5, 8))
    covariances = np.stack([np.diag(rng.uniform(1e-4, 1e-2, 8)) for _ in range(5)])
    together = first_order(pad_model, means, covariances)
    for index in range(5):
        alone = first_order(pad_model, means[index], covariances[index])
        assert_allclose(together.covariance[index], alone.covariance, rtol=1e-12)


def test_pad_agrees_with_monte_carlo() -> None:
    mean = np.array([7.9, 13.8, 11.8, np.radians(30), 0.05, 2.0, 7.4, 5.0])
    std = np.array([0.1, 0.12, 0.08, np.radians(0.5), np.radians(1), 0.02, 0.1, 0.08])
    correlation = np.eye(8)
    correlation[6, 7] = correlation[7, 6] = 0.6
    covariance = correlation * np.outer(std, std)
    draws = np.random.default_rng(11).multivariate_normal(mean, covariance, 100_000)
    expected = pad_model(draws).std(axis=0)
    assert_allclose(first_order(pad_model, mean, covariance).std, expected, rtol=0.02)


@pytest.mark.parametrize("shape", [(), (4,), (2, 3)])
def test_model_broadcasts(shape: tuple[int, ...]) -> None:
    inputs = np.broadcast_to([7.9, 13.8, 11.8, 0.5, 0.0, 2.0, 7.4, 5.0], (*shape, len(PAD_INPUTS)))
    assert pad_model(inputs).shape == (*shape, len(PAD_OUTPUTS))


def test_near_circle_is_differentiable() -> None:
    mean = np.array([7.9, 13.8, 11.8, 0.5, 0.0, 2.0, 5.0, 5.0])
    result = first_order(pad_model, mean, np.diag(np.full(8, 1e-4)))
    assert np.isfinite(result.std).all()
