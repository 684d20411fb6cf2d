"""Measure pictures: contact images, and photographs of a finger's faces."""

from fingerpad.image._face_frame import Direction
from fingerpad.image.colour import read_colour_image
from fingerpad.image.direct import direct_semi_axes
from fingerpad.image.ellipse_fit import (
    AlignedEllipseFit,
    EllipseFit,
    RegionEllipse,
    equal_area_ellipse,
    fit_aligned_ellipse,
    fit_ellipse,
)
from fingerpad.image.imprint import (
    FLAGS,
    PLAUSIBLE_RIDGE_PERIOD_MM,
    Imprint,
    ImprintSettings,
    measure_imprint,
)
from fingerpad.image.outline import (
    FACE_AXES,
    Face,
    FaceSemiAxes,
    OutlineSemiAxes,
    combine_faces,
    face_from_outline,
    read_marks,
    read_outline,
    semi_axes_from_outlines,
)
from fingerpad.image.outline_fit import OutlineFit, fit_outline_ellipse
from fingerpad.image.overlay import draw_overlay, write_overlay
from fingerpad.image.photograph import (
    PHOTOGRAPH_FLAGS,
    PhotographFit,
    measure_photograph,
)
from fingerpad.image.photograph_overlay import draw_photograph_overlay, write_photograph_overlay
from fingerpad.image.read import Picture, read_image
from fingerpad.image.scale import Scale
from fingerpad.image.synthetic import SyntheticImprint, outline_points, render_imprint
from fingerpad.image.synthetic_finger import Backdrop, SyntheticFinger, render_finger

__all__ = [
    "FACE_AXES",
    "FLAGS",
    "PHOTOGRAPH_FLAGS",
    "PLAUSIBLE_RIDGE_PERIOD_MM",
    "AlignedEllipseFit",
    "Backdrop",
    "Direction",
    "EllipseFit",
    "Face",
    "FaceSemiAxes",
    "Imprint",
    "ImprintSettings",
    "OutlineFit",
    "OutlineSemiAxes",
    "PhotographFit",
    "Picture",
    "RegionEllipse",
    "Scale",
    "SyntheticFinger",
    "SyntheticImprint",
    "combine_faces",
    "direct_semi_axes",
    "draw_overlay",
    "draw_photograph_overlay",
    "equal_area_ellipse",
    "face_from_outline",
    "fit_aligned_ellipse",
    "fit_ellipse",
    "fit_outline_ellipse",
    "measure_imprint",
    "measure_photograph",
    "outline_points",
    "read_colour_image",
    "read_image",
    "read_marks",
    "read_outline",
    "render_finger",
    "render_imprint",
    "semi_axes_from_outlines",
    "write_overlay",
    "write_photograph_overlay",
]
