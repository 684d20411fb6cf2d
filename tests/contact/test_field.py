"""Fields below a pad: known maxima, Hertz theory as the limit of small loads, sections, and refusals."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fingerpad.contact import ContactField, Tissue, solve_contact
from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Ellipsoid, Placement

PAD = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
BALL = Placement(Ellipsoid(10.0, 10.0, 10.0), wedge_angle=0.3)


@pytest.mark.parametrize("poisson_ratio", [0.0, 0.3, 0.5])
def test_highest_shear_under_a_sphere(poisson_ratio: float) -> None:
    # Johnson (1985), Eqs 3.45: 0.31 p0 at 0.48 a for ν = 0.3.
    field = ContactField.of_hertz(BALL, Tissue(0.1, poisson_ratio), load=1.0)
    z = np.linspace(0.2, 0.8, 600_001)
    known = np.abs(1.5 / (1 + z**2) - (1 + poisson_ratio) * (1 - z * np.arctan(1 / z))) / 2
    highest, where = field.highest_shear_on_axis()
    radius = np.sqrt(field.contact.area / np.pi)
    assert_allclose(highest / field.contact.peak_pressure, known.max(), rtol=2e-4)
    assert where / radius == pytest.approx(z[np.argmax(known)], abs=0.02)


@pytest.mark.parametrize("roll", [0.0, 0.5])
def test_small_loads_are_hertz_s(roll: float) -> None:
    placement = Placement(PAD, wedge_angle=1.0, roll_angle=roll)
    tissue = Tissue.of_reduced_modulus(0.1, 0.4)
    hertz = ContactField.of_hertz(placement, tissue, load=0.002)
    solved = ContactField.of_solution(solve_contact(placement, tissue, load=0.002, points=128))
    assert_allclose(solved.contact.load, hertz.contact.load)
    along, across, depth = np.random.default_rng(6).uniform([-0.7, -0.7, 0.1], [0.7, 0.7, 1], (40, 3)).T
    found, expected = (field.stress_at(along, across, depth).tensor for field in (solved, hertz))
    assert_allclose(found, expected, atol=0.03 * hertz.contact.peak_pressure)
    found, expected = (field.pressure_at(along, across) for field in (solved, hertz))
    inner = expected > 0.4 * hertz.contact.peak_pressure  # the edge, where it is steep, moves a little
    assert inner.sum() > 5
    assert_allclose(found[inner], expected[inner], atol=0.03 * hertz.contact.peak_pressure)
    # The ellipse is one and a half times as long as wide: a quarter turn would show.
    assert np.abs(hertz.pressure_at(-across, along) - expected).max() > 0.3 * hertz.contact.peak_pressure


def test_section_ends_at_the_bone() -> None:
    placement, tissue = Placement(PAD, wedge_angle=0.5), Tissue(0.07, thickness=6.0)
    layer = ContactField.of_solution(solve_contact(placement, tissue, load=2.0, points=64))
    section = layer.section(points=31, levels=13)
    assert section.depth[-1] == section.thickness == 6
    assert section.maximum_shear.shape == (13, 31)
    assert np.isfinite(section.maximum_shear).all()
    axis = layer.stress_on_axis(section.depth).maximum_shear
    assert_allclose(section.maximum_shear[:, 15], axis, atol=1e-4 * layer.contact.peak_pressure)
    deep = ContactField.of_hertz(placement, tissue, load=2.0).section(points=11, levels=5)
    assert deep.depth[-1] < deep.thickness == np.inf


def test_strain_of_the_tissue() -> None:
    field = ContactField.of_hertz(BALL, Tissue(0.1, 0.3), load=1.0)
    stress = field.stress_on_axis(1.0)
    assert_allclose(field.strain(stress), stress.strain(youngs_modulus=0.1, poisson_ratio=0.3), rtol=1e-12)
    energy = 0.5 * np.sum(stress.tensor * field.strain(stress))
    assert_allclose(field.strain_energy_density(stress), energy, rtol=1e-12)


def test_refuses() -> None:
    field = ContactField.of_hertz(BALL, Tissue(0.1), load=1.0)
    for depth in (-1.0, np.nan, np.inf):
        with pytest.raises(GeometryError, match="depth must be finite and not negative"):
            field.stress_on_axis([1.0, depth])
    for given in ({}, {"load": 1.0, "area": 3.0}):
        with pytest.raises(GeometryError, match="exactly one of load, area, indentation"):
            ContactField.of_hertz(BALL, Tissue(0.1), **given)
    for given in ({"load": -1.0}, {"load": np.inf}, {"area": np.nan}, {"load": [1.0, 2.0]}):
        with pytest.raises(GeometryError, match="one contact under a positive, finite load"):
            ContactField.of_hertz(BALL, Tissue(0.1), **given)
