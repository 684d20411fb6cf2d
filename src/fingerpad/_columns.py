"""Named columns with units of a CSV file."""

import csv
import difflib
import json
import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad.exceptions import LoadingError
from fingerpad.units import FACTORS

# How instruments call a quantity, in order of preference; its own name first.
_NAMES: Final[Mapping[str, tuple[str, ...]]] = {
    "force": ("force", "load", "normal force"),
    "displacement": ("displacement", "disp", "displ", "indentation"),
    "area": ("area", "contact area"),
    "time": ("time", "t"),
    "trigger": ("trigger",),
}
# Force (N), force [N]; force_N; Force / N, force N.
_IN_BRACKETS, _AFTER_LOW_LINE, _AFTER_SPACE = map(
    re.compile, (r"(.+?)[ _]*[(\[](.+?)[)\]]", r"(.+)_([^_]+)", r"(.+?)(?: */ *| +)(\S+)")
)
_UNIT_SPELLINGS: Final = {"μ": "µ", "²": "2", "^2": "2", "msec": "ms", "sec": "s"}


class ColumnsError(LoadingError):
    """A table without columns that it needs.

    Attributes
    ----------
    problem : str
        The message without the way out.
    proposed : mapping
        From each quantity to ``"HEADER:UNIT"``, as far as a header tells.
    """

    def __init__(self, problem: str, proposed: Mapping[str, str] | None = None) -> None:
        self.problem, self.proposed = problem, dict(proposed or {})
        super().__init__(problem)

    def __str__(self) -> str:
        return self.with_way_out(f"columns={_mapping_text(self.proposed, ': ', quoted=True)}")

    def with_way_out(self, words: str) -> str:
        """Return the message with what to write, the units explained that are still to be filled in."""
        units = (
            f"; UNIT of {name}: {', '.join(FACTORS[name])}"
            for name, column in self.proposed.items()
            if column.endswith(":UNIT")
        )
        if not words:
            return f"{self.problem}. Rename it in the header"
        return f"{self.problem}. Rename it, or say which one it is: {words}{''.join(units)}"


@contextmanager
def columns_named_by(words: Callable[[Mapping[str, str]], str]) -> Iterator[None]:
    """Say how columns are named where the tables are read for a command or a manifest."""
    try:
        yield
    except ColumnsError as error:
        raise LoadingError(error.with_way_out(words(error.proposed))) from None


def columns_in_toml(key: str, columns: Mapping[str, str]) -> str:
    """Return the line of a manifest that maps columns.

    Examples
    --------
    >>> columns_in_toml("file_columns", {"force": "Fz (mN):mN"})
    'file_columns = { force = "Fz (mN):mN" }'
    """
    return f"{key} = {_mapping_text(columns, ' = ', quoted=False)}"


def _mapping_text(columns: Mapping[str, str], equals: str, *, quoted: bool) -> str:
    names = {name: f'"{name}"' if quoted else name for name in columns}
    items = ", ".join(
        f"{names[name]}{equals}{json.dumps(column, ensure_ascii=False)}" for name, column in columns.items()
    )
    return f"{{{items}}}" if quoted else f"{{ {items} }}"


class _Column(NamedTuple):
    place: int
    header: str
    factor: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Table:
    path: Path
    separator: str
    header: list[str]
    rows: list[tuple[int, list[str]]]


def read_columns(
    path: Path,
    required: Sequence[str],
    optional: Sequence[str] = (),
    *,
    columns: Mapping[str, str] | None = None,
) -> dict[str, FloatArray]:
    """Read quantities from a CSV file whose header names each with its unit, as in ``force_N, Time (s)``.

    Cells are separated by commas, semicolons or tabs, the latter two with decimal points or commas.

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
    found = _find_columns(table, [*required, *optional], columns or {})
    missing = [name for name in required if name not in found]
    if missing:
        proposed = _proposed(table, missing, found)
        raise ColumnsError(
            f"{path}: no column {' or '.join(f'{name}_{next(iter(FACTORS[name]))}' for name in missing)}; "
            f"found {', '.join(table.header)}",
            {name: proposed.get(name, "HEADER:UNIT") for name in missing},
        )
    return {name: column.factor * _numbers(table, column) for name, column in found.items()}


def unread_columns(
    path: Path, quantities: Sequence[str], columns: Mapping[str, str] | None = None
) -> dict[str, str]:
    """Return columns that `read_columns` leaves alone, and that by name or unit look like what it lacks.

    Parameters
    ----------
    path, columns
        As for `read_columns`.
    quantities : sequence of str
        What may be read of the file.

    Returns
    -------
    dict of str to str
        From each quantity that has no column to ``"HEADER:UNIT"`` of the one that may be it; ``UNIT`` where
        the header has none.

    Raises
    ------
    LoadingError
        If the file cannot be read.
    """
    table = _read_table(path)
    found = _find_columns(table, quantities, columns or {})
    return _proposed(table, [name for name in quantities if name not in found], found)


def _read_table(path: Path) -> _Table:
    if path.is_char_device():
        raise LoadingError(f"{path}: is a device, not a file")  # which may have no end
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            first = next((line for line in file if line.strip()), "")
            separator = max(",;\t", key=first.count)
            file.seek(0)
            reader = csv.reader(file, delimiter=separator)
            rows = [(reader.line_num, row) for row in reader if any(cell.strip() for cell in row)]
    except FileNotFoundError:
        raise LoadingError(f"{path}: no such file: check the path") from None
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise LoadingError(f"{path}: cannot be read as CSV ({error})") from error
    if len(rows) < 2:
        raise LoadingError(f"{path}: holds no data; a header line and rows of numbers are expected")
    header = [cell.strip() for cell in rows[0][1]]
    for line, row in rows[1:]:
        if any(cell.strip() for cell in row[len(header) :]):
            raise LoadingError(
                f"{path}: line {line} has {len(row)} cells under {len(header)} headers: "
                "decimal commas need semicolons or tabs between cells"
            )
    return _Table(path=path, separator=separator, header=header, rows=rows[1:])


def _find_columns(table: _Table, known: Sequence[str], given: Mapping[str, str]) -> dict[str, _Column]:
    """Return the column of each quantity that has one."""
    for name in given:
        if name not in known:
            raise LoadingError(
                f"{table.path}: columns name no quantity {name!r}; there are {', '.join(known)}"
            )
    found = {name: _find_column(table, name, given.get(name)) for name in known}
    return {name: column for name, column in found.items() if column is not None}


def _find_column(table: _Table, name: str, given: str | None) -> _Column | None:
    """Return the column that holds quantity `name`, or None where there is none."""
    if given is not None:
        title, _, unit = given.rpartition(":")
        if title not in table.header:
            raise LoadingError(
                f"{table.path}: no column {title!r} for {name}; found {', '.join(table.header)}"
            )
        return _Column(table.header.index(title), title, _factor(table.path, name, title, unit))
    units = {title: _named(title, name) for title in table.header}
    for word in _NAMES[name]:
        # Without a unit it is not read; of its own name, an unknown unit is refused.
        titles = [
            title
            for title, (called, unit) in units.items()
            if called == word and (unit in FACTORS[name] or (unit and word == name))
        ]
        if len(titles) > 1:
            raise LoadingError(
                f"{table.path}: two columns of {name}, {' and '.join(titles)}: say which, as in {name} = ..."
            )
        if titles:
            factor = _factor(table.path, name, titles[0], units[titles[0]][1])
            return _Column(table.header.index(titles[0]), titles[0], factor)
    return None


def _named(title: str, quantity: str) -> tuple[str, str]:
    """Return what a header names, in lower case, and its unit, empty where it has none.

    A space parts the unit from the name only where it is a unit of the quantity.
    """
    for form in (_IN_BRACKETS, _AFTER_LOW_LINE, _AFTER_SPACE):
        if match := form.fullmatch(title):
            name, unit = re.sub(r"[\s_]+", " ", match[1]).strip().casefold(), _plain_unit(match[2])
            if form is not _AFTER_SPACE or unit in FACTORS[quantity]:
                return name, unit
    return title.casefold(), ""


def _plain_unit(text: str) -> str:
    for spelling, plain in _UNIT_SPELLINGS.items():
        text = text.strip().replace(spelling, plain)
    return text


def _proposed(table: _Table, missing: Iterable[str], found: Mapping[str, _Column]) -> dict[str, str]:
    """Return what may be the columns of missing quantities: like in name, or the only one of such a unit."""
    read = {column.header for column in found.values()}
    titles = [title for title in table.header if title and title not in read]
    proposed = {}
    for name in missing:
        named = {title: _named(title, name) for title in titles}
        of_unit = [title for title, (_, unit) in named.items() if unit in FACTORS[name]]
        alike = [
            title
            for title, (word, unit) in named.items()
            if (not unit or title in of_unit) and difflib.get_close_matches(word, _NAMES[name], cutoff=0.7)
        ]
        choice = alike if len(alike) == 1 else of_unit
        if len(choice) == 1:
            unit = named[choice[0]][1]
            proposed[name] = f"{choice[0]}:{unit or 'UNIT'}"
    return proposed


def _factor(path: Path, name: str, title: str, unit: str) -> float:
    factor = FACTORS[name].get(_plain_unit(unit))
    if factor is None:
        known = ", ".join(FACTORS[name])
        raise LoadingError(f"{path}: column {title!r} has unit {unit!r}; {name} is read in {known}")
    return factor


def _numbers(table: _Table, column: _Column) -> FloatArray:
    """Return the numbers of a column; commas mark decimals where cells are not separated by them."""
    cells = [row[column.place].strip() if column.place < len(row) else "" for _, row in table.rows]
    if table.separator != "," and not any("." in cell for cell in cells):
        cells = [cell.replace(",", ".") for cell in cells]
    return np.array(
        [_number(table, line, column, cell) for (line, _), cell in zip(table.rows, cells, strict=True)]
    )


def _number(table: _Table, line: int, column: _Column, cell: str) -> float:
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise LoadingError(
            f"{table.path}: line {line}, column {column.header!r}: {cell!r} is not a finite number"
        )
    return value
