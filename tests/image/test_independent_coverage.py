"""Stated intervals against images that were rendered without a look at the measurement."""

import numpy as np
import pytest
from benchmarks.contact_images import independent_errors


@pytest.fixture(scope="module")
def found():
    return independent_errors(count=2, seed=40)


def test_most_intervals_hold_the_truth(found):
    _, scores, _ = found
    # Of 48 intervals of 95 %, fewer than 40 hold with a chance below 0.5 %.
    assert len(scores) == 48
    assert (np.sum(np.abs(scores) < 1.96, axis=0) >= 40).all()


def test_areas_are_as_good_as_their_definition(found):
    errors, _, _ = found
    # What fades to nothing has no edge that everybody would see: 0.1 mm of it are 3 % of an area.
    assert np.sqrt(np.mean(np.square(errors), axis=0)) == pytest.approx([0, 0, 0, 0], abs=0.045)
    assert np.abs(np.mean(errors, axis=0)).max() < 0.02
