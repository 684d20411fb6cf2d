"""Results in memory: what a run wrote, by columns and as a DataFrame."""

import csv
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import fingerpad as fp

STUDY = """
title = "Two presses"
[[fingers]]
name = "index"
semi_axes_mm = { palmar = 7.9, distal = 13.8, radial_ulnar = 11.8 }
semi_axes_mm_std = { palmar = 0.1, distal = 0.1, radial_ulnar = 0.1 }
[[observations]]
name = "heavy"
finger = "index"
wedge_angle_deg = 30
load_N = 2
ellipse_mm = { semi_major = 7.4, semi_minor = 5.0, std = 0.1, long_axis = "along" }
[[observations]]
name = "light"
finger = "index"
wedge_angle_deg = 45
load_N = 0.5
ellipse_mm = { semi_major = 5.3, semi_minor = 4.2, std = 0.1 }
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> str:
    study = tmp_path_factory.mktemp("study")
    (study / "study.toml").write_text(STUDY, encoding="utf-8")
    fp.run_study(str(study), str(study / "out"))
    return str(study / "out")


def test_columns_hold_what_the_file_says(folder: str) -> None:
    results = fp.load_results(folder)
    with (Path(folder) / "results.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert list(results) == list(rows[0])
    assert (results.rows, results.title) == (2, "Two presses")
    assert results["observation"].tolist() == ["heavy", "light"]
    np.testing.assert_array_equal(results["load_N"], [float(row["load_N"]) for row in rows])
    assert results.columns["youngs_modulus_kpa"].unit == "kPa"
    assert len(repr(results)) < 100
    with pytest.raises(KeyError, match=r"no column 'load'; list\(results\) names all"):
        results["load"]


def test_a_data_frame_has_the_same_columns(folder: str) -> None:
    results = fp.load_results(Path(folder))
    frame = results.to_pandas()
    assert isinstance(frame, pd.DataFrame)
    assert list(frame.columns) == list(results)
    np.testing.assert_array_equal(frame["semi_major_mm"], [7.4, 5.3])


def test_pandas_need_not_be_installed(folder: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    results = fp.load_results(folder)
    with pytest.raises(fp.FingerpadError, match="pip install pandas"):
        results.to_pandas()


def test_a_folder_without_results_is_refused(tmp_path: Path) -> None:
    with pytest.raises(fp.FingerpadError, match="no finished run"):
        fp.load_results(str(tmp_path))


def test_results_lie_beside_the_manifest(tmp_path: Path) -> None:
    (tmp_path / "study.toml").write_text(STUDY, encoding="utf-8")
    fp.run_study(tmp_path)
    assert fp.load_results(tmp_path / "results").rows == 2
    with pytest.raises(fp.FingerpadError, match="no finished run there, but in .*results: name that folder"):
        fp.load_results(tmp_path)
    with pytest.raises(fp.FingerpadError, match="study.toml: is a file; name the output folder"):
        fp.load_results(tmp_path / "study.toml")


def test_loads_and_angles_in_other_units_are_noted(tmp_path: Path) -> None:
    manifest = tmp_path / "study.toml"
    manifest.write_text(STUDY.replace("load_N = 2", "load_N = 2000").replace("deg = 45", "deg = 0.785"))
    assert fp.run_study(manifest).notes == (
        "heavy: more than 100 N: load_N is in newtons, not millinewtons",
        "light: less than 1.6°: wedge_angle_deg is in degrees, not radians",
    )
    manifest.write_text(STUDY.replace("deg = 30", "deg = 1.2").replace("deg = 45", "deg = 0.5"))
    assert fp.run_study(manifest).notes == (
        "heavy and 1 more: less than 1.6°: wedge_angle_deg is in degrees, not radians",
    )
    manifest.write_text(STUDY.replace("load_N = 2", "load_N = 100").replace("deg = 45", "deg = 0"))
    assert fp.run_study(manifest).notes == ()
