"""The documents of a study while they are changed: its manifest with all comments, and its spreadsheet."""

import re
import tomllib
from collections.abc import Collection, Mapping
from itertools import groupby
from pathlib import Path
from typing import Any, Final

import tomlkit
from tomlkit.exceptions import TOMLKitError
from tomlkit.items import AoT

from fingerpad.exceptions import ManifestError
from fingerpad.study.journal import read_text_or_none, replace_files
from fingerpad.study.manifest.load import (
    LISTS,
    SECTIONS,
    STUDY_NAME,
    LoadedStudy,
    checked_study,
    file_inside,
    is_as_read,
    load_study,
)
from fingerpad.study.manifest.sheet import Sheet


def update(table: Any, values: Mapping[str, Any]) -> None:
    """Set the keys of a table; None removes one."""
    for key, value in values.items():
        if value is None:
            table.pop(key, None)
        else:
            table[key] = _item(value)


def _item(value: Any) -> Any:
    """Return a value as TOML writes it in place: tables inline, lists of tables one a line."""
    if isinstance(value, Mapping):
        table = tomlkit.inline_table()
        for key, item in value.items():
            if item is not None:
                table[key] = _item(item)
        return table
    if isinstance(value, list | tuple):
        array = tomlkit.array()
        for item in value:
            array.append(_item(item))
        return array.multiline(any(isinstance(item, Mapping) for item in value))
    return tomlkit.item(value)


def new_table(tables: Any, key: str) -> Any:
    """Return a new table of this name."""
    tables[key] = spaced(tomlkit.table())
    return tables[key]


def added(home: Any, name: str) -> Any:
    """Return a new table at the end of a list of tables."""
    if name not in home:
        home[name] = tomlkit.aot()
    listed = home[name]
    listed.append(spaced(tomlkit.table()) if isinstance(listed, AoT) else tomlkit.inline_table())
    return listed[-1]


def spaced(table: Any) -> Any:
    """Return a table with an empty line before it."""
    table.trivia.indent = "\n"
    return table


def remove(home: Any, name: str, table: Any) -> None:
    """Remove a table from a list of tables, and the list with its last one."""
    listed = home[name]
    listed.pop(next(place for place, one in enumerate(listed) if one is table))
    if not listed:
        home.pop(name)


def remove_scale(home: Any, name: str) -> None:
    """Remove a scale, and the table of scales with its last one."""
    home["scales"].pop(name)
    if not home["scales"]:
        home.pop("scales")


_HEADER: Final = re.compile(r"^[ \t]*\[[^,\n]*\][ \t]*(?:#.*)?\r?$", re.MULTILINE)
_LISTED: Final = re.compile(r"[ \t]*\[\[[ \t]*(\w+)[ \t]*\]\].*\n")
_MARK: Final = "# left out: "
# Of lists whose tables are found by their names.
_LISTS: Final = frozenset(name for kind, name in LISTS.items() if kind != "curve")


def folded(text: str, kept: Collection[str]) -> tuple[str, dict[str, str]]:
    """Leave tables out of a manifest.

    Parameters
    ----------
    text : str
        The manifest.
    kept : collection of str
        Names of the tables that stay.

    Returns
    -------
    folded : str
        The manifest, in which tables that follow one another in a list are one without keys.
    left_out : dict of str to str
        The text that stood in place of each line that was added.
    """
    starts = [match.start() for match in _HEADER.finditer(text)]
    pieces = [text[start:stop] for start, stop in zip([0, *starts], [*starts, len(text)], strict=True)]
    try:
        # A piece that is TOML on its own begins and ends between two values.
        lists = [_list_left_out(piece, kept) for piece in pieces]
    except tomllib.TOMLDecodeError:
        return text, {}
    if _MARK in text:
        return text, {}
    parts: list[str] = []
    left_out: dict[str, str] = {}
    for name, group in groupby(zip(lists, pieces, strict=True), key=lambda one: one[0]):
        run = "".join(piece for _, piece in group)
        if name is None:
            parts.append(run)
            continue
        header = _LISTED.match(run)
        assert header is not None
        line = f"{_MARK}{len(left_out)}\n"
        left_out[line] = run.removeprefix(header[0])
        parts.append(header[0] + line)
    return "".join(parts), left_out


def unfolded(text: str, left_out: dict[str, str]) -> str:
    """Put back what `folded` left out."""
    for line, tables in left_out.items():
        before, _, after = text.partition(line)
        text = before + tables + after
    return text


def _list_left_out(piece: str, kept: Collection[str]) -> str | None:
    """Return the list of which a piece of a manifest is a table that is left out, None for any other piece.

    Raises
    ------
    TOMLDecodeError
        If it is not TOML.
    """
    content, header = tomllib.loads(piece), _LISTED.match(piece)
    if header is None or header[1] not in _LISTS or not piece.endswith("\n"):
        return None
    tables = content.pop(header[1])
    return None if content or len(tables) > 1 or str(tables[0].get("name")) in kept else header[1]


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
