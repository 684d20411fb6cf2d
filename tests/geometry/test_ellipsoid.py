"""The ellipsoid and the plane ellipse: limits, invariants, and curvature by independent routes."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Counterface, Ellipsoid, Placement
from fingerpad.geometry.curvature import principal_curvatures
from fingerpad.geometry.placement import platen_normal
from fingerpad.uncertainty import placement_model

PAD = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
axis = st.floats(1.0, 50.0)
u_angle = st.floats(-np.pi, np.pi)
v_angle = st.floats(0.0, np.pi)


def fundamental_form_curvatures(axes: tuple[float, float, float], u: float, v: float) -> tuple[float, float]:
    """Return mean and Gaussian curvature from the first and second fundamental forms."""
    a, b, c = axes
    r_u = np.array([-a * np.sin(u) * np.sin(v), b * np.cos(u) * np.sin(v), 0])
    r_v = np.array([a * np.cos(u) * np.cos(v), b * np.sin(u) * np.cos(v), -c * np.sin(v)])
    r_uu = np.array([-a * np.cos(u) * np.sin(v), -b * np.sin(u) * np.sin(v), 0])
    r_uv = np.array([-a * np.sin(u) * np.cos(v), b * np.cos(u) * np.cos(v), 0])
    r_vv = -np.array([a * np.cos(u) * np.sin(v), b * np.sin(u) * np.sin(v), c * np.cos(v)])
    normal = np.cross(r_v, r_u)
    normal /= -np.linalg.norm(normal)
    E, F, G = r_u @ r_u, r_u @ r_v, r_v @ r_v
    L, M, N = r_uu @ normal, r_uv @ normal, r_vv @ normal
    sign = -1.0 if L + N > 0 else 1.0
    determinant = E * G - F**2
    return -sign * -(E * N - 2 * F * M + G * L) / (2 * determinant), (L * N - M**2) / determinant


@given(axis, axis, axis, u_angle, st.floats(0.05, np.pi - 0.05))
def test_curvatures_from_fundamental_forms(a: float, b: float, c: float, u: float, v: float) -> None:
    curvature = Ellipsoid(a, b, c).curvature(u, v)
    mean, gaussian = fundamental_form_curvatures((a, b, c), u, v)
    assert_allclose(curvature.mean_curvature, abs(mean), rtol=1e-8)
    assert_allclose(curvature.gaussian_curvature, gaussian, rtol=1e-8)


@given(axis, axis, axis, u_angle, v_angle)
def test_principal_directions_are_orthonormal_tangents(a, b, c, u, v) -> None:
    pad = Ellipsoid(a, b, c)
    normal = pad.normal(u, v)
    first, second = pad.curvature(u, v).principal_directions
    frame = np.stack([normal, first, second])
    assert_allclose(frame @ frame.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(frame) > 0


def test_radii_at_poles() -> None:
    a, b, c = 7.9, 13.8, 11.8
    # Normals +x, +y and +z; in-plane radius first (along the finger), transverse second.
    radii = PAD.curvature_at_normal(np.eye(3)).principal_radii
    assert_allclose(radii.first, [b**2 / a, a**2 / b, b**2 / c], rtol=1e-14)
    assert_allclose(radii.second, [c**2 / a, c**2 / b, a**2 / c], rtol=1e-14)


@given(axis, axis, axis, u_angle, v_angle)
def test_contact_point_inverts_normal(a, b, c, u, v) -> None:
    pad = Ellipsoid(a, b, c)
    normal = pad.normal(u, v)
    assert_allclose(pad.contact_point(normal), pad.point(u, v), atol=1e-9)
    assert_allclose(pad.point(*pad.parametric_angles(normal)), pad.point(u, v), atol=1e-9)


def test_finger_axis_when_rolled_on_side() -> None:
    # Nothing jumps where the normal passes the side of the finger.
    radii = PAD.curvature_at_normal(platen_normal(np.array([0.0, 1e-5, 1e-3]), np.pi / 2)).principal_radii
    assert_allclose(radii.first, 13.8**2 / 11.8, rtol=1e-4)
    assert_allclose(radii.second, 7.9**2 / 11.8, rtol=1e-4)


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


# Placement on the wedge: printed reference numbers, limits, and symmetry under roll


@pytest.mark.parametrize(
    ("axes", "wedge", "u", "in_plane", "transverse", "mean", "geometric"),
    [
        ((7.9, 13.8, 11.8), 30, 45.243495, 12.955, 14.330, 13.607666, 13.625),
        ((7.9, 13.8, 11.8), 45, 60.210426, 8.361, 12.384, 9.982357, 10.175),
        ((7.5, 14.7, 11.8), 30, 48.532988, 12.880, 14.196, 13.506019, 13.522),
        ((7.5, 14.7, 11.8), 45, 62.969140, 7.650, 11.932, 9.322567, 9.554),
    ],
)
def test_reference_numbers(axes, wedge, u, in_plane, transverse, mean, geometric) -> None:
    placement = Placement(Ellipsoid(*axes), wedge_angle=np.radians(wedge))
    curvature = placement.curvature
    assert_allclose(np.degrees(placement.u), u, atol=5e-7)
    assert_allclose(np.degrees(placement.v), 90, rtol=1e-15)
    assert_allclose(
        [curvature.in_plane_radius, curvature.transverse_radius], [in_plane, transverse], atol=6e-4
    )
    assert_allclose(curvature.mean_curvature_radius, mean, atol=6e-7)
    assert_allclose(curvature.geometric_mean_radius, geometric, atol=6e-4)


def test_roll_by_right_angle() -> None:
    placement = Placement(PAD, wedge_angle=0.0, roll_angle=np.pi / 2)
    assert_allclose(placement.point, [0, 0, 11.8], atol=1e-14)
    assert_allclose(placement.v, 0, atol=1e-15)


@given(st.floats(0, np.pi / 2), st.floats(-1.5, 1.5))
def test_roll_symmetry_and_tangency(wedge: float, roll: float) -> None:
    left, right = (Placement(PAD, wedge_angle=wedge, roll_angle=side * roll) for side in (-1, 1))
    assert_allclose(left.curvature.principal_radii, right.curvature.principal_radii, rtol=1e-12)
    assert_allclose(left.point, right.point * [1, 1, -1], atol=1e-12)
    assert_allclose(np.linalg.norm(right.normal), 1, rtol=1e-14)
    assert_allclose(right.normal[1], np.sin(wedge), rtol=1e-14)  # rolling does not change the wedge's angle
    # The platen touches at one point only: no other point of the pad lies further out.
    u, v = np.meshgrid(np.linspace(-np.pi, np.pi, 40), np.linspace(0, np.pi, 20))
    assert (PAD.point(u, v) @ right.normal).max() <= right.point @ right.normal + 1e-12


def test_a_sphere_adds_its_curvature_in_each_direction() -> None:
    flat = Placement(PAD, wedge_angle=0.5, roll_angle=0.3).gap
    against = Placement(PAD, wedge_angle=0.5, roll_angle=0.3, counterface=Counterface.sphere(20.0)).gap
    found = sorted([1 / against.first_radius, 1 / against.second_radius])
    assert_allclose(found, sorted([1 / flat.first_radius + 1 / 20, 1 / flat.second_radius + 1 / 20]))


def test_full_turns_accepted() -> None:
    assert_allclose(PAD.point([2 * np.pi, -2 * np.pi, 0], 0.5)[:, 0], 7.9 * np.sin(0.5))


def radius_at(**angles) -> np.ndarray:
    return placement_model(palmar=7.9, distal=13.8, radial_ulnar=11.8, **angles)["mean_curvature_radius"]


def test_draws_about_upright_finger_accepted() -> None:
    assert_allclose(*radius_at(wedge_angle=np.pi / 2 + np.array([-0.1, 0.1]), roll_angle=0.0))
    with pytest.raises(GeometryError):
        Placement(PAD, wedge_angle=np.pi / 2 + 0.1)


def test_a_right_angle_may_come_in_single_precision() -> None:
    right = np.radians(np.array([0, 90], np.float32))  # rounded up, beyond π/2
    placement = Placement(PAD, wedge_angle=right, roll_angle=-right)
    assert_allclose(placement.normal, [[1, 0, 0], [0, 1, 0]], atol=1e-7)


def test_kernels_broadcast_nan() -> None:
    radius = radius_at(wedge_angle=np.array([0.5, np.nan]), roll_angle=np.array([[0.0], [np.nan]]))
    assert np.isnan(radius).tolist() == [[False, True], [True, True]]
