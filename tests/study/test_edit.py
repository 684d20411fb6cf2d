"""Changing the manifest by program: comments stay, wrong edits write nothing, what is incomplete waits."""

import csv
import errno
import os
import resource
import shutil
import signal
import sys
import time
import tomllib
import zipfile
from contextlib import suppress
from pathlib import Path

import pytest
import tomlkit
from filelock import FileLock
from tests.studies import PAD, append_tables, correct, finger, sequence
from tests.waiting import exit_codes

from fingerpad.exceptions import EditConflict, FingerpadError, ManifestError, StoreError
from fingerpad.study import journal
from fingerpad.study.editing import edit
from fingerpad.study.editing.edit import Edit, change_study, create_study, folded, unfolded
from fingerpad.study.editing.template import write_template
from fingerpad.study.journal import JOURNAL_NAME, LOCK_NAME, recover, replace_files
from fingerpad.study.manifest.load import STUDY_NAME, LoadedStudy, is_as_read, load_study, read_study
from fingerpad.study.share import Bundle, pack
from fingerpad.study.status import missing, unused_files

MANIFEST = """\
# Whose study this is.
title = "Ours"   # to be renamed

[scales.reader]
ppi = 500        # on the box

[[fingers]]
name = "left"    # the first
semi_axes_mm = { palmar = 7.9, distal = 13.8, radial_ulnar = 11.8 }
semi_axes_mm_std = { palmar = 0.2, distal = 0.2, radial_ulnar = 0.2 }

# The prints.
[[observations]]
name = "print_1"
finger = "left"
wedge_angle_deg = 30
load_N = 2.0     # from the balance
file = "a.png"
scale = "reader"

[[observations]]
name = "print_2"
finger = "left"
wedge_angle_deg = 45
load_N = 1.0
file = "b.png"
scale = "reader"
"""
SEMI_AXES = {"semi_axes_mm": PAD, "semi_axes_mm_std": dict.fromkeys(PAD, 0.2)}
PRINT = {"finger": "left", "file": "a.png", "scale": "reader", "wedge_angle_deg": 30, "load_N": 2}


@pytest.fixture
def folder(tmp_path):
    for name in ("a.png", "b.png", "c.png"):
        (tmp_path / name).write_bytes(b"a picture")
    (tmp_path / STUDY_NAME).write_text(MANIFEST)
    return tmp_path


def studied(folder):
    return read_study(folder / STUDY_NAME)


def loaded(folder):
    return load_study(folder / STUDY_NAME)


def changed(folder, *edits):
    edits = [Edit(kind=kind, key=key, set=values) for kind, key, values in edits]
    return change_study(folder, edits, expected=loaded(folder).digest)


def contents(folder):
    """Everything a study folder holds, but locks."""
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.suffix != ".lock"}


def test_one_value_changes_one_line(folder):
    changed(folder, ("observation", "print_1", {"load_N": 2.5}))
    line = "load_N = {}     # from the balance"
    assert (folder / STUDY_NAME).read_text() == MANIFEST.replace(line.format("2.0"), line.format(2.5))


def test_adding_leaves_what_was_there(folder):
    state = changed(
        folder,
        ("observation", "print_3", {**PRINT, "file": "c.png", "threshold": 40.5, "seed_px": [20, 30]}),
        ("scale", "camera", {"mm_per_px": 0.05, "relative_std": 0.01}),
        ("study", "", {"poisson_ratio": 0.49}),
        ("uncertainty", "", {"load_relative_std": 0.02}),
        ("curve", "0", {"finger": "left", "wedge_angle_deg": 30, "loading_radius_mm": 5.5}),
    )
    study = studied(folder)
    assert (study, loaded(folder)) == (state.study, state)
    assert [each.name for each in study.observations] == ["print_1", "print_2", "print_3"]
    assert study.observations[2].seed_px == [20, 30]
    assert (study.poisson_ratio, study.uncertainty.load_relative_std) == (0.49, 0.02)
    assert study.scales["camera"].mm_per_px == 0.05
    assert study.curves[0].loading_radius_mm == 5.5
    text = (folder / STUDY_NAME).read_text()
    assert all(line in text for line in MANIFEST.splitlines())
    assert state.issues == ()


def test_removing_renaming_and_replacing(folder):
    changed(folder, ("observation", "print_1", None), ("finger", "left", {"name": "right"}))
    changed(folder, ("scale", "reader", {"name": "scanner"}))
    changed(folder, ("scale", "scanner", {"line": [[10, 20], [10, 220.5]], "length_mm": 10}))
    study = studied(folder)
    (left,) = study.observations
    assert (left.name, left.finger, left.scale) == ("print_2", "right", "scanner")
    assert study.scales["scanner"].line == [[10, 20], [10, 220.5]]
    assert "a.png" not in (folder / STUDY_NAME).read_text()


def test_a_finger_from_semi_axes_to_photographs(folder):
    changed(
        folder,
        ("finger", "left", dict.fromkeys(SEMI_AXES)),
        ("photograph", "left/a.png", {"face": "palmar", "scale": "reader"}),
        ("photograph", "left/b.png", {"face": "distal", "scale": "reader"}),
    )
    changed(folder, ("photograph", "left/b.png", {"tip": "left"}))
    one, other = studied(folder).fingers[0].photographs
    assert (one.face, one.file, one.tip) == ("palmar", "a.png", "up")
    assert (other.face, other.file, other.tip) == ("distal", "b.png", "left")
    changed(folder, ("photograph", "left/a.png", None))
    assert studied(folder).fingers[0].photographs == [other]


BAD = {
    "unknown finger": (("observation", "print_1", {"finger": "middle"}), "no finger is named 'middle'"),
    "no such file": (("observation", "print_1", {"file": "z.png"}), "no file 'z.png' in the study folder"),
    "out of the folder": (("observation", "print_1", {"file": "../a.png"}), "'../a.png'"),
    "negative load": (("observation", "print_1", {"load_N": -1}), "observations[0].load_N: expected"),
    "unknown key": (("observation", "print_1", {"laod_N": 1}), "did you mean 'load_N'"),
    "required key gone": (("observation", "print_1", {"load_N": None}), "load_N: required, but missing"),
    "name twice": (("observation", "print_1", {"name": "print_2"}), "'print_2' is taken"),
    "name that is a path": (("observation", "print_1", {"name": "../x"}), "letters, digits and"),
    "new finger of two words": (("finger", "left index", {}), "letters, digits and"),
    "new contact in a folder": (("observation", "a/b", {}), "letters, digits and"),
    "new sequence without a name": (("sequence", "", {}), "letters, digits and"),
    "new scale of a long name": (("scale", "x" * 61, {}), "letters, digits and"),
    "scale in use": (("scale", "reader", None), "no scale is named 'reader'"),
    "finger in use": (("finger", "left", None), "no finger is named 'left'"),
    "no such observation": (("observation", "p", None), "none of this name"),
    "photograph of no finger": (("photograph", "x/a.png", {"face": "palmar"}), "no finger is named 'x'"),
    "tables at the top": (("study", "", {"fingers": []}), "edits of its own"),
    "not for TOML": (("observation", "print_1", {"notes": {1, 2}}), "cannot be written as TOML"),
    "unknown kind": (("thing", "x", {}), "no part of a study"),
}


@pytest.mark.parametrize("case", BAD)
def test_a_wrong_edit_writes_nothing(folder, case):
    edit, words = BAD[case]
    before = contents(folder)
    with pytest.raises(ManifestError) as error:
        changed(folder, ("observation", "print_2", {"load_N": 9}), edit)
    assert words in str(error.value)
    assert ("cannot be written as TOML" in str(error.value)) == (case == "not for TOML")
    assert ".new" not in str(error.value)
    assert contents(folder) == before


def test_a_scale_does_not_take_the_name_of_another(folder):
    changed(folder, ("scale", "box", {"ppi": 1000}))
    with pytest.raises(ManifestError, match="scale reader: 'box' is taken"):
        changed(folder, ("scale", "reader", {"name": "box"}))
    assert {name: scale.ppi for name, scale in studied(folder).scales.items()} == {"reader": 500, "box": 1000}


def test_many_new_contacts_are_not_looked_up_among_one_another(folder, monkeypatch):
    looked, get = [], tomlkit.items.Table.__getitem__
    monkeypatch.setattr(tomlkit.items.Table, "__getitem__", lambda *one: looked.append(one) or get(*one))
    changed(folder, *(("observation", f"new_{number}", PRINT) for number in range(200)))
    assert len(studied(folder).observations) == 202
    assert len(looked) < 20 * 200


def test_names_removed_and_changed_among_others_are_free_again(folder):
    changed(
        folder,
        ("observation", "new", PRINT | {"load_N": 3}),
        ("observation", "new", {"load_N": 4}),
        ("observation", "print_1", None),
        ("observation", "print_2", {"name": "print_1"}),
        ("observation", "print_1", {"load_N": 5}),
        ("observation", "print_2", PRINT),
    )
    loads = {one.name: one.load_N for one in studied(folder).observations}
    assert loads == {"print_1": 5, "new": 4, "print_2": 2}


def test_a_study_grows_from_nothing(tmp_path):
    state = create_study(tmp_path, "  New one ")
    assert (state.study.title, state.tables) == ("New one", ())
    assert state.issues == ("study.toml: fingers: no finger yet: add one",)
    assert said(tmp_path)["study", ""] == "no finger yet: add one"
    template = load_study(write_template(tmp_path / "template")).study.uncertainty
    assert state.study.uncertainty.load_relative_std == template.load_relative_std > 0
    assert state.study.uncertainty.model_fields_set == {"load_relative_std"}
    state = changed(tmp_path, ("observation", "print_1", {"finger": "left"}))
    assert ("load_N", "required, but missing") in state.incomplete[0].faults
    changed(tmp_path, ("observation", "print_1", None))
    state = changed(tmp_path, ("finger", "left", {}))
    assert state.issues == ()  # contact areas need no semi-axes
    assert state.study == studied(tmp_path)
    lines = (tmp_path / STUDY_NAME).read_text().splitlines()
    assert lines[:2] == ["#:schema ./study.schema.json", 'title = "New one"']


def test_what_is_incomplete_does_not_stand_in_the_way(folder):
    state = changed(folder, ("observation", "print_3", {"file": "c.png", "scale": "reader"}))
    assert [one.key for one in state.incomplete] == ["print_3"]
    state = changed(folder, ("observation", "print_1", {"load_N": 7}))
    assert state.study.observations[0].load_N == 7
    kept = tomllib.loads((folder / STUDY_NAME).read_text())["observations"][2]
    assert kept == {"name": "print_3", "file": "c.png", "scale": "reader"}
    state = changed(folder, ("observation", "print_3", {"file": "z.png", **PRINT, "name": "PRINT_1"}))
    assert state.incomplete[0].faults == (
        ("name", "'PRINT_1' is taken; names must differ by more than case"),
    )
    state = changed(folder, ("observation", "PRINT_1", {"name": "print_4", "file": "z.png"}))
    assert state.incomplete[0].faults == (("file", "no file 'z.png' in the study folder"),)
    state = changed(folder, ("observation", "print_4", None))
    assert state.issues == ()


def test_a_curve_keeps_its_number_beside_one_that_is_incomplete(folder):
    given = {"finger": "left", "wedge_angle_deg": 30, "loading_radius_mm": 5.5}
    changed(folder, ("curve", "0", given), ("curve", "1", {"finger": "left"}), ("curve", "2", given))
    state = changed(folder, ("curve", "2", {"loading_radius_mm": 6.5}))
    assert [one.loading_radius_mm for one in state.study.curves] == [5.5, 6.5]
    state = changed(folder, ("curve", "0", None))
    curves = [one for one in state.tables if one.kind == "curve"]
    assert [(one.key, one.complete) for one in curves] == [("0", False), ("1", True)]


def test_what_was_wrong_by_hand_can_be_mended_in_steps(folder):
    text = MANIFEST.replace("load_N = 1.0", "load_N = -1").replace('title = "Ours"', "poisson_ratio = 7")
    (folder / STUDY_NAME).write_text(text)
    state = loaded(folder)
    assert [one.name for one in state.study.observations] == ["print_1"]
    places = [line.split(": ")[1] for line in state.issues]
    assert places == ["title", "poisson_ratio", "observations[1].load_N"]
    changed(folder, ("observation", "print_2", {"load_N": 1}))
    changed(folder, ("study", "", {"poisson_ratio": 0.5}))
    assert changed(folder, ("study", "", {"title": "Mended"})).issues == ()


def rename_until_done(folder, number):
    edit = Edit(kind="observation", key=f"print_{number}", set={"notes": "done"})
    with suppress(EditConflict):
        return change_study(folder, [edit], expected=loaded(folder).digest)
    return rename_until_done(folder, number)


def test_two_editors_at_once(folder):
    assert exit_codes(rename_until_done, (folder, 1), (folder, 2)) == [0, 0]
    assert [each.notes for each in studied(folder).observations] == ["done", "done"]
    before = contents(folder)
    with pytest.raises(EditConflict, match="changed the study since"):
        change_study(folder, [Edit(kind="study", key="", set={"title": "x"})], expected="that of before")
    assert contents(folder) == before


WITH_ROWS = MANIFEST.replace('title = "Ours"', 'observations_csv = "more.csv"\ntitle = "Ours"')


def with_rows(folder, *lines):
    """Let the study read rows of a spreadsheet, and return the path of the latter."""
    (folder / STUDY_NAME).write_text(WITH_ROWS)
    path = folder / "more.csv"
    path.write_text("\n".join([*lines, ""]))
    return path


def test_rows_of_a_spreadsheet_are_changed_there(folder):
    rows = ['row_1,left,30,1.5,a.png,500,"as, was"', "row_2,left,30,2,b.png,500,"]
    path = with_rows(folder, "name,finger,wedge_angle_deg,load_N,file,ppi,notes", *rows)
    changed(
        folder,
        ("observation", "row_2", {"load_N": 2.25, "scale": "reader", "seed_px": [4, 5.5], "notes": None}),
        ("finger", "left", {"name": "right"}),
    )
    lines = path.read_text().splitlines()
    assert lines[1].startswith('row_1,right,30,1.5,a.png,500,"as, was"')
    rows = {each.name: each for each in studied(folder).observations}
    assert (rows["row_2"].load_N, rows["row_2"].scale, rows["row_2"].seed_px) == (2.25, "reader", [4, 5.5])
    assert rows["row_1"].scale.ppi == 500
    before = contents(folder)
    with pytest.raises(ManifestError, match=r"more\.csv, line 3: load_N"):
        changed(folder, ("observation", "row_2", {"load_N": -1}))
    with pytest.raises(ManifestError, match="no column for scale.le"):
        changed(folder, ("observation", "row_2", {"scale": {"line": [[1, 1], [2, 2]], "length_mm": 2}}))
    assert contents(folder) == before
    changed(folder, ("observation", "row_2", None))
    assert "row_2" not in path.read_text()


def test_a_spreadsheet_that_was_missing_is_read_once_it_is_there(folder):
    (folder / STUDY_NAME).write_text(WITH_ROWS)
    before = loaded(folder)
    assert any("more.csv" in issue for issue in before.issues)
    with_rows(folder, "name,finger,wedge_angle_deg,load_N,file,ppi", "row_1,left,30,1.5,a.png,500")
    assert not is_as_read(before)
    assert is_as_read(loaded(folder))


@pytest.mark.parametrize("notes", ["=1+1", "'=1", "-1.5"])
def test_no_spreadsheet_evaluates_what_was_typed_into_its_rows(folder, notes):
    row = "row_{},left,30,1.5,-2.5,a.png,500,"
    header = "name,finger,wedge_angle_deg,load_N,roll_angle_deg,file,ppi,notes"
    path = with_rows(folder, header, row.format(1), row.format(2))
    changed(folder, ("observation", "row_1", {"notes": notes}))
    changed(folder, ("observation", "row_2", {"load_N": 2}))
    with path.open(newline="") as file:
        cells = [cell for line in csv.reader(file) for cell in line]
    assert [cell for cell in cells if cell.startswith(("=", "@", "-")) and cell not in {"-2.5", "-1.5"}] == []
    rows = {each.name: each for each in studied(folder).observations}
    assert (rows["row_1"].notes, rows["row_1"].roll_angle_deg, rows["row_2"].load_N) == (notes, -2.5, 2)


def test_names_of_corrected_sequences_fingers_and_rows_of_a_spreadsheet_stay(folder):
    (folder / "frames").mkdir()
    (folder / "frames" / "1.png").write_bytes(b"a frame")
    (folder / "force.csv").write_text("time_s,force_N\n0,0\n1,1\n")
    rows = (f"{name},left,30,1,a.png,500" for name in ("row_1", "row_2"))
    with_rows(folder, "name,finger,wedge_angle_deg,load_N,file,ppi", *rows)
    scale = {"scale": "reader"}
    faces = [
        {"face": face, "file": file, **scale} for face, file in (("palmar", "c.png"), ("distal", "b.png"))
    ]
    append_tables(
        folder,
        *(finger(name, photographs=faces) for name in ("right", "rig")),
        *(sequence(name, "frames", finger="left", force="force.csv", **scale) for name in ("press", "pres")),
    )
    for item in ("press#3", "right/c.png", "row_1"):
        correct(folder, item, {"accepted": True})
    for kind, corrected, other in (
        ("sequence", "press", "pres"),
        ("finger", "right", "rig"),
        ("observation", "row_1", "row_2"),
    ):
        with pytest.raises(ManifestError, match="has corrections"):
            changed(folder, (kind, corrected, {"name": "new"}))
        changed(folder, (kind, other, {"name": f"new_{kind}"}))
    study = studied(folder)
    assert [each.name for each in study.sequences] == ["press", "new_sequence"]
    assert [each.name for each in study.fingers] == ["left", "right", "new_finger"]
    assert {"row_1", "new_observation"} <= {each.name for each in study.observations}


@pytest.fixture
def with_sheet(folder):
    """A study with a spreadsheet in a folder of its own, and an incomplete table."""
    (folder / STUDY_NAME).write_text(WITH_ROWS.replace("more.csv", "tables/more.csv"))
    (folder / "tables").mkdir()
    header = "name,finger,wedge_angle_deg,load_N,file,ppi"
    (folder / "tables/more.csv").write_text(f"{header}\nrow_1,left,30,1.5,a.png,500\n")
    changed(folder, ("observation", "print_3", {"finger": "left", "file": "c.png"}))
    return folder


DOCUMENTS = (STUDY_NAME, "tables/more.csv")
LARGE_EDIT = (
    ("observation", "print_3", {"wedge_angle_deg": 30, "load_N": 3, "scale": "reader"}),
    ("observation", "row_1", {"notes": "seen"}),
)


def documents(folder):
    return {name: (folder / name).read_bytes() if (folder / name).exists() else None for name in DOCUMENTS}


def killed_at(step, folder):
    """Edit a study in a process that is killed before it touches files for the `step`-th time."""

    def work():
        left = step

        def before(event, arguments):
            nonlocal left
            if event in {"open", "os.rename", "os.remove"} and str(folder) in os.fsdecode(arguments[0]):
                left -= 1
                if left == 0:
                    os.kill(os.getpid(), signal.SIGKILL)

        sys.addaudithook(before)
        changed(folder, *LARGE_EDIT)

    return exit_codes(work, ()) == [-signal.SIGKILL]


def test_killed_at_any_step_an_edit_is_done_or_not(with_sheet, tmp_path_factory):
    def copied():
        target = tmp_path_factory.mktemp("copy") / "study"
        return shutil.copytree(with_sheet, target)

    done = copied()
    changed(done, *LARGE_EDIT)
    states = [documents(with_sheet), documents(done)]
    assert sum(states[0][name] != states[1][name] for name in DOCUMENTS) > 1
    found, step = [], 1
    while killed_at(step, folder := copied()):
        loaded(folder)
        found.append(states.index(documents(folder)))
        assert not (folder / JOURNAL_NAME).exists()
        step += 1
    assert set(found) == {0, 1}
    assert found == sorted(found)


def test_no_study_and_two_studies(tmp_path, folder):
    new = tmp_path / "new"
    for where, title, words in ((folder, "x", "there is a study already"), (new, " ", "needs a title")):
        with pytest.raises(ManifestError, match=words):
            create_study(where, title)
    with pytest.raises(ManifestError, match="no such file"):
        loaded(new)


def test_damage_by_hand_is_told(folder):
    for text, words in (("title = ", "not valid TOML"), ("fingers = 3", "fingers: expected a list")):
        (folder / STUDY_NAME).write_text(text)
        with pytest.raises(ManifestError, match=rf"study\.toml: {words}"):
            loaded(folder)


def said(folder):
    return {(one.kind, one.key): one.words for one in missing(loaded(folder))}


def test_what_is_missing_is_said(folder):
    words = said(folder)
    assert words == {("file", "c.png"): words["file", "c.png"]}
    no_axes = ("finger", "left", dict.fromkeys(SEMI_AXES)), ("observation", "print_2", None)
    changed(folder, *no_axes, ("observation", "print_1", None))
    assert said(folder)["finger", "left"].startswith("for more than contact areas, give its semi-axes")
    changed(folder, ("photograph", "left/a.png", {"scale": "reader"}))
    assert said(folder)["photograph", "left/a.png"] == "a.png: which face it shows is missing"
    changed(folder, ("photograph", "left/a.png", {"face": "palmar", "scale": None}))
    assert said(folder)["photograph", "left/a.png"] == "a.png: its scale is missing"
    assert "scale" in {one.place for one in missing(loaded(folder))}
    changed(folder, ("photograph", "left/a.png", {"face": "palmar", "scale": "reader"}))
    words = said(folder)
    assert "palmar semi-axis: add one of the distal or radial or ulnar face" in words["finger", "left"]
    assert "no contact yet" in words["study", ""]
    assert set(words) == {("finger", "left"), ("study", ""), ("file", "b.png"), ("file", "c.png")}
    print_1 = {"finger": "left", "file": "c.png", "scale": "reader", "wedge_angle_deg": 30}
    distal = {"face": "distal", "scale": "reader"}
    changed(folder, ("photograph", "left/b.png", distal), ("observation", "p", print_1))
    assert said(folder) == {("observation", "p"): "the load is missing"}
    changed(folder, ("observation", "p", {"load_N": 1}))
    assert said(folder) == {}


def test_many_loose_files_beside_many_in_use_are_listed_at_once(tmp_path, monkeypatch):
    for number in range(1500):
        (tmp_path / f"new_{number}_1N.png").touch()

    def seconds(in_use):
        names = {f"old_{number}.png" for number in range(in_use)}
        monkeypatch.setattr(LoadedStudy, "files", lambda _: names)
        began = time.process_time()
        assert len(list(unused_files(LoadedStudy.empty(tmp_path)))) == 1500
        return time.process_time() - began

    few, many = seconds(3_000), seconds(100_000)
    assert many < 20 * few  # to look through all for each would take seventy times as long


def test_sequences_and_results_are_no_loose_pictures(folder):
    (folder / "press").mkdir()
    for number in range(30):
        (folder / "press" / f"{number}.png").write_bytes(b"a frame")
    (folder / "out" / "overlays").mkdir(parents=True)
    (folder / "out" / "store.sqlite").write_bytes(b"")
    (folder / "out" / "overlays" / "print_1.png").write_bytes(b"drawn")
    words = said(folder)
    assert words.pop(("folder", "press")).startswith("30 pictures")
    assert set(words) == {("file", "c.png")}


# Files changed as one: nothing is changed where one of them cannot be, and a journal leads nowhere else


def test_files_are_replaced_and_made(folder):
    before = contents(folder)
    replace_files(folder, {"a.png": "new", "d": "\u00e9\r\n"})
    assert contents(folder) == before | {"a.png": b"new", "d": b"\xc3\xa9\r\n"}


def replace_on_a_full_disk(folder):
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100, -1))
    with pytest.raises(OSError, match="large") as error:
        replace_files(folder, {"a.png": "new", "c.png": "new" * 100})
    assert error.value.errno == errno.EFBIG


def test_where_one_does_not_fit_on_the_disk_nothing_is_changed(folder):
    before = contents(folder)
    assert exit_codes(replace_on_a_full_disk, (folder,)) == [0]
    assert contents(folder) == before


def failing_with(number):
    def fail(*_, **__):
        raise OSError(number, os.strerror(number))

    return fail


def test_where_a_study_cannot_be_changed_it_is_said_why(folder, monkeypatch):
    seen, edits = loaded(folder), [Edit(kind="study", key="", set={"title": "Theirs"})]

    def change():
        return change_study(folder, edits, expected=seen.digest, before=seen)

    with monkeypatch.context() as patch, FileLock(folder / LOCK_NAME):
        patch.setattr(journal, "_WAIT_S", 0.01)
        with pytest.raises(StoreError, match=f"^{folder}: another process has been writing"):
            change()
    with monkeypatch.context() as patch:
        patch.setattr(FileLock, "acquire", failing_with(errno.EACCES))
        with pytest.raises(StoreError, match=f"^{folder}: cannot be written .* get the right to write"):
            change()
    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", failing_with(errno.ENOSPC))
        with pytest.raises(StoreError, match="No space left on device.: make room and try again"):
            change()
    assert studied(folder).title == "Ours"


def test_a_spreadsheet_that_cannot_be_read_is_not_called_unwritable(folder, monkeypatch):
    (folder / "study.toml").write_text('observations_csv = "rows.csv"\n' + MANIFEST)
    (folder / "rows.csv").write_text(
        "name,finger,wedge_angle_deg,load_N,file,scale\nr,left,30,1,a.png,reader\n"
    )
    seen = loaded(folder)
    read = Path.read_bytes
    monkeypatch.setattr(
        Path, "read_bytes", lambda path: failing_with(errno.EIO)() if path.name == "rows.csv" else read(path)
    )
    with pytest.raises(ManifestError, match=r"^rows\.csv: cannot be read \(Input/output error\)"):
        change_study(folder, [], expected=seen.digest, before=seen)


def test_a_zip_without_room_is_not_taken_for_a_study_that_cannot_be_written(folder, tmp_path, monkeypatch):
    monkeypatch.setattr(zipfile.ZipFile, "write", failing_with(errno.ENOSPC))
    with pytest.raises(OSError, match="No space left"):  # of the ZIP: the page says where to make room
        pack(folder, Bundle(folder, folder / "results", ()), tmp_path / "study.zip")


@pytest.mark.parametrize(
    "content",
    [
        *("no JSON", "[]", '{"replace": [3]}', '{"replace": [], "remove": ["a"]}'),
        *('{"replace": ["../outside"]}', '{"replace": ["link/outside"]}', '{"replace": ["/"]}'),
    ],
)
def test_a_journal_that_is_damaged_or_leads_out_is_refused(tmp_path, content):
    (tmp_path / "outside").write_text("kept")
    (tmp_path / ".outside.new").write_text("would replace it")
    study = tmp_path / "study"
    study.mkdir()
    (study / "link").symlink_to(tmp_path)
    (study / JOURNAL_NAME).write_text(content)
    with pytest.raises(ManifestError, match=r"is no journal of a change.*remove it"):
        recover(study)
    assert (tmp_path / "outside").read_text() == "kept"


# An edit parses what it looks at, and writes what it would write had it parsed the whole manifest


HEAD = """\
# Whose study this is.
title = "Ours"
notes_of_ours = "[[observations]]"

[scales.reader]
ppi = 500        # on the box
[scales."camera"]
mm_per_px = 0.1
"""
FINGERS = """
[[fingers]]  # the first
name = "left"
semi_axes_mm = { palmar = 7.9, distal = 13.8, radial_ulnar = 11.8 }

  [[fingers]]
  name = "right"
  [[fingers.photographs]]
  face = "palmar"
  file = "a.png"
  scale = "camera"
  [[fingers.photographs]]
  face = "distal"
  file = "b.png"
  scale = "reader"
[[fingers]]
name = "middle"
photographs = [
  { face = "palmar", file = "a.png", scale = "camera" },
]
# The end of the fingers.
"""
CURVES = """
[[curves]]
finger = "left"
wedge_angle_deg = 30
loading_radius_mm = 9
[[curves]]
finger = "right"
wedge_angle_deg = 45
loading_radius_mm = 8
"""


def observation(name, more=""):
    return f"""
[[observations]]
name = "{name}"
finger = "left"
wedge_angle_deg = 30
load_N = 2.0     # from the balance
file = "a.png"
scale = "reader"
{more}"""


ALIKE = "".join(observation(f"p{number}") for number in range(5))
HEADERS_IN_TEXT = observation("p0", 'notes = """\n[[observations]]\nname = "p1"\n"""\n')
LISTS_OF_LISTS = observation("p1", "region_of_interest_px = [\n[0],\n[1]\n]\n")
SUBTABLES = "".join(observation(f"p{k}", "[observations.ellipse_mm]\nsemi_major = 7\n") for k in range(3))
MANIFESTS = {
    "no_last_line_break": (HEAD + FINGERS + CURVES + ALIKE).rstrip(),
    "headers_in_text": HEAD + FINGERS + HEADERS_IN_TEXT + observation("p1") + observation("p2") + CURVES,
    "lists_of_lists": HEAD + FINGERS + observation("p0") + LISTS_OF_LISTS + observation("p2") + CURVES,
    "subtables": HEAD + SUBTABLES + FINGERS + CURVES,
    "mixed": HEAD + observation("p0") + FINGERS + observation("p1") + observation("p2") + CURVES,
    "odd_headers": HEAD + FINGERS + ALIKE.replace("[[o", '[["o').replace("ns]]", 'ns"]]'),
    "no_names": HEAD + FINGERS + ALIKE.replace('"p1"', "1").replace('"p2"', '["p2"]') + CURVES,
    "empty_tables": HEAD + "[[observations]]\n[[observations]]\n[[fingers]]\n" + ALIKE,
    "marked": HEAD + "# left out: 0\n" + FINGERS + ALIKE,
    "empty": "",
}
# Of manifests that differ only in what stands elsewhere, these tell all.
TELLING = [("change",), ("rename", "add"), ("change_finger", "remove", "change_curve")]
EDITS = {
    "change": Edit(kind="observation", key="p1", set={"load_N": 3, "notes": "a\n# left out: 0\n"}),
    "add": Edit(kind="observation", key="new", set={"load_N": 3}),
    "remove": Edit(kind="observation", key="p2", set=None),
    "rename": Edit(kind="observation", key="p0", set={"name": "p9"}),
    "change_finger": Edit(kind="finger", key="right", set={"sex": "f"}),
    "remove_finger": Edit(kind="finger", key="middle", set=None),
    "add_photograph": Edit(kind="photograph", key="right/c.png", set={"face": "radial"}),
    "add_inline_photograph": Edit(kind="photograph", key="middle/c.png", set={"face": "radial"}),
    "remove_photograph": Edit(kind="photograph", key="right/b.png", set=None),
    "rename_scale": Edit(kind="scale", key="reader", set={"name": "box"}),
    "title": Edit(kind="study", key="", set={"title": "Others"}),
    "change_curve": Edit(kind="curve", key="1", set={"loading_radius_mm": 7}),
}


def after(folder, edits):
    """Return what the manifest says after some edits, or what is said of them."""
    try:
        change_study(folder, edits, expected=load_study(folder / STUDY_NAME).digest)
    except FingerpadError as error:
        return str(error)
    return (folder / STUDY_NAME).read_bytes()


@pytest.mark.parametrize("manifest", MANIFESTS)
def test_an_edit_writes_what_it_would_write_had_all_been_parsed(tmp_path, monkeypatch, manifest):
    monkeypatch.setattr(edit, "_require_as_complete", lambda *_: None)  # any text will do
    monkeypatch.setattr(os, "fsync", lambda _: None)
    for edits in [*((one,) for one in EDITS if manifest == "mixed"), *TELLING]:
        found = []
        for names in (edit.tables_of, lambda _: None):
            (tmp_path / STUDY_NAME).write_text(MANIFESTS[manifest])
            with monkeypatch.context() as patch:
                patch.setattr(edit, "tables_of", names)
                found.append(after(tmp_path, [EDITS[name] for name in edits]))
        assert found[0] == found[1], edits


@pytest.mark.parametrize("manifest", MANIFESTS.values(), ids=MANIFESTS)
@pytest.mark.parametrize("kept", [(), ("p1",), ("left", "p0")])
def test_what_is_left_out_is_put_back(manifest, kept):
    text, left_out = folded(manifest, kept)
    assert unfolded(tomlkit.dumps(tomlkit.parse(text)), left_out) == tomlkit.dumps(tomlkit.parse(manifest))


def test_an_edit_of_a_large_manifest_parses_little_of_it(tmp_path, monkeypatch):
    text = HEAD + FINGERS + "".join(observation(f"p{number}") for number in range(200)) + CURVES
    (tmp_path / STUDY_NAME).write_text(text)
    (tmp_path / "a.png").touch()
    parse, parsed = tomlkit.parse, []

    def counted(some):
        parsed.append(some.count("[[observations]]\n"))
        return parse(some)

    monkeypatch.setattr(tomlkit, "parse", counted)
    edits = [EDITS["change"], EDITS["add"]]
    change_study(tmp_path, edits, expected=load_study(tmp_path / STUDY_NAME).digest)
    assert (tmp_path / STUDY_NAME).read_text().count("[[observations]]\n") == 201
    assert sum(parsed) <= 5
