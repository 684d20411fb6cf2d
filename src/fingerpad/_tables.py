"""The cells of a table: CSV, a workbook's first sheet (XLSX), vectors (MAT) or channels (TDMS)."""

import csv
import io
import re
import struct
import zipfile
import zlib
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from datetime import date, datetime
from itertools import zip_longest
from pathlib import Path
from typing import Any, Final, Literal
from xml.parsers import expat

import numpy as np

from fingerpad._csv import unescape_formula
from fingerpad.exceptions import FingerpadError

TABLE_SUFFIXES: Final = frozenset((".csv", ".tsv", ".xlsx", ".mat", ".tdms"))
_HEAD_BYTES: Final = 65536
_GUESS_ROWS: Final = 20
# Of a workbook or a MAT file, whatever it is packed into: bytes, cells from the first to the last one.
_MOST_BYTES: Final = 100_000_000
_MOST_CELLS: Final = 5_000_000
_MOST_PARTS: Final = 1000
_PARTS: Final = re.compile(
    r"\[Content_Types\]\.xml|_rels/\.rels|xl/(?!media/|drawings/|embeddings/).*(xml|rels)"
)
# A matrix with more columns is no table but an image or the like.
_MOST_MATRIX_COLUMNS: Final = 50
_COMPRESSED: Final = 15  # MAT: type of an element that is packed
_MAT_HEADER: Final = 128
# One number, its thousands included, by which 1,234 may be more than a decimal fraction.
_NUMBER: Final = re.compile(r"[-+]?[\d.,]+(e[-+]?\d+)?", re.IGNORECASE)
_DATE: Final = re.compile(r"\d{4}-\d\d-\d\d.*|(\d+ days?, )?\d+:\d\d.*")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Table:
    """The cells of a table as text."""

    name: str  # its file, for messages
    header: list[str]  # the cells of its first line; empty where it has none
    rows: list[tuple[int, list[str]]]  # the number of each other line that is not blank, and its cells
    separator: str  # what separates its cells, empty where it is no text file
    sheet: str = ""  # of a workbook that has several

    def line(self, number: int) -> str:
        """Return how messages name a line."""
        return f"{'line' if self.separator else 'row'} {number}"

    def texts(self, indices: Sequence[int]) -> list[list[str]]:
        """Return the cells of columns, with decimal points where these columns have decimal commas."""
        columns = [
            [cells[index].strip() if index < len(cells) else "" for _, cells in self.rows]
            for index in indices
        ]
        if not self.has_decimal_commas(cell for column in columns for cell in column):
            return columns
        return [[with_point(cell) for cell in column] for column in columns]

    def has_decimal_commas(self, cells: Iterable[str]) -> bool:
        """Tell whether commas in numbers mark decimals: they separate no cells, and no number has a point."""
        if self.separator == ",":
            return False
        # 24.12.2026 is a date.
        marked = [cell for cell in cells if "," in cell or cell.count(".") == 1]
        numbers = [cell for cell in marked if _NUMBER.fullmatch(cell)] if "," in "".join(marked) else []
        return bool(numbers) and all(cell.count(",") == 1 and "." not in cell for cell in numbers)

    def require_headers(self, error: type[FingerpadError]) -> None:
        """Raise `error` if a line has cells beyond the last header."""
        for number, cells in self.rows:
            if len(cells) > len(self.header) and any(map(str.strip, cells[len(self.header) :])):
                is_header = not any(_NUMBER.fullmatch(cell.strip()) for cell in cells)
                way_out = (
                    f"if {self.line(number)} is the header, delete the lines above it"
                    if is_header
                    else "decimal commas need semicolons or tabs between cells"
                )
                raise error(
                    f"{self.name}: {self.line(number)} has {len(cells)} cells under {len(self.header)} "
                    f"headers: {way_out}"
                )

    def hint(self, cell: str) -> str:
        """Return what is to be done about a cell that is not a number, with the colon before it."""
        if not cell.strip():
            return ": fill it in, or leave out the row"
        if not self.separator and _DATE.fullmatch(cell):
            return ": the cell is a date or a time in the workbook: give the column the format of numbers"
        if "," in cell:
            return ": decimal commas need semicolons or tabs between cells, and no decimal point in the table"
        return ""


def with_point(cell: str) -> str:
    """Return a cell that is a number with a point in place of its decimal comma, others as they are."""
    return cell.replace(",", ".") if _NUMBER.fullmatch(cell) else cell


def read_table(
    path: Path,
    error: type[FingerpadError],
    *,
    head_only: bool = False,
    is_wanted: Callable[[list[str]], bool] | None = None,
) -> Table:
    """Read the cells of a file of any kind that `_kind_of` knows.

    Where the header of a workbook's first sheet is not wanted, the only sheet whose header is stands for it.
    """
    if path.is_char_device():
        raise error(f"{path}: is a device, not a file")  # which may have no end
    try:
        with path.open("rb") as file:
            content = file.read(_HEAD_BYTES) if head_only else file.read()
            if head_only and len(content) == _HEAD_BYTES:
                head_is_enough = _kind_of(content, path.name) in {"text", "hdf5"}
                content = content.rpartition(b"\n")[0] if head_is_enough else content + file.read()
    except FileNotFoundError:
        raise error(f"{path}: no such file: check the path") from None
    except OSError as fault:
        raise error(f"{path}: cannot be read ({fault.strerror})") from fault
    return parse_table(content, str(path), error, is_wanted=is_wanted)


def _kind_of(content: bytes, name: str) -> Literal["xlsx", "tdms", "hdf5", "mat", "text"]:
    """Return the kind of a file by its first bytes, or else by its name."""
    if content[:4] == b"PK\x03\x04":
        return "xlsx"
    if content[:4] == b"TDSm":
        return "tdms"
    if b"\x89HDF\r\n" in (content[:6], content[512:518]):
        return "hdf5"
    return "mat" if name.lower().endswith(".mat") else "text"


def parse_table(
    content: bytes | str,
    name: str,
    error: type[FingerpadError],
    *,
    is_wanted: Callable[[list[str]], bool] | None = None,
) -> Table:
    """Return the cells of a file's content, or of a text; errors are those of `read_table`."""
    separator = sheet = ""
    lines: Iterable[tuple[int, list[str]]]
    if isinstance(content, str) or (kind := _kind_of(content, name)) == "text":
        try:
            text = content if isinstance(content, str) else _decoded(content)
            separator = _separator(text)
            reader = csv.reader(io.StringIO(text, newline=""), delimiter=separator)
            lines = [(reader.line_num, row) for row in reader]
            if "'" in text:
                lines = [(number, [unescape_formula(cell) for cell in row]) for number, row in lines]
        except (UnicodeDecodeError, csv.Error) as fault:
            raise error(f"{name}: cannot be read as CSV ({fault})") from fault
    elif kind == "xlsx":
        sheet, cells = _sheet_cells(content, name, error, is_wanted)
        lines = enumerate(cells, 1)
    elif kind == "tdms":
        lines = enumerate(_tdms_cells(content, name, error))
    elif kind == "mat":
        lines = enumerate(_mat_cells(content, name, error))
    else:
        raise error(
            f"{name}: is HDF5, as MATLAB's version 7.3: save it again with save('curve.mat', ..., '-v7')"
        )
    rows = [(number, row) for number, row in lines if any(map(str.strip, row))]
    header = _header(row for _, row in rows)
    return Table(name=name, header=header, rows=rows[1:], separator=separator, sheet=sheet)


def _header(rows: Iterable[list[str]]) -> list[str]:
    """Return the cells of the first row that is not blank."""
    return next(([cell.strip() for cell in row] for row in rows if any(map(str.strip, row))), [])


def _decoded(content: bytes) -> str:
    """Return text in UTF-8, or else in the 8-bit code of Windows, in which instruments write µ and ²."""
    if content[:4] == b"\xd0\xcf\x11\xe0":
        raise csv.Error("is an old Excel workbook: save it as XLSX or CSV")
    if b"\0" in content:
        raise csv.Error("holds zero bytes; UTF-8 is expected")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("cp1252")


def _separator(text: str) -> str:
    """Return what divides the first lines into equally many cells, or else the commonest in the header."""
    lines = [line for line in text[:_HEAD_BYTES].splitlines() if line.strip()][:_GUESS_ROWS]
    for mark in "\t;,":
        try:
            widths = {len(row) for row in csv.reader(lines, delimiter=mark)}
        except csv.Error:
            continue
        if len(widths) == 1 and widths != {1}:
            return mark
    return max(",;\t", key=lines[0].count) if lines else ","


def _sheet_cells(
    content: bytes,
    name: str,
    error: type[FingerpadError],
    is_wanted: Callable[[list[str]], bool] | None,
) -> tuple[str, list[list[str]]]:
    """Return a sheet of a workbook, and its name where there are several: dates as text, formulas' values.

    It is the first one, or the only one whose header is wanted where that of the first is not.
    """
    try:
        from python_calamine import CalamineError, CalamineWorkbook
    except ImportError as fault:
        raise error(f"{name}: reading XLSX needs python-calamine: pip install 'fingerpad[study]'") from fault
    try:
        book = CalamineWorkbook.from_filelike(io.BytesIO(_unpacked_workbook(content)))

        def cells(sheet: str) -> list[list[str]]:
            rows = book.get_sheet_by_name(sheet).to_python(skip_empty_area=False)
            return [[_cell_text(cell) for cell in row] for row in rows]

        first, *others = book.sheet_names
        found = {first: cells(first)}
        if others and is_wanted and not is_wanted(_header(found[first])):
            wanted = {}
            for sheet in others:
                with suppress(CalamineError):  # a chart, or damaged
                    if is_wanted(_header(rows := cells(sheet))):
                        wanted[sheet] = rows
            found = wanted if len(wanted) == 1 else found
    except _TooLarge as fault:
        raise error(f"{name}: {fault}: keep only the table in it, or save it as CSV") from None
    except (
        *(CalamineError, zipfile.BadZipFile, zlib.error, expat.ExpatError, OSError, EOFError),
        *(RuntimeError, NotImplementedError, ValueError, KeyError),
    ) as fault:
        raise error(f"{name}: is no XLSX workbook, or a damaged one: save it as CSV") from fault
    ((sheet, rows),) = found.items()
    return (sheet if others else ""), rows


class _TooLarge(Exception):  # noqa: N818 (the reader's own, which raises the error that is asked for)
    """What a packed file would be when unpacked."""


def _unpacked_workbook(content: bytes) -> bytes:
    """Return a workbook as a ZIP that is not compressed, its sheets within the limits.

    Sizes that a ZIP declares may be wrong, and a reader of cells makes room for all from the first to the
    last one: both are found out here.
    """
    target, size, texts, longest = io.BytesIO(), 0, 0, 0
    with zipfile.ZipFile(io.BytesIO(content)) as packed, zipfile.ZipFile(target, "w") as unpacked:
        members = [member for member in packed.infolist() if _PARTS.fullmatch(member.filename)]
        if len(members) > _MOST_PARTS:
            raise _TooLarge(f"has {len(members)} parts")
        for member in members:
            with packed.open(member) as file:
                part = file.read(_MOST_BYTES - size + 1)
            size += len(part)
            if size > _MOST_BYTES or member.file_size > _MOST_BYTES:
                raise _TooLarge(f"is larger than {_MOST_BYTES // 1_000_000} MB when unpacked")
            if member.filename.startswith("xl/worksheets/") and member.filename.endswith(".xml"):
                texts += _text_cells(part)
            elif member.filename.endswith("sharedStrings.xml"):
                longest = max(map(len, part.split(b"<si")))
            unpacked.writestr(member.filename, part)
    if texts * longest > 10 * _MOST_BYTES:
        raise _TooLarge(f"repeats a text of {longest} bytes")
    return target.getvalue()


def _text_cells(sheet: bytes) -> int:
    """Return how many cells of a sheet hold shared texts; check how far its cells reach."""
    row = column = last_row = last_column = texts = 0

    def start(name: str, attributes: dict[str, str]) -> None:
        nonlocal row, column, last_row, last_column, texts
        match name.rpartition(":")[2]:
            case "row":
                row, column = int(attributes.get("r", row + 1)), 0
            case "c":
                column += 1
                if place := re.fullmatch(r"([A-Z]{1,3})(\d{1,7})", attributes.get("r", "")):
                    row, column = int(place[2]), 0
                    for letter in place[1]:
                        column = 26 * column + ord(letter) - ord("A") + 1
                texts += attributes.get("t") == "s"
            case "v" | "is":  # a cell without is only formatted
                last_row, last_column = max(last_row, row), max(last_column, column)

    def refuse(*_: Any) -> None:
        raise ValueError("declares entities, as no workbook does")

    parser = expat.ParserCreate()
    parser.StartElementHandler, parser.StartDoctypeDeclHandler = start, refuse
    parser.Parse(sheet, True)
    if last_row * last_column > _MOST_CELLS:
        raise _TooLarge(f"has a sheet of {last_row} x {last_column} cells")
    return texts


def _cell_text(cell: Any) -> str:
    if isinstance(cell, bool):
        return "true" if cell else "false"
    if isinstance(cell, float):
        return str(int(cell)) if cell.is_integer() and abs(cell) < 1e15 else repr(cell)
    if isinstance(cell, datetime):
        return cell.isoformat(sep=" ")
    return cell.isoformat() if isinstance(cell, date) else str(cell)


def _mat_cells(content: bytes, name: str, error: type[FingerpadError]) -> Iterator[list[str]]:
    """Yield the names of a MAT file's vectors, then their values."""
    from scipy import io as matlab

    try:
        variables = matlab.loadmat(io.BytesIO(_unpacked_mat(content)))
    except _TooLarge as fault:
        raise error(f"{name}: {fault}: keep only the table in it, or save it as CSV") from None
    except Exception as fault:  # scipy raises many kinds for bytes that are no MAT file
        raise error(f"{name}: is no MAT file of version 7 or below, or a damaged one ({fault})") from fault
    columns = list(_vectors({key: value for key, value in variables.items() if not key.startswith("__")}))
    if not columns:
        raise error(
            f"{name}: holds no vectors of numbers; save each column as one, named with its unit: "
            "save('curve.mat', 'time_s', 'force_N', '-v7'); of a table T: "
            "s = table2struct(T, 'ToScalar', true); save('curve.mat', '-struct', 's', '-v7')"
        )
    yield [title for title, _ in columns]
    values = [map(repr, column.tolist()) for _, column in columns]
    yield from map(list, zip_longest(*values, fillvalue=""))


def _tdms_cells(content: bytes, name: str, error: type[FingerpadError]) -> Iterator[list[str]]:
    """Yield the names of a TDMS file's channels with their units, then their values."""
    try:
        columns = _channels(content)
    except ImportError as fault:
        raise error(f"{name}: reading TDMS needs npTDMS: pip install 'fingerpad[tdms]'") from fault
    except _TooLarge as fault:
        raise error(f"{name}: {fault}: keep only the press in it, or save it as CSV") from None
    except Exception as fault:  # npTDMS raises many kinds for damaged bytes
        raise error(f"{name}: is no TDMS file, or a damaged one ({fault}): save it as CSV") from fault
    if not columns:
        raise error(f"{name}: holds no channels of numbers: save force and displacement as channels")
    yield list(columns)
    values = [map(repr, column.tolist()) for column in columns.values()]
    yield from map(list, zip_longest(*values, fillvalue=""))


def _channels(content: bytes) -> dict[str, Any]:
    """Return the channels of numbers; their time, too, where they state its steps and no channel is it."""
    from nptdms import TdmsFile

    columns: dict[str, Any] = {}
    with TdmsFile.open(io.BytesIO(content)) as file:
        channels = [each for group in file.groups() for each in group.channels() if len(each) > 1]
        if (count := sum(map(len, channels))) > _MOST_CELLS:
            raise _TooLarge(f"says that it holds {count} values")
        names = [each.name for each in channels]
        for channel in channels:
            values = channel[:]
            if values.dtype.kind not in "biuf":
                continue
            unit = channel.properties.get("unit_string", "")
            title = channel.name if names.count(channel.name) == 1 else f"{channel.group_name} {channel.name}"
            columns[f"{title} ({unit})" if unit else title] = values
            if "wf_increment" in channel.properties and not any("time" in one.lower() for one in names):
                columns.setdefault("time_s", channel.time_track())
    return columns


def _unpacked_mat(content: bytes) -> bytes:
    """Return a MAT file without compression, within the limit."""
    order = {b"IM": "<", b"MI": ">"}.get(content[126:128])
    if order is None:  # version 4, which has none
        return content
    parts, start, size = [content[:_MAT_HEADER]], _MAT_HEADER, 0
    while start + 8 <= len(content):
        kind, length = struct.unpack(f"{order}II", content[start : start + 8])
        stop = start + 8 + length
        if kind == _COMPRESSED:
            part = zlib.decompressobj().decompress(content[start + 8 : stop], _MOST_BYTES - size + 1)
        else:
            part = content[start:stop]
        size += len(part)
        if size > _MOST_BYTES:
            raise _TooLarge(f"is larger than {_MOST_BYTES // 1_000_000} MB when unpacked")
        parts.append(part)
        start = stop
    return b"".join(parts)


def _vectors(variables: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    """Yield the vectors of numbers among variables, in structures and matrices too, with their names."""
    for title, value in variables.items():
        if not isinstance(value, np.ndarray) or value.ndim != 2:
            continue
        if value.dtype.names and value.size == 1:
            yield from _vectors({field: value[0, 0][field] for field in value.dtype.names})
        elif value.dtype.kind in "biuf" and value.size > 1:
            if 1 in value.shape:
                yield title, value.ravel()
            elif value.shape[1] <= _MOST_MATRIX_COLUMNS:
                yield from ((f"{title} column {k}", column) for k, column in enumerate(value.T, 1))
