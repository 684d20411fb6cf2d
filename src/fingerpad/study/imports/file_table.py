"""A spreadsheet that states person, finger, angle, load and scale of files, joined to them by name."""

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path, PurePosixPath
from typing import Final, Literal, NamedTuple, TypeAlias

from fingerpad._tables import Table, parse_table, read_table
from fingerpad.exceptions import ManifestError
from fingerpad.study.imports.values import FACTORS, Field, FileValues, finger_name, read_value

_MOST_BYTES: Final = 20_000_000
Meaning: TypeAlias = Field | Literal["file", "hand"]

# Words of a header, in order of preference; other words beside them do not matter.
_HEADERS: Final[Mapping[str, Meaning]] = {
    **dict.fromkeys(("file", "filename", "files", "image", "picture", "photo", "img"), "file"),
    **dict.fromkeys(("person", "subject", "participant", "volunteer", "donor"), "person"),
    **dict.fromkeys(("finger", "digit"), "finger"),
    "hand": "hand",
    **dict.fromkeys(("face", "view", "aspect"), "face"),
    **dict.fromkeys(("kind", "type", "role"), "role"),
    **dict.fromkeys(("wedge", "angle", "theta", "θ"), "wedge"),
    **dict.fromkeys(("load", "force", "weight"), "load"),
    **dict.fromkeys(("scale", "ppi", "dpi", "resolution", "pitch"), "scale"),
    **dict.fromkeys(("session", "visit"), "session"),
}
_SYMBOLS: Final[Mapping[str, Meaning]] = {"w": "load"}
_FIELDS_OF_UNITS: Final[tuple[tuple[Meaning, frozenset[str]], ...]] = (
    ("load", frozenset(FACTORS["load"])),
    ("wedge", frozenset(FACTORS["wedge"])),
    ("scale", frozenset(unit for name in ("mm_per_px", "px_per_mm", "ppi") for unit in FACTORS[name])),
)
_UNITS: Final = {unit for units in FACTORS.values() for unit in units}
# Of another quantity than the one stated for a file: uncertainties, rates, times.
_OTHERS: Final = frozenset(("std", "sd", "uncertainty", "rate", "time", "speed", "roll", "size", "date"))


class Column(NamedTuple):
    """A column: its header, its meaning, None where unknown, and its unit."""

    header: str
    meaning: Meaning | None
    unit: str | None


@dataclass(frozen=True, slots=True, kw_only=True)
class FileRow:
    """A row of a spreadsheet: the file that it names, its values, and what could not be read."""

    line: int
    file: str
    values: FileValues
    problems: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class FileTable:
    """A spreadsheet that names files.

    Attributes
    ----------
    columns : tuple of Column
        Its columns in order.
    rows : tuple of FileRow
        Its rows.
    """

    columns: tuple[Column, ...]
    rows: tuple[FileRow, ...]

    @property
    def unknown_columns(self) -> list[str]:
        """Headers that are not understood; their cells are left alone."""
        return [column.header for column in self.columns if column.meaning is None and column.header]


@dataclass(frozen=True, slots=True, kw_only=True)
class JoinedFiles:
    """Files with the rows that name them.

    Attributes
    ----------
    values : mapping of str to FileValues
        What the spreadsheet states of each file that one row names.
    rows_without_file : list of FileRow
        Rows that name no file, or one that another row names too.
    files_without_row : list of str
        Files that no row names.
    """

    values: Mapping[str, FileValues]
    rows_without_file: list[FileRow]
    files_without_row: list[str]


def read_file_table(path: str | PathLike[str]) -> FileTable:
    r"""Read a spreadsheet of which each row names a file and states something of it.

    One column names the file; others are person, finger, hand, face, type, wedge angle, load, scale and
    session, in any order, each header in its usual words and with its unit: ``Load (mN)``, ``theta [deg]``,
    ``mm/px``. A unit in a cell holds before that of the header. Decimal commas are read too.

    Parameters
    ----------
    path : path-like
        A CSV, TSV or XLSX file.

    Returns
    -------
    FileTable

    Raises
    ------
    ManifestError
        If it cannot be read, has no column of files, or two columns of one meaning.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "files.csv")
    ...     _ = path.write_text("file,load (mN)\nIMG_1,500\n")
    ...     read_file_table(path).rows[0].values
    {'load_N': 0.5}
    """
    path = Path(path)
    if path.is_file() and path.stat().st_size > _MOST_BYTES:
        raise ManifestError(f"{path.name}: larger than {_MOST_BYTES // 1_000_000} MB")
    return file_table(read_table(path, ManifestError))


def parse_file_table(text: str) -> FileTable:
    r"""Read a spreadsheet, as `read_file_table` does, from text: cells that were copied, tabs between them.

    Parameters
    ----------
    text : str
        A line of headers and the rows.

    Returns
    -------
    FileTable

    Raises
    ------
    ManifestError
        If it cannot be read, has no column of files, or two columns of one meaning.

    Examples
    --------
    >>> table = parse_file_table("file\tfinger\tload, mN\tmood\nIMG_1\tLI\t500\tgood")
    >>> table.rows[0].values
    {'finger': 'left_index', 'load_N': 0.5}
    >>> table.unknown_columns
    ['mood']
    """
    return file_table(parse_table(text, "the pasted text", ManifestError))


def file_table(table: Table) -> FileTable:
    """Return the rows of a table as what they state of files; errors as of `read_file_table`."""
    name = PurePosixPath(table.name).name
    if not table.rows:
        raise ManifestError(f"{name}: a line of headers and at least one row are expected")
    columns = tuple(_column(header) for header in table.header)
    counts = Counter(column.meaning for column in columns if column.meaning)
    if not counts["file"]:
        raise ManifestError(
            f"{name}: no column names the files; found {', '.join(filter(None, table.header))[:300]}. "
            "Call it file, in the first line"
        )
    twice = [meaning for meaning, count in counts.items() if count > 1]
    if twice:
        headers = " and ".join(repr(one.header) for one in columns if one.meaning == twice[0])
        raise ManifestError(f"{name}: {headers} both state the {twice[0]}: remove one")
    return FileTable(columns=columns, rows=tuple(_row(columns, cells, line) for line, cells in table.rows))


def _column(header: str) -> Column:
    lower = header.casefold()
    unit = next((unit for unit in _parts(lower) if unit in _UNITS), None)
    words = re.findall(r"[^\W\d_]+", lower)
    if not _OTHERS.isdisjoint(words):
        return Column(header, None, None)
    meaning = next((_HEADERS[word] for word in words if word in _HEADERS), None)
    if meaning is None:
        meaning = next((_SYMBOLS[part] for part in _parts(lower) if part in _SYMBOLS), None)
    if meaning is None and unit is not None:
        meaning = next(field for field, units in _FIELDS_OF_UNITS if unit in units)
    if meaning is None and words in (["name"], ["observation"]):
        meaning = "file"
    return Column(header, meaning, unit)


def _parts(header: str) -> list[str]:
    """Return the parts of a header that can be units, from the last."""
    plain = re.sub(r"[ _]per[ _]|(?<=m) / (?=p)", "/", header)
    return re.split(r"[\s_,;:()\[\]]+", plain)[::-1]


def _row(columns: Sequence[Column], cells: Sequence[str], line: int) -> FileRow:
    values, problems, file, hand = FileValues(), [], "", ""
    for column, cell in zip(columns, map(str.strip, cells), strict=False):
        if not cell or column.meaning is None:
            continue
        if column.meaning == "file":
            file = cell
        elif column.meaning == "hand":
            hand = cell
        else:
            try:
                read_value(values, column.meaning, cell, column.unit)
            except ValueError as error:
                problems.append(f"{column.header}: {error}")
    if hand and "finger" in values:
        values["finger"] = finger_name(values["finger"], hand)
    return FileRow(line=line, file=file, values=values, problems=tuple(problems))


def join_files(table: FileTable, files: Iterable[str]) -> JoinedFiles:
    r"""Join the rows of a spreadsheet to files by their names.

    Case, folders and characters that are neither letters nor digits do not matter, nor does a suffix where
    only one file has the rest of the name.

    Examples
    --------
    >>> table = parse_file_table("file,load\nIMG 1,2\nIMG_3.png,4")
    >>> found = join_files(table, ["uploads/img_1.PNG", "uploads/img_2.PNG"])
    >>> found.values, found.files_without_row
    ({'uploads/img_1.PNG': {'load_N': 2.0}}, ['uploads/img_2.PNG'])
    >>> [row.file for row in found.rows_without_file]
    ['IMG_3.png']
    """
    files = list(files)
    whole, stems = _by(files, with_suffix=True), _by(files, with_suffix=False)
    owners: dict[str, list[FileRow]] = {}
    without = []
    for row in table.rows:
        found = whole.get(_key(row.file, with_suffix=True)) or stems.get(_stem(row.file)) or []
        if len(found) == 1 and row.file:
            owners.setdefault(found[0], []).append(row)
        else:
            without.append(row)
    without += [row for rows in owners.values() if len(rows) > 1 for row in rows]
    values = {file: rows[0].values for file, rows in owners.items() if len(rows) == 1}
    return JoinedFiles(
        values=values,
        rows_without_file=sorted(without, key=lambda row: row.line),
        files_without_row=[file for file in files if file not in values],
    )


def _by(files: Iterable[str], *, with_suffix: bool) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for file in files:
        found.setdefault(_key(file, with_suffix=with_suffix), []).append(file)
    return found


def _stem(name: str) -> str:
    """Return the key of a name that may have a suffix; a decimal point in it begins none."""
    return _key(name, with_suffix=not re.search(r"\.[A-Za-z]\w{1,4}$", name))


def _key(name: str, *, with_suffix: bool) -> str:
    last = PurePosixPath(name.replace("\\", "/"))
    plain = last.name if with_suffix else last.stem
    return re.sub(r"[\W_]+", "-", plain.casefold()).strip("-")
