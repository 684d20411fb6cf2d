"""Uploaded files: streamed to the disk under safe names."""

import hashlib
import os
import re
import unicodedata
from contextlib import suppress
from http import HTTPStatus
from itertools import count
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import IO, Any, Final

from starlette.concurrency import run_in_threadpool
from starlette.requests import Request

from fingerpad._files import sha256_of
from fingerpad._tables import TABLE_SUFFIXES, read_table
from fingerpad.exceptions import FingerpadError, ManifestError
from fingerpad.image import open_frames, read_image
from fingerpad.image.sequence.frames import PICTURE_SUFFIXES, VIDEO_SUFFIXES
from fingerpad.web.errors import RequestError
from fingerpad.web.pictures import is_sequence, kind_of_file
from fingerpad.web.study_session import StudySession

FOLDER: Final = "uploads"
_LONGEST: Final = 120
_SUFFIXES: Final = PICTURE_SUFFIXES | VIDEO_SUFFIXES | TABLE_SUFFIXES


def plain_name(name: str) -> str:
    """Return a file's name with letters, digits and _ + - only, and . in decimal fractions.

    The decimal point is kept, and a decimal comma becomes one: the load is read from the name, and 0.5N is
    not 5N.

    Examples
    --------
    >>> plain_name("../../Finger (1).PNG"), plain_name("ü b.tif"), plain_name("30deg_0,5N.png")
    ('Finger-1.PNG', 'ü-b.tif', '30deg_0.5N.png')
    """
    last = unicodedata.normalize("NFC", re.split(r"[/\\]", name)[-1])
    stem, dot, suffix = last.rpartition(".")
    if not dot or f".{suffix.lower()}" not in _SUFFIXES:
        raise RequestError(
            HTTPStatus.UNSUPPORTED_MEDIA_TYPE,
            f"{name[-80:]!r}: only pictures (PNG, TIFF, JPEG, BMP, PGM), videos (AVI, MP4) and tables "
            "(CSV, TSV, XLSX, MAT, TDMS) can be used",
        )
    stem = re.sub(r"(?<=\d),(?=\d)", ".", stem)
    plain = re.sub(r"(?:(?!(?<=\d)\.(?=\d))[^\w+-])+", "-", stem).strip("-.+_")[:_LONGEST] or "file"
    return f"{plain}.{suffix}"


async def stored(request: Request, limit: int, folder: Path) -> tuple[Path, str]:
    """Stream a body into a file of `folder` and return its path and its SHA-256.

    Raises
    ------
    RequestError
        If it is larger than `limit` bytes, empty, or cannot be written.
    """
    announced = request.headers.get("content-length", "")
    if announced.isdecimal() and int(announced) > limit:
        raise _too_large(limit)
    try:
        await run_in_threadpool(folder.mkdir, parents=True, exist_ok=True)
        with NamedTemporaryFile(dir=folder, prefix=".upload-", delete=False) as file:
            try:
                return Path(file.name), await _written(request, limit, file)
            except BaseException:
                with suppress(OSError):
                    Path(file.name).unlink()
                raise
    except OSError as error:
        raise RequestError.impossible(
            f"the file cannot be written ({error.strerror}): make room on the disk"
        ) from error


async def _written(request: Request, limit: int, file: IO[bytes]) -> str:
    """Write a body to the disk as it arrives, and return its SHA-256."""
    digest, size = hashlib.sha256(), 0
    async for part in request.stream():
        size += len(part)
        if size > limit:
            raise _too_large(limit)
        digest.update(part)
        await run_in_threadpool(file.write, part)
    if not size:
        raise RequestError(HTTPStatus.BAD_REQUEST, "the file is empty: choose it again")
    file.flush()
    await run_in_threadpool(os.fsync, file.fileno())
    return digest.hexdigest()


def _too_large(limit: int) -> RequestError:
    return RequestError(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"the file is larger than {limit} bytes")


def kept(opened: StudySession, path: Path, digest: str, name: str) -> tuple[dict[str, Any], bool]:
    """Move an uploaded file into the study; return its description, and whether it is new."""
    target = placed(path, path.parent / name, digest)
    new = not path.exists()
    path.unlink(missing_ok=True)
    return described(opened, target), new


def placed(path: Path, target: Path, digest: str | None = None) -> Path:
    """Rename a file, with a number if the name is taken by a file of another SHA-256."""
    for number in count(1):
        free = target if number == 1 else target.with_stem(f"{target.stem}-{number}")
        try:
            _rename_to_free(path, free)
        except FileExistsError:
            if digest is not None and sha256_of(free) == digest:
                return free
        else:
            return free
    raise AssertionError


def _rename_to_free(path: Path, free: Path) -> None:
    """Rename a file, but never put it in the place of another."""
    try:
        os.link(path, free)
    except FileExistsError:
        raise
    except OSError:  # no hard links there
        free.touch(exist_ok=False)
        path.replace(free)
    else:
        path.unlink()


def described(opened: StudySession, path: Path) -> dict[str, Any]:
    """Return the kind and size of a file."""
    record: dict[str, Any] = {
        "file": path.relative_to(opened.folder).as_posix(),
        "kind": kind_of_file(path.name),
        "bytes": path.stat().st_size,
        "rows_px": None,
        "columns_px": None,
        "resolution_ppi": None,
        "frames": None,
        "columns": None,
        "problem": None,
    }
    try:
        if record["kind"] == "table":
            record["columns"] = read_table(path, ManifestError, head_only=True).header
        elif is_sequence(path) and (count := open_frames(path, memory_limit=opened.memory_limit).count) > 1:
            record |= {"kind": "sequence", "frames": count}
        else:
            picture = read_image(path, memory_limit=opened.memory_limit)
            record |= dict(zip(("rows_px", "columns_px"), picture.pixels.shape, strict=True))
            record |= {"resolution_ppi": picture.dots_per_inch, "frames": 1}
    except FingerpadError as error:
        record["problem"] = str(error).replace(f"{opened.folder}{os.sep}", "")
    return record
