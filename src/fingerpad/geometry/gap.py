"""The gap between an ellipsoidal pad and the rigid body that it touches, exactly."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Any, Self

import numpy as np

from fingerpad._arrays import (
    ArrayLike,
    FloatArray,
    as_float_array,
    broadcast_named,
    check_all,
    check_positive,
    finite_angle,
    real_number,
    set_fields,
)
from fingerpad._display import Displayed
from fingerpad.exceptions import GeometryError
from fingerpad.geometry.curvature import PrincipalRadii, curvatures_of, half_difference, principal_curvatures
from fingerpad.geometry.ellipsoid import curvature_tensor, support_function, tangents


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Gap(Displayed):
    r"""The gap between ellipsoids and a flat plate, in the axes of their principal curvatures.

    .. math:: g = \frac{q}{\beta + \sqrt{\beta^2 - c q}}, \quad q = \frac{x^2}{R_1} + \frac{y^2}{R_2}, \quad
        \beta = 1 + \mu_1 x + \mu_2 y

    Attributes
    ----------
    first_radius, second_radius : ndarray
        Principal radii of curvature R1, R2, the first along the direction within 45° of the finger's axis.
    first_skewness, second_skewness : ndarray
        μ1, μ2, per length: how fast the gap steepens to one side. Zero where the plate touches the end of an
        axis.
    flatness : ndarray
        c, per length: 1/R for a sphere, 0 for a paraboloid.
    angle : ndarray
        From the finger's axis to the first principal direction, in the tangent plane, radians.

    Raises
    ------
    GeometryError
        If a radius is not positive. NaN passes.

    Examples
    --------
    The gap of a sphere of radius 10 mm, 6 mm from the place of contact:

    >>> gap = Paraboloid(10.0, 10.0).gap
    >>> float(gap.height(np.array(6.0), np.array(0.0)))
    1.8
    """

    first_radius: FloatArray
    second_radius: FloatArray
    first_skewness: FloatArray
    second_skewness: FloatArray
    flatness: FloatArray
    angle: FloatArray

    def __post_init__(self) -> None:
        values = {field.name: as_float_array(getattr(self, field.name), field.name) for field in fields(self)}
        for name in ("first_radius", "second_radius"):
            check_all(~(values[name].real <= 0), name, values[name].real, "positive", GeometryError)
        set_fields(self, **values)

    def __getitem__(self, index: Any) -> Self:
        """Return some of an array of gaps, or the array with more axes."""
        named = {field.name: np.asarray(getattr(self, field.name)) for field in fields(self)}
        values = np.broadcast_arrays(*named.values())
        return type(self)(**{name: value[index] for name, value in zip(named, values, strict=True)})

    @property
    def is_paraboloid(self) -> bool:
        """Whether it is a paraboloid throughout, as in Hertz theory."""
        return not any(
            np.any(number != 0) for number in (self.first_skewness, self.second_skewness, self.flatness)
        )

    def height(self, along: FloatArray, across: FloatArray) -> FloatArray:
        """Return the gap of one pad, NaN beyond its silhouette.

        Parameters
        ----------
        along, across : ndarray
            Coordinates in the tangent plane, along the finger and across it, from the place of contact.

        Returns
        -------
        ndarray
            Gap ≥ 0, in the unit of length of the radii.
        """
        cosine, sine = np.cos(self.angle), np.sin(self.angle)
        x, y = cosine * along + sine * across, cosine * across - sine * along
        q = x * x / self.first_radius + y * y / self.second_radius
        beta = 1 + self.first_skewness * x + self.second_skewness * y
        with np.errstate(invalid="ignore"):
            return q / (beta + np.sqrt(beta * beta - self.flatness * q))


@np.errstate(all="ignore")
def gap_kernel(
    palmar: FloatArray, distal: FloatArray, radial_ulnar: FloatArray, *, normal: FloatArray
) -> Gap:
    """Return the gap of pads where their outward normal is `normal`; nothing is checked.

    Random draws and complex steps of an uncertainty need it: no single draw may stop the others.
    """
    first, second, mixed = curvature_tensor(palmar, distal, radial_ulnar, normal)
    curvatures = curvatures_of(first, second, mixed)
    semi_axes = np.stack(np.broadcast_arrays(palmar, distal, radial_ulnar), axis=-1)
    support = support_function(palmar, distal, radial_ulnar, normal)
    along, across = tangents(normal)
    bent = support[..., None] * normal / semi_axes**2
    skew_along, skew_across, flatness = (np.sum(bent * each, axis=-1) for each in (along, across, normal))
    cosine, sine = _direction(0.5 * (first - second), mixed, half_difference(first, second, mixed))
    return Gap(
        first_radius=1 / curvatures[..., 0],
        second_radius=1 / curvatures[..., 1],
        first_skewness=cosine * skew_along + sine * skew_across,
        second_skewness=cosine * skew_across - sine * skew_along,
        flatness=flatness,
        angle=np.arctan2(sine.real, cosine.real),
    )


def _direction(along: FloatArray, mixed: FloatArray, half: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return cosine and sine of the angle, within 45°, to the first principal direction.

    `along` is half of what the curvature along the finger is more than that across it, `half` the same of
    the principal ones.
    """
    size = np.where(half == 0, 1.0, half)
    cosine = np.sqrt((1 + np.where(half == 0, 1.0, along / size)) / 2)
    return cosine, mixed / size / (2 * cosine)


@dataclass(frozen=True, slots=True, init=False, eq=False, repr=False)
class Paraboloid(Displayed):
    """Two bodies by their relative principal radii of curvature, as Hertz theory has them.

    Takes the place of a `Placement` where no ellipsoid is known.

    Attributes
    ----------
    first_radius, second_radius : array_like
        Relative principal radii, in either order of size, of any shapes that broadcast; along the finger and
        across it, where there is one.

    Raises
    ------
    GeometryError
        If a radius is not positive and finite.

    Examples
    --------
    >>> Paraboloid(12.955, 14.330)
    Paraboloid(first_radius=12.955, second_radius=14.33)
    """

    first_radius: FloatArray
    second_radius: FloatArray

    def __init__(self, first_radius: ArrayLike, second_radius: ArrayLike) -> None:
        first, second = broadcast_named(first_radius=first_radius, second_radius=second_radius)
        check_positive("first_radius", first, GeometryError)
        check_positive("second_radius", second, GeometryError)
        set_fields(self, first_radius=first, second_radius=second)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the array of contacts; empty for one."""
        return self.first_radius.shape

    @property
    def relative_radii(self) -> PrincipalRadii:
        """The two radii."""
        return PrincipalRadii(self.first_radius, self.second_radius)

    @property
    def gap(self) -> Gap:
        """The gap of the two bodies."""
        return paraboloid_gap(self.first_radius, self.second_radius)


def paraboloid_gap(first: FloatArray, second: FloatArray) -> Gap:
    """Return the gap of Hertz theory, from relative principal radii that nothing has checked."""
    zero = np.zeros(np.broadcast_shapes(np.shape(first), np.shape(second)))
    return Gap(
        first_radius=first,
        second_radius=second,
        first_skewness=zero,
        second_skewness=zero,
        flatness=zero,
        angle=zero,
    )


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Counterface(Displayed):
    """A curved rigid body that a pad is pressed against: a sphere or a cylinder.

    Attributes
    ----------
    radius : float
        Radius of the sphere or cylinder.
    axis_angle : float or None
        Angle from the finger's axis to the cylinder's, in the common tangent plane, radians; None for a
        sphere.

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

    radius: float
    axis_angle: float | None = None

    def __post_init__(self) -> None:
        radius = real_number(self.radius, "radius", GeometryError)
        check_all(radius > 0, "radius", radius, "positive", GeometryError)
        angle = None if self.axis_angle is None else finite_angle("axis_angle", self.axis_angle)
        set_fields(self, radius=radius, axis_angle=angle)

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
        squared = along**2 + across**2
        if self.axis_angle is not None:
            squared = (across * math.cos(self.axis_angle) - along * math.sin(self.axis_angle)) ** 2
        with np.errstate(invalid="ignore"):
            return squared / (self.radius + np.sqrt(self.radius**2 - squared))

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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class CounterfaceGap(Displayed):
    """The gap between a pad and a curved rigid body.

    `first_radius` and `second_radius` are relative radii of the two; `angle` (rad) is that from the finger's
    axis to the first relative principal direction, and `pad` the pad's gap to the tangent plane.
    """

    first_radius: FloatArray
    second_radius: FloatArray
    angle: FloatArray
    pad: Gap
    counterface: Counterface

    @classmethod
    def of(cls, pad: Gap, counterface: Counterface) -> Self:
        """Return the gap of a pad and a body that touches it: the curvature tensors add."""
        cosine, sine = np.cos(pad.angle), np.sin(pad.angle)
        first, second = 1 / pad.first_radius, 1 / pad.second_radius
        other = counterface.curvature_tensor()
        curvatures, angle = principal_curvatures(
            cosine**2 * first + sine**2 * second + other[0, 0],
            sine**2 * first + cosine**2 * second + other[1, 1],
            cosine * sine * (first - second) + other[0, 1],
        )
        return cls(
            first_radius=1 / curvatures[..., 0],
            second_radius=1 / curvatures[..., 1],
            angle=angle,
            pad=pad,
            counterface=counterface,
        )

    def height(self, along: FloatArray, across: FloatArray) -> FloatArray:
        """Return the gap, NaN beyond the silhouette of either; as `Gap.height`."""
        return self.pad.height(along, across) + self.counterface.height(along, across)
