"""Files of a study that are uploaded, removed and restored, and studies that are imported from a ZIP."""

import hashlib
import os
import re
import shutil
import unicodedata
from contextlib import ExitStack
from datetime import UTC, datetime
from http import HTTPStatus
from itertools import count
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import Annotated, Any, Final, TypeAlias
from uuid import uuid4

from fastapi import Response
from pydantic import Field
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request

from fingerpad._files import sha256_of
from fingerpad._tables import read_table
from fingerpad.exceptions import FingerpadError, ManifestError
from fingerpad.image import open_frames, read_image
from fingerpad.study.imports.identify import USABLE_SUFFIXES, kind_of_file
from fingerpad.study.imports.names import FileKind
from fingerpad.study.share import unpack
from fingerpad.web.answers import Answer, RequestError
from fingerpad.web.api.base import Body, Here, Item, Opened, Params, here, router
from fingerpad.web.api.state import State, state_of
from fingerpad.web.pictures import is_sequence
from fingerpad.web.study_session import StudySession
from fingerpad.web.workspace import NAME, name_of

FOLDER: Final = "uploads"
# Hidden, so that its contents do not count as files of the study.
_REMOVED: Final = ".removed"
_LONGEST: Final = 120
_Name: TypeAlias = Annotated[str, Field(max_length=500)]
_Folder: TypeAlias = Annotated[str, Field(pattern=rf"^$|{NAME}")]


class UploadedFile(Answer):
    """An uploaded file, with what its kind has: a table columns, pictures a size."""

    file: str
    kind: FileKind
    bytes: int
    rows_px: int | None = None
    columns_px: int | None = None
    resolution_ppi: float | None = None
    frames: int | None = None
    columns: list[str] | None = None


class Removal(Params):
    """The number by which a removed file can be restored."""

    removed: Annotated[str, Field(pattern=r"^\d{8}T\d{6}-[0-9a-f]{8}$")]


@router.post("/files", status_code=HTTPStatus.CREATED)
async def upload(
    opened: Opened, workspace: Here, request: Request, answer: Response, *, name: _Name, folder: _Folder = ""
) -> UploadedFile:
    """Add a file to the study, a frame to the folder of its sequence."""
    plain, home = plain_name(name), opened.folder / FOLDER / folder
    path, digest = await stored(request, workspace.upload_limit, home)

    def keep() -> UploadedFile:
        try:
            target = placed(path, home / plain, digest)
            new = not path.exists()
        finally:
            path.unlink(missing_ok=True)
        try:
            found = _described(opened, target)
        except FingerpadError as error:
            if new:
                target.unlink(missing_ok=True)
            raise RequestError.impossible(str(error).replace(f"{opened.folder}{os.sep}", "")) from error
        opened.tell_changed()
        if not new:
            answer.status_code = HTTPStatus.OK
        return found

    return await run_in_threadpool(keep)


def _described(opened: StudySession, path: Path) -> UploadedFile:
    """Return the kind and size of a file, which must be one that can be read."""
    kind, limit = kind_of_file(path.name), opened.pictures.memory_limit
    known: dict[str, Any] = {"file": path.relative_to(opened.folder).as_posix(), "bytes": path.stat().st_size}
    if kind == "table":
        header = read_table(path, ManifestError, head_only=True).header
        return UploadedFile(**known, kind=kind, columns=header)
    if is_sequence(path) and (frames := open_frames(path, memory_limit=limit).count) > 1:
        return UploadedFile(**known, kind="sequence", frames=frames)
    picture = read_image(path, memory_limit=limit)
    rows, columns = picture.pixels.shape
    ppi = picture.dots_per_inch
    return UploadedFile(**known, kind=kind, rows_px=rows, columns_px=columns, resolution_ppi=ppi, frames=1)


@here.post("/session/import", status_code=HTTPStatus.CREATED)
async def import_study(workspace: Here, request: Request, file: _Name = "", name: _Folder = "") -> State:
    """Import a study from a ZIP, and open it; its name follows from the file's unless it is given."""
    folder = workspace.new_folder(name or workspace.free_name(name_of(file.removesuffix(".zip"))))
    path, _ = await stored(request, workspace.room, workspace.workspace)

    def open_it() -> State:
        try:
            unpack(path, folder, workspace.room)
            return state_of(workspace.open_folder(folder))
        finally:
            path.unlink(missing_ok=True)

    return await run_in_threadpool(open_it)


@router.delete("/files")
def remove(opened: Opened, file: Item) -> Removal:
    """Move an uploaded file that is not used into a hidden folder."""
    path = opened.file(file)
    named = opened.read().files()
    used = {(opened.folder / name).resolve() for name in named if os.path.exists(opened.folder / name)}
    if not used.isdisjoint((path.resolve(), *path.resolve().parents)):
        raise RequestError.conflict(f"{file}: the study names this file: remove what names it first")
    if not file.startswith(f"{FOLDER}/"):
        raise RequestError.conflict(f"{file}: only files that were dropped on the page are removed by it")
    number = f"{datetime.now(UTC):%Y%m%dT%H%M%S}-{uuid4().hex[:8]}"
    kept = opened.folder / _REMOVED / number / path.relative_to(opened.folder)
    kept.parent.mkdir(parents=True)
    path.rename(kept)
    return Removal(removed=number)


@router.post("/files/restore")
def restore(opened: Opened, params: Body[Removal]) -> UploadedFile:
    """Restore a removed file, under another name if its own is taken."""
    home = opened.folder / _REMOVED / params.removed
    kept = next((path for path in home.rglob("*") if path.is_file()), None)
    if kept is None:
        raise RequestError.not_there(f"nothing that was removed is kept as {params.removed!r}")
    target = opened.folder / kept.relative_to(home)
    target.parent.mkdir(parents=True, exist_ok=True)
    back = placed(kept, target)
    shutil.rmtree(home, ignore_errors=True)
    return _described(opened, back)


def plain_name(name: str) -> str:
    """Return a file's name with letters, digits and _ + - only, and . in decimal fractions.

    The decimal point is kept, and a decimal comma becomes one: the load is read from the name, and 0.5N is
    not 5N.
    """
    last = unicodedata.normalize("NFC", re.split(r"[/\\]", name)[-1])
    stem, dot, suffix = last.rpartition(".")
    if not dot or f".{suffix.lower()}" not in USABLE_SUFFIXES:
        raise RequestError(
            HTTPStatus.UNSUPPORTED_MEDIA_TYPE,
            "only pictures (PNG, TIFF, JPEG, BMP, PGM), videos (AVI, MP4) and tables "
            "(CSV, TSV, XLSX, MAT, TDMS) can be used",
        )
    stem = re.sub(r"(?<=\d),(?=\d)", ".", stem)
    plain = re.sub(r"(?:(?!(?<=\d)\.(?=\d))[^\w+-])+", "-", stem).strip("-.+_")[:_LONGEST] or "file"
    return f"{plain}.{suffix}"


async def stored(request: Request, limit: int, folder: Path) -> tuple[Path, str]:
    """Stream a body of at most `limit` bytes into a file of `folder`; return its path and its SHA-256."""
    too_large = RequestError(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"the file is larger than {limit} bytes")
    announced = request.headers.get("content-length", "")
    if announced.isdecimal() and int(announced) > limit:
        raise too_large
    digest, size = hashlib.sha256(), 0
    try:
        await run_in_threadpool(folder.mkdir, parents=True, exist_ok=True)
        with NamedTemporaryFile(dir=folder, prefix=".upload-", delete=False) as file, ExitStack() as failed:
            path = Path(file.name)
            failed.callback(path.unlink, missing_ok=True)
            async for part in request.stream():
                size += len(part)
                if size > limit:
                    raise too_large
                digest.update(part)
                await run_in_threadpool(file.write, part)
            if not size:
                raise RequestError(HTTPStatus.BAD_REQUEST, "the file is empty: choose it again")
            file.flush()
            await run_in_threadpool(os.fsync, file.fileno())
            failed.pop_all()
            return path, digest.hexdigest()
    except OSError as error:
        raise RequestError.impossible(
            f"the file cannot be written ({error.strerror}): make room on the disk"
        ) from error


def placed(path: Path, target: Path, digest: str | None = None) -> Path:
    """Rename a file, with a number if the name is taken by a file of another SHA-256."""
    for number in count(1):
        free = target if number == 1 else target.with_stem(f"{target.stem}-{number}")
        try:
            free.touch(exist_ok=False)  # so that no other file is replaced
        except FileExistsError:
            if digest is not None and sha256_of(free) == digest:
                return free
        else:
            return path.replace(free)
    raise AssertionError
