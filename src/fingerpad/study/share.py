"""A study folder as one ZIP, and such a ZIP as a study folder; what comes from elsewhere is not trusted."""

import lzma
import os
import re
import shutil
import sqlite3
import stat
import struct
import time
import zipfile
import zlib
from collections.abc import Iterable
from contextlib import closing, nullcontext
from dataclasses import dataclass
from itertools import accumulate
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory
from typing import Final
from uuid import uuid4

from fingerpad._files import folded, leads_out
from fingerpad.exceptions import ArchiveError
from fingerpad.study.corrections.log import CORRECTIONS_LOCK, CORRECTIONS_NAME, SECOND_OPERATOR_NAME
from fingerpad.study.editing.template import SCHEMA_NAME
from fingerpad.study.engine.store import STORE_NAME
from fingerpad.study.journal import LOCK_NAME, locked
from fingerpad.study.manifest.load import STUDY_NAME
from fingerpad.study.results.result_set import OUTPUT_NAMES, RESULTS_NAME

# The files that the page changes together.
DOCUMENTS: Final = (STUDY_NAME, SCHEMA_NAME, CORRECTIONS_NAME, SECOND_OPERATOR_NAME)
_OF_A_RUN: Final = OUTPUT_NAMES | {STORE_NAME, "results.parquet", "results.mat", "results.xlsx"}
# Lock files of running programs.
_LOCKS: Final = frozenset((LOCK_NAME, CORRECTIONS_LOCK))
# What is in no file name on Windows, and the names that are devices there.
_NOWHERE: Final = '\\:*?"<>|'
_DEVICE: Final = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?", re.IGNORECASE)
LEFT_OUT_NAME: Final = "LEFT_OUT.txt"
_BESIDE_A_STORE: Final = frozenset((f"{STORE_NAME}-wal", f"{STORE_NAME}-shm", "store.lock"))


@dataclass(frozen=True, slots=True, order=True)
class LeftOut:
    """A file or folder that is not in the ZIP."""

    file: str  # its name in the study; that of a folder ends in a slash
    why: str


class Bundle:
    """The files of a study and its results."""

    def __init__(self, folder: Path, out: Path, named: Iterable[str], sheet: str | None = None) -> None:
        """List the files of a study; those that it has `named` also if hidden or behind links."""
        # Where each is, by its name in the study; the documents come first.
        self.files = {name: folder / name for name in DOCUMENTS if (folder / name).is_file()}
        self.folders: list[str] = []  # each with a slash at its end
        self.left_out: list[LeftOut] = []  # what the ZIP does not hold
        self._add_named(folder, sheet or "")
        documents = tuple(self.files)
        for name in sorted(named):
            self._add_named(folder, name)
        results = folder / RESULTS_NAME
        if out != results and results.is_dir():
            self._leave(f"{RESULTS_NAME}/", "other results than those that are open")
        for path, name in self._entries(folder, ""):
            of_a_run = path.is_dir() and path in {results, out}
            if not of_a_run and not (out == folder and name in _OF_A_RUN):
                self._add(path, name, folder, out)
        if out.is_dir():
            for path, name in self._entries(out, f"{RESULTS_NAME}/"):
                if not folder.is_relative_to(out) or path.name in _OF_A_RUN:
                    self._add(path, name, out, out)
        self._leave_unportable()
        # The files that the page changes together.
        self.documents = tuple(name for name in documents if name in self.files)
        self.left_out = sorted({one for one in self.left_out if one.file not in self.files})

    def _leave_unportable(self) -> None:
        """Leave out what a system without case, or with names of its own, could not unpack."""
        taken = {folded(LEFT_OUT_NAME): ""}
        for name in [*self.files, *dict.fromkeys(self.folders)]:
            bare = name.rstrip("/")
            ways = accumulate(bare.split("/"), "{}/{}".format)
            if not is_portable(bare):
                self._leave(name, f"a name that not every system can have: rename it without {_NOWHERE}")
            elif any(taken.setdefault(folded(way), way) != way for way in ways):
                self._leave(name, "another differs from it by case or accents only: rename one")
        left = {one.file for one in self.left_out}
        self.files = {name: path for name, path in self.files.items() if name not in left}
        self.folders = [name for name in dict.fromkeys(self.folders) if name not in left]

    def _leave(self, name: str, why: str) -> None:
        self.left_out.append(LeftOut(name, why))

    def _add_named(self, folder: Path, name: str) -> None:
        """Add a file that the study uses, or the frames in a folder."""
        path = folder / name
        if not name or not (os.path.isfile(path) or os.path.isdir(path)):
            return
        if leads_out(name) or not path.resolve().is_relative_to(folder.resolve()):
            return
        plain = "/".join(PurePosixPath(name).parts)
        if os.path.isfile(path):
            self.files.setdefault(plain, path)
            return
        for frame, frame_name in self._entries(path, plain and f"{plain}/"):
            if os.path.isfile(frame):
                self._add(frame, frame_name, folder, folder)

    def _entries(self, here: Path, prefix: str) -> list[tuple[Path, str]]:
        """Return the paths in a folder with their names, but for hidden ones."""
        try:
            names = sorted(os.listdir(here))
        except OSError as error:
            self._leave(prefix, f"cannot be read ({error.strerror})")
            return []
        for name in names:
            if name[0] == "." and name not in _LOCKS:
                slash = "/" if os.path.isdir(here / name) else ""
                self._leave(f"{prefix}{name}{slash}", "hidden: only what the study names in it is carried")
        aside = _BESIDE_A_STORE if STORE_NAME in names else frozenset()
        return [(here / name, prefix + name) for name in names if name[0] != "." and name not in aside]

    def _add(self, path: Path, name: str, home: Path, out: Path) -> None:
        """Add a file, or what is in a folder."""
        if name in self.files:
            if self.files[name].resolve() != path.resolve():
                self._leave(f"{name} (of the results)", "the study uses another file of this name")
            return
        linked = path.is_symlink()
        try:
            mode = path.stat().st_mode
            inside = not linked or path.resolve().is_relative_to(home.resolve())
        except OSError as error:
            self._leave(name, "a link that leads nowhere" if linked else f"cannot be read ({error.strerror})")
            return
        if not inside:
            self._leave(name, "a link that leaves the study folder")
        elif stat.S_ISREG(mode):
            self.files[name] = path
        elif not stat.S_ISDIR(mode):
            self._leave(name, "no file that can be copied")
        elif linked:
            self._leave(f"{name}/", "a link to a folder: only what the study names in it is carried")
        else:
            self.folders.append(f"{name}/")
            for inner, inner_name in self._entries(path, f"{name}/"):
                if inner != out:
                    self._add(inner, inner_name, home, out)


def is_portable(name: str) -> bool:
    """Tell whether every system can have a file of this name below the study folder."""
    return all(
        part not in {"", ".", ".."}
        and part[-1] not in ". "
        and not any(char in _NOWHERE or ord(char) < 32 or 0xD800 <= ord(char) < 0xE000 for char in part)
        and len(part.encode()) <= 255
        and not _DEVICE.fullmatch(part)
        for part in name.split("/")
    )


MOST_FILES: Final = 1_000_000
# Pictures hardly shrink; a file that grows a thousandfold is a bomb. Frames of a blank platen reach 500.
MOST_RATIO: Final = 1000
_SMALL: Final = 1_000_000
# What reading a damaged ZIP raises.
_DAMAGED: Final = (
    *(zipfile.BadZipFile, zipfile.LargeZipFile, zlib.error, lzma.LZMAError),
    *(struct.error, EOFError, RuntimeError, ValueError),
)


def pack(folder: Path, bundle: Bundle, target: Path) -> None:
    """Write a study's files into a ZIP, with a list of what is left out."""
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
    """Unpack a study into a new folder; it appears there whole, or not at all."""
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
    """Unpack one file, of which no more is read than it says it has, or make a folder."""
    if entry.is_dir():
        path.mkdir(parents=True, exist_ok=True)
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    with archive.open(entry) as source, path.open("xb") as target:
        shutil.copyfileobj(source, target)
