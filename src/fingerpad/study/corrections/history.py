"""Corrections of one item, and which of them is active."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, Literal, TypeAlias

from fingerpad.exceptions import ManifestError, StoreError
from fingerpad.study.corrections.changes import (
    Change,
    ContactCorrection,
    PhotographCorrection,
    SequenceCorrection,
)
from fingerpad.study.manifest.validation import validated

CORRECTIONS_NAME: Final = "corrections.jsonl"
SECOND_OPERATOR_NAME: Final = "second_operator.jsonl"
_PHASES: Final = "#phases"

Action: TypeAlias = Literal["change", "undo", "redo"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Record:
    """One correction by one person.

    Attributes
    ----------
    id : int
        Its number in the file, from 1, rising.
    item : str
        What was corrected.
    when : str
        Time, ISO 8601, UTC.
    who : str
        The person.
    action : {"change", "undo", "redo"}
        What was done.
    change : dict
        All that is wanted of the item, as the model of `model_of` writes it; empty for what the program
        found, and for an undo or redo.
    picture : str
        SHA-256 of the picture's file, of the frame's pixels, or of a sequence's force, as it was then; empty
        where there is none.
    """

    id: int
    item: str
    when: str
    who: str
    action: Action
    change: dict[str, Any]
    picture: str = ""

    def as_json(self) -> dict[str, Any]:
        """Return it as its line of the file says it."""
        names = ("id", "item", "when", "who", "action", "change", "picture")
        return {name: getattr(self, name) for name in names}

    @property
    def words(self) -> str:
        """Who did what, and when."""
        what = ", ".join(self.change) or "everything back to the program's"
        did = f"changed {what}" if self.action == "change" else f"took a step ({self.action})"
        return f"{self.who} {did} at {self.when}"


@dataclass(frozen=True, slots=True, kw_only=True)
class ActiveCorrection:
    """The active correction of an item.

    Attributes
    ----------
    item : str
        The item.
    change : ContactCorrection, PhotographCorrection or SequenceCorrection
        What is wanted of it.
    who, when : str
        Who wanted it first, and when.
    picture : str
        That of the `Record`.
    pooling_who, pooling_when : str
        Who corrected whether it is pooled, and when; empty where no person did.
    """

    item: str
    change: Change
    who: str
    when: str
    picture: str = ""
    pooling_who: str = ""
    pooling_when: str = ""

    @property
    def key(self) -> list[Any]:
        """All of it that results depend on, for a digest."""
        return [self.item, self.who, self.change.as_json()]


def is_rejected(active_correction: ActiveCorrection | None) -> bool:
    """Tell whether a person rejected an item."""
    return active_correction is not None and active_correction.change.rejected is not None


@dataclass(frozen=True, slots=True, kw_only=True)
class History:
    """All corrections of one item.

    Attributes
    ----------
    item : str
        The item.
    records : tuple of Record
        In order.
    """

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
        change = checked_change(
            model_of(self.item), record.change, f"{CORRECTIONS_NAME}: record {record.id}: {self.item}"
        )
        pooling = _first_with_pooling(changes[:place])
        return ActiveCorrection(
            item=self.item,
            change=change,
            who=record.who,
            when=record.when,
            picture=record.picture,
            pooling_who=pooling.who if pooling else "",
            pooling_when=pooling.when if pooling else "",
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


def _first_with_pooling(changes: Sequence[Record]) -> Record | None:
    """Return the change that set what the last of some says of pooling; None where it says nothing."""
    found = None
    for record in reversed(changes):
        if (pooling := record.change.get("pooling")) is None or pooling != changes[-1].change.get("pooling"):
            break
        found = record
    return found


def phases_item(sequence: str) -> str:
    """Return the item under which the phases of a sequence are corrected."""
    return f"{sequence}{_PHASES}"


def sequence_of_phases(item: str) -> str | None:
    """Return the sequence whose phases an item is, None where it is another one."""
    return item.removesuffix(_PHASES) if item.endswith(_PHASES) and "/" not in item else None


def model_of(item: str) -> type[Change]:
    """Return the model of an item's corrections."""
    if "/" in item:
        return PhotographCorrection
    return ContactCorrection if sequence_of_phases(item) is None else SequenceCorrection


def checked_change(model: type[Change], content: Mapping[str, Any], where: str) -> Any:
    """Return a change, checked.

    Raises
    ------
    StoreError
        With one line for each fault.
    """
    try:
        return validated(model, content, where, strict=True)
    except ManifestError as error:
        raise StoreError(str(error)) from None


def line_of(record: Record) -> bytes:
    """Return the line of the file that holds a record, with its checksum."""
    content = record.as_json()
    return _dump({**content, "checksum": _checksum(content)}) + b"\n"


def record_of(line: bytes) -> Record | None:
    """Return the record that a line holds, None where it holds none.

    Raises
    ------
    ValueError
        If the line was changed after it was written. A line without a checksum was written manually.
    """
    try:
        content = json.loads(line)
        checksum = content.pop("checksum", None)
        record = Record(**content)
    except (ValueError, TypeError, AttributeError, RecursionError):
        return None
    texts = (record.item, record.when, record.who, record.picture)
    good = (
        all(isinstance(text, str) for text in texts)
        and type(record.id) is int
        and record.id > 0
        and record.action in ("change", "undo", "redo")
        and isinstance(record.change, dict)
    )
    if good and checksum is not None and checksum != _checksum(record.as_json()):
        raise ValueError("was changed after it was written")
    return record if good else None


def _checksum(content: Mapping[str, Any]) -> str:
    return hashlib.blake2b(_dump(content), digest_size=8).hexdigest()


def _dump(content: Mapping[str, Any]) -> bytes:
    return json.dumps(content, ensure_ascii=False, allow_nan=False).encode(errors="surrogatepass")
