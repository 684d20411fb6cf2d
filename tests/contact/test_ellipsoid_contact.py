"""The whole ellipsoid: its gap, the limit of Hertz theory, counterfaces, the layer over bone, refusals."""

import math
from functools import partial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from fingerpad.contact import Counterface, EllipsoidContact, HertzGeometry, ellipsoid_gap
from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Ellipsoid, platen_normal
from fingerpad.geometry.ellipsoid import tangents

PAD = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
PLACE = {"wedge_angle": np.radians(45), "roll_angle": np.radians(10)}


@settings(max_examples=40)
@given(st.floats(0, 1.5), st.floats(-1, 1), st.floats(-2, 2), st.floats(-2, 2))
def test_gap_ends_on_ellipsoid(wedge: float, roll: float, along: float, across: float) -> None:
    normal = platen_normal(wedge, roll)
    gap = ellipsoid_gap(PAD, normal, np.array([along, 0.0]), np.array([across, 0.0]))
    assert gap[0] >= -1e-12
    assert abs(gap[1]) < 1e-12
    plane = np.array([along, across]) @ np.stack(tangents(normal))
    end = PAD.contact_point(normal) + plane - gap[0] * normal
    assert_allclose(np.sum((end / PAD.semi_axes) ** 2), 1, atol=1e-9)
    first, second = PAD.curvature_at_normal(normal).principal_directions
    small = ellipsoid_gap(PAD, normal, np.array([1e-3, 0.0]), np.array([0.0, 1e-3]))
    tilted = np.stack([first, second]) @ np.stack(tangents(normal)).T  # the plate's axes are not principal
    curvatures = 1 / np.array(PAD.principal_radii_at_normal(normal))
    assert_allclose(small, 0.5e-6 * curvatures @ tilted**2, rtol=2e-3)


def test_gap_nan_beyond_silhouettes() -> None:
    ball, normal = Ellipsoid(10, 10, 10), np.array([1.0, 0.0, 0.0])
    far, near = np.array([11.0, 3.0]), np.zeros(2)
    assert np.isnan(ellipsoid_gap(ball, normal, far, near)).tolist() == [True, False]
    assert np.isnan(ellipsoid_gap(ball, normal, far, near, Counterface.sphere(2.0))).all()
    along_axis = Counterface.cylinder(2.0, axis_angle=0.0)
    assert np.isnan(ellipsoid_gap(ball, normal, far, near, along_axis)).tolist() == [True, False]


def test_small_contacts_equal_hertz() -> None:
    contact = EllipsoidContact.of(PAD, **PLACE, load=1e-4, reduced_modulus=0.1365)
    found, hertz = contact.solution, contact.hertz
    assert_allclose(found.indentation, hertz.indentation, rtol=1e-4)
    assert_allclose(found.peak_pressure, hertz.peak_pressure, rtol=2e-4)
    assert_allclose(found.semi_major, hertz.semi_major, rtol=3e-4)
    assert_allclose(found.semi_minor, hertz.semi_minor, rtol=3e-4)
    assert_allclose(contact.modulus_disagreement, 1, atol=2e-3)


@pytest.mark.parametrize(
    "counterface",
    [
        Counterface.sphere(20.0),
        Counterface.cylinder(15.0, axis_angle=0.0),
        Counterface.cylinder(6.0, axis_angle=0.7),
    ],
)
def test_small_contacts_with_curved_bodies_equal_hertz(counterface: Counterface) -> None:
    contact = EllipsoidContact.of(
        PAD, wedge_angle=0.5, counterface=counterface, load=1e-4, reduced_modulus=0.1, points=128
    )
    found, hertz = contact.solution, contact.hertz
    curvature = np.diag(1 / np.array(PAD.principal_radii_at_normal(platen_normal(0.5))))
    angle = counterface.axis_angle
    across = np.eye(2) if angle is None else np.outer(*2 * [[-math.sin(angle), math.cos(angle)]])
    values, vectors = np.linalg.eigh(curvature + across / counterface.radius)
    expected = HertzGeometry(*(1 / values)).under_load(1e-4, reduced_modulus=0.1)
    assert_allclose(hertz.semi_major, expected.semi_major, rtol=1e-12)
    assert_allclose(found.semi_major, expected.semi_major, rtol=1e-3)
    assert_allclose(found.semi_minor, expected.semi_minor, rtol=1e-3)
    assert_allclose(found.indentation, expected.indentation, rtol=1e-3)
    direction = math.cos(found.long_axis_angle), math.sin(found.long_axis_angle)
    assert_allclose(abs(np.dot(direction, vectors[:, 0])), 1, rtol=1e-4)


def test_ellipsoid_against_paraboloid() -> None:
    light, heavy = (
        EllipsoidContact.of(PAD, **PLACE, load=W, reduced_modulus=0.1365, points=64) for W in (0.2, 2.0)
    )
    for contact in (light, heavy):
        assert contact.solution.area < float(contact.hertz.area)
        assert contact.solution.indentation > float(contact.hertz.indentation)
    assert heavy.modulus_disagreement > light.modulus_disagreement > 1


def test_dimensional_scaling() -> None:
    one = EllipsoidContact.of(PAD, **PLACE, load=1.0, reduced_modulus=0.1, thickness=6.0, points=64).solution
    double = Ellipsoid(*(2 * PAD.semi_axes))
    other = EllipsoidContact.of(
        double, **PLACE, load=1.0, reduced_modulus=0.025, thickness=12.0, points=64
    ).solution
    assert_allclose(other.indentation, 2 * one.indentation, rtol=1e-6)
    assert_allclose(other.area, 4 * one.area, rtol=1e-6)


@pytest.mark.parametrize("thickness", [None, 8.0])
def test_error_estimate_bounds_refinement(thickness: float | None) -> None:
    coarse, fine = (
        EllipsoidContact.of(
            PAD, **PLACE, load=2.0, reduced_modulus=0.1365, thickness=thickness, points=points
        ).solution
        for points in (96, 256)
    )
    assert abs(coarse.area / fine.area - 1) < coarse.relative_error < 5e-3
    assert abs(coarse.indentation / fine.indentation - 1) < 0.1 * coarse.relative_error
    assert fine.relative_error < 1e-3


@pytest.mark.parametrize(
    ("wedge", "area", "thickness", "expected"),
    [(30, 116.3, math.inf, 12.45), (30, 116.3, 8.0, 20.5), (45, 69.4, math.inf, 9.60), (45, 69.4, 8.0, 14.5)],
)
def test_layer_of_8_mm_gives_published_loading_radii(
    wedge: float, area: float, thickness: float, expected: float
) -> None:
    # A/(πξ) at the measured area of 2 N: R_g is 20.5 mm at 30° and 14.5 mm at 45°.
    found = EllipsoidContact.of(
        PAD, wedge_angle=np.radians(wedge), reduced_modulus=0.1, thickness=thickness, area=area, points=128
    ).solution
    assert_allclose(found.area_over_pi_indentation, expected, rtol=5e-3)
    assert_allclose(found.area, area, rtol=1e-4)


@pytest.mark.parametrize(
    ("load", "modulus", "message"),
    [
        (0.0, 0.1, "load must be positive and finite, found 0"),
        (1.0, -0.1, "reduced_modulus must be positive and finite, found -0.1"),
        (2000.0, 0.1, "load would flatten the pad to its silhouette"),
    ],
)
def test_invalid_arguments(load: float, modulus: float, message: str) -> None:
    with pytest.raises(GeometryError, match=message):
        EllipsoidContact.of(PAD, **PLACE, load=load, reduced_modulus=modulus, points=64)


def test_invalid_bodies() -> None:
    with pytest.raises(GeometryError, match="radius must be positive, found 0"):
        Counterface.sphere(0.0)
    with pytest.raises(GeometryError, match="axis_angle must be finite, found nan"):
        Counterface.cylinder(1.0, axis_angle=math.nan)


def test_area_near_silhouette_on_layer():
    pad = Ellipsoid(palmar=7.5, distal=14.7, radial_ulnar=11.8)
    press = partial(
        EllipsoidContact.of,
        pad,
        wedge_angle=np.radians(30),
        thickness=8.0,
        reduced_modulus=0.1,
        points=64,
    )
    at_area = press(area=116.3).solution
    assert press(load=at_area.load).solution.area == pytest.approx(116.3, rel=1e-3)
