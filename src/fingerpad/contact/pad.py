"""Corrected radii, indentation, modulus and model range of a finger pad from an observed contact ellipse."""

from dataclasses import dataclass

import numpy as np

from fingerpad._arrays import ArrayLike, FloatArray, broadcast
from fingerpad._display import Displayed
from fingerpad.contact.elliptic import solve_contact_ellipse
from fingerpad.contact.equivalent import equivalent_radius_ratios
from fingerpad.contact.hertz import youngs_modulus
from fingerpad.geometry import Ellipsoid
from fingerpad.geometry.placement import checked_placement, platen_normal_kernel

# Random draws and steps about a flat or an upright finger pass the ends of the ranges, degrees far more so.
_ANGLE_MARGIN = 0.5
_POISSON_MARGIN = 0.1


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class PadContact(Displayed):
    """A finger pad on its wedge, and the contact seen under a load.

    Attributes
    ----------
    mean_curvature_radius, geometric_mean_radius : ndarray
        R_0g = 1/H and R_e = √(R'R'') of the undeformed pad at the place of contact.
    radius_from_indentation, radius_from_area, radius_from_compliance : ndarray
        Equivalent spheres on R_0g, as in Dzidek et al. (2017); the first is their "corrected radius".
    geometric_radius_from_indentation, geometric_radius_from_area, geometric_radius_from_compliance : ndarray
        The same on R_e, as in exact Hertz theory.
    indentation : ndarray
        ξ = A/(π R_Aξ) from the observed ellipse, on R_e.
    reduced_modulus : ndarray
        E* = 3 W R_e F1³/(4 (ℓd ℓe)^{3/2}) from the load and the observed ellipse.
    youngs_modulus : ndarray
        E = E*(1 − ν²).
    mean_pressure : ndarray
        W/A.
    contact_radius_ratio : ndarray
        √(ℓd ℓe)/R_e, which Hertz theory takes to be small.
    predicted_elongation : ndarray
        Signed ln(ℓd/ℓe) that Hertz theory predicts: positive where the long axis lies along the finger,
        negative where it lies across.

    Examples
    --------
    Hertz theory predicts a contact wider across the finger; the observed one is 1.48 times longer along it:

    >>> import numpy as np
    >>> pad = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
    >>> contact = pad_contact(pad, wedge_angle=np.radians(30), load=2, semi_major=7.4, semi_minor=5.0)
    >>> round(float(np.exp(contact.predicted_elongation)), 3), round(float(contact.contact_radius_ratio), 2)
    (0.935, 0.45)
    """

    mean_curvature_radius: FloatArray
    geometric_mean_radius: FloatArray
    radius_from_indentation: FloatArray
    radius_from_area: FloatArray
    radius_from_compliance: FloatArray
    geometric_radius_from_indentation: FloatArray
    geometric_radius_from_area: FloatArray
    geometric_radius_from_compliance: FloatArray
    indentation: FloatArray
    reduced_modulus: FloatArray
    youngs_modulus: FloatArray
    mean_pressure: FloatArray
    contact_radius_ratio: FloatArray
    predicted_elongation: FloatArray


def pad_contact(
    pad: Ellipsoid,
    *,
    wedge_angle: ArrayLike,
    roll_angle: ArrayLike = 0.0,
    load: ArrayLike,
    semi_major: ArrayLike,
    semi_minor: ArrayLike,
    poisson_ratio: ArrayLike = 0.5,
) -> PadContact:
    """Turn an observed contact ellipse into radii, indentation and modulus.

    Parameters
    ----------
    pad : Ellipsoid
        The undeformed pad.
    wedge_angle, roll_angle : array_like
        Placement, radians: the wedge angle from 0 to π/2 and the roll within π/2 either way, and up to 0.5
        beyond for draws about the ends.
    load : array_like
        Normal force W, positive or zero.
    semi_major, semi_minor : array_like
        Semi-axes of the observed contact ellipse, positive, in either order: the axis ratio of
        a near-circle stays differentiable where measurement noise swaps them.
    poisson_ratio : array_like
        ν of the pad, from −1 to 0.5, and up to 0.1 beyond for draws.

    Returns
    -------
    PadContact
        Shapes broadcast.

    Raises
    ------
    GeometryError
        If an angle cannot be one in radians. All else that is out of range, and NaN, gives NaN.

    Examples
    --------
    The measurement of Dzidek et al. (2017) at 30° and 2 N (mm, N, MPa):

    >>> import numpy as np
    >>> pad = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
    >>> contact = pad_contact(
    ...     pad, wedge_angle=np.radians(30), roll_angle=0, load=2, semi_major=7.4, semi_minor=5.0
    ... )
    >>> print(f"{contact.mean_curvature_radius:.2f} mm, corrected {contact.radius_from_indentation:.2f} mm")
    13.61 mm, corrected 13.80 mm
    """
    normal = platen_normal_kernel(*checked_placement(wedge_angle, roll_angle, margin=_ANGLE_MARGIN))
    major, minor, load, nu = broadcast(semi_major, semi_minor, load, poisson_ratio)
    return pad_contact_kernel(
        *pad.principal_radii_at_normal(normal),
        load=np.where(load.real >= 0, load, np.nan),
        semi_major=np.where(major.real > 0, major, np.nan),
        semi_minor=np.where(minor.real > 0, minor, np.nan),
        poisson_ratio=np.where((nu.real >= -1) & (nu.real <= 0.5 + _POISSON_MARGIN), nu, np.nan),
    )


@np.errstate(all="ignore")
def pad_contact_kernel(
    in_plane: FloatArray,
    transverse: FloatArray,
    *,
    load: ArrayLike,
    semi_major: ArrayLike,
    semi_minor: ArrayLike,
    poisson_ratio: ArrayLike,
) -> PadContact:
    """Return `pad_contact` from the pad's principal radii at the place of contact."""
    major, minor, load = broadcast(semi_major, semi_minor, load)
    axis_ratio = np.minimum(major, minor) / np.maximum(major, minor)
    base, exact = 2 / (1 / in_plane + 1 / transverse), np.sqrt(in_plane * transverse)
    size, area = np.sqrt(major * minor), np.pi * major * minor
    predicted, _, _ = solve_contact_ellipse(in_plane, transverse)
    along = np.sign(np.real(in_plane - transverse))
    from_indentation, from_area, from_compliance = equivalent_radius_ratios(axis_ratio)
    modulus = 0.75 * load * exact * from_area / size**3
    return PadContact(
        mean_curvature_radius=base,
        geometric_mean_radius=exact,
        radius_from_indentation=base * from_indentation,
        radius_from_area=base * from_area,
        radius_from_compliance=base * from_compliance,
        geometric_radius_from_indentation=exact * from_indentation,
        geometric_radius_from_area=exact * from_area,
        geometric_radius_from_compliance=exact * from_compliance,
        indentation=area / (np.pi * exact * from_compliance),
        reduced_modulus=modulus,
        youngs_modulus=youngs_modulus(modulus, poisson_ratio),
        mean_pressure=load / area,
        contact_radius_ratio=size / exact,
        predicted_elongation=-along * np.log(predicted),
    )
