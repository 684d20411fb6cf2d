"""The finger pad as a model of named quantities, and its uncertainty."""

from collections.abc import Mapping
from typing import Final

import numpy as np

from fingerpad._arrays import IN_RADIANS, ArrayLike, FloatArray, broadcast, check_all
from fingerpad.contact.contact import from_reduced_modulus
from fingerpad.contact.elliptic import solve_contact_ellipse
from fingerpad.contact.hertz import equivalent_radius_ratios
from fingerpad.exceptions import GeometryError, UncertaintyError
from fingerpad.geometry import PrincipalRadii
from fingerpad.geometry.ellipsoid import principal_radii_kernel
from fingerpad.geometry.placement import checked_placement, platen_normal_kernel
from fingerpad.uncertainty.covariance import covariance_root
from fingerpad.uncertainty.inputs import Groups, Inputs, Quantity
from fingerpad.uncertainty.propagate import Propagated, propagate

# Sources of an uncertainty budget, by the names of their inputs.
PAD_SOURCES: Final[Groups] = {
    "semi-axes": ("palmar", "distal", "radial_ulnar"),
    "pad shape": ("in_plane_deviation", "transverse_deviation"),
    "wedge angle": ("wedge_angle",),
    "roll angle": ("roll_angle",),
    "Poisson's ratio": ("poisson_ratio",),
    "image scale": ("image_scale",),
    "contact edge": ("edge_offset",),
    "load": ("load",),
    "repeatability": ("radius_deviation", "elongation_deviation"),
    "contact ellipse": ("contact_radius", "elongation"),
}
PAD_OUTPUTS: Final = (
    "mean_curvature_radius",
    "geometric_mean_radius",
    "radius_from_indentation",
    "radius_from_area",
    "radius_from_compliance",
    "geometric_radius_from_indentation",
    "geometric_radius_from_area",
    "geometric_radius_from_compliance",
    "indentation",
    "reduced_modulus",
    "youngs_modulus",
    "mean_pressure",
    "contact_radius_ratio",
    "predicted_elongation",
)

_ELLIPSE: Final = ("semi_major", "semi_minor")
_PAD_INPUTS: Final = tuple(name for names in PAD_SOURCES.values() for name in names)
_ROUNDING: Final = 1e-9


def pad_model(
    *,
    palmar: FloatArray,
    distal: FloatArray,
    radial_ulnar: FloatArray,
    wedge_angle: FloatArray,
    roll_angle: FloatArray,
    poisson_ratio: FloatArray,
    image_scale: FloatArray,
    edge_offset: FloatArray,
    load: FloatArray,
    contact_radius: FloatArray,
    elongation: FloatArray,
    radius_deviation: FloatArray | float = 0.0,
    elongation_deviation: FloatArray | float = 0.0,
    in_plane_deviation: FloatArray | float = 0.0,
    transverse_deviation: FloatArray | float = 0.0,
) -> dict[str, FloatArray]:
    """Return what follows from a pad on its wedge and an observed contact ellipse.

    The contact ellipse enters by its radius √(ℓd ℓe) and elongation ln(ℓd/ℓe), which stays differentiable
    where noise makes the axes of a near-circle change places.

    Parameters
    ----------
    palmar, distal, radial_ulnar : ndarray
        Semi-axes of the pad.
    wedge_angle, roll_angle : ndarray
        Placement, radians.
    poisson_ratio : ndarray
        ν of the pad.
    image_scale : ndarray
        Factor on the lengths of the contact ellipse, one: a separate input, because all images that it
        calibrates share it.
    edge_offset : ndarray
        Displacement of the contact's edge, added to both semi-axes, zero: an input of its own, because all
        images of one device share it.
    load : ndarray
        Normal force W.
    contact_radius : ndarray
        √(ℓd ℓe).
    elongation : ndarray
        ln(ℓd/ℓe).
    radius_deviation, elongation_deviation : ndarray
        By how much the logarithm of the radius, and the elongation, of one impression differ from those of
        others under the same load, zero: inputs of their own, whose uncertainty is the repeatability.
    in_plane_deviation, transverse_deviation : ndarray
        By how much the logarithms of the pad's principal radii along the finger and across it differ at the
        place of contact from those of the ellipsoid: no finger is one.

    Returns
    -------
    dict of str to ndarray
        ``mean_curvature_radius`` R_0g = 1/H and ``geometric_mean_radius`` R_e = √(R'R'') of the undeformed
        pad; ``radius_from_indentation`` (the corrected radius of Dzidek et al. 2017), ``radius_from_area``
        and ``radius_from_compliance``, spheres equivalent to the contact on R_0g, and the same on R_e as
        ``geometric_radius_from_…``; ``indentation`` ξ = A/(π R_Aξ), on R_e; ``reduced_modulus``
        E* = 3 W R_e F1³/(4 (ℓd ℓe)^{3/2}), ``youngs_modulus`` E*(1 − ν²), ``mean_pressure`` W/A;
        ``contact_radius_ratio`` √(ℓd ℓe)/R_e, which Hertz theory takes to be small; ``predicted_elongation``,
        the signed ln(ℓd/ℓe) of Hertz theory, positive where the long axis lies along the finger.

    Examples
    --------
    >>> import numpy as np
    >>> outputs = pad_model(
    ...     palmar=7.9,
    ...     distal=13.8,
    ...     radial_ulnar=11.8,
    ...     wedge_angle=np.radians(30),
    ...     roll_angle=0.0,
    ...     poisson_ratio=0.5,
    ...     image_scale=1.0,
    ...     edge_offset=0.0,
    ...     load=2.0,
    ...     contact_radius=np.sqrt(7.4 * 5.0),
    ...     elongation=np.log(7.4 / 5.0),
    ... )
    >>> print(f"{outputs['mean_curvature_radius']:.3f}")
    13.608
    """
    half = np.exp(0.5 * (elongation + elongation_deviation))
    radius = image_scale * contact_radius * np.exp(radius_deviation)
    major, minor = radius * half + edge_offset, radius / half + edge_offset
    normal = platen_normal_kernel(wedge_angle, roll_angle)
    radii = principal_radii_kernel(palmar, distal, radial_ulnar, normal=normal)
    radii = PrincipalRadii(
        radii.first * np.exp(in_plane_deviation), radii.second * np.exp(transverse_deviation)
    )
    return _observed(radii, major, minor, load, poisson_ratio)


@np.errstate(all="ignore")
def _observed(
    principal_radii: PrincipalRadii,
    major: FloatArray,
    minor: FloatArray,
    load: FloatArray,
    poisson_ratio: FloatArray,
) -> dict[str, FloatArray]:
    """Return the outputs of `pad_model` from the pad's radii and the observed contact ellipse.

    The axes may change places: the ratio of a near-circle stays differentiable where noise swaps them.
    """
    major, minor, load = broadcast(major, minor, load)
    in_plane, transverse = principal_radii
    axis_ratio = np.minimum(major, minor) / np.maximum(major, minor)
    base, exact = 2 / (1 / in_plane + 1 / transverse), np.sqrt(in_plane * transverse)
    size, area = np.sqrt(major * minor), np.pi * major * minor
    predicted, _, _ = solve_contact_ellipse(in_plane, transverse)
    along = np.sign(np.real(in_plane - transverse))
    from_indentation, from_area, from_compliance = equivalent_radius_ratios(axis_ratio)
    modulus = 0.75 * load * exact * from_area / size**3
    return {
        "mean_curvature_radius": base,
        "geometric_mean_radius": exact,
        "radius_from_indentation": base * from_indentation,
        "radius_from_area": base * from_area,
        "radius_from_compliance": base * from_compliance,
        "geometric_radius_from_indentation": exact * from_indentation,
        "geometric_radius_from_area": exact * from_area,
        "geometric_radius_from_compliance": exact * from_compliance,
        "indentation": area / (np.pi * exact * from_compliance),
        "reduced_modulus": modulus,
        "youngs_modulus": from_reduced_modulus(modulus, poisson_ratio),
        "mean_pressure": load / area,
        "contact_radius_ratio": size / exact,
        "predicted_elongation": -along * np.log(predicted),
    }


def pad_inputs(measured: Inputs) -> Inputs:
    """Return the inputs of `pad_model` that follow from measured quantities.

    The semi-axes of the contact ellipse become its radius and elongation, to first order; all else is kept.

    Parameters
    ----------
    measured : Inputs
        The parameters of `pad_uncertainty`, all of them.

    Returns
    -------
    Inputs
        With `PAD_SOURCES` as groups.

    Raises
    ------
    UncertaintyError
        If a quantity is missing, or the semi-axes correlate by more than one.

    Examples
    --------
    >>> measured = Inputs.of(
    ...     palmar=7.9,
    ...     distal=13.8,
    ...     radial_ulnar=11.8,
    ...     wedge_angle=0.5,
    ...     roll_angle=0.0,
    ...     poisson_ratio=0.5,
    ...     image_scale=1.0,
    ...     edge_offset=0.0,
    ...     load=2.0,
    ...     semi_major=(7.4, 0.1),
    ...     semi_minor=(5.0, 0.1),
    ...     radius_deviation=0.0,
    ...     elongation_deviation=0.0,
    ...     in_plane_deviation=0.0,
    ...     transverse_deviation=0.0,
    ... )
    >>> inputs = pad_inputs(measured)
    >>> inputs.mean[inputs.places(["contact_radius", "elongation"])].round(3)
    array([6.083, 0.392])
    """
    kept = [name for name in _PAD_INPUTS if name not in PAD_SOURCES["contact ellipse"]]
    others, ellipse = measured.places(kept), measured.places(_ELLIPSE)
    axes = measured.mean[..., ellipse]
    block = measured.covariance[..., np.array(ellipse)[:, None], ellipse]
    limit = (1 + _ROUNDING) * np.sqrt(block[..., 0, 0] * block[..., 1, 1])
    check_all(
        ~(np.abs(block[..., 0, 1]) > limit),
        "covariance of semi_major and semi_minor",
        block[..., 0, 1],
        "that of a correlation within [-1, 1]",
        UncertaintyError,
    )
    count = len(others)
    mean = np.empty((*axes.shape[:-1], count + 2))
    covariance = np.empty((*axes.shape[:-1], count + 2, count + 2))
    with np.errstate(all="ignore"):
        radius, elongation = np.sqrt(axes.prod(axis=-1)), np.log(axes[..., 0] / axes[..., 1])
        derivatives = np.stack([0.5 * radius[..., None] / axes, [1, -1] / axes], axis=-2)
        mean[..., :count] = measured.mean[..., others]
        mean[..., count], mean[..., count + 1] = radius, elongation
        # A product with its own transpose cannot get a negative variance by rounding.
        root = derivatives @ covariance_root(block)
        across = measured.covariance[..., np.array(others)[:, None], ellipse] @ _transpose(derivatives)
        covariance[..., :count, :count] = measured.covariance[..., np.array(others)[:, None], others]
        covariance[..., :count, count:], covariance[..., count:, :count] = across, _transpose(across)
        covariance[..., count:, count:] = root @ _transpose(root)
    return Inputs(names=_PAD_INPUTS, mean=mean, covariance=covariance, groups=PAD_SOURCES)


def _transpose(matrices: FloatArray) -> FloatArray:
    return np.swapaxes(matrices, -1, -2)


def _check_ranges(measured: Inputs) -> None:
    """Refuse what no finger on a wedge has, as degrees are in place of radians. NaN passes."""
    value, std = (
        dict(zip(measured.names, np.moveaxis(each, -1, 0), strict=True))
        for each in (measured.mean, measured.std)
    )
    checked_placement(value["wedge_angle"], value["roll_angle"])
    for name in ("wedge_angle", "roll_angle"):
        expected = f"at most π/2 ({IN_RADIANS})"
        what = f"standard uncertainty of {name}"
        check_all(~(std[name] > np.pi / 2), what, std[name], expected, GeometryError)
    for name in (*PAD_SOURCES["semi-axes"], *_ELLIPSE, "image_scale"):
        check_all(~(value[name] <= 0), name, value[name], "positive", GeometryError)
    check_all(~(value["load"] < 0), "load", value["load"], "positive or zero", GeometryError)
    nu = value["poisson_ratio"]
    check_all(~((nu < -1) | (nu > 0.5)), "poisson_ratio", nu, "within [-1, 0.5]", GeometryError)


def pad_uncertainty(
    *,
    palmar: Quantity,
    distal: Quantity,
    radial_ulnar: Quantity,
    wedge_angle: Quantity,
    load: Quantity,
    semi_major: Quantity,
    semi_minor: Quantity,
    roll_angle: Quantity = 0.0,
    poisson_ratio: Quantity = 0.5,
    image_scale: Quantity = 1.0,
    edge_offset: Quantity = 0.0,
    radius_deviation: Quantity = 0.0,
    elongation_deviation: Quantity = 0.0,
    in_plane_deviation: Quantity = 0.0,
    transverse_deviation: Quantity = 0.0,
    correlations: Mapping[tuple[str, str], ArrayLike] | None = None,
) -> Propagated:
    """Return everything that follows from an observed contact ellipse, with uncertainty.

    Each quantity is an exact number, or a pair of a value and its standard uncertainty, either of which may
    be an array; those of many contacts broadcast.

    Parameters
    ----------
    palmar, distal, radial_ulnar : float, or pair of array_like
        Semi-axes of the pad.
    wedge_angle, roll_angle : float, or pair of array_like
        Placement, radians.
    load : float, or pair of array_like
        Normal force W.
    semi_major, semi_minor : float, or pair of array_like
        Semi-axes of the contact ellipse, in either order, without the uncertainties of `image_scale` and
        `edge_offset`.
    poisson_ratio : float, or pair of array_like
        ν of the pad.
    image_scale : float, or pair of array_like
        Factor on both semi-axes of the contact ellipse, as (1, 0.01) for a scale known to 1 %.
    edge_offset : float, or pair of array_like
        Displacement of the contact's edge, added to both semi-axes, as (0, 0.06) with the
        `ContactImageResult.edge_offset_std` of 0.06 mm.
    radius_deviation, elongation_deviation : float, or pair of array_like
        By how much one impression differs from others under the same load, in ln √(ℓd ℓe) and ln(ℓd/ℓe): as
        (0, 0.02) with a repeatability of 2 %.
    in_plane_deviation, transverse_deviation : float, or pair of array_like
        By how much the logarithms of the pad's principal radii along the finger and across it differ at the
        place of contact from those of the ellipsoid: as (0, 0.1) of a pad that is no ellipsoid.
    correlations : mapping, optional
        From pairs of these names to correlation coefficients.

    Returns
    -------
    Propagated
        The outputs of `pad_model`, by name.

    Raises
    ------
    GeometryError
        If a wedge angle lies outside [0, π/2], a roll outside [−π/2, π/2] or ν outside [−1, 0.5], the
        standard uncertainty of an angle is larger than π/2, a length or the image scale is not positive, or
        the load is negative.
    UncertaintyError
        If a standard uncertainty is negative or NaN, or the correlations cannot be those of these quantities.

    Examples
    --------
    >>> import numpy as np
    >>> result = pad_uncertainty(
    ...     palmar=(7.9, 0.1),
    ...     distal=(13.8, 0.1),
    ...     radial_ulnar=(11.8, 0.1),
    ...     wedge_angle=(np.radians(30), np.radians(0.5)),
    ...     load=(2, 0.02),
    ...     semi_major=(7.4, 0.1),
    ...     semi_minor=(5.0, 0.1),
    ...     correlations={("palmar", "distal"): 0.9},
    ... )
    >>> print(f"{result['radius_from_indentation']:.2f} mm")
    13.80 ± 0.18 mm
    >>> shares = result.budget("radius_from_indentation")
    >>> max(shares, key=shares.get)
    'wedge angle'

    The same inputs by Monte Carlo:

    >>> from fingerpad.uncertainty import run_monte_carlo
    >>> simulated = run_monte_carlo(pad_model, result.inputs)
    >>> print(f"{simulated['radius_from_indentation']:.2f} mm")
    13.80 ± 0.18 mm
    """
    measured = Inputs.of(
        palmar=palmar,
        distal=distal,
        radial_ulnar=radial_ulnar,
        wedge_angle=wedge_angle,
        roll_angle=roll_angle,
        poisson_ratio=poisson_ratio,
        image_scale=image_scale,
        edge_offset=edge_offset,
        radius_deviation=radius_deviation,
        elongation_deviation=elongation_deviation,
        in_plane_deviation=in_plane_deviation,
        transverse_deviation=transverse_deviation,
        load=load,
        semi_major=semi_major,
        semi_minor=semi_minor,
        correlations=correlations,
    )
    _check_ranges(measured)
    return propagate(pad_model, pad_inputs(measured))
