"""Objects of the `uncertainties` package in and out: its own propagation is a second implementation."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fingerpad.exceptions import UncertaintyError
from fingerpad.uncertainty import correlated_values, mean_and_covariance, propagate

uncertainties = pytest.importorskip("uncertainties")


def test_propagation_agrees_with_the_package() -> None:
    scale = uncertainties.ufloat(1.0, 0.02)
    axes = [7.4 * scale + uncertainties.ufloat(0, 0.05), 5.0 * scale]
    mean, covariance = mean_and_covariance([*axes, 2.0])
    pressure = propagate(lambda x: (x[..., 2] / (np.pi * x[..., 0] * x[..., 1]))[..., None], mean, covariance)
    expected = 2.0 / (np.pi * axes[0] * axes[1])
    assert_allclose(pressure.value[0], expected.nominal_value)
    assert_allclose(np.abs(pressure.jacobian[0] @ covariance @ pressure.jacobian[0]) ** 0.5, expected.std_dev)


def test_there_and_back() -> None:
    value, covariance = np.array([13.8, 2.1]), np.array([[0.04, 0.01], [0.01, 0.02]])
    mean, again = mean_and_covariance(correlated_values(value, covariance))
    assert_allclose(mean, value)
    assert_allclose(again, covariance)


def test_plain_numbers_are_exact() -> None:
    mean, covariance = mean_and_covariance([1, 2.5])
    assert_allclose(mean, [1, 2.5])
    assert not covariance.any()


def test_refuses_what_does_not_fit() -> None:
    with pytest.raises(UncertaintyError, match="do not fit"):
        correlated_values([1.0, 2.0, 3.0], np.eye(2))
