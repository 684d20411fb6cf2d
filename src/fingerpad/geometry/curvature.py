"""Principal curvatures of one surface at a point, and the relative curvature of two that touch there."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

import numpy as np

from fingerpad._arrays import (
    ArrayLike,
    FloatArray,
    broadcast,
    check_all,
    check_radians,
    hypotenuse,
)
from fingerpad._display import Displayed
from fingerpad.exceptions import GeometryError

# Two radii, either of which may be an array: a tuple, or two numbers.
RadiusPair: TypeAlias = tuple[ArrayLike, ArrayLike] | Sequence[float] | FloatArray


class PrincipalRadii(NamedTuple):
    """Two principal radii of curvature, each a number or an array over points.

    Attributes
    ----------
    first, second : ndarray or float
        In the order of the principal directions, not sorted.

    Examples
    --------
    >>> import numpy as np
    >>> from fingerpad.geometry import Ellipsoid, Placement
    >>> pad = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
    >>> first, second = Placement(pad, wedge_angle=np.radians([30, 45])).curvature.principal_radii
    >>> first.round(2), second.round(2)
    (array([12.95,  8.36]), array([14.33, 12.38]))
    """

    first: FloatArray
    second: FloatArray


def inverse_of(curvatures: FloatArray) -> PrincipalRadii:
    """Return the radii of principal curvatures of shape (..., 2)."""
    radii = 1 / curvatures
    return PrincipalRadii(radii[..., 0][()], radii[..., 1][()])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SurfaceCurvature(Displayed):
    """Principal radii and directions of a surface at points of it.

    Attributes
    ----------
    principal_radii : PrincipalRadii
        Radii of curvature, positive where the surface is convex. They keep their identity and are not
        sorted: on a finger pad the first is the one whose direction lies nearer to the finger's long axis
        (in-plane), the second the one across it (transverse).
    principal_directions : ndarray, shape (..., 2, 3)
        Unit tangent vectors, in the order of the radii.

    Examples
    --------
    >>> import numpy as np
    >>> from fingerpad.geometry import Ellipsoid
    >>> pad = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
    >>> curvature = pad.curvature(u=np.pi / 4, v=np.pi / 2)
    >>> np.round(curvature.principal_radii, 2)
    array([13.04, 14.36])
    >>> round(float(curvature.mean_curvature_radius), 2)
    13.67
    """

    principal_radii: PrincipalRadii
    principal_directions: FloatArray

    @property
    def in_plane_radius(self) -> FloatArray:
        """Principal radius along the finger."""
        return self.principal_radii.first

    @property
    def transverse_radius(self) -> FloatArray:
        """Principal radius across the finger."""
        return self.principal_radii.second

    @property
    def mean_curvature(self) -> FloatArray:
        """Mean curvature H = (1/R' + 1/R'')/2."""
        return 0.5 * (1 / self.in_plane_radius + 1 / self.transverse_radius)

    @property
    def gaussian_curvature(self) -> FloatArray:
        """Gaussian curvature 1/(R'R'')."""
        return 1 / (self.in_plane_radius * self.transverse_radius)

    @property
    def mean_curvature_radius(self) -> FloatArray:
        """Radius 1/H, the harmonic mean of the principal radii: R_0g of Dzidek et al. (2017)."""
        return 1 / self.mean_curvature

    @property
    def geometric_mean_radius(self) -> FloatArray:
        """Radius √(R'R''): Johnson's R_e for contact with a flat plate."""
        return np.sqrt(self.in_plane_radius * self.transverse_radius)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class RelativeCurvature(Displayed):
    """Curvature of the gap between two bodies at their point of contact.

    The gap is x²/(2R') + y²/(2R'') along the relative principal directions x, y.

    Attributes
    ----------
    principal_radii : PrincipalRadii
        Relative principal radii, not sorted: the direction of the first lies nearer to the first body's
        first principal direction. NaN where the gap does not open in all directions.
    angle : ndarray
        Angle in (−π/4, π/4] from the first body's first principal direction to the first relative one, in
        radians, in the sense that turns the first body's first direction into its second.

    Examples
    --------
    A pad of radii 13 and 14.3 mm against a sphere of 10 mm, and against a plate:

    >>> np.round(relative_curvature((13.0, 14.3), (10.0, 10.0)).principal_radii, 2)
    array([5.65, 5.88])
    >>> round(float(relative_curvature((13.0, 14.3)).geometric_mean_radius), 3)
    13.635
    """

    principal_radii: PrincipalRadii
    angle: FloatArray

    @property
    def mean_curvature_radius(self) -> FloatArray:
        """Radius 1/H of the gap, H = (1/R' + 1/R'')/2."""
        return 2 / (1 / self.principal_radii.first + 1 / self.principal_radii.second)

    @property
    def geometric_mean_radius(self) -> FloatArray:
        """Johnson's R_e = √(R'R'')."""
        return np.sqrt(self.principal_radii.first * self.principal_radii.second)


def relative_curvature(
    first: RadiusPair,
    second: RadiusPair = (np.inf, np.inf),
    *,
    angle: ArrayLike = 0.0,
) -> RelativeCurvature:
    r"""Combine the principal radii of two bodies.

    The curvature tensors add (Johnson 1985, Eq. 4.5).

    Parameters
    ----------
    first, second : tuple of array_like
        Two principal radii of each body: both equal for a sphere, (R, inf) for a cylinder, (inf, inf) for a
        flat plate (the default second body), negative for a hollow.
    angle : array_like
        Angle from the first body's first principal direction to the second body's, in radians.

    Returns
    -------
    RelativeCurvature
        Radii and directions of the gap, in the unit of length of the radii.

    Raises
    ------
    GeometryError
        If a body has not two radii, one is zero or NaN, or the angle is not finite or beyond a full turn.

    Examples
    --------
    Two equal cylinders crossed at a right angle touch as a sphere does on a plate:

    >>> import numpy as np
    >>> np.round(relative_curvature((10, np.inf), (10, np.inf), angle=np.pi / 2).principal_radii, 2)
    array([10., 10.])
    """
    first_1, first_2, second_1, second_2, turn = broadcast(
        *_two_radii("first", first), *_two_radii("second", second), angle
    )
    for name, radius in (
        ("first", first_1),
        ("first", first_2),
        ("second", second_1),
        ("second", second_2),
    ):
        check_all(
            np.abs(radius) > 0,
            f"{name} body's principal radius",
            radius,
            "a non-zero number",
            GeometryError,
        )
    check_all(np.isfinite(check_radians("angle", turn)), "angle", turn, "finite", GeometryError)
    cosine, sine = np.cos(turn), np.sin(turn)
    curvatures, angle_ = principal_curvatures(
        1 / first_1 + cosine**2 / second_1 + sine**2 / second_2,
        1 / first_2 + sine**2 / second_1 + cosine**2 / second_2,
        cosine * sine * (1 / second_1 - 1 / second_2),
    )
    curvatures = np.where((curvatures > 0).all(axis=-1, keepdims=True), curvatures, np.nan)
    return RelativeCurvature(principal_radii=inverse_of(curvatures), angle=angle_[()])


def _two_radii(name: str, radii: RadiusPair) -> tuple[ArrayLike, ArrayLike]:
    """Return the radii of one body; an array of several pairs is refused, since two pairs unpack wrongly."""
    if len(radii) != 2 or not (isinstance(radii, tuple) or np.ndim(radii) == 1):
        raise GeometryError(
            f"{name} must be two principal radii, arrays as (first, second), found {radii!r:.100}"
        )
    return radii[0], radii[1]


def principal_curvatures(
    first: ArrayLike, second: ArrayLike, mixed: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Diagonalise the symmetric curvature tensor [[first, mixed], [mixed, second]] of a tangent plane.

    Parameters
    ----------
    first, second, mixed : array_like
        Components along two orthonormal tangent vectors.

    Returns
    -------
    curvatures : ndarray, shape (..., 2)
        Principal curvatures; the direction of the first lies within 45° of the first tangent vector.
    angle : ndarray
        Angle of that direction from the first tangent vector towards the second, in (−π/4, π/4].

    Examples
    --------
    >>> curvatures, angle = principal_curvatures(1.5, 2.5, 1.2)
    >>> curvatures.round(12), round(float(np.degrees(angle)), 3)
    (array([0.7, 3.3]), -33.69)
    """
    first, second, mixed = broadcast(first, second, mixed)
    difference = first - second
    angle = 0.5 * np.arctan2(np.where(difference < 0, -mixed, mixed), 0.5 * np.abs(difference))
    return curvatures_of(first, second, mixed), angle


def curvatures_of(first: FloatArray, second: FloatArray, mixed: FloatArray) -> FloatArray:
    """Return the curvatures of `principal_curvatures` alone, shape (..., 2)."""
    half_difference = 0.5 * (first - second)
    mean = 0.5 * (first + second)
    # The product of the two is the determinant; their difference would lose the smaller one's digits.
    radius = hypotenuse(half_difference, mixed)
    concave = mean.real < 0
    stronger = np.where(concave, mean - radius, mean + radius)
    weaker = (first * second - mixed * mixed) / np.where(stronger == 0, 1.0, stronger)
    first_is_stronger = (half_difference.real < 0) == concave
    return np.stack(
        [np.where(first_is_stronger, stronger, weaker), np.where(first_is_stronger, weaker, stronger)],
        axis=-1,
    )
