"""One edit made in the documents of a study: a table added, changed, renamed or taken away."""

from typing import Any, Final

import tomlkit
from pydantic import TypeAdapter, ValidationError
from tomlkit.exceptions import TOMLKitError
from tomlkit.items import AoT

from fingerpad.exceptions import ManifestError
from fingerpad.study.corrections.log import CorrectionLog
from fingerpad.study.editing.documents import LISTS, TABLES, StudyFiles
from fingerpad.study.editing.incomplete import Kind
from fingerpad.study.editing.state import Edit
from fingerpad.study.editing.toml_tables import added, remove, remove_scale, spaced, update
from fingerpad.study.manifest.tables import Name

_NAME: Final = TypeAdapter(Name)
_WAYS: Final = frozenset(("ppi", "mm_per_px", "line", "coin"))


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
    if edit.kind in {"study", "uncertainty"}:
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
    home = files.draft if files.study is None else files.study
    if edit.set is None:
        if edit.kind == "study":
            raise ManifestError("the study itself cannot be removed; delete its folder")
        home.pop("uncertainty", None)
        return
    if edit.kind == "study" and (tables := sorted(TABLES & edit.set.keys())):
        raise ManifestError(f"study: {tables[0]} has edits of its own")
    if edit.kind == "uncertainty" and "uncertainty" not in home:
        home["uncertainty"] = spaced(tomlkit.table())
    update(home if edit.kind == "study" else home["uncertainty"], edit.set)


def _set_scale(files: StudyFiles, edit: Edit) -> None:
    home = next((doc for doc in files.documents() if edit.key in doc.get("scales", {})), None)
    if edit.set is None:
        if home is None:
            raise ManifestError(f"scale {edit.key}: there is none of this name")
        remove_scale(home, edit.key)
        return
    values = dict(edit.set)
    renamed = str(values.pop("name", edit.key))
    _require_name("scale", renamed)
    home = files.draft if home is None else home
    if "scales" not in home:
        home["scales"] = tomlkit.table(True)
    table = home["scales"].setdefault(edit.key, tomlkit.table())
    if _WAYS & values.keys() and not _WAYS & values.keys() & table.keys():
        table.clear()
    update(table, values)
    if renamed != edit.key:
        home["scales"][renamed] = home["scales"].pop(edit.key)
        _rename(files, "scale", edit.key, renamed)


def _set_listed(files: StudyFiles, edit: Edit) -> None:
    if edit.kind == "observation" and files.sheet is not None and edit.key in files.sheet:
        _refuse_rename(files, edit)
        files.sheet.change(edit.key, edit.set)
        return
    table, home = _find(files, edit.kind, edit.key)
    if edit.set is None:
        if table is None or home is None:
            raise ManifestError(f"{edit.kind} {edit.key}: there is none of this name")
        remove(home, LISTS[edit.kind], table)
        return
    values = dict(edit.set)
    if edit.kind != "curve":
        _require_name(edit.kind, str(values.get("name", edit.key)))
    if table is None:
        table = added(files.draft, LISTS[edit.kind])
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
    finger, _ = _find(files, "finger", owner)
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


def _find(files: StudyFiles, kind: Kind, key: str) -> tuple[Any, Any]:
    """Return a table and the document that holds it; curves are counted through both."""
    places = [(table, doc) for doc in files.documents() for table in doc.get(LISTS[kind], [])]
    if kind == "curve":
        number = int(key) if key.isdecimal() else -1
        if not 0 <= number <= len(places):
            raise ManifestError(f"curve {key!r}: there are {len(places)}, numbered from 0")
        return places[number] if number < len(places) else (None, None)
    return next(((table, doc) for table, doc in places if table.get("name") == key), (None, None))


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
    for doc in files.documents():
        tables = [table for name in LISTS.values() for table in doc.get(name, [])]
        tables += [photo for finger in doc.get("fingers", []) for photo in finger.get("photographs", [])]
        for table in tables:
            if table.get(key) == old:
                table[key] = new
    if files.sheet is not None:
        files.sheet.rename(key, old, new)
