"""What the areas of a loading curve tell: their slope, their growth with load, and if they suit a sphere."""

import math

import numpy as np

from fingerpad._arrays import ArrayLike, BoolArray, FloatArray, broadcast
from fingerpad.estimate import Estimate
from fingerpad.exceptions import FitError
from fingerpad.loading.averaging import average_models
from fingerpad.loading.curve import LoadingCurve
from fingerpad.loading.cycles import choose_cycle, rows_in_contact
from fingerpad.loading.joint import JointFit
from fingerpad.loading.least_squares import fit_least_squares
from fingerpad.loading.rivals import Comparison

# An area that grows by less than this share of itself does not grow.
_FLAT = 1e-9
NO_RADIUS = (
    "no contact area in the curve, so its radius is not known: give a column area_mm2, or loading_radius"
)


def fit_contact_compliance(curve: LoadingCurve, *, cycle: int = 0) -> Estimate:
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
    Estimate
        R_g, mm, with its uncertainty from the residuals.

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
    >>> print(f"{fit_contact_compliance(curve)} mm (truth: 15)")
    15.003 ± 0.020 mm (truth: 15)
    """
    if curve.area is None:
        raise FitError("the loading curve has no contact area; R_g needs a column area_mm2")
    _, press = choose_cycle(curve, cycle)
    rows = rows_in_contact(curve, press)
    if rows.size < 3:
        raise FitError(f"{rows.size} rows in contact while the load grows; at least 3 are needed for a line")
    x, y = np.pi * curve.indentation[rows], curve.area[rows]
    (slope, _), covariance = np.polyfit(x, y, 1, cov=True)
    if not slope * np.ptp(x) > _FLAT * np.abs(y).max():
        raise FitError(
            f"contact area falls as the displacement grows (slope {slope:.3g} mm); is its sign reversed?"
        )
    return Estimate.symmetric(slope, math.sqrt(covariance[0, 0]), rows.size - 2)


@np.errstate(all="ignore")
def sphere_ratio(indentation: ArrayLike, area: ArrayLike, *, loading_radius: ArrayLike) -> FloatArray:
    """Return E* read from the area over E* read from the indentation, both on a sphere of one radius.

    E* = 3 W R/(4 a³) with a = √(A/π), and E* = 3 W/(4 R^½ ξ^{3/2}) (Johnson 1985, Eqs 4.22 and 4.23) have the
    ratio (πRξ/A)^{3/2}, whatever the load and the modulus: one on a sphere of radius R. For an elliptical
    contact of axis ratio k taken for a sphere of radius R_e it is (R_e/R_Aξ)^{3/2} = F2^{3/2}/F1³.

    Parameters
    ----------
    indentation, area : array_like
        ξ (mm) and A (mm²), from first contact on.
    loading_radius : array_like
        R, mm.

    Returns
    -------
    ndarray
        The ratio, NaN before contact.

    Examples
    --------
    Tissue on bone is indented less than a half-space of the same contact area:

    >>> sphere_ratio([0.9, 1.3], [60.0, 90.0], loading_radius=14.5).round(2)
    array([0.56, 0.53])
    """
    xi, A, radius = broadcast(indentation, area, loading_radius)
    touching = (xi > 0) & (A > 0)
    return np.where(touching, radius * np.pi * xi / A, np.nan)[()] ** 1.5


def area_exponent(compared: Comparison) -> Estimate:
    """Return n by the best explanation, with the uncertainty of where the areas begin."""
    best, name = compared.best, "area_offset"
    found = _exponent(best, best.areas(), zeroed=True)
    if not found.known:
        return found
    if name in best.values:
        other, weight = _exponent(best, best.record.area, zeroed=False), 0.5
    elif name in compared.rivals:
        late = compared.rivals[name]
        other, weight = _exponent(late, late.areas(), zeroed=True), compared.weights[name]
    else:
        return found
    if not other.known:
        return found
    return average_models([found, other], [1 - weight, weight], value=found.value)


def _exponent(main: JointFit, areas: FloatArray, *, zeroed: bool) -> Estimate:
    """Fit A = a W^n to what was measured, with the noise of both and the uncertainty of their zeros."""
    record, noise = main.record, main.noise
    load = main.corrected_load(record.clock, record.load)[record.with_area]
    smooth = main.load(record.smooth_displacement)[record.with_area]
    used = smooth > max(
        0.05 * float(smooth.max(initial=0.0)), 5 * math.hypot(noise.force_std, noise.drift_std)
    )
    W, A = load[used], areas[used]
    if W.size < 5:
        return Estimate.unknown(
            NO_RADIUS if not record.area.size else f"{W.size} areas under load; five are needed"
        )
    spread = np.hypot(noise.area_std, 0.5 * A * math.hypot(noise.force_std, noise.drift_std) / smooth[used])

    def residuals(p: FloatArray) -> FloatArray:
        grown = np.maximum(W / W.max(), 1e-9) ** float(np.clip(p[1], 0.02, 5.0))
        return np.asarray((A - p[0] * grown) / spread)

    try:
        fit = fit_least_squares(residuals, [A.max(), 0.5], ["area", "area_exponent"])
    except FitError as error:
        return Estimate.unknown(str(error))
    by_area = -np.linalg.pinv(fit.jacobian)[1] / spread
    exponent = fit.value("area_exponent")
    std = _exponent_std(main, used, by_area, -exponent * A / smooth[used] * by_area, zeroed=zeroed)
    return Estimate.symmetric(exponent, std, fit.degrees_of_freedom)


def _exponent_std(
    main: JointFit, used: BoolArray, by_area: FloatArray, by_load: FloatArray, *, zeroed: bool
) -> float:
    """Return the standard uncertainty of a sum over the used areas and loads, with their fitted zeros."""
    record = main.record
    rows = np.flatnonzero(record.with_area)[used]
    force, area = np.zeros((record.load.size, 1)), np.zeros((record.area.size, 1))
    force[rows, 0], area[used, 0] = by_load, by_area
    zeros = {
        "force_zero": by_load.sum(),
        "force_tilt": by_load @ record.clock[rows],
        "area_offset": by_area.sum() if zeroed else 0.0,
    }
    gradient = np.array([zeros.get(name, 0.0) for name in main.fit.names])[:, None]
    of_force, of_area = (answer @ gradient for answer in main.estimator())
    # Noise of the displacement is in the residuals, to which the parameters answer, but not in the data.
    shared = main.noise.of_displacement(of_force, of_area)
    variance = main.noise.covariance_of_sums(force + of_force, area + of_area, shared)
    return math.sqrt(float(variance[0, 0]))
