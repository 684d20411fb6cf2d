"""A study while it is edited: what is complete of it, what waits, and what can be changed."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fingerpad.study.editing.incomplete import Kind
from fingerpad.study.manifest import Study


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
class IncompleteTable:
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

    @property
    def tables(self) -> list[Mapping[str, Any]]:
        """The table, and the photographs in it."""
        photographs = self.content.get("photographs")
        inner = photographs if isinstance(photographs, list) else []
        return [self.content, *(one for one in inner if isinstance(one, Mapping))]


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyState:
    """The current state of a study.

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
    incomplete : tuple of IncompleteTable
        What is not.
    """

    folder: Path
    digest: str
    title: str
    study: Study | None
    incomplete: tuple[IncompleteTable, ...]


def named_files(study: Study | None, incomplete: Iterable[IncompleteTable]) -> set[str]:
    """Return the names of files that a study uses, and all texts of what is incomplete: any may be one."""
    names = {name for _, name in study.named_files()} if study is not None else set()
    for table in (table for one in incomplete for table in one.tables):
        scale = table.get("scale")
        inner = scale.values() if isinstance(scale, Mapping) else ()
        names.update(value for value in (*table.values(), *inner) if isinstance(value, str))
    return names
