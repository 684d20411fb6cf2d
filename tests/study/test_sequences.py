"""Sequences of presses in a study: frames become rows, few are pooled, and none is listed by the thousand."""

import html
import re
import shutil
import sqlite3
from collections.abc import Callable
from dataclasses import replace
from itertools import combinations
from pathlib import Path
from typing import NoReturn

import numpy as np
import pytest
from numpy.testing import assert_allclose
from PIL import Image
from tests import studies
from tests.image.test_frames import write as write_frames
from tests.smooth_study import LOADS, area_at, make_smooth_study

from fingerpad.exceptions import LoadingError, ManifestError
from fingerpad.image import ImageEllipse, interpolated_ellipse
from fingerpad.report import plots, write_report
from fingerpad.report.text import doubtful_results, fingers_without_results, pooled_from, sequence_notes
from fingerpad.simulate import SyntheticSequence, render_sequence
from fingerpad.study.corrections.apply import contact_options, frame_corrections
from fingerpad.study.corrections.changes import ContactCorrection
from fingerpad.study.corrections.log import ActiveCorrection, CorrectionLog
from fingerpad.study.engine.runner import Progress
from fingerpad.study.engine.store import STORE_NAME, Store
from fingerpad.study.manifest.load import read_study
from fingerpad.study.measuring.context import RunContext
from fingerpad.study.measuring.run import StudyItems
from fingerpad.study.pipeline import run_study
from fingerpad.study.results.methods import methods_section
from fingerpad.study.results.output import summary_of
from fingerpad.study.results.study_result import StudyResult
from fingerpad.study.results.table import records
from fingerpad.study.status import study_status, verify_study

RATE = 20
# Loading to frame 11, hold to 15, unloading; empty at either end.
LOAD = np.interp(np.arange(28), [2, 11, 15, 25], [0, 2, 2, 0])
UNCERTAINTY = {"wedge_angle_deg_std": 0.5}


def of_frames(name: str = "p", *, frames_per_second: int | None = RATE, **keys: object) -> studies.Table:
    """Return the press as a sequence of a study."""
    clock = {"frames_per_second": frames_per_second} if frames_per_second else {}
    scale = {"ppi": 240, "relative_std": 0.01}
    return studies.sequence(name, "frames", scale=scale, force="force.csv", **clock, **keys)


@pytest.fixture(scope="module")
def press() -> SyntheticSequence:
    return render_sequence(LOAD, radii=(14.3, 13.0), reduced_modulus=0.09, ppi=240, seed=5)


@pytest.fixture(scope="module")
def untouched(press, tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("untouched")
    (folder / "frames").mkdir()
    for k in range(LOAD.size):
        Image.fromarray(press.pixels(k)).save(folder / "frames" / f"f{k}.png")
    write_force(folder)
    return folder


def write_force(folder: Path, load: np.ndarray = LOAD, *, since: int = 0, **columns: np.ndarray) -> None:
    """Write the force table, of some frames and with other columns."""
    every = {"time_s": np.arange(load.size) / RATE, "force_N": load, **columns}
    studies.write_numbers(folder / "force.csv", ",".join(every), np.transpose([*every.values()])[since:])


@pytest.fixture(scope="module")
def plain(untouched) -> StudyResult:
    return run(untouched)


@pytest.fixture
def study_dir(untouched, plain, tmp_path) -> Path:
    """Return the folder of a study with the results of the plain run in ``out``."""
    return Path(shutil.copytree(untouched, tmp_path / "study"))


def run(
    folder: Path, *tables: studies.Table, on_progress: Callable[[Progress], None] = lambda _: None
) -> StudyResult:
    """Run a study of tables, of the press alone where none is given."""
    studies.write_study(folder, studies.finger(), *(tables or [of_frames()]), uncertainty=UNCERTAINTY)
    return run_study(folder / "study.toml", folder / "out", on_progress=on_progress)


def test_frames_in_contact_become_rows(plain, press):
    rows = studies.rows_by(plain, "frame")
    assert set(range(4, 24)) <= set(rows) <= set(range(3, 25))
    for k, row in rows.items():
        assert (row["observation"], row["sequence"], row["status"]) == (f"p#{k}", "p", "measured")
        assert row["scale"] == "sequence:p"
        assert (row["time_s"], row["load_N"]) == pytest.approx((k / RATE, LOAD[k]))
        assert abs(row["semi_major_mm"] - press.semi_major[k]) < 3.5 * row["semi_major_mm_std"]
    for phase, frames in (("loading", range(5, 10)), ("hold", range(12, 15)), ("unloading", range(17, 24))):
        assert {rows[k]["phase"] for k in frames} == {phase}
    assert_allclose([row["reduced_modulus_kpa"] for row in records(plain.rows[3:-3])], 90, rtol=0.06)


def test_only_loading_frames_of_large_ellipses_are_pooled(study_dir, plain):
    pooled = [row for row in records(plain.rows) if row["pooled"]]
    assert {row["phase"] for row in pooled} == {"loading"}
    assert all(row["semi_minor_mm"] >= 5 * row["ridge_period_mm"] for row in pooled)
    chosen = [
        row["load_N"] for row in records(run(study_dir, of_frames(pool_min_load_N=1.2)).rows) if row["pooled"]
    ]
    assert 1.2 <= min(chosen) < 1.5
    assert 0 < len(chosen) < len(pooled)


def test_a_sequence_given_twice_counts_once_or_not_at_all(study_dir, plain):
    result = run(study_dir, of_frames(), of_frames("q"))
    (once,), (twice,) = plain.summaries, result.summaries
    assert twice.corrected_radius.count == once.corrected_radius.count == 1
    assert twice.corrected_radius.total_std == once.corrected_radius.total_std
    assert result.notes[0].startswith("p and q are one sequence, which counts once: keep one")
    other = run(study_dir, of_frames(), of_frames("q", wedge=45))
    assert not other.rows["pooled"].any()
    assert other.notes[0].startswith("p and q are one sequence, of different presses, none of which counts")


def test_a_sequence_counts_as_one_contact_however_many_its_frames(study_dir):
    few, many = (run(study_dir, of_frames(pool_min_load_N=least)) for least in (1.5, 0.3))
    (one,), (all_,) = few.summaries, many.summaries
    assert one.corrected_radius.count == all_.corrected_radius.count == 1
    own = [
        row["radius_from_indentation_mm_fixed_geometry_std"] for row in records(many.rows) if row["pooled"]
    ]
    assert all_.corrected_radius.fixed.std >= min(own)
    assert all_.corrected_radius.total_std == pytest.approx(one.corrected_radius.total_std, rel=0.02)
    again = shutil.copytree(study_dir / "frames", study_dir / "again")
    shutil.copy(
        again / "f0.png", again / "f27.png"
    )  # another press, whose frames are the same where it counts
    pressed = of_frames("q")
    pressed = pressed._replace(keys={**pressed.keys, "file": "again"})
    (two,) = run(study_dir, of_frames(), pressed).summaries
    assert two.corrected_radius.count == 2
    assert pooled_from(two).endswith("frames of 2 sequences")
    # Pad and wedge are the same for both sequences: most of the uncertainty does not average away.
    assert two.corrected_radius.total_std == pytest.approx(all_.corrected_radius.total_std, rel=0.05)


def test_frames_in_contact_without_load_cost_themselves_only(study_dir):
    write_force(study_dir, LOAD - 0.3)
    studies.write_study(
        study_dir, studies.finger(), of_frames(), uncertainty=UNCERTAINTY | {"load_relative_std": 0.01}
    )
    found = list(records(run_study(study_dir / "study.toml", study_dir / "out").rows))
    failed = [row for row in found if row["load_N"] <= 0]
    assert 0 < len(failed) < len(found)
    for row in failed:
        assert (row["status"], row["youngs_modulus_kpa"], row["pooled"]) == ("failed", None, False)
        assert "the load of a contact must be positive, found -0." in row["reason"]
        assert row["gross_area_mm2"] > 0
    assert all(row["youngs_modulus_kpa"] > 0 for row in found if row["load_N"] > 0)


def test_frames_missing_by_their_names_keep_the_times_of_the_others(study_dir):
    for lost in (7, 8, 9):
        (study_dir / "frames" / f"f{lost}.png").unlink()
    result = run(study_dir)
    kept = [k for k in range(LOAD.size) if k not in {7, 8, 9}]
    for row in records(result.rows):
        assert row["load_N"] == pytest.approx(LOAD[kept[row["frame"]]])
    skipped = "file names skip 3 frames between f6.png and f10.png: times follow the numbers"
    assert result.sequences[0].summary.notes == (skipped,)
    studies.write_numbers(study_dir / "times.csv", "time_s", np.array(kept) / RATE)
    timed = run(study_dir, of_frames(frames_per_second=None, times="times.csv"))
    assert_allclose(timed.rows["load_N"], result.rows["load_N"])
    assert not timed.sequences[0].summary.notes


def test_a_sequence_out_of_step_with_its_force_is_not_pooled(study_dir):
    for k in range(7, LOAD.size):  # three frames are lost, and the names do not tell
        frame = study_dir / "frames" / f"f{k}.png"
        frame.rename(frame.with_name(f"f{k - 3}.png")) if k >= 10 else frame.unlink()
    result = run(study_dir)
    assert "from frame 6 to 7 the area grows by" in result.sequences[0].summary.notes[0]
    assert not result.rows["pooled"].any()
    assert set(result.rows["excluding_flags"]) == {"out_of_step"}
    assert any(
        re.match(r"doubtful: p \(\d+ frames\): the area does not follow", words)
        for words in doubtful_results(result)
    )


def test_frames_of_a_camera_that_stood_still_are_not_pooled(study_dir):
    for k in (8, 9):
        shutil.copy(study_dir / "frames" / "f7.png", study_dir / "frames" / f"f{k}.png")
    result = run(study_dir)
    assert "frames 8 and 9 are the same picture" in result.sequences[0].summary.notes[0]
    assert list(result.rows["frame"][result.rows["excluding_flags"] == "repeated_frame"]) == [8, 9]


def test_a_corrupt_frame_is_one_failed_row(study_dir):
    (study_dir / "frames" / "f8.png").write_bytes(b"torn")
    Image.new("L", (40, 40)).save(study_dir / "frames" / "f12.png")
    result = run(study_dir)
    failed = {row["frame"]: row for row in records(result.rows) if row["status"] == "failed"}
    assert set(failed) == {8, 12}
    assert "f8.png" in failed[8]["reason"]
    assert str(study_dir) not in failed[8]["reason"]
    assert (failed[8]["time_s"], failed[8]["pooled"]) == (pytest.approx(0.4), False)
    assert len(result.failures) == 1
    assert "first frame 8: frames/f8.png" in result.sequences[0].summary.notes[0]
    assert result.failures[0].startswith("p: 2 frames; the first: 8: frames/f8.png")


@pytest.mark.parametrize("torn", [False, True])
def test_a_sequence_without_a_contact_of_known_load_leaves_results(study_dir, torn):
    """Its force begins after its last frame, or no frame can be read."""
    if torn:
        for frame in (study_dir / "frames").iterdir():
            frame.write_bytes(b"torn")
    out = study_dir / "out"
    run(study_dir, of_frames() if torn else of_frames(start_s=100))
    result = run_study(study_dir / "study.toml", out, write_report=write_report)
    (why,) = fingers_without_results(result)
    assert why.endswith(
        "was measured" if torn else "no frame of its sequences is a contact under a known force"
    )
    assert not result.summaries
    text = " ".join(methods_section(result).paragraphs)
    assert "of 1 sequence" in text
    assert "nan" not in text
    assert (out / "report.html").exists()


@pytest.mark.parametrize(
    ("keys", "change", "reason"),
    [
        ({"frames_per_second": None}, None, "frames: pictures state no rate: give frames_per_second"),
        (
            {},
            lambda path: studies.write_numbers(path / "force.csv", "t,F", [[1, 2]]),
            "force.csv: no column time_s or force_N",
        ),
        ({}, lambda path: [*map(Path.unlink, (path / "frames").iterdir())], "frames: holds no picture"),
        ({"contact_load_N": 9}, None, "the force never rises through 9 N"),
        ({"region_of_interest_px": [900, 0, 990, 90]}, None, "region_of_interest"),
    ],
)
def test_a_sequence_that_cannot_be_used_costs_itself_only(study_dir, keys, change, reason):
    if change:
        change(study_dir)
    reported: list[Progress] = []
    result = run(study_dir, of_frames(**keys), studies.contact(load=1, axis=""), on_progress=reported.append)
    given, lost = records(result.rows)
    assert (given["status"], lost["status"], lost["observation"]) == ("measured", "failed", "p")
    assert (reported[-1].pictures, reported[-1].failed) == (reported[-1].total, 1)
    assert reason in lost["reason"]
    if "frames_per_second" in keys:
        assert "It could not be measured" in studies.page_of(result, study_dir / "out")


def test_a_stored_sequence_whose_force_is_refused_now_costs_itself_only(study_dir, monkeypatch):
    def refuse(path: Path, columns: object) -> NoReturn:
        raise LoadingError(f"{path}: refused")

    monkeypatch.setattr("fingerpad.image.read_force_signal", refuse)
    given, lost = records(run(study_dir, of_frames(), studies.contact(load=1, axis="")).rows)
    assert (given["status"], lost["status"], lost["reason"]) == ("measured", "failed", "force.csv: refused")


def test_frames_that_changed_since_the_run_are_changed_inputs(study_dir):
    studies.write_study(study_dir, studies.finger(), of_frames(), uncertainty=UNCERTAINTY)
    assert verify_study(study_dir, study_dir / "out").changed_inputs == ()
    (study_dir / "frames" / "f9.png").write_bytes((study_dir / "frames" / "f8.png").read_bytes())
    assert verify_study(study_dir, study_dir / "out").changed_inputs == ("frames",)


@pytest.mark.parametrize(("least", "noted"), [(5.0, True), (0.5, False), (None, False)])
def test_a_sequence_of_which_nothing_is_pooled_is_noted(study_dir, least, noted):
    result = run(study_dir, of_frames(**({} if least is None else {"pool_min_load_N": least})))
    notes = [note for note in sequence_notes(result) if "frames is pooled" in note]
    assert len(notes) == noted
    assert all(note.endswith("in none of the loading ones the load is 5 N or more") for note in notes)
    held = replace(result, rows=result.rows.assign(phase="hold", pooled=False))
    *_, note = sequence_notes(held)
    assert note.endswith("none is of the loading phase")


@pytest.mark.parametrize("stated", [None, RATE])
def test_the_rate_at_which_a_video_plays_is_noted_where_it_is_taken(study_dir, press, stated):
    write_frames(study_dir / "press.avi", [press.pixels(k) for k in range(LOAD.size)], RATE)
    table = of_frames(frames_per_second=stated)
    result = run(study_dir, table._replace(keys={**table.keys, "file": "press.avi"}))
    notes = result.sequences[0].summary.notes
    assert any("press.avi plays at 20 frames per second" in note for note in notes) == (stated is None)


def test_what_looks_wrong_in_a_force_table_is_noted(study_dir):
    rows = "\n".join(f"{k / RATE};{1000 * load:.3f};0" for k, load in enumerate(LOAD))
    (study_dir / "force.csv").write_text(f"Time / s;Load [N];triger (V)\n{rows}\n".replace(".", ","))
    result = run(study_dir, of_frames(region_of_interest_px=[0, 0, 60, 60]))
    (note,) = result.notes
    assert note.startswith("force.csv: column 'triger (V)' was not read; if it is the trigger: force_columns")
    assert "loads up to 2000 N: is the force in millinewtons (force_mN)?" in result.sequences[0].summary.notes


@pytest.mark.parametrize(
    ("task", "change", "named"),
    [
        ("p header", "UPDATE result SET seconds = -1", "p header"),
        ("p frames 0-28", "UPDATE result SET seconds = -1", "p frames 0-28"),
        ("p frames 0-28", "DELETE FROM result", "p"),
    ],
)
def test_a_part_that_is_damaged_or_lost_is_measured_again_and_named(study_dir, plain, task, change, named):
    with sqlite3.connect(study_dir / "out" / STORE_NAME) as connection:
        assert connection.execute(f"{change} WHERE task = ?", (task,)).rowcount == 1
    result = run(study_dir)
    assert studies.rows_by(result) == studies.rows_by(plain)
    assert result.notes == (f"{STORE_NAME}: the stored result of {named} was damaged and is measured again",)


def test_corrections_reach_every_frame(study_dir, press):
    rows, columns = press.pixels(0).shape
    result = run(study_dir, of_frames(region_of_interest_px=[0, 0, rows // 2, columns]))
    frame = studies.rows_by(result, "frame")[12]
    assert frame["measured_by"] == "corrected"
    assert "cut_by_mask" in frame["flags"]
    assert not any(row["pooled"] for row in records(result.rows))
    assert frame["gross_area_mm2"] == pytest.approx(press.gross_area[12] / 2, rel=0.05)
    text = studies.page_of(result, study_dir / "out")
    assert re.search(r"In \d\d of its frames the contact is cut by the mask", text)


def test_the_report_shows_a_few_frames_and_lists_none(plain, study_dir, monkeypatch):
    monkeypatch.setattr(plots, "_MOST_FRAMES", 10)
    text = studies.page_of(plain, study_dir / "out")
    assert re.search(r"10 of 2\d frames are drawn", text)
    assert "<td>p#" not in text
    assert text.count("p#") < 8  # drawn and looked at closely, not listed
    assert text.count("data:image/jpeg;base64,") == 3
    roles = {overlay.role: overlay.frame for overlay in plain.sequences[0].overlays}
    assert list(roles) == ["first contact", "largest load", "last contact"]
    assert LOAD[roles["largest load"]] == 2
    (record,) = summary_of(plain).model_dump()["sequences"]
    assert record["frames"] == LOAD.size
    assert record["frames_with_contact"] + record["frames_without_contact"] == LOAD.size
    assert record["area_exponent"] == pytest.approx(2 / 3, abs=0.02)


def key_frame(press: SyntheticSequence, frame: int) -> dict:
    """The true ellipse of a frame as a person would place it."""
    size = 25.4 / press.ppi
    ellipse = {
        "centre": [(length - 1) / 2 for length in press.pixels(frame).shape],
        "semi_axes": [press.semi_major[frame] / size, press.semi_minor[frame] / size],
    }
    return {"ellipse_px": ellipse, "key_frame": True}


def test_ellipses_of_key_frames_are_carried_to_the_frames_between(study_dir, plain, press):
    run(study_dir)
    studies.correct(study_dir, "p#5", key_frame(press, 5))
    studies.correct(study_dir, "p#8", {"rejected": "slipped"})
    studies.correct(study_dir, "p#11", key_frame(press, 11))
    studies.correct(study_dir, "p#14", {**key_frame(press, 14), "key_frame": False})
    rows, before = studies.rows_by(run(study_dir), "frame"), studies.rows_by(plain, "frame")
    assert before[5]["measured_by"] == "automatic"
    for frame in (6, 7, 9, 10):
        row = rows[frame]
        assert "interpolated" in row["flags"]
        assert (row["measured_by"], row["reviewed_by"]) == ("manual", "anna")
        for name, truth in (("semi_major_mm", press.semi_major), ("semi_minor_mm", press.semi_minor)):
            expected = np.interp(frame, [5, 11], truth[[5, 11]])
            assert row[name] == pytest.approx(expected, rel=3e-3)
            assert abs(row[name] - truth[frame]) < 2 * row[f"{name}_std"]
        # Half-way from 5 to 11 little is known of the size: more than the hand's own uncertainty is added.
        assert row["gross_area_mm2_noise_std"] > 1.5 * rows[5]["gross_area_mm2_noise_std"]
    assert rows[7]["gross_area_mm2_noise_std"] > rows[6]["gross_area_mm2_noise_std"]
    assert rows[8]["status"] == "rejected"
    assert "interpolated" not in rows[5]["flags"] + rows[11]["flags"]
    for frame in (4, 12, 13, 15):  # beyond the key frames, and up to a frame that is none
        assert rows[frame]["semi_major_mm"] == before[frame]["semi_major_mm"]
    # Without its second key frame nothing is carried.
    studies.correct(study_dir, "p#11", {})
    assert studies.rows_by(run(study_dir), "frame")[9] == before[9]


def active_corrections(frames: dict[int, dict]) -> dict[str, ActiveCorrection]:
    """Return what is said of frames of the press."""
    changes = {f"p#{frame}": ContactCorrection(**change) for frame, change in frames.items()}
    said = {"who": "anna", "when": ""}
    return {item: ActiveCorrection(item=item, change=change, **said) for item, change in changes.items()}


def test_a_range_of_frames_takes_its_ellipses_and_no_others():
    ellipses = {frame: {"centre": [50, 50], "semi_axes": [size, size]} for frame, size in ((2, 30), (9, 40))}
    active = active_corrections({k: {"ellipse_px": one, "key_frame": True} for k, one in ellipses.items()})
    every = frame_corrections(active, "p")
    assert sorted(every) == [2, 3, 4, 5, 6, 7, 8, 9]
    some = frame_corrections(active, "p", range(4, 6))
    assert some == {frame: every[frame] for frame in (2, 4, 5, 9)}
    assert set(frame_corrections(active, "p", range(20, 30))) == {2, 9}
    slipped = ContactCorrection(ellipse_px=ellipses[9], key_frame=True, rejected="slipped")
    active["p#9"] = replace(active["p#9"], change=slipped)
    assert set(frame_corrections(active, "p")) == {2, 9}  # a frame that is rejected carries nothing


def test_ellipses_between_keep_their_direction_and_turn_the_short_way():
    one = ImageEllipse(centre=(0, 0), semi_axes=(50, 30), orientation=np.radians(80))
    other = ImageEllipse(centre=(10, 20), semi_axes=(50, 30), orientation=np.radians(-80))
    between = interpolated_ellipse(one, other, 0.5)
    assert abs(np.degrees(between.orientation)) == pytest.approx(90)
    assert between.centre == (5, 10)
    for share, same in ((0, one), (1, other)):
        end = interpolated_ellipse(one, other, share)
        assert_allclose(end.semi_axes, same.semi_axes)
        assert np.degrees(end.orientation) == pytest.approx(np.degrees(same.orientation))
    # What the points of the circle become moves along straight lines, wherever the axes point.
    turned = interpolated_ellipse(one, ImageEllipse(centre=(0, 0), semi_axes=(40, 40)), 0.25)
    assert_allclose(turned.semi_axes, (47.5, 32.5))
    assert np.degrees(turned.orientation) == pytest.approx(80)


def test_the_key_of_a_sequence_changes_with_what_is_carried_and_with_nothing_else(study_dir):
    studies.write_study(study_dir, studies.finger(), of_frames(), uncertainty=UNCERTAINTY)
    study = read_study(study_dir / "study.toml")

    def key_of(**frames: dict) -> tuple[str, str]:
        active = active_corrections({int(name[1:]): change for name, change in frames.items()})
        edits = {frame: one.change.edits for frame, one in frame_corrections(active, "p").items()}
        measured = repr(sorted((frame, edit) for frame, edit in edits.items() if edit))
        return measured, StudyItems(
            RunContext(study=study, folder=study_dir, active_corrections=active)
        ).sequences[0].key

    ellipse = {"ellipse_px": {"centre": [50, 50], "semi_axes": [30, 20]}}
    key, accepted = {"key_frame": True}, {"accepted": True}
    larger = {"ellipse_px": {"centre": [50, 50], "semi_axes": [40, 20]}} | key
    both, widening = {"f2": ellipse | key, "f9": ellipse | key}, {"f2": ellipse | key, "f9": larger}
    cases = [
        key_of(),
        key_of(f2=ellipse),
        key_of(f2=ellipse, f9=ellipse),
        key_of(**both),
        key_of(**both, f20=accepted),
        key_of(**both, f5=accepted),
        key_of(**both | {"f9": ellipse | key | accepted}),
        key_of(**both | {"f9": ellipse | key | {"rejected": "slipped"}}),
        key_of(**widening),
        key_of(**widening, f5={"threshold": 40.0}),
        key_of(**widening, f5=larger),
    ]
    for one, other in combinations(cases, 2):
        assert (one[0] == other[0]) == (one[1] == other[1])


PHASES = [("loading", 0.075), ("hold", 0.475), ("unloading", 0.925), ("after", 1.125)]


def phases(*starts: tuple[str, float], why: str = "slipped at first") -> dict:
    return {"phases": {"starts": [{"phase": phase, "start_s": start} for phase, start in starts], "why": why}}


def stored_keys(out: Path) -> set[tuple[str, str]]:
    with Store.reading(out / STORE_NAME) as store:
        return {(name, status.key) for name, status in store.statuses().items()}


def test_phases_that_a_person_set_rule_and_are_reported_as_such(study_dir, plain):
    run(study_dir)
    studies.correct(study_dir, "p#phases", phases(*PHASES))
    assert study_status(study_dir / "study.toml", study_dir / "out").stale == 1
    stored = stored_keys(study_dir / "out")
    log, result = CorrectionLog(study_dir), run(study_dir)
    # No picture is measured again.
    assert {name for name, _ in stored - stored_keys(study_dir / "out")} == {"p"}
    rows, before = studies.rows_by(result, "frame"), studies.rows_by(plain, "frame")
    # Frames are 0.05 s apart: the limits lie half-way between frames 1 and 2, 9 and 10, 18 and 19, 22 and 23.
    for names, frames in (("loading", range(5, 10)), ("hold", range(10, 19)), ("unloading", range(19, 23))):
        assert {rows[k]["phase"] for k in frames} == {names}
    assert 23 in before
    assert 23 not in rows
    assert {row["phase_corrected_by"] for row in rows.values()} == {"anna"}
    assert max(frame for frame, row in rows.items() if row["pooled"]) == 9
    assert max(frame for frame, row in before.items() if row["pooled"]) == 11
    (record,) = summary_of(result).model_dump()["sequences"]
    assert list(map(list, record["phase_starts_s"])) == [list(one) for one in PHASES]
    assert (record["phases_corrected_by"], record["phases_reason"]) == ("anna", "slipped at first")
    assert record["phases_corrected_at"] == log.history("p#phases").records[0].when
    assert record["phases"]["hold"] == 9
    text = studies.page_of(result, study_dir / "out")
    assert "phases set manually by anna" in text
    assert "hold from 0.475 s" in text
    # Taken back, everything is as it was.
    log.undo("p#phases", who="anna", expected=log.history("p#phases").last_id)
    after = run(study_dir)
    assert studies.rows_by(after, "frame") == before
    assert summary_of(after).model_dump()["sequences"][0]["phases_corrected_by"] is None
    assert "phases set manually" not in studies.page_of(after, study_dir / "out")


# The platen moves up to the pad, presses it by Hertz's law, and goes back.
DEPTH = 1.2 * (LOAD / 2) ** (2 / 3)
AWAY = np.where(np.arange(LOAD.size) < 2, np.arange(LOAD.size) - 2.0, 0) * 0.1


def test_a_displacement_gives_each_frame_its_indentation(study_dir, plain):
    write_force(study_dir, displacement_mm=7 + DEPTH + AWAY)
    result, out = run(study_dir), study_dir / "out"
    for frame, row in studies.rows_by(result, "frame").items():
        assert row["measured_indentation_mm"] == pytest.approx(DEPTH[frame], abs=0.02)
    assert np.isnan(plain.rows["measured_indentation_mm"].to_numpy()).all()
    against = "against the platen's displacement from the place of contact"
    assert against in html.unescape(studies.page_of(result, out))
    assert "indentation ξ" in (out / "figures" / "sequence_p_indentation.svg").read_text()
    assert against not in html.unescape(studies.page_of(plain, out))


def test_without_an_approach_there_is_no_indentation_but_a_note(study_dir, plain):
    # The record begins in contact.
    write_force(study_dir, since=4, displacement_mm=DEPTH + np.arange(LOAD.size) / 1e4)
    result = run(study_dir, of_frames(start_s=0))
    assert not result.rows["measured_indentation_mm"].notna().any()
    (note,) = [note for note in result.sequences[0].summary.notes if "indentation" in note]
    assert "place of contact is unknown" in note


# Smooth contacts in a study: said once for all, or for one observation or sequence


def test_the_background_of_smooth_frames_is_as_deep_as_they_are(tmp_path):
    manifest = make_smooth_study(tmp_path)
    levels = np.asarray(Image.open(tmp_path / "empty.png")).astype(np.uint16) * 257 + 100
    Image.fromarray(levels).save(tmp_path / "deep.png")
    (sequence,) = read_study(manifest).sequences
    options = contact_options(sequence.model_copy(update={"background": "deep.png"}), tmp_path)
    np.testing.assert_array_equal(options["background"], levels)


@pytest.fixture(scope="module")
def smooth(tmp_path_factory):
    manifest = make_smooth_study(tmp_path_factory.mktemp("smooth"))
    return manifest, run_study(manifest, manifest.parent / "out")


@pytest.mark.parametrize("colour", [False, True])
def test_the_first_frame_is_the_background_of_a_sequence_of_smooth_contacts(smooth, tmp_path, colour):
    """In colour what differs from it has the luma of the ground."""
    coloured = colour and run_study(make_smooth_study(tmp_path, colour=True), tmp_path / "out")
    rows = studies.rows_by(coloured or smooth[1])
    assert rows.pop("contact")["gross_area_mm2"] == pytest.approx(area_at(2.0), rel=0.015)
    assert set(rows) == {f"press#{frame}" for frame, load in enumerate(LOADS) if load}
    for name, row in rows.items():
        truth = area_at(LOADS[int(name.removeprefix("press#"))])
        assert abs(row["gross_area_mm2"] - truth) < 2.5 * row["gross_area_mm2_std"] < 0.3 * truth
        assert (row["status"], row["ridge_area_mm2"]) == ("measured", None)
    assert colour or any(row["pooled"] for row in rows.values())


def test_smooth_contacts_are_reported_with_the_edge_as_their_uncertainty(smooth):
    manifest, result = smooth
    assert studies.rows_by(result)["contact"]["gross_area_mm2_noise_std"] == 0
    write_report(result, manifest.parent / "out")
    assert "noise 0, edge " in (manifest.parent / "out" / "report.html").read_text()


def change(manifest, old, new):
    manifest.write_text(manifest.read_text().replace(old, new))


def test_a_table_overrides_the_surface_of_the_study_and_a_threshold_is_refused_in_words(tmp_path):
    manifest = make_smooth_study(tmp_path / "a")
    change(manifest, 'name = "contact"', 'name = "contact"\nsurface = "ridged"')
    study = read_study(manifest)
    assert (study.observations[0].surface, study.sequences[0].surface) == ("ridged", "smooth")
    change(manifest, 'surface = "ridged"', "threshold = 20")
    rows = studies.rows_by(run_study(manifest, manifest.parent / "out"))
    assert "threshold tells ridges from valleys" in rows["contact"]["reason"]
    change(manifest, 'surface = "smooth"', 'surface = "rough"')
    with pytest.raises(ManifestError, match=r"surface.*smooth"):
        read_study(manifest)


def test_another_surface_of_the_study_measures_again(smooth):
    manifest, _ = smooth
    assert study_status(manifest, manifest.parent / "out").stale == 0
    change(manifest, 'surface = "smooth"', "")
    assert study_status(manifest, manifest.parent / "out").stale > 0
