"""First-order propagation against closed forms and a Monte Carlo of its own."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from fingerpad.exceptions import UncertaintyError
from fingerpad.uncertainty import PAD_INPUTS, PAD_OUTPUTS, pad_model, propagate


@given(st.lists(st.floats(-5, 5), min_size=6, max_size=6), st.floats(0.01, 2))
def test_linear_models_are_exact(entries: list[float], scale: float) -> None:
    matrix = np.reshape(entries, (2, 3))
    covariance = scale * np.array([[1.0, 0.3, 0.0], [0.3, 2.0, -0.5], [0.0, -0.5, 1.5]])
    result = propagate(lambda x: x @ matrix.T, [1.0, -2.0, 0.0], covariance)
    assert_allclose(result.covariance, matrix @ covariance @ matrix.T, atol=1e-7)
    assert_allclose(result.jacobian, matrix, atol=1e-8)


def test_products_add_relative_variances() -> None:
    mean = np.array([3.0, 0.2, 50.0])
    relative = np.array([0.01, 0.02, 0.03])
    result = propagate(lambda x: x.prod(-1, keepdims=True), mean, np.diag((relative * mean) ** 2))
    assert_allclose(result.std[0] / result.value[0], np.sqrt(np.sum(relative**2)), rtol=1e-9)


def test_many_at_once_equal_one_by_one() -> None:
    rng = np.random.default_rng(3)
    means = np.array([7.9, 13.8, 11.8, 0.5, 0.1, 0.5, 1.0, 2.0, 6.08, 0.39]) * rng.uniform(
        0.95, 1.05, (5, 10)
    )
    covariances = np.stack([np.diag(rng.uniform(1e-4, 1e-2, 10)) for _ in range(5)])
    together = propagate(pad_model, means, covariances)
    for index in range(5):
        alone = propagate(pad_model, means[index], covariances[index])
        assert_allclose(together.covariance[index], alone.covariance, rtol=1e-10, atol=1e-14)


def test_pad_agrees_with_monte_carlo() -> None:
    mean = np.array([7.9, 13.8, 11.8, np.radians(30), 0.05, 0.5, 1.0, 2.0, 6.08, 0.39])
    std = np.array([0.1, 0.12, 0.08, np.radians(0.5), np.radians(1), 0.01, 0.01, 0.02, 0.07, 0.02])
    correlation = np.eye(10)
    correlation[8, 9] = correlation[9, 8] = 0.6
    covariance = correlation * np.outer(std, std)
    draws = np.random.default_rng(11).multivariate_normal(mean, covariance, 100_000)
    expected = pad_model(draws).std(axis=0)
    assert_allclose(propagate(pad_model, mean, covariance).std, expected, rtol=0.02)


@pytest.mark.parametrize("shape", [(), (4,), (2, 3)])
def test_model_broadcasts(shape: tuple[int, ...]) -> None:
    inputs = np.broadcast_to(
        [7.9, 13.8, 11.8, 0.5, 0.0, 0.5, 1.0, 2.0, 6.08, 0.39], (*shape, len(PAD_INPUTS))
    )
    assert pad_model(inputs).shape == (*shape, len(PAD_OUTPUTS))


def test_flat_outputs_take_the_second_order() -> None:
    # z² of a standard normal z has variance 2; z₁² + z₂² twice that.
    result = propagate(lambda x: (x**2).sum(-1, keepdims=True), [0.0, 0.0], np.eye(2))
    assert_allclose(result.std, 2.0, rtol=1e-9)


@pytest.mark.parametrize("elongation", [0.0, 0.01, 0.05])
def test_corrected_radius_of_a_circular_contact(elongation: float) -> None:
    mean = np.array([7.9, 13.8, 11.8, 0.5, 0.0, 0.5, 1.0, 2.0, 5.0, elongation])
    covariance = np.zeros((10, 10))
    covariance[9, 9] = 0.0283**2  # axes of 5 mm, each to 0.1 mm
    draws = np.tile(mean, (200_000, 1))
    draws[:, 9] += np.random.default_rng(2).normal(0, 0.0283, 200_000)
    column = PAD_OUTPUTS.index("radius_from_indentation")
    expected = pad_model(draws)[:, column].std()
    assert_allclose(propagate(pad_model, mean, covariance).std[column], expected, rtol=0.02)


def test_upright_finger_feels_the_wedge_angle() -> None:
    mean = np.array([7.9, 13.8, 11.8, 0.0, 0.0, 0.5, 1.0, 2.0, 5.0, 0.2])
    covariance = np.diag([0, 0, 0, np.radians(2) ** 2, np.radians(2) ** 2, 0, 0, 0, 0, 0])
    draws = np.random.default_rng(4).multivariate_normal(mean, covariance, 100_000)
    column = PAD_OUTPUTS.index("mean_curvature_radius")
    expected = pad_model(draws)[:, column].std()
    assert_allclose(propagate(pad_model, mean, covariance).std[column], expected, rtol=0.03)


def test_near_circle_is_differentiable() -> None:
    mean = np.array([7.9, 13.8, 11.8, 0.5, 0.0, 0.5, 1.0, 2.0, 5.0, 0.0])
    result = propagate(pad_model, mean, np.diag(np.full(10, 1e-4)))
    assert np.isfinite(result.std).all()


@pytest.mark.parametrize(
    "mean",
    [
        [7.9, 13.8, 11.8, np.radians(30), 0.05, 0.5, 1.0, 2.0, 6.08, 0.39],
        [7.9, 13.8, 11.8, 0.0, 0.0, 0.5, 1.0, 2.0, 5.0, 0.2],  # flat on the platen
        [7.9, 13.8, 11.8, np.pi / 2, 0.0, 0.5, 1.0, 2.0, 5.0, 0.0],  # on the tip, a circular contact
    ],
)
def test_derivatives_agree_with_differences(mean: list[float]) -> None:
    jacobian = propagate(pad_model, mean, np.eye(10) * 1e-6).jacobian
    for column in range(10):
        step = 1e-4 * np.eye(10)[column]
        outer = pad_model(mean + 2 * step) - pad_model(mean - 2 * step)
        inner = pad_model(mean + step) - pad_model(mean - step)
        assert_allclose(jacobian[:, column], (8 * inner - outer) / 12e-4, rtol=1e-8, atol=1e-9)


def test_refuses_models_that_drop_the_complex_step() -> None:
    with pytest.raises(UncertaintyError, match="real numbers for complex steps"):
        propagate(np.abs, [1.0], [[1.0]])
