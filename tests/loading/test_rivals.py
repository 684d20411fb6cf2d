"""Other explanations of a curve, on curves of `benchmarks.truth.loading_physics`, which is none of them."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from benchmarks.claims.loading_truth import CONDITIONS, make_curve
from benchmarks.truth.loading_physics import Pad, exact_sphere, layer

from fingerpad import Estimate
from fingerpad.loading import LoadingCurve, fit_loading_curve
from fingerpad.loading.laws import shape_factors
from fingerpad.loading.rivals import akaike_weights, average_models

PAD = Pad(radius=15.0, modulus=0.05)


def curve_of(name: str):
    return make_curve(CONDITIONS[name], PAD, 0.3, np.random.default_rng(1))


@pytest.mark.parametrize(
    ("name", "explanation"),
    [
        ("exact sphere", "a sphere instead of its paraboloid"),
        ("layer of 8 mm on bone", "a layer of tissue on bone"),
        ("A ∝ W^0.42", "an area that is not proportional to indentation"),
    ],
)
def test_a_wrong_model_is_named_and_its_intervals_hold_the_truth(name, explanation) -> None:
    fit = fit_loading_curve(curve_of(name))
    assert "misfit" in fit.flags
    assert explanation in fit.notes["misfit"]
    assert fit.initial_modulus.lower < PAD.modulus < fit.initial_modulus.upper
    assert fit.loading_radius.lower < PAD.radius < fit.loading_radius.upper
    assert 0 < fit.misfit_std["loading_radius"] < fit.loading_radius.std


def pressed(grown, seed: int) -> LoadingCurve:
    """Return a Hertzian press of PAD of 600 rows, its load grown by a factor of the indentation in mm."""
    rng = np.random.default_rng(seed)
    travel = np.linspace(-0.6, 1.6, 600)
    xi = np.maximum(travel, 0)
    load = 4 / 3 * PAD.reduced * np.sqrt(PAD.radius) * xi**1.5 * grown(xi)
    return LoadingCurve(
        load=load + rng.normal(0, 0.004, 600),
        indentation=travel + 0.3 + rng.normal(0, 0.003, 600),
        area=np.where(xi > 0, np.pi * PAD.radius * xi + rng.normal(0, 0.7, 600), 0),
        time=travel + 1,
    )


@pytest.mark.parametrize(
    "seed", [0, *(pytest.param(seed, marks=pytest.mark.nightly) for seed in range(1, 6))]
)
@pytest.mark.parametrize(
    "grown", [lambda xi: np.exp(0.8 * xi), lambda xi: (xi / 1.6 + 1e-9) ** 0.6], ids=["exponential", "power"]
)
def test_tissue_that_stiffens_by_another_law_is_held(grown, seed) -> None:
    """The law's misfit was taken for drift of the force, and moved the modulus out of its interval."""
    fit = fit_loading_curve(pressed(grown, seed))
    depth = np.interp(fit.modulus_load, *truth_of(grown))
    modulus = PAD.modulus * float(grown(depth))
    assert fit.youngs_modulus.lower < modulus < fit.youngs_modulus.upper
    assert fit.contact_offset.lower < 0.3 < fit.contact_offset.upper


def truth_of(grown):
    """Return loads and indentations of a press of PAD."""
    xi = np.linspace(0, 2, 2000)
    return 4 / 3 * PAD.reduced * np.sqrt(PAD.radius) * xi**1.5 * grown(xi), xi


def test_a_slip_is_flagged() -> None:
    fit = fit_loading_curve(pressed(lambda xi: np.where(xi > 1.2, 0.85, 1), 1))
    assert not {"misfit", "modulus_partly_decreases"}.isdisjoint(fit.flags)


@pytest.mark.parametrize("areas", [True, False])
def test_thin_tissue_is_held_by_the_uncertainty(areas) -> None:
    curve, given = curve_of("layer of 2 mm on bone"), None
    if not areas:
        curve, given = replace(curve, area=None), Estimate.symmetric(15.0, 0.3)
    fit = fit_loading_curve(curve, loading_radius=given)
    assert fit.load_exponent.lower > 1.6
    assert fit.initial_modulus.lower < PAD.modulus < fit.initial_modulus.upper
    assert "--semi-axes-mm" in fit.summary()


def test_a_modulus_is_not_stated_where_tissue_is_thinner_than_any() -> None:
    pad, rng = Pad(radius=14.5, modulus=0.086), np.random.default_rng(1)
    xi, load, area = layer(0.8)(pad, 2.0)
    travel = np.linspace(-0.3, np.interp(2.0, load, xi), 200)
    fit = fit_loading_curve(
        LoadingCurve(
            load=np.interp(travel, xi, load) + rng.normal(0, 0.005, 200),
            indentation=travel,
            area=np.interp(travel, xi, area) + rng.normal(0, 1, 200),
        )
    )
    assert fit.loading_radius.known
    for estimate in (fit.initial_modulus, fit.youngs_modulus, fit.reduced_modulus, fit.load_coefficient):
        assert "--semi-axes-mm" in estimate.reason


@pytest.mark.parametrize("name", ["Hertz, no baseline", "growing modulus, no baseline"])
def test_without_a_baseline_the_zero_of_the_force_is_in_the_uncertainty(name) -> None:
    pad = replace(PAD, slope=CONDITIONS[name].slope * PAD.modulus)
    fit = fit_loading_curve(make_curve(CONDITIONS[name], pad, 0.3, np.random.default_rng(1)))
    assert "no_baseline" in fit.flags
    assert fit.initial_modulus.lower < pad.modulus < fit.initial_modulus.upper
    assert abs(fit.initial_modulus.value / pad.modulus - 1) < 0.1
    assert fit.contact_offset.lower < 0.3 < fit.contact_offset.upper


def test_late_areas_do_not_move_the_contact_of_the_force() -> None:
    late = fit_loading_curve(curve_of("area 100 ms late"))
    assert "area_offset" in late.flags
    (milliseconds,) = re.findall(r"as of areas (\d+) ms late", late.notes["area_offset"])
    assert 70 < int(milliseconds) < 130
    assert late.contact_offset.lower < 0.3 < late.contact_offset.upper
    given = fit_loading_curve(curve_of("area 100 ms late"), area_delay=0.1)
    assert "area_offset" not in given.flags
    assert given.contact_offset.lower < 0.3 < given.contact_offset.upper
    assert given.contact_offset.std < 0.6 * late.contact_offset.std


def test_a_given_compliance_of_the_stage_is_corrected_for_with_its_uncertainty() -> None:
    curve = curve_of("stage yields 0.06 mm/N")
    exact, vague = (
        fit_loading_curve(curve, stage_compliance=Estimate.symmetric(0.06, std), thickness=math.inf)
        for std in (0.0, 0.02)
    )
    assert abs(exact.loading_radius.value - PAD.radius) < 3 * exact.loading_radius.std
    assert vague.loading_radius.std > 2 * exact.loading_radius.std


@pytest.mark.parametrize(
    ("law", "values", "contact", "tolerance"),
    [
        ("exact_sphere", {}, exact_sphere, 1e-6),
        ("load_dependent", {"inverse_thickness": 1 / 8}, layer(8.0), 3e-3),
        ("exact_sphere", {"inverse_thickness": 1 / 8}, layer(8.0, sphere=True), 5e-3),
    ],
)
def test_factors_agree_with_an_independent_solution(law, values, contact, tolerance) -> None:
    xi, load, area = (column[300:3000:300] for column in contact(PAD, 2.0))
    of_load, of_area = shape_factors(law, {"loading_radius": 15.0, **values}, xi, 0.5)
    assert of_load * 4 / 3 * PAD.reduced * np.sqrt(15) * xi**1.5 == pytest.approx(load, rel=tolerance)
    assert of_area * np.pi * 15 * xi == pytest.approx(area, rel=tolerance)


@pytest.mark.parametrize("name", ["sphere on a layer of 15 mm", "sphere on a layer of 8 mm"])
def test_bone_and_the_shape_of_the_pad_together_are_within_the_interval(name: str) -> None:
    fit = fit_loading_curve(curve_of(name))
    assert fit.initial_modulus.lower < PAD.modulus < fit.initial_modulus.upper
    assert fit.loading_radius.lower < PAD.radius < fit.loading_radius.upper
    assert fit.initial_modulus.value > 1.2 * PAD.modulus


def test_a_sphere_lies_on_the_stated_layer() -> None:
    fit = fit_loading_curve(curve_of("sphere on a layer of 8 mm"), thickness=8.0)
    found = fit.alternatives
    assert min(found, key=lambda name: found[name].aicc) == "exact_sphere"
    assert fit.flags == ("misfit",)  # areas that a sphere explains far better are not called late
    assert fit.initial_modulus.lower < PAD.modulus < fit.initial_modulus.upper


def without_areas(name: str):
    radius = Estimate.symmetric(1.02 * PAD.radius, 0.03 * PAD.radius)
    return fit_loading_curve(replace(curve_of(name), area=None), loading_radius=radius)


def test_a_layer_that_no_area_tells_from_a_growing_modulus_is_within_the_interval() -> None:
    fit = without_areas("layer of 8 mm on bone")
    assert "untested_without_area" in fit.flags
    assert fit.initial_modulus.lower < PAD.modulus < fit.initial_modulus.upper
    assert fit.initial_modulus.value > 1.5 * PAD.modulus
    # What a layer cannot have made is not widened.
    grows = without_areas("growing modulus, white noise")
    assert grows.initial_modulus.lower < PAD.modulus < grows.initial_modulus.upper
    assert grows.initial_modulus.upper < 1.2 * PAD.modulus


def test_a_zero_that_drifts_may_bend() -> None:
    warm, steady = (
        fit_loading_curve(curve_of(name)) for name in ("force warms up by 40 mN", "Hertz, white noise")
    )
    assert warm.initial_modulus.lower < PAD.modulus < warm.initial_modulus.upper
    curve = curve_of("Hertz, white noise")
    drifts = fit_loading_curve(replace(curve, load=curve.load + 0.03 * curve.time))
    assert drifts.initial_modulus.std > 1.5 * steady.initial_modulus.std
    assert abs(drifts.initial_modulus.value / steady.initial_modulus.value - 1) < 1e-3


def test_akaike_weights_fall_by_exp_of_half_the_difference() -> None:
    weights = akaike_weights([100.0, 102.0, math.inf])
    assert sum(weights) == pytest.approx(1)
    assert weights[1] / weights[0] == pytest.approx(math.exp(-1))
    assert weights[2] == 0


def test_mean_variance_and_interval_are_those_of_the_mixture() -> None:
    models = [Estimate.symmetric(40.0, 1.0), Estimate.symmetric(44.0, 2.0), Estimate.symmetric(30.0, 0.5)]
    weights = [0.5, 0.3, 0.2]
    rng = np.random.default_rng(1)
    drawn = np.concatenate(
        [rng.normal(one.value, one.std, int(400_000 * w)) for one, w in zip(models, weights, strict=True)]
    )
    found = average_models(models, weights)
    assert (found.value, found.std) == pytest.approx((drawn.mean(), drawn.std()), rel=0.005)
    assert (found.lower, found.upper) == pytest.approx(tuple(np.quantile(drawn, [0.025, 0.975])), rel=0.003)
    stated = average_models(models, weights, value=40.0)
    assert stated.value == 40.0
    assert stated.std == pytest.approx(math.hypot(found.std, found.value - 40.0))


def test_an_interval_holds_the_stated_value_where_its_model_has_no_weight() -> None:
    found = average_models(
        [Estimate.symmetric(40.0, 1.0), Estimate.symmetric(60.0, 1.0)], [0.0, 1.0], value=40.0
    )
    assert (found.lower, found.value) == (40.0, 40.0)
    assert found.upper == pytest.approx(61.96, abs=0.01)
    assert found.std == pytest.approx(math.hypot(20.0, 1.0))


def test_an_end_is_open_where_a_model_of_weight_leaves_it_open() -> None:
    closed = Estimate.symmetric(8.0, 1.0)
    unbounded = Estimate(value=12.0, std=4.0, interval=(6.0, math.inf))
    assert average_models([closed, unbounded], [0.9, 0.1]).upper == math.inf
    assert average_models([closed, unbounded], [0.99, 0.01]).upper < 12
    assert average_models([closed, unbounded], [0.9, 0.1]).lower == pytest.approx(6.0, abs=0.2)


def test_exact_models_are_averaged() -> None:
    found = average_models([Estimate.symmetric(2.0, 0.0), Estimate.symmetric(4.0, 0.0)], [0.5, 0.5])
    assert (found.value, found.std) == (3.0, 1.0)
    assert (found.lower, found.upper) == pytest.approx((2.0, 4.0))


def test_smoothed_areas_are_flagged() -> None:
    curve = curve_of("Hertz, white noise")
    assert curve.area is not None
    noise = np.random.default_rng(5).normal(size=len(curve.area) + 20)
    smooth = np.convolve(noise, np.ones(21) / 4.6, "valid")
    ideal = curve.area - (curve.area - np.pi * 15 * np.maximum(curve.indentation - 0.3, 0))
    assert "correlated_area" in fit_loading_curve(replace(curve, area=ideal + smooth)).flags
