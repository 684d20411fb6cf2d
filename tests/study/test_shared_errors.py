"""Errors that all contacts of a study share, against a Monte Carlo written from the physics."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.studies import contact, finger, run

from fingerpad.study.compare import compare_studies, means_of
from fingerpad.study.results.layer import LayerQuantity
from fingerpad.study.results.study_result import StudyResult

AXES = 7.9, 13.8, 11.8
COUNT = 9
EXACT = {"wedge_angle_deg_std": 0, "roll_angle_deg_std": 0}


def result(folder: Path, stated: dict[str, float], wedge: float = 0.0) -> StudyResult:
    contacts = (contact(f"c{number}", std=0.05, axis="") for number in range(COUNT))
    known = finger(std=1e-6, effective_thickness_mm=9)
    return run(folder, known, *contacts, uncertainty={**EXACT, "wedge_angle_deg_std": wedge, **stated})


def test_presses_do_not_average_the_gain_of_the_force_out(tmp_path):
    found = result(tmp_path, {"load_relative_std": 0.03, "load_gain_relative_std": 0.04})
    rng, draws = np.random.default_rng(1), 20_000
    # E of a contact of known ellipse goes with its load, and with its area to the power of -3/2.
    load = (1 + 0.04 * rng.normal(size=(draws, 1))) * (1 + 0.03 * rng.normal(size=(draws, COUNT)))
    major, minor = (axis + 0.05 * rng.normal(size=(draws, COUNT)) for axis in (7.4, 5.0))
    modulus = load * (major * minor / 37) ** -1.5
    one, mean = modulus[:, 0].std(), modulus.mean(axis=1).std()
    row = found.rows.iloc[0]
    assert row["youngs_modulus_kpa_std"] / row["youngs_modulus_kpa"] == pytest.approx(one, rel=0.03)
    (at_load,) = found.by_load
    for name in ("youngs_modulus_kpa", "youngs_modulus_on_layer_kpa"):
        value = getattr(at_load, name)
        assert getattr(at_load, f"{name}_other_std") / value == pytest.approx(0.04, rel=0.01)
        assert getattr(at_load, f"{name}_std") / value == pytest.approx(mean, rel=0.03)
    for name in ("youngs_modulus", "youngs_modulus_on_layer"):
        pooled = LayerQuantity.of(found.summaries[0].on_layer.pooled, name)
        assert pooled.std / pooled.value == pytest.approx(mean, rel=0.03)
        assert pooled.budget["force gain"] == pytest.approx((0.04 / mean) ** 2, rel=0.06)
    # An area at a load is in error with it, by Hertz theory to the power of 2/3.
    area = (major * minor * load ** (2 / 3)).mean(axis=1)
    area_std = at_load.contact_area_mm2_std / at_load.contact_area_mm2
    assert area_std == pytest.approx(area.std() / area.mean(), rel=0.03)
    assert at_load.contact_area_mm2_other_std / at_load.contact_area_mm2 == pytest.approx(0.08 / 3, rel=0.01)
    # A radius does not depend on the load.
    assert "force gain" not in found.summaries[0].corrected_radius.budget


def test_the_pose_of_the_jig_is_one_error_of_all_angles(tmp_path):
    found = result(tmp_path, {"jig_angle_deg_std": 2}, wedge=1.0)
    rng, draws = np.random.default_rng(2), 20_000
    angle = np.radians(30 + 2 * rng.normal(size=draws) + rng.normal(size=draws))
    palmar, distal, across = AXES
    support = np.hypot(palmar * np.cos(angle), distal * np.sin(angle))
    in_plane, transverse = (palmar * distal) ** 2 / support**3, across**2 / support
    radius = 2 / (1 / in_plane + 1 / transverse)
    row = found.rows.iloc[0]
    assert row["mean_curvature_radius_mm_std"] == pytest.approx(radius.std(), rel=0.03)
    # The corrected radius is 1/H times a factor of the ellipse, which is the same at each angle.
    pooled = found.summaries[0].corrected_radius
    geometry = pooled.total_std**2 - pooled.fixed_geometry**2
    assert np.sqrt(geometry) / pooled.value == pytest.approx((radius / radius.mean()).std(), rel=0.03)
    assert pooled.budget["jig angle"] == pytest.approx(4 * pooled.budget["wedge angle"], rel=0.05)


def test_unstated_errors_change_nothing(tmp_path):
    found = result(tmp_path, {"load_relative_std": 0.03})
    assert {"force gain", "jig angle"}.isdisjoint(found.summaries[0].corrected_radius.budget)
    pooled = found.summaries[0].on_layer.pooled
    assert {"force gain", "jig angle"}.isdisjoint(pooled.youngs_modulus_variance_shares)


def test_fingers_do_not_average_the_gain_of_the_force_out(tmp_path):
    people = 6
    fingers = (finger(f"f{number}", std=1e-6, person=f"p{number}") for number in range(people))
    contacts = (contact(f"c{number}", finger=f"f{number}", std=0.05, axis="") for number in range(people))
    stated = {"load_relative_std": 0.03, "load_gain_relative_std": 0.04}
    run(tmp_path, *fingers, *contacts, uncertainty={**EXACT, **stated})
    values = [one for one in compare_studies([tmp_path / "out"]).values if "youngs" in one.quantity]
    truth = values[0].value
    rng, draws = np.random.default_rng(3), 500
    load = (1 + 0.04 * rng.normal(size=(draws, 1))) * (1 + 0.03 * rng.normal(size=(draws, people)))
    major, minor = (axis + 0.05 * rng.normal(size=(draws, people)) for axis in (7.4, 5.0))
    seen = truth * load * (major * minor / 37) ** -1.5
    means = [
        means_of(replace(one, value=value) for one, value in zip(values, drawn, strict=True))[0]
        for drawn in seen.tolist()
    ]
    error = np.array([mean.value - truth for mean in means])
    assert np.mean([mean.std for mean in means]) == pytest.approx(error.std(), rel=0.1)
    held = np.mean([low <= truth <= high for low, high in (mean.interval for mean in means)])
    assert 0.92 <= held <= 0.98


def test_fingers_do_not_average_the_scale_of_their_contacts_out(tmp_path):
    people = 16
    fingers = (finger(f"f{number}", std=1e-6, person=f"p{number}") for number in range(people))
    contacts = (
        contact(f"c{number}", finger=f"f{number}", std=0.05, axis="", scale="camera")
        for number in range(people)
    )
    run(
        tmp_path,
        *fingers,
        *contacts,
        uncertainty=EXACT,
        scales={"camera": {"ppi": 500, "relative_std": 0.02}},
    )
    found = {mean.quantity: mean.std / mean.value for mean in compare_studies([tmp_path / "out"]).means}
    noise = np.hypot(0.05 / 7.4, 0.05 / 5.0) / np.sqrt(people)
    # The area goes with the square of the scale, E with its third power and the area to −3/2.
    assert found["highest_area_mm2"] == pytest.approx(np.hypot(0.04, noise), rel=0.02)
    assert found["youngs_modulus_kpa"] == pytest.approx(np.hypot(0.06, 1.5 * noise), rel=0.03)
