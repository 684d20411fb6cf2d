"""Changing a study's manifest by program: comments and order stay, and what is complete stays so.

A table may be written before it is complete: `load_study` tells what it lacks.
"""

import re
import tomllib
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Any, Final

import tomlkit
from tomlkit.exceptions import TOMLKitError
from tomlkit.items import AoT

from fingerpad._files import explain_write_errors, make_folder
from fingerpad.exceptions import EditConflict, ManifestError, StoreError
from fingerpad.study.corrections.log import CorrectionLog, ItemKind, parts_of_item
from fingerpad.study.editing.template import manifest_files
from fingerpad.study.journal import LOCK_NAME, complete, locked, read_text_or_none, replace_files
from fingerpad.study.manifest.load import (
    LISTS,
    NAME,
    SECTIONS,
    STUDY_NAME,
    TABLES,
    Kind,
    LoadedStudy,
    checked_study,
    is_as_read,
    load_study,
    read_inside,
)
from fingerpad.study.manifest.models import SCALE_KINDS, checked
from fingerpad.study.manifest.sheet import Sheet


def update(table: Any, values: Mapping[str, Any]) -> None:
    """Set the keys of a table; None removes one."""
    for key, value in values.items():
        if value is None:
            table.pop(key, None)
        elif key.endswith("_columns") and isinstance(value, str):
            table[key] = _item(_columns_in(key, value))
        else:
            table[key] = _item(value)


def _columns_in(key: str, text: str) -> Any:
    """Return columns from text as a manifest names them."""
    try:
        return tomllib.loads(f"columns = {{ {text} }}")["columns"]
    except tomllib.TOMLDecodeError:
        raise ManifestError(
            f'{key}: write force = "HEADER:UNIT", with commas between several, found {text}'
        ) from None


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


def table_in(tables: Any, key: str) -> Any:
    """Return the table of this name, which is added where there is none."""
    if key not in tables:
        tables[key] = spaced(tomlkit.table())
    return tables[key]


def spaced(table: Any) -> Any:
    """Return a table with an empty line before it."""
    table.trivia.indent = "\n"
    return table


def change_listed(home: Any, name: str, table: Any, edit: "Edit", start: Mapping[str, str]) -> None:
    """Change a table of a list, or remove it, and the list with its last one; None is added at the end.

    A new one begins with the keys of `start`, which name it.
    """
    if edit.set is None:
        if table is None:
            raise ManifestError(f"{edit.kind} {edit.key}: there is none of this name")
        listed = home[name]
        listed.pop(next(place for place, one in enumerate(listed) if one is table))
        if not listed:
            home.pop(name)
    elif table is not None:
        update(table, edit.set)
    else:
        if name not in home:
            home[name] = tomlkit.array().multiline(True) if name == "photographs" else tomlkit.aot()
        inline = not isinstance(home[name], AoT)
        table = tomlkit.inline_table() if inline else spaced(tomlkit.table())
        update(table, {**start, **edit.set})
        home[name].append(table)


_HEADER: Final = re.compile(r"^[ \t]*\[[^,\n]*\][ \t]*(?:#.*)?\r?$", re.MULTILINE)
_LISTED: Final = re.compile(r"[ \t]*\[\[[ \t]*(\w+)[ \t]*\]\].*\n")
_MARK: Final = "# left out: "
# Of lists whose tables are found by their names.
_LISTS: Final = frozenset(name for kind, name in LISTS.items() if kind != "curve")


def folded(text: str, kept: Collection[str]) -> tuple[str, dict[str, str]]:
    """Leave tables of lists out of a manifest but for those of these names.

    Those that follow one another become one without keys; the second value is what stood in place of each
    line that was added.
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
    return re.sub(f"{_MARK}\\d+\n", lambda line: left_out[line[0]], text) if left_out else text


def _list_left_out(piece: str, kept: Collection[str]) -> str | None:
    """Return the list of which a piece of a manifest is a table to be left out, None for any other."""
    content, header = tomllib.loads(piece), _LISTED.match(piece)
    if header is None or header[1] not in _LISTS or not piece.endswith("\n"):
        return None
    tables = content.pop(header[1])
    return None if content or len(tables) > 1 or str(tables[0].get("name")) in kept else header[1]


class StudyFiles:
    """The documents of a study while they are changed."""

    def __init__(self, folder: Path, kept: Collection[str] | None, before: LoadedStudy | None = None) -> None:
        """Read tables of lists by name, None for all; `before` is not read again if it is unchanged."""
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
            self.sheet = Sheet(name, read_inside(folder, name))
        self._texts = self._written()
        # Tables of lists by their names, as of `find`: to look at all of them for each edit takes too long.
        self.named: dict[Kind, dict[str, Any]] = {}

    def find(self, kind: Kind, key: str) -> Any:
        """Return a table of a list, None where there is none."""
        tables = self.manifest.get(LISTS[kind], [])
        if kind == "curve":
            number = int(key) if key.isdecimal() else -1
            if not 0 <= number <= len(tables):
                raise ManifestError(f"curve {key!r}: there are {len(tables)}, numbered from 0")
            return tables[number] if number < len(tables) else None
        if kind not in self.named:  # of equal names the first
            self.named[kind] = {str(table.get("name", "")): table for table in reversed(list(tables))}
        return self.named[kind].get(key)

    def _written(self) -> dict[str, str]:
        sheet = {} if self.sheet is None else {self.sheet.name: self.sheet.text()}
        return {STUDY_NAME: unfolded(tomlkit.dumps(self.manifest), self._left_out), **sheet}

    def write(self) -> LoadedStudy:
        """Put the changed files in place, all or none; none where what was complete would be wrong."""
        changed = {name: text for name, text in self._written().items() if text != self._texts[name]}
        if not changed:
            return self.before

        def read(name: str) -> bytes:
            return changed[name].encode() if name in changed else read_inside(self.folder, name)

        after = checked_study(self.folder / STUDY_NAME, read(STUDY_NAME), read)
        _require_as_complete(self.before, after)
        replace_files(self.folder, changed)
        return after


_OF_SHAPE: Final = frozenset(("semi_axes_mm", "photographs"))


def _require_as_complete(before: LoadedStudy, after: LoadedStudy) -> None:
    """Refuse to make wrong what was complete; what was not may lack other things than before."""
    wrong_before = {(one.kind, one.key) for one in before.incomplete}
    # A finger of a name alone may get photographs whose face is not known yet.
    was_complete: set[tuple[str, str]] = {
        (one.kind, one.key)
        for one in before.tables
        if one.complete and (one.kind != "finger" or not one.content.keys().isdisjoint(_OF_SHAPE))
    }
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


@dataclass(frozen=True, slots=True, kw_only=True)
class Edit:
    """One change of the manifest."""

    kind: Kind
    # A name, FINGER/IMAGE of a photograph, the number of a curve from 0; a new one is added.
    key: str
    # None as a value removes that key, None in place of all the table.
    set: Mapping[str, Any] | None


def tables_of(edits: Iterable[Edit]) -> set[str] | None:
    """Return the names of tables in lists that edits look at; None where one may look at all."""
    names: set[str] = set()
    for edit in edits:
        if edit.kind in {"scale", "finger"} and (edit.set or {}).get("name", edit.key) != edit.key:
            return None  # all that refer to it are changed too
        names.add(edit.key.partition("/")[0] if edit.kind == "photograph" else edit.key)
    return names


def _require_name(kind: Kind, name: str) -> None:
    """Refuse a name that no study may have, before anything refers to it."""
    if checked(NAME, name, strict=False)[1]:
        raise ManifestError(
            f"{kind} {name!r}: write the name with letters, digits and . _ + - only, as in left_index"
        )


def _set_top(files: StudyFiles, edit: Edit) -> None:
    manifest = files.manifest
    if edit.kind == "study":
        if edit.set is None:
            raise ManifestError("the study itself cannot be removed; delete its folder")
        if tables := sorted(TABLES & edit.set.keys()):
            raise ManifestError(f"study: {tables[0]} has edits of its own")
        update(manifest, edit.set)
    elif edit.set is None:
        manifest.pop(edit.kind, None)
    else:
        update(table_in(manifest, edit.kind), edit.set)


def _set_scale(files: StudyFiles, edit: Edit) -> None:
    manifest = files.manifest
    if edit.set is None:
        if edit.key not in manifest.get("scales", {}):
            raise ManifestError(f"scale {edit.key}: there is none of this name")
        manifest["scales"].pop(edit.key)
        if not manifest["scales"]:
            manifest.pop("scales")
        return
    values = dict(edit.set)
    renamed = str(values.pop("name", edit.key))
    _require_name("scale", renamed)
    if renamed != edit.key and renamed in manifest.get("scales", {}):
        raise ManifestError(
            f"scale {edit.key}: {renamed!r} is taken: remove that scale first, or name another"
        )
    if "scales" not in manifest:
        manifest["scales"] = tomlkit.table(True)
    table = table_in(manifest["scales"], edit.key)
    kinds = values.keys() & set(SCALE_KINDS)
    if kinds and not kinds & table.keys():
        table.clear()
    update(table, values)
    if renamed != edit.key:
        manifest["scales"][renamed] = manifest["scales"].pop(edit.key)
        _rename(files, "scale", edit.key, renamed)


def _set_listed(files: StudyFiles, edit: Edit) -> None:
    if edit.kind == "observation" and files.sheet is not None and edit.key in files.sheet:
        _refuse_rename(files, edit)
        files.sheet.change(edit.key, edit.set)
        return
    table = files.find(edit.kind, edit.key)
    renamed = str((edit.set or {}).get("name", edit.key))
    start = {} if edit.kind == "curve" else {"name": edit.key}
    if edit.set is not None and start:
        _require_name(edit.kind, renamed)
    if table is not None:
        _refuse_rename(files, edit)
    change_listed(files.manifest, LISTS[edit.kind], table, edit, start)
    if table is None and start:
        files.named[edit.kind].setdefault(renamed, files.manifest[LISTS[edit.kind]][-1])
    elif edit.set is None or renamed != edit.key:
        files.named.pop(edit.kind, None)
    if edit.kind == "finger" and renamed != edit.key:
        _rename(files, "finger", edit.key, renamed)


def _set_photograph(files: StudyFiles, edit: Edit) -> None:
    owner, _, file = edit.key.partition("/")
    finger = files.find("finger", owner)
    if finger is None:
        raise ManifestError(f"photograph {edit.key}: no finger is named {owner!r}; add the finger first")
    photographs = finger.get("photographs", [])
    found = next((one for one in photographs if file in {one.get("file"), one.get("outline")}), None)
    start = {} if "outline" in (edit.set or {}) else {"file": file}
    change_listed(finger, "photographs", found, edit, start)


# Whose name stands in the items of each kind.
_CORRECTED: Final[Mapping[ItemKind, Kind]] = {
    "observation": "observation",
    "frame": "sequence",
    "phases": "sequence",
    "photograph": "finger",
}


def _refuse_rename(files: StudyFiles, edit: Edit) -> None:
    """Keep the names that corrections go by."""
    if (edit.set or {}).get("name", edit.key) == edit.key:
        return
    for item in CorrectionLog(files.folder).active_corrections():
        kind, name, _ = parts_of_item(item)
        if (_CORRECTED[kind], name) == (edit.kind, edit.key):
            raise ManifestError(
                f"{edit.kind} {edit.key}: it has corrections, which are kept under its name: "
                "take them back before you rename it"
            )


def _rename(files: StudyFiles, key: str, old: str, new: str) -> None:
    """Change every reference to a name."""
    tables = [table for name in LISTS.values() for table in files.manifest.get(name, [])]
    tables += [one for finger in files.manifest.get("fingers", []) for one in finger.get("photographs", [])]
    for table in tables:
        if table.get(key) == old:
            table[key] = new
    if files.sheet is not None:
        files.sheet.rename(key, old, new)


_CHANGES: Final[Mapping[Kind, Callable[[StudyFiles, Edit], None]]] = {
    **dict.fromkeys(("study", *SECTIONS), _set_top),
    "scale": _set_scale,
    **dict.fromkeys(LISTS, _set_listed),
    "photograph": _set_photograph,
}


def _apply(files: StudyFiles, edit: Edit) -> None:
    """Make one edit in the documents of a study."""
    if edit.kind not in _CHANGES:
        raise ManifestError(f"{edit.kind!r} is no part of a study that can be edited")
    try:
        _CHANGES[edit.kind](files, edit)
    except ManifestError:
        raise
    except (TOMLKitError, TypeError, ValueError, KeyError) as error:
        raise ManifestError(f"{edit.kind} {edit.key}: cannot be written as TOML ({error})") from error


# As in template.toml.
_BEGINNING: Final = {"uncertainty": {"load_relative_std": 0.01}}


def create_study(folder: Path, title: str) -> LoadedStudy:
    """Begin a study in a folder that has none; pictures may lie there already."""
    if not title.strip():
        raise ManifestError("a study needs a title")
    make_folder(folder)
    with locked(folder, folder / LOCK_NAME), explain_write_errors(folder, error=StoreError):
        complete(folder)
        if (folder / STUDY_NAME).exists():
            raise ManifestError(
                f"{folder}: there is a study already: open it, name another folder, or remove {STUDY_NAME} "
                "to begin again"
            )
        replace_files(folder, manifest_files(tomlkit.dumps({"title": title.strip(), **_BEGINNING})))
    return load_study(folder / STUDY_NAME)


def change_study(
    folder: Path, edits: Sequence[Edit], *, expected: str, before: LoadedStudy | None = None
) -> LoadedStudy:
    """Change a study, all edits or none, and return it; `EditConflict` if someone else has changed it since.

    `expected` is `LoadedStudy.digest` as the author last saw it; `before` as of `StudyFiles`.
    """
    with locked(folder, folder / LOCK_NAME), explain_write_errors(folder, error=StoreError):
        complete(folder)
        files = StudyFiles(folder, tables_of(edits), before)
        if files.before.digest != expected:
            raise EditConflict(
                f"{files.before.study.title}: someone has changed the study since: "
                "look at it again before you do"
            )
        for edit in edits:
            _apply(files, edit)
        return files.write()
