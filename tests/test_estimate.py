"""A number with its uncertainty, or why there is none."""

import math

import numpy as np
import pytest

from fingerpad import Estimate
from fingerpad.uncertainty import Inputs, propagate

SKEW = Estimate(value=10.0, std=3.0, interval=(7.0, 20.0))


def test_an_error_is_added_and_a_width_stretched_on_either_side() -> None:
    wider = SKEW.with_error(4.0)
    assert (wider.value, wider.std) == (10.0, 5.0)
    assert wider.interval == pytest.approx((10 - math.hypot(3, 1.96 * 4), 10 + math.hypot(10, 1.96 * 4)))
    twice = SKEW.stretched(2.0)
    assert (twice.std, twice.interval) == (6.0, (4.0, 30.0))


def test_arrays_are_divided_and_widened_one_by_one() -> None:
    several = propagate(lambda x: {"double": 2 * x}, Inputs.of(x=([3.0, 4.0], 0.1)))["double"]
    divisor = Estimate.symmetric(2.0, 0.2)
    ratio, wider = several.over(divisor), several.with_error(0.4)
    for index, value in enumerate((6.0, 8.0)):
        one = Estimate.symmetric(value, 0.2)
        for found, expected in ((ratio, one.over(divisor)), (wider, one.with_error(0.4))):
            assert (found.value[index], found.std[index]) == pytest.approx((expected.value, expected.std))
            ends = found.lower[index], found.upper[index]
            assert ends == pytest.approx(expected.interval, rel=1e-4)
    assert several.over(several).value.tolist() == [1.0, 1.0]


def test_a_quantity_that_is_not_known_stays_so_with_its_reason() -> None:
    unknown = Estimate.unknown("no area was recorded")
    exact = Estimate.symmetric(2.0, 0.0)
    for found in (unknown, unknown.times(1000.0), unknown.over(exact), unknown.with_error(1.0)):
        assert not found.known
        assert math.isnan(found.value)
        assert math.isnan(found.std)
        assert str(found) == f"{found:.2f}" == "unknown: no area was recorded"
    assert SKEW.times(2.0).known


def test_outputs_of_a_model_are_estimates() -> None:
    one = propagate(lambda x: {"double": 2 * x}, Inputs.of(x=(3.0, 0.1)))["double"]
    assert isinstance(one, Estimate)
    assert (one.value, one.std) == pytest.approx((6.0, 0.2))
    assert one.interval == pytest.approx(Estimate.symmetric(6.0, 0.2).interval)
    none = propagate(lambda x: {"root": x * np.nan}, Inputs.of(x=(-1.0, 0.1)))
    assert str(none["root"]) == "unknown: the model has no finite value for these inputs"
    several = propagate(lambda x: {"double": 2 * x}, Inputs.of(x=([3.0, 4.0], 0.1)))["double"]
    assert several.upper == pytest.approx([6.392, 8.392], abs=1e-3)
