"""Stated intervals of corrected and pooled radii hold the truth as often as they say."""

import pytest
from benchmarks.claims.studies import study_coverage


@pytest.mark.nightly
def test_intervals_cover_the_truth() -> None:
    # 300 studies: coverage is known to 1.3 %, a mean score to 0.06.
    for name, (held, bias) in study_coverage(300, first_seed=5000).items():
        assert 0.91 <= held <= 0.985, name
        assert abs(bias) < 0.2, name
