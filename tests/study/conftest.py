"""The small study, rendered once for all processes that test; no test may change it."""

from pathlib import Path

import pytest
from filelock import FileLock
from tests.study.small_study import make


@pytest.fixture(scope="session")
def small_study(session_folder: Path) -> Path:
    """Return the manifest of the small study, whose film is a folder of pictures."""
    return made_once(session_folder / "small-study", "film")


@pytest.fixture(scope="session")
def small_study_of_tiff(session_folder: Path) -> Path:
    """Return the manifest of the small study, whose film is a TIFF."""
    return made_once(session_folder / "small-study-of-tiff", "film.tif")


def made_once(folder: Path, film: str) -> Path:
    with FileLock(f"{folder}.lock"):
        return folder / "study.toml" if (folder / "study.toml").exists() else make(folder, film=film)
