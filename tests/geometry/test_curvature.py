"""Relative curvature of two bodies: limits, invariants, and tensors added by hand."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from fingerpad.exceptions import GeometryError
from fingerpad.geometry import principal_curvatures, relative_curvature

radius = st.floats(0.1, 1000.0)
angle = st.floats(-2 * np.pi, 2 * np.pi)


def test_flat_plate() -> None:
    gap = relative_curvature((12.955, 14.330))
    assert_allclose(gap.principal_radii, [12.955, 14.330], rtol=1e-15)
    assert gap.angle == 0


def test_sphere_on_pad() -> None:
    for turn in (0.0, 0.4, 2.0):
        gap = relative_curvature((10.0, 20.0), (5.0, 5.0), angle=turn)
        assert_allclose(1 / np.array(gap.principal_radii), [0.1 + 0.2, 0.05 + 0.2], rtol=1e-14)


def test_two_spheres() -> None:
    gap = relative_curvature((6.0, 6.0), (3.0, 3.0))
    assert_allclose(gap.mean_curvature_radius, 2.0)
    assert_allclose(gap.geometric_mean_radius, 2.0)


@given(radius, radius, radius, radius, angle)
def test_sum_of_tensors(first_1, first_2, second_1, second_2, turn) -> None:
    gap = relative_curvature((first_1, first_2), (second_1, second_2), angle=turn)
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    total = (
        np.diag([1 / first_1, 1 / first_2]) + rotation @ np.diag([1 / second_1, 1 / second_2]) @ rotation.T
    )
    assert_allclose(np.sort(1 / np.array(gap.principal_radii)), np.linalg.eigvalsh(total), rtol=1e-7)
    direction = np.array([np.cos(gap.angle), np.sin(gap.angle)])
    assert_allclose(direction @ total @ direction, 1 / gap.principal_radii.first, rtol=1e-7)
    assert abs(gap.angle) <= np.pi / 4 + 1e-12


@given(radius, radius, radius, radius, angle)
def test_order_of_bodies(first_1, first_2, second_1, second_2, turn) -> None:
    one = relative_curvature((first_1, first_2), (second_1, second_2), angle=turn)
    other = relative_curvature((second_1, second_2), (first_1, first_2), angle=-turn)
    assert_allclose(np.sort(one.principal_radii), np.sort(other.principal_radii), rtol=1e-7)


def test_cylinder_across_a_pad() -> None:
    gap = relative_curvature((12.0, 14.0), (8.0, np.inf), angle=np.pi / 2)
    assert_allclose(1 / np.array(gap.principal_radii), [1 / 12, 1 / 14 + 1 / 8], rtol=1e-14)


def test_slender_gap_precision() -> None:
    assert_allclose(relative_curvature((1.0, 1e12)).principal_radii, [1.0, 1e12], rtol=1e-15)
    crossed = relative_curvature((1.0, np.inf), (np.inf, 1e17))
    assert_allclose(crossed.principal_radii, [1.0, 1e17], rtol=1e-15)


@given(st.floats(-5, 5), st.floats(-5, 5), st.floats(-5, 5))
@example(-0.0, -0.0, 1.0)
@example(-0.0, 0.0, -1.0)
def test_principal_curvatures_of_random_tensors(first, second, mixed) -> None:
    curvatures, angle = principal_curvatures(first, second, mixed)
    tensor = np.array([[first, mixed], [mixed, second]])
    assert_allclose(np.sort(curvatures), np.linalg.eigvalsh(tensor), atol=1e-12)
    direction = np.array([np.cos(angle), np.sin(angle)])
    assert_allclose(direction @ tensor @ direction, curvatures[0], atol=1e-12)
    assert abs(angle) <= np.pi / 4 + 1e-12


def test_complex_step_keeps_order() -> None:
    step = 1e-30j
    for first in (1.0, -1.0):
        up, down = (principal_curvatures(first + sign * step, first, 0.5)[0].real for sign in (1, -1))
        assert_allclose(up, [first + 0.5, first - 0.5], rtol=1e-15)
        assert_allclose(down, up, rtol=1e-15)


def test_gap_that_does_not_open() -> None:
    assert np.isnan(relative_curvature((10.0, 10.0), (-9.0, -20.0)).principal_radii).all()
    assert np.isfinite(relative_curvature((10.0, 10.0), (-12.0, -20.0)).principal_radii).all()


def test_gaps_are_judged_one_by_one() -> None:
    # A sphere on a plate; a cylinder, which touches along a line; a ball in too narrow a hollow.
    first, second = (10.0, [10.0, np.inf, 10.0]), ([np.inf, np.inf, -9.0], [np.inf, np.inf, -9.0])
    with np.errstate(divide="raise", invalid="raise"):
        radii = relative_curvature(first, second).principal_radii
    assert_allclose(radii, [[10.0, np.nan, np.nan], [10.0, np.nan, np.nan]])


def test_broadcasting() -> None:
    gap = relative_curvature((10.0, 12.0), (np.full((4, 1), 7.0), 7.0), angle=np.zeros(3))
    assert [radius.shape for radius in gap.principal_radii] == [(4, 3), (4, 3)]


@pytest.mark.parametrize("radii", [np.full((2, 2), 9.0), [[9.0, 9.0], [9.0, 9.0]], (9.0,), (9.0, 9.0, 9.0)])
def test_radii_that_are_not_two_are_refused(radii) -> None:
    with pytest.raises(
        GeometryError, match=r"second must be two principal radii, arrays as \(first, second\)"
    ):
        relative_curvature((10.0, 12.0), radii)


@pytest.mark.parametrize("bad", [0.0, np.nan])
def test_invalid_radii(bad: float) -> None:
    with pytest.raises(GeometryError, match="second body's principal radius must be a non-zero number"):
        relative_curvature((10.0, 12.0), (5.0, bad))
    with pytest.raises(GeometryError, match="angle must be .*radians"):
        relative_curvature((10.0, 12.0), (5.0, 5.0), angle=np.inf)
