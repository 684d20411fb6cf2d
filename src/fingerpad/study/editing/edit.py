"""Changing a study's manifest by program: comments and order stay, and nothing that is wrong is written.

What is not complete yet cannot stand in ``study.toml``. It waits in ``draft.toml`` beside it, in the same
layout, and moves over as soon as the manifest takes it.
"""

from collections.abc import Sequence
from pathlib import Path

import tomlkit

from fingerpad.exceptions import EditConflict, ManifestError, StoreError
from fingerpad.study.atomic_files import locked, replace_file
from fingerpad.study.editing.apply_edit import apply_edit
from fingerpad.study.editing.documents import DRAFT_NAME, STUDY_NAME, StudyFiles
from fingerpad.study.editing.state import Edit, StudyState
from fingerpad.study.journal import LOCK_NAME, complete


def create_study(folder: Path, title: str) -> StudyState:
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
        if any((folder / name).exists() for name in (STUDY_NAME, DRAFT_NAME)):
            raise ManifestError(f"{folder}: there is a study already: open it, or name another folder")
        replace_file(folder / DRAFT_NAME, tomlkit.dumps({"title": title.strip()}))
        return StudyFiles.read(folder).state()


def study_state(folder: Path) -> StudyState:
    """Return the current state of a study.

    Raises
    ------
    ManifestError
        If there is none, or what someone wrote into it by hand is wrong.
    """
    return StudyFiles.read(folder).state()


def change_study(folder: Path, edits: Sequence[Edit], *, expected: str) -> StudyState:
    """Change a study: all edits or none.

    Parameters
    ----------
    folder : Path
        The study folder.
    edits : sequence of Edit
        In order.
    expected : str
        `StudyState.digest` as the author last saw it.

    Returns
    -------
    StudyState
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
        files = StudyFiles.to_edit(folder)
        if files.digest != expected:
            raise EditConflict(
                f"{files.title}: someone has changed the study since: look at it again before you do"
            )
        for edit in edits:
            apply_edit(files, edit)
        files.settle()
        files.write()
        return files.state()
