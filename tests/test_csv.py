"""Text in CSV files: no spreadsheet takes it for a formula, and it is read back as it was."""

import csv
import io

import pytest
from hypothesis import example, given
from hypothesis import settings as examples
from hypothesis import strategies as st

from fingerpad._csv import csv_text, escape_formula, unescape_formula

FORMULAS = ('=HYPERLINK("x")', "+1+1", "-x", "-", "@SUM(A1)", "\t=1", "\r=1", "-1.5e", "-1 -2", "+1;=2")
NUMBERS = ("-1.5", "+2", "-1e-7", "-.5", "-5, 3.5", "1,2")
TEXTS = st.text(st.one_of(st.sampled_from("='+-@\t\r\n, 1.\""), st.characters(codec="utf-8")), max_size=8)


@pytest.mark.parametrize("text", FORMULAS)
def test_formula_becomes_text(text: str) -> None:
    assert escape_formula(text) == f"'{text}"
    assert unescape_formula(f"'{text}") == text


@pytest.mark.parametrize("text", [*NUMBERS, "left_index", "", "'quoted'", "a=b"])
def test_numbers_and_words_unchanged(text: str) -> None:
    assert escape_formula(text) == text
    assert unescape_formula(text) == text


@examples(derandomize=True, max_examples=100, database=None)
@given(st.lists(st.lists(TEXTS, min_size=2, max_size=3), max_size=4))
@example([["a\rb,30,1", "'=1"]])
def test_text_round_trip(rows: list[list[str]]) -> None:
    written = list(csv.reader(io.StringIO(csv_text(rows), newline="")))
    assert [[unescape_formula(cell) for cell in row] for row in written] == rows
