"""Radius of curvature from loading data."""

from dataclasses import dataclass

import numpy as np

from fingerpad._display import Displayed
from fingerpad.exceptions import FitError
from fingerpad.loading.curve import LoadingCurve
from fingerpad.loading.segments import choose_cycle, rows_in_contact

# An area that grows by less than this share of itself does not grow.
_FLAT = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class ContactCompliance(Displayed):
    """The line A = R_g π ξ + A₀ through a loading curve.

    Attributes
    ----------
    loading_radius, loading_radius_std : float
        Slope R_g and its standard uncertainty from the residuals, mm.
    area_at_zero : float
        Intercept A₀, mm²: the area at the instrument's zero of displacement.
    residual_std : float
        Standard deviation of the area about the line, mm².
    count : int
        Number of points fitted.

    Examples
    --------
    >>> travel = np.linspace(0, 2, 41)
    >>> depth = np.maximum(travel - 0.5, 0)
    >>> curve = LoadingCurve(load=depth**1.5, indentation=travel, area=np.pi * 14.5 * depth)
    >>> line = fit_contact_compliance(curve)
    >>> print(f"R_g = {line.loading_radius:.1f} mm, A₀ = {line.area_at_zero:.2f} mm²")
    R_g = 14.5 mm, A₀ = -22.78 mm²
    """

    loading_radius: float
    loading_radius_std: float
    area_at_zero: float
    residual_std: float
    count: int


def fit_contact_compliance(curve: LoadingCurve, *, cycle: int = 0) -> ContactCompliance:
    """Fit R_g, the slope of contact area against πξ ("contact compliance"), by least squares.

    The rows are those of one loading, from where the area is well above zero. A smooth sphere or ellipse
    gives R = A/(πξ) at every load, whatever its modulus and however it varies with load. The zero of
    displacement is free.

    Parameters
    ----------
    curve : LoadingCurve
        With an area.
    cycle : int
        Which press of the record to fit.

    Returns
    -------
    ContactCompliance
        Slope, intercept and residuals.

    Raises
    ------
    LoadingError
        If there is no such press in the record (`find_cycles`).
    FitError
        If the curve has no area or fewer than three rows in contact, or if area does not grow with
        indentation.

    Examples
    --------
    >>> from fingerpad.simulate import simulate_loading_curve
    >>> curve = simulate_loading_curve(points=200, force_std=0.005, area_std=0.5, seed=1)
    >>> line = fit_contact_compliance(curve)
    >>> print(f"{line.loading_radius:.2f} ± {line.loading_radius_std:.2f} mm (truth: 15)")
    15.00 ± 0.02 mm (truth: 15)
    """
    if curve.area is None:
        raise FitError("the loading curve has no contact area; R_g needs a column area_mm2")
    _, press = choose_cycle(curve, cycle)
    rows = rows_in_contact(curve, press)
    count = rows.size
    if count < 3:
        raise FitError(f"{count} rows in contact while the load grows; at least 3 are needed for a line")
    x, y = np.pi * curve.indentation[rows], curve.area[rows]
    (slope, intercept), covariance = np.polyfit(x, y, 1, cov=True)
    if not slope * np.ptp(x) > _FLAT * np.abs(y).max():
        raise FitError(
            f"contact area falls as the displacement grows (slope {slope:.3g} mm); is its sign reversed?"
        )
    residual = y - intercept - slope * x
    return ContactCompliance(
        loading_radius=float(slope),
        loading_radius_std=float(np.sqrt(covariance[0, 0])),
        area_at_zero=float(intercept),
        residual_std=float(np.sqrt(np.sum(residual**2) / (count - 2))),
        count=count,
    )
