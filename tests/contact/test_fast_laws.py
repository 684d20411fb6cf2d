"""The fast laws: exact limits, contacts solved otherwise, derivatives, and where they end."""

import math
from pathlib import Path

import numpy as np
import pytest
from benchmarks.contact_law_data import circular_contacts, layer_spectrum
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from fingerpad.contact import (
    EllipsoidContact,
    HertzGeometry,
    PadGap,
    ellipsoid_gap,
    fast_contact,
    fast_ellipse,
    hertz_contact,
)
from fingerpad.contact.law_factors import LayerFactors, PadFactors
from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Ellipsoid, platen_normal
from fingerpad.geometry.ellipsoid import tangents
from fingerpad.uncertainty import Inputs, propagate, run_monte_carlo

PAD = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
KEPT = Path(__file__).parents[2] / "benchmarks" / "contact_laws.npz"
GRID_BIAS = 1.000545  # of the areas kept, solved on 128² cells
GIVEN = ("load", "area", "indentation")


@settings(max_examples=40)
@given(st.floats(0, 1.5), st.floats(-1, 1), st.floats(-2, 2), st.floats(-2, 2))
def test_five_numbers_are_the_whole_gap(wedge: float, roll: float, x: float, y: float) -> None:
    normal, gap = platen_normal(wedge, roll), PadGap.of(PAD, wedge_angle=wedge, roll_angle=roll)
    assert_allclose([gap.first_radius, gap.second_radius], PAD.principal_radii_at_normal(normal), rtol=1e-9)
    directions = PAD.curvature_at_normal(normal).principal_directions @ np.stack(tangents(normal)).T
    along, across = x * directions[0] + y * directions[1]
    exact = ellipsoid_gap(PAD, normal, np.array(along), np.array(across))
    q = x**2 / gap.first_radius + y**2 / gap.second_radius
    beta = 1 + gap.first_skewness * x + gap.second_skewness * y
    assert_allclose(q / (beta + np.sqrt(beta**2 - gap.flatness * q)), exact, rtol=1e-9, atol=1e-13)


@pytest.mark.parametrize("name", GIVEN)
@pytest.mark.parametrize("thickness", [None, np.inf, 1e6])
def test_small_contacts_are_hertzian(name: str, thickness: float | None) -> None:
    gap = PadGap.of(PAD, wedge_angle=0.8, roll_angle=0.3)
    hertz = hertz_contact(gap.first_radius, gap.second_radius, 1e-9, reduced_modulus=0.1)
    found = fast_contact(gap, reduced_modulus=0.1, thickness=thickness, **{name: getattr(hertz, name)})
    for each in GIVEN:
        assert_allclose(getattr(found, each), getattr(hertz, each), rtol=1e-5)
    form = fast_ellipse(gap, area=found.area, thickness=thickness)
    assert_allclose(form.semi_major / form.semi_minor, hertz.semi_major / hertz.semi_minor, rtol=1e-5)
    assert_allclose(form.peak_over_mean_pressure, 1.5, rtol=1e-5)


@pytest.mark.parametrize("name", GIVEN)
def test_paraboloids_on_deep_tissue_are_hertzian(name: str) -> None:
    hertz = HertzGeometry([8.0, 900.0], [12.0, 1.0]).under_load(2.0, reduced_modulus=0.1)
    gap = PadGap.paraboloid([8.0, 900.0], [12.0, 1.0])
    found = fast_contact(gap, reduced_modulus=0.1, **{name: getattr(hertz, name)})
    for each in GIVEN:
        assert_allclose(getattr(found, each), getattr(hertz, each), rtol=1e-13)


@pytest.mark.parametrize("thickness", [None, 8.0])
def test_a_paraboloid_among_ellipsoids_is_as_alone(thickness: float | None) -> None:
    # The third is too slender for the laws of an ellipsoid; Hertz theory of a paraboloid has no such limit.
    first, second, zero = np.array([10.0, 12.0, 3.0]), np.array([11.0, 14.0, 60.0]), np.zeros(3)
    gap = PadGap(
        first_radius=first,
        second_radius=second,
        first_skewness=zero,
        second_skewness=zero,
        flatness=np.array([0.0, 0.07, 0.0]),
    )
    press = {"thickness": thickness, "load": 0.5, "reduced_modulus": 0.1}
    alone = fast_contact(PadGap.paraboloid(first, second), **press)
    among = fast_contact(gap, **press)
    assert among.flag.tolist() == alone.flag.tolist()
    assert_allclose(among.area[::2], alone.area[::2], rtol=1e-12)
    assert among.flag.tolist()[:2] == ["", ""]
    assert not np.isclose(among.area[1], alone.area[1], rtol=1e-3)
    form, plain = (
        fast_ellipse(each, area=20.0, thickness=thickness) for each in (gap, PadGap.paraboloid(first, second))
    )
    assert_allclose(form.semi_major[::2], plain.semi_major[::2], rtol=1e-12)


@pytest.mark.parametrize("poisson_ratio", [-0.5, 0.0, 0.25, 0.5])
def test_poisson_ratio_does_not_matter_to_a_half_space(poisson_ratio: float) -> None:
    gap = PadGap.of(PAD, wedge_angle=0.5)
    thickness, nu = np.array([np.inf, 8.0]), np.array([poisson_ratio, 0.5])
    press = {"load": 1.0, "reduced_modulus": 0.1}
    deep = fast_contact(gap, **press)
    for found in (
        fast_contact(gap, **press, thickness=np.inf, poisson_ratio=poisson_ratio),
        fast_contact(gap, **press, thickness=thickness, poisson_ratio=nu),
        fast_contact(gap, **press, thickness=[np.inf, 8.0], poisson_ratio=poisson_ratio),
    ):
        assert found.flag.ravel()[0] == ""
        assert_allclose(found.area.ravel()[0], deep.area, rtol=1e-12)
        assert_allclose(found.indentation.ravel()[0], deep.indentation, rtol=1e-12)
    assert found.flag[1] == ("" if poisson_ratio == 0.5 else "poisson_ratio_out_of_range")


@pytest.mark.parametrize("name", GIVEN)
def test_spheres_are_sneddons(name: str) -> None:
    # Sneddon (1965): ξ = (a/2) ln((R + a)/(R − a)), W = E*/2 · ((R² + a²) ln((R + a)/(R − a)) − 2aR).
    radius = np.linspace(0.1, 5.9, 30)
    log = np.log((10 + radius) / (10 - radius))
    exact = {
        "load": 0.05 * ((100 + radius**2) * log - 20 * radius),
        "area": np.pi * radius**2,
        "indentation": radius / 2 * log,
    }
    found = fast_contact(
        PadGap.of(Ellipsoid(10, 10, 10), wedge_angle=0.4), reduced_modulus=0.1, **{name: exact[name]}
    )
    for each in GIVEN:
        assert_allclose(getattr(found, each), exact[each], rtol=1e-4)


@pytest.mark.parametrize("poisson_ratio", [0.3, 0.333, 0.4, 0.47, 0.4999, 0.5])
def test_circular_contacts_on_a_layer(poisson_ratio: float) -> None:
    size = np.array([0.03, 0.1, 0.3, 0.5, 0.9, 1.3, 2.0, 2.6, 3.0])
    load, depth, peak = circular_contacts(size, poisson_ratio).T
    exact = {
        "load": 4 / 3 * 0.1 * size**3 / 10 * load,
        "area": np.pi * size**2,
        "indentation": size**2 / 10 * depth,
    }
    gap = PadGap.paraboloid(10.0, 10.0)
    for name in GIVEN:
        layer = {"thickness": 1.0, "poisson_ratio": poisson_ratio}
        found = fast_contact(gap, reduced_modulus=0.1, **layer, **{name: exact[name]})
        for each in GIVEN:
            assert_allclose(getattr(found, each), exact[each], rtol=3e-3)
    form = fast_ellipse(gap, area=exact["area"], **layer)
    assert_allclose(form.semi_major, form.semi_minor, rtol=1e-12)
    assert_allclose(form.peak_over_mean_pressure, 1.5 * peak, rtol=5e-3)


@pytest.mark.parametrize("poisson_ratio", [0.3, 0.45, 0.5])
def test_thick_layers_follow_the_series(poisson_ratio: float) -> None:
    # Of Green's function, α0 and α2 r²/t²: ξ/ξ_H = 1 + 4α0 x/(3π) + O(x³), ln(W/W_H) = 8α2 x³/(3π) + O(x⁵).
    wavenumber, weight = layer_spectrum(poisson_ratio)
    uniform, curved = weight.sum(), -0.25 * weight @ wavenumber**2
    x = np.array([0.01, 0.02])
    layer = LayerFactors(np.ones(2), np.full(2, poisson_ratio), np.zeros(2))
    assert_allclose((layer.value("indentation", x) - 1) / x, 4 * uniform / (3 * np.pi), atol=2 * x.max() ** 2)
    assert_allclose(np.log(layer.value("load", x)) / x**3, 8 * curved / (3 * np.pi), atol=0.02)


def test_the_series_of_garcia() -> None:
    # F/F_Hertz = 1 + 1.133χ + 1.497χ² + 1.469χ³ + 0.755χ⁴, χ = √(Rξ)/t, ν = 0.5 (García & García 2018).
    chi = np.array([0.05, 0.1, 0.2])
    found = fast_contact(PadGap.paraboloid(1.0, 1.0), indentation=chi**2, thickness=1.0, reduced_modulus=0.75)
    series = np.polynomial.Polynomial([1, 1.133, 1.497, 1.469, 0.755])(chi)
    assert_allclose(found.load / chi**3, series, rtol=2e-3)


@pytest.mark.parametrize("poisson_ratio", [0.3, 0.4, 0.5])
def test_thin_layers_tend_to_their_limits(poisson_ratio: float) -> None:
    # Compressible: W = πM a⁴/(4Rt), ξ = a²/(2R), M = E*(1 − ν)²/(1 − 2ν).
    # Incompressible: W = πE* a⁶/(128 R t³), ξ = a²/(4R).
    x = np.array([1e7])
    layer = LayerFactors(np.ones(1), np.array([poisson_ratio]), np.zeros(1))
    stiffness = (1 - poisson_ratio) ** 2 / (1 - 2 * poisson_ratio) if poisson_ratio < 0.5 else math.inf
    load = 3 * np.pi / 512 * x**3 if poisson_ratio == 0.5 else 3 * np.pi / 16 * stiffness * x
    assert_allclose(layer.value("load", x), load, rtol=1e-4)
    assert_allclose(layer.value("indentation", x), 0.25 if poisson_ratio == 0.5 else 0.5, rtol=1e-5)


@pytest.mark.parametrize(
    ("name", "tolerances"),
    [
        (
            "elliptical_held_out",
            {"load": 5e-3, "area": 2e-3, "indentation": 2e-3, "form": 3e-3, "peak": 3e-3},
        ),
        ("pads_held_out", {"load": 2e-3, "area": 2e-3, "indentation": 2e-3, "form": 2e-3, "peak": 3e-3}),
        ("layered_held_out", {"load": 1e-2, "area": 6e-3, "indentation": 6e-3, "form": 6e-3, "peak": 1e-2}),
    ],
)
def test_contacts_that_nothing_was_fitted_to(name: str, tolerances: dict[str, float]) -> None:
    rows = np.load(KEPT)[name]
    if name == "elliptical_held_out":
        gap, thickness, poisson_ratio = PadGap.paraboloid(1000.0, rows[:, 2]), np.ones(len(rows)), rows[:, 0]
    else:
        gap = PadGap.of(Ellipsoid(*rows[:, :3].T), wedge_angle=rows[:, 3], roll_angle=rows[:, 4])
        thickness, poisson_ratio = rows[:, 5], rows[:, 6]
    load, area, indentation, ratio, peak = rows[:, -5:].T
    layer = {} if np.isinf(thickness).all() else {"thickness": thickness, "poisson_ratio": poisson_ratio}
    solved = {"load": load, "area": area / GRID_BIAS, "indentation": indentation}
    for given_name in GIVEN:
        found = fast_contact(gap, reduced_modulus=1.0, **layer, **{given_name: solved[given_name]})
        inside = found.flag == ""
        assert inside.mean() > 0.75
        for each in GIVEN:
            assert_allclose(getattr(found, each)[inside], solved[each][inside], rtol=tolerances[each])
            assert np.isnan(getattr(found, each)[~inside]).all()
    form = fast_ellipse(gap, area=solved["area"], **layer)
    inside = np.isfinite(form.semi_major)
    assert_allclose((form.semi_minor / form.semi_major)[inside], ratio[inside], rtol=tolerances["form"])
    pressure = form.peak_over_mean_pressure * load / solved["area"]
    assert_allclose(pressure[inside], peak[inside], rtol=tolerances["peak"])


def test_agrees_with_a_finer_solver() -> None:
    place = {"wedge_angle": math.radians(45), "roll_angle": math.radians(15)}
    layer = {"thickness": 7.0, "poisson_ratio": 0.48}
    solution = EllipsoidContact.of(PAD, **place, **layer, load=1.5, reduced_modulus=0.1).solution
    found = fast_contact(PadGap.of(PAD, **place), **layer, load=1.5, reduced_modulus=0.1)
    assert_allclose(found.area, solution.area, rtol=3e-3)
    assert_allclose(found.indentation, solution.indentation, rtol=3e-3)
    form = fast_ellipse(PadGap.of(PAD, **place), area=found.area, **layer)
    assert_allclose([form.semi_major, form.semi_minor], [solution.semi_major, solution.semi_minor], rtol=3e-3)


@pytest.mark.parametrize(
    "layer", [{}, {"thickness": 6.0, "poisson_ratio": 0.45}, {"thickness": 1.3, "poisson_ratio": 0.3}]
)
def test_load_area_and_indentation_ask_the_same_contact(layer: dict[str, float]) -> None:
    gap = PadGap.of(PAD, wedge_angle=np.linspace(0, 1.5, 7), roll_angle=0.2)
    by_area = fast_contact(gap, area=40.0, reduced_modulus=0.1, **layer)
    for name in ("load", "indentation"):
        found = fast_contact(gap, reduced_modulus=0.1, **layer, **{name: getattr(by_area, name)})
        assert_allclose(found.area, 40.0, rtol=2e-5)
        assert_allclose(found.load, by_area.load, rtol=2e-5)
        assert_allclose(found.indentation, by_area.indentation, rtol=2e-5)


def model(palmar, distal, radial_ulnar, wedge_angle, roll_angle, load, modulus, thickness, poisson_ratio):
    pad = Ellipsoid(palmar=palmar, distal=distal, radial_ulnar=radial_ulnar)
    gap = PadGap.of(pad, wedge_angle=wedge_angle, roll_angle=roll_angle)
    layer = {"thickness": thickness, "poisson_ratio": poisson_ratio}
    contact = fast_contact(gap, load=load, reduced_modulus=modulus, **layer)
    form = fast_ellipse(gap, area=contact.area, **layer)
    return {
        "area": contact.area,
        "indentation": contact.indentation,
        "ratio": form.semi_minor / form.semi_major,
        "peak": form.peak_over_mean_pressure,
    }


INPUTS = {
    "palmar": (7.9, 0.05),
    "distal": (13.8, 0.05),
    "radial_ulnar": (11.8, 0.05),
    "wedge_angle": (0.6, 0.01),
    "roll_angle": (0.2, 0.01),
    "load": (1.5, 0.02),
    "modulus": (0.12, 0.002),
    "thickness": (7.0, 0.1),
    "poisson_ratio": (0.47, 0.005),
}


def test_derivatives_are_exact() -> None:
    found = propagate(model, Inputs.of(**INPUTS))
    centre = {name: value for name, (value, _) in INPUTS.items()}
    for place, (name, value) in enumerate(centre.items()):
        ends = [model(**{**centre, name: value * (1 + sign * 1e-5)}) for sign in (1, -1)]
        slopes = [(ends[0][each] - ends[1][each]) / (2e-5 * value) for each in found.names]
        assert_allclose(found.jacobian[:, place], slopes, rtol=1e-5, atol=1e-8)


@pytest.mark.parametrize("of", ["load", "indentation"])
@pytest.mark.parametrize("layered", [False, True])
def test_slopes_of_the_pad_are_those_of_its_values(of: str, layered: bool) -> None:
    gap = PadGap.of(PAD, wedge_angle=0.6, roll_angle=0.2)
    radius, every, step = np.array([1.0, 3.0, 5.0]), np.ones(3), 1e-5
    numbers = (gap.first_radius, gap.second_radius, gap.first_skewness, gap.second_skewness, gap.flatness)
    pad = PadFactors(*(each * every for each in numbers), stretch=1.1 * every, elongation=0.2 * every)
    layer = LayerFactors(6 * every, 0.45 * every, 0.02 * every)

    def size(radius: np.ndarray) -> np.ndarray | None:
        return layer.size(radius) if layered else None

    up, down = (pad.value(of, each, size(each)) for each in (radius * np.exp(step), radius * np.exp(-step)))
    exact = (up - down) / (2 * step)
    assert_allclose(pad.slope(of, radius, size(radius)), exact, rtol=0.04 if layered else 1e-6)


def test_first_order_agrees_with_monte_carlo() -> None:
    first_order = propagate(model, Inputs.of(**INPUTS))
    drawn = run_monte_carlo(model, Inputs.of(**INPUTS), seed=1)
    assert_allclose(first_order.std, drawn.std, rtol=0.03)


@pytest.mark.parametrize(
    ("gap", "given", "flag"),
    [
        (PadGap.paraboloid(10, 10), {"load": 1.0}, ""),
        (PadGap.paraboloid(10, 10), {"load": 0.0}, "no_contact"),
        (PadGap.paraboloid(10, math.nan), {"load": 1.0}, "no_contact"),
        (PadGap.paraboloid(10, 10), {"area": math.nan}, "no_contact"),
        (PadGap.paraboloid(10, 10), {"area": math.inf}, "no_contact"),
        (PadGap.paraboloid(10, 10), {"area": 3.02**2 * math.pi, "thickness": 1.0}, "layer_too_thin"),
        (PadGap.paraboloid(10, 10), {"load": 1e9, "thickness": 1.0}, "layer_too_thin"),
        (PadGap.paraboloid(10, 10), {"indentation": 1e9, "thickness": 1.0}, "layer_too_thin"),
        (PadGap.paraboloid(10, 10), {"load": 1.0, "thickness": -1.0}, "layer_too_thin"),
        (PadGap.paraboloid(10, 10), {"load": 1.0, "thickness": math.nan}, "layer_too_thin"),
        (PadGap.of(PAD, wedge_angle=0.5), {"area": 50.0, "thickness": -1.0}, "layer_too_thin"),
        (PadGap.paraboloid(10, 29), {"load": 1.0, "thickness": 5.0}, "contact_too_slender"),
        (
            PadGap.paraboloid(10, 10),
            {"load": 1.0, "thickness": 5.0, "poisson_ratio": 0.29},
            "poisson_ratio_out_of_range",
        ),
        (
            PadGap.paraboloid(10, 10),
            {"load": 1.0, "thickness": 5.0, "poisson_ratio": 0.51},
            "poisson_ratio_out_of_range",
        ),
        (PadGap.of(PAD, wedge_angle=0.0), {"area": 0.595**2 * math.pi * 13.8 * 11.8}, ""),
        (PadGap.of(PAD, wedge_angle=0.0), {"area": 0.605**2 * math.pi * 13.8 * 11.8}, "contact_too_wide"),
        (PadGap.of(PAD, wedge_angle=0.5), {"load": 30.0}, "contact_too_wide"),
        (PadGap.of(PAD, wedge_angle=0.5), {"load": 1e6}, "contact_too_wide"),
        (PadGap.of(PAD, wedge_angle=0.5), {"indentation": 1e3, "thickness": 5.0}, "contact_too_wide"),
        (PadGap.of(Ellipsoid(3, 14, 9), wedge_angle=0.6), {"area": 60.0}, "contact_too_skew"),
        (PadGap.of(Ellipsoid(6, 40, 6), wedge_angle=0.0), {"load": 1.0}, "contact_too_slender"),
    ],
)
def test_beyond_their_range_they_say_why(gap: PadGap, given: dict[str, float], flag: str) -> None:
    found = fast_contact(gap, reduced_modulus=0.1, **given)
    assert found.flag == flag
    for name in GIVEN:
        assert np.isnan(getattr(found, name)) == (flag != "")


def test_refuses_two_questions_at_once() -> None:
    with pytest.raises(GeometryError, match="exactly one of load, area and indentation, found 2"):
        fast_contact(PadGap.paraboloid(10, 10), load=1.0, area=2.0, reduced_modulus=0.1)
