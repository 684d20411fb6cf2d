"""Stress in a bonded layer: its boundaries, equilibrium, the half-space as its limit, and what it refuses."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fingerpad._arrays import FloatArray
from fingerpad.contact import ContactSolution, ElasticBody, hertz_stress, layer_stress, solve_contact
from fingerpad.exceptions import GeometryError


def contact(
    thickness: float, poisson_ratio: float, *, ratio: float = 1.5, angle: float = 0.0
) -> ContactSolution:
    body = ElasticBody.of(reduced_modulus=0.1, thickness=thickness, poisson_ratio=poisson_ratio)
    return solve_contact(
        lambda x, y: x**2 / 20 + y**2 / 30,
        body,
        half_widths=(2, 2.5),
        angle=angle,
        area=4 * math.pi,
        points=128,
    )


LAYER = contact(2.5, 0.4)
PLACES = np.array([[0.3, 0.4], [1.0, -0.7], [2.5, 2.0], [-4.0, 0.2]])


@pytest.mark.parametrize("depth", [0.5, 1.5, 2.5])
def test_load_at_each_depth(depth: float) -> None:
    side = np.linspace(-16, 16, 321)
    field = layer_stress(LAYER, side[:, None], side, depth)
    assert_allclose(-field.tensor[..., 2, 2].sum() * 0.1**2, LAYER.load, rtol=2e-3)


def test_surface_traction() -> None:
    x, y = LAYER.grid.coordinates
    field = layer_stress(LAYER, x, y, 0.0)
    assert_allclose(-field.tensor[..., 2, 2], LAYER.pressure, atol=1e-9)
    assert_allclose(field.tensor[..., :2, 2], 0, atol=1e-12)


def test_no_strain_at_base() -> None:
    # Nothing moves at the base: no strain in its plane, so that both in-plane stresses are νσ_zz/(1 − ν).
    field = layer_stress(LAYER, *PLACES.T, 2.5).tensor
    peak = LAYER.peak_pressure
    assert_allclose(field[:, 0, 0], 0.4 / 0.6 * field[:, 2, 2], atol=1e-9 * peak)
    assert_allclose(field[:, 1, 1], 0.4 / 0.6 * field[:, 2, 2], atol=1e-9 * peak)
    assert_allclose(field[:, 0, 1], 0, atol=1e-9 * peak)
    assert np.abs(field[:, 0, 2]).max() > 0.05 * peak


def test_equilibrium_and_surface_displacement() -> None:
    step = 0.02

    def tensor(shift: FloatArray) -> FloatArray:
        x, y, z = np.array([*PLACES.T, np.full(len(PLACES), 1.2)]) + shift[:, None]
        return layer_stress(LAYER, x, y, z).tensor

    divergence = sum(
        (tensor(step * unit) - tensor(-step * unit))[:, :, k] / (2 * step) for k, unit in enumerate(np.eye(3))
    )
    assert_allclose(divergence, 0, atol=2e-4 * LAYER.peak_pressure)


@pytest.mark.parametrize("poisson_ratio", [0.3, 0.5])
def test_thick_layer_equals_half_space(poisson_ratio: float) -> None:
    # The stress along the layer departs as 1/t² in the end, the one across it faster.
    def departure(thickness: float) -> tuple[float, float]:
        found = contact(thickness, poisson_ratio)
        x, y, z = np.array([[0.0, 0.0, 1.0], [1.0, 0.5, 0.7], [0.5, -2.0, 1.5]]).T
        layer = layer_stress(found, x, y, z).tensor
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


def test_grid_direction_invariance() -> None:
    turned = contact(2.5, 0.4, angle=0.6)
    one, other = (layer_stress(found, *PLACES.T, 1.0).tensor for found in (LAYER, turned))
    assert_allclose(one, other, atol=2e-3 * LAYER.peak_pressure)


def test_nan_outside_layer() -> None:
    field = layer_stress(LAYER, [0, 0, 0, 100], 0.0, [-0.1, 2.6, 1.0, 1.0]).tensor
    assert np.isnan(field).all(axis=(1, 2)).tolist() == [True, True, False, True]


def test_half_space_refused() -> None:
    with pytest.raises(GeometryError, match="thickness must be finite"):
        layer_stress(contact(math.inf, 0.5), 0.0, 0.0, 1.0)
    with pytest.raises(GeometryError, match="too great beside the contact"):
        layer_stress(contact(500.0, 0.5), 0.0, 0.0, 1.0)
