"""The small study, rendered and run once for all processes that test; no test may change it."""

from pathlib import Path

import pytest
from tests.once import made_once
from tests.study.pinned_study import make_pinned
from tests.study.small_study import PIECE, copy, copy_unfinished, make, make_of_tiff

from fingerpad.study.measuring import sequences
from fingerpad.study.pipeline import run_study
from fingerpad.study.results.table import Row, records


@pytest.fixture(scope="session")
def small_study(session_folder: Path) -> Path:
    """Return the manifest of the small study, whose sequence is a folder of pictures."""
    return made_once(session_folder / "small-study", make) / "study.toml"


@pytest.fixture(scope="session")
def small_study_of_tiff(small_study: Path, session_folder: Path) -> Path:
    """Return the manifest of the small study, whose sequence is a TIFF."""
    folder = session_folder / "small-study-of-tiff"
    return made_once(folder, lambda folder: make_of_tiff(small_study, folder)) / "study.toml"


@pytest.fixture(scope="session")
def small_run(small_study: Path, session_folder: Path) -> Path:
    """Return the manifest of the small study, run with its sequence in pieces: the results are in ``out``."""
    folder = session_folder / "small-run"
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(sequences, "_LEAST_PIECE", PIECE)
        made_once(folder, lambda folder: run_study(copy(small_study, folder), folder / "out"))
    return folder / "study.toml"


@pytest.fixture
def finished(small_run: Path, tmp_path: Path) -> Path:
    """Return the manifest of a copy of the small study with the results of a run in ``out``."""
    return copy(small_run, tmp_path / "study")


@pytest.fixture
def unfinished(small_run: Path, tmp_path: Path) -> Path:
    """Return the manifest of such a study whose run had yet to measure the pictures and the sequence."""
    return copy_unfinished(small_run, tmp_path / "study", "o", "p")


@pytest.fixture(scope="session")
def undisturbed(small_run: Path, tmp_path_factory: pytest.TempPathFactory) -> list[Row]:
    """Return the rows of a run that nothing disturbed, which measured the sequence in pieces."""
    manifest = copy(small_run, tmp_path_factory.mktemp("undisturbed") / "study")
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(sequences, "_LEAST_PIECE", PIECE)
        return list(records(run_study(manifest, manifest.parent / "out").rows))


@pytest.fixture(scope="session")
def pinned_run(session_folder: Path) -> Path:
    """Return the manifest of the study whose numbers are pinned, run: the results are in ``out``."""
    folder = session_folder / "pinned"
    return (
        made_once(folder, lambda folder: run_study(make_pinned(folder), folder / "out", all_columns=True))
        / "study.toml"
    )


@pytest.fixture
def small_pieces(monkeypatch: pytest.MonkeyPatch) -> None:
    """Measure sequences in the pieces of `small_run`."""
    monkeypatch.setattr(sequences, "_LEAST_PIECE", PIECE)
