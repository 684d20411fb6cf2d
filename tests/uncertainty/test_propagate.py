"""First-order propagation against closed forms, a Monte Carlo of its own, and the `uncertainties` package."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from tests.uncertainty.pads import EXACT, PAD

from fingerpad.uncertainty import (
    Inputs,
    correlated_values,
    inputs_from_ufloats,
    pad_model,
    pad_uncertainty,
    propagate,
)

CIRCLE = {**EXACT, "semi_major": 5.0}


def observed(
    *, image_scale, edge_offset, semi_major, semi_minor, radius_deviation, elongation_deviation, **rest
) -> dict[str, Any]:
    """Return the outputs of the ellipse that measured quantities make."""
    ellipse = [
        image_scale * axis * np.exp(radius_deviation + sign * elongation_deviation / 2) + edge_offset
        for axis, sign in ((semi_major, 1), (semi_minor, -1))
    ]
    return pad_model(
        contact_radius=np.sqrt(ellipse[0] * ellipse[1]),
        elongation=np.log(ellipse[0] / ellipse[1]),
        image_scale=1.0,
        edge_offset=0.0,
        **rest,
    )


@given(st.lists(st.floats(-5, 5), min_size=6, max_size=6), st.floats(0.01, 2))
def test_linear_models_are_exact(entries: list[float], scale: float) -> None:
    matrix = np.reshape(entries, (2, 3))
    covariance = scale * np.array([[1.0, 0.3, 0.0], [0.3, 2.0, -0.5], [0.0, -0.5, 1.5]])
    inputs = Inputs.of(a=1.0, b=-2.0, c=0.0).with_covariance("abc", covariance)
    result = propagate(
        lambda **x: {f"y{row}": sum(map(np.multiply, matrix[row], x.values())) for row in range(2)}, inputs
    )
    assert_allclose(result.covariance, matrix @ covariance @ matrix.T, atol=1e-7)
    assert_allclose(result.jacobian, matrix, atol=1e-8)


def test_pad_agrees_with_monte_carlo() -> None:
    mean, std = np.array([*PAD.values()], dtype=float).T
    correlations = {
        ("palmar", "distal"): 0.9,
        ("semi_major", "semi_minor"): 0.6,
        ("semi_major", "radial_ulnar"): -0.5,
    }
    correlation, names = np.eye(len(PAD)), list(PAD)
    for (one, other), value in correlations.items():
        correlation[names.index(one), names.index(other)] = value
        correlation[names.index(other), names.index(one)] = value
    draws = np.random.default_rng(11).multivariate_normal(mean, correlation * np.outer(std, std), 100_000)
    contact = observed(**dict(zip(names, draws.T, strict=True)))
    result = pad_uncertainty(**PAD, correlations=correlations)
    for name in result.names:
        assert_allclose(result[name].std, contact[name].std(), rtol=0.02, err_msg=name)


def test_values_are_those_of_the_ellipse() -> None:
    result, contact = pad_uncertainty(**PAD), observed(**EXACT)
    for name in result.names:
        assert_allclose(result[name].value, contact[name], rtol=1e-12, err_msg=name)


@pytest.mark.parametrize("semi_major", [5.0, 5.05, 5.25])
def test_corrected_radius_of_a_near_circle(semi_major: float) -> None:
    given = {**EXACT, "semi_major": (semi_major, 0.1), "semi_minor": (5.0, 0.1)}
    draws = np.random.default_rng(2).normal([semi_major, 5.0], 0.1, (200_000, 2)).T
    contact = observed(**{**EXACT, "semi_major": draws[0], "semi_minor": draws[1]})
    found = pad_uncertainty(**given)["radius_from_indentation"].std
    assert_allclose(found, contact["radius_from_indentation"].std(), rtol=0.02)


def test_elongation_alone_keeps_area() -> None:
    given = {**EXACT, "semi_major": (7.4, 0.074), "semi_minor": (5.0, 0.05)}
    inputs = pad_uncertainty(**given, correlations={("semi_major", "semi_minor"): -1.0}).inputs
    radius, elongation = inputs.std[inputs.places(["contact_radius", "elongation"])]
    assert radius < 1e-9
    assert_allclose(elongation, 0.02)


@pytest.mark.parametrize(
    "quantities",
    [
        EXACT,
        {**CIRCLE, "wedge_angle": 0.0, "roll_angle": 0.0},  # flat on the platen
        {**CIRCLE, "wedge_angle": np.pi / 2, "roll_angle": 0.0},  # on the tip
    ],
)
def test_jacobian_agrees_with_finite_differences(quantities: dict[str, float]) -> None:
    result = pad_uncertainty(**quantities)
    mean = result.inputs.mean

    def at(offset: np.ndarray) -> np.ndarray:
        return np.array([*pad_model(**dict(zip(result.inputs.names, mean + offset, strict=True))).values()])

    for column in range(mean.size):
        step = 1e-4 * np.eye(mean.size)[column]
        outer, inner = at(2 * step) - at(-2 * step), at(step) - at(-step)
        assert_allclose(result.jacobian[:, column], (8 * inner - outer) / 12e-4, rtol=1e-8, atol=1e-9)


def test_a_pad_whose_radii_deviate_from_the_ellipsoids() -> None:
    ball = {**EXACT, "palmar": 10.0, "distal": 10.0, "radial_ulnar": 10.0}
    along = pad_uncertainty(**ball, in_plane_deviation=(np.log(1.2), 0.1))
    assert_allclose(along["mean_curvature_radius"].value, 2 / (1 / 12 + 1 / 10))
    assert_allclose(along["geometric_mean_radius"].value, np.sqrt(120))
    # Of 1/H = (1/R' + 1/R'')/2 a radius has the share of its curvature.
    share = (1 / 12) / (1 / 12 + 1 / 10)
    assert_allclose(
        along["mean_curvature_radius"].std / along["mean_curvature_radius"].value, 0.1 * share, rtol=1e-4
    )
    assert_allclose(along.budget("mean_curvature_radius")["pad shape"], 1)
    both = pad_uncertainty(**ball, in_plane_deviation=np.log(1.2), transverse_deviation=np.log(1.2))
    larger = pad_uncertainty(**{**ball, "palmar": 12.0, "distal": 12.0, "radial_ulnar": 12.0})
    assert_allclose(both.value, larger.value, rtol=1e-12, atol=1e-15)


def test_propagation_agrees_with_uncertainties() -> None:
    uncertainties = pytest.importorskip("uncertainties")
    scale = uncertainties.ufloat(1.0, 0.02)
    axes = [7.4 * scale + uncertainties.ufloat(0, 0.05), 5.0 * scale]
    inputs = inputs_from_ufloats(semi_major=axes[0], load=2.0, semi_minor=axes[1])
    pressure = propagate(
        lambda load, semi_major, semi_minor: {"pressure": load / (np.pi * semi_major * semi_minor)}, inputs
    )
    expected = 2.0 / (np.pi * axes[0] * axes[1])
    assert_allclose(pressure["pressure"].value, expected.nominal_value)
    first_order = pressure.jacobian[0] @ inputs.covariance @ pressure.jacobian[0]
    assert_allclose(np.sqrt(first_order), expected.std_dev)


def test_round_trip() -> None:
    pytest.importorskip("uncertainties")
    given = Inputs.of(radius=(13.8, 0.2), depth=(2.1, 0.1), correlations={("depth", "radius"): 0.7})
    outputs = propagate(lambda radius, depth: {"radius": radius, "depth": depth}, given)
    again = inputs_from_ufloats(**correlated_values(outputs))
    assert again.names == ("radius", "depth")
    assert_allclose(again.mean, [13.8, 2.1])
    assert_allclose(again.covariance, [[0.04, 0.014], [0.014, 0.01]])
