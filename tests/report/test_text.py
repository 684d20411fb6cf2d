"""Remarks of the report in words."""

import math

import numpy as np
import pytest

from fingerpad.figures.publish import plain_text
from fingerpad.flags import FLAGS
from fingerpad.image import FaceSemiAxes, combine_faces
from fingerpad.report.repeatability import borrowed
from fingerpad.report.templates import signed_with_uncertainty, typeset
from fingerpad.report.text import advice, face_differences, p_words, phase_words, pooling_words, probability
from fingerpad.study.corrections.apply import ManualPhases
from fingerpad.study.corrections.changes import PhaseCorrection
from fingerpad.uncertainty.repeats import ContactRepeatability


def test_a_flag_says_what_to_do() -> None:
    assert advice(FLAGS["contact"]["cut_by_mask"]) == (
        "The contact is cut by the mask or region of interest. To do: make the mask or region of interest "
        "larger."
    )


def test_manual_phases_name_who_set_them_and_why() -> None:
    starts = [{"phase": "loading", "start_s": 0.25}, {"phase": "hold", "start_s": 1}]
    correction = PhaseCorrection(starts=starts, why="slipped at first")
    assert phase_words(ManualPhases(correction, "Ada", "2026-05-04T10:00:00.000Z")) == (
        "phases set manually by Ada on 2026-05-04: loading from 0.25 s, hold from 1 s (slipped at first)"
    )


def test_pooling_says_who_decided_and_what_speaks_against_it() -> None:
    row = {"excluding_flags": "low_contrast", "pooling_corrected_by": None, "pooled": False}
    flag = "the contact has little contrast with the background"
    assert pooling_words(row) == flag
    row |= {"pooled": True, "pooling_corrected_by": "Ada", "pooling_reason": "whole print"}
    assert pooling_words(row) == f"included by Ada: whole print ({flag})"


@pytest.mark.parametrize(
    ("p_value", "words", "with_letter"),
    [(0.04321, "0.043", "p = 0.043"), (1e-9, "< 0.001", "p < 0.001"), (math.nan, "–", "p = –")],
)
def test_probabilities(p_value, words, with_letter) -> None:
    assert (probability(p_value), p_words(p_value)) == (words, with_letter)


def test_differences_between_faces_in_percent() -> None:
    seen = {"palmar": (11.8, 13.8), "radial": (7.9, 14.0)}
    faces = [FaceSemiAxes(face=f, semi_axes=np.array(s), covariance=np.eye(2)) for f, s in seen.items()]
    assert face_differences(combine_faces(faces)) == (
        "palmar face: radial–ulnar +0.0 %, distal −0.7 %; radial face: palmar +0.0 %, distal +0.7 %"
    )


def test_what_repeats_tell_of_one_impression() -> None:
    found = ContactRepeatability(covariance=np.diag([0.01**2, 0.03**2]), freedom=8, groups=4, count=12)
    assert borrowed(found) == (
        "2.0 % in area and 3.0 % in aspect ratio, from 12 repeats of 4 contacts (8 degrees of freedom)"
    )


def test_symbols_and_signs_of_a_page() -> None:
    assert typeset("R_g & 4 (ℓd ℓe)^(3/2)") == (
        "R<sub>g</sub> &amp; 4 (ℓ<sub>d</sub> ℓ<sub>e</sub>)<sup>3/2</sup>"
    )
    assert signed_with_uncertainty(-0.512, 0.034) == "−0.512 ± 0.034"
    assert plain_text(r"$R_\mathrm{g}^\mathrm{corr}$ (mm)") == "Rgcorr (mm)"
