"""Pressure of an elliptical Hertz contact and the stress under it, in closed form.

The two potentials of Boussinesq's solution are those of a Hertzian pressure. The first, ∫p/r, is an integral
over the family of confocal ellipsoids, a Carlson integral. The second, ∫p ln(r + z), matters to compressible
bodies alone; it is elementary, here a smooth integral of rational functions, and the same for circles.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import product
from typing import Self

import numpy as np
from scipy.special import elliprd

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array, broadcast
from fingerpad._display import Displayed
from fingerpad.contact.contact import Contact
from fingerpad.contact.grid import ContactGrid

_NODE, _WEIGHT = np.polynomial.legendre.leggauss(24)
_NODE, _WEIGHT = (_NODE + 1) / 2, _WEIGHT / 2
_NEWTON_STEPS = 80
_SAMPLES = 4  # along each side of a cell


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class StressField(Displayed):
    """Stress at points of an isotropic elastic body.

    Attributes
    ----------
    tensor : ndarray, shape (..., 3, 3)
        Stress, tension positive.

    Examples
    --------
    The surface of an incompressible body under a Hertz pressure is in hydrostatic compression:

    >>> field = hertz_stress(0.0, 0.0, [0.0, 0.5], semi_x=1.0, semi_y=1.0, peak_pressure=1.0)
    >>> field.principal.round(3) + 0.0
    array([[-1.  , -1.  , -1.  ],
           [-0.8 , -0.27, -0.27]])
    >>> round(float(field.strain_energy_density(youngs_modulus=0.1, poisson_ratio=0.5)[1]), 3)
    1.406
    """

    tensor: FloatArray

    @property
    def principal(self) -> FloatArray:
        """Principal stresses, ascending, shape (..., 3)."""
        return np.linalg.eigvalsh(self.tensor).astype(np.float64)

    @property
    def maximum_shear(self) -> FloatArray:
        """Half the difference of the extreme principal stresses."""
        principal = self.principal
        return (principal[..., 2] - principal[..., 0]) / 2

    def turned(self, angle: float) -> Self:
        """Return the stress on axes from which those of this field are turned by an angle about the third.

        Parameters
        ----------
        angle : float
            From the first of the new axes to the first of this field's, towards the second, radians.

        Returns
        -------
        StressField
            The same stress, tensor of shape (..., 3, 3).

        Examples
        --------
        Tension along this field's first axis, which points along the second of the new ones:

        >>> StressField(tensor=np.diag([1.0, 0.0, 0.0])).turned(np.pi / 2).tensor.round(12).diagonal()
        array([0., 1., 0.])
        """
        cosine, sine = math.cos(angle), math.sin(angle)
        turn = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])
        return replace(self, tensor=turn @ self.tensor @ turn.T)

    def strain(self, *, youngs_modulus: ArrayLike, poisson_ratio: float) -> FloatArray:
        """Return the strain ((1 + ν)σ − ν tr σ)/E.

        Parameters
        ----------
        youngs_modulus : array_like
            E.
        poisson_ratio : float
            ν.

        Returns
        -------
        ndarray, shape (..., 3, 3)
            Strain, extension positive.
        """
        mean = np.trace(self.tensor, axis1=-2, axis2=-1)[..., None, None] * np.eye(3)
        compliance = 1 / as_float_array(youngs_modulus)[..., None, None]
        return np.asarray(((1 + poisson_ratio) * self.tensor - poisson_ratio * mean) * compliance)

    def strain_energy_density(self, *, youngs_modulus: ArrayLike, poisson_ratio: float) -> FloatArray:
        """Return the strain energy density ½ σ : ε.

        Parameters
        ----------
        youngs_modulus : array_like
            E.
        poisson_ratio : float
            ν.

        Returns
        -------
        ndarray
            Energy per volume, in the unit of the stress.
        """
        strain = self.strain(youngs_modulus=youngs_modulus, poisson_ratio=poisson_ratio)
        return np.asarray(0.5 * np.sum(self.tensor * strain, axis=(-2, -1)))[()]


@np.errstate(all="ignore")
def hertz_stress(
    x: ArrayLike,
    y: ArrayLike,
    z: ArrayLike,
    *,
    semi_x: ArrayLike,
    semi_y: ArrayLike,
    peak_pressure: ArrayLike,
    poisson_ratio: ArrayLike = 0.5,
) -> StressField:
    """Return the stress in a half-space under the pressure p0 √(1 − x²/a² − y²/b²).

    Parameters
    ----------
    x, y, z : array_like
        Points, z ≥ 0 into the body; NaN is returned above it.
    semi_x, semi_y : array_like
        Semi-axes a and b of the contact ellipse along x and y, in either order of size.
    peak_pressure : array_like
        p0.
    poisson_ratio : array_like
        ν.

    Returns
    -------
    StressField
        Axes x, y, z.

    Examples
    --------
    Under the middle of a circular contact, in incompressible tissue, the shear is highest at about half the
    contact radius:

    >>> depth = np.linspace(0, 2, 201)
    >>> field = hertz_stress(0.0, 0.0, depth, semi_x=1.0, semi_y=1.0, peak_pressure=1.0)
    >>> highest = np.argmax(field.maximum_shear)
    >>> print(f"{field.maximum_shear[highest]:.3f} p0 at {depth[highest]:.2f} a")
    0.266 p0 at 0.55 a
    """
    x, y, z, a, b, p0, nu = broadcast(x, y, z, semi_x, semi_y, peak_pressure, poisson_ratio)
    good = (z >= 0) & (a > 0) & (b > 0)
    scale = np.maximum(a, b)  # lengths over the semi-major axis
    x, y, z, a, b = x / scale, y / scale, np.where(good, z, np.nan) / scale, a / scale, b / scale
    root = _confocal_root(x, y, z, a, b)
    across_x, across_y = a**2 + root, b**2 + root
    height = np.where(root > 0, z / np.sqrt(root), np.sqrt(np.maximum(1 - (x / a) ** 2 - (y / b) ** 2, 0)))
    product = np.sqrt(across_x * across_y)
    integral_x = 2 / 3 * elliprd(across_y, root, across_x)
    integral_y = 2 / 3 * elliprd(across_x, root, across_y)
    # The gradient of the root times its weight in the integrals, 2/(HΔ); none inside the contact.
    spread = np.sqrt(root) * ((x / across_x) ** 2 + (y / across_y) ** 2)
    edge = 2 / (product * (spread + np.where(root > 0, z**2 / root**1.5, np.inf)))
    twice = np.pi * a * b * p0  # twice the potentials' common factor
    slope_z = -twice * (2 * height / product - z * (integral_x + integral_y))
    second_x = -twice * (integral_x - (x / across_x) ** 2 * edge)
    second_y = -twice * (integral_y - (y / across_y) ** 2 * edge)
    mixed = twice * x * y / (across_x * across_y) * edge
    ratio_z = np.where(root > 0, z / np.where(root > 0, root, 1), 0)
    other_x, other_mixed = _second_potential(
        x=x,
        y=y,
        z=z,
        a=a,
        b=b,
        root=root,
        square_root=product * height,
        integral_x=integral_x,
        twice=twice,
    )
    loss, around = 1 - 2 * nu, 1 / (2 * np.pi)
    tensor = np.empty((*x.shape, 3, 3))
    tensor[..., 0, 0] = around * (2 * nu * slope_z - z * second_x - loss * other_x)
    tensor[..., 1, 1] = around * (2 * nu * slope_z - z * second_y + loss * (slope_z + other_x))
    tensor[..., 2, 2] = around * (slope_z + z * (second_x + second_y))
    tensor[..., 0, 1] = tensor[..., 1, 0] = -around * (loss * other_mixed + z * mixed)
    tensor[..., 0, 2] = tensor[..., 2, 0] = -around * twice * z * x / across_x * ratio_z * edge
    tensor[..., 1, 2] = tensor[..., 2, 1] = -around * twice * z * y / across_y * ratio_z * edge
    return StressField(tensor=tensor)


def _confocal_root(x: FloatArray, y: FloatArray, z: FloatArray, a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the largest root of x²/(a² + s) + y²/(b² + s) + z²/s = 1, by Newton's method from above."""
    first, second = a**2, b**2
    least, plane = np.minimum(first, second), x**2 + y**2
    # With the lesser semi-axis in both terms the root is larger, and that of a quadratic.
    half = (plane + z**2 - least) / 2
    discriminant = np.sqrt(half**2 + least * z**2)
    below = np.where(half > 0, 1, discriminant - half)
    root = np.where(half > 0, half + discriminant, least * z**2 / np.where(below > 0, below, 1))
    quadratic = first + second - plane - z**2
    linear = first * second - x**2 * second - y**2 * first - z**2 * (first + second)
    constant = -first * second * z**2
    for _ in range(_NEWTON_STEPS):
        value = ((root + quadratic) * root + linear) * root + constant
        slope = (3 * root + 2 * quadratic) * root + linear
        step = np.where(value > 0, value / slope, 0)
        root = root - step
        if not (step > 1e-15 * root).any():
            break
    return np.maximum(root, 0)


def _second_potential(
    *,
    x: FloatArray,
    y: FloatArray,
    z: FloatArray,
    a: FloatArray,
    b: FloatArray,
    root: FloatArray,
    square_root: FloatArray,
    integral_x: FloatArray,
    twice: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Return ∂²χ/∂x² and ∂²χ/∂x∂y of χ = ∫p ln(r + z).

    √((a² + s)(b² + s)(1 − x²/(a² + s) − y²/(b² + s))) = √((s + m)² − 4κ) is rational in 2/(s + m + √…).
    """
    middle = (a**2 + b**2 - x**2 - y**2) / 2
    kappa = (((a**2 - b**2 - x**2 + y**2) / 2) ** 2 + x**2 * y**2) / 4
    end = 2 / (root + middle + square_root)
    inner, direct, mixed = np.zeros_like(x), np.zeros_like(x), np.zeros_like(x)
    for node, weight in zip(_NODE, _WEIGHT, strict=True):
        sigma = node * end
        bent = kappa * sigma**2
        first = 1 + (a**2 - middle) * sigma + bent
        second = 1 + (b**2 - middle) * sigma + bent
        inner += weight * (1 - bent) ** 2 / (first**2 * second)
        direct += weight * sigma / first**2
        mixed += weight * sigma / (first * second)
    along = twice * (end * inner - z * integral_x - x**2 * end * direct)
    return along, -twice * x * y * end * mixed


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class HertzPressure(Displayed):
    """A semi-ellipsoidal pressure over an ellipse that lies anywhere in the plane of contact."""

    peak_pressure: float
    semi_major: float
    semi_minor: float
    long_axis_angle: float  # from the plane's first coordinate, along the finger, rad
    centre: FloatArray  # in the plane, (2,)

    @classmethod
    def of_contact(cls, contact: Contact, long_axis_angle: float) -> Self:
        """Return the pressure of one Hertz contact, whose long axis lies at an angle (rad) to the finger."""
        return cls(
            peak_pressure=float(contact.peak_pressure),
            semi_major=float(contact.semi_major),
            semi_minor=float(contact.semi_minor),
            long_axis_angle=long_axis_angle,
            centre=np.zeros(2),
        )

    @classmethod
    def of_moments(cls, grid: ContactGrid, pressure: FloatArray) -> Self:
        """Return the pressure that has the load, centre and second moments of one given on a grid.

        Its variance along a semi-axis a is a²/5.
        """
        place = grid.cells
        load = pressure.sum()
        middle = np.tensordot(pressure, place, 2) / load
        offset = place - middle
        second = np.einsum("ij,ijk,ijl->kl", pressure, offset, offset) / load
        spread, axes = np.linalg.eigh(second)
        minor, major = np.sqrt(5 * spread)
        return cls(
            peak_pressure=float(1.5 * load * grid.cell_area / (np.pi * major * minor)),
            semi_major=float(major),
            semi_minor=float(minor),
            long_axis_angle=math.remainder(grid.angle + math.atan2(axes[1, 1], axes[0, 1]), math.tau),
            centre=grid.to_plane(middle),
        )

    def at(self, along: ArrayLike, across: ArrayLike) -> FloatArray:
        """Return the pressure at points of the plane, zero outside the ellipse."""
        x, y = self._own(*broadcast(along, across))
        inside = 1 - (x / self.semi_major) ** 2 - (y / self.semi_minor) ** 2
        return self.peak_pressure * np.sqrt(np.maximum(inside, 0))

    def over_cells(self, grid: ContactGrid) -> FloatArray:
        """Return the mean pressure over each cell of a grid that holds all of the ellipse."""
        shifts = (np.arange(_SAMPLES) + 0.5) / _SAMPLES - 0.5
        mean = np.zeros((grid.points, grid.points))
        for shift in product(shifts, shifts):
            moved = replace(grid, centre=grid.centre + np.multiply(shift, grid.spacing))
            mean += self.at(*moved.coordinates)
        load = 2 / 3 * np.pi * self.semi_major * self.semi_minor * self.peak_pressure
        mean *= load / (mean.sum() * grid.cell_area)
        return mean

    def stress(
        self, along: ArrayLike, across: ArrayLike, depth: ArrayLike, *, poisson_ratio: float
    ) -> StressField:
        """Return the stress in a half-space, as `hertz_stress`, on axes along, across and down."""
        along, across, depth = broadcast(along, across, depth)
        x, y = self._own(along, across)
        field = hertz_stress(
            *(x, y, depth),
            semi_x=self.semi_major,
            semi_y=self.semi_minor,
            peak_pressure=self.peak_pressure,
            poisson_ratio=poisson_ratio,
        )
        return field.turned(self.long_axis_angle)

    def _own(self, along: FloatArray, across: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return coordinates along the ellipse's own axes."""
        cosine, sine = math.cos(self.long_axis_angle), math.sin(self.long_axis_angle)
        along, across = along - self.centre[0], across - self.centre[1]
        return along * cosine + across * sine, across * cosine - along * sine
