"""A measured indentation by Hertz theory and on a layer, with uncertainty."""

import pytest
from numpy.testing import assert_allclose

from fingerpad.contact import Tissue, fast_contact, hertz_contact, youngs_modulus
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.uncertainty import Inputs, propagate
from fingerpad.uncertainty.models import indentation_model

AXES = {"palmar": 7.9, "distal": 13.8, "radial_ulnar": 11.8}


def pressed(thickness, thickness_std=0.0, contact_shift=0.1) -> Inputs:
    placed = {"wedge_angle": (0.6, 0.01), "roll_angle": 0.0, "poisson_ratio": 0.49}
    lengths = {name: (value, 0.1) for name, value in AXES.items()}
    press = {"load": (2.0, 0.04), "indentation": (1.7, 0.05), "contact_shift": contact_shift}
    return Inputs.of(**lengths, **placed, **press, thickness=(thickness, thickness_std))


def test_moduli_from_a_measured_indentation() -> None:
    found = propagate(indentation_model, pressed(8.0))
    placement = Placement(Ellipsoid(**AXES), wedge_angle=0.6)
    hertz = 2.0 / hertz_contact(placement, Tissue(1.0, 0.49), indentation=1.7).load
    layered = youngs_modulus(placement, load=2.0, indentation=1.8, thickness=8.0, poisson_ratio=0.49)
    contact = fast_contact(placement, Tissue(layered, 0.49, 8.0), indentation=1.8)
    expected = hertz, layered, contact.area_over_pi_indentation
    assert_allclose(found.value, expected, rtol=1e-12)
    assert found.value[1] < 0.6 * found.value[0]
    deep = propagate(indentation_model, pressed(1e4, contact_shift=0.0))
    assert deep.value[1] == pytest.approx(deep.value[0], rel=0.06)  # the true shape alone
