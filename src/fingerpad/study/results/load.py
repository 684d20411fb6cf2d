"""The table of a finished run in memory, by columns."""

from collections.abc import Iterator, Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy.typing as npt

from fingerpad.exceptions import FingerpadError
from fingerpad.study.results.columns import COLUMNS
from fingerpad.study.results.result_set import require_result_set
from fingerpad.study.results.results_reader import read_table
from fingerpad.study.results.summary_file import SummaryFile
from fingerpad.study.results.table import ResultsTable

if TYPE_CHECKING:
    import pandas as pd


class Results(Mapping[str, npt.NDArray[Any]]):
    """The results of a finished run: one array for each column of ``results.csv``, by name.

    Text is an object array with None for empty cells; other columns are as `Column.dtype` says.

    Attributes
    ----------
    title : str
        The study's title.
    summary : SummaryFile
        What ``summary.json`` holds: semi-axes of fingers, pooled radii, verdicts, loading curves and more.
    columns : dict of str to Column
        Unit and meaning of each column.
    rows : int
        Number of rows.
    """

    def __init__(self, summary: SummaryFile, table: ResultsTable) -> None:
        self.summary, self.title = summary, summary.title
        self.columns, self.rows = COLUMNS, len(table)
        self._table = table

    def __getitem__(self, name: str) -> npt.NDArray[Any]:
        try:
            return self._table.column(name)
        except KeyError:
            raise KeyError(f"no column {name!r}; list(results) names all {len(self)}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(COLUMNS)

    def __len__(self) -> int:
        return len(COLUMNS)

    def __repr__(self) -> str:
        return f"<Results of {self.title!r}: {self.rows} rows, {len(self)} columns>"

    def to_pandas(self) -> "pd.DataFrame":
        """Return the table as a pandas DataFrame.

        Raises
        ------
        FingerpadError
            If pandas is not installed.
        """
        try:
            import pandas as pd  # noqa: PLC0415 (it need not be installed)
        except ImportError:
            raise FingerpadError("this needs the package pandas: pip install pandas") from None
        return pd.DataFrame(dict(self))


def load_results(folder: str | PathLike[str]) -> Results:
    """Read the results of a finished run.

    Parameters
    ----------
    folder : path-like
        Output folder of the run.

    Returns
    -------
    Results
        A mapping from the names of columns to arrays; ``.to_pandas()`` makes it a DataFrame, and ``.summary``
        holds what was pooled.

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
    return Results(SummaryFile.read(Path(folder)), read_table(Path(folder)))
