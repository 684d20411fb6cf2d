"""The pad on a layer of tissue over bone as a model of named quantities."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

import numpy as np
import numpy.typing as npt

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array, broadcast
from fingerpad.contact.contact import Contact, from_reduced_modulus
from fingerpad.contact.laws import find_modulus
from fingerpad.geometry.gap import Gap, gap_kernel, paraboloid_gap
from fingerpad.geometry.placement import platen_normal_kernel
from fingerpad.uncertainty.inputs import Groups, Inputs
from fingerpad.uncertainty.pad import PAD_SOURCES, pad_model

# Sources of an uncertainty budget, by the names of their inputs.
LAYER_SOURCES: Final[Groups] = {**PAD_SOURCES, "thickness": ("thickness",)}
LAYER_OUTPUTS: Final = (
    "reduced_modulus_on_layer",
    "youngs_modulus_on_layer",
    "indentation_on_layer",
    "loading_radius_on_layer",
)


def layer_model(*, thickness: FloatArray, **pad: FloatArray) -> dict[str, FloatArray]:
    """Return what a contact's load and area tell of a pad on a layer of tissue over bone.

    Parameters
    ----------
    thickness : ndarray
        Effective thickness of the tissue.
    **pad : ndarray
        The parameters of `pad_model`. A Poisson's ratio above 0.5, which a draw can have, is taken as 0.5.

    Returns
    -------
    dict of str to ndarray
        `LAYER_OUTPUTS`; NaN beyond the range of the fast laws (see `fingerpad.contact.fast_contact`).

    Examples
    --------
    >>> import numpy as np
    >>> outputs = layer_model(
    ...     thickness=8.0,
    ...     palmar=7.9,
    ...     distal=13.8,
    ...     radial_ulnar=11.8,
    ...     wedge_angle=np.radians(30),
    ...     roll_angle=0.0,
    ...     poisson_ratio=0.5,
    ...     image_scale=1.0,
    ...     load=2.0,
    ...     contact_radius=np.sqrt(7.4 * 5.0),
    ...     elongation=np.log(7.4 / 5.0),
    ...     edge_offset=0.0,
    ... )
    >>> print(f"{outputs['loading_radius_on_layer']:.2f}")
    20.43
    """
    modulus, contact = _contact_of(thickness, pad)
    values = (
        modulus,
        from_reduced_modulus(modulus, _possible(pad["poisson_ratio"])),
        contact.indentation,
        contact.area_over_pi_indentation,
    )
    return dict(zip(LAYER_OUTPUTS, values, strict=True))


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
    >>> from fingerpad.uncertainty import pad_uncertainty
    >>> pad = {"palmar": 7.9, "distal": 13.8, "radial_ulnar": 11.8, "wedge_angle": 0.5, "load": 2.0}
    >>> inputs = pad_uncertainty(**pad, semi_major=9.0, semi_minor=8.0).inputs
    >>> str(layer_flag(with_thickness(inputs, 8.0)))
    'contact_too_wide'
    """
    named = dict(zip(inputs.names, np.moveaxis(inputs.mean, -1, 0), strict=True))
    return _contact_of(named.pop("thickness"), named)[1].flags


def with_thickness(inputs: Inputs, thickness: ArrayLike, thickness_std: ArrayLike = 0.0) -> Inputs:
    """Return the inputs of `layer_model` from those of `pad_model`.

    Parameters
    ----------
    inputs : Inputs
        From `pad_inputs`.
    thickness, thickness_std : array_like
        Effective thickness and its standard uncertainty, independent of all others.

    Returns
    -------
    Inputs
        With "thickness" as one more source.

    Examples
    --------
    >>> inputs = with_thickness(Inputs.of(load=(2.0, 0.1)), 8.0, 1.5)
    >>> inputs.names, inputs.std
    (('load', 'thickness'), array([0.1, 1.5]))
    """
    shape = np.broadcast_shapes(inputs.mean.shape[:-1], np.shape(thickness), np.shape(thickness_std))
    count = len(inputs.names)
    mean, covariance = np.empty((*shape, count + 1)), np.zeros((*shape, count + 1, count + 1))
    mean[..., :count], mean[..., count] = inputs.mean, thickness
    covariance[..., :count, :count] = inputs.covariance
    covariance[..., count, count] = as_float_array(thickness_std) ** 2
    return replace(
        inputs,
        names=(*inputs.names, "thickness"),
        mean=mean,
        covariance=covariance,
        groups={**inputs.groups, "thickness": ("thickness",)},
    )


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

    Parameters
    ----------
    palmar, distal, radial_ulnar : ndarray
        Semi-axes of the pad.
    wedge_angle, roll_angle : ndarray
        Placement, radians.
    poisson_ratio : ndarray
        ν of the pad; above 0.5, which a draw can have, it is taken as 0.5 on the layer.
    load, indentation : ndarray
        Normal force W, and indentation ξ from the place of first contact.
    contact_shift : ndarray
        By how much ξ is larger on the layer, where its place of first contact was found by Hertz theory: on
        bone the load rises later, and that place seems deeper than it is.
    thickness : ndarray
        Effective thickness of the tissue.

    Returns
    -------
    dict of str to ndarray
        ``youngs_modulus_from_indentation`` of Hertz theory (half-space, paraboloid of the pad's radii), and
        ``youngs_modulus_from_indentation_on_layer`` and ``loading_radius_on_layer`` of the whole pad.

    Examples
    --------
    >>> from fingerpad.uncertainty import propagate
    >>> inputs = Inputs.of(
    ...     palmar=7.9,
    ...     distal=13.8,
    ...     radial_ulnar=11.8,
    ...     wedge_angle=np.radians(30),
    ...     roll_angle=0.0,
    ...     poisson_ratio=0.5,
    ...     load=2.0,
    ...     indentation=(1.81, 0.05),
    ...     contact_shift=0.0,
    ...     thickness=(8.0, 1.5),
    ... )
    >>> moduli = propagate(indentation_model, inputs)
    >>> for name in moduli.names[:2]:
    ...     print(f"{1000 * moduli[name].value:.0f} ± {1000 * moduli[name].std:.0f} kPa")
    125 ± 5 kPa
    50 ± 10 kPa
    """
    gap = _gap(palmar, distal, radial_ulnar, wedge_angle=wedge_angle, roll_angle=roll_angle)
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


@np.errstate(all="ignore")
def _contact_of(thickness: FloatArray, pad: Mapping[str, FloatArray]) -> tuple[FloatArray, Contact]:
    """Return E* and the contact of a pad whose area is that of the contact ellipse."""
    # Of a pad that is larger as a whole all radii are larger by as much.
    deviations = (pad.get(name, 0.0) for name in PAD_SOURCES["pad shape"])
    larger = np.exp(sum(deviations) / 2)
    axes = (larger * pad[name] for name in PAD_SOURCES["semi-axes"])
    hertz = pad_model(**pad)
    radius = hertz["contact_radius_ratio"] * hertz["geometric_mean_radius"]
    return find_modulus(
        _gap(*axes, wedge_angle=pad["wedge_angle"], roll_angle=pad["roll_angle"]),
        thickness=thickness,
        poisson_ratio=_possible(pad["poisson_ratio"]),
        load=pad["load"],
        area=np.pi * radius**2,
    )


def _gap(*semi_axes: FloatArray, wedge_angle: FloatArray, roll_angle: FloatArray) -> Gap:
    return gap_kernel(*broadcast(*semi_axes), normal=platen_normal_kernel(wedge_angle, roll_angle))


def _possible(poisson_ratio: FloatArray) -> FloatArray:
    """Return ν, at most 0.5; the derivative at 0.5 is that from below."""
    nu = as_float_array(poisson_ratio)
    return np.where(nu.real > 0.5, 0.5, nu)
