"""Stress under contacts: integrals of point loads, closed forms, boundaries, limits, fields and sections."""

import math
from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fingerpad._arrays import FloatArray
from fingerpad.contact import (
    ContactField,
    SolvedContact,
    SolvedStress,
    StressField,
    Tissue,
    hertz_stress,
    solve_contact,
    solve_gap,
)
from fingerpad.contact.grid import ContactGrid
from fingerpad.contact.stress import HertzPressure
from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Ellipsoid, Placement


def point_load_stress(x: FloatArray, y: FloatArray, z: FloatArray, poisson_ratio: float) -> FloatArray:
    """Boussinesq's stress under a unit force (Johnson 1985, Eq. 3.20)."""
    r, loss = np.sqrt(x**2 + y**2 + z**2), 1 - 2 * poisson_ratio
    plane = np.array([[x * x, x * y], [x * y, y * y]])
    eye = np.eye(2)[:, :, None, None]
    stress = np.empty((3, 3, *r.shape))
    stress[:2, :2] = loss * (
        eye * (z / r**3 - 1 / (r * (r + z))) + plane * (2 * r + z) / (r**3 * (r + z) ** 2)
    )
    stress[:2, :2] -= 3 * plane * z / r**5
    stress[0, 2] = stress[2, 0] = -3 * x * z**2 / r**5
    stress[1, 2] = stress[2, 1] = -3 * y * z**2 / r**5
    stress[2, 2] = -3 * z**3 / r**5
    return stress / (2 * np.pi)


def integrated(place: tuple[float, float, float], a: float, b: float, poisson_ratio: float) -> FloatArray:
    node, weight = np.polynomial.legendre.leggauss(200)
    angle, turn = np.pi / 4 * (node + 1), 2 * np.pi * np.arange(400) / 400
    radius, pressure = np.sin(angle), np.cos(angle)
    load = a * b * (np.pi / 4 * weight * pressure * radius * np.cos(angle))[:, None] * 2 * np.pi / 400
    x, y = a * radius[:, None] * np.cos(turn), b * radius[:, None] * np.sin(turn)
    stress = point_load_stress(place[0] - x, place[1] - y, np.full_like(x, place[2]), poisson_ratio)
    return np.sum(stress * load, axis=(-2, -1))


@pytest.mark.parametrize(
    ("a", "b", "place", "poisson_ratio"),
    [
        (1.0, 1.0, (0.3, 0.2, 0.5), 0.3),
        (1.0, 0.999999, (0.3, 0.2, 0.5), 0.3),
        (2.0, 1.0, (0.3, 0.2, 0.5), 0.3),
        (1.0, 2.0, (0.3, 1.2, 0.4), 0.5),
        (1.0, 1.0, (1.5, 0.0, 0.3), 0.0),
        (2.0, 1.0, (1.5, 1.2, 0.3), 0.2),
        (1.0, 0.1, (0.5, 0.05, 0.3), 0.3),
        (1.0, 1.3, (4.0, -7.0, 2.0), 0.45),
    ],
)
def test_agrees_with_boussinesq_integral(
    a: float, b: float, place: tuple[float, float, float], poisson_ratio: float
) -> None:
    found = hertz_stress(*place, semi_x=a, semi_y=b, peak_pressure=1.0, poisson_ratio=poisson_ratio).tensor
    expected = integrated(place, a, b, poisson_ratio)
    assert_allclose(found, expected, atol=1e-12 * np.abs(expected).max() + 1e-15)


def test_surface_traction() -> None:
    x, y = np.meshgrid(np.linspace(-2.9, 2.9, 30), np.linspace(-1.7, 1.7, 31))
    field = hertz_stress(x, y, 0, semi_x=2, semi_y=1.2, peak_pressure=3, poisson_ratio=0.4)
    pressure = 3 * np.sqrt(np.maximum(1 - (x / 2) ** 2 - (y / 1.2) ** 2, 0))
    assert_allclose(field.tensor[..., 2, 2], -pressure, atol=1e-12)
    assert_allclose(field.tensor[..., :2, 2], 0, atol=1e-12)


def test_nan_above_surface() -> None:
    field = hertz_stress(0, 0, [-0.1, 0.1], semi_x=1, semi_y=1, peak_pressure=1)
    assert np.isnan(field.tensor[0]).all()
    assert np.isfinite(field.tensor[1]).all()


TURNED = HertzPressure(
    peak_pressure=2.0, semi_major=2.0, semi_minor=1.2, long_axis_angle=0.7, centre=np.array([0.3, -0.2])
)


def test_is_found_from_its_moments() -> None:
    grid = ContactGrid(centre=np.array([0.1, 0.2]), half_widths=np.array([2.6, 2.6]), angle=0.3, points=200)
    samples, cells = TURNED.at(*grid.coordinates), TURNED.over_cells(grid)
    assert_allclose(cells[samples > 0.7], samples[samples > 0.7], rtol=2e-3)
    assert_allclose(cells.sum() * grid.cell_area, 2 / 3 * np.pi * 2.0 * 1.2 * 2.0, rtol=1e-12)
    found = HertzPressure.of_moments(grid, samples)
    for name in ("peak_pressure", "semi_major", "semi_minor", "centre"):
        assert_allclose(getattr(found, name), getattr(TURNED, name), rtol=1e-4)
    assert math.sin(found.long_axis_angle - 0.7) == pytest.approx(0, abs=5e-4)


def test_stress_turns_with_the_ellipse() -> None:
    own = np.array([0.8, -0.5])
    cosine, sine = math.cos(0.7), math.sin(0.7)
    turn = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])
    along, across = turn[:2, :2] @ own + TURNED.centre
    found = TURNED.stress(along, across, 0.6, poisson_ratio=0.3).tensor
    expected = hertz_stress(*own, 0.6, semi_x=2.0, semi_y=1.2, peak_pressure=2.0, poisson_ratio=0.3).tensor
    assert_allclose(found, turn @ expected @ turn.T, atol=1e-13)


def contact(thickness: float, poisson_ratio: float, *, angle: float = 0.0) -> SolvedContact:
    return solve_gap(
        lambda x, y: x**2 / 20 + y**2 / 30,
        Tissue.of_reduced_modulus(0.1, poisson_ratio, thickness),
        half_widths=(2, 2.5),
        angle=angle,
        area=4 * math.pi,
        points=128,
    )


@cache
def layer() -> SolvedContact:
    return contact(2.5, 0.4)


@cache
def ellipsoid() -> SolvedContact:
    placement = Placement(
        Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8),
        wedge_angle=np.radians(60),
        roll_angle=np.radians(20),
    )
    return solve_contact(placement, Tissue.of_reduced_modulus(0.09, 0.3), load=2.0, points=128)


def contact_stress(found: SolvedContact, along, across, depth) -> StressField:
    return SolvedStress.of(found).at(along, across, depth)


PLACES = np.array([[0.3, 0.4], [1.0, -0.7], [2.5, 2.0], [-4.0, 0.2]])


@pytest.mark.parametrize("depth", [0.5, 1.5, 2.5])
def test_each_level_carries_the_load(depth: float) -> None:
    side = np.linspace(-16, 16, 321)
    field = contact_stress(layer(), side[:, None], side, depth)
    assert_allclose(-field.tensor[..., 2, 2].sum() * 0.1**2, layer().load, rtol=2e-3)


def test_surface_carries_the_pressure() -> None:
    x, y = layer().grid.coordinates
    field = contact_stress(layer(), x, y, 0.0)
    assert_allclose(-field.tensor[..., 2, 2], layer().pressure, atol=1e-9)
    assert_allclose(field.tensor[..., :2, 2], 0, atol=1e-12)


@pytest.mark.parametrize(("depth", "tolerance"), [(0.6, 3e-4), (2.0, 1e-4), (12.0, 3e-5)])
def test_whole_ellipsoid_on_a_half_space_is_a_sum_of_point_loads(depth: float, tolerance: float) -> None:
    found = ellipsoid()
    x, y = np.random.default_rng(5).uniform(-9, 9, (2, 25))
    stress = contact_stress(found, x, y, depth).tensor
    pressed = found.pressure > 0
    away = [side - one[pressed][:, None] for side, one in zip((x, y), found.grid.coordinates, strict=True)]
    each = point_load_stress(*away, np.full_like(away[0], depth), 0.3)
    forces = found.pressure[pressed] * found.grid.cell_area
    expected = np.einsum("ijkl,k->lij", each, forces)
    assert_allclose(stress, expected, atol=tolerance * found.peak_pressure)


def test_base_does_not_stretch() -> None:
    # Nothing moves at the base: no strain in its plane, so that both in-plane stresses are νσ_zz/(1 − ν).
    field = contact_stress(layer(), *PLACES.T, 2.5).tensor
    peak = layer().peak_pressure
    assert_allclose(field[:, 0, 0], 0.4 / 0.6 * field[:, 2, 2], atol=1e-9 * peak)
    assert_allclose(field[:, 1, 1], 0.4 / 0.6 * field[:, 2, 2], atol=1e-9 * peak)
    assert_allclose(field[:, 0, 1], 0, atol=1e-9 * peak)
    assert np.abs(field[:, 0, 2]).max() > 0.05 * peak


def test_nothing_in_the_air_in_the_bone_or_far_away() -> None:
    field = contact_stress(layer(), [0, 0, 0, 100], 0.0, [-0.1, 2.6, 1.0, 1.0]).tensor
    assert np.isnan(field).all(axis=(1, 2)).tolist() == [True, True, False, True]


@pytest.mark.parametrize("poisson_ratio", [0.3, 0.5])
def test_strains_down_to_the_base_add_up_to_the_displacement(poisson_ratio: float) -> None:
    found = contact(2.5, poisson_ratio)
    node, weight = np.polynomial.legendre.leggauss(16)
    depth, x = 1.25 * (node + 1), np.array([0.0, 0.7, 1.4])  # in contact, where the plate says how deep
    stress = contact_stress(found, x, 0.4, depth[:, None])
    strain = stress.strain(youngs_modulus=0.1 * (1 - poisson_ratio**2), poisson_ratio=poisson_ratio)
    total = -1.25 * weight @ strain[..., 2, 2]
    displacement = found.indentation - x**2 / 20 - 0.4**2 / 30
    assert_allclose(total, displacement, atol=5e-4 * found.indentation)


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
    for field in (solved, hertz):  # one point too
        assert field.pressure_at(0.2, 0.1) == pytest.approx(field.pressure_at([0.2], [0.1])[0])


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


def test_refuses() -> None:
    with pytest.raises(GeometryError, match="too great beside the contact"):
        contact_stress(contact(500.0, 0.5), 0.0, 0.0, 1.0)
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


def test_surface_has_no_gaps() -> None:
    # The circle whose radius is the lesser semi-axis, inside the ellipse, and the edge itself.
    place = np.array([[1.0, 0.0], [0.6, 0.8], [0.0, 1.0], [2.0, 0.0]]).T
    on, below = (
        hertz_stress(*place, z, semi_x=2, semi_y=1, peak_pressure=1, poisson_ratio=0.3).tensor
        for z in (0.0, 1e-9)
    )
    assert_allclose(on, below, atol=1e-4)


def test_strain_and_energy_are_those_of_the_tissue() -> None:
    field = ContactField.of_hertz(BALL, Tissue(0.1, 0.3), load=1.0)
    stress = field.stress_on_axis(1.0)
    assert_allclose(field.strain(stress), stress.strain(youngs_modulus=0.1, poisson_ratio=0.3), rtol=1e-12)
    energy = 0.5 * np.sum(stress.tensor * field.strain(stress))
    assert_allclose(field.strain_energy_density(stress), energy, rtol=1e-12)
