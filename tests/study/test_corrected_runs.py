"""Runs of a corrected study: results follow the corrections, and nothing else is measured again."""

from pathlib import Path

import pytest
from tests.studies import correct, page_of, rows_by, run_watched

from fingerpad.study.corrections.log import CorrectionLog
from fingerpad.study.engine.store import STORE_NAME, Store
from fingerpad.study.manifest.load import read_study
from fingerpad.study.measuring.context import RunContext
from fingerpad.study.measuring.run import StudyItems
from fingerpad.study.results.output import summary_of
from fingerpad.study.results.study_result import StudyResult
from fingerpad.study.results.table import COLUMNS, records
from fingerpad.study.status import item_states, semi_axes_state, study_status

pytestmark = pytest.mark.usefixtures("small_pieces")
ELLIPSE = {"ellipse_px": {"centre": [60, 60], "semi_axes": [40, 30], "orientation_deg": 10}}


def test_a_corrected_observation_alone_is_measured_anew(finished):
    before, _ = run_watched(finished)
    correct(finished.parent, "o1", ELLIPSE)
    assert study_status(finished, finished.parent / "out").stale == 1
    after, measured = run_watched(finished)
    assert measured == ["o1"]
    row = rows_by(after)["o1"]
    assert (row["measured_by"], row["reviewed"], row["reviewed_by"]) == ("manual", "corrected", "anna")
    assert row["semi_major_mm"] == pytest.approx(40 * 25.4 / 240, rel=1e-3)
    assert row["orientation_deg"] == pytest.approx(10, abs=0.1)
    assert (finished.parent / "out" / row["overlay"]).is_file()
    own = rows_by(before)["o1"]
    for name in ("semi_major_mm", "semi_minor_mm"):
        assert row[f"automatic_{name}"] == own[name] == own[f"automatic_{name}"]
    correct(finished.parent, "o1", {})
    again, measured = run_watched(finished)
    assert measured == ["o1"]
    assert rows_by(again) == rows_by(before)


@pytest.mark.parametrize(
    ("item", "change", "status"),
    [("o2", {"accepted": True}, "measured"), ("p#12", {"rejected": "smeared"}, "rejected")],
)
def test_a_verdict_measures_nothing(finished, item, change, status):
    before, _ = run_watched(finished)
    correct(finished.parent, item, change)
    after, measured = run_watched(finished)
    assert measured == []
    row = rows_by(after)[item]
    assert (row["status"], row["reviewed_by"]) == (status, "anna")
    assert row["reason"] == change.get("rejected")
    assert not (row["pooled"] and status == "rejected")
    assert after.failures == []
    # What the model's checks say is of all contacts of the finger together.
    every = ("_model_std", "_total_std", "model_verdict")
    own = [name for name in COLUMNS if not name.endswith(every)]
    before, after = ({row["observation"]: row for row in records(one.rows, *own)} for one in (before, after))
    assert before | {item: None} == after | {item: None}


def test_the_report_lists_manual_corrections(finished):
    correct(finished.parent, "o1", ELLIPSE)
    correct(finished.parent, "o2", {"rejected": "it <slipped>"})
    result, _ = run_watched(finished)
    page = page_of(result, finished.parent / "out")
    section = page[page.index('<div id="corrections">') : page.index('<div id="methods">')]
    own = rows_by(result)["o1"]["automatic_semi_major_mm"]
    assert all(words in section for words in ("corrected", "it &lt;slipped&gt;", "anna", f"{own:.3f}"))


def test_a_corrected_frame_has_its_piece_measured_anew(finished):
    before, _ = run_watched(finished)
    correct(finished.parent, "p#8", ELLIPSE)
    after, measured = run_watched(finished)
    assert measured == ["p", "p"]  # the piece, and the drawings
    rows, untouched = rows_by(after), rows_by(before)
    row, automatic = rows.pop("p#8"), untouched.pop("p#8")
    assert (row["measured_by"], row["load_N"]) == ("manual", automatic["load_N"])
    assert row["semi_minor_mm"] == pytest.approx(30 * 25.4 / 240, rel=1e-3)
    assert rows == untouched
    # A frame without an automatic contact can be measured manually.
    empty = min(frame for frame in range(2, 24) if f"p#{frame}" not in untouched and frame != 8)
    correct(finished.parent, f"p#{empty}", ELLIPSE)
    frames = rows_by(run_watched(finished)[0])
    assert f"p#{empty}" not in frames or frames[f"p#{empty}"]["measured_by"] == "manual"


def semi_axes_states(finished: Path, run_of: StudyResult | None) -> dict[str, str]:
    """Return the state of each finger's semi-axes in the results of a run."""
    study, log = read_study(finished), CorrectionLog(finished.parent)
    records = {one.finger: one for one in summary_of(run_of).fingers} if run_of else {}
    with Store.reading(finished.parent / "out" / STORE_NAME) as store:
        states = item_states(
            StudyItems(
                RunContext(
                    study=study,
                    folder=finished.parent,
                    active_corrections=log.active_corrections(),
                    store=store,
                )
            )
        )
    return {one.name: semi_axes_state(one, states, records.get(one.name)) for one in study.fingers}


def test_semi_axes_are_out_of_date_once_their_photographs_change(finished):
    assert semi_axes_states(finished, None) == {"f": "given", "g": "left"}
    result, _ = run_watched(finished)
    assert semi_axes_states(finished, result) == {"f": "given", "g": "done"}
    text = finished.read_text()
    finished.write_text(text.replace("mm_per_px = 0.1 }", "mm_per_px = 0.11 }", 1))
    assert semi_axes_states(finished, result)["g"] == "stale"
    finished.write_text(text)
    correct(finished.parent, "g/distal.jpg", {"rejected": "nail in view"})
    assert semi_axes_states(finished, result)["g"] == "stale"
    result, measured = run_watched(finished)
    assert semi_axes_states(finished, result)["g"] == "failed"
    assert "g/distal.jpg" not in measured
    assert "palmar" in (result.fingers["g"].reason or "")


def test_what_is_odd_about_corrections_is_told(finished):
    correct(finished.parent, "o1", ELLIPSE)
    correct(finished.parent, "p#900", {"rejected": "smeared"})
    text = finished.read_text()
    finished.write_text(text.replace('name = "o1"', 'name = "other"'))
    with (finished.parent / "corrections.jsonl").open("a") as file:
        file.write('{"id": 3, "item": "o')
    result, _ = run_watched(finished)
    for words in ("o1 is not in the study", "p#900 is not in the study", "torn"):
        assert any(words in note for note in result.notes)
    assert "corrections.jsonl" in result.provenance["inputs_sha256"]


def test_corrections_of_a_picture_that_was_replaced_are_told(finished):
    for item in ("o1", "o2", "g/distal.jpg", "p#8"):
        correct(finished.parent, item, {"accepted": True})
    assert not run_watched(finished)[0].notes
    pictures = {one.name: finished.parent / one.file for one in read_study(finished).observations}
    pictures["o1"].write_bytes(pictures["o2"].read_bytes() + b"\0")  # of the same bytes a note says so
    notes = run_watched(finished)[0].notes
    assert [note.split()[1] for note in notes] == ["o1"]
    assert "another picture or force" in notes[0]
    correct(finished.parent, "o1", ELLIPSE)
    assert not run_watched(finished)[0].notes
    images = finished.parent / "frames"
    (images / "f8.png").write_bytes((images / "f9.png").read_bytes())
    notes = run_watched(finished)[0].notes
    assert [note.split()[1] for note in notes] == ["p#8"]
    assert "another picture or force" in notes[0]
