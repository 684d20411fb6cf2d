"""Named inputs and covariances, and what is refused of them, of pools, of draws and of scatter."""

import math

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
    agreement,
    covariance_of,
    covariance_root,
    nested_scatter,
    placement_model,
    pool,
    pool_random_effects,
    propagate,
    run_monte_carlo,
    sobol_indices,
)
from fingerpad.uncertainty.discrepancy import model_discrepancy
from fingerpad.uncertainty.models import pad_inputs


def correlated(other: str, correlation: float) -> Inputs:
    return Inputs.of(a=(1, 2), b=(1, 2), correlations={("a", other): correlation})


def doubled(x):
    return {"double": 2 * x}


def absolute(x):
    return {"size": np.abs(x)}


def drawn(inputs: Inputs, **options):
    return run_monte_carlo(lambda x: {"y": np.sqrt(x)}, inputs, **options)


def indices(groups: dict[str, tuple[str, ...]], **options):
    """Return the indices of a sum of three inputs, of which the last two are correlated."""
    covariance = [[2.0, 0.0, 0.0], [0.0, 1.0, 0.6], [0.0, 0.6, 1.5]]
    inputs = Inputs.of(a=0.0, b=0.0, c=0.0).with_covariance("abc", covariance)
    grouped = Inputs(names=inputs.names, mean=inputs.mean, covariance=inputs.covariance, groups=groups)
    return sobol_indices(lambda a, b, c: {"sum": a + b + c}, grouped, **options)


def equal_correlations(below: float) -> np.ndarray:
    """Return three equal correlations r, whose smallest eigenvalue, 1 + 2 r, is so far below zero."""
    return (1.5 + below / 2) * np.eye(3) - (0.5 + below / 2)


CORRELATED_AXES = Inputs.of(**PAD, in_plane_deviation=0.0, transverse_deviation=0.0).with_covariance(
    ["semi_major", "semi_minor"], [[1.0, 2.0], [2.0, 1.0]]
)
ONE = {"names": ("a",), "mean": [1.0], "covariance": [[1.0]], "groups": {}}
SCALE = {"sources": ("scale",), "parts": np.ones((3, 1)), "groups": [[0], [0], [1]]}
NORMAL, GROUPS = Inputs.of(x=(0.0, 1.0)), {"first": ("a",), "others": ("b", "c")}
TWO, STDS = [1.0, 2.0], [0.1, 0.1]
THREE_PARTS = SharedErrors(sources=("s",), parts=np.ones((3, 1)), groups=np.zeros((1, 1), int))
TWICE = {("a", "b"): 0.5, ("b", "a"): 0.4}
NEGATIVE = "smallest eigenvalue of the correlations must be positive"
APART = "inputs 'b' and 'c' are correlated but in different groups"
NO_GROUP = "each value needs its group, found 3 and 2"


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
        (lambda: Inputs.of(load="2 N"), "load must be numeric, found '2 N'"),
        (lambda: Inputs.of(load=(2, "1 %")), "standard uncertainty of load must be numeric, found '1 %'"),
        (lambda: Inputs.of(load=(2, np.nan)), "standard uncertainty of load must be finite, found nan"),
        (lambda: Inputs.of(load=(2, [0.1, np.inf])), "of load must be finite, found inf at index 1"),
        (lambda: Inputs.of(load=fp.Estimate.unknown("no area")), "load is not known: no area"),
        (lambda: correlated("c", 0.5), "no input 'c'; there are a, b"),
        (lambda: correlated("a", 0.5), "found a with itself"),
        (lambda: correlated("b", 1.5), r"correlation of a and b must be within \[-1, 1\]"),
        (lambda: correlated("b", np.nan), "correlation of a and b .* found nan"),
        (lambda: correlated("b", "high"), "correlation of a and b must be numeric, found 'high'"),
        (lambda: Inputs.of(a=(1, 2), correlations={"a": 0.5}), r"two inputs, as \('a', 'b'\), found 'a'"),
        (lambda: Inputs.of(a=1, b=2, correlations=TWICE), "of a and b is given twice, found 0.5 and 0.4"),
        (
            lambda: propagate(lambda x: [x], NORMAL),
            "must return a mapping from names to outputs, found list",
        ),
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
        (lambda: covariance_of([1.0, 2.0]), "must be square, found the shape"),
        (lambda: covariance_of([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), "must be square"),
        (lambda: covariance_of([[1.0, np.nan], [np.nan, 1.0]]), "must be finite, found nan at index 0, 1"),
        (lambda: covariance_of(np.diag([1.0, -0.1])), "variance must be .* zero, found -0.1 at index 1"),
        (lambda: covariance_of([[1.0, 0.5], [0.4, 1.0]]), "must be symmetric, found 0.5 at index 0, 1"),
        (lambda: covariance_of([[1.0, 1.5], [1.5, 1.0]]), r"correlation must be within .*, found 1.5"),
        (lambda: covariance_of([[0.0, 0.1], [0.1, 1.0]]), r"correlation must be within .*, found inf"),
        (lambda: covariance_of(equal_correlations(1e-7)), NEGATIVE),
        (lambda: covariance_of(equal_correlations(1e-3)), NEGATIVE),
        (lambda: drawn(Inputs.of(x=(-3.0, 1.0))), "no finite output for .* draws"),
        (lambda: drawn(Inputs.of(x=([1.0, 2.0], 1.0))), r"one set of inputs, found the shape \(2,\)"),
        (lambda: drawn(Inputs.of(x=1.0).with_covariance("x", [[-1.0]])), "variance must be positive or zero"),
        (lambda: drawn(NORMAL, digits=0), "digits must be at least 1"),
        (lambda: drawn(NORMAL, min_draws=10, max_draws=5), "at most max_draws, found 2, 10, 5"),
        (lambda: indices({"p": ("a", "b"), "q": ("b", "c")}), "input 'b' is in two groups, 'p' and 'q'"),
        (lambda: indices({"p": ("a",), "q": ("b",)}), "input 'c' has a variance and belongs to no group"),
        (lambda: indices({"p": ("a", "b"), "q": ("c",)}), APART),
        (lambda: indices({"q": ("a", "b"), "p": ("c",)}), APART),
        (lambda: indices(GROUPS, draws=1000), "power of two, found 1000"),
        (lambda: pool([], []), "no estimates to pool"),
        (lambda: pool(TWO, [0.1]), "each value needs its standard uncertainty"),
        (lambda: pool(TWO, [0.1, np.inf]), "uncertainty must be finite and not negative, found inf"),
        (lambda: pool(TWO, [0.1, -1.0]), "found -1 at index 1"),
        (lambda: pool([1.0, np.nan], STDS), "value to pool must be finite, found nan at index 1"),
        (lambda: pool(TWO, STDS, [[1.0, 3.0], [3.0, 1.0]]), "correlation"),
        (lambda: pool(TWO, STDS, np.eye(3)), r"shared must have the shape \(2, 2\), found \(3, 3\)"),
        (lambda: pool(["a"], [1.0]), "values to pool must be numeric"),
        (lambda: pool(TWO, STDS, THREE_PARTS), "each estimate needs its parts, found 2 and 3"),
        (lambda: pool_random_effects(TWO, [0.1, 0.0]), "uncertainty must be positive, found 0 at index 1"),
        (lambda: nested_scatter([1.0, 2.0, 3.0], {"finger": [0, 1]}), NO_GROUP),
        (lambda: nested_scatter([1.0, np.nan], {"finger": [0, 1]}), "value"),
        (lambda: agreement([1, 2], [1]), "pairs"),
        (lambda: agreement([1, 0], [1, 1]), "first must be positive"),
        (lambda: agreement([1.0], [math.inf]), "second"),
        (lambda: model_discrepancy([], []), "one at least; found 0 and 0"),
        (lambda: model_discrepancy([0.1], STDS), "found 1 and 2"),
        (lambda: model_discrepancy([math.nan], [0.1]), "log_ratios must be finite"),
        (lambda: model_discrepancy([0.1], [-0.1]), "must be at least zero"),
    ],
)
def test_what_cannot_be_is_refused(make, message) -> None:
    with pytest.raises(UncertaintyError, match=message):
        make()


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
        ({"load": (2.0, np.nan)}, "standard uncertainty of load must be finite"),
        ({"load": ([1, 2], [1, 2, 3])}, r"found load \(2,\), standard uncertainty of load \(3,\)"),
        ({"load": ([1, 2], 0.1), "palmar": ([1, 2, 3], 0)}, r"found palmar \(3,\), load \(2,\)"),
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


def test_an_estimate_is_its_value_and_uncertainty() -> None:
    fitted = Inputs.of(thickness=Estimate.symmetric(8.0, 1.5), load=2.0)
    assert_allclose(fitted.mean, [8.0, 2.0])
    assert_allclose(fitted.std, [1.5, 0.0])


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


def test_rounding_below_zero_accepted() -> None:
    correlation = (1.5 + 5e-11) * np.eye(3) - (0.5 + 5e-11)
    assert np.linalg.eigvalsh(correlation)[0] < -5e-11
    for scale in (1.0, 1e-12, 1e12):
        assert covariance_of(scale * correlation).shape == (3, 3)


def test_root_of_nonfinite_matrix_is_nan() -> None:
    roots = covariance_root(np.stack([np.eye(2), np.diag([1.0, np.inf]), np.full((2, 2), np.nan)]))
    assert_allclose(roots[0], np.eye(2))
    assert np.isnan(roots[1:]).all()
