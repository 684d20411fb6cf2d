"""The table of results: a pandas DataFrame of `COLUMNS`, with one row per contact or frame.

Text is of dtype object, with None where nothing is known; the number of a frame is Int64; the rest is bool
and float64. Some rows of a table keep their index, which is their place in the whole.
"""

from collections.abc import Hashable, Iterable, Iterator, Mapping
from typing import Any, Final, TypeAlias

import numpy as np
import numpy.typing as npt
import pandas as pd

from fingerpad.study.results.columns import COLUMNS, ColumnArray

Row: TypeAlias = dict[str, Any]
Places: TypeAlias = npt.NDArray[np.intp]

_AT_ONCE: Final = 1000


def table_of(batches: Iterable[Mapping[str, ColumnArray]], names: Iterable[str] = COLUMNS) -> pd.DataFrame:
    """Return a table of batches of rows, given by column; a column that is not given is not known.

    Examples
    --------
    >>> names = COLUMNS["observation"].array(["a", "b"])
    >>> table = table_of([{"observation": names}, {"observation": names, "load_N": np.array([1.0, 2.0])}])
    >>> table[["observation", "load_N", "frame"]]
      observation  load_N  frame
    0           a     NaN   <NA>
    1           b     NaN   <NA>
    2           a     1.0   <NA>
    3           b     2.0   <NA>
    """
    columns = {name: GrowingArray(COLUMNS[name].unknown(0)) for name in names}
    words: dict[str | None, str | None] = {}
    for batch in batches:
        size = len(next(iter(batch.values())))
        for name, grown in columns.items():
            column, array = COLUMNS[name], batch.get(name)
            if array is None:
                array = column.unknown(size)
            elif column.dtype == "text":  # each word is kept once
                array = column.array(words.setdefault(word, word) for word in array)
            grown.add(array)
    return pd.DataFrame(
        {name: COLUMNS[name].series(grown.array) for name, grown in columns.items()}, copy=False
    )


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


def items(column: pd.Series) -> list[Any]:
    """Return a column as plain values, None for what is not known."""
    values: list[Any] = column.tolist()
    if column.dtype in (bool, object):
        return values
    return [None if missing else item for item, missing in zip(values, column.isna().tolist(), strict=True)]


def records(table: pd.DataFrame, *names: str) -> Iterator[Row]:
    """Yield rows as dicts, of some columns or of all."""
    chosen = names or tuple(table)
    for batch in batches(table):
        for values in zip(*(items(batch[name]) for name in chosen), strict=True):
            yield dict(zip(chosen, values, strict=True))


def batches(table: pd.DataFrame) -> Iterator[pd.DataFrame]:
    """Yield all rows, some at a time."""
    for start in range(0, len(table), _AT_ONCE):
        yield table.iloc[start : start + _AT_ONCE]


def first_record(table: pd.DataFrame) -> Row | None:
    """Return the first row as a dict, None of an empty table."""
    return next(records(table.iloc[:1]), None)


def groups(table: pd.DataFrame, *names: str) -> dict[tuple[Any, ...], Places]:
    """Return the places of rows with the same values in some columns, in the order of coming."""
    places: dict[tuple[Any, ...], list[int]] = {}
    for place, values in enumerate(zip(*(items(table[name]) for name in names), strict=True)):
        places.setdefault(values, []).append(place)
    return {values: np.array(some) for values, some in places.items()}


def numbered(items: Iterable[Hashable]) -> Places:
    """Return a number for each item, the same for the same, counted from 0 in the order of coming.

    Examples
    --------
    >>> numbered(["b", "a", "b"])
    array([0, 1, 0])
    """
    numbers: dict[Hashable, int] = {}
    return np.array([numbers.setdefault(item, len(numbers)) for item in items], dtype=np.intp)
