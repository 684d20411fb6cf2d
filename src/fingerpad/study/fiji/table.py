"""Fiji's Results table: as CSV, as tab separated text, or saved again by a spreadsheet."""

import csv
import io
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Final

from fingerpad.exceptions import ManifestError
from fingerpad.study.fiji.ellipse import MeasuredEllipse, upward_deg

_BINARY: Final = {b"PK\x03\x04": "an Excel workbook or a zip", b"\xd0\xcf\x11\xe0": "an old Excel workbook"}
_SUMMARY: Final = ["Mean", "SD", "Min", "Max"]  # rows that Fiji's Summarize appends
# Area over that of the ellipse: they differ where holes or a threshold count.
_SAME_AREA: Final = 0.05


def read_results_table(path: Path) -> list[MeasuredEllipse]:
    """Read the fitted ellipses of a Results table, in its own unit.

    Cells may be separated by commas, tabs or semicolons, the latter two with decimal commas. Rows that Fiji's
    *Summarize* appends are left out.

    Parameters
    ----------
    path : Path
        ``Results.csv``, or ``.txt``, ``.tsv``, ``.xls`` as Fiji writes them: text.

    Raises
    ------
    ManifestError
        Naming file and line, what was found, and what to do in Fiji.
    """
    lines = _lines(path)
    header = [cell.strip() for cell in lines[0][1]]
    missing = [name for name in ("Major", "Minor") if name not in header]
    if missing:
        raise ManifestError(
            f"{path}: no column {' and '.join(missing)}; found {', '.join(filter(None, header)) or 'none'}. "
            "In Fiji choose Analyze > Set Measurements > Fit ellipse, and measure again"
        )
    rows = [
        (f"{path.name}, line {line}", dict(zip(header, map(str.strip, cells), strict=False)))
        for line, cells in lines[1:]
    ]
    if [row.get("Label") for _, row in rows[-4:]] == _SUMMARY:
        rows = rows[:-4]
    if not rows:
        raise ManifestError(f"{path}: holds no rows below its first line; measure something first")
    return [_ellipse(row, place, number) for number, (place, row) in enumerate(rows, start=1)]


def _lines(path: Path) -> list[tuple[int, list[str]]]:
    """Return the rows of cells with their line numbers, by the separator that parts the header best."""
    if path.is_char_device():
        raise ManifestError(f"{path}: is a device, not a file")  # which may have no end
    try:
        content = path.read_bytes()
    except OSError as error:
        raise ManifestError(f"{path}: cannot be read ({error.strerror})") from error
    kind = _BINARY.get(content[:4], "a binary file" if b"\0" in content[:4096] else None)
    if kind:
        raise ManifestError(f"{path}: is {kind}, no text; save the table as CSV")
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("cp1252", errors="replace")  # as spreadsheets on Windows save
    first = text.split("\n", 1)[0]
    separator = max("\t;,", key=first.count)
    try:
        reader = csv.reader(io.StringIO(text), delimiter=separator)
        lines = [(reader.line_num, cells) for cells in reader if any(cell.strip() for cell in cells)]
    except csv.Error as error:
        raise ManifestError(f"{path}: cannot be read as a table ({error})") from error
    if not lines:
        raise ManifestError(f"{path}: is empty")
    for line, cells in lines:
        if any(cell.strip() for cell in cells[len(lines[0][1]) :]):
            hint = "; decimal commas need tabs or semicolons between cells" if separator == "," else ""
            raise ManifestError(f"{path.name}, line {line}: more cells than the header has columns{hint}")
    return lines


def _ellipse(row: Mapping[str, str], place: str, number: int) -> MeasuredEllipse:
    major, minor = _number(row, "Major", place), _number(row, "Minor", place)
    if not major >= minor > 0:
        raise ManifestError(
            f"{place}: Major {major:g} and Minor {minor:g} are no full axes of an ellipse; "
            "a line or a point has none: remove the row"
        )
    doubts = []
    if row.get("Area"):
        ratio = _number(row, "Area", place) / (math.pi * major * minor / 4)
        if abs(ratio - 4) < 4 * _SAME_AREA:
            raise ManifestError(
                f"{place}: Area is π times Major times Minor, so these are semi-axes; "
                "Fiji writes full axes: double them, or write observations with semi_major_mm yourself"
            )
        if abs(ratio - 1) > _SAME_AREA:
            doubts.append(f"Area is {ratio:.2f} of the ellipse's; were holes or a threshold measured?")
    angle = _number(row, "Angle", place) if row.get("Angle") else None
    return MeasuredEllipse(
        label=row.get("Label") or f"contact_{number}",
        place=place,
        semi_major=major / 2,
        semi_minor=minor / 2,
        orientation_deg=None if angle is None else upward_deg(angle),
        doubts=tuple(doubts),
    )


def _number(row: Mapping[str, str], column: str, place: str) -> float:
    text = row.get(column, "")
    try:
        value = float(text.replace(",", ".") if "." not in text else text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ManifestError(f"{place}: column {column}: expected a number, found {text[:40]!r}")
    return value
