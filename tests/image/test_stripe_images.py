"""Contact images of ridges grown as stripes, which share nothing with the measurement."""

import numpy as np
import pytest
from benchmarks.claims.contact_areas import compare, ridged
from benchmarks.truth.stripe_images import stripe_image


@pytest.mark.parametrize("condition", ["prism", "prism, both fade over 0.6 mm", "scanner"])
def test_the_intervals_hold_gross_area_and_semi_axes(condition: str) -> None:
    found = compare(ridged(stripe_image(condition, 0, seed=7)))
    assert found.held[[0, 2, 3]].all()
    assert abs(found.errors[0]) < 0.06
    assert not found.flags


def test_truth_depends_on_seed_condition_and_number_only() -> None:
    one, same = (stripe_image("scanner", 1, seed=3) for _ in range(2))
    assert np.array_equal(one.pixels, same.pixels)
    assert one.ridge_area == same.ridge_area
    assert one.gross_area == pytest.approx(np.pi * np.prod(one.semi_axes), rel=1e-3)
    assert one.ridge_area < one.hull_area < one.gross_area
