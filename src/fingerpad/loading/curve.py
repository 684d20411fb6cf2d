"""Loading curves as tables of force, displacement and contact area."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from fingerpad._arrays import FloatArray
from fingerpad._columns import read_columns


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LoadingCurve:
    """One record of a finger pad pressed against a platen, row by row.

    Attributes
    ----------
    load : ndarray
        Normal force W, N.
    indentation : ndarray
        Displacement of the platen ξ, mm, from whatever zero the instrument had.
    area : ndarray or None
        Contact area A, mm², where it was measured.
    """

    load: FloatArray
    indentation: FloatArray
    area: FloatArray | None


def read_loading_curve(path: Path, columns: Mapping[str, str] | None = None) -> LoadingCurve:
    """Read a loading curve from a CSV file.

    The header names a quantity and its unit, as in ``force_N, displacement_mm, area_mm2``; ``force_mN`` or
    ``displacement_um`` are converted. Columns of other names are left alone.

    Parameters
    ----------
    path : Path
        The CSV file, with a header line.
    columns : mapping, optional
        From a quantity (``force``, ``displacement``, ``area``) to ``"HEADER:UNIT"`` where the file's own
        headers differ.

    Raises
    ------
    LoadingError
        If the file cannot be read, a column is missing or has an unknown unit, or a cell is not a finite
        number. The message names file, column and line.
    """
    found = read_columns(path, ("force", "displacement"), ("area",), columns=columns)
    return LoadingCurve(load=found["force"], indentation=found["displacement"], area=found.get("area"))
