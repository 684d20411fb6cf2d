"""Folders for results, names and digests of files."""

import errno
import hashlib
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Final
from unicodedata import normalize

from fingerpad.exceptions import FingerpadError, ManifestError

# By the reason why nothing can be written.
_WAYS_OUT: Final[Mapping[int | None, str]] = {
    **dict.fromkeys((errno.ENOSPC, errno.EDQUOT), "make room and try again"),
    **dict.fromkeys((errno.EACCES, errno.EPERM, errno.EROFS), "get the right to write, or work on a copy"),
}
# Bytes; a file system takes 255 with what is added.
_LONGEST_STEM: Final = 200


@contextmanager
def explain_write_errors(
    path: Path, way_out: str = "", error: type[FingerpadError] = FingerpadError
) -> Iterator[None]:
    """Say of a file that cannot be written, or of `path` where none is named, why, and the way out.

    By default the way out is that from want of room or of rights.
    """
    try:
        yield
    except OSError as fault:
        place, why = fault.filename or path, fault.strerror or fault
        way_out = way_out or _WAYS_OUT.get(fault.errno, "")
        raise error(f"{place}: cannot be written ({why}){way_out and f': {way_out}'}") from fault


def make_folder(folder: Path) -> None:
    """Make a folder for results unless it is there."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FingerpadError(
            f"{folder}: cannot make this folder ({error.strerror}); choose another"
        ) from error


def check_new(folder: Path) -> None:
    """Refuse a folder for a study that holds anything."""
    if folder.is_dir() and any(folder.iterdir()):
        raise ManifestError(f"{folder}: the folder is not empty; name a new one, so that nothing is lost")


def file_stem(name: str) -> str:
    """Return a name, cut short where no file system could hold it; different names stay different."""
    encoded = name.encode()
    if len(encoded) <= _LONGEST_STEM:
        return name
    return (
        f"{encoded[: _LONGEST_STEM - 20].decode(errors='ignore')}-{hashlib.sha256(encoded).hexdigest()[:16]}"
    )


def leads_out(name: str) -> bool:
    """Tell whether a name, joined to a folder, is that of a file elsewhere; links are not followed."""
    return Path(name).is_absolute() or ".." in Path(name).parts


def folded(name: str) -> str:
    """Return what names have in common that are one on a system without case or accents of two kinds."""
    return normalize("NFC", normalize("NFC", name).casefold())


def sha256_of(path: Path) -> str:
    """Return the SHA-256 of a file's bytes, which are not held in memory."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def digest_of(path: Path) -> str:
    """Return the SHA-256 of a file's bytes, empty where it cannot be read."""
    try:
        return sha256_of(path)
    except OSError:
        return ""


def content_digest(path: Path) -> str:
    """Return the digest of a file, or that of a folder's names and digests; empty where it is unavailable."""
    if not path.is_dir():
        return digest_of(path)
    try:
        digests = [f"{item.name}\0{sha256_of(item)}\n" for item in _files(path)]
    except OSError:
        return ""
    return hashlib.sha256("".join(digests).encode()).hexdigest()


def content_stamp(path: Path) -> str:
    """Return what changes with the content of a file or folder, without reading it; empty if unavailable.

    The time of the last change of any kind, which is part of it, cannot be set back.
    """
    try:
        stats = [(item.name, item.stat()) for item in _files(path)]
    except OSError:
        return ""
    parts = [(name, s.st_size, s.st_mtime_ns, s.st_ctime_ns, s.st_ino) for name, s in stats]
    return hashlib.sha256(repr(parts).encode()).hexdigest()


def _files(path: Path) -> list[Path]:
    if not path.is_dir():
        return [path]
    with os.scandir(path) as entries:  # which tells what is a file without asking for each
        return [path / name for name in sorted(entry.name for entry in entries if entry.is_file())]
