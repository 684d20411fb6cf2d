"""The table: what is put in comes out, for one row, some of them, and all."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from tests.studies import rows_of

from fingerpad.study.results.output import write_rows
from fingerpad.study.results.table import COLUMNS, Row, first_record, groups, records, table_of

ROWS = [
    {"observation": "a", "finger": "f", "load_N": 1.5, "frame": None, "pooled": True, "sequence": None},
    {"observation": 'b"ü, 2', "finger": "g", "load_N": None, "frame": 0, "pooled": False, "sequence": "p"},
    {"observation": "c", "finger": "f", "load_N": -2e-7, "frame": 12, "pooled": False, "sequence": "p"},
    {
        "observation": "line\nbreak",
        "finger": "f",
        "load_N": 3.0,
        "frame": 13,
        "pooled": True,
        "sequence": "q",
    },
]


def table_by(rows: list[Row], batch: int, *, read_only: bool = False) -> pd.DataFrame:
    starts = range(0, len(rows), batch)
    some = (
        {name: COLUMNS[name].array([row[name] for row in rows[start : start + batch]]) for name in ROWS[0]}
        for start in starts
    )
    return table_of(some, read_only=read_only)


@pytest.mark.parametrize("batch", [1, 3, 4])
def test_rows_come_out_as_they_went_in(batch: int) -> None:
    table = table_by(ROWS, batch)
    whole = [{**dict.fromkeys(COLUMNS), "synthetic": False, **row} for row in ROWS]
    assert list(records(table)) == whole
    assert first_record(table) == whole[0]
    assert first_record(table[:0]) is None
    assert all(
        type(item) in {str, float, int, bool, type(None)} for row in records(table) for item in row.values()
    )
    pd.testing.assert_frame_equal(table, table_by(ROWS, 2))
    pd.testing.assert_frame_equal(table, table_by(ROWS, batch, read_only=True))


def test_a_table_can_be_written_to_unless_it_is_read_only() -> None:
    table, fixed = table_by(ROWS, 2), table_by(ROWS, 2, read_only=True)
    table.loc[0, "session"] = "morning"
    assert table["session"].tolist() == ["morning", None, None, None]
    with pytest.raises(ValueError, match="read-only"):
        fixed.loc[0, "session"] = "morning"


def test_types_are_those_of_the_registry_whatever_is_known() -> None:
    """Also of no row, and of columns in which nothing is known: pandas guesses neither."""
    names = {"text": "object", "bool": "bool", "int": "Int64", "float": "float64"}
    for table in (table_by(ROWS, 2), table_by(ROWS[:1], 1), table_of([])):
        assert list(table.dtypes.astype(str)) == [names[column.dtype] for column in COLUMNS.values()]


def test_some_rows_keep_their_places_in_the_whole() -> None:
    table = table_by(ROWS, 2)
    sequences = groups(table[table["frame"].notna()], "sequence", "finger")
    assert list(sequences) == [("p", "g"), ("p", "f"), ("q", "f")]
    assert sequences["q", "f"].tolist() == [2]
    assert list(groups(table, "sequence")) == [(None,), ("p",), ("q",)]


def test_records_hold_the_columns_asked_for() -> None:
    table = table_by(ROWS, 2)
    assert list(records(table[table["frame"].notna()], "frame", "load_N")) == [
        {"frame": 0, "load_N": None},
        {"frame": 12, "load_N": -2e-7},
        {"frame": 13, "load_N": 3.0},
    ]


@pytest.mark.parametrize("count", [0, 1, 4, 2500])
def test_files_hold_every_row(tmp_path: Path, count: int) -> None:
    rows = [{**ROWS[k % 4], "load_N": None if k % 5 == 1 else k / 7} for k in range(count)]
    rows[:1] = [{**row, "load_N": np.inf} for row in rows[:1]]
    write_rows(table_by(rows, 700), tuple(COLUMNS), tmp_path / "c", tmp_path / "j")
    objects = json.loads((tmp_path / "j").read_text(encoding="utf-8"))
    lines = rows_of(tmp_path / "c")
    assert len(objects) == len(lines) == count
    for place, (record, line) in enumerate(zip(objects, lines, strict=True)):
        assert list(record) == list(line) == list(COLUMNS)
        assert record["observation"] == line["observation"] == rows[place]["observation"]
        load = None if place == 0 else rows[place]["load_N"]
        assert record["load_N"] == load
        assert line["load_N"] == ("" if load is None else repr(load))
        assert line["pooled"] == str(record["pooled"]).lower()
        frame = rows[place]["frame"]
        assert (record["frame"], line["frame"]) == (frame, "" if frame is None else str(frame))
    text = (tmp_path / "j").read_text(encoding="utf-8")
    assert text == json.dumps(objects, indent=1, ensure_ascii=False) + "\n"
