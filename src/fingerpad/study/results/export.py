"""Results as Parquet and as MATLAB files, typed and with the unit and meaning of every column."""

import os
import re
from collections.abc import Callable, Mapping
from os import PathLike
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt
from scipy import io

from fingerpad.exceptions import FingerpadError
from fingerpad.study.results.columns import BOOL_COLUMNS, INT_COLUMNS, TEXT_COLUMNS
from fingerpad.study.results.results_reader import ResultsTable

# What MATLAB takes as the name of a field.
_MATLAB_NAME: Final = re.compile(r"[A-Za-z]\w{0,62}", re.ASCII)


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
            f"name the file with {' or '.join(_FORMATS)}"
        )
    table = ResultsTable.of(folder)
    part = file.with_name(f".{file.name}.part")
    try:
        write(table, part)
        os.replace(part, file)
    except OSError as error:
        raise FingerpadError(f"{file}: cannot be written ({error.strerror or error})") from error
    finally:
        part.unlink(missing_ok=True)


def _write_parquet(table: ResultsTable, file: Path) -> None:
    """Write one row group for each batch of rows: memory stays flat."""
    try:
        import pyarrow as pa
        from pyarrow import parquet
    except ImportError:
        raise FingerpadError("Parquet needs the package pyarrow: pip install 'fingerpad[parquet]'") from None
    schema = pa.schema(
        [
            pa.field(
                column.name,
                _arrow_type(pa, column.name),
                metadata={"unit": column.unit, "meaning": column.description},
            )
            for column in table.columns
        ],
        metadata={"title": table.title, "fingerpad": table.version},
    )
    with parquet.ParquetWriter(file, schema, compression="zstd") as writer:
        for batch in table.batches():
            arrays = [pa.array(batch[field.name], type=field.type, from_pandas=True) for field in schema]
            writer.write_table(pa.table(arrays, schema=schema))


def _arrow_type(pa: Any, name: str) -> Any:
    kinds = {TEXT_COLUMNS: pa.string(), BOOL_COLUMNS: pa.bool_(), INT_COLUMNS: pa.int64()}
    return next((kind for names, kind in kinds.items() if name in names), pa.float64())


def _write_mat(table: ResultsTable, file: Path) -> None:
    """Write structs `results`, `units`, `meanings` and `study`, with one field for each column."""
    illegal = [column.name for column in table.columns if not _MATLAB_NAME.fullmatch(column.name)]
    if illegal:
        raise FingerpadError(f"MATLAB takes no field named {illegal[0]}: letters, digits and _, 63 at most")
    batches = list(table.batches())
    content = {
        "results": {
            column.name: _matlab_column(np.concatenate([batch[column.name] for batch in batches]))
            for column in table.columns
        },
        "units": {column.name: column.unit for column in table.columns},
        "meanings": {column.name: column.description for column in table.columns},
        "study": {"title": table.title, "fingerpad": table.version},
    }
    with file.open("wb") as target:
        io.savemat(target, content, long_field_names=True, oned_as="column", do_compression=True)


def _matlab_column(values: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return a column as MATLAB has it: doubles, logicals, or a character matrix with one line for each row.

    A cell array would take a hundred times as long to write and read; ``cellstr`` makes one.
    """
    if values.dtype != object:
        return values.reshape(-1, 1)
    return np.array([word or " " for word in values], dtype=np.str_)


_FORMATS: Final[Mapping[str, Callable[[ResultsTable, Path], None]]] = {
    ".parquet": _write_parquet,
    ".mat": _write_mat,
}
