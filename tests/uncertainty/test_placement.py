"""The place of contact as a model, against the geometry itself and against simulation."""

import numpy as np
import pytest

from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.uncertainty import placement_model


@pytest.mark.parametrize("wedge_deg", [0.0, 30.0, 60.0, 90.0])
@pytest.mark.parametrize("roll_deg", [-40.0, 0.0, 25.0])
def test_equals_placement(wedge_deg, roll_deg):
    axes = {"palmar": 7.9, "distal": 13.8, "radial_ulnar": 11.8}
    angles = {"wedge_angle": np.radians(wedge_deg), "roll_angle": np.radians(roll_deg)}
    found = placement_model(**axes, **angles)
    placement = Placement(Ellipsoid(**axes), **angles)
    for name in found.keys() - {"u"}:
        assert found[name] == pytest.approx(float(getattr(placement.curvature, name)))
    assert found["u"] == pytest.approx(float(placement.u))
