"""`fingerpad verify` names everything that is not what was written, and nothing else."""

import json
import shutil
import sqlite3
from collections.abc import Callable
from pathlib import Path

import pytest
from tests import command
from tests.studies import correct
from tests.study.small_study import PIECE, copy

from fingerpad.study.measuring import sequences
from fingerpad.study.pipeline import run_study


@pytest.fixture(scope="module")
def finished(small_run: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("study") / "study"
    manifest = copy(small_run, folder)
    correct(folder, "o1", {"accepted": True})
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(sequences, "_LEAST_PIECE", PIECE)
        run_study(manifest, folder / "out")
    return folder


@pytest.fixture
def study(finished: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(finished, tmp_path / "study"))


def verify(folder: Path) -> tuple[int, dict]:
    code, out, _ = command.run("verify", folder, "--out", folder / "out", "--json")
    return code, json.loads(out)


def test_a_finished_study_is_intact(study: Path) -> None:
    code, found = verify(study)
    assert code == 0
    assert found["faults"] == []
    assert found["changed_inputs"] == []
    assert found["intact"].keys() == {"study.toml", "corrections.jsonl", "store.sqlite", "results"}
    words = command.run("verify", study, "--out", study / "out")[1]
    assert words.startswith("intact   study.toml: 2 fingers, 6 contacts")


def flip(path: Path) -> None:
    """Flip a bit that every format minds, and give the file the times that it had."""
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


def spoil_record(path: Path) -> None:
    connection = sqlite3.connect(path)
    connection.execute("UPDATE result SET seconds = seconds + 1 WHERE task = 'o3'")
    connection.commit()
    connection.close()


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
def test_what_was_changed_is_named(study: Path, name: str, change: Callable, words: str) -> None:
    change(study / name)
    code, found = verify(study)
    assert code == 3
    assert any(words in fault for fault in found["faults"])
    assert Path(name).name not in found["intact"]


def test_changed_inputs_are_no_fault(study: Path) -> None:
    (study / "o1.png").write_bytes((study / "o2.png").read_bytes())
    code, found = verify(study)
    assert (code, found["changed_inputs"]) == (0, ["o1.png"])


def test_a_study_that_was_never_run(study: Path) -> None:
    shutil.rmtree(study / "out")
    code, found = verify(study)
    assert (code, found["intact"].keys()) == (0, {"study.toml", "corrections.jsonl"})
