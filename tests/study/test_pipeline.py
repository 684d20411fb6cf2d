"""The whole way: the bundled study against its known truth, and faults that cost one row only."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from PIL import Image
from tests import studies
from tests.study.small_study import LOAD, PPI

from fingerpad.exceptions import ManifestError
from fingerpad.report.text import implausible_values
from fingerpad.study.measuring.curves import loading_radius
from fingerpad.study.pipeline import run_study
from fingerpad.study.results.study_result import StudyResult
from fingerpad.study.results.table import COLUMNS, DEFAULT_COLUMNS, items, records

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "dzidek2017"


@pytest.fixture(scope="module")
def demo(run_demo, tmp_path_factory) -> tuple[StudyResult, Path]:
    out = tmp_path_factory.mktemp("demo") / "results"
    shutil.copytree(run_demo / "results", out)
    result = run_study(EXAMPLE / "study.toml", out)  # from what is stored
    return result, out


def test_measures_the_rendered_pad_as_it_is(demo):
    result, _ = demo
    rows = studies.rows_by(result)
    truths = studies.rows_of(EXAMPLE / "synthetic" / "truth.csv")
    assert len(truths) == 9
    for truth in truths:
        row = rows[truth["observation"]]
        assert (row["status"], row["synthetic"], row["flags"]) == ("measured", True, "")
        assert row["long_axis"] == row["predicted_long_axis"] == "across"
        for name, within in (("semi_major_mm", 0.02), ("semi_minor_mm", 0.02), ("indentation_mm", 0.035)):
            assert_allclose(row[name], float(truth[name]), rtol=within)
            assert abs(row[name] - float(truth[name])) < 3.5 * row[f"{name}_std"]
        assert abs(row["reduced_modulus_kpa"] - 90) < 3.5 * row["reduced_modulus_kpa_std"]


def test_measures_the_photographs_and_the_curve(demo):
    result, _ = demo
    pad = result.fingers["synthetic_pad"]
    assert_allclose(pad.semi_axes, [7.9, 13.8, 11.8], rtol=0.01)
    assert len(pad.photographs) == 3
    assert (np.abs(pad.semi_axes - [7.9, 13.8, 11.8]) < 3 * np.sqrt(np.diag(pad.covariance))).all()
    curves = [curve for curve in result.curves if curve.fit is not None]
    assert [round(curve.velocity, 1) for curve in curves] == [0.2, 2.0, 10.0]
    for curve in curves:  # the pad's own A/(πξ) at 30°
        assert abs(curve.loading_radius - 13.6248 * 0.99986) < 3 * curve.loading_radius_std
    # A viscoelastic pad is the stiffer the faster it is pressed.
    moduli = [curve.fit.initial_modulus.value for curve in curves]
    assert moduli == sorted(moduli)
    loading = loading_radius(result.curves, ("synthetic_pad", 30, True))
    assert abs(loading.value - 13.6248 * 0.99986) < 3 * loading.std < 0.7


def test_pools_by_finger_and_angle_without_mixing_synthetic_rows(demo):
    result, _ = demo
    keys = [(summary.finger, summary.wedge_angle_deg, summary.synthetic) for summary in result.summaries]
    assert len(keys) == len(set(keys)) == 6
    pooled = {key: summary.corrected_radius for key, summary in zip(keys, result.summaries, strict=True)}
    # Five contacts, and one press however many its frames.
    assert pooled["synthetic_pad", 30.0, True].count == 6
    assert pooled["left_index_ellipse", 30.0, False].count == 1
    truth = 13.6077 * 1.0004  # R_0g F2⁻³ of the true pad
    found = pooled["synthetic_pad", 30.0, True]
    assert abs(found.value - truth) < 2 * found.total_std


def test_tables_agree_with_each_other(demo):
    result, out = demo
    records = json.loads((out / "results.json").read_text())
    assert len(studies.rows_of(out / "results.csv")) == len(records) == len(result.rows) == 13 + 21
    assert all(list(record) == list(DEFAULT_COLUMNS) for record in records)
    assert [row["column"] for row in studies.rows_of(out / "results_columns.csv")] == list(DEFAULT_COLUMNS)
    inputs = studies.summary_of(out)["provenance"]["inputs_sha256"]
    assert set(inputs) >= {"study.toml", "observations.csv"}
    assert len(inputs) == 2 + 3 + 9 + 2 + 3
    for row in records:
        assert row["overlay"] is None or (out / row["overlay"]).is_file()


def test_each_column_is_filled_by_some_study(demo, small_study, tmp_path):
    """By the demo study, or by one whose rows are rejected, left out, cut, repeated and out of range."""
    folder = Path(shutil.copytree(small_study.parent, tmp_path / "study"))
    with Image.open(folder / "o0.png") as whole:
        whole.crop((45, 0, *whole.size)).save(folder / "cut.png")
    stage = np.minimum(np.arange(LOAD.size) - 2, 0) / 10 + 1.2 * (LOAD / 2) ** (2 / 3)
    force = np.transpose([np.arange(LOAD.size) / 20, LOAD, stage])
    studies.write_numbers(folder / "force.csv", "time_s,force_N,displacement_mm", force)
    drawn = {"scale": {"ppi": PPI}}
    manifest = studies.write_study(
        folder,
        studies.finger(pad_thickness_mm=8, effective_thickness_mm=1.5),
        *(studies.contact(f"c{k}", 1, (5 + k / 10, 4), session="monday", roll_angle_deg=5) for k in range(6)),
        studies.picture("cut", "cut.png", **drawn),
        studies.sequence("p", "frames", force="force.csv", frames_per_second=20, **drawn),
    )
    studies.correct(folder, "c0", {"rejected": "slipped"})
    studies.correct(folder, "c1", {"pooling": {"include": False, "why": "smeared"}})
    studies.correct(
        folder, "p#phases", {"phases": {"starts": [{"phase": "loading", "start_s": 0.1}], "why": "late"}}
    )
    result = run_study(manifest, tmp_path / "out")
    assert "shown, not pooled" in studies.page_of(result, tmp_path / "out")
    tables = demo[0].rows, result.rows
    filled = {
        name for table in tables for name in table if not {None, "", False}.issuperset(items(table[name]))
    }
    assert set(COLUMNS) - filled == set()


def test_a_bad_image_costs_its_row_only(run_demo, tmp_path, demo):
    copy = Path(shutil.copytree(run_demo, tmp_path / "study"))
    bad = copy / "synthetic"
    (bad / "synthetic_30deg_1N.png").write_bytes((bad / "synthetic_30deg_1N.png").read_bytes()[:2000])
    (bad / "synthetic_30deg_2N.png").write_text("not a picture")
    Image.fromarray(np.full((300, 300), 255, np.uint8)).save(bad / "synthetic_30deg_4N.png")
    Image.fromarray(np.full((300, 300, 3), 200, np.uint8)).save(bad / "photograph_palmar.jpg")
    (bad / "curve_30deg_10mm_per_s.csv").write_text("force_N\n1\n")
    result = run_study(copy / "study.toml", copy / "results")  # the others are there already
    rows, untouched = studies.rows_by(result), studies.rows_by(demo[0])
    for load in ("1N", "2N", "4N"):
        row = rows[f"synthetic_30deg_{load}"]
        assert row["status"] == "failed"
        assert row["semi_major_mm"] is None
        assert f"synthetic_30deg_{load}.png" in row["reason"] or "no contact found" in row["reason"]
        assert str(tmp_path) not in row["reason"]
    # A photograph that fails costs the finger its radii and moduli, and no contact its area.
    seen, before = rows["synthetic_45deg_2N"], untouched["synthetic_45deg_2N"]
    assert (seen["status"], seen["gross_area_mm2"]) == ("measured", before["gross_area_mm2"])
    assert seen["youngs_modulus_kpa"] is None
    assert rows["table3_30deg_ellipse"] == untouched["table3_30deg_ellipse"]
    fingers = ("left_index_ellipse", "left_index_direct", "synthetic_pad")
    assert [summary.finger for summary in result.summaries] == [name for name in fingers for _ in range(2)]
    assert result.curves[-1].fit is None
    assert len(result.failures) == 3 + 1 + 1
    assert result.failures[3].startswith("finger synthetic_pad: ")


# Angles known so well that few random draws check the uncertainty.
STATED = {"wedge_angle_deg_std": 0.3}


def shown(name: str, file: str) -> studies.Table:
    return studies.picture(name, file, 1, scale={"ppi": 500})


def write(folder: Path, *tables: studies.Table) -> Path:
    """Write a study of one finger."""
    return studies.write_study(folder, studies.finger(), *tables, uncertainty=STATED)


@pytest.mark.parametrize(
    ("file", "out"),
    [("overlays/a.png", "."), ("sub/overlays/a.png", "sub"), ("a.png", "study.toml"), ("a.png", "a.png")],
)
def test_results_are_never_written_over_inputs(tmp_path, file, out):
    (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(EXAMPLE / "synthetic" / "synthetic_30deg_1N.png", tmp_path / file)
    before = (tmp_path / file).read_bytes()
    manifest = write(tmp_path, shown("a", file))
    over = file if "/" in file else out
    with pytest.raises(ManifestError, match=f"results would be written over .*{over}.*; choose another"):
        run_study(manifest, tmp_path / out)
    assert (tmp_path / file).read_bytes() == before


def test_a_study_through_a_link_and_by_its_folder(tmp_path):
    (tmp_path / "mine").mkdir()
    real = write(tmp_path / "real", studies.contact("x", 1)).rename(tmp_path / "real" / "other.toml")
    (tmp_path / "mine" / "study.toml").symlink_to(real)
    result = run_study(tmp_path / "mine", tmp_path / "out")
    assert len(result.rows) == 1
    assert set(result.provenance["inputs_sha256"]) == {"study.toml"}


@pytest.mark.parametrize(
    ("factor", "surface", "noted"),
    [(1, "ridged", 0), (0.1, "ridged", 1), (10, "ridged", 1), (10, "smooth", 0)],
)
def test_a_modulus_of_no_finger_pad_is_noted(tmp_path, factor, surface, noted):
    """As of loads in another unit; a smooth contact is of a robot's finger, of any material."""
    study = studies.write_study(
        tmp_path, studies.finger(), studies.contact("x", 2 * factor, (7.4, 5)), surface=surface
    )
    notes = [one for one in implausible_values(run_study(study, tmp_path / "out")) if "modulus" in one]
    assert len(notes) == noted


def test_a_pad_of_no_fingers_size_is_not_pooled(tmp_path):
    pad = studies.finger(std=1e-4, semi_axes_mm={name: axis / 1000 for name, axis in studies.PAD.items()})
    touched = studies.contact("x", 1, (0.074, 0.05), std=1e-4, axis="")
    result = run_study(studies.write_study(tmp_path, pad, touched, uncertainty=STATED), tmp_path / "out")
    (only,) = records(result.rows)
    assert "deeper_than_pad" in only["range_notes"]
    assert (only["pooled"], only["excluding_flags"]) == (False, "implausible_size implausible_modulus")
    assert result.summaries[0].corrected_radius is None
    (size, *_) = implausible_values(result)
    assert size.startswith("f, wedge 30°: x: a semi-axis of the pad lies outside 2–40 mm: ")
    page = studies.page_of(result, tmp_path / "out")
    assert page.index("f, wedge 30°: x: a semi-axis") < page.index("<details")
    assert "x is left out: a semi-axis of the pad lies outside 2–40 mm" in page
