"""Named columns with units of a table."""

import difflib
import json
import math
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad._tables import Table, read_table
from fingerpad.exceptions import LoadingError
from fingerpad.units import FACTORS

# How instruments call a quantity, also in German, French, Spanish and Italian; its own name first.
NAMES: Final[Mapping[str, tuple[str, ...]]] = {
    "force": (
        *("force", "load", "normal force", "normal load", "compressive force", "compressive load"),
        *("kraft", "normalkraft", "prüfkraft", "standardkraft"),
        *("charge", "fuerza", "carga", "forza", "carico"),
    ),
    "displacement": (
        *("displacement", "disp", "displ", "indentation", "indentation depth"),
        *("compressive displacement", "compressive extension", "weg", "standardweg", "eindringtiefe"),
        *("déplacement", "enfoncement", "desplazamiento", "spostamento"),
    ),
    "area": ("area", "contact area", "gross area", "fläche", "kontaktfläche", "aire", "área"),
    "time": ("time", "t", "elapsed time", "test time", "zeit", "prüfzeit", "temps", "tiempo", "tempo"),
}
# Force (N), force [N]; Force / N; force, N: these state a unit. force_N, force N, force in N: perhaps.
_IN_BRACKETS, _AFTER_MARK, _AFTER_LOW_LINE, _AFTER_SPACE = map(
    re.compile,
    (r"(.+?)[ _]*[(\[](.+?)[)\]]", r"(.+?)(?: */ *| *, *)(\S+)", r"(.+)_([^_]+)", r"(.+?)(?: in)? +(\S+)"),
)
_UNIT_SPELLINGS: Final = {"µ": "u", "μ": "u", "²": "2", "^2": "2", "sec": "s"}
# Of these, a unit tells what was not read; anything can be in volts or millimetres.
_TOLD_BY_UNIT: Final = frozenset(("area", "time"))
# Measured in some rows only where a camera is slower than the force; NaN in the others.
_MAY_BE_EMPTY: Final = "area"
_NUMBER: Final = re.compile(r"[-+]?[\d.,]+(e[-+]?\d+)?", re.IGNORECASE)
_MOST_PROPOSED: Final = 4


class ColumnsError(LoadingError):
    """A table in which the column of a quantity is missing, or several may be meant.

    `problem`: The message without the way out.
    `proposed`: From each quantity to what its column may be, each ``"HEADER:UNIT"``, as far as a header
    tells.
    """

    def __init__(self, problem: str, proposed: Mapping[str, Sequence[str]] | None = None) -> None:
        self.problem, self.proposed = problem, dict(proposed or {})
        super().__init__(problem)

    def __str__(self) -> str:
        return self.with_way_out(lambda columns: f"columns={json.dumps(columns, ensure_ascii=False)}")

    def with_way_out(self, words: Callable[[dict[str, str]], str]) -> str:
        """Return the message with what to write, the units explained that are still to be filled in."""
        most = max(map(len, self.proposed.values()), default=0)
        choices = [
            words({name: columns[min(place, len(columns) - 1)] for name, columns in self.proposed.items()})
            for place in range(min(most, _MOST_PROPOSED))
        ]
        units = (
            f"; UNIT of {name}: {', '.join(FACTORS[name])}"
            for name, columns in self.proposed.items()
            if any(column.endswith(":UNIT") for column in columns)
        )
        way_out = f"{self.problem}: rename columns in the first line"
        if not any(choices):
            return way_out
        return f"{way_out}, or say which they are: {' or '.join(choices)}{''.join(units)}"


@contextmanager
def columns_named_by(words: Callable[[dict[str, str]], str]) -> Iterator[None]:
    """Say how columns are named where tables are read for a command or a manifest."""
    try:
        yield
    except ColumnsError as error:
        raise LoadingError(error.with_way_out(words)) from None


def columns_in_toml(key: str, columns: Mapping[str, str]) -> str:
    """Return the line of a manifest that maps columns."""
    return f"{key} = {{ {named_columns(columns)} }}"


def named_columns(columns: Mapping[str, str]) -> str:
    """Return quantities and their columns as a manifest names them."""
    return ", ".join(f"{name} = {json.dumps(column, ensure_ascii=False)}" for name, column in columns.items())


class _Column(NamedTuple):
    position: int
    header: str
    factor: float


def read_columns(
    path: Path,
    required: Sequence[str],
    optional: Sequence[str] = (),
    *,
    columns: Mapping[str, str] | None = None,
) -> dict[str, FloatArray]:
    """Read quantities from a table whose header names each with its unit, as in ``force_N, Time (s)``.

    Units may stand in a line of their own below the header.

    `required` and `optional` are quantities of `fingerpad.units.FACTORS`; `columns` leads from a quantity to
    ``"HEADER:UNIT"`` where the file's own headers differ. Arrays are in the library's units.
    """
    return _numbers(*_located(path, required, optional, columns))


def require_columns(
    path: Path,
    required: Sequence[str],
    optional: Sequence[str] = (),
    *,
    columns: Mapping[str, str] | None = None,
) -> None:
    """Raise what `read_columns` raises of a table's header, without reading its numbers."""
    _located(path, required, optional, columns, head_only=True)


def _located(
    path: Path,
    required: Sequence[str],
    optional: Sequence[str],
    columns: Mapping[str, str] | None,
    *,
    head_only: bool = False,
) -> tuple[Table, dict[str, _Column]]:
    """Return a table and the columns of quantities in it. Raise ColumnsError where one is missing."""
    given = dict(columns or {})
    table = _read_table(path, required, given, head_only=head_only)
    found = _find_columns(table, [*required, *optional], given)
    missing = [name for name in required if name not in found]
    if missing:
        proposed = _proposed(table, missing, found, by_unit=missing)
        lacking = " or ".join(f"{name}_{next(iter(FACTORS[name]))}" for name in missing)
        sheet = f", sheet {table.sheet!r}" if table.sheet else ""
        raise ColumnsError(
            f"{path}{sheet}: no column {lacking}; found {', '.join(table.header)}",
            _as_choices(given) | {name: proposed.get(name, ["HEADER:UNIT"]) for name in missing},
        )
    return table, found


def unread_columns(
    path: Path, quantities: Sequence[str], columns: Mapping[str, str] | None = None
) -> dict[str, list[str]]:
    """Return columns that `read_columns` leaves alone, and that by name or unit look like what it lacks.

    Each is ``"HEADER:UNIT"`` under the quantity that has no column; ``UNIT`` where the header has none.
    """
    if not path.is_file():  # a pipe, which can be read only once
        return {}
    table = _read_table(path, quantities[:1], columns or {}, head_only=True)
    found = _find_columns(table, quantities, columns or {})
    missing = [name for name in quantities if name not in found]
    return _proposed(table, missing, found, by_unit=_TOLD_BY_UNIT)


def unread_notes(unread: Mapping[str, Sequence[str]], way_out: Callable[[str, str], str]) -> Iterator[str]:
    """Yield a note on each of `unread_columns`, whose way out is given by its quantity and the column."""
    for name, columns in unread.items():
        for column in columns:
            title = column.rpartition(":")[0]
            yield f"column {title!r} was not read; if it is the {name}{way_out(name, column)}"


def _read_table(
    path: Path, required: Sequence[str], given: Mapping[str, str], *, head_only: bool = False
) -> Table:
    """Return a table with numbers under its header; units of a line of their own are in the header.

    Of a workbook whose first sheet lacks a required quantity it is the only sheet that has all.
    """

    def is_wanted(header: list[str]) -> bool:
        words = {header_parts(title, FACTORS[name])[0] for title in header for name in required}
        return all(
            given[name].rpartition(":")[0] in header
            if name in given
            else words & set(NAMES.get(name, (name,)))
            for name in required
        )

    table = read_table(path, LoadingError, head_only=head_only, is_wanted=is_wanted)
    if table.rows and (units := _line_of_units(table.rows[0][1])):
        header = [
            f"{title} ({unit})" if unit else title for title, unit in zip(table.header, units, strict=False)
        ]
        table = replace(table, header=header, rows=table.rows[1:])
    if not table.rows:
        raise LoadingError(f"{path}: holds no data; a header line and rows of numbers are expected")
    table.require_headers(LoadingError)
    return table


def _line_of_units(cells: Sequence[str]) -> list[str]:
    """Return the units in a line, empty where it is not one of units."""
    units = [cell.strip("()[] ") for cell in cells]
    known = {unit for factors in FACTORS.values() for unit in factors}
    has_unit = any(_plain_unit(unit) in known for unit in units)
    return units if has_unit and not any(map(_NUMBER.fullmatch, units)) else []


def _find_columns(table: Table, known: Sequence[str], given: Mapping[str, str]) -> dict[str, _Column]:
    """Return the column of each quantity that has one."""
    for name in given:
        if name not in known:
            raise LoadingError(
                f"{table.name}: columns name no quantity {name!r}; there are {', '.join(known)}"
            )
    found = {name: _find_column(table, name, given) for name in known}
    return {name: column for name, column in found.items() if column is not None}


def _find_column(table: Table, name: str, given: Mapping[str, str]) -> _Column | None:
    """Return the column that holds quantity `name`, or None where there is none."""
    if name in given:
        title, _, unit = given[name].rpartition(":")
        if title not in table.header:
            raise LoadingError(
                f"{table.name}: no column {title!r} for {name}; found {', '.join(table.header)}"
            )
        column = _column(table, name, table.header.index(title), unit)
        word, own, stated = header_parts(title, FACTORS[name])
        own = own if stated or word in NAMES.get(name, (name,)) else ""
        if FACTORS[name].get(own, column.factor) != column.factor:
            raise ColumnsError(
                f"{table.name}: the header of column {title!r} says {own}, and its unit is given as {unit}",
                _as_choices(given) | {name: [f"{title}:{own}"]},
            )
        return column
    named = [
        (place, word, unit, stated)
        for place, title in enumerate(table.header)
        for word, unit, stated in [header_parts(title, FACTORS[name])]
        if word in NAMES.get(name, (name,))
    ]
    readable = [(place, unit) for place, _, unit, _ in named if unit in FACTORS[name]]
    if len(readable) > 1:
        titles = [_column(table, name, *column).header for column in readable]
        raise ColumnsError(
            f"{table.name}: {' and '.join(titles)} may each be the {name}",
            _as_choices(given) | {name: [f"{table.header[place]}:{unit}" for place, unit in readable]},
        )
    # A unit that is not one of the quantity is refused rather than the column left out; load_cell has none.
    unread = [(place, unit) for place, word, unit, stated in named if unit and (stated or word == name)]
    for place, unit in readable or unread:
        return _column(table, name, place, unit)
    return None


def header_parts(title: str, units: Collection[str] = ()) -> tuple[str, str, bool]:
    """Return what a header names, in lower case, its unit if any, and whether it states that as one."""
    for form in (_IN_BRACKETS, _AFTER_MARK, _AFTER_LOW_LINE, _AFTER_SPACE):
        if match := form.fullmatch(title):
            word, unit = re.sub(r"[\s_]+", " ", match[1]).strip().casefold(), _plain_unit(match[2])
            if form is not _AFTER_SPACE or unit in units:
                return word, unit, form in (_IN_BRACKETS, _AFTER_MARK)
    return title.casefold(), "", False


def _plain_unit(text: str) -> str:
    for spelling, plain in _UNIT_SPELLINGS.items():
        text = text.strip().replace(spelling, plain)
    return text


def _proposed(
    table: Table, missing: Iterable[str], found: Mapping[str, _Column], *, by_unit: Collection[str]
) -> dict[str, list[str]]:
    """Return what may be the columns of missing quantities: like in name, or else of such a unit."""
    read = {column.position for column in found.values()}
    proposed = {}
    for name in missing:
        titles = [
            (title, *header_parts(title, FACTORS[name])[:2])
            for place, title in enumerate(table.header)
            if title and place not in read
        ]
        of_unit = [(title, word, unit) for title, word, unit in titles if unit in FACTORS[name]]
        alike = [
            (title, word, unit)
            for title, word, unit in titles
            if (not unit or unit in FACTORS[name])
            and difflib.get_close_matches(word, NAMES.get(name, (name,)), cutoff=0.7)
        ]
        if choice := alike or (of_unit if name in by_unit else []):
            proposed[name] = [f"{title}:{unit or 'UNIT'}" for title, _, unit in choice]
    return proposed


def _as_choices(columns: Mapping[str, str]) -> dict[str, Sequence[str]]:
    return {name: [column] for name, column in columns.items()}


def _column(table: Table, name: str, place: int, unit: str) -> _Column:
    title = table.header[place]
    if table.header.count(title) > 1:
        raise LoadingError(
            f"{table.name}: {table.header.count(title)} columns are called {title}: rename one"
        )
    factor = FACTORS[name].get(_plain_unit(unit))
    if factor is None:
        known = ", ".join(FACTORS[name])
        raise LoadingError(
            f"{table.name}: column {title!r} has unit {unit!r}; {name} is read in {known}. Convert it, or "
            "rename the column to leave it out"
        )
    return _Column(place, title, factor)


def _numbers(table: Table, columns: Mapping[str, _Column]) -> dict[str, FloatArray]:
    """Return the numbers of columns; other columns of a workbook or MAT file may be longer."""
    cells = table.texts([column.position for column in columns.values()])
    count = len(table.rows)
    if not table.separator:
        count = max((k for k, row in enumerate(zip(*cells, strict=True), 1) if any(row)), default=count)
    return {
        name: column.factor * _parsed(table, column, texts[:count], gaps=name == _MAY_BE_EMPTY)
        for (name, column), texts in zip(columns.items(), cells, strict=True)
    }


def _parsed(table: Table, column: _Column, texts: Sequence[str], *, gaps: bool) -> FloatArray:
    try:
        values = np.array(list(map(float, texts)))
    except ValueError:
        values = np.array([math.nan])
    if len(texts) > 1 and not any(texts):
        raise LoadingError(f"{table.name}: column {column.header!r} is empty: leave the column out")
    if np.isfinite(values).all():
        return values
    return np.array(
        [
            math.nan if gaps and text.lower() in {"", "nan"} else _number(table, line, text, column)
            for (line, _), text in zip(table.rows, texts, strict=False)
        ]
    )


def _number(table: Table, line: int, cell: str, column: _Column) -> float:
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise LoadingError(
            f"{table.name}: {table.line(line)}, column {column.header!r}: {cell!r} is not a finite number"
            f"{table.hint(cell)}"
        )
    return value
