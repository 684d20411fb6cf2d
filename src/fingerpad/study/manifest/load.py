"""Loading a study: its manifest and spreadsheet, with everything that can be checked before any work.

The tables without a fault, whose finger and scale have none either, make up the study; the others are kept
as they stand, each with what it lacks.
"""

import hashlib
import re
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from fingerpad._display import Displayed
from fingerpad.exceptions import ManifestError
from fingerpad.study.journal import recover
from fingerpad.study.manifest.check import MODELS, SECTIONS, Kind, Table, TableChecks
from fingerpad.study.manifest.files import file_inside
from fingerpad.study.manifest.sheet import Sheet
from fingerpad.study.manifest.study import Study
from fingerpad.study.manifest.validation import Fault, checked

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
    """A study, complete or not.

    Attributes
    ----------
    folder : Path
        The study folder.
    digest : str
        Of the bytes of its manifest and spreadsheet: what an author has seen.
    study : Study
        What is complete of it.
    tables : tuple of Table
        All scales, fingers, observations, sequences and curves; of the top level and the sections what is
        wrong.
    issues : tuple of str
        What is missing or wrong, each naming its file and key; a study without any can be run.
    """

    folder: Path
    digest: str
    study: Study
    tables: tuple[Table, ...] = ()
    issues: tuple[str, ...] = ()

    @property
    def incomplete(self) -> list[Table]:
        """The tables that are not part of the study yet."""
        return [table for table in self.tables if not table.complete]

    def complete(self) -> Study:
        """Return the study if nothing of it is missing or wrong.

        Raises
        ------
        ManifestError
            With one line for each issue.
        """
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


def load_study(
    path: Path, on_read: Callable[[str, bytes], None] = lambda _name, _content: None
) -> LoadedStudy:
    """Load a study from its manifest and check everything: values, references, and that all files are there.

    Parameters
    ----------
    path : Path
        The TOML file. File names in it are relative to its folder.
    on_read : callable
        Called with the name and the content of each file that is read.

    Raises
    ------
    ManifestError
        If there is no manifest, or it is not made of tables, so that nothing of it can be used.
    """
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
    on_read(path.name, content)

    def read(name: str) -> bytes:
        rows = file_inside(path.parent, name).read_bytes()
        on_read(name, rows)
        return rows

    return checked_study(path, content, read)


def is_as_read(loaded: LoadedStudy) -> bool:
    """Tell whether the manifest and the spreadsheet of a study are what was read of them."""
    sheet = loaded.study.observations_csv
    try:
        content = (loaded.folder / STUDY_NAME).read_bytes()
        rows = b"" if sheet is None else (loaded.folder / sheet).read_bytes()
    except OSError:
        return False
    return _digest(content, rows) == loaded.digest


def _digest(content: bytes, rows: bytes) -> str:
    return hashlib.sha256(hashlib.sha256(content).digest() + rows).hexdigest()


def read_study(path: Path, on_read: Callable[[str, bytes], None] = lambda _name, _content: None) -> Study:
    """Load a study that can be run.

    Raises
    ------
    ManifestError
        Naming the file, and for each issue its key, what was found and what was expected.
    """
    return load_study(path, on_read).complete()


def _toml_error(content: bytes, error: Exception) -> str:
    """Return what a parser says is wrong, with the line that it names."""
    place = re.search(r"at line (\d+)", str(error))
    lines = content.decode("utf-8-sig").splitlines()
    if place is None or not 0 < int(place[1]) <= len(lines):
        return str(error)
    line = lines[int(place[1]) - 1].strip()
    return f"{error}: {line[:60]!r}; text stands in quotes, and numbers have a decimal point"


def checked_study(path: Path, content: bytes, read: Callable[[str], bytes]) -> LoadedStudy:
    """Check what a manifest says, or is going to say.

    Parameters
    ----------
    path : Path
        The manifest, which need not say it yet.
    content : bytes
        What it says.
    read : callable
        Gives the content of the spreadsheet that it names.

    Raises
    ------
    ManifestError
        If it is not made of tables.
    """
    try:
        document = tomllib.loads(content.decode("utf-8-sig"))
    except UnicodeDecodeError as error:
        raise ManifestError(f"{path}: cannot be read ({error})") from error
    except (ValueError, RecursionError) as error:
        raise ManifestError(f"{path}: not valid TOML: {_toml_error(content, error)}") from error
    require_tables(document, path.name)
    top, wrong = _top_level(document, path)
    rows, tables = b"", list(_tables(document, path.name))
    if top.observations_csv is not None:
        try:
            rows = read(top.observations_csv)
            tables += _rows(Sheet.parse(top.observations_csv, rows))
        except (ManifestError, OSError) as error:
            fault = Fault("observations_csv", str(error))
            wrong.append(Table(kind="study", key="", content={}, file=path.name, place="", faults=(fault,)))
    check = TableChecks(path.parent)
    found = (*wrong, *map(check.checked, tables))
    issues = [line for one in found for line in one.lines]
    if not document.get("fingers"):
        issues.append(f"{path.name}: fingers: no finger yet: add one")
    return LoadedStudy(
        folder=path.parent,
        digest=_digest(content, rows),
        study=_study(top, found),
        tables=found,
        issues=tuple(issues),
    )


def _study(top: Study, tables: Iterable[Table]) -> Study:
    """Return the study that the complete tables make up."""
    lists: dict[str, Any] = {name: [] for name in LISTS.values()}
    scales = {}
    for one in tables:
        if one.complete and one.kind == "scale":
            scales[one.key] = one.model
        elif one.complete:
            lists[LISTS[one.kind]].append(one.model)
    return top.model_copy(update={**lists, "scales": scales})


def require_tables(document: Mapping[str, Any], file: str) -> None:
    """Refuse other values in place of tables.

    Raises
    ------
    ManifestError
        Naming the file and the key.
    """
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


def _top_level(document: Mapping[str, Any], path: Path) -> tuple[Study, list[Table]]:
    """Return the study without its lists of tables, and what is wrong at the top level."""
    parts: dict[Kind, tuple[str, Any]] = {
        "study": ("", {key: value for key, value in document.items() if key not in TABLES}),
        **{name: (name, document.get(name, {})) for name in SECTIONS},
    }
    found, wrong = {}, []
    for kind, (place, content) in parts.items():
        _, faults = checked(MODELS[kind], content, strict=True)
        if faults:
            wrong.append(
                Table(kind=kind, key="", content=content, file=path.name, place=place, faults=faults)
            )
        bad = {fault.place for fault in faults}
        fields = SECTIONS.get(kind, Study).model_fields
        found[kind] = {key: value for key, value in content.items() if key in fields and key not in bad}
    title = {"title": path.absolute().parent.name}
    sections: dict[str, Any] = {name: model(**found[name]) for name, model in SECTIONS.items()}
    return Study(**{**title, **found["study"], **sections}), wrong


def _tables(document: Mapping[str, Any], file: str) -> Iterator[Table]:
    """Yield the tables of a manifest; what others refer to comes first."""
    for name, content in document.get("scales", {}).items():
        yield Table(kind="scale", key=name, content=content, file=file, place=f"scales.{name}")
    for kind, name in LISTS.items():
        for number, content in enumerate(document.get(name, [])):
            key = str(number) if kind == "curve" else str(content.get("name", ""))
            yield Table(kind=kind, key=key, content=content, file=file, place=f"{name}[{number}]")


def _rows(sheet: Sheet) -> Iterator[Table]:
    """Yield the observations of a spreadsheet."""
    for line, content, faults in sheet.tables():
        yield Table(
            kind="observation",
            key=str(content.get("name", "")),
            content=content,
            file=f"{sheet.name}, line {line}",
            place="",
            faults=faults,
        )
