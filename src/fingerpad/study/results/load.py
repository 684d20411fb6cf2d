"""The results of a finished run, read back: as a table, as one pad, as a file for another program.

What a table does not need is imported when something else is asked for: it would take a third of the memory.
"""

import csv
import html
import math
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import chain, islice
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import pandas as pd

from fingerpad._csv import unescape_formula
from fingerpad.exceptions import FingerpadError
from fingerpad.study.results.result_set import RERUN, require_result_set
from fingerpad.study.results.summary_file import PlacementRecord, SummaryFile, reading
from fingerpad.study.results.table import (
    COLUMNS,
    DEFAULT_COLUMNS,
    Column,
    ColumnArray,
    DType,
    records,
    table_of,
)
from fingerpad.units import KPA_PER_MPA

if TYPE_CHECKING:
    from fingerpad.contact import Tissue
    from fingerpad.geometry import Placement

# Of the sentences, one for each finger and wedge, where no notebook shows all.
_MOST_SHOWN: Final = 12
# The cells of so many rows take some megabytes.
_ROWS_AT_ONCE: Final = 1000
_CONVERT: Final[Mapping[DType, Callable[[str], Any]]] = {
    "text": unescape_formula,
    "bool": {"true": True, "false": False}.__getitem__,
    "int": int,
    "float": float,
}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Results:
    """The results of a finished run.

    Attributes
    ----------
    table : DataFrame
        ``results.csv``: one row per contact, and per frame in contact. Units of its columns are in
        ``table.attrs["units"]``. Text has None for empty cells, numbers have NaN, the number of a frame is
        Int64.
    summary : SummaryFile
        ``summary.json``: semi-axes of fingers, pooled radii, verdicts, loading curves and more.
    """

    table: pd.DataFrame
    summary: SummaryFile

    @property
    def title(self) -> str:
        """The study's title."""
        return self.summary.title

    def __repr__(self) -> str:
        """Return how large it is, and what was found: the sentences with which the report begins."""
        found = self._sentences()
        more = [f"and {len(found) - _MOST_SHOWN} more"] if len(found) > _MOST_SHOWN else []
        return "\n".join([f"<{self._size()}>", *found[:_MOST_SHOWN], *more])

    def _repr_html_(self) -> str:
        """Return the same for a notebook, with all sentences."""
        lines = "".join(f"<li>{html.escape(sentence)}</li>" for sentence in self._sentences())
        return f"<strong>{html.escape(self.title)}</strong><ul>{lines}</ul>{html.escape(self._size())}"

    def _size(self) -> str:
        rows, columns = self.table.shape
        return f"Results of {self.title!r}: {rows} rows, {columns} columns"

    def _sentences(self) -> list[str]:
        from fingerpad.study.results.output import answers

        return [one.sentence for one in answers(self.summary.summaries, self.summary.by_load)]


def load_results(folder: str | PathLike[str]) -> Results:
    """Read the results of a finished run.

    Parameters
    ----------
    folder : path-like
        Output folder of the run.

    Returns
    -------
    Results
        Its ``table`` is a pandas DataFrame with one row per contact; ``summary`` holds what was pooled. Shown,
        it says one sentence for each finger and wedge.

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
    return Results(table=read_rows(Path(folder)), summary=SummaryFile.read(Path(folder)))


def read_rows(folder: Path) -> pd.DataFrame:
    """Return all rows of a finished run, with the columns' units in ``attrs``."""
    names = read_header(folder)
    table = table_of(read_batches(folder, _ROWS_AT_ONCE), names)
    table.attrs["units"] = {name: COLUMNS[name].unit for name in names}
    return table


def read_header(folder: Path) -> tuple[str, ...]:
    """Return the columns of a finished run: all, or those that a run writes by default."""
    path = folder / "results.csv"
    with reading(path), path.open(newline="", encoding="utf-8") as file:
        names = tuple(next(csv.reader(file), ()))
    if names not in {DEFAULT_COLUMNS, tuple(COLUMNS)}:
        raise FingerpadError(f"{path}: its columns are not those of this version; {RERUN}")
    return names


def read_batches(folder: Path, size: int) -> Iterator[dict[str, ColumnArray]]:
    """Yield the rows of a finished run by column, `size` at a time, so that memory stays flat."""
    columns, path = [COLUMNS[name] for name in read_header(folder)], folder / "results.csv"
    with reading(path), path.open(newline="", encoding="utf-8") as file:
        reader = csv.reader(file)
        next(reader)
        while rows := list(islice(reader, size)):
            where = f"{path}, before line {reader.line_num}"
            if any(len(row) != len(columns) for row in rows):
                raise FingerpadError(f"{where}: a row has more or fewer cells than the header; {RERUN}")
            cells = zip(columns, zip(*rows, strict=True), strict=True)
            yield {column.name: _array(column, some, where) for column, some in cells}


def _array(column: Column, cells: tuple[str, ...], where: str) -> ColumnArray:
    """Return the cells of a column as an array."""
    convert = _CONVERT[column.dtype]
    try:
        array = column.array(convert(cell) if cell or column.dtype == "bool" else None for cell in cells)
    except (ValueError, KeyError, OverflowError) as error:
        raise FingerpadError(
            f"{where}: {column.name} holds what is no {column.dtype} ({error}); {RERUN}"
        ) from error
    if column.dtype == "float" and np.isinf(array).any():
        raise FingerpadError(f"{where}: {column.name} holds an infinite number; {RERUN}")
    return array


_CLOSE: Final = 1e-6  # degrees


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredPad:
    """A pad at its placement, its tissue, standard uncertainties by name, and where all that is from."""

    placement: "Placement"
    tissue: "Tissue"
    stds: dict[str, float]
    source: str


def measured_pad(
    folder: Path,
    *,
    finger: str | None,
    wedge_deg: float,
    thickness_mm: float | None = None,
    poisson_ratio: float | None = None,
) -> MeasuredPad:
    """Return a finger at one angle, with E of a loading curve, or of the area at the highest load.

    Thickness and Poisson's ratio are by default those of the run. Where others are given, E is that of the
    area: a curve tells it for its own alone.
    """
    from fingerpad.contact import Tissue
    from fingerpad.image import SEMI_AXES
    from fingerpad.study.measuring.fingers import pad_placement

    require_result_set(folder)
    summary = SummaryFile.read(folder)
    found = _placed(summary, folder, finger, wedge_deg)
    poisson_ratio = summary.poisson_ratio if poisson_ratio is None else poisson_ratio
    axes = summary.finger(found.finger)
    if axes is None or math.isnan(axes.palmar_mm):
        raise FingerpadError(f"{folder}: the semi-axes of {found.finger} are not known there")
    placement = pad_placement(axes.semi_axes_mm, found.wedge_angle_deg, found.roll_angle_deg)
    stds = dict(zip(SEMI_AXES, np.sqrt(np.diagonal(axes.covariance_mm2)).tolist(), strict=True))
    layers = [
        curve.layer
        for curve in summary.curves
        if curve.layer is not None
        and (curve.finger, curve.wedge_angle_deg, curve.synthetic)
        == (found.finger, found.wedge_angle_deg, found.synthetic)
        and not math.isnan(curve.layer.thickness_mm + curve.layer.youngs_modulus_kpa)
    ]
    if layers and thickness_mm is None and poisson_ratio == summary.poisson_ratio:
        best = min(layers, key=lambda layer: layer.thickness_mm_std / layer.thickness_mm)
        modulus, modulus_std = best.youngs_modulus_kpa, best.youngs_modulus_kpa_std
        thickness, thickness_std = best.thickness_mm, best.thickness_mm_std
        source = "E and thickness are those of its loading curve"
    else:
        stated = found.on_layer
        thickness, thickness_std = math.inf, 0.0
        if thickness_mm is not None:
            thickness = thickness_mm
        elif stated is not None:
            thickness, thickness_std = stated.effective_thickness_mm, stated.effective_thickness_mm_std
        modulus, modulus_std, load = _of_contacts(summary, found, placement, thickness, poisson_ratio)
        deep = "deep tissue" if math.isinf(thickness) else f"{thickness:g} mm of tissue"
        source = f"E is that of {deep} with the contact area seen at {load:g} N"
    stds |= {"youngs_modulus": modulus_std / KPA_PER_MPA, "thickness": thickness_std}
    roll = f", roll {found.roll_angle_deg:g}°" if found.roll_angle_deg else ""  # of several the smallest
    return MeasuredPad(
        placement=placement,
        tissue=Tissue(modulus / KPA_PER_MPA, poisson_ratio, thickness),
        stds={name: std for name, std in stds.items() if std > 0},
        source=f"{found.finger} at {found.wedge_angle_deg:g}°{roll}: {source}",
    )


def _placed(summary: SummaryFile, folder: Path, finger: str | None, wedge_deg: float) -> PlacementRecord:
    """Return the one record of a finger at an angle, or say which there are."""
    known = sorted({one.finger for one in summary.summaries})
    if finger is None and len(known) == 1:
        finger = known[0]
    if finger is None or finger not in known:
        what = "name one" if finger is None else f"found no finger {finger!r}"
        raise FingerpadError(f"{folder}: {what}; it has {', '.join(known) or 'none'}")
    placed = [one for one in summary.summaries if one.finger == finger]
    at = [one for one in placed if abs(one.wedge_angle_deg - wedge_deg) < _CLOSE]
    if not at:
        angles = ", ".join(f"{angle:g}°" for angle in sorted({one.wedge_angle_deg for one in placed}))
        raise FingerpadError(f"{folder}: {finger} was not pressed at {wedge_deg:g}°; it was at {angles}")
    return min(at, key=lambda one: (one.synthetic, abs(one.roll_angle_deg)))


def _of_contacts(
    summary: SummaryFile,
    found: PlacementRecord,
    placement: "Placement",
    thickness: float,
    poisson_ratio: float,
) -> tuple[float, float, float]:
    """Return E, kPa, its standard uncertainty, and the load of the contacts that give it."""
    from fingerpad.contact import youngs_modulus

    seen = [one for one in summary.by_load if one.key == found.key and not math.isnan(one.contact_area_mm2)]
    for one in sorted(seen, key=lambda one: -one.load_N):
        modulus = KPA_PER_MPA * float(
            youngs_modulus(
                placement,
                load=one.load_N,
                area=one.contact_area_mm2,
                thickness=thickness,
                poisson_ratio=poisson_ratio,
            )
        )
        if not math.isnan(modulus):
            relative = one.youngs_modulus_kpa_std / one.youngs_modulus_kpa
            return modulus, 0.0 if math.isnan(relative) else relative * modulus, one.load_N
    raise FingerpadError(
        f"{found.finger} at {found.wedge_angle_deg:g}°: neither a loading curve nor a contact "
        "within the range of the laws gives its modulus: add a loading curve to the study, or give fingerpad "
        "simulator --semi-axes-mm and --youngs-modulus-kpa in place of the folder"
    )


_ROW_GROUP: Final = 5000
# Below the header.
_MOST_SHEET_ROWS: Final = 1_048_575


def export_results(folder: str | PathLike[str], file: str | PathLike[str]) -> None:
    """Write the results of a finished run into one file, in the format that its suffix names."""
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
    from scipy import io

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
    """Return doubles, logicals, or a character matrix: cells would take a hundred times as long."""
    if column.dtype == "text":
        return np.array([word or " " for word in values], dtype=np.str_)
    numbers = values.to_numpy(bool if column.dtype == "bool" else float, na_value=np.nan)
    return np.asarray(numbers).reshape(-1, 1)


def _write_xlsx(folder: Path, study: dict[str, str], file: Path) -> None:
    """Write the sheets `results`, `columns` and `study`, row by row: memory stays flat."""
    from xlsxwriter import Workbook

    table = read_rows(folder)
    if len(table) > _MOST_SHEET_ROWS:
        raise FingerpadError(
            f"a sheet of Excel has {_MOST_SHEET_ROWS} rows at most, these results {len(table)}"
        )
    columns = [COLUMNS[name] for name in table]
    sheets: dict[str, Iterable[Iterable[Any]]] = {
        "results": chain([table], (row.values() for row in records(table))),
        "columns": [("column", "unit", "meaning"), *((one.name, one.unit, one.meaning) for one in columns)],
        "study": study.items(),
    }
    plain = {"constant_memory": True, "strings_to_formulas": False, "strings_to_urls": False}
    with file.open("wb") as target, Workbook(target, plain) as book:
        for name, rows in sheets.items():
            sheet = book.add_worksheet(name)
            sheet.freeze_panes(1, 1)
            for number, row in enumerate(rows):
                sheet.write_row(number, 0, row)


_FORMATS: Final[Mapping[str, Callable[[Path, dict[str, str], Path], None]]] = {
    ".parquet": _write_parquet,
    ".mat": _write_mat,
    ".xlsx": _write_xlsx,
}
