"""Elliptical Hertz contact (Johnson 1985, section 4.2), and the spheres that are equivalent to one.

The shape of the contact ellipse depends on the ratio of the relative radii alone. Its size follows from
ℓd³ = 3WR'D/(πE*) and the indentation from ξ = 3WK/(2πE*ℓd), R' being the larger relative radius: Johnson's
Eqs 4.26 rearranged so that nothing cancels at the circle.
"""

from __future__ import annotations

from functools import cache, partial

import numpy as np
from numpy.polynomial.chebyshev import cheb2poly, chebfit

from fingerpad._arrays import ArrayLike, FloatArray, apply_blockwise, as_float_array
from fingerpad.contact.contact import FLAGS, AnyPlacement, Contact, Form, Tissue, check_pressed
from fingerpad.contact.elliptic import contact_ellipse_kernel, cube_root, factor_products, polynomial

# Contact radius over thickness from which Hertz theory's indentation is 2 % too large (2.3 % for ν = 0.5,
# 1.8 % for 0.3), growing in proportion; its area under a load is 0.04 % too large at three times that.
_THICKNESS_MATTERS = 0.03
# Contact radius over that of curvature to which contacts of pads were solved; by then the area of a sphere
# under a load is 12 % too large.
WIDEST = 0.6

_RANGE, _TERMS = 1.2, 10  # of |ln(R1/R2)|, and of its square's polynomials


def hertz_contact(
    placement: AnyPlacement,
    tissue: Tissue,
    *,
    load: ArrayLike | None = None,
    area: ArrayLike | None = None,
    indentation: ArrayLike | None = None,
) -> Contact:
    """Press pads, as paraboloids, into deep tissue: Hertz theory, which holds for small contacts.

    Parameters
    ----------
    placement : Placement or Paraboloid
        Where the pads touch, or the relative radii of curvature there.
    tissue : Tissue
        What is pressed. A thickness is not taken into account, and flagged ``thickness_ignored`` where the
        contact's radius exceeds 3 % of it: `fast_contact` and `solve_contact` take it into account.
    load, area, indentation : array_like
        Exactly one of normal force W, contact area A and mutual approach ξ; a negative one gives NaN.

    Returns
    -------
    Contact
        Shapes broadcast. Flagged ``contact_too_wide`` where the contact's radius exceeds 0.6 of that of
        curvature, as it does when a load in mN meets a modulus in MPa.

    Raises
    ------
    GeometryError
        If not exactly one of load, area and indentation is given, an argument is of another type, or
        the shapes do not broadcast.

    Examples
    --------
    The pad of Dzidek et al. (2017) on wedges of 30° and 45°, under 2 N (mm, N, MPa):

    >>> from fingerpad.geometry import Ellipsoid, Placement
    >>> pad = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
    >>> place = Placement(pad, wedge_angle=np.radians([30, 45]))
    >>> contact = hertz_contact(place, Tissue(youngs_modulus=0.1024), load=2.0)
    >>> contact.area.round(1), contact.indentation.round(3)
    (array([88.5, 72.6]), array([2.069, 2.276]))
    """
    of, value = check_pressed(placement, tissue, load=load, area=area, indentation=indentation)
    first, second = placement.relative_radii
    value = np.broadcast_to(value, np.broadcast_shapes(value.shape, np.shape(tissue.thickness)))
    force, size, depth, major, minor = apply_blockwise(
        partial(_sizes, of=of), 5, first, second, value, tissue.reduced_modulus
    )
    code = np.multiply(~(force > 0), np.int8(FLAGS.index("no_contact")))
    with np.errstate(invalid="ignore"):
        if not tissue.is_deep:
            matters = size > np.pi * (_THICKNESS_MATTERS * tissue.thickness) ** 2
            code = np.where(matters, np.int8(FLAGS.index("thickness_ignored")), code)
        # The graver of the two, and what a wrong unit shows.
        too_wide = size > np.pi * WIDEST**2 * np.abs(first * second)
        code = np.where(too_wide, np.int8(FLAGS.index("contact_too_wide")), code)[()]
    return Contact(
        load=force,
        area=size,
        indentation=depth,
        flag_code=code,
        _find_form=partial(_form, first, second, major, minor),
    )


def _form(first: FloatArray, second: FloatArray, major: FloatArray, minor: FloatArray) -> Form:
    along = np.broadcast_to(first >= second, np.shape(major))[()]
    return Form(semi_major=major, semi_minor=minor, along=along, peak_over_mean_pressure=np.array(1.5))


def _sizes(
    first: FloatArray, second: FloatArray, value: FloatArray, modulus: FloatArray, *, of: str
) -> tuple[FloatArray, ...]:
    """Return load, area, indentation and semi-axes of one block."""
    k, K, D = contact_ellipse_kernel(first, second)
    radius_D = np.maximum(first, second) * D
    if not value.min() >= 0:  # or NaN
        value = np.where(value >= 0, value, np.nan)
    if of == "load":
        major = cube_root((3 / np.pi) * (value / modulus) * radius_D)
    elif of == "area":
        major = np.sqrt(value / (np.pi * k))
    else:
        major = np.sqrt(2 * radius_D * value / K)
    square, minor = major * major, k * major
    load = value if of == "load" else (np.pi / 3) * modulus * square * major / radius_D
    area = value if of == "area" else np.pi * major * minor
    depth = value if of == "indentation" else 0.5 * square * K / radius_D
    return load, area, depth, major, minor


def hertz_units(first: FloatArray, second: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the axis ratio of Hertz theory, load over E* a³ and indentation over a².

    By polynomials where the radii differ little enough: to the last digits, in a fraction of the time.
    """
    x = np.log(first / second)
    if not (np.abs(x.real) <= _RANGE).all():
        return _exact_units(first, second)
    x = np.where(x < 0, -x, x)  # by its complex step where it is zero, as in `_exact_units`
    at, mean = (2 / _RANGE**2) * (x * x) - 1, np.sqrt(first * second)
    slope, load, depth = (polynomial(each, at) for each in _polynomials())
    return np.exp(x * slope), load / mean, depth / mean


def _exact_units(first: FloatArray, second: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    k, integral, D = contact_ellipse_kernel(first, second)
    radius_D = np.maximum(first, second) * D * k
    return k, (np.pi / 3) / (radius_D * np.sqrt(k)), 0.5 * integral / radius_D


@cache
def _polynomials() -> tuple[FloatArray, ...]:
    """Return ln(k)/x, load and indentation of R1 R2 = 1 as polynomials in x² = ln²(R1/R2)."""
    at = np.cos((np.arange(_TERMS) + 0.5) * np.pi / _TERMS)
    x = _RANGE * np.sqrt((1 + at) / 2)
    k, load, depth = _exact_units(np.exp(x / 2), np.exp(-x / 2))
    fitted = (cheb2poly(chebfit(at, values, _TERMS - 1)) for values in (np.log(k) / x, load, depth))
    return tuple(map(as_float_array, fitted))


# The three spheres equivalent to an elliptical contact.
#
# A sphere can be chosen to give the same indentation under the same load, the same area under the same load,
# or the same area at the same indentation. Each radius is the base radius R times a function of the observed
# contact ellipse. The base is the mean-curvature radius R_0g = 1/H in Dzidek et al. (2017), the geometric
# mean R_e = √(R'R'') in exact Hertz theory, for which the three relations are identities.


@np.errstate(all="ignore")
def equivalent_radius_ratios(axis_ratio: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
    r"""Return R_δ/R ≥ 1, R_A/R ≤ 1 and R_Aξ/R ≤ 1, the three equivalent radii over their base radius.

    In Johnson's factors they are F2⁻³, F1³ and F1²/F2, computed without a cube root: F1³ = (4/π) √(kBD) and
    F1 F2 = (2/π) √k K.
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
