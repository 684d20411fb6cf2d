"""`fingerpad verify` names everything that is not what was written, and nothing else."""

import json
import shutil
import sqlite3
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest
from tests import command
from tests.studies import correct

from fingerpad.study.pipeline import run_study


@pytest.fixture
def study(finished, small_pieces) -> Path:
    """Return the folder of the small study, run with a correction."""
    correct(finished.parent, "o1", {"accepted": True})
    run_study(finished, finished.parent / "out")
    return finished.parent


def verify(folder: Path) -> tuple[int, dict]:
    code, out, _ = command.run("verify", folder, "--out", folder / "out", "--json")
    return code, json.loads(out)


def test_a_finished_study_is_intact_also_where_inputs_changed_or_it_was_never_run(study):
    code, found = verify(study)
    assert (code, found["faults"], found["changed_inputs"]) == (0, [], [])
    assert found["intact"].keys() == {"study.toml", "corrections.jsonl", "store.sqlite", "results"}
    words = command.run("verify", study, "--out", study / "out")[1]
    assert words.startswith("intact   study.toml: 2 fingers, 6 contacts")
    (study / "o1.png").write_bytes((study / "o2.png").read_bytes())
    code, found = verify(study)
    assert (code, found["changed_inputs"]) == (0, ["o1.png"])
    shutil.rmtree(study / "out")
    code, found = verify(study)
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
def test_what_was_changed_is_named(study, name, change, words):
    change(study / name)
    code, found = verify(study)
    assert code == 3
    assert any(words in fault for fault in found["faults"])
    assert Path(name).name not in found["intact"]
