"""The table of results: a pandas DataFrame of `COLUMNS`, with one row per contact or frame.

Text is of dtype object, with None where nothing is known; the number of a frame is Int64; the rest is bool
and float64. Some rows of a table keep their index, which is their place in the whole.
"""

from collections.abc import Hashable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from math import nan
from typing import Any, Final, Literal, TypeAlias

import numpy as np
import numpy.typing as npt
import pandas as pd

from fingerpad._csv import package_table

ColumnArray: TypeAlias = npt.NDArray[Any]
DType: TypeAlias = Literal["text", "bool", "int", "float"]

_NUMPY: Final[Mapping[DType, type]] = {"text": object, "bool": bool, "int": np.int64, "float": np.float64}
# What an array holds where nothing is known.
_UNKNOWN: Final[Mapping[DType, Any]] = {"text": None, "bool": False, "int": -1, "float": nan}


@dataclass(frozen=True, slots=True)
class Column:
    """A column of the results."""

    name: str  # as in ``results.csv``
    # what it holds. As an array: objects, with None for what is not known; truths; int64 with −1; float64
    # with NaN. In a table whole numbers are Int64
    dtype: DType
    unit: str  # its unit: empty for text and truths, ``1`` for pure numbers and counts
    meaning: str
    group: str = ""
    default: bool = True  # whether ``results.csv`` has it without ``--all-columns``

    def array(self, items: Iterable[Any]) -> ColumnArray:
        """Return items as an array; None is what is not known."""
        unknown = _UNKNOWN[self.dtype]
        listed = [unknown if item is None else item for item in items]
        array: ColumnArray = np.empty(len(listed), dtype=_NUMPY[self.dtype])
        array[:] = listed
        return array

    def unknown(self, size: int) -> ColumnArray:
        """Return an array in which nothing is known; truths are false."""
        return np.full(size, _UNKNOWN[self.dtype], dtype=_NUMPY[self.dtype])

    def is_unknown(self, array: ColumnArray) -> bool:
        """Return whether an array tells nothing."""
        missing = np.isnan(array) if self.dtype == "float" else array == _UNKNOWN[self.dtype]
        return bool(missing.all())

    def series(self, array: ColumnArray, index: pd.Index | None = None) -> pd.Series:
        """Return an array as a column of a table, whose index it may share."""
        if self.dtype == "int":
            return pd.Series(pd.arrays.IntegerArray(array, array == _UNKNOWN["int"]), index=index)
        return pd.Series(array, index=index, dtype=array.dtype, copy=False)


# In the order of ``results.csv``: what a contact comes to stands first.
COLUMNS: Final[Mapping[str, Column]] = {
    line["column"]: Column(
        line["column"],
        line["type"],  # type: ignore[arg-type]
        line["unit"],
        line["meaning"],
        line["group"],
        line["default"] == "yes",
    )
    for line in package_table("fingerpad.study.results", "columns.csv")
}
DEFAULT_COLUMNS: Final = tuple(name for name, column in COLUMNS.items() if column.default)

Row: TypeAlias = dict[str, Any]
Indices: TypeAlias = npt.NDArray[np.intp]

_AT_ONCE: Final = 500


def table_of(
    batches: Iterable[Mapping[str, ColumnArray]],
    names: Iterable[str] = COLUMNS,
    *,
    read_only: bool = False,
    capacity: int = 0,
) -> pd.DataFrame:
    """Return a table of batches by column; one that is read only holds once what all rows share."""
    size, words = 0, dict[str | None, str | None]()
    growing = {name: GrowingArray(column.unknown(0), capacity) for name, column in COLUMNS.items()}
    for batch in batches:
        if unknown := batch.keys() - COLUMNS.keys():
            raise ValueError(f"columns.csv has no line for {', '.join(sorted(unknown))}")
        more = len(next(iter(batch.values())))
        for name, column in COLUMNS.items():
            array = batch.get(name)
            if array is None or column.is_unknown(array):
                array = column.unknown(more)
            elif column.dtype == "text" and name != "observation":  # each word is kept once
                array = column.array(words.setdefault(word, word) for word in array)
            growing[name].add(array)
        size += more
    # With one index, pandas need not align the columns, which takes longer than the model of a contact.
    index = pd.RangeIndex(size)
    columns = {}
    for name in names:
        array = growing[name].array
        columns[name] = COLUMNS[name].series(array if read_only else np.require(array, None, "W"), index)
    return pd.DataFrame(columns, index=index, copy=False)


class GrowingArray:
    """An array that is added to at its end, in place: lists of parts would be held twice when joined.

    As long as all its items are the same, it holds one. Room for `capacity` items is set aside when they are
    not; what is not used of it takes no memory.
    """

    def __init__(self, empty: ColumnArray, capacity: int = 0) -> None:
        self._array, self._size, self._capacity = empty, 0, capacity

    def add(self, more: ColumnArray) -> None:
        """Add items."""
        before, self._size = self._size, self._size + len(more)
        if before == 0:
            self._array = more[:1].copy()
        if len(self._array) <= 1:
            if _all_are(more, self._array):
                return
            same, room = self._array, max(self._size, self._capacity)
            self._array = np.empty((room, *more.shape[1:]), dtype=more.dtype)
            self._array[:before] = same
        elif self._size > len(self._array):
            room = max(self._size, len(self._array) * 5 // 4)
            self._array.resize((room, *more.shape[1:]), refcheck=False)
        self._array[before : self._size] = more

    @property
    def array(self) -> ColumnArray:
        """All items, read only where they are the same; nothing can be added to them any more."""
        shape = (self._size, *self._array.shape[1:])
        if len(self._array) <= 1:
            return np.broadcast_to(self._array, shape)
        self._array.resize(shape, refcheck=False)
        return self._array


def _all_are(array: ColumnArray, one: ColumnArray) -> bool:
    """Return whether all items are the same, to the bit: 0 and −0 are not, NaN and NaN are."""
    if array.dtype == float:
        array, one = array.view(np.int64), one.view(np.int64)
    return bool((array == one).all())


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


def record_at(table: pd.DataFrame, place: int = 0) -> Row | None:
    """Return one row of a table with text as a dict, None of an empty table."""
    row = {} if table.empty else table.iloc[place].items()  # column by column it takes much longer
    plain = ((name, one.item() if isinstance(one, np.generic) else one) for name, one in row)
    return {name: None if pd.isna(one) else one for name, one in plain} or None


def groups(table: pd.DataFrame, *names: str) -> dict[tuple[Any, ...], Indices]:
    """Return the places of rows with the same values in some columns, in the order of coming."""
    number = table.groupby([*names], sort=False, dropna=False).ngroup().to_numpy()
    order = np.argsort(number, kind="stable")
    places = np.split(order, np.flatnonzero(np.diff(number[order])) + 1) if len(table) else []
    firsts = records(table.iloc[[some[0] for some in places]], *names)
    return {tuple(first.values()): some for first, some in zip(firsts, places, strict=True)}


def numbered(items: Iterable[Hashable]) -> Indices:
    """Return a number for each item, the same for the same, counted from 0 in the order of coming."""
    numbers: dict[Hashable, int] = {}
    return np.array([numbers.setdefault(item, len(numbers)) for item in items], dtype=np.intp)
