"""Corrections of items: saved with author and time, undone and redone, and repeated by a second operator."""

from collections.abc import Callable
from functools import partial
from http import HTTPStatus
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import Field

from fingerpad.study.corrections.apply import contact_correction
from fingerpad.study.corrections.changes import ContactCorrection
from fingerpad.study.corrections.log import (
    CorrectedPooling,
    CorrectionLog,
    Record,
    kind_of,
    on_another_image,
    similar_images,
    with_settings_of,
)
from fingerpad.study.measuring.contacts import blind_order
from fingerpad.study.results.summary_file import OperatorAgreementRecord
from fingerpad.web.answers import Answer, Review, review_of
from fingerpad.web.api.base import Body, Item, Opened, Params, router
from fingerpad.web.events import CorrectionsEvent
from fingerpad.web.study_session import StudySession

# Whose corrections are meant.
_Operator: TypeAlias = Literal["first", "second"]


class Corrections(Answer):
    """The corrections of an item; `change` is the active one, `pooling` what it says of that, and who did."""

    item: str
    last_id: int
    change: dict[str, Any]
    pooling: CorrectedPooling | None
    on_another_image: bool
    can_undo: bool
    can_redo: bool
    history: list[Record]


class SimilarImage(Answer):
    """Another image of the same finger and device: its correction, and what it would become."""

    item: str
    last_id: int
    change: dict[str, Any]
    proposed: dict[str, Any]
    differs: bool


class SimilarImages(Answer):
    """The settings of an image's correction, and the images that they may apply to."""

    settings: dict[str, Any]
    images: list[SimilarImage]


class SecondOperatorImage(Review):
    """An image, and the second operator's review of it."""

    item: str


class SecondOperator(Answer):
    """Images that the first operator looked at, in random order, and how the second agrees.

    `unseen` are those that the first has not looked at yet.
    """

    first_operators: list[str]
    images: list[SecondOperatorImage]
    unseen: int
    agreement: list[OperatorAgreementRecord]


class StepParams(Params):
    """An item, author of an undo or redo, and the last record that they have seen."""

    item: Item
    operator: _Operator = "first"
    expected: Annotated[int, Field(ge=0, le=2**53)]
    who: Annotated[str, Field(max_length=60)]


class ChangeParams(StepParams):
    """The whole correction of an item."""

    change: dict[str, Any]


def _log(opened: StudySession, operator: _Operator) -> CorrectionLog:
    return opened.corrections if operator == "first" else opened.second_operator


def _corrections(opened: StudySession, item: str, operator: _Operator) -> Corrections:
    history = _log(opened, operator).history(item)
    active = history.active_correction
    return Corrections.of(
        history,
        change=active.change.as_json() if active else {},
        pooling=active.pooling if active else None,
        on_another_image=bool(active and on_another_image({item: active}, opened.picture_digest)),
        history=history.records,
    )


@router.get("/corrections")
def show(opened: Opened, item: Item, operator: _Operator = "first") -> Corrections:
    """Return the corrections of an item."""
    kind_of(item, opened.with_incomplete())
    return _corrections(opened, item, operator)


@router.post("/corrections", status_code=HTTPStatus.CREATED)
def add(opened: Opened, params: Body[ChangeParams]) -> Corrections:
    """Save a correction; it is on the disk before the response."""
    study = opened.with_incomplete()
    kind_of(params.item, study)
    save = partial(
        _log(opened, params.operator).append,
        change=params.change,
        study=study,
        shape=opened.shape_of(params.item) if params.change else None,
        picture=opened.picture_digest(params.item),
    )
    return _saved(opened, params, save)


@router.post("/corrections/undo", status_code=HTTPStatus.CREATED)
def undo(opened: Opened, params: Body[StepParams]) -> Corrections:
    """Undo the last correction."""
    return _saved(opened, params, _log(opened, params.operator).undo)


@router.post("/corrections/redo", status_code=HTTPStatus.CREATED)
def redo(opened: Opened, params: Body[StepParams]) -> Corrections:
    """Redo the correction that was undone last."""
    return _saved(opened, params, _log(opened, params.operator).redo)


def _saved(opened: StudySession, params: StepParams, save: Callable[..., object]) -> Corrections:
    """Save a step, tell every window of it, and return the corrections of the item."""
    save(params.item, who=params.who, expected=params.expected)
    found = _corrections(opened, params.item, params.operator)
    opened.events.send(CorrectionsEvent(item=params.item, last_id=found.last_id))
    return found


@router.get("/corrections/similar")
def similar(opened: Opened, item: Item) -> SimilarImages:
    """Return the images that a correction's settings may apply to, with their new corrections."""
    study = opened.with_incomplete()
    kind_of(item, study)
    source = contact_correction(opened.corrections.active_correction(item))

    def image(other: str) -> SimilarImage:
        history = opened.corrections.history(other)
        now = contact_correction(history.active_correction)
        proposed = with_settings_of(source, now)
        return SimilarImage(
            item=other,
            last_id=history.last_id,
            change=now.as_json(),
            proposed=proposed.as_json(),
            differs=proposed.edits != now.edits,
        )

    settings = with_settings_of(source, ContactCorrection()).as_json()
    return SimilarImages(settings=settings, images=[image(one) for one in similar_images(item, study)])


@router.get("/second-operator")
def second_operator(opened: Opened) -> SecondOperator:
    """Return the images in random order with the second operator's review, and the last run's agreement."""
    first, second = opened.corrections.active_corrections(), opened.second_operator.active_corrections()
    named = {one.name: one for one in opened.with_incomplete().observations if one.file and one.scale}
    looked = [
        name
        for name in named
        if (change := contact_correction(first.get(name))).accepted or (change.edits and not change.rejected)
    ]
    found = opened.results()
    return SecondOperator(
        first_operators=sorted({first[name].who for name in looked}),
        images=[SecondOperatorImage(item=one, **review_of(second.get(one))) for one in blind_order(looked)],
        unseen=len(named) - len(looked),
        agreement=found.summary.second_operator if found else [],
    )
