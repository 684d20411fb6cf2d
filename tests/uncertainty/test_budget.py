"""Variance shares and Sobol indices: closed forms, SciPy's estimator, and what is refused."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import stats

from fingerpad.exceptions import UncertaintyError
from fingerpad.uncertainty import propagate, sobol_indices, variance_shares

GROUPS = {"first": [0], "second and third": [1, 2]}
MATRIX = np.array([[1.0, -2.0, 0.5], [0.0, 1.0, 1.0]])
COVARIANCE = np.array([[2.0, 0.0, 0.0], [0.0, 1.0, 0.6], [0.0, 0.6, 1.5]])


def linear(x: np.ndarray) -> np.ndarray:
    return x @ MATRIX.T


def expected_shares() -> np.ndarray:
    variance = np.diag(MATRIX @ COVARIANCE @ MATRIX.T)
    first = MATRIX[:, 0] ** 2 * 2.0 / variance
    return np.stack([first, 1 - first], axis=-1)


def test_linear_models_have_known_shares() -> None:
    shares = variance_shares(propagate(linear, np.zeros(3), COVARIANCE), COVARIANCE, GROUPS)
    assert_allclose(shares, expected_shares(), rtol=1e-10)


def test_sobol_indices_of_linear_models_are_their_shares() -> None:
    indices = sobol_indices(linear, np.zeros(3), COVARIANCE, GROUPS)
    assert_allclose(indices.first, expected_shares(), atol=0.003)
    assert_allclose(indices.total, expected_shares(), atol=0.003)


def test_shares_sum_to_one_when_inputs_correlate_across_groups() -> None:
    groups = {"first and second": [0, 1], "third": [2]}
    shares = variance_shares(propagate(linear, np.zeros(3), COVARIANCE), COVARIANCE, groups)
    assert_allclose(shares.sum(axis=-1), 1, rtol=1e-12)


def test_agrees_with_scipy_where_inputs_interact() -> None:
    def model(x: np.ndarray) -> np.ndarray:
        return (x[..., 0] + x[..., 1] * x[..., 2] + 0.3 * x[..., 2] ** 3)[..., None]

    ours = sobol_indices(model, np.zeros(3), np.eye(3), {"a": [0], "b": [1], "c": [2]})
    theirs = stats.sobol_indices(
        func=lambda x: model(x.T).T, n=2**14, dists=[stats.norm()] * 3, rng=np.random.default_rng(1)
    )
    assert_allclose(ours.first[0], theirs.first_order, atol=0.03)
    assert_allclose(ours.total[0], theirs.total_order, atol=0.03)
    assert (ours.total[0, 1:] > ours.first[0, 1:] + 0.1).all()


def test_errors_shrink_with_draws() -> None:
    few, many = (sobol_indices(linear, np.zeros(3), COVARIANCE, GROUPS, draws=n) for n in (64, 4096))
    assert many.first_std.max() < few.first_std.max() / 4


@pytest.mark.parametrize(
    ("groups", "options", "message"),
    [
        ({"a": [0, 1], "b": [1, 2]}, {}, "group 'b' holds an input that another group holds"),
        ({"a": [0], "b": [1]}, {}, "input 2 varies and belongs to no group"),
        ({"a": [0, 1], "b": [2]}, {}, "inputs 1 and 2 are correlated but in different groups"),
        (GROUPS, {"draws": 1000}, "power of two, found 1000"),
    ],
)
def test_refuses(groups: dict[str, list[int]], options: dict[str, int], message: str) -> None:
    with pytest.raises(UncertaintyError, match=message):
        sobol_indices(linear, np.zeros(3), COVARIANCE, groups, **options)
