"""Named inputs and outputs: values, correlations and covariances reach the names that they are given for."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fingerpad import Estimate
from fingerpad.exceptions import UncertaintyError
from fingerpad.uncertainty import Inputs, SharedErrors, placement_model, propagate, run_monte_carlo


def test_numbers_are_exact_pairs_uncertain() -> None:
    inputs = Inputs.of(a=1, b=(2.0, 0.1), c=(np.radians(30), np.radians(0.5)), d=np.array(4.0))
    assert_allclose(inputs.mean, [1, 2, np.radians(30), 4])
    assert_allclose(inputs.std, [0, 0.1, np.radians(0.5), 0])


def test_broadcasting() -> None:
    inputs = Inputs.of(a=([1.0, 2.0, 3.0], 0.1), b=(5.0, [[0.1], [0.2]]), correlations={("b", "a"): 0.5})
    assert inputs.mean.shape == (2, 3, 2)
    assert_allclose(inputs.covariance[1, 2], [[0.01, 0.01], [0.01, 0.04]])
    assert_allclose(inputs.at(1).mean, inputs.mean[1])


def test_covariance_in_order_of_names() -> None:
    inputs = Inputs.of(a=(1, 2), b=(1, 3), c=(1, 5))
    changed = inputs.with_covariance(["c", "a"], [[1.0, 0.5], [0.5, 9.0]])
    assert_allclose(changed.covariance, [[9, 0, 0.5], [0, 9, 0], [0.5, 0, 1]])
    assert_allclose(inputs.std, [2, 3, 5])


def test_covariance_of_other_inputs_refused() -> None:
    with pytest.raises(UncertaintyError, match="covariance of 2 inputs must be square, found the shape"):
        Inputs.of(a=1.0, b=2.0).with_covariance(["a", "b"], np.eye(3))


def test_outputs_by_name() -> None:
    result = propagate(lambda x: {"double": 2 * x, "triple": 3 * x}, Inputs.of(x=(1.0, 0.1)))
    triple = result["triple"]
    assert (triple.value, triple.std) == (3, pytest.approx(0.3))
    assert_allclose(triple.interval, [3 - 1.96 * 0.3, 3 + 1.96 * 0.3], rtol=1e-4)
    assert f"{triple:.1f}" == "3.0 ± 0.3"
    with pytest.raises(UncertaintyError, match="no output 'fourfold'; there are double, triple"):
        result["fourfold"]


def correlated(other: str, correlation: float) -> Inputs:
    return Inputs.of(a=(1, 2), b=(1, 2), correlations={("a", other): correlation})


ONE = {"names": ("a",), "mean": [1.0], "covariance": [[1.0]], "groups": {}}
SCALE = {"sources": ("scale",), "parts": np.ones((3, 1)), "groups": [[0], [0], [1]]}


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Inputs(**ONE | {"mean": [1, 2]}), r"1 inputs need a mean of shape \(..., 1\)"),
        (lambda: Inputs(**ONE | {"covariance": 1}), r"found \(1,\) and \(\)"),
        (lambda: Inputs(**ONE | {"groups": {"x": ("b",)}}), "no input 'b'; there are a"),
        (
            lambda: Inputs(names=("a", "a"), mean=[1, 2], covariance=np.eye(2), groups={}),
            "a name of its own, found a, a",
        ),
        (lambda: Inputs.of(load=[1, 2]), r"load: .* exact arrays as \(values, 0\); found a list of 2"),
        # Two loads, or a load and its uncertainty?
        (
            lambda: Inputs.of(load=np.array([1, 2])),
            r"load: .* exact arrays as \(values, 0\); found an array of 2",
        ),
        (lambda: Inputs.of(load=np.array([[1, 2], [3, 4]])), "found an array of 2"),
        (Inputs.of, "no inputs"),
        (lambda: Inputs.of(load=(2, -0.1)), "uncertainty of load must be positive or zero, found -0.1"),
        (lambda: Inputs.of(load=(1, 2, 3)), "load: give a number or .*; found a tuple of 3"),
        (lambda: correlated("c", 0.5), "no input 'c'; there are a, b"),
        (lambda: correlated("a", 0.5), "found a with itself"),
        (lambda: correlated("b", 1.5), r"correlation of a and b must be within \[-1, 1\]"),
        (lambda: correlated("b", np.nan), "correlation of a and b .* found nan"),
        (
            lambda: SharedErrors(**SCALE | {"parts": np.ones((3, 2))}),
            "parts of 1 sources must have the shape",
        ),
        (lambda: SharedErrors(**SCALE | {"groups": [[0, 1]]}), r"groups must broadcast .* found \(1, 2\)"),
        (lambda: SharedErrors(**SCALE | {"groups": [[0], [-1], [1]]}), "counted from 0, found -1"),
        (lambda: propagate(placement_model, Inputs.of(palmar=7.9)), "other inputs: missing .* 'distal'"),
        (lambda: run_monte_carlo(placement_model, Inputs.of(palmr=7.9)), "given are palmr"),
    ],
)
def test_what_cannot_be_is_refused(make, message) -> None:
    with pytest.raises(UncertaintyError, match=message):
        make()


def test_an_estimate_is_its_value_and_uncertainty() -> None:
    fitted = Inputs.of(thickness=Estimate.symmetric(8.0, 1.5), load=2.0)
    assert_allclose(fitted.mean, [8.0, 2.0])
    assert_allclose(fitted.std, [1.5, 0.0])
    with pytest.raises(UncertaintyError, match="thickness is not known: no area was recorded"):
        Inputs.of(thickness=Estimate.unknown("no area was recorded"))
