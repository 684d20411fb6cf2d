"""Loading a study: its manifest and spreadsheet, with everything that can be checked before any work.

The tables without a fault, whose finger and scale have none either, make up the study; the others are kept
as they stand, each with what it lacks.
"""

import hashlib
import os
import re
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import chain
from pathlib import Path
from typing import Any, Final, Literal, Self, TypeAlias, TypeVar

from pydantic import BaseModel, TypeAdapter

from fingerpad._display import Displayed
from fingerpad._files import digest_of, folded, leads_out
from fingerpad._words import joined
from fingerpad.exceptions import ManifestError
from fingerpad.study.journal import recover
from fingerpad.study.manifest import models
from fingerpad.study.manifest.models import Fault, checked, key_path
from fingerpad.study.manifest.sheet import Sheet


def file_inside(folder: Path, name: str, *, may_be_folder: bool = False) -> Path:
    """Return the path of a file of the study; `ManifestError` if it is not inside its folder."""
    path, home = folder / name, os.path.realpath(folder)
    if leads_out(name):
        raise ManifestError(
            f"{name!r} leaves the study folder, or is named from outside it; name the file from the study "
            "folder, without .."
        )
    try:
        # A study names thousands of files: each check is a few system calls.
        known = path.exists() if may_be_folder else path.is_file()
        real = os.path.realpath(path)
        inside = real == home or real.startswith(os.path.join(home, ""))
        entries = list(os.scandir(path)) if may_be_folder and inside and path.is_dir() else []
        links = sorted(entry.name for entry in entries if entry.is_symlink())
        outside = [name for name in links if not (path / name).resolve().is_relative_to(home)]
    except (OSError, ValueError, RuntimeError) as error:  # a name too long, a NUL in it, a loop of links
        raise ManifestError(f"{name[:60]!r} is no file name ({error})") from error
    if not inside:
        raise ManifestError(f"{name!r} leaves the study folder; copy the file into it")
    if not known:
        raise ManifestError(f"no file {name!r} in the study folder")
    if outside:
        raise ManifestError(
            f"{f'{name}/{outside[0]}'!r} is a link that leaves the study folder; copy the file into it"
        )
    return path


def read_inside(folder: Path, name: str) -> bytes:
    """Return the content of a file of the study; `ManifestError` as of `file_inside`, or if unreadable."""
    path = file_inside(folder, name)
    try:
        return path.read_bytes()
    except OSError as error:
        raise ManifestError(f"{name}: cannot be read ({error.strerror})") from error


Kind: TypeAlias = Literal[
    "study", "uncertainty", "apparatus", "scale", "finger", "photograph", "observation", "sequence", "curve"
]

NAME: Final = TypeAdapter(models.Name)
# Tables that a study has once.
SECTIONS: Final[Mapping[Kind, type[models.ManifestModel]]] = {
    "uncertainty": models.Uncertainty,
    "apparatus": models.Apparatus,
}
MODELS: Final[Mapping[Kind, TypeAdapter[Any]]] = {
    "study": TypeAdapter(models.Study),
    **{name: TypeAdapter(model) for name, model in SECTIONS.items()},
    "scale": TypeAdapter(models.OwnScale),
    "finger": TypeAdapter(models.Finger),
    "observation": TypeAdapter(models.Observation),
    "sequence": TypeAdapter(models.ContactSequence),
    "curve": TypeAdapter(models.Curve),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """A table as the manifest or the spreadsheet has it."""

    kind: Kind
    key: str = ""  # its name, of a curve its number from 0
    content: dict[str, Any] = field(default_factory=dict)  # `model` says all of a complete row
    file: str
    line: int = 0  # of a row of a spreadsheet
    key_path: str = ""  # in the manifest
    faults: tuple[Fault, ...] = ()
    model: models.ManifestModel | None = None  # where its values are right
    complete: bool = False  # without faults, and not waiting for a finger or a scale

    @property
    def lines(self) -> list[str]:
        """The faults, each with where it is."""
        name, file = self.content.get("name"), f"{self.file}, line {self.line}" if self.line else self.file
        lines = []
        for place, words in self.faults:
            where = ".".join(part for part in (self.key_path, place) if part)
            owner = f" (in {name})" if isinstance(name, str) and place != "name" else ""
            lines.append(": ".join(part for part in (file, where, words + owner) if part))
        return lines

    @property
    def stated(self) -> dict[str, Any]:
        """The keys that it states; where it is not complete they may hold anything."""
        if self.model is None or not self.complete:
            return self.content
        return self.model.model_dump(mode="json", exclude_unset=True)

    @property
    def tables(self) -> list[Mapping[str, Any]]:
        """Its content, and that of the photographs in it."""
        inner = self.content.get("photographs", []) if self.kind == "finger" else []
        return [self.content, *inner]


_NONE: Final[dict[str, Any]] = {}
AnyModel = TypeVar("AnyModel", bound=BaseModel)


class TableChecks:
    """Checks tables one by one; those that others refer to must come first."""

    def __init__(self, folder: Path, surface: models.Surface = "ridged") -> None:
        self._folder, self._surface = folder, surface
        # Names seen so far by their folded form; observations and sequences share theirs.
        self._names: dict[Kind, dict[str, str]] = {"scale": {}, "finger": {}, "observation": {}}
        self._incomplete: set[tuple[Kind, str]] = set()
        self._stated: dict[frozenset[str], set[str]] = {}

    def checked(self, table: Table) -> Table:
        """Return the next table with its faults."""
        model, faults = None, table.faults
        if not faults:  # what is of a spreadsheet has no place but its line, and is text
            model, faults = checked(MODELS[table.kind], table.content, strict=bool(table.key_path))
        if (
            isinstance(model, models.Observation | models.ContactSequence)
            and "surface" not in model.model_fields_set
        ):
            model = model.model_copy(update={"surface": self._surface if model.file else "ridged"})
        if model is not None:
            model = self._with_shared_keys(model)
        faults = (*faults, *self._name_faults(table))
        if model is not None:
            faults = (*faults, *self._reference_faults(model), *_file_faults(model, self._folder))
        referred = set() if model is None else {(kind, name) for _, kind, name in _references(model)}
        complete = model is not None and not faults and self._incomplete.isdisjoint(referred)
        if not complete:
            self._incomplete.add((table.kind, table.key))
        # The cells of a row take half of its memory.
        content = _NONE if complete and not table.key_path else table.content
        return replace(table, content=content, faults=faults, model=model, complete=complete)

    def _with_shared_keys(self, model: AnyModel) -> AnyModel:
        """Return a model that takes half of the memory: its keys, and the set of those stated, are shared."""
        compact, stated = type(model).__new__(type(model)), frozenset(model.model_fields_set)
        attributes = {
            **dict(model),
            "__pydantic_fields_set__": self._stated.setdefault(stated, {*stated}),
            "__pydantic_extra__": None,
            "__pydantic_private__": None,
        }
        for name, value in attributes.items():
            kept = self._with_shared_keys(value) if isinstance(value, BaseModel) else value
            object.__setattr__(compact, name, kept)
        return compact

    def _name_faults(self, table: Table) -> Iterator[Fault]:
        if table.kind == "curve":
            return
        names = self._names["observation" if table.kind == "sequence" else table.kind]
        place = "" if table.kind == "scale" else "name"
        if table.kind == "scale":
            yield from checked(NAME, table.key, strict=True)[1]
        if folded(table.key) in names:
            yield Fault(place, f"{table.key!r} is taken; names must differ by more than case")
        names.setdefault(folded(table.key), table.key)

    def _reference_faults(self, model: models.ManifestModel) -> Iterator[Fault]:
        """Yield which finger and which scales are not there."""
        for place, kind, name in _references(model):
            names = self._names[kind]
            if names.get(folded(name)) != name:
                known = f"; there is {joined(names.values(), 5)}" if names else ""
                if kind == "scale" and not names:
                    known = f"; write a table [scales.{name}]"
                yield Fault(place, f"no {kind} is named {name!r}{known}")


def _references(model: models.ManifestModel) -> Iterator[tuple[str, Kind, str]]:
    """Yield each place where a table refers to a finger or a scale by name, which of them, and the name."""
    if (finger := getattr(model, "finger", None)) is not None:
        yield "finger", "finger", finger
    for loc, part in (((), model), *model.tables()):
        if isinstance(scale := getattr(part, "scale", None), str):
            yield key_path((*loc, "scale")), "scale", scale


def _file_faults(model: models.ManifestModel, folder: Path) -> Iterator[Fault]:
    """Yield which files are not in the study folder."""
    for loc, name in model.files():
        try:
            file_inside(
                folder, name, may_be_folder=isinstance(model, models.ContactSequence) and loc == ("file",)
            )
        except ManifestError as error:
            yield Fault(key_path(loc), str(error))


STUDY_NAME: Final = "study.toml"
# Lists of tables by the kind of table they hold; what others refer to comes first.
LISTS: Final[Mapping[Kind, str]] = {
    "finger": "fingers",
    "observation": "observations",
    "sequence": "sequences",
    "curve": "curves",
}
TABLES: Final = frozenset((*LISTS.values(), "scales", *SECTIONS))


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class LoadedStudy(Displayed):
    """A study, complete or not."""

    folder: Path
    digests: Mapping[str, str]  # SHA-256 of its manifest and spreadsheet, by name
    study: models.Study  # what is complete
    # All in lists; of the top level and the sections those that are wrong.
    tables: tuple[Table, ...] = ()
    issues: tuple[str, ...] = ()  # a study without any can be run

    @classmethod
    def empty(cls, folder: Path, faults: Iterable[str] = ()) -> Self:
        """Return a study without anything in it, and what is wrong with its manifest."""
        wrong = tuple(Fault("", words) for words in faults)
        damage = Table(kind="study", file="", faults=wrong)
        study, tables = models.Study(title=folder.absolute().name), (damage,) if wrong else ()
        return cls(folder=folder, digests={}, study=study, tables=tables, issues=tuple(damage.lines))

    @property
    def digest(self) -> str:
        """Digest of all that was read: what an author has seen."""
        return hashlib.sha256("".join(self.digests.values()).encode()).hexdigest()

    @property
    def incomplete(self) -> list[Table]:
        """The tables that are not part of the study yet."""
        return [table for table in self.tables if not table.complete]

    def table(self, kind: Kind, key: str) -> Table | None:
        """Return a table, None where there is none."""
        return next((one for one in self.tables if (one.kind, one.key) == (kind, key)), None)

    def complete(self) -> models.Study:
        """Return the study; `ManifestError` has one line for each issue."""
        if self.issues:
            raise ManifestError("\n".join(self.issues))
        return self.study

    def files(self) -> set[str]:
        """Return the names of files in use, and all texts of what is incomplete: any may be one."""
        names = {name for _, name in self.study.files()}
        for table in (table for one in self.incomplete for table in one.tables):
            scale = table.get("scale")
            inner = scale.values() if isinstance(scale, Mapping) else ()
            names.update(value for value in (*table.values(), *inner) if isinstance(value, str))
        return names


def manifest_in(path: Path) -> Path:
    """Return the manifest that a path means: itself, or ``study.toml`` in the folder that it is."""
    return path / STUDY_NAME if path.is_dir() else path


def load_study(path: Path) -> LoadedStudy:
    """Load a study from its manifest and check all values, references, and that the files are there."""
    recover(path.parent)
    if path.is_char_device():
        raise ManifestError(f"{path}: is a device, not a file")  # which may have no end
    try:
        content = path.read_bytes()
    except FileNotFoundError:
        raise ManifestError(
            f"{path}: no such file; `fingerpad init DIR` writes a manifest to start from"
        ) from None
    except OSError as error:
        raise ManifestError(f"{path}: cannot be read ({error})") from error
    return checked_study(path, content, partial(read_inside, path.parent))


def is_as_read(loaded: LoadedStudy) -> bool:
    """Tell whether the manifest and the spreadsheet of a study are what was read of them."""
    digests = {name: digest_of(loaded.folder / name) for name in (STUDY_NAME, *loaded.digests)}
    return digests == loaded.digests


def read_study(path: Path) -> models.Study:
    """Load a study that can be run; `ManifestError` names each issue."""
    return load_study(path).complete()


def _toml_error(content: bytes, error: Exception) -> str:
    """Return what a parser says is wrong, with the line that it names."""
    place = re.search(r"at line (\d+)", str(error))
    lines = content.decode("utf-8-sig").splitlines()
    if place is None or not 0 < int(place[1]) <= len(lines):
        return str(error)
    line = lines[int(place[1]) - 1].strip()
    return f"{error}: {line[:60]!r}; text stands in quotes, and numbers have a decimal point"


def checked_study(path: Path, content: bytes, read: Callable[[str], bytes]) -> LoadedStudy:
    """Check what a manifest says, or is going to say; `read` gives the content of its spreadsheet."""
    try:
        document = tomllib.loads(content.decode("utf-8-sig"))
    except UnicodeDecodeError as error:
        raise ManifestError(f"{path}: cannot be read ({error})") from error
    except (ValueError, RecursionError) as error:
        raise ManifestError(f"{path}: not valid TOML: {_toml_error(content, error)}") from error
    require_tables(document, path.name)
    top, wrong = _top_level(document, path)
    tables, digests = _tables(document, path.name), {path.name: hashlib.sha256(content).hexdigest()}
    if top.observations_csv is not None:
        digests[top.observations_csv] = ""  # as of a file that cannot be read: `is_as_read` sees it come back
        try:
            rows = read(top.observations_csv)
            digests[top.observations_csv] = hashlib.sha256(rows).hexdigest()
            tables = chain(tables, _rows(Sheet(top.observations_csv, rows)))
        except ManifestError as error:
            fault = Fault("observations_csv", str(error))
            wrong.append(Table(kind="study", file=path.name, faults=(fault,)))
    check = TableChecks(path.parent, top.surface)
    found = (*wrong, *map(check.checked, tables))
    lists: dict[str, Any] = {name: [] for name in LISTS.values()}
    for one in found:
        if one.complete and one.kind != "scale":
            lists[LISTS[one.kind]].append(one.model)
    scales = {one.key: one.model for one in found if one.complete and one.kind == "scale"}
    issues = [line for one in found for line in one.lines]
    if not document.get("fingers"):
        issues.append(f"{path.name}: fingers: no finger yet: add one")
    return LoadedStudy(
        folder=path.parent,
        digests=digests,
        study=top.model_copy(update={**lists, "scales": scales}),
        tables=found,
        issues=tuple(issues),
    )


def require_tables(document: Mapping[str, Any], file: str) -> None:
    """Refuse other values in place of tables."""
    for name in LISTS.values():
        _require_list(document.get(name, []), f"{file}: {name}", name)
    for finger in document.get("fingers", []):
        _require_list(finger.get("photographs", []), f"{file}: fingers.photographs", "fingers.photographs")
    for name in ("scales", *SECTIONS):
        if not isinstance(document.get(name, {}), Mapping):
            raise ManifestError(f"{file}: {name}: expected a table, as in [{name}]")
    for name, scale in document.get("scales", {}).items():
        if not isinstance(scale, Mapping):
            raise ManifestError(f"{file}: scales.{name}: expected a table, as in {{ ppi = 500 }}")


def _require_list(listed: Any, where: str, name: str) -> None:
    if isinstance(listed, Mapping):
        raise ManifestError(f"{where}: expected a list of tables: write [[{name}]] in place of [{name}]")
    if not isinstance(listed, list) or not all(isinstance(table, Mapping) for table in listed):
        raise ManifestError(f"{where}: expected a list of tables, as in [[{name}]]")


def _top_level(document: Mapping[str, Any], path: Path) -> tuple[models.Study, list[Table]]:
    """Return the study without its lists of tables, and what is wrong at the top level."""
    found, wrong = {}, []
    parts: dict[Kind, type[models.ManifestModel]] = {"study": models.Study, **SECTIONS}
    for kind, model in parts.items():
        place = kind if kind in SECTIONS else ""
        content = document.get(kind, {}) if place else {k: v for k, v in document.items() if k not in TABLES}
        _, faults = checked(MODELS[kind], content, strict=True)
        if faults:
            wrong.append(Table(kind=kind, content=content, file=path.name, key_path=place, faults=faults))
        bad = {fault.key_path for fault in faults}
        found[kind] = {key: of for key, of in content.items() if key in model.model_fields and key not in bad}
    sections: dict[str, Any] = {name: model(**found[name]) for name, model in SECTIONS.items()}
    return models.Study(**{"title": path.absolute().parent.name, **found["study"], **sections}), wrong


def _tables(document: Mapping[str, Any], file: str) -> Iterator[Table]:
    """Yield the tables of a manifest; what others refer to comes first."""
    for name, content in document.get("scales", {}).items():
        yield Table(kind="scale", key=name, content=content, file=file, key_path=f"scales.{name}")
    for kind, name in LISTS.items():
        for number, content in enumerate(document.get(name, [])):
            key = str(number) if kind == "curve" else str(content.get("name", ""))
            yield Table(kind=kind, key=key, content=content, file=file, key_path=f"{name}[{number}]")


def _rows(sheet: Sheet) -> Iterator[Table]:
    """Yield the observations of a spreadsheet."""
    for line, content, faults in sheet.tables():
        yield Table(
            kind="observation",
            key=str(content.get("name", "")),
            content=content,
            file=sheet.name,
            line=line,
            faults=faults,
        )
