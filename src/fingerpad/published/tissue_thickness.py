"""The effective thickness of tissue that explains R_g of Dzidek et al. (2017).

R_g is read from contact area and indentation. Bone raises it: tissue of finite thickness is indented less
for the same contact area. One number is fitted here, the thickness, to two measured ones.
"""

from collections.abc import Callable, Iterator
from dataclasses import astuple, dataclass
from typing import Final, Self

import numpy as np
from scipy.interpolate import CubicSpline

from fingerpad._arrays import ArrayLike, FloatArray, as_float_array, check_all
from fingerpad._display import Displayed
from fingerpad.exceptions import FitError, UncertaintyError
from fingerpad.geometry import Ellipsoid
from fingerpad.published.audit import AuditItem, Verdict
from fingerpad.published.dzidek2017 import METHODS, WEDGE_ANGLES_DEG, PublishedWedge, dzidek2017
from fingerpad.published.layer_loading import READINGS, check_choice, expected_loading
from fingerpad.units import KPA_PER_MPA

_THINNEST: Final = 3.0  # contact radius over thickness, to which the laws hold
_CHI_SQUARE_95: Final = 3.841
_KNOTS: Final = 241
_STEPS: Final = 100_001
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

    Examples
    --------
    >>> fit = fit_tissue_thickness()
    >>> {source: round(std, 1) for source, std in fit.contribution_mm.items()}
    {'loading radii': 0.9, 'semi-axes': 0.5, 'wedge angles': 0.4, 'contact areas': 0.1}
    """

    thickness_mm: float
    std_mm: float
    interval_mm: tuple[float, float]
    chi_square: float
    thickness_by_angle_mm: FloatArray
    loading_radius_mm: FloatArray
    contribution_mm: dict[str, float]


def fit_tissue_thickness(
    *,
    method: str = "ellipse",
    reading: str = "ratio",
    poisson_ratio: float = 0.5,
    min_load_N: float = 0.0,
    loading_radius_std_mm: tuple[float, float] | None = None,
    semi_axes_std_mm: tuple[float, float, float] | None = None,
    wedge_angle_std_deg: float = 1.0,
    area_relative_std: float = 0.05,
) -> TissueThickness:
    """Fit one thickness of tissue to the two R_g that Dzidek et al. (2017) print.

    Generalised least squares: the semi-axes are shared by both angles, so their errors are correlated.
    Nothing else is fitted. Dzidek et al. print no uncertainty of R_g itself, of the angles or of the areas.

    Parameters
    ----------
    method : str
        Semi-axes of Table 1: "ellipse" or "direct".
    reading : str
        How R_g is read: "ratio", "slope" or "slope_through_origin", see `ExpectedLoading`.
    poisson_ratio : float
        ν of the tissue, 0.3 to 0.5.
    min_load_N : float
        Lowest load of the fitted lines; the highest is 2 N.
    loading_radius_std_mm : tuple of float, optional
        Of R_g at 30° and 45°. By default those printed for R_g^corr, 1.5 and 0.6 mm.
    semi_axes_std_mm : tuple of float, optional
        Of the palmar, distal and radial–ulnar semi-axis. By default the standard deviation of the two
        methods of Table 1, together with rounding.
    wedge_angle_std_deg, area_relative_std : float
        Of each wedge angle and each contact area; the defaults are assumptions.

    Returns
    -------
    TissueThickness
        The thickness, its uncertainty, and how well both angles agree.

    Raises
    ------
    GeometryError
        If method or reading is unknown, or the loads are impossible.
    UncertaintyError
        If a standard uncertainty is negative or not finite, or that of an R_g is zero.
    FitError
        If ν is outside the range of the laws.

    Examples
    --------
    >>> fit = fit_tissue_thickness()
    >>> print(f"{fit.thickness_mm:.1f} mm, 95 %: {fit.interval_mm[0]:.1f} to {fit.interval_mm[1]:.1f} mm")
    7.9 mm, 95 %: 6.1 to 10.6 mm
    >>> fit.thickness_by_angle_mm.round(1), fit.loading_radius_mm.round(1)
    (array([7.9, 7.9]), array([20.5, 14.5]))
    """
    check_choice("method", method, METHODS)
    check_choice("reading", reading, READINGS)
    data = _Data.printed(method)
    radius_std = data.radius_std if loading_radius_std_mm is None else loading_radius_std_mm
    radius_std = _checked_std("loading_radius_std_mm", radius_std, 2)
    if not radius_std.all():
        raise UncertaintyError("loading_radius_std_mm must be positive, found 0")
    axes_std = _semi_axes_std() if semi_axes_std_mm is None else semi_axes_std_mm
    input_std = np.concatenate(
        [
            _checked_std("semi_axes_std_mm", axes_std, 3),
            np.radians(_checked_std("wedge_angle_std_deg", [wedge_angle_std_deg] * 2, 2)),
            data.areas * _checked_std("area_relative_std", [area_relative_std] * 2, 2),
        ]
    )

    def model(inputs: FloatArray, inverse: FloatArray) -> FloatArray:
        with np.errstate(divide="ignore"):
            thickness = 1 / inverse
        return expected_loading(
            Ellipsoid(*np.moveaxis(inputs[..., None, :3], -1, 0)),
            wedge_angle=inputs[..., 3:5],
            area=inputs[..., 5:7],
            thickness=thickness,
            poisson_ratio=poisson_ratio,
            load=data.load,
            min_load=min_load_N,
        ).loading_radius(reading)

    knots = np.linspace(0, _THINNEST / np.sqrt(data.areas.max() / np.pi), _KNOTS)
    radii = model(data.inputs, knots[:, None])
    if not np.isfinite(radii).all():
        raise FitError(f"the laws do not hold for ν = {poisson_ratio:g}; they do from 0.3 to 0.5")
    return _fit(model, CubicSpline(knots, radii), data, radius_std, input_std)


def layer_items() -> list[AuditItem]:
    """Return what one layer of tissue over bone gives, its thickness fitted to the two printed R_g.

    This goes beyond the equations of Dzidek et al. (2017), see `fit_tissue_thickness`. E* gives the printed
    contact area. Nothing is fitted to the contact's axes.

    Returns
    -------
    list of AuditItem
        The thickness with its 95 % interval; R_g, E* and the ratio of the contact's axes at either angle.

    Examples
    --------
    >>> for item in layer_items()[:3]:
    ...     print(item.item, item.printed, round(item.computed, 1))
    One layer, effective thickness t None 7.9
    One layer, θ = 30°, R_g 20.5 20.5
    One layer, θ = 30°, E* None 65.7
    """
    fit = fit_tissue_thickness()
    thickness = AuditItem(
        item="One layer, effective thickness t",
        printed=None,
        computed=fit.thickness_mm,
        low=fit.interval_mm[0],
        high=fit.interval_mm[1],
        unit="mm",
        verdict=Verdict.FITTED,
        formula=_LAYER,
        remark="fitted to R_g = A/(πξ) at 2 N of both angles, ellipse semi-axes; 95 % interval",
    )
    wedges = sorted(dzidek2017().wedges.values(), key=lambda wedge: wedge.wedge_angle_deg)
    return [thickness, *(item for wedge in wedges for item in _on_layer(wedge, fit.thickness_mm))]


def _on_layer(wedge: PublishedWedge, thickness: float) -> Iterator[AuditItem]:
    loading = expected_loading(
        dzidek2017().semi_axes["ellipse"].ellipsoid,
        wedge_angle=np.radians(wedge.wedge_angle_deg),
        area=wedge.area_mm2.value,
        thickness=thickness,
        load=wedge.load_N,
    )
    name = f"One layer, θ = {wedge.wedge_angle_deg}°"
    axis_ratio = wedge.semi_major_mm.value / wedge.semi_minor_mm.value
    modulus = KPA_PER_MPA * loading.reduced_modulus
    for item, printed, computed, unit, verdict, remark in (
        ("R_g", wedge.measured_radius_mm.value, loading.ratio, "mm", Verdict.FITTED, ""),
        ("E*", None, modulus, "kPa", Verdict.FITTED, "gives the printed contact area at 2 N"),
        (
            "contact axis along the finger over across",
            axis_ratio,
            loading.along_over_across,
            "1",
            Verdict.NOT_REPRODUCIBLE,
            "printed is ℓd/ℓe, taken as along the finger; no direction is printed",
        ),
    ):
        yield AuditItem(
            item=f"{name}, {item}",
            printed=printed,
            computed=float(computed),
            unit=unit,
            verdict=verdict,
            formula=_LAYER,
            remark=remark,
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Data:
    """Printed numbers of both angles, 30° first."""

    radii: FloatArray
    radius_std: FloatArray
    areas: FloatArray
    inputs: FloatArray
    load: float

    @classmethod
    def printed(cls, method: str) -> Self:
        article = dzidek2017()
        wedges = [article.wedges[angle] for angle in WEDGE_ANGLES_DEG]
        areas = np.array([wedge.area_mm2.value for wedge in wedges])
        return cls(
            radii=np.array([wedge.measured_radius_mm.value for wedge in wedges]),
            radius_std=np.array([wedge.pooled_uncertainty_mm.value for wedge in wedges]),
            areas=areas,
            inputs=np.concatenate(
                [article.semi_axes[method].ellipsoid.semi_axes, np.radians(WEDGE_ANGLES_DEG), areas]
            ),
            load=wedges[0].load_N,
        )


def _semi_axes_std() -> FloatArray:
    """Return the standard deviation of the two methods of Table 1, and of rounding, in one."""
    (direct, rounding), (ellipse, _) = (
        np.transpose(astuple(dzidek2017().semi_axes[name])) for name in METHODS
    )
    return as_float_array(np.hypot((direct - ellipse) / np.sqrt(2), rounding / np.sqrt(3)))


def _fit(
    model: Callable[[FloatArray, FloatArray], FloatArray],
    curve: CubicSpline,
    data: _Data,
    radius_std: FloatArray,
    input_std: FloatArray,
) -> TissueThickness:
    """Minimise χ² over 1/t, which is zero for a half-space; `curve` is R_g of both angles against it."""
    inverse = np.linspace(curve.x[0], curve.x[-1], _STEPS)
    misfit = data.radii - curve(inverse)
    covariance = np.diag(radius_std**2)
    step = _DIFFERENCE * data.inputs
    shifts = np.diag(step)
    for _ in range(3):  # the covariance depends on the thickness, but little
        precision = np.linalg.inv(covariance)
        chi_square = np.einsum("ni,ij,nj->n", misfit, precision, misfit)
        best = int(chi_square.argmin())
        at = inverse[best]
        change = model(data.inputs + shifts, np.array([[at]])) - model(data.inputs - shifts, np.array([[at]]))
        sensitivity = change.T / (2 * step)
        errors = np.hstack([np.diag(radius_std), sensitivity * input_std])  # of R_g, one column per input
        covariance = errors @ errors.T
    inside = inverse[chi_square <= chi_square[best] + _CHI_SQUARE_95]
    slope = curve(at, 1)
    weights = precision @ slope / (slope @ precision @ slope)
    with np.errstate(divide="ignore", invalid="ignore"):
        stds = np.abs(weights @ errors) / at**2
        thickness, low, high = 1 / np.array([at, inside[-1], inside[0]])
        radii = curve(inverse)
        alone = [
            1 / np.interp(radius, of_angle, inverse)
            for radius, of_angle in zip(data.radii, radii.T, strict=True)
        ]
    parts = np.split(stds, np.cumsum([2, 3, 2]))
    names = "loading radii", "semi-axes", "wedge angles", "contact areas"
    return TissueThickness(
        thickness_mm=float(thickness),
        std_mm=float(np.linalg.norm(stds)),
        interval_mm=(float(low), float(high)),
        chi_square=float(chi_square[best]),
        thickness_by_angle_mm=np.array(alone),
        loading_radius_mm=curve(at),
        contribution_mm={name: float(np.linalg.norm(part)) for name, part in zip(names, parts, strict=True)},
    )


def _checked_std(name: str, value: ArrayLike, count: int) -> FloatArray:
    """Return standard uncertainties, or say which one is none."""
    std = as_float_array(value)
    if std.shape != (count,):
        raise UncertaintyError(f"{name} must be {count} numbers, found {std.size}")
    check_all((std >= 0) & (std < np.inf), name, std, "finite and not negative", UncertaintyError)
    return std
