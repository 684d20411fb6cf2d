"""Ridge area on images of ridges that are pressed flat, which share nothing with the measurement."""

from functools import cache

import numpy as np
import pytest
from benchmarks.claims.contact_areas import compare, ridged
from benchmarks.truth.elastic_ridges import ElasticImage, elastic_image


@cache
def image(condition: str) -> ElasticImage:
    return elastic_image(condition, 0, seed=7)


@pytest.mark.parametrize("condition", ["prism, sharp", "live-scan", "dark field"])
def test_ridge_area_within_a_tenth_of_the_truth(condition: str) -> None:
    found = compare(ridged(image(condition)))
    assert abs(found.errors[1]) < 0.1
    assert abs(found.errors[1]) < 2.6 * found.stds[1]


def test_truth_depends_on_seed_condition_and_number_only() -> None:
    one = image("live-scan")
    same, other = (elastic_image("live-scan", number, seed=7) for number in (0, 1))
    assert np.array_equal(one.pixels, same.pixels)
    assert one.ridge_area == same.ridge_area != other.ridge_area
    assert one.gross_area == pytest.approx(np.pi * np.prod(one.semi_axes), rel=0.02)
    assert 0.3 < one.ridge_area / one.gross_area < 0.9
