"""Create, open, edit and run studies."""

import os
from http import HTTPStatus
from typing import Annotated, Any

from pydantic import Field

from fingerpad.exceptions import EditConflict
from fingerpad.study.editing.edit import Edit, create_study
from fingerpad.study.editing.template import write_example
from fingerpad.study.manifest.load import STUDY_NAME, Kind
from fingerpad.web.answers import study as answers
from fingerpad.web.endpoints import Params, endpoint
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


@endpoint("GET", "/api/session", "The open study, and the studies of the workspace", answers.Session)
def session(workspace: Workspace, _: Any, __: Any) -> dict[str, Any]:
    """Return the studies of the workspace and the open one."""
    return workspace.describe()


@endpoint("POST", "/api/session/new", "Create a study", answers.State, status=HTTPStatus.CREATED)
def new(workspace: Workspace, _: Any, params: NewParams) -> dict[str, Any]:
    """Create a study in a new folder."""
    folder = workspace.new_folder(params.name)
    create_study(folder, params.title or params.name)
    return document(workspace.open_folder(folder))


@endpoint(
    "POST",
    "/api/session/example",
    "Create the synthetic example study",
    answers.State,
    status=HTTPStatus.CREATED,
)
def example(workspace: Workspace, _: Any, __: Any) -> dict[str, Any]:
    """Write the example study into a new folder, and open it."""
    taken = {path.name for path in workspace.workspace.iterdir()}
    names = ("example", *(f"example-{number}" for number in range(2, 1000)))
    folder = workspace.new_folder(next(name for name in names if name not in taken))
    write_example(folder)
    return document(workspace.open_folder(folder))


@endpoint("POST", "/api/session/open", "Open a study", answers.State)
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


@endpoint("POST", "/api/studies/{study}/edits", "Change the manifest: all edits or none", answers.State)
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


@endpoint("POST", "/api/studies/{study}/run", "Run the study", answers.RunStatus, status=HTTPStatus.ACCEPTED)
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


@endpoint("GET", "/api/studies/{study}/run", "Status of the run", answers.RunStatus)
def progress(workspace: Workspace, _: Any, __: Any) -> dict[str, Any]:
    """Return the status of the run."""
    return workspace.study.run_job.describe()


@endpoint(
    "POST",
    "/api/studies/{study}/run/cancel",
    "Stop the run; finished measurements are kept",
    answers.RunStatus,
    status=HTTPStatus.ACCEPTED,
)
def cancel(workspace: Workspace, _: Any, __: Any) -> dict[str, Any]:
    """Stop the run; finished measurements are kept."""
    return workspace.study.run_job.cancel()
