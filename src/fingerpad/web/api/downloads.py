"""Downloads: results of the last run, and the whole study as a ZIP."""

import os
from contextlib import ExitStack
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import Annotated

from fastapi import Path as PathParameter
from fastapi import Response
from starlette.background import BackgroundTask
from starlette.responses import FileResponse

from fingerpad.study.results.result_set import result_files
from fingerpad.study.share import Bundle, LeftOut, pack
from fingerpad.web.answers import Answer
from fingerpad.web.api.base import MEDIA_TYPES, Opened, router, saved_as
from fingerpad.web.errors import RequestError
from fingerpad.web.last_results import require_file
from fingerpad.web.security import FRAMED_HEADERS
from fingerpad.web.study_session import StudySession

FilePath = Annotated[str, PathParameter(max_length=300)]


class BundleContents(Answer):
    """What the ZIP of the study holds, and what it does not."""

    files: int
    bytes: int
    left_out: list[LeftOut]


@router.get("/download/{path:path}", response_class=Response)
def download(opened: Opened, path: FilePath, *, attachment: bool = False) -> Response:
    """Return a file of the results."""
    if path == "study.zip":
        return _zipped(opened)
    file = opened.out / path
    if path not in result_files(opened.out) or not file.resolve().is_relative_to(opened.out.resolve()):
        raise RequestError.not_there(f"{path[:80]!r} is no file of the last run: run the study")
    require_file(opened, path)
    headers = {"cache-control": "private, no-cache"} | (FRAMED_HEADERS if file.suffix == ".html" else {})
    if attachment:
        headers |= saved_as(file.name)
    kind = MEDIA_TYPES.get(file.suffix, "application/octet-stream")
    return FileResponse(file, media_type=kind, headers=headers)


@router.get("/bundle")
def bundle(opened: Opened) -> BundleContents:
    """Return the contents of the study's ZIP, and the files left out."""
    found = _bundle(opened)
    size = sum(os.stat(path).st_size for path in found.files.values())
    return BundleContents.of(found, files=len(found.files), bytes=size)


def _bundle(opened: StudySession) -> Bundle:
    loaded = opened.read()
    return Bundle.of(opened.folder, opened.out, loaded.files(), loaded.study.observations_csv)


def _zipped(opened: StudySession) -> Response:
    with ExitStack() as on_failure:
        with NamedTemporaryFile(prefix="fingerpad-", suffix=".zip", delete=False) as file:
            target = Path(file.name)
        on_failure.callback(target.unlink, missing_ok=True)
        try:
            pack(opened.folder, _bundle(opened), target)
        except OSError as error:
            raise RequestError.impossible(
                f"the ZIP cannot be made ({error.strerror}): make room in {target.parent}, "
                "or set TMPDIR to a folder with more and start fingerpad app again"
            ) from error
        on_failure.pop_all()
    sent = BackgroundTask(os.unlink, target)
    headers = saved_as(f"{opened.name}.zip")
    return FileResponse(target, media_type="application/zip", headers=headers, background=sent)
