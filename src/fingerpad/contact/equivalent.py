"""The three spheres equivalent to an elliptical contact.

A sphere can be chosen to give the same indentation under the same load, the same area under the same load,
or the same area at the same indentation. Each radius is the base radius R times a function of the observed
contact ellipse. The base is the mean-curvature radius R_0g = 1/H in Dzidek et al. (2017), the geometric
mean R_e = √(R'R'') in exact Hertz theory, for which the three relations are identities.
"""

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array
from fingerpad.contact.elliptic import factor_products


@np.errstate(all="ignore")
def equivalent_radius_ratios(axis_ratio: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
    r"""Return R_δ/R, R_A/R and R_Aξ/R, the three equivalent radii over their base radius, in one pass.

    In Johnson's factors they are :math:`F_2^{-3}`, :math:`F_1^3` and :math:`F_1^2/F_2`, computed without a
    cube root: :math:`F_1^3 = \frac{4}{\pi}\sqrt{kBD}` and :math:`F_1 F_2 = \frac{2}{\pi}\sqrt{k}K`.

    Parameters
    ----------
    axis_ratio : array_like
        k = ℓe/ℓd of the contact ellipse, in (0, 1]; NaN is returned elsewhere.

    Returns
    -------
    from_indentation, from_area, from_compliance : ndarray
        R_δ/R ≥ 1, R_A/R ≤ 1 and R_Aξ/R ≤ 1.

    Examples
    --------
    >>> [round(float(ratio), 4) for ratio in equivalent_radius_ratios(5.0 / 7.4)]
    [1.0145, 0.9858, 0.9953]
    """
    area, product = factor_products(axis_ratio)
    return area / product**3, area, area / product


def equivalent_radius_from_indentation(base_radius: ArrayLike, axis_ratio: ArrayLike) -> FloatArray:
    r"""Return the radius of the sphere with the same indentation under the same load.

    :math:`R_\delta = R F_2^{-3} \ge R`. Dzidek et al. (2017), Eq. (2), print :math:`F^{+3}` with F ≥ 1; their
    ξ(e) gives :math:`F^{-3}` with Johnson's F2 ≤ 1.

    Parameters
    ----------
    base_radius : array_like
        R_0g (Dzidek et al. 2017) or R_e (exact Hertz theory), positive; NaN is returned elsewhere.
    axis_ratio : array_like
        k = ℓe/ℓd of the contact ellipse, in (0, 1]; NaN is returned elsewhere.

    Returns
    -------
    ndarray
        R_δ, in the unit of `base_radius`.

    Examples
    --------
    >>> round(float(equivalent_radius_from_indentation(18.7, 5.0 / 7.4)), 2)
    18.97
    """
    return _convex(base_radius) * equivalent_radius_ratios(axis_ratio)[0]


def equivalent_radius_from_area(base_radius: ArrayLike, axis_ratio: ArrayLike) -> FloatArray:
    r"""Return the radius of the sphere with the same area under the same load.

    :math:`R_A = R F_1^3 \le R`.

    Parameters
    ----------
    base_radius : array_like
        R_0g (Dzidek et al. 2017) or R_e (exact Hertz theory), positive; NaN is returned elsewhere.
    axis_ratio : array_like
        k = ℓe/ℓd of the contact ellipse, in (0, 1]; NaN is returned elsewhere.

    Returns
    -------
    ndarray
        R_A, in the unit of `base_radius`.

    Examples
    --------
    >>> round(float(equivalent_radius_from_area(18.7, 5.0 / 7.4)), 2)
    18.43
    """
    return _convex(base_radius) * equivalent_radius_ratios(axis_ratio)[1]


def equivalent_radius_from_compliance(base_radius: ArrayLike, axis_ratio: ArrayLike) -> FloatArray:
    r"""Return the radius of the sphere with the same area at the same indentation, R = A/(πξ).

    :math:`R_{A\xi} = R F_1^2/F_2`, slightly below R. It is the one to compare with R_g, the slope of A
    against πξ.

    Parameters
    ----------
    base_radius : array_like
        R_0g (Dzidek et al. 2017) or R_e (exact Hertz theory), positive; NaN is returned elsewhere.
    axis_ratio : array_like
        k = ℓe/ℓd of the contact ellipse, in (0, 1]; NaN is returned elsewhere.

    Returns
    -------
    ndarray
        R_Aξ, in the unit of `base_radius`.

    Examples
    --------
    >>> round(float(equivalent_radius_from_compliance(18.7, 5.0 / 7.4)), 2)
    18.61
    """
    return _convex(base_radius) * equivalent_radius_ratios(axis_ratio)[2]


def _convex(base_radius: ArrayLike) -> FloatArray:
    """Return positive radii as they are, and NaN for the others."""
    radius = as_float_array(base_radius)
    return np.where(radius.real > 0, radius, np.nan)
