"""The models of pads: an observed ellipse, a measured indentation and a placement, by other routes."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from fingerpad.contact import Tissue, fast_contact, hertz_contact, youngs_modulus
from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.uncertainty import (
    LAYER_OUTPUTS,
    LAYER_SOURCES,
    Inputs,
    layer_flag,
    layer_model,
    pad_model,
    pad_uncertainty,
    placement_model,
    propagate,
    run_monte_carlo,
)
from fingerpad.uncertainty.models import indentation_model

AXES = {"palmar": 7.9, "distal": 13.8, "radial_ulnar": 11.8}


def seen(*, semi_major, semi_minor, axes=AXES, **given) -> SimpleNamespace:
    """Return the outputs of the model for an observed ellipse."""
    return SimpleNamespace(
        **pad_model(
            **axes,
            **{"roll_angle": 0.0, "poisson_ratio": 0.5, "image_scale": 1.0, "edge_offset": 0.0} | given,
            contact_radius=np.sqrt(semi_major * semi_minor),
            elongation=np.log(semi_major / semi_minor),
        )
    )


@given(st.floats(0, 1.5), st.floats(-1, 1), st.floats(0.1, 5), st.floats(0.02, 0.5))
def test_hertzian_pad_round_trip(wedge: float, roll: float, load: float, modulus: float) -> None:
    placement = Placement(Ellipsoid(**AXES), wedge_angle=wedge, roll_angle=roll)
    truth = hertz_contact(placement, Tissue.of_reduced_modulus(modulus), load=load)
    found = seen(
        wedge_angle=wedge,
        roll_angle=roll,
        load=load,
        semi_major=truth.semi_major,
        semi_minor=truth.semi_minor,
    )
    assert_allclose(found.indentation, truth.indentation, rtol=1e-12)
    assert_allclose(found.reduced_modulus, modulus, rtol=1e-12)
    assert_allclose(found.mean_pressure, truth.mean_pressure, rtol=1e-12)
    ratio = np.exp(np.abs(found.predicted_elongation))
    assert_allclose(ratio, truth.semi_major / truth.semi_minor, rtol=1e-12)
    if ratio > 1 + 1e-9:
        assert (found.predicted_elongation > 0) == truth.along
    assert_allclose(
        found.geometric_radius_from_compliance, truth.area / (np.pi * truth.indentation), rtol=1e-12
    )


def test_order_of_observed_axes() -> None:
    straight, swapped = (
        seen(wedge_angle=0.5, load=2.0, semi_major=a, semi_minor=b) for a, b in ((7.4, 5.0), (5.0, 7.4))
    )
    assert straight.radius_from_indentation == pytest.approx(swapped.radius_from_indentation, rel=1e-14)
    assert straight.indentation == pytest.approx(swapped.indentation, rel=1e-14)


@pytest.mark.parametrize("wedge_deg", [0.0, 30.0, 60.0, 90.0])
@pytest.mark.parametrize("roll_deg", [-40.0, 0.0, 25.0])
def test_equals_placement(wedge_deg, roll_deg):
    axes = {"palmar": 7.9, "distal": 13.8, "radial_ulnar": 11.8}
    angles = {"wedge_angle": np.radians(wedge_deg), "roll_angle": np.radians(roll_deg)}
    found = placement_model(**axes, **angles)
    placement = Placement(Ellipsoid(**axes), **angles)
    for name in found.keys() - {"u"}:
        assert found[name] == pytest.approx(float(getattr(placement.curvature, name)))
    assert found["u"] == pytest.approx(float(placement.u))


def pressed(thickness, thickness_std=0.0, contact_shift=0.1) -> Inputs:
    placed = {"wedge_angle": (0.6, 0.01), "roll_angle": 0.0, "poisson_ratio": 0.49}
    lengths = {name: (value, 0.1) for name, value in AXES.items()}
    press = {"load": (2.0, 0.04), "indentation": (1.7, 0.05), "contact_shift": contact_shift}
    return Inputs.of(**lengths, **placed, **press, thickness=(thickness, thickness_std))


def test_moduli_from_a_measured_indentation() -> None:
    found = propagate(indentation_model, pressed(8.0))
    placement = Placement(Ellipsoid(**AXES), wedge_angle=0.6)
    hertz = 2.0 / hertz_contact(placement, Tissue(1.0, 0.49), indentation=1.7).load
    layered = youngs_modulus(placement, load=2.0, indentation=1.8, thickness=8.0, poisson_ratio=0.49)
    contact = fast_contact(placement, Tissue(layered, 0.49, 8.0), indentation=1.8)
    expected = hertz, layered, contact.area_over_pi_indentation
    assert_allclose(found.value, expected, rtol=1e-12)
    assert found.value[1] < 0.6 * found.value[0]
    deep = propagate(indentation_model, pressed(1e4, contact_shift=0.0))
    assert deep.value[1] == pytest.approx(deep.value[0], rel=0.06)  # the true shape alone


# The pad on a layer as a model: first order against Monte Carlo and against differences, and its budget


MEASURED = {
    **{name: (value, 0.1) for name, value in AXES.items()},
    "wedge_angle": (math.radians(30), math.radians(1)),
    "poisson_ratio": (0.47, 0.01),
    "image_scale": (1.0, 0.01),
    "load": (2.0, 0.05),
    "semi_major": (7.4, 0.1),
    "semi_minor": (5.0, 0.1),
}


def inputs(thickness=8.0, std=0.8, **changes) -> Inputs:
    return pad_uncertainty(**{**MEASURED, **changes}, thickness=(thickness, std)).inputs


def test_a_thickness_adds_to_what_hertz_theory_says() -> None:
    deep, layered = pad_uncertainty(**MEASURED), pad_uncertainty(**MEASURED, thickness=(8.0, 0.8))
    assert layered.names == (*deep.names, *LAYER_OUTPUTS)
    assert_allclose(layered.value[: len(deep.names)], deep.value, rtol=1e-14)
    assert_allclose(layered.std[: len(deep.names)], deep.std, rtol=1e-12)
    assert_allclose(layered.covariance, propagate(layer_model, layered.inputs).covariance)
    with pytest.raises(GeometryError, match="thickness must be positive, found -8"):
        pad_uncertainty(**MEASURED, thickness=-8.0)


@pytest.mark.parametrize("name", LAYER_OUTPUTS)
def test_budget_of_the_thickness_is_its_own_effect(name: str) -> None:
    found = propagate(layer_model, inputs())
    thin, thick = (propagate(layer_model, inputs(t, 0.0)) for t in (7.2, 8.8))
    alone = (thick[name].value - thin[name].value) / 2
    shares = found.budget(name)
    assert set(shares) == set(LAYER_SOURCES)
    assert sum(shares.values()) == pytest.approx(1)
    assert shares["thickness"] == pytest.approx((alone / found[name].std) ** 2, rel=0.05)
    assert propagate(layer_model, inputs(std=0.0)).budget(name)["thickness"] == 0


def test_incompressible_tissue_may_have_an_uncertain_poisson_ratio() -> None:
    found = propagate(layer_model, inputs(poisson_ratio=(0.5, 0.02)))
    below = propagate(layer_model, inputs(poisson_ratio=(0.48, 0.0)))
    exact = propagate(layer_model, inputs(poisson_ratio=0.5))
    name = "youngs_modulus_on_layer"
    share = found.budget(name)["Poisson's ratio"]
    step = abs(float(below[name].value - exact[name].value))
    assert step < math.sqrt(share) * found[name].std < 1.5 * step


def test_flags_are_named_for_each_contact() -> None:
    many = inputs(thickness=[8.0, 1.0, 8.0], std=0.0, load=([2.0, 2.0, 0.0], 0.1))
    assert layer_flag(many).tolist() == ["", "layer_too_thin", "no_contact"]
    found = propagate(layer_model, many)
    value = found.value[:, [found.place(name) for name in LAYER_OUTPUTS]]
    assert np.isfinite(value[0]).all()
    assert np.isnan(value[1:]).all()


ROUND = {"palmar": 13.7, "distal": 13.7, "radial_ulnar": 13.7}


@pytest.mark.parametrize(
    ("axes", "wedge_deg"),
    [
        (ROUND, 0),
        (ROUND, 30),
        (ROUND, 90),
        (ROUND | {"distal": 13.8, "radial_ulnar": 13.6}, 0),
        (ROUND | {"palmar": 12.0}, 0),  # two equal curvatures, at the end of an axis
        (ROUND | {"palmar": 12.0, "radial_ulnar": 12.0}, 90),
    ],
)
def test_pads_whose_curvatures_are_equal_have_the_derivatives_of_others(axes, wedge_deg) -> None:
    pad = {name: (value, 0.2) for name, value in axes.items()}
    ellipse = {"semi_major": (5.08, 0.05), "semi_minor": (5.06, 0.05)}
    shape = {
        "in_plane_deviation": (0.0, 0.02),
        "transverse_deviation": (0.0, 0.02),
        "roll_angle": (0.0, 0.02),
    }
    wedge = math.radians(wedge_deg), math.radians(1)
    at = inputs(4.0, 0.2, **pad, **ellipse, **shape, wedge_angle=wedge, load=(1.5, 0.0))
    found = propagate(layer_model, at)
    step = 1e-5 * np.eye(len(at.names))
    ends = [propagate(layer_model, replace(at, mean=at.mean + sign * step)).value for sign in (1, -1)]
    assert_allclose(found.jacobian, (ends[0] - ends[1]).T / 2e-5, rtol=1e-4, atol=1e-6)
    drawn = run_monte_carlo(layer_model, at, seed=1, max_draws=40_000)
    assert drawn.undefined == 0
    names = [name for name in found.names if name != "predicted_elongation"]  # its draws have a kink in roll
    for name in names:
        assert found[name].std == pytest.approx(drawn[name].std, rel=0.03), name
