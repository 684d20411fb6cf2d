"""The table: what is put in comes out, for one row, some of them, and all."""

import json
from collections.abc import Iterator

import numpy as np
import pandas as pd
import pytest
from tests.studies import finger, rows_of, study_of
from tests.study.measured import frame, measured, pad

from fingerpad.report.text import pooled_from
from fingerpad.study.manifest.models import Contact
from fingerpad.study.measuring.contacts import Measurement
from fingerpad.study.results import rows as rows_module
from fingerpad.study.results.output import write_rows
from fingerpad.study.results.pooling import pool_contacts
from fingerpad.study.results.rows import Rows
from fingerpad.study.results.table import COLUMNS, Row, groups, record_at, records, table_of

KEYS = ("observation", "finger", "load_N", "frame", "pooled", "sequence")
ROWS = [
    dict(zip(KEYS, row, strict=True))
    for row in (
        ("a", "f", 1.5, None, True, None),
        ('b"ü, 2', "g", None, 0, False, "p"),
        ("c", "f", -2e-7, 12, False, "p"),
        ("line\nbreak", "f", 3.0, 13, True, "q"),
    )
]


def table_by(rows: list[Row], batch: int, *, read_only: bool = False) -> pd.DataFrame:
    starts = range(0, len(rows), batch)
    some = (
        {name: COLUMNS[name].array([row[name] for row in rows[start : start + batch]]) for name in ROWS[0]}
        for start in starts
    )
    return table_of(some, read_only=read_only)


@pytest.mark.parametrize("batch", [1, 3, 4])
def test_rows_come_out_as_they_went_in(batch):
    table = table_by(ROWS, batch)
    whole = [{**dict.fromkeys(COLUMNS), "synthetic": False, **row} for row in ROWS]
    assert list(records(table)) == whole
    assert record_at(table) == whole[0]
    assert record_at(table[:0]) is None
    assert all(
        type(item) in {str, float, int, bool, type(None)} for row in records(table) for item in row.values()
    )
    pd.testing.assert_frame_equal(table, table_by(ROWS, 2))
    pd.testing.assert_frame_equal(table, table_by(ROWS, batch, read_only=True))


def test_a_table_can_be_written_to_unless_it_is_read_only():
    table, fixed = table_by(ROWS, 2), table_by(ROWS, 2, read_only=True)
    table.loc[0, "session"] = "morning"
    assert table["session"].tolist() == ["morning", None, None, None]
    with pytest.raises(ValueError, match="read-only"):
        fixed.loc[0, "session"] = "morning"


def test_types_are_those_of_the_registry_whatever_is_known():
    """Also of no row, and of columns in which nothing is known: pandas guesses neither."""
    names = {"text": "object", "bool": "bool", "int": "Int64", "float": "float64"}
    for table in (table_by(ROWS, 2), table_by(ROWS[:1], 1), table_of([])):
        assert list(table.dtypes.astype(str)) == [names[column.dtype] for column in COLUMNS.values()]


def test_a_column_that_columns_csv_lacks_is_not_dropped_in_silence():
    with pytest.raises(ValueError, match=r"columns\.csv has no line for contact_length_mm"):
        table_of([{"load_N": np.ones(1), "contact_length_mm": np.ones(1)}])


def test_some_rows_keep_their_places_in_the_whole():
    table = table_by(ROWS, 2)
    some = table[table["frame"].notna()]
    sequences = groups(some, "sequence", "finger")
    assert list(sequences) == [("p", "g"), ("p", "f"), ("q", "f")]
    assert sequences["q", "f"].tolist() == [2]
    assert list(groups(table, "sequence")) == [(None,), ("p",), ("q",)]
    found = [(row["frame"], row["load_N"]) for row in records(some, "frame", "load_N")]
    assert found == [(0, None), (12, -2e-7), (13, 3.0)]


@pytest.mark.parametrize("count", [0, 1, 2500])
def test_files_hold_every_row(tmp_path, count):
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


# Everything after measuring: the same however it is streamed, and never all of it in memory


STUDY = study_of(finger(), uncertainty={"wedge_angle_deg_std": 0.5})


def many(count: int) -> Iterator[tuple[Contact, Measurement]]:
    """Yield frames and single contacts in turn, some of which failed, as they are measured."""
    noise = np.random.default_rng(4).normal(0, 0.1, (count, 2))
    for number, axes in enumerate(np.add([7.0, 5.0], noise)):
        covariance = 0.01 * np.eye(2) + 0.02**2 * np.outer(axes, axes)
        known = {"covariance_mm2": covariance, "relative_scale_std": 0.02}
        if number % 2:
            yield frame(number, axes, scale="sequence:p", counts=number % 10 != 1, **known)
        else:
            failed = {"reason": "the page is damaged"} if number % 100 == 8 else {}
            yield measured(f"c{number}", axes, scale=f"s{number % 3}", **known, **failed)


def test_batches_change_nothing(monkeypatch):
    whole = Rows(STUDY, {"f": pad()}, many(300))
    monkeypatch.setattr(rows_module, "_AT_ONCE", 7)
    parted = Rows(STUDY, {"f": pad()}, many(300))
    pd.testing.assert_frame_equal(whole.table, parted.table, rtol=1e-9)
    for one, other in zip(pool_contacts(whole), pool_contacts(parted), strict=True):
        assert pooled_from(one) == pooled_from(other)
        assert one.corrected_radius.total_std == pytest.approx(other.corrected_radius.total_std, rel=1e-9)


def test_no_more_than_a_batch_is_held():
    alive: set[int] = set()
    most = 0

    class Counted(Measurement):
        def __del__(self) -> None:
            alive.discard(id(self))

    def seen() -> Iterator[tuple[Contact, Measurement]]:
        nonlocal most
        for where, one in many(1_900):
            counted = Counted(**{name: getattr(one, name) for name in Measurement.__slots__})
            alive.add(id(counted))
            most = max(most, len(alive))
            yield where, counted
            del counted

    assert len(Rows(STUDY, {"f": pad()}, seen()).table) == 1_900
    assert most <= 2 * rows_module._AT_ONCE
