"""The ellipsoid and the plane ellipse: limits, invariants, and curvature by independent routes."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Ellipse, Ellipsoid
from fingerpad.geometry.curvature import principal_curvatures
from fingerpad.geometry.placement import platen_normal

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


def test_radii_on_equator() -> None:
    a, b, c = 7.9, 13.8, 11.8
    u = np.radians([0, 30, 45, 60, 90])
    S = b**2 * np.cos(u) ** 2 + a**2 * np.sin(u) ** 2
    curvature = PAD.curvature(u, np.pi / 2)
    assert_allclose(curvature.in_plane_radius, S**1.5 / (a * b), rtol=1e-14)
    assert_allclose(curvature.transverse_radius, c**2 * np.sqrt(S) / (a * b), rtol=1e-14)
    assert_allclose(curvature.principal_directions[:, 1], np.broadcast_to([0, 0, 1], (5, 3)), atol=1e-15)


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


@pytest.mark.parametrize("bad", [0, -1.0, np.nan, np.inf])
@pytest.mark.parametrize("name", ["palmar", "distal", "radial_ulnar"])
def test_invalid_axes(name: str, bad: float) -> None:
    axes = {"palmar": 7.9, "distal": 13.8, "radial_ulnar": 11.8} | {name: bad}
    with pytest.raises(GeometryError, match=f"semi-axis {name} must be positive and finite, found"):
        Ellipsoid(**axes)


def test_published_ellipses() -> None:
    ellipse = Ellipse([5.3, 7.4], [4.2, 5.0])
    assert_allclose(ellipse.eccentricity, [0.6099332, 0.7371990], atol=6e-8)
    assert_allclose(ellipse.area, [69.93, 116.24], atol=5e-3)


@pytest.mark.parametrize(
    ("axes", "message"),
    [
        ((4.0, 5.0), "semi_minor must be no longer than semi_major .*, found 5"),
        ((0.0, 0.0), "semi_major must be positive and finite, found 0"),
        ((5.0, -1.0), "semi_minor must be positive and finite, found -1"),
        ((np.nan, 1.0), "semi_major must be positive and finite, found nan"),
        ((np.inf, 1.0), "semi_major must be positive and finite, found inf"),
        (([5.0, 5.0], [4.0, 6.0]), "found 6 at index 1"),
    ],
)
def test_invalid_ellipses(axes, message: str) -> None:
    with pytest.raises(GeometryError, match=message):
        Ellipse(*axes)


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
