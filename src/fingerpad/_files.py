"""Folders for results, and what tells one file from another."""

import hashlib
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


def sha256_of(path: Path) -> str:
    """Return the SHA-256 of a file's bytes, which are not held in memory.

    Raises
    ------
    OSError
        If it cannot be read.
    """
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def digest_of(path: Path) -> str:
    """Return the SHA-256 of a file's bytes, empty where it cannot be read: who needs them will say so."""
    try:
        return sha256_of(path)
    except OSError:
        return ""
