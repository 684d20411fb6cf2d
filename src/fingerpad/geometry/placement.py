"""Place of contact of a pad with a flat platen, for a finger on a wedge."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np

from fingerpad._arrays import (
    IN_RADIANS,
    ArrayLike,
    FloatArray,
    broadcast,
    broadcast_named,
    check_all,
    set_fields,
)
from fingerpad._display import Displayed
from fingerpad.exceptions import GeometryError
from fingerpad.geometry.curvature import PrincipalRadii, SurfaceCurvature
from fingerpad.geometry.ellipsoid import Ellipsoid
from fingerpad.geometry.gap import Counterface, CounterfaceGap, Gap, gap_kernel


def platen_normal(wedge_angle: ArrayLike, roll_angle: ArrayLike) -> FloatArray:
    """Return the pad's outward unit normal n = (cos θ cos φ, sin θ, cos θ sin φ) at the place of contact.

    Nothing is checked, as random draws of the angles are not.
    """
    wedge, roll = broadcast(wedge_angle, roll_angle)
    return np.stack([np.cos(wedge) * np.cos(roll), np.sin(wedge), np.cos(wedge) * np.sin(roll)], axis=-1)


_UPRIGHT: Final = float(np.float32(np.pi / 2))  # in single precision 4e-8 above π/2


def checked_placement(
    wedge_angle: ArrayLike, roll_angle: ArrayLike, *, margin: float = 0.0
) -> tuple[FloatArray, FloatArray]:
    """Return both angles of a placement, and refuse those that no finger on a wedge has. NaN passes."""
    wedge, roll = broadcast_named(wedge_angle=wedge_angle, roll_angle=roll_angle)
    for name, angle, lowest, limits in (
        ("wedge_angle", wedge, 0.0, "0 and π/2"),
        ("roll_angle", roll, -_UPRIGHT, "-π/2 and π/2"),
    ):
        outside = (angle.real < lowest - margin) | (angle.real > _UPRIGHT + margin)
        check_all(~outside, name, angle.real, f"between {limits} ({IN_RADIANS})", GeometryError)
    return wedge, roll


@dataclass(frozen=True, slots=True, init=False, eq=False, repr=False)
class Placement(Displayed):
    """A finger pad resting on a flat plate or another rigid body; arrays are arrays of placements.

    Parameters
    ----------
    ellipsoid : Ellipsoid
        The pad.
    wedge_angle, roll_angle : array_like
        Wedge angle θ in [0, π/2], radians: 0 lies flat on the palmar face, π/2 stands on the fingertip.
        Roll φ of the finger about its own long axis, in [−π/2, π/2].
    counterface : Counterface, optional
        The rigid body; a flat plate where none is given.

    Attributes
    ----------
    normal : ndarray, shape (..., 3)
        Outward unit normal of the pad at the place of contact.
    point : ndarray, shape (..., 3)
        Place of contact in the pad's own axes.
    u, v : ndarray or float
        Its parametric angles, radians.
    curvature : SurfaceCurvature
        Principal radii and directions of the pad there.

    Raises
    ------
    GeometryError
        If the wedge angle lies outside [0, π/2], the roll outside [−π/2, π/2], or an angle is not finite.

    Examples
    --------
    >>> pad = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
    >>> placement = Placement(pad, wedge_angle=np.radians([30, 45]))
    >>> np.degrees(placement.u).round(3)
    array([45.243, 60.21 ])
    >>> round(float(placement[0].curvature.mean_curvature_radius), 6)
    13.607666
    """

    ellipsoid: Ellipsoid
    wedge_angle: FloatArray
    roll_angle: FloatArray
    counterface: Counterface | None
    normal: FloatArray = field(init=False)
    point: FloatArray = field(init=False)
    u: FloatArray = field(init=False)
    v: FloatArray = field(init=False)
    curvature: SurfaceCurvature = field(init=False)

    def __init__(
        self,
        ellipsoid: Ellipsoid,
        *,
        wedge_angle: ArrayLike,
        roll_angle: ArrayLike = 0.0,
        counterface: Counterface | None = None,
    ) -> None:
        if not isinstance(ellipsoid, Ellipsoid):
            raise GeometryError(f"ellipsoid must be an Ellipsoid, found {type(ellipsoid).__name__}")
        if not isinstance(counterface, Counterface | None):
            raise GeometryError(f"counterface must be a Counterface, found {type(counterface).__name__}")
        wedge, roll = checked_placement(wedge_angle, roll_angle)
        for name, angle in (("wedge_angle", wedge), ("roll_angle", roll)):
            check_all(np.isfinite(angle), name, angle, "finite", GeometryError)
        broadcast_named(
            ellipsoid=ellipsoid.palmar, wedge_angle=wedge, roll_angle=roll
        )  # or refuse the shapes
        normal = platen_normal(wedge, roll)
        u, v = ellipsoid.parametric_angles(normal)
        set_fields(
            self,
            ellipsoid=ellipsoid,
            wedge_angle=wedge,
            roll_angle=roll,
            counterface=counterface,
            normal=normal,
            point=ellipsoid.contact_point(normal),
            u=u,
            v=v,
            curvature=ellipsoid.curvature_at_normal(normal),
        )

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the array of placements; empty for one."""
        return self.point.shape[:-1]

    @property
    def relative_radii(self) -> PrincipalRadii:
        """Relative principal radii of the pad and the body that it touches."""
        if self.counterface is None:
            return self.curvature.principal_radii
        gap = self.gap
        return PrincipalRadii(gap.first_radius, gap.second_radius)

    @property
    def gap(self) -> Gap | CounterfaceGap:
        """The gap between the pad and the body that it touches."""
        pad = self.ellipsoid
        gap = gap_kernel(pad.palmar, pad.distal, pad.radial_ulnar, normal=self.normal)
        return gap if self.counterface is None else CounterfaceGap.of(gap, self.counterface)

    def __len__(self) -> int:
        """Return the number of placements along the first axis of an array of them."""
        if not self.shape:
            raise TypeError("one placement has no length")
        return self.shape[0]

    def __getitem__(self, index: Any) -> Placement:
        """Return one or some of an array of placements."""
        pad = self.ellipsoid
        axes = (pad.palmar, pad.distal, pad.radial_ulnar, self.wedge_angle, self.roll_angle)
        palmar, distal, radial_ulnar, wedge, roll = (
            np.broadcast_to(each, self.shape)[index] for each in axes
        )
        return Placement(
            Ellipsoid(palmar=palmar, distal=distal, radial_ulnar=radial_ulnar),
            wedge_angle=wedge,
            roll_angle=roll,
            counterface=self.counterface,
        )
