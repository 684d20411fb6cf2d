"""Starting, opening and closing studies, and running the one that is open."""

import os
from http import HTTPStatus
from typing import Annotated, Any, Final

from pydantic import Field

from fingerpad.exceptions import EditConflict
from fingerpad.study.editing.documents import STUDY_NAME
from fingerpad.study.editing.edit import create_study
from fingerpad.study.editing.incomplete import Kind
from fingerpad.study.editing.state import Edit
from fingerpad.web.bench import NAME, Bench
from fingerpad.web.operations import Operation, Question
from fingerpad.web.refusal import Refusal
from fingerpad.web.state import document

_Name = Annotated[str, Field(pattern=NAME, max_length=60)]


class NewQuestion(Question):
    """A study to start."""

    name: _Name
    title: Annotated[str, Field(max_length=200)] = ""


class OpenQuestion(Question):
    """A study of the workspace."""

    name: Annotated[str, Field(min_length=1, max_length=255)]


class RunQuestion(Question):
    """How to run."""

    workers: Annotated[int, Field(ge=1, le=64)] = 1
    fresh: bool = False


def session(bench: Bench, _: Any, __: Any) -> dict[str, Any]:
    """Return what there is to open, and what is open."""
    return bench.describe()


def new(bench: Bench, _: Any, asked: NewQuestion) -> dict[str, Any]:
    """Start a study in a new folder."""
    folder = bench.new_folder(asked.name)
    create_study(folder, asked.title or asked.name)
    return document(bench.open_folder(folder))


def open_study(bench: Bench, _: Any, asked: OpenQuestion) -> dict[str, Any]:
    """Open a study of the workspace."""
    return document(bench.open(asked.name))


class EditQuestion(Question):
    """One change of the manifest."""

    kind: Kind
    key: Annotated[str, Field(max_length=1000)]
    set: dict[str, Any] | None


class EditsQuestion(Question):
    """Some changes of the manifest as it was last seen."""

    expected: Annotated[str, Field(max_length=100)]
    edits: Annotated[list[EditQuestion], Field(min_length=1, max_length=10_000)]


def edit(bench: Bench, _: Any, asked: EditsQuestion) -> dict[str, Any]:
    """Change the manifest: all edits or none."""
    opened = bench.study
    edits = [Edit(kind=one.kind, key=one.key, set=one.set) for one in asked.edits]
    try:
        opened.change(edits, asked.expected)
    except EditConflict as conflict:
        raise Refusal.conflict(str(conflict), digest=opened.read().digest) from conflict
    found = document(opened)
    bench.events.tell("study", {"digest": found["digest"]})
    return found


def close(bench: Bench, _: Any, __: Any) -> dict[str, Any]:
    """Close the study."""
    bench.close()
    return bench.describe()


def run(bench: Bench, _: Any, asked: RunQuestion) -> dict[str, Any]:
    """Begin to run the study."""
    opened = bench.study
    opened.study()
    workers = min(asked.workers, os.cpu_count() or 1)
    return opened.running.start(
        opened.folder / STUDY_NAME,
        opened.out,
        workers=workers,
        fresh=asked.fresh,
        when_done=lambda: bench.events.tell("study", {"digest": opened.read().digest}),
    )


def progress(bench: Bench, _: Any, __: Any) -> dict[str, Any]:
    """Return how far the run is."""
    return bench.study.running.describe()


def cancel(bench: Bench, _: Any, __: Any) -> dict[str, Any]:
    """Stop the run; what it has measured is kept."""
    return bench.study.running.cancel()


OPERATIONS: Final = (
    Operation(
        method="GET", path="/api/session", answer=session, summary="What is open, and what there is to open"
    ),
    Operation(
        method="POST",
        path="/api/session/new",
        answer=new,
        body=NewQuestion,
        status=HTTPStatus.CREATED,
        summary="Start a study",
    ),
    Operation(
        method="POST", path="/api/session/open", answer=open_study, body=OpenQuestion, summary="Open a study"
    ),
    Operation(method="POST", path="/api/session/close", answer=close, summary="Close the study"),
    Operation(
        method="POST",
        path="/api/study/edits",
        answer=edit,
        body=EditsQuestion,
        summary="Change the manifest: all edits or none",
    ),
    Operation(
        method="POST",
        path="/api/run",
        answer=run,
        body=RunQuestion,
        status=HTTPStatus.ACCEPTED,
        summary="Run the study",
    ),
    Operation(method="GET", path="/api/run", answer=progress, summary="How far the run is"),
    Operation(
        method="POST",
        path="/api/run/cancel",
        answer=cancel,
        status=HTTPStatus.ACCEPTED,
        summary="Stop the run; what is done is kept",
    ),
)
