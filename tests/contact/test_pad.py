"""From an observed ellipse to radii, indentation and modulus."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from fingerpad.contact import HertzGeometry, hertz_contact, pad_contact, youngs_modulus
from fingerpad.geometry import Ellipsoid, Placement

PAD = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)


@given(st.floats(0, 1.5), st.floats(-1, 1), st.floats(0.1, 5), st.floats(0.02, 0.5))
def test_hertzian_pad_round_trip(wedge: float, roll: float, load: float, modulus: float) -> None:
    radii = Placement(PAD, wedge_angle=wedge, roll_angle=roll).curvature.principal_radii
    geometry = HertzGeometry(*radii)
    truth = geometry.under_load(load, reduced_modulus=modulus)
    seen = pad_contact(
        PAD,
        wedge_angle=wedge,
        roll_angle=roll,
        load=load,
        semi_major=truth.semi_major,
        semi_minor=truth.semi_minor,
    )
    assert_allclose(seen.indentation, truth.indentation, rtol=1e-12)
    assert_allclose(seen.reduced_modulus, modulus, rtol=1e-12)
    assert_allclose(seen.mean_pressure, truth.mean_pressure, rtol=1e-12)
    ratio = np.exp(np.abs(seen.predicted_elongation))
    assert_allclose(ratio, truth.semi_major / truth.semi_minor, rtol=1e-12)
    if geometry.long_axis == 0:
        assert seen.predicted_elongation > 0
    assert_allclose(
        seen.geometric_radius_from_compliance, truth.area / (np.pi * truth.indentation), rtol=1e-12
    )


@pytest.mark.parametrize(
    "wedges", [30.0, [30.0], [30.0, 45.0], [10.0, 20.0, 30.0], [[0.0, 30.0], [45.0, 60.0]], np.zeros((3, 0))]
)
def test_contacts_of_many_placements_are_those_of_each(wedges) -> None:
    """Principal radii unpack into two arguments, whatever the shape of the angles: two are the trap."""
    angles = np.radians(wedges)
    radii = Placement(PAD, wedge_angle=angles).curvature.principal_radii
    area = hertz_contact(*radii, 2.0, reduced_modulus=0.1365).area
    each = [
        hertz_contact(*Placement(PAD, wedge_angle=one).curvature.principal_radii, 2.0, reduced_modulus=0.1365)
        for one in np.ravel(angles)
    ]
    assert np.shape(area) == np.shape(angles)
    assert_allclose(np.ravel(area), [one.area for one in each], rtol=1e-14)


def test_areas_of_the_published_pad_at_two_angles() -> None:
    radii = Placement(PAD, wedge_angle=np.radians([30, 45])).curvature.principal_radii
    area = hertz_contact(*radii, 2.0, reduced_modulus=0.1365).area
    assert_allclose(area, [88.56, 72.61], atol=0.01)


def test_published_values_at_2_N() -> None:
    # Hertz values from the printed areas and R_g, ν = 0.5: the spheres of radius R_g as pads.
    for radius, area, depth, modulus, pressure in (
        (20.5, 116.3, 1.806, 102.4, 17.2),
        (14.5, 69.4, 1.523, 157.1, 28.8),
    ):
        circle = np.sqrt(area / np.pi)
        seen = pad_contact(
            Ellipsoid(radius, radius, radius),
            wedge_angle=0.5,
            roll_angle=0.0,
            load=2.0,
            semi_major=circle,
            semi_minor=circle,
        )
        assert_allclose(seen.indentation, depth, atol=6e-4)
        assert_allclose(1e3 * youngs_modulus(seen.reduced_modulus), modulus, atol=0.06)
        assert_allclose(1e3 * seen.mean_pressure, pressure, atol=0.06)


def test_predicted_long_axis_of_published_pad() -> None:
    seen = pad_contact(
        PAD, wedge_angle=np.radians([30, 45]), roll_angle=0, load=2, semi_major=7.4, semi_minor=5.0
    )
    assert_allclose(seen.predicted_elongation, -np.log([1.0696, 1.2991]), atol=1e-4)


def test_order_of_observed_axes() -> None:
    straight, swapped = (
        pad_contact(PAD, wedge_angle=0.5, roll_angle=0, load=2, semi_major=a, semi_minor=b)
        for a, b in ((7.4, 5.0), (5.0, 7.4))
    )
    assert straight.radius_from_indentation == swapped.radius_from_indentation
    assert straight.indentation == swapped.indentation
