"""Elliptical Hertz contact against a 50-digit reference, limits, scaling laws and round trips."""

import mpmath as mp
import numpy as np
import pytest
from benchmarks.exact import RATIOS, exact_contact
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from fingerpad.contact import (
    HertzGeometry,
    curvature_ratio,
    hertz_contact,
    reduced_modulus,
    solve_contact_ellipse,
    youngs_modulus,
)
from fingerpad.exceptions import GeometryError

TOLERANCE = 4e-15


@pytest.mark.parametrize("ratio", RATIOS)
def test_agrees_with_mpmath(ratio: float) -> None:
    first = 8.0  # a power of two, so that the ratio of the doubles is the ratio meant
    expected = exact_contact(ratio, first, 2.0, 0.1365)
    contact = hertz_contact(first, first * ratio, 2.0, reduced_modulus=0.1365)
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


def test_sphere() -> None:
    contact = hertz_contact(10.0, 10.0, 3.0, reduced_modulus=0.2)
    radius = (3 * 3.0 * 10.0 / (4 * 0.2)) ** (1 / 3)
    assert_allclose(contact.semi_major, radius, rtol=4e-15)
    assert contact.semi_major == contact.semi_minor
    assert_allclose(contact.indentation, radius**2 / 10.0, rtol=4e-15)
    assert np.isnan(HertzGeometry(10, 10).long_axis)


def test_reference_numbers_of_published_pads() -> None:
    geometry = HertzGeometry([12.955, 8.361, 12.880, 7.650], [14.330, 12.384, 14.196, 11.932])
    assert_allclose(1 / geometry.axis_ratio, [1.0696, 1.2991, 1.067, 1.345], atol=6e-4)
    assert (geometry.long_axis == 1).all()
    assert_allclose(geometry.geometric_mean_radius, [13.625, 10.175, 13.522, 9.554], atol=6e-4)


def test_axes_not_sorted() -> None:
    assert HertzGeometry(20.0, 10.0).long_axis == 0
    assert HertzGeometry(10.0, 20.0).long_axis == 1
    swapped, straight = HertzGeometry(20.0, 10.0), HertzGeometry(10.0, 20.0)
    assert swapped.axis_ratio == straight.axis_ratio


def test_pressure_integrates_to_load() -> None:
    contact = hertz_contact(9.0, 14.0, 2.0, reduced_modulus=0.1)
    # ∫ p0 √(1 − r²) over the ellipse, by Gauss–Legendre in the radius.
    node, weight = np.polynomial.legendre.leggauss(60)
    radius = 0.5 * (node + 1)
    integral = np.sum(0.5 * weight * 2 * np.pi * radius * np.sqrt(1 - radius**2))
    carried = contact.peak_pressure * contact.semi_major * contact.semi_minor * integral
    assert_allclose(carried, 2.0, rtol=1e-5)
    assert_allclose(contact.mean_pressure * contact.area, 2.0, rtol=1e-14)
    assert_allclose(contact.ellipse.area, contact.area)


def test_stiffness_is_derivative_of_load() -> None:
    geometry = HertzGeometry(9.0, 14.0)
    step = 1e-5
    lower, upper = (
        geometry.under_load(2.0 * (1 + s), reduced_modulus=0.1).indentation for s in (-step, step)
    )
    assert_allclose(
        geometry.under_load(2.0, reduced_modulus=0.1).stiffness, 4 * step / (upper - lower), rtol=1e-8
    )


positive = st.floats(1e-3, 1e3)


@given(positive, positive, positive, positive, st.floats(1e-2, 1e2))
def test_scaling_exponents(first: float, second: float, load: float, modulus: float, factor: float) -> None:
    base = hertz_contact(first, second, load, reduced_modulus=modulus)
    heavier = hertz_contact(first, second, load * factor, reduced_modulus=modulus)
    larger = hertz_contact(first * factor, second * factor, load, reduced_modulus=modulus)
    stiffer = hertz_contact(first, second, load * factor, reduced_modulus=modulus * factor)
    assert_allclose(heavier.area, base.area * factor ** (2 / 3), rtol=1e-13)
    assert_allclose(heavier.indentation, base.indentation * factor ** (2 / 3), rtol=1e-13)
    assert_allclose(larger.indentation, base.indentation * factor ** (-1 / 3), rtol=1e-13)
    assert_allclose(larger.semi_major, base.semi_major * factor ** (1 / 3), rtol=1e-13)
    assert_allclose(stiffer.semi_minor, base.semi_minor, rtol=1e-13)
    assert base.semi_major >= base.semi_minor > 0


@given(positive, positive, positive, positive)
def test_inverse_functions(first: float, second: float, load: float, modulus: float) -> None:
    geometry = HertzGeometry(first, second)
    contact = geometry.under_load(load, reduced_modulus=modulus)
    for again in (
        geometry.at_indentation(contact.indentation, reduced_modulus=modulus),
        geometry.at_area(contact.area, reduced_modulus=modulus),
    ):
        assert_allclose(again.load, load, rtol=1e-13)
        assert_allclose(again.semi_minor, contact.semi_minor, rtol=1e-13)
        assert_allclose(again.indentation, contact.indentation, rtol=1e-13)
    assert_allclose(geometry.reduced_modulus_from_indentation(load, contact.indentation), modulus, rtol=1e-13)
    assert_allclose(geometry.reduced_modulus_from_area(load, contact.area), modulus, rtol=1e-13)


@given(st.floats(1, 1e12))
def test_curvature_ratio_inverts_solution(ratio: float) -> None:
    k, _, _ = solve_contact_ellipse(ratio, 1.0)
    assert_allclose(curvature_ratio(k), ratio, rtol=5e-15)


def test_arrays_equal_scalars() -> None:
    generator = np.random.default_rng(7)
    first, second = generator.uniform(5, 20, (2, 30_000))
    many = hertz_contact(first, second, 2.0, reduced_modulus=0.1)
    split = HertzGeometry(first, second).under_load(2.0, reduced_modulus=0.1)
    assert (many.semi_major == split.semi_major).all()
    for index in (0, 1, 11_999, 12_000, 29_999):
        one = hertz_contact(first[index], second[index], 2.0, reduced_modulus=0.1)
        assert one.semi_major == many.semi_major[index]
        assert one.indentation == many.indentation[index]


def test_broadcasting_and_integers() -> None:
    geometry = HertzGeometry([10, 12, 14], 12)
    contact = geometry.under_load([[1], [2]], reduced_modulus=1)
    assert contact.area.shape == (2, 3)
    assert contact.load.shape == (2, 3)
    as_float = HertzGeometry([10.0, 12.0, 14.0], 12.0).under_load([[1.0], [2.0]], reduced_modulus=1.0)
    assert (contact.indentation == as_float.indentation).all()
    assert hertz_contact(10, 12, 1, reduced_modulus=1).area.shape == ()


def test_zero_load() -> None:
    contact = HertzGeometry(10.0, 12.0).under_load(0.0, reduced_modulus=0.1)
    assert contact.area == 0
    assert contact.indentation == 0


@pytest.mark.parametrize("bad", [-1.0, np.nan])
def test_nan_elementwise(bad: float) -> None:
    geometry = HertzGeometry(10.0, 12.0)
    for contact in (
        geometry.under_load([1.0, bad], reduced_modulus=0.1),
        geometry.under_load(1.0, reduced_modulus=[0.1, bad]),
        geometry.at_indentation([1.0, bad], reduced_modulus=0.1),
        geometry.at_area([1.0, bad], reduced_modulus=0.1),
        hertz_contact([10.0, bad], 12.0, 1.0, reduced_modulus=0.1),
    ):
        assert np.isfinite(contact.semi_major[0])
        assert np.isnan(contact.semi_major[1])


@pytest.mark.parametrize("bad", [0.0, -3.0, np.nan, np.inf])
def test_invalid_radii(bad: float) -> None:
    with pytest.raises(
        GeometryError, match=r"second_radius must be positive and finite, found .* at index 1"
    ):
        HertzGeometry(10.0, [12.0, bad])


def test_modulus_conversion_inverts() -> None:
    assert_allclose(youngs_modulus(reduced_modulus(0.1, 0.48), 0.48), 0.1)
    assert_allclose(reduced_modulus(0.75), 1.0)
