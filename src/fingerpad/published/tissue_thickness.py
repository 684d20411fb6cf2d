"""The effective thickness of tissue that explains R_g of Dzidek et al. (2017).

R_g is read from contact area and indentation. Bone raises it: tissue of finite thickness is indented less
for the same contact area. One number is fitted here, the thickness, to two measured ones.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Final

import numpy as np
from scipy.interpolate import CubicSpline

from fingerpad._arrays import FloatArray
from fingerpad._display import Displayed
from fingerpad.contact import Tissue, fast_contact
from fingerpad.exceptions import FitError, GeometryError
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.published.audit import AuditItem, Verdict
from fingerpad.published.dzidek2017 import dzidek2017
from fingerpad.units import KPA_PER_MPA

_ANGLE_STD, _AREA_RELATIVE_STD = np.radians(1.0), 0.05  # assumed: Dzidek et al. print none
_THINNEST: Final = 3.0  # contact radius over thickness, to which the laws hold
_CHI_SQUARE_95: Final = 3.841
_KNOTS, _STEPS = 241, 100_001  # of 1/t: where R_g is computed, and where it is interpolated
_DIFFERENCE: Final = 1e-3
_LAYER: Final = "whole ellipsoid on a layer of thickness t bonded to bone, ν = 0.5, frictionless plate"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class TissueThickness(Displayed):
    """The effective thickness of the tissue of Dzidek et al. (2017), fitted to R_g at 30° and 45°.

    Attributes
    ----------
    thickness_mm : float
        Of one layer for both angles.
    std_mm : float
        Standard uncertainty by linear propagation.
    interval_mm : tuple of float
        95 % interval, where χ² is at most 3.84 above its minimum; its upper end may be infinite.
    chi_square : float
        Of the two R_g about the fit: one degree of freedom, so 3.84 is exceeded by chance in 5 %.
    thickness_by_angle_mm : ndarray
        From 30° and from 45° alone.
    loading_radius_mm : ndarray
        R_g at 30° and 45° with the fitted thickness.
    contribution_mm : dict
        Standard uncertainty of the thickness from each group of inputs.
    """

    thickness_mm: float
    std_mm: float
    interval_mm: tuple[float, float]
    chi_square: float
    thickness_by_angle_mm: FloatArray
    loading_radius_mm: FloatArray
    contribution_mm: dict[str, float]


def _ratio(placement: Placement, tissue: Tissue, area: FloatArray) -> FloatArray:
    return fast_contact(placement, tissue, area=area).area_over_pi_indentation


def fit_tissue_thickness(
    *,
    method: str = "ellipse",
    poisson_ratio: float = 0.5,
    reading: Callable[[Placement, Tissue, FloatArray], FloatArray] = _ratio,
) -> TissueThickness:
    """Fit one thickness of tissue to the two R_g that Dzidek et al. (2017) print.

    Generalised least squares over 1/t, which is zero for a half-space: the semi-axes are shared by both
    angles, so their errors are correlated. R_g is as uncertain as R_g^corr is printed, the semi-axes as the
    two methods of Table 1 differ, the angles by 1° and the areas by 5 %.

    Parameters
    ----------
    method : str
        Semi-axes of Table 1: "ellipse" or "direct".
    poisson_ratio : float
        ν of the tissue, 0.3 to 0.5.
    reading : callable
        How R_g is read: takes `Placement`, `Tissue` and contact areas at 2 N, and returns radii. By default
        A/(πξ).

    Returns
    -------
    TissueThickness
        The thickness, its uncertainty, and how well both angles agree.

    Raises
    ------
    GeometryError
        If there is no such method.
    FitError
        If ν is outside the range of the laws.

    Examples
    --------
    >>> fit = fit_tissue_thickness()
    >>> print(f"{fit.thickness_mm:.1f} mm, 95 %: {fit.interval_mm[0]:.1f} to {fit.interval_mm[1]:.1f} mm")
    7.9 mm, 95 %: 6.1 to 10.6 mm
    >>> fit.thickness_by_angle_mm.round(1), fit.loading_radius_mm.round(1)
    (array([7.9, 7.9]), array([20.5, 14.5]))
    >>> {source: round(std, 1) for source, std in fit.contribution_mm.items()}
    {'loading radii': 0.9, 'semi-axes': 0.5, 'wedge angles': 0.4, 'contact areas': 0.1}
    """
    article = dzidek2017()
    if method not in article.semi_axes:
        raise GeometryError(f"method must be one of {', '.join(article.semi_axes)}, found {method!r}")
    angles = np.radians(list(article.wedges))
    areas, measured, radius_std = (
        np.array([getattr(wedge, name).value for wedge in article.wedges.values()])
        for name in ("area_mm2", "measured_radius_mm", "pooled_uncertainty_mm")
    )
    axes, rounding = np.transpose(list(article.semi_axes.values()))
    axes_std = np.hypot(np.std(axes, axis=1, ddof=1), rounding[:, 0] / np.sqrt(3))
    inputs = np.concatenate([article.semi_axes[method].ellipsoid.semi_axes, angles, areas])
    input_std = np.concatenate([axes_std, 2 * [_ANGLE_STD], _AREA_RELATIVE_STD * areas])

    def model(inputs: FloatArray, inverse: FloatArray) -> FloatArray:
        pad = Ellipsoid(*np.moveaxis(inputs[..., None, :3], -1, 0))
        with np.errstate(divide="ignore"):
            tissue = Tissue(1.0, poisson_ratio, 1 / inverse)
        return reading(Placement(pad, wedge_angle=inputs[..., 3:5]), tissue, inputs[..., 5:7])

    knots = np.linspace(0, _THINNEST / np.sqrt(areas.max() / np.pi), _KNOTS)
    radii = model(inputs, knots[:, None])
    if not np.isfinite(radii).all():
        raise FitError(f"the laws do not hold for ν = {poisson_ratio:g}; they do from 0.3 to 0.5")
    curve = CubicSpline(knots, radii)
    inverse = np.linspace(0, knots[-1], _STEPS)
    misfit = measured - curve(inverse)
    covariance = np.diag(radius_std**2)
    step = _DIFFERENCE * inputs
    for _ in range(3):  # the covariance depends on the thickness, but little
        precision = np.linalg.inv(covariance)
        chi_square = np.einsum("ni,ij,nj->n", misfit, precision, misfit)
        best = int(chi_square.argmin())
        at = inverse[best]
        higher, lower = (model(inputs + shift, np.array([[at]])) for shift in (np.diag(step), -np.diag(step)))
        sensitivity = (higher - lower).T / (2 * step)
        errors = np.hstack([np.diag(radius_std), sensitivity * input_std])  # of R_g, one column per input
        covariance = errors @ errors.T
    inside = inverse[chi_square <= chi_square[best] + _CHI_SQUARE_95]
    slope = curve(at, 1)
    weights = precision @ slope / (slope @ precision @ slope)
    stds = np.abs(weights @ errors) / at**2
    alone = [np.interp(r, of_angle, inverse) for r, of_angle in zip(measured, curve(inverse).T, strict=True)]
    with np.errstate(divide="ignore"):
        thickness, low, high = 1 / np.array([at, inside[-1], inside[0]])
    parts = np.split(stds, np.cumsum([2, 3, 2]))
    names = "loading radii", "semi-axes", "wedge angles", "contact areas"
    return TissueThickness(
        thickness_mm=float(thickness),
        std_mm=float(np.linalg.norm(stds)),
        interval_mm=(float(low), float(high)),
        chi_square=float(chi_square[best]),
        thickness_by_angle_mm=1 / np.array(alone),
        loading_radius_mm=curve(at),
        contribution_mm={name: float(np.linalg.norm(part)) for name, part in zip(names, parts, strict=True)},
    )


def layer_items() -> list[AuditItem]:
    """Return what one layer of tissue over bone gives, its thickness fitted to the two printed R_g.

    This goes beyond the equations of Dzidek et al. (2017), see `fit_tissue_thickness`. E* gives the printed
    contact area. Nothing is fitted to the contact's axes.
    """
    fit, article = fit_tissue_thickness(), dzidek2017()
    fitted = partial(AuditItem, verdict=Verdict.FITTED, formula=_LAYER)
    remark = "fitted to R_g = A/(πξ) at 2 N of both angles, ellipse semi-axes; 95 % interval"
    low, high = fit.interval_mm
    name = "One layer, effective thickness t"
    items = [fitted(item=name, printed=None, computed=fit.thickness_mm, low=low, high=high, remark=remark)]
    tissue = Tissue.of_reduced_modulus(1.0, thickness=fit.thickness_mm)
    for angle, wedge in article.wedges.items():
        placement = Placement(article.semi_axes["ellipse"].ellipsoid, wedge_angle=np.radians(angle))
        unit = fast_contact(placement, tissue, area=wedge.area_mm2.value)
        radius, modulus = unit.area_over_pi_indentation, KPA_PER_MPA * wedge.load_N / unit.load
        ratio = unit.aspect_ratio if unit.along else 1 / unit.aspect_ratio
        name, remark = f"One layer, θ = {angle}°", "gives the printed contact area at 2 N"
        items += [
            fitted(item=f"{name}, R_g", printed=wedge.measured_radius_mm.value, computed=float(radius)),
            fitted(item=f"{name}, E*", printed=None, unit="kPa", computed=float(modulus), remark=remark),
            fitted(
                item=f"{name}, contact axis along the finger over across",
                printed=wedge.semi_major_mm.value / wedge.semi_minor_mm.value,
                unit="1",
                verdict=Verdict.NOT_REPRODUCIBLE,
                computed=float(ratio),
                remark="printed is ℓd/ℓe, taken as along the finger; no direction is printed",
            ),
        ]
    return items
