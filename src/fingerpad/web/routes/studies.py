"""Create, open, close, edit and run studies."""

import os
from http import HTTPStatus
from typing import Annotated, Any, Final

from pydantic import Field

from fingerpad.exceptions import EditConflict
from fingerpad.study.editing.apply_edit import Edit
from fingerpad.study.editing.edit import create_study
from fingerpad.study.editing.example import write_example
from fingerpad.study.manifest.check import Kind
from fingerpad.study.manifest.load import STUDY_NAME
from fingerpad.web import answers
from fingerpad.web.endpoints import Endpoint, Params
from fingerpad.web.errors import RequestError
from fingerpad.web.routes.state import document
from fingerpad.web.workspace import NAME, Workspace

_Name = Annotated[str, Field(pattern=NAME, max_length=60)]


class NewParams(Params):
    """Name and title of a new study."""

    name: _Name
    title: Annotated[str, Field(max_length=200)] = ""


class OpenParams(Params):
    """Name of a study of the workspace."""

    name: Annotated[str, Field(min_length=1, max_length=255)]


class RunParams(Params):
    """Options of a run."""

    workers: Annotated[int, Field(ge=1, le=64)] = 1
    force: bool = False


def session(workspace: Workspace, _: Any, __: Any) -> dict[str, Any]:
    """Return the studies of the workspace and the open one."""
    return workspace.describe()


def new(workspace: Workspace, _: Any, params: NewParams) -> dict[str, Any]:
    """Create a study in a new folder."""
    folder = workspace.new_folder(params.name)
    create_study(folder, params.title or params.name)
    return document(workspace.open_folder(folder))


def example(workspace: Workspace, _: Any, __: Any) -> dict[str, Any]:
    """Write the example study into a new folder, and open it."""
    taken = {path.name for path in workspace.workspace.iterdir()}
    names = ("example", *(f"example-{number}" for number in range(2, 1000)))
    folder = workspace.new_folder(next(name for name in names if name not in taken))
    write_example(folder)
    return document(workspace.open_folder(folder))


def open_study(workspace: Workspace, _: Any, params: OpenParams) -> dict[str, Any]:
    """Open a study of the workspace."""
    return document(workspace.open(params.name))


class EditParams(Params):
    """One edit of the manifest."""

    kind: Kind
    key: Annotated[str, Field(max_length=1000)]
    set: dict[str, Any] | None


class EditsParams(Params):
    """Edits of the manifest, whose digest is `expected`."""

    expected: Annotated[str, Field(max_length=100)]
    edits: Annotated[list[EditParams], Field(min_length=1, max_length=10_000)]


def edit(workspace: Workspace, _: Any, params: EditsParams) -> dict[str, Any]:
    """Apply all edits to the manifest, or none."""
    opened = workspace.study
    edits = [Edit(kind=one.kind, key=one.key, set=one.set) for one in params.edits]
    try:
        opened.change(edits, params.expected)
    except EditConflict as conflict:
        raise RequestError.conflict(str(conflict), digest=opened.read().digest) from conflict
    found = document(opened)
    workspace.study.events.send("study", {"digest": found["digest"]})
    return found


def close(workspace: Workspace, _: Any, __: Any) -> dict[str, Any]:
    """Close the study."""
    workspace.close_study()
    return workspace.describe()


def run(workspace: Workspace, _: Any, params: RunParams) -> dict[str, Any]:
    """Start a run of the study."""
    opened = workspace.study
    opened.require_complete()
    workers = min(params.workers, os.cpu_count() or 1)
    return opened.run_job.start(
        opened.folder / STUDY_NAME,
        opened.out,
        workers=workers,
        force=params.force,
        when_done=lambda: opened.events.send("study", {"digest": opened.read().digest}),
    )


def progress(workspace: Workspace, _: Any, __: Any) -> dict[str, Any]:
    """Return the status of the run."""
    return workspace.study.run_job.describe()


def cancel(workspace: Workspace, _: Any, __: Any) -> dict[str, Any]:
    """Stop the run; finished measurements are kept."""
    return workspace.study.run_job.cancel()


ENDPOINTS: Final = (
    Endpoint(
        method="GET",
        path="/api/session",
        answer=session,
        model=answers.Session,
        summary="The open study, and the studies of the workspace",
    ),
    Endpoint(
        method="POST",
        path="/api/session/new",
        answer=new,
        model=answers.State,
        body=NewParams,
        status=HTTPStatus.CREATED,
        summary="Create a study",
    ),
    Endpoint(
        method="POST",
        path="/api/session/example",
        answer=example,
        model=answers.State,
        status=HTTPStatus.CREATED,
        summary="Create the synthetic example study",
    ),
    Endpoint(
        method="POST",
        path="/api/session/open",
        answer=open_study,
        model=answers.State,
        body=OpenParams,
        summary="Open a study",
    ),
    Endpoint(
        method="POST",
        path="/api/session/close",
        answer=close,
        model=answers.Session,
        summary="Close the study",
    ),
    Endpoint(
        method="POST",
        path="/api/study/edits",
        answer=edit,
        model=answers.State,
        body=EditsParams,
        summary="Change the manifest: all edits or none",
    ),
    Endpoint(
        method="POST",
        path="/api/run",
        answer=run,
        model=answers.RunStatus,
        body=RunParams,
        status=HTTPStatus.ACCEPTED,
        summary="Run the study",
    ),
    Endpoint(
        method="GET", path="/api/run", answer=progress, model=answers.RunStatus, summary="Status of the run"
    ),
    Endpoint(
        method="POST",
        path="/api/run/cancel",
        answer=cancel,
        model=answers.RunStatus,
        status=HTTPStatus.ACCEPTED,
        summary="Stop the run; finished measurements are kept",
    ),
)
