"""Named columns with units of a CSV file."""

import csv
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad.exceptions import LoadingError
from fingerpad.units import FACTORS


class _Column(NamedTuple):
    place: int
    header: str
    factor: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Table:
    path: Path
    header: list[str]
    rows: list[tuple[int, list[str]]]


def read_columns(
    path: Path,
    required: Sequence[str],
    optional: Sequence[str] = (),
    *,
    columns: Mapping[str, str] | None = None,
) -> dict[str, FloatArray]:
    """Read quantities from a CSV file whose header names each with its unit, as in ``force_N, time_s``.

    Parameters
    ----------
    path : Path
        The CSV file, with a header line. Columns of other names are left alone.
    required, optional : sequence of str
        Quantities of `fingerpad.units.FACTORS`.
    columns : mapping, optional
        From a quantity to ``"HEADER:UNIT"`` where the file's own headers differ.

    Returns
    -------
    dict of str to ndarray
        Each quantity found, in the library's units.

    Raises
    ------
    LoadingError
        If the file cannot be read, a column is missing or has an unknown unit, `columns` names another
        quantity, or a cell is not a finite number. The message names file, column and line.
    """
    table = _read_table(path)
    given = columns or {}
    known = [*required, *optional]
    for name in given:
        if name not in known:
            raise LoadingError(f"{path}: columns name no quantity {name!r}; there are {', '.join(known)}")
    found = {name: _find_column(table, name, given.get(name)) for name in known}
    for name in required:
        if found[name] is None:
            raise LoadingError(
                f"{path}: no column {name}_{next(iter(FACTORS[name]))}; found {', '.join(table.header)}. "
                f'Rename it or say which one it is, as in {name} = "HEADER:UNIT"'
            )
    return {
        name: column.factor * np.array([_number(table, line, column, row) for line, row in table.rows])
        for name, column in found.items()
        if column is not None
    }


def _read_table(path: Path) -> _Table:
    if path.is_char_device():
        raise LoadingError(f"{path}: is a device, not a file")  # which may have no end
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            reader = csv.reader(file)
            rows = [(reader.line_num, row) for row in reader if any(cell.strip() for cell in row)]
    except FileNotFoundError:
        raise LoadingError(f"{path}: no such file: check the path") from None
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise LoadingError(f"{path}: cannot be read as CSV ({error})") from error
    if len(rows) < 2:
        raise LoadingError(f"{path}: holds no data; a header line and rows of numbers are expected")
    header = [cell.strip() for cell in rows[0][1]]
    if len(header) == 1 and any(mark in header[0] for mark in ";\t"):
        raise LoadingError(f"{path}: columns must be separated by commas, with decimal points")
    for line, row in rows[1:]:
        if any(cell.strip() for cell in row[len(header) :]):
            raise LoadingError(
                f"{path}: line {line} has {len(row)} cells under {len(header)} headers: "
                "decimals are marked by points, not commas"
            )
    return _Table(path=path, header=header, rows=rows[1:])


def _find_column(table: _Table, name: str, given: str | None) -> _Column | None:
    """Return the column that holds quantity `name`, or None where there is none."""
    if given is not None:
        title, _, unit = given.rpartition(":")
        if title not in table.header:
            raise LoadingError(
                f"{table.path}: no column {title!r} for {name}; found {', '.join(table.header)}"
            )
        return _Column(table.header.index(title), title, _factor(table.path, name, title, unit))
    found = [index for index, title in enumerate(table.header) if title.rpartition("_")[0].lower() == name]
    if not found:
        return None
    if len(found) > 1:
        titles = " and ".join(table.header[index] for index in found)
        raise LoadingError(f"{table.path}: two columns of {name}, {titles}: say which, as in {name} = ...")
    title = table.header[found[0]]
    return _Column(found[0], title, _factor(table.path, name, title, title.rpartition("_")[2]))


def _factor(path: Path, name: str, title: str, unit: str) -> float:
    if unit not in FACTORS[name]:
        known = ", ".join(FACTORS[name])
        raise LoadingError(f"{path}: column {title!r} has unit {unit!r}; {name} is read in {known}")
    return FACTORS[name][unit]


def _number(table: _Table, line: int, column: _Column, row: list[str]) -> float:
    cell = row[column.place].strip() if column.place < len(row) else ""
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise LoadingError(
            f"{table.path}: line {line}, column {column.header!r}: {cell!r} is not a finite number"
        )
    return value
