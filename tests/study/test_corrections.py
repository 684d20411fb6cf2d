"""The file of corrections: nothing confirmed is lost, the newest rules, and undo walks back and forth."""

import json
import time

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tests.studies import contact, finger, picture, sequence, study_of
from tests.waiting import exit_codes

from fingerpad.exceptions import CorrectionConflict, StoreError
from fingerpad.study.corrections.log import CORRECTIONS_NAME, CorrectionLog, frames_of, kind_of

PPI_500 = {"scale": {"ppi": 500}}
STUDY = study_of(
    finger(photographs=[{"face": "palmar", "file": "a/p.jpg", **PPI_500}]),
    *(picture(name, "x.png", **PPI_500) for name in ("print_1", "print_2")),
    contact("given", 1),
    sequence("press", "p", force="f.csv", **PPI_500),
)
STARTS = [{"phase": "loading", "start_s": 0.5}, {"phase": "hold", "start_s": 1.5}]
PHASES = {"phases": {"starts": STARTS, "why": "slipped"}}
STROKE = {"action": "add", "points_px": [[10.5, 20], [30, 40.25]], "radius_px": 5}


@pytest.fixture
def log(tmp_path):
    return CorrectionLog(tmp_path)


def said(log, item, change, **others):
    given = {"who": "anna", "expected": log.history(item).last_id, "study": STUDY} | others
    return log.append(item, change, **given)


def test_the_newest_is_active_and_every_correction_stays(tmp_path, log):
    for level in (10, 20, 40):
        said(log, "print_1", {"threshold": level, "strokes": [STROKE], "accepted": True})
    other = CorrectionLog(tmp_path)
    active_correction = other.active_correction("print_1")
    assert active_correction.change.threshold == 40
    assert active_correction.change.strokes[0].points_px == [[10.5, 20], [30, 40.25]]
    assert (active_correction.change.accepted, active_correction.who) == (True, "anna")
    assert other.active_correction("print_2") is None
    kept = [json.loads(line) for line in (tmp_path / CORRECTIONS_NAME).read_text().splitlines()]
    assert [record["change"]["threshold"] for record in kept] == [10, 20, 40]
    assert all(record["who"] == "anna" and record["when"].endswith("Z") for record in kept)
    said(log, "print_1", {})  # nothing said is the program's own
    assert log.active_correction("print_1") is None
    assert log.active_corrections() == {}


def test_many_corrections_are_found_in_a_large_study_at_once(tmp_path):
    def seconds(count):
        names = [f"print_{number}" for number in range(count)]
        record = {"when": "2026", "who": "anna", "action": "change", "change": {"threshold": 9}}
        lines = (json.dumps({"id": number, "item": name, **record}) for number, name in enumerate(names, 1))
        (tmp_path / CORRECTIONS_NAME).write_text("\n".join([*lines, ""]))
        log, study = CorrectionLog(tmp_path), study_of(finger(), *(contact(name, 1) for name in names))
        began = time.process_time()
        assert log.unknown_items(study) == []
        return time.process_time() - began

    few, many = seconds(1_000), seconds(10_000)
    assert many < 40 * few + 0.2  # to look through all for each would take a hundred times as long


def test_who_corrected_pooling_stays_whoever_corrects_later(log):
    out = {"include": False, "why": "slipped"}
    said(log, "print_1", {"pooling": {"include": True, "why": "slipped"}}, who="first")
    said(log, "print_1", {"pooling": out}, who="anna")
    said(log, "print_1", {"pooling": out, "threshold": 20}, who="ben")
    rules = log.active_correction("print_1")
    assert (rules.who, rules.pooling.who) == ("ben", "anna")
    assert rules.pooling.when == log.history("print_1").records[1].when
    assert rules.change.edits == {"threshold": 20}
    said(log, "print_1", {"threshold": 20}, who="ben")
    assert log.active_correction("print_1").pooling is None


def test_items_of_all_kinds(log):
    said(log, "press#120", {"rejected": "blurred"})
    said(log, "press#phases", PHASES)
    said(log, "f/a/p.jpg", {"tip": "left", "erased": [{"points_px": [[1, 1]], "radius_px": 3}]})
    kinds = [kind_of(item, STUDY) for item in ("print_1", "press#120", "press#phases", "f/a/p.jpg")]
    assert kinds == ["observation", "frame", "phases", "photograph"]
    assert frames_of(log.active_corrections(), "press").keys() == {120}
    assert frames_of(log.active_corrections(), "press")[120].change.rejected == "blurred"
    assert log.active_correction("press#phases").change.phases.starts[1].phase == "hold"
    assert log.active_correction("f/a/p.jpg").change.tip == "left"


def test_items_that_the_manifest_lost_wait_and_so_do_frames_without_a_number(tmp_path, log):
    said(log, "print_1", {"accepted": True})
    assert log.unknown_items(STUDY) == []
    fewer = STUDY.model_copy(update={"observations": STUDY.observations[1:]})
    assert log.unknown_items(fewer) == ["print_1"]
    record = {"id": 2, "when": "2026", "who": "A", "action": "change", "change": {"threshold": 0.4}}
    with (tmp_path / CORRECTIONS_NAME).open("a") as file:
        for number in ("abc", "07"):
            file.write(json.dumps({**record, "item": f"press#{number}"}) + "\n")
            record["id"] += 1
    assert frames_of(log.active_corrections(), "press") == {}
    assert log.unknown_items(STUDY) == ["press#abc", "press#07"]


BAD = {
    "no frame number": ("press#x", {"threshold": 1}, "nothing that can be corrected"),
    "no such photograph": ("f/b.jpg", {"tip": "up"}, "nothing that can be corrected"),
    "unknown key": ("print_1", {"treshold": 1}, "treshold: unknown key"),
    "zero threshold": ("print_1", {"threshold": 0}, "threshold: expected"),
    "not a number": ("print_1", {"threshold": float("nan")}, "threshold"),
    "no radius": ("print_1", {"strokes": [{"action": "add", "points_px": [[1, 1]]}]}, "give radius_px"),
    "stroke as region": ("print_1", {"strokes": [{**STROKE, "action": "replace"}]}, "leave it out"),
    "key frame alone": ("press#4", {"key_frame": True}, "give ellipse_px"),
    "minor first": ("print_1", {"ellipse_px": {"centre": [1, 1], "semi_axes": [3, 4]}}, "major one first"),
    "phases of no sequence": ("print_1#phases", PHASES, "nothing that can be corrected"),
    "phases backwards": (
        "press#phases",
        {"phases": {"starts": STARTS[::-1], "why": "slipped"}},
        "loading at 0.5 s begins before hold at 1.5 s",
    ),
    "phases for no reason": ("press#phases", {"phases": {"starts": STARTS}}, "why"),
    "both verdicts": ("print_1", {"accepted": True, "rejected": "x"}, "one of the two"),
    "no reason": ("print_1", {"rejected": "  "}, "rejected"),
    "no picture": ("given", {"threshold": 4}, "no picture to correct"),
    "threshold of nothing": ("print_1", {"threshold": 1e-300}, "1e-300 is too small to be meant"),
    "stroke outside": ("print_1", {"strokes": [{**STROKE, "points_px": [[-9, 4]]}]}, "lies outside"),
    "mask outside": ("print_1", {"mask_px": [[1, 90], [2, 90], [3, 99]]}, "mask_px"),
    "ellipse outside": ("print_1", {"ellipse_px": {"centre": [5, -3], "semi_axes": [4, 3]}}, "centre"),
    "point far away": ("f/a/p.jpg", {"added_points_px": [[5, 5], [1e200, 9]]}, "or equal to 1000000"),
}


@pytest.mark.parametrize(("item", "change", "words"), BAD.values(), ids=BAD)
def test_what_is_wrong_is_said_and_nothing_is_kept(tmp_path, log, item, change, words):
    with pytest.raises(StoreError, match=words) as error:
        said(log, item, change, shape=(60, 80))
    assert item in str(error.value)
    assert not (tmp_path / CORRECTIONS_NAME).exists()


def test_a_brush_may_reach_over_the_rim_but_no_author_be_nameless(log):
    change = {"strokes": [{**STROKE, "points_px": [[-3, 40]]}]}
    with pytest.raises(StoreError, match="name of who"):
        said(log, "print_1", change, shape=(60, 80), who="  ")
    said(log, "print_1", change, shape=(60, 80))
    (stroke,) = log.active_correction("print_1").change.strokes
    assert [list(point) for point in stroke.points_px] == [[-3, 40]]


def test_who_saw_less_is_told_who_did_what(tmp_path):
    log, other = CorrectionLog(tmp_path), CorrectionLog(tmp_path)
    seen = other.history("print_1").last_id
    record = said(log, "print_1", {"threshold": 40})
    with pytest.raises(CorrectionConflict, match="anna changed threshold at 2") as error:
        said(other, "print_1", {"threshold": 50}, who="ben", expected=seen)
    assert error.value.latest == record
    assert log.active_correction("print_1").change.threshold == 40
    # What is done to one item does not stand in the way of another.
    said(other, "print_2", {"threshold": 50}, who="ben", expected=0)


@given(steps=st.lists(st.one_of(st.sampled_from(["undo", "redo"]), st.integers(1, 9)), max_size=14))
@settings(max_examples=15, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_undo_and_redo_walk_like_two_stacks(tmp_path_factory, steps):
    log = CorrectionLog(tmp_path_factory.mktemp("study"))
    done, undone = [], []
    for step in steps:
        history = log.history("print_1")
        assert (history.can_undo, history.can_redo) == (bool(done), bool(undone))
        if isinstance(step, int):
            said(log, "print_1", {"threshold": step})
            done.append(step)
            undone.clear()
        elif (step == "undo" and done) or (step == "redo" and undone):
            getattr(log, step)("print_1", who="anna", expected=history.last_id)
            (undone if step == "undo" else done).append((done if step == "undo" else undone).pop())
        else:
            with pytest.raises(StoreError, match=f"nothing to {step}"):
                getattr(log, step)("print_1", who="anna", expected=history.last_id)
        active_correction = CorrectionLog(log._path.parent).active_correction("print_1")
        assert (active_correction and active_correction.change.threshold) == (done[-1] if done else None)


def write_many(folder, item):
    log = CorrectionLog(folder)
    for number in range(60):
        said(log, item, {"threshold": number + 1, "strokes": [STROKE] * (number % 7)})


def test_two_processes_lose_nothing(tmp_path, log):
    items = ("print_1", "print_2")
    assert exit_codes(write_many, *((tmp_path, item) for item in items)) == [0, 0]
    for item in items:
        assert [record.change["threshold"] for record in log.history(item).records] == list(range(1, 61))
    lines = (tmp_path / CORRECTIONS_NAME).read_text().splitlines()
    assert [json.loads(line)["id"] for line in lines] == list(range(1, 121))


@pytest.mark.parametrize("cut", [1, -2])
def test_a_torn_line_is_left_out_and_mended(tmp_path, cut):
    log = CorrectionLog(tmp_path)
    for level in (10, 20):
        said(log, "print_1", {"threshold": level, "strokes": [STROKE] * 9})
    path = tmp_path / CORRECTIONS_NAME
    whole = path.read_bytes()
    # Longer than the next record, so that it must make room.
    last = whole.splitlines(keepends=True)[-1]
    path.write_bytes(whole + last[:cut])
    fresh = CorrectionLog(tmp_path)
    assert "line 3 is torn" in fresh.notes[0]
    assert fresh.active_correction("print_1").change.threshold == 20
    said(fresh, "print_1", {"threshold": 30})
    assert fresh.notes == ()
    assert path.read_bytes().startswith(whole)
    assert [record.id for record in CorrectionLog(tmp_path).history("print_1").records] == [1, 2, 3]


def test_a_last_line_without_its_end_counts(tmp_path, log):
    said(log, "print_1", {"threshold": 10})
    path = tmp_path / CORRECTIONS_NAME
    path.write_bytes(path.read_bytes().rstrip(b"\n"))
    again = CorrectionLog(tmp_path)
    assert again.notes == ()
    said(again, "print_1", {"threshold": 20})
    assert [r.change["threshold"] for r in CorrectionLog(tmp_path).history("print_1").records] == [10, 20]


@pytest.mark.parametrize("line", ["{}", "[1]", "nonsense", "{" * 3000])
def test_damage_in_the_middle_is_no_silence(tmp_path, log, line):
    said(log, "print_1", {"threshold": 10})
    path = tmp_path / CORRECTIONS_NAME
    path.write_text(f"{line}\n{path.read_text()}")
    with pytest.raises(StoreError, match="line 1 is no correction"):
        CorrectionLog(tmp_path)


def test_a_bad_line_is_named_each_time_and_its_repair_noticed(tmp_path, log):
    for level in (10, 20):
        said(log, "print_1", {"threshold": level})
    path = tmp_path / CORRECTIONS_NAME
    good = path.read_bytes()
    path.write_bytes(good + b"nonsense\n" + good)
    for _ in range(3):
        with pytest.raises(StoreError, match="line 3 is no correction"):
            log.active_corrections()
    path.write_bytes(good)
    assert log.active_correction("print_1").change.threshold == 20
    # A line in the middle, in place and of the same length.
    path.write_bytes(good.replace(b'"who": "anna"', b'"who": "anne"', 1))
    for _ in range(2):
        with pytest.raises(StoreError, match="line 1 was changed after it was written"):
            log.active_corrections()
    path.write_bytes(good)
    assert log.active_correction("print_1").who == "anna"


def test_what_is_written_by_hand_has_no_checksum_and_counts(tmp_path, log):
    said(log, "print_1", {"threshold": 10})
    path = tmp_path / CORRECTIONS_NAME
    content = json.loads(path.read_text())
    content["change"]["threshold"] = 11
    path.write_text(json.dumps(content) + "\n")
    with pytest.raises(StoreError, match='remove its "checksum"'):
        log.active_corrections()
    del content["checksum"]
    path.write_text(json.dumps(content) + "\n")
    assert log.active_correction("print_1").change.threshold == 11
