"""The equations of loading: printed numbers, limits, inverses."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fingerpad.contact import Tissue, hertz_contact, indentation_factor, size_factor
from fingerpad.geometry import Paraboloid
from fingerpad.loading import (
    area_from_load,
    indentation_from_load,
    load_from_indentation,
    local_area_exponent,
    secant_modulus,
    sphere_ratio,
)
from fingerpad.loading.laws import FittedForceModel
from fingerpad.published import dzidek2017

PAD = {"loading_radius": 14.5, "initial_modulus": 0.04, "load_coefficient": 0.02}


@pytest.mark.parametrize(("angle", "indentation", "modulus_kpa"), [(30, 1.806, 102.4), (45, 1.523, 157.1)])
def test_published_contacts_at_2_N(angle, indentation, modulus_kpa) -> None:
    wedge = dzidek2017().wedges[angle]
    radius = wedge.measured_radius_mm.value
    xi = wedge.area_mm2.value / (np.pi * radius)
    assert_allclose(xi, indentation, atol=5e-4)
    assert_allclose(1000 * secant_modulus(2.0, xi, loading_radius=radius), modulus_kpa, atol=0.06)


def test_hertz_without_load_coefficient() -> None:
    contact = hertz_contact(Paraboloid(14.5, 14.5), Tissue(0.04), load=2.0)
    found = load_from_indentation(contact.indentation, loading_radius=14.5, initial_modulus=0.04)
    assert_allclose(found, 2.0, rtol=1e-12)
    area = area_from_load(2.0, loading_radius=14.5, initial_modulus=0.04)
    assert_allclose(area, contact.area, rtol=1e-12)


def test_indentation_and_load_invert() -> None:
    load = np.geomspace(1e-6, 50, 40)
    assert_allclose(load_from_indentation(indentation_from_load(load, **PAD), **PAD), load, rtol=1e-9)
    assert load_from_indentation(-1.0, **PAD) == 0
    assert np.isnan(load_from_indentation(100.0, **PAD))  # beyond where the growing modulus ends it


def test_secant_modulus_grows_linearly() -> None:
    load = np.array([0.5, 1.0, 2.0])
    secant = secant_modulus(load, indentation_from_load(load, **PAD), loading_radius=14.5)
    assert_allclose(secant, 0.04 + 0.02 * load, rtol=1e-12)


def test_area_exponent_is_logarithmic_slope() -> None:
    load = np.geomspace(0.01, 20, 30)
    step = 1e-5
    area = [area_from_load(load * np.exp(way * step), **PAD) for way in (1, -1)]
    slope = (np.log(area[0]) - np.log(area[1])) / (2 * step)
    found = local_area_exponent(load, initial_modulus=0.04, load_coefficient=0.02)
    assert_allclose(found, slope, rtol=1e-7)


@pytest.mark.parametrize("ratio", [1.0, 1.2, 2.0])
def test_sphere_ratio_of_elliptical_contact(ratio: float) -> None:
    contact = hertz_contact(Paraboloid(14.0, 14.0 * ratio), Tissue(0.075), load=2.0)
    k = float(1 / contact.aspect_ratio)
    found = sphere_ratio(contact.indentation, contact.area, loading_radius=14.0 * np.sqrt(ratio))
    assert_allclose(found, indentation_factor(k) ** 1.5 / size_factor(k) ** 3, rtol=1e-12)


def test_a_sphere_has_one_modulus_from_area_and_indentation() -> None:
    sphere = hertz_contact(Paraboloid(14.0, 14.0), Tissue.of_reduced_modulus(0.1), load=2.0)
    assert_allclose(sphere_ratio(sphere.indentation, sphere.area, loading_radius=14.0), 1.0, rtol=1e-12)
    assert np.isnan(sphere_ratio(-0.1, 0.2, loading_radius=14.0))


@pytest.mark.parametrize("compliance", [0.01, 0.2])
def test_a_yielding_stage_moves_with_the_load(compliance: float) -> None:
    values = {"contact_offset": 0.3, "loading_radius": 15.0, "youngs_modulus": 0.1}
    depth = np.linspace(0.01, 2, 40)
    load = 4 / 3 * 0.1 / 0.75 * np.sqrt(15.0) * depth**1.5
    model = FittedForceModel(
        law="hertz", values={**values, "stage_compliance": compliance}, poisson_ratio=0.5, aicc=0.0
    )
    assert_allclose(model.load(0.3 + depth + compliance * load), load, rtol=1e-7)
