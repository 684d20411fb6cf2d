"""A spreadsheet of observations, changed row by row; what is not changed stays as it was written."""

import csv
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Self

from fingerpad._csv import csv_cell, csv_text, unescape_formula
from fingerpad.exceptions import ManifestError
from fingerpad.study.manifest.spreadsheet import TABLE_COLUMNS


class Sheet:
    """The rows of ``observations_csv``."""

    def __init__(self, header: list[str], rows: list[list[str]]) -> None:
        self._header = header
        self._rows = rows

    @classmethod
    def read(cls, path: Path) -> Self:
        """Read a CSV file.

        Raises
        ------
        ManifestError
            If it cannot be read.
        """
        try:
            with path.open(newline="", encoding="utf-8-sig") as file:
                lines = [[unescape_formula(cell) for cell in line] for line in csv.reader(file)]
        except (OSError, UnicodeDecodeError, csv.Error) as error:
            raise ManifestError(f"{path.name}: cannot be read as CSV ({error})") from error
        header = [cell.strip() for cell in lines[0]] if lines else []
        if "name" not in header:
            raise ManifestError(f"{path.name}: no column name in the first line")
        return cls(header, lines[1:])

    def text(self) -> str:
        """Return it as a CSV text."""
        return csv_text([self._header, *self._rows])

    def __contains__(self, name: str) -> bool:
        """Tell whether an observation of this name is in it."""
        return self._row(name) is not None

    def change(self, name: str, values: Mapping[str, Any] | None) -> None:
        """Set cells of an observation's row, or remove the row with None; None as a value empties a cell."""
        row = self._row(name)
        if row is None:
            raise ManifestError(f"observation {name}: no row of this name")
        if values is None:
            self._rows.remove(row)
            return
        for key, value in values.items():
            if key not in TABLE_COLUMNS:
                self._set(row, key, value)
                continue
            # The table's columns and the column of its name say the same thing: one of them stays.
            table = value if isinstance(value, Mapping) else {}
            for column, inner in TABLE_COLUMNS[key].items():
                self._set(row, column, table.get(inner))
            if unknown := sorted(table.keys() - TABLE_COLUMNS[key].values()):
                raise ManifestError(
                    f"observation {name}: a spreadsheet has no column for {key}.{unknown[0]}; "
                    "name a scale of [scales], or move the row to the manifest"
                )
            self._set(row, key, None if isinstance(value, Mapping) else value)

    def rename(self, key: str, old: str, new: str) -> None:
        """Replace a name in one column."""
        for row in self._rows:
            if self._cell(row, key) == old:
                self._set(row, key, new)

    def _row(self, name: str) -> list[str] | None:
        return next((row for row in self._rows if self._cell(row, "name") == name), None)

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
