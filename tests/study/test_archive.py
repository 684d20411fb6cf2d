"""A study as a ZIP, and back."""

import json
import os
import shutil
import sqlite3
import zipfile
from contextlib import closing
from itertools import cycle
from pathlib import Path

import pytest
import tomlkit
from tests.studies import finger

from fingerpad.exceptions import ManifestError
from fingerpad.study.engine.store import STORE_NAME, Store
from fingerpad.study.manifest.load import load_study, read_study
from fingerpad.study.share import Bundle, pack, unpack

ROOM = 10**9
HEAD = {"title": "T", "fingers": [finger().keys]}
OBSERVATION = {"finger": "f", "wedge_angle_deg": 30, "load_N": 1, "scale": {"ppi": 500}}
RECORD = {"id": 1, "item": "x", "when": "", "who": "ada", "action": "change", "change": {}, "picture": ""}
ODD_NAMES = (
    "a:b.png", "C:evil.png", "up\\..\\x.png", "tail.", "tail ", "CON", "nul.png", "Com1.tif",
    "LEFT_OUT.txt", "Left_Out.TXT", "fingerpad-bundle", "Study.TOML", "study.toml.", "a.png", "A.png",
    "\xe9.png", "e\u0301.png", "ß", "SS", "ss", "tab\there", "line\nbreak", "\x7f", "?*<>|", "=1+1", "-x",
    "~", "%41", "x" * 250, "store.lock", "results",
)  # fmt: skip
WAYS = ("used", "unused", "linked", "hidden")
DATES = (0.0, 1.0, 315_532_799.0, 1e9, 4_354_819_200.0, 1e10, -1e9, float(2**33))


ODD_FILES = {name: (name.encode(), 0.0) for name in ODD_NAMES if name != "results"}


def write(folder, files, folders, ways):
    """Write a study; return the names of the files that its manifest names."""
    used = []
    (folder / ".data").mkdir(parents=True)
    for number, (name, (content, date)) in enumerate(files.items()):
        here = f".data/{number}" if ways[name] == "linked" else name
        if ways[name] == "hidden":
            name = here = f".hidden/{name}"  # noqa: PLW2901
        try:
            (folder / here).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            with (folder / here).open("xb") as file:
                file.write(content)
            os.utime(folder / here, (date, date))
            if here != name:
                (folder / name).symlink_to(folder / here)
        except (FileExistsError, NotADirectoryError, IsADirectoryError):
            continue  # a folder is of this name
        if number % 4 and ways[name.removeprefix(".hidden/")] != "unused":
            used.append(name)
    for name in folders:
        try:
            (folder / name).mkdir(parents=True, exist_ok=True)
        except (FileExistsError, NotADirectoryError):
            continue
    observations = [{"name": f"o{k}", "file": name, **OBSERVATION} for k, name in enumerate(used)]
    (folder / "study.toml").write_text(tomlkit.dumps({**HEAD, "observations": observations}))
    (folder / "corrections.jsonl").write_text(json.dumps(RECORD) + "\n")
    (folder / "results/figures").mkdir(parents=True, exist_ok=True)
    (folder / "results/results.csv").write_text("observation\n")
    (folder / "results/figures/a b.svg").write_text("<svg/>")
    return used


def round_trip(folder, out=None):
    """Export a study and import it again; return what was exported, and the new folder."""
    found = Bundle(folder, out or folder / "results", load_study(folder / "study.toml").files())
    target, other = folder.parent / "study.zip", folder.parent / "other"
    pack(folder, found, target)
    unpack(target, other, ROOM)
    return found, other


def contents(folder, *, hidden=False):
    """Every file below a folder by its name, through links, and every folder."""
    found = {}
    for here, folders, files in os.walk(folder):
        folders[:] = [name for name in folders if hidden or name[0] != "."]
        path = Path(here)
        found |= {(path / name).relative_to(folder).as_posix(): None for name in folders}
        found |= {
            (path / name).relative_to(folder).as_posix(): (path / name).read_bytes()
            for name in files
            if hidden or name[0] != "."
        }
    return found


@pytest.mark.parametrize("turn", range(len(WAYS)))
def test_an_exported_study_is_imported_unchanged(tmp_path, turn):
    """Files of odd names, each used, unused, linked and hidden in turn, and one that shrinks a lot."""
    folder = tmp_path / "study"
    names = [*ODD_FILES, *(f"{place}/x{place}" for place in ("é", "É", "nul", "sub"))]
    files = {name: (name.encode(), date) for name, date in zip(names, cycle(DATES), strict=False)}
    files["blank.pgm"] = bytes(3_000_000), 0.0
    ways = {name: WAYS[(turn + number) % len(WAYS)] for number, name in enumerate(files)}
    used = write(folder, files, {"e:", "E", "empty/é"}, ways)
    found, other = round_trip(folder)
    reasons = ("a name that not every system can have", "another differs from it by case or accents")
    left = {one.file.rstrip("/") for one in found.left_out if one.why.startswith(reasons)}
    assert contents(other) == {name: one for name, one in contents(folder).items() if name not in left}
    for name in set(used) - left:
        assert (other / name).read_bytes() == (folder / name).read_bytes()
        assert not (other / name).is_symlink()
    assert not any((other / name).exists() for name in left)
    assert (other / "study.toml").read_bytes() == (folder / "study.toml").read_bytes()


def test_files_left_out_are_listed(tmp_path):
    folder = tmp_path / "study"
    write(folder, {"a.png": (b"a", 0.0), "b.png": (b"b", 0.0)}, set(), {"a.png": "unused", "b.png": "linked"})
    (tmp_path / "outside.png").write_bytes(b"secret")
    (folder / "out.png").symlink_to(tmp_path / "outside.png")
    (folder / "lost.png").symlink_to("nowhere.png")
    (folder / "self").symlink_to(folder)
    os.mkfifo(folder / "pipe")
    (folder / ".git").mkdir()
    (folder / ".hidden.png").write_bytes(b"x")
    found, other = round_trip(folder)
    assert {one.file: one.why.partition(":")[0] for one in found.left_out} == {
        ".data/": "hidden",
        ".git/": "hidden",
        ".hidden.png": "hidden",
        "lost.png": "a link that leads nowhere",
        "out.png": "a link that leaves the study folder",
        "pipe": "no file that can be copied",
        "self/": "a link to a folder",
    }
    with zipfile.ZipFile(tmp_path / "study.zip") as archive:
        listed = archive.read("LEFT_OUT.txt").decode()
        assert b"secret" not in b"".join(map(archive.read, archive.namelist()))
    for one in found.left_out:
        assert f"{one.file}: {one.why}" in listed
    assert (other / "b.png").read_bytes() == b"b"
    assert not (other / "LEFT_OUT.txt").exists()


def test_a_sequence_travels_with_its_frames_wherever_they_are(tmp_path):
    folder = tmp_path / "study"
    write(folder, {}, set(), {})
    (folder / ".data/frames").mkdir()
    for number in (1, 2):
        (folder / f".data/frames/f{number}.png").write_bytes(bytes([number]))
    (folder / "frames").symlink_to(".data/frames")
    (folder / "force.csv").write_text("time_s,force_N\n0,0\n")
    sequence = {"name": "p", "finger": "f", "wedge_angle_deg": 30, "file": "frames", "force": "force.csv"}
    text = tomlkit.dumps({**HEAD, "sequences": [{**sequence, "scale": {"ppi": 500}}]})
    (folder / "study.toml").write_text(text)
    found, other = round_trip(folder)
    assert [path.read_bytes() for path in sorted((other / "frames").iterdir())] == [b"\x01", b"\x02"]
    assert read_study(other / "study.toml").sequences[0].file == "frames"
    assert [one.file for one in found.left_out] == [".data/", "frames/"]


@pytest.mark.parametrize("place", ["around", "within"])
def test_results_travel_from_wherever_they_are(tmp_path, place):
    folder = tmp_path / "workspace/study"
    write(folder, {"a.png": (b"a", 0.0)}, set(), {"a.png": "used"})
    (tmp_path / "workspace/another study").mkdir()
    (tmp_path / "workspace/another study/x.png").write_bytes(b"x")
    out = tmp_path / "workspace" if place == "around" else folder / "deep/out"
    out.mkdir(exist_ok=True, parents=True)
    (out / "summary.json").write_text("{}")
    (out / "overlays").mkdir()
    (out / "overlays/o.png").write_bytes(b"o")
    found, other = round_trip(folder, out)
    assert set(contents(other)) - {"deep"} == {
        "study.toml", "corrections.jsonl", "a.png", "results", "results/summary.json", "results/overlays",
        "results/overlays/o.png",
    }  # fmt: skip
    assert "results/" in {one.file for one in found.left_out}  # those of an earlier run


@pytest.mark.parametrize("place", ["absolute", "up and down"])
def test_a_file_named_from_outside_the_study_is_refused(tmp_path, place):
    folder = tmp_path / "study"
    write(folder, {"a.png": (b"a", 0.0)}, set(), {"a.png": "unused"})
    name = {"absolute": str(folder / "a.png"), "up and down": ".data/../a.png"}[place]
    one = {**OBSERVATION, "name": "o", "file": name}
    (folder / "study.toml").write_text(tomlkit.dumps({**HEAD, "observations": [one]}))
    with pytest.raises(ManifestError, match=r"name the file from the study folder, without \.\."):
        read_study(folder / "study.toml")
    _, other = round_trip(folder)  # incomplete as it is, it travels
    assert (other / "a.png").read_bytes() == b"a"


def test_a_store_in_use_travels_whole_and_so_does_a_file_in_its_place(tmp_path):
    folder = tmp_path / "study"
    write(folder, {}, set(), {})
    shutil.rmtree(folder / "results")
    (folder / "results").write_text("notes")
    assert (round_trip(folder)[1] / "results").read_text() == "notes"
    shutil.rmtree(folder.parent / "other")
    (folder / "results").unlink()
    path = folder / "results" / STORE_NAME
    path.parent.mkdir(exist_ok=True)
    with Store.writing(path) as store:
        store.remember(Path("a.png"), "d")
        assert path.with_name(f"{STORE_NAME}-wal").stat().st_size
        _, other = round_trip(folder)
    with closing(sqlite3.connect(other / "results" / STORE_NAME)) as copy:
        assert copy.execute("SELECT path FROM input").fetchall() == [("a.png",)]
    assert not (other / "results" / f"{STORE_NAME}-wal").exists()
