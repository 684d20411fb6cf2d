"""Semi-axes of the finger pad from a photograph of one face before a plain backdrop.

The finger is separated from the backdrop by colour, its outline located to a fraction of a pixel, the arc of
the pad selected, and an ellipse along the finger's axis fitted to it by least orthogonal distance.
"""

import math
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import ArrayLike, FloatArray
from fingerpad.exceptions import FitError, ImageError
from fingerpad.geometry.faces import Direction, Face, face_axes, opposite, palmar_directions
from fingerpad.image.ellipse import rotation
from fingerpad.image.inputs import ImageLike, ScaleLike, as_scale, colour_levels
from fingerpad.image.photograph._arc import (
    PAD_MIDDLE,
    PadArc,
    add_departure,
    add_shared_errors,
    candidate_points,
    fit_arc,
    longest_arc,
)
from fingerpad.image.photograph._arc_averaging import average_over_ends
from fingerpad.image.photograph._arc_extension import extend_arc
from fingerpad.image.photograph._departure import is_significant, with_departure
from fingerpad.image.photograph._edges import SubpixelOutline, locate_edges
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
from fingerpad.image.photograph._reach import with_reach
from fingerpad.image.photograph._silhouette import Silhouette, find_silhouette
from fingerpad.image.photograph.outline_fit import turns_from
from fingerpad.image.photograph.result import PhotographFit, size_flags
from fingerpad.image.scale import Scale

_SHORT_ARC_DEG = 90.0
_MAX_RELATIVE_STD = 0.4
# Step across the edge over the noise beside it.
_LOW_CONTRAST = 30.0
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
            axes = face_axes(face, tip, side)
            arc, place = _pad_arc(edges, face, axes, window, marks)
            found = _result(arc, (axes, place), (edges, silhouette), face, scale)
            order = candidate_points((edges.points - place) @ axes.T, face)
            found = replace(found, outline=edges.points[order[edges.found[order]]])
            tried.append(found if marked else with_reach(found, arc.tilt))
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
    edges: SubpixelOutline, face: Face, axes: FloatArray, window: Window | None, marks: FloatArray | None
) -> tuple[PadArc, FloatArray]:
    """Return the pad's arc in the face's frame, and the place of that frame's origin in the picture."""
    place = edges.points.mean(axis=0)
    local = (edges.points - place) @ axes.T
    tilt = finger_tilt(local, face)
    if marks is not None:
        order = between(edges, marks)
    elif window is not None:
        order = within(edges, window)
    else:
        order = candidate_points(local, face)
    found = order[edges.found[order]]
    middle = PAD_MIDDLE[face]
    if len(found) < _MIN_POINTS:
        raise FitError(
            f"only {len(found)} points of the finger's outline lie on the {face} face's arc: "
            "widen region_of_interest, or mark points on the pad"
        )
    if marks is None and window is None:
        arc = longest_arc(local, found, middle, tilt)
        arc = average_over_ends(local, found, arc, middle=middle, tilt=tilt, spacing=edges.spacing)
    else:
        arc = extend_arc(local, edges, fit_arc(local, found, tilt), tilt)
    return add_departure(add_shared_errors(arc, edges), local, found, face, tilt), place


def _result(
    arc: PadArc,
    frame: tuple[FloatArray, FloatArray],
    seen: tuple[SubpixelOutline, Silhouette],
    face: Face,
    scale: Scale,
) -> PhotographFit:
    """Return what was fitted in the face's frame, as lengths and as places in the picture."""
    fit, (axes, place), (edges, silhouette) = arc.fit, frame, seen
    x, y, semi_x, semi_y, tilt = fit.ellipse
    centre = np.array([x, y]) @ axes + place
    middle = PAD_MIDDLE[face]
    local = (edges.points[arc.used] - place) @ axes.T
    angles = middle + turns_from(middle, local, fit.ellipse)
    found = PhotographFit(
        face=face,
        semi_axes=np.array([semi_x, semi_y]) * scale.mm_per_px,
        edge_covariance=fit.covariance[2:4, 2:4] * scale.mm_per_px**2,
        scale=scale,
        centre=(float(centre[0]), float(centre[1])),
        directions=rotation(tilt).T @ axes,
        tilt=tilt,
        tilt_std=math.sqrt(fit.covariance[4, 4]),
        arc=(float(angles.min()), float(angles.max())),
        points=edges.points[arc.used],
        outliers=edges.points[arc.rejected],
        correlation_px=fit.correlation * edges.spacing,
        residual_px_std=fit.residual_std,
        blur_px=edges.blur,
        flags=frozenset(),
    )
    relative = float((np.sqrt(np.diagonal(found.edge_covariance)) / found.semi_axes).max())
    if not relative < _MAX_RELATIVE_STD:
        raise FitError(
            f"the {face} face's arc of {found.arc_deg:.0f} degrees leaves an axis unknown by {relative:.0%}: "
            "mark a longer arc, come nearer, or choose a backdrop of another colour than the skin"
        )
    found = with_departure(found, fit.ellipse, arc.departure)
    contrast = float(np.quantile(edges.step_ratio[arc.used], 0.25))
    return replace(found, flags=_flags(found, contrast, silhouette))


def _flags(found: PhotographFit, contrast: float, silhouette: Silhouette) -> frozenset[str]:
    """Return what makes a measurement doubtful."""
    semi_px = float(found.semi_axes.min()) / found.scale.mm_per_px
    relative = np.sqrt(np.diagonal(found.edge_covariance)) / found.semi_axes
    size = np.array(silhouette.mask.shape) * silhouette.reduction
    margin = np.minimum(found.points, size - 1 - found.points).min()
    holds = {
        "short_arc": found.arc_deg < _SHORT_ARC_DEG,
        "uncertain": float(relative.max()) > 0.02,
        "many_outliers": found.outlier_fraction > 0.15,
        "low_contrast": contrast < _LOW_CONTRAST,
        "soft_edges": found.blur_px > 0.02 * semi_px,
        "touches_border": float(margin) < 6 + 3 * silhouette.reduction,
        "poor_ellipse": found.residual_px_std > max(0.01 * semi_px, 0.5),
        "not_an_ellipse": is_significant(found.exponent, found.exponent_std),
        "tilted": abs(found.tilt) > math.radians(10),
    }
    return frozenset(name for name, held in holds.items() if held) | size_flags(found.semi_axes)
