"""Stress under solved contacts: point loads, boundaries, equilibrium, limits, and what is refused."""

import math
from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose
from tests.contact.point_loads import point_load_stress

from fingerpad._arrays import FloatArray
from fingerpad.contact import (
    SolvedContact,
    SolvedStress,
    StressField,
    Tissue,
    hertz_stress,
    solve_contact,
    solve_gap,
)
from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Ellipsoid, Placement


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


def test_stress_is_in_equilibrium_and_compatible_with_the_surface() -> None:
    step = 0.02

    def tensor(shift: FloatArray) -> FloatArray:
        x, y, z = np.array([*PLACES.T, np.full(len(PLACES), 1.2)]) + shift[:, None]
        return contact_stress(layer(), x, y, z).tensor

    divergence = sum(
        (tensor(step * unit) - tensor(-step * unit))[:, :, k] / (2 * step) for k, unit in enumerate(np.eye(3))
    )
    assert_allclose(divergence, 0, atol=2e-4 * layer().peak_pressure)


@pytest.mark.parametrize("poisson_ratio", [0.3, 0.5])
def test_thick_layer_is_the_half_space(poisson_ratio: float) -> None:
    # The stress along the layer departs as 1/t² in the end, the one across it faster.
    def departure(thickness: float) -> tuple[float, float]:
        found = contact(thickness, poisson_ratio)
        x, y, z = np.array([[0.0, 0.0, 1.0], [1.0, 0.5, 0.7], [0.5, -2.0, 1.5]]).T
        layer = contact_stress(found, x, y, z).tensor
        hertz = hertz_stress(
            *(x, y, z),
            semi_x=found.semi_minor,
            semi_y=found.semi_major,
            peak_pressure=found.peak_pressure,
            poisson_ratio=poisson_ratio,
        ).tensor
        difference = np.abs(layer - hertz) / found.peak_pressure
        return difference.max(), difference[:, 2, 2].max()

    (near, near_across), (far, far_across) = departure(4.0), departure(8.0)
    assert far < 0.45 * near < 0.03
    assert far_across < 0.2 * near_across


def test_nothing_in_the_air_in_the_bone_or_far_away() -> None:
    field = contact_stress(layer(), [0, 0, 0, 100], 0.0, [-0.1, 2.6, 1.0, 1.0]).tensor
    assert np.isnan(field).all(axis=(1, 2)).tolist() == [True, True, False, True]


def test_refuses_layers_that_are_half_spaces() -> None:
    with pytest.raises(GeometryError, match="too great beside the contact"):
        contact_stress(contact(500.0, 0.5), 0.0, 0.0, 1.0)


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
