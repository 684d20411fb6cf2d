"""What a study has measured so far: one SQLite file that outlives any run.

A task is named by what it measures, and keyed by everything that its result depends on: the bytes of its
inputs, its parameters, and the code that measures. A task whose key has changed is stale. The file is written
by one process, result by result, and can be read while that happens.
"""

import hashlib
import json
import sqlite3
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Final, Literal, Self

from filelock import FileLock, Timeout

from fingerpad._files import sha256_of
from fingerpad.exceptions import StoreError

FORMAT: Final = 2
STORE_NAME: Final = "store.sqlite"

_SCHEMA: Final = """
CREATE TABLE result (
    task TEXT PRIMARY KEY,
    key TEXT NOT NULL,
    status TEXT NOT NULL,
    seconds REAL NOT NULL,
    count INTEGER NOT NULL,
    drawn TEXT NOT NULL,
    finished TEXT NOT NULL,
    record TEXT NOT NULL
);
CREATE TABLE input (
    path TEXT PRIMARY KEY,
    stamp TEXT NOT NULL,
    digest TEXT NOT NULL
) WITHOUT ROWID;
"""


@dataclass(frozen=True, slots=True)
class Mark:
    """What is known of a task without its result.

    Attributes
    ----------
    key : str
        What the result depends on, hashed.
    status : {"done", "failed"}
        Whether anything was measured.
    seconds : float
        What it cost.
    count : int
        Number of pictures or frames that it dealt with.
    drawn : str
        Files drawn for it, relative to the output folder, a line each.
    """

    key: str
    status: Literal["done", "failed"]
    seconds: float
    count: int
    drawn: str


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
        if found < FORMAT:  # what an older one measured would be stale in any case
            drop = "DROP TABLE IF EXISTS result; DROP TABLE IF EXISTS input;"
            self._connection.executescript(f"BEGIN; {drop} {_SCHEMA} PRAGMA user_version={FORMAT}; COMMIT;")

    def marks(self) -> dict[str, Mark]:
        """Return what is known of every task by its name, without the results themselves."""
        with _plain_errors(self.path):
            rows = self._connection.execute("SELECT task, key, status, seconds, count, drawn FROM result")
            return {task: Mark(*rest) for task, *rest in rows}

    def record(self, task: str, key: str) -> dict[str, Any] | None:
        """Return the result of a task; None where there is none with this key."""
        with _plain_errors(self.path):
            row = self._connection.execute(
                "SELECT record FROM result WHERE task = ? AND key = ?", (task, key)
            ).fetchone()
        return None if row is None else json.loads(row[0])

    def put(
        self,
        task: str,
        key: str,
        record: Mapping[str, Any],
        *,
        seconds: float,
        count: int,
        drawn: Iterable[str] = (),
    ) -> None:
        """Keep a result, in place of what the task had before; one with a ``reason`` counts as failed.

        Parameters
        ----------
        task : str
            Its name.
        key : str
            What the result depends on, hashed.
        record : mapping
            The result.
        seconds : float
            What it cost.
        count : int
            Number of pictures or frames that it dealt with.
        drawn : iterable of str
            Files drawn for it, relative to the output folder.
        """
        row = (
            task,
            key,
            "done" if record.get("reason") is None else "failed",
            seconds,
            count,
            "\n".join(drawn),
            datetime.now(UTC).isoformat(timespec="seconds"),
            json.dumps(record),
        )
        with _plain_errors(self.path):
            self._connection.execute("INSERT OR REPLACE INTO result VALUES (?, ?, ?, ?, ?, ?, ?, ?)", row)

    def forget(self) -> None:
        """Remove all results."""
        with _plain_errors(self.path):
            self._connection.execute("DELETE FROM result")

    def digest(self, path: Path) -> str:
        """Return the SHA-256 of a file, or of the names and bytes of a folder's files; empty without any.

        The bytes are read again only when size, times or inode have changed.
        """
        stamp = _stamp(path)
        with _plain_errors(self.path):
            row = self._connection.execute(
                "SELECT digest FROM input WHERE path = ? AND stamp = ?", (str(path), stamp)
            ).fetchone()
            if row is not None:
                return str(row[0])
            digest = _digest(path) if stamp else ""
            self._connection.execute(
                "INSERT OR REPLACE INTO input VALUES (?, ?, ?)", (str(path), stamp, digest)
            )
        return digest

    def unchanged(self, path: Path) -> bool:
        """Tell whether a file or folder is still what `digest` last read."""
        with _plain_errors(self.path):
            row = self._connection.execute("SELECT stamp FROM input WHERE path = ?", (str(path),)).fetchone()
        return row is not None and row[0] == _stamp(path)


def _files(path: Path) -> list[Path]:
    return sorted(item for item in path.iterdir() if item.is_file()) if path.is_dir() else [path]


def _stamp(path: Path) -> str:
    """Return what changes with the content: the time of the last change of any kind cannot be set back."""
    try:
        stats = [(item.name, item.stat()) for item in _files(path)]
    except OSError:
        return ""
    parts = [(name, s.st_size, s.st_mtime_ns, s.st_ctime_ns, s.st_ino) for name, s in stats]
    return hashlib.sha256(repr(parts).encode()).hexdigest()


def _digest(path: Path) -> str:
    """Return the digest of a file, or that of a folder's names and digests; empty where that cannot be."""
    try:
        digests = [(item.name, sha256_of(item)) for item in _files(path)]
    except OSError:
        return ""
    if not path.is_dir():
        return digests[0][1]
    return hashlib.sha256("".join(f"{name}\0{digest}\n" for name, digest in digests).encode()).hexdigest()


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
