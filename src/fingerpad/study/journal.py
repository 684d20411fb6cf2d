"""Files of a study changed as one: all of them or none, even if the process is killed in between.

The new contents are written beside the old ones first. Then a journal names them, and from then on the change
is completed: by the process that began it, or by the next one that opens the study.
One process writes at a time.
"""

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from filelock import FileLock, Timeout
from pydantic import BaseModel, ConfigDict, ValidationError

from fingerpad._files import explain_write_errors
from fingerpad.exceptions import ManifestError, StoreError

_WAIT_S: Final = 30.0


@contextmanager
def locked(path: Path, lock: Path) -> Iterator[None]:
    """Hold the lock of a file or folder; `StoreError` where another process has it, or it cannot be made.

    What goes wrong while it is held is the caller's to explain: it may be of any file.
    """
    held = FileLock(lock, timeout=_WAIT_S)
    with explain_write_errors(path, error=StoreError):
        try:
            held.acquire()
        except Timeout:  # an OSError, too
            words = f"{path}: another process has been writing for {_WAIT_S:g} s: try again"
            raise StoreError(words) from None
    try:
        yield
    finally:
        held.release()


def read_text_or_none(path: Path) -> str | None:
    """Return what a file says, None where there is none."""
    try:
        return path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        return None
    except (OSError, UnicodeDecodeError) as error:
        raise ManifestError(f"{path}: cannot be read ({error})") from error


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


JOURNAL_NAME: Final = ".study.journal"
LOCK_NAME: Final = ".study.lock"


class _Journal(BaseModel):
    """Files to replace by what is written beside them."""

    model_config = ConfigDict(extra="forbid")

    replace: list[str]


def replace_files(folder: Path, texts: Mapping[str, str]) -> None:
    """Write files of a study, all or none; the caller holds the study's lock."""
    journal = folder / JOURNAL_NAME
    try:
        for name, text in texts.items():
            write_synced(new_path(folder / name), text)
        write_synced(new_path(journal), _Journal(replace=list(texts)).model_dump_json())
        new_path(journal).replace(journal)
        sync_folder(folder)
    except BaseException:
        for path in (journal, *(new_path(folder / name) for name in texts)):
            path.unlink(missing_ok=True)
        raise
    complete(folder)


def complete(folder: Path) -> None:
    """Complete a change that was started, if there is one; the caller holds the study's lock."""
    text = read_text_or_none(folder / JOURNAL_NAME)
    if text is None:
        return
    try:
        change = _Journal.model_validate_json(text)
        replaced = [_inside(folder, name) for name in change.replace]
    except ValueError as error:
        reason = error.errors()[0]["msg"] if isinstance(error, ValidationError) else error
        raise ManifestError(
            f"{folder / JOURNAL_NAME}: is no journal of a change ({reason}): remove it"
        ) from error
    for path in replaced:
        if new_path(path).exists():  # else it was replaced before the process was killed
            new_path(path).replace(path)
    for parent in {path.parent for path in replaced}:
        sync_folder(parent)
    (folder / JOURNAL_NAME).unlink()
    sync_folder(folder)


def recover(folder: Path) -> None:
    """Complete the change that a killed process had started in a study folder."""
    if os.path.lexists(folder / JOURNAL_NAME):
        with locked(folder, folder / LOCK_NAME), explain_write_errors(folder, error=StoreError):
            complete(folder)


def _inside(folder: Path, name: str) -> Path:
    """Return the path of a file of the study: a journal may have come with a study from elsewhere."""
    path = folder / name
    if not path.name or not path.parent.resolve().is_relative_to(folder.resolve()):
        raise ValueError(f"{name!r} leaves the study folder")
    return path
