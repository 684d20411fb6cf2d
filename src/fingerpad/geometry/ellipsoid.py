"""The finger pad as an ellipsoidal cap."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fingerpad._arrays import (
    ArrayLike,
    FloatArray,
    as_float_array,
    broadcast,
    broadcast_named,
    check_all,
    check_radians,
    hypotenuse,
    set_fields,
)
from fingerpad._display import Displayed
from fingerpad.exceptions import GeometryError
from fingerpad.geometry.curvature import (
    PrincipalRadii,
    SurfaceCurvature,
    curvatures_of,
    inverse_of,
    principal_curvatures,
)


@dataclass(frozen=True, slots=True, init=False, eq=False, repr=False)
class Ellipsoid(Displayed):
    """The ellipsoid x²/ℓa² + y²/ℓb² + z²/ℓc² = 1.

    x points out of the palmar face, y out of the fingertip, z across the finger. The surface is
    (ℓa cos u sin v, ℓb sin u sin v, ℓc cos v); u is the parametric angle, not the polar one.

    Attributes
    ----------
    palmar, distal, radial_ulnar : array_like
        Semi-axes ℓa, ℓb, ℓc, in one unit of length, of any shapes that broadcast; never sorted.

    Raises
    ------
    GeometryError
        If a semi-axis is not positive and finite.

    Examples
    --------
    >>> pad = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
    >>> pad.point(u=0.0, v=np.pi / 2).round(3) + 0.0
    array([7.9, 0. , 0. ])
    """

    palmar: FloatArray
    distal: FloatArray
    radial_ulnar: FloatArray

    def __init__(self, palmar: ArrayLike, distal: ArrayLike, radial_ulnar: ArrayLike) -> None:
        names = ("palmar", "distal", "radial_ulnar")
        given = broadcast_named(palmar=palmar, distal=distal, radial_ulnar=radial_ulnar)
        axes = dict(zip(names, given, strict=True))
        for name, axis in axes.items():
            check_all(
                np.isfinite(axis) & (axis > 0),
                f"semi-axis {name}",
                axis,
                "positive and finite",
                GeometryError,
            )
        set_fields(self, **axes)

    @property
    def semi_axes(self) -> FloatArray:
        """Semi-axes ℓa, ℓb, ℓc along the last axis, shape (..., 3)."""
        return np.stack([self.palmar, self.distal, self.radial_ulnar], axis=-1)

    def point(self, u: ArrayLike, v: ArrayLike) -> FloatArray:
        """Return surface points at parametric angles.

        Parameters
        ----------
        u, v : array_like
            Parametric angles, radians.

        Returns
        -------
        ndarray, shape (..., 3)
            Points (ℓa cos u sin v, ℓb sin u sin v, ℓc cos v).

        Raises
        ------
        GeometryError
            If an angle is beyond a full turn either way, as degrees are.
        """
        u, v = broadcast(check_radians("u", u), check_radians("v", v))
        direction: FloatArray = np.stack([np.cos(u) * np.sin(v), np.sin(u) * np.sin(v), np.cos(v)], axis=-1)
        return self.semi_axes * direction

    def normal(self, u: ArrayLike, v: ArrayLike) -> FloatArray:
        """Return outward unit normals at parametric angles.

        Parameters
        ----------
        u, v : array_like
            Parametric angles, radians.

        Returns
        -------
        ndarray, shape (..., 3)
            Unit vectors.
        """
        gradient = self.point(u, v) / self.semi_axes**2
        normal: FloatArray = gradient / np.linalg.norm(gradient, axis=-1, keepdims=True)
        return normal

    def contact_point(self, normal: ArrayLike) -> FloatArray:
        """Return the point whose outward normal is `normal`, where a flat plate touches.

        p = (ℓa² nx, ℓb² ny, ℓc² nz)/√(ℓa² nx² + ℓb² ny² + ℓc² nz²).

        Parameters
        ----------
        normal : array_like, shape (..., 3)
            Unit vectors.

        Returns
        -------
        ndarray, shape (..., 3)
            Points of the surface.
        """
        normal = as_float_array(normal)
        return self.semi_axes**2 * normal / self._support(normal)[..., None]

    def parametric_angles(self, normal: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return the parametric angles of the point whose outward normal is `normal`.

        Parameters
        ----------
        normal : array_like, shape (..., 3)
            Unit vectors.

        Returns
        -------
        u, v : ndarray
            In (−π, π] and [0, π], radians.
        """
        x, y, z = np.moveaxis(self.semi_axes * as_float_array(normal), -1, 0)
        return np.arctan2(y, x), np.arctan2(np.hypot(x, y), z)

    def curvature(self, u: ArrayLike, v: ArrayLike) -> SurfaceCurvature:
        """Return principal radii and directions at parametric angles, poles included.

        Parameters
        ----------
        u, v : array_like
            Parametric angles, radians.

        Returns
        -------
        SurfaceCurvature
            First principal direction nearer to the finger's axis.
        """
        return self.curvature_at_normal(self.normal(u, v))

    def curvature_at_normal(self, normal: ArrayLike) -> SurfaceCurvature:
        """Return principal radii and directions where the outward normal is `normal`.

        Parameters
        ----------
        normal : array_like, shape (..., 3)
            Unit vectors.

        Returns
        -------
        SurfaceCurvature
            First principal direction nearer to the finger's axis.
        """
        normal = as_float_array(normal)
        curvatures, angle = principal_curvatures(*self._curvature_tensor(normal))
        along, across = tangents(normal)
        cosine, sine = np.cos(angle)[..., None], np.sin(angle)[..., None]
        directions = np.stack([cosine * along + sine * across, cosine * across - sine * along], axis=-2)
        return SurfaceCurvature(principal_radii=inverse_of(curvatures), principal_directions=directions)

    def _curvature_tensor(self, normal: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        return curvature_tensor(self.palmar, self.distal, self.radial_ulnar, normal)

    def _support(self, normal: FloatArray) -> FloatArray:
        return support_function(self.palmar, self.distal, self.radial_ulnar, normal)


def principal_radii_kernel(
    palmar: FloatArray, distal: FloatArray, radial_ulnar: FloatArray, *, normal: FloatArray
) -> PrincipalRadii:
    """Return the principal radii where the outward normal is `normal`; no semi-axis is checked.

    Random draws and complex steps of an uncertainty need it: no single draw may stop the others.
    """
    return inverse_of(curvatures_of(*curvature_tensor(palmar, distal, radial_ulnar, normal)))


def curvature_tensor(
    palmar: FloatArray, distal: FloatArray, radial_ulnar: FloatArray, normal: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the curvatures along and across the finger, and the mixed one.

    The shape operator of the level surface ½ pᵀQp, Q = diag(1/ℓ²), is the tangential part of
    Q/‖Qp‖, and 1/‖Qp‖ is the support function h(n) = √(Σ ℓ²n²).
    """
    y, radius, cosine, sine = _parts(normal)
    support = support_function(palmar, distal, radial_ulnar, normal)
    flatness_x, flatness_y, flatness_z = 1 / palmar**2, 1 / distal**2, 1 / radial_ulnar**2
    return (
        support * (y**2 * (cosine**2 * flatness_x + sine**2 * flatness_z) + radius**2 * flatness_y),
        support * (sine**2 * flatness_x + cosine**2 * flatness_z),
        support * y * cosine * sine * (flatness_x - flatness_z),
    )


def support_function(
    palmar: FloatArray, distal: FloatArray, radial_ulnar: FloatArray, normal: FloatArray
) -> FloatArray:
    """Return the support function h(n), the distance from the centre to the tangent plane."""
    x, y, z = np.moveaxis(normal, -1, 0)
    squared: FloatArray = (palmar * x) ** 2 + (distal * y) ** 2 + (radial_ulnar * z) ** 2
    return np.sqrt(squared)


def _parts(normal: FloatArray) -> tuple[FloatArray, ...]:
    """Return y, √(x² + z²), and cosine and sine of the roll of unit normals."""
    x, y, z = np.moveaxis(normal, -1, 0)
    radius = hypotenuse(x, z)
    at_tip = radius == 0  # there the roll has no meaning, and is taken to be none
    radius_or_one = np.where(at_tip, 1.0, radius)
    return y, radius, np.where(at_tip, 1.0, x / radius_or_one), z / radius_or_one


def tangents(normal: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return unit tangents along the finger, the projection of its axis y, and across it."""
    y, radius, cosine, sine = _parts(normal)
    along = np.stack([-y * cosine, radius, -y * sine], axis=-1)
    across = np.stack([-sine, np.zeros_like(y), cosine], axis=-1)
    return along, across
