"""Rows by column: what is put in comes out, for one row, some of them, and all."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from fingerpad.study.results.columns import COLUMNS
from fingerpad.study.results.output import write_rows
from fingerpad.study.results.table import ResultsTable, Row, TableBuilder

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


LOADS = (None, 3.0, 1.0, None, 1.0, 1.0)


def table_of(rows: list[Row], batch: int) -> ResultsTable:
    builder = TableBuilder()
    for start in range(0, len(rows), batch):
        some = rows[start : start + batch]
        builder.add({name: COLUMNS[name].array([row[name] for row in some]) for name in ROWS[0]})
    return builder.table()


@pytest.mark.parametrize("batch", [1, 3, 4])
def test_rows_come_out_as_they_went_in(batch: int) -> None:
    table = table_of(ROWS, batch)
    whole = [{**dict.fromkeys(COLUMNS), "synthetic": False, **row} for row in ROWS]
    assert list(table) == [table[place] for place in range(4)] == whole
    assert list(table[0]) == list(COLUMNS)
    assert table[-1]["observation"] == "line\nbreak"
    assert all(type(item) in {str, float, int, bool, type(None)} for row in table for item in row.values())
    assert table == table_of(ROWS, 2)
    assert table != table_of(ROWS[:3], 2)
    assert table != table_of([*ROWS[:3], {**ROWS[3], "load_N": 3.1}], 2)


def test_some_rows_keep_their_places_in_the_whole() -> None:
    table = table_of(ROWS, 2)
    sequences = table.at(table.known("frame")).by("sequence", "finger")
    assert list(sequences) == [("p", "g"), ("p", "f"), ("q", "f")]
    assert sequences["q", "f"].places.tolist() == [3]
    assert sequences["q", "f"][0] == table[3] == list(table[2:])[1]
    assert table[1:][::-1].column("frame").tolist() == [13, 12, 0]
    assert table[1:].at(np.array([2, 0])).places.tolist() == [3, 1]
    assert np.isnan(table.column("load_N")).tolist() == [False, True, False, False]
    with pytest.raises(IndexError):
        table[4]


def test_rows_without_a_value_come_last_whichever_way_they_are_sorted() -> None:
    rows = [
        {**ROWS[0], "observation": name, "load_N": load} for name, load in zip("abcdef", LOADS, strict=True)
    ]
    table = table_of(rows, 4)
    assert table.sorted_by("load_N").items("observation") == ["c", "e", "f", "b", "a", "d"]
    assert table.sorted_by("load_N", descending=True).items("observation") == ["b", "c", "e", "f", "a", "d"]
    sequences = table_of(ROWS, 4).sorted_by("sequence", descending=True)
    assert sequences.items("sequence") == ["q", "p", "p", None]
    frames = table_of(ROWS, 4).sorted_by("frame")
    assert frames.items("frame") == [0, 12, 13, None]


def test_records_hold_the_columns_asked_for() -> None:
    table = table_of(ROWS, 2)
    assert list(table.at(table.known("frame")).records("frame", "load_N")) == [
        {"frame": 0, "load_N": None},
        {"frame": 12, "load_N": -2e-7},
        {"frame": 13, "load_N": 3.0},
    ]


@pytest.mark.parametrize("count", [0, 1, 4, 2500])
def test_files_hold_every_row(tmp_path: Path, count: int) -> None:
    rows = [{**ROWS[k % 4], "load_N": None if k % 5 == 1 else k / 7} for k in range(count)]
    rows[:1] = [{**row, "load_N": np.inf} for row in rows[:1]]
    write_rows(table_of(rows, 700) if rows else TableBuilder().table(), tmp_path / "c", tmp_path / "j")
    records = json.loads((tmp_path / "j").read_text(encoding="utf-8"))
    with (tmp_path / "c").open(encoding="utf-8", newline="") as file:
        lines = list(csv.DictReader(file))
    assert len(records) == len(lines) == count
    for place, (record, line) in enumerate(zip(records, lines, strict=True)):
        assert list(record) == list(line) == list(COLUMNS)
        assert record["observation"] == line["observation"] == rows[place]["observation"]
        load = None if place == 0 else rows[place]["load_N"]
        assert record["load_N"] == load
        assert line["load_N"] == ("" if load is None else repr(load))
        assert line["pooled"] == str(record["pooled"]).lower()
        frame = rows[place]["frame"]
        assert (record["frame"], line["frame"]) == (frame, "" if frame is None else str(frame))
    text = (tmp_path / "j").read_text(encoding="utf-8")
    assert text == json.dumps(records, indent=1, ensure_ascii=False) + "\n"
