"""The audit: no printed number missing, each with the right verdict, and nothing tuned to get it."""

import tomllib
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
from benchmarks.claims.tissue_thickness import READINGS
from numpy.testing import assert_allclose
from scipy.interpolate import CubicSpline

from fingerpad.contact import Tissue, fast_contact
from fingerpad.exceptions import FitError, GeometryError
from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.published import AuditItem, audit, dzidek2017, fit_tissue_thickness, layer_items
from fingerpad.published.audit import radius_with_misprint
from fingerpad.published.dzidek2017 import Printed

REPRODUCED = "reproduced"
MISPRINT = "reproduced with the known misprint"
NOT = "not reproducible from what is printed"


@pytest.fixture(scope="module")
def items() -> dict[str, AuditItem]:
    found = audit()
    named = {item.item: item for item in found}
    assert len(named) == len(found)
    return named


def printed_numbers(table: object, path: tuple[str, ...] = ()) -> list[float]:
    """Return every number of the data file but the load, which only says where others hold."""
    if isinstance(table, dict):
        return [number for key, part in table.items() for number in printed_numbers(part, (*path, key))]
    if path == ("table3", "load_N"):
        return []
    return [float(number) for number in (table if isinstance(table, list) else [table])]


def test_each_printed_number_audited_once(items) -> None:
    text = files("fingerpad.published").joinpath("dzidek2017.toml").read_text(encoding="utf-8")
    expected = printed_numbers(tomllib.loads(text))
    assert len(expected) == 36
    measured = [item for item in items.values() if item.computed is None]
    assert len(measured) == 12
    assert all(item.verdict == NOT and "measured input" in item.remark for item in measured)
    assert sorted(item.printed for item in items.values()) == sorted(expected)


@pytest.mark.parametrize(
    ("method", "printed", "true"),
    [
        ("direct", [41.0, 30.2, 20.5, 12.2, 5.5], [22.58, 18.72, 14.57, 10.12, 5.45]),
        ("ellipse", [33.3, 25.3, 18.0, 11.6, 6.2], [20.36, 17.11, 13.67, 10.03, 6.25]),
    ],
)
def test_table_2(items, method, printed, true) -> None:
    row = [items[f"Table 2, {method}, u = {u}°"] for u in (0, 30, 45, 60, 90)]
    assert [item.printed for item in row] == printed
    assert_allclose([item.computed for item in row], true, atol=5e-3)
    assert_allclose([item.with_misprint for item in row], printed, atol=0.05)
    assert [item.verdict for item in row] == [MISPRINT] * 4 + [REPRODUCED]
    assert {item.unit for item in row} == {"mm"}


@pytest.mark.parametrize(
    ("name", "printed", "computed", "tolerance", "verdict"),
    [
        ("Text, ellipse, θ = 30°, R_0g", 18.7, 13.607666, 6e-7, NOT),
        ("Text, ellipse, θ = 45°, R_0g", 13.2, 9.982357, 6e-7, NOT),
        ("Table 3, θ = 30°, area", 116.3, np.pi * 7.4 * 5.0, 1e-12, REPRODUCED),
        ("Table 3, θ = 45°, area", 69.4, np.pi * 5.3 * 4.2, 1e-12, REPRODUCED),
        ("Table 3, θ = 30°, u", 47.6, 45.243495, 6e-7, NOT),
        ("Table 3, θ = 45°, u", 68.3, 60.210426, 6e-7, NOT),
        ("Table 4, θ = 30°, R_0g", 18.7, 13.607666, 6e-7, NOT),
        ("Table 4, θ = 45°, R_0g", 13.2, 9.982357, 6e-7, NOT),
        ("Table 4, θ = 30°, R_corr", 19.9, 18.7 / 0.995216154**3, 1e-6, NOT),
        ("Table 4, θ = 45°, R_corr", 14.0, 13.2 / 0.998311346**3, 1e-6, NOT),
        ("Pooled, θ = 30°, R_corr", 20.2, 18.97, 5e-3, NOT),
        ("Pooled, θ = 45°, R_corr", 14.2, 13.27, 5e-3, NOT),
        ("Pooled, θ = 30°, uncertainty of R_corr", 1.5, 0.02, 5e-3, NOT),
        ("Pooled, θ = 45°, uncertainty of R_corr", 0.6, 0.01, 5e-3, NOT),
    ],
)
def test_other_computed_values(items, name, printed, computed, tolerance, verdict) -> None:
    item = items[name]
    assert (item.printed, item.verdict) == (printed, verdict)
    assert_allclose(item.computed, computed, atol=tolerance)
    assert item.formula


def test_misprint_does_not_explain_wedge_radii(items) -> None:
    found = [items[f"Table 4, θ = {angle}°, R_0g"].with_misprint for angle in (30, 45)]
    assert_allclose(found, [17.89, 11.55], atol=5e-3)


def test_range_covers_rounding(items) -> None:
    item = items["Table 2, ellipse, u = 30°"]
    steps = np.linspace(-0.05, 0.05, 11)
    a, b, c = np.meshgrid(7.9 + steps, 13.8 + steps, 11.8 + steps)
    radii = Ellipsoid(a, b, c).curvature(np.radians(30), np.pi / 2).mean_curvature_radius
    assert_allclose([item.low, item.high], [radii.min(), radii.max()], rtol=1e-9)


def test_misprint_without_effect_at_fingertip() -> None:
    pad = dzidek2017().semi_axes["direct"].ellipsoid
    true = pad.curvature(np.pi / 2, np.pi / 2).mean_curvature_radius
    assert_allclose(radius_with_misprint(pad, np.pi / 2), true, rtol=1e-14)
    assert radius_with_misprint(pad, 0.0) > 1.5 * pad.curvature(0.0, np.pi / 2).mean_curvature_radius


@pytest.mark.parametrize(
    ("digits", "value", "rounding"), [("5.0", 5.0, 0.05), ("5", 5.0, 0.5), ("116.30", 116.3, 0.005)]
)
def test_rounding_from_last_digit(digits, value, rounding) -> None:
    assert Printed.of(digits) == Printed(value, rounding)


def test_the_docs_count_the_misprints() -> None:
    root = Path(__file__).parents[2]
    page = (root / "docs/explanation/dzidek2017.md").read_text(encoding="utf-8")
    assert "Eight of the ten radii that it tabulates contain a misprint" in " ".join(page.split())
    paper = (root / "paper" / "paper.md").read_text(encoding="utf-8")
    assert "eight of ten tabulated radii contain a misprint" in paper


# R_g on one layer of tissue: known values, limits, the solver, and the fit of the thickness


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


def test_what_cannot_be_fitted_is_refused() -> None:
    with pytest.raises(FitError, match="ν = 0.29"):  # the laws do not hold there
        fit_tissue_thickness(poisson_ratio=0.29)
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
