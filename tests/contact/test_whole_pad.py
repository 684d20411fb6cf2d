"""The whole ellipsoid: its gap, the limit of Hertz theory, counterfaces, the layer over bone, refusals."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from fingerpad.contact import Tissue, hertz_contact, solve_contact
from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Counterface, Ellipsoid, Paraboloid, Placement
from fingerpad.geometry.ellipsoid import tangents
from fingerpad.geometry.placement import platen_normal

PAD = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
PLACEMENT = Placement(PAD, wedge_angle=np.radians(45), roll_angle=np.radians(10))
SOFT = Tissue.of_reduced_modulus(0.1365)


@settings(max_examples=40)
@given(st.floats(0, 1.5), st.floats(-1, 1), st.floats(-2, 2), st.floats(-2, 2))
def test_gap_ends_on_ellipsoid(wedge: float, roll: float, along: float, across: float) -> None:
    placement = Placement(PAD, wedge_angle=wedge, roll_angle=roll)
    normal, height = placement.normal, placement.gap.height
    gap = height(np.array([along, 0.0]), np.array([across, 0.0]))
    assert gap[0] >= -1e-12
    assert abs(gap[1]) < 1e-12
    plane = np.array([along, across]) @ np.stack(tangents(normal))
    end = PAD.contact_point(normal) + plane - gap[0] * normal
    assert_allclose(np.sum((end / PAD.semi_axes) ** 2), 1, atol=1e-9)
    first, second = PAD.curvature_at_normal(normal).principal_directions
    small = height(np.array([1e-3, 0.0]), np.array([0.0, 1e-3]))
    tilted = np.stack([first, second]) @ np.stack(tangents(normal)).T  # the plate's axes are not principal
    curvatures = 1 / np.array(PAD.curvature_at_normal(normal).principal_radii)
    assert_allclose(small, 0.5e-6 * curvatures @ tilted**2, rtol=2e-3)


def test_gap_nan_beyond_silhouettes() -> None:
    far, near = np.array([11.0, 3.0]), np.zeros(2)

    def missing(counterface: Counterface | None) -> list[bool]:
        ball = Placement(Ellipsoid(10, 10, 10), wedge_angle=0.0, counterface=counterface)
        return np.isnan(ball.gap.height(far, near)).tolist()

    assert missing(None) == [True, False]
    assert missing(Counterface.sphere(2.0)) == [True, True]
    assert missing(Counterface.cylinder(2.0, axis_angle=0.0)) == [True, False]


@pytest.mark.parametrize(
    "counterface",
    [
        Counterface.sphere(20.0),
        Counterface.cylinder(15.0, axis_angle=0.0),
        Counterface.cylinder(6.0, axis_angle=0.7),
    ],
)
def test_small_contacts_with_curved_bodies_equal_hertz(counterface: Counterface) -> None:
    placement = Placement(PAD, wedge_angle=0.5, counterface=counterface)
    tissue = Tissue.of_reduced_modulus(0.1)
    found = solve_contact(placement, tissue, load=1e-4, points=128)
    hertz = hertz_contact(placement, tissue, load=1e-4)
    curvature = np.diag(1 / np.array(PAD.curvature_at_normal(platen_normal(0.5, 0.0)).principal_radii))
    angle = counterface.axis_angle
    across = np.eye(2) if angle is None else np.outer(*2 * [[-math.sin(angle), math.cos(angle)]])
    values, vectors = np.linalg.eigh(curvature + across / counterface.radius)
    expected = hertz_contact(Paraboloid(*(1 / values)), tissue, load=1e-4)
    assert_allclose(hertz.semi_major, expected.semi_major, rtol=1e-12)
    assert_allclose(found.semi_major, expected.semi_major, rtol=1e-3)
    assert_allclose(found.semi_minor, expected.semi_minor, rtol=1e-3)
    assert_allclose(found.indentation, expected.indentation, rtol=1e-3)
    direction = math.cos(found.long_axis_angle), math.sin(found.long_axis_angle)
    assert_allclose(abs(np.dot(direction, vectors[:, 0])), 1, rtol=1e-4)


@pytest.mark.parametrize("thickness", [math.inf, 8.0])
def test_error_estimate_bounds_refinement(thickness: float) -> None:
    tissue = Tissue.of_reduced_modulus(0.1365, thickness=thickness)
    coarse, fine = (solve_contact(PLACEMENT, tissue, load=2.0, points=points) for points in (96, 256))
    assert abs(coarse.area / fine.area - 1) < coarse.relative_error < 5e-3
    assert abs(coarse.indentation / fine.indentation - 1) < 0.1 * coarse.relative_error
    assert fine.relative_error < 1e-3


def test_one_contact_at_a_time() -> None:
    two = Placement(PAD, wedge_angle=np.radians([30, 45]))
    for placement, tissue in ((two, SOFT), (two[0], Tissue([0.1, 0.2]))):
        with pytest.raises(GeometryError, match=r"one contact is solved at a time.*place\[0\]"):
            solve_contact(placement, tissue, load=1.0)
    with pytest.raises(GeometryError, match=r"load of shape \(2,\): loop over them"):
        solve_contact(PLACEMENT, SOFT, load=[1.0, 2.0])
    one = Placement(PAD, wedge_angle=np.radians(45))
    solved = [solve_contact(each, SOFT, load=1.0, points=64).area for each in (two[1], one)]
    assert solved[0] == solved[1]


def test_a_load_that_flattens_the_pad_is_refused() -> None:
    with pytest.raises(GeometryError, match="load would flatten the pad to its silhouette"):
        solve_contact(PLACEMENT, SOFT, load=2000.0, points=64)
