"""Consistency of one sphere with a contact: modulus from area against that from indentation."""

from dataclasses import dataclass

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, broadcast
from fingerpad._display import Displayed


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ShapeCheck(Displayed):
    """Reduced moduli that agree where the contact is that of one Hertzian sphere.

    Attributes
    ----------
    load : ndarray
        W, N.
    modulus_from_area, modulus_from_indentation : ndarray
        E* = 3 W R/(4 a³) with a = √(A/π), and 3 W/(4 R^½ ξ^{3/2}), MPa.
    ratio : ndarray
        The first over the second, R^{3/2} ξ^{3/2}/a³: one for a sphere, whatever its modulus.
    expected_ratio : ndarray
        What the shape of the contact makes of it.

    Examples
    --------
    Tissue on bone is indented less than a half-space of the same contact area:

    >>> check = shape_check([1.0, 2.0], [0.9, 1.3], [60.0, 90.0], loading_radius=14.5)
    >>> check.ratio.round(2)
    array([0.56, 0.53])
    """

    load: FloatArray
    modulus_from_area: FloatArray
    modulus_from_indentation: FloatArray
    ratio: FloatArray
    expected_ratio: FloatArray


@np.errstate(all="ignore")
def shape_check(
    load: ArrayLike,
    indentation: ArrayLike,
    area: ArrayLike,
    *,
    loading_radius: ArrayLike,
    expected_ratio: ArrayLike = 1.0,
) -> ShapeCheck:
    """Compare reduced moduli from area and from indentation at each load; NaN before contact.

    E* = 3 W R/(4 a³) with a = √(A/π), and E* = 3 W/(4 R^½ ξ^{3/2}): Johnson (1985), Eqs 4.22 and 4.23.

    Parameters
    ----------
    load, indentation, area : array_like
        W (N), ξ (mm) and A (mm²), counted from zero load and first contact.
    loading_radius : array_like
        R, mm, the same in both.
    expected_ratio : array_like
        For an elliptical contact of axis ratio k taken for a sphere of radius R_e it is (R_e/R_Aξ)^{3/2}
        = F2^{3/2}/F1³, with the equivalent radius from compliance of `fingerpad.contact`.

    Returns
    -------
    ShapeCheck
        Both moduli and their ratio.

    Examples
    --------
    >>> check = shape_check(2.0, 1.5, np.pi * 14.5 * 1.5, loading_radius=14.5)
    >>> print(f"{check.ratio:.3f}")
    1.000
    """
    W, xi, A, radius, expected = broadcast(load, indentation, area, loading_radius, expected_ratio)
    touching = (xi > 0) & (A > 0)
    xi, A = np.where(touching, xi, np.nan), np.where(touching, A, np.nan)
    from_area = 3 * W * radius / (4 * (A / np.pi) ** 1.5)
    from_indentation = 3 * W / (4 * np.sqrt(radius) * xi**1.5)
    return ShapeCheck(
        load=W,
        modulus_from_area=from_area,
        modulus_from_indentation=from_indentation,
        ratio=(radius * np.pi * xi / A) ** 1.5,
        expected_ratio=expected,
    )
