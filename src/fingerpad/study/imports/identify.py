"""What new files are: by content and name together, and by a spreadsheet that names them."""

import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from os import PathLike
from pathlib import Path, PurePosixPath
from typing import Final, Literal, TypeAlias

from fingerpad._columns import NAMES
from fingerpad._tables import TABLE_SUFFIXES, Table, parse_table, read_table
from fingerpad.exceptions import ManifestError
from fingerpad.image import MEMORY_LIMIT, Face, guess_subject, open_frames
from fingerpad.image.read import in_colour, read_levels
from fingerpad.image.sequence.frames import PICTURE_SUFFIXES, TIFF_SUFFIXES, VIDEO_SUFFIXES
from fingerpad.study.imports import names

_MOST_BYTES: Final = 20_000_000
Meaning: TypeAlias = names.Field | Literal["file", "hand"]

_HEADERS: Final[Mapping[str, Meaning]] = names.words_of("header")
_SYMBOLS: Final[Mapping[str, Meaning]] = {"w": "load"}
_FIELDS_OF_UNITS: Final[tuple[tuple[Meaning, frozenset[str]], ...]] = (
    ("load", frozenset(names.FACTORS["load"])),
    ("wedge", frozenset(names.FACTORS["wedge"])),
    ("scale", frozenset(unit for name in ("mm_per_px", "px_per_mm", "ppi") for unit in names.FACTORS[name])),
)
_UNITS: Final = {unit for units in names.FACTORS.values() for unit in units}
_OTHERS: Final = names.words_of("other").keys()
# What can be a picture, a sequence, a curve, an outline or a spreadsheet that tells of them.
_SUFFIXES: Final[Mapping[names.FileKind, frozenset[str]]] = {
    "picture": PICTURE_SUFFIXES,
    "sequence": VIDEO_SUFFIXES,
    "table": TABLE_SUFFIXES,
}
USABLE_SUFFIXES: Final = frozenset[str]().union(*_SUFFIXES.values())


@dataclass(frozen=True, slots=True)
class FileColumn:
    """A column: its header, its meaning, None where unknown, and its unit."""

    header: str
    meaning: Meaning | None
    unit: str | None


@dataclass(frozen=True, slots=True, kw_only=True)
class FileRow:
    """A row of a spreadsheet: the file that it names, its values, and what could not be read."""

    line: int
    file: str
    values: names.FileValues
    problems: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class FileTable:
    """A spreadsheet that names files."""

    columns: tuple[FileColumn, ...]
    rows: tuple[FileRow, ...]
    sheet: str = ""  # which was read of a workbook that has several

    @property
    def unread(self) -> list[str]:
        """The headers of columns whose meaning is not known."""
        return [column.header for column in self.columns if column.header and not column.meaning]


@dataclass(frozen=True, slots=True, kw_only=True)
class JoinedFiles:
    """Files with the rows that name them."""

    rows: Mapping[str, FileRow]  # of each file that one row names
    rows_without_file: list[FileRow]  # rows that name no file, or one that another row names too
    files_without_row: list[str]


def read_file_table(path: str | PathLike[str]) -> FileTable:
    """Read a spreadsheet of which each row names a file and states something of it.

    One column names the file, by its header or, in any language, as the only one whose cells are names with
    a suffix; others are person, finger, hand, face, type, wedge angle, load, scale and session, in any order,
    each header in its usual words and with its unit: ``Load (mN)``, ``theta [deg]``, ``mm/px``. A unit in a
    cell holds before that of the header. Decimal commas are read too.
    """
    path = Path(path)
    if path.is_file() and path.stat().st_size > _MOST_BYTES:
        raise ManifestError(f"{path.name}: larger than {_MOST_BYTES // 1_000_000} MB")
    return file_table(read_table(path, ManifestError))


def parse_file_table(text: str) -> FileTable:
    """Read a spreadsheet, as `read_file_table` does, from text: cells that were copied, tabs between them."""
    return file_table(parse_table(text, "the pasted text", ManifestError))


def file_table(table: Table) -> FileTable:
    """Return the rows of a table as what they state of files; errors as of `read_file_table`."""
    name = PurePosixPath(table.name).name
    if not table.rows:
        raise ManifestError(f"{name}: a line of headers and at least one row are expected")
    columns = tuple(_column(header) for header in table.header)
    if not any(column.meaning == "file" for column in columns):
        of_names = [place for place in range(len(columns)) if _holds_names(table, place)]
        columns = tuple(
            replace(column, meaning="file") if [place] == of_names else column
            for place, column in enumerate(columns)
        )
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
    rows = tuple(_row(columns, cells, line) for line, cells in table.rows)
    return FileTable(columns=columns, rows=rows, sheet=table.sheet)


def _holds_names(table: Table, place: int) -> bool:
    """Tell whether the cells of a column are names of files."""
    files = [cells[place].strip() for _, cells in table.rows if place < len(cells) and cells[place].strip()]
    return bool(files) and all(PurePosixPath(file).suffix.lower() in USABLE_SUFFIXES for file in files)


def _column(header: str) -> FileColumn:
    lower = header.casefold()
    unit = next((unit for unit in _parts(lower) if unit in _UNITS), None)
    words = re.findall(r"[^\W\d_]+", lower)
    if not _OTHERS.isdisjoint(words):
        return FileColumn(header, None, None)
    meaning = next((_HEADERS[word] for word in words if word in _HEADERS), None)
    if meaning is None:
        meaning = next((_SYMBOLS[part] for part in _parts(lower) if part in _SYMBOLS), None)
    if meaning is None and unit is not None:
        meaning = next(field for field, units in _FIELDS_OF_UNITS if unit in units)
    if meaning is None and words in (["name"], ["observation"]):
        meaning = "file"
    return FileColumn(header, meaning, unit)


def _parts(header: str) -> list[str]:
    """Return the parts of a header that can be units, from the last."""
    plain = re.sub(r"[ _]per[ _]|(?<=m) / (?=p)", "/", header)
    return re.split(r"[\s_,;:()\[\]]+", plain)[::-1]


def _row(columns: Sequence[FileColumn], cells: Sequence[str], line: int) -> FileRow:
    values, problems, file, hand = names.FileValues(), [], "", ""
    for column, cell in zip(columns, map(str.strip, cells), strict=False):
        if not cell or column.meaning is None:
            continue
        if column.meaning == "file":
            file = cell
        elif column.meaning == "hand":
            hand = cell
        else:
            try:
                names.read_value(values, column.meaning, cell, column.unit)
            except ValueError as error:
                problems.append(f"{column.header}: {error}")
    if hand and "finger" in values:
        values["finger"] = names.finger_name(values["finger"], hand)
    return FileRow(line=line, file=file, values=values, problems=tuple(problems))


def join_files(table: FileTable, files: Iterable[str]) -> JoinedFiles:
    """Join rows to files by name: case, folders, punctuation, and a suffix where one fits, do not matter."""
    files = list(files)
    whole, stems = defaultdict[str, list[str]](list), defaultdict[str, list[str]](list)
    for file in files:
        whole[_key(file, with_suffix=True)].append(file)
        stems[_key(file, with_suffix=False)].append(file)
    owners: dict[str, list[FileRow]] = {}
    without = []
    for row in table.rows:
        # Of a name without suffix all is its stem; a decimal point in it begins no suffix.
        has_suffix = re.search(r"\.[A-Za-z]\w{1,4}$", row.file) is not None
        found = exact = whole.get(_key(row.file, with_suffix=True)) or []
        found = found or stems.get(_key(row.file, with_suffix=not has_suffix)) or []
        if len(found) == 1 and row.file:
            unlike = (f"{row.file} is not there: taken for {found[0]}",) if has_suffix and not exact else ()
            owners.setdefault(found[0], []).append(replace(row, problems=row.problems + unlike))
        else:
            without.append(row)
    without += [row for rows in owners.values() if len(rows) > 1 for row in rows]
    joined = {file: rows[0] for file, rows in owners.items() if len(rows) == 1}
    return JoinedFiles(
        rows=joined,
        rows_without_file=sorted(without, key=lambda row: row.line),
        files_without_row=[file for file in files if file not in joined],
    )


def _key(name: str, *, with_suffix: bool) -> str:
    last = PurePosixPath(name.replace("\\", "/"))
    plain = last.name if with_suffix else last.stem
    return re.sub(r"[\W_]+", "-", plain.casefold()).strip("-")


_OF_SUBJECT: Final[Mapping[str, names.Use]] = names.words_of("subject")
# A name that says what a file is counts as this factor; a likelihood at which a guess need not be asked.
_NAMED: Final = 200.0
SURE: Final = 0.9
_SIDES: Final[tuple[Face, ...]] = ("radial", "ulnar")


@dataclass(frozen=True, slots=True)
class GuessedScale:
    """A scale that may hold, and why."""

    scale: str
    why: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Guess:
    """What a new file may be, from its content and its name, and which scale may hold for it."""

    kind: names.FileKind
    uses: tuple[names.Use, ...]  # most likely first
    sure: bool  # whether no other use is at all likely; otherwise it is to be asked
    face: Face | None = None  # that it shows if it is a photograph, None where nothing tells
    face_sure: bool = False  # whether no other face is at all likely; the two sides count as one
    dots_per_inch: float | None = None  # that a picture states, as in `fingerpad.image.Picture`
    scales: Mapping[names.Use, GuessedScale] = field(default_factory=dict)  # by use
    stated: str = ""  # the scale in its file, proposed or not


def kind_of_file(name: str) -> names.FileKind:
    """Return the kind of a file by its name; pages of a TIFF file may make it a sequence."""
    suffix = PurePosixPath(name).suffix.lower()
    return next((kind for kind, suffixes in _SUFFIXES.items() if suffix in suffixes), "other")


def identify_file(path: str | PathLike[str], *, memory_limit: int = MEMORY_LIMIT) -> Guess:
    """Guess what a file is, by its content and its name.

    Pictures are looked at (`fingerpad.image.guess_subject`), tables are known by their headers, and
    sequences by their frames. A name that says it, as ``palmar`` or ``coin``, counts for much, and one with a
    load, as ``30deg_2N``, is that of a contact image.
    """
    path = Path(path)
    kind = kind_of_file(path.name)
    if kind == "table":
        return _identity(_table_uses(path), path, kind)
    if path.suffix.lower() in TIFF_SUFFIXES and open_frames(path, memory_limit=memory_limit).count > 1:
        kind = "sequence"
    if kind != "picture":
        return _identity({"sequence" if kind == "sequence" else "": 1.0}, path, kind)
    levels, dots_per_inch = read_levels(path, memory_limit)
    guess = guess_subject(in_colour(levels))
    uses = {_OF_SUBJECT[subject]: share for subject, share in guess.subjects.items()}
    return replace(_identity(uses, path, "picture", guess.faces), dots_per_inch=dots_per_inch)


def _identity(
    uses: Mapping[names.Use, float],
    path: Path,
    kind: names.FileKind,
    faces: Mapping[Face, float] | None = None,
) -> Guess:
    """Return what content and name say together."""
    reading = names.read_file_name(path.name, kind)
    weights, by_face = dict(uses), dict(faces or {})
    if kind == "picture":
        named: list[names.Use] = []
        if names.names_a_scale(path.name):
            named = ["coin", "ruler"]
        elif "face" in reading:
            named = ["photograph"]
        elif "load_N" in reading:  # which nothing else has: a small print can look like a ruler
            weights = {use: float(use == "observation") for use in weights}
        for use in named:
            weights[use] *= _NAMED
    if "face" in reading and kind in {"picture", "table"}:
        by_face = {reading["face"]: 1.0, **{face: 0.0 for face in by_face if face != reading["face"]}}
    sides = sum(by_face.get(face, 0.0) for face in _SIDES)  # which look alike
    return Guess(
        kind=kind,
        uses=tuple(sorted(weights, key=lambda use: -weights[use])),
        sure=max(weights.values()) >= SURE * sum(weights.values()),
        face=next(iter(by_face), None),
        face_sure=bool(by_face) and max(*by_face.values(), sides) >= SURE,
    )


def _table_uses(path: Path) -> dict[names.Use, float]:
    """Return what a table may be, by its headers."""
    table = read_table(path, ManifestError, head_only=True)
    headers = [cell.casefold() for cell in table.header]
    has = {
        # With or without a unit after it.
        name: any(
            re.match(rf"{word}(?=$|[_ ,/(\[])", header)
            for word in (*NAMES.get(name, ()), *more)
            for header in headers
        )
        for name, more in names.TABLES["column"].items()
    }
    if has["force"] and has["displacement"]:
        # Beside a sequence the platen's displacement may be recorded too.
        share = 0.04
        if has["time"] and has["trigger"]:
            share = 0.95
        elif has["time"] and names.names_a_force(path.name):
            share = 0.7
        return {"curve": 0.99 - share, "force": share, "": 0.01}
    with suppress(ManifestError):  # of a table that names no files
        if any(row.values for row in file_table(table).rows):
            return {"sheet": 0.95, "": 0.05}
    if has["force"] and has["time"]:
        return {"force": 0.95, "curve": 0.03, "": 0.02}
    if has["x"] and has["y"]:
        return {"outline": 0.95, "": 0.05}
    return {"": 0.6, "curve": 0.2, "force": 0.1, "outline": 0.1}
