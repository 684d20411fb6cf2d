"""Tables out: what is read back from Parquet, MATLAB and Excel files is what the run wrote."""

import json
import re
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from pyarrow import parquet
from python_calamine import CalamineWorkbook
from scipy import io
from tests import command
from tests.studies import Table, contact, correct, finger, picture, rows_of, write_study, write_sums

import fingerpad as fp
from fingerpad._csv import package_table
from fingerpad.exceptions import FingerpadError
from fingerpad.study.pipeline import run_study
from fingerpad.study.results import load
from fingerpad.study.results.load import export_results, read_rows
from fingerpad.study.results.summary_file import CurveRecord, SummaryFile, ThicknessFitRecord
from fingerpad.study.results.table import COLUMNS


def make(folder: Path, *more: Table, **of: Any) -> Path:
    heavy = contact("heavy", finger="index")
    light = contact("light", 0.5, (5.3, 4.2), finger="index", wedge=45, axis="", **of)
    stated = {"wedge_angle_deg_std": 0.5}
    tables = finger("index"), heavy, light, *more
    return write_study(folder, *tables, title="Two presses, é", uncertainty=stated)


@pytest.fixture(scope="module")
def results(tmp_path_factory) -> Path:
    """Return the results, in all columns, of a study of which one picture cannot be read."""
    folder = tmp_path_factory.mktemp("study")
    (folder / "broken.png").write_bytes(b"no picture")
    lost = picture("lost", "broken.png", 0.5, finger="index", wedge=45, scale={"ppi": 500})
    run_study(make(folder, lost, synthetic=True), folder / "out", all_columns=True)
    return folder / "out"


def copied(results: Path, folder: Path, **changed: str) -> Path:
    """Copy a run's tables, with the content of some replaced."""
    folder.mkdir()
    for name in ("results.csv", "results_columns.csv", "summary.json"):
        (folder / name).write_bytes((results / name).read_bytes())
    for name, content in changed.items():
        (folder / name.replace("__", ".")).write_text(content, encoding="utf-8")
    return write_sums(folder)


def test_parquet_keeps_values_types_units_and_meanings(results, tmp_path):
    export_results(results, tmp_path / "r.parquet")
    rows = json.loads((results / "results.json").read_text())
    table = parquet.read_table(tmp_path / "r.parquet")
    assert table.to_pylist() == [
        {name: None if item == "" else item for name, item in row.items()} for row in rows
    ]
    types = {field.name: str(field.type) for field in table.schema}
    assert types["synthetic"] == types["pooled"] == "bool"
    assert types["frame"] == "int64"
    assert types["scale"] == types["reason"] == "string"
    assert types["load_N"] == types["time_s"] == types["ridge_area_mm2_std"] == "double"
    kept = {"unit": "mm", "meaning": "standard uncertainty of semi_minor_mm", "group": "ellipse"}
    found = table.schema.field("semi_minor_mm_std").metadata
    assert {key.decode(): value.decode() for key, value in found.items()} == kept
    assert table.schema.metadata[b"title"].decode() == "Two presses, é"
    frame = pd.read_parquet(tmp_path / "r.parquet")
    assert frame["semi_major_mm"].tolist()[:2] == [7.4, 5.3]
    assert np.isnan(frame["semi_major_mm"][2])


def test_matlab_keeps_values_units_and_meanings(results, tmp_path):
    export_results(results, tmp_path / "r.mat")
    rows = json.loads((results / "results.json").read_text())
    content = io.loadmat(tmp_path / "r.mat")
    struct = content["results"][0, 0]
    assert set(struct.dtype.names) == set(COLUMNS)
    for name, column in COLUMNS.items():
        assert len(struct[name]) == len(rows), name  # one line each, as MATLAB's struct2table asks for
        values = [row[name] for row in rows]
        if column.dtype == "text":
            assert [str(word).rstrip() for word in struct[name]] == [value or "" for value in values]
        else:
            assert struct[name].shape == (3, 1)
            np.testing.assert_array_equal(struct[name][:, 0], np.array(values, dtype=float))
    simple = io.loadmat(tmp_path / "r.mat", simplify_cells=True)
    assert simple["units"]["youngs_modulus_kpa"] == "kPa"
    assert simple["meanings"]["load_N"] == "normal force W"
    assert simple["study"]["title"] == "Two presses, é"
    assert all(re.fullmatch(r"[A-Za-z]\w{0,62}", name, re.ASCII) for name in COLUMNS)  # as MATLAB takes


def test_a_workbook_keeps_values_units_and_words(results, tmp_path, monkeypatch):
    export_results(results, tmp_path / "r.xlsx")
    rows = json.loads((results / "results.json").read_text())
    book = CalamineWorkbook.from_path(str(tmp_path / "r.xlsx"))
    assert book.sheet_names == ["results", "columns", "study"]
    header, *found = book.get_sheet_by_name("results").to_python()
    assert header == list(COLUMNS)
    for cells, row in zip(found, rows, strict=True):
        for cell, value in zip(cells, row.values(), strict=True):
            kept = "" if value is None else value
            assert cell == (pytest.approx(kept, rel=1e-15) if isinstance(kept, float) else kept)  # 16 digits
    first, *described = book.get_sheet_by_name("columns").to_python()
    assert first == ["column", "unit", "meaning"]
    assert described == [[one.name, one.unit, one.meaning] for one in COLUMNS.values()]
    assert book.get_sheet_by_name("study").to_python()[0] == ["title", "Two presses, é"]
    monkeypatch.setattr(load, "_MOST_SHEET_ROWS", 2)
    with pytest.raises(FingerpadError, match="a sheet of Excel has 2 rows at most, these results 3"):
        export_results(results, tmp_path / "more.xlsx")


def test_every_line_of_columns_csv_is_whole():
    lines = package_table("fingerpad.study.results", "columns.csv")
    allowed = {
        "type": {"text", "bool", "int", "float"},
        "group": {
            *("observation", "placement", "sequence", "image", "ellipse", "region", "pad"),
            *("radius", "hertz", "layer", "validity", "output"),
        },
        "default": {"yes", "no"},
    }
    for number, line in enumerate(lines, 2):
        assert line["meaning"], number
        assert None not in line, f"line {number}: quotes lack around commas"
        assert all(line[key] in words for key, words in allowed.items()), number
    assert len(lines) == len(COLUMNS), "a column stands twice"


def test_every_column_has_the_unit_that_its_name_says():
    for name, column in COLUMNS.items():
        assert (column.unit == "") == (column.dtype in {"text", "bool"}), f"{name}: numbers have a unit or 1"
        unit = re.search(
            r"_(mm_per_px|mm2|mm|kpa|deg|N|s|px)(_fixed_geometry|_noise|_edge|_repeatability|_model|_total)?(_std)?$",
            f"_{name}",
        )
        said = {"kpa": "kPa", "mm_per_px": "mm/px"}.get(unit[1], unit[1]) if unit else "1"
        assert column.unit in {said, ""}, f"{name}: its name says {said}, columns.csv {column.unit}"


def test_words_of_people_are_no_formulas_and_come_back(tmp_path):
    manifest, reason = make(tmp_path), '=HYPERLINK("https://example.org")'
    correct(tmp_path, "heavy", {"rejected": reason}, who="@anna")
    run_study(manifest, tmp_path / "out")
    row, *_ = rows_of(tmp_path / "out" / "results.csv")
    assert (row["reason"], row["reviewed_by"]) == (f"'{reason}", "'@anna")
    read = read_rows(tmp_path / "out").iloc[0]
    assert (read["reason"], read["reviewed_by"]) == (reason, "@anna")
    export_results(tmp_path / "out", tmp_path / "r.xlsx")
    header, cells = CalamineWorkbook.from_path(str(tmp_path / "r.xlsx")).get_sheet_by_index(0).to_python()[:2]
    assert cells[header.index("reason")] == reason


def test_many_rows_come_in_batches_and_none_is_lost(results, tmp_path, monkeypatch):
    for name in ("_ROW_GROUP", "_ROWS_AT_ONCE"):
        monkeypatch.setattr(load, name, 100)
    header, row, *_ = (results / "results.csv").read_text(encoding="utf-8").splitlines()
    many = "\n".join([header, *(row.replace("heavy,", f"press#{number},", 1) for number in range(234))])
    folder = copied(results, tmp_path / "many", results__csv=many + "\n")
    export_results(folder, tmp_path / "many.parquet")
    export_results(folder, tmp_path / "many.mat")
    file = parquet.ParquetFile(tmp_path / "many.parquet")
    assert file.num_row_groups == 3
    names = file.read(columns=["observation"])["observation"].to_pylist()
    assert names == [f"press#{number}" for number in range(234)]
    assert len(io.loadmat(tmp_path / "many.mat")["results"][0, 0]["load_N"]) == 234


def test_a_run_without_rows_keeps_its_columns(results, tmp_path):
    header = (results / "results.csv").read_text(encoding="utf-8").splitlines()[0]
    folder = copied(results, tmp_path / "none", results__csv=header + "\n")
    for suffix in ("parquet", "mat", "xlsx"):
        export_results(folder, tmp_path / f"none.{suffix}")
    assert parquet.read_table(tmp_path / "none.parquet").column_names == list(COLUMNS)
    assert io.loadmat(tmp_path / "none.mat")["results"][0, 0]["load_N"].size == 0


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"results__csv": "a,b\n1,2\n"}, "its columns are not those of this version; run the study again"),
        ({"results__csv": ""}, "its columns are not those"),
        ({"summary__json": "{"}, "summary.json: is none \\(Invalid JSON"),
        ({"summary__json": "[]"}, "summary.json: is none \\(Input should be an object"),
    ],
)
def test_tables_that_are_not_whole_are_refused(results, tmp_path, changed, message):
    require_refused(copied(results, tmp_path / "bad", **changed), message)


@pytest.mark.parametrize(
    ("name", "cell", "message"),
    [
        ("load_N", "two", "load_N holds what is no float .*two"),
        ("load_N", "inf", "load_N holds an infinite number"),
        ("frame", "2.5", "frame holds what is no int"),
        ("pooled", "maybe", "pooled holds what is no bool .*maybe"),
        ("overlay", "a,b", "a row has more or fewer cells than the header"),
    ],
)
def test_a_cell_that_its_column_does_not_hold_is_refused(results, tmp_path, name, cell, message):
    header = ",".join(COLUMNS)
    row = ",".join({"synthetic": "true", "pooled": "true", name: cell}.get(each, "") for each in COLUMNS)
    folder = copied(results, tmp_path / "bad", results__csv=f"{header}\n{row}\n")
    require_refused(folder, f"before line 2: {message}.*; run the study again")


def require_refused(folder: Path, message: str) -> None:
    for suffix in ("parquet", "mat", "xlsx"):
        with pytest.raises(FingerpadError, match=message):
            export_results(folder, folder.parent / f"r.{suffix}")
    assert [path.name for path in folder.parent.iterdir()] == ["bad"]  # nothing half written is left


def test_other_formats_and_folders_are_refused(results, tmp_path):
    as_csv = r"no format is known by .ods.*\.parquet or \.mat or \.xlsx; as CSV the table is .*results.csv"
    for folder, name, words in (
        (results, "r.ods", as_csv),
        (results, "r", "a name without suffix"),
        (tmp_path, "r.mat", "no finished run there; `fingerpad run"),
        (results, "nowhere/r.mat", "nowhere/r.mat: cannot be written"),
    ):
        with pytest.raises(FingerpadError, match=words):
            export_results(folder, tmp_path / name)


def test_without_pyarrow_the_way_out_is_said(results, tmp_path, monkeypatch):
    for name in ("pyarrow", "pyarrow.parquet"):
        monkeypatch.setitem(sys.modules, name, None)
    code, _, error = command.run("export", results, tmp_path / "r.parquet")
    words = "fingerpad: Parquet needs the package pyarrow: pip install 'fingerpad[parquet]'\n"
    assert (code, error) == (2, words)
    assert not (tmp_path / "r.parquet").exists()


def test_an_older_export_stays_where_a_new_one_fails(results, tmp_path):
    export_results(results, tmp_path / "r.mat")
    before = (tmp_path / "r.mat").read_bytes()
    cut = f"{(results / 'results.csv').read_text(encoding='utf-8').splitlines()[0]}\ncut,short"
    with pytest.raises(FingerpadError, match="fewer cells"):
        export_results(copied(results, tmp_path / "cut", results__csv=cut), tmp_path / "r.mat")
    assert (tmp_path / "r.mat").read_bytes() == before


# Results in memory: what a run wrote, a DataFrame and a summary


def test_the_table_holds_what_the_file_says(tmp_path):
    make(tmp_path)
    folder = tmp_path / "out"
    fp.run_study(str(tmp_path), str(folder))
    results = fp.load_results(str(folder))
    rows = rows_of(folder / "results.csv")
    assert isinstance(results.table, pd.DataFrame)
    assert list(results.table) == list(rows[0])
    assert (len(results.table), results.title) == (2, "Two presses, é")
    assert results.table["observation"].tolist() == ["heavy", "light"]
    np.testing.assert_array_equal(results.table["load_N"], [float(row["load_N"]) for row in rows])
    assert results.table.attrs["units"]["youngs_modulus_kpa"] == "kPa"
    assert set(results.table.attrs["units"]) == set(results.table)
    assert results.summary.summaries[0].finger == "index"
    first, *sentences = repr(results).splitlines()
    assert first.startswith("<Results of 'Two presses, é': 2 rows, ")
    assert sentences[0].startswith("index, 30°: modulus 67.1 ± ")
    assert len(sentences) == 2
    shown = results._repr_html_()
    assert shown.startswith("<strong>Two presses, é</strong><ul><li>index, 30°: modulus 67.1 ± ")
    assert shown.count("<li>") == shown.count(" mm.</li>") == 2
    assert "</ul>Results of &#x27;Two presses, é&#x27;: 2 rows" in shown


def test_what_a_contact_comes_to_stands_first_and_what_few_ask_for_is_asked_for(tmp_path):
    make(tmp_path)
    fp.run_study(tmp_path)
    few = fp.load_results(tmp_path / "results").table
    fp.run_study(tmp_path, all_columns=True)
    every = fp.load_results(tmp_path / "results").table
    assert list(every) == list(COLUMNS)
    assert list(few) == [name for name, column in COLUMNS.items() if column.default]
    assert list(few)[:4] == ["observation", "finger", "wedge_angle_deg", "load_N"]
    first = {"gross_area_mm2", "semi_minor_mm_std", "youngs_modulus_kpa", "model_verdict"}
    assert first <= set(list(few)[:15])
    assert {"semi_major_mm_noise_std", "geometric_radius_from_area_mm"} <= set(every) - set(few)
    pd.testing.assert_frame_equal(every[list(few)], few)
    described = rows_of(tmp_path / "results" / "results_columns.csv")
    assert [line["column"] for line in described] == list(every)
    table = tmp_path / "results" / "results.csv"
    table.write_text(table.read_text().replace("load_N", "load", 1))
    with pytest.raises(FingerpadError, match=r"results\.csv"):
        read_rows(tmp_path / "results")


def test_results_lie_beside_the_manifest(tmp_path):
    make(tmp_path)
    with pytest.raises(FingerpadError, match="no finished run"):
        fp.load_results(str(tmp_path))
    fp.run_study(tmp_path)
    assert len(fp.load_results(tmp_path / "results").table) == 2
    with pytest.raises(FingerpadError, match="no finished run there, but in .*results: name that folder"):
        fp.load_results(tmp_path)
    with pytest.raises(FingerpadError, match="study.toml: is a file; name the output folder"):
        fp.load_results(tmp_path / "study.toml")


def test_a_pad_has_poissons_ratio_of_its_run(tmp_path, monkeypatch):
    press = contact("press", 2, (6, 5), axis="")
    run_study(write_study(tmp_path, finger(), press, poisson_ratio=0.3), tmp_path / "out")
    summary = SummaryFile.read(tmp_path / "out")
    layer = ThicknessFitRecord.model_construct(
        thickness_mm=7.0, thickness_mm_std=0.5, youngs_modulus_kpa=40.0, youngs_modulus_kpa_std=4.0
    )
    of = {"finger": summary.fingers[0].finger, "wedge_angle_deg": 30.0, "synthetic": False}
    curve = CurveRecord.model_construct(**of, layer=layer)
    monkeypatch.setattr(SummaryFile, "read", lambda _: summary.model_copy(update={"curves": [curve]}))
    pad, other = (
        load.measured_pad(tmp_path / "out", finger=None, wedge_deg=30, **given)
        for given in ({}, {"poisson_ratio": 0.5})
    )
    assert (float(pad.tissue.youngs_modulus), pad.tissue.poisson_ratio) == (0.04, 0.3)
    assert other.tissue.poisson_ratio == 0.5  # for which the curve tells no E
    assert "contact area" in other.source
