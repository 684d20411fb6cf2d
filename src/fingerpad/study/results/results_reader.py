"""The tables of a finished run, read back from results.csv."""

import csv
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from itertools import islice
from pathlib import Path
from typing import Any, Final, TextIO

import numpy as np

from fingerpad._csv import unescape_formula
from fingerpad.exceptions import FingerpadError
from fingerpad.study.results.columns import COLUMNS, Column, ColumnArray, DType
from fingerpad.study.results.result_set import RERUN
from fingerpad.study.results.summary_file import no_finished_run
from fingerpad.study.results.table import ResultsTable, TableBuilder

# The cells of so many rows take some megabytes.
_ROWS_AT_ONCE: Final = 1000
_CONVERT: Final[Mapping[DType, Callable[[str], Any]]] = {
    "text": unescape_formula,
    "bool": {"true": True, "false": False}.__getitem__,
    "int": int,
    "float": float,
}


def read_table(folder: Path) -> ResultsTable:
    """Return all rows of a finished run.

    Raises
    ------
    FingerpadError
        As `read_batches` does.
    """
    builder = TableBuilder()
    for batch in read_batches(folder, _ROWS_AT_ONCE):
        builder.add(batch)
    return builder.table()


def read_batches(folder: Path, size: int) -> Iterator[dict[str, ColumnArray]]:
    """Yield the rows of a finished run by column, `size` at a time, so that memory stays flat.

    Raises
    ------
    FingerpadError
        If there is no ``results.csv``, its columns are others, a row has a cell too few or too many, as a
        file cut short has, or a cell holds something else than its column does.
    """
    path = folder / "results.csv"
    with _opened(path) as file:
        reader = csv.reader(file)
        if next(reader, []) != list(COLUMNS):
            raise FingerpadError(f"{path}: its columns are not those of this version; {RERUN}")
        while rows := list(islice(reader, size)):
            where = f"{path}, before line {reader.line_num}"
            if any(len(row) != len(COLUMNS) for row in rows):
                raise FingerpadError(f"{where}: a row has more or fewer cells than the header; {RERUN}")
            cells = zip(COLUMNS.values(), zip(*rows, strict=True), strict=True)
            yield {column.name: _array(column, some, where) for column, some in cells}


def _array(column: Column, cells: tuple[str, ...], where: str) -> ColumnArray:
    """Return the cells of a column as an array."""
    convert = _CONVERT[column.dtype]
    try:
        array = column.array(convert(cell) if cell or column.dtype == "bool" else None for cell in cells)
    except (ValueError, KeyError, OverflowError) as error:
        raise FingerpadError(
            f"{where}: {column.name} holds what is no {column.dtype} ({error}); {RERUN}"
        ) from error
    if column.dtype == "float" and np.isinf(array).any():
        raise FingerpadError(f"{where}: {column.name} holds an infinite number; {RERUN}")
    return array


@contextmanager
def _opened(path: Path) -> Iterator[TextIO]:
    """Open a file of a run's output."""
    try:
        with path.open(newline="", encoding="utf-8") as file:
            yield file
    except FileNotFoundError:
        raise no_finished_run(path) from None
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise FingerpadError(f"{path}: cannot be read ({error})") from error
