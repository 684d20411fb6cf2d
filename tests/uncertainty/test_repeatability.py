"""Scatter of repeats: closed forms, limits, and coverage of studies whose truth is known."""

import numpy as np
import pytest
from benchmarks.claims import repeatability
from numpy.testing import assert_allclose
from scipy import stats

from fingerpad.exceptions import UncertaintyError
from fingerpad.uncertainty import nested_scatter

RNG = np.random.default_rng(7)
BALANCED = RNG.normal(0, 0.1, (4, 3, 2, 5)).cumsum(axis=0)  # persons, fingers, sessions, repeats
PLACES = np.indices(BALANCED.shape).reshape(4, -1)
LEVELS = {
    "person": PLACES[0],
    "finger": PLACES[0] * 3 + PLACES[1],
    "session": (PLACES[0] * 3 + PLACES[1]) * 2 + PLACES[2],
}


def test_balanced_data_give_the_textbook_mean_squares() -> None:
    found = nested_scatter(BALANCED.ravel(), LEVELS).components
    repeat = BALANCED.var(axis=3, ddof=1).mean()
    session = BALANCED.mean(axis=3).var(axis=2, ddof=1).mean()
    finger = BALANCED.mean(axis=(2, 3)).var(axis=1, ddof=1).mean()
    person = BALANCED.mean(axis=(1, 2, 3)).var(ddof=1)
    expected = [person - finger / 3, finger - session / 2, session - repeat / 5, repeat]
    assert list(found) == ["person", "finger", "session", "repeat"]
    assert_allclose([one.std for one in found.values()], np.sqrt(np.maximum(expected, 0)), rtol=1e-9)
    assert [one.freedom for one in found.values()] == [3, 8, 12, 96]
    assert [one.count for one in found.values()] == [4, 12, 24, 120]


def test_the_interval_of_repeats_is_exact() -> None:
    repeat = nested_scatter(BALANCED.ravel(), LEVELS).components["repeat"]
    assert_allclose(repeat.interval, repeat.std * np.sqrt(96 / stats.chi2.ppf([0.975, 0.025], 96)), rtol=1e-9)
    assert_allclose(repeat.limit_of_agreement, 1.96 * np.sqrt(2) * repeat.std, rtol=1e-4)


def test_unequal_groups() -> None:
    rng = np.random.default_rng(10)
    groups = np.repeat(np.arange(400), rng.integers(1, 5, 400))
    values = 12 + 1.5 * rng.normal(size=400)[groups] + 0.5 * rng.normal(size=groups.size)
    found = nested_scatter(values, {"load": groups}).components
    assert_allclose(found["repeat"].std, 0.5, rtol=0.06)
    assert_allclose(found["load"].std, 1.5, rtol=0.08)


def test_fewer_degrees_of_freedom_are_enough_if_asked_for() -> None:
    values, groups = [1.0, 2.0, 5.0], [0, 0, 1]
    assert not nested_scatter(values, {"load": groups}).components["repeat"].known
    found = nested_scatter(values, {"load": groups}, least_freedom=(1, 1)).components
    assert_allclose(found["repeat"].std ** 2, 0.5)
    assert_allclose(found["load"].std ** 2, 3.5**2 / 2 - 0.5 * (1 / 2 + 1) / 2)
    alone = nested_scatter([1.0, 2.0], {"load": [0, 0]}, least_freedom=(1, 1)).components
    assert [one.known for one in alone.values()] == [False, True]
    single = nested_scatter([1.0, 2.0], {"load": [0, 1]}, least_freedom=(1, 1)).components
    assert not any(one.known for one in single.values())


def test_conditions_are_compared_within_only() -> None:
    """Other loads shift all values, and add repeats but no fingers."""
    values, levels = BALANCED.ravel(), {name: np.tile(of, 2) for name, of in LEVELS.items()}
    one = nested_scatter(values, LEVELS).components
    twice = nested_scatter(np.append(values, values + 5.0), levels, np.repeat([0, 1], values.size)).components
    for level, found in twice.items():
        assert_allclose(found.std, one[level].std, rtol=1e-9)
        assert found.freedom == one[level].freedom * (2 if level == "repeat" else 1)


def test_levels_that_cannot_be_told_apart_are_one() -> None:
    """Persons of one finger each: what lies between fingers is part of what lies between persons."""
    values, person = BALANCED[:, 0, 0].ravel(), np.repeat(np.arange(4), 5)
    levels = {"person": person, "finger": person, "session": person}
    found = nested_scatter(values, levels).components
    alone = nested_scatter(values, {"person": person}).components["person"]
    assert found["person"].includes == ("session", "finger")
    assert found["person"].std == pytest.approx(alone.std)
    assert not found["finger"].known
    assert not found["session"].known


@pytest.mark.parametrize(
    ("groups", "known"),
    [([0, 1, 2, 3, 4, 5], False), ([0, 0, 1, 1, 2, 3], False), ([0, 0, 1, 1, 2, 2], True)],
)
def test_too_few_repeats_tell_nothing(groups: list[int], known: bool) -> None:
    found = nested_scatter(RNG.normal(size=6), {"finger": groups})
    assert [one.known for one in found.components.values()] == [known, known]
    assert np.isfinite(found.icc) == known


def test_no_scatter_between_groups_is_zero_with_an_interval_from_zero() -> None:
    values = np.tile([0.0, 0.1, -0.1, 0.2], 5) + np.repeat([0.0, 0.02, 0.01, 0.0, 0.01], 4)
    finger = nested_scatter(values, {"finger": np.repeat(np.arange(5), 4)}).components["finger"]
    assert finger.std == finger.interval[0] == 0
    assert 0 < finger.interval[1] < 0.2


def test_values_without_a_group_are_refused() -> None:
    with pytest.raises(UncertaintyError, match="each value needs its group, found 3 and 2"):
        nested_scatter([1.0, 2.0, 3.0], {"finger": [0, 1]})
    with pytest.raises(UncertaintyError, match="value"):
        nested_scatter([1.0, np.nan], {"finger": [0, 1]})


@pytest.mark.parametrize(
    ("studies", "least", "in_all"), [(8, 0.6, 0.8), pytest.param(60, 0.85, 0.9, marks=pytest.mark.nightly)]
)
def test_coverage(studies: int, least: float, in_all: float) -> None:
    """On a few studies what the benchmark measures on many: few groups, unbalanced, nested."""
    totals: dict[str, list[bool]] = {}
    for place in (0, 2, 6):
        _, population, design = repeatability.CONDITIONS[place]
        for name, held in repeatability.component_coverage(population, design, studies).items():
            assert np.mean(held) > least, (name, place)
            totals.setdefault(name, []).extend(held)
    for name, found in totals.items():
        assert np.mean(found) > in_all, name


def test_only_groups_of_two_and_more_are_counted() -> None:
    fingers = [0, 0, 0, 1, 1, 2, 3]
    repeat = nested_scatter(RNG.normal(size=7), {"finger": fingers}).components["repeat"]
    assert (repeat.groups, repeat.count, repeat.freedom) == (2, 5, 3)
