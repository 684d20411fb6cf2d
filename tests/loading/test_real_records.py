"""Real records of soft matter pressed by a sphere, and what others find in them (data/README.md)."""

import math
from functools import cache
from pathlib import Path

import pytest

from fingerpad.loading import LoadingCurve, LoadingFit, find_cycles, fit_loading_curve, read_loading_curve

DATA = Path(__file__).with_name("data")
# Radius of the sphere, mm, E*, kPa, and where the platen turns back, mm.
RECORDS = {"chiaro_gel.csv": (27.5, 0.1560, 85.7), "afm_cell.csv": (5.0, 480.3, 26.6)}


def record(name: str, every: int = 1) -> LoadingCurve:
    whole = read_loading_curve(DATA / name)
    rows = slice(None, None, every)
    return LoadingCurve(load=whole.load[rows], indentation=whole.indentation[rows], time=whole.time[rows])


@cache
def fitted(name: str) -> LoadingFit:
    """Return a fit that knows what was pressed and by what."""
    return fit_loading_curve(
        record(name), loading_radius=RECORDS[name][0], thickness=math.inf, stage_compliance=0.0
    )


@pytest.mark.parametrize("name", RECORDS)
@pytest.mark.parametrize("every", [1, 8])
def test_the_press_is_found_after_a_long_approach_and_before_a_fast_retreat(name: str, every: int) -> None:
    curve = record(name, every)
    (cycle,) = find_cycles(curve)
    assert curve.indentation[cycle.loading.stop - 1] == pytest.approx(RECORDS[name][2], rel=0.02)
    assert len(cycle.baseline) > 2 * len(cycle.loading)
    assert len(cycle.unloading) > 10


@pytest.mark.parametrize("name", RECORDS)
def test_moduli_are_those_that_others_find(name: str) -> None:
    found, known = fitted(name).reduced_modulus.times(1000), RECORDS[name][1]
    assert found.lower < known < found.upper or found.value == pytest.approx(known, rel=0.03)


def test_a_slip_does_not_end_the_range_in_which_the_modulus_grows() -> None:
    fit = fitted("chiaro_gel.csv")
    assert "modulus_partly_decreases" not in fit.flags
    assert fit.modulus_load > 0.04


def test_a_force_that_no_law_has_the_shape_of_is_flagged() -> None:
    fit = fitted("afm_cell.csv")
    assert "under load the force departs from the model" in fit.notes["misfit"]
    assert fit.misfit_std["reduced_modulus"] > 3 * math.sqrt(
        fit.reduced_modulus.std**2 - fit.misfit_std["reduced_modulus"] ** 2
    )


def test_a_layer_that_no_finger_has_is_no_explanation() -> None:
    """The best layer under the cell would be thinner than the indentation."""
    fit = fit_loading_curve(record("afm_cell.csv"), loading_radius=5.0, stage_compliance=0.0)
    inverse = [law.values["inverse_thickness"] for law in fit.alternatives.values()]
    assert inverse
    assert all(1 / 25 <= one <= 1 for one in inverse)
    depth = record("afm_cell.csv").indentation.max() - fit.contact_offset.value
    assert all(1 / one > 1.9 * depth for one in inverse)
    assert "untested_without_area" in fit.flags
    assert fit.reduced_modulus.lower > 0.1
