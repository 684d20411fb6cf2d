"""The contact solver: exact solutions, limits, other implementations, the whole pad, and what it refuses."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from benchmarks.claims.contact_solver import solved_by_tamaas
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from fingerpad._arrays import FloatArray
from fingerpad.contact import SolvedContact, Tissue, hertz_contact, solve_contact, solve_gap
from fingerpad.contact.grid import contact_outline
from fingerpad.exceptions import ConvergenceError, GeometryError
from fingerpad.geometry import Counterface, Ellipsoid, Paraboloid, Placement
from fingerpad.geometry.ellipsoid import tangents
from fingerpad.geometry.placement import platen_normal

HALF_SPACE = Tissue.of_reduced_modulus(0.1)
RADIUS = 10.0
BALL = Paraboloid(RADIUS, RADIUS)


def paraboloid(first: float, second: float) -> Callable[[FloatArray, FloatArray], FloatArray]:
    return lambda x, y: x**2 / (2 * first) + y**2 / (2 * second)


def sphere(x: FloatArray, y: FloatArray) -> FloatArray:
    with np.errstate(invalid="ignore"):
        return RADIUS - np.sqrt(RADIUS**2 - x**2 - y**2)


def on_layer(thickness: float, poisson_ratio: float, *, points: int = 128, **given: float) -> SolvedContact:
    tissue = Tissue.of_reduced_modulus(0.1, poisson_ratio, thickness)
    return solve_contact(BALL, tissue, points=points, **given)


@pytest.mark.parametrize("ratio", [1.0, 1.07, 2.0, 5.0, 20.0])
@pytest.mark.parametrize("points", [64, 128])
def test_paraboloids_equal_hertz(ratio: float, points: int) -> None:
    bodies = Paraboloid(RADIUS, ratio * RADIUS)
    hertz = hertz_contact(bodies, HALF_SPACE, load=0.5)
    found = solve_contact(bodies, HALF_SPACE, load=0.5, points=points)
    fineness = (256 / points) ** 1.6
    assert_allclose(found.area, hertz.area, rtol=3e-4 * fineness)
    assert_allclose(found.semi_major, hertz.semi_major, rtol=2e-4 * fineness)
    assert_allclose(found.semi_minor, hertz.semi_minor, rtol=2e-4 * fineness)
    assert_allclose(found.indentation, hertz.indentation, rtol=6e-6 * (256 / points) ** 2)
    assert_allclose(found.peak_pressure, hertz.peak_pressure, rtol=3e-5 * (256 / points) ** 2)
    assert_allclose(found.elastic_energy, 0.4 * 0.5 * hertz.indentation, rtol=1e-5 * (256 / points) ** 2)
    assert_allclose(found.load, 0.5, rtol=1e-12)
    error = abs(found.area / float(hertz.area) - 1)
    assert error < found.relative_error < 1e-3 * fineness
    if ratio > 1:
        assert not found.along
        assert_allclose(abs(found.long_axis_angle), math.pi / 2, atol=1e-3)


@pytest.mark.parametrize(("power", "factor"), [(4, 8 / 3), (6, 16 / 5)])
def test_power_law_shapes_equal_sneddon(power: int, factor: float) -> None:
    # Gap r^n: ξ = factor·a^n, W = 2n/(n + 1) E* a ξ (Johnson 1985, Eq. 5.20).
    found = solve_gap(
        lambda x, y: (x**2 + y**2) ** (power // 2) / 1000,
        HALF_SPACE,
        half_widths=(3, 3),
        area=math.pi * 4,
        points=128,
    )
    indentation = factor * 2.0**power / 1000
    assert_allclose(found.indentation, indentation, rtol=4e-3)
    assert_allclose(found.load, 2 * power / (power + 1) * 0.1 * 2 * found.indentation, rtol=1e-3)


# Contact radius over thickness: A/(πRξ), load over Hertz's at this indentation and at this area, ν = 0.5 and
# 0.3, on 512² cells; they lie within 2 % of the coarser table from which the work began.
LAYERS = {
    (0.1, 0.5): (1.0802, 1.1235, 1.0007),
    (0.5, 0.5): (1.4364, 1.8570, 1.0787),
    (1.0, 0.5): (1.7877, 3.3708, 1.4103),
    (2.0, 0.5): (2.1985, 8.4671, 2.5975),
    (2.0, 0.3): (1.7451, 4.3311, 1.8788),
}


@pytest.mark.parametrize(("ratio", "poisson_ratio"), LAYERS)
def test_layer_table(ratio: float, poisson_ratio: float) -> None:
    found = on_layer(3 / ratio, poisson_ratio, area=9 * math.pi)
    hertz = 4 / 3 * 0.1
    at_indentation = found.load / (hertz * RADIUS**0.5 * found.indentation**1.5)
    at_area = found.load / (hertz * 27 / RADIUS)
    computed = found.area_over_pi_indentation / RADIUS, at_indentation, at_area
    assert_allclose(computed, LAYERS[ratio, poisson_ratio], rtol=1e-3)


@pytest.mark.parametrize("thickness", [math.inf, 4.0])
def test_load_is_derivative_of_energy(thickness: float) -> None:
    lower, middle, upper = (on_layer(thickness, 0.48, indentation=x) for x in (0.495, 0.5, 0.505))
    assert_allclose((upper.elastic_energy - lower.elastic_energy) / 0.01, middle.load, rtol=2e-4)


def test_oblique_contact_direction() -> None:
    turn = 0.4
    along = lambda x, y: x * math.cos(turn) + y * math.sin(turn)  # noqa: E731
    across = lambda x, y: y * math.cos(turn) - x * math.sin(turn)  # noqa: E731
    ellipse = paraboloid(2 * RADIUS, RADIUS)
    hertz = hertz_contact(Paraboloid(2 * RADIUS, RADIUS), HALF_SPACE, load=0.5)
    for angle in (0.0, turn, 1.2):
        found = solve_gap(
            lambda x, y: ellipse(along(x - 1, y), across(x - 1, y)),
            HALF_SPACE,
            half_widths=(2, 4),
            angle=angle,
            load=0.5,
            points=128,
        )
        assert_allclose(found.long_axis_angle, turn, atol=1e-3)
        assert_allclose(found.centre, [1, 0], atol=1e-3)
        assert_allclose(found.aspect_ratio, hertz.aspect_ratio, rtol=1e-3)


def test_agrees_with_tamaas() -> None:
    found = solve_gap(sphere, HALF_SPACE, half_widths=(4, 4), load=1.5, points=128)
    along = 12 * (np.arange(128) + 0.5) / 128 - 6
    pressure, indentation = solved_by_tamaas(sphere(along[:, None], along), 12.0, 1.5, tolerance=1e-10)
    assert_allclose(found.indentation, indentation, rtol=1e-4)
    assert_allclose(found.peak_pressure, pressure.max(), rtol=1e-3)
    assert_allclose(found.area, np.mean(pressure > 0) * 12**2, rtol=0.01)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({}, "give exactly one of load, area, indentation, found 0"),
        ({"load": 1.0, "area": 1.0}, "found 2"),
        ({"load": 0.0}, "load must be positive and finite, found 0"),
        ({"area": math.nan}, "area must be positive and finite, found nan"),
        ({"load": 1.0, "points": 40}, "points must be a whole number from 64 to 4096, found 40"),
        ({"load": 1.0, "points": 64.5}, "points must be a whole number .*, found 64.5"),
        ({"load": 1.0, "points": 10**6}, "points must be a whole number .*, found 1000000"),
        ({"load": 100.0}, "would press through the layer's thickness of 2"),
        ({"thickness": 0.1, "indentation": 0.06}, r"a tenth of the contact's mean radius 1\..*, found 0.1"),
    ],
)
def test_invalid_arguments(given: dict[str, float], message: str) -> None:
    with pytest.raises(GeometryError, match=message):
        on_layer(**{"thickness": 2.0, "poisson_ratio": 0.3, "points": 64, **given})


@pytest.mark.parametrize("given", [{"load": 1e2}, {"load": 1e9}, {"area": 1e9}, {"indentation": 1e9}])
def test_a_pad_far_too_hard_pressed_is_said_to_be(given: dict[str, float]) -> None:
    place = Placement(Ellipsoid(7.9, 13.8, 11.8), wedge_angle=0.5)
    with pytest.raises(GeometryError, match="would flatten the pad to its silhouette"):
        solve_contact(place, HALF_SPACE, points=64, **given)


def test_a_gap_is_a_function() -> None:
    with pytest.raises(GeometryError, match="gap must be a function of x and y, found float"):
        solve_gap(0.5, HALF_SPACE, half_widths=(3, 3), load=1.0)


@pytest.mark.parametrize("given", [{"indentation": 1.0}, {"area": 31.4159}, {"load": 0.42164}])
@pytest.mark.parametrize("offset", [2.0, 10.0, -60.0])
def test_the_lowest_point_need_not_lie_on_the_first_grid(given: dict[str, float], offset: float) -> None:
    def gap(x: FloatArray, y: FloatArray) -> FloatArray:
        return ((x - offset) ** 2 + y**2) / (2 * RADIUS)

    found = solve_gap(gap, HALF_SPACE, half_widths=(3, 3), points=64, **given)
    assert found.area_over_pi_indentation == pytest.approx(RADIUS, rel=3e-3)
    assert found.area == pytest.approx(31.4159, rel=3e-3)
    assert_allclose(found.centre, [offset, 0], atol=1e-3)


@pytest.mark.parametrize(
    ("gap", "given"),
    [
        (lambda x, y: 0 * x * y, {"load": 1.0}),
        (lambda x, y: 5 + x**2 + y**2, {"indentation": 1.0}),
        *((lambda x, y: x - y, given) for given in ({"indentation": 1.0}, {"area": 30.0}, {"load": 0.4})),
        (lambda x, y: np.full_like(x + y, np.nan), {"load": 0.4}),
    ],
)
def test_a_gap_that_does_not_close_is_refused(gap, given: dict[str, float]) -> None:
    with pytest.raises((GeometryError, ConvergenceError), match="gap|did not settle on the contact"):
        solve_gap(gap, HALF_SPACE, half_widths=(3, 3), points=64, **given)


@pytest.mark.parametrize("degrees", [-80, -45, -10, 10, 45, 80])
def test_long_axis_points_forward(degrees: int) -> None:
    x = np.linspace(-2.2, 2.2, 80)
    along, across = np.meshgrid(x, x, indexing="ij")
    cosine, sine = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    inside = 1 - ((cosine * along + sine * across) / 2) ** 2 - (cosine * across - sine * along) ** 2
    outline = contact_outline(x, x, np.sqrt(np.maximum(inside, 0)))
    assert_allclose(np.degrees(outline.long_axis_angle), degrees, atol=1e-3)
    assert_allclose([outline.semi_major, outline.semi_minor], [2, 1], rtol=1e-5)


PAD = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
PLACEMENT = Placement(PAD, wedge_angle=np.radians(45), roll_angle=np.radians(10))
SOFT = Tissue.of_reduced_modulus(0.1365)


@settings(max_examples=40)
@given(st.floats(0, 1.5), st.floats(-1, 1), st.floats(-2, 2), st.floats(-2, 2))
def test_gap_ends_on_ellipsoid(wedge: float, roll: float, along: float, across: float) -> None:
    placement = Placement(PAD, wedge_angle=wedge, roll_angle=roll)
    normal, height = placement.normal, placement.gap.height
    gap = height(np.array([along, 0.0]), np.array([across, 0.0]))
    assert gap[0] >= -1e-12
    assert abs(gap[1]) < 1e-12
    plane = np.array([along, across]) @ np.stack(tangents(normal))
    end = PAD.contact_point(normal) + plane - gap[0] * normal
    assert_allclose(np.sum((end / PAD.semi_axes) ** 2), 1, atol=1e-9)
    first, second = PAD.curvature_at_normal(normal).principal_directions
    small = height(np.array([1e-3, 0.0]), np.array([0.0, 1e-3]))
    tilted = np.stack([first, second]) @ np.stack(tangents(normal)).T  # the plate's axes are not principal
    curvatures = 1 / np.array(PAD.curvature_at_normal(normal).principal_radii)
    assert_allclose(small, 0.5e-6 * curvatures @ tilted**2, rtol=2e-3)


def test_gap_nan_beyond_silhouettes() -> None:
    far, near = np.array([11.0, 3.0]), np.zeros(2)

    def missing(counterface: Counterface | None) -> list[bool]:
        ball = Placement(Ellipsoid(10, 10, 10), wedge_angle=0.0, counterface=counterface)
        return np.isnan(ball.gap.height(far, near)).tolist()

    assert missing(None) == [True, False]
    assert missing(Counterface.sphere(2.0)) == [True, True]
    assert missing(Counterface.cylinder(2.0, axis_angle=0.0)) == [True, False]


@pytest.mark.parametrize(
    "counterface",
    [
        Counterface.sphere(20.0),
        Counterface.cylinder(15.0, axis_angle=0.0),
        Counterface.cylinder(6.0, axis_angle=0.7),
    ],
)
def test_small_contacts_with_curved_bodies_equal_hertz(counterface: Counterface) -> None:
    placement = Placement(PAD, wedge_angle=0.5, counterface=counterface)
    tissue = Tissue.of_reduced_modulus(0.1)
    found = solve_contact(placement, tissue, load=1e-4, points=128)
    hertz = hertz_contact(placement, tissue, load=1e-4)
    curvature = np.diag(1 / np.array(PAD.curvature_at_normal(platen_normal(0.5, 0.0)).principal_radii))
    angle = counterface.axis_angle
    across = np.eye(2) if angle is None else np.outer(*2 * [[-math.sin(angle), math.cos(angle)]])
    values, vectors = np.linalg.eigh(curvature + across / counterface.radius)
    expected = hertz_contact(Paraboloid(*(1 / values)), tissue, load=1e-4)
    assert_allclose(hertz.semi_major, expected.semi_major, rtol=1e-12)
    assert_allclose(found.semi_major, expected.semi_major, rtol=1e-3)
    assert_allclose(found.semi_minor, expected.semi_minor, rtol=1e-3)
    assert_allclose(found.indentation, expected.indentation, rtol=1e-3)
    direction = math.cos(found.long_axis_angle), math.sin(found.long_axis_angle)
    assert_allclose(abs(np.dot(direction, vectors[:, 0])), 1, rtol=1e-4)


@pytest.mark.parametrize("thickness", [math.inf, 8.0])
def test_error_estimate_bounds_refinement(thickness: float) -> None:
    tissue = Tissue.of_reduced_modulus(0.1365, thickness=thickness)
    coarse, fine = (solve_contact(PLACEMENT, tissue, load=2.0, points=points) for points in (96, 256))
    assert abs(coarse.area / fine.area - 1) < coarse.relative_error < 5e-3
    assert abs(coarse.indentation / fine.indentation - 1) < 0.1 * coarse.relative_error
    assert fine.relative_error < 1e-3


def test_one_contact_at_a_time() -> None:
    two = Placement(PAD, wedge_angle=np.radians([30, 45]))
    for placement, tissue in ((two, SOFT), (two[0], Tissue([0.1, 0.2]))):
        with pytest.raises(GeometryError, match=r"one contact is solved at a time.*place\[0\]"):
            solve_contact(placement, tissue, load=1.0)
    with pytest.raises(GeometryError, match=r"load of shape \(2,\): loop over them"):
        solve_contact(PLACEMENT, SOFT, load=[1.0, 2.0])
    one = Placement(PAD, wedge_angle=np.radians(45))
    solved = [solve_contact(each, SOFT, load=1.0, points=64).area for each in (two[1], one)]
    assert solved[0] == solved[1]
