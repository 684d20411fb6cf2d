"""Rows of results kept by column: a study may have a hundred thousand."""

from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from typing import Any, Final, TypeAlias, overload

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray
from fingerpad.study.results.columns import COLUMNS, ColumnArray

Row: TypeAlias = dict[str, Any]
Places: TypeAlias = npt.NDArray[np.intp]

_AT_ONCE: Final = 1000


class ResultsTable(Sequence[Row]):
    """Rows of `COLUMNS`, each column one array; a row is a dict made when it is asked for.

    In a row what is not known is None; in a column it is what `Column.dtype` says. Some rows of a table
    (`at`, a slice, `by`, `sorted_by`) are a table that shares the columns.

    Examples
    --------
    >>> builder = TableBuilder()
    >>> builder.add({name: COLUMNS[name].array(["a", None]) for name in ("observation", "reason")})
    >>> builder.add({"observation": COLUMNS["observation"].array(["b"]), "load_N": np.array([2.0])})
    >>> table = builder.table()
    >>> table[2]["observation"], table[2]["load_N"], table[2]["frame"]
    ('b', 2.0, None)
    >>> table.column("load_N")
    array([nan, nan,  2.])
    """

    __slots__ = ("_columns", "_places")

    def __init__(self, columns: Mapping[str, ColumnArray], places: Places) -> None:
        self._columns = columns
        self._places = places

    def __len__(self) -> int:
        return self._places.size

    @overload
    def __getitem__(self, place: int) -> Row: ...
    @overload
    def __getitem__(self, place: slice) -> "ResultsTable": ...
    def __getitem__(self, place: int | slice) -> "Row | ResultsTable":
        if isinstance(place, slice):
            return self.at(np.arange(len(self))[place])
        index = self._places[place]
        return {name: COLUMNS[name].items(array[index, None])[0] for name, array in self._columns.items()}

    def __iter__(self) -> Iterator[Row]:
        return self.records(*self._columns)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, ResultsTable):
            return NotImplemented
        return len(self) == len(other) and all(self.items(name) == other.items(name) for name in COLUMNS)

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        """Let some rows travel to another process without the others whose columns they share."""
        return ResultsTable, ({name: self.column(name) for name in self._columns}, np.arange(len(self)))

    def __repr__(self) -> str:
        return f"<ResultsTable of {len(self)} rows>"

    @property
    def places(self) -> Places:
        """Where the rows stand in the table that they are of."""
        return self._places

    def column(self, name: str) -> ColumnArray:
        """Return one column as an array."""
        return self._columns[name][self._places]

    def items(self, name: str) -> list[Any]:
        """Return one column as it stands in rows."""
        return COLUMNS[name].items(self.column(name))

    def known(self, name: str) -> BoolArray:
        """Return where a column is known."""
        return COLUMNS[name].known(self.column(name))

    def records(self, *names: str) -> Iterator[Row]:
        """Yield rows of some columns only."""
        for batch in self.batches():
            for values in zip(*map(batch.items, names), strict=True):
                yield dict(zip(names, values, strict=True))

    def at(self, places: Places | BoolArray) -> "ResultsTable":
        """Return some rows, by their places or by truths."""
        return ResultsTable(self._columns, self._places[places])

    def fill(self, name: str, values: Any) -> None:
        """Fill a column of these rows, in every table that shares it."""
        self._columns[name][self._places] = values

    def by(self, *names: str) -> dict[tuple[Any, ...], "ResultsTable"]:
        """Return the rows with the same values in some columns, in the order in which they first come."""
        groups: dict[tuple[Any, ...], list[int]] = {}
        for place, values in enumerate(zip(*map(self.items, names), strict=True)):
            groups.setdefault(values, []).append(place)
        return {values: self.at(np.array(places)) for values, places in groups.items()}

    def sorted_by(self, name: str, *, descending: bool = False) -> "ResultsTable":
        """Return the rows by one column, those where it is not known last; equal ones keep their order."""
        items, known = self.items(name), self.known(name)
        places = sorted(np.flatnonzero(known).tolist(), key=items.__getitem__, reverse=descending)
        return self.at(np.array([*places, *np.flatnonzero(~known)], dtype=np.intp))

    def batches(self) -> Iterator["ResultsTable"]:
        """Yield all rows, some at a time."""
        for start in range(0, len(self), _AT_ONCE):
            yield self[start : start + _AT_ONCE]


class GrowingArray:
    """An array that is added to at its end, in place: lists of parts would be held twice when joined."""

    def __init__(self, empty: ColumnArray) -> None:
        self._array, self._size = empty, 0

    def add(self, more: ColumnArray) -> None:
        """Add items."""
        size = self._size + len(more)
        if size > len(self._array):
            grown = np.empty((max(size, len(self._array) * 5 // 4), *more.shape[1:]), dtype=self._array.dtype)
            grown[: self._size] = self._array[: self._size]
            self._array = grown
        self._array[self._size : size] = more
        self._size = size

    @property
    def array(self) -> ColumnArray:
        """All items."""
        return self._array[: self._size]


class TableBuilder:
    """Gathers a table from batches of rows."""

    def __init__(self) -> None:
        self._columns = {name: GrowingArray(column.unknown(0)) for name, column in COLUMNS.items()}
        self._words: dict[str | None, str | None] = {}

    def add(self, batch: Mapping[str, ColumnArray]) -> None:
        """Add rows, given by column; a column that is not named is not known."""
        size = len(next(iter(batch.values())))
        for name, grown in self._columns.items():
            column, array = COLUMNS[name], batch.get(name)
            if array is None:
                array = column.unknown(size)
            elif column.dtype == "text":  # each word is kept once
                array = column.array(self._words.setdefault(word, word) for word in array)
            grown.add(array)

    def table(self) -> ResultsTable:
        """Return all rows."""
        columns = {name: grown.array for name, grown in self._columns.items()}
        return ResultsTable(columns, np.arange(len(columns["observation"])))


def numbered(items: Iterable[Hashable]) -> Places:
    """Return a number for each item, the same for the same, counted from 0 in the order of coming.

    Examples
    --------
    >>> numbered(["b", "a", "b"])
    array([0, 1, 0])
    """
    numbers: dict[Hashable, int] = {}
    return np.array([numbers.setdefault(item, len(numbers)) for item in items], dtype=np.intp)
