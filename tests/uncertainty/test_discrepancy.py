"""By how much a model is wrong, from pairs of values that would agree if it held."""

import math

import numpy as np
import pytest

from fingerpad.exceptions import UncertaintyError
from fingerpad.uncertainty.discrepancy import model_discrepancy


def test_the_discrepancy_makes_differences_as_large_as_expected() -> None:
    ratios, stds = np.array([0.5, 0.42, 0.1, 0.61]), np.array([0.05, 0.2, 0.1, 0.3])
    found = model_discrepancy(ratios, stds)
    assert np.sum(ratios**2 / (stds**2 + found.between_std**2)) == pytest.approx(4)
    assert found.relative_std == pytest.approx(math.expm1(found.between_std / math.sqrt(2)))
    assert found.count == 4


def test_there_is_no_discrepancy_where_uncertainties_explain_the_differences() -> None:
    assert model_discrepancy([0.1, -0.1], [0.2, 0.2]).relative_std == 0.0
    assert model_discrepancy([0.0], [0.0]).relative_std == 0.0


@pytest.mark.parametrize(
    ("ratios", "stds"), [([], []), ([0.1], [0.1, 0.1]), ([math.nan], [0.1]), ([0.1], [-0.1])]
)
def test_pairs_that_say_nothing_are_refused(ratios: list[float], stds: list[float]) -> None:
    with pytest.raises(UncertaintyError):
        model_discrepancy(ratios, stds)
