"""Small functions below all packages: cells, names, doubts, rounded numbers, and digests of values."""

import csv
import io
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import settings as examples
from hypothesis import strategies as st
from pydantic_core import SchemaError

from fingerpad import Estimate
from fingerpad._columns import columns_in_toml, header_parts
from fingerpad._csv import csv_cell, csv_text, escape_formula, unescape_formula
from fingerpad._digest import digest_of_values
from fingerpad._display import short_text
from fingerpad._files import file_stem
from fingerpad._plausible import load_doubts, semi_axes_doubt
from fingerpad._rounding import (
    positive_with_uncertainty,
    two_digits,
    uncertainty_of_positive,
    value_with_uncertainty,
)
from fingerpad.exceptions import ImageError, is_interrupt, reason_of
from fingerpad.study.manifest.models import Uncertainty
from fingerpad.study.results.table import COLUMNS, table_of


@pytest.mark.parametrize(
    ("value", "std", "text"),
    [
        (13.80484, 0.18442, "13.80 ± 0.18"),
        (13.80484, 0.0996, "13.80 ± 0.10"),
        (13.80484, 0.0994, "13.805 ± 0.099"),
        (0.00123, 0.000456, "0.00123 ± 0.00046"),
        (1234.5, 56.7, "1234 ± 57"),
        (123456.0, 5678.0, "123500 ± 5700"),
        (13.61796, 0.00025, "13.618 ± 0.001"),
        (-0.5, 0.25, "-0.50 ± 0.25"),
        (20.5, None, "20.5"),
        (20.5, np.nan, "20.5"),
        (0.5, 0.0, "0.500"),
        (0.0004, None, "0.000400"),
        (12345, None, "12340"),
        (None, 0.1, "–"),
        (np.nan, 1.0, "–"),
    ],
)
def test_a_value_has_the_digits_of_its_uncertainty(value, std, text) -> None:
    assert value_with_uncertainty(value, std) == text


def test_what_is_known_badly_has_a_factor() -> None:
    assert [positive_with_uncertainty(39.3, std) for std in (4.1, 94.0)] == ["39.3 ± 4.1", "39 ×/÷ 3.4"]
    assert [uncertainty_of_positive(39.3, std) for std in (4.1, 94.0)] == ["± 4.1", "×/÷ 3.4"]
    assert [two_digits(0.0996), two_digits(5678.0), two_digits(0.0)] == ["0.10", "5700", "0"]


def test_cells_and_short_texts() -> None:
    cells = ["0.1", "2", "true", "1.5, 2", "", "'=1+1"]
    assert [csv_cell(value) for value in (0.1, 2, True, [1.5, 2], None, "=1+1")] == cells
    values = np.float64(12.3456789), np.arange(3.0), np.zeros((512, 2))
    assert [short_text(value) for value in values] == ["12.3457", "[0, 1, 2]", "<array (512, 2)>"]


def test_names_of_files_are_cut_and_stay_different() -> None:
    assert file_stem("left_index_30deg") == "left_index_30deg"
    assert len(file_stem("指" * 90).encode()) == 197
    assert file_stem("指" * 90) != file_stem("指" * 91)


def test_headers_state_units() -> None:
    assert header_parts("Normal force [mN]") == ("normal force", "mN", True)
    assert header_parts("Disp / µm") == ("disp", "um", True)
    assert header_parts("force_N") == header_parts("Force N", {"N"}) == ("force", "N", False)
    assert header_parts("load cell", {"N"}) == ("load cell", "", False)
    line = 'file_columns = { force = "Fz (mN):mN" }'
    assert columns_in_toml("file_columns", {"force": "Fz (mN):mN"}) == line


def test_doubts_of_what_no_finger_has() -> None:
    assert semi_axes_doubt((7.9, 13.8, 11.8)) == ""
    assert semi_axes_doubt((15.0, 28.4, 23.0)).startswith("radial_ulnar 23 mm would be a finger 46 mm wide")
    assert semi_axes_doubt((7.9, 11.8, 13.8)) == ""
    assert semi_axes_doubt((7.9, 9.5, 13.1)).startswith("radial_ulnar 13.1 mm is more than distal 9.5 mm")
    assert not list(load_doubts(2.0, 60.0))
    assert len(list(load_doubts(2000.0, 60000.0))) == 2


@pytest.mark.parametrize(
    ("error", "reason"),
    [
        (ImageError("a.png: no such file"), "a.png: no such file"),
        (PermissionError(13, "Permission denied", "a.csv"), "a.csv: Permission denied"),
        (OSError(28, "No space left on device"), "cannot write (No space left on device)"),
        (KeyError("width"), "cannot write (KeyError: 'width')"),
    ],
)
def test_reasons_name_file_or_step(error, reason) -> None:
    assert reason_of(error, "cannot write") == reason
    assert not is_interrupt(error)
    assert is_interrupt(KeyboardInterrupt())


def test_an_interrupt_is_one_in_whatever_error_it_comes() -> None:
    imported, model = ImportError("initialization failed"), SchemaError("Error building: KeyboardInterrupt:")
    imported.__cause__ = KeyboardInterrupt()  # as of a compiled module
    assert is_interrupt(imported)
    assert is_interrupt(model)
    assert not is_interrupt(SchemaError("Error building"))


FORMULAS = ('=HYPERLINK("x")', "+1+1", "-x", "-", "@SUM(A1)", "\t=1", "\r=1", "-1.5e", "-1 -2", "+1;=2")
NUMBERS = ("-1.5", "+2", "-1e-7", "-.5", "-5, 3.5", "1,2")
TEXTS = st.text(st.one_of(st.sampled_from("='+-@\t\r\n, 1.\""), st.characters(codec="utf-8")), max_size=8)


@pytest.mark.parametrize("text", [*FORMULAS, *NUMBERS, "left_index", "", "'quoted'", "a=b"])
def test_formulas_alone_become_text(text: str) -> None:
    escaped = f"'{text}" if text in FORMULAS else text
    assert escape_formula(text) == escaped
    assert unescape_formula(escaped) == text


@examples(derandomize=True, max_examples=100, database=None)
@given(st.lists(st.lists(TEXTS, min_size=2, max_size=3), max_size=4))
@example([["a\rb,30,1", "'=1"]])
def test_text_round_trip(rows: list[list[str]]) -> None:
    written = list(csv.reader(io.StringIO(csv_text(rows), newline="")))
    assert [[unescape_formula(cell) for cell in row] for row in written] == rows


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
