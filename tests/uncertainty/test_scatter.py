"""Scatter of repeats, of operators and of a model: closed forms, limits, and coverage of known truth."""

import math

import numpy as np
import pytest
import scipy
from benchmarks.claims import repeatability
from numpy.testing import assert_allclose

from fingerpad.uncertainty import agreement, nested_scatter
from fingerpad.uncertainty.discrepancy import model_discrepancy
from fingerpad.uncertainty.repeats import ContactRepeatability, nominal_loads

BALANCED = (
    np.random.default_rng(7).normal(0, 0.1, (4, 3, 2, 5)).cumsum(axis=0)
)  # persons, fingers, sessions, repeats
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
    assert_allclose(
        repeat.interval, repeat.std * np.sqrt(96 / scipy.stats.chi2.ppf([0.975, 0.025], 96)), rtol=1e-9
    )
    assert_allclose(repeat.limit_of_agreement, 1.96 * np.sqrt(2) * repeat.std, rtol=1e-4)


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


@pytest.mark.parametrize(
    ("groups", "known"),
    [([0, 1, 2, 3, 4, 5], False), ([0, 0, 1, 1, 2, 3], False), ([0, 0, 1, 1, 2, 2], True)],
)
def test_too_few_repeats_tell_nothing(groups: list[int], known: bool) -> None:
    found = nested_scatter(np.random.default_rng(7).normal(size=6), {"finger": groups})
    assert [one.known for one in found.components.values()] == [known, known]
    assert np.isfinite(found.icc) == known


def test_no_scatter_between_groups_is_zero_with_an_interval_from_zero() -> None:
    values = np.tile([0.0, 0.1, -0.1, 0.2], 5) + np.repeat([0.0, 0.02, 0.01, 0.0, 0.01], 4)
    finger = nested_scatter(values, {"finger": np.repeat(np.arange(5), 4)}).components["finger"]
    assert finger.std == finger.interval[0] == 0
    assert 0 < finger.interval[1] < 0.2


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
    repeat = nested_scatter(np.random.default_rng(7).normal(size=7), {"finger": fingers}).components["repeat"]
    assert (repeat.groups, repeat.count, repeat.freedom) == (2, 5, 3)


@pytest.mark.parametrize(
    ("loads", "expected"),
    [
        ([2.0, 0.5, 1.0], [2, 0, 1]),
        ([0.95, 1.0, 1.05], [0, 0, 0]),
        ([1.0, 1.06], [0, 0]),
        ([1.0, 1.12], [0, 1]),
        ([1.0, 1.04, 1.08, 1.12, 1.16], [0, 1, 2, 3, 4]),  # a ramp
        ([1.0, 1.04, 1.08, 1.12, 1.04, 5.0, 5.1], [0, 1, 2, 3, 1, 4, 4]),
        ([], []),
    ],
)
def test_nominal_loads(loads: list[float], expected: list[int]) -> None:
    assert nominal_loads(loads).tolist() == expected


def test_noise_is_not_counted_twice() -> None:
    """What repeats scatter by beyond their noise is theirs; noise alone makes no repeatability."""
    rng, group = np.random.default_rng(3), np.repeat(np.arange(300), 4)
    noise = np.diag([0.02**2, 0.04**2])
    axes = rng.normal(0, (0.02, 0.04), (1200, 2))
    more = axes + rng.normal(0, (0.03, 0.01), (1200, 2))
    alone, both = (ContactRepeatability.of(of, [noise] * 1200, group) for of in (axes, more))
    assert both.area_std == pytest.approx(0.06, rel=0.1)
    assert alone.area_std < 0.02
    assert (both.freedom, both.groups, both.count) == (900, 300, 1200)


def test_against_sums_by_hand() -> None:
    """Differences of −0.02, 0, 0.02 and 0.04: mean 0.01, standard deviation √(0.002/3)."""
    found = agreement(np.ones(4), np.exp([-0.02, 0.0, 0.02, 0.04]))
    std = math.sqrt(0.002 / 3)
    assert found.std == pytest.approx(std)
    assert found.bias == pytest.approx(math.expm1(0.01))
    assert found.bias_interval[1] == pytest.approx(math.expm1(0.01 + 3.182446 * std / 2))
    far = scipy.stats.nct.ppf(0.975, 3, 1.959964 * 2) * std / 2  # of an end, by the noncentral t distribution
    assert found.limits_interval == pytest.approx((math.expm1(0.01 - far), math.expm1(0.01 + far)), rel=1e-5)
    assert found.limits == pytest.approx(
        (math.expm1(0.01 - 1.959964 * std), math.expm1(0.01 + 1.959964 * std))
    )


def test_too_few_pairs_say_so() -> None:
    found = agreement([1.0, 1.0], [1.1, 1.3])
    assert found.bias == pytest.approx(math.sqrt(1.1 * 1.3) - 1)
    assert math.isnan(found.std)
    assert math.isnan(found.limits[0])
    assert math.isnan(agreement([], []).bias)


def test_the_discrepancy_makes_differences_as_large_as_expected() -> None:
    ratios, stds = np.array([0.5, 0.42, 0.1, 0.61]), np.array([0.05, 0.2, 0.1, 0.3])
    found = model_discrepancy(ratios, stds)
    assert np.sum(ratios**2 / (stds**2 + found.between_std**2)) == pytest.approx(4)
    assert found.relative_std == pytest.approx(math.expm1(found.between_std / math.sqrt(2)))
    assert found.count == 4


def test_there_is_no_discrepancy_where_uncertainties_explain_the_differences() -> None:
    assert model_discrepancy([0.1, -0.1], [0.2, 0.2]).relative_std == 0.0
    assert model_discrepancy([0.0], [0.0]).relative_std == 0.0
