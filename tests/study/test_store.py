"""What was measured is kept: runs go on where they stopped, measure only what changed, and lose nothing."""

import json
import os
import shutil
import signal
import sqlite3
import subprocess
import sys
import time
from contextlib import closing, suppress
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from tests import command
from tests.studies import finger, picture, rows_by, run_watched, write_study
from tests.waiting import wait_until

from fingerpad.exceptions import StoreError
from fingerpad.simulate import render_contact_image
from fingerpad.study.engine.store import STORE_NAME, Store
from fingerpad.study.engine.task import TaskResult
from fingerpad.study.results.table import Row
from fingerpad.study.status import Status, study_status, verify_study

COUNT = 4


@pytest.fixture(scope="module")
def pictures(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("pictures")
    for number in range(COUNT):
        truth = render_contact_image(semi_major=4.0 + 0.2 * number, semi_minor=3.2, ppi=250, seed=number)
        Image.fromarray(truth.pixels).save(folder / f"o{number}.png")
    return folder


@pytest.fixture(scope="module")
def whole(pictures, tmp_path_factory) -> tuple[Path, dict[str, Row]]:
    """Return a study with the results of a run in ``out``, which no test may change, and the run's rows."""
    folder = Path(shutil.copytree(pictures, tmp_path_factory.mktemp("whole"), dirs_exist_ok=True))
    write(folder)
    measured, rows = run(folder)
    assert measured == [f"o{k}" for k in range(COUNT)]
    return folder, rows


@pytest.fixture
def fresh(pictures, tmp_path) -> Path:
    """Return the folder of a study that was not run."""
    shutil.copytree(pictures, tmp_path, dirs_exist_ok=True)
    write(tmp_path)
    return tmp_path


@pytest.fixture
def folder(whole, tmp_path) -> Path:
    """Return the folder of a study with the results of a run in ``out``."""
    return Path(shutil.copytree(whole[0], tmp_path, dirs_exist_ok=True))


@pytest.fixture
def rows(whole) -> dict[str, Row]:
    return whole[1]


def write(folder: Path, more: dict[int, dict[str, object]] | None = None, load: float = 1.0) -> None:
    keys = [{"scale": {"ppi": 250}, **(more or {}).get(k, {})} for k in range(COUNT)]
    tables = (picture(f"o{k}", f"o{k}.png", load, **each) for k, each in enumerate(keys))
    # Angles known so well that few random draws check the uncertainty.
    write_study(folder, finger(), *tables, uncertainty={"wedge_angle_deg_std": 0.3})


def run(folder: Path, **options: object) -> tuple[list[str], dict[str, Row]]:
    """Run the study, and return what was measured and the rows."""
    result, measured = run_watched(folder / "study.toml", **options)
    return sorted(measured), rows_by(result)


def status(folder: Path) -> Status:
    return study_status(folder / "study.toml", folder / "out")


def test_a_second_run_measures_nothing_and_says_the_same(folder, rows):
    assert run(folder) == ([], rows)
    assert status(folder).done == COUNT


@pytest.mark.parametrize(
    ("more", "expected"),
    [
        ({1: {"threshold": 40}}, ["o1"]),
        ({2: {"finger_axis_deg": 10}}, ["o2"]),
        ({0: {"notes": "a second look"}}, []),
        ({0: {"roll_angle_deg": 5, "session": "tuesday"}}, []),
    ],
)
def test_only_what_bears_on_the_picture_is_measured_again(folder, more, expected):
    write(folder, more)
    assert status(folder).stale == len(expected)
    assert run(folder)[0] == expected


def test_a_changed_load_changes_the_row_without_measuring(folder, rows):
    write(folder, load=2.0)
    measured, after = run(folder)
    assert measured == []
    for name, row in after.items():
        assert row["load_N"] == 2.0
        assert row["reduced_modulus_kpa"] == pytest.approx(2 * rows[name]["reduced_modulus_kpa"])


def test_a_replaced_picture_is_measured_again_and_a_touched_one_is_not(folder):
    os.utime(folder / "o0.png", (1, 1))
    shutil.copy(folder / "o2.png", folder / "o1.png")
    assert run(folder)[0] == ["o1"]


def test_fresh_measures_everything(folder):
    assert len(run(folder, force=True)[0]) == COUNT


def test_a_failed_picture_is_kept_as_failed_until_it_is_mended(folder):
    good = (folder / "o1.png").read_bytes()
    Image.fromarray(np.full((200, 200), 255, np.uint8)).save(folder / "o1.png")
    run(folder)
    assert status(folder).failed == 1
    assert run(folder)[0] == []
    (folder / "o1.png").write_bytes(good)
    measured, rows = run(folder)
    assert measured == ["o1"]
    assert {row["status"] for row in rows.values()} == {"measured"}


def test_a_killed_run_loses_no_row_and_doubles_none(fresh, rows):
    words = [sys.executable, "-m", "fingerpad", "run", str(fresh), "--out", str(fresh / "out")]
    process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    assert wait_until(lambda: len(list((fresh / "out" / ".drawn").glob("*.png"))) > 1)
    process.send_signal(signal.SIGKILL)
    process.wait()
    measured, again = run(fresh)
    assert len(measured) < COUNT
    assert again == rows


def test_a_store_that_is_none(fresh):
    (fresh / "out").mkdir()
    (fresh / "out" / STORE_NAME).write_bytes(b"not a database" * 100)
    with pytest.raises(StoreError, match="damaged or no store .* move it away and run again"):
        run(fresh)
    assert (fresh / "out" / STORE_NAME).read_bytes() == b"not a database" * 100


def test_a_damaged_index_of_a_store(folder):
    path = folder / "out" / STORE_NAME
    root = "SELECT rootpage FROM sqlite_master WHERE name = 'sqlite_autoindex_result_1'"
    with closing(sqlite3.connect(path)) as connection:
        (size,), (page,) = (connection.execute(each).fetchone() for each in ("PRAGMA page_size", root))
    content = bytearray(path.read_bytes())
    place = content.index(b"o2", size * (page - 1), size * page)
    content[place : place + 2] = b"n2"  # the table still has the result, no search by its name finds it
    path.write_bytes(content)
    (fault,) = verify_study(folder / "study.toml", folder / "out").faults
    assert "damaged or no store" in fault
    with pytest.raises(StoreError, match="damaged or no store"):
        run(folder)


FOREIGN = {
    "newer": ("PRAGMA user_version=99", "written by a newer fingerpad"),
    "older": ("PRAGMA user_version=2", "written by an older fingerpad"),
    "of another program": (
        "PRAGMA user_version=0; CREATE TABLE mine (b); INSERT INTO mine VALUES (1)",
        "no store of fingerpad .made by another program",
    ),
}


@pytest.mark.parametrize(("change", "words"), FOREIGN.values(), ids=FOREIGN)
def test_a_store_that_this_version_did_not_write_is_left_alone(folder, change, words):
    path = folder / "out" / STORE_NAME
    if "CREATE" in change:
        path.unlink()
    with closing(sqlite3.connect(path)) as connection:
        connection.executescript(change)
    before = path.read_bytes()
    for use in (run, status):
        with pytest.raises(StoreError, match=words):
            use(folder)
        assert path.read_bytes() == before


def snapshot(folder: Path) -> dict[Path, tuple[int, bytes]]:
    """Return each file with its time, but for the index of a log that is being read: it says who reads it."""
    files = (path for path in folder.rglob("*") if path.is_file() and path.suffix != ".sqlite-shm")
    return {path: (path.stat().st_mtime_ns, path.read_bytes()) for path in files}


@pytest.mark.parametrize("state", ["finished", "killed", "at work"])
def test_status_writes_nothing(folder, state):
    out = folder / "out"
    if state != "finished":
        (folder / "o1.png").write_bytes((folder / "o2.png").read_bytes())
        pid = os.fork()
        if not pid:
            try:
                with Store.writing(out / STORE_NAME) as store:
                    store.put("a", "k", TaskResult({}, {}, 0.5), count=1)
                    (folder / "written").touch()
                    time.sleep(60)
            finally:
                os._exit(1)
        assert wait_until((folder / "written").exists)
        if state == "killed":
            os.kill(pid, signal.SIGKILL)
    before = snapshot(out)
    found = status(folder)
    assert snapshot(out) == before
    assert found.done == (COUNT if state == "finished" else COUNT - 1)
    if state != "finished":
        os.kill(pid, signal.SIGKILL)
        os.waitpid(pid, 0)


def update(folder: Path, change: str) -> None:
    """Change what is stored of o2 or o3."""
    with closing(sqlite3.connect(folder / "out" / STORE_NAME)) as connection, connection:
        assert connection.execute(f"UPDATE result SET {change}").rowcount == 1


OTHER_NUMBER = """record = replace(record, '"semi_major_mm": 4', '"semi_major_mm": 6') WHERE task ="""


def test_a_damaged_result_is_measured_again_and_named(folder, rows):
    update(folder, f"{OTHER_NUMBER} 'o2'")
    words = f"{STORE_NAME}: the stored result of o2 is damaged"
    assert verify_study(folder / "study.toml", folder / "out").faults == (words,)
    result, measured = run_watched(folder / "study.toml")
    assert (measured, rows_by(result)) == (["o2"], rows)
    assert result.notes == (f"{STORE_NAME}: the stored result of o2 was damaged and is measured again",)
    assert verify_study(folder / "study.toml", folder / "out").faults == ()


@pytest.mark.skipif(sys.platform != "linux", reason="other systems have no such names")
def test_a_folder_may_have_a_name_that_is_no_utf_8(folder, rows, tmp_path):
    other = shutil.copytree(folder, tmp_path / os.fsdecode(b"pr\xfcfstand"))
    assert run(other) == ([], rows)


@pytest.mark.nightly
def test_flipped_bits_of_a_store_change_no_row_in_silence(folder, rows):
    path = folder / "out" / STORE_NAME
    whole = path.read_bytes()
    rng = np.random.default_rng(8)
    for place in rng.integers(0, 8 * len(whole), 60).tolist():
        flipped = bytearray(whole)
        flipped[place // 8] ^= 1 << place % 8
        path.write_bytes(flipped)
        with suppress(StoreError):
            status(folder)
        with suppress(StoreError):
            assert run(folder)[1] == rows
        for other in path.parent.glob(f"{STORE_NAME}-*"):
            other.unlink()


def test_status_for_scripts(fresh):
    words = ("status", fresh, "--out", fresh / "out")
    before = command.run_json(*words)
    assert (before["left"], before["total"], before["seconds_left"]) == (COUNT, COUNT, None)
    run(fresh)
    whole = command.run_json(*words)["seconds"]["done"]
    write(fresh, {0: {"threshold": 50}})
    after = command.run_json(*words)
    counts = {"done": COUNT - 1, "failed": 0, "stale": 1, "left": 0, "total": COUNT}
    assert {key: after[key] for key in counts} == counts
    assert whole > after["seconds"]["done"] > after["seconds"]["left"] == 0
    assert after["seconds_left"] == after["seconds"]["stale"] > 0


def test_the_store_keeps_numbers_to_the_last_digit(tmp_path):
    record = {"x": 0.1 + 0.2, "words": "µ – ✓", "none": None}
    with Store.writing(tmp_path / STORE_NAME) as store:
        store.put("a", "k", TaskResult(record | {"nan": float("nan")}, {}, 0.5), count=1)
    with Store.reading(tmp_path / STORE_NAME) as store:
        found = store.record("a", "k")
        assert store.record("a", "another key") is None
    assert np.isnan(found.pop("nan"))
    assert found == record


def test_the_log_of_runs(fresh):
    log = fresh / "run.jsonl"
    for _ in range(2):
        assert command.run("run", fresh, "--out", fresh / "out", "--log", log)[0] == 0
    lines = [json.loads(line) for line in log.read_text().splitlines()]
    measuring = [line for line in lines if line["status"] != "written"]
    assert [line["status"] for line in measuring] == ["started", *["done"] * COUNT, "checked", "started"]
    assert [line["pictures"] for line in measuring] == [0, *range(1, COUNT + 1), COUNT, COUNT]
    assert {line["file"] for line in measuring[1:-2]} == {f"o{k}.png" for k in range(COUNT)}


@pytest.mark.parametrize(
    ("name", "words"),
    [("study.toml", "is no log"), ("o1.png", "is no log"), (".", "cannot be written"), ("a/b", "cannot be")],
)
def test_a_log_that_would_spoil_something(folder, name, words):
    before = snapshot(folder)
    assert words in command.refusal("run", folder, "--out", folder / "out", "--log", folder / name)
    assert snapshot(folder) == before
