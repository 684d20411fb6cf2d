"""Contact images that share nothing with the measurement: their truth, and intervals that hold it."""

import numpy as np
import pytest
from benchmarks.claims.contact_areas import compare
from benchmarks.truth import image_sets
from benchmarks.truth.independent_ridges import Outline
from numpy.testing import assert_allclose

EGG = Outline(9, 6, 0.7, ((0.03, 0.2), (0.06, -0.4), (-0.03, 0.1), (0.01, 0.3)))


def test_the_moments_of_an_outline_are_those_of_the_points_inside_it():
    step = 0.03
    x, y = np.meshgrid(np.arange(-11, 11, step), np.arange(-11, 11, step))
    inside = np.stack([x, y])[:, EGG.level(x, y) < 1]
    values = np.linalg.eigvalsh(np.cov(inside))
    area, centre, semi_major, semi_minor = EGG.moments()
    assert_allclose(area, inside.shape[1] * step**2, rtol=3e-4)
    assert_allclose(centre, inside.mean(axis=1), atol=2e-3)
    assert_allclose([semi_minor, semi_major], 2 * np.sqrt(values), rtol=3e-4)


def test_the_intervals_hold_areas_and_semi_axes():
    """On one image what `benchmarks.claims.contact_areas` measures on many, of three simulators."""
    image = image_sets.draw("elastic ridges", "light touch", 1, 0)
    found = compare(image)
    assert found.held.all()
    assert abs(found.errors[0]) < 0.06
    assert abs(found.errors[1]) < 0.1
    assert not found.flags
    assert np.pi * np.prod(image.semi_axes) == pytest.approx(image.gross_area, rel=1e-9)
