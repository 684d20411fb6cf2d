"""The table of a finished run, read back from results.csv with types, units and meanings."""

import csv
import json
import math
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import islice
from os import PathLike
from pathlib import Path
from typing import Any, Final, Self, TextIO

import numpy as np
import numpy.typing as npt

from fingerpad._csv import unescape_formula
from fingerpad.exceptions import FingerpadError
from fingerpad.study.results.columns import BOOL_COLUMNS, TEXT_COLUMNS
from fingerpad.study.results.result_set import require_result_set

_STD: Final = re.compile(r"(_fixed_geometry)?_std$")
_UNITS: Final = {
    "mm_per_px": "mm/px", "mm2": "mm2", "mm": "mm", "N": "N", "s": "s", "deg": "deg", "kpa": "kPa",
    "px": "px",
}  # fmt: skip
_ROWS_AT_ONCE: Final = 5000
_RERUN: Final = "run the study again: nothing that was measured is measured again"


@dataclass(frozen=True, slots=True, kw_only=True)
class Column:
    """A column of the table.

    Attributes
    ----------
    name : str
        As in ``results.csv``.
    meaning : str
        What it holds, in words.
    """

    name: str
    meaning: str

    @property
    def unit(self) -> str:
        """Its unit: empty for words and truths, ``1`` for pure numbers and counts.

        Examples
        --------
        >>> Column(name="youngs_modulus_kpa_std", meaning="").unit
        'kPa'
        """
        if self.name in TEXT_COLUMNS | BOOL_COLUMNS:
            return ""
        name = _STD.sub("", self.name)
        return next((unit for end, unit in _UNITS.items() if name == end or name.endswith(f"_{end}")), "1")

    @property
    def description(self) -> str:
        """Its meaning, which names the column that a standard uncertainty belongs to."""
        own = self.meaning == "its standard uncertainty"
        return f"standard uncertainty of {_STD.sub('', self.name)}" if own else self.meaning


@dataclass(frozen=True, slots=True, kw_only=True)
class ResultsTable:
    """The results of a finished run, read in batches of rows so that memory stays flat.

    Attributes
    ----------
    folder : Path
        The output folder.
    columns : tuple of Column
        In the order of ``results.csv``.
    title : str
        The study's title.
    version : str
        The fingerpad that made it.
    """

    folder: Path
    columns: tuple[Column, ...]
    title: str
    version: str

    @classmethod
    def of(cls, folder: str | PathLike[str]) -> Self:
        """Open the output folder of a finished run.

        Raises
        ------
        FingerpadError
            If the folder holds no finished run, or its files do not belong together.
        """
        folder = Path(folder)
        require_result_set(folder)
        meanings = dict(_pairs(folder / "results_columns.csv"))
        with _opened(folder / "results.csv") as file:
            header = next(csv.reader(file), [])
        if not header or set(header) - set(meanings) or len(set(header)) < len(header):
            raise FingerpadError(
                f"{folder / 'results.csv'}: its columns are not those of results_columns.csv; {_RERUN}"
            )
        summary = read_summary(folder)
        return cls(
            folder=folder,
            columns=tuple(Column(name=name, meaning=meanings[name]) for name in header),
            title=str(summary["title"]),
            version=str(summary["provenance"]["fingerpad"]),
        )

    def batches(self) -> Iterator[dict[str, npt.NDArray[Any]]]:
        """Yield the rows in batches: each column as an array.

        Text is an object array with None for empty cells; a truth is bool; all else is float, NaN for empty
        cells. There is one batch at least, so that a table without rows keeps its columns.

        Raises
        ------
        FingerpadError
            If a row has a cell too few or too many, as a file cut short has, or a cell of the wrong kind.
        """
        path = self.folder / "results.csv"
        with _opened(path) as file:
            reader = csv.reader(file)
            next(reader)
            rows = list(islice(reader, _ROWS_AT_ONCE))
            while True:
                yield self._arrays(rows, path, reader.line_num)
                rows = list(islice(reader, _ROWS_AT_ONCE))
                if not rows:
                    return

    def _arrays(self, rows: Sequence[Sequence[str]], path: Path, line: int) -> dict[str, npt.NDArray[Any]]:
        if any(len(row) != len(self.columns) for row in rows):
            raise FingerpadError(
                f"{path}, before line {line}: a row has more or fewer cells than the header; {_RERUN}"
            )
        cells = zip(*rows, strict=True) if rows else ([] for _ in self.columns)
        try:
            return {
                column.name: _typed(column.name, list(some))
                for column, some in zip(self.columns, cells, strict=True)
            }
        except (ValueError, KeyError) as error:
            raise FingerpadError(
                f"{path}, before line {line}: a cell that is no number or no truth ({error}); {_RERUN}"
            ) from error


def read_summary(folder: Path) -> dict[str, Any]:
    """Return the content of a finished run's ``summary.json``.

    Raises
    ------
    FingerpadError
        If there is none, or it is none.
    """
    path = folder / "summary.json"
    try:
        with _opened(path) as file:
            summary = json.load(file)
    except (ValueError, RecursionError) as error:
        raise FingerpadError(f"{path}: cannot be read as JSON ({error}); {_RERUN}") from error
    if not isinstance(summary, dict) or not {"title", "fingers", "summaries", "provenance"} <= summary.keys():
        raise FingerpadError(f"{path}: is no summary of a study that was run; {_RERUN}")
    return summary


def _typed(name: str, cells: list[str]) -> npt.NDArray[Any]:
    if name in TEXT_COLUMNS:
        return np.array([unescape_formula(cell) or None for cell in cells], dtype=object)
    if name in BOOL_COLUMNS:
        return np.array([{"true": True, "false": False}[cell] for cell in cells], dtype=bool)
    return np.array([float(cell) if cell else math.nan for cell in cells], dtype=np.float64)


def _pairs(path: Path) -> Iterator[tuple[str, str]]:
    with _opened(path) as file:
        rows = csv.reader(file)
        next(rows, None)
        yield from ((row[0], row[1]) for row in rows if len(row) > 1)


@contextmanager
def _opened(path: Path) -> Iterator[TextIO]:
    """Open a file of a run's output."""
    try:
        with path.open(newline="", encoding="utf-8") as file:
            yield file
    except FileNotFoundError:
        raise FingerpadError(
            f"{path.parent}: no {path.name} there, so no finished run; "
            "`fingerpad run STUDY --out FOLDER` makes one"
        ) from None
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise FingerpadError(f"{path}: cannot be read ({error})") from error
