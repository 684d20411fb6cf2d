"""Relaxation and growth of area from simulated truth, and what is not claimed to be known."""

import pytest
from numpy.testing import assert_allclose

from fingerpad.exceptions import FitError
from fingerpad.loading import find_cycles, fit_relaxation
from fingerpad.simulate import simulate_loading_curve

PAD = {"load_coefficient": 0.0, "points": 600, "force_std": 0.003, "displacement_std": 0.002, "hold": 10.0}


def relaxation(**options):
    curve = simulate_loading_curve(**{**PAD, **options})
    return fit_relaxation(curve, find_cycles(curve)[0], 1.0)


def test_one_term_with_ramp() -> None:
    found = relaxation(relaxation=[(0.3, 3.0)], seed=1)
    (term,) = found.terms
    assert abs(term.time.value - 3.0) < 4 * term.time.std
    assert abs(term.share.value - 0.3) < 4 * term.share.std
    assert_allclose([term.time.value, term.share.value], [3.0, 0.3], rtol=0.1)


def test_no_term_without_relaxation() -> None:
    assert relaxation(seed=2).terms == ()


def test_times_outside_record_undetermined() -> None:
    fast = relaxation(relaxation=[(0.3, 0.2)], rate=1.0, seed=3)
    assert fast.terms
    assert all("faster than the ramp" in term.time.reason for term in fast.terms)
    slow = relaxation(relaxation=[(0.5, 60.0)], seed=4)
    assert slow.terms
    assert all("slower than the hold" in term.time.reason for term in slow.terms)


def test_hold_and_times_required() -> None:
    curve = simulate_loading_curve(points=100)
    with pytest.raises(FitError, match="no hold"):
        fit_relaxation(curve, find_cycles(curve)[0], 1.0)
