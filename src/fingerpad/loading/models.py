r"""The contact of a soft sphere whose modulus grows with load, as equations between arrays.

Hertz: :math:`W = \tfrac{4}{3} E^* R^{1/2} \xi^{3/2}` with :math:`E^* = E/(1 - \nu^2)`. With the secant
modulus :math:`E_g = E_{0g} + \beta W` in place of E, the load is explicit in
:math:`h = \tfrac{4}{3} R^{1/2} \xi^{3/2}/(1 - \nu^2)`: :math:`W = E_{0g} h/(1 - \beta h)`.
Lengths in mm, forces in N, moduli in MPa; arrays broadcast, and what has no answer is NaN.
"""

from typing import TypeVar

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array, broadcast

Real = TypeVar("Real", float, FloatArray)

# Where β h comes this near to one, the load grows beyond all bounds, and a search must be turned back.
_POLE = 0.02


def hertz_stiffness(radius: Real, poisson_ratio: Real) -> Real:
    """Return k = 4/3 √R/(1 − ν²) of Hertz's W = k E ξ^(3/2), Johnson (4.23)."""
    stiffness: Real = 4 / 3 * radius**0.5 / (1 - poisson_ratio**2)
    return stiffness


@np.errstate(all="ignore")
def load_from_indentation(
    indentation: ArrayLike,
    *,
    loading_radius: ArrayLike,
    initial_modulus: ArrayLike,
    load_coefficient: ArrayLike = 0.0,
    poisson_ratio: ArrayLike = 0.5,
) -> FloatArray:
    r"""Return the load W at an indentation ξ, zero before contact.

    :math:`W = E_{0g} h/(1 - \beta h)` with :math:`h = \tfrac{4}{3} R_g^{1/2} \xi^{3/2}/(1-\nu^2)`: Hertz
    theory with E_g = E_0g + β W. NaN where β h ≥ 1, at which the load is infinite.

    Parameters
    ----------
    indentation : array_like
        ξ, mm.
    loading_radius, initial_modulus, load_coefficient, poisson_ratio : array_like
        R_g (mm), E_0g (MPa), β (MPa/N) and ν.

    Returns
    -------
    ndarray
        W, N.

    Examples
    --------
    >>> print(f"{load_from_indentation(1.806, loading_radius=20.5, initial_modulus=0.1024):.2f} N")
    2.00 N
    """
    xi, radius, modulus, coefficient, ratio = broadcast(
        indentation, loading_radius, initial_modulus, load_coefficient, poisson_ratio
    )
    h = hertz_stiffness(radius, ratio) * np.maximum(xi, 0) ** 1.5
    rest = 1 - coefficient * h
    return np.where(rest > 0, modulus * h / rest, np.nan)[()]


@np.errstate(all="ignore")
def indentation_from_load(
    load: ArrayLike,
    *,
    loading_radius: ArrayLike,
    initial_modulus: ArrayLike,
    load_coefficient: ArrayLike = 0.0,
    poisson_ratio: ArrayLike = 0.5,
) -> FloatArray:
    r"""Return the indentation ξ under a load W; the inverse of `load_from_indentation`.

    :math:`\xi = [3(1-\nu^2) W/(4 R_g^{1/2}(E_{0g} + \beta W))]^{2/3}`.

    Parameters
    ----------
    load : array_like
        W, N.
    loading_radius, initial_modulus, load_coefficient, poisson_ratio : array_like
        R_g (mm), E_0g (MPa), β (MPa/N) and ν.

    Returns
    -------
    ndarray
        ξ, mm.

    Examples
    --------
    >>> print(f"{indentation_from_load(2.0, loading_radius=20.5, initial_modulus=0.1024):.3f} mm")
    1.806 mm
    """
    W, radius, modulus, coefficient, ratio = broadcast(
        load, loading_radius, initial_modulus, load_coefficient, poisson_ratio
    )
    xi: FloatArray = (3 * (1 - ratio**2) * W / (4 * np.sqrt(radius) * (modulus + coefficient * W))) ** (2 / 3)
    return xi


@np.errstate(all="ignore")
def secant_modulus(
    load: ArrayLike, indentation: ArrayLike, *, loading_radius: ArrayLike, poisson_ratio: ArrayLike = 0.5
) -> FloatArray:
    r"""Return the secant modulus E_g, NaN before contact.

    :math:`E_g = 3(1-\nu^2) W/(4 R_g^{1/2} \xi^{3/2})` (Dzidek et al. 2017).

    Parameters
    ----------
    load, indentation : array_like
        W (N) and ξ (mm).
    loading_radius, poisson_ratio : array_like
        R_g (mm) and ν.

    Returns
    -------
    ndarray
        E_g, MPa.

    Examples
    --------
    The contact of Dzidek et al. (2017) at 30° and 2 N:

    >>> print(f"{1000 * secant_modulus(2.0, 1.806, loading_radius=20.5):.1f} kPa")
    102.4 kPa
    """
    W, xi, radius, ratio = broadcast(load, indentation, loading_radius, poisson_ratio)
    return np.where(xi > 0, 3 * (1 - ratio**2) * W / (4 * np.sqrt(radius) * xi**1.5), np.nan)[()]


def area_from_load(
    load: ArrayLike,
    *,
    loading_radius: ArrayLike,
    initial_modulus: ArrayLike,
    load_coefficient: ArrayLike = 0.0,
    poisson_ratio: ArrayLike = 0.5,
) -> FloatArray:
    r"""Return the contact area A under a load W.

    :math:`A = \pi [3(1-\nu^2) W R_g/(4(E_{0g} + \beta W))]^{2/3}`, which is π R_g ξ(W).

    Parameters
    ----------
    load : array_like
        W, N.
    loading_radius, initial_modulus, load_coefficient, poisson_ratio : array_like
        R_g (mm), E_0g (MPa), β (MPa/N) and ν.

    Returns
    -------
    ndarray
        A, mm².

    Examples
    --------
    >>> print(f"{area_from_load(2.0, loading_radius=20.5, initial_modulus=0.1024):.1f} mm²")
    116.3 mm²
    """
    xi = indentation_from_load(
        load,
        loading_radius=loading_radius,
        initial_modulus=initial_modulus,
        load_coefficient=load_coefficient,
        poisson_ratio=poisson_ratio,
    )
    area: FloatArray = np.pi * as_float_array(loading_radius) * xi
    return area


@np.errstate(all="ignore")
def local_area_exponent(
    load: ArrayLike, *, initial_modulus: ArrayLike, load_coefficient: ArrayLike
) -> FloatArray:
    r"""Return :math:`d\ln A/d\ln W = \tfrac{2}{3} E_{0g}/(E_{0g} + \beta W)`: 2/3 for Hertz, less as β grows.

    Parameters
    ----------
    load : array_like
        W, N.
    initial_modulus, load_coefficient : array_like
        E_0g (MPa) and β (MPa/N).

    Returns
    -------
    ndarray
        The exponent.

    Examples
    --------
    >>> print(f"{local_area_exponent(2.0, initial_modulus=0.04, load_coefficient=0.02):.3f}")
    0.333
    """
    W, modulus, coefficient = broadcast(load, initial_modulus, load_coefficient)
    return 2 / 3 * modulus / (modulus + coefficient * W)


def clipped_load(h: FloatArray, initial_modulus: float, load_coefficient: float) -> FloatArray:
    """Return the load for a parameter search: finite and very large beyond its pole."""
    return initial_modulus * h / np.maximum(1 - load_coefficient * h, _POLE)


def load_slope(xi: FloatArray, h: FloatArray, initial_modulus: float, load_coefficient: float) -> FloatArray:
    """Return dW/dξ of the same."""
    rest = np.maximum(1 - load_coefficient * h, _POLE)
    return np.asarray(1.5 * initial_modulus * h / np.maximum(xi, 1e-12) / rest**2)
