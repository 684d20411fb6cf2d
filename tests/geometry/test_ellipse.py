"""The plane ellipse and what it refuses."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Ellipse


def test_published_ellipses() -> None:
    ellipse = Ellipse([5.3, 7.4], [4.2, 5.0])
    assert_allclose(ellipse.eccentricity, [0.6099332, 0.7371990], atol=6e-8)
    assert_allclose(ellipse.area, [69.93, 116.24], atol=5e-3)


@pytest.mark.parametrize(
    ("axes", "message"),
    [
        ((4.0, 5.0), "semi_minor must be no longer than semi_major .*, found 5"),
        ((0.0, 0.0), "semi_major must be positive and finite, found 0"),
        ((5.0, -1.0), "semi_minor must be positive and finite, found -1"),
        ((np.nan, 1.0), "semi_major must be positive and finite, found nan"),
        ((np.inf, 1.0), "semi_major must be positive and finite, found inf"),
        (([5.0, 5.0], [4.0, 6.0]), "found 6 at index 1"),
    ],
)
def test_invalid_axes(axes, message: str) -> None:
    with pytest.raises(GeometryError, match=message):
        Ellipse(*axes)
