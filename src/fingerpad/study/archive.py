"""A study folder as one ZIP, and such a ZIP as a study folder; what comes from elsewhere is not trusted."""

import lzma
import os
import shutil
import sqlite3
import stat
import struct
import time
import zipfile
import zlib
from collections.abc import Iterable
from contextlib import closing, nullcontext
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final
from uuid import uuid4

from fingerpad.exceptions import ArchiveError
from fingerpad.study.atomic_files import locked
from fingerpad.study.bundle import LEFT_OUT_NAME, Bundle, LeftOut, is_portable
from fingerpad.study.engine.store import STORE_NAME
from fingerpad.study.journal import LOCK_NAME
from fingerpad.study.manifest.load import STUDY_NAME

MOST_FILES: Final = 1_000_000
# Pictures hardly shrink; a file that grows a thousandfold is a bomb. Frames of a blank platen reach 500.
MOST_RATIO: Final = 1000
_SMALL: Final = 1_000_000
# What reading a damaged ZIP raises.
_DAMAGED: Final = (
    zipfile.BadZipFile,
    zipfile.LargeZipFile,
    zlib.error,
    lzma.LZMAError,
    struct.error,
    NotImplementedError,
    EOFError,
    RuntimeError,
    ValueError,
)


def pack(folder: Path, bundle: Bundle, target: Path) -> None:
    """Write a study's files into a ZIP, with a list of what is left out.

    Raises
    ------
    ArchiveError
        If there are more files than an import takes.
    OSError
        If a file cannot be read to its end, or the ZIP cannot be written.
    """
    count = len(bundle.files) + len(bundle.folders)
    if count > MOST_FILES:
        raise ArchiveError(f"the study has {count} files and folders, more than {MOST_FILES}")
    left_out = list(bundle.left_out)
    with (
        TemporaryDirectory() as scratch,
        zipfile.ZipFile(
            target, "w", zipfile.ZIP_DEFLATED, compresslevel=1, strict_timestamps=False
        ) as archive,
    ):

        def add(names: Iterable[str]) -> None:
            for name in names:
                try:
                    bundle.files[name].open("rb").close()
                except OSError as error:
                    left_out.append(LeftOut(name, f"cannot be read ({error.strerror})"))
                else:
                    _add(archive, _settled(bundle.files[name], Path(scratch)), name)

        # No document changes while the others are read.
        with locked(folder, folder / LOCK_NAME) if os.access(folder, os.W_OK) else nullcontext():
            add(bundle.documents)
        add(name for name in bundle.files if name not in bundle.documents)
        for name in bundle.folders:
            archive.writestr(name, b"")
        if left_out:
            lines = "".join(f"{one.file}: {one.why}\n" for one in left_out)
            archive.writestr(LEFT_OUT_NAME, f"Not in this ZIP:\n\n{lines}".encode(errors="replace"))


def _add(archive: zipfile.ZipFile, path: Path, stored: str) -> None:
    try:
        time.localtime(path.stat().st_mtime)
    except (OverflowError, OSError):  # a date that no calendar has
        with path.open("rb") as source, archive.open(stored, "w", force_zip64=True) as target:
            shutil.copyfileobj(source, target)
    else:
        archive.write(path, stored)


def _settled(path: Path, scratch: Path) -> Path:
    """Return a file as it can be copied: of a store that a run writes to, a copy with all that it holds."""
    log = path.with_name(f"{STORE_NAME}-wal")
    if path.name != STORE_NAME or not log.exists() or not log.stat().st_size:
        return path
    copy = scratch / uuid4().hex
    try:
        with closing(sqlite3.connect(path)) as store, closing(sqlite3.connect(copy)) as other:
            store.backup(other)
    except sqlite3.Error:
        return path  # damaged: it travels as it is
    return copy


def unpack(source: Path, folder: Path, most_bytes: int) -> None:
    """Unpack a study into a new folder; it appears there whole, or not at all.

    Raises
    ------
    ArchiveError
        If the file is no ZIP, holds no study, or anything that a study does not hold.
    """
    beside = folder.with_name(f".{folder.name}.{uuid4().hex}")
    try:
        with zipfile.ZipFile(source) as archive:
            for entry, name in _checked(archive, most_bytes):
                _extract(archive, entry, beside / name)
        beside.rename(folder)
    except _DAMAGED as error:
        raise ArchiveError(f"this is no ZIP that can be read ({error})") from error
    except OSError as error:
        raise ArchiveError(f"the ZIP cannot be unpacked ({error.strerror or error})") from error
    finally:
        shutil.rmtree(beside, ignore_errors=True)


def _checked(archive: zipfile.ZipFile, most_bytes: int) -> list[tuple[zipfile.ZipInfo, str]]:
    """Return files and folders with their names below the study folder, if all of them are harmless."""
    entries = archive.infolist()
    if len(entries) > MOST_FILES + 1:  # with the list of what is left out
        raise ArchiveError(f"the ZIP holds {len(entries)} files, more than {MOST_FILES}")
    total = sum(entry.file_size for entry in entries)
    if total > most_bytes:
        raise ArchiveError(
            f"the ZIP unpacks to {total} bytes, and there is room for {most_bytes}: make room on the disk"
        )
    for entry in entries:
        _require_harmless(entry)
    prefix = _prefix(entries)
    entries = [entry for entry in entries if entry.filename.startswith(prefix)]
    files = [entry.filename.casefold() for entry in entries if not entry.is_dir()]
    if len(set(files)) < len(files):
        raise ArchiveError("the ZIP holds two files of the same name")
    found = {entry.filename.removeprefix(prefix): entry for entry in entries}
    found.pop(LEFT_OUT_NAME, None)
    return [(entry, name) for name, entry in found.items() if name]


def _require_harmless(entry: zipfile.ZipInfo) -> None:
    name = entry.filename
    if not is_portable(name.removesuffix("/")):
        raise ArchiveError(
            f"the ZIP holds the name {name[:80]!r}, which leads out of the study folder, or which not every "
            "system can have"
        )
    if stat.S_IFMT(entry.external_attr >> 16) not in {0, stat.S_IFREG, stat.S_IFDIR}:
        raise ArchiveError(f"the ZIP holds {name[:80]!r}, which is no plain file")
    if entry.flag_bits & 1:
        raise ArchiveError(f"the ZIP holds {name[:80]!r}, which is encrypted")
    if entry.file_size > _SMALL and entry.file_size > MOST_RATIO * max(entry.compress_size, 1):
        raise ArchiveError(f"the ZIP holds {name[:80]!r}, which unpacks to far more than it should")


def _prefix(entries: list[zipfile.ZipInfo]) -> str:
    """Return the folder in the ZIP that holds the study: its top, or a single folder there."""
    names = {entry.filename for entry in entries}
    if STUDY_NAME in names:
        return ""
    tops = {name.split("/")[0] for name in names}
    for top in sorted(tops):
        if f"{top}/{STUDY_NAME}" in names:
            return f"{top}/"
    raise ArchiveError("the ZIP holds no study: no study.toml lies at its top")


def _extract(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, path: Path) -> None:
    """Unpack one file, and no more of it than it says it has, or make a folder."""
    if entry.is_dir():
        path.mkdir(parents=True, exist_ok=True)
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    left = entry.file_size
    with archive.open(entry) as source, path.open("xb") as target:
        while part := source.read(min(1 << 20, left + 1)):
            left -= len(part)
            if left < 0:
                raise ArchiveError(f"the ZIP holds {entry.filename[:80]!r}, which is larger than it says")
            target.write(part)
