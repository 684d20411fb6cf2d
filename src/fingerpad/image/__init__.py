"""Measure pictures: contact images, and photographs of a finger's faces."""

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
from fingerpad.image.outline import FACE_AXES, Face, OutlineSemiAxes, read_outline, semi_axes_from_outlines
from fingerpad.image.overlay import draw_overlay, write_overlay
from fingerpad.image.read import Picture, read_image
from fingerpad.image.scale import Scale
from fingerpad.image.synthetic import SyntheticImprint, outline_points, render_imprint

__all__ = [
    "FACE_AXES",
    "FLAGS",
    "PLAUSIBLE_RIDGE_PERIOD_MM",
    "AlignedEllipseFit",
    "EllipseFit",
    "Face",
    "Imprint",
    "ImprintSettings",
    "OutlineSemiAxes",
    "Picture",
    "RegionEllipse",
    "Scale",
    "SyntheticImprint",
    "draw_overlay",
    "equal_area_ellipse",
    "fit_aligned_ellipse",
    "fit_ellipse",
    "measure_imprint",
    "outline_points",
    "read_image",
    "read_outline",
    "render_imprint",
    "semi_axes_from_outlines",
    "write_overlay",
]
