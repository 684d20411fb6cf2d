"""What people corrected in a study, with who and when: a file that is only ever added to.

``corrections.jsonl`` lies beside the manifest, one record a line. Each record of a change says all that is
wanted of its item, so that the newest is active. An undo or redo is a record too, and walks over earlier
changes. Automatic measurements are neither kept here nor overwritten.
"""

import hashlib
import json
import os
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import takewhile
from pathlib import Path
from threading import RLock
from typing import Annotated, Any, Final, Literal, TypeAlias

from pydantic import BaseModel, ConfigDict, Field

from fingerpad._files import digest_of, explain_write_errors
from fingerpad.exceptions import CorrectionConflict, ImageError, ManifestError, StoreError
from fingerpad.image import Frames, open_frames
from fingerpad.study.corrections.changes import (
    Change,
    ContactCorrection,
    PhotographCorrection,
    SequenceCorrection,
)
from fingerpad.study.journal import locked, sync_folder
from fingerpad.study.manifest.models import ContactSequence, Observation, Photograph, Study, validated

CORRECTIONS_NAME: Final = "corrections.jsonl"
SECOND_OPERATOR_NAME: Final = "second_operator.jsonl"
_PHASES: Final = "phases"

Action: TypeAlias = Literal["change", "undo", "redo"]


class Record(BaseModel):
    """One correction by one person."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    id: Annotated[int, Field(gt=0)]  # in the file, rising
    item: str
    when: str  # ISO 8601, UTC
    who: str
    action: Action
    # All that is wanted of the item; empty for the automatic result, and for an undo or redo.
    change: dict[str, Any]
    # SHA-256 of what was corrected, as of `picture_digest`.
    picture: str = ""

    @property
    def words(self) -> str:
        """Who did what, and when."""
        what = ", ".join(self.change) or "everything back to the program's"
        did = f"changed {what}" if self.action == "change" else f"took a step ({self.action})"
        return f"{self.who} {did} at {self.when}"


@dataclass(frozen=True, slots=True, kw_only=True)
class CorrectedPooling:
    """Whether a contact is pooled as a person wants it, and who said so first, and when."""

    include: bool
    why: str
    who: str
    when: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ActiveCorrection:
    """The active correction of an item."""

    item: str
    change: Change
    who: str
    when: str
    picture: str = ""
    pooling: CorrectedPooling | None = None


def is_rejected(active_correction: ActiveCorrection | None) -> bool:
    """Tell whether a person rejected an item."""
    return active_correction is not None and active_correction.change.rejected is not None


@dataclass(frozen=True, slots=True, kw_only=True)
class History:
    """All corrections of one item."""

    item: str
    records: tuple[Record, ...] = ()

    @property
    def last_id(self) -> int:
        """Number of the newest record, 0 where there is none: what an author has seen."""
        return self.records[-1].id if self.records else 0

    @property
    def can_undo(self) -> bool:
        """Whether there is a change to take back."""
        return self._place()[1] > 0

    @property
    def can_redo(self) -> bool:
        """Whether there is a change taken back."""
        changes, place = self._place()
        return place < len(changes)

    @property
    def active_correction(self) -> ActiveCorrection | None:
        """The active correction; None where the automatic result holds."""
        changes, place = self._place()
        if not place or not changes[place - 1].change:
            return None
        record = changes[place - 1]
        where = f"{CORRECTIONS_NAME}: record {record.id}: {self.item}"
        return ActiveCorrection(
            item=self.item,
            change=checked_change(self.item, record.change, where),
            who=record.who,
            when=record.when,
            picture=record.picture,
            pooling=_pooling(changes[:place]),
        )

    def _place(self) -> tuple[list[Record], int]:
        """Return the changes that undo and redo walk over, and how many of them hold."""
        changes: list[Record] = []
        place = 0
        for record in self.records:
            if record.action == "change":
                changes[place:] = [record]
                place += 1
            elif record.action == "undo":
                place = max(0, place - 1)
            else:
                place = min(len(changes), place + 1)
        return changes, place


def _pooling(changes: Sequence[Record]) -> CorrectedPooling | None:
    """Return what the last change says of pooling, by the one that set it; None where it says nothing."""
    if (wanted := changes[-1].change.get("pooling")) is None:
        return None
    same = takewhile(lambda record: record.change.get("pooling") == wanted, reversed(changes))
    *_, first = same
    return CorrectedPooling(**wanted, who=first.who, when=first.when)


ItemKind: TypeAlias = Literal["observation", "frame", "phases", "photograph"]
_MODELS: Final[Mapping[ItemKind, type[Change]]] = {
    "observation": ContactCorrection,
    "frame": ContactCorrection,
    "phases": SequenceCorrection,
    "photograph": PhotographCorrection,
}


def phases_item(sequence: str) -> str:
    """Return the item under which the phases of a sequence are corrected."""
    return f"{sequence}#{_PHASES}"


def parts_of_item(item: str) -> tuple[ItemKind, str, str]:
    """Return what an item is by its name alone, whose it is, and which picture or frame, empty for none."""
    if "/" in item:
        finger, _, picture = item.partition("/")
        return "photograph", finger, picture
    name, mark, frame = item.partition("#")
    if not mark:
        return "observation", name, ""
    return ("phases", name, "") if frame == _PHASES else ("frame", name, frame)


def checked_change(item: str, content: Mapping[str, Any], where: str) -> Any:
    """Return a change of an item, checked; `StoreError` has one line for each fault."""
    try:
        return validated(_MODELS[parts_of_item(item)[0]], content, where, strict=True)
    except ManifestError as error:
        raise StoreError(str(error)) from None


def _checksum(content: Mapping[str, Any]) -> str:
    return hashlib.blake2b(_dump(content), digest_size=8).hexdigest()


def _dump(content: Mapping[str, Any]) -> bytes:
    return json.dumps(content, ensure_ascii=False, allow_nan=False).encode(errors="surrogatepass")


_Corrected: TypeAlias = Observation | ContactSequence | Photograph


class Correctable:
    """What of a study can be corrected."""

    def __init__(self, study: Study) -> None:
        photographs = ((each.name, one) for each in study.fingers for one in each.photographs)
        self._tables: dict[str, _Corrected] = {
            **{f"{finger}/{one.file}": one for finger, one in photographs if one.file},
            **{one.name: one for one in study.observations},
            **{phases_item(one.name): one for one in study.sequences},
        }

    def table(self, item: str) -> _Corrected | None:
        """Return the table of an item, of a frame or phases their sequence's; None where there is none."""
        kind, name, part = parts_of_item(item)
        return self._tables.get(phases_item(name) if kind == "frame" and _is_frame(part) else item)

    def image(self, item: str) -> str | None:
        """Return the file of an item's picture, or of the force whose phases it is; None of a frame."""
        table = self.table(item)
        if isinstance(table, ContactSequence):
            return table.force if item == phases_item(table.name) else None
        return None if table is None else table.file


def kind_of(item: str, study: Study) -> ItemKind:
    """Return what an item is; `StoreError` where the manifest names no such item."""
    if Correctable(study).table(item) is None:
        raise StoreError(
            f"{item[:80]!r} is nothing that can be corrected: name an observation, a frame as SEQUENCE#12, "
            "the phases of a sequence as SEQUENCE#phases, or a photograph as FINGER/IMAGE, as the manifest "
            "has them"
        )
    return parts_of_item(item)[0]


def picture_digest(item: str, study: Study, folder: Path, digest: Callable[[str], str] | None = None) -> str:
    """Return the SHA-256 of an item's file, or of a frame's pixels; empty without any.

    `digest` gives that of a file of the study by its name, which is read otherwise.
    """
    known = Correctable(study)
    if (image := known.image(item)) is not None:
        return digest(image) if digest else digest_of(folder / image)
    if not isinstance(sequence := known.table(item), ContactSequence):
        return ""
    try:
        return sequence_frames(sequence, folder).at(int(parts_of_item(item)[2])).digest
    except ImageError:
        return ""


def sequence_frames(sequence: ContactSequence, folder: Path) -> Frames:
    """Return a sequence's frames, those of smooth contacts in colour: a gel shows a contact by it."""
    return open_frames(folder / sequence.file, colour=sequence.surface == "smooth")


def on_another_image(
    active_corrections: Mapping[str, ActiveCorrection], digest: Callable[[str], str]
) -> list[str]:
    """Return the items whose picture is not the one that was corrected; `digest` gives the current one's."""
    return [
        item
        for item, active_correction in active_corrections.items()
        if active_correction.picture and digest(item) not in {"", active_correction.picture}
    ]


def frames_of(
    active_corrections: Mapping[str, ActiveCorrection], sequence: str
) -> dict[int, ActiveCorrection]:
    """Return the active corrections of a sequence's frames, by the frame's number."""
    start = f"{sequence}#"
    named = ((item.removeprefix(start), item) for item in active_corrections if item.startswith(start))
    return {int(number): active_corrections[item] for number, item in named if _is_frame(number)}


def _is_frame(number: str) -> bool:
    """Tell whether a frame is numbered as the rows name it."""
    return number.isdecimal() and str(int(number)) == number


# How an image is measured. What was drawn, and the place of a contact, belong to one image alone.
_SHARED_SETTINGS: Final = ("dark_on_light", "threshold", "region_of_interest_px", "mask_px")


def similar_images(item: str, study: Study) -> list[str]:
    """Return the other contact images of the same finger with the same scale, as of one device."""
    one = Correctable(study).table(item)
    if not isinstance(one, Observation) or one.file is None:
        return []
    return [
        each.name
        for each in study.observations
        if each.file and each.name != item and (each.finger, each.scale) == (one.finger, one.scale)
    ]


def with_settings_of(source: ContactCorrection, target: ContactCorrection) -> ContactCorrection:
    """Return a correction with another one's settings and without a verdict; what was drawn stays."""
    settings = {name: value for name in _SHARED_SETTINGS if (value := getattr(source, name)) is not None}
    return target.model_copy(update={**settings, "accepted": False, "rejected": None})


CORRECTIONS_LOCK: Final = ".corrections.lock"
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
        line = f"{self._path.name}: line {self._next_line}"
        return (f"{line} is torn, as by a process stopped while it wrote; it is left out",)

    @property
    def _next_line(self) -> int:
        return self._read.count(b"\n") + 1

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
        with suppress(ValueError, RecursionError):
            json.loads(self._torn)  # it is whole: its end of line was lost in an editor
            lines.append(self._torn)
            self._torn = b""
        for number, line in enumerate(lines, self._next_line):
            if line.strip():
                self._take(line, f"{self._path}: line {number}")
        self._read += fresh.removesuffix(self._torn)

    def _take(self, line: bytes, where: str) -> None:
        record: Record | None
        try:
            content = json.loads(line)
            checksum = content.pop("checksum", None)
            record = Record.model_validate(content)
        except (ValueError, TypeError, AttributeError, RecursionError):
            record = checksum = None
        if record is not None and checksum not in {None, _checksum(record.model_dump())}:
            raise StoreError(
                f"{where} was changed after it was written: fix or remove it; if it is meant so, remove its "
                '"checksum"'
            )
        if record is None or record.id <= self._last_id:
            raise StoreError(f"{where} is no correction that follows those above it: fix or remove that line")
        self._last_id = record.id
        self._histories.setdefault(record.item, []).append(record)

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
        known = Correctable(study)
        return [item for item in self._histories if known.table(item) is None]

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
        checked = checked_change(item, content, item)
        table = Correctable(study).table(item)
        if checked.edits and isinstance(table, Observation) and table.file is None:
            raise StoreError(
                f"{item}: its ellipse was given, there is no picture to correct: accept or reject it, or "
                "change ellipse_mm in the manifest"
            )
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
        lock = locked(self._path, self._path.with_name(CORRECTIONS_LOCK))
        with self._lock, lock, explain_write_errors(self._path, error=StoreError):
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
            content = record.model_dump()
            self._write(_dump({**content, "checksum": _checksum(content)}) + b"\n")
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
