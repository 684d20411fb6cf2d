"""Ellipses from regions and from points.

Points are fitted in two steps: the direct least-squares ellipse of Halíř & Flusser (1998), which always is an
ellipse, then the ellipse of least orthogonal distance from there, with the covariance of its parameters.
"""

import math
from dataclasses import dataclass

import numpy as np

from fingerpad._arrays import ArrayLike, BoolArray, FloatArray, as_float_array
from fingerpad._display import Displayed
from fingerpad.exceptions import FitError, ImageError
from fingerpad.geometry.ellipse import Ellipse
from fingerpad.image._orthogonal_fit import Parameters, refine

# An angle of which nothing is known is uniform over half a turn.
_ANGLE_VARIANCE_LIMIT = math.pi**2 / 12


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class RegionEllipse(Displayed):
    """The ellipse that stands for a region: its area, centroid and the shape of its second moments, in px.

    Attributes
    ----------
    ellipse : Ellipse
        Semi-axes, px.
    centroid : (float, float)
        (row, column), px; pixel centres are whole numbers.
    orientation : float
        Angle of the major axis from the image's row axis (straight up), counter-clockwise as seen on the
        screen, in (−π/2, π/2].
    """

    ellipse: Ellipse
    centroid: tuple[float, float]
    orientation: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class EllipseFit(Displayed):
    """An ellipse fitted to points (x, y).

    Attributes
    ----------
    centre : ndarray, (2,)
        (x, y), in the unit of the points.
    semi_major, semi_minor : float
        Semi-axes, sorted.
    angle : float
        Angle of the major axis from x towards y, in (−π/2, π/2].
    covariance : ndarray, (5, 5)
        Of (x, y, semi_major, semi_minor, angle), from the residuals.
    residual_std : float
        Standard deviation of the orthogonal distances.
    """

    centre: FloatArray
    semi_major: float
    semi_minor: float
    angle: float
    covariance: FloatArray
    residual_std: float

    @property
    def ellipse(self) -> Ellipse:
        """The semi-axes as an `Ellipse`."""
        return Ellipse(self.semi_major, self.semi_minor)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class AlignedEllipseFit(Displayed):
    """An ellipse with axes along x and y fitted to points.

    Attributes
    ----------
    centre : ndarray, (2,)
        (x, y), in the unit of the points.
    semi_x, semi_y : float
        Semi-axes along x and y, never sorted.
    covariance : ndarray, (4, 4)
        Of (x, y, semi_x, semi_y), from the residuals.
    residual_std : float
        Standard deviation of the orthogonal distances.
    """

    centre: FloatArray
    semi_x: float
    semi_y: float
    covariance: FloatArray
    residual_std: float


def equal_area_ellipse(mask: BoolArray) -> RegionEllipse:
    """Return the ellipse of a region: same area and centroid, axis ratio and direction of its second moments.

    Raises
    ------
    ImageError
        If the mask is not two-dimensional or has no pixel.

    Examples
    --------
    >>> fitted = equal_area_ellipse(np.ones((40, 20), dtype=bool))
    >>> round(float(fitted.ellipse.area), 6), fitted.centroid, fitted.orientation
    (800.0, (19.5, 9.5), 0.0)
    """
    mask = np.asarray(mask, dtype=bool)
    if mask.ndim != 2 or not mask.any():
        raise ImageError(
            f"the region must be a picture with at least one pixel set, found shape {mask.shape}, none set"
        )
    weights, row_index, column_index = mask.astype(np.float64), *map(np.arange, mask.shape)
    area = weights.sum()
    row, column = weights.sum(axis=1) @ row_index / area, weights.sum(axis=0) @ column_index / area
    # A pixel is a square, not a point: 1/12 is its own second moment.
    along_rows = weights.sum(axis=1) @ (row_index - row) ** 2 / area + 1 / 12
    along_columns = weights.sum(axis=0) @ (column_index - column) ** 2 / area + 1 / 12
    mixed = (row_index - row) @ weights @ (column_index - column) / area
    return ellipse_of_moments(area=area, centroid=(row, column), moments=(along_rows, along_columns, mixed))


def ellipse_of_moments(
    *, area: float, centroid: tuple[float, float], moments: tuple[float, float, float]
) -> RegionEllipse:
    """Return the ellipse of an area, with the axis ratio and direction of central second moments.

    Parameters
    ----------
    area : float
        Area of the region.
    centroid : (float, float)
        Its (row, column).
    moments : (float, float, float)
        Variance along rows and along columns, and their covariance, over the region.
    """
    along_rows, along_columns, mixed = moments
    half_sum, half_difference = (along_rows + along_columns) / 2, (along_rows - along_columns) / 2
    spread = math.hypot(half_difference, mixed)
    ratio = math.sqrt((half_sum - spread) / (half_sum + spread))
    semi_major = math.sqrt(area / (math.pi * ratio))
    return RegionEllipse(
        ellipse=Ellipse(semi_major, semi_major * ratio),
        centroid=(float(centroid[0]), float(centroid[1])),
        orientation=_half_turn(0.5 * math.atan2(mixed, half_difference)),
    )


def fit_ellipse(points: ArrayLike) -> EllipseFit:
    """Fit the ellipse of least orthogonal distance to points.

    Parameters
    ----------
    points : array_like, (n, 2)
        (x, y) of at least five points, in any unit of length.

    Raises
    ------
    FitError
        If the points are too few, not finite, on a line, or do not lie on an ellipse.

    Examples
    --------
    >>> t = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    >>> fit = fit_ellipse(np.stack([7.4 * np.cos(t), 5.0 * np.sin(t)], axis=-1))
    >>> round(fit.semi_major, 6), round(fit.semi_minor, 6), abs(round(fit.angle, 6))
    (7.4, 5.0, 0.0)
    """
    points = _checked(points, least=5)
    shift, size = _frame(points)
    start = _direct_ellipse((points - shift) / size)
    values, covariance, residual_std = refine((points - shift) / size, start)
    to_units = np.array([size, size, size, size, 1.0])
    values, covariance = values * to_units, covariance * np.outer(to_units, to_units)
    if values[2] < values[3]:
        order = [0, 1, 3, 2, 4]
        values, covariance = values[order], covariance[np.ix_(order, order)]
        values[4] += math.pi / 2
    covariance[4, 4] = min(covariance[4, 4], _ANGLE_VARIANCE_LIMIT)
    return EllipseFit(
        centre=values[:2] + shift,
        semi_major=float(values[2]),
        semi_minor=float(values[3]),
        angle=_half_turn(float(values[4])),
        covariance=covariance,
        residual_std=residual_std * size,
    )


def fit_aligned_ellipse(points: ArrayLike) -> AlignedEllipseFit:
    """Fit the ellipse of least orthogonal distance whose axes lie along x and y.

    Parameters
    ----------
    points : array_like, (n, 2)
        (x, y) of at least four points, in any unit of length.

    Raises
    ------
    FitError
        If the points are too few, not finite, on a line, or do not lie on such an ellipse.

    Examples
    --------
    >>> t = np.linspace(0, np.pi, 30)
    >>> fit = fit_aligned_ellipse(np.stack([11.8 * np.cos(t), 13.8 * np.sin(t)], axis=-1))
    >>> round(fit.semi_x, 6), round(fit.semi_y, 6)
    (11.8, 13.8)
    """
    points = _checked(points, least=4)
    shift, size = _frame(points)
    values, covariance, residual_std = refine(
        (points - shift) / size, _direct_aligned((points - shift) / size)
    )
    return AlignedEllipseFit(
        centre=values[:2] * size + shift,
        semi_x=float(values[2] * size),
        semi_y=float(values[3] * size),
        covariance=covariance * size**2,
        residual_std=residual_std * size,
    )


def _checked(points: ArrayLike, least: int) -> FloatArray:
    points = as_float_array(points)
    if points.ndim != 2 or points.shape[1] != 2:
        raise FitError(f"points must have shape (n, 2), found {points.shape}")
    if not np.isfinite(points).all():
        row = int(np.argwhere(~np.isfinite(points))[0, 0])
        raise FitError(f"points must be finite, found {points[row]} at row {row}: remove it")
    if len(np.unique(points, axis=0)) < least:
        raise FitError(
            f"an ellipse needs at least {least} different points, found {len(np.unique(points, axis=0))}"
        )
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    if spread[1] < 1e-6 * spread[0]:
        raise FitError("the points lie on a straight line: mark points round the outline")
    return points


def _frame(points: FloatArray) -> tuple[FloatArray, float]:
    """Return the centroid and root-mean-square radius that condition the fit."""
    shift = points.mean(axis=0)
    return shift, float(np.sqrt(np.mean((points - shift) ** 2)))


def _direct_ellipse(points: FloatArray) -> Parameters:
    """Return (x, y, semi_1, semi_2, angle) of Halíř & Flusser's direct least-squares ellipse."""
    x, y = points.T
    quadratic = np.stack([x * x, x * y, y * y], axis=-1)
    linear = np.stack([x, y, np.ones_like(x)], axis=-1)
    try:
        to_linear = -np.linalg.solve(linear.T @ linear, linear.T @ quadratic)
        reduced = quadratic.T @ quadratic + (quadratic.T @ linear) @ to_linear
        _, vectors = np.linalg.eig(np.stack([reduced[2] / 2, -reduced[1], reduced[0] / 2]))
    except np.linalg.LinAlgError as error:
        raise FitError("the points do not determine an ellipse: mark points round the outline") from error
    vectors = np.real(vectors)
    elliptic = np.flatnonzero(4 * vectors[0] * vectors[2] - vectors[1] ** 2 > 0)
    if not elliptic.size:
        raise FitError("the points do not lie on an ellipse: mark points round one outline")
    conic = vectors[:, elliptic[0]]
    return _semi_axes_of(conic, to_linear @ conic)


def _semi_axes_of(quadratic: FloatArray, linear: FloatArray) -> Parameters:
    """Return (x, y, semi_1, semi_2, angle) of a conic a x² + b xy + c y² + d x + e y + f = 0."""
    a, b, c = quadratic
    matrix = np.array([[a, b / 2], [b / 2, c]])
    centre = -np.linalg.solve(matrix, linear[:2]) / 2
    level = centre @ matrix @ centre - linear[2]
    eigenvalues, axes = np.linalg.eigh(matrix)
    with np.errstate(divide="ignore", invalid="ignore"):
        semi_axes = np.sqrt(level / eigenvalues)
    if not np.isfinite(semi_axes).all():
        raise FitError("the points do not lie on an ellipse: mark points round one outline")
    return np.array([*centre, *semi_axes, math.atan2(axes[1, 0], axes[0, 0])])


def _direct_aligned(points: FloatArray) -> Parameters:
    """Return (x, y, semi_x, semi_y) of the least-squares conic x² + c y² + d x + e y + f = 0, c > 0."""
    x, y = points.T
    design = np.stack([y * y, x, y, np.ones_like(x)], axis=-1)
    c, d, e, f = np.linalg.lstsq(design, -x * x, rcond=None)[0]
    if not c > 0:
        raise FitError(
            "the points do not lie on an ellipse along x and y: check that x_mm and y_mm are not mixed"
        )
    level = d * d / 4 + e * e / (4 * c) - f
    if not level > 0:
        raise FitError("the points do not lie on an ellipse: mark points round one outline")
    return np.array([-d / 2, -e / (2 * c), math.sqrt(level), math.sqrt(level / c)])


def _half_turn(angle: float) -> float:
    """Bring the direction of an axis into (−π/2, π/2]."""
    return math.pi / 2 - (math.pi / 2 - angle) % math.pi
