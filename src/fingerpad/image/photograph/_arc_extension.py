"""The outline just beyond the pad's arc, which still informs the fit of its ellipse."""

from dataclasses import replace

import numpy as np

from fingerpad._arrays import BoolArray, FloatArray
from fingerpad.image._orthogonal_fit import distances
from fingerpad.image.photograph._arc import IndexArray, PadArc
from fingerpad.image.photograph._edges import SubpixelOutline
from fingerpad.image.photograph.outline_fit import (
    departure_covariance,
    fit_outline_ellipse,
    parametric_angles,
    radii_of_curvature,
)

# Farther out, in radii of curvature, the outline can be 3 percent of one off, and is not used.
_REACH = 0.25
_REJECTION = 4.0


def extend_arc(points: FloatArray, edges: SubpixelOutline, arc: PadArc, tilt: tuple[float, float]) -> PadArc:
    """Fit the arc's ellipse again, with the outline just beyond its ends.

    Parameters
    ----------
    points : ndarray, (n, 2)
        Outline in the face's frame, px.
    edges : SubpixelOutline
        The same outline in the picture.
    arc : PadArc
        The arc, fitted alone.
    tilt : (float, float)
        Tilt of the finger's axis and its standard uncertainty, radians.
    """
    values, ends = np.array(arc.fit.ellipse), arc.used[[0, -1]]
    first, last = radii_of_curvature(values, parametric_angles(points[ends], values))
    before = _flank(points, edges, arc, -first)[::-1]
    after = _flank(points, edges, arc, last)
    order = np.concatenate([before, arc.used, after])
    count = len(points)
    place = np.concatenate(
        [(before - ends[0] - 1) % count - count + 1, (arc.used - ends[0]) % count, (after - ends[0]) % count]
    )
    beyond = edges.spacing * (np.minimum(place, 0) + np.maximum(place - (ends[1] - ends[0]) % count, 0))
    fit = fit_outline_ellipse(
        points[order], tilt=tilt[0], tilt_std=tilt[1], places=place, start=values, beyond=beyond
    )
    return replace(arc, fit=fit)


def _flank(points: FloatArray, edges: SubpixelOutline, arc: PadArc, radius: float) -> IndexArray:
    """Return the indices of the points beyond one end, outwards, as far as they can belong to the finger.

    The end is the first where the radius of curvature is negative, the last where it is positive.
    """
    step, end = (1, arc.used[-1]) if radius > 0 else (-1, arc.used[0])
    away = np.arange(1, int(_REACH * abs(radius) / edges.spacing) + 1)
    order = end + step * away
    if edges.closed:
        order, away = order % len(points), away[: len(points) - len(arc.used)]
        order = order[: len(away)]
    else:
        order = order[(order >= 0) & (order < len(points))]
        away = away[: len(order)]
    spread = np.diagonal(departure_covariance(np.float64(edges.spacing) * away, (abs(radius), abs(radius))))
    off = np.abs(distances(np.array(arc.fit.ellipse), points[order])[0])
    good: BoolArray = off < _REJECTION * np.sqrt(spread + arc.fit.residual_std**2)
    # What stands out is a hair, a nail or the frame, and so may be all that follows.
    good[np.argmin(good) :] &= good.all()
    return np.asarray(order[good & edges.found[order]], dtype=np.intp)
