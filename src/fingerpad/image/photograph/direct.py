"""Semi-axes measured directly, as lengths between marks."""

import math

import numpy as np

from fingerpad._arrays import as_float_array
from fingerpad.exceptions import ImageError
from fingerpad.image.photograph.faces import FaceSemiAxes
from fingerpad.image.photograph.orientation import Face
from fingerpad.image.scale import ScaleLike, as_scale


def direct_semi_axes(
    face: Face,
    scale: ScaleLike,
    *,
    centre: tuple[float, float],
    across_end: tuple[float, float],
    along_end: tuple[float, float],
    point_px_std: float = 1.0,
) -> FaceSemiAxes:
    """Measure two semi-axes directly, as the lengths from a marked centre to marked ends.

    The first method of Dzidek et al. (2017), electronic supplement, Table 1, "Direct".

    Parameters
    ----------
    face : Face
        The face that looks at the camera.
    scale : Scale or float
        Millimetres per pixel.
    centre, across_end, along_end : (float, float)
        (row, column), px: centre, and the ends of the semi-axes across and along (see `FACE_AXES`).
    point_px_std : float
        Standard uncertainty of each coordinate of a mark, px.

    Returns
    -------
    FaceSemiAxes
        Across and along, mm, with their covariance.

    Raises
    ------
    ImageError
        If a mark is not finite, an axis has no length, or the two are not about square to each other.

    Examples
    --------
    >>> from fingerpad.image import Scale
    >>> marks = {"centre": (300, 200), "across_end": (300, 436), "along_end": (24, 200)}
    >>> direct_semi_axes("palmar", Scale(0.05), **marks).semi_axes.tolist()
    [11.8, 13.8]
    """
    scale = as_scale(scale)
    ends = as_float_array([across_end, along_end]) - as_float_array(centre)
    lengths = np.linalg.norm(ends, axis=1)
    if not (np.isfinite(lengths).all() and (lengths > 0).all()):
        raise ImageError(f"marks must be finite and apart, found {centre}, {across_end}, {along_end}")
    if not point_px_std >= 0:
        raise ImageError(f"point_px_std must be zero or positive, found {point_px_std}")
    off_square = math.degrees(math.asin(min(1.0, abs(float(ends[0] @ ends[1])) / float(lengths.prod()))))
    if off_square > 15:
        raise ImageError(
            f"the marked semi-axes are {off_square:.0f} degrees off the square: "
            "check that the marks are in their order, centre, across, along"
        )
    return FaceSemiAxes(
        face=face,
        semi_axes=lengths * scale.mm_per_px,
        covariance=2 * (point_px_std * scale.mm_per_px) ** 2 * np.eye(2),
        relative_scale_std=scale.relative_std,
    )
