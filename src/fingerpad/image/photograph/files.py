"""Outlines and marks read from files."""

from os import PathLike
from pathlib import Path

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad._columns import columns_named_by, read_columns
from fingerpad.exceptions import ImageError, LoadingError


def read_outline(path: str | PathLike[str]) -> FloatArray:
    r"""Read outline points from a CSV file with columns like ``x_mm, y_mm`` or ``X [um], Y [um]``.

    Parameters
    ----------
    path : path-like
        The file.

    Returns
    -------
    ndarray, shape (n, 2)
        Points (x, y), mm.

    Raises
    ------
    ImageError
        If the file cannot be opened, lacks a column, or holds anything but finite numbers; the message names
        file, column and line.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "outline.csv")
    ...     _ = path.write_text("x_mm,y_mm\n11.8,0\n0,13.8\n")
    ...     read_outline(path)
    array([[11.8,  0. ],
           [ 0. , 13.8]])
    """
    return _read_points(Path(path), "x", "y")


def read_marks(path: str | PathLike[str]) -> FloatArray:
    r"""Read marks on a picture from a CSV file with the columns ``row_px`` and ``column_px``.

    Parameters
    ----------
    path : path-like
        The file.

    Returns
    -------
    ndarray, shape (n, 2)
        Marks (row, column), px.

    Raises
    ------
    ImageError
        As `read_outline`.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "marks.csv")
    ...     _ = path.write_text("row_px,column_px\n24,200\n300,436\n")
    ...     read_marks(path)
    array([[ 24., 200.],
           [300., 436.]])
    """
    return _read_points(Path(path), "row", "column")


def _read_points(path: Path, first: str, second: str) -> FloatArray:
    try:
        with columns_named_by(lambda _: ""):  # nothing else names them
            found = read_columns(path, (first, second))
    except LoadingError as error:
        raise ImageError(str(error)) from error
    return np.column_stack([found[first], found[second]])
