"""Where on the pad a flat platen touches, from the wedge on which the finger rests."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, broadcast, check_all
from fingerpad.exceptions import GeometryError
from fingerpad.geometry.curvature import SurfaceCurvature
from fingerpad.geometry.ellipsoid import Ellipsoid


def platen_normal(wedge_angle: ArrayLike, roll_angle: ArrayLike = 0.0) -> FloatArray:
    """Return the pad's outward unit normal at the place of contact, shape (..., 3).

    n = (cos θ cos φ, sin θ, cos θ sin φ).

    Parameters
    ----------
    wedge_angle : array_like
        Wedge angle θ, radians: 0 lies flat on the palmar face, π/2 stands on the fingertip.
    roll_angle : array_like
        Roll φ of the finger about its own long axis, radians.

    Examples
    --------
    >>> platen_normal(0.0)
    array([1., 0., 0.])
    """
    wedge, roll = broadcast(wedge_angle, roll_angle)
    return np.stack([np.cos(wedge) * np.cos(roll), np.sin(wedge), np.cos(wedge) * np.sin(roll)], axis=-1)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Placement:
    """A finger pad resting on a flat platen.

    Attributes
    ----------
    normal : ndarray, shape (..., 3)
        Outward unit normal of the pad at the place of contact.
    point : ndarray, shape (..., 3)
        Place of contact in the pad's own axes.
    u, v : ndarray
        Its parametric angles, radians.
    curvature : SurfaceCurvature
        Principal radii and directions there.

    Examples
    --------
    >>> pad = Ellipsoid.of(palmar=7.9, distal=13.8, radial_ulnar=11.8)
    >>> placement = Placement.of(pad, wedge_angle=np.radians(30))
    >>> round(float(np.degrees(placement.u)), 6)
    45.243495
    >>> round(float(placement.curvature.mean_curvature_radius), 6)
    13.607666
    """

    normal: FloatArray
    point: FloatArray
    u: FloatArray
    v: FloatArray
    curvature: SurfaceCurvature

    @classmethod
    def of(cls, ellipsoid: Ellipsoid, *, wedge_angle: ArrayLike, roll_angle: ArrayLike = 0.0) -> Self:
        """Place `ellipsoid` on a wedge of angle in [0, π/2]; angles in radians, as for `platen_normal`.

        Raises
        ------
        GeometryError
            If the wedge angle lies outside [0, π/2] or an angle is not finite.
        """
        wedge, roll = broadcast(wedge_angle, roll_angle)
        inside = (wedge >= 0) & (wedge <= np.pi / 2)
        check_all(inside, "wedge angle (in degrees)", np.degrees(wedge), "between 0° and 90°", GeometryError)
        check_all(np.isfinite(roll), "roll angle (in degrees)", np.degrees(roll), "finite", GeometryError)
        normal = platen_normal(wedge, roll)
        u, v = ellipsoid.parametric_angles(normal)
        return cls(
            normal=normal,
            point=ellipsoid.contact_point(normal),
            u=u,
            v=v,
            curvature=ellipsoid.curvature_at_normal(normal),
        )
