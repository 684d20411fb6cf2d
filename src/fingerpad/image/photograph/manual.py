"""Manual ellipses of a finger pad in a photograph, and manual changes to its outline."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from fingerpad._arrays import ArrayLike, BoolArray, FloatArray, as_float_array, check_radians
from fingerpad.exceptions import ImageError
from fingerpad.image.ellipse import PlaneEllipse
from fingerpad.image.photograph.arc import PAD_MIDDLE
from fingerpad.image.photograph.face_arc import FaceArc, face_from_arc, outline_points, photograph_fit
from fingerpad.image.photograph.faces import Direction, Face, face_axes, palmar_directions
from fingerpad.image.photograph.result import PhotographFit, size_flags
from fingerpad.image.scale import ScaleLike, as_scale

# An ellipse within so much of the outline, as a share of its smaller semi-axis, passes for a good one to the
# eye (as to the flag `poor_ellipse`), and a mark is placed to a pixel: at the centre and at each end.
_BY_EYE, _MARK_PX = 0.01, 1.0
# No picture reaches so far, px.
_FARTHEST_PX = 1e6


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
    if not (np.isfinite([*centre, *semi_axes, tilt]).all() and min(semi_axes) > 0):
        raise ImageError(
            f"an ellipse needs a finite centre and tilt and two positive semi-axes, found {centre}, "
            f"{math.degrees(tilt):g} degrees, {semi_axes}"
        )
    check_radians("tilt", tilt)
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

    Raises
    ------
    ImageError
        As `photograph_from_ellipse`.

    Examples
    --------
    >>> from fingerpad.image import Scale
    >>> scale = Scale(0.05)
    >>> fit = photograph_from_handles(
    ...     "palmar", scale, centre=(300, 200), across_end=(300, 436), along_end=(24, 200)
    ... )
    >>> {name: round(value, 2) for name, value in fit.semi_axes_mm.items()}, round(fit.tilt, 6) + 0.0
    ({'radial_ulnar': 11.8, 'distal': 13.8}, 0.0)
    """
    ends = as_float_array([across_end, along_end]) - as_float_array(centre)
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
    arc: FaceArc = found._arc
    places = arc.in_picture(arc.xy)
    gone = np.zeros(len(places), dtype=bool)
    for path, radius in erased:
        gone |= _points_under_stroke(places, path, radius)
    if not len(marks) and not (gone & (arc.points["pad"] | arc.searched)).any():
        return found
    return replace(face_from_arc(arc.without(gone).with_marks(marks)), _picture=found.picture)


def _check_points(what: str, points: ArrayLike) -> FloatArray:
    values = as_float_array(points)
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
    if not (len(path) and radius > 0 and math.isfinite(radius)):
        raise ImageError(f"a stroke needs a point and a positive radius, found {len(path)} and {radius}")
    start, end = (path, path) if len(path) == 1 else (path[:-1], path[1:])
    along = end - start
    length = np.maximum((along**2).sum(axis=1), 1e-12)
    share = np.einsum("nki,ki->nk", points[:, None] - start, along) / length
    foot = start + share.clip(0, 1)[..., None] * along
    return np.asarray(np.linalg.norm(points[:, None] - foot, axis=2).min(axis=1) <= radius)
