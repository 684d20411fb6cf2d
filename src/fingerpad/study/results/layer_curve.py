"""A loading curve at its highest load, by Hertz theory and on the finger's layer of tissue."""

import math
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from scipy.optimize import minimize_scalar

from fingerpad._arrays import FloatArray, broadcast
from fingerpad.contact.contact import from_reduced_modulus
from fingerpad.contact.fast_laws import find_modulus, plate_gap, press
from fingerpad.geometry import Ellipsoid, Gap, Placement
from fingerpad.geometry.gap import gap_kernel, paraboloid_gap
from fingerpad.geometry.placement import platen_normal
from fingerpad.image import SEMI_AXES
from fingerpad.loading import LoadingFit, Secant
from fingerpad.study.manifest import Study
from fingerpad.study.measuring.curves import CurveResult
from fingerpad.study.measuring.fingers import FingerResult
from fingerpad.study.results.layer import UNCERTAINTY_OUT_OF_RANGE
from fingerpad.study.results.layer_summary import LayerQuantity, quantity_of
from fingerpad.uncertainty import LAYER_SOURCES, Inputs, propagate

_SOURCES: Final = {
    **{
        name: LAYER_SOURCES[name]
        for name in ("semi-axes", "wedge angle", "roll angle", "Poisson's ratio", "load")
    },
    "place of contact": ("indentation",),
    "thickness": ("thickness", "contact_shift"),
}
_MOST_ROWS: Final = 200
_EARLIEST, _LATEST = 0.3, 0.04  # shifts of the place of contact, of the largest indentation


@dataclass(frozen=True, slots=True, kw_only=True)
class CurveOnLayer:
    """What the highest load of a loading curve and its indentation tell of the pad.

    Attributes
    ----------
    load : float
        Highest load fitted, N.
    indentation, indentation_std : float
        Its indentation from the place of contact that Hertz theory fits, with its uncertainty, mm.
    contact_shift : float
        By how much it is larger from the place of contact that the law of the layer fits, mm.
    flag : str
        What takes it out of the range of the laws; empty where nothing does.
    quantities : dict of str to LayerQuantity
        Young's modulus by Hertz theory and on the layer, and A/(πξ) on the layer; NaN where it is flagged.
    """

    load: float
    indentation: float
    indentation_std: float
    contact_shift: float
    flag: str
    quantities: dict[str, LayerQuantity]


def curve_on_layer(study: Study, finger: FingerResult, curve: CurveResult) -> CurveOnLayer | None:
    """Return what a loading curve tells of a finger on its layer of tissue.

    Parameters
    ----------
    study : Study
        The manifest, which states the common uncertainties.
    finger : FingerResult
        Its finger.
    curve : CurveResult
        What was fitted to the curve.

    Returns
    -------
    CurveOnLayer or None
        None without a thickness, semi-axes, or a fitted place of contact.
    """
    offset = curve.fit.contact_offset if curve.fit else None
    if (
        curve.fit is None
        or offset is None
        or not math.isfinite(offset.std)
        or finger.effective_thickness is None
        or not np.isfinite(finger.semi_axes).all()
    ):
        return None
    load = curve.fit.modulus_load
    inputs = _inputs(study, finger, curve.manifest.wedge_angle_deg, curve.fit, offset.std)
    found = propagate(indentation_model, inputs)
    indentation, shift = inputs.mean[0, inputs.places(["indentation", "contact_shift"])].tolist()
    _, contact = find_modulus(
        _gap(finger, curve.manifest.wedge_angle_deg),
        thickness=finger.effective_thickness,
        poisson_ratio=study.poisson_ratio,
        load=load,
        indentation=indentation + shift,
    )
    known = bool(np.isfinite(found.std).all())
    return CurveOnLayer(
        load=load,
        indentation=indentation,
        indentation_std=offset.std,
        contact_shift=shift,
        flag=str(contact.flags) or ("" if known else UNCERTAINTY_OUT_OF_RANGE),
        quantities={name: quantity_of(found, name) for name in found.names},
    )


def _inputs(
    study: Study, finger: FingerResult, wedge_angle_deg: float, fit: LoadingFit, offset_std: float
) -> Inputs:
    """Return the inputs of `indentation_model` at the highest load, as one contact."""
    given, secant, load = study.uncertainty, fit.secant, fit.modulus_load
    thickness, thickness_std = finger.effective_thickness or math.nan, finger.effective_thickness_std or 0.0
    gap = _gap(finger, wedge_angle_deg)
    shift, *ends = (
        _contact_shift(gap, secant, at, study.poisson_ratio)
        for at in (thickness, thickness - thickness_std, thickness + thickness_std)
    )
    # Signed: it goes with the thickness. Where a shift is unknown, the highest load is out of range.
    shift_std = (ends[1] - ends[0]) / 2 if np.isfinite(ends).all() else 0.0
    one: dict[str, Any] = dict(zip(SEMI_AXES, finger.semi_axes.tolist(), strict=True))
    inputs = Inputs.of(
        **one,
        wedge_angle=([math.radians(wedge_angle_deg)], math.radians(given.wedge_angle_deg_std)),
        roll_angle=(0.0, math.radians(given.roll_angle_deg_std)),
        poisson_ratio=(study.poisson_ratio, given.poisson_ratio_std),
        load=(load, given.load_relative_std * load),
        indentation=(float(secant.indentation.max()), offset_std),
        contact_shift=(shift if math.isfinite(shift) else 0.0, 0.0),
        thickness=(thickness, 0.0),
    )
    inputs = inputs.with_covariance(SEMI_AXES, finger.covariance)
    both = np.outer(*2 * ([thickness_std, shift_std],))
    return replace(inputs.with_covariance(("thickness", "contact_shift"), both), groups=_SOURCES)


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
    palmar, distal, radial_ulnar, wedge_angle, roll_angle, poisson_ratio
        As for `pad_model`; on the layer a Poisson's ratio above 0.5, which a draw can have, is taken as 0.5.
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
    """
    axes = broadcast(palmar, distal, radial_ulnar)
    gap = gap_kernel(*axes, normal=platen_normal(wedge_angle, roll_angle))
    hertz, _ = find_modulus(
        paraboloid_gap(gap.first_radius, gap.second_radius), load=load, indentation=indentation
    )
    nu = np.where(np.real(poisson_ratio) > 0.5, 0.5, poisson_ratio)
    layered, contact = find_modulus(
        gap, load=load, indentation=indentation + contact_shift, thickness=thickness, poisson_ratio=nu
    )
    return {
        "youngs_modulus_from_indentation": from_reduced_modulus(hertz, poisson_ratio),
        "youngs_modulus_from_indentation_on_layer": from_reduced_modulus(layered, nu),
        "loading_radius_on_layer": contact.area_over_pi_indentation,
    }


def _gap(finger: FingerResult, wedge_angle_deg: float) -> Gap:
    return plate_gap(Placement(Ellipsoid(*finger.semi_axes), wedge_angle=math.radians(wedge_angle_deg)))


def _contact_shift(gap: Gap, secant: Secant, thickness: float, poisson_ratio: float) -> float:
    """Return by how much the law of the layer puts the place of contact earlier than Hertz theory does."""
    places = np.linspace(0, secant.load.size - 1, min(secant.load.size, _MOST_ROWS)).round().astype(int)
    load, indentation = secant.load[places], secant.indentation[places]

    def misfit(shift: float) -> float:
        law: FloatArray = press(
            gap,
            indentation=indentation + shift,
            reduced_modulus=1.0,
            thickness=thickness,
            poisson_ratio=poisson_ratio,
        ).load
        return float(np.sum((load - law * (load @ law) / (law @ law)) ** 2))

    largest = float(indentation.max())
    if not math.isfinite(misfit(0.0)):
        return math.nan
    return float(
        minimize_scalar(misfit, bounds=(-_LATEST * largest, _EARLIEST * largest), method="bounded").x
    )
