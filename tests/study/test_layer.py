"""Fingers whose thickness is stated: rows, pooling, loading curves and tables of the layer."""

import math
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator
from tests.studies import Table, contact, curve, finger, run, summary_of, write_numbers

from fingerpad.contact import Tissue, fast_contact, solve_contact, youngs_modulus
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.study.results.layer import POOLED_ON_LAYER, LayerQuantity, curve_on_layer
from fingerpad.study.results.study_result import StudyResult
from fingerpad.study.results.summary_file import CurveOnLayerRecord
from fingerpad.study.results.table import COLUMNS, records
from fingerpad.uncertainty import LAYER_SOURCES

PAD = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
THICK = {"effective_thickness_mm": 8.0, "effective_thickness_mm_std": 0.8}
LAYER = [name for name, column in COLUMNS.items() if column.group == "layer"]


def study(
    folder: Path,
    thickness: dict[str, float] = THICK,
    *tables: Table,
    contacts=((2, 7.4),),
    axes_std: float = 0.1,
    top: dict[str, float] | None = None,
    **uncertainty: object,
) -> StudyResult:
    presses = (contact(f"c{number}", load, (major, 5.0)) for number, (load, major) in enumerate(contacts))
    stated = {"wedge_angle_deg_std": 0.5, "load_relative_std": 0.02, **uncertainty}
    return run(
        folder, finger(std=axes_std, **thickness), *presses, *tables, uncertainty=stated, **(top or {})
    )


def test_rows_have_both_theories(tmp_path):
    (row,) = records(study(tmp_path).rows)
    placement, area = Placement(PAD, wedge_angle=math.radians(30)), math.pi * 7.4 * 5.0
    modulus = youngs_modulus(placement, load=2.0, area=area, thickness=8.0)
    found = fast_contact(placement, Tissue(modulus, thickness=8.0), area=area)
    assert row["youngs_modulus_on_layer_kpa"] == pytest.approx(1000 * modulus)
    assert row["indentation_on_layer_mm"] == pytest.approx(found.indentation)
    assert row["loading_radius_on_layer_mm"] == pytest.approx(found.area_over_pi_indentation)
    assert row["layer_flag"] is None
    assert (row["effective_thickness_mm"], row["effective_thickness_mm_std"]) == (8.0, 0.8)
    # Bone: a softer tissue that is indented less.
    assert row["youngs_modulus_on_layer_kpa"] < 0.8 * row["youngs_modulus_kpa"]
    assert row["indentation_on_layer_mm"] < 0.8 * row["indentation_mm"]


def test_a_thickness_changes_nothing_else_and_is_exact_without_an_uncertainty(tmp_path):
    (with_layer,), (without,) = records(study(tmp_path).rows), records(study(tmp_path, {}).rows)
    assert all(without[name] is None for name in LAYER)
    others = set(COLUMNS) - set(LAYER)
    assert {name: with_layer[name] for name in others} == {name: without[name] for name in others}
    (exact,) = records(study(tmp_path, {"effective_thickness_mm": 8.0}).rows)
    assert exact["effective_thickness_mm_std"] is None
    for name in ("youngs_modulus_on_layer_kpa", "loading_radius_on_layer_mm"):
        assert exact[name] == with_layer[name]
        assert 0 < exact[f"{name}_std"] < with_layer[f"{name}_std"]


@pytest.mark.parametrize(
    ("thickness", "major", "flag"),
    [
        (THICK, 14.0, "contact_too_wide"),
        ({"effective_thickness_mm": 1.5}, 7.4, "layer_too_thin"),
        ({"effective_thickness_mm": 2.2, "effective_thickness_mm_std": 0.5}, 7.4, "uncertainty_out_of_range"),
    ],
)
def test_out_of_range_is_named_and_not_pooled(tmp_path, thickness, major, flag):
    result = study(tmp_path, thickness, contacts=[(2, major)])
    (row,), (summary,) = records(result.rows), result.summaries
    assert row["layer_flag"] == summary.on_layer.highest_load.layer_flag == flag
    assert "layer_out_of_range" in row["range_notes"]
    assert row["youngs_modulus_on_layer_kpa_std"] is None
    assert (row["youngs_modulus_on_layer_kpa"] is None) == (flag != "uncertainty_out_of_range")
    assert math.isnan(summary.on_layer.pooled.youngs_modulus_on_layer_kpa)
    record = summary_of(tmp_path / "out")["summaries"][0]["on_layer"]
    assert record["pooled"]["youngs_modulus_on_layer_count"] == 0
    assert record["highest_load"]["layer_flag"] == flag


def test_a_poisson_ratio_below_the_laws_and_large_uncertainties_cost_the_layer_alone(tmp_path):
    (row,) = records(study(tmp_path, top={"poisson_ratio": 0.2}).rows)
    assert row["layer_flag"] == "poisson_ratio_out_of_range"
    large = {"wedge_angle_deg_std": 60, "roll_angle_deg_std": 30, "method": "monte_carlo"}
    (row,) = records(study(tmp_path, axes_std=9.0, **large).rows)
    assert row["status"] in {"measured", "failed"}
    assert row["youngs_modulus_on_layer_kpa_std"] is None


def test_one_contact_is_its_own_mean(tmp_path):
    result = study(tmp_path)
    (row,), layer = records(result.rows), result.summaries[0].on_layer
    highest = layer.highest_load
    assert (highest.observation, highest.load_N, highest.layer_flag) == ("c0", 2.0, "")
    for name in POOLED_ON_LAYER:
        unit = "kpa" if "modulus" in name else "mm"
        for record in (layer.pooled, highest):
            one = LayerQuantity.of(record, name)
            assert one.value == pytest.approx(row[f"{name}_{unit}"])
            assert one.std == pytest.approx(row[f"{name}_{unit}_std"])
        budget = LayerQuantity.of(layer.pooled, name).budget
        assert set(budget) == {*LAYER_SOURCES, "scatter"}
        assert sum(budget.values()) == pytest.approx(1)
        assert getattr(layer.pooled, f"{name}_count") == 1
    shares = (record.youngs_modulus_on_layer_variance_shares for record in (layer.pooled, highest))
    pooled, alone = (of["thickness"] for of in shares)
    assert alone == pytest.approx(pooled)


def test_the_thickness_does_not_average_away(tmp_path):
    one, many = (study(tmp_path, contacts=[(2, 7.4)] * count).summaries[0].on_layer for count in (1, 30))
    alone, pooled = (LayerQuantity.of(each.pooled, "youngs_modulus_on_layer") for each in (one, many))
    own = sum(alone.budget[source] for source in ("load", "contact ellipse")) * alone.std**2
    expected = math.sqrt(alone.std**2 - own + own / 30)
    assert pooled.std == pytest.approx(expected, rel=1e-6)
    assert many.pooled.youngs_modulus_on_layer_count == 30
    assert pooled.value == pytest.approx(alone.value)


def test_contacts_out_of_range_are_left_out_of_both_means(tmp_path):
    contacts = [(1, 6.0), (2, 7.4), (4, 14.0)]
    layer = study(tmp_path, contacts=contacts).summaries[0].on_layer
    inside = study(tmp_path, contacts=contacts[:2]).summaries[0].on_layer
    assert layer.highest_load.observation == "c1"
    assert layer == inside


@cache
def solved_press() -> tuple[PchipInterpolator, PchipInterpolator]:
    """Logarithms of load over E*, and of area, against that of indentation: solved on a grid, not by laws."""
    depths = np.geomspace(0.05, 1.8, 8)
    placement, tissue = Placement(PAD, wedge_angle=math.radians(30)), Tissue(0.75, thickness=8.0)
    found = [solve_contact(placement, tissue, indentation=float(depth), points=64) for depth in depths]
    return tuple(
        PchipInterpolator(np.log(depths), np.log([getattr(one, name) for one in found]), extrapolate=True)
        for name in ("load", "area")
    )


@pytest.fixture(scope="module")
def pressed(tmp_path_factory) -> tuple[StudyResult, Path]:
    """A press of the pad on 8 mm of tissue of 50 kPa, with noise: first contact at 0.3 mm."""
    folder, rng = tmp_path_factory.mktemp("pressed"), np.random.default_rng(1)
    depth = np.linspace(-0.3, 1.8, 160)
    load, area = (np.exp(law(np.log(np.maximum(depth, 1e-9)))) for law in solved_press())
    load = np.where(depth > 0, 0.05 / 0.75 * load, 0) + rng.normal(0, 0.005, depth.size)
    area = np.where(depth > 0, area + rng.normal(0, 0.5, depth.size), 0.0)
    columns = 0.01 * np.arange(depth.size), load, depth + 0.3, np.maximum(area, 0)
    write_numbers(folder / "c.csv", "time_s,force_N,displacement_mm,area_mm2", np.transpose(columns))
    return study(folder, THICK, curve(file="c.csv"), curve(loading_radius_mm=20.5)), folder


def on_layer(
    result: StudyResult, thickness: float | None, std: float | None = None
) -> CurveOnLayerRecord | None:
    pad, stated = (
        result.fingers["f"],
        {"effective_thickness_mm": thickness, "effective_thickness_mm_std": std},
    )
    known = replace(pad, manifest=pad.manifest.model_copy(update=stated))
    return curve_on_layer(result.study, known, result.curves[0])


def test_a_curve_gives_the_modulus_that_made_it(pressed):
    result, folder = pressed
    found, of_no_file = (curve_on_layer(result.study, result.fingers["f"], one) for one in result.curves)
    assert of_no_file is None
    name = "youngs_modulus_from_indentation_on_layer"
    hertz = LayerQuantity.of(found, "youngs_modulus_from_indentation")
    layered = LayerQuantity.of(found, name)
    assert layered.value == pytest.approx(50, rel=0.03)
    assert hertz.value > 2 * layered.value
    assert found.loading_radius_on_layer_mm == pytest.approx(20.4, abs=0.2)
    assert found.contact_shift_mm == pytest.approx(0.09, abs=0.01)
    assert max(layered.budget, key=layered.budget.__getitem__) == "thickness"
    assert hertz.budget["thickness"] == 0
    # The uncertainty of the thickness moves the place of contact with it: another thickness, all over again.
    thin, thick = (LayerQuantity.of(on_layer(result, thickness), name) for thickness in (7.2, 8.8))
    share = layered.budget["thickness"]
    assert layered.std * share**0.5 == pytest.approx((thick.value - thin.value) / 2, rel=0.1)
    record = summary_of(folder / "out")["curves"][0]["on_layer"]
    assert record[f"{name}_kpa"] == pytest.approx(layered.value)
    assert record["contact_shift_mm"] == pytest.approx(found.contact_shift_mm)


@pytest.mark.parametrize(
    ("thickness", "std", "flag"),
    [(2.2, 0.1, "layer_too_thin"), (1.0, None, "layer_too_thin"), (2.8, 0.6, "uncertainty_out_of_range")],
)
def test_a_curve_out_of_range_is_named(pressed, thickness, std, flag):
    found = on_layer(pressed[0], thickness, std)
    hertz = LayerQuantity.of(found, "youngs_modulus_from_indentation")
    layered = LayerQuantity.of(found, "youngs_modulus_from_indentation_on_layer")
    assert found.layer_flag == flag
    assert math.isnan(layered.std)
    assert math.isnan(layered.value) == (flag != "uncertainty_out_of_range")
    assert 0 < hertz.std < hertz.value
    assert on_layer(pressed[0], None) is None
