"""Changing a study's manifest by program: comments and order stay, and what is complete stays so.

A table may be written before it is complete: `load_study` tells what it lacks.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import tomlkit
from pydantic import TypeAdapter, ValidationError
from tomlkit.exceptions import TOMLKitError
from tomlkit.items import AoT

from fingerpad.exceptions import EditConflict, ManifestError, StoreError
from fingerpad.study.corrections.log import CorrectionLog
from fingerpad.study.editing.documents import StudyFiles, added, new_table, remove, remove_scale, update
from fingerpad.study.editing.template import manifest_files
from fingerpad.study.journal import LOCK_NAME, complete, locked, replace_files
from fingerpad.study.manifest.load import LISTS, SECTIONS, STUDY_NAME, TABLES, Kind, LoadedStudy, load_study
from fingerpad.study.manifest.models import SCALE_KINDS, Name

_NAME: Final = TypeAdapter(Name)


@dataclass(frozen=True, slots=True, kw_only=True)
class Edit:
    """One change of the manifest.

    Attributes
    ----------
    kind : str
        ``study`` (the top level), ``uncertainty``, ``apparatus``, ``scale``, ``finger``,
        ``photograph``, ``observation``, ``sequence`` or ``curve``.
    key : str
        Its name; for a photograph ``FINGER/IMAGE``, for a curve its number from 0, else empty. A key that is
        not there yet is added.
    set : dict or None
        Keys to set; None as a value removes that key, None in place of all removes the table.
    """

    kind: Kind
    key: str
    set: Mapping[str, Any] | None


def tables_of(edits: Iterable[Edit]) -> set[str] | None:
    """Return the names of tables in lists that edits look at; None where one may look at all."""
    names: set[str] = set()
    for edit in edits:
        if edit.kind in {"scale", "finger"} and (edit.set or {}).get("name", edit.key) != edit.key:
            return None  # all that refer to it are changed too
        names.add(edit.key.partition("/")[0] if edit.kind == "photograph" else edit.key)
    return names


def apply_edit(files: StudyFiles, edit: Edit) -> None:
    """Make one edit in the documents of a study.

    Raises
    ------
    ManifestError
        If there is no such table, or what is to be set cannot stand in one.
    """
    try:
        _apply(files, edit)
    except (TOMLKitError, TypeError, ValueError, KeyError) as error:
        if isinstance(error, ManifestError):
            raise
        raise ManifestError(f"{edit.kind} {edit.key}: cannot be written as TOML ({error})") from error


def _apply(files: StudyFiles, edit: Edit) -> None:
    if edit.kind == "study" or edit.kind in SECTIONS:
        _set_top(files, edit)
    elif edit.kind == "scale":
        _set_scale(files, edit)
    elif edit.kind == "photograph":
        _set_photograph(files, edit)
    elif edit.kind in LISTS:
        _set_listed(files, edit)
    else:
        raise ManifestError(f"{edit.kind!r} is no part of a study that can be edited")


def _require_name(kind: Kind, name: str) -> None:
    """Refuse a name that no study may have, before anything refers to it."""
    try:
        _NAME.validate_python(name)
    except ValidationError:
        raise ManifestError(
            f"{kind} {name!r}: write the name with letters, digits and . _ + - only, as in left_index"
        ) from None


def _set_top(files: StudyFiles, edit: Edit) -> None:
    manifest = files.manifest
    if edit.set is None:
        if edit.kind == "study":
            raise ManifestError("the study itself cannot be removed; delete its folder")
        manifest.pop(edit.kind, None)
        return
    if edit.kind == "study":
        if tables := sorted(TABLES & edit.set.keys()):
            raise ManifestError(f"study: {tables[0]} has edits of its own")
        update(manifest, edit.set)
        return
    if edit.kind not in manifest:
        new_table(manifest, edit.kind)
    update(manifest[edit.kind], edit.set)


def _set_scale(files: StudyFiles, edit: Edit) -> None:
    manifest = files.manifest
    known = edit.key in manifest.get("scales", {})
    if edit.set is None:
        if not known:
            raise ManifestError(f"scale {edit.key}: there is none of this name")
        remove_scale(manifest, edit.key)
        return
    values = dict(edit.set)
    renamed = str(values.pop("name", edit.key))
    _require_name("scale", renamed)
    if "scales" not in manifest:
        manifest["scales"] = tomlkit.table(True)
    table = manifest["scales"][edit.key] if known else new_table(manifest["scales"], edit.key)
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
    table = _find(files, edit.kind, edit.key)
    if edit.set is None:
        if table is None:
            raise ManifestError(f"{edit.kind} {edit.key}: there is none of this name")
        remove(files.manifest, LISTS[edit.kind], table)
        return
    values = dict(edit.set)
    if edit.kind != "curve":
        _require_name(edit.kind, str(values.get("name", edit.key)))
    if table is None:
        table = added(files.manifest, LISTS[edit.kind])
        if edit.kind != "curve":
            values = {"name": edit.key} | values
    else:
        _refuse_rename(files, edit)
    update(table, values)
    renamed = str(values.get("name", edit.key))
    if edit.kind == "finger" and renamed != edit.key:
        _rename(files, "finger", edit.key, renamed)


def _set_photograph(files: StudyFiles, edit: Edit) -> None:
    owner, _, file = edit.key.partition("/")
    finger = _find(files, "finger", owner)
    if finger is None:
        raise ManifestError(f"photograph {edit.key}: no finger is named {owner!r}; add the finger first")
    photographs = finger.get("photographs", [])
    found = next((one for one in photographs if file in {one.get("file"), one.get("outline")}), None)
    if edit.set is None:
        if found is None:
            raise ManifestError(f"photograph {edit.key}: there is none of this name")
        remove(finger, "photographs", found)
        return
    if found is not None:
        update(found, edit.set)
        return
    values = dict(edit.set)
    if "outline" not in values:
        values = {"file": file} | values
    if "photographs" not in finger:
        finger["photographs"] = tomlkit.array().multiline(True)
    if isinstance(finger["photographs"], AoT):
        table: Any = tomlkit.table()
    else:
        table = tomlkit.inline_table()
    update(table, values)
    finger["photographs"].append(table)


def _find(files: StudyFiles, kind: Kind, key: str) -> Any:
    """Return a table of a list, None where there is none."""
    tables = files.manifest.get(LISTS[kind], [])
    if kind == "curve":
        number = int(key) if key.isdecimal() else -1
        if not 0 <= number <= len(tables):
            raise ManifestError(f"curve {key!r}: there are {len(tables)}, numbered from 0")
        return tables[number] if number < len(tables) else None
    return next((table for table in tables if table.get("name") == key), None)


def _refuse_rename(files: StudyFiles, edit: Edit) -> None:
    """Keep the names that corrections go by."""
    renamed = (edit.set or {}).get("name", edit.key)
    if renamed == edit.key:
        return
    starts = {"observation": edit.key, "sequence": f"{edit.key}#", "finger": f"{edit.key}/"}
    start = starts.get(edit.kind)
    for item in CorrectionLog(files.folder).active_corrections():
        if item == start or (start is not None and start[-1] in "#/" and item.startswith(start)):
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
