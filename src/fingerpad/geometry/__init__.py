"""The finger pad as a surface: ellipsoid, curvature, placement on a wedge, and the plane ellipse."""

from fingerpad.geometry.curvature import (
    PrincipalRadii,
    RelativeCurvature,
    SurfaceCurvature,
    principal_curvatures,
    relative_curvature,
)
from fingerpad.geometry.ellipse import Ellipse
from fingerpad.geometry.ellipsoid import Ellipsoid
from fingerpad.geometry.placement import Placement, platen_normal

__all__ = [
    "Ellipse",
    "Ellipsoid",
    "Placement",
    "PrincipalRadii",
    "RelativeCurvature",
    "SurfaceCurvature",
    "platen_normal",
    "principal_curvatures",
    "relative_curvature",
]
