"""Elliptical Hertz contact and its integrals: a 50-digit reference, limits, printed numbers, spheres."""

from collections.abc import Callable

import mpmath as mp
import numpy as np
import pytest
from benchmarks.truth.hertz import exact_contact
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from fingerpad.contact import (
    Contact,
    Tissue,
    complete_integrals,
    equivalent_radius_from_area,
    equivalent_radius_from_compliance,
    equivalent_radius_from_indentation,
    fast_contact,
    hertz_contact,
    indentation_factor,
    size_factor,
    solve_contact,
    solve_contact_ellipse,
)
from fingerpad.contact.elliptic import curvature_ratio
from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Ellipsoid, Paraboloid, Placement

# From the circle, through ratios that differ from one by single digits of a double, to slender ellipses.
RATIOS = np.concatenate([[1.0], 1 + 10.0 ** -np.arange(15, 0, -1.0), np.geomspace(1.2, 1e7, 60)])
AXIS_RATIOS = np.concatenate([[1.0, 1 - 1e-16, 1 - 1e-12, 1 - 1e-6], np.geomspace(1e-12, 0.999, 40)])


@pytest.mark.parametrize("k", AXIS_RATIOS)
def test_integrals_agree_with_mpmath(k: float) -> None:
    with mp.workdps(90):
        m = 1 - mp.mpf(k) ** 2
        K, E = mp.ellipk(m), mp.ellipe(m)
        D = (K - E) / m if m else mp.pi / 4
        exact = (K, K - D, D)
        found = complete_integrals(k)
        for value, reference in zip(found, exact, strict=True):
            assert abs(mp.mpf(float(value)) / reference - 1) <= 1e-15


@pytest.mark.parametrize("function", [size_factor, indentation_factor, curvature_ratio])
def test_nan_outside_domain(function) -> None:
    values = function([0.5, 0.0, -1.0, 1.5, np.nan])
    assert np.isfinite(values).tolist() == [True, False, False, False, False]


TOLERANCE = 4e-15
PAD = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)


def pressed(first, second, *, reduced_modulus=0.1, **given) -> Contact:
    return hertz_contact(Paraboloid(first, second), Tissue.of_reduced_modulus(reduced_modulus), **given)


@pytest.mark.parametrize(("first", "load", "modulus"), [(8.0, 2.0, 0.1365), (0.5, 70.0, 3.2)])
@pytest.mark.parametrize("ratio", RATIOS)
def test_agrees_with_mpmath(ratio: float, first: float, load: float, modulus: float) -> None:
    """The first radius is a power of two, so that the ratio of the doubles is the ratio meant."""
    expected = exact_contact(ratio, first, load, modulus)
    contact = pressed(first, first * ratio, load=load, reduced_modulus=modulus)
    found = (contact.semi_major, contact.semi_minor, contact.indentation, contact.peak_pressure)
    for value, exact in zip(found, expected, strict=True):
        assert abs(mp.mpf(float(value)) / exact - 1) <= TOLERANCE


@pytest.mark.parametrize("ratio", [1e8, 1e12, 1e30, 1e200])
def test_slender_contacts(ratio: float) -> None:
    # There the contact tends to a line: k² R'/R'' (ln(4/k) − 1) → 1.
    k, K, D = solve_contact_ellipse(1.0, ratio)
    assert_allclose(K, np.log(4 / k), rtol=1e-7)
    assert_allclose(k**2 * ratio * (np.log(4 / k) - 1), 1, rtol=1e-6)
    assert_allclose(K - D, 1, rtol=1e-6)


positive = st.floats(1e-3, 1e3)


@given(positive, positive, positive, positive)
def test_load_area_and_indentation_ask_the_same_contact(
    first: float, second: float, load: float, modulus: float
) -> None:
    contact = pressed(first, second, load=load, reduced_modulus=modulus)
    for name in ("indentation", "area"):
        again = pressed(first, second, reduced_modulus=modulus, **{name: getattr(contact, name)})
        assert_allclose(again.load, load, rtol=1e-13)
        assert_allclose(again.semi_minor, contact.semi_minor, rtol=1e-13)
        assert_allclose(again.indentation, contact.indentation, rtol=1e-13)


@given(st.floats(1, 1e12))
def test_curvature_ratio_inverts_solution(ratio: float) -> None:
    k, _, _ = solve_contact_ellipse(ratio, 1.0)
    assert_allclose(curvature_ratio(k), ratio, rtol=5e-15)


@pytest.mark.parametrize(
    "wedges", [30.0, [30.0], [30.0, 45.0], [10.0, 20.0, 30.0], [[0.0, 30.0], [45.0, 60.0]], np.zeros((3, 0))]
)
def test_contacts_of_many_placements_are_those_of_each(wedges) -> None:
    angles, tissue = np.radians(wedges), Tissue(youngs_modulus=0.1024)
    area = hertz_contact(Placement(PAD, wedge_angle=angles), tissue, load=2.0).area
    each = [hertz_contact(Placement(PAD, wedge_angle=one), tissue, load=2.0).area for one in np.ravel(angles)]
    assert np.shape(area) == np.shape(angles)
    assert_allclose(np.ravel(area), each, rtol=1e-14)


@pytest.mark.parametrize("poisson_ratio", [0.3, 0.5])
def test_thickness_is_flagged_where_the_layer_is_stiffer(poisson_ratio: float) -> None:
    thickness = np.array([4.0, 8.0, 100.0, 200.0, np.inf])
    ball, layer = Paraboloid(10.0, 10.0), Tissue(0.05, poisson_ratio, thickness)
    found = hertz_contact(ball, layer, area=np.pi * 4.0**2)
    error = found.indentation / fast_contact(ball, layer, area=found.area).indentation - 1
    assert found.flags.tolist() == [*3 * ["thickness_ignored"], "", ""]
    assert found.load.shape == found.semi_major.shape == thickness.shape
    assert_array_equal(found.flags != "", error > 0.02)
    deep = hertz_contact(ball, Tissue(0.05, poisson_ratio), area=found.area)
    for name in ("load", "indentation", "semi_major", "peak_pressure"):
        assert_array_equal(getattr(found, name), getattr(deep, name))
    assert str(hertz_contact(ball, Tissue(0.05, poisson_ratio, 8.0), load=0.0).flags) == "no_contact"


def test_contact_wider_than_the_pad_is_flagged_whatever_is_given() -> None:
    place, tissue = Placement(PAD, wedge_angle=np.radians(30)), Tissue(youngs_modulus=0.1024)
    found = hertz_contact(place, tissue, load=[0.0, 2.0, 2000.0])
    assert found.flags.tolist() == ["no_contact", "", "contact_too_wide"]
    assert str(hertz_contact(place, Tissue(0.1024, thickness=8.0), load=2000.0).flags) == "contact_too_wide"
    for name in ("area", "indentation"):
        again = hertz_contact(place, tissue, **{name: getattr(found, name)})
        assert_array_equal(again.flag_code, found.flag_code)
    assert_allclose(found.area[2], 100 * found.area[1])  # the number stays


@pytest.mark.parametrize(("size", "flag"), [(0.59, ""), (0.61, "contact_too_wide")])
def test_contact_is_too_wide_from_six_tenths_of_the_radius(size: float, flag: str) -> None:
    sphere = hertz_contact(Paraboloid(9.0, 9.0), Tissue(0.1), area=np.pi * (9 * size) ** 2)
    assert sphere.flags == flag


@pytest.mark.parametrize("bad", [-1.0, np.nan])
@pytest.mark.parametrize("name", ["load", "indentation", "area"])
def test_nan_elementwise(name: str, bad: float) -> None:
    contact = pressed(10.0, 12.0, **{name: [1.0, bad]})
    assert np.isfinite(contact.semi_major[0])
    assert np.isnan(contact.semi_major[1])
    assert contact.flags.tolist() == ["", "no_contact"]


@pytest.mark.parametrize("contact", [hertz_contact, fast_contact, solve_contact])
def test_other_types_and_shapes_are_refused_by_name(contact: Callable[..., Contact]) -> None:
    place, tissue = Placement(PAD, wedge_angle=[0.5, 0.7]), Tissue(youngs_modulus=0.1)
    with pytest.raises(GeometryError, match="must be a Placement, or a Paraboloid.*, found float"):
        contact(12.955, tissue, load=2.0)
    with pytest.raises(GeometryError, match=r"must be a Tissue\(youngs_modulus\), found float"):
        contact(place, 0.1, load=2.0)
    with pytest.raises(GeometryError, match=r"placement \(2,\), tissue \(\), load \(3,\)"):
        contact(place, tissue, load=[1.0, 2.0, 3.0])


@pytest.mark.parametrize("radii", [(10.0, 10.0), (8.361, 12.384), (3.0, 40.0)])
def test_equivalent_spheres_satisfy_hertz(radii: tuple[float, float]) -> None:
    tissue = Tissue(youngs_modulus=0.1)
    ellipse = hertz_contact(Paraboloid(*radii), tissue, load=2.0)
    base, k = np.sqrt(np.prod(radii)), 1 / ellipse.aspect_ratio

    def sphere(radius):
        return hertz_contact(Paraboloid(radius, radius), tissue, load=2.0)

    by_indentation = sphere(equivalent_radius_from_indentation(base, k))
    assert_allclose(by_indentation.indentation, ellipse.indentation, rtol=1e-14)
    assert_allclose(sphere(equivalent_radius_from_area(base, k)).area, ellipse.area, rtol=1e-14)
    compliance = equivalent_radius_from_compliance(base, k)
    assert_allclose(compliance, ellipse.area / (np.pi * ellipse.indentation), rtol=1e-14)


@pytest.mark.parametrize(
    "radius_of",
    [equivalent_radius_from_area, equivalent_radius_from_compliance, equivalent_radius_from_indentation],
)
def test_nan_for_nonconvex_radius(radius_of) -> None:
    found = radius_of([-10.0, 0.0, np.nan, 10.0], 0.7)
    assert np.isnan(found).tolist() == [True, True, True, False]
    assert np.isnan(radius_of(-1, 0.7))
    assert_allclose(radius_of(10 + 1e-30j, 0.7).imag / 1e-30, found[3] / 10, rtol=1e-15)
