"""Files changed as one: nothing is changed where one of them cannot be, and a journal leads nowhere else."""

import errno
import multiprocessing
import resource
import signal
from pathlib import Path

import pytest

from fingerpad.exceptions import ManifestError
from fingerpad.study.journal import JOURNAL_NAME, recover, replace_files


@pytest.fixture
def folder(tmp_path) -> Path:
    folder = tmp_path / "study"
    folder.mkdir()
    for name in "abc":
        (folder / name).write_text(f"old {name}")
    return folder


def contents(folder: Path) -> dict[str, str]:
    return {path.name: path.read_text() for path in folder.iterdir() if path.suffix != ".lock"}


def test_files_are_replaced_and_made(folder):
    replace_files(folder, {"a": "new", "d": "\u00e9\r\n"})
    assert (folder / "d").read_bytes() == b"\xc3\xa9\r\n"
    (folder / "d").unlink()
    assert contents(folder) == {"a": "new", "b": "old b", "c": "old c"}


def replace_on_a_full_disk(folder: Path) -> None:
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100, -1))
    with pytest.raises(OSError, match="large") as error:
        replace_files(folder, {"a": "new", "c": "new" * 100})
    assert error.value.errno == errno.EFBIG


def test_where_one_does_not_fit_on_the_disk_nothing_is_changed(folder):
    before = contents(folder)
    process = multiprocessing.get_context("fork").Process(target=replace_on_a_full_disk, args=(folder,))
    process.start()
    process.join(60)
    assert process.exitcode == 0
    assert contents(folder) == before


@pytest.mark.parametrize(
    "content",
    [
        "no JSON",
        "[]",
        '{"replace": [3]}',
        '{"replace": [], "remove": ["a"]}',
        '{"replace": ["../outside"]}',
        '{"replace": ["link/outside"]}',
        '{"replace": ["/"]}',
    ],
)
def test_a_journal_that_is_damaged_or_leads_out_is_refused(folder, content):
    (folder.parent / "outside").write_text("kept")
    (folder.parent / ".outside.new").write_text("would replace it")
    (folder / "link").symlink_to(folder.parent)
    (folder / JOURNAL_NAME).write_text(content)
    with pytest.raises(ManifestError, match=r"is no journal of a change.*remove it"):
        recover(folder)
    assert (folder.parent / "outside").read_text() == "kept"
