"""Create, open, edit and run studies, and hear what has changed."""

import getpass
import os
from collections.abc import AsyncIterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from http import HTTPStatus
from typing import Annotated, Any, Final, get_args

from fastapi.sse import EventSourceResponse, ServerSentEvent
from pydantic import Field

import fingerpad
from fingerpad._csv import package_table
from fingerpad.image import Face
from fingerpad.report.text import VERDICT_SYMBOLS
from fingerpad.study.editing.edit import Edit, create_study
from fingerpad.study.editing.template import write_example
from fingerpad.study.imports.names import AMBIGUOUS, FACES, NUMBER, TABLES, FileKind, Use
from fingerpad.study.manifest.load import STUDY_NAME
from fingerpad.study.manifest.models import SCALE_KINDS, ScaleTable
from fingerpad.study.new_files import TAKES, USES
from fingerpad.study.pipeline import run_study
from fingerpad.web.answers import Answer, RequestError
from fingerpad.web.api.base import Body, Here, Opened, Params, here, router
from fingerpad.web.api.state import State, state_of
from fingerpad.web.events import Event, RunStatus
from fingerpad.web.glossary import GLOSSARY, Symbol
from fingerpad.web.workspace import NAME, PLOTLY_ADDRESS, name_of, title_of

_Name = Annotated[str, Field(pattern=NAME, max_length=60)]


class StudyName(Answer):
    """A study of the workspace; the title is null where its manifest cannot be read."""

    name: str
    title: str | None


@dataclass(frozen=True, slots=True, kw_only=True)
class ScaleWay:
    """A way to state a scale."""

    needs: list[str]
    may: list[str]
    starts: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class KnownSize:
    """A length that everybody has at hand, mm."""

    size_mm: float
    words: str


SCALE_WAYS: Final[Mapping[str, ScaleWay]] = {
    way: ScaleWay(
        needs=[name for name, one in model.model_fields.items() if one.is_required()],
        may=[name for name, one in model.model_fields.items() if not one.is_required()],
        starts=TABLES["starts"].get(way, {}),
    )
    for way, model in zip(SCALE_KINDS, get_args(ScaleTable), strict=True)
}
# Cards are ISO/IEC 7810, format ID-1: bank cards, most identity cards and driving licences.
COINS, CARD = (
    tuple(
        KnownSize(size_mm=float(line["size_mm"]), words=f"{line['words']}, {line['size_mm']} mm")
        for line in package_table("fingerpad.web.api", "known_sizes.csv")
        if line["what"] == what
    )
    for what in ("coin", "card")
)


class EntryRules(Answer):
    """What can be entered: patterns of names and numbers, uses of files, scales, signs of verdicts.

    A number that fits `ambiguous` could be two.
    """

    # As NAME, in the regular expressions of browsers.
    name: str = r"[\p{L}\p{N}_][\p{L}\p{N}_.+\-]*"
    number: str = NUMBER
    ambiguous: str = AMBIGUOUS
    faces: tuple[Face, ...] = FACES
    uses: Mapping[FileKind, Mapping[Use, str]] = USES
    takes: Mapping[Use, Sequence[str]] = TAKES
    scale_ways: Mapping[str, ScaleWay] = SCALE_WAYS
    coins: tuple[KnownSize, ...] = COINS
    card: tuple[KnownSize, ...] = CARD
    verdicts: Mapping[str, str] = VERDICT_SYMBOLS


class Session(Answer):
    """What is open, what can be opened, symbols, rules of entries, and the address of Plotly's script."""

    version: str = fingerpad.__version__
    study: StudyName | None
    workspace: str
    studies: list[StudyName]
    who: str
    plotly: str = PLOTLY_ADDRESS
    glossary: Mapping[str, Symbol] = GLOSSARY
    rules: EntryRules = EntryRules()


class NewParams(Params):
    """Title of a new study, and the name of its folder, which follows from the title unless it is given."""

    title: Annotated[str, Field(max_length=200)] = ""
    name: _Name | None = None


class OpenParams(Params):
    """Name of a study of the workspace."""

    name: Annotated[str, Field(min_length=1, max_length=255)]


class RunParams(Params):
    """Options of a run, `incomplete` to leave out what lacks entries."""

    workers: Annotated[int, Field(ge=1, le=64)] = 1
    force: bool = False
    incomplete: bool = False


@here.get("/session")
def session(workspace: Here) -> Session:
    """Return the studies of the workspace and the one that was opened last."""
    last, who = workspace.last, ""
    with suppress(OSError, KeyError):  # systems without login names
        who = getpass.getuser()
    return Session.of(
        study=last and {"name": last.name, "title": last.study().title},
        workspace=workspace.workspace.name,
        studies=[
            {"name": name, "title": title_of(workspace.workspace / name)} for name in workspace.studies()
        ],
        who=who,
    )


@here.post("/session/new", status_code=HTTPStatus.CREATED)
def new(workspace: Here, params: Body[NewParams]) -> State:
    """Create a study in a new folder."""
    name = params.name or name_of(params.title.lower())
    folder = workspace.new_folder(name)
    create_study(folder, params.title or name)
    return state_of(workspace.open_folder(folder))


@here.post("/session/example", status_code=HTTPStatus.CREATED)
def example(workspace: Here) -> State:
    """Write the example study into a new folder, and open it."""
    folder = workspace.new_folder(workspace.free_name("example"))
    write_example(folder)
    return state_of(workspace.open_folder(folder))


@here.post("/session/open")
def open_study(workspace: Here, params: Body[OpenParams]) -> State:
    """Open a study of the workspace."""
    return state_of(workspace.open_folder(workspace.folder_of(params.name)))


class EditsParams(Params):
    """Edits of the manifest, whose digest is `expected`."""

    expected: Annotated[str, Field(max_length=100)]
    edits: Annotated[list[Edit], Field(min_length=1, max_length=10_000)]


@router.post("/edits")
def edit(opened: Opened, params: Body[EditsParams]) -> State:
    """Apply all edits to the manifest, or none."""
    opened.change(params.edits, params.expected)
    opened.tell_changed()
    return state_of(opened)


@router.get("/events", response_class=EventSourceResponse, responses={200: {"model": Event}})
async def listen(opened: Opened) -> AsyncIterator[ServerSentEvent]:
    """Stream events, each with its kind: ``study``, ``corrections`` or ``run``."""
    async for event in opened.events.listen():
        yield event


@router.post("/run", status_code=HTTPStatus.ACCEPTED)
def run(opened: Opened, params: Body[RunParams]) -> RunStatus:
    """Start a run of the study."""
    if opened.read().issues and not params.incomplete:
        faults = [one for one in opened.missing() if one.kind not in {"file", "folder"}]
        raise RequestError.impossible("; ".join(one.words for one in faults), faults=faults)
    workers = min(params.workers, os.cpu_count() or 1)
    options = params.model_dump() | {"workers": workers}
    measure = partial(run_study, opened.folder / STUDY_NAME, opened.out, **options)
    return opened.run_job.start(measure, when_done=opened.tell_changed)


@router.get("/run")
def progress(opened: Opened) -> RunStatus:
    """Return the status of the run."""
    return opened.run_job.describe()


@router.post("/run/cancel", status_code=HTTPStatus.ACCEPTED)
def cancel(opened: Opened) -> RunStatus:
    """Stop the run; finished measurements are kept."""
    return opened.run_job.cancel()
