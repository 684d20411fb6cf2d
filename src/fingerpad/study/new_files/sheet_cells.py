"""Cells of a spreadsheet: CSV, TSV, or the first sheet of an XLSX workbook, of limited size."""

import csv
import io
import re
import zipfile
import zlib
from pathlib import Path
from typing import Final
from xml.etree import ElementTree

from fingerpad._csv import unescape_formula
from fingerpad.exceptions import ManifestError

SHEET_SUFFIXES: Final = frozenset((".csv", ".tsv", ".xlsx"))
_MOST_BYTES: Final = 20_000_000
_MOST_ROWS: Final = 100_000
_MOST_COLUMNS: Final = 200
_MOST_PARTS: Final = 1000
_MAIN: Final = "{http://schemas.openxmlformats.org/spreadsheetml/2006/main}"
_LINK: Final = "{http://schemas.openxmlformats.org/officeDocument/2006/relationships}id"
_DAMAGED: Final = (
    zipfile.BadZipFile,
    zlib.error,
    NotImplementedError,
    EOFError,
    RuntimeError,
    ElementTree.ParseError,
    KeyError,
    ValueError,
)


def read_cells(path: Path) -> list[list[str]]:
    """Read the cells of a CSV, TSV or XLSX file; rows without any text are left out.

    Of an XLSX workbook, the first sheet: text and numbers as stored, and the last values of formulas.

    Raises
    ------
    ManifestError
        If it cannot be read, or is too large.
    """
    try:
        if path.stat().st_size > _MOST_BYTES:
            raise ManifestError(f"{path.name}: larger than {_MOST_BYTES // 1_000_000} MB")
        if path.suffix.lower() == ".xlsx":
            return _kept(_workbook_cells(path), path.name)
        return cells_of_text(path.read_bytes().decode("utf-8-sig", errors="replace"), path.name)
    except OSError as error:
        raise ManifestError(f"{path.name}: cannot be read ({error.strerror})") from error


def cells_of_text(text: str, name: str = "the pasted text") -> list[list[str]]:
    r"""Return the cells of a text, separated by tabs, semicolons or commas, as its first line shows.

    Raises
    ------
    ManifestError
        If it is too large, or quotes are not closed.

    Examples
    --------
    >>> cells_of_text("file;load\na.png;1,5\n")
    [['file', 'load'], ['a.png', '1,5']]
    """
    if len(text) > _MOST_BYTES:
        raise ManifestError(f"{name}: larger than {_MOST_BYTES // 1_000_000} MB")
    first = next((line for line in text.splitlines() if line.strip()), "")
    mark = max("\t;,", key=first.count)
    try:
        rows = list(csv.reader(io.StringIO(text, newline=""), delimiter=mark))
    except csv.Error as error:
        raise ManifestError(f"{name}: cannot be read as a table ({error})") from error
    return _kept([[unescape_formula(cell) for cell in row] for row in rows], name)


def _kept(rows: list[list[str]], name: str) -> list[list[str]]:
    kept = [[cell.strip() for cell in row] for row in rows if any(cell.strip() for cell in row)]
    if len(kept) > _MOST_ROWS or any(len(row) > _MOST_COLUMNS for row in kept):
        raise ManifestError(f"{name}: more than {_MOST_ROWS} rows or {_MOST_COLUMNS} columns")
    return kept


def _workbook_cells(path: Path) -> list[list[str]]:
    try:
        with zipfile.ZipFile(path) as workbook:
            if len(workbook.infolist()) > _MOST_PARTS:
                raise ManifestError(f"{path.name}: holds too many parts for a workbook")
            texts = _shared_texts(workbook, path.name)
            sheet = _part(workbook, _first_sheet(workbook, path.name), path.name)
    except _DAMAGED as error:
        if isinstance(error, ManifestError):
            raise
        raise ManifestError(f"{path.name}: is no XLSX workbook, or a damaged one: save it as CSV") from error
    try:
        return [_row(row, texts) for row in sheet.iter(f"{_MAIN}row")]
    except (ValueError, IndexError) as error:
        raise ManifestError(f"{path.name}: its first sheet is damaged: save it as CSV") from error


def _part(workbook: zipfile.ZipFile, name: str, path: str) -> ElementTree.Element:
    """Return a part as XML: never more of it than the limit, and nothing that declares entities."""
    with workbook.open(name) as file:
        content = file.read(_MOST_BYTES + 1)
    if len(content) > _MOST_BYTES:
        raise ManifestError(f"{path}: larger than {_MOST_BYTES // 1_000_000} MB when unpacked")
    if b"<!" in content.replace(b"<!--", b"").replace(b"<![CDATA[", b"") or b"\0" in content:
        raise ManifestError(f"{path}: declares entities, as no workbook does: save it as CSV")
    return ElementTree.fromstring(content)  # noqa: S314 (without declarations, there are no entities)


def _first_sheet(workbook: zipfile.ZipFile, path: str) -> str:
    book = _part(workbook, "xl/workbook.xml", path)
    links = _part(workbook, "xl/_rels/workbook.xml.rels", path)
    sheet = book.find(f"{_MAIN}sheets/{_MAIN}sheet")
    wanted = None if sheet is None else sheet.get(_LINK)
    targets = {link.get("Id"): link.get("Target") or "" for link in links}
    target = targets[wanted]
    return target.lstrip("/") if target.startswith("/") else f"xl/{target}"


def _shared_texts(workbook: zipfile.ZipFile, path: str) -> list[str]:
    name = "xl/sharedStrings.xml"
    if name not in workbook.namelist():
        return []
    return [_text(item) for item in _part(workbook, name, path).iter(f"{_MAIN}si")]


def _text(item: ElementTree.Element) -> str:
    """Return the text of an item, without its phonetic guide."""
    runs = [item, *item.iter(f"{_MAIN}r")]
    return "".join(text.text or "" for run in runs for text in run.findall(f"{_MAIN}t"))


def _row(row: ElementTree.Element, texts: list[str]) -> list[str]:
    cells: list[str] = []
    for cell in row.iter(f"{_MAIN}c"):
        found = re.match(r"[A-Z]{1,3}(?=\d)", cell.get("r") or "")
        place = _column(found[0]) if found else len(cells)
        if place >= _MOST_COLUMNS:
            continue
        cells.extend([""] * (place + 1 - len(cells)))
        cells[place] = _cell(cell, texts)
    return cells


def _column(letters: str) -> int:
    number = 0
    for letter in letters:
        number = 26 * number + ord(letter) - ord("A") + 1
    return number - 1


def _cell(cell: ElementTree.Element, texts: list[str]) -> str:
    kind = cell.get("t")
    if kind == "inlineStr":
        inline = cell.find(f"{_MAIN}is")
        return "" if inline is None else _text(inline)
    value = cell.findtext(f"{_MAIN}v") or ""
    if kind == "s" and value:
        return texts[int(value)]
    if kind in {None, "n"} and value:
        return f"{float(value):.15g}"
    return "" if kind == "e" else value
