"""The small study, rendered and run once for all processes that test; no test may change it."""

import shutil
from pathlib import Path

import pytest
from filelock import FileLock
from tests.study.small_study import PIECE, copy, make, make_of_tiff

from fingerpad.study.measuring import sequences
from fingerpad.study.pipeline import run_study


@pytest.fixture(scope="session")
def small_study(session_folder: Path) -> Path:
    """Return the manifest of the small study, whose sequence is a folder of pictures."""
    folder = session_folder / "small-study"
    with FileLock(f"{folder}.lock"):
        return folder / "study.toml" if (folder / "study.toml").exists() else make(folder)


@pytest.fixture(scope="session")
def small_study_of_tiff(small_study: Path, session_folder: Path) -> Path:
    """Return the manifest of the small study, whose sequence is a TIFF."""
    folder = session_folder / "small-study-of-tiff"
    with FileLock(f"{folder}.lock"):
        if not (folder / "stack.tif").exists():
            shutil.rmtree(folder, ignore_errors=True)
            make_of_tiff(small_study, folder)
    return folder / "study.toml"


@pytest.fixture(scope="session")
def small_run(small_study: Path, session_folder: Path) -> Path:
    """Return the manifest of the small study, run with its sequence in pieces: the results are in ``out``."""
    folder = session_folder / "small-run"
    with FileLock(f"{folder}.lock"), pytest.MonkeyPatch.context() as patched:
        patched.setattr(sequences, "_LEAST_PIECE", PIECE)
        if not (folder / "out" / "SHA256SUMS").exists():
            shutil.rmtree(folder, ignore_errors=True)
            run_study(copy(small_study, folder), folder / "out")
    return folder / "study.toml"


@pytest.fixture
def small_pieces(monkeypatch: pytest.MonkeyPatch) -> None:
    """Measure sequences in the pieces of `small_run`."""
    monkeypatch.setattr(sequences, "_LEAST_PIECE", PIECE)
