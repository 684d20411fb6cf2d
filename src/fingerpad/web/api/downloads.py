"""Downloads: files of the last run, its figures for publication, and the whole study as a ZIP."""

import os
import re
from contextlib import ExitStack
from fnmatch import fnmatch
from html import unescape
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import Annotated, Final, Literal

from fastapi import Depends, Response
from fastapi import Path as PathParameter
from starlette.background import BackgroundTask
from starlette.responses import FileResponse

from fingerpad._files import file_stem
from fingerpad.figures.marks import Figure
from fingerpad.figures.publish import FigureSettings, Format, figure_colours, figure_file, plain_text
from fingerpad.study.results.result_set import RERUN, result_files, result_set_faults
from fingerpad.study.share import Bundle, LeftOut, pack
from fingerpad.web.answers import Answer, RequestError
from fingerpad.web.api.base import ASK_AGAIN, Opened, router, saved_as
from fingerpad.web.security import FRAMED_HEADERS
from fingerpad.web.study_session import StudySession

# Media types of the files of results; `mimetypes` would ask the system.
_MEDIA_TYPES: Final = {
    ".html": "text/html; charset=utf-8",
    ".csv": "text/csv; charset=utf-8",
    ".json": "application/json",
    ".svg": "image/svg+xml",
    ".png": "image/png",
    ".pdf": "application/pdf",
}
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
    _require_intact(opened, path)
    headers = ASK_AGAIN | (FRAMED_HEADERS if file.suffix == ".html" else {})
    if attachment:
        headers |= saved_as(file.name)
    kind = _MEDIA_TYPES.get(file.suffix, "application/octet-stream")
    return FileResponse(file, media_type=kind, headers=headers)


def _require_intact(opened: StudySession, name: str) -> None:
    """Refuse a file of the results that is not what the last run wrote."""
    faults = result_set_faults(opened.out, is_checked=lambda one: one == name)
    if faults:
        raise RequestError.conflict(f"{'; '.join(faults)}: {RERUN}")


@router.get("/bundle")
def bundle(opened: Opened) -> BundleContents:
    """Return the contents of the study's ZIP, and the files left out."""
    found = _bundle(opened)
    size = sum(os.stat(path).st_size for path in found.files.values())
    return BundleContents.of(found, files=len(found.files), bytes=size)


def _bundle(opened: StudySession) -> Bundle:
    loaded = opened.read()
    return Bundle(opened.folder, opened.out, loaded.files(), loaded.study.observations_csv)


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


class FigureEntry(Answer):
    """A figure of the report, and the address of its drawing."""

    name: str
    caption: str
    svg: str


class FigureDetails(Answer):
    """What can be set of a figure, as it is in the report.

    Of the axes it is those on which all panels show one quantity, whose name is given.
    """

    width_mm: float
    height_mm: float
    colours: list[str]
    axes: dict[Literal["x", "y"], str]


_CAPTION: Final = re.compile(r'aria-label="([^"]+)"')


@router.get("/results/figures")
def figures(opened: Opened) -> list[FigureEntry]:
    """Return the report's figures with their captions."""
    opened.require_results()

    def entry(name: str) -> FigureEntry:
        drawing = f"figures/{name}.svg"
        with (opened.out / drawing).open(encoding="utf-8") as file:
            caption = _CAPTION.search(file.read(4000))
        words = unescape(caption[1]) if caption else name
        return FigureEntry(name=name, caption=words, svg=opened.address(f"/download/{drawing}"))

    return [entry(Path(one).stem) for one in result_files(opened.out) if fnmatch(one, "figures/*.svg")]


@router.get("/results/figure")
def figure(opened: Opened, name: str) -> FigureDetails:
    """Return what can be set of a figure, as it is in the report."""
    found = _figure(opened, name)
    labels = {axis: {plain_text(getattr(panel, axis).label) for panel in found.panels} for axis in "xy"}
    axes = {axis: name for axis, names in labels.items() if len(names) == 1 for name in names if name}
    return FigureDetails.of(found, colours=figure_colours(found), axes=axes)


@router.get("/results/figure/file", response_class=Response)
def figure_download(
    opened: Opened,
    name: str,
    kind: Format,
    settings: Annotated[FigureSettings, Depends()],
    *,
    attachment: bool = False,
) -> Response:
    """Return a figure as a file; what is left out of its settings stays as in the report."""
    content = figure_file(_figure(opened, name), kind, settings)
    saved = saved_as(f"{file_stem(name)}.{kind}") if attachment else {}
    return Response(content, media_type=_MEDIA_TYPES[f".{kind}"], headers=ASK_AGAIN | saved)


def _figure(opened: StudySession, name: str) -> Figure:
    opened.require_results()
    file = f"figures/{name}.json"
    if file not in result_files(opened.out):
        raise RequestError.not_there(f"{name[:80]!r}: no figure of the last run that can be set")
    _require_intact(opened, file)
    try:
        return Figure.of_json((opened.out / file).read_text(encoding="utf-8"))
    except ValueError as error:
        raise RequestError.conflict(f"{file}: is damaged: {RERUN}") from error
