"""Young's modulus of a pad on a layer of tissue: limits, the solver, and what takes it out of the range."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fingerpad.contact import Tissue, fast_contact, youngs_modulus
from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Ellipsoid, Placement

PLACEMENT = Placement(
    Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8),
    wedge_angle=np.radians(30.0),
    roll_angle=np.radians(8.0),
)


@pytest.mark.parametrize("thickness", [8.0, math.inf])
def test_inverts_the_fast_laws(thickness) -> None:
    pressed = fast_contact(PLACEMENT, Tissue(0.07, 0.48, thickness), load=[0.5, 1.5])
    for name in ("area", "indentation"):
        given = {name: getattr(pressed, name)}
        found = youngs_modulus(PLACEMENT, load=[0.5, 1.5], thickness=thickness, poisson_ratio=0.48, **given)
        assert_allclose(found, 0.07, rtol=3e-5)


def test_bone_lowers_the_modulus_and_raises_the_loading_radius() -> None:
    thickness = np.array([4.0, 6, 8, 12, math.inf])
    found = youngs_modulus(PLACEMENT, load=2.0, area=110.0, thickness=thickness)
    assert (np.diff(found) > 0).all()
    contact = fast_contact(PLACEMENT, Tissue(found, thickness=thickness), load=2.0)
    assert (np.diff(contact.area_over_pi_indentation) < 0).all()


@pytest.mark.parametrize(
    ("change", "flag"),
    [
        ({}, ""),
        ({"area": 0.0}, "no_contact"),
        ({"area": math.nan}, "no_contact"),
        ({"area": 300.0}, "contact_too_wide"),
        ({"thickness": 1.0}, "layer_too_thin"),
        ({"poisson_ratio": 0.2}, "poisson_ratio_out_of_range"),
    ],
)
def test_nan_where_the_laws_say_why(change, flag) -> None:
    given = {"thickness": 8.0, "area": 110.0, "poisson_ratio": 0.5} | change
    assert all(math.isnan(youngs_modulus(PLACEMENT, load=load, **given)) for load in (0.0, -1.0, math.nan))
    assert math.isnan(youngs_modulus(PLACEMENT, load=2.0, **given)) == bool(flag)
    area = given.pop("area")
    assert fast_contact(PLACEMENT, Tissue(1.0, **given), area=area).flags == flag


def test_impossible_arguments() -> None:
    for given in ({}, {"area": 110.0, "indentation": 2.0}):
        with pytest.raises(GeometryError, match="exactly one"):
            youngs_modulus(PLACEMENT, thickness=8.0, load=2.0, **given)
    with pytest.raises(GeometryError, match="thickness must be positive, found -8"):
        youngs_modulus(PLACEMENT, thickness=-8.0, load=2.0, area=110.0)
