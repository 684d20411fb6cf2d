"""Results in memory: what a run wrote, a DataFrame and a summary."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from tests.studies import contact, finger, rows_of, write_study

import fingerpad as fp
from fingerpad.study.results.load import read_rows
from fingerpad.study.results.table import COLUMNS


def make(folder: Path, load: float = 2, first: float = 30, second: float = 45) -> Path:
    heavy = contact("heavy", load, finger="index", wedge=first)
    light = contact("light", 0.5, (5.3, 4.2), finger="index", wedge=second, axis="")
    return write_study(folder, finger("index"), heavy, light, title="Two presses")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> str:
    study = tmp_path_factory.mktemp("study")
    make(study)
    fp.run_study(str(study), str(study / "out"))
    return str(study / "out")


def test_the_table_holds_what_the_file_says(folder: str) -> None:
    results = fp.load_results(folder)
    rows = rows_of(Path(folder) / "results.csv")
    assert isinstance(results.table, pd.DataFrame)
    assert list(results.table) == list(rows[0])
    assert (len(results.table), results.title) == (2, "Two presses")
    assert results.table["observation"].tolist() == ["heavy", "light"]
    np.testing.assert_array_equal(results.table["load_N"], [float(row["load_N"]) for row in rows])
    assert results.table.attrs["units"]["youngs_modulus_kpa"] == "kPa"
    assert set(results.table.attrs["units"]) == set(results.table)
    assert results.summary.summaries[0].finger == "index"
    assert len(repr(results)) < 100


def test_a_notebook_shows_the_answers(folder: str) -> None:
    shown = fp.load_results(folder)._repr_html_()
    assert shown.startswith("<strong>Two presses</strong><ul><li>index, 30°: modulus 67.1 ± ")
    assert shown.count("<li>") == shown.count(" mm.</li>") == 2
    assert "&lt;Results of &#x27;Two presses&#x27;: 2 rows" in shown


def test_what_a_contact_comes_to_stands_first_and_what_few_ask_for_is_asked_for(tmp_path: Path) -> None:
    make(tmp_path)
    fp.run_study(tmp_path)
    few = fp.load_results(tmp_path / "results").table
    fp.run_study(tmp_path, all_columns=True)
    every = fp.load_results(tmp_path / "results").table
    assert list(every) == list(COLUMNS)
    assert list(few) == [name for name, column in COLUMNS.items() if column.default]
    assert list(few)[:4] == ["observation", "finger", "wedge_angle_deg", "load_N"]
    assert {"gross_area_mm2", "semi_minor_mm_std", "youngs_modulus_kpa", "model_verdict"} <= set(
        list(few)[:15]
    )
    assert {"semi_major_mm_noise_std", "geometric_radius_from_area_mm"} <= set(every) - set(few)
    pd.testing.assert_frame_equal(every[list(few)], few)
    described = rows_of(tmp_path / "results" / "results_columns.csv")
    assert [line["column"] for line in described] == list(every)
    table = tmp_path / "results" / "results.csv"
    table.write_text(table.read_text().replace("load_N", "load", 1))
    with pytest.raises(fp.FingerpadError, match=r"results\.csv"):
        read_rows(tmp_path / "results")


def test_a_folder_without_results_is_refused(tmp_path: Path) -> None:
    with pytest.raises(fp.FingerpadError, match="no finished run"):
        fp.load_results(str(tmp_path))


def test_results_lie_beside_the_manifest(tmp_path: Path) -> None:
    make(tmp_path)
    fp.run_study(tmp_path)
    assert len(fp.load_results(tmp_path / "results").table) == 2
    with pytest.raises(fp.FingerpadError, match="no finished run there, but in .*results: name that folder"):
        fp.load_results(tmp_path)
    with pytest.raises(fp.FingerpadError, match="study.toml: is a file; name the output folder"):
        fp.load_results(tmp_path / "study.toml")


def test_loads_and_angles_in_other_units_are_noted(tmp_path: Path) -> None:
    assert fp.run_study(make(tmp_path, load=2000, second=0.785)).notes == (
        "heavy: more than 100 N: is load_N in millinewtons, not newtons?",
        "light: less than 1.6°: is wedge_angle_deg in radians, not degrees?",
    )
    assert fp.run_study(make(tmp_path, first=1.2, second=0.5)).notes == (
        "heavy and 1 more: less than 1.6°: is wedge_angle_deg in radians, not degrees?",
    )
    assert fp.run_study(make(tmp_path, load=100, second=0)).notes == ()
