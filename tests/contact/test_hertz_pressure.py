"""The pressure of Hertz theory anywhere in the plane."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fingerpad.contact import hertz_stress
from fingerpad.contact.grid import ContactGrid
from fingerpad.contact.stress import HertzPressure

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
