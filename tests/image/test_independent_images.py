"""Contact images that share nothing with the measurement: their truth, and intervals that hold it."""

from dataclasses import replace

import numpy as np
import pytest
from benchmarks.claims.contact_areas import compare
from benchmarks.truth.elastic_ridges import elastic_image
from benchmarks.truth.independent_images import CONDITIONS, render
from benchmarks.truth.independent_ridges import Outline, draw_contact
from numpy.testing import assert_allclose
from scipy.spatial import ConvexHull

SMOOTH = {"shape": 0.0, "features": 0.0, "uneven": 0.0}
EGG = Outline(9, 6, 0.7, ((0.03, 0.2), (0.06, -0.4), (-0.03, 0.1), (0.01, 0.3)))


def test_the_moments_of_an_outline_are_those_of_the_points_inside_it():
    step = 0.03
    x, y = np.meshgrid(np.arange(-11, 11, step), np.arange(-11, 11, step))
    inside = np.stack([x, y])[:, EGG.level(x, y) < 1]
    values, vectors = np.linalg.eigh(np.cov(inside))
    area, centre, semi_major, semi_minor, orientation = EGG.moments()
    assert_allclose(area, inside.shape[1] * step**2, rtol=3e-4)
    assert_allclose(centre, inside.mean(axis=1), atol=2e-3)
    assert_allclose([semi_minor, semi_major], 2 * np.sqrt(values), rtol=3e-4)
    axis = [-np.sin(orientation), -np.cos(orientation)]
    assert_allclose(abs(axis @ vectors[:, 1]), 1, atol=1e-6)


@pytest.mark.parametrize("axis", [-1.5, -0.3, 0, 1.2, np.pi / 2])
def test_an_ellipse_has_its_own_axes(axis):
    area, centre, *rest = Outline(9, 6, axis).moments()
    assert_allclose(area, 54 * np.pi, rtol=1e-12)
    assert_allclose(centre, 0, atol=1e-12)
    assert_allclose(rest, [9, 6, axis], rtol=1e-12)


@pytest.mark.nightly
@pytest.mark.parametrize("growth", ["gabor", "swift-hohenberg"])
def test_the_ridge_area_has_converged_and_does_not_depend_on_where_the_samples_lie(growth):
    contact = draw_contact(
        np.random.default_rng(3), growth=growth, width_fade=1, shape=0.05, features=1, uneven=1
    )
    area = contact.ridge_area()
    assert_allclose(contact.ridge_area(step=0.005, offset=(0, 0)), area, rtol=8e-4)
    assert_allclose(contact.ridge_area(offset=(0.9, 0.1)), area, rtol=8e-4)


@pytest.mark.nightly
@pytest.mark.parametrize("growth", ["gabor", "swift-hohenberg"])
def test_the_width_of_ridges_is_proportional_to_the_pressure_up_to_the_full_width(growth):
    relative, touching, width = [], [], []
    for seed in range(3):
        contact = draw_contact(np.random.default_rng(seed), growth=growth, width_fade=1.5, **SMOOTH)
        at = np.arange(-10, 10, 0.02)
        reach = np.abs(contact.outline.points()).max(axis=0)
        touches, pressure = contact.touching(at[np.abs(at) < reach[0]], at[np.abs(at) < reach[1]])
        relative.append((pressure / contact.full_width_pressure)[pressure > 0])
        touching.append(touches[pressure > 0])
        width.append(np.full(touching[-1].shape, contact.width_fraction))
    relative, touching, width = (np.concatenate(parts) for parts in (relative, touching, width))
    for low, high in [(0.2, 0.6), (0.6, 0.95), (1, 9)]:
        here = (relative > low) & (relative < high)
        expected = (width * np.minimum(relative, 1))[here].mean()
        assert_allclose(touching[here].mean(), expected, rtol=0.06)


def test_ridges_touch_up_to_the_outline_and_nowhere_outside():
    contact = draw_contact(
        np.random.default_rng(5), growth="gabor", width_fade=1, shape=0.05, features=1, uneven=1
    )
    reach = np.abs(contact.outline.points()).max(axis=0) + 0.5
    x, y = (np.arange(-r, r, 0.02) for r in reach)
    rows, columns = np.nonzero(contact.touching(x, y)[0])
    assert contact.outline.level(x[columns], y[rows]).max() < 1.001
    hull = ConvexHull(np.stack([x[columns], y[rows]], axis=-1)).volume
    assert 0.95 < hull / contact.outline.moments()[0] < 1.001


@pytest.mark.nightly
def test_the_darkness_of_a_clean_image_adds_up_to_the_ridge_area_at_the_outline():
    clean = replace(CONDITIONS["clean, sharp edge"], noise=0, contrast=(0.5, 0.5), bits=16, bright=True)
    image = render(np.random.default_rng(11), replace(clean, ppi=300))
    darkness = np.abs(image.pixels - image.ground) / (0.5 * 65535)
    assert_allclose(darkness.sum() * image.mm_per_px**2, image.ridge_area, rtol=2e-3)
    contact = draw_contact(np.random.default_rng(11).spawn(2)[0], growth="gabor", width_fade=0, **SMOOTH)
    x, y = np.arange(-10, 10, 0.008), np.arange(-10, 10, 0.008)
    reach = np.abs(contact.outline.points()).max(axis=0)
    x, y = x[np.abs(x) < reach[0]], y[np.abs(y) < reach[1]]
    rows, columns = np.nonzero(contact.touching(x, y)[0])
    i, j = (np.sum(darkness * (at + 0.5)) / darkness.sum() for at in np.indices(darkness.shape))
    ridges = [x[columns].mean(), y[rows].mean()]
    assert_allclose(np.array([j, i]) * image.mm_per_px - image.centre, ridges, atol=5e-3)
    rows, columns = np.nonzero(darkness > 0.5)
    x, y = (columns + 0.5) * image.mm_per_px, (rows + 0.5) * image.mm_per_px
    sin, cos = np.sin(image.orientation), np.cos(image.orientation)
    along = -sin * (x - image.centre[0]) - cos * (y - image.centre[1])
    across = cos * (x - image.centre[0]) - sin * (y - image.centre[1])
    semi_major, semi_minor = image.semi_axes
    level = np.hypot(along / semi_major, across / semi_minor)
    assert 1 - 0.1 / semi_minor < level.max() < 1 + 0.06 / semi_minor


def test_the_intervals_hold_areas_and_semi_axes():
    """On one image what `benchmarks.claims.contact_areas` measures on many, of three simulators."""
    image = elastic_image("light touch", 1)
    found = compare(image)
    assert found.held.all()
    assert abs(found.errors[0]) < 0.06
    assert abs(found.errors[1]) < 0.1
    assert not found.flags
    assert np.pi * np.prod(image.semi_axes) == pytest.approx(image.gross_area, rel=1e-9)
