"""Runs of a corrected study: results follow the corrections, and nothing else is measured again."""

from pathlib import Path

import pytest
from tests.studies import correct
from tests.study.small_study import copy

from fingerpad.report import write_report
from fingerpad.study.corrections.log import CorrectionLog
from fingerpad.study.engine.runner import Progress
from fingerpad.study.engine.store import STORE_NAME, Store
from fingerpad.study.manifest.load import read_study
from fingerpad.study.measuring.context import RunContext
from fingerpad.study.measuring.run import StudyItems
from fingerpad.study.pipeline import run_study
from fingerpad.study.results.output import summary_of
from fingerpad.study.results.study_result import StudyResult
from fingerpad.study.results.table import COLUMNS, records
from fingerpad.study.status import item_states, semi_axes_state, study_status

pytestmark = pytest.mark.usefixtures("small_pieces")
ELLIPSE = {"ellipse_px": {"centre": [60, 60], "semi_axes": [40, 30], "orientation_deg": 10}}


@pytest.fixture
def manifest(small_run: Path, tmp_path: Path) -> Path:
    """Return the manifest of a study with the results of a run in ``out``."""
    return copy(small_run, tmp_path / "study")


def run(manifest: Path) -> tuple[StudyResult, list[str]]:
    reported: list[Progress] = []
    result = run_study(manifest, manifest.parent / "out", on_progress=reported.append)
    return result, [one.item for one in reported[1:] if one.status != "written"]


def row_of(result: StudyResult, name: str) -> dict:
    return next(row for row in records(result.rows) if row["observation"] == name)


def test_a_corrected_observation_alone_is_measured_anew(manifest: Path) -> None:
    before, _ = run(manifest)
    correct(manifest.parent, "o1", ELLIPSE)
    assert study_status(manifest, manifest.parent / "out").stale == 1
    after, measured = run(manifest)
    assert measured == ["o1"]
    row = row_of(after, "o1")
    assert (row["measured_by"], row["reviewed"], row["reviewed_by"]) == ("manual", "corrected", "anna")
    assert row["semi_major_mm"] == pytest.approx(40 * 25.4 / 240, rel=1e-3)
    assert row["automatic_semi_major_mm"] == row_of(before, "o1")["semi_major_mm"]
    correct(manifest.parent, "o1", {})
    again, measured = run(manifest)
    assert measured == ["o1"]
    assert list(records(again.rows)) == list(records(before.rows))


@pytest.mark.parametrize(
    ("item", "change", "status"),
    [
        ("o2", {"accepted": True}, "measured"),
        ("p#12", {"rejected": "smeared"}, "rejected"),
    ],
)
def test_a_verdict_measures_nothing(manifest: Path, item: str, change: dict, status: str) -> None:
    before, _ = run(manifest)
    correct(manifest.parent, item, change)
    after, measured = run(manifest)
    assert measured == []
    row = row_of(after, item)
    assert (row["status"], row["reviewed_by"]) == (status, "anna")
    assert row["reason"] == change.get("rejected")
    assert not (row["pooled"] and status == "rejected")
    assert after.failures == []
    # What the model's checks say is of all contacts of the finger together.
    own = [
        name
        for name in COLUMNS
        if not (name == "model_verdict" or name.endswith(("_model_std", "_total_std")))
    ]
    others = [
        [one for one in records(found.rows, *own) if one["observation"] != item] for found in (before, after)
    ]
    assert others[0] == others[1]


def test_the_report_lists_manual_corrections(manifest: Path) -> None:
    correct(manifest.parent, "o1", ELLIPSE)
    correct(manifest.parent, "o2", {"rejected": "it <slipped>"})
    result, _ = run(manifest)
    page = write_report(result, manifest.parent / "out").read_text(encoding="utf-8")
    section = page[page.index('<div id="corrections">') : page.index('<div id="methods">')]
    assert ("corrected" in section, "it &lt;slipped&gt;" in section, "anna" in section) == (True,) * 3
    own = row_of(result, "o1")["automatic_semi_major_mm"]
    assert f"{own:.3f}" in section


def test_a_corrected_frame_has_its_piece_measured_anew(manifest: Path) -> None:
    before, _ = run(manifest)
    correct(manifest.parent, "p#8", ELLIPSE)
    after, measured = run(manifest)
    assert measured == ["p", "p"]  # the piece, and the drawings
    row = row_of(after, "p#8")
    assert (row["measured_by"], row["load_N"]) == ("manual", row_of(before, "p#8")["load_N"])
    assert row["semi_minor_mm"] == pytest.approx(30 * 25.4 / 240, rel=1e-3)
    others = [
        [one for one in records(found.rows) if one["observation"] != "p#8"] for found in (before, after)
    ]
    assert others[0] == others[1]
    # A frame without an automatic contact can be measured manually.
    seen = {row["frame"] for row in records(before.rows)}
    empty = min(frame for frame in range(24) if frame not in seen and frame > 1)
    correct(manifest.parent, f"p#{empty}", ELLIPSE)
    frames = {row["frame"]: row for row in records(run(manifest)[0].rows)}
    assert empty not in frames or frames[empty]["measured_by"] == "manual"


def test_a_rejected_photograph_is_left_out(manifest: Path) -> None:
    correct(manifest.parent, "g/distal.jpg", {"rejected": "nail in view"})
    result, measured = run(manifest)
    assert "g/distal.jpg" not in measured
    assert "palmar" in (result.fingers["g"].reason or "")


def semi_axes_states(manifest: Path, run_of: StudyResult | None) -> dict[str, str]:
    """Return the state of each finger's semi-axes in the results of a run."""
    study, log = read_study(manifest), CorrectionLog(manifest.parent)
    records = {one.finger: one for one in summary_of(run_of).fingers} if run_of else {}
    with Store.reading(manifest.parent / "out" / STORE_NAME) as store:
        states = item_states(
            StudyItems.of(RunContext.of(study, manifest.parent, log.active_corrections(), store))
        )
    return {one.name: semi_axes_state(one, states, records.get(one.name)) for one in study.fingers}


def test_semi_axes_are_out_of_date_once_their_photographs_change(manifest: Path) -> None:
    assert semi_axes_states(manifest, None) == {"f": "given", "g": "left"}
    result, _ = run(manifest)
    assert semi_axes_states(manifest, result) == {"f": "given", "g": "done"}
    text = manifest.read_text()
    manifest.write_text(text.replace("mm_per_px = 0.1 }", "mm_per_px = 0.11 }", 1))
    assert semi_axes_states(manifest, result)["g"] == "stale"
    manifest.write_text(text)
    correct(manifest.parent, "g/distal.jpg", {"rejected": "nail in view"})
    assert semi_axes_states(manifest, result)["g"] == "stale"
    result, _ = run(manifest)
    assert semi_axes_states(manifest, result)["g"] == "failed"


def test_what_is_odd_about_corrections_is_told(manifest: Path) -> None:
    correct(manifest.parent, "o1", ELLIPSE)
    correct(manifest.parent, "p#900", {"rejected": "smeared"})
    text = manifest.read_text()
    manifest.write_text(text.replace('name = "o1"', 'name = "other"'))
    with (manifest.parent / "corrections.jsonl").open("a") as file:
        file.write('{"id": 3, "item": "o')
    result, _ = run(manifest)
    assert any("o1 is not in the study" in note for note in result.notes)
    assert any("p#900 is not in the study" in note for note in result.notes)
    assert any("torn" in note for note in result.notes)
    assert "corrections.jsonl" in result.provenance["inputs_sha256"]


def test_corrections_of_a_picture_that_was_replaced_are_told(manifest: Path) -> None:
    for item in ("o1", "o2", "g/distal.jpg", "p#8"):
        correct(manifest.parent, item, {"accepted": True})
    assert not run(manifest)[0].notes
    pictures = {one.name: manifest.parent / one.file for one in read_study(manifest).observations}
    pictures["o1"].write_bytes(pictures["o2"].read_bytes() + b"\0")  # of the same bytes a note says so
    notes = run(manifest)[0].notes
    assert [note.split()[1] for note in notes] == ["o1"]
    assert "another picture or force" in notes[0]
    correct(manifest.parent, "o1", ELLIPSE)
    assert not run(manifest)[0].notes
    images = manifest.parent / "frames"
    (images / "f8.png").write_bytes((images / "f9.png").read_bytes())
    notes = run(manifest)[0].notes
    assert [note.split()[1] for note in notes] == ["p#8"]
    assert "another picture or force" in notes[0]
