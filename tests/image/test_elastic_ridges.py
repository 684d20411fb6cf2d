"""Ridge area on images of ridges that are pressed flat, which share nothing with the measurement."""

import numpy as np
import pytest
from benchmarks.elastic_ridges import compare, elastic_image


@pytest.mark.parametrize("condition", ["prism, sharp", "live-scan", "dark field", "1000 ppi"])
def test_ridge_area_within_a_tenth_of_the_truth(condition: str) -> None:
    relative, score = compare(elastic_image(condition, 0, seed=7))
    assert abs(relative[1]) < 0.1
    assert abs(score[1]) < 2.6


def test_truth_depends_on_seed_condition_and_number_only() -> None:
    one, same, other = (elastic_image("ink, much", number, seed=3) for number in (1, 1, 2))
    assert np.array_equal(one.pixels, same.pixels)
    assert one.ridge_area == same.ridge_area != other.ridge_area
    assert one.gross_area == pytest.approx(np.pi * np.prod(one.semi_axes), rel=0.02)
    assert 0.3 < one.ridge_area / one.gross_area < 0.9
