"""The radius of curvature that side faces show, beside the ellipsoid's."""

import numpy as np
import pytest

from fingerpad.geometry import Ellipsoid, Placement
from fingerpad.study.manifest.models import Finger
from fingerpad.study.measuring.fingers import FingerResult
from fingerpad.study.results.rows import _curvature_disagrees, _outline_radii

AXES = np.array([7.9, 13.8, 11.8])


def finger(*sides, std=0.1):
    return FingerResult(
        manifest=Finger(name="f"),
        semi_axes=AXES,
        covariance=std**2 * np.eye(3),
        source="photographs",
        outline_radii=tuple(filter(None, sides)),
    )


def radius_along(axes, wedge_deg=30.0):
    return float(Placement(Ellipsoid(*axes), wedge_angle=np.radians(wedge_deg)).curvature.in_plane_radius)


def test_radii_are_interpolated_between_wedges_and_never_beyond():
    pad = finger(((30.0, 12.0, 1.0), (35.0, 10.0, 1.0)))
    assert pad.outline_radius(30) == pytest.approx((12, 1))
    assert 10 < pad.outline_radius(32)[0] < 12
    assert np.isnan(pad.outline_radius(36)).all()
    assert np.isnan(finger(()).outline_radius(30)).all()


def test_side_faces_are_averaged_by_their_relative_uncertainties():
    radius, std = finger(((30.0, 12.0, 0.6),), ((30.0, 14.0, 1.4),)).outline_radius(30)
    assert radius == pytest.approx(np.exp(0.8 * np.log(12) + 0.2 * np.log(14)))
    assert std / radius == pytest.approx(1 / np.sqrt(20**2 + 10**2))


def test_the_ellipsoids_radius_is_as_uncertain_as_its_semi_axes_make_it():
    slopes = [(radius_along(AXES + step) - radius_along(AXES - step)) / 0.002 for step in np.eye(3) * 0.001]
    assert finger().in_plane_radius_std(30) == pytest.approx(0.1 * np.linalg.norm(slopes), rel=1e-5)


def test_the_pads_radius_lies_between_ellipsoid_and_outline_and_near_the_latter_where_they_disagree():
    true = radius_along(AXES)
    agrees, differs = (finger(((30.0, factor * true, 0.06 * true),)) for factor in (1.02, 1.4))
    along, along_std, across_std = agrees.shape_deviation(30, 0)
    assert 0 < along < np.log(1.02)
    assert along_std < 0.06 < across_std
    along, along_std, _ = differs.shape_deviation(30, 0)
    assert 0.9 * np.log(1.4) < along < np.log(1.4)
    own = differs.in_plane_radius_std(30) / true
    assert np.hypot(along_std, own) == pytest.approx(0.06 / 1.4, rel=0.1)
    # Where no outline shows the place, nothing moves, and more is open than where none was looked at.
    assert differs.shape_deviation(30, 5)[:2] == (0.0, pytest.approx(0.1))
    assert differs.shape_deviation(60, 0)[:2] == (0.0, pytest.approx(0.2))
    manifest = Finger(name="f")
    given = FingerResult(manifest=manifest, semi_axes=AXES, covariance=np.eye(3), source="given")
    assert given.shape_deviation(30, 0) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(("roll", "factor", "disagrees"), [(0, 1.0, False), (0, 1.4, True), (5, 1.4, False)])
def test_a_radius_that_disagrees_is_noted_where_the_plane_is_seen(roll, factor, disagrees):
    true = radius_along(AXES)
    pads = [finger(((30.0, factor * true, 0.05 * true),))]
    row = {
        "wedge_angle_deg": np.array([30.0]),
        "roll_angle_deg": np.array([float(roll)]),
        "in_plane_radius_mm": np.array([true]),
    }
    row |= _outline_radii(row, pads)
    assert np.isnan(row["outline_radius_mm"]).all() == (roll != 0)
    assert _curvature_disagrees(row, pads).tolist() == [disagrees]
