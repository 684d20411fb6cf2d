"""Stress under elliptical contacts: an integral of point loads, closed forms, equilibrium, limits."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from tests.contact.point_loads import point_load_stress

from fingerpad._arrays import FloatArray
from fingerpad.contact import StressField, hertz_stress
from fingerpad.contact.grid import ContactGrid
from fingerpad.contact.stress import HertzPressure


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


def test_uniaxial_strain_and_energy() -> None:
    field = StressField(tensor=np.diag([2.0, 0.0, 0.0]))
    assert_allclose(
        field.strain(youngs_modulus=4.0, poisson_ratio=0.3), np.diag([0.5, -0.15, -0.15]), atol=1e-15
    )
    assert_allclose(field.strain_energy_density(youngs_modulus=4.0, poisson_ratio=0.3), 0.5)
    assert_allclose(field.maximum_shear, 1)


def test_surface_has_no_gaps() -> None:
    # The circle whose radius is the lesser semi-axis, inside the ellipse, and the edge itself.
    place = np.array([[1.0, 0.0], [0.6, 0.8], [0.0, 1.0], [2.0, 0.0]]).T
    on, below = (
        hertz_stress(*place, z, semi_x=2, semi_y=1, peak_pressure=1, poisson_ratio=0.3).tensor
        for z in (0.0, 1e-9)
    )
    assert_allclose(on, below, atol=1e-4)


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
