"""Files that are there whole, old or new, whatever happens while they are written; one writer at a time."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from filelock import FileLock, Timeout

from fingerpad.exceptions import ManifestError, StoreError

_WAIT_S: Final = 30.0


@contextmanager
def locked(path: Path, lock: Path) -> Iterator[None]:
    """Hold the lock of a file or folder, and say plainly where it cannot be written."""
    try:
        with FileLock(lock, timeout=_WAIT_S):
            yield
    except Timeout:
        raise StoreError(f"{path}: another process has been writing for {_WAIT_S:g} s: try again") from None
    except OSError as error:
        raise StoreError(f"{path}: cannot be written ({error.strerror})") from error


def read_text_or_none(path: Path) -> str | None:
    """Return what a file says, None where there is none."""
    try:
        return path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        return None
    except (OSError, UnicodeDecodeError) as error:
        raise ManifestError(f"{path}: cannot be read ({error})") from error


def replace_file(path: Path, text: str) -> None:
    """Write a file so that it is there whole, old or new, whatever happens."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_synced(new_path(path), text)
    new_path(path).replace(path)
    sync_folder(path.parent)


def new_path(path: Path) -> Path:
    """Return the path of a file's new content."""
    return path.with_name(f".{path.name}.new")


def write_synced(path: Path, text: str) -> None:
    """Write a file, and wait until its content is on the disk."""
    with path.open("w", encoding="utf-8", newline="") as file:
        file.write(text)
        file.flush()
        os.fsync(file.fileno())


def sync_folder(folder: Path) -> None:
    """Wait until the names in a folder are on the disk, where the system can."""
    if os.name == "nt":
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
