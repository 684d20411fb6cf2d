"""Semi-axes of the finger pad from a photograph of one face before a plain backdrop.

The finger is separated from the backdrop by colour and its outline located to a fraction of a pixel
(silhouette.py), the arc of the pad selected (arc.py), and an ellipse along the finger's axis fitted to it by
least orthogonal distance, which a superellipse and the outline's lengths are compared with (shape.py,
result.py).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fingerpad._arrays import ArrayLike, Float32Array, FloatArray, IndexArray, as_float_array, real_array
from fingerpad.exceptions import FitError, ImageError
from fingerpad.image._masks import region_window
from fingerpad.image.levels import check_finite, checked_picture
from fingerpad.image.photograph import arc
from fingerpad.image.photograph.arc import FaceArc, outline_points
from fingerpad.image.photograph.faces import Direction, Face, face_axes, opposite, palmar_directions
from fingerpad.image.photograph.result import PhotographFit, face_from_arc
from fingerpad.image.photograph.silhouette import (
    Silhouette,
    SubpixelOutline,
    find_silhouette,
    locate_edges,
    opponent_light,
)
from fingerpad.image.read import ImageLike, levels_of
from fingerpad.image.scale import Scale, ScaleLike, as_scale

_MIN_POINTS = 24
_MAX_POINTS = 1000


def measure_photograph(
    image: ImageLike,
    face: Face,
    scale: ScaleLike,
    *,
    tip: Direction = "up",
    palmar: Direction | None = None,
    region_of_interest: tuple[float, float, float, float] | None = None,
    points: ArrayLike | None = None,
) -> PhotographFit:
    """Measure two semi-axes of the finger pad in a photograph of one face.

    The arc is the longest about the pad's middle that one ellipse fits; or all the outline inside
    `region_of_interest`, or from the first to the last of `points`: beyond such ends the outline, which has
    no corner, still informs the fit. The ellipse lies along the finger's own axis, as its sides show it,
    within what they leave open.

    No finger is an ellipse. A superellipse is fitted to the same arc; by the odds of the two, what its
    semi-axes differ by stands in the covariance. Where its mean exponent departs from 2 significantly, the
    flag ``not_an_ellipse`` says so.

    Parameters
    ----------
    image : array_like, (rows, columns) or (rows, columns, 3), path-like or Picture
        Grey levels or red, green, blue, sRGB, or the file that holds them. A fourth channel is left aside.
    face : {"palmar", "distal", "radial", "ulnar"}
        The face that looks at the camera.
    scale : Scale or float
        Millimetres per pixel.
    tip : {"up", "down", "left", "right"}
        Where the fingertip points.
    palmar : {"up", "down", "left", "right"}, optional
        Where the palmar side is. Down if left out in the distal face; in a side face the side that gives the
        longer arc. The palmar face needs none.
    region_of_interest : (float, float, float, float), optional
        First row, first column, last row, last column, px, round the pad's arc.
    points : array_like, (n, 2), optional
        (row, column), px, of two or more marks on the pad's outline, the arc's ends among them.

    Returns
    -------
    PhotographFit

    Raises
    ------
    ImageError
        If the picture, region or marks are no good, no finger or more than one object that may be it stands
        out, or the frame cuts the pad.
    FitError
        If the outline found does not determine an ellipse.
    CalibrationError
        If a number is no length of a pixel, mm.

    Examples
    --------
    >>> from fingerpad.image import Scale
    >>> from fingerpad.simulate import render_finger
    >>> truth = render_finger("palmar", semi_axes=(11.8, 13.8), mm_per_px=0.1, seed=1)
    >>> found = measure_photograph(truth.pixels, "palmar", Scale(truth.mm_per_px))
    >>> {name: round(value) for name, value in found.semi_axes_mm.items()}
    {'radial_ulnar': 12, 'distal': 14}
    """
    sides = palmar_directions(face, tip, palmar)
    pixels, scale = checked_picture(levels_of(image, colour=True), "pixels", colour=True), as_scale(scale)
    if pixels.dtype == bool:
        raise ImageError("pixels must hold grey levels or colours, found bool: a mask is no photograph")
    check_finite(pixels, "pixels")
    light = opponent_light(pixels)
    size = (light.shape[0], light.shape[1])
    window = None if region_of_interest is None else region_window(region_of_interest, size)
    marks = None if points is None else _check_marks(points, size)
    silhouette = find_silhouette(light, None if face == "distal" else opposite(tip), window)
    edges = _outline(light, silhouette)
    border = (size[0] - 1.0, size[1] - 1.0, 6.0 + 3 * silhouette.reduction)
    marked: IndexArray | None = None
    if marks is not None:
        marked = edges.between(marks)
    elif window is not None:
        marked = edges.within(window)
    else:
        silhouette.check_alone()
        if face != "distal":
            silhouette.check_tip(tip)
    tried: list[PhotographFit] = []
    errors: list[ImageError | FitError] = []
    for side in sides:
        try:
            if marked is None:  # by the frame, on the sides that the pad faces
                silhouette.check_not_cut((side,) if face in ("palmar", "distal") else (tip, side), tip)
            outline = _pad_arc(edges, marked, face, face_axes(face, tip, side), scale)
            tried.append(face_from_arc(replace(outline, border=border)))
        except (FitError, ImageError) as error:
            errors.append(error)
    if not tried:
        raise errors[0]
    # The arc of the pad determines its ellipse better than one of the dorsal side does.
    best = min(
        tried, key=lambda one: np.linalg.norm(np.sqrt(np.diagonal(one.edge_covariance)) / one.semi_axes)
    )
    return replace(best, picture=pixels)


def _outline(light: Float32Array, silhouette: Silhouette) -> SubpixelOutline:
    """Locate the outline, first as far as the silhouette can be off, then closely."""
    contour = silhouette.contour()
    if len(contour) < 40:
        raise ImageError(
            f"the finger's outline has {len(contour)} points inside the frame: leave a margin round it"
        )
    step = silhouette.reduction
    if step > 1:
        coarse = locate_edges(light, contour, reach=3 * step + 2, spacing=step)
        contour = coarse.points[coarse.found] if coarse.found.mean() > 0.5 else contour
    # Errors run together over several pixels: more points than these add nothing.
    length = float(np.linalg.norm(np.diff(contour, axis=0), axis=1).sum())
    return locate_edges(light, contour, reach=4.0, spacing=max(1.0, length / _MAX_POINTS))


def _pad_arc(
    edges: SubpixelOutline, marked: IndexArray | None, face: Face, axes: FloatArray, scale: Scale
) -> FaceArc:
    """Return the pad's arc: the longest that one ellipse fits, or as marked."""
    origin = edges.points.mean(axis=0)
    local = (edges.points - origin) @ axes.T
    tilt, pad = arc.finger_tilt(local, face), arc.candidate_points(local, face)
    order = pad if marked is None else marked
    if edges.found[order].sum() < _MIN_POINTS:
        raise FitError(
            f"only {edges.found[order].sum()} points of the finger's outline lie on the {face} face's arc: "
            "widen region_of_interest, or mark points on the pad"
        )
    # In order from opposite the arc's middle, so that the arc is one piece.
    every = np.arange(len(local))
    if edges.closed:
        every = np.roll(every, len(every) // 2 - int(order[len(order) // 2]))
    every = every[edges.found[every]]
    xy, candidates = local[every], np.flatnonzero(np.isin(every, order))
    rough = np.append(arc.initial_ellipse(local, face)[:4], tilt[0])
    if marked is None:
        found = arc.longest_arc(xy, candidates, arc.PAD_MIDDLE[face], tilt, rough)
    else:
        found = arc.fit_arc(xy, candidates, tilt, arc.rough_start(xy[candidates], tilt, rough))
    points = outline_points(xy, step_ratio=edges.step_ratio[every], pad=np.isin(every, pad), used=False)
    points["used"][found.used] = True
    points["rejected"][found.rejected] = True
    return FaceArc(
        face=face,
        scale=scale,
        frame=(axes, origin),
        tilt=tilt,
        points=points,
        start=found.fit.ellipse.parameters,
        ends_known=marked is not None,
        blur=edges.blur,
    )


def _check_marks(points: ArrayLike, size: tuple[int, int]) -> FloatArray:
    """Return the marks, checked."""
    marks = real_array(points, "points", ImageError)
    if marks.ndim != 2 or marks.shape[1] != 2 or len(np.unique(marks, axis=0)) < 2:
        raise ImageError(
            f"points must be two or more different marks (row, column), found shape {marks.shape}"
        )
    inside = ((marks >= 0) & (marks <= as_float_array(size) - 1)).all(axis=1)
    if not inside.all():
        row, column = marks[int(np.argmin(inside))]
        raise ImageError(
            f"points: row {row:g}, column {column:g} is outside the picture of {size[0]} rows and {size[1]} "
            "columns: give marks as (row, column)"
        )
    return marks
