"""A study's answers: one sentence for each finger and placement, with what is missing said."""

import math
from pathlib import Path

import pytest

from fingerpad.study.pipeline import run_study
from fingerpad.study.results.output import Answer, answers_of

FINGER = """
title = "T"
[[fingers]]
name = "f"
semi_axes_mm = { palmar = 7.9, distal = 13.8, radial_ulnar = 11.8 }
semi_axes_mm_std = { palmar = 0.1, distal = 0.1, radial_ulnar = 0.1 }
"""
THICK = "effective_thickness_mm = 8\neffective_thickness_mm_std = 1\n"
CONTACT = """
[[observations]]
name = "o{load}"
finger = "f"
wedge_angle_deg = 30
roll_angle_deg = {roll}
load_N = {load}
ellipse_mm = {{ semi_major = {major}, semi_minor = {minor}, std = 0.05, long_axis = "along" }}
"""


def contact(load: float = 2, major: float = 7.4, minor: float = 5.0, roll: float = 0) -> str:
    return CONTACT.format(load=load, major=major, minor=minor, roll=roll)


def answer(folder: Path, text: str) -> Answer:
    (folder / "study.toml").write_text(text, encoding="utf-8")
    (found,) = answers_of(run_study(folder / "study.toml", folder / "out"))
    return found


def test_bone_that_nobody_stated_is_said_to_be_unknown(tmp_path: Path) -> None:
    found = answer(tmp_path, FINGER + contact(0.02, 1.2, 1.16, roll=-10))
    assert found.label == "f, 30°, roll −10°"
    assert "kPa, bone unknown; Hertz theory " in found.sentence
    assert not found.on_bone


def test_modulus_is_that_on_bone_where_the_thickness_is_stated(tmp_path: Path) -> None:
    found = answer(tmp_path, FINGER + THICK + contact())
    without = answer(tmp_path, FINGER + contact())
    assert " kPa on its bone (layer fails: shape +" in found.sentence
    assert found.on_bone
    assert found.modulus < without.modulus
    assert (found.area, found.load) == (pytest.approx(math.pi * 7.4 * 5.0), 2)


def test_contact_out_of_the_layer_s_range_has_the_modulus_of_hertz_theory(tmp_path: Path) -> None:
    found = answer(tmp_path, FINGER + THICK + contact(2, 14, 9))
    assert " kPa without bone; Hertz theory fails" in found.sentence


def test_the_largest_difference_stands_with_its_quantity_and_sign(tmp_path: Path) -> None:
    curve = '[[curves]]\nfinger = "f"\nwedge_angle_deg = 30\nloading_radius_mm = 40\n'
    found = answer(tmp_path, FINGER + contact(0.5, 3.5, 3.3) + curve)
    (check,) = (one for one in found.of.validity.checks if one.check == "radius_against_loading")
    assert check.relative_difference < -0.5
    assert f"; Hertz theory fails (radius −{-100 * check.relative_difference:.0f} %); " in found.sentence


def test_highest_load_counts(tmp_path: Path) -> None:
    found = answer(tmp_path, FINGER + contact(1, 6.0) + contact(2, 7.4))
    assert (found.load, found.area) == (2, pytest.approx(math.pi * 7.4 * 5.0))
