"""The finger pad as a surface: ellipsoid, curvature, placement on a wedge, and the gap to what it touches."""

from fingerpad.geometry.curvature import PrincipalRadii, SurfaceCurvature
from fingerpad.geometry.ellipse import Ellipse
from fingerpad.geometry.ellipsoid import Ellipsoid
from fingerpad.geometry.gap import Counterface, Gap, Paraboloid
from fingerpad.geometry.placement import Placement

__all__ = [
    "Counterface",
    "Ellipse",
    "Ellipsoid",
    "Gap",
    "Paraboloid",
    "Placement",
    "PrincipalRadii",
    "SurfaceCurvature",
]
