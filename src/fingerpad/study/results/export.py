"""Results as Parquet and as MATLAB files, typed and with the unit and meaning of every column."""

import os
from collections.abc import Callable, Mapping
from os import PathLike
from pathlib import Path
from typing import Final

import numpy as np
import pandas as pd
from scipy import io

from fingerpad.exceptions import FingerpadError
from fingerpad.study.results.columns import COLUMNS, Column, ColumnArray
from fingerpad.study.results.load import read_batches, read_header, read_rows
from fingerpad.study.results.result_set import require_result_set
from fingerpad.study.results.summary_file import SummaryFile

_ROW_GROUP: Final = 5000


def export_results(folder: str | PathLike[str], file: str | PathLike[str]) -> None:
    """Write the results of a finished run into one file, in the format that its suffix names.

    Parameters
    ----------
    folder : path-like
        Output folder of the run.
    file : path-like
        ``.parquet`` or ``.mat``; one that is there is replaced, once the new one is whole.

    Raises
    ------
    FingerpadError
        If the folder holds no finished run, the suffix is another, a package is missing, or the file cannot
        be written.
    """
    folder, file = Path(folder), Path(file)
    write = _FORMATS.get(file.suffix.lower())
    if write is None:
        raise FingerpadError(
            f"{file}: no format is known by {file.suffix or 'a name without suffix'}; "
            f"name the file with {' or '.join(_FORMATS)}; as CSV the table is {folder / 'results.csv'}"
        )
    require_result_set(folder)
    summary = SummaryFile.read(folder)
    study = {"title": summary.title, "fingerpad": summary.provenance.fingerpad}
    part = file.with_name(f".{file.name}.part")
    try:
        write(folder, study, part)
        os.replace(part, file)
    except OSError as error:
        raise FingerpadError(f"{file}: cannot be written ({error.strerror or error})") from error
    finally:
        part.unlink(missing_ok=True)


def _write_parquet(folder: Path, study: dict[str, str], file: Path) -> None:
    """Write one row group for each batch of rows: memory stays flat."""
    try:
        import pyarrow as pa
        from pyarrow import parquet
    except ImportError:
        raise FingerpadError("Parquet needs the package pyarrow: pip install 'fingerpad[parquet]'") from None
    columns = [COLUMNS[name] for name in read_header(folder)]
    types = {"text": pa.string(), "bool": pa.bool_(), "int": pa.int64(), "float": pa.float64()}
    schema = pa.schema(
        [
            pa.field(
                column.name,
                types[column.dtype],
                metadata={"unit": column.unit, "meaning": column.meaning, "group": column.group},
            )
            for column in columns
        ],
        metadata=study,
    )
    with parquet.ParquetWriter(file, schema, compression="zstd") as writer:
        for batch in read_batches(folder, _ROW_GROUP):
            arrays = [
                pa.Array.from_pandas(column.series(batch[column.name]), type=types[column.dtype])
                for column in columns
            ]
            writer.write_table(pa.table(arrays, schema=schema))


def _write_mat(folder: Path, study: dict[str, str], file: Path) -> None:
    """Write structs `results`, `units`, `meanings` and `study`, with one field for each column."""
    table = read_rows(folder)
    content = {
        "results": {name: _matlab_column(COLUMNS[name], table[name]) for name in table},
        "units": {name: COLUMNS[name].unit for name in table},
        "meanings": {name: COLUMNS[name].meaning for name in table},
        "study": study,
    }
    with file.open("wb") as target:
        io.savemat(target, content, long_field_names=True, oned_as="column", do_compression=True)


def _matlab_column(column: Column, values: pd.Series) -> ColumnArray:
    """Return a column as MATLAB has it: doubles, logicals, or a character matrix with one line for each row.

    A cell array would take a hundred times as long to write and read; ``cellstr`` makes one.
    """
    if column.dtype == "text":
        return np.array([word or " " for word in values], dtype=np.str_)
    numbers = values.to_numpy(bool if column.dtype == "bool" else float, na_value=np.nan)
    return np.asarray(numbers).reshape(-1, 1)


_FORMATS: Final[Mapping[str, Callable[[Path, dict[str, str], Path], None]]] = {
    ".parquet": _write_parquet,
    ".mat": _write_mat,
}
