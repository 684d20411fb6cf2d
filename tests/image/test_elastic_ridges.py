"""Ridge area on images of ridges that are pressed flat, which share nothing with the measurement."""

from functools import cache

import pytest
from benchmarks.claims.contact_areas import compare
from benchmarks.truth.elastic_ridges import elastic_image
from benchmarks.truth.true_image import TrueImage


@cache
def image(condition: str) -> TrueImage:
    return elastic_image(condition, 0, seed=7)


@pytest.mark.parametrize(
    "condition",
    [
        "dark field",
        *(pytest.param(name, marks=pytest.mark.nightly) for name in ("prism, sharp", "live-scan")),
    ],
)
def test_ridge_area_within_a_tenth_of_the_truth(condition: str) -> None:
    found = compare(image(condition))
    assert abs(found.errors[1]) < 0.1
    assert abs(found.errors[1]) < 2.6 * found.stds[1]
