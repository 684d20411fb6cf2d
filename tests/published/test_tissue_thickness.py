"""R_g on one layer of tissue: known values, limits, the solver, and the fit of the thickness."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.interpolate import CubicSpline

from fingerpad.contact import Tissue, fast_contact, solve_contact
from fingerpad.exceptions import FitError, GeometryError, UncertaintyError
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.published import dzidek2017, expected_loading, fit_tissue_thickness, layer_items

ANGLES = np.array([30, 45])
AREAS = np.array([116.3, 69.4])
THICKNESSES = np.array([np.inf, 12, 10, 8, 7, 6])
# By thickness: ratio at 2 N, slope, slope through the origin; E* in kPa. From a solver on 128² cells.
RADII = {
    30: [
        (12.45, 12.3, 12.7),
        (18.1, 18.6, 17.7),
        (19.1, 19.8, 18.7),
        (20.5, 21.4, 20.0),
        (21.4, 22.5, 20.9),
        (22.5, 23.7, 22.0),
    ],
    45: [
        (9.60, 9.5, 9.7),
        (12.9, 13.2, 12.7),
        (13.6, 14.0, 13.3),
        (14.5, 15.1, 14.1),
        (15.2, 15.9, 14.7),
        (16.0, 16.7, 15.4),
    ],
}
MODULI = {30: [81, 75, 72, 66, 62, 57], 45: [138, 132, 128, 122, 116, 110]}


@pytest.fixture
def pad() -> Ellipsoid:
    return dzidek2017().semi_axes["ellipse"].ellipsoid


@pytest.mark.parametrize(("angle", "area"), [(30, 116.3), (45, 69.4)])
def test_independent_solver(pad, angle, area) -> None:
    loading = expected_loading(pad, wedge_angle=np.radians(angle), area=area, thickness=THICKNESSES)
    found = np.transpose([loading.ratio, loading.slope, loading.slope_through_origin])
    assert_allclose(found, RADII[angle], rtol=0.01)
    assert_allclose(1e3 * loading.reduced_modulus, MODULI[angle], rtol=0.018)  # printed to two digits


@pytest.mark.parametrize("method", ["ellipse", "direct"])
@pytest.mark.parametrize(("angle", "area"), [(30, 116.3), (45, 69.4)])
def test_solver(method, angle, area) -> None:
    pad = dzidek2017().semi_axes[method].ellipsoid
    place = {"wedge_angle": np.radians(angle), "thickness": 8.0}
    loading = expected_loading(pad, area=area, **place)
    tissue = Tissue.of_reduced_modulus(loading.reduced_modulus, thickness=8.0)
    solved = solve_contact(Placement(pad, wedge_angle=np.radians(angle)), tissue, load=2.0, points=128)
    assert_allclose(loading.ratio, solved.area_over_pi_indentation, rtol=5e-3)
    assert_allclose(solved.area, area, rtol=5e-3)
    aspect_ratio = solved.aspect_ratio if solved.along else 1 / solved.aspect_ratio
    assert_allclose(loading.along_over_across, aspect_ratio, rtol=0.01)


def test_deep_tissue_is_a_half_space(pad) -> None:
    place = {"wedge_angle": np.radians(ANGLES), "area": AREAS}
    deep = expected_loading(pad, thickness=1e7, **place)
    placement = Placement(pad, wedge_angle=np.radians(ANGLES))
    contact = fast_contact(placement, Tissue.of_reduced_modulus(1.0), area=AREAS)
    assert_allclose(deep.ratio, contact.area_over_pi_indentation, rtol=1e-5)
    assert_allclose(deep.reduced_modulus, 2 / contact.load, rtol=1e-5)
    for name in ("slope", "slope_through_origin", "area_exponent", "load_exponent"):
        half_space = expected_loading(pad, thickness=np.inf, **place)
        assert_allclose(getattr(deep, name), getattr(half_space, name), rtol=1e-5)


def test_small_contacts_on_deep_tissue_follow_hertz(pad) -> None:
    loading = expected_loading(pad, wedge_angle=np.radians(30), area=1e-4, thickness=np.inf)
    curvature = Placement(pad, wedge_angle=np.radians(30)).curvature
    assert_allclose(loading.ratio, curvature.geometric_mean_radius, rtol=2e-3)
    assert_allclose(loading.slope, loading.slope_through_origin, rtol=1e-4)
    assert_allclose(loading.area_exponent, 2 / 3, rtol=1e-4)
    assert_allclose(loading.load_exponent, 3 / 2, rtol=1e-4)
    assert_allclose(loading.contact_shift, 0, atol=1e-6)


def test_broadcasting(pad) -> None:
    loading = expected_loading(
        pad,
        wedge_angle=np.radians(ANGLES),
        area=AREAS,
        thickness=THICKNESSES[:, None, None],
        poisson_ratio=np.array([[0.45], [0.5]]),
    )
    assert loading.slope.shape == (6, 2, 2)
    one = expected_loading(pad, wedge_angle=np.radians(45), area=69.4, thickness=8, poisson_ratio=0.45)
    assert_allclose(loading.slope[3, 0, 1], one.slope)
    assert_allclose(loading.ratio[0, 0], loading.ratio[0, 1])  # ν does not matter to a half-space


def test_load_range_moves_the_slope_only(pad) -> None:
    place = {"wedge_angle": np.radians(30), "area": 116.3, "thickness": 8.0}
    whole, upper = (expected_loading(pad, min_load=low, **place) for low in (0.0, 1.0))
    assert_allclose(upper.ratio, whole.ratio)
    assert upper.slope > whole.slope + 0.3
    other_unit = expected_loading(pad, load=2000.0, min_load=1000.0, **place)
    assert_allclose(other_unit.slope, upper.slope)
    assert_allclose(other_unit.reduced_modulus, 1e3 * upper.reduced_modulus)


@pytest.mark.parametrize("thickness", [0, -8, np.nan, [8, 0]])
def test_impossible_thickness(pad, thickness) -> None:
    with pytest.raises(GeometryError, match="thickness must be positive"):
        expected_loading(pad, wedge_angle=0.5, area=116.3, thickness=thickness)


@pytest.mark.parametrize(("load", "min_load"), [(2, 2), (2, -1), (np.nan, 0), (np.inf, 0), (0, 0)])
def test_impossible_loads(pad, load, min_load) -> None:
    with pytest.raises(GeometryError, match="loads must rise"):
        expected_loading(pad, wedge_angle=0.5, area=116.3, thickness=8, load=load, min_load=min_load)


def test_beyond_the_laws_is_nan(pad) -> None:
    place = {"wedge_angle": np.radians(30), "area": [116.3, 116.3, 1e4], "thickness": [8, 1.5, 8]}
    loading = expected_loading(pad, **place)
    assert np.isfinite(loading.ratio).tolist() == [True, False, False]
    assert np.isnan(expected_loading(pad, **place, poisson_ratio=0.2).slope).all()


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
    rounding = {
        "loading_radius_std_mm": (0.029, 0.029),
        "semi_axes_std_mm": (0.029, 0.029, 0.029),
        "wedge_angle_std_deg": 0.0,
        "area_relative_std": 0.0,
    }
    assert fit_tissue_thickness(method="direct", **rounding).chi_square > 100
    assert fit_tissue_thickness(**rounding).chi_square < 3.84


@pytest.mark.parametrize("reading", ["ratio", "slope", "slope_through_origin"])
def test_fitted_thickness_gives_back_its_radii(reading) -> None:
    fit = fit_tissue_thickness(reading=reading, poisson_ratio=0.48)
    pad = dzidek2017().semi_axes["ellipse"].ellipsoid
    again = expected_loading(
        pad,
        wedge_angle=np.radians(ANGLES),
        area=AREAS,
        thickness=np.array([fit.thickness_mm, *fit.thickness_by_angle_mm])[:, None],
        poisson_ratio=0.48,
    ).loading_radius(reading)
    assert_allclose(again[0], fit.loading_radius_mm, rtol=1e-4)
    assert_allclose([again[1, 0], again[2, 1]], [20.5, 14.5], rtol=1e-4)


AXES_STD = (0.2843, 0.6371, 0.0289)  # of two methods, 0.4/√2 and 0.9/√2 mm, and of rounding, 0.05/√3 mm


def drawn_inputs(method: str, draws: int) -> dict[str, object]:
    """Return pads, angles and areas as uncertain as the fit takes them."""
    random = np.random.default_rng(5)
    axes = dzidek2017().semi_axes[method].ellipsoid.semi_axes + random.normal(size=(draws, 3)) * AXES_STD
    return {
        "pad": Ellipsoid(*axes.T[:, :, None]),
        "wedge_angle": np.radians(ANGLES + random.normal(size=(draws, 2))),
        "area": AREAS * (1 + 0.05 * random.normal(size=(draws, 2))),
    }


def test_default_uncertainty_of_the_axes() -> None:
    assert_allclose(
        fit_tissue_thickness().std_mm, fit_tissue_thickness(semi_axes_std_mm=AXES_STD).std_mm, rtol=1e-4
    )


def test_chi_square_by_monte_carlo() -> None:
    radius_std = 0.1, 0.1
    fit = fit_tissue_thickness(method="direct", loading_radius_std_mm=radius_std)
    radii = expected_loading(**drawn_inputs("direct", 3000), thickness=fit.thickness_mm).ratio
    inside = np.isfinite(radii).all(axis=1)  # a draw or two are too skew for the laws
    assert inside.mean() > 0.999
    covariance = np.cov(radii[inside].T) + np.diag(np.square(radius_std))
    misfit = [20.5, 14.5] - fit.loading_radius_mm
    assert_allclose(fit.chi_square, misfit @ np.linalg.solve(covariance, misfit), rtol=0.06)


def test_uncertainty_by_monte_carlo() -> None:
    radius_std = 0.3, 0.2
    fit = fit_tissue_thickness(loading_radius_std_mm=radius_std)
    inputs, thicknesses = drawn_inputs("ellipse", 1000), 1 / np.linspace(1 / 4, 1 / 14, 12)
    radii = np.array([expected_loading(**inputs, thickness=each).ratio for each in thicknesses])
    measured = [20.5, 14.5] + np.random.default_rng(6).normal(size=(1000, 2)) * radius_std
    inverses = np.empty((1000, 2))
    for place in np.ndindex(1000, 2):
        falling = radii[(slice(None), *place)]
        inverses[place] = CubicSpline(falling[::-1], 1 / thicknesses[::-1])(measured[place])
    # Both thicknesses carry the errors of the shared axes: the best mean of the two is the fit's.
    precision = np.linalg.inv(np.cov(inverses.T))
    combined = 1 / (inverses @ precision.sum(axis=0) / precision.sum())
    assert_allclose(combined.std(), fit.std_mm, rtol=0.06)
    assert_allclose(np.quantile(combined, [0.025, 0.975]), fit.interval_mm, rtol=0.015)


def test_interval_without_upper_end() -> None:
    deep = fit_tissue_thickness(loading_radius_std_mm=(50, 50))
    assert deep.interval_mm[1] == np.inf


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"method": "both"}, GeometryError, "method must be one of direct, ellipse; found 'both'"),
        ({"reading": "secant"}, GeometryError, "reading must be one of ratio, slope"),
        ({"poisson_ratio": 0.2}, FitError, "ν = 0.2"),
        ({"poisson_ratio": np.nan}, FitError, "ν = nan"),
        ({"min_load_N": 2.0}, GeometryError, "loads must rise"),
        ({"loading_radius_std_mm": (1, 0)}, UncertaintyError, "must be positive"),
        ({"loading_radius_std_mm": (1,)}, UncertaintyError, "2 numbers, found 1"),
        ({"semi_axes_std_mm": (0.1, -0.1, 0.1)}, UncertaintyError, "semi_axes_std_mm must be finite"),
        ({"wedge_angle_std_deg": np.nan}, UncertaintyError, "wedge_angle_std_deg must be finite"),
        ({"area_relative_std": np.inf}, UncertaintyError, "area_relative_std must be finite"),
    ],
)
def test_bad_options(options, error, message) -> None:
    with pytest.raises(error, match=message):
        fit_tissue_thickness(**options)


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
