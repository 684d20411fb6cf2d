"""The files of a run are put in place as one, and reading them detects files that do not belong."""

import json
import os
import shutil
import signal
import sqlite3
import subprocess
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from filelock import FileLock
from PIL import Image
from tests import command
from tests.studies import RESULT_TABLES, contact, correct, finger, run_watched, write_study
from tests.study.small_study import PICTURES, copy

from fingerpad.exceptions import FingerpadError, StoreError
from fingerpad.report import write_report
from fingerpad.simulate import render_finger
from fingerpad.study.engine.store import STORE_NAME, Store
from fingerpad.study.engine.task import TaskResult
from fingerpad.study.pipeline import run_study
from fingerpad.study.results.result_set import new_result_set, put_in_place, result_files, result_set_faults
from fingerpad.study.results.table import records


def make(folder: Path, rows: int = 3, *, title: str = "T", load: float = 1.0) -> Path:
    # Angles known so well that few random draws check the uncertainty.
    stated = {"wedge_angle_deg_std": 0.3}
    contacts = (contact(f"o{k}", load, axis="") for k in range(rows))
    return write_study(folder, finger(), *contacts, title=title, uncertainty=stated)


@pytest.fixture(scope="module")
def made(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("study")
    run_study(make(folder), folder / "out")
    return folder


@pytest.fixture
def study(made, tmp_path) -> Path:
    return Path(shutil.copytree(made, tmp_path / "study"))


def contents(out: Path) -> dict[str, bytes]:
    return {name: (out / name).read_bytes() for name in (*result_files(out), "SHA256SUMS")}


def test_the_list_is_one_that_sha256sum_checks(study):
    done = subprocess.run(
        ["sha256sum", "--check", "--strict", "SHA256SUMS"], cwd=study / "out", capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert set(result_files(study / "out")) >= set(RESULT_TABLES)


def test_what_goes_wrong_while_results_are_written_leaves_the_old_ones(study):
    before = contents(study / "out")
    make(study, rows=5)

    def fail(*_: object) -> None:
        raise FingerpadError("no paper")

    with pytest.raises(FingerpadError, match="no paper"):
        run_study(study / "study.toml", study / "out", write_report=fail)
    assert contents(study / "out") == before
    assert result_set_faults(study / "out") == []


NEW = {
    **dict.fromkeys(RESULT_TABLES, b"new"),
    "report.html": b"new",
    "figures/a.svg": b"new",
    "figures/b.svg": b"new",
    "overlays/o1.png": b"drawn",
}
STEPS = ("fsync", "link", "mkdir", "rename", "replace", "rmdir", "unlink")


def put(out: Path, files: dict[str, bytes]) -> None:
    """Put a result set in place; its overlays were drawn before."""
    with Store.writing(out / STORE_NAME) as store:
        put_in_place(store)
        drawn = {name: content for name, content in files.items() if name.startswith("overlays")}
        store.put("o", "key", TaskResult({}, drawn, 0.0), count=1)
        with new_result_set(store) as new:
            for name, content in files.items():
                if name in drawn:
                    digest = store.statuses()["o"].drawn[name]
                    new.add(name, store.drawn_file(name, digest), digest)
                else:
                    (new.folder / name).parent.mkdir(exist_ok=True)
                    (new.folder / name).write_bytes(content)


def put_and_die(out: Path, step: int) -> int:
    """Put a result set in place in a copy of this process, kill it at a step, and return the signal."""
    pid = os.fork()
    if pid:
        return os.waitpid(pid, 0)[1]
    calls = 0

    def counted(function: Callable[..., object]) -> Callable[..., object]:
        def call(*args: Any, **options: Any) -> object:
            nonlocal calls
            calls += 1
            if calls == step:
                os.kill(os.getpid(), signal.SIGKILL)
            return function(*args, **options)

        return call

    try:
        for name in STEPS:
            setattr(os, name, counted(getattr(os, name)))
        put(out, NEW)
    finally:
        os._exit(0)


def test_a_kill_at_any_step_leaves_the_old_results_or_the_new_ones(study, tmp_path):
    """Old and new, whole or named as unfinished; what comes next ends as if nothing had happened."""
    out = study / "out"
    put(out, {**dict.fromkeys(RESULT_TABLES, b"old"), "report.html": b"old", "figures/old.svg": b"old"})
    before = contents(out)
    outcomes = set()
    step = 1
    while True:
        copy = Path(shutil.copytree(out, tmp_path / f"killed_{step}"))
        if put_and_die(copy, step) != signal.SIGKILL:
            break
        faults = result_set_faults(copy)
        if faults:
            assert "put its results in place" in faults[0]
            outcomes.add("between")
        else:
            found = contents(copy)
            outcomes.add("old" if found == before else "new")
            assert found == before or {name: found[name] for name in NEW} == NEW
        put(copy, NEW)
        assert result_set_faults(copy) == []
        assert {name: content for name, content in contents(copy).items() if name in NEW} == NEW
        assert not [path for path in copy.iterdir() if path.name.startswith((".results", ".drawn"))]
        shutil.rmtree(copy)
        step += 1
    assert outcomes == {"old", "between", "new"}
    assert step > 15


def test_files_that_the_new_results_lack_are_removed_and_others_are_not(study):
    out = study / "out"
    put(out, NEW)
    (out / "figures" / "mine.svg").write_text("mine")
    (out / "notes.txt").write_text("mine")
    run_study(study / "study.toml", out)
    assert not (out / "report.html").exists()
    assert not (out / "overlays" / "o1.png").exists()
    assert [path.name for path in (out / "figures").iterdir()] == ["mine.svg"]
    assert (out / "notes.txt").read_text() == "mine"


def lose_a_row(path: Path, _: Path) -> None:
    path.write_bytes(b"\n".join(path.read_bytes().splitlines()[:-1]) + b"\n")


def replace_by_that_of_another_run(path: Path, other: Path) -> None:
    run_study(make(other, load=2.0), other / "out")
    shutil.copy(other / "out" / path.name, path)


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("results.csv", lose_a_row),
        ("summary.json", replace_by_that_of_another_run),
        ("results.csv", lambda path, _: path.unlink()),
    ],
)
def test_who_reads_results_names_the_file_that_does_not_belong(study, name, change):
    out, table = study / "out", study / "r.mat"
    change(out / name, study / "other")
    status = ("status", study, "--out", out)
    for words in (("export", out, table), ("compare", out), status, (*status, "--json")):
        code, said, error = command.run(*words)
        assert code in {2, 3}, words
        assert f"{name}: is" in said + error, words
    assert not table.exists()
    run_study(study / "study.toml", out)
    assert command.run("compare", out)[0] == 0


def test_what_came_from_elsewhere_leads_out_of_no_folder(study):
    out, outside = study / "out", study / "outside.txt"
    outside.write_text("precious")
    (out / "SHA256SUMS").write_text(f"{'0' * 64}  ../outside.txt\n")
    run_study(study / "study.toml", out)
    assert outside.read_text() == "precious"
    with Store.reading(out / STORE_NAME) as store:
        assert store.drawn_file("../outside.txt", store.digest(outside)) is None


@pytest.mark.parametrize("damage", [b"", b"x", b"\xff\xfe"])
def test_a_damaged_list_is_named(study, damage):
    path = study / "out" / "SHA256SUMS"
    path.write_bytes(path.read_bytes()[:-30] + damage)
    assert result_set_faults(study / "out")[0].startswith("SHA256SUMS: is damaged")


def test_results_without_a_list_are_no_results(study):
    (study / "out" / "SHA256SUMS").unlink()
    code, _, error = command.run("export", study / "out", study / "r.mat")
    assert code == 2
    assert "results.csv: is there without SHA256SUMS" in error


def test_the_lock_holds_until_the_results_are_in_place(study):
    """Of two runs on one folder one is refused, whatever the other is at."""
    seen: list[str] = []

    def report(*_: object) -> None:
        with pytest.raises(StoreError, match="another run writes here"):
            run_study(study / "study.toml", study / "out")
        seen.append("refused")

    run_study(study / "study.toml", study / "out", write_report=report)
    assert seen == ["refused"]
    with FileLock(study / "out" / "store.lock", timeout=0):
        pass


@pytest.mark.usefixtures("small_pieces")
def test_a_changed_picture_of_the_results_is_drawn_again(finished):
    out = finished.parent / "out"
    good = (out / "overlays" / "o1.png").read_bytes()
    (out / "overlays" / "o1.png").write_bytes(good[:100])
    assert run_watched(finished)[1] == ["o1"]
    assert (out / "overlays" / "o1.png").read_bytes() == good
    assert len([name for name in result_files(out) if name.startswith("overlays/o")]) == PICTURES
    assert not os.path.lexists(out / ".drawn")


def test_files_of_the_results_never_share_a_name(small_study, tmp_path):
    """Photographs whose names differ in what no file name holds, and names of 60 letters of four bytes."""
    manifest = copy(small_study, tmp_path / "study")
    long = "指" * 60
    (tmp_path / "study" / "x").mkdir()
    for name, source in (("x/a.jpg", "palmar.jpg"), ("x_a.jpg", "distal.jpg")):
        shutil.copy(tmp_path / "study" / source, tmp_path / "study" / name)
    text = manifest.read_text()
    for old, new in {
        '"palmar.jpg"': '"x/a.jpg"',
        '"distal.jpg"': '"x_a.jpg"',
        'name = "g"': f'name = "{long}"',
        'name = "p"': f'name = "{long}"',
        'name = "o1"\nfinger = "f"': f'name = "finger_{long[:20]}_palmar_1"\nfinger = "{long}"',
    }.items():
        text = text.replace(old, new)
    manifest.write_text(text)
    result = run_study(manifest, tmp_path / "out", write_report=write_report)
    assert result.failures == []
    shown = [row["overlay"] for row in records(result.rows) if row["overlay"]]
    shown += [one.overlay for finger in result.fingers.values() for one in finger.photographs]
    shown += [one.file for sequence in result.sequences for one in sequence.overlays]
    assert len(set(shown)) == len(shown) >= PICTURES + 2 + 3
    assert set(shown) <= set(result_files(tmp_path / "out"))


def test_each_photograph_keeps_an_overlay_of_its_own(small_study, tmp_path):
    """Whatever its place in the list; what a second run draws changes no file of the first."""
    shutil.copy(small_study.parent / "distal.jpg", tmp_path)
    for number, name in enumerate(("a.png", "b.png", "c.png")):
        Image.fromarray(render_finger("palmar", mm_per_px=0.1, seed=number).pixels).save(tmp_path / name)
    out = tmp_path / "out"

    def run(first: str, last: str) -> tuple[dict[str, str], list[str]]:
        """Run the study of these palmar photographs; return each one's overlay, and what was measured."""
        shown = {"scale": {"mm_per_px": 0.1}, "synthetic": True}
        files = ("palmar", first), ("distal", "distal.jpg"), ("palmar", last)
        photographs = [{"face": face, "file": file, **shown} for face, file in files]
        manifest = write_study(tmp_path, finger(photographs=photographs, synthetic=True))
        result, measured = run_watched(manifest)
        return {str(one.manifest.file): one.overlay for one in result.fingers["f"].photographs}, measured

    first, _ = run("a.png", "b.png")
    shown = {name: (out / overlay).read_bytes() for name, overlay in first.items()}
    os.link(out / first["b.png"], tmp_path / "kept.png")  # as a copy of the results made of links
    second, measured = run("b.png", "c.png")
    assert measured == ["f/c.png"]
    assert (out / second["b.png"]).read_bytes() == shown["b.png"] == (tmp_path / "kept.png").read_bytes()
    assert (out / second["c.png"]).read_bytes() != shown["b.png"]
    assert run("b.png", "c.png")[1] == []
    assert result_set_faults(out) == []


# `fingerpad verify` names everything that is not what was written, and nothing else


@pytest.fixture
def corrected(finished, small_pieces) -> Path:
    """Return the folder of the small study, run with a correction."""
    correct(finished.parent, "o1", {"accepted": True})
    run_study(finished, finished.parent / "out")
    return finished.parent


def verify(folder: Path) -> tuple[int, dict]:
    code, out, _ = command.run("verify", folder, "--out", folder / "out", "--json")
    return code, json.loads(out)


def test_a_finished_study_is_intact_also_where_inputs_changed_or_it_was_never_run(corrected):
    code, found = verify(corrected)
    assert (code, found["faults"], found["changed_inputs"]) == (0, [], [])
    assert found["intact"].keys() == {"study.toml", "corrections.jsonl", "store.sqlite", "results"}
    words = command.run("verify", corrected, "--out", corrected / "out")[1]
    assert words.startswith("intact   study.toml: 2 fingers, 6 contacts")
    (corrected / "o1.png").write_bytes((corrected / "o2.png").read_bytes())
    code, found = verify(corrected)
    assert (code, found["changed_inputs"]) == (0, ["o1.png"])
    shutil.rmtree(corrected / "out")
    code, found = verify(corrected)
    assert (code, found["intact"].keys()) == (0, {"study.toml", "corrections.jsonl"})


def flip(path: Path) -> None:
    """Flip a bit that every format minds, and give the file the times that it had."""
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


def spoil_record(path: Path) -> None:
    with closing(sqlite3.connect(path)) as connection, connection:
        connection.execute("UPDATE result SET seconds = seconds + 1 WHERE task = 'o3'")


FAULTS: dict[str, tuple[str, Callable[[Path], object], str]] = {
    "a table": ("out/results.csv", flip, "results.csv: is not the file"),
    "an overlay": ("out/overlays/o2.png", flip, "overlays/o2.png: is not the file"),
    "a lost overlay": ("out/overlays/o2.png", Path.unlink, "overlays/o2.png: is missing"),
    "a stored result": ("out/store.sqlite", spoil_record, "the stored result of o3 is damaged"),
    "the list": ("out/SHA256SUMS", flip, ""),
    "a correction": ("corrections.jsonl", flip, "corrections.jsonl: line 1"),
    "the manifest": ("study.toml", lambda path: path.write_text("title = 1"), "study.toml: title"),
}


@pytest.mark.parametrize(("name", "change", "words"), FAULTS.values(), ids=FAULTS)
def test_what_was_changed_is_named(corrected, name, change, words):
    change(corrected / name)
    code, found = verify(corrected)
    assert code == 3
    assert any(words in fault for fault in found["faults"])
    assert Path(name).name not in found["intact"]
