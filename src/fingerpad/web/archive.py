"""A study folder as one ZIP, and such a ZIP as a study folder; what comes from elsewhere is not trusted."""

import os
import shutil
import stat
import zipfile
from collections.abc import Iterator
from pathlib import Path, PurePosixPath
from typing import Final
from uuid import uuid4

from fingerpad.study.editing.documents import DRAFT_NAME, STUDY_NAME
from fingerpad.web.refusal import Refusal

MOST_FILES: Final = 200_000
# Pictures hardly shrink; a file that grows a thousandfold is a bomb. Frames of a blank platen reach 500.
MOST_RATIO: Final = 1000
_SMALL: Final = 1_000_000
_WAL: Final = ("-wal", "-shm")
_MANIFESTS: Final = frozenset((STUDY_NAME, DRAFT_NAME))
_WINDOWS: Final = frozenset('\\:*?"<>|')


def packed(folder: Path, out: Path, target: Path) -> None:
    """Write a study and its results into `target`; the results lie in ``results`` wherever they are."""
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        for path in _plain_files(folder, leave=out):
            archive.write(path, path.relative_to(folder).as_posix())
        for path in _plain_files(out):
            archive.write(path, f"results/{path.relative_to(out).as_posix()}")


def _plain_files(folder: Path, leave: Path | None = None) -> Iterator[Path]:
    """Yield the files below a folder, without links and what belongs to running programs."""
    for here, folders, files in os.walk(folder):
        folders[:] = sorted(name for name in folders if name[0] != "." and Path(here, name) != leave)
        for name in sorted(files):
            path = Path(here, name)
            if name[0] != "." and not name.endswith((".lock", *_WAL)) and not path.is_symlink():
                yield path


def unpacked(source: Path, folder: Path, most_bytes: int) -> None:
    """Unpack a study into a new folder; it appears there whole, or not at all.

    Raises
    ------
    Refusal
        If the file is no ZIP, holds no study, or anything that a study does not hold.
    """
    beside = folder.with_name(f".{folder.name}.{uuid4().hex}")
    try:
        with zipfile.ZipFile(source) as archive:
            entries = _checked(archive, most_bytes)
            for entry, name in entries:
                _extract(archive, entry, beside / name)
        beside.rename(folder)
    except (zipfile.BadZipFile, zipfile.LargeZipFile, NotImplementedError, EOFError, RuntimeError) as error:
        raise Refusal.impossible(f"this is no ZIP that can be read ({error})") from error
    except OSError as error:
        raise Refusal.impossible(f"the ZIP cannot be unpacked ({error.strerror or error})") from error
    finally:
        shutil.rmtree(beside, ignore_errors=True)


def _checked(archive: zipfile.ZipFile, most_bytes: int) -> list[tuple[zipfile.ZipInfo, str]]:
    """Return the files with their names below the study folder, if all of them are harmless."""
    entries = [entry for entry in archive.infolist() if not entry.is_dir()]
    if len(entries) > MOST_FILES:
        raise Refusal.impossible(f"the ZIP holds {len(entries)} files, more than {MOST_FILES}")
    total = sum(entry.file_size for entry in entries)
    if total > most_bytes:
        raise Refusal.impossible(f"the ZIP unpacks to {total} bytes, more than {most_bytes}")
    for entry in entries:
        _require_harmless(entry)
    prefix = _prefix(entries)
    names = [
        (entry, entry.filename.removeprefix(prefix)) for entry in entries if entry.filename.startswith(prefix)
    ]
    folded = [name.casefold() for _, name in names]
    if len(set(folded)) != len(folded):
        raise Refusal.impossible("the ZIP holds two files of the same name")
    return names


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
        raise Refusal.impossible(f"the ZIP holds the name {name[:80]!r}, which leads out of the study folder")
    if (
        entry.external_attr >> 16
        and not stat.S_ISREG(entry.external_attr >> 16)
        and stat.S_IFMT(entry.external_attr >> 16)
    ):
        raise Refusal.impossible(f"the ZIP holds {name[:80]!r}, which is no plain file")
    if entry.flag_bits & 1:
        raise Refusal.impossible(f"the ZIP holds {name[:80]!r}, which is encrypted")
    if entry.file_size > _SMALL and entry.file_size > MOST_RATIO * max(entry.compress_size, 1):
        raise Refusal.impossible(f"the ZIP holds {name[:80]!r}, which unpacks to far more than it should")


def _prefix(entries: list[zipfile.ZipInfo]) -> str:
    """Return the folder in the ZIP that holds the study: its top, or a single folder there."""
    names = {entry.filename for entry in entries}
    if not names.isdisjoint(_MANIFESTS):
        return ""
    tops = {name.split("/")[0] for name in names}
    for top in sorted(tops):
        if any(f"{top}/{name}" in names for name in _MANIFESTS):
            return f"{top}/"
    raise Refusal.impossible("the ZIP holds no study: no study.toml lies at its top")


def _extract(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, path: Path) -> None:
    """Unpack one file, and no more of it than it says it has."""
    path.parent.mkdir(parents=True, exist_ok=True)
    left = entry.file_size
    with archive.open(entry) as source, path.open("xb") as target:
        while part := source.read(min(1 << 20, left + 1)):
            left -= len(part)
            if left < 0:
                raise Refusal.impossible(
                    f"the ZIP holds {entry.filename[:80]!r}, which is larger than it says"
                )
            target.write(part)
