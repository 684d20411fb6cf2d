"""Principal curvatures of a surface at a point."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, broadcast, hypotenuse
from fingerpad._display import Displayed


class PrincipalRadii(NamedTuple):
    """Two principal radii of curvature, in the order of the principal directions, not sorted."""

    first: FloatArray
    second: FloatArray


def inverse_of(curvatures: FloatArray) -> PrincipalRadii:
    """Return the radii of principal curvatures of shape (..., 2)."""
    radii = 1 / curvatures
    return PrincipalRadii(radii[..., 0][()], radii[..., 1][()])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SurfaceCurvature(Displayed):
    """Principal radii and directions (..., 2, 3) of a surface at points of it.

    The radii are positive where the surface is convex. They are not sorted but keep their identity: on a
    finger pad the first is the one whose direction lies nearer to the finger's long axis (in-plane), the
    second the one across it (transverse).
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


def principal_curvatures(
    first: ArrayLike, second: ArrayLike, mixed: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Diagonalise the symmetric curvature tensor [[first, mixed], [mixed, second]] of a tangent plane.

    Returns the two principal curvatures, shape (..., 2), and the angle of the first one's direction from the
    first tangent vector towards the second, in (−π/4, π/4].
    """
    first, second, mixed = broadcast(first, second, mixed)
    difference = first - second
    angle = 0.5 * np.arctan2(np.where(difference < 0, -mixed, mixed), 0.5 * np.abs(difference))
    return curvatures_of(first, second, mixed), angle


def curvatures_of(first: FloatArray, second: FloatArray, mixed: FloatArray) -> FloatArray:
    """Return the curvatures of `principal_curvatures` alone, shape (..., 2)."""
    mean, half = 0.5 * (first + second), half_difference(first, second, mixed)
    # The product of the two is the determinant; their difference would lose the smaller one's digits.
    first_is_stronger = (half.real < 0) == (mean.real < 0)
    stronger = np.where(first_is_stronger, mean + half, mean - half)
    weaker = (first * second - mixed * mixed) / np.where(stronger == 0, 1.0, stronger)
    return np.stack(
        [np.where(first_is_stronger, stronger, weaker), np.where(first_is_stronger, weaker, stronger)],
        axis=-1,
    )


def half_difference(first: FloatArray, second: FloatArray, mixed: FloatArray) -> FloatArray:
    """Return half of what the first principal curvature is more than the second.

    With its derivative for complex steps; where both are equal it is that along the step, since the root of a
    square would lose its sign.
    """
    along = 0.5 * (first - second)
    half = np.where(along.real < 0, -1.0, 1.0) * hypotenuse(along, mixed)
    if not np.iscomplexobj(half):
        return half
    umbilic = (along.real == 0) & (mixed.real == 0)
    return np.where(umbilic, 1j * np.copysign(np.hypot(along.imag, mixed.imag), along.imag), half)
