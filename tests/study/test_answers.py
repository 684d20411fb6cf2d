"""A study's answers: one sentence for each finger and placement, with what is missing said."""

import math
import re
from pathlib import Path

import pytest
from tests.studies import Table, contact, curve, finger, run

from fingerpad.study.results.output import Answer, answers_of

THICK = finger(effective_thickness_mm=8, effective_thickness_mm_std=1)


def press(load: float = 2, major: float = 7.4, minor: float = 5.0, roll: float = 0) -> Table:
    return contact(f"o{load}", load, (major, minor), std=0.05, roll_angle_deg=roll)


def answer(folder: Path, *tables: Table) -> Answer:
    (found,) = answers_of(run(folder, *tables))
    return found


def test_bone_that_nobody_stated_is_said_to_be_unknown(tmp_path: Path) -> None:
    found = answer(tmp_path, finger(), press(0.02, 1.2, 1.16, roll=-10))
    assert found.label == "f, 30°, roll −10°"
    assert "kPa (0.02 N), bone unknown; Hertz theory " in found.sentence
    assert not found.on_bone


def test_modulus_is_that_on_bone_where_the_thickness_is_stated(tmp_path: Path) -> None:
    found = answer(tmp_path, THICK, press())
    without = answer(tmp_path, finger(), press())
    assert " kPa (2 N) on its bone (layer fails: shape +" in found.sentence
    assert found.on_bone
    assert found.modulus < without.modulus
    assert (found.area, found.load) == (pytest.approx(math.pi * 7.4 * 5.0), 2)


def test_where_both_models_fail_both_moduli_are_said(tmp_path: Path) -> None:
    found = answer(tmp_path, THICK, press(), curve(loading_radius_mm=40))
    hertz = found.of.validity.headlines["youngs_modulus_kpa"].value
    assert found.of.validity.verdict == found.of.validity.on_layer.verdict == "fails"
    said = rf"\(layer fails: .*\) or {hertz:.0f} .* kPa .* which fails too \(.*\): report the range"
    assert re.search(said, found.sentence)


def test_contact_out_of_the_layer_s_range_has_the_modulus_of_hertz_theory(tmp_path: Path) -> None:
    found = answer(tmp_path, THICK, press(2, 14, 9))
    assert " kPa (2 N) without bone; Hertz theory fails" in found.sentence


def test_the_largest_difference_stands_with_its_quantity_and_sign(tmp_path: Path) -> None:
    given = curve(loading_radius_mm=40)
    found = answer(tmp_path, finger(), press(0.5, 3.5, 3.3), given)
    (check,) = (one for one in found.of.validity.checks if one.check == "radius_against_loading")
    assert check.relative_difference < -0.5
    assert f"; Hertz theory fails (radius −{-100 * check.relative_difference:.0f} %); " in found.sentence


def test_highest_load_counts(tmp_path: Path) -> None:
    found = answer(tmp_path, finger(), press(1, 6.0), press(2, 7.4))
    assert (found.load, found.area) == (2, pytest.approx(math.pi * 7.4 * 5.0))
