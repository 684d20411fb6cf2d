"""R_g on one layer of tissue: known values, limits, the solver, and the fit of the thickness."""

import numpy as np
import pytest
from benchmarks.claims.tissue_thickness import READINGS, line, loading_of, placed
from numpy.testing import assert_allclose
from scipy.interpolate import CubicSpline

from fingerpad.contact import Tissue, fast_contact, solve_contact
from fingerpad.exceptions import FitError, GeometryError
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.published import dzidek2017, fit_tissue_thickness, layer_items

ANGLES = np.array([30, 45])
AREAS = np.array([116.3, 69.4])
THICKNESSES = np.array([np.inf, 12, 10, 8, 7, 6])
# Ratio at 2 N, slope, and slope through the origin, by thickness; E* in kPa. From a solver on 128² cells.
RADII = {
    30: [
        (12.45, 18.1, 19.1, 20.5, 21.4, 22.5),
        (12.3, 18.6, 19.8, 21.4, 22.5, 23.7),
        (12.7, 17.7, 18.7, 20.0, 20.9, 22.0),
    ],
    45: [
        (9.60, 12.9, 13.6, 14.5, 15.2, 16.0),
        (9.5, 13.2, 14.0, 15.1, 15.9, 16.7),
        (9.7, 12.7, 13.3, 14.1, 14.7, 15.4),
    ],
}
MODULI = {30: [81, 75, 72, 66, 62, 57], 45: [138, 132, 128, 122, 116, 110]}


@pytest.mark.parametrize(("angle", "area"), [(30, 116.3), (45, 69.4)])
def test_independent_solver(angle, area) -> None:
    place = placed("ellipse", dzidek2017().wedges[angle])
    tissue = Tissue.of_reduced_modulus(1.0, thickness=THICKNESSES)
    found = [read(place, tissue, np.array(area)) for read in READINGS.values()]
    assert_allclose(found, RADII[angle], rtol=0.01)
    modulus = 2 / fast_contact(place, tissue, area=area).load
    assert_allclose(1e3 * modulus, MODULI[angle], rtol=0.018)  # printed to two digits


@pytest.mark.parametrize("method", ["ellipse", "direct"])
@pytest.mark.parametrize(("angle", "area"), [(30, 116.3), (45, 69.4)])
def test_solver(method, angle, area) -> None:
    place = placed(method, dzidek2017().wedges[angle])
    unit = fast_contact(place, Tissue.of_reduced_modulus(1.0, thickness=8.0), area=area)
    solved = solve_contact(
        place, Tissue.of_reduced_modulus(2 / unit.load, thickness=8.0), load=2.0, points=128
    )
    assert_allclose(unit.area_over_pi_indentation, solved.area_over_pi_indentation, rtol=5e-3)
    assert_allclose(solved.area, area, rtol=5e-3)
    assert solved.along == unit.along
    assert_allclose(unit.aspect_ratio, solved.aspect_ratio, rtol=0.01)


def test_small_contacts_on_deep_tissue_follow_hertz() -> None:
    loading = loading_of(placed("ellipse", dzidek2017().wedges[30]), Tissue(1.0), np.array(1e-4))
    assert_allclose(loading.slope, loading.slope_through_origin, rtol=1e-4)
    assert_allclose(loading.area_exponent, 2 / 3, rtol=1e-4)
    assert_allclose(loading.load_exponent, 3 / 2, rtol=1e-4)
    assert_allclose(loading.contact_shift, 0, atol=1e-6)


def test_one_thickness_for_both_angles() -> None:
    fit = fit_tissue_thickness()
    assert_allclose(fit.thickness_by_angle_mm, [7.92, 7.94], atol=0.02)
    assert fit.thickness_by_angle_mm.min() < fit.thickness_mm < fit.thickness_by_angle_mm.max()
    assert_allclose(fit.loading_radius_mm, [20.5, 14.5], rtol=5e-3)
    assert fit.interval_mm[0] < 7.9 < fit.interval_mm[1]
    assert fit.chi_square < 0.01
    assert_allclose(np.linalg.norm(list(fit.contribution_mm.values())), fit.std_mm)


def test_direct_axes_want_two_thicknesses() -> None:
    fit = fit_tissue_thickness(method="direct")
    assert_allclose(fit.thickness_by_angle_mm, [7.81, 6.52], atol=0.02)
    assert fit.chi_square > 50 * fit_tissue_thickness().chi_square


@pytest.mark.parametrize("reading", READINGS)
def test_fitted_thickness_gives_back_its_radii(reading) -> None:
    read = READINGS[reading]
    fit = fit_tissue_thickness(reading=read, poisson_ratio=0.48)
    thickness = np.array([fit.thickness_mm, *fit.thickness_by_angle_mm])[:, None]
    pad = dzidek2017().semi_axes["ellipse"].ellipsoid
    again = read(Placement(pad, wedge_angle=np.radians(ANGLES)), Tissue(1.0, 0.48, thickness), AREAS)
    assert_allclose(again[0], fit.loading_radius_mm, rtol=1e-4)
    assert_allclose([again[1, 0], again[2, 1]], [20.5, 14.5], rtol=1e-4)


def test_the_load_range_moves_the_slope() -> None:
    whole, upper = (fit_tissue_thickness(reading=line("slope", lowest)) for lowest in (0.0, 0.5))
    assert (round(whole.thickness_mm, 1), round(upper.thickness_mm, 1)) == (9.0, 10.0)


AXES_STD = (0.2843, 0.6371, 0.0289)  # of two methods, 0.4/√2 and 0.9/√2 mm, and of rounding, 0.05/√3 mm


def drawn_radii(method: str, draws: int, thicknesses) -> np.ndarray:
    """Return A/(πξ) of pads, angles and areas as uncertain as the fit takes them."""
    random = np.random.default_rng(5)
    axes = dzidek2017().semi_axes[method].ellipsoid.semi_axes + random.normal(size=(draws, 3)) * AXES_STD
    angles = np.radians(ANGLES + random.normal(size=(draws, 2)))
    places = Placement(Ellipsoid(*axes.T[:, :, None]), wedge_angle=angles)
    tissue = Tissue(1.0, thickness=np.asarray(thicknesses)[:, None, None])
    areas = AREAS * (1 + 0.05 * random.normal(size=(draws, 2)))
    return fast_contact(places, tissue, area=areas).area_over_pi_indentation


def test_chi_square_by_monte_carlo() -> None:
    fit = fit_tissue_thickness(method="direct")
    (radii,) = drawn_radii("direct", 3000, [fit.thickness_mm])
    inside = np.isfinite(radii).all(axis=1)  # a draw or two are too skew for the laws
    assert inside.mean() > 0.999
    covariance = np.cov(radii[inside].T) + np.diag(np.square([1.5, 0.6]))
    misfit = [20.5, 14.5] - fit.loading_radius_mm
    assert_allclose(fit.chi_square, misfit @ np.linalg.solve(covariance, misfit), rtol=0.06)


def test_uncertainty_by_monte_carlo() -> None:
    fit = fit_tissue_thickness()
    thicknesses = 1 / np.linspace(1 / 3.5, 1 / 60, 16)
    radii = drawn_radii("ellipse", 1000, thicknesses)
    measured = [20.5, 14.5] + np.random.default_rng(6).normal(size=(1000, 2)) * [1.5, 0.6]
    inverses = np.empty((1000, 2))
    for place in np.ndindex(1000, 2):
        falling = radii[(slice(None), *place)]
        inverses[place] = CubicSpline(falling[::-1], 1 / thicknesses[::-1])(measured[place])
    # Both thicknesses carry the errors of the shared axes: the best mean of the two is the fit's.
    precision = np.linalg.inv(np.cov(inverses.T))
    combined = 1 / (inverses @ precision.sum(axis=0) / precision.sum())
    assert_allclose(combined.std(), fit.std_mm, rtol=0.1)
    assert_allclose(np.quantile(combined, [0.025, 0.975]), fit.interval_mm, rtol=0.03)


@pytest.mark.parametrize("poisson_ratio", [0.2, 0.29])
def test_laws_do_not_hold_for_every_poisson_ratio(poisson_ratio) -> None:
    with pytest.raises(FitError, match=f"ν = {poisson_ratio}"):
        fit_tissue_thickness(poisson_ratio=poisson_ratio)


def test_unknown_method() -> None:
    with pytest.raises(GeometryError, match="method must be one of direct, ellipse, found 'both'"):
        fit_tissue_thickness(method="both")


def test_layer_items() -> None:
    items = {item.item: item for item in layer_items()}
    thickness = items["One layer, effective thickness t"]
    assert (thickness.printed, thickness.low < 7.9 < thickness.high) == (None, True)
    ratios = [
        items[f"One layer, θ = {angle}°, contact axis along the finger over across"] for angle in ANGLES
    ]
    assert_allclose([item.computed for item in ratios], [0.95, 0.79], atol=0.01)
    assert_allclose([item.printed for item in ratios], [1.48, 1.262], atol=1e-3)
    moduli = [items[f"One layer, θ = {angle}°, E*"].computed for angle in ANGLES]
    assert_allclose(moduli, [66, 121], atol=1)
