"""Loading curves as tables of force, displacement and contact area."""

import csv
import math
from collections.abc import Mapping
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
class LoadingCurve:
    """One record of a finger pad pressed against a platen, row by row.

    Attributes
    ----------
    load : ndarray
        Normal force W, N.
    indentation : ndarray
        Displacement of the platen ξ, mm, from whatever zero the instrument had.
    area : ndarray or None
        Contact area A, mm², where it was measured.
    """

    load: FloatArray
    indentation: FloatArray
    area: FloatArray | None


def read_loading_curve(path: Path, columns: Mapping[str, str] | None = None) -> LoadingCurve:
    """Read a loading curve from a CSV file.

    The header names a quantity and its unit, as in ``force_N, displacement_mm, area_mm2``; ``force_mN`` or
    ``displacement_um`` are converted. Columns of other names are left alone.

    Parameters
    ----------
    path : Path
        The CSV file, with a header line.
    columns : mapping, optional
        From a quantity (``force``, ``displacement``, ``area``) to ``"HEADER:UNIT"`` where the file's own
        headers differ.

    Raises
    ------
    LoadingError
        If the file cannot be read, a column is missing or has an unknown unit, or a cell is not a finite
        number. The message names file, column and line.
    """
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            reader = csv.reader(file)
            rows = [(reader.line_num, row) for row in reader if any(cell.strip() for cell in row)]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise LoadingError(f"{path}: cannot be read as CSV ({error})") from error
    if len(rows) < 2:
        raise LoadingError(f"{path}: holds no data; a header line and rows of numbers are expected")
    header = [cell.strip() for cell in rows[0][1]]
    found = {name: _find_column(path, header, name, (columns or {}).get(name)) for name in FACTORS}

    def column(name: str) -> FloatArray:
        place = found[name]
        if place is None:
            raise LoadingError(
                f"{path}: no column {name}_{next(iter(FACTORS[name]))}; found {', '.join(header)}. "
                f'Rename it or say which one it is, as in {name} = "HEADER:UNIT"'
            )
        cells = [_number(path, line, place, row) for line, row in rows[1:]]
        return place.factor * np.array(cells)

    return LoadingCurve(
        load=column("force"),
        indentation=column("displacement"),
        area=column("area") if found["area"] else None,
    )


def _find_column(path: Path, header: list[str], name: str, given: str | None) -> _Column | None:
    """Return the column that holds quantity `name`, or None where there is none."""
    if given is not None:
        title, _, unit = given.rpartition(":")
        if title not in header:
            raise LoadingError(f"{path}: no column {title!r} for {name}; found {', '.join(header)}")
        return _Column(header.index(title), title, _factor(path, name, title, unit))
    for index, title in enumerate(header):
        stem, _, unit = title.rpartition("_")
        if stem.lower() == name:
            return _Column(index, title, _factor(path, name, title, unit))
    return None


def _factor(path: Path, name: str, title: str, unit: str) -> float:
    if unit not in FACTORS[name]:
        known = ", ".join(FACTORS[name])
        raise LoadingError(f"{path}: column {title!r} has unit {unit!r}; {name} is read in {known}")
    return FACTORS[name][unit]


def _number(path: Path, line: int, column: _Column, row: list[str]) -> float:
    cell = row[column.place].strip() if column.place < len(row) else ""
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise LoadingError(f"{path}: line {line}, column {column.header!r}: {cell!r} is not a finite number")
    return value
