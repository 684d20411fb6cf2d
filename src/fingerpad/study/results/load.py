"""The results of a finished run, read back."""

import csv
import html
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import islice
from os import PathLike
from pathlib import Path
from typing import Any, Final, TextIO

import numpy as np
import pandas as pd

from fingerpad._csv import unescape_formula
from fingerpad.exceptions import FingerpadError
from fingerpad.study.results.answers import answers
from fingerpad.study.results.columns import COLUMNS, DEFAULT_COLUMNS, Column, ColumnArray, DType
from fingerpad.study.results.result_set import RERUN, require_result_set
from fingerpad.study.results.summary_file import SummaryFile, no_finished_run
from fingerpad.study.results.table import table_of

# The cells of so many rows take some megabytes.
_ROWS_AT_ONCE: Final = 1000
_CONVERT: Final[Mapping[DType, Callable[[str], Any]]] = {
    "text": unescape_formula,
    "bool": {"true": True, "false": False}.__getitem__,
    "int": int,
    "float": float,
}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Results:
    """The results of a finished run.

    Attributes
    ----------
    table : DataFrame
        ``results.csv``: one row per contact, and per frame in contact. Units of its columns are in
        ``table.attrs["units"]``. Text has None for empty cells, numbers have NaN, the number of a frame is
        Int64.
    summary : SummaryFile
        ``summary.json``: semi-axes of fingers, pooled radii, verdicts, loading curves and more.
    """

    table: pd.DataFrame
    summary: SummaryFile

    @property
    def title(self) -> str:
        """The study's title."""
        return self.summary.title

    def __repr__(self) -> str:
        rows, columns = self.table.shape
        return f"<Results of {self.title!r}: {rows} rows, {columns} columns>"

    def _repr_html_(self) -> str:
        """Return what was found, for a notebook: the sentences with which the report begins."""
        found = answers(self.summary.summaries, self.summary.by_load)
        lines = "".join(f"<li>{html.escape(one.sentence)}</li>" for one in found)
        return f"<strong>{html.escape(self.title)}</strong><ul>{lines}</ul>{html.escape(repr(self))}"

    @classmethod
    def read(cls, folder: Path) -> "Results":
        """Read the tables of an output folder, whose files are known to belong together.

        Raises
        ------
        FingerpadError
            If there is none, or a table is not as a run writes it.
        """
        return cls(table=read_rows(folder), summary=SummaryFile.read(folder))


def load_results(folder: str | PathLike[str]) -> Results:
    """Read the results of a finished run.

    Parameters
    ----------
    folder : path-like
        Output folder of the run.

    Returns
    -------
    Results
        Its ``table`` is a pandas DataFrame with one row per contact; ``summary`` holds what was pooled. A
        notebook shows one sentence for each finger and wedge.

    Raises
    ------
    FingerpadError
        If the folder holds no finished run, or its files do not belong together.

    Examples
    --------
    >>> load_results("no-such-folder")
    Traceback (most recent call last):
    fingerpad.exceptions.FingerpadError: no-such-folder: no finished run there; `fingerpad run STUDY --out FOLDER` makes one
    """  # noqa: E501 (a message stands on one line)
    require_result_set(Path(folder))
    return Results.read(Path(folder))


def read_rows(folder: Path) -> pd.DataFrame:
    """Return all rows of a finished run, with the columns' units in ``attrs``.

    Raises
    ------
    FingerpadError
        As `read_header` and `read_batches` do.
    """
    names = read_header(folder)
    table = table_of(read_batches(folder, _ROWS_AT_ONCE), names)
    table.attrs["units"] = {name: COLUMNS[name].unit for name in names}
    return table


def read_header(folder: Path) -> tuple[str, ...]:
    """Return the columns of a finished run: all, or those that a run writes by default.

    Raises
    ------
    FingerpadError
        If there is no ``results.csv``, or its columns are others.
    """
    path = folder / "results.csv"
    with _opened(path) as file:
        names = tuple(next(csv.reader(file), ()))
    if names not in {DEFAULT_COLUMNS, tuple(COLUMNS)}:
        raise FingerpadError(f"{path}: its columns are not those of this version; {RERUN}")
    return names


def read_batches(folder: Path, size: int) -> Iterator[dict[str, ColumnArray]]:
    """Yield the rows of a finished run by column, `size` at a time, so that memory stays flat.

    Raises
    ------
    FingerpadError
        As `read_header`, or if a row has a cell too few or too many, as a file cut short has, or a cell
        holds something else than its column does.
    """
    columns, path = [COLUMNS[name] for name in read_header(folder)], folder / "results.csv"
    with _opened(path) as file:
        reader = csv.reader(file)
        next(reader)
        while rows := list(islice(reader, size)):
            where = f"{path}, before line {reader.line_num}"
            if any(len(row) != len(columns) for row in rows):
                raise FingerpadError(f"{where}: a row has more or fewer cells than the header; {RERUN}")
            cells = zip(columns, zip(*rows, strict=True), strict=True)
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
