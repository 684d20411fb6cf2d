"""The models of pads: an observed ellipse, a measured indentation and a placement, by other routes."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from fingerpad.contact import Tissue, fast_contact, hertz_contact, youngs_modulus
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.uncertainty import Inputs, pad_model, placement_model, propagate
from fingerpad.uncertainty.models import indentation_model

AXES = {"palmar": 7.9, "distal": 13.8, "radial_ulnar": 11.8}


def seen(*, semi_major, semi_minor, axes=AXES, **given) -> SimpleNamespace:
    """Return the outputs of the model for an observed ellipse."""
    return SimpleNamespace(
        **pad_model(
            **axes,
            **{"roll_angle": 0.0, "poisson_ratio": 0.5, "image_scale": 1.0, "edge_offset": 0.0} | given,
            contact_radius=np.sqrt(semi_major * semi_minor),
            elongation=np.log(semi_major / semi_minor),
        )
    )


@given(st.floats(0, 1.5), st.floats(-1, 1), st.floats(0.1, 5), st.floats(0.02, 0.5))
def test_hertzian_pad_round_trip(wedge: float, roll: float, load: float, modulus: float) -> None:
    placement = Placement(Ellipsoid(**AXES), wedge_angle=wedge, roll_angle=roll)
    truth = hertz_contact(placement, Tissue.of_reduced_modulus(modulus), load=load)
    found = seen(
        wedge_angle=wedge,
        roll_angle=roll,
        load=load,
        semi_major=truth.semi_major,
        semi_minor=truth.semi_minor,
    )
    assert_allclose(found.indentation, truth.indentation, rtol=1e-12)
    assert_allclose(found.reduced_modulus, modulus, rtol=1e-12)
    assert_allclose(found.mean_pressure, truth.mean_pressure, rtol=1e-12)
    ratio = np.exp(np.abs(found.predicted_elongation))
    assert_allclose(ratio, truth.semi_major / truth.semi_minor, rtol=1e-12)
    if ratio > 1 + 1e-9:
        assert (found.predicted_elongation > 0) == truth.along
    assert_allclose(
        found.geometric_radius_from_compliance, truth.area / (np.pi * truth.indentation), rtol=1e-12
    )


def test_order_of_observed_axes() -> None:
    straight, swapped = (
        seen(wedge_angle=0.5, load=2.0, semi_major=a, semi_minor=b) for a, b in ((7.4, 5.0), (5.0, 7.4))
    )
    assert straight.radius_from_indentation == pytest.approx(swapped.radius_from_indentation, rel=1e-14)
    assert straight.indentation == pytest.approx(swapped.indentation, rel=1e-14)


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
