"""Phases of a record: presses of many shapes, with noise."""

import itertools

import numpy as np
import pytest

from fingerpad.exceptions import LoadingError
from fingerpad.image import PHASES, PhaseIntervals, phase_intervals, phases_of

TIME = np.arange(0, 5, 0.002)
SHAPES = {
    "hold": ([0, 1, 2, 3, 4, 5], [0, 0, 2, 2, 0, 0]),
    "slow load, quick release": ([0, 0.5, 3, 4, 4.1, 5], [0, 0, 2, 2, 0, 0]),
    "quick load, slow release": ([0, 0.5, 0.75, 1.6, 4.5, 5], [0, 0, 2, 2, 0, 0]),
    "peak": ([0, 1, 2.5, 4, 5], [0, 0, 2, 0, 0]),
    "relaxing hold": ([0, 1, 1.5, 4, 4.5, 5], [0, 0, 2, 1.6, 0, 0]),
}


def found(values):
    return [PHASES[k] for k in phases_of(TIME, values)]


@pytest.mark.parametrize("noise", [0.0, 0.005])
@pytest.mark.parametrize("name", SHAPES)
def test_corners_of_press(name, noise):
    corners, loads = SHAPES[name]
    load = np.interp(TIME, corners, loads) + np.random.default_rng(1).normal(0, noise, TIME.size)
    phases = found(load)
    order = [phases[0], *(b for a, b in itertools.pairwise(phases) if a != b)]
    expected = ["before", "loading", "unloading", "after"]
    if name != "peak":
        expected.insert(2, "hold")
    assert order == expected
    ends = [float(TIME[phases.index(phase)]) for phase in expected[1:]]
    np.testing.assert_allclose(ends, corners[1:-1], atol=0.12)


def test_convex_ramp():
    depth = np.interp(TIME, [0.5, 2.5, 3.5, 4.5], [0, 2, 2, 0])
    phases = found(depth**1.5)
    assert "hold" not in phases[: int(2.3 / 0.002)]
    assert phases[int(3.0 / 0.002)] == "hold"


def test_the_slow_foot_of_a_ramp_is_part_of_it_on_either_side():
    load = np.interp(TIME, [0.5, 2.5, 3.5, 4.5], [0, 1, 1, 0]) ** 4
    ramp = slice(int(1.3 / 0.002), int(2.2 / 0.002))  # from two percent of the load on
    assert set(found(load)[ramp]) == {"loading"}
    assert set(found(load[::-1])[::-1][ramp]) == {"unloading"}


def test_two_presses():
    load = np.interp(TIME, [0, 0.5, 1, 1.5, 2, 3, 3.5, 4, 4.5, 5], [0, 0, 2, 2, 0.4, 0.4, 2, 2, 0, 0])
    phases = found(load)
    order = [b for a, b in itertools.pairwise(phases) if a != b]
    assert order.count("loading") == 2
    assert order[-1] == "after"


@pytest.mark.parametrize("values", [np.zeros(50), np.zeros(1), np.array([0.0, 1.0])])
def test_no_press(values):
    assert set(phases_of(np.arange(values.size), values)) == {0}


@pytest.mark.parametrize("name", SHAPES)
def test_intervals_give_each_sample_its_phase_and_the_time_before_it_too(name):
    corners, loads = SHAPES[name]
    load = np.interp(TIME, corners, loads) + np.random.default_rng(2).normal(0, 0.005, TIME.size)
    intervals, labels = phase_intervals(TIME, load), found(load)
    assert [intervals.at(time) for time in TIME] == labels
    # A frame between two samples has the phase of the later one.
    assert [intervals.at(time) for time in (TIME[:-1] + TIME[1:]) / 2] == labels[1:]


def test_a_record_that_begins_in_contact_begins_with_a_phase():
    intervals = phase_intervals(TIME, np.interp(TIME, [0, 2, 4, 5], [1, 2, 2, 0]))
    assert intervals.at(0.0) != "before"


def test_a_phase_that_begins_with_the_next_is_empty():
    intervals = PhaseIntervals([1, 2, 2, 3], ["loading", "hold", "unloading", "after"])
    assert [intervals.at(time) for time in (0, 1, 1.5, 2, 2.1, 3, 9)] == [
        *("before", "before", "loading", "loading", "unloading", "unloading", "after")
    ]


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: PhaseIntervals([1.0], ["loading", "hold"]), "give each its start"),
        (lambda: PhaseIntervals([1.0, 0.5], ["loading", "hold"]), "not decrease"),
        (lambda: PhaseIntervals([1.0, np.nan], ["loading", "hold"]), "finite"),
        (lambda: phases_of([0, 1], [1]), "time|values"),
        (lambda: phases_of([1, 0], [0, 1]), "time|values"),
        (lambda: phases_of([0, 1], [0, np.nan]), "time|values"),
        (lambda: phases_of("ab", [0, 1]), "time|values"),
        (lambda: phases_of(0, 1), "time|values"),
    ],
)
def test_what_has_no_phases_is_refused(make, words):
    with pytest.raises(LoadingError, match=words):
        make()


def test_no_record_has_no_phases():
    assert phases_of([], []).size == 0
    assert phase_intervals([], []).phase == ()
