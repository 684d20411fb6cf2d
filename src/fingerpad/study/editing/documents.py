"""The documents of a study while they are changed: its manifest with all comments, and its spreadsheet."""

import re
import tomllib
from collections.abc import Collection
from pathlib import Path
from typing import Any, Final

import tomlkit
from tomlkit.exceptions import TOMLKitError

from fingerpad.exceptions import ManifestError
from fingerpad.study.atomic_files import read_text_or_none
from fingerpad.study.editing.folded import folded, unfolded
from fingerpad.study.journal import replace_files
from fingerpad.study.manifest.load import (
    SECTIONS,
    STUDY_NAME,
    LoadedStudy,
    checked_study,
    file_inside,
    is_as_read,
    load_study,
)
from fingerpad.study.manifest.sheet import Sheet

_FIRST_TABLE: Final = re.compile(r"^\s*\[", re.MULTILINE)


class StudyFiles:
    """The documents of a study while they are changed.

    Attributes
    ----------
    folder : Path
        The study folder.
    before : LoadedStudy
        The study as its files have it.
    manifest : TOMLDocument
        The manifest.
    sheet : Sheet or None
        The spreadsheet of observations.
    """

    def __init__(self, folder: Path, kept: Collection[str] | None, before: LoadedStudy | None = None) -> None:
        """Read the files of a study.

        Parameters
        ----------
        folder : Path
            The study folder.
        kept : collection of str or None
            Names of the tables in lists that are needed, None for all.
        before : LoadedStudy or None
            The study as it was read last, which is not read again if its files are the same.

        Raises
        ------
        ManifestError
            If there is none, or it is not made of tables.
        """
        self.folder = folder
        self.before = before if before is not None and is_as_read(before) else load_study(folder / STUDY_NAME)
        text = read_text_or_none(folder / STUDY_NAME) or ""
        text, self._left_out = (text, {}) if kept is None else folded(text, kept)
        try:
            self.manifest: Any = tomlkit.parse(text)
        except TOMLKitError as error:
            raise ManifestError(f"{STUDY_NAME}: not valid TOML: {error}") from error
        self.sheet: Sheet | None = None
        name = self.before.study.observations_csv
        if name is not None:
            self.sheet = Sheet.parse(name, file_inside(folder, name).read_bytes())
        self._texts = self._written()

    def _written(self) -> dict[str, str]:
        sheet = {} if self.sheet is None else {self.sheet.name: self.sheet.text()}
        return {STUDY_NAME: unfolded(tomlkit.dumps(self.manifest), self._left_out), **sheet}

    def write(self) -> LoadedStudy:
        """Put the changed files in place of the old ones, all or none, and return the study after it.

        Raises
        ------
        ManifestError
            If what was complete is wrong now; nothing is written then.
        """
        changed = {name: text for name, text in self._written().items() if text != self._texts[name]}
        if not changed:
            return self.before

        def read(name: str) -> bytes:
            return changed[name].encode() if name in changed else file_inside(self.folder, name).read_bytes()

        after = checked_study(self.folder / STUDY_NAME, read(STUDY_NAME), read)
        _require_as_complete(self.before, after)
        replace_files(self.folder, changed)
        return after


def _require_as_complete(before: LoadedStudy, after: LoadedStudy) -> None:
    """Refuse to make wrong what was complete; what was not may lack other things than before."""
    wrong_before = {(one.kind, one.key) for one in before.incomplete}
    was_complete: set[tuple[str, str]] = {(one.kind, one.key) for one in before.tables if one.complete}
    was_complete |= {(name, "") for name in ("study", *SECTIONS)} - wrong_before
    contents = [one.content for one in before.incomplete]
    lines = [
        line
        for one in after.incomplete
        if (one.kind, one.key) in was_complete and one.content not in contents
        for line in one.lines
    ]
    if lines:
        raise ManifestError("\n".join(lines))


def title_of(folder: Path) -> str | None:
    """Return a study's title at a glance, without reading its tables; None where that does not tell it."""
    try:
        text = read_text_or_none(folder / STUDY_NAME) or ""
        title = tomllib.loads(_FIRST_TABLE.split(text, maxsplit=1)[0]).get("title")
    except (ManifestError, tomllib.TOMLDecodeError):
        return None
    return title if isinstance(title, str) else None
