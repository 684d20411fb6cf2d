"""Observations kept in a spreadsheet: its headers are the keys of an observation.

Headers may have their units in brackets too, and loads other units than N. It can be changed row by row;
other rows stay as they were written.
"""

import re
from collections import deque
from collections.abc import Iterator, Mapping
from sys import intern
from typing import Any, Final

from fingerpad._columns import header_parts
from fingerpad._csv import csv_cell, csv_text, unescape_formula
from fingerpad._tables import parse_table, with_point
from fingerpad.exceptions import ManifestError
from fingerpad.study.manifest.models import Fault, Observation
from fingerpad.units import FACTORS

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

_KEYS: Final = frozenset(Observation.model_fields).union(*_TABLE_COLUMNS.values())
# Keys whose cells repeat, so that they are kept once.
_REPEATED: Final = frozenset(("finger", "session", "scale", "background"))
# Keys of one number; a comma in a point separates its coordinates.
_QUANTITY: Final = re.compile(r".*_(N|deg|mm|std)|ppi|mm_per_px")


class Sheet:
    """The rows of ``observations_csv``."""

    def __init__(self, name: str, content: bytes) -> None:
        """Read the rows of a CSV file of this name."""
        table = parse_table(content, name, ManifestError)
        if not table.separator:
            raise ManifestError(f"{name}: is no CSV, the rows of which can be edited: save it as CSV")
        self.name, self._separator, self._titles = table.name, table.separator, table.header
        columns = [_key_and_factor(title) for title in table.header]
        header, self._factors = [key for key, _ in columns], dict(columns)
        missing = {"name", "finger", "wedge_angle_deg", "load_N"} - set(header)
        if missing:
            raise ManifestError(
                f"{name}: no column {', '.join(sorted(missing))} in the first line; found "
                f"{', '.join(header) or 'none'}: rename the columns, and convert other units"
            )
        repeated = sorted({key for key in header if key and header.count(key) > 1})
        if repeated:
            raise ManifestError(f"{name}: column {repeated[0]} is there {header.count(repeated[0])} times")
        if not table.rows:
            raise ManifestError(f"{name}: holds no rows below its first line")
        self._header, self._rows = header, table.rows
        self._decimal_commas = table.has_decimal_commas(
            cell.strip()
            for _, cells in self._rows
            for key, cell in zip(header, cells, strict=False)
            if _QUANTITY.fullmatch(key)
        )

    def text(self) -> str:
        """Return it as a CSV text."""
        return csv_text([self._titles, *(cells for _, cells in self._rows)], self._separator)

    def tables(self) -> Iterator[tuple[int, dict[str, Any], tuple[Fault, ...]]]:
        """Yield line, table and faults of each row, and forget it: cells take as much as their study."""
        rows, self._rows = deque(self._rows), []
        while rows:
            line, cells = rows.popleft()
            if any(cell.strip() for cell in cells):
                yield line, *self._table(cells)

    def _table(self, cells: list[str]) -> tuple[dict[str, Any], tuple[Fault, ...]]:
        faults = []
        if any(cell.strip() for cell in cells[len(self._header) :]):
            faults.append(Fault("", "more cells than the header has columns"))
        content: dict[str, Any] = {
            key: self._value(key, cell)
            for key, cell in zip(self._header, map(str.strip, cells), strict=False)
            if cell
        }
        for table, columns in _TABLE_COLUMNS.items():
            found = [column for column in columns if column in content]
            if found and table in content:
                faults.append(Fault("", f"give either {table} or {found[0]}, one of the two"))
            elif found:
                content[table] = {columns[column]: content.pop(column) for column in found}
        return content, tuple(faults)

    def _value(self, key: str, cell: str) -> str:
        """Return a cell as it is kept: what repeats once, and never as it was read.

        Of cells that were read one after another all must be forgotten before their memory is free.
        """
        if key in _REPEATED:
            return intern(cell)
        copy = cell.encode(errors="surrogatepass").decode(errors="surrogatepass")
        value = with_point(copy) if self._decimal_commas and _QUANTITY.fullmatch(key) else copy
        return _times(value, self._factors[key])

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
            self._titles.append(key)
        place = self._header.index(key)
        row.extend([""] * (place + 1 - len(row)))
        try:
            cell = unescape_formula(csv_cell(value))
        except TypeError as error:
            raise ManifestError(f"{key}: {error}; move the row to the manifest") from error
        cell = _times(cell, 1 / self._factors.get(key, 1.0))
        commas = self._decimal_commas and _QUANTITY.fullmatch(key)
        row[place] = cell.replace(".", ",") if commas else cell


def _key_and_factor(title: str) -> tuple[str, float]:
    """Return the key of a header, as load_N of "Load (mN)", or the header, and the factor on its cells.

    Units are those of loads and lengths that `FACTORS` knows.
    """
    word, unit, _ = header_parts(title)
    if word == "load" and unit in FACTORS["force"]:
        return "load_N", FACTORS["force"][unit]
    if unit in FACTORS["displacement"]:
        key, factor = f"{word.replace(' ', '_')}_mm", FACTORS["displacement"][unit]
        return (key, factor) if key in _KEYS else (title, 1.0)
    key = "_".join(filter(None, (word.replace(" ", "_"), unit)))
    return (key if key in _KEYS else title), 1.0


def _times(cell: str, factor: float) -> str:
    """Return a number times a factor; what is no number as it is."""
    if factor == 1:
        return cell
    try:
        return f"{float(cell) * factor:.12g}"
    except ValueError:
        return cell
