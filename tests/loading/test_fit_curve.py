"""All quantities of a loading curve against the truth it was simulated from."""

import json
import math
import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose
from tests.loading.options import DEEP

from fingerpad import Ellipsoid, Estimate, Placement, Tissue, hertz_contact
from fingerpad._json import dumps
from fingerpad.exceptions import LoadingError
from fingerpad.loading import LoadingCurve, LoadingFit, fit_loading_curve
from fingerpad.loading.contact_point import contact_by_threshold
from fingerpad.simulate import simulate_loading_curve

NOISE = {"force_std": 0.005, "displacement_std": 0.005, "area_std": 1.0, "force_tilt": 0.01}
CURVE = simulate_loading_curve(points=120, seed=3, **NOISE)


@cache
def fit_of_curve() -> LoadingFit:
    return fit_loading_curve(CURVE)


def test_a_long_record_with_areas_in_some_rows() -> None:
    long = simulate_loading_curve(points=24_000, seed=4, **NOISE)
    area = np.where(np.arange(long.load.size) % 50 == 0, long.area, np.nan)
    fit = fit_loading_curve(replace(long, area=area), **DEEP)
    for name, value in {"loading_radius": 15.0, "youngs_modulus": 0.08, "contact_offset": 1.0}.items():
        found = getattr(fit, name)
        assert abs(found.value - value) < 3 * found.std, name
    # As of a line of areas with 1 mm² of noise, whose zero is free.
    depth = long.indentation[::50][long.indentation[::50] > 1]
    spread = np.sqrt(depth.size) * np.std(depth)
    assert fit.loading_radius.std == pytest.approx(1 / (np.pi * spread), rel=0.2)
    assert " rows, each the mean of 6, loads from " in fit.summary()


def test_a_compressible_pad_has_its_modulus() -> None:
    curve = simulate_loading_curve(points=60, poisson_ratio=0.3)
    fit = fit_loading_curve(curve, poisson_ratio=0.3, **DEEP)
    assert_allclose(fit.initial_modulus.value, 0.04, rtol=1e-3)


def test_two_rows_beyond_the_noise_are_no_contact() -> None:
    displacement = np.linspace(0, 2, 101)
    load = 0.001 * (-1.0) ** np.arange(101) + np.maximum(displacement - 1.2, 0)
    load[[40, 41, 50]] += 0.1
    assert contact_by_threshold(displacement, load) == pytest.approx(1.22, abs=0.021)


def test_a_curve_that_begins_at_contact_is_fitted() -> None:
    """Displacements that were set to zero at contact put it where a step in proportion is none."""
    displacement = np.linspace(0, 2.4, 201).round(4)
    noise = 0.002 * np.sin(0.4 * np.arange(201))
    load = (0.45 * displacement**1.5 + noise).round(4)
    fit = fit_loading_curve(LoadingCurve(load=load, indentation=displacement), **DEEP)
    assert abs(fit.contact_offset.value) < fit.contact_offset.std < 0.05


def test_growing_modulus() -> None:
    fit = fit_of_curve()
    assert fit.preferred_model == "load_dependent"
    assert "modulus_depends_on_load" in fit.flags
    assert fit.load_exponent.lower > 1.5
    assert fit.area_exponent.upper < 2 / 3


def test_given_radius_uncertainty() -> None:
    bare = replace(CURVE, area=None)
    sure, unsure = (
        fit_loading_curve(bare, loading_radius=Estimate.symmetric(15.0, std), **DEEP) for std in (0.0, 1.5)
    )
    # E goes as R^-1/2 for a given curve: 10 % of the radius are 5 % of the modulus.
    added = np.sqrt(unsure.youngs_modulus.std**2 - sure.youngs_modulus.std**2)
    assert_allclose(added / unsure.youngs_modulus.value, 0.05, rtol=0.05)
    # The force is measured: another radius asks for another modulus, and for the same load.
    assert_allclose(unsure.predict(1.0).std, sure.predict(1.0).std, rtol=0.01)
    assert_allclose(sure.youngs_modulus.value, 0.08, rtol=0.15)
    four = fit_loading_curve(bare, loading_radius=60.0, **DEEP)
    assert_allclose(four.youngs_modulus.value, sure.youngs_modulus.value / 2, rtol=1e-3)


def test_the_record_has_each_number_with_its_interval() -> None:
    fit = fit_of_curve()
    record = json.loads(dumps(fit.as_record()))
    names = [key.removesuffix("_ci95") for key in record if key.endswith("_ci95")]
    assert len(names) >= 8
    for name in names:
        low, high = record[f"{name}_ci95"]
        assert low < record[name] < high
        assert 1.5 * record[f"{name}_std"] < high - low
    assert_allclose(record["initial_modulus_kpa"], 1000 * fit.initial_modulus.value)
    assert record["reasons"] == {}


def test_load_range_found_or_given() -> None:
    curve = simulate_loading_curve(points=120, top_load=4.0, seed=1, **NOISE)
    # From 2 N on the pad is made ever softer than its law.
    soft = np.where(curve.load > 2, curve.load / (1 + 0.9 * (curve.load - 2)), curve.load)
    fit = fit_loading_curve(replace(curve, load=soft), **DEEP)
    assert "modulus_partly_decreases" in fit.flags
    assert fit.fit_load_range[1] < 2.4
    blind = fit_loading_curve(replace(curve, load=soft), fit_load_range=(0.0, 10.0), **DEEP)
    assert abs(fit.initial_modulus.value - 0.04) < 0.5 * abs(blind.initial_modulus.value - 0.04)
    given = fit_loading_curve(CURVE, fit_load_range=(0.0, 1.0))
    assert "region_given" in given.flags
    assert given.modulus_load < 1.05
    assert given.load_coefficient.std > fit_of_curve().load_coefficient.std


@pytest.mark.parametrize("offset", [-12.0, 12.0])
def test_area_before_contact_flagged(offset: float) -> None:
    assert "area_offset" not in fit_of_curve().flags
    moved = replace(CURVE, area=np.maximum(CURVE.area + offset, 0))
    assert "area_offset" in fit_loading_curve(moved, **DEEP).flags


def test_chosen_estimator_uncertainty() -> None:
    fit = fit_of_curve()
    held = fit_loading_curve(CURVE, contact_point="contact_by_threshold")
    assert held.contact_offset.value > fit.contact_offset.value  # a threshold is always late
    assert held.initial_modulus.std > 3 * fit.initial_modulus.std


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"curve": "curve.csv"}, "curve must be a LoadingCurve, found str: `read_loading_curve` reads"),
        ({"curve": replace(CURVE, time=np.ones(120))}, "the time is 1 s in every row"),
        ({"poisson_ratio": 0.6}, "poisson_ratio must be"),
        ({"poisson_ratio": np.nan}, "poisson_ratio must be"),
        ({"contact_point": "eye"}, "contact_point must be joint, contact_by_threshold"),
        ({"loading_radius": -3.0}, "loading_radius must be positive"),
        ({"loading_radius": np.nan}, "loading_radius must be positive"),
        ({"fit_load_range": (1.0, 0.5)}, "fit_load_range must be two rising loads"),
        # Given in another unit.
        ({"area_delay": 50.0}, "area_delay is 50 s, and the whole record lasts .* 0.05 for 50 ms"),
        ({"stage_compliance": 100.0}, "stage_compliance of 100 mm/N is .* mm/N, 0.1 for 100 µm/N"),
        ({"stage_compliance": -1.0}, "stage_compliance must not be negative, found -1"),
        ({"thickness": 4000.0}, "thickness is 4000 mm, .* 4 for 4000 µm, or inf for a half-space"),
    ],
)
def test_invalid_options(options: dict, message: str) -> None:
    with pytest.raises(LoadingError, match=message):
        fit_loading_curve(**{"curve": CURVE, **options})


def test_constraint_coefficient() -> None:
    fit = fit_of_curve()
    free = fit.divide_by_constraint(Estimate.symmetric(2.0, 0.5))
    for name in ("reduced_modulus", "youngs_modulus", "initial_modulus", "load_coefficient"):
        before, after = getattr(fit, name), getattr(free, name)
        assert after.value == pytest.approx(before.value / 2)
        assert after.std / after.value == pytest.approx(math.hypot(before.std / before.value, 0.25))
        assert after.lower < after.value < after.upper
    assert free.loading_radius == fit.loading_radius
    assert free.contact_offset == fit.contact_offset
    assert "constraint_assumed" in free.flags
    exact = fit.divide_by_constraint(Estimate.symmetric(2.0, 0.0)).youngs_modulus
    assert exact.upper - exact.lower == pytest.approx(
        (fit.youngs_modulus.upper - fit.youngs_modulus.lower) / 2
    )
    with pytest.raises(LoadingError, match="must be positive, found 0"):
        fit.divide_by_constraint(Estimate.symmetric(0.0, 0.0))


def test_repeated_times_are_spread() -> None:
    curve = simulate_loading_curve(points=120, force_std=0.004, area_std=0.5, seed=3)
    fine, coarse = (
        fit_loading_curve(replace(curve, time=time), **DEEP)
        for time in (curve.time, np.floor(curve.time / 0.05) * 0.05)
    )
    assert "duplicated_time" in coarse.flags
    assert abs(coarse.loading_radius.value - fine.loading_radius.value) < 0.2 * fine.loading_radius.std


def test_implausible_units_flagged() -> None:
    curve = simulate_loading_curve(points=60, force_std=0.004, area_std=0.5, seed=3)
    for change, given, flag in (
        ({"area": curve.area / 100}, {}, "implausible_radius"),
        ({"load": 1000 * curve.load}, {}, "implausible_modulus"),
        ({}, {"loading_radius": 18.0}, "radius_contradicts_area"),
    ):
        assert flag in fit_loading_curve(replace(curve, **change), **given, **DEEP).flags
    right = fit_loading_curve(curve, loading_radius=15.0, **DEEP)
    assert not {"radius_contradicts_area", "implausible_radius"} & set(right.flags)


def test_a_modulus_that_falls_with_load_is_not_said_to_grow() -> None:
    fit = fit_loading_curve(yielding(stage_compliance=0.1, seed=1))
    assert "modulus_falls_with_load" in fit.flags
    assert "modulus_depends_on_load" not in fit.flags
    assert fit.load_coefficient.value < 0
    assert "grows with load" not in fit.summary().replace("modulus growing with load", "")
    assert "semi-axes" not in fit.summary()


def yielding(*, stage_compliance: float, seed: int) -> LoadingCurve:
    """Return a Hertzian press whose displacement has what the stage yields."""
    truth = {"points": 150, "load_coefficient": 0.0, "seed": seed}
    elastic = simulate_loading_curve(**truth).load
    curve = simulate_loading_curve(**truth, force_std=0.004, displacement_std=0.002, area_std=1.0)
    return replace(curve, indentation=curve.indentation + stage_compliance * elastic)


def test_the_exponent_of_the_load_holds_a_stage_that_yields() -> None:
    exponent = fit_loading_curve(yielding(stage_compliance=0.03, seed=2)).load_exponent
    assert exponent.lower < 1.5 < exponent.upper


@pytest.mark.parametrize(
    ("truth", "words"),
    [
        ({"relaxation": [(0.5, 1.0)]}, "the force grows as ξ\\^1.3"),
        (
            {"relaxation": [(0.3, 1.0)], "hold": 1.0, "unloading": True, "hysteresis": 0.0},
            "gives back 79 % of",
        ),
        ({"load_coefficient": 0.02, "unloading": True}, ""),
        ({"unloading": True}, ""),
    ],
)
def test_a_pad_that_relaxes_is_flagged_and_an_elastic_one_is_not(truth, words) -> None:
    noise = {"force_std": 0.005, "displacement_std": 0.003, "area_std": 1.0}
    pad = {"load_coefficient": 0.0, "rate": 0.5, "points": 200} | truth
    fit = fit_loading_curve(simulate_loading_curve(**pad, **noise, seed=1), **DEEP)
    assert ("relaxes" in fit.flags) == bool(words)
    assert re.search(words, fit.notes.get("relaxes", ""))
    assert "modulus_falls_with_load" not in fit.flags


@pytest.mark.parametrize(("axes", "wedge_angle"), [((7.5, 14.0, 9.0), 0.5), ((6.0, 16.0, 11.0), 0.2)])
def test_with_the_shape_of_the_pad_moduli_are_those_of_its_ellipse(axes, wedge_angle) -> None:
    placement = Placement(Ellipsoid(*axes), wedge_angle=wedge_angle)
    contact = hertz_contact(placement, Tissue(0.06, 0.5), load=np.linspace(1e-3, 2, 100))
    before = np.zeros(40)
    curve = LoadingCurve(
        load=np.r_[before, contact.load] + np.random.default_rng(2).normal(0, 1e-3, 140),
        indentation=np.r_[np.linspace(-0.5, 0, 40), contact.indentation],
        area=np.r_[before, contact.area],
    )
    ellipse, sphere = (fit_loading_curve(curve, placement=one, **DEEP) for one in (placement, None))
    assert_allclose(ellipse.youngs_modulus.value, 0.06, rtol=2e-3)
    for name in ("youngs_modulus", "reduced_modulus", "initial_modulus"):
        ratio = getattr(ellipse, name).value / getattr(sphere, name).value
        assert_allclose(ratio, ellipse.shape_factor, rtol=1e-12)
    assert ellipse.shape_factor < 0.997 < sphere.shape_factor == 1
    assert_allclose(ellipse.secant.modulus[-20:], 0.06, rtol=0.01)


def test_fit_of_each_cycle() -> None:
    curve = simulate_loading_curve(points=450, cycles=2, unloading=True, seed=4, **NOISE)
    for cycle in (0, 1):
        fit = fit_loading_curve(curve, cycle=cycle, **DEEP)
        assert abs(fit.loading_radius.value - 15) < 4 * fit.loading_radius.std
