"""What a study has measured so far: one SQLite file that outlives any run.

A task is named by what it measures, and keyed by everything that its result depends on: the bytes of its
inputs, its parameters, and the code that measures. A task whose key has changed is stale. The file is written
by one process, result by result, and can be read while that happens.
"""

import hashlib
import json
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Final, Literal, Self

from filelock import FileLock, Timeout

from fingerpad.exceptions import StoreError

FORMAT: Final = 1
STORE_NAME: Final = "store.sqlite"

_SCHEMA: Final = """
CREATE TABLE IF NOT EXISTS result (
    task TEXT PRIMARY KEY,
    key TEXT NOT NULL,
    status TEXT NOT NULL,
    record TEXT NOT NULL,
    seconds REAL NOT NULL,
    finished TEXT NOT NULL
) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS input (
    path TEXT PRIMARY KEY,
    stamp TEXT NOT NULL,
    digest TEXT NOT NULL
) WITHOUT ROWID;
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Stored:
    """One task's result.

    Attributes
    ----------
    key : str
        What the result depends on, hashed.
    status : {"done", "failed"}
        Whether anything was measured.
    record : dict
        The result, or the reason why there is none.
    seconds : float
        What it cost.
    """

    key: str
    status: Literal["done", "failed"]
    record: dict[str, Any]
    seconds: float


class Store:
    """The results of a study in one SQLite file."""

    def __init__(self, path: Path, connection: sqlite3.Connection) -> None:
        self.path = path
        self._connection = connection

    @classmethod
    @contextmanager
    def writing(cls, path: Path) -> Iterator[Self]:
        """Open the store at `path` for the one run that may write to it.

        Raises
        ------
        StoreError
            As `open`, and if another run is at work on it.
        """
        lock = FileLock(path.with_suffix(".lock"), timeout=0)
        try:
            with _plain_errors(path):
                lock.acquire()
        except Timeout:
            raise StoreError(
                f"{path.parent}: another run writes here: wait for it to end, or choose --out"
            ) from None
        except OSError as error:
            raise StoreError(
                f"{path.parent}: cannot be written ({error.strerror}): choose another --out"
            ) from error
        try:
            with cls.open(path) as store:
                yield store
        finally:
            lock.release()

    @classmethod
    @contextmanager
    def open(cls, path: Path) -> Iterator[Self]:
        """Open the store at `path`, made if it is not there, and close it in the end.

        Raises
        ------
        StoreError
            If the file cannot be opened or written, is no store, is damaged, or was made by a newer
            fingerpad.
        """
        store = None
        try:
            with _plain_errors(path):
                connection = sqlite3.connect(path, isolation_level=None)
                store = cls(path, connection)
                store._prepare()
            yield store
        finally:
            if store is not None:
                store._connection.close()

    def _prepare(self) -> None:
        execute = self._connection.execute
        found = execute("PRAGMA user_version").fetchone()[0]
        if found > FORMAT:
            raise StoreError(
                f"{self.path}: written by a newer fingerpad (format {found}, this one knows {FORMAT}): "
                "update fingerpad, or move the file away to measure everything anew"
            )
        if execute("PRAGMA quick_check(1)").fetchone()[0] != "ok":
            raise sqlite3.DatabaseError("damaged")
        execute("PRAGMA journal_mode=WAL")
        execute("PRAGMA synchronous=NORMAL")  # a killed process loses nothing, a power cut the last results
        if found == 0:
            self._connection.executescript(f"BEGIN; {_SCHEMA} PRAGMA user_version={FORMAT}; COMMIT;")

    def results(self) -> dict[str, Stored]:
        """Return every result by the name of its task."""
        with _plain_errors(self.path):
            rows = self._connection.execute("SELECT task, key, status, record, seconds FROM result")
            return {
                task: Stored(key=key, status=status, record=json.loads(record), seconds=seconds)
                for task, key, status, record, seconds in rows
            }

    def put(self, task: str, stored: Stored) -> None:
        """Keep a result, in place of what the task had before."""
        with _plain_errors(self.path):
            self._connection.execute(
                "INSERT OR REPLACE INTO result VALUES (?, ?, ?, ?, ?, ?)",
                (
                    task,
                    stored.key,
                    stored.status,
                    json.dumps(stored.record),
                    stored.seconds,
                    datetime.now(UTC).isoformat(timespec="seconds"),
                ),
            )

    def digest(self, path: Path) -> str:
        """Return the SHA-256 of a file, or of the names and digests of a folder's files.

        A file's bytes are read again only when its size, time or inode have changed.
        """
        if path.is_dir():
            whole = hashlib.sha256()
            for item in sorted(item for item in path.iterdir() if item.is_file()):
                whole.update(f"{item.name}\0{self.digest(item)}\n".encode())
            return whole.hexdigest()
        status = path.stat()
        stamp = f"{status.st_size} {status.st_mtime_ns} {status.st_ino}"
        with _plain_errors(self.path):
            row = self._connection.execute(
                "SELECT digest FROM input WHERE path = ? AND stamp = ?", (str(path), stamp)
            ).fetchone()
            if row is not None:
                return str(row[0])
            with path.open("rb") as file:
                digest = hashlib.file_digest(file, "sha256").hexdigest()
            self._connection.execute(
                "INSERT OR REPLACE INTO input VALUES (?, ?, ?)", (str(path), stamp, digest)
            )
        return digest


@contextmanager
def _plain_errors(path: Path) -> Iterator[None]:
    """Say in plain words what SQLite cannot do, and the way out."""
    try:
        yield
    except sqlite3.OperationalError as error:
        text = str(error)
        if "full" in text:
            way_out = "the disk is full: make room and run again; what was measured before is kept"
        elif "locked" in text or "busy" in text:
            way_out = "another process is writing to it: wait for it to end"
        elif "readonly" in text or "unable to open" in text:
            way_out = "cannot be written: check the folder's rights, or choose another with --out"
        else:
            way_out = f"cannot be used ({text})"
        raise StoreError(f"{path}: {way_out}") from error
    except sqlite3.DatabaseError as error:
        raise StoreError(
            f"{path}: damaged or no store of fingerpad ({error}): move it away and run again, "
            "which measures everything anew"
        ) from error
