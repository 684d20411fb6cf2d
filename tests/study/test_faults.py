"""Whatever happens to a run: no row is lost, none doubled, and the next run ends as an undisturbed one."""

import os
import shutil
import signal
import subprocess
from collections.abc import Callable, Iterator
from multiprocessing import get_context
from pathlib import Path
from time import perf_counter

import numpy as np
import pytest
from tests.study.small_study import FRAMES, PICTURES, copy_unfinished, run_here

from fingerpad.exceptions import FingerpadError, StoreError
from fingerpad.study.engine.runner import Progress
from fingerpad.study.engine.store import STORE_NAME, Store
from fingerpad.study.measuring import sequences
from fingerpad.study.pipeline import run_study
from fingerpad.study.results.table import records
from fingerpad.study.status import study_status

pytestmark = pytest.mark.usefixtures("small_pieces")
ITEMS = PICTURES + 3  # two photographs and a sequence


def rows(manifest: Path, out: Path, **options: object) -> list[dict]:
    return list(records(run_study(manifest, out, **options).rows))


@pytest.mark.nightly
def test_killed_at_any_moment(small_study, undisturbed, tmp_path):
    context, out, kills = get_context("forkserver"), tmp_path / "out", 0
    context.set_forkserver_preload(["tests.study.small_study"])
    moments = np.random.default_rng(20).uniform(0.0, 1.0, 8)
    took = 3.0
    while kills < moments.size:
        process = context.Process(target=run_here, args=(small_study, out, 1 + kills % 2))
        process.start()
        start = perf_counter()
        process.join(took * moments[kills])
        if process.is_alive():
            process.kill()
            kills += 1
        process.join()
        if process.exitcode == 0:
            took = perf_counter() - start  # the next one is killed before its end
            assert rows(small_study, out) == undisturbed
            shutil.rmtree(out)
        else:
            assert process.exitcode == -signal.SIGKILL
    assert rows(small_study, out) == undisturbed
    assert not list(out.rglob("*.part"))


def stored(out: Path) -> int:
    """Return the number of results in the store, but for the sequence's header, which no task reports."""
    with Store.reading(out / STORE_NAME) as store:
        return len(store.statuses().keys() - {"p header"})


@pytest.mark.parametrize("workers", [1, pytest.param(2, marks=pytest.mark.nightly)])
def test_an_interrupt_keeps_what_is_in_hand(unfinished, undisturbed, workers):
    out = unfinished.parent / "out"
    before = stored(out)
    reported: list[Progress] = []

    def interrupt(progress: Progress) -> None:
        reported.append(progress)
        if len(reported) == 3:
            os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        rows(unfinished, out, workers=workers, on_progress=interrupt)
    kept = stored(out) - before
    assert kept == len(reported) - 1
    assert 2 <= kept <= 2 + 2 * workers
    again: list[Progress] = []
    assert rows(unfinished, out, on_progress=again.append) == undisturbed
    assert again[-1].pictures == again[-1].total == PICTURES + 2 + FRAMES


def replaced(path: Path, other: bytes) -> None:
    """Put other bytes in place of a file's, with the time that it had: only the change itself tells."""
    stamp = path.stat()
    path.write_bytes(other)
    os.utime(path, ns=(stamp.st_atime_ns, stamp.st_mtime_ns))


CHANGES: dict[str, tuple[int, str, Callable[[Path], object]]] = {
    "replaced": (1, "o4.png", lambda path: replaced(path, path.with_name("o1.png").read_bytes())),
    "truncated": (2, "o3.png", lambda path: path.write_bytes(path.read_bytes()[:500])),
    "deleted": (1, "o2.png", Path.unlink),
    "a frame replaced": (
        2, "frames/f12.png", lambda path: replaced(path, path.with_name("f2.png").read_bytes()),
    ),
    "a frame deleted": (1, "frames/f12.png", Path.unlink),
    "a photograph replaced": (2, "palmar.jpg", lambda path: replaced(path, b"no picture")),
}  # fmt: skip


@pytest.mark.parametrize(
    ("workers", "name", "change"),
    [
        pytest.param(*change, id=name, marks=() if "frame replaced" in name else pytest.mark.nightly)
        for name, change in CHANGES.items()
    ],
)
def test_an_input_that_changes_while_the_run_goes_on(small_run, undisturbed, tmp_path, workers, name, change):
    item = name.partition("/")[0]
    task = {"frames": "p", "palmar.jpg": "g/palmar.jpg"}.get(item, item.removesuffix(".png"))
    manifest = copy_unfinished(small_run, tmp_path / "study", "o0", task)
    path, out = manifest.parent / name, manifest.parent / "out"
    before = path.read_bytes()

    def disturb(progress: Progress) -> None:
        if progress.status == "started":
            change(path)

    result = run_study(manifest, out, workers=workers, on_progress=disturb)
    assert any(item in failure and "run again" in failure for failure in result.failures)
    assert study_status(manifest, out).done < ITEMS if path.exists() else True
    # The very bytes of before, so that a result of the others under the old key would be found again.
    path.write_bytes(before)
    assert rows(manifest, out) == undisturbed


def test_a_picture_of_the_same_size_and_time(finished, undisturbed):
    """A clock that was set back gives a file a time that it had before."""
    assert rows(finished, finished.parent / "out") == undisturbed
    path = finished.parent / "o1.png"
    content = path.read_bytes()
    replaced(path, content[:-40] + bytes(40))
    assert study_status(finished, finished.parent / "out").stale == 1
    os.utime(path, (1, 1))
    assert study_status(finished, finished.parent / "out").stale == 1


@pytest.fixture
def small_disk(tmp_path) -> Iterator[Path]:
    """Give a file system of its own, which can be made too small."""
    disk = tmp_path / "disk"
    disk.mkdir()
    made = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=50m", "tmpfs", str(disk)], capture_output=True)
    if made.returncode:
        pytest.skip("mounting a small tmpfs needs rights that this machine does not give")
    try:
        yield disk
    finally:
        subprocess.run(["umount", "-l", str(disk)], check=True)


def test_two_processes_and_a_tiff_in_one_piece_give_the_rows_of_one(
    small_study_of_tiff, undisturbed, tmp_path, monkeypatch
):
    monkeypatch.setattr(sequences, "_LEAST_PIECE", FRAMES)
    found = rows(small_study_of_tiff, tmp_path / "out", workers=2)
    assert [row | {"file": None} for row in found] == [row | {"file": None} for row in undisturbed]


def remount(disk: Path, options: str) -> None:
    subprocess.run(["mount", "-o", f"remount,{options}", str(disk)], check=True)


def test_a_full_disk(small_run, undisturbed, small_disk):
    manifest = copy_unfinished(small_run, small_disk / "study", "o", "p")
    out = manifest.parent / "out"
    used = subprocess.run(["du", "-sk", small_disk], capture_output=True, text=True, check=True).stdout
    remount(small_disk, f"size={int(used.split()[0]) + 300}k")
    with pytest.raises(StoreError, match=r"(?s)make room.*run again"):
        rows(manifest, out)
    kept = study_status(manifest, out)
    assert kept.failed == kept.stale == 0
    remount(small_disk, "size=50m")
    assert rows(manifest, out) == undisturbed


def test_a_folder_that_cannot_be_written(finished, undisturbed, small_disk):
    out = small_disk / "out"
    remount(small_disk, "ro")
    with pytest.raises(FingerpadError, match=r"cannot (be written|make this folder).*choose another"):
        rows(finished, out)
    remount(small_disk, "rw")
    shutil.copytree(finished.parent / "out", out)
    assert rows(finished, out) == undisturbed
    remount(small_disk, "ro")
    with pytest.raises(FingerpadError, match=r"cannot be written.*choose another"):
        rows(finished, out)
