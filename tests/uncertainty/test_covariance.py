"""What is a covariance and what is not, and its factors."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fingerpad.exceptions import UncertaintyError
from fingerpad.uncertainty import covariance_of, covariance_root


@pytest.mark.parametrize(
    "covariance",
    [
        np.diag([4.0, 0.0, 1e-12]),
        np.ones((2, 2)),  # one input seen twice
        np.array([[1e-12, 1e-3 * 1e-6], [1e-3 * 1e-6, 1e6]]),
        np.zeros((3, 3)),
    ],
)
def test_root_squared_is_matrix(covariance: np.ndarray) -> None:
    factor = covariance_root(covariance_of(covariance))
    assert_allclose(factor @ factor.T, covariance, rtol=1e-9, atol=1e-20)


@pytest.mark.parametrize(
    ("covariance", "message"),
    [
        ([1.0, 2.0], "must be square, found the shape"),
        ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], "must be square"),
        ([[1.0, np.nan], [np.nan, 1.0]], "covariance must be finite, found nan at index 0, 1"),
        ([[1.0, 0.0], [0.0, -0.1]], "variance must be positive or zero, found -0.1 at index 1"),
        ([[1.0, 0.5], [0.4, 1.0]], "covariance must be symmetric, found 0.5 at index 0, 1"),
        ([[1.0, 1.5], [1.5, 1.0]], r"correlation must be within \[-1, 1\], found 1.5"),
        ([[0.0, 0.1], [0.1, 1.0]], r"correlation must be within \[-1, 1\], found inf"),
        (
            [[1.0, 0.9, -0.9], [0.9, 1.0, 0.9], [-0.9, 0.9, 1.0]],
            "smallest eigenvalue of the correlations must be positive or zero",
        ),
    ],
)
def test_invalid_arguments(covariance: list[list[float]], message: str) -> None:
    with pytest.raises(UncertaintyError, match=message):
        covariance_of(covariance)


@pytest.mark.parametrize("below", [1e-7, 1e-3])
def test_negative_eigenvalue_refused(below: float) -> None:
    # Three equal correlations r have the smallest eigenvalue 1 + 2 r.
    correlation = (1.5 + below / 2) * np.eye(3) - (0.5 + below / 2)
    with pytest.raises(UncertaintyError, match="smallest eigenvalue"):
        covariance_of(correlation)


def test_rounding_below_zero_accepted() -> None:
    correlation = (1.5 + 5e-11) * np.eye(3) - (0.5 + 5e-11)
    assert np.linalg.eigvalsh(correlation)[0] < -5e-11
    for scale in (1.0, 1e-12, 1e12):
        assert covariance_of(scale * correlation).shape == (3, 3)


def test_root_of_nonfinite_matrix_is_nan() -> None:
    roots = covariance_root(np.stack([np.eye(2), np.diag([1.0, np.inf]), np.full((2, 2), np.nan)]))
    assert_allclose(roots[0], np.eye(2))
    assert np.isnan(roots[1:]).all()


def test_one_invalid_matrix_of_many() -> None:
    matrices = np.tile(np.eye(2), (4, 1, 1))
    matrices[2, 0, 0] = -1
    with pytest.raises(UncertaintyError, match="at index 2, 0"):
        covariance_of(matrices)
