"""The ellipse of an outline that a person traced, as a list of corners."""

import numpy as np

from fingerpad._arrays import ArrayLike, as_float_array
from fingerpad.exceptions import ImageError
from fingerpad.image.ellipse_fit import RegionEllipse, ellipse_of_moments


def ellipse_of_polygon(corners: ArrayLike) -> RegionEllipse:
    """Return the ellipse of a polygon: its area and centroid, ratio and direction of its second moments.

    The polygon's moments are exact, by Green's theorem, at any size of pixels.

    Parameters
    ----------
    corners : array_like, shape (n, 2)
        (row, column) of the corners in order, open or closed, either way round.

    Raises
    ------
    ImageError
        If the corners are too few, not finite, or enclose no area.

    Examples
    --------
    >>> found = ellipse_of_polygon([(0, 0), (40, 0), (40, 20), (0, 20)])
    >>> round(float(found.ellipse.area), 9), found.centroid, found.orientation
    (800.0, (20.0, 10.0), 0.0)
    """
    points = as_float_array(corners)
    if points.ndim != 2 or points.shape[-1] != 2 or len(points) < 3 or not np.isfinite(points).all():
        raise ImageError(f"an outline needs three corners or more, all finite; found shape {points.shape}")
    middle = points.mean(axis=0)
    y, x = (points - middle).T
    next_y, next_x = np.roll(y, -1), np.roll(x, -1)
    cross = y * next_x - next_y * x
    area = cross.sum() / 2
    if not abs(area) > 1e-9 * np.ptp(points, axis=0).max() ** 2:
        raise ImageError("the outline encloses no area: trace round the contact")
    row, column = (np.sum((one + other) * cross) / (6 * area) for one, other in ((y, next_y), (x, next_x)))
    square_y = np.sum((y * y + y * next_y + next_y * next_y) * cross) / (12 * area)
    square_x = np.sum((x * x + x * next_x + next_x * next_x) * cross) / (12 * area)
    mixed = np.sum((2 * y * x + y * next_x + next_y * x + 2 * next_y * next_x) * cross) / (24 * area)
    moments = square_y - row**2, square_x - column**2, mixed - row * column
    if not (moments[0] > 0 and moments[1] > 0 and moments[0] * moments[1] > moments[2] ** 2):
        raise ImageError("the outline crosses itself: trace once round the contact")
    return ellipse_of_moments(
        area=float(abs(area)),
        centroid=(float(middle[0] + row), float(middle[1] + column)),
        moments=(float(moments[0]), float(moments[1]), float(moments[2])),
    )
