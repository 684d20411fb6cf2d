"""Rows of results kept by column: a study may have a hundred thousand."""

from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from math import isnan
from typing import Any, Final, TypeAlias, overload

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray
from fingerpad.study.results.columns import BOOL_COLUMNS, COLUMNS, INT_COLUMNS, TEXT_COLUMNS

Row: TypeAlias = dict[str, Any]
Column: TypeAlias = npt.NDArray[Any]
Places: TypeAlias = npt.NDArray[np.intp]

# Stands for a count that is not known, as NaN does for a float and None for a word.
UNKNOWN_COUNT: Final = -1
_AT_ONCE: Final = 1000


class Table(Sequence[Row]):
    """Rows of `COLUMNS`, each column one array; a row is a dict made when it is asked for.

    In a row what is not known is None. In a column it is NaN among floats, None among words, and −1 among
    counts. Some rows of a table (`at`, a slice, `by`) are a table that shares the columns.

    Examples
    --------
    >>> builder = TableBuilder()
    >>> builder.add({name: column_of(name, ["a", None]) for name in ("observation", "reason")})
    >>> builder.add({"observation": column_of("observation", ["b"]), "load_N": np.array([2.0])})
    >>> table = builder.table()
    >>> table[2]["observation"], table[2]["load_N"], table[2]["frame"]
    ('b', 2.0, None)
    >>> table.column("load_N")
    array([nan, nan,  2.])
    """

    __slots__ = ("_columns", "_places")

    def __init__(self, columns: Mapping[str, Column], places: Places) -> None:
        self._columns = columns
        self._places = places

    def __len__(self) -> int:
        return self._places.size

    @overload
    def __getitem__(self, place: int) -> Row: ...
    @overload
    def __getitem__(self, place: slice) -> "Table": ...
    def __getitem__(self, place: int | slice) -> "Row | Table":
        if isinstance(place, slice):
            return self.at(np.arange(len(self))[place])
        index = self._places[place]
        return {name: _items(name, column[index, None])[0] for name, column in self._columns.items()}

    def __iter__(self) -> Iterator[Row]:
        for some in self.batches():
            columns = (_items(name, some.column(name)) for name in self._columns)
            for values in zip(*columns, strict=True):
                yield dict(zip(self._columns, values, strict=True))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Table):
            return NotImplemented
        return len(self) == len(other) and all(
            _items(name, self.column(name)) == _items(name, other.column(name)) for name in self._columns
        )

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        """Let some rows travel to another process without the others whose columns they share."""
        return Table, ({name: self.column(name) for name in self._columns}, np.arange(len(self)))

    def __repr__(self) -> str:
        return f"<Table of {len(self)} rows>"

    @property
    def places(self) -> Places:
        """Where the rows stand in the table that they are of."""
        return self._places

    def column(self, name: str) -> Column:
        """Return one column: floats, counts (int), truths (bool) or words (object)."""
        return self._columns[name][self._places]

    def known(self, name: str) -> BoolArray:
        """Return where a column is known."""
        column = self.column(name)
        if name in TEXT_COLUMNS:
            return np.array([item is not None for item in column], dtype=bool)
        return np.asarray(column != UNKNOWN_COUNT if name in INT_COLUMNS else ~np.isnan(column))

    def at(self, places: Places | BoolArray) -> "Table":
        """Return some rows, by their places or by truths."""
        return Table(self._columns, self._places[places])

    def by(self, *names: str) -> dict[tuple[Any, ...], "Table"]:
        """Return the rows with the same values in some columns, in the order in which they first come."""
        groups: dict[tuple[Any, ...], list[int]] = {}
        columns = (_items(name, self.column(name)) for name in names)
        for place, values in enumerate(zip(*columns, strict=True)):
            groups.setdefault(values, []).append(place)
        return {values: self.at(np.array(places)) for values, places in groups.items()}

    def batches(self, size: int = _AT_ONCE) -> Iterator["Table"]:
        """Yield all rows, some at a time."""
        for start in range(0, len(self), size):
            yield self[start : start + size]


class GrowingArray:
    """An array that is added to at its end, in place: lists of parts would be held twice when joined."""

    def __init__(self, empty: Column) -> None:
        self._array, self._size = empty, 0

    def add(self, more: Column) -> None:
        """Add items."""
        size = self._size + len(more)
        if size > len(self._array):
            grown = np.empty((max(size, 2 * len(self._array)), *more.shape[1:]), dtype=self._array.dtype)
            grown[: self._size] = self._array[: self._size]
            self._array = grown
        self._array[self._size : size] = more
        self._size = size

    @property
    def array(self) -> Column:
        """All items."""
        return self._array[: self._size]


class TableBuilder:
    """Gathers a table from batches of rows."""

    def __init__(self) -> None:
        self._columns = {name: GrowingArray(unknown(name, 0)) for name in COLUMNS}
        self._words: dict[str | None, str | None] = {}

    def add(self, batch: Mapping[str, Column]) -> None:
        """Add rows, given by column; a column that is not named is not known."""
        size = len(next(iter(batch.values())))
        for name, grown in self._columns.items():
            column = batch.get(name)
            if column is None:
                column = unknown(name, size)
            elif name in TEXT_COLUMNS:  # each word is kept once
                column = column_of(name, (self._words.setdefault(word, word) for word in column))
            grown.add(column)

    def table(self) -> Table:
        """Return all rows."""
        columns = {name: grown.array for name, grown in self._columns.items()}
        return Table(columns, np.arange(len(columns["observation"])))


def column_of(name: str, items: Iterable[Any]) -> Column:
    """Return the items of rows as a column."""
    listed = list(items)
    if name in TEXT_COLUMNS:
        column = np.empty(len(listed), dtype=object)
        column[:] = listed
        return column
    if name in INT_COLUMNS:
        return np.array([UNKNOWN_COUNT if item is None else item for item in listed], dtype=np.int64)
    return np.array(listed, dtype=bool if name in BOOL_COLUMNS else np.float64)


def numbered(items: Iterable[Hashable]) -> Places:
    """Return a number for each item, the same for the same, counted from 0 in the order of coming.

    Examples
    --------
    >>> numbered(["b", "a", "b"])
    array([0, 1, 0])
    """
    numbers: dict[Hashable, int] = {}
    return np.array([numbers.setdefault(item, len(numbers)) for item in items], dtype=np.intp)


def unknown(name: str, size: int) -> Column:
    """Return a column of which nothing is known."""
    if name in TEXT_COLUMNS:
        return np.full(size, None, dtype=object)
    if name in BOOL_COLUMNS:
        return np.zeros(size, dtype=bool)
    return np.full(size, UNKNOWN_COUNT) if name in INT_COLUMNS else np.full(size, np.nan)


def _items(name: str, column: Column) -> list[Any]:
    """Return a column as it stands in rows: None for what is not known."""
    items: list[Any] = column.tolist()
    if name in TEXT_COLUMNS or name in BOOL_COLUMNS:
        return items
    if name in INT_COLUMNS:
        return [None if item == UNKNOWN_COUNT else item for item in items]
    return [None if isnan(item) else item for item in items]
