"""A pad on a layer of tissue: limits, the solver, and what takes a contact out of the range."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fingerpad.contact import EllipsoidContact, HertzGeometry, layered_contact
from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Ellipsoid, Placement

PAD = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
PLACED = {"wedge_angle": np.radians(30.0), "roll_angle": np.radians(8.0)}


@pytest.fixture(scope="module", params=[8.0, None])
def solved(request):
    press = {"load": 1.5, "reduced_modulus": 0.09, "poisson_ratio": 0.48, "points": 64}
    return request.param, EllipsoidContact.of(PAD, **PLACED, thickness=request.param, **press).solution


@pytest.mark.parametrize("given", ["area", "indentation"])
def test_finds_the_modulus_that_the_solver_was_given(solved, given) -> None:
    thickness, solution = solved
    found = layered_contact(
        PAD,
        **PLACED,
        thickness=math.inf if thickness is None else thickness,
        poisson_ratio=0.48,
        load=1.5,
        **{given: getattr(solution, given)},
    )
    assert found.reduced_modulus == pytest.approx(0.09, rel=0.006)
    assert found.youngs_modulus == pytest.approx(0.09 * (1 - 0.48**2), rel=0.006)
    assert found.area == pytest.approx(solution.area, rel=0.006)
    assert found.indentation == pytest.approx(solution.indentation, rel=0.006)
    assert found.area_over_pi_indentation == pytest.approx(
        solution.area / (math.pi * solution.indentation), rel=0.006
    )


def test_a_thick_layer_is_the_half_space() -> None:
    thickness = np.array([1e4, math.inf])
    found = layered_contact(PAD, **PLACED, thickness=thickness, load=2.0, area=110.0)
    for values in (found.youngs_modulus, found.indentation, found.area_over_pi_indentation):
        assert_allclose(values[0], values[1], rtol=1e-3)
    assert found.flag.tolist() == ["", ""]


@pytest.mark.parametrize("thickness", [4.0, math.inf])
def test_a_tiny_contact_is_hertzian(thickness) -> None:
    radii = Placement(PAD, **PLACED).curvature.principal_radii
    area, load = 1e-6, 1e-7
    hertz = HertzGeometry(radii[0], radii[1]).at_area(area, reduced_modulus=1.0)
    found = layered_contact(PAD, **PLACED, thickness=thickness, load=load, area=area)
    assert found.reduced_modulus == pytest.approx(load / hertz.load, rel=2e-3)
    assert found.indentation == pytest.approx(hertz.indentation, rel=2e-3)


def test_bone_lowers_the_modulus_and_raises_the_loading_radius() -> None:
    found = layered_contact(PAD, **PLACED, thickness=[4.0, 6, 8, 12, math.inf], load=2.0, area=110.0)
    assert (np.diff(found.youngs_modulus) > 0).all()
    assert (np.diff(found.area_over_pi_indentation) < 0).all()


@pytest.mark.parametrize(
    ("change", "flag"),
    [
        ({}, ""),
        ({"load": 0.0}, "no_contact"),
        ({"load": -1.0}, "no_contact"),
        ({"load": math.nan}, "no_contact"),
        ({"area": 0.0}, "no_contact"),
        ({"area": 300.0}, "contact_too_wide"),
        ({"thickness": 1.0}, "layer_too_thin"),
        ({"thickness": -8.0}, "layer_too_thin"),
        ({"poisson_ratio": 0.2}, "poisson_ratio_out_of_range"),
    ],
)
def test_flags(change, flag) -> None:
    press = {"thickness": 8.0, "load": 2.0, "area": 110.0} | change
    found = layered_contact(PAD, **PLACED, **press)
    assert str(found.flag) == flag
    for name in (
        "load",
        "area",
        "indentation",
        "reduced_modulus",
        "youngs_modulus",
        "area_over_pi_indentation",
    ):
        assert math.isnan(getattr(found, name)) == bool(flag), name


def test_one_of_area_and_indentation() -> None:
    for given in ({}, {"area": 110.0, "indentation": 2.0}):
        with pytest.raises(GeometryError, match="exactly one"):
            layered_contact(PAD, **PLACED, thickness=8.0, load=2.0, **given)
