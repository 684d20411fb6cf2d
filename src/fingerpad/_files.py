"""Folders for results, names and digests of files."""

import hashlib
from pathlib import Path
from typing import Final

from fingerpad.exceptions import FingerpadError

# Bytes; a file system takes 255 with what is added.
_LONGEST_STEM: Final = 200


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


def file_stem(name: str) -> str:
    """Return a name, cut short where no file system could hold it; different names stay different.

    Examples
    --------
    >>> file_stem("left_index_30deg")
    'left_index_30deg'
    >>> len(file_stem("指" * 90).encode()), file_stem("指" * 90) == file_stem("指" * 91)
    (197, False)
    """
    encoded = name.encode()
    if len(encoded) <= _LONGEST_STEM:
        return name
    return (
        f"{encoded[: _LONGEST_STEM - 20].decode(errors='ignore')}-{hashlib.sha256(encoded).hexdigest()[:16]}"
    )


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
    """Return the SHA-256 of a file's bytes, empty where it cannot be read."""
    try:
        return sha256_of(path)
    except OSError:
        return ""
