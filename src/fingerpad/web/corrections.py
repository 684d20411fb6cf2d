"""What people correct: kept by the library with who and when, undone and redone, lost by no second page."""

from collections.abc import Callable
from http import HTTPStatus
from typing import Annotated, Any, Final

from pydantic import Field

from fingerpad.exceptions import CorrectionConflict
from fingerpad.study.corrections.decisions import Record
from fingerpad.study.corrections.log import kind_of, on_another_picture
from fingerpad.web.asked import Item, Person
from fingerpad.web.bench import Bench
from fingerpad.web.open_study import OpenStudy
from fingerpad.web.operations import Operation, Question
from fingerpad.web.refusal import Refusal

_Seen = Annotated[int, Field(ge=0, le=2**53)]


class ItemQuestion(Question):
    """Which item."""

    item: Item


class StepQuestion(Question):
    """Whose step back or forth, after which record."""

    item: Item
    expected: _Seen
    who: Person


class ChangeQuestion(StepQuestion):
    """All that is wanted of an item."""

    change: dict[str, Any]


def document(opened: OpenStudy, item: str) -> dict[str, Any]:
    """Return all decisions about an item."""
    history = opened.corrections.history(item)
    ruling = history.ruling
    elsewhere = ruling and on_another_picture({item: ruling}, opened.picture_digest)
    return {
        "item": item,
        "last_id": history.last_id,
        "change": {} if ruling is None else ruling.change.as_json(),
        "ruling": ruling and {"who": ruling.who, "when": ruling.when},
        "on_another_picture": bool(elsewhere),
        "can_undo": history.can_undo,
        "can_redo": history.can_redo,
        "history": [record.as_json() for record in history.records],
    }


def show(bench: Bench, asked: ItemQuestion, _: Any) -> dict[str, Any]:
    """Return all decisions about an item."""
    opened = bench.study
    kind_of(asked.item, opened.study())
    return document(opened, asked.item)


def add(bench: Bench, _: Any, asked: ChangeQuestion) -> dict[str, Any]:
    """Keep a change; it is on the disk when this is answered."""
    opened = bench.study
    study = opened.study()
    kind_of(asked.item, study)
    return _kept(
        bench,
        asked,
        lambda: opened.corrections.append(
            asked.item,
            asked.change,
            who=asked.who,
            expected=asked.expected,
            study=study,
            shape=opened.shape_of(asked.item) if asked.change else None,
            picture=opened.picture_digest(asked.item),
        ),
    )


def undo(bench: Bench, _: Any, asked: StepQuestion) -> dict[str, Any]:
    """Take the newest change back."""
    log = bench.study.corrections
    return _kept(bench, asked, lambda: log.undo(asked.item, who=asked.who, expected=asked.expected))


def redo(bench: Bench, _: Any, asked: StepQuestion) -> dict[str, Any]:
    """Put the change back that was taken back last."""
    log = bench.study.corrections
    return _kept(bench, asked, lambda: log.redo(asked.item, who=asked.who, expected=asked.expected))


def _kept(bench: Bench, asked: StepQuestion, keep: Callable[[], object]) -> dict[str, Any]:
    opened = bench.study
    try:
        keep()
    except CorrectionConflict as conflict:
        latest = conflict.latest.as_json() if isinstance(conflict.latest, Record) else None
        now = document(opened, asked.item)
        raise Refusal.conflict(str(conflict), latest=latest, corrections=now) from conflict
    found = document(opened, asked.item)
    bench.events.tell("corrections", {"item": asked.item, "last_id": found["last_id"]})
    return found


OPERATIONS: Final = (
    Operation(
        method="GET",
        path="/api/corrections",
        answer=show,
        query=ItemQuestion,
        summary="What people corrected in an item",
    ),
    Operation(
        method="POST",
        path="/api/corrections",
        answer=add,
        body=ChangeQuestion,
        status=HTTPStatus.CREATED,
        summary="Correct an item",
    ),
    Operation(
        method="POST",
        path="/api/corrections/undo",
        answer=undo,
        body=StepQuestion,
        status=HTTPStatus.CREATED,
        summary="Take the newest change back",
    ),
    Operation(
        method="POST",
        path="/api/corrections/redo",
        answer=redo,
        body=StepQuestion,
        status=HTTPStatus.CREATED,
        summary="Put back what was taken back",
    ),
)
