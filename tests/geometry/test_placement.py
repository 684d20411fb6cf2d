"""Placement on the wedge: printed reference numbers, limits, and symmetry under roll."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Counterface, Ellipsoid, Placement

PAD = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)


@pytest.mark.parametrize(
    ("axes", "wedge", "u", "in_plane", "transverse", "mean", "geometric"),
    [
        ((7.9, 13.8, 11.8), 30, 45.243495, 12.955, 14.330, 13.607666, 13.625),
        ((7.9, 13.8, 11.8), 45, 60.210426, 8.361, 12.384, 9.982357, 10.175),
        ((7.5, 14.7, 11.8), 30, 48.532988, 12.880, 14.196, 13.506019, 13.522),
        ((7.5, 14.7, 11.8), 45, 62.969140, 7.650, 11.932, 9.322567, 9.554),
    ],
)
def test_reference_numbers(axes, wedge, u, in_plane, transverse, mean, geometric) -> None:
    placement = Placement(Ellipsoid(*axes), wedge_angle=np.radians(wedge))
    curvature = placement.curvature
    assert_allclose(np.degrees(placement.u), u, atol=5e-7)
    assert_allclose(np.degrees(placement.v), 90, rtol=1e-15)
    assert_allclose(
        [curvature.in_plane_radius, curvature.transverse_radius], [in_plane, transverse], atol=6e-4
    )
    assert_allclose(curvature.mean_curvature_radius, mean, atol=6e-7)
    assert_allclose(curvature.geometric_mean_radius, geometric, atol=6e-4)


def test_roll_by_right_angle() -> None:
    placement = Placement(PAD, wedge_angle=0.0, roll_angle=np.pi / 2)
    assert_allclose(placement.point, [0, 0, 11.8], atol=1e-14)
    assert_allclose(placement.v, 0, atol=1e-15)


@given(st.floats(0, np.pi / 2), st.floats(-1.5, 1.5))
def test_roll_symmetry_and_tangency(wedge: float, roll: float) -> None:
    left, right = (Placement(PAD, wedge_angle=wedge, roll_angle=side * roll) for side in (-1, 1))
    assert_allclose(left.curvature.principal_radii, right.curvature.principal_radii, rtol=1e-12)
    assert_allclose(left.point, right.point * [1, 1, -1], atol=1e-12)
    assert_allclose(np.linalg.norm(right.normal), 1, rtol=1e-14)
    assert_allclose(right.normal[1], np.sin(wedge), rtol=1e-14)  # rolling does not change the wedge's angle
    # The platen touches at one point only: no other point of the pad lies further out.
    u, v = np.meshgrid(np.linspace(-np.pi, np.pi, 40), np.linspace(0, np.pi, 20))
    assert (PAD.point(u, v) @ right.normal).max() <= right.point @ right.normal + 1e-12


@pytest.mark.parametrize("bad", [-1e-9, np.radians(90.001), np.nan, np.inf])
def test_invalid_wedge_angle(bad: float) -> None:
    with pytest.raises(GeometryError, match="wedge_angle must be (finite|between 0 and π/2 .*), found"):
        Placement(PAD, wedge_angle=bad)


@pytest.mark.parametrize("bad", [np.nan, -np.inf])
def test_invalid_roll_angle(bad: float) -> None:
    with pytest.raises(GeometryError, match="roll_angle must be"):
        Placement(PAD, wedge_angle=0.5, roll_angle=bad)


def test_placement_needs_an_ellipsoid() -> None:
    with pytest.raises(GeometryError, match="ellipsoid must be an Ellipsoid, found tuple"):
        Placement((7.9, 13.8, 11.8), wedge_angle=0.5)


def test_a_sphere_adds_its_curvature_in_each_direction() -> None:
    flat = Placement(PAD, wedge_angle=0.5, roll_angle=0.3).gap
    against = Placement(PAD, wedge_angle=0.5, roll_angle=0.3, counterface=Counterface.sphere(20.0)).gap
    found = sorted([1 / against.first_radius, 1 / against.second_radius])
    assert_allclose(found, sorted([1 / flat.first_radius + 1 / 20, 1 / flat.second_radius + 1 / 20]))
