"""Faces of a finger by hand: ellipses placed in a photograph, changes to its outline, outlines as points."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path

import numpy as np

from fingerpad._arrays import (
    ArrayLike,
    BoolArray,
    FloatArray,
    as_float_array,
    finite_angle,
    finite_pair,
    real_array,
    real_number,
)
from fingerpad._columns import columns_named_by, read_columns
from fingerpad.exceptions import FitError, ImageError, LoadingError
from fingerpad.image.ellipse import PlaneEllipse, nearest_on_sides
from fingerpad.image.ellipse_fit import fit_aligned_ellipse
from fingerpad.image.photograph.arc import PAD_MIDDLE, FaceArc, outline_points, turns_from
from fingerpad.image.photograph.calibration import DOUBT
from fingerpad.image.photograph.faces import (
    Direction,
    Face,
    FaceSemiAxes,
    check_face,
    face_axes,
    palmar_directions,
)
from fingerpad.image.photograph.result import PhotographFit, face_from_arc, photograph_fit, size_flags
from fingerpad.image.scale import Scale, ScaleLike, as_scale

# An ellipse within so much of the outline, as a share of its smaller semi-axis, passes for a good one to the
# eye (as to the flag `poor_ellipse`), and a mark is placed to a pixel: at the centre and at each end.
_BY_EYE, _MARK_PX = 0.01, 1.0
# No picture reaches so far, px.
_FARTHEST_PX = 1e6
# From so many points on an outline shows whether it is an ellipse.
_MIN_POINTS = 16
# Points of an outline digitised by hand err each on its own; of one traced closely neighbours share errors.
_INDEPENDENT_POINTS, _MOST_ALIKE = 60, 8
# An outline laid along its axes by eye.
_UPRIGHT_STD = math.radians(2.0)
# Shared errors of photographs are in pixels: those of an outline are taken as of a photograph so fine.
_UNIT = Scale(0.05)


def photograph_from_ellipse(
    face: Face,
    scale: ScaleLike,
    *,
    centre: tuple[float, float],
    semi_axes: tuple[float, float],
    tilt: float = 0.0,
    tip: Direction = "up",
    palmar: Direction | None = None,
) -> PhotographFit:
    """Return a face's semi-axes from an ellipse placed manually, px; it needs no picture.

    `semi_axes` are across and along, `centre` is (row, column), `tilt` goes from across to along, radians.
    """
    centre, semi_axes = (
        finite_pair(value, name, ImageError) for name, value in (("centre", centre), ("semi_axes", semi_axes))
    )
    if not min(semi_axes) > 0:
        raise ImageError(f"an ellipse needs two positive semi-axes, found {semi_axes}")
    tilt = finite_angle("tilt", tilt)
    scale = as_scale(scale)
    side = palmar_directions(face, tip, palmar)[0]
    ellipse, middle = PlaneEllipse(0.0, 0.0, *semi_axes, tilt), PAD_MIDDLE[face]
    own_std = math.hypot(_MARK_PX, _BY_EYE * min(semi_axes))
    tilt_std = own_std / max(semi_axes)
    arc = FaceArc(  # without points yet
        face=face,
        scale=scale,
        frame=(face_axes(face, tip, side), as_float_array(centre)),
        tilt=(tilt, tilt_std),
        points=outline_points(np.empty((0, 2))),
        start=ellipse.parameters,
    )
    terms = {"placement": 2 * (own_std * scale.mm_per_px) ** 2 * np.eye(2)}
    found = photograph_fit(arc, ellipse, terms, tilt_std, (middle - math.pi, middle + math.pi))
    return replace(found, flags=size_flags(found.semi_axes) | {"fitted_manually"})


def photograph_from_handles(
    face: Face,
    scale: ScaleLike,
    *,
    centre: tuple[float, float],
    across_end: tuple[float, float],
    along_end: tuple[float, float],
    tip: Direction = "up",
    palmar: Direction | None = None,
) -> PhotographFit:
    """Return the ellipse of a face from the ends of its semi-axes, marked manually; it needs no picture.

    The ends need not be at right angles: the ellipse is turned as the longer of the two is.

    Parameters
    ----------
    face, scale, tip, palmar
        As for `photograph_from_ellipse`.
    centre, across_end, along_end : (float, float)
        (row, column), px, as `PhotographFit.handles` gives them.

    Returns
    -------
    PhotographFit
        Without points, with the flag ``fitted_manually``.

    Examples
    --------
    >>> fit = photograph_from_handles(
    ...     "palmar", 0.05, centre=(300, 200), across_end=(300, 436), along_end=(24, 200)
    ... )
    >>> {name: round(value, 2) for name, value in fit.semi_axes_mm.items()}, round(fit.tilt, 6) + 0.0
    ({'radial_ulnar': 11.8, 'distal': 13.8}, 0.0)
    """
    ends = np.subtract(
        [finite_pair(across_end, "across_end", ImageError), finite_pair(along_end, "along_end", ImageError)],
        finite_pair(centre, "centre", ImageError),
    )
    across, along = np.linalg.norm(ends, axis=1).tolist()
    axes = face_axes(face, tip, palmar_directions(face, tip, palmar)[0])
    first, second = axes @ ends[0 if across >= along else 1]
    tilt = math.atan2(second, first) if across >= along else math.atan2(-first, second)
    return photograph_from_ellipse(
        face, scale, centre=centre, semi_axes=(across, along), tilt=tilt, tip=tip, palmar=palmar
    )


def with_marked_points(
    found: PhotographFit, *, added: ArrayLike = (), erased: Sequence[tuple[ArrayLike, float]] = ()
) -> PhotographFit:
    """Fit the ellipse again with points added to the outline or erased from it, (row, column), px.

    Fit, uncertainty and flags are those that `measure_photograph` gives for the arc as it is then; several
    changes one after another are the same as all at once. `erased` are strokes of an eraser, each with its
    radius, px; where one takes the end of the arc, the pad ends there.
    """
    marks = _check_points("added points", added)
    arc = found._arc
    places = arc.in_picture(arc.xy)
    gone = np.zeros(len(places), dtype=bool)
    for path, radius in erased:
        gone |= _points_under_stroke(places, path, radius)
    if not len(marks) and not (gone & (arc.points["pad"] | arc.searched)).any():
        return found
    return replace(face_from_arc(arc.without(gone).with_marks(marks)), picture=found.picture)


def _check_points(what: str, points: ArrayLike) -> FloatArray:
    values = real_array(points, what, ImageError)
    values = values.reshape(0, 2) if values.size == 0 else values
    if values.ndim != 2 or values.shape[1] != 2 or not (np.abs(values) <= _FARTHEST_PX).all():
        raise ImageError(
            f"{what} must be finite pairs (row, column) within {_FARTHEST_PX:.0f} px, "
            f"found shape {values.shape}"
        )
    return values


def _points_under_stroke(points: FloatArray, stroke: ArrayLike, radius: float) -> BoolArray:
    """Return which points lie under a stroke of a rubber."""
    path = _check_points("a stroke", stroke)
    if not (len(path) and 0 < real_number(radius, "radius", ImageError) < math.inf):
        raise ImageError(f"a stroke needs a point and a positive radius, found {len(path)} and {radius}")
    sides = (path, path) if len(path) == 1 else (path[:-1], path[1:])
    off = points[:, None] - nearest_on_sides(points[:, None], *sides)
    return np.asarray(np.linalg.norm(off, axis=2).min(axis=1) <= radius)


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
    check_face(face, FitError)
    try:
        found = _face_of_points(face, as_float_array(points, "points", FitError))
    except FitError as error:
        raise FitError(f"outline of the {face} face: {error}") from error
    return replace(found, relative_scale_std=relative_scale_std)


def _face_of_points(face: Face, points: FloatArray) -> FaceSemiAxes:
    fit = fit_aligned_ellipse(points)
    if not np.isfinite(fit.covariance).all():
        raise FitError("four points leave no residual: mark five points or more")
    if len(points) >= _MIN_POINTS:
        return face_from_arc(_arc(face, points, fit.ellipse)).face_semi_axes
    semi_axes = fit.ellipse.semi_axes
    covariance = fit.covariance[2:4, 2:4] + np.diag((DOUBT.rough_std * semi_axes) ** 2)
    flags = size_flags(semi_axes) | {"few_points"}
    return FaceSemiAxes(face=face, semi_axes=semi_axes, covariance=covariance, flags=flags)


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
