"""Budgets and Sobol indices: closed forms, and SciPy's estimator."""

from dataclasses import replace

import numpy as np
import pytest
import scipy
from numpy.testing import assert_allclose

from fingerpad.uncertainty import Inputs, propagate, sobol_indices

MATRIX = np.array([[1.0, -2.0, 0.5], [0.0, 1.0, 1.0]])
COVARIANCE = np.array([[2.0, 0.0, 0.0], [0.0, 1.0, 0.6], [0.0, 0.6, 1.5]])
GROUPS = {"first": ("a",), "others": ("b", "c")}


def given(groups: dict[str, tuple[str, ...]]) -> Inputs:
    inputs = Inputs.of(a=0.0, b=0.0, c=0.0).with_covariance("abc", COVARIANCE)
    return replace(inputs, groups=groups)


def linear(**inputs: np.ndarray) -> dict[str, np.ndarray]:
    return {
        f"y{row}": sum(factor * inputs[name] for factor, name in zip(factors, "abc", strict=True))
        for row, factors in enumerate(MATRIX)
    }


@pytest.mark.parametrize("row", [0, 1])
def test_budget_and_indices_of_a_linear_model(row: int) -> None:
    first = MATRIX[row, 0] ** 2 * 2.0 / (MATRIX[row] @ COVARIANCE @ MATRIX[row])
    expected, name = {"first": first, "others": 1 - first}, f"y{row}"
    budget = propagate(linear, given(GROUPS)).budget(name)
    assert {group: float(share) for group, share in budget.items()} == pytest.approx(expected)
    indices = sobol_indices(linear, given(GROUPS))[name]
    assert indices.first == pytest.approx(expected, abs=0.003)
    assert indices.total == pytest.approx(expected, abs=0.003)


def test_second_order_share_of_its_input() -> None:
    # x² at zero has no slope: its variance 2u⁴ = 2 is all of second order; y adds 6.
    inputs = Inputs.of(x=(0.0, 1.0), y=(0.0, np.sqrt(6)))
    budget = propagate(lambda x, y: {"z": x**2 + y}, inputs).budget("z")
    assert {name: float(share) for name, share in budget.items()} == pytest.approx({"x": 0.25, "y": 0.75})


def test_budget_broadcasting_and_zero_variance() -> None:
    inputs = Inputs.of(x=(1.0, [0.1, 0.0]), y=(2.0, [0.1, 0.0]))
    budget = propagate(lambda x, y: {"z": x + y}, inputs).budget("z")
    assert_allclose(budget["x"], [0.5, np.nan])


def test_agrees_with_scipy_with_interactions() -> None:
    def model(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> dict[str, np.ndarray]:
        return {"y": a + b * c + 0.3 * c**3}

    ours = sobol_indices(model, Inputs.of(a=(0.0, 1.0), b=(0.0, 1.0), c=(0.0, 1.0)))["y"]
    theirs = scipy.stats.sobol_indices(
        func=lambda x: model(*x)["y"], n=2**14, dists=[scipy.stats.norm()] * 3, rng=np.random.default_rng(1)
    )
    assert_allclose(list(ours.first.values()), theirs.first_order, atol=0.03)
    assert_allclose(list(ours.total.values()), theirs.total_order, atol=0.03)
    assert all(ours.total[name] > ours.first[name] + 0.1 for name in "bc")
