"""Events that the server sends."""

from typing import Final

from fingerpad.web.answers.base import Answer
from fingerpad.web.answers.study import RunStatus


class StudyEvent(Answer):
    """Event ``study``: the manifest has changed."""

    digest: str


class CorrectionsEvent(Answer):
    """Event ``corrections``: an item was corrected."""

    item: str
    last_id: int


EVENTS: Final[dict[str, type[Answer]]] = {
    "study": StudyEvent,
    "corrections": CorrectionsEvent,
    "run": RunStatus,
}
