"""Stated intervals against images that were rendered without a look at the measurement."""

import numpy as np
import pytest
from benchmarks.claims.contact_areas import compared
from benchmarks.claims.contact_edge import measured_images, scores_of, sets_of_one_device

pytestmark = pytest.mark.nightly


@pytest.fixture(scope="module")
def images():
    return list(measured_images(count=2, seed=40))


@pytest.fixture(scope="module")
def found(images):
    return [compared(one.truth, one.found) for one in images]


def test_most_intervals_hold_the_truth(found):
    # Of 48 intervals of 95 %, fewer than 40 hold with a chance below 0.5 %.
    assert len(found) == 48
    assert (np.sum([one.held for one in found], axis=0) >= 40).all()


def test_areas_are_as_good_as_their_definition(found):
    errors = [one.errors for one in found]
    # What fades to nothing has no edge that everybody would see: 0.1 mm of it are 3 % of an area.
    assert np.sqrt(np.mean(np.square(errors), axis=0)) == pytest.approx([0, 0, 0, 0], abs=0.045)
    assert np.abs(np.mean(errors, axis=0)).max() < 0.02


def test_pooling_does_not_average_the_edge_away(images):
    """Pooled areas of two images of one device hold the truth with the edge shared, less as noise."""
    pairs = list(sets_of_one_device(images, 2))
    assert len(pairs) == 24
    noise, shared = (scores_of(pairs, shared=shared) for shared in (False, True))
    held = np.sum(np.abs(shared) < 1.96, axis=0)
    assert (held >= 20).all()  # of 24 of 95 %, fewer hold with a chance below 0.6 %
    # Errors of two images of one device are nearly the same: as noise they are taken for √2 less.
    assert np.sqrt(np.mean(noise[:, 0] ** 2)) > 1.3 * np.sqrt(np.mean(shared[:, 0] ** 2))
