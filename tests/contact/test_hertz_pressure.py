"""The pressure of Hertz theory anywhere in the plane, and the displacement of the surface under it."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fingerpad.contact import HertzGeometry, HertzPressure, hertz_displacement, hertz_stress
from fingerpad.contact.grid import ContactGrid

TURNED = HertzPressure(
    peak_pressure=2.0, semi_major=2.0, semi_minor=1.2, long_axis_angle=0.7, centre=np.array([0.3, -0.2])
)


def gauss(count: int) -> tuple[np.ndarray, np.ndarray]:
    node, weight = np.polynomial.legendre.leggauss(count)
    return (node + 1) / 2, weight / 2


@pytest.mark.parametrize(("a", "b"), [(1.0, 1.0), (2.0, 1.0), (1.0, 2.0), (1.0, 0.1)])
@pytest.mark.parametrize("place", [(0.0, 0.0), (0.4, 0.3), (-0.9, 0.9), (2.6, 0.1), (0.3, 3.0)])
def test_displacement_is_an_integral_of_the_pressure(a: float, b: float, place: tuple[float, float]) -> None:
    """Lines through the point: u = (1/πE*) ∫∫ p dr dφ, the chord of each line being known."""
    x, y = place
    node, weight = gauss(400)
    # Outside, all lines that meet the ellipse lie between its two tangents.
    quadratic = (x / a) ** 2 + (y / b) ** 2 - 1
    low, high = 0.0, np.pi
    if quadratic > 0:
        p, q, r = x**2 - a**2, x * y, y**2 - b**2  # tangents: p sin² − 2q sin cos + r cos² = 0
        slopes = np.sort(np.arctan2(q + np.array([-1, 1]) * np.sqrt(q * q - p * r), p) % np.pi)
        low, high = slopes
        middle = (low + high) / 2
        if p * np.sin(middle) ** 2 - 2 * q * np.sin(middle) * np.cos(middle) + r * np.cos(middle) ** 2 > 0:
            low, high = high, low + np.pi
    angle = low + (high - low) * node
    cosine, sine = np.cos(angle), np.sin(angle)
    first = (cosine / a) ** 2 + (sine / b) ** 2
    half = x * cosine / a**2 + y * sine / b**2
    # p along a line is p0 √(first (r1 − r)(r − r0)): over the chord, p0 √first π (r1 − r0)²/8.
    chord = 2 * np.sqrt(np.maximum(half**2 - first * quadratic, 0)) / first
    expected = np.sum(weight * np.sqrt(first) * np.pi * chord**2 / 8) * (high - low) / np.pi
    found = hertz_displacement(x, y, semi_x=a, semi_y=b, peak_pressure=1.0, reduced_modulus=1.0)
    assert_allclose(found, expected, rtol=1e-8)


def test_inside_the_body_is_the_plate_s() -> None:
    contact = HertzGeometry(12.0, 20.0).under_load(1.5, reduced_modulus=0.1)
    x, y = np.random.default_rng(1).uniform(-1, 1, (2, 20))
    u = HertzPressure.of_contact(contact, 0.4).displacement(x, y, reduced_modulus=0.1)
    first, second = x * np.cos(0.4) + y * np.sin(0.4), y * np.cos(0.4) - x * np.sin(0.4)
    # The long axis lies along the larger radius.
    assert_allclose(u, contact.indentation - first**2 / 40 - second**2 / 24, rtol=1e-10)


def test_outside_a_circle() -> None:
    # Johnson (1985), Eq. 3.42b.
    r = np.array([1.0, 1.2, 3.0, 50.0])
    u = hertz_displacement(0, r, semi_x=1, semi_y=1, peak_pressure=2.0, reduced_modulus=4.0)
    expected = ((2 - r**2) * np.arcsin(1 / r) + np.sqrt(r**2 - 1)) * 2.0 / (2 * 4.0)
    assert_allclose(u, expected, rtol=1e-9)


def test_impossible_axes_give_nan() -> None:
    u = hertz_displacement(0, 0, semi_x=[1, 0, -1, np.nan], semi_y=1, peak_pressure=1, reduced_modulus=1)
    assert np.isnan(u).tolist() == [False, True, True, True]


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
