"""R_g on one layer of tissue: known values, limits, the solver, and the fit of the thickness."""

import numpy as np
import pytest
from benchmarks.claims.tissue_thickness import READINGS
from numpy.testing import assert_allclose
from scipy.interpolate import CubicSpline

from fingerpad.contact import Tissue, fast_contact
from fingerpad.exceptions import FitError, GeometryError
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.published import dzidek2017, fit_tissue_thickness, layer_items

ANGLES = np.array([30, 45])
AREAS = np.array([116.3, 69.4])


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
