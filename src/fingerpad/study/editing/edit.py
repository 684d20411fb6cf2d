"""Changing a study's manifest by program: comments and order stay, and what is complete stays so.

A table may be written before it is complete: `load_study` tells what it lacks.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

import tomlkit

from fingerpad.exceptions import EditConflict, ManifestError, StoreError
from fingerpad.study.atomic_files import locked
from fingerpad.study.editing.apply_edit import Edit, apply_edit, tables_of
from fingerpad.study.editing.documents import StudyFiles
from fingerpad.study.editing.template import manifest_files
from fingerpad.study.journal import LOCK_NAME, complete, replace_files
from fingerpad.study.manifest.load import STUDY_NAME, LoadedStudy, load_study

# As in template.toml.
_BEGINNING: Final = {"uncertainty": {"load_relative_std": 0.01}}


def create_study(folder: Path, title: str) -> LoadedStudy:
    """Begin a study in a folder that has none; pictures may lie there already.

    Raises
    ------
    ManifestError
        If there is a study already, or the title is empty.
    StoreError
        If the folder cannot be written.
    """
    if not title.strip():
        raise ManifestError("a study needs a title")
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise StoreError(f"{folder}: cannot make this folder ({error.strerror})") from error
    with locked(folder, folder / LOCK_NAME):
        complete(folder)
        if (folder / STUDY_NAME).exists():
            raise ManifestError(f"{folder}: there is a study already: open it, or name another folder")
        replace_files(folder, manifest_files(tomlkit.dumps({"title": title.strip(), **_BEGINNING})))
    return load_study(folder / STUDY_NAME)


def change_study(
    folder: Path, edits: Sequence[Edit], *, expected: str, before: LoadedStudy | None = None
) -> LoadedStudy:
    """Change a study: all edits or none.

    Parameters
    ----------
    folder : Path
        The study folder.
    edits : sequence of Edit
        In order.
    expected : str
        `LoadedStudy.digest` as the author last saw it.
    before : LoadedStudy or None
        The study as it was read last, which is not read again if its files are the same.

    Returns
    -------
    LoadedStudy
        The study after it.

    Raises
    ------
    EditConflict
        If someone has changed the study since.
    ManifestError
        If an edit would make wrong what is complete; nothing is written.
    StoreError
        If the folder cannot be written.
    """
    with locked(folder, folder / LOCK_NAME):
        complete(folder)
        files = StudyFiles(folder, tables_of(edits), before)
        if files.before.digest != expected:
            raise EditConflict(
                f"{files.before.study.title}: someone has changed the study since: "
                "look at it again before you do"
            )
        for edit in edits:
            apply_edit(files, edit)
        return files.write()
