"""Equivalent spheres: their definitions, checked by pressing the spheres."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fingerpad.contact import (
    Tissue,
    equivalent_radius_from_area,
    equivalent_radius_from_compliance,
    equivalent_radius_from_indentation,
    hertz_contact,
)
from fingerpad.geometry import Paraboloid


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
    ("radius", "ellipse", "corrected"), [(18.7, (7.4, 5.0), 18.97), (13.2, (5.3, 4.2), 13.27)]
)
def test_published_radii(radius, ellipse, corrected) -> None:
    found = equivalent_radius_from_indentation(radius, ellipse[1] / ellipse[0])
    assert_allclose(found, corrected, atol=5e-3)


@pytest.mark.parametrize(
    "radius_of",
    [equivalent_radius_from_area, equivalent_radius_from_compliance, equivalent_radius_from_indentation],
)
def test_nan_for_nonconvex_radius(radius_of) -> None:
    found = radius_of([-10.0, 0.0, np.nan, 10.0], 0.7)
    assert np.isnan(found).tolist() == [True, True, True, False]
    assert np.isnan(radius_of(-1, 0.7))
    assert_allclose(radius_of(10 + 1e-30j, 0.7).imag / 1e-30, found[3] / 10, rtol=1e-15)
