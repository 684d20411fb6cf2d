"""The gap between an ellipsoidal pad and the rigid body that touches it."""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np

from fingerpad._arrays import FloatArray, check_all, finite_angle, real_number, set_fields
from fingerpad._display import Displayed
from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Ellipsoid
from fingerpad.geometry.ellipsoid import tangents


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Counterface(Displayed):
    """The rigid body that the pad is pressed against: a plate, a sphere or a cylinder.

    Attributes
    ----------
    radius : float
        Radius of the sphere or cylinder; infinite for a plate.
    axis_angle : float or None
        Angle from the finger's axis to the cylinder's, in the common tangent plane, radians; None for a
        plate or sphere.

    Raises
    ------
    GeometryError
        If the radius is not positive, or the angle not finite or beyond a full turn, as degrees are.

    Examples
    --------
    >>> Counterface.sphere(5.0).height(np.array(3.0), np.array(0.0))
    np.float64(1.0)
    >>> Counterface.cylinder(5.0, axis_angle=0.0).height(np.array(3.0), np.array(0.0))
    np.float64(0.0)
    """

    radius: float = math.inf
    axis_angle: float | None = None

    def __post_init__(self) -> None:
        radius = real_number(self.radius, "radius", GeometryError)
        check_all(radius > 0, "radius", radius, "positive", GeometryError)
        angle = None if self.axis_angle is None else finite_angle("axis_angle", self.axis_angle)
        set_fields(self, radius=radius, axis_angle=angle)

    @classmethod
    def plate(cls) -> Self:
        """Return a flat plate.

        Returns
        -------
        Counterface
            Of infinite radius.
        """
        return cls()

    @classmethod
    def sphere(cls, radius: float) -> Self:
        """Return a sphere.

        Parameters
        ----------
        radius : float
            Radius.

        Returns
        -------
        Counterface
            The sphere.
        """
        return cls(radius=radius)

    @classmethod
    def cylinder(cls, radius: float, *, axis_angle: float) -> Self:
        """Return a cylinder.

        Parameters
        ----------
        radius : float
            Radius.
        axis_angle : float
            Angle from the finger's axis to the cylinder's, in the common tangent plane, radians.

        Returns
        -------
        Counterface
            The cylinder.
        """
        return cls(radius=radius, axis_angle=axis_angle)

    def height(self, along: FloatArray, across: FloatArray) -> FloatArray:
        """Return the distance of the surface from the tangent plane, NaN beyond its silhouette.

        Parameters
        ----------
        along, across : ndarray
            Coordinates in the tangent plane, along and across the finger, from the place of contact.

        Returns
        -------
        ndarray
            Distances ≥ 0.
        """
        if math.isinf(self.radius):
            return np.zeros(np.broadcast_shapes(along.shape, across.shape))
        squared = along**2 + across**2
        if self.axis_angle is not None:
            squared = (across * math.cos(self.axis_angle) - along * math.sin(self.axis_angle)) ** 2
        with np.errstate(invalid="ignore"):
            height: FloatArray = squared / (self.radius + np.sqrt(self.radius**2 - squared))
        return height

    def curvature_tensor(self) -> FloatArray:
        """Return the curvatures along and across the finger and the mixed one.

        Returns
        -------
        ndarray, shape (2, 2)
            Curvature tensor, 1/length.
        """
        if self.axis_angle is None:
            return np.eye(2) / self.radius
        across_axis = np.array([-math.sin(self.axis_angle), math.cos(self.axis_angle)])
        return np.outer(across_axis, across_axis) / self.radius


def ellipsoid_gap(
    pad: Ellipsoid,
    normal: FloatArray,
    along: FloatArray,
    across: FloatArray,
    counterface: Counterface | None = None,
) -> FloatArray:
    """Return the gap between a pad and the body that touches it, NaN beyond the silhouette of either.

    Parameters
    ----------
    pad : Ellipsoid
        One pad.
    normal : ndarray, shape (3,)
        Its outward normal at the place of contact.
    along, across : ndarray
        Coordinates in the tangent plane, along and across the finger, from the place of contact.
    counterface : Counterface, optional
        The rigid body; a plate where none is given.

    Returns
    -------
    ndarray
        Gap ≥ 0, zero at the origin, in the unit of length of the pad.

    Examples
    --------
    >>> ball = Ellipsoid(10.0, 10.0, 10.0)
    >>> ellipsoid_gap(ball, np.array([1.0, 0.0, 0.0]), np.array(6.0), np.array(0.0)).round(12)
    np.float64(2.0)
    """
    first, second = tangents(normal)
    start = pad.contact_point(normal) + along[..., None] * first + across[..., None] * second
    # |(start − g n)/ℓ|² = 1, of which the smaller root g is the near side of the pad.
    quadratic = np.sum((normal / pad.semi_axes) ** 2)
    half_linear = np.sum(start * normal / pad.semi_axes**2, axis=-1)
    constant = np.sum((start / pad.semi_axes) ** 2, axis=-1) - 1
    with np.errstate(invalid="ignore"):
        root = np.sqrt(half_linear**2 - quadratic * constant)
    gap: FloatArray = constant / (half_linear + root)
    return gap if counterface is None else gap + counterface.height(along, across)


def relative_curvature_tensor(pad: Ellipsoid, normal: FloatArray, counterface: Counterface) -> FloatArray:
    """Return the sum of the curvature tensors, along and across the finger, shape (2, 2).

    Parameters
    ----------
    pad, normal, counterface
        As for `ellipsoid_gap`.
    """
    plane = np.stack(tangents(normal))
    surface = pad.curvature_at_normal(normal)
    directions = plane @ surface.principal_directions.T  # columns: the principal directions in the plane
    own: FloatArray = directions @ np.diag(1 / np.array(surface.principal_radii)) @ directions.T
    return own + counterface.curvature_tensor()
