"""Semi-axes of the finger pad from a photograph of one face before a plain backdrop.

The finger is separated from the backdrop by colour, its outline located to a fraction of a pixel, the arc of
the pad selected, and an ellipse along the finger's axis fitted to it by least orthogonal distance.
"""

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import ArrayLike, FloatArray
from fingerpad.exceptions import FitError, ImageError
from fingerpad.image.photograph._arc import PAD_MIDDLE, candidate_points, fit_arc, longest_arc
from fingerpad.image.photograph._edges import SubpixelOutline, locate_edges
from fingerpad.image.photograph._face import FaceArc, face_from_arc
from fingerpad.image.photograph._finger_axis import finger_tilt
from fingerpad.image.photograph._input import (
    Window,
    between,
    check_image,
    check_marks,
    check_not_cut,
    check_window,
    opponent_light,
    pad_sides,
    within,
)
from fingerpad.image.photograph._silhouette import Silhouette, find_silhouette
from fingerpad.image.photograph.orientation import Direction, Face, face_axes, opposite, palmar_directions
from fingerpad.image.photograph.result import PhotographFit
from fingerpad.image.read import ImageLike, colour_levels
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

    The arc is the longest about the pad's middle that one ellipse fits, its ellipse averaged over where the
    arc may end; or all the outline inside `region_of_interest`, or from the first to the last of `points`.
    Beyond its ends the outline, which has no corner, still informs the fit. The ellipse lies along
    the finger's own axis, as its sides show it, within what they leave open.

    No finger is an ellipse. A superellipse, with an exponent for each quadrant, is fitted to the same arc; by
    the odds of the two, what its semi-axes differ by stands in the covariance. Where its mean exponent
    departs from 2 significantly, the flag ``not_an_ellipse`` says so.

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
        If the picture, region or marks are no good, no finger stands out, or the frame cuts the pad.
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
    pixels, scale = colour_levels(image), as_scale(scale)
    light = opponent_light(check_image(pixels))
    size = (light.shape[0], light.shape[1])
    window = None if region_of_interest is None else check_window(region_of_interest, size)
    marks = None if points is None else check_marks(points, size)
    silhouette = find_silhouette(light, None if face == "distal" else opposite(tip), window)
    edges = _outline(light, silhouette)
    marked = window is not None or marks is not None
    tried: list[PhotographFit] = []
    errors: list[ImageError | FitError] = []
    for side in sides:
        try:
            if not marked:
                check_not_cut(silhouette, pad_sides(face, tip, side), tip)
            arc = _pad_arc(edges, (face, face_axes(face, tip, side)), scale, window, marks)
            border = (*(np.array(light.shape[:2]) - 1.0).tolist(), 6.0 + 3 * silhouette.reduction)
            tried.append(face_from_arc(replace(arc, border=border)))
        except (FitError, ImageError) as error:
            errors.append(error)
    if not tried:
        raise errors[0]
    return replace(max(tried, key=_merit), _picture=np.asarray(pixels))


def _merit(found: PhotographFit) -> float:
    """Return how well an arc determines its ellipse, to distinguish the pad from the dorsal side."""
    relative = np.sqrt(np.diagonal(found.edge_covariance)) / found.semi_axes
    return -float(np.linalg.norm(relative))


def _outline(light: npt.NDArray[np.float32], silhouette: Silhouette) -> SubpixelOutline:
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
    edges: SubpixelOutline,
    face_and_axes: tuple[Face, FloatArray],
    scale: Scale,
    window: Window | None,
    marks: FloatArray | None,
) -> FaceArc:
    """Return the pad's arc: the longest that one ellipse fits, or as marked."""
    (face, axes), place = face_and_axes, edges.points.mean(axis=0)
    local = (edges.points - place) @ axes.T
    tilt, pad = finger_tilt(local, face), candidate_points(local, face)
    if marks is not None:
        order = between(edges, marks)
    elif window is not None:
        order = within(edges, window)
    else:
        order = pad
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
    points, searched = local[every], np.isin(every, order)
    candidates, ends_known = np.flatnonzero(searched), marks is not None or window is not None
    if ends_known:
        arc = fit_arc(points, candidates, tilt)
    else:
        arc = longest_arc(points, candidates, PAD_MIDDLE[face], tilt)
    numbers = np.arange(len(every))
    return FaceArc(
        face=face,
        scale=scale,
        frame=(axes, place),
        tilt=tilt,
        points=points,
        step_ratio=edges.step_ratio[every],
        pad=np.isin(every, pad),
        searched=searched,
        used=np.isin(numbers, arc.used),
        rejected=np.isin(numbers, arc.rejected),
        marked=np.zeros(len(every), dtype=bool),
        erased=np.empty((0, 2)),
        start=np.array(arc.fit.ellipse),
        ends_known=ends_known,
        blur=edges.blur,
    )
