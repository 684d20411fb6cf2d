"""The gap between an ellipsoidal pad and a plate, by five numbers."""

from dataclasses import dataclass, fields
from typing import Self

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array, broadcast_named, check_all, set_fields
from fingerpad._display import Displayed
from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Ellipsoid
from fingerpad.geometry.curvature import curvatures_of
from fingerpad.geometry.ellipsoid import tangents
from fingerpad.geometry.placement import checked_placement, platen_normal_kernel


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class PadGap(Displayed):
    r"""The gap of a whole ellipsoid, exactly, in the axes of its principal curvatures.

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

    Raises
    ------
    GeometryError
        If a radius is not positive. NaN passes.

    Examples
    --------
    The gap of a sphere of radius 10 mm:

    >>> gap = PadGap.of(Ellipsoid(palmar=10.0, distal=10.0, radial_ulnar=10.0), wedge_angle=np.radians(30))
    >>> print(f"{gap.first_radius:.1f} mm, {gap.flatness:.2f} per mm")
    10.0 mm, 0.10 per mm
    """

    first_radius: FloatArray
    second_radius: FloatArray
    first_skewness: FloatArray
    second_skewness: FloatArray
    flatness: FloatArray

    def __post_init__(self) -> None:
        values = {field.name: as_float_array(getattr(self, field.name), field.name) for field in fields(self)}
        for name in ("first_radius", "second_radius"):
            check_all(~(values[name].real <= 0), name, values[name].real, "positive", GeometryError)
        set_fields(self, **values)

    @classmethod
    def paraboloid(cls, first_radius: ArrayLike, second_radius: ArrayLike) -> Self:
        """Return the gap of Hertz theory, from relative principal radii.

        Parameters
        ----------
        first_radius, second_radius : array_like
            R1 and R2, of any shapes that broadcast.

        Returns
        -------
        PadGap
            Without skewness or flatness.

        Examples
        --------
        >>> float(PadGap.paraboloid(12.0, 14.0).flatness)
        0.0
        """
        first, second = broadcast_named(first_radius=first_radius, second_radius=second_radius)
        zero = np.zeros(first.shape)
        return cls(
            first_radius=first,
            second_radius=second,
            first_skewness=zero,
            second_skewness=zero,
            flatness=zero,
        )

    @classmethod
    def of(cls, pad: Ellipsoid, *, wedge_angle: ArrayLike, roll_angle: ArrayLike = 0.0) -> "PadGap":
        """Return the gap of a pad on its wedge, against a flat plate.

        Parameters
        ----------
        pad : Ellipsoid
            One pad, or many.
        wedge_angle, roll_angle : array_like
            Placement, radians, of any shapes that broadcast with the pads.

        Returns
        -------
        PadGap
            Shapes broadcast.

        Raises
        ------
        GeometryError
            If the angles are those of no placement.

        Examples
        --------
        >>> pad = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
        >>> gap = PadGap.of(pad, wedge_angle=np.radians(30))
        >>> print(f"{gap.first_radius:.3f} mm, {gap.second_radius:.3f} mm")
        12.955 mm, 14.330 mm
        >>> print(f"{gap.first_skewness:.4f} per mm, {gap.flatness:.4f} per mm")
        -0.0453 per mm, 0.1295 per mm
        """
        angles = checked_placement(wedge_angle, roll_angle, margin=0.5)
        broadcast_named(pad=pad.palmar, wedge_angle=angles[0])  # or refuse the shapes
        normal = platen_normal_kernel(*angles)
        return pad_gap_kernel(pad.semi_axes, normal)


@np.errstate(all="ignore")
def pad_gap_kernel(semi_axes: FloatArray, normal: FloatArray) -> PadGap:
    """Return the gap of pads of semi-axes of shape (..., 3) where their outward normal is `normal`."""
    flatness = 1 / semi_axes**2
    support = np.sqrt(np.sum((semi_axes * normal) ** 2, axis=-1))
    along, across = tangents(normal)

    def product(one: FloatArray, other: FloatArray) -> FloatArray:
        total: FloatArray = support * np.sum(one * flatness * other, axis=-1)
        return total

    first, second, mixed = product(along, along), product(across, across), product(along, across)
    curvatures = curvatures_of(first, second, mixed)
    skew_along, skew_across = product(normal, along), product(normal, across)
    cosine, sine = _direction(first - second, 2 * mixed)
    return PadGap(
        first_radius=1 / curvatures[..., 0],
        second_radius=1 / curvatures[..., 1],
        first_skewness=cosine * skew_along + sine * skew_across,
        second_skewness=cosine * skew_across - sine * skew_along,
        flatness=product(normal, normal),
    )


def _direction(difference: FloatArray, twice_mixed: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return cosine and sine of the angle, within 45°, to the first principal direction."""
    flip = np.where(difference.real < 0, -1.0, 1.0)
    size = np.sqrt(difference * difference + twice_mixed * twice_mixed)
    double = np.where(size == 0, 1.0, flip * difference / np.where(size == 0, 1.0, size))
    cosine = np.sqrt((1 + double) / 2)
    sine = np.where(size == 0, 0.0, flip * twice_mixed / np.where(size == 0, 1.0, size)) / (2 * cosine)
    return cosine, sine
