"""A study's answers: one sentence for each finger and placement, with what is missing said."""

import html
import math
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from tests import command
from tests.studies import Table, contact, curve, finger, picture, run, sequence

from fingerpad import pad_uncertainty
from fingerpad._rounding import positive_with_uncertainty
from fingerpad.report import write_report
from fingerpad.study.pipeline import run_study
from fingerpad.study.results.load import load_results
from fingerpad.study.results.output import Answer, answers_of
from fingerpad.study.results.table import COLUMNS, items

THICK = finger(effective_thickness_mm=8, effective_thickness_mm_std=1)


def press(load: float = 2, major: float = 7.4, minor: float = 5.0, roll: float = 0) -> Table:
    return contact(f"o{load}", load, (major, minor), std=0.05, roll_angle_deg=roll)


def answer(folder: Path, *tables: Table) -> Answer:
    (found,) = answers_of(run(folder, *tables))
    return found


def test_bone_that_nobody_stated_is_said_to_be_unknown(tmp_path):
    found = answer(tmp_path, finger(), press(0.02, 1.2, 1.16, roll=-10))
    assert found.label == "f, 30°, roll −10°"
    assert "kPa (0.02 N), bone unknown; Hertz theory " in found.sentence
    assert not found.on_bone


def test_modulus_is_that_on_bone_where_the_thickness_is_stated(tmp_path):
    found = answer(tmp_path, THICK, press(1, 6.0), press())  # under the highest load
    without = answer(tmp_path, finger(), press())
    assert " kPa (2 N) on its bone (layer fails: aspect ratio +" in found.sentence
    assert found.on_bone
    assert found.modulus < without.modulus
    assert (found.area, found.load) == (pytest.approx(math.pi * 7.4 * 5.0), 2)


def test_where_both_models_fail_both_moduli_are_said(tmp_path):
    found = answer(tmp_path, THICK, press(), curve(loading_radius_mm=40))
    hertz = found.of.validity.headlines["youngs_modulus_kpa"].value
    assert found.of.validity.verdict == found.of.validity.on_layer.verdict == "fails"
    said = rf"\(layer fails: .*\) or {hertz:.0f} .* kPa .* which fails too \(.*\): report the range"
    assert re.search(said, found.sentence)


def test_contact_out_of_the_layer_s_range_has_the_modulus_of_hertz_theory(tmp_path):
    found = answer(tmp_path, THICK, press(2, 14, 9))
    assert " kPa (2 N) without bone; Hertz theory fails" in found.sentence


def test_the_modulus_on_bone_is_at_the_highest_load_in_the_range_of_the_laws(tmp_path):
    result = run(tmp_path, THICK, press(1, 6.0), press(6, 14, 9))
    (found,) = answers_of(result)
    assert found.on_bone
    assert (found.load, found.modulus_load) == (6, 1)
    assert " kPa (1 N) on its bone" in found.sentence
    low, high = result.by_load
    assert found.modulus == low.youngs_modulus_on_layer_kpa
    assert low.youngs_modulus_on_layer_kpa_verdict
    assert not high.youngs_modulus_on_layer_kpa_verdict


def test_whole_pad_has_the_modulus_and_uncertainty_of_deep_tissue(tmp_path):
    found = answer(tmp_path, finger(), contact(ellipse=(6.2, 5.9), std=0.05, axis="across"))
    (check,) = (one for one in found.of.validity.checks if one.check == "youngs_modulus_on_half_space")
    with_uncertainty = pad_uncertainty(
        palmar=(7.9, 0.1),
        distal=(13.8, 0.1),
        radial_ulnar=(11.8, 0.1),
        load=(2, 0.02),
        wedge_angle=(math.radians(30), math.radians(3)),
        roll_angle=(0, math.radians(3)),
        semi_major=(6.2, 0.05),
        semi_minor=(5.9, 0.05),
        thickness=(math.inf, 0),
    )["youngs_modulus_on_layer"].times(1000)
    assert check.reference == pytest.approx(float(with_uncertainty.value), rel=1e-6)
    assert check.reference_std == pytest.approx(float(with_uncertainty.std), rel=0.02)
    whole_pad = positive_with_uncertainty(check.reference, check.reference_std)
    assert f"strained (modulus +12 %), for the whole pad {whole_pad} kPa; corrected" in found.sentence


def test_the_largest_difference_stands_with_its_quantity_and_sign(tmp_path):
    given = curve(loading_radius_mm=40)
    found = answer(tmp_path, finger(), press(0.5, 3.5, 3.3), given)
    (check,) = (one for one in found.of.validity.checks if one.check == "radius_against_loading")
    assert check.relative_difference < -0.5
    assert f"; Hertz theory fails (radius −{-100 * check.relative_difference:.0f} %); " in found.sentence


# Fingers without semi-axes and photographs: contact areas against load, and nothing that needs a pad

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "dzidek2017"
# Columns of what follows from a pad.
OF_A_PAD = [
    name
    for name, column in COLUMNS.items()
    if column.group in {"pad", "radius", "hertz", "layer"} and column.dtype == "float"
]
PRESSES = [contact(f"c{load}", load, (5 * load ** (1 / 3), 4 * load ** (1 / 3))) for load in (0.5, 1, 2, 4)]


def test_areas_are_those_of_a_finger_with_semi_axes(tmp_path):
    with_pad = run(tmp_path / "with", finger(), *PRESSES)
    without = run(tmp_path / "without", finger(std=0), *PRESSES)
    assert items(without.rows["status"]) == ["measured"] * 4
    assert without.rows["pooled"].all()
    assert not without.failures
    assert without.rows[OF_A_PAD].isna().all(axis=None)
    assert not with_pad.rows[OF_A_PAD].isna().all(axis=None)
    for known, alone in zip(with_pad.by_load, without.by_load, strict=True):
        assert alone.contact_area_mm2 == known.contact_area_mm2
        assert alone.contact_area_mm2_std == known.contact_area_mm2_std
        assert math.isnan(alone.youngs_modulus_kpa)
        assert math.isnan(alone.youngs_modulus_on_layer_kpa)
    (summary,), (placed,) = without.summaries, without.placements
    validity = placed.validity
    assert summary.corrected_radius is summary.compliance_radius is summary.on_layer is None
    growth = next(one for one in validity.checks if one.check == "area_against_load")
    assert growth.value == pytest.approx(2 / 3)
    assert validity.verdict == "not tested"  # an exponent alone tests no theory


def test_the_sentence_says_what_is_missing(tmp_path):
    steep = [contact(f"c{load}", load, (5 * load, 4 * load), std=0.01) for load in (0.5, 1, 2)]
    known = curve(loading_radius_mm=15, loading_radius_mm_std=1)
    result = run(tmp_path, finger(std=0), *steep, known)
    (answer,), (placed,) = answers_of(result), result.placements
    validity = placed.validity
    radius = next(one for one in validity.checks if one.check == "radius_against_loading")
    assert (radius.verdict, radius.note) == ("not tested", "the finger has no semi-axes")
    assert answer.text.startswith("contact area 251.33 ± 0.40 mm² under 2 N; Hertz theory fails (modulus")
    assert answer.text.endswith("no modulus and no radius, as the finger's semi-axes are not known")
    assert math.isnan(answer.modulus)


def test_report_and_results_of_areas_alone(tmp_path):
    """One finger has a pad, the other none; a picture of the other is measured, and a sequence."""
    shutil.copy(EXAMPLE / "synthetic" / "synthetic_30deg_2N.png", tmp_path / "print.png")
    frames = tmp_path / "frames"
    frames.mkdir()
    for number in range(3):
        shutil.copy(tmp_path / "print.png", frames / f"{number}.png")
    (tmp_path / "force.csv").write_text("time_s,force_N\n0,0.1\n1,0.7\n2,1.4\n3,2\n4,2\n")
    scale = {"scale": {"ppi": 500}}
    run(
        tmp_path,
        finger("g", std=0),
        finger(),
        contact("other"),
        picture("seen", "print.png", finger="g", **scale),
        sequence("press", "frames", finger="g", wedge=45, force="force.csv", frames_per_second=1, **scale),
    )
    out = tmp_path / "out"
    result = run_study(tmp_path / "study.toml", out, write_report=write_report)
    page = html.unescape((out / "report.html").read_text(encoding="utf-8"))
    assert "as the finger's semi-axes are not known" in page
    assert "Give semi-axes or photographs of g: radius and modulus follow" in page
    assert "contact areas alone, no radius and no modulus: g" in page
    assert "Of g, whose semi-axes are not known" in page
    assert not re.search(r"\bnan\b", page)
    head = page[page.index('<table class="results">') :].partition("</thead>")[0]
    assert "Corrected" in head  # of f
    assert "Loading radius" not in head
    texts = {answer.label: answer.text for answer in answers_of(result)}
    assert texts["g, 45°"].startswith("contact area 116.")
    assert "corrected radius" in texts["f, 30°"]
    stored = load_results(out)
    row = stored.table.set_index("observation").loc["seen"]
    assert row["gross_area_mm2"] == pytest.approx(116.3, rel=0.03)
    assert np.isnan(row["youngs_modulus_kpa"])
    assert stored.summary.finger("g").source == "none"
    for words in (("compare", out), ("export", out, tmp_path / "all.mat")):
        assert command.run(*words)[0] == 0
    assert "semi-axes" in command.refusal("simulator", out, "--finger", "g", "--wedge-deg", "30")
