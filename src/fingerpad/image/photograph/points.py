"""Outlines of faces given as points, and the files of points and marks."""

from __future__ import annotations

import math
from os import PathLike
from pathlib import Path

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array
from fingerpad._columns import columns_named_by, read_columns
from fingerpad.exceptions import FitError, ImageError, LoadingError
from fingerpad.image.ellipse import PlaneEllipse
from fingerpad.image.ellipse_fit import fit_aligned_ellipse
from fingerpad.image.photograph.arc import PAD_MIDDLE, turns_from
from fingerpad.image.photograph.calibration import DOUBT
from fingerpad.image.photograph.face_arc import FaceArc, face_from_arc, outline_points
from fingerpad.image.photograph.faces import Face, FaceSemiAxes
from fingerpad.image.photograph.result import size_flags
from fingerpad.image.scale import Scale

# From so many points on an outline shows whether it is an ellipse.
_MIN_POINTS = 16
# Points of an outline digitised by hand err each on its own; of one traced closely neighbours share errors.
_INDEPENDENT_POINTS, _MOST_ALIKE = 60, 8
# An outline laid along its axes by eye.
_UPRIGHT_STD = math.radians(2.0)
# Shared errors of photographs are in pixels: those of an outline are taken as of a photograph so fine.
_UNIT = Scale(0.05)


def face_from_outline(face: Face, points: ArrayLike, relative_scale_std: float = 0.0) -> FaceSemiAxes:
    """Fit the two semi-axes that the outline of one face shows.

    All points are taken for pad. As in a photograph, a superellipse is compared with the ellipse, and what
    their semi-axes differ by stands in the covariance. The points' own scatter gives their errors, those that
    neighbours share included; the axes are taken to lie along x and y within 2 degrees. Fewer than 16 points
    do not tell whether the outline is an ellipse: 8 percent are added to each semi-axis.

    Parameters
    ----------
    face : {"palmar", "distal", "radial", "ulnar"}
        The face that looks at the camera.
    points : array_like, shape (n, 2)
        Outline points, mm. ``palmar``: x across the finger (radial–ulnar), y along it (distal). ``distal``,
        the fingertip seen end on: x across (radial–ulnar), y palmar. ``radial`` or ``ulnar``, a side:
        x palmar, y along the finger (distal).
    relative_scale_std : float
        Relative standard uncertainty of the photograph's scale.

    Returns
    -------
    FaceSemiAxes
        Across and along, mm, with their covariance, and flags by their codes in `fingerpad.flags`.

    Raises
    ------
    FitError
        If the outline gives no ellipse, leaves an axis unknown by 40 percent, or fits one without a residual
        to estimate its uncertainty.

    Examples
    --------
    >>> from fingerpad.simulate import outline_points
    >>> face = face_from_outline("palmar", outline_points(11.8, 13.8, noise_std=0.05, seed=1))
    >>> face.semi_axes.round(1).tolist()
    [11.8, 13.8]
    """
    try:
        fit = fit_aligned_ellipse(points)
    except FitError as error:
        raise FitError(f"outline of the {face} face: {error}") from error
    if not np.isfinite(fit.covariance).all():
        raise FitError(f"outline of the {face} face: four points leave no residual: mark five points or more")
    semi_axes = fit.ellipse.semi_axes
    covariance = fit.covariance[2:4, 2:4] + np.diag((DOUBT.rough_std * semi_axes) ** 2)
    flags = size_flags(semi_axes) | {"few_points"}
    if len(as_float_array(points)) >= _MIN_POINTS:
        try:
            found = face_from_arc(_arc(face, as_float_array(points), fit.ellipse))
        except FitError as error:
            raise FitError(f"outline of the {face} face: {error}") from error
        semi_axes, covariance, flags = found.semi_axes, found.edge_covariance, found.flags
    return FaceSemiAxes(
        face=face,
        semi_axes=semi_axes,
        covariance=covariance,
        relative_scale_std=relative_scale_std,
        flags=flags,
    )


def _arc(face: Face, points: FloatArray, ellipse: PlaneEllipse) -> FaceArc:
    """Return the arc that is all of an outline, whose points, mm, may come in any order."""
    order = np.argsort(turns_from(PAD_MIDDLE[face], points, ellipse.parameters), kind="stable")
    return FaceArc(
        face=face,
        points=outline_points(points[order] / _UNIT.mm_per_px),
        scale=_UNIT,
        frame=(np.eye(2), np.zeros(2)),
        tilt=(0.0, _UPRIGHT_STD),
        start=ellipse.parameters / [*(4 * [_UNIT.mm_per_px]), 1.0],
        alike=min(max(len(points) // _INDEPENDENT_POINTS, 1), _MOST_ALIKE),
    )


def read_outline(path: str | PathLike[str]) -> FloatArray:
    r"""Read outline points from a table with columns like ``x_mm, y_mm`` or ``X [um], Y [um]``.

    Parameters
    ----------
    path : path-like
        A CSV, XLSX, MAT or TDMS file.

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
    """Read marks (row, column), px, from a table with the columns ``row_px`` and ``column_px``."""
    return _read_points(Path(path), "row", "column")


def _read_points(path: Path, first: str, second: str) -> FloatArray:
    try:
        with columns_named_by(lambda _: ""):  # nothing else names them
            found = read_columns(path, (first, second))
    except LoadingError as error:
        raise ImageError(str(error)) from error
    return np.column_stack([found[first], found[second]])
