"""The tables of a study, checked one by one: values, names, references and files."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final, Literal, TypeAlias
from unicodedata import normalize

from pydantic import TypeAdapter

from fingerpad.exceptions import ManifestError
from fingerpad.study.manifest.contacts import ContactSequence, Observation
from fingerpad.study.manifest.curves import Curve
from fingerpad.study.manifest.files import file_inside
from fingerpad.study.manifest.fingers import Finger
from fingerpad.study.manifest.scales import OwnScale
from fingerpad.study.manifest.study import Apparatus, Study, Uncertainty
from fingerpad.study.manifest.tables import ManifestModel, Name
from fingerpad.study.manifest.validation import Fault, checked, key_path

Kind: TypeAlias = Literal[
    "study", "uncertainty", "apparatus", "scale", "finger", "photograph", "observation", "sequence", "curve"
]

_NAME: Final = TypeAdapter(Name)
# Tables that a study has once.
SECTIONS: Final[Mapping[Kind, type[ManifestModel]]] = {"uncertainty": Uncertainty, "apparatus": Apparatus}
MODELS: Final[Mapping[Kind, TypeAdapter[Any]]] = {
    "study": TypeAdapter(Study),
    **{name: TypeAdapter(model) for name, model in SECTIONS.items()},
    "scale": TypeAdapter(OwnScale),
    "finger": TypeAdapter(Finger),
    "observation": TypeAdapter(Observation),
    "sequence": TypeAdapter(ContactSequence),
    "curve": TypeAdapter(Curve),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """A table as the manifest or the spreadsheet has it.

    Attributes
    ----------
    kind, key : str
        What it is, and its name; of a curve its number from 0, of the top level and the sections empty.
    content : dict
        What it says.
    file, place : str
        The file that holds it, with the line in a spreadsheet, and its place there.
    faults : tuple of Fault
        What is missing or wrong in it.
    model : ManifestModel or None
        The table as a model, where its values are right.
    complete : bool
        Whether it is part of the study: without faults, and not waiting for a finger or a scale.
    """

    kind: Kind
    key: str
    content: dict[str, Any]
    file: str
    place: str
    faults: tuple[Fault, ...] = ()
    model: ManifestModel | None = None
    complete: bool = False

    @property
    def lines(self) -> list[str]:
        """The faults, each with where it is."""
        name = self.content.get("name")
        lines = []
        for place, words in self.faults:
            where = ".".join(part for part in (self.place, place) if part)
            owner = f" (in {name})" if isinstance(name, str) and place != "name" else ""
            lines.append(": ".join(part for part in (self.file, where, words + owner) if part))
        return lines

    @property
    def tables(self) -> list[Mapping[str, Any]]:
        """Its content, and that of the photographs in it."""
        inner = self.content.get("photographs", []) if self.kind == "finger" else []
        return [self.content, *inner]


class TableChecks:
    """Checks tables one by one; those that others refer to must come first."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        # Names seen so far by their folded form: of scales, fingers, and observations and sequences.
        self._scales: dict[str, str] = {}
        self._fingers: dict[str, str] = {}
        self._contacts: dict[str, str] = {}
        self._incomplete: set[tuple[Kind, str]] = set()

    def checked(self, table: Table) -> Table:
        """Return the next table with its faults."""
        model, faults = None, table.faults
        if not faults:  # what is of a spreadsheet has no place but its line, and is text
            model, faults = checked(MODELS[table.kind], table.content, strict=bool(table.place))
        faults = (*faults, *self._name_faults(table))
        if model is not None:
            faults = (*faults, *self._reference_faults(model), *_file_faults(model, self._folder))
        complete = model is not None and not faults and not self._waits(model)
        if not complete:
            self._incomplete.add((table.kind, table.key))
        return replace(table, faults=faults, model=model, complete=complete)

    def _name_faults(self, table: Table) -> Iterator[Fault]:
        if table.kind == "curve":
            return
        names = {"scale": self._scales, "finger": self._fingers}.get(table.kind, self._contacts)
        place = "" if table.kind == "scale" else "name"
        if table.kind == "scale":
            yield from checked(_NAME, table.key, strict=True)[1]
        if _folded(table.key) in names:
            yield Fault(place, f"{table.key!r} is taken; names must differ by more than case")
        names.setdefault(_folded(table.key), table.key)

    def _reference_faults(self, model: ManifestModel) -> Iterator[Fault]:
        """Yield which finger and which scales are not there."""
        finger = getattr(model, "finger", None)
        if finger is not None and self._fingers.get(_folded(finger)) != finger:
            known = f"; there is {', '.join(self._fingers.values())}" if self._fingers else ""
            yield Fault("finger", f"no finger is named {finger!r}{known}")
        for place, scale in _scales_of(model):
            if self._scales.get(_folded(scale)) != scale:
                known = ", ".join(self._scales.values())
                known = f"there is {known}" if known else f"write a table [scales.{scale}]"
                yield Fault(place, f"no scale is named {scale!r}; {known}")

    def _waits(self, model: ManifestModel) -> bool:
        """Tell whether a finger or a scale of a table is not complete."""
        referred = [
            ("finger", getattr(model, "finger", None)),
            *(("scale", name) for _, name in _scales_of(model)),
        ]
        return not self._incomplete.isdisjoint(referred)


def _folded(name: str) -> str:
    """Return a name without its case and its way to write accents: names of files must differ by more."""
    return normalize("NFC", name).casefold()


def _scales_of(model: ManifestModel) -> Iterator[tuple[str, str]]:
    """Yield each place where a table refers to a scale by name, and the name."""
    for loc, part in (((), model), *model.tables()):
        scale = getattr(part, "scale", None)
        if isinstance(scale, str):
            yield key_path((*loc, "scale")), scale


def _file_faults(model: ManifestModel, folder: Path) -> Iterator[Fault]:
    """Yield which files are not in the study folder."""
    for loc, name in model.files():
        try:
            file_inside(folder, name, may_be_folder=isinstance(model, ContactSequence) and loc == ("file",))
        except ManifestError as error:
            yield Fault(key_path(loc), str(error))
