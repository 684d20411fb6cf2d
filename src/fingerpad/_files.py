"""Folders for results."""

from pathlib import Path

from fingerpad.exceptions import FingerpadError


def make_folder(folder: Path) -> None:
    """Make a folder for results unless it is there.

    Raises
    ------
    FingerpadError
        Where it cannot be made.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FingerpadError(
            f"{folder}: cannot make this folder ({error.strerror}); choose another"
        ) from error
