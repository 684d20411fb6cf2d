"""The exponent of the area over the frames of presses, whose errors are not independent."""

import math
from dataclasses import replace

import numpy as np
import pytest
from benchmarks.claims.area_exponents import ERRORS, held, smooth
from tests.study.test_repeats import PADS, STUDY, contact

from fingerpad.study.manifest.models import ContactSequence
from fingerpad.study.results.pooling import Exponent, area_exponent, pool_contacts
from fingerpad.study.results.rows import Rows, model_contacts
from fingerpad.study.results.summary_file import ValidityRecord
from fingerpad.study.results.validity.checks import validity_of
from fingerpad.study.results.validity.model_checks import MODULUS

STATED = 0.02


@pytest.mark.parametrize("presses", [1, 3])
@pytest.mark.parametrize("kind", ERRORS)
def test_the_exponent_of_presses_covers_the_truth_whatever_their_errors(kind: str, presses: int) -> None:
    """Taken as independent, frames of smooth errors covered it in 4 to 40 %."""
    ours, _ = held(kind, presses, repeats=200)
    assert np.mean(ours) > 0.9


def pressed(seed: int, presses: int = 1, frames: int = 40) -> Rows:
    """Return the rows of presses whose areas have a smooth error of 2 %, as they state."""
    rng, seen = np.random.default_rng(seed), []
    for press in range(presses):
        sequence = ContactSequence(
            name=f"p{press}", finger="f", wedge_angle_deg=30, file="p.tif", force="f.csv", scale={"ppi": 500}
        )
        error = 0.5 * STATED * smooth(0.3, rng, frames)
        for k, load in enumerate(np.linspace(0.1, 2, frames)):
            radius = 5 * load ** (1 / 3) * math.exp(error[k])
            _, measured = contact(k, radius, load=load)
            noise = (STATED / 2 * radius) ** 2 * np.ones((2, 2))
            name = {"observation": f"p{press}#{k}", "sequence": f"p{press}", "frame": k}
            seen.append((sequence, replace(measured, **name, covariance_mm2=noise, gross_area_mm2=math.nan)))
    return model_contacts(STUDY, PADS, seen)


def validity(rows: Rows) -> ValidityRecord:
    (found,) = validity_of(STUDY, PADS, rows, pool_contacts(rows), [])
    return found


def test_a_press_is_as_uncertain_in_its_table_and_in_the_check_of_the_model() -> None:
    exponents: list[Exponent] = []
    for seed in range(12):
        rows = pressed(seed)
        exponents.append(area_exponent(rows.table))
        (growth,) = (one for one in validity(rows).checks if one.check == "area_against_load")
        assert growth.value == pytest.approx(exponents[-1].value)
        assert growth.value_std >= 0.4 * exponents[-1].std
        assert growth.verdict != "fails"
    value, std = np.transpose(exponents)
    assert np.all(np.abs(value - 2 / 3) < 3 * std)
    assert np.mean(np.abs(value - 2 / 3) < 2 * std) > 0.9
    assert np.all(std > 0.005)


def test_more_frames_of_one_press_say_no_more() -> None:
    few, many = (area_exponent(pressed(1, frames=frames).table) for frames in (40, 160))
    assert many.std > 0.8 * few.std
    model_std = [
        validity(pressed(1, frames=frames)).headlines[MODULUS].model_relative_std for frames in (40, 160)
    ]
    assert model_std[1] == pytest.approx(model_std[0], abs=0.02)


def test_more_presses_say_more() -> None:
    one, nine = (
        np.median([area_exponent(pressed(s, presses).table).std for s in range(5)]) for presses in (1, 9)
    )
    assert nine < 0.6 * one
