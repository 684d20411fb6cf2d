"""Named inputs, their covariances and outputs, and what is refused."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from tests.uncertainty.pads import ELLIPSE, LENGTHS, PAD

import fingerpad as fp
from fingerpad import Estimate
from fingerpad.exceptions import UncertaintyError
from fingerpad.uncertainty import (
    Inputs,
    SharedErrors,
    covariance_of,
    covariance_root,
    placement_model,
    propagate,
    run_monte_carlo,
)
from fingerpad.uncertainty.models import pad_inputs


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


def correlated(other: str, correlation: float) -> Inputs:
    return Inputs.of(a=(1, 2), b=(1, 2), correlations={("a", other): correlation})


def doubled(x):
    return {"double": 2 * x}


def absolute(x):
    return {"size": np.abs(x)}


CORRELATED_AXES = Inputs.of(**PAD, in_plane_deviation=0.0, transverse_deviation=0.0).with_covariance(
    ["semi_major", "semi_minor"], [[1.0, 2.0], [2.0, 1.0]]
)
ONE = {"names": ("a",), "mean": [1.0], "covariance": [[1.0]], "groups": {}}
SCALE = {"sources": ("scale",), "parts": np.ones((3, 1)), "groups": [[0], [0], [1]]}


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Inputs(**ONE | {"mean": [1, 2]}), r"1 inputs need a mean of shape \(..., 1\)"),
        (lambda: Inputs(**ONE | {"covariance": 1}), r"found \(1,\) and \(\)"),
        (lambda: Inputs(**ONE | {"groups": {"x": ("b",)}}), "no input 'b'; there are a"),
        (lambda: Inputs(**ONE | {"names": ("a", "a"), "mean": [1, 2]}), "a name of its own, found a, a"),
        (lambda: Inputs.of(load=[1, 2]), r"load: .* exact arrays as \(values, 0\); found a list of 2"),
        # Two loads, or a load and its uncertainty?
        (lambda: Inputs.of(load=np.array([1, 2])), r"exact arrays as \(values, 0\); found an array of 2"),
        (lambda: Inputs.of(load=np.array([[1, 2], [3, 4]])), "found an array of 2"),
        (Inputs.of, "no inputs"),
        (lambda: Inputs.of(load=(2, -0.1)), "uncertainty of load must be positive or zero, found -0.1"),
        (lambda: Inputs.of(load=(1, 2, 3)), "load: give a number or .*; found a tuple of 3"),
        (lambda: correlated("c", 0.5), "no input 'c'; there are a, b"),
        (lambda: correlated("a", 0.5), "found a with itself"),
        (lambda: correlated("b", 1.5), r"correlation of a and b must be within \[-1, 1\]"),
        (lambda: correlated("b", np.nan), "correlation of a and b .* found nan"),
        (lambda: SharedErrors(**SCALE | {"parts": np.ones((3, 2))}), "of 1 sources must have the shape"),
        (lambda: SharedErrors(**SCALE | {"groups": [[0, 1]]}), r"groups must broadcast .* found \(1, 2\)"),
        (lambda: SharedErrors(**SCALE | {"groups": [[0], [-1], [1]]}), "counted from 0, found -1"),
        (lambda: propagate(placement_model, Inputs.of(palmar=7.9)), "other inputs: missing .* 'distal'"),
        (lambda: run_monte_carlo(placement_model, Inputs.of(palmr=7.9)), "given are palmr"),
        (lambda: propagate(doubled, Inputs.of(x=(1.0, 0.1)))["half"], "no output 'half'; there are double"),
        (lambda: correlated("b", 0.5).with_covariance(["a", "b"], np.eye(3)), "of 2 inputs must be square"),
        (lambda: propagate(absolute, Inputs.of(x=1.0)), "for complex steps in size: leave out abs"),
        (lambda: pad_inputs(Inputs.of(palmar=7.9)), "no input 'distal'; there are palmar"),
        (lambda: pad_inputs(CORRELATED_AXES), "covariance of semi_major and semi_minor .* found 2"),
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


@pytest.mark.parametrize(
    "covariance",
    [
        np.diag([4.0, 0.0, 1e-12]),
        np.ones((2, 2)),  # one input seen twice
        np.array([[1e-12, 1e-3 * 1e-6], [1e-3 * 1e-6, 1e6]]),
        np.zeros((3, 3)),
    ],
)
def test_root_squared_is_matrix(covariance: np.ndarray) -> None:
    factor = covariance_root(covariance_of(covariance))
    assert_allclose(factor @ factor.T, covariance, rtol=1e-9, atol=1e-20)


@pytest.mark.parametrize(
    ("covariance", "message"),
    [
        ([1.0, 2.0], "must be square, found the shape"),
        ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], "must be square"),
        ([[1.0, np.nan], [np.nan, 1.0]], "covariance must be finite, found nan at index 0, 1"),
        ([[1.0, 0.0], [0.0, -0.1]], "variance must be positive or zero, found -0.1 at index 1"),
        ([[1.0, 0.5], [0.4, 1.0]], "covariance must be symmetric, found 0.5 at index 0, 1"),
        ([[1.0, 1.5], [1.5, 1.0]], r"correlation must be within \[-1, 1\], found 1.5"),
        ([[0.0, 0.1], [0.1, 1.0]], r"correlation must be within \[-1, 1\], found inf"),
    ],
)
def test_invalid_arguments(covariance: list[list[float]], message: str) -> None:
    with pytest.raises(UncertaintyError, match=message):
        covariance_of(covariance)


@pytest.mark.parametrize("below", [1e-7, 1e-3])
def test_negative_eigenvalue_refused(below: float) -> None:
    # Three equal correlations r have the smallest eigenvalue 1 + 2 r.
    correlation = (1.5 + below / 2) * np.eye(3) - (0.5 + below / 2)
    with pytest.raises(UncertaintyError, match="smallest eigenvalue of the correlations must be positive"):
        covariance_of(correlation)


def test_rounding_below_zero_accepted() -> None:
    correlation = (1.5 + 5e-11) * np.eye(3) - (0.5 + 5e-11)
    assert np.linalg.eigvalsh(correlation)[0] < -5e-11
    for scale in (1.0, 1e-12, 1e12):
        assert covariance_of(scale * correlation).shape == (3, 3)


def test_root_of_nonfinite_matrix_is_nan() -> None:
    roots = covariance_root(np.stack([np.eye(2), np.diag([1.0, np.inf]), np.full((2, 2), np.nan)]))
    assert_allclose(roots[0], np.eye(2))
    assert np.isnan(roots[1:]).all()


DEGREES = ".*for degrees use np.radians\\(30\\)"
CONTRADICTION = {("palmar", "distal"): 0.9, ("distal", "radial_ulnar"): 0.9, ("palmar", "radial_ulnar"): -0.9}


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"wedge_angle": (5, 0.1)}, "wedge_angle must be between 0 and π/2" + DEGREES),
        ({"wedge_angle": ([0.5, 30], 0.01)}, "found 30 at index 1"),
        ({"wedge_angle": (0.5, 3)}, "standard uncertainty of wedge_angle must be at most π/2" + DEGREES),
        ({"roll_angle": (-10, 0.1)}, "roll_angle must be between -π/2 and π/2" + DEGREES),
        ({"roll_angle": (0, 3)}, "standard uncertainty of roll_angle" + DEGREES),
        ({"palmar": -7.9}, "palmar must be positive, found -7.9"),
        ({"semi_minor": ([5, 0], 0.1)}, "semi_minor must be positive, found 0 at index 1"),
        ({"load": -2}, "load must be positive or zero, found -2"),
        ({"image_scale": 0}, "image_scale must be positive"),
        ({"poisson_ratio": (3, 0.1)}, r"poisson_ratio must be within \[-1, 0.5\], found 3"),
        ({"load": (2.0, -0.1)}, "standard uncertainty of load must be positive or zero, found -0.1"),
        ({"load": (2.0, np.nan)}, "covariance must be finite"),
        ({"wedge": 0.5}, "no quantity 'wedge'; there are palmar, distal, .*semi_minor, thickness"),
        ({"contact_radius": 6.0}, "no quantity 'contact_radius'"),
        ({"correlations": {("palmar", "distl"): 0.9}}, "no input 'distl'; there are palmar, distal,"),
        ({"correlations": CONTRADICTION}, "smallest eigenvalue"),
    ],
)
def test_impossible_quantities_are_refused(given: dict[str, object], words: str) -> None:
    with pytest.raises(fp.FingerpadError, match=words):
        fp.pad_uncertainty(**PAD | given)


def test_a_missing_quantity_is_named() -> None:
    with pytest.raises(fp.FingerpadError, match="give wedge_angle too, each as a number or"):
        fp.pad_uncertainty(**LENGTHS, **ELLIPSE)
