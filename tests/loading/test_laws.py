"""The equations of loading: printed numbers, limits, inverses."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fingerpad.contact import Tissue, hertz_contact, indentation_factor, size_factor
from fingerpad.geometry import Paraboloid
from fingerpad.loading import FittedForceModel, sphere_ratio
from fingerpad.loading.law_registry import LAWS
from fingerpad.loading.laws import AppliedLaw, hertz, load_dependent

GIVEN = {"loading_radius": 14.5, "poisson_ratio": 0.5}
PAD = {"loading_radius": 14.5, "initial_modulus": 0.04, "load_coefficient": 0.02}


def indentation_under(load, *, loading_radius, initial_modulus, load_coefficient):
    """Return ξ under a load by Hertz theory with the modulus of that load."""
    modulus = initial_modulus + load_coefficient * load
    return (3 * 0.75 * load / (4 * np.sqrt(loading_radius) * modulus)) ** (2 / 3)


def test_hertz_without_load_coefficient() -> None:
    contact = hertz_contact(Paraboloid(14.5, 14.5), Tissue(0.04), load=2.0)
    pad = {**PAD, "load_coefficient": 0.0}
    found = load_dependent(contact.indentation, **pad, poisson_ratio=0.5)
    assert_allclose(found, 2.0, rtol=1e-12)
    assert_allclose(hertz(contact.indentation, youngs_modulus=0.04, **GIVEN), 2.0, rtol=1e-12)
    law = AppliedLaw(law="load_dependent", values=pad, poisson_ratio=0.5)
    area = law.area_at(np.atleast_1d(contact.indentation))
    assert_allclose(area, contact.area, rtol=1e-12)


def test_indentation_and_load_invert() -> None:
    load = np.geomspace(1e-6, 50, 40)
    found = load_dependent(indentation_under(load, **PAD), **PAD, poisson_ratio=0.5)
    assert_allclose(found, load, rtol=1e-9)
    model = FittedForceModel(
        law="load_dependent", values={**PAD, "contact_offset": 0.0}, poisson_ratio=0.5, aicc=0.0
    )
    # Before contact, and beyond where the growing modulus ends it: without an end a search cannot come back.
    before, beyond = model.load(np.array([-1.0, 100.0]))
    assert before == 0
    assert 50 < beyond < np.inf


@pytest.mark.parametrize("law", [hertz, load_dependent, LAWS["exact_sphere"], LAWS["free_exponent"]])
def test_slopes_that_laws_state_are_those_of_their_loads(law) -> None:
    given = {"youngs_modulus": 0.05, "load_exponent": 2.6, **PAD}
    values = {name: given[name] for name in law.parameters}
    xi, step = np.geomspace(0.01, 2, 20), 1e-6
    up, down = (law(xi + way * step, **values, **GIVEN) for way in (1, -1))
    assert_allclose(law.slope(xi, **values, **GIVEN), (up - down) / (2 * step), rtol=1e-6)


@pytest.mark.parametrize("ratio", [1.0, 1.2, 2.0])
def test_sphere_ratio_of_elliptical_contact(ratio: float) -> None:
    contact = hertz_contact(Paraboloid(14.0, 14.0 * ratio), Tissue(0.075), load=2.0)
    k = float(1 / contact.aspect_ratio)
    found = sphere_ratio(contact.indentation, contact.area, loading_radius=14.0 * np.sqrt(ratio))
    assert_allclose(found, indentation_factor(k) ** 1.5 / size_factor(k) ** 3, rtol=1e-12)
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
