"""What a study has measured so far: one SQLite file that outlives any run, and the files drawn meanwhile.

A task is named by what it measures, and keyed by everything that its result depends on: the bytes of its
inputs, its parameters, and the code that measures. A task whose key has changed is stale. The file is written
by one process, result by result, and can be read while that happens. Each result carries a checksum.

Files that tasks draw wait in a hidden folder, named by their digests, until results are put in place.
"""

import hashlib
import json
import shutil
import sqlite3
from collections.abc import Iterable, Iterator, Mapping
from contextlib import closing, contextmanager, suppress
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from functools import partial
from importlib.resources import files
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final, Literal, Self, TypeAlias, get_args

from filelock import FileLock, Timeout

from fingerpad._files import content_digest, content_stamp, leads_out, make_folder
from fingerpad.exceptions import StoreError
from fingerpad.study.engine.task import Limits, TaskResult

FORMAT: Final = 4
STORE_NAME: Final = "store.sqlite"
DRAWN_NAME: Final = ".drawn"

# Marks the file as a store of fingerpad ("fpad").
_APPLICATION_ID: Final = 0x66706164
_AWAY: Final = "move it away and run again, which measures everything again"

TaskState: TypeAlias = Literal["done", "failed"]
_NOTHING: Final[Mapping[str, str]] = MappingProxyType({})


class DamagedResultError(StoreError):
    """A stored result, that of `task`, is not what was written."""

    def __init__(self, path: Path, task: str) -> None:
        super().__init__(f"{path}: the stored result of {task} is damaged: {_AWAY}")
        self.task = task


@dataclass(frozen=True, slots=True)
class TaskStatus:
    """What is known of a task without its result."""

    key: str
    status: TaskState
    seconds: float
    count: int  # pictures or frames dealt with
    drawn: Mapping[str, str]  # digests of files by their names in the results
    limits: Limits | None  # that stopped it


class Store:
    """The results of a study in one SQLite file."""

    def __init__(self, path: Path, connection: sqlite3.Connection, *, read_only: bool) -> None:
        self.path = path
        self.folder = path.parent
        self._connection = connection
        self._read_only = read_only
        # Damaged bytes need not be text: they are found by their checksum.
        connection.text_factory = partial(str, encoding="utf-8", errors="surrogateescape")

    @classmethod
    @contextmanager
    def writing(cls, path: Path) -> Iterator[Self]:
        """Open the store at `path`, created if missing, for the one run that may write to it."""
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
            with _plain_errors(path):
                is_new = not path.exists() or not path.stat().st_size
                connection = sqlite3.connect(path, isolation_level=None)
            with closing(connection):
                store = cls(path, connection, read_only=False)
                with _plain_errors(path):
                    if is_new:
                        schema = files("fingerpad.study.engine").joinpath("store.sql").read_text()
                        marks = f"PRAGMA application_id={_APPLICATION_ID}; PRAGMA user_version={FORMAT};"
                        connection.executescript(f"BEGIN; {schema} {marks} COMMIT;")
                    store._require_own()
                    connection.execute("PRAGMA journal_mode=WAL")
                    # A killed process loses nothing, a power cut the last results.
                    connection.execute("PRAGMA synchronous=NORMAL")
                yield store
        finally:
            lock.release()

    @classmethod
    @contextmanager
    def reading(cls, path: Path) -> Iterator[Self]:
        """Open the store at `path` and write nothing, neither into it nor beside it."""
        # Without a log beside it the file is complete; a log's index is there while a run writes.
        alone = not path.with_name(f"{path.name}-wal").exists()
        uri = f"{path.absolute().as_uri()}?{'immutable=1' if alone else 'mode=ro'}"
        with _plain_errors(path):
            connection = sqlite3.connect(uri, uri=True, isolation_level=None)
        with closing(connection):
            store = cls(path, connection, read_only=True)
            with _plain_errors(path):
                store._require_own()
            yield store

    def _require_own(self) -> None:
        application, version, tables = (
            self._connection.execute(query).fetchone()[0]
            for query in (
                "PRAGMA application_id",
                "PRAGMA user_version",
                "SELECT count(*) FROM sqlite_master WHERE name IN ('result', 'input')",
            )
        )
        if application != _APPLICATION_ID and not (tables == 2 and 0 < version < FORMAT):
            raise sqlite3.DatabaseError("made by another program")
        if version != FORMAT:
            age = "a newer" if version > FORMAT else "an older"
            raise StoreError(
                f"{self.path}: written by {age} fingerpad (format {version}; this one reads {FORMAT}): "
                f"{_AWAY}"
            )
        # Not the quick one, to which an index that hides a result is sound.
        if self._connection.execute("PRAGMA integrity_check(1)").fetchone()[0] != "ok":
            raise sqlite3.DatabaseError("damaged")

    def _execute(self, query: str, *values: object) -> list[Any]:
        """Return the rows that a query gives."""
        with _plain_errors(self.path):
            return self._connection.execute(query, values).fetchall()

    def statuses(
        self, tasks: Iterable[str] | None = None, *, only_drawn: bool = False
    ) -> dict[str, TaskStatus]:
        """Return what is known of all tasks, of some, or of those with drawn files, without their results."""
        query = "SELECT task, key, status, seconds, count, drawn, limits FROM result"
        if tasks is None:
            rows = self._execute(f"{query} WHERE drawn <> '{{}}'" if only_drawn else query)
        else:
            rows = [row for task in tasks for row in self._execute(f"{query} WHERE task = ?", task)]
        found = {}
        for task, key, status, seconds, count, drawn, limits in rows:
            if status not in get_args(TaskState):
                continue  # damaged: as good as not there
            with suppress(ValueError, TypeError):  # the same
                found[task] = TaskStatus(
                    key=key,
                    status=status,
                    seconds=float(seconds),
                    count=int(count),
                    # Most draw nothing, and nothing stopped them.
                    drawn=_NOTHING if drawn == "{}" else json.loads(drawn),
                    limits=None if limits == "null" else Limits(**json.loads(limits)),
                )
        return found

    def record(self, task: str, key: str) -> dict[str, Any] | None:
        """Return the result of a task, None where there is none with this key; `DamagedResultError`."""
        rows = self._execute("SELECT * FROM result WHERE task = ? AND key = ?", task, key)
        if not rows:
            return None
        if not _is_intact(rows[0]):
            raise DamagedResultError(self.path, task)
        found: dict[str, Any] = json.loads(rows[0][-2])
        return found

    def damaged(self) -> list[str]:
        """Return the names of tasks whose stored result is not what was written."""
        with _plain_errors(self.path):
            rows = self._connection.execute("SELECT * FROM result")
            return [str(row[0]) for row in rows if not _is_intact(row)]

    def discard(self, tasks: list[str] | None = None) -> None:
        """Remove the results of some tasks, or of all."""
        if tasks is None:
            self._execute("DELETE FROM result")
        for task in tasks or ():
            self._execute("DELETE FROM result WHERE task = ?", task)

    def put(self, task: str, key: str, result: TaskResult, *, count: int) -> None:
        """Store a result of so many pictures or frames; one with a ``reason`` failed."""
        drawn = {name: self._put_drawn(name, content) for name, content in result.drawn.items()}
        row = (
            task,
            key,
            "done" if result.record.get("reason") is None else "failed",
            float(result.seconds),
            count,
            json.dumps(drawn),
            json.dumps(result.limits and asdict(result.limits)),
            datetime.now(UTC).isoformat(timespec="seconds"),
            json.dumps(result.record),
        )
        query = "INSERT OR REPLACE INTO result VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)"
        self._execute(query, *row, _checksum(row))

    def is_current(self, status: TaskStatus | None, key: str, limits: Limits) -> bool:
        """Tell whether a result still holds: what stricter limits stopped and an empty key do not."""
        if status is None or not key or status.key != key:
            return False
        if status.limits is not None and limits.exceed(status.limits):
            return False
        return all(self.drawn_file(name, digest) is not None for name, digest in status.drawn.items())

    def drawn_file(self, name: str, digest: str) -> Path | None:
        """Return where a file is that was drawn for the results; None where it is not as it was drawn."""
        if leads_out(name):  # in a store from elsewhere
            return None
        waiting = self._waiting(name, digest)
        if waiting.is_file():
            return waiting
        placed = self.folder / name
        return placed if self.digest(placed) == digest else None

    def _put_drawn(self, name: str, content: bytes) -> str:
        digest = hashlib.sha256(content).hexdigest()
        path = self._waiting(name, digest)
        make_folder(path.parent)
        part = path.with_suffix(".part")
        try:
            part.write_bytes(content)
            part.replace(path)
        except OSError as error:
            part.unlink(missing_ok=True)
            raise StoreError(
                f"{self.folder / name}: cannot be written ({error.strerror}): what was measured before is "
                "kept; make room, or choose another --out, and run again to go on"
            ) from error
        return digest

    def _waiting(self, name: str, digest: str) -> Path:
        return self.folder / DRAWN_NAME / f"{digest}{Path(name).suffix}"

    def keep_drawn(self, placed: Mapping[str, str]) -> None:
        """Keep of drawn files those in place, by name and digest, and no result whose files are not."""
        self.discard(
            [
                task
                for task, status in self.statuses(only_drawn=True).items()
                if not status.drawn.items() <= placed.items()
            ]
        )
        shutil.rmtree(self.folder / DRAWN_NAME, ignore_errors=True)

    def digest(self, path: Path) -> str:
        """Return the SHA-256 of a file or of a folder's files, read only where changed; empty without any."""
        name, stamp = _as_text(path), content_stamp(path)
        query = "SELECT path, stamp, digest, checksum FROM input WHERE path = ? AND stamp = ?"
        rows = self._execute(query, name, stamp)
        if rows and _is_intact(rows[0]):
            return str(rows[0][2])
        digest = content_digest(path) if stamp else ""
        if not self._read_only:
            self.remember(path, digest, stamp)
        return digest

    def remember(self, path: Path, digest: str, stamp: str | None = None) -> None:
        """Keep the SHA-256 of a file, by default of its current content, for `digest`."""
        values = _as_text(path), content_stamp(path) if stamp is None else stamp, digest
        self._execute("INSERT OR REPLACE INTO input VALUES (?, ?, ?, ?)", *values, _checksum(values))

    def unchanged(self, path: Path) -> bool:
        """Tell whether a file or folder is still what `digest` last read."""
        rows = self._execute("SELECT stamp FROM input WHERE path = ?", _as_text(path))
        return [stamp for (stamp,) in rows] == [content_stamp(path)]


def _checksum(values: tuple[object, ...]) -> str:
    return hashlib.blake2b(repr(values).encode(errors="surrogatepass"), digest_size=16).hexdigest()


def _as_text(path: Path) -> str:
    """Return a path as text that SQLite takes: names of files may be no UTF-8, and damage makes them so."""
    return str(path).encode(errors="backslashreplace").decode()


def _is_intact(row: tuple[object, ...]) -> bool:
    """Tell whether a row, with its checksum last, is what was written."""
    return _checksum(row[:-1]) == row[-1]


@contextmanager
def _plain_errors(path: Path) -> Iterator[None]:
    """Turn errors of SQLite into plain words, with the way out."""
    try:
        yield
    except sqlite3.OperationalError as error:
        text = str(error)
        if "full" in text:
            way_out = "the disk is full: make room and run again; what was measured before is kept"
        elif "I/O" in text:
            way_out = f"{text}: make room on the disk, or check it, and run again"
        elif "locked" in text or "busy" in text:
            way_out = "another process is writing to it: wait for it to end"
        elif "readonly" in text or "unable to open" in text:
            way_out = "cannot be written: check the folder's rights, or choose another with --out"
        else:
            way_out = f"cannot be used ({text}): {_AWAY}"
        raise StoreError(f"{path}: {way_out}") from error
    except (sqlite3.DatabaseError, UnicodeDecodeError) as error:  # a message may quote damaged bytes
        raise StoreError(f"{path}: damaged or no store of fingerpad ({error}): {_AWAY}") from error
