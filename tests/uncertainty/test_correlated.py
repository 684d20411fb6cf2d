"""Objects of the `uncertainties` package in and out: its own propagation is a second implementation."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fingerpad.uncertainty import Inputs, correlated_values, inputs_from_ufloats, propagate

uncertainties = pytest.importorskip("uncertainties")


def test_propagation_agrees_with_uncertainties() -> None:
    scale = uncertainties.ufloat(1.0, 0.02)
    axes = [7.4 * scale + uncertainties.ufloat(0, 0.05), 5.0 * scale]
    inputs = inputs_from_ufloats(semi_major=axes[0], load=2.0, semi_minor=axes[1])
    pressure = propagate(
        lambda load, semi_major, semi_minor: {"pressure": load / (np.pi * semi_major * semi_minor)}, inputs
    )
    expected = 2.0 / (np.pi * axes[0] * axes[1])
    assert_allclose(pressure["pressure"].value, expected.nominal_value)
    first_order = pressure.jacobian[0] @ inputs.covariance @ pressure.jacobian[0]
    assert_allclose(np.sqrt(first_order), expected.std_dev)


def test_round_trip() -> None:
    given = Inputs.of(radius=(13.8, 0.2), depth=(2.1, 0.1), correlations={("depth", "radius"): 0.7})
    outputs = propagate(lambda radius, depth: {"radius": radius, "depth": depth}, given)
    again = inputs_from_ufloats(**correlated_values(outputs))
    assert again.names == ("radius", "depth")
    assert_allclose(again.mean, [13.8, 2.1])
    assert_allclose(again.covariance, [[0.04, 0.014], [0.014, 0.01]])
