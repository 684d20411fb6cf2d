"""Files that are there whole, old or new, whatever happens while they are written; one writer at a time."""

import os
from collections.abc import Container, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from filelock import FileLock, Timeout

from fingerpad._files import make_folder
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


def text_of(path: Path) -> str | None:
    """Return what a file says, None where there is none."""
    try:
        return path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        return None
    except (OSError, UnicodeDecodeError) as error:
        raise ManifestError(f"{path}: cannot be read ({error})") from error


def replace_file(path: Path, text: str) -> None:
    """Write a file so that it is there whole, old or new, whatever happens."""
    new = path.with_name(f".{path.name}.new")
    new.parent.mkdir(parents=True, exist_ok=True)
    with new.open("w", encoding="utf-8", newline="") as file:
        file.write(text)
        file.flush()
        os.fsync(file.fileno())
    new.replace(path)
    sync_folder(path.parent)


def keep_files(out: Path, files: Mapping[str, bytes]) -> None:
    """Write results into the output folder; each is there as a whole or not at all.

    Raises
    ------
    StoreError
        If one cannot be written.
    """
    for name, content in files.items():
        path = out / name
        make_folder(path.parent)
        half = path.with_suffix(".part")
        try:
            half.write_bytes(content)
            half.replace(path)
        except OSError as error:
            half.unlink(missing_ok=True)
            raise StoreError(
                f"{path}: cannot be written ({error.strerror}): what was measured before is kept; make room, "
                "or choose another --out, and run again to go on"
            ) from error


def remove_others(out: Path, patterns: Iterable[str], kept: Container[str]) -> None:
    """Remove results of earlier runs, lest they mix with this one's.

    Raises
    ------
    StoreError
        If one cannot be removed.
    """
    try:
        for pattern in patterns:
            for path in out.glob(pattern):
                if path.relative_to(out).as_posix() not in kept:
                    path.unlink()
    except OSError as error:
        raise StoreError(f"{error.filename}: cannot be removed ({error.strerror})") from error


def sync_folder(folder: Path) -> None:
    """Wait until the names in a folder are on the disk, where the system can."""
    if os.name == "nt":
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
