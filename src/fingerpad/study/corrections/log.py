"""What people corrected in a study, with who and when: a file that is only ever added to.

``corrections.jsonl`` lies beside the manifest, one record a line. Each record of a change says all that is
wanted of its item, so that the newest is active. An undo or redo is a record too, and walks over earlier
changes. Automatic measurements are neither kept here nor overwritten.
"""

import hashlib
import os
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from threading import RLock
from typing import Any, Final

from fingerpad.exceptions import CorrectionConflict, StoreError
from fingerpad.study.corrections.changes import Change
from fingerpad.study.corrections.items import (
    CORRECTIONS_NAME,
    Action,
    ActiveCorrection,
    History,
    Record,
    checked_change,
    kind_of,
    line_of,
    model_of,
    named_kind,
    picture_digest,
    record_of,
)
from fingerpad.study.journal import locked, sync_folder
from fingerpad.study.manifest.models import Study

_LOCK: Final = ".corrections.lock"
_MOST_NAME: Final = 200


class CorrectionLog:
    """The corrections of a study folder, to which any process and thread may write meanwhile."""

    def __init__(self, folder: Path, name: str = CORRECTIONS_NAME) -> None:
        self._path = folder / name
        self._lock = RLock()
        self._forget()
        self.refresh()

    def _forget(self) -> None:
        self._stamp: object = None
        self._read = b""
        self._lines = 0
        self._last_id = 0
        self._torn = b""
        self._histories: dict[str, list[Record]] = {}

    @property
    def digest(self) -> str | None:
        """SHA-256 of the file as it was read last; None where there is none."""
        if self._stamp is None:
            return None
        return hashlib.sha256(self._read + self._torn).hexdigest()

    @property
    def count(self) -> int:
        """Number of records."""
        return sum(map(len, self._histories.values()))

    @property
    def notes(self) -> tuple[str, ...]:
        """What is odd in the file but does no harm."""
        if not self._torn:
            return ()
        line = f"{self._path.name}: line {self._lines + 1}"
        return (f"{line} is torn, as by a process stopped while it wrote; it is left out",)

    def refresh(self) -> None:
        """Read what has been written since."""
        try:
            with self._path.open("rb") as file:
                state = os.fstat(file.fileno())
                stamp = (state.st_size, state.st_mtime_ns, state.st_ino)
                if stamp == self._stamp:
                    return
                content = file.read()
        except FileNotFoundError:
            self._forget()
            return
        except OSError as error:
            raise StoreError(f"{self._path}: cannot be read ({error.strerror})") from error
        if not content.startswith(self._read):  # changed manually
            self._forget()
        try:
            self._take_all(content.removeprefix(self._read))
        except StoreError:
            self._forget()  # once it is mended, it is read from the start
            raise
        self._stamp = stamp

    def _take_all(self, fresh: bytes) -> None:
        whole, end, self._torn = fresh.rpartition(b"\n")
        lines = whole.split(b"\n") if end else []
        if self._torn and self._is_record(self._torn):  # its end of line was lost in an editor
            lines.append(self._torn)
            self._torn = b""
        for line in lines:
            self._take(line)
        self._read += fresh.removesuffix(self._torn)

    def _take(self, line: bytes) -> None:
        self._lines += 1
        if not line.strip():
            return
        where = f"{self._path}: line {self._lines}"
        try:
            record = record_of(line)
        except ValueError as error:
            raise StoreError(
                f'{where} {error}: fix or remove it; if it is meant so, remove its "checksum"'
            ) from None
        if record is None or record.id <= self._last_id:
            raise StoreError(f"{where} is no correction that follows those above it: fix or remove that line")
        self._last_id = record.id
        self._histories.setdefault(record.item, []).append(record)

    @staticmethod
    def _is_record(line: bytes) -> bool:
        try:
            return record_of(line) is not None
        except ValueError:
            return True  # the line is named when it is taken

    def history(self, item: str) -> History:
        """Return all corrections of an item."""
        with self._lock:
            self.refresh()
            return History(item=item, records=tuple(self._histories.get(item, ())))

    def active_correction(self, item: str) -> ActiveCorrection | None:
        """Return the active correction of an item; None where the automatic result holds."""
        return self.history(item).active_correction

    def active_corrections(self) -> dict[str, ActiveCorrection]:
        """Return the active corrections by item."""
        with self._lock:
            self.refresh()
            found = {
                item: History(item=item, records=tuple(records)).active_correction
                for item, records in self._histories.items()
            }
        return {item: active for item, active in found.items() if active is not None}

    def unknown_items(self, study: Study) -> list[str]:
        """Return the corrected items that a manifest does not name: they are kept, and wait."""
        self.refresh()
        return [item for item in self._histories if named_kind(item, study) is None]

    def append(
        self,
        item: str,
        change: Mapping[str, Any] | Change,
        *,
        who: str,
        expected: int,
        study: Study,
        shape: tuple[int, int] | None = None,
        picture: str | None = None,
    ) -> Record:
        """Keep a change on the disk; `expected` is `History.last_id` as the person saw it."""
        kind_of(item, study)
        content = change if isinstance(change, Mapping) else change.as_json()
        checked = checked_change(model_of(item), content, item)
        _require_picture(item, checked, study)
        if shape is not None and (fault := checked.outside(shape)):
            raise StoreError(f"{item}: {fault}")
        if picture is None:
            picture = picture_digest(item, study, self._path.parent)
        return self._add(
            item, "change", who=who, expected=expected, change=checked.as_json(), picture=picture
        )

    def undo(self, item: str, *, who: str, expected: int) -> Record:
        """Take the newest change of an item back; parameters and errors as for `append`."""
        return self._add(item, "undo", who=who, expected=expected)

    def redo(self, item: str, *, who: str, expected: int) -> Record:
        """Put back the change that was taken back last; parameters and errors as for `append`."""
        return self._add(item, "redo", who=who, expected=expected)

    def _add(
        self,
        item: str,
        action: Action,
        *,
        who: str,
        expected: int,
        change: dict[str, Any] | None = None,
        picture: str = "",
    ) -> Record:
        who = " ".join(who.split())
        if not 0 < len(who) <= _MOST_NAME:
            raise StoreError(f"{item}: a correction needs the name of who makes it, found {who[:40]!r}")
        with self._lock, locked(self._path, self._path.with_name(_LOCK)):
            history = self.history(item)
            if history.last_id != expected:
                latest = history.records[-1] if history.records else None
                since = latest.words if latest else "the corrections were removed"
                raise CorrectionConflict(f"{item}: {since}: look at it again before you correct it", latest)
            if (action == "undo" and not history.can_undo) or (action == "redo" and not history.can_redo):
                raise StoreError(f"{item}: there is nothing to {action}")
            record = Record(
                id=self._last_id + 1,
                item=item,
                when=datetime.now(UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z"),
                who=who,
                action=action,
                change=change or {},
                picture=picture,
            )
            self._write(line_of(record))
            self.refresh()
        return record

    def _write(self, line: bytes) -> None:
        """Add a line after the last whole one, and wait until it is on the disk."""
        new = not self._path.exists()
        with self._path.open("r+b" if not new else "xb") as file:
            # A torn line was never confirmed to anyone: it makes room.
            file.truncate(len(self._read))
            file.seek(len(self._read))
            if self._read and not self._read.endswith(b"\n"):
                line = b"\n" + line
            file.write(line)
            file.flush()
            os.fsync(file.fileno())
        if new:
            sync_folder(self._path.parent)


def _require_picture(item: str, change: Change, study: Study) -> None:
    """Refuse edits of an observation whose ellipse was measured elsewhere."""
    given = any(each.name == item and each.file is None for each in study.observations)
    if given and change.edits:
        raise StoreError(
            f"{item}: its ellipse was given, there is no picture to correct: accept or reject it, or change "
            "ellipse_mm in the manifest"
        )
