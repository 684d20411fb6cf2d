"""Degrees given where radians are meant are refused; NaN is not."""

import numpy as np
import pytest

from fingerpad.contact import Tissue, solve_gap
from fingerpad.exceptions import GeometryError
from fingerpad.geometry import Counterface, Ellipsoid, Placement
from fingerpad.image import ImageEllipse, PlaneEllipse, Scale, photograph_from_ellipse
from fingerpad.simulate import outline_points, render_coin, render_contact_image
from fingerpad.uncertainty import Inputs, placement_model, propagate, run_monte_carlo

PAD = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
MEASURED = {"palmar": (7.9, 0.1), "distal": 13.8, "radial_ulnar": 11.8}
DEGREES = {
    "one wedge of several": lambda: Placement(PAD, wedge_angle=[0.5, 3.0]),
    "roll of a few degrees": lambda: Placement(PAD, wedge_angle=0.5, roll_angle=5),
    "wedge of a model": lambda: propagate(
        placement_model, Inputs.of(**MEASURED, wedge_angle=30, roll_angle=0)
    ),
    "roll of a model": lambda: run_monte_carlo(
        placement_model, Inputs.of(**MEASURED, wedge_angle=0.5, roll_angle=(10, 0.1))
    ),
    "u of a point": lambda: PAD.point(45, 1.5),
    "v of a normal": lambda: PAD.normal(0.5, 90),
    "u of a curvature": lambda: PAD.curvature(45, 1.5),
    "axis of a cylinder": lambda: Counterface.cylinder(5, axis_angle=45),
    "angle of solve_gap": lambda: solve_gap(
        lambda x, y: (x**2 + y**2) / 20, Tissue(0.1), half_widths=(3, 3), angle=30, load=1.0
    ),
    "orientation of an ellipse": lambda: ImageEllipse(centre=(1, 1), semi_axes=(9, 8), orientation=20),
    "angle of a plane ellipse": lambda: PlaneEllipse(0, 0, 9, 8, angle=45),
    "angle of outline points": lambda: outline_points(11.8, 13.8, angle=30),
    "arc of outline points": lambda: outline_points(11.8, 13.8, arc=(0, 180)),
    "tilt of a photograph": lambda: photograph_from_ellipse(
        "palmar", Scale(0.05), centre=(300, 200), semi_axes=(236, 276), tilt=12
    ),
    "orientation of a rendered contact": lambda: render_contact_image(orientation=20),
    "orientation of a rendered coin": lambda: render_coin(orientation=20),
    "tilt of a rendered coin": lambda: render_coin(tilt=10),
}


@pytest.mark.parametrize("name", DEGREES)
def test_degrees_refused(name: str) -> None:
    with pytest.raises(GeometryError, match=r"in radians; for degrees use np.radians\(30\)\), found"):
        DEGREES[name]()


def test_full_turns_accepted() -> None:
    np.testing.assert_allclose(PAD.point([2 * np.pi, -2 * np.pi, 0], 0.5)[:, 0], 7.9 * np.sin(0.5))


def radius_at(**angles) -> np.ndarray:
    return placement_model(palmar=7.9, distal=13.8, radial_ulnar=11.8, **angles)["mean_curvature_radius"]


def test_draws_about_upright_finger_accepted() -> None:
    np.testing.assert_allclose(*radius_at(wedge_angle=np.pi / 2 + np.array([-0.1, 0.1]), roll_angle=0.0))
    with pytest.raises(GeometryError):
        Placement(PAD, wedge_angle=np.pi / 2 + 0.1)


def test_a_right_angle_may_come_in_single_precision() -> None:
    right = np.radians(np.array([0, 90], np.float32))  # rounded up, beyond π/2
    placement = Placement(PAD, wedge_angle=right, roll_angle=-right)
    np.testing.assert_allclose(placement.normal, [[1, 0, 0], [0, 1, 0]], atol=1e-7)


def test_kernels_broadcast_nan() -> None:
    radius = radius_at(wedge_angle=np.array([0.5, np.nan]), roll_angle=np.array([[0.0], [np.nan]]))
    assert np.isnan(radius).tolist() == [[False, True], [True, True]]
