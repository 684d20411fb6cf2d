"""Comparisons of two ways to a quantity, verdicts, and the discrepancy of a model."""

import math

import numpy as np
import pytest
from scipy import stats

from fingerpad.study.results.validity.model_checks import (
    FAILS,
    HOLDS,
    NOT_TESTED,
    STRAINED,
    ValidityCheck,
    judge_together,
    overall_verdict,
    p_value_of,
    verdict_of,
    verdict_of_error,
)

CHECK = ValidityCheck(check="n", compared="n", headlines=("E",))


def ratio(value: float, std: float, reference: float, reference_std: float) -> ValidityCheck:
    return CHECK.of_ratio((value, std), (reference, reference_std))


@pytest.mark.parametrize(
    ("p_value", "size", "std", "verdict"),
    [
        (1e-300, 0.01, 0.001, HOLDS),  # certain, and too small to matter
        (0.04, 0.06, 0.03, STRAINED),
        (0.06, 0.06, 0.03, HOLDS),
        (1e-5, 0.19, 0.04, STRAINED),  # certain, of middle size
        (1e-5, 0.21, 0.04, FAILS),
        (0.002, 3.0, 0.5, STRAINED),  # large, but not certain
        (0.5, 0.01, 0.1, HOLDS),
        (0.5, 0.01, 0.11, NOT_TESTED),  # a difference of 20 % would not be seen
        (0.5, 0.01, math.nan, NOT_TESTED),
    ],
)
def test_a_verdict_needs_probability_and_size(p_value: float, size: float, std: float, verdict: str) -> None:
    assert verdict_of(p_value, size, std) == verdict
    assert verdict_of(p_value, -size, std) == verdict


def test_known_errors_count_in_factors() -> None:
    assert [verdict_of_error(size) for size in (0.05, 0.051, 0.2, 0.21)] == [HOLDS, STRAINED, STRAINED, FAILS]
    # A third too small is as wrong as half too large.
    low, high = CHECK.of_known_error(1.0, 1.21, ""), CHECK.of_known_error(1.21, 1.0, "")
    assert low.verdict == high.verdict == FAILS
    assert low.relative_difference == pytest.approx(1 / 1.21 - 1)
    assert math.isnan(low.p_value)


def test_the_worst_counts_and_what_was_not_tested_does_not() -> None:
    assert overall_verdict([NOT_TESTED, HOLDS]) == HOLDS
    assert overall_verdict([FAILS, HOLDS, STRAINED]) == FAILS
    assert overall_verdict([NOT_TESTED]) == NOT_TESTED


def test_p_is_uniform_where_two_values_have_one_truth() -> None:
    rng = np.random.default_rng(3)
    truth, std, other_std = 14.0, 0.4, 0.9
    found = [
        ratio(truth + std * a, std, truth + other_std * b, other_std)
        for a, b in rng.standard_normal((2000, 2))
    ]
    p_values = [one.p_value for one in found]
    assert stats.kstest(p_values, "uniform").pvalue > 0.01
    assert np.mean([one.verdict == HOLDS for one in found]) > 0.94


def test_shared_errors_cancel() -> None:
    rng = np.random.default_rng(4)
    shared, own = rng.normal(0, 0.2, 2000), rng.normal(0, 0.02, (2, 2000))
    first, second = np.exp(shared + own)
    found = [
        CHECK.of_ratio((a, 0.201 * a), (b, 0.201 * b), log_std=math.hypot(0.02, 0.02)).deviations
        for a, b in zip(first, second, strict=True)
    ]
    assert np.std(found) == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize(("value", "verdict"), [(0.4, FAILS), (2 / 3, HOLDS)])
def test_exact_exponents_differ_for_certain_or_not_at_all(value: float, verdict: str) -> None:
    check = CHECK.of_difference((value, 0.0), 2 / 3, effect=-2.0)
    assert (check.verdict, check.p_value) == (verdict, 0.0 if verdict == FAILS else 1.0)


def test_small_samples_are_judged_by_t() -> None:
    assert p_value_of(12.706, 1) == pytest.approx(0.05, abs=1e-4)
    one = CHECK.of_difference((0.4, 0.05), 2 / 3, effect=-3.0)
    few = CHECK.of_difference((0.4, 0.05), 2 / 3, effect=-3.0, degrees_of_freedom=1)
    assert (one.verdict, few.verdict) == (FAILS, NOT_TESTED)
    assert one.relative_difference == pytest.approx(math.exp(0.8) - 1)


def named(check: ValidityCheck, name: str) -> ValidityCheck:
    return check.with_fields(check=name)


def test_several_checks_share_the_chance_of_a_false_alarm() -> None:
    one = ratio(10.0, 0.25, 10.9, 0.25)  # p = 0.012
    assert one.verdict == STRAINED
    same, sure = ratio(10.0, 0.1, 10.0, 0.1), ratio(10.0, 0.1, 20.0, 0.2)
    assert judge_together([one, *(named(same, f"s{k}") for k in range(2))])[0].verdict == STRAINED
    assert judge_together([one, *(named(same, f"s{k}") for k in range(4))])[0].verdict == HOLDS
    assert judge_together([one, *(named(sure, f"s{k}") for k in range(9))])[0].verdict == STRAINED
    copies = [named(one, f"c{k}") for k in range(9)]
    assert {each.verdict for each in judge_together(copies)} == {HOLDS}
    together = judge_together(copies, same=[each.check for each in copies])
    assert {each.verdict for each in together} == {STRAINED}
    rng = np.random.default_rng(5)
    alarms = [
        overall_verdict(
            each.verdict
            for each in judge_together(
                [named(ratio(x, 0.07, 1.0, 0.0), f"{k}") for k, x in enumerate(1 + 0.07 * four)]
            )
        )
        != HOLDS
        for four in rng.standard_normal((1000, 4))
    ]
    assert np.mean(alarms) < 0.065


def test_evidence_of_one_check_is_not_lost_by_adding_others_that_agree() -> None:
    """An exponent over four contacts, then with the comparisons that a loading curve adds."""
    growth = CHECK.of_difference((0.13, 0.06), 2 / 3, effect=-3.1, degrees_of_freedom=2, effect_on="E")
    alone = judge_together([growth, *(named(ratio(10.0, 0.1, 10.0, 0.1), f"{k}") for k in range(2))])
    agreeing = [named(ratio(10.0, 0.1, 30.0, 0.3), f"with curve {k}") for k in range(3)]
    more = judge_together([*alone, *agreeing])
    assert alone[0].verdict == more[0].verdict == STRAINED
    against = judge_together([*alone, *(named(ratio(10.0, 0.1, 10.0, 0.1), f"o{k}") for k in range(9))])
    assert against[0].verdict == NOT_TESTED
    assert "would hide" not in against[0].note
    assert "may be chance" in against[0].note
