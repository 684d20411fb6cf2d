"""The place of contact as one function, against the geometry itself and against simulation."""

import numpy as np
import pytest

from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.uncertainty import PLACEMENT_OUTPUTS, placement_model, propagate, run_monte_carlo


@pytest.mark.parametrize("wedge_deg", [0.0, 30.0, 60.0, 90.0])
@pytest.mark.parametrize("roll_deg", [-40.0, 0.0, 25.0])
def test_it_is_the_placement(wedge_deg, roll_deg):
    axes, wedge, roll = (7.9, 13.8, 11.8), np.radians(wedge_deg), np.radians(roll_deg)
    found = dict(zip(PLACEMENT_OUTPUTS, placement_model(np.array([*axes, wedge, roll])), strict=True))
    placement = Placement(Ellipsoid(*axes), wedge_angle=wedge, roll_angle=roll)
    for name in PLACEMENT_OUTPUTS[:-1]:
        assert found[name] == pytest.approx(float(getattr(placement.curvature, name)))
    assert found["u"] == pytest.approx(float(placement.u))


def test_its_first_order_is_what_simulation_finds():
    mean = np.array([7.9, 13.8, 11.8, np.radians(30), 0.0])
    covariance = np.diag(np.square([0.1, 0.1, 0.1, np.radians(0.5), np.radians(0.5)]))
    first, drawn = (
        propagate(placement_model, mean, covariance),
        run_monte_carlo(placement_model, mean, covariance),
    )
    np.testing.assert_allclose(first.std, drawn.std, rtol=0.02)
