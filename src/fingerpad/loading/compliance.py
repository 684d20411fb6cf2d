"""Radius of curvature from loading data."""

from dataclasses import dataclass

import numpy as np

from fingerpad._display import Displayed
from fingerpad._loading_curve import LoadingCurve
from fingerpad.exceptions import FitError


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
    >>> depth = np.linspace(0.1, 2, 20)
    >>> area = np.pi * 14.5 * (depth - 0.05)
    >>> line = fit_contact_compliance(LoadingCurve(load=depth**1.5, indentation=depth, area=area))
    >>> print(f"R_g = {line.loading_radius:.1f} mm, A₀ = {line.area_at_zero:.2f} mm²")
    R_g = 14.5 mm, A₀ = -2.28 mm²
    """

    loading_radius: float
    loading_radius_std: float
    area_at_zero: float
    residual_std: float
    count: int


def fit_contact_compliance(curve: LoadingCurve) -> ContactCompliance:
    """Fit R_g, the slope of contact area against πξ ("contact compliance"), by least squares.

    Points without load are left out. A smooth sphere or ellipse gives R = A/(πξ) at every load, whatever its
    modulus and however it varies with load. The zero of displacement is free.

    Parameters
    ----------
    curve : LoadingCurve
        With an area.

    Returns
    -------
    ContactCompliance
        Slope, intercept and residuals.

    Raises
    ------
    FitError
        If the curve has no area, fewer than three points under load, or no spread in displacement; or if
        area does not grow with indentation.

    Examples
    --------
    >>> import numpy as np
    >>> depth = np.linspace(0.1, 2, 20)
    >>> curve = LoadingCurve(load=depth**1.5, indentation=depth, area=np.pi * 20.5 * depth)
    >>> print(f"{fit_contact_compliance(curve).loading_radius:.2f} mm")
    20.50 mm
    """
    if curve.area is None:
        raise FitError("the loading curve has no contact area; R_g needs a column area_mm2")
    loaded = curve.load > 0
    count = int(loaded.sum())
    if count < 3:
        raise FitError(f"{count} points under load in the curve; at least 3 are needed for a line")
    x, y = np.pi * curve.indentation[loaded], curve.area[loaded]
    if not np.ptp(x) > 0:
        raise FitError("the displacement is the same at every point under load; R_g needs a range of it")
    (slope, intercept), covariance = np.polyfit(x, y, 1, cov=True)
    if not slope > 0:
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
