"""Elliptical Hertz contact, forward and inverse (Johnson 1985, section 4.2)."""

from dataclasses import dataclass, field

import numpy as np

from fingerpad._arrays import (
    ArrayLike,
    FloatArray,
    apply_blockwise,
    as_float_array,
    broadcast,
    broadcast_named,
    check_all,
    set_fields,
)
from fingerpad._display import Displayed
from fingerpad.contact.elliptic import contact_ellipse_kernel, solve_contact_ellipse
from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Ellipse


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class HertzContact(Displayed):
    """A loaded elliptical contact.

    Attributes
    ----------
    load : ndarray
        Normal force W.
    reduced_modulus : ndarray
        E*, with 1/E* = (1 − ν1²)/E1 + (1 − ν2²)/E2.
    semi_major, semi_minor : ndarray
        Semi-axes ℓd ≥ ℓe of the contact ellipse.
    indentation : ndarray
        Mutual approach ξ of the two bodies.

    Examples
    --------
    >>> contact = hertz_contact(12.955, 14.330, 2.0, reduced_modulus=0.1365)  # mm, N, MPa
    >>> print(f"{contact.area:.1f} mm², {1000 * contact.peak_pressure:.1f} kPa")
    88.6 mm², 33.9 kPa
    """

    load: FloatArray
    reduced_modulus: FloatArray
    semi_major: FloatArray
    semi_minor: FloatArray
    indentation: FloatArray

    @property
    def ellipse(self) -> Ellipse:
        """The contact ellipse; a `GeometryError` where a contact has no size, as without load."""
        return Ellipse(semi_major=self.semi_major, semi_minor=self.semi_minor)

    @property
    def area(self) -> FloatArray:
        """Contact area A = π ℓd ℓe."""
        return np.pi * self.semi_major * self.semi_minor

    @property
    def mean_pressure(self) -> FloatArray:
        """Mean pressure W/A; NaN without load."""
        with np.errstate(all="ignore"):
            return self.load / self.area

    @property
    def peak_pressure(self) -> FloatArray:
        """Peak pressure p0 = 3W/(2π ℓd ℓe), at the centre."""
        return 1.5 * self.mean_pressure

    @property
    def stiffness(self) -> FloatArray:
        """Normal contact stiffness dW/dξ = 3W/(2ξ); NaN without load."""
        with np.errstate(all="ignore"):
            return 1.5 * self.load / self.indentation


@dataclass(frozen=True, slots=True, init=False, eq=False, repr=False)
class HertzGeometry(Displayed):
    r"""The undeformed gap of two bodies, with its contact ellipse solved once for all loads.

    The shape of the ellipse depends on the curvature ratio alone. Its size follows from
    :math:`\ell_d^3 = 3WR'D/(\pi E^*)` and the indentation from :math:`\xi = 3WK/(2\pi E^*\ell_d)`, R' being
    the larger relative radius: Johnson's Eqs 4.26 rearranged so that nothing cancels at the circle.

    Parameters
    ----------
    first_radius, second_radius : array_like
        Relative principal radii, in either order of size, of any shapes that broadcast.

    Attributes
    ----------
    axis_ratio : ndarray
        k = ℓe/ℓd of the contact ellipse, at any load.
    K, D : ndarray
        Complete elliptic integrals of modulus √(1 − k²).

    Raises
    ------
    GeometryError
        If a radius is not positive and finite.

    Examples
    --------
    A pad of Dzidek et al. (2017), Table 1, on a 30° wedge, under 2 N (mm, N, MPa):

    >>> geometry = HertzGeometry(12.955, 14.330)
    >>> contact = geometry.under_load(2.0, reduced_modulus=0.1365)
    >>> print(f"{contact.semi_major:.3f} × {contact.semi_minor:.3f} mm, {contact.indentation:.3f} mm")
    5.491 × 5.134 mm, 2.069 mm
    >>> int(geometry.long_axis)  # the long axis lies along the second, here the transverse, direction
    1
    """

    first_radius: FloatArray
    second_radius: FloatArray
    axis_ratio: FloatArray = field(init=False)
    K: FloatArray = field(init=False)
    D: FloatArray = field(init=False)

    def __init__(self, first_radius: ArrayLike, second_radius: ArrayLike) -> None:
        first, second = broadcast_named(first_radius=first_radius, second_radius=second_radius)
        for name, radius in (("first_radius", first), ("second_radius", second)):
            check_all(np.isfinite(radius) & (radius > 0), name, radius, "positive and finite", GeometryError)
        k, K, D = solve_contact_ellipse(first, second)
        set_fields(self, first_radius=first, second_radius=second, axis_ratio=k, K=K, D=D)

    @property
    def long_axis(self) -> FloatArray:
        """Index of the principal direction along which the long axis lies: 0 or 1, NaN for a circle."""
        sign = np.sign(self.second_radius - self.first_radius)
        return np.where(sign == 0, np.nan, (sign + 1) / 2)[()]

    @property
    def geometric_mean_radius(self) -> FloatArray:
        """Johnson's R_e = √(R'R'')."""
        return np.sqrt(self.first_radius * self.second_radius)

    def under_load(self, load: ArrayLike, *, reduced_modulus: ArrayLike) -> HertzContact:
        """Return the contact under a normal force.

        Parameters
        ----------
        load, reduced_modulus : array_like
            W and E*; NaN is returned where either is negative.

        Returns
        -------
        HertzContact
            Shapes broadcast.
        """
        W, E = as_float_array(load), as_float_array(reduced_modulus)
        with np.errstate(all="ignore"):
            sizes = _size_under_load(self._larger_radius * self.D, self.axis_ratio, self.K, W, E)
        return _contact(W, E, *sizes)

    def at_indentation(self, indentation: ArrayLike, *, reduced_modulus: ArrayLike) -> HertzContact:
        """Return the contact at a mutual approach.

        Parameters
        ----------
        indentation, reduced_modulus : array_like
            ξ and E*; NaN is returned where either is negative.

        Returns
        -------
        HertzContact
            Shapes broadcast.
        """
        return self._of_size(self._semi_major_from_indentation(indentation), reduced_modulus)

    def at_area(self, area: ArrayLike, *, reduced_modulus: ArrayLike) -> HertzContact:
        """Return the contact of a given area.

        Parameters
        ----------
        area, reduced_modulus : array_like
            A and E*; NaN is returned where either is negative.

        Returns
        -------
        HertzContact
            Shapes broadcast.
        """
        return self._of_size(self._semi_major_from_area(area), reduced_modulus)

    def reduced_modulus_from_indentation(self, load: ArrayLike, indentation: ArrayLike) -> FloatArray:
        """Return E* from a normal force and its indentation.

        Parameters
        ----------
        load, indentation : array_like
            W and ξ.

        Returns
        -------
        ndarray
            E*.
        """
        return self._reduced_modulus(load, self._semi_major_from_indentation(indentation))

    def reduced_modulus_from_area(self, load: ArrayLike, area: ArrayLike) -> FloatArray:
        """Return E* from a normal force and its contact area.

        Parameters
        ----------
        load, area : array_like
            W and A.

        Returns
        -------
        ndarray
            E*.
        """
        return self._reduced_modulus(load, self._semi_major_from_area(area))

    @property
    def _larger_radius(self) -> FloatArray:
        return np.maximum(self.first_radius, self.second_radius)

    def _semi_major_from_indentation(self, indentation: ArrayLike) -> FloatArray:
        with np.errstate(invalid="ignore"):
            return np.sqrt(2 * self._larger_radius * self.D * as_float_array(indentation) / self.K)

    def _semi_major_from_area(self, area: ArrayLike) -> FloatArray:
        with np.errstate(invalid="ignore"):
            return np.sqrt(as_float_array(area) / (np.pi * self.axis_ratio))

    def _reduced_modulus(self, load: ArrayLike, major: FloatArray) -> FloatArray:
        with np.errstate(divide="ignore", invalid="ignore"):
            return (3 / np.pi) * as_float_array(load) * self._larger_radius * self.D / major**3

    @np.errstate(all="ignore")
    def _of_size(self, major: FloatArray, reduced_modulus: ArrayLike) -> HertzContact:
        modulus = as_float_array(reduced_modulus)
        modulus = np.where(modulus >= 0, modulus, np.nan)
        radius = self._larger_radius
        load = (np.pi / 3) * modulus * major**3 / (radius * self.D)
        return _contact(
            load, modulus, major, self.axis_ratio * major, 0.5 * major**2 * self.K / (radius * self.D)
        )


def hertz_contact(
    first_radius: ArrayLike, second_radius: ArrayLike, load: ArrayLike, *, reduced_modulus: ArrayLike
) -> HertzContact:
    """Return the contacts of distinct geometries, each under its own load.

    The same as ``HertzGeometry(first_radius, second_radius).under_load(load, ...)``, in one pass over the
    arrays; values out of range give NaN, not an error.

    Parameters
    ----------
    first_radius, second_radius : array_like
        Relative principal radii, in either order of size.
    load, reduced_modulus : array_like
        Normal force W and E*.

    Returns
    -------
    HertzContact
        Shapes broadcast.

    Examples
    --------
    >>> contact = hertz_contact(12.955, 14.330, [1.0, 2.0], reduced_modulus=0.1365)
    >>> contact.area.round(1)
    array([55.8, 88.6])
    """

    def kernel(*values: FloatArray) -> tuple[FloatArray, ...]:
        first, second, W, E = values
        k, K, D = contact_ellipse_kernel(first, second)
        return _size_under_load(np.maximum(first, second) * D, k, K, W, E)

    return _contact(
        load, reduced_modulus, *apply_blockwise(kernel, 3, first_radius, second_radius, load, reduced_modulus)
    )


def _size_under_load(
    radius_D: FloatArray, k: FloatArray, K: FloatArray, W: FloatArray, E: FloatArray
) -> tuple[FloatArray, ...]:
    """Return semi-axes and indentation; `radius_D` is R'D."""
    major = np.cbrt((3 / np.pi) * np.where((W >= 0) & (E >= 0), W / E, np.nan) * radius_D)
    return major, k * major, 0.5 * major * major * K / radius_D


def _contact(*values: ArrayLike) -> HertzContact:
    load, modulus, major, minor, indentation = (value[()] for value in broadcast(*values))
    return HertzContact(
        load=load, reduced_modulus=modulus, semi_major=major, semi_minor=minor, indentation=indentation
    )


@np.errstate(all="ignore")
def reduced_modulus(youngs_modulus: ArrayLike, poisson_ratio: ArrayLike = 0.5) -> FloatArray:
    """Return E* = E/(1 − ν²) of a body pressed against a rigid one.

    Parameters
    ----------
    youngs_modulus : array_like
        E.
    poisson_ratio : array_like
        ν.

    Returns
    -------
    ndarray
        E*, in the unit of E.

    Examples
    --------
    >>> float(reduced_modulus(0.1024))
    0.13653333333333334
    """
    return as_float_array(youngs_modulus) / (1 - as_float_array(poisson_ratio) ** 2)


def youngs_modulus(reduced_modulus: ArrayLike, poisson_ratio: ArrayLike = 0.5) -> FloatArray:
    """Return E = E*(1 − ν²) of a body pressed against a rigid one.

    Parameters
    ----------
    reduced_modulus : array_like
        E*.
    poisson_ratio : array_like
        ν.

    Returns
    -------
    ndarray
        E, in the unit of E*.

    Examples
    --------
    >>> round(float(youngs_modulus(0.1365)), 4)
    0.1024
    """
    return as_float_array(reduced_modulus) * (1 - as_float_array(poisson_ratio) ** 2)
