"""Uploads, import and export of a study as a ZIP, and downloads of results."""

import os
import re
import shutil
from contextlib import suppress
from dataclasses import asdict
from datetime import UTC, datetime
from http import HTTPStatus
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import Annotated, Any, Final, Literal
from uuid import uuid4

from fastapi import Path as PathParameter
from fastapi import Query, Response
from pydantic import Field
from starlette.background import BackgroundTask
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import FileResponse, StreamingResponse

from fingerpad.study.share import Bundle, pack, unpack
from fingerpad.web.answers import Answer
from fingerpad.web.api.base import Body, Here, Opened, Params, api_router, saved_as, study_router
from fingerpad.web.api.state import State, StateAfterRemoval, StateAfterRestore, document
from fingerpad.web.errors import RequestError
from fingerpad.web.events import CorrectionsEvent, RunStatus, StudyEvent
from fingerpad.web.last_results import require_file
from fingerpad.web.security import FRAMED_HEADERS
from fingerpad.web.study_session import StudySession
from fingerpad.web.uploads import FOLDER, kept, placed, plain_name, stored
from fingerpad.web.workspace import NAME

router = study_router()
here = api_router("/api")

# Hidden, so that its contents do not count as files of the study.
_REMOVED: Final = ".removed"
_TABLES: Final = (
    "report.html",
    "results.csv",
    "results_columns.csv",
    "by_load.csv",
    "repeatability.csv",
    "second_operator.csv",
    "results.json",
    "summary.json",
    "results.parquet",
    "results.mat",
)
_TYPES: Final = {
    ".html": "text/html",
    ".csv": "text/csv",
    ".json": "application/json",
    ".svg": "image/svg+xml",
    ".png": "image/png",
}
_DRAWN: Final = re.compile(
    r"(figures|overlays)/((photographs|sequences)/)?[^/\\\0]+\.(svg|png|json)|report/[^/\\\0]+\.html"
)


FilePath = Annotated[str, PathParameter(max_length=300)]


class UploadedFile(Answer):
    """An uploaded file."""

    file: str
    kind: Literal["picture", "sequence", "table", "other"]
    bytes: int
    rows_px: int | None
    columns_px: int | None
    resolution_ppi: float | None
    frames: int | None
    columns: list[str] | None
    problem: str | None


class LeftOutFile(Answer):
    """A file that the ZIP does not hold, and why."""

    file: str
    why: str


class BundleContents(Answer):
    """What the ZIP of the study holds."""

    files: int
    bytes: int
    left_out: list[LeftOutFile]


class EventStream(StreamingResponse):
    """Server-sent events."""

    media_type = "text/event-stream"


class UploadParams(Params):
    """Name of a file, and the folder for the frames of a sequence."""

    name: Annotated[str, Field(min_length=1, max_length=500)]
    folder: Annotated[str, Field(pattern=NAME)] | None = None


class ImportParams(Params):
    """Name of the imported study."""

    name: Annotated[str, Field(pattern=NAME)]


class RemoveParams(Params):
    """A file of the study."""

    file: Annotated[str, Field(min_length=1, max_length=1000)]


class RestoreParams(Params):
    """Number of a removed file."""

    removed: Annotated[str, Field(pattern=r"^\d{8}T\d{6}-[0-9a-f]{8}$")]


@router.post("/files", status_code=HTTPStatus.CREATED)
async def upload(
    opened: Opened,
    workspace: Here,
    params: Annotated[UploadParams, Query()],
    request: Request,
    answer: Response,
) -> UploadedFile:
    """Add a file to the study."""
    name = plain_name(params.name)
    target = opened.folder / FOLDER if params.folder is None else opened.folder / FOLDER / params.folder
    path, digest = await stored(request, workspace.upload_limit, target)

    def keep() -> dict[str, Any]:
        try:
            record, new = kept(opened, path, digest, name)
        finally:
            with suppress(OSError):
                path.unlink()
        if record["problem"] is not None:
            if new:
                (opened.folder / record["file"]).unlink(missing_ok=True)
            raise RequestError.impossible(record["problem"])
        opened.events.send("study", {"digest": opened.read().digest})
        if not new:
            answer.status_code = HTTPStatus.OK
        return record

    return UploadedFile.of(await run_in_threadpool(keep))


@here.post("/session/import", status_code=HTTPStatus.CREATED)
async def import_study(workspace: Here, params: Annotated[ImportParams, Query()], request: Request) -> State:
    """Import a study from a ZIP, and open it."""
    folder = workspace.new_folder(params.name)
    path, _ = await stored(request, workspace.room, workspace.workspace)

    def open_it() -> dict[str, Any]:
        try:
            unpack(path, folder, workspace.room)
            return document(workspace.open_folder(folder))
        finally:
            path.unlink(missing_ok=True)

    return State.of(await run_in_threadpool(open_it))


@router.get(
    "/events",
    response_class=EventStream,
    responses={200: {"model": StudyEvent | CorrectionsEvent | RunStatus}},
)
async def listen(opened: Opened) -> Response:
    """Stream events, each with its kind: ``study``, ``corrections`` or ``run``."""
    return EventStream(opened.events.listen())


@router.delete("/files")
def remove(opened: Opened, params: Body[RemoveParams]) -> StateAfterRemoval:
    """Move an uploaded file that is not used into a hidden folder."""
    path = opened.file(params.file)
    named = opened.read().files()
    used = {(opened.folder / name).resolve() for name in named if os.path.exists(opened.folder / name)}
    if not used.isdisjoint((path.resolve(), *path.resolve().parents)):
        raise RequestError.conflict(f"{params.file}: the study names this file: remove what names it first")
    if not params.file.startswith(f"{FOLDER}/"):
        raise RequestError.conflict(
            f"{params.file}: only files that were dropped on the page are removed by it"
        )
    number = f"{datetime.now(UTC):%Y%m%dT%H%M%S}-{uuid4().hex[:8]}"
    kept = opened.folder / _REMOVED / number / path.relative_to(opened.folder)
    kept.parent.mkdir(parents=True)
    path.rename(kept)
    return StateAfterRemoval.of({**document(opened), "removed": number})


@router.post("/files/restore")
def restore(opened: Opened, params: Body[RestoreParams]) -> StateAfterRestore:
    """Restore a removed file, under another name if its own is taken."""
    home = opened.folder / _REMOVED / params.removed
    kept = next((path for path in home.rglob("*") if path.is_file()), None)
    if kept is None:
        raise RequestError.not_there(f"nothing that was removed is kept as {params.removed!r}")
    target = opened.folder / kept.relative_to(home)
    target.parent.mkdir(parents=True, exist_ok=True)
    back = placed(kept, target)
    shutil.rmtree(home, ignore_errors=True)
    return StateAfterRestore.of({**document(opened), "restored": back.relative_to(opened.folder).as_posix()})


@router.get("/download/{path:path}", response_class=Response)
def download(opened: Opened, path: FilePath, *, attachment: bool = False) -> Response:
    """Return a file of the results."""
    if path == "study.zip":
        return _zipped(opened)
    if path not in _TABLES and not _DRAWN.fullmatch(path):
        raise RequestError.not_there(f"no file {path[:80]!r} can be downloaded here")
    file = opened.out / path
    if not file.is_file() or not file.resolve().is_relative_to(opened.out.resolve()):
        raise RequestError.not_there(f"{path}: not there yet: run the study")
    require_file(opened, path)
    headers = {"cache-control": "private, no-cache"} | (FRAMED_HEADERS if file.suffix == ".html" else {})
    if attachment:
        headers |= saved_as(file.name)
    return FileResponse(file, media_type=_TYPES.get(file.suffix, "application/octet-stream"), headers=headers)


@router.get("/bundle")
def bundle(opened: Opened) -> BundleContents:
    """Return the contents of the study's ZIP, and the files left out."""
    found = _bundle(opened)
    return BundleContents.of(
        {
            "files": len(found.files),
            "bytes": sum(os.stat(path).st_size for path in found.files.values()),
            "left_out": [asdict(one) for one in found.left_out],
        }
    )


def _bundle(opened: StudySession) -> Bundle:
    loaded = opened.read()
    return Bundle.of(opened.folder, opened.out, loaded.files(), loaded.study.observations_csv)


def _zipped(opened: StudySession) -> Response:
    with NamedTemporaryFile(prefix="fingerpad-", suffix=".zip", delete=False) as file:
        target = Path(file.name)
    try:
        pack(opened.folder, _bundle(opened), target)
    except OSError as error:
        target.unlink(missing_ok=True)
        raise RequestError.impossible(
            f"the ZIP cannot be made ({error.strerror}): make room in {target.parent}, or set TMPDIR to a "
            "folder with more and start fingerpad app again"
        ) from error
    except BaseException:
        target.unlink(missing_ok=True)
        raise
    return FileResponse(
        target,
        media_type="application/zip",
        headers=saved_as(f"{opened.name}.zip"),
        background=BackgroundTask(os.unlink, target),
    )
