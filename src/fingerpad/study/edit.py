"""Changing a study's manifest by program: comments and order stay, and nothing that is wrong is written.

What is not complete yet cannot stand in ``study.toml``. It waits in ``draft.toml`` beside it, in the same
layout, and moves over by itself as soon as the manifest takes it.
"""

import hashlib
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal, TypeAlias

import tomlkit
from filelock import FileLock, Timeout
from tomlkit.exceptions import TOMLKitError
from tomlkit.items import AoT

from fingerpad.exceptions import EditConflict, ManifestError, StoreError
from fingerpad.study.corrections import CorrectionLog, sync_folder
from fingerpad.study.manifest import Study, read_study
from fingerpad.study.manifest.contacts import ContactSequence, Observation
from fingerpad.study.manifest.curves import Curve
from fingerpad.study.manifest.faults import validated
from fingerpad.study.manifest.fingers import Finger
from fingerpad.study.manifest.read import file_inside
from fingerpad.study.manifest.scales import OwnScale
from fingerpad.study.manifest.tables import Name, Table
from fingerpad.study.sheet import Sheet

STUDY_NAME: Final = "study.toml"
DRAFT_NAME: Final = "draft.toml"
LOCK_NAME: Final = ".study.lock"

Kind: TypeAlias = Literal[
    "study", "uncertainty", "scale", "finger", "photograph", "observation", "sequence", "curve"
]

_LISTS: Final = {
    "finger": "fingers",
    "observation": "observations",
    "sequence": "sequences",
    "curve": "curves",
}
_MODELS: Final[Mapping[str, type[Table]]] = {
    "finger": Finger,
    "observation": Observation,
    "sequence": ContactSequence,
    "curve": Curve,
}
_FILES: Final = ("image", "outline", "background", "path", "force", "times", "file")
_TABLES: Final = frozenset((*_LISTS.values(), "scales", "uncertainty"))
_WAYS: Final = frozenset(("ppi", "mm_per_px", "line", "coin"))
_WAIT_S: Final = 30.0


class _Scale(Table):
    """A scale in a table of its own, for its faults."""

    name: Name
    table: OwnScale


@dataclass(frozen=True, slots=True, kw_only=True)
class Edit:
    """One change of the manifest.

    Attributes
    ----------
    kind : str
        ``study`` (the top level), ``uncertainty``, ``scale``, ``finger``, ``photograph``, ``observation``,
        ``sequence`` or ``curve``.
    key : str
        Its name; for a photograph ``FINGER/IMAGE``, for a curve its number from 0, else empty. A key that is
        not there yet is added.
    set : dict or None
        Keys to set; None as a value removes that key, None in place of all removes the table.
    """

    kind: Kind
    key: str
    set: Mapping[str, Any] | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Incomplete:
    """A table that the manifest does not take yet.

    Attributes
    ----------
    kind, key : str
        As of an `Edit`.
    content : dict
        What is known so far.
    faults : tuple of str
        What is missing or wrong, in the manifest's words; none where it only waits for a finger.
    """

    kind: Kind
    key: str
    content: dict[str, Any]
    faults: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyState:
    """A study as it is now.

    Attributes
    ----------
    folder : Path
        The study folder.
    digest : str
        Of its manifest's bytes: what an author has seen.
    title : str
        Its title, which it has from the beginning.
    study : Study or None
        What is complete of it; None as long as there is no complete finger.
    incomplete : tuple of Incomplete
        What is not.
    """

    folder: Path
    digest: str
    title: str
    study: Study | None
    incomplete: tuple[Incomplete, ...]


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
    with _locked(folder):
        if any((folder / name).exists() for name in (STUDY_NAME, DRAFT_NAME)):
            raise ManifestError(f"{folder}: there is a study already: open it, or name another folder")
        _replace(folder / DRAFT_NAME, tomlkit.dumps({"title": title.strip()}))
        return _Files.read(folder).state()


def study_state(folder: Path) -> StudyState:
    """Return a study as it is now.

    Raises
    ------
    ManifestError
        If there is none, or what someone wrote into it by hand is wrong.
    """
    if not (folder / DRAFT_NAME).exists() and (text := _text(folder / STUDY_NAME)) is not None:
        # Without a draft there is nothing to put together; a document that keeps its remarks is slow to read.
        study = read_study(folder / STUDY_NAME)
        sheet = None
        if (name := study.observations_csv) is not None:
            sheet = Sheet.read(file_inside(folder, name, STUDY_NAME, "observations_csv")).text()
        digest = _digest([text, None, sheet])
        return StudyState(folder=folder, digest=digest, title=study.title, study=study, incomplete=())
    return _Files.read(folder).state()


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
    with _locked(folder):
        files = _Files.read(folder)
        if files.digest != expected:
            raise EditConflict(
                f"{files.title}: someone has changed the study since: look at it again before you do"
            )
        for edit in edits:
            files.apply(edit)
        files.settle()
        files.write()
        return _Files.read(folder).state()


class _Files:
    """The documents of a study while they are changed: the manifest, its draft and its spreadsheet."""

    def __init__(self, folder: Path, texts: Mapping[str, str | None]) -> None:
        self.folder = folder
        self._texts = texts
        self.study = _parsed(STUDY_NAME, texts[STUDY_NAME])
        draft = _parsed(DRAFT_NAME, texts[DRAFT_NAME])
        self.draft = tomlkit.document() if draft is None else draft
        _require_tables(self.draft)
        if self.study is not None:
            _require_tables(self.study, STUDY_NAME)
        name = self.study.get("observations_csv") if self.study is not None else None
        self._sheet_name = str(name) if name is not None else None
        self.sheet: Sheet | None = None
        if self._sheet_name is not None:
            self.sheet = Sheet.read(file_inside(folder, self._sheet_name, STUDY_NAME, "observations_csv"))
        self._sheet_text = self.sheet.text() if self.sheet is not None else None
        self.digest = _digest([*texts.values(), self._sheet_text])
        self._drop_what_moved()

    @classmethod
    def read(cls, folder: Path) -> "_Files":
        texts = {name: _text(folder / name) for name in (STUDY_NAME, DRAFT_NAME)}
        if not any(text is not None for text in texts.values()):
            raise ManifestError(f"{folder}: holds no study; make one, or open another folder")
        return cls(folder, texts)

    @property
    def title(self) -> str:
        """The study's title."""
        home = self.draft if self.study is None else self.study
        return str(home.get("title", "study"))

    def state(self) -> StudyState:
        """Return what the files say."""
        study = None
        if self.study is not None:
            study = read_study(self.folder / STUDY_NAME)
        return StudyState(
            folder=self.folder,
            digest=self.digest,
            title=self.title,
            study=study,
            incomplete=tuple(
                Incomplete(kind=kind, key=key, content=content, faults=self._faults(kind, key, content))
                for kind, key, content in self._waiting()
            ),
        )

    def apply(self, edit: Edit) -> None:
        """Make one edit in the documents."""
        try:
            self._apply(edit)
        except (TOMLKitError, TypeError, ValueError, KeyError) as error:
            if isinstance(error, ManifestError):
                raise
            raise ManifestError(f"{edit.kind} {edit.key}: cannot be written as TOML ({error})") from error

    def _apply(self, edit: Edit) -> None:
        if edit.kind in {"study", "uncertainty"}:
            self._set_top(edit)
        elif edit.kind == "scale":
            self._set_scale(edit)
        elif edit.kind == "photograph":
            self._set_photograph(edit)
        elif edit.kind in _LISTS:
            self._set_listed(edit)
        else:
            raise ManifestError(f"{edit.kind!r} is no part of a study that can be edited")

    def _set_top(self, edit: Edit) -> None:
        home = self.draft if self.study is None else self.study
        if edit.set is None:
            if edit.kind == "study":
                raise ManifestError("the study itself cannot be removed; delete its folder")
            home.pop("uncertainty", None)
            return
        if edit.kind == "study" and (tables := sorted(_TABLES & edit.set.keys())):
            raise ManifestError(f"study: {tables[0]} has edits of its own")
        if edit.kind == "uncertainty" and "uncertainty" not in home:
            home["uncertainty"] = _spaced(tomlkit.table())
        _update(home if edit.kind == "study" else home["uncertainty"], edit.set)

    def _set_scale(self, edit: Edit) -> None:
        home = next((doc for doc in self._documents() if edit.key in doc.get("scales", {})), None)
        if edit.set is None:
            if home is None:
                raise ManifestError(f"scale {edit.key}: there is none of this name")
            _remove_scale(home, edit.key)
            return
        values = dict(edit.set)
        renamed = str(values.pop("name", edit.key))
        home = self.draft if home is None else home
        if "scales" not in home:
            home["scales"] = tomlkit.table(True)
        table = home["scales"].setdefault(edit.key, tomlkit.table())
        if _WAYS & values.keys() and not _WAYS & values.keys() & table.keys():
            table.clear()
        _update(table, values)
        if renamed != edit.key:
            home["scales"][renamed] = home["scales"].pop(edit.key)
            self._rename("scale", edit.key, renamed)

    def _set_listed(self, edit: Edit) -> None:
        if edit.kind == "observation" and self.sheet is not None and edit.key in self.sheet:
            self._refuse_rename(edit)
            self.sheet.change(edit.key, edit.set)
            return
        table, home = self._find(edit.kind, edit.key)
        if edit.set is None:
            if table is None or home is None:
                raise ManifestError(f"{edit.kind} {edit.key}: there is none of this name")
            _remove(home, _LISTS[edit.kind], table)
            return
        values = dict(edit.set)
        if table is None:
            table = _added(self.draft, _LISTS[edit.kind])
            if edit.kind != "curve":
                values = {"name": edit.key} | values
        else:
            self._refuse_rename(edit)
        _update(table, values)
        renamed = str(values.get("name", edit.key))
        if edit.kind == "finger" and renamed != edit.key:
            self._rename("finger", edit.key, renamed)

    def _set_photograph(self, edit: Edit) -> None:
        owner, _, file = edit.key.partition("/")
        finger, _ = self._find("finger", owner)
        if finger is None:
            raise ManifestError(f"photograph {edit.key}: no finger is named {owner!r}; add the finger first")
        photographs = finger.get("photographs", [])
        found = next((one for one in photographs if file in {one.get("image"), one.get("outline")}), None)
        if edit.set is None:
            if found is None:
                raise ManifestError(f"photograph {edit.key}: there is none of this name")
            _remove(finger, "photographs", found)
            return
        if found is not None:
            _update(found, edit.set)
            return
        values = dict(edit.set)
        if "outline" not in values:
            values = {"image": file} | values
        if "photographs" not in finger:
            finger["photographs"] = tomlkit.array().multiline(True)
        if isinstance(finger["photographs"], AoT):
            table: Any = tomlkit.table()
        else:
            table = tomlkit.inline_table()
        _update(table, values)
        finger["photographs"].append(table)

    def _find(self, kind: Kind, key: str) -> tuple[Any, Any]:
        """Return a table and the document that holds it; curves are counted through both."""
        places = [(table, doc) for doc in self._documents() for table in doc.get(_LISTS[kind], [])]
        if kind == "curve":
            number = int(key) if key.isdecimal() else -1
            if not 0 <= number <= len(places):
                raise ManifestError(f"curve {key!r}: there are {len(places)}, numbered from 0")
            return places[number] if number < len(places) else (None, None)
        return next(((table, doc) for table, doc in places if table.get("name") == key), (None, None))

    def _refuse_rename(self, edit: Edit) -> None:
        """Keep the names that corrections go by."""
        renamed = (edit.set or {}).get("name", edit.key)
        if renamed == edit.key:
            return
        starts = {"observation": edit.key, "sequence": f"{edit.key}#", "finger": f"{edit.key}/"}
        start = starts.get(edit.kind)
        for item in CorrectionLog(self.folder).rulings():
            if item == start or (start is not None and start[-1] in "#/" and item.startswith(start)):
                raise ManifestError(
                    f"{edit.kind} {edit.key}: it has corrections, which are kept under its name: "
                    "take them back before you rename it"
                )

    def _rename(self, key: str, old: str, new: str) -> None:
        """Let all that goes by a name go by the new one."""
        for doc in self._documents():
            tables = [table for name in _LISTS.values() for table in doc.get(name, [])]
            tables += [photo for finger in doc.get("fingers", []) for photo in finger.get("photographs", [])]
            for table in tables:
                if table.get(key) == old:
                    table[key] = new
        if self.sheet is not None:
            self.sheet.rename(key, old, new)

    def _documents(self) -> list[Any]:
        return [self.draft] if self.study is None else [self.study, self.draft]

    def _waiting(self) -> Iterator[tuple[Kind, str, dict[str, Any]]]:
        """Yield the tables of the draft."""
        content = self.draft.unwrap()
        for name, table in content.get("scales", {}).items():
            yield "scale", name, table
        kind: Any
        for kind, name in _LISTS.items():
            before = len(self.study.get(name, [])) if self.study is not None and kind == "curve" else 0
            for number, table in enumerate(content.get(name, [])):
                yield kind, str(before + number) if kind == "curve" else str(table.get("name", "")), table

    def _faults(self, kind: Kind, key: str, content: Mapping[str, Any]) -> tuple[str, ...]:
        """Say what the manifest would not take of a table of the draft."""
        where = f"{kind} {key}"
        try:
            if kind == "scale":
                checked: Table = validated(_Scale, {"name": key, "table": content}, where, strict=True)
            else:
                checked = validated(_MODELS[kind], content, where, strict=True)
        except ManifestError as error:
            lines = str(error).replace(f"{where}: table.", f"{where}: ").splitlines()
            return tuple(line.removeprefix(f"{where}: ") for line in lines)
        return tuple(self._reference_faults(checked, key))

    def _reference_faults(self, checked: Table, key: str) -> Iterator[str]:
        """Say which finger, scale or file is not there, or which name is taken."""
        home = self.study if self.study is not None else {}
        name, finger = getattr(checked, "name", None), getattr(checked, "finger", None)
        others = home.get("scales", {}) if isinstance(checked, _Scale) else _names(home, checked)
        if name is not None and name.casefold() in {other.casefold() for other in others}:
            yield f"name: {name!r} is taken; names must differ by more than case"
        if finger is not None and not any(each["name"] == finger for each in home.get("fingers", [])):
            yield f"finger: {finger!r} is not complete, or there is none of this name"
        for part in (checked, *getattr(checked, "photographs", [])):
            scale = part.table if isinstance(part, _Scale) else getattr(part, "scale", None)
            if isinstance(scale, str) and scale not in self._complete_scales():
                yield f"scale: {scale!r} is not complete, or there is none of this name"
            named = {place: getattr(part, place, None) for place in _FILES}
            for place, file in (named | {"coin": getattr(scale, "coin", None)}).items():
                if file is not None:
                    try:
                        file_inside(self.folder, file, key, f".{place}")
                    except ManifestError as error:
                        yield str(error).removeprefix(f"{key}: .")

    def _complete_scales(self) -> set[str]:
        known = set() if self.study is None else set(self.study.get("scales", {}))
        waiting = self.draft.unwrap().get("scales", {})
        return known | {name for name, table in waiting.items() if not self._faults("scale", name, table)}

    def settle(self) -> None:
        """Move what is complete from the draft to the manifest, and check the whole.

        Raises
        ------
        ManifestError
            If what was complete is wrong now.
        """
        if self.study is not None:
            self._check()
        before = [None if doc is None else tomlkit.dumps(doc) for doc in (self.study, self.draft)]
        moved = self._move_complete()
        try:
            if moved and self.study is not None:
                self._check()
        except ManifestError:
            moved = False  # `state` says why
        if not moved or (self.study is not None and not self.study.get("fingers")):
            self.study, draft = (_parsed("", text) for text in before)
            self.draft = draft if draft is not None else tomlkit.document()

    def _move_complete(self) -> bool:
        """Move all tables without faults, what others go by first; tell whether there was one."""
        if self.study is None:
            self.study = tomlkit.document()
            for name in [name for name in self.draft if name not in _TABLES or name == "uncertainty"]:
                self.study[name] = self.draft.pop(name)
        moved = False
        for kind in ("scale", *_LISTS):
            for waiting, key, content in list(self._waiting()):
                if waiting == kind and not self._faults(waiting, key, content):
                    self._move(waiting, key, content)
                    moved = True
        return moved

    def _move(self, kind: Kind, key: str, content: dict[str, Any]) -> None:
        assert self.study is not None
        if kind == "scale":
            if "scales" not in self.study:
                self.study["scales"] = tomlkit.table(True)
            _update(_new_table(self.study["scales"], key), content)
            _remove_scale(self.draft, key)
            return
        _update(_added(self.study, _LISTS[kind]), content)
        table = next(one for one in self.draft[_LISTS[kind]] if one.unwrap() == content)
        _remove(self.draft, _LISTS[kind], table)

    def _check(self) -> None:
        """Let the manifest's own reader check what is about to be written.

        Raises
        ------
        ManifestError
            In the reader's words.
        """
        trial, sheet = self.folder / f".{STUDY_NAME}.new", None
        document = self.study
        if self.sheet is not None and self._sheet_name is not None:
            sheet = self.folder / ".observations.new.csv"
            sheet.write_text(self.sheet.text(), encoding="utf-8", newline="")
            document = tomlkit.parse(tomlkit.dumps(self.study))
            document["observations_csv"] = sheet.name
        try:
            trial.write_text(tomlkit.dumps(document), encoding="utf-8")
            read_study(trial)
        except ManifestError as error:
            words = str(error).replace(trial.name, STUDY_NAME)
            if sheet is not None:
                words = words.replace(sheet.name, str(self._sheet_name))
            raise ManifestError(words) from None
        finally:
            trial.unlink(missing_ok=True)
            if sheet is not None:
                sheet.unlink(missing_ok=True)

    def write(self) -> None:
        """Put the changed files in place of the old ones, each at once."""
        texts: dict[str | None, str | None] = {
            self._sheet_name: None if self.sheet is None else self.sheet.text(),
            STUDY_NAME: None if self.study is None else tomlkit.dumps(self.study),
            DRAFT_NAME: tomlkit.dumps(self.draft) if self.draft.unwrap() else None,
        }
        old: dict[str | None, str | None] = dict(self._texts.items())
        old[self._sheet_name] = self._sheet_text
        for name, text in texts.items():
            if name is None or text == old[name]:
                continue
            if text is None:
                (self.folder / name).unlink(missing_ok=True)
            else:
                _replace(self.folder / name, text)

    def _drop_what_moved(self) -> None:
        """Forget what a process that was stopped between two files has left in both."""
        if self.study is None:
            return
        for name in [name for name in self.draft if name not in _TABLES or name == "uncertainty"]:
            self.draft.pop(name)
        for scale in set(self.draft.get("scales", {})) & set(self.study.get("scales", {})):
            _remove_scale(self.draft, scale)
        for name in _LISTS.values():
            there = [table.unwrap() for table in self.study.get(name, [])]
            for table in [one for one in self.draft.get(name, []) if one.unwrap() in there]:
                _remove(self.draft, name, table)


def _require_tables(document: Any, name: str = DRAFT_NAME) -> None:
    """Refuse what someone wrote by hand in place of tables."""
    for kind in _LISTS.values():
        listed = document.get(kind, [])
        if not isinstance(listed, list) or not all(isinstance(table, dict) for table in listed):
            raise ManifestError(f"{name}: {kind}: expected a list of tables, as in [[{kind}]]")
    for kind in ("scales", "uncertainty"):
        if not isinstance(document.get(kind, {}), dict):
            raise ManifestError(f"{name}: {kind}: expected a table, as in [{kind}]")
    for finger in document.get("fingers", []):
        photographs = finger.get("photographs", [])
        if not isinstance(photographs, list) or not all(isinstance(one, dict) for one in photographs):
            raise ManifestError(f"{name}: fingers.photographs: expected a list of tables")


def _names(home: Mapping[str, Any], checked: Table) -> list[str]:
    """Return the names among which a table's must differ."""
    lists = ("fingers",) if isinstance(checked, Finger) else ("observations", "sequences")
    return [str(table["name"]) for name in lists for table in home.get(name, [])]


def _update(table: Any, values: Mapping[str, Any]) -> None:
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


def _new_table(tables: Any, key: str) -> Any:
    tables[key] = _spaced(tomlkit.table())
    return tables[key]


def _added(home: Any, name: str) -> Any:
    """Return a new table at the end of a list of tables."""
    if name not in home:
        home[name] = tomlkit.aot()
    listed = home[name]
    listed.append(_spaced(tomlkit.table()) if isinstance(listed, AoT) else tomlkit.inline_table())
    return listed[-1]


def _spaced(table: Any) -> Any:
    """Return a table with an empty line before it."""
    table.trivia.indent = "\n"
    return table


def _remove(home: Any, name: str, table: Any) -> None:
    """Remove a table from a list of tables, and the list with its last one."""
    listed = home[name]
    listed.pop(next(place for place, one in enumerate(listed) if one is table))
    if not listed:
        home.pop(name)


def _remove_scale(home: Any, name: str) -> None:
    """Remove a scale, and the table of scales with its last one."""
    home["scales"].pop(name)
    if not home["scales"]:
        home.pop("scales")


def _parsed(name: str, text: str | None) -> Any:
    try:
        return None if text is None else tomlkit.parse(text)
    except (TOMLKitError, ValueError, RecursionError) as error:
        raise ManifestError(f"{name}: not valid TOML: {error}") from error


def _text(path: Path) -> str | None:
    try:
        return path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        return None
    except (OSError, UnicodeDecodeError) as error:
        raise ManifestError(f"{path}: cannot be read ({error})") from error


def _digest(texts: Sequence[str | None]) -> str:
    digest = hashlib.sha256()
    for text in texts:
        digest.update(b"-" if text is None else b"+" + hashlib.sha256(text.encode()).digest())
    return digest.hexdigest()


def _replace(path: Path, text: str) -> None:
    """Write a file so that it is there whole, old or new, whatever happens."""
    new = path.with_name(f".{path.name}.new")
    new.parent.mkdir(parents=True, exist_ok=True)
    with new.open("w", encoding="utf-8", newline="") as file:
        file.write(text)
        file.flush()
        os.fsync(file.fileno())
    new.replace(path)
    sync_folder(path.parent)


@contextmanager
def _locked(folder: Path) -> Iterator[None]:
    """Hold the lock of the manifest, and say plainly where it cannot be written."""
    try:
        with FileLock(folder / LOCK_NAME, timeout=_WAIT_S):
            yield
    except Timeout:
        raise StoreError(f"{folder}: another process has been writing for {_WAIT_S:g} s: try again") from None
    except OSError as error:
        raise StoreError(f"{folder}: the study cannot be written ({error.strerror})") from error
