"""The documents of a study while they are changed: the manifest, its draft and its spreadsheet."""

import hashlib
import re
import tomllib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, Final

import tomlkit

from fingerpad.exceptions import ManifestError
from fingerpad.study.atomic_files import read_text_or_none
from fingerpad.study.editing.incomplete import Kind, Known, validation_errors
from fingerpad.study.editing.sheet import Sheet
from fingerpad.study.editing.state import IncompleteTable, StudyState
from fingerpad.study.editing.toml_tables import (
    added,
    new_table,
    parsed,
    plain,
    remove,
    remove_scale,
    update,
)
from fingerpad.study.journal import recover, replace_files
from fingerpad.study.manifest import Study, read_study
from fingerpad.study.manifest.read import file_inside

STUDY_NAME: Final = "study.toml"
DRAFT_NAME: Final = "draft.toml"

LISTS: Final = {
    "finger": "fingers",
    "observation": "observations",
    "sequence": "sequences",
    "curve": "curves",
}
_FIRST_TABLE: Final = re.compile(r"^\s*\[", re.MULTILINE)
TABLES: Final = frozenset((*LISTS.values(), "scales", "uncertainty"))


class StudyFiles:
    """The documents of a study while they are changed: the manifest, its draft and its spreadsheet."""

    def __init__(self, folder: Path, texts: dict[str, str | None], study: Any) -> None:
        self.folder = folder
        self.study = study
        self._texts = texts
        self._checked: Study | None = None
        draft = parsed(DRAFT_NAME, texts[DRAFT_NAME])
        self.draft = tomlkit.document() if draft is None else draft
        require_tables(self.draft, DRAFT_NAME)
        self.sheet: Sheet | None = None
        self._sheet_name: str | None = None
        if study is not None:
            require_tables(study, STUDY_NAME)
            self._read_sheet()
            self._drop_what_moved()

    @classmethod
    def read(cls, folder: Path) -> "StudyFiles":
        """Read what there is of a study, to look at it.

        Raises
        ------
        ManifestError
            If there is none, or it is damaged.
        """
        recover(folder)
        texts = _texts_of(folder)
        try:
            study = None if texts[STUDY_NAME] is None else tomllib.loads(texts[STUDY_NAME])
        except (ValueError, RecursionError) as error:
            raise ManifestError(f"{STUDY_NAME}: not valid TOML: {error}") from error
        return cls(folder, texts, study)

    @classmethod
    def to_edit(cls, folder: Path) -> "StudyFiles":
        """Read what there is of a study as `read` does, ten times slower, with its comments."""
        texts = _texts_of(folder)
        return cls(folder, texts, parsed(STUDY_NAME, texts[STUDY_NAME]))

    def _read_sheet(self) -> None:
        name = self.study.get("observations_csv")
        if name is None:
            return
        self._sheet_name = str(name)
        self.sheet = Sheet.read(file_inside(self.folder, self._sheet_name, STUDY_NAME, "observations_csv"))
        self._texts[self._sheet_name] = self.sheet.text()

    @property
    def digest(self) -> str:
        """Digest of what the files said when they were read or written last."""
        return digest_of(list(self._texts.values()))

    @property
    def title(self) -> str:
        """The study's title."""
        home = self.draft if self.study is None else self.study
        return str(home.get("title", "study"))

    def state(self) -> StudyState:
        """Return what the files say."""
        study = self._checked
        if study is None and self.study is not None:
            study = read_study(self.folder / STUDY_NAME)
        known = self._known()
        return StudyState(
            folder=self.folder,
            digest=self.digest,
            title=self.title,
            study=study,
            incomplete=tuple(
                IncompleteTable(
                    kind=kind,
                    key=key,
                    content=content,
                    faults=validation_errors(kind, key, content, known=known, folder=self.folder),
                )
                for kind, key, content in self._waiting()
            ),
        )

    def documents(self) -> list[Any]:
        """Return the documents in which tables may lie."""
        return [self.draft] if self.study is None else [self.study, self.draft]

    def _waiting(self) -> Iterator[tuple[Kind, str, dict[str, Any]]]:
        """Yield the tables of the draft."""
        content = self.draft.unwrap()
        for name, table in content.get("scales", {}).items():
            yield "scale", name, table
        kind: Any
        for kind, name in LISTS.items():
            before = len(self.study.get(name, [])) if self.study is not None and kind == "curve" else 0
            for number, table in enumerate(content.get(name, [])):
                yield kind, str(before + number) if kind == "curve" else str(table.get("name", "")), table

    def _known(self) -> Known:
        """Return the names that a table of the draft may go by, or may not have again."""
        home = {} if self.study is None else self.study
        waiting = self.draft.unwrap().get("scales", {})
        no_names = Known(
            scales=frozenset(), waiting_scales=frozenset(), fingers=frozenset(), contacts=frozenset()
        )
        return Known(
            scales=frozenset(map(str, home.get("scales", {}))),
            waiting_scales=frozenset(
                name
                for name, table in waiting.items()
                if not validation_errors("scale", name, table, known=no_names, folder=self.folder)
            ),
            fingers=frozenset(str(one["name"]) for one in home.get("fingers", [])),
            contacts=frozenset(
                str(one["name"]) for name in ("observations", "sequences") for one in home.get(name, [])
            ),
        )

    def settle(self) -> None:
        """Move what is complete from the draft to the manifest, and check the whole.

        Raises
        ------
        ManifestError
            If what was complete is wrong now.
        """
        if self.study is not None:
            self._checked = self._check()
        before = [None if doc is None else tomlkit.dumps(doc) for doc in (self.study, self.draft)]
        was_study = self.study is not None
        if self._move_complete() and self.study.get("fingers"):
            try:
                self._checked = self._check()
            except ManifestError:
                pass  # each is valid alone, but not together: they wait
            else:
                return
        elif was_study:
            return
        self.study, draft = (parsed("", text) for text in before)
        self.draft = tomlkit.document() if draft is None else draft

    def _move_complete(self) -> bool:
        """Move all tables without faults, what others go by first; tell whether there was one."""
        if self.study is None:
            self.study = tomlkit.document()
            for name in [name for name in self.draft if name not in TABLES or name == "uncertainty"]:
                self.study[name] = self.draft.pop(name)
        moved = False
        for kind in ("scale", *LISTS):
            for waiting, key, content in list(self._waiting()):
                if waiting != kind or validation_errors(
                    waiting, key, content, known=self._known(), folder=self.folder
                ):
                    continue
                self._move(waiting, key, content)
                moved = True
        return moved

    def _move(self, kind: Kind, key: str, content: dict[str, Any]) -> None:
        assert self.study is not None
        if kind == "scale":
            if "scales" not in self.study:
                self.study["scales"] = tomlkit.table(True)
            update(new_table(self.study["scales"], key), content)
            remove_scale(self.draft, key)
            return
        update(added(self.study, LISTS[kind]), content)
        table = next(one for one in self.draft[LISTS[kind]] if one.unwrap() == content)
        remove(self.draft, LISTS[kind], table)

    def _check(self) -> Study:
        """Let the manifest's own reader check and read what is about to be written.

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
            return read_study(trial)
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
        """Put the changed files in place of the old ones: all of them, or none."""
        texts: dict[str, str | None] = {
            STUDY_NAME: None if self.study is None else tomlkit.dumps(self.study),
            DRAFT_NAME: tomlkit.dumps(self.draft) if self.draft else None,
        }
        if self.sheet is not None and self._sheet_name is not None:
            texts[self._sheet_name] = self.sheet.text()
        replace_files(
            self.folder, {name: text for name, text in texts.items() if text != self._texts.get(name)}
        )
        self._texts |= texts

    def _drop_what_moved(self) -> None:
        """Forget what a process that was stopped between two files has left in both."""
        for name in [name for name in self.draft if name not in TABLES or name == "uncertainty"]:
            self.draft.pop(name)
        for scale in set(self.draft.get("scales", {})) & set(self.study.get("scales", {})):
            remove_scale(self.draft, scale)
        for name in LISTS.values():
            waiting = self.draft.get(name, [])
            there = [plain(table) for table in self.study.get(name, [])] if waiting else []
            for table in [one for one in waiting if plain(one) in there]:
                remove(self.draft, name, table)


def title_of(folder: Path) -> str | None:
    """Return a study's title at a glance, without reading its tables; None where that does not tell it."""
    try:
        text = next(text for text in _texts_of(folder).values() if text is not None)
        title = tomllib.loads(_FIRST_TABLE.split(text, maxsplit=1)[0]).get("title")
    except (ManifestError, tomllib.TOMLDecodeError):
        return None
    return title if isinstance(title, str) else None


def require_tables(document: Any, name: str) -> None:
    """Refuse what someone wrote by hand in place of tables."""
    for kind in LISTS.values():
        listed = document.get(kind, [])
        if not isinstance(listed, list) or not all(isinstance(table, dict) for table in listed):
            raise ManifestError(f"{name}: {kind}: expected a list of tables, as in [[{kind}]]")
    for kind in ("scales", "uncertainty"):
        if not isinstance(document.get(kind, {}), dict):
            raise ManifestError(f"{name}: {kind}: expected a table, as in [{kind}]")
    for scale, table in document.get("scales", {}).items():
        if not isinstance(table, dict):
            raise ManifestError(f"{name}: scales.{scale}: expected a table, as in {{ ppi = 500 }}")
    for finger in document.get("fingers", []):
        photographs = finger.get("photographs", [])
        if not isinstance(photographs, list) or not all(isinstance(one, dict) for one in photographs):
            raise ManifestError(f"{name}: fingers.photographs: expected a list of tables")


def _texts_of(folder: Path) -> dict[str, str | None]:
    texts = {name: read_text_or_none(folder / name) for name in (STUDY_NAME, DRAFT_NAME)}
    if not any(text is not None for text in texts.values()):
        raise ManifestError(f"{folder}: holds no study; make one, or open another folder")
    return texts


def digest_of(texts: Sequence[str | None]) -> str:
    """Return the SHA-256 of some texts, or of their absence."""
    digest = hashlib.sha256()
    for text in texts:
        digest.update(b"-" if text is None else b"+" + hashlib.sha256(text.encode()).digest())
    return digest.hexdigest()
