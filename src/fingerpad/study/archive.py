"""A study folder as one ZIP, and such a ZIP as a study folder; what comes from elsewhere is not trusted.

Files keep their names in the ZIP where every system can have them. The others, as names with colons or names
that differ by case only, are stored under a number, and an index says what they are called.
"""

import json
import lzma
import os
import re
import shutil
import sqlite3
import stat
import struct
import time
import unicodedata
import zipfile
import zlib
from collections.abc import Iterable, Mapping
from contextlib import closing, nullcontext
from itertools import accumulate
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory
from typing import Any, Final
from uuid import uuid4

from fingerpad.exceptions import ArchiveError
from fingerpad.study.atomic_files import locked
from fingerpad.study.bundle import Bundle, LeftOut
from fingerpad.study.engine.store import STORE_NAME
from fingerpad.study.journal import LOCK_NAME
from fingerpad.study.manifest.load import STUDY_NAME

MOST_FILES: Final = 1_000_000
LEFT_OUT_NAME: Final = "LEFT_OUT.txt"
# Pictures hardly shrink; a file that grows a thousandfold is a bomb. Frames of a blank platen reach 500.
MOST_RATIO: Final = 1000
_SMALL: Final = 1_000_000
_INDEX_FOLDER: Final = "fingerpad-bundle"
_INDEX_NAME: Final = f"{_INDEX_FOLDER}/index.json"
_RESERVED: Final = frozenset((_INDEX_FOLDER, LEFT_OUT_NAME.casefold()))
_WINDOWS: Final = frozenset('\\:*?"<>|')
_DEVICE: Final = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?", re.IGNORECASE)
_SUFFIX: Final = re.compile(r"\.\w{1,10}", re.ASCII)
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
    stored = _stored_names([*bundle.files, *bundle.folders])
    if len(stored) > MOST_FILES:
        raise ArchiveError(f"the study has {len(stored)} files and folders, more than {MOST_FILES}")
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
                    _add(archive, _settled(bundle.files[name], Path(scratch)), stored[name])

        # No document changes while the others are read.
        with locked(folder, folder / LOCK_NAME) if os.access(folder, os.W_OK) else nullcontext():
            add(bundle.documents)
        add(name for name in bundle.files if name not in bundle.documents)
        for name in bundle.folders:
            archive.writestr(stored[name], b"")
        renamed = {there: name for name, there in stored.items() if name != there}
        archive.writestr(_INDEX_NAME, json.dumps({"renamed": renamed}, indent=1))
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


def _stored_names(names: Iterable[str]) -> dict[str, str]:
    """Return the name in the ZIP of each file and folder: its own, if that is another's on no system."""
    taken: dict[str, str] = {}
    stored = {}
    for number, name in enumerate(names, 1):
        bare = name.rstrip("/")
        ways = accumulate(bare.split("/"), "{}/{}".format)
        if _is_portable(bare) and all(taken.setdefault(_folded(way), way) == way for way in ways):
            stored[name] = name
        else:
            suffix = PurePosixPath(bare).suffix
            end = "/" if name.endswith("/") else suffix if _SUFFIX.fullmatch(suffix) else ""
            stored[name] = f"{_INDEX_FOLDER}/renamed/{number}{end}"
    return stored


def _folded(name: str) -> str:
    """Return what names have in common that are one on a system without case or accents of two kinds."""
    return unicodedata.normalize("NFC", unicodedata.normalize("NFC", name).casefold())


def _is_portable(name: str) -> bool:
    """Tell whether every system can have a file of this name, and it is none of the ZIP's own."""
    parts = name.split("/")
    return _folded(parts[0]) not in _RESERVED and all(
        part not in {"", ".", ".."}
        and part[-1] not in ". "
        and not any(char in _WINDOWS or ord(char) < 32 or 0xD800 <= ord(char) < 0xE000 for char in part)
        and len(part.encode()) <= 255
        and not _DEVICE.fullmatch(part)
        for part in parts
    )


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
    if len(entries) > MOST_FILES + 2:  # with the index, and the list of what is left out
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
    index = found.pop(_INDEX_NAME, None)
    renamed = {} if index is None else _renamed(archive.read(index))
    if index is not None:
        found.pop(LEFT_OUT_NAME, None)
    names = [(entry, renamed.get(name, name)) for name, entry in found.items() if name]
    if len({name for _, name in names}) < len(names):
        raise ArchiveError("the ZIP holds two files of the same name")
    return names


def _renamed(index: bytes) -> Mapping[str, str]:
    """Return the names of the files that are stored under others."""
    content: Any = json.loads(index)
    renamed = content.get("renamed") if isinstance(content, dict) else None
    if not isinstance(renamed, dict) or not all(isinstance(name, str) for name in renamed.values()):
        raise ArchiveError(f"the ZIP's {_INDEX_NAME} is not as fingerpad writes it")
    for name in renamed.values():
        parts = name.rstrip("/").split("/")
        odd = not {"", ".", ".."}.isdisjoint(parts) or "\0" in name
        if odd or (os.name == "nt" and not _is_portable(name)):
            raise ArchiveError(f"the ZIP holds {name[:80]!r}, a name that no file here can have")
    return renamed


def _require_harmless(entry: zipfile.ZipInfo) -> None:
    name = entry.filename
    parts = PurePosixPath(name).parts
    if (
        not parts
        or name.startswith("/")
        or ".." in parts
        or any(char in _WINDOWS or ord(char) < 32 for char in name)
        or any(len(part.encode()) > 255 for part in parts)
    ):
        raise ArchiveError(f"the ZIP holds the name {name[:80]!r}, which leads out of the study folder")
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
