"""The digest of results: distinguished by every value, and by nothing else."""

from dataclasses import replace

import numpy as np
import pytest

from fingerpad import Estimate
from fingerpad._digest import digest_of_values
from fingerpad.study.manifest.models import Uncertainty
from fingerpad.study.results.table import COLUMNS, table_of

ESTIMATE = Estimate.symmetric(1.0, 0.1)


def table(*loads: float, word: str = "a"):
    names = COLUMNS["observation"].array([word] * len(loads))
    return table_of([{"observation": names, "load_N": np.array(loads)}])


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (1.0, 1.0 + 1e-15),
        (1, 1.0),
        (None, "None"),
        ([1, [2]], [1, 2]),
        (["ab", "c"], ["a", "bc"]),
        ({"a": 1}, {"b": 1}),
        (ESTIMATE, replace(ESTIMATE, interval=(ESTIMATE.lower, 9.0))),
        (np.zeros(2), np.zeros((2, 1))),
        (np.zeros(2), np.zeros(2, dtype=np.float32)),
        (np.array(["a", None], dtype=object), np.array(["a", "None"], dtype=object)),
        (table(1.0, 2.0), table(1.0)),
        (table(1.0), table(1.0, word="b")),
        (Uncertainty(load_relative_std=0.0), Uncertainty()),
    ],
    ids=str,
)
def test_what_differs_is_told_apart(one: object, other: object) -> None:
    assert digest_of_values(one) != digest_of_values(other)


def test_what_is_the_same_is_the_same() -> None:
    assert digest_of_values({"x", "y", "z"}) == digest_of_values({"z", "y", "x"})
    assert digest_of_values(table(5.0, 1.0)[1:]) == digest_of_values(table(1.0))
    assert digest_of_values([ESTIMATE]) == digest_of_values([replace(ESTIMATE)])
