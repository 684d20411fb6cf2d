"""Semi-axes of the finger pad from the outlines seen in photographs of its faces.

Each face shows two of the three semi-axes, so that two faces give one of them twice and three faces each of
them twice: the joint estimate is over-determined, and the disagreement is reported.
"""

import csv
import math
from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Literal, TypeAlias

import numpy as np
from scipy.stats import chi2

from fingerpad._arrays import ArrayLike, FloatArray
from fingerpad.exceptions import FitError, ImageError
from fingerpad.image.ellipse_fit import AlignedEllipseFit, fit_aligned_ellipse

Face: TypeAlias = Literal["palmar", "distal", "radial", "ulnar"]

SEMI_AXES = ("palmar", "distal", "radial_ulnar")
# The semi-axes that (x, y), that is (across, along), show in a photograph of each face.
FACE_AXES: Mapping[Face, tuple[str, str]] = {
    "palmar": ("radial_ulnar", "distal"),
    "distal": ("radial_ulnar", "palmar"),
    "radial": ("palmar", "distal"),
    "ulnar": ("palmar", "distal"),
}
_COLUMNS = ("x_mm", "y_mm")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class OutlineSemiAxes:
    """Semi-axes of a finger pad from the outlines of its faces.

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
    fits : mapping from face to AlignedEllipseFit
        The ellipse of each outline.
    """

    palmar: float
    distal: float
    radial_ulnar: float
    covariance: FloatArray
    chi_square: float
    degrees_of_freedom: int
    p_value: float
    fits: Mapping[Face, AlignedEllipseFit]

    @property
    def stds(self) -> FloatArray:
        """Standard uncertainties of (palmar, distal, radial_ulnar), mm."""
        return np.sqrt(np.diagonal(self.covariance))


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
    fits = {face: _fit_face(face, points) for face, points in outlines.items()}
    _require_every_axis(fits)
    return _combined(fits, relative_scale_std)


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
    path = Path(path)
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            reader = csv.DictReader(file, skipinitialspace=True)
            header = [name.strip() for name in reader.fieldnames or ()]
            for column in _COLUMNS:
                if column not in header:
                    raise ImageError(
                        f"{path}: line 1: no column {column}, found {', '.join(header) or 'nothing'}: "
                        "begin the file with x_mm,y_mm"
                    )
            reader.fieldnames = header
            points = [
                [_number(path, reader.line_num, column, row[column]) for column in _COLUMNS] for row in reader
            ]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise ImageError(
            f"{path}: cannot be read as an outline ({error}): give a CSV file with x_mm,y_mm"
        ) from error
    if not points:
        raise ImageError(f"{path}: holds no points: put one on each line below x_mm,y_mm")
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


def _fit_face(face: Face, points: ArrayLike) -> AlignedEllipseFit:
    try:
        fit = fit_aligned_ellipse(points)
    except FitError as error:
        raise FitError(f"outline of the {face} face: {error}") from error
    if not np.isfinite(fit.covariance).all():
        raise FitError(f"outline of the {face} face: four points leave no residual: mark five points or more")
    return fit


def _require_every_axis(fits: Mapping[Face, AlignedEllipseFit]) -> None:
    seen = {axis for face in fits for axis in FACE_AXES[face]}
    for axis in SEMI_AXES:
        if axis not in seen:
            showing = ", ".join(face for face, axes in FACE_AXES.items() if axis in axes)
            raise FitError(
                f"no face given shows the {axis} semi-axis, found {', '.join(fits) or 'no face'}: "
                f"add one of {showing}"
            )


def _combined(fits: Mapping[Face, AlignedEllipseFit], relative_scale_std: float) -> OutlineSemiAxes:
    """Combine the semi-axes of all faces by generalised least squares."""
    count = 2 * len(fits)
    values, covariance, design = np.empty(count), np.zeros((count, count)), np.zeros((count, 3))
    for k, (face, fit) in enumerate(fits.items()):
        pair = slice(2 * k, 2 * k + 2)
        values[pair] = fit.semi_x, fit.semi_y
        # A wrong scale stretches both axes of a photograph alike; the floor keeps perfect points invertible.
        shared = relative_scale_std**2 * np.outer(values[pair], values[pair])
        covariance[pair, pair] = fit.covariance[2:, 2:] + shared + np.diag((1e-9 * values[pair]) ** 2)
        for row, axis in enumerate(FACE_AXES[face], start=2 * k):
            design[row, SEMI_AXES.index(axis)] = 1
    weight = np.linalg.inv(covariance)
    joint = np.linalg.inv(design.T @ weight @ design)
    palmar, distal, radial_ulnar = joint @ design.T @ weight @ values
    off = values - design @ (palmar, distal, radial_ulnar)
    freedom = count - 3
    chi_square = float(off @ weight @ off) if freedom else 0.0
    return OutlineSemiAxes(
        palmar=float(palmar),
        distal=float(distal),
        radial_ulnar=float(radial_ulnar),
        covariance=np.asarray(joint, dtype=np.float64),
        chi_square=chi_square,
        degrees_of_freedom=freedom,
        p_value=float(chi2.sf(chi_square, freedom)) if freedom else math.nan,
        fits=fits,
    )
