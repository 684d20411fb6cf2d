"""Semi-axes of the finger pad from the outlines seen in photographs of its faces.

Each face shows two of the three semi-axes, so that two faces give one of them twice and three faces each of
them twice: the joint estimate is over-determined, and the disagreement is reported.
"""

import csv
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Literal, TypeAlias

import numpy as np
from scipy.stats import chi2

from fingerpad._arrays import ArrayLike, FloatArray
from fingerpad.exceptions import FitError, ImageError
from fingerpad.image.ellipse_fit import fit_aligned_ellipse

Face: TypeAlias = Literal["palmar", "distal", "radial", "ulnar"]

SEMI_AXES = ("palmar", "distal", "radial_ulnar")
# The semi-axes that (x, y), that is (across, along), show in a photograph of each face.
FACE_AXES: Mapping[Face, tuple[str, str]] = {
    "palmar": ("radial_ulnar", "distal"),
    "distal": ("radial_ulnar", "palmar"),
    "radial": ("palmar", "distal"),
    "ulnar": ("palmar", "distal"),
}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FaceSemiAxes:
    """The two semi-axes that one face shows, however they were measured.

    Attributes
    ----------
    face : Face
        The face that looked at the camera.
    semi_axes : ndarray, (2,)
        Semi-axes across and along, in the order of `FACE_AXES`, mm.
    covariance : ndarray, (2, 2)
        Their covariance without the scale's share, mm².
    relative_scale_std : float
        Relative standard uncertainty of the picture's scale, independent of other pictures'.
    """

    face: Face
    semi_axes: FloatArray
    covariance: FloatArray
    relative_scale_std: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class OutlineSemiAxes:
    """Semi-axes of a finger pad from two or more of its faces.

    Attributes
    ----------
    palmar, distal, radial_ulnar : float
        Semi-axes, mm, never sorted.
    covariance : ndarray, (3, 3)
        Their covariance in that order, mm².
    chi_square : float
        Weighted sum of squares of the disagreement between the faces, zero when nothing is over-determined.
    degrees_of_freedom : int
        Number of semi-axis values beyond the three that are needed.
    p_value : float
        Chance of at least this disagreement if the stated uncertainties are right, NaN without freedom.
    faces : tuple of FaceSemiAxes
        What was combined.
    """

    palmar: float
    distal: float
    radial_ulnar: float
    covariance: FloatArray
    chi_square: float
    degrees_of_freedom: int
    p_value: float
    faces: tuple[FaceSemiAxes, ...]

    @property
    def stds(self) -> FloatArray:
        """Standard uncertainties of (palmar, distal, radial_ulnar), mm."""
        return np.sqrt(np.diagonal(self.covariance))

    @property
    def disagreements(self) -> tuple[dict[str, float], ...]:
        """What each face says beyond the joint semi-axes, by anatomical name, relative to them."""
        joint = dict(zip(SEMI_AXES, (self.palmar, self.distal, self.radial_ulnar), strict=True))
        return tuple(
            {
                name: float(value) / joint[name] - 1
                for name, value in zip(FACE_AXES[one.face], one.semi_axes, strict=True)
            }
            for one in self.faces
        )


def semi_axes_from_outlines(
    outlines: Mapping[Face, ArrayLike], *, relative_scale_std: float = 0.0
) -> OutlineSemiAxes:
    """Combine the outlines of two or more faces into the three semi-axes.

    Each outline is fitted with an ellipse along its own x and y, of free centre; the semi-axes are then
    combined by generalised least squares.

    Parameters
    ----------
    outlines : mapping from face to array_like, (n, 2)
        Outline points, mm, by face. ``palmar``: x across the finger (radial–ulnar), y along it (distal).
        ``distal``, the fingertip seen end on: x across (radial–ulnar), y palmar. ``radial`` or ``ulnar``, a
        side: x palmar, y along the finger (distal).
    relative_scale_std : float
        Relative standard uncertainty of each photograph's scale, independent between photographs.

    Returns
    -------
    OutlineSemiAxes

    Raises
    ------
    FitError
        If an outline gives no ellipse, fits one without a residual to tell its uncertainty, or no face shows
        one of the semi-axes.

    Examples
    --------
    >>> from fingerpad.image import outline_points
    >>> found = semi_axes_from_outlines(
    ...     {
    ...         "palmar": outline_points(11.8, 13.8, noise_std=0.05, seed=1),
    ...         "distal": outline_points(11.8, 7.9, noise_std=0.05, seed=2),
    ...         "radial": outline_points(7.9, 13.8, noise_std=0.05, seed=3),
    ...     }
    ... )
    >>> round(found.palmar, 1), round(found.distal, 1), round(found.radial_ulnar, 1), found.degrees_of_freedom
    (7.9, 13.8, 11.8, 3)
    """
    if not (math.isfinite(relative_scale_std) and relative_scale_std >= 0):
        raise FitError(f"relative_scale_std must be zero or positive, and finite, found {relative_scale_std}")
    return combine_faces(
        [face_from_outline(face, points, relative_scale_std) for face, points in outlines.items()]
    )


def combine_faces(
    faces: Iterable[FaceSemiAxes], *, shared_relative_scale_std: float = 0.0
) -> OutlineSemiAxes:
    """Combine the semi-axes that two or more faces show into the three of the finger pad.

    Generalised least squares. Faces that disagree by more than they may are still combined: `chi_square`,
    `p_value` and `disagreements` of the result say so, and nothing is widened to hide it.

    Parameters
    ----------
    faces : iterable of FaceSemiAxes
        Semi-axes by face; a face may come more than once, from several photographs.
    shared_relative_scale_std : float
        Relative standard uncertainty of a scale that all pictures share, as of one ruler or a fixed camera.
        It widens the result and excuses no disagreement.

    Returns
    -------
    OutlineSemiAxes

    Raises
    ------
    FitError
        If no face shows one of the semi-axes, or a covariance or scale is not one.

    Examples
    --------
    >>> def seen(face, *semi_axes):
    ...     return FaceSemiAxes(face=face, semi_axes=np.array(semi_axes), covariance=0.01 * np.eye(2))
    >>> faces = [seen("palmar", 11.8, 13.8), seen("distal", 11.8, 7.9), seen("radial", 8.0, 13.7)]
    >>> found = combine_faces(faces)
    >>> round(found.palmar, 3), round(found.distal, 3), found.degrees_of_freedom, round(found.p_value, 2)
    (7.95, 13.75, 3, 0.8)
    """
    given = tuple(faces)
    _require_std("shared_relative_scale_std", shared_relative_scale_std)
    for one in given:
        _require_face(one)
    _require_every_axis(given)
    return _combined(given, shared_relative_scale_std)


def read_outline(path: str | PathLike[str]) -> FloatArray:
    """Read outline points from a CSV file with the columns ``x_mm`` and ``y_mm``.

    Returns
    -------
    ndarray, (n, 2)
        Points (x, y), mm.

    Raises
    ------
    ImageError
        If the file cannot be opened, lacks a column, or holds anything but finite numbers; the message names
        file, column and line.
    """
    return _read_points(Path(path), ("x_mm", "y_mm"))


def read_marks(path: str | PathLike[str]) -> FloatArray:
    """Read marks on a picture from a CSV file with the columns ``row_px`` and ``column_px``.

    Returns
    -------
    ndarray, (n, 2)
        Marks (row, column), px.

    Raises
    ------
    ImageError
        As `read_outline`.
    """
    return _read_points(Path(path), ("row_px", "column_px"))


def _read_points(path: Path, columns: tuple[str, str]) -> FloatArray:
    titles = ",".join(columns)
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            reader = csv.DictReader(file, skipinitialspace=True)
            header = [name.strip() for name in reader.fieldnames or ()]
            for column in columns:
                if column not in header:
                    raise ImageError(
                        f"{path}: line 1: no column {column}, found {', '.join(header) or 'nothing'}: "
                        f"begin the file with {titles}"
                    )
            reader.fieldnames = header
            points = [
                [_number(path, reader.line_num, column, row[column]) for column in columns] for row in reader
            ]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise ImageError(
            f"{path}: cannot be read as points ({error}): give a CSV file with {titles}"
        ) from error
    if not points:
        raise ImageError(f"{path}: holds no points: put one on each line below {titles}")
    return np.asarray(points, dtype=np.float64)


def _number(path: Path, line: int, column: str, text: str | None) -> float:
    try:
        value = float(text or "")
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ImageError(
            f"{path}: line {line}: {column} must be a finite number, found {text!r}: correct or remove it"
        )
    return value


def face_from_outline(face: Face, points: ArrayLike, relative_scale_std: float = 0.0) -> FaceSemiAxes:
    """Fit the two semi-axes that the outline of one face shows; arguments as `semi_axes_from_outlines`.

    Raises
    ------
    FitError
        If the outline gives no ellipse, or fits one without a residual to tell its uncertainty.
    """
    try:
        fit = fit_aligned_ellipse(points)
    except FitError as error:
        raise FitError(f"outline of the {face} face: {error}") from error
    if not np.isfinite(fit.covariance).all():
        raise FitError(f"outline of the {face} face: four points leave no residual: mark five points or more")
    return FaceSemiAxes(
        face=face,
        semi_axes=np.array([fit.semi_x, fit.semi_y]),
        covariance=fit.covariance[2:, 2:],
        relative_scale_std=relative_scale_std,
    )


def _require_std(name: str, value: float) -> None:
    if not (math.isfinite(value) and value >= 0):
        raise FitError(f"{name} must be zero or positive, and finite, found {value}")


def _require_face(one: FaceSemiAxes) -> None:
    if one.face not in FACE_AXES:
        raise FitError(f"face must be one of {', '.join(FACE_AXES)}, found {one.face!r}")
    _require_std("relative_scale_std", one.relative_scale_std)
    if not (np.shape(one.semi_axes) == (2,) and np.isfinite(one.semi_axes).all() and min(one.semi_axes) > 0):
        raise FitError(f"{one.face} face: semi_axes must be two positive lengths, found {one.semi_axes}")
    covariance = np.asarray(one.covariance)
    if covariance.shape != (2, 2) or not np.isfinite(covariance).all():
        raise FitError(f"{one.face} face: covariance must be finite, of shape (2, 2), found {covariance}")
    if np.linalg.eigvalsh(covariance).min() < -1e-12 * np.abs(covariance).max():
        raise FitError(f"{one.face} face: covariance must have no negative variance, found {covariance}")


def _require_every_axis(faces: tuple[FaceSemiAxes, ...]) -> None:
    seen = {axis for one in faces for axis in FACE_AXES[one.face]}
    for axis in SEMI_AXES:
        if axis not in seen:
            showing = ", ".join(face for face, axes in FACE_AXES.items() if axis in axes)
            found = ", ".join(one.face for one in faces) or "no face"
            raise FitError(f"no face given shows the {axis} semi-axis, found {found}: add one of {showing}")


def _combined(faces: tuple[FaceSemiAxes, ...], shared_scale_std: float) -> OutlineSemiAxes:
    """Combine the semi-axes of all faces by generalised least squares."""
    count = 2 * len(faces)
    values, covariance, design = np.empty(count), np.zeros((count, count)), np.zeros((count, 3))
    for k, one in enumerate(faces):
        pair = slice(2 * k, 2 * k + 2)
        values[pair] = one.semi_axes
        # A wrong scale stretches both axes of a photograph alike; the floor keeps perfect points invertible.
        own_scale = one.relative_scale_std**2 * np.outer(values[pair], values[pair])
        covariance[pair, pair] = one.covariance + own_scale + np.diag((1e-9 * values[pair]) ** 2)
        for row, axis in enumerate(FACE_AXES[one.face], start=2 * k):
            design[row, SEMI_AXES.index(axis)] = 1
    weight = np.linalg.inv(covariance)
    joint = np.linalg.inv(design.T @ weight @ design)
    semi_axes = joint @ design.T @ weight @ values
    off = values - design @ semi_axes
    freedom = count - 3
    chi_square = float(off @ weight @ off) if freedom else 0.0
    # A scale that all share moves every semi-axis alike, and takes no part in the weighing.
    joint = joint + shared_scale_std**2 * np.outer(semi_axes, semi_axes)
    palmar, distal, radial_ulnar = map(float, semi_axes)
    return OutlineSemiAxes(
        palmar=palmar,
        distal=distal,
        radial_ulnar=radial_ulnar,
        covariance=np.asarray(joint, dtype=np.float64),
        chi_square=chi_square,
        degrees_of_freedom=freedom,
        p_value=float(chi2.sf(chi_square, freedom)) if freedom else math.nan,
        faces=faces,
    )
