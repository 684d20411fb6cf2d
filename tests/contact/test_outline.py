"""The outline of a solved contact, of pressures whose ellipse is known."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fingerpad.contact.grid import contact_outline


@pytest.mark.parametrize("degrees", [-80, -45, -10, 10, 45, 80])
def test_long_axis_points_forward(degrees: int) -> None:
    x = np.linspace(-2.2, 2.2, 80)
    along, across = np.meshgrid(x, x, indexing="ij")
    cosine, sine = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    inside = 1 - ((cosine * along + sine * across) / 2) ** 2 - (cosine * across - sine * along) ** 2
    outline = contact_outline(x, x, np.sqrt(np.maximum(inside, 0)))
    assert_allclose(np.degrees(outline.long_axis_angle), degrees, atol=1e-3)
    assert_allclose([outline.semi_major, outline.semi_minor], [2, 1], rtol=1e-5)
