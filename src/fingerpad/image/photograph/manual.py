"""Manual ellipses of a finger pad in a photograph, and manual changes to its outline."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import ArrayLike, BoolArray, FloatArray, as_float_array, check_radians
from fingerpad.exceptions import FitError, ImageError
from fingerpad.geometry.faces import Direction, Face, face_axes, palmar_directions
from fingerpad.image.ellipse import rotation
from fingerpad.image.inputs import ScaleLike, as_scale
from fingerpad.image.photograph._arc import PAD_MIDDLE
from fingerpad.image.photograph._departure import PadShape, departure_of, is_significant, with_departure
from fingerpad.image.photograph.outline_fit import fit_outline_ellipse, turns_from
from fingerpad.image.photograph.result import PhotographFit, size_flags

IntArray: TypeAlias = npt.NDArray[np.int64]

# An ellipse within so much of the outline, as a share of its smaller semi-axis, passes for a good one to the
# eye (as to the flag `poor_ellipse`), and a mark is placed to a pixel: at the centre and at each end.
_BY_EYE, _MARK_PX = 0.01, 1.0
# Least difference between a fitted ellipse's residuals and its points' errors that all points share, px.
_SHARED_PX, _SHARED_REACH = 0.1, math.radians(25)
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
    """Return the semi-axes of a face from an ellipse placed manually; it needs no picture.

    Parameters
    ----------
    face : {"palmar", "distal", "radial", "ulnar"}
        The face that looks at the camera.
    scale : Scale or float
        Millimetres per pixel.
    centre : (float, float)
        (row, column), px.
    semi_axes : (float, float)
        Across and along, in the order of `FACE_AXES`, px.
    tilt : float
        Turn of the ellipse from the face's x (across) towards its y (along), radians.
    tip, palmar : {"up", "down", "left", "right"}
        Directions of the fingertip and the palmar side, as for `measure_photograph`.

    Returns
    -------
    PhotographFit
        Without points, with the flag ``fitted_manually``.

    Raises
    ------
    ImageError
        If a number is not finite, a semi-axis not positive, or face and directions do not agree.
    GeometryError
        If the tilt is beyond a full turn, as degrees are.

    Examples
    --------
    >>> from fingerpad.image import Scale
    >>> fit = photograph_from_ellipse(
    ...     "palmar", Scale(0.05), centre=(300, 200), semi_axes=(236, 276)
    ... )
    >>> {name: round(value, 3) for name, value in fit.semi_axes_mm.items()}
    {'radial_ulnar': 11.8, 'distal': 13.8}
    """
    if not (np.isfinite([*centre, *semi_axes, tilt]).all() and min(semi_axes) > 0):
        raise ImageError(
            f"an ellipse needs a finite centre and tilt and two positive semi-axes, found {centre}, "
            f"{math.degrees(tilt):g} degrees, {semi_axes}"
        )
    check_radians("tilt", tilt)
    scale = as_scale(scale)
    side = palmar_directions(face, tip, palmar)[0]
    semi_px = as_float_array(semi_axes)
    semi_mm = semi_px * scale.mm_per_px
    own_std = math.hypot(_MARK_PX, _BY_EYE * float(semi_px.min()))
    return PhotographFit(
        face=face,
        semi_axes=semi_mm,
        edge_covariance=2 * (own_std * scale.mm_per_px) ** 2 * np.eye(2),
        scale=scale,
        centre=(float(centre[0]), float(centre[1])),
        directions=rotation(tilt).T @ face_axes(face, tip, side),
        tilt=tilt,
        tilt_std=own_std / float(semi_px.max()),
        arc=(PAD_MIDDLE[face] - math.pi, PAD_MIDDLE[face] + math.pi),
        points=np.empty((0, 2)),
        outliers=np.empty((0, 2)),
        correlation_px=math.nan,
        residual_px_std=math.nan,
        blur_px=math.nan,
        flags=size_flags(semi_mm) | {"fitted_manually"},
    )


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
    lengths = np.linalg.norm(ends, axis=1)
    longer = int(np.argmax(lengths))
    axes = face_axes(face, tip, palmar_directions(face, tip, palmar)[0])
    first, second = axes @ ends[longer]
    tilt = math.atan2(second, first) if longer == 0 else math.atan2(-first, second)
    return photograph_from_ellipse(
        face,
        scale,
        centre=centre,
        semi_axes=(float(lengths[0]), float(lengths[1])),
        tilt=tilt,
        tip=tip,
        palmar=palmar,
    )


def with_marked_points(
    found: PhotographFit,
    *,
    added: ArrayLike = (),
    erased: Sequence[tuple[ArrayLike, float]] = (),
) -> PhotographFit:
    """Fit the ellipse again with points added to the outline or erased from it.

    Parameters
    ----------
    found : PhotographFit
        A measured photograph.
    added : array_like, shape (n, 2)
        (row, column), px, of further points on the pad's outline.
    erased : sequence of (array_like (n, 2), float)
        Strokes of an eraser: (row, column) along each, px, and its radius, px. Points under it are left out.

    Returns
    -------
    PhotographFit
        With the flag ``fitted_manually``; the same as `found` where nothing is added or erased.

    Raises
    ------
    ImageError
        If points or strokes are not as described.
    FitError
        If what is left does not determine an ellipse.

    Examples
    --------
    >>> from fingerpad.image import Scale, measure_photograph
    >>> from fingerpad.simulate import render_finger
    >>> truth = render_finger("palmar", semi_axes=(11.8, 13.8), mm_per_px=0.1, seed=1)
    >>> found = measure_photograph(truth.pixels, "palmar", Scale(truth.mm_per_px))
    >>> fewer = with_marked_points(found, erased=[([found.points[0]], 10)])
    >>> len(fewer.points) < len(found.points), round(fewer.semi_axes_mm["radial_ulnar"])
    (True, 12)
    """
    marks = _check_points("added points", added)
    kept = np.ones(len(found.points), dtype=bool)
    for path, radius in erased:
        kept &= ~_points_under_stroke(found.points, path, radius)
    if not len(marks) and kept.all():
        return found
    left_out = np.concatenate([found.outliers, found.points[~kept]])
    points = np.concatenate([found.points[kept], marks])
    axes = rotation(found.tilt) @ found.directions
    centre = as_float_array(found.centre)
    local = (points - centre) @ axes.T
    start = np.array([0.0, 0.0, *(found.semi_axes / found.scale.mm_per_px), found.tilt])
    order, places = _outline_order(local, start, found)
    points, local = points[order], local[order]
    # The tilt of the automatic fit comes from the sides of the finger: it is kept as prior.
    fit = fit_outline_ellipse(
        local, tilt=found.tilt, tilt_std=max(found.tilt_std, 1e-3), places=places, start=start
    )
    shared = fit.shared_error_covariance(_SHARED_PX, _SHARED_PX, _SHARED_REACH)
    x, y, semi_x, semi_y, tilt = fit.ellipse
    place = np.array([x, y]) @ axes + centre
    middle = PAD_MIDDLE[found.face]
    angles = middle + turns_from(middle, local, fit.ellipse)
    covariance = (fit.covariance + shared)[2:4, 2:4]
    shape = PadShape(tilt=(found.tilt, max(found.tilt_std, 1e-3)), noise=fit.residual_std)
    departure = departure_of(local, fit.ellipse, covariance, shape)
    result = replace(
        found,
        semi_axes=np.array([semi_x, semi_y]) * found.scale.mm_per_px,
        edge_covariance=covariance * found.scale.mm_per_px**2,
        centre=(float(place[0]), float(place[1])),
        directions=rotation(tilt).T @ axes,
        tilt=tilt,
        tilt_std=math.sqrt(fit.covariance[4, 4]),
        arc=(float(angles.min()), float(angles.max())),
        points=points,
        outliers=left_out,
        residual_px_std=fit.residual_std,
    )
    relative = np.sqrt(np.diagonal(result.edge_covariance)) / result.semi_axes
    if not float(relative.max()) < 0.4:
        raise FitError(
            f"the points left leave an axis unknown by {float(relative.max()):.0%}: "
            "keep or add points along a longer arc"
        )
    flags = found.flags - size_flags(found.semi_axes) - {"not_an_ellipse"} | size_flags(result.semi_axes)
    result = with_departure(result, fit.ellipse, departure)
    if is_significant(result.exponent, result.exponent_std):
        flags |= {"not_an_ellipse"}
    return replace(result, flags=flags | {"fitted_manually"})


def _outline_order(local: FloatArray, start: FloatArray, found: PhotographFit) -> tuple[IntArray, IntArray]:
    """Return the points' order along the outline, and the place of each in steps of the outline."""
    turns = turns_from(PAD_MIDDLE[found.face], local, start)
    order = np.argsort(turns, kind="stable")
    lengths = np.linalg.norm(np.diff(local[order], axis=0), axis=1)
    step = float(np.median(lengths[lengths > 0])) if (lengths > 0).any() else 1.0
    # Never twice in one place: each point is one.
    places = np.concatenate([[0], np.cumsum(np.maximum(np.rint(lengths / step), 1))])
    return order.astype(np.int64), places.astype(np.int64)


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
