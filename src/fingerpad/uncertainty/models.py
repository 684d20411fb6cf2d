"""The finger pad as a model of named quantities: where it touches, what a contact says of it, and on bone."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import IN_RADIANS, ArrayLike, FloatArray, as_float_array, broadcast, check_all
from fingerpad.contact.contact import Contact, from_reduced_modulus
from fingerpad.contact.elliptic import solve_contact_ellipse
from fingerpad.contact.fast_laws import find_modulus
from fingerpad.contact.hertz import equivalent_radius_ratios
from fingerpad.exceptions import GeometryError, UncertaintyError
from fingerpad.geometry.ellipsoid import principal_radii_kernel
from fingerpad.geometry.gap import gap_kernel, paraboloid_gap
from fingerpad.geometry.placement import checked_placement, platen_normal
from fingerpad.uncertainty.propagate import Propagated, propagate
from fingerpad.uncertainty.quantities import Given, Groups, Inputs, covariance_root

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
LAYER_SOURCES: Final[Groups] = {**PAD_SOURCES, "thickness": ("thickness",)}
LAYER_OUTPUTS: Final = (
    "reduced_modulus_on_layer",
    "youngs_modulus_on_layer",
    "indentation_on_layer",
    "loading_radius_on_layer",
)

_ELLIPSE: Final = ("semi_major", "semi_minor")
_ROUNDING: Final = 1e-9


def placement_model(
    *,
    palmar: FloatArray,
    distal: FloatArray,
    radial_ulnar: FloatArray,
    wedge_angle: FloatArray,
    roll_angle: FloatArray | float = 0.0,
    in_plane_deviation: FloatArray | float = 0.0,
    transverse_deviation: FloatArray | float = 0.0,
) -> dict[str, FloatArray]:
    """Return radii of curvature and the angle u at the place of contact.

    Parameters
    ----------
    palmar, distal, radial_ulnar : ndarray
        Semi-axes of the pad, in any unit.
    wedge_angle, roll_angle : ndarray
        Placement, radians.
    in_plane_deviation, transverse_deviation : ndarray
        As for `pad_model`.

    Returns
    -------
    dict of str to ndarray
        ``in_plane_radius``, ``transverse_radius``, ``mean_curvature_radius`` and ``geometric_mean_radius``
        in the unit of the semi-axes, ``u`` in radians.

    Examples
    --------
    >>> from fingerpad.uncertainty import Inputs, propagate
    >>> inputs = Inputs.of(
    ...     palmar=(7.9, 0.1),
    ...     distal=(13.8, 0.1),
    ...     radial_ulnar=(11.8, 0.1),
    ...     wedge_angle=(np.radians(30), np.radians(0.5)),
    ... )
    >>> print(f"{propagate(placement_model, inputs)['mean_curvature_radius']:.2f}")
    13.61 ± 0.18
    """
    normal = platen_normal(wedge_angle, roll_angle)
    in_plane, transverse = principal_radii_kernel(palmar, distal, radial_ulnar, normal=normal)
    in_plane = in_plane * np.exp(in_plane_deviation)
    transverse = transverse * np.exp(transverse_deviation)
    x, y = palmar * normal[..., 0], distal * normal[..., 1]
    return {
        "in_plane_radius": in_plane,
        "transverse_radius": transverse,
        "mean_curvature_radius": 2 / (1 / in_plane + 1 / transverse),
        "geometric_mean_radius": np.sqrt(in_plane * transverse),
        "u": 2 * np.arctan(y / (x + np.sqrt(x * x + y * y))),  # arctan2, for complex steps too
    }


@np.errstate(all="ignore")
def pad_model(
    *,
    palmar: FloatArray,
    distal: FloatArray,
    radial_ulnar: FloatArray,
    wedge_angle: FloatArray,
    load: FloatArray,
    contact_radius: FloatArray,
    elongation: FloatArray,
    roll_angle: FloatArray | float = 0.0,
    poisson_ratio: FloatArray | float = 0.5,
    image_scale: FloatArray | float = 1.0,
    edge_offset: FloatArray | float = 0.0,
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
    load : ndarray
        Normal force W.
    contact_radius : ndarray
        √(ℓd ℓe).
    elongation : ndarray
        ln(ℓd/ℓe).
    poisson_ratio : ndarray
        ν of the pad.
    image_scale : ndarray
        Factor on the lengths of the contact ellipse: a separate input, because all images that it
        calibrates share it.
    edge_offset : ndarray
        Displacement of the contact's edge, added to both semi-axes: an input of its own, because all
        images of one device share it.
    radius_deviation, elongation_deviation : ndarray
        By how much the logarithm of the radius, and the elongation, of one impression differ from those of
        others under the same load: inputs of their own, whose uncertainty is the repeatability.
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
    >>> pad = {"palmar": 7.9, "distal": 13.8, "radial_ulnar": 11.8, "wedge_angle": 0.5236}
    >>> seen = {"contact_radius": np.sqrt(7.4 * 5.0), "elongation": np.log(7.4 / 5.0)}
    >>> print(f"{pad_model(**pad, **seen, load=2.0)['radius_from_indentation']:.2f}")
    13.80
    """
    half = np.exp(0.5 * (elongation + elongation_deviation))
    radius = image_scale * contact_radius * np.exp(radius_deviation)
    normal = platen_normal(wedge_angle, roll_angle)
    in_plane, transverse = principal_radii_kernel(palmar, distal, radial_ulnar, normal=normal)
    in_plane = in_plane * np.exp(in_plane_deviation)
    transverse = transverse * np.exp(transverse_deviation)
    # The axes may change places: the ratio of a near-circle stays differentiable where noise swaps them.
    major, minor, load = broadcast(radius * half + edge_offset, radius / half + edge_offset, load)
    axis_ratio = np.minimum(major, minor) / np.maximum(major, minor)
    base, exact = 2 / (1 / in_plane + 1 / transverse), np.sqrt(in_plane * transverse)
    size, area = np.sqrt(major * minor), np.pi * major * minor
    predicted, _, _ = solve_contact_ellipse(in_plane, transverse)
    # By their complex steps where they are equal, as the ratio that k follows from.
    along = 1.0 * (in_plane > transverse) - (in_plane < transverse)
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


_PARAMETERS: Final = inspect.signature(pad_model).parameters
# What a quantity is where it is not given.
_DEFAULTS: Final = {name: one.default for name, one in _PARAMETERS.items() if one.default is not one.empty}
# What is measured: the contact ellipse by its semi-axes.
_MEASURED: Final = (
    *(name for name in _PARAMETERS if name not in PAD_SOURCES["contact ellipse"]),
    *("semi_major", "semi_minor"),
)


def layer_model(*, thickness: FloatArray, **pad: FloatArray) -> dict[str, FloatArray]:
    """Return what follows from a pad and a contact ellipse, by Hertz theory and on a layer over bone.

    Parameters
    ----------
    thickness : ndarray
        Effective thickness of the tissue.
    **pad : ndarray
        The parameters of `pad_model`. On the layer a Poisson's ratio above 0.5, which a draw can have, is
        taken as 0.5.

    Returns
    -------
    dict of str to ndarray
        The outputs of `pad_model`, and `LAYER_OUTPUTS`; these are NaN beyond the range of the fast laws (see
        `fingerpad.contact.fast_contact`).

    Examples
    --------
    >>> pad = {"palmar": 7.9, "distal": 13.8, "radial_ulnar": 11.8, "wedge_angle": 0.5236}
    >>> seen = {"contact_radius": np.sqrt(7.4 * 5.0), "elongation": np.log(7.4 / 5.0)}
    >>> found = layer_model(**pad, **seen, load=2.0, thickness=8.0)
    >>> print(f"{found['loading_radius_on_layer']:.2f}")
    20.43
    """
    hertz = pad_model(**pad)
    modulus, contact = _on_layer(thickness, pad, hertz)
    nu = _possible(pad.get("poisson_ratio", _DEFAULTS["poisson_ratio"]))
    values = (
        modulus,
        from_reduced_modulus(modulus, nu),
        contact.indentation,
        contact.area_over_pi_indentation,
    )
    return {**hertz, **dict(zip(LAYER_OUTPUTS, values, strict=True))}


def indentation_model(
    *,
    palmar: FloatArray,
    distal: FloatArray,
    radial_ulnar: FloatArray,
    wedge_angle: FloatArray,
    roll_angle: FloatArray,
    poisson_ratio: FloatArray,
    load: FloatArray,
    indentation: FloatArray,
    contact_shift: FloatArray,
    thickness: FloatArray,
) -> dict[str, FloatArray]:
    """Return what a load and a measured indentation tell of a pad, by Hertz theory and on a layer.

    W and ξ from the place of first contact. On the layer ξ is larger by `contact_shift`, as that place was
    found by Hertz theory: on bone the load rises later, and it seems deeper than it is; and a Poisson's ratio
    above 0.5, which a draw can have, is taken as 0.5.
    """
    axes = broadcast(palmar, distal, radial_ulnar)
    gap = gap_kernel(*axes, normal=platen_normal(wedge_angle, roll_angle))
    hertz, _ = find_modulus(
        paraboloid_gap(gap.first_radius, gap.second_radius), load=load, indentation=indentation
    )
    nu = _possible(poisson_ratio)
    layered, contact = find_modulus(
        gap, load=load, indentation=indentation + contact_shift, thickness=thickness, poisson_ratio=nu
    )
    return {
        "youngs_modulus_from_indentation": from_reduced_modulus(hertz, poisson_ratio),
        "youngs_modulus_from_indentation_on_layer": from_reduced_modulus(layered, nu),
        "loading_radius_on_layer": contact.area_over_pi_indentation,
    }


def layer_flag(inputs: Inputs) -> npt.NDArray[np.str_]:
    """Return which limit of the fast laws takes each contact out of their range, empty where none does.

    Parameters
    ----------
    inputs : Inputs
        Those of `layer_model`.

    Returns
    -------
    ndarray of str
        Names as in `Contact.flags`.

    Examples
    --------
    >>> pad = {"palmar": 7.9, "distal": 13.8, "radial_ulnar": 11.8, "wedge_angle": 0.5, "load": 2.0}
    >>> result = pad_uncertainty(**pad, semi_major=9.0, semi_minor=8.0, thickness=8.0)
    >>> str(layer_flag(result.inputs))
    'contact_too_wide'
    """
    pad = dict(zip(inputs.names, np.moveaxis(inputs.mean, -1, 0), strict=True))
    thickness = pad.pop("thickness")
    return _on_layer(thickness, pad, pad_model(**pad))[1].flags


@np.errstate(all="ignore")
def _on_layer(
    thickness: FloatArray, pad: Mapping[str, FloatArray], hertz: Mapping[str, FloatArray]
) -> tuple[FloatArray, Contact]:
    """Return E* and the contact of a pad whose area is that of the contact ellipse."""
    given: dict[str, Any] = {**_DEFAULTS, **pad}
    # Of a pad that is larger as a whole all radii are larger by as much.
    larger = np.exp(sum(given[name] for name in PAD_SOURCES["pad shape"]) / 2)
    axes = broadcast(*(larger * given[name] for name in PAD_SOURCES["semi-axes"]))
    radius = hertz["contact_radius_ratio"] * hertz["geometric_mean_radius"]
    return find_modulus(
        gap_kernel(*axes, normal=platen_normal(given["wedge_angle"], given["roll_angle"])),
        thickness=thickness,
        poisson_ratio=_possible(given["poisson_ratio"]),
        load=given["load"],
        area=np.pi * radius**2,
    )


def _possible(poisson_ratio: ArrayLike) -> FloatArray:
    """Return ν, at most 0.5; the derivative at 0.5 is that from below."""
    nu = as_float_array(poisson_ratio)
    return np.where(nu.real > 0.5, 0.5, nu)


def pad_inputs(measured: Inputs) -> Inputs:
    """Return the inputs of `pad_model`, or of `layer_model`, that follow from those of `pad_uncertainty`.

    The semi-axes of the contact ellipse become its radius and elongation, to first order; all else is kept.
    Groups are `PAD_SOURCES`, with a thickness `LAYER_SOURCES`.
    """
    sources = LAYER_SOURCES if "thickness" in measured.names else PAD_SOURCES
    names = tuple(name for inputs in sources.values() for name in inputs)
    kept = [name for name in names if name not in PAD_SOURCES["contact ellipse"]]
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
    at = np.array([names.index(name) for name in kept])
    to = np.array([names.index(name) for name in PAD_SOURCES["contact ellipse"]])
    mean = np.empty((*axes.shape[:-1], len(names)))
    covariance = np.empty((*mean.shape, len(names)))
    with np.errstate(all="ignore"):
        radius, elongation = np.sqrt(axes.prod(axis=-1)), np.log(axes[..., 0] / axes[..., 1])
        derivatives = np.stack([0.5 * radius[..., None] / axes, [1, -1] / axes], axis=-2)
        mean[..., at], mean[..., to] = measured.mean[..., others], np.stack([radius, elongation], axis=-1)
        # A product with its own transpose cannot get a negative variance by rounding.
        root = derivatives @ covariance_root(block)
        across = measured.covariance[..., np.array(others)[:, None], ellipse] @ _transpose(derivatives)
        covariance[..., at[:, None], at] = measured.covariance[..., np.array(others)[:, None], others]
        covariance[..., at[:, None], to], covariance[..., to[:, None], at] = across, _transpose(across)
        covariance[..., to[:, None], to] = root @ _transpose(root)
    return Inputs(names=names, mean=mean, covariance=covariance, groups=sources)


def _transpose(matrices: FloatArray) -> FloatArray:
    return np.swapaxes(matrices, -1, -2)


def pad_uncertainty(
    *, correlations: Mapping[tuple[str, str], ArrayLike] | None = None, **measured: Given
) -> Propagated:
    """Return everything that follows from an observed contact ellipse, with uncertainty.

    Each quantity is an exact number, an `Estimate`, or a pair of a value and its standard uncertainty, either
    of which may be an array; those of many contacts broadcast.

    Parameters
    ----------
    correlations : mapping, optional
        From pairs of names to correlation coefficients.
    **measured : float, Estimate, or pair of array_like
        The semi-axes ``palmar``, ``distal`` and ``radial_ulnar`` of the pad, ``wedge_angle`` (radians),
        ``load``, and the semi-axes ``semi_major`` and ``semi_minor`` of the contact ellipse, in either order,
        without the uncertainties of scale and edge. What is not given is exact: ``roll_angle`` and
        ``poisson_ratio`` (0 and 0.5); ``image_scale``, as (1, 0.01) for a scale known to 1 %;
        ``edge_offset``, as (0, 0.06) with the `ContactImageResult.edge_offset_std` of 0.06 mm;
        ``radius_deviation`` and ``elongation_deviation``, as (0, 0.02) with a repeatability of 2 %;
        ``in_plane_deviation`` and ``transverse_deviation``, as (0, 0.1) of a pad that is no ellipsoid: each
        as in `pad_model`. With a ``thickness`` the pad is also taken as a layer of tissue over bone.

    Returns
    -------
    Propagated
        The outputs of `pad_model`, with a thickness those of `layer_model`, by name.

    Raises
    ------
    GeometryError
        If a wedge angle lies outside [0, π/2], a roll outside [−π/2, π/2] or ν outside [−1, 0.5], the
        standard uncertainty of an angle is larger than π/2, a length or the image scale is not positive, the
        load is negative, or the shapes do not broadcast.
    UncertaintyError
        If a quantity is missing, has no such name or is no number, a standard uncertainty is negative or not
        finite, or the correlations cannot be those of these quantities.

    Examples
    --------
    >>> measured = {
    ...     "palmar": (7.9, 0.1),
    ...     "distal": (13.8, 0.1),
    ...     "radial_ulnar": (11.8, 0.1),
    ...     "wedge_angle": (np.radians(30), np.radians(0.5)),
    ...     "load": (2, 0.02),
    ...     "semi_major": (7.4, 0.1),
    ...     "semi_minor": (5.0, 0.1),
    ... }
    >>> result = pad_uncertainty(**measured, correlations={("palmar", "distal"): 0.9})
    >>> print(f"{result['radius_from_indentation']:.2f} mm")
    13.80 ± 0.18 mm
    >>> shares = result.budget("radius_from_indentation")
    >>> max(shares, key=shares.get)
    'wedge angle'

    On a layer over bone:

    >>> layered = pad_uncertainty(**measured, thickness=(8.0, 1.5))
    >>> for name in ("youngs_modulus", "youngs_modulus_on_layer"):
    ...     print(f"{1000 * layered[name].value:.0f} ± {1000 * layered[name].std:.0f} kPa")
    67 ± 3 kPa
    49 ± 5 kPa
    """
    given = Inputs.of(**_complete(measured), correlations=correlations)
    _check_ranges(given)
    return propagate(layer_model if "thickness" in measured else pad_model, pad_inputs(given))


def _complete(measured: Mapping[str, Given]) -> dict[str, Given]:
    """Return all quantities by name, and refuse names that the model does not have, and missing ones."""
    for name in measured:
        if name not in (*_MEASURED, "thickness"):
            raise UncertaintyError(f"no quantity {name!r}; there are {', '.join(_MEASURED)}, thickness")
    missing = [name for name in _MEASURED if name not in measured and name not in _DEFAULTS]
    if missing:
        raise UncertaintyError(f"give {', '.join(missing)} too, each as a number or (value, uncertainty)")
    return {**measured, **{name: _DEFAULTS[name] for name in _MEASURED if name not in measured}}


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
    for name in (*PAD_SOURCES["semi-axes"], *_ELLIPSE, "image_scale", "thickness"):
        if name in value:
            check_all(~(value[name] <= 0), name, value[name], "positive", GeometryError)
    check_all(~(value["load"] < 0), "load", value["load"], "positive or zero", GeometryError)
    nu = value["poisson_ratio"]
    check_all(~((nu < -1) | (nu > 0.5)), "poisson_ratio", nu, "within [-1, 0.5]", GeometryError)
