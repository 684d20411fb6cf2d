"""The half-space solver: the limit of Hertz theory, invariants, and what it refuses."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from fingerpad.contact import HalfSpaceContact, ellipsoid_gap
from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Ellipsoid, platen_normal
from fingerpad.geometry.ellipsoid import tangents

pytest.importorskip("tamaas")

PAD = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
PLACE = {"wedge_angle": np.radians(45), "roll_angle": np.radians(10)}


def test_small_contacts_are_hertzian() -> None:
    contact = HalfSpaceContact.of(PAD, **PLACE, load=1e-4, reduced_modulus=0.1365)
    assert_allclose(contact.indentation, contact.hertz.indentation, rtol=2e-4)
    assert_allclose(contact.peak_pressure, contact.hertz.peak_pressure, rtol=2e-3)
    assert_allclose(contact.semi_major, contact.hertz.semi_major, rtol=5e-3)
    assert_allclose(contact.semi_minor, contact.hertz.semi_minor, rtol=5e-3)
    assert_allclose(contact.modulus_disagreement, 1, atol=0.01)


def test_the_true_ellipsoid_touches_less_and_sinks_deeper() -> None:
    light, heavy = (HalfSpaceContact.of(PAD, **PLACE, load=W, reduced_modulus=0.1365) for W in (0.2, 2.0))
    for contact in (light, heavy):
        assert contact.area < float(contact.hertz.area)
        assert contact.indentation > float(contact.hertz.indentation)
    assert heavy.modulus_disagreement > light.modulus_disagreement > 1


def test_only_load_over_modulus_and_size_squared_matters() -> None:
    one = HalfSpaceContact.of(PAD, **PLACE, load=1.0, reduced_modulus=0.1, points=64)
    double = Ellipsoid(*(2 * PAD.semi_axes))
    other = HalfSpaceContact.of(double, **PLACE, load=1.0, reduced_modulus=0.025, points=64)
    assert_allclose(other.indentation, 2 * one.indentation, rtol=1e-6)
    assert_allclose(other.area, 4 * one.area, rtol=1e-6)


def test_a_finer_grid_changes_little() -> None:
    coarse, fine = (
        HalfSpaceContact.of(PAD, **PLACE, load=2.0, reduced_modulus=0.1365, points=n) for n in (96, 192)
    )
    assert_allclose(coarse.area, fine.area, rtol=0.006)
    assert_allclose(coarse.indentation, fine.indentation, rtol=1e-3)


@settings(max_examples=40)
@given(st.floats(0, 1.5), st.floats(-1, 1), st.floats(-2, 2), st.floats(-2, 2))
def test_gap_ends_on_the_ellipsoid(wedge: float, roll: float, along: float, across: float) -> None:
    normal = platen_normal(wedge, roll)
    gap = ellipsoid_gap(PAD, normal, np.array([along, 0.0]), np.array([across, 0.0]))
    assert gap[0] >= -1e-12
    assert abs(gap[1]) < 1e-12
    first, second = PAD.curvature_at_normal(normal).principal_directions
    small = ellipsoid_gap(PAD, normal, np.array([1e-3, 0.0]), np.array([0.0, 1e-3]))
    tilted = np.stack([first, second]) @ np.stack(tangents(normal)).T  # the plate's axes are not principal
    curvatures = 1 / PAD.principal_radii_at_normal(normal)
    assert_allclose(small, 0.5e-6 * curvatures @ tilted**2, rtol=2e-3)


@pytest.mark.parametrize(
    ("load", "modulus", "message"),
    [
        (0.0, 0.1, "load must be positive and finite, found 0"),
        (1.0, -0.1, "reduced_modulus must be positive and finite, found -0.1"),
        (2000.0, 0.1, "would flatten the pad to its silhouette"),
    ],
)
def test_refuses(load: float, modulus: float, message: str) -> None:
    with pytest.raises(GeometryError, match=message):
        HalfSpaceContact.of(PAD, **PLACE, load=load, reduced_modulus=modulus, points=32)
