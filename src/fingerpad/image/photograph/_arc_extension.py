"""The outline just beyond an arc whose ends are known, which still informs the fit of its ellipse."""

import numpy as np

from fingerpad._arrays import BoolArray, FloatArray
from fingerpad.image.ellipse_fit import distances
from fingerpad.image.photograph.arc import IndexArray
from fingerpad.image.photograph.arc_fit import (
    ArcFit,
    departure_covariance,
    fit_arc_ellipse,
    outline_places,
    parametric_angles,
    radii_of_curvature,
)

# Farther out, in radii of curvature, the outline can be 3 percent of one off, and is not used.
_REACH = 0.25
_REJECTION = 4.0


def extend_arc(points: FloatArray, used: IndexArray, fit: ArcFit, tilt: tuple[float, float]) -> ArcFit:
    """Fit an arc's ellipse again, with the outline just beyond its ends.

    Parameters
    ----------
    points : ndarray, (n, 2)
        Outline in the face's frame, px, in order.
    used : ndarray of int
        The arc.
    fit : ArcFit
        The ellipse of the arc alone.
    tilt : (float, float)
        Tilt of the finger's axis and its standard uncertainty, radians.
    """
    values, ends = np.array(fit.ellipse), used[[0, -1]]
    first, last = radii_of_curvature(values, parametric_angles(points[ends], values))
    places, spacing = outline_places(points)
    before, after = np.arange(ends[0])[::-1], np.arange(ends[1] + 1, len(points))
    before, after = (
        _flank(points, side, spacing * np.abs(places[side] - places[end]), fit, float(radius))
        for side, end, radius in ((before, ends[0], first), (after, ends[1], last))
    )
    order = np.concatenate([before[::-1], used, after])
    beyond = spacing * (
        np.minimum(places[order] - places[ends[0]], 0) + np.maximum(places[order] - places[ends[1]], 0)
    )
    return fit_arc_ellipse(
        points[order], tilt=tilt[0], tilt_std=tilt[1], places=places[order], start=values, beyond=beyond
    )


def _flank(points: FloatArray, order: IndexArray, away: FloatArray, fit: ArcFit, radius: float) -> IndexArray:
    """Return the points beyond one end, outwards, as far as they can belong to the finger."""
    order, away = order[away <= _REACH * radius], away[away <= _REACH * radius]
    if not len(order):
        return order
    spread = np.diagonal(departure_covariance(away, (radius, radius)))
    off = np.abs(distances(np.array(fit.ellipse), points[order])[0])
    good: BoolArray = off < _REJECTION * np.sqrt(spread + fit.residual_std**2)
    # What stands out is a hair, a nail or the frame, and so may be all that follows.
    good[np.argmin(good) :] &= good.all()
    return np.asarray(order[good], dtype=np.intp)
