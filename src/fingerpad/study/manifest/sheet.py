"""Observations kept in a spreadsheet: its headers are the keys of an observation.

It can be changed row by row; what is not changed stays as it was written.
"""

import csv
import io
from collections.abc import Iterator, Mapping
from typing import Any, Final, Self

from fingerpad._csv import csv_cell, csv_text, unescape_formula
from fingerpad.exceptions import ManifestError
from fingerpad.study.manifest.messages import Fault

# A cell holds no table: these columns make the tables of an observation.
_TABLE_COLUMNS: Final = {
    "ellipse_mm": {
        "semi_major_mm": "semi_major",
        "semi_minor_mm": "semi_minor",
        "ellipse_mm_std": "std",
        "long_axis": "long_axis",
    },
    "scale": {"ppi": "ppi", "mm_per_px": "mm_per_px", "scale_relative_std": "relative_std"},
}


class Sheet:
    """The rows of ``observations_csv``."""

    def __init__(self, name: str, header: list[str], rows: list[tuple[int, list[str]]]) -> None:
        self.name = name
        self._header = header
        self._rows = rows

    @classmethod
    def parse(cls, name: str, content: bytes) -> Self:
        """Return the rows of a CSV file of this name.

        Raises
        ------
        ManifestError
            If it is no table of observations.
        """
        try:
            reader = csv.reader(io.StringIO(content.decode("utf-8-sig"), newline=""))
            rows = [(reader.line_num, [unescape_formula(cell) for cell in cells]) for cells in reader]
        except (UnicodeDecodeError, csv.Error) as error:
            raise ManifestError(f"{name}: cannot be read as CSV ({error})") from error
        while rows and not any(cell.strip() for cell in rows[0][1]):
            del rows[0]
        header = [cell.strip() for cell in rows[0][1]] if rows else []
        missing = {"name", "finger", "wedge_angle_deg", "load_N"} - set(header)
        if missing:
            hint = "; its cells are separated by semicolons, save it with commas"
            hint = hint if ";" in "".join(header) else ""
            raise ManifestError(f"{name}: no column {', '.join(sorted(missing))} in the first line{hint}")
        repeated = sorted({title for title in header if title and header.count(title) > 1})
        if repeated:
            raise ManifestError(f"{name}: column {repeated[0]} is there {header.count(repeated[0])} times")
        if not any(cell.strip() for _, cells in rows[1:] for cell in cells):
            raise ManifestError(f"{name}: holds no rows below its first line")
        return cls(name, header, rows[1:])

    def text(self) -> str:
        """Return it as a CSV text."""
        return csv_text([self._header, *(cells for _, cells in self._rows)])

    def tables(self) -> Iterator[tuple[int, dict[str, Any], tuple[Fault, ...]]]:
        """Yield the line of each row, its cells as the table of an observation, and what is wrong with it."""
        for line, cells in self._rows:
            if any(cell.strip() for cell in cells):
                yield line, *self._table(cells)

    def _table(self, cells: list[str]) -> tuple[dict[str, Any], tuple[Fault, ...]]:
        faults = []
        if any(cell.strip() for cell in cells[len(self._header) :]):
            faults.append(Fault("", "more cells than the header has columns"))
        content: dict[str, Any] = {
            key: cell.strip() for key, cell in zip(self._header, cells, strict=False) if cell.strip()
        }
        for table, columns in _TABLE_COLUMNS.items():
            found = [column for column in columns if column in content]
            if found and table in content:
                faults.append(Fault("", f"give either {table} or {found[0]}, one of the two"))
            elif found:
                content[table] = {columns[column]: content.pop(column) for column in found}
        return content, tuple(faults)

    def __contains__(self, name: str) -> bool:
        """Tell whether an observation of this name is in it."""
        return self._row(name) is not None

    def change(self, name: str, values: Mapping[str, Any] | None) -> None:
        """Set cells of an observation's row, or remove the row with None; None as a value empties a cell."""
        row = self._row(name)
        if row is None:
            raise ManifestError(f"observation {name}: no row of this name")
        if values is None:
            self._rows = [(line, cells) for line, cells in self._rows if cells is not row]
            return
        for key, value in values.items():
            if key not in _TABLE_COLUMNS:
                self._set(row, key, value)
                continue
            # The table's columns and the column of its name say the same thing: one of them stays.
            table = value if isinstance(value, Mapping) else {}
            for column, inner in _TABLE_COLUMNS[key].items():
                self._set(row, column, table.get(inner))
            if unknown := sorted(table.keys() - _TABLE_COLUMNS[key].values()):
                raise ManifestError(
                    f"observation {name}: a spreadsheet has no column for {key}.{unknown[0]}; "
                    "name a scale of [scales], or move the row to the manifest"
                )
            self._set(row, key, None if isinstance(value, Mapping) else value)

    def rename(self, key: str, old: str, new: str) -> None:
        """Replace a name in one column."""
        for _, row in self._rows:
            if self._cell(row, key) == old:
                self._set(row, key, new)

    def _row(self, name: str) -> list[str] | None:
        return next((row for _, row in self._rows if self._cell(row, "name") == name), None)

    def _cell(self, row: list[str], key: str) -> str:
        place = self._header.index(key) if key in self._header else len(row)
        return row[place].strip() if place < len(row) else ""

    def _set(self, row: list[str], key: str, value: Any) -> None:
        if key not in self._header:
            if value is None:
                return
            self._header.append(key)
        place = self._header.index(key)
        row.extend([""] * (place + 1 - len(row)))
        try:
            row[place] = unescape_formula(csv_cell(value))
        except TypeError as error:
            raise ManifestError(f"{key}: {error}; move the row to the manifest") from error
