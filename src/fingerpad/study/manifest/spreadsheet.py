"""Observations kept in a spreadsheet: its headers are the keys of an observation."""

import csv
import io
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

from fingerpad._csv import unescape_formula
from fingerpad.exceptions import ManifestError
from fingerpad.study.manifest.contacts import Observation
from fingerpad.study.manifest.validation import validated

# A cell holds no table: these columns make the tables of an observation.
TABLE_COLUMNS: Final = {
    "ellipse_mm": {
        "semi_major_mm": "semi_major",
        "semi_minor_mm": "semi_minor",
        "ellipse_mm_std": "std",
        "long_axis": "long_axis",
    },
    "scale": {"ppi": "ppi", "mm_per_px": "mm_per_px", "scale_relative_std": "relative_std"},
}


def read_rows(path: Path, on_read: Callable[[bytes], None] = lambda _: None) -> list[Observation]:
    """Read observations from a CSV file.

    Parameters
    ----------
    path : Path
        The file.
    on_read : callable
        Called with its content.

    Raises
    ------
    ManifestError
        Naming the file and line, what was found and what was expected.
    """
    try:
        content = path.read_bytes()
        on_read(content)
        reader = csv.reader(io.StringIO(content.decode("utf-8-sig"), newline=""))
        lines = [(reader.line_num, cells) for cells in reader if any(cell.strip() for cell in cells)]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise ManifestError(f"{path.name}: cannot be read as CSV ({error})") from error
    header = [cell.strip() for cell in lines[0][1]] if lines else []
    missing = {"name", "finger", "wedge_angle_deg", "load_N"} - set(header)
    if missing:
        hint = (
            "; its cells are separated by semicolons, save it with commas" if ";" in "".join(header) else ""
        )
        raise ManifestError(f"{path.name}: no column {', '.join(sorted(missing))} in the first line{hint}")
    repeated = sorted({title for title in header if title and header.count(title) > 1})
    if repeated:
        raise ManifestError(f"{path.name}: column {repeated[0]} is there {header.count(repeated[0])} times")
    if len(lines) == 1:
        raise ManifestError(f"{path.name}: holds no rows below its first line")
    return [_row(header, cells, f"{path.name}, line {line}") for line, cells in lines[1:]]


def _row(header: list[str], cells: list[str], where: str) -> Observation:
    if any(cell.strip() for cell in cells[len(header) :]):
        raise ManifestError(f"{where}: more cells than the header has columns")
    content: dict[str, Any] = {
        key: unescape_formula(cell.strip()) for key, cell in zip(header, cells, strict=False) if cell.strip()
    }
    for table, columns in TABLE_COLUMNS.items():
        found = [column for column in columns if column in content]
        if found and table in content:
            raise ManifestError(f"{where}: give either {table} or {found[0]}, one of the two")
        if found:
            content[table] = {columns[column]: content.pop(column) for column in found}
    return validated(Observation, content, where, strict=False)
