"""Constructors convert what they are given and refuse what cannot be, at once."""

import dataclasses
import pickle
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from fingerpad.contact import HertzGeometry, hertz_contact, pad_contact, reduced_modulus, youngs_modulus
from fingerpad.exceptions import (
    CalibrationError,
    FingerpadError,
    GeometryError,
    ImageError,
    LoadingError,
)
from fingerpad.geometry import Ellipse, Ellipsoid, Placement, relative_curvature
from fingerpad.image import (
    ForceSignal,
    FrameRate,
    FrameStamps,
    Scale,
    measure_coin,
    measure_contact_image,
    measure_photograph,
    read_image,
)
from fingerpad.loading import LoadingCurve, read_loading_curve
from fingerpad.simulate import render_coin, render_contact_image, render_finger
from fingerpad.uncertainty import (
    Inputs,
    pad_model,
    propagate,
)

PAD = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda: Ellipsoid(palmar=-7.9, distal=13.8, radial_ulnar=11.8), GeometryError, "palmar .*found -7"),
        (lambda: Ellipse(5.0, 7.4), GeometryError, "semi_minor must be no longer"),
        (lambda: HertzGeometry([12, -1], 14), GeometryError, "first_radius .*found -1 at index 1"),
        (lambda: LoadingCurve(load=[0, 1], indentation=[0]), LoadingError, "indentation has shape"),
        (lambda: LoadingCurve(load=[0, np.nan], indentation=[0, 1]), LoadingError, "load is not finite"),
        (lambda: ForceSignal([0, 0], [0, 1]), LoadingError, "time must increase"),
        (lambda: ForceSignal([0, 1], [0, 1, 2]), LoadingError, "load must be a row of 2"),
        (lambda: FrameStamps([1, 0]), LoadingError, "must increase"),
        (lambda: FrameRate(0), LoadingError, "frames_per_second must be positive"),
        (lambda: FrameRate(500, anchor_time=np.nan), LoadingError, "anchor_time must be finite"),
        (lambda: Scale(0), CalibrationError, "mm_per_px must be positive"),
        (lambda: Scale(500), CalibrationError, "mm_per_px must be between"),
        (lambda: dataclasses.replace(PAD, distal=0), GeometryError, "distal"),
    ],
)  # fmt: skip
def test_invalid_values(make, error, message) -> None:
    with pytest.raises(error, match=message):
        make()


def test_lists_become_float_arrays() -> None:
    curve = LoadingCurve(load=[0, 1, 2], indentation=[0, 1, 2], time=[0, 1, 2])
    assert curve.load.dtype == curve.time.dtype == float
    assert curve.area is None
    assert curve.clock.tolist() == [0, 1, 2]
    signal = ForceSignal([0, 1], [0, 2], trigger=[0, 5])
    assert signal.trigger.dtype == float
    assert signal.load_at([0.5]).tolist() == [1]


def test_pickle_and_replace() -> None:
    placement = Placement(PAD, wedge_angle=[0.4, 0.5])
    for one in (PAD, placement, HertzGeometry(12, [14, 15]), ForceSignal([0, 1], [0, 1])):
        again = pickle.loads(pickle.dumps(one))
        assert repr(again) == repr(one)
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(one, dataclasses.fields(one)[0].name, 1)
    moved = dataclasses.replace(placement, wedge_angle=0.5, roll_angle=0.0)
    np.testing.assert_array_equal(moved.point, placement.point[1])


def test_monte_carlo_draws_accepted() -> None:
    inputs = {
        "distal": 13.8,
        "radial_ulnar": 11.8,
        "wedge_angle": 0.5,
        "poisson_ratio": 0.5,
        "image_scale": 1.0,
        "edge_offset": 0.0,
    }
    inputs |= {"load": 2.0, "contact_radius": 6.0, "elongation": 0.3}
    draws = pad_model(palmar=np.array([7.9, np.nan]), roll_angle=np.array([9.0, 0.0]), **inputs)
    assert np.isnan(draws["indentation"]).tolist() == [False, True]


SCALARS = {
    "palmar": lambda: PAD.palmar,
    "axis ratio": lambda: Ellipse(7.4, 5).axis_ratio,
    "semi-major": lambda: Ellipse(7.4, 5).semi_major,
    "wedge": lambda: Placement(PAD, wedge_angle=0.5).wedge_angle,
    "u": lambda: Placement(PAD, wedge_angle=0.5).u,
    "in-plane radius": lambda: Placement(PAD, wedge_angle=0.5).curvature.in_plane_radius,
    "angle": lambda: relative_curvature((10, 12), (8, 9), angle=0.3).angle,
    "parametric angle": lambda: PAD.parametric_angles([1.0, 0, 0])[0],
    "load": lambda: hertz_contact(12, 14, 2, reduced_modulus=0.1).load,
    "indentation": lambda: hertz_contact(12, 14, 2, reduced_modulus=0.1).indentation,
    "stiffness": lambda: hertz_contact(12, 14, 2, reduced_modulus=0.1).stiffness,
    "K": lambda: HertzGeometry(12, 14).K,
    "long axis": lambda: HertzGeometry(12, 14).long_axis,
    "at area": lambda: HertzGeometry(12, 14).at_area(80, reduced_modulus=0.1).semi_minor,
    "modulus from area": lambda: HertzGeometry(12, 14).reduced_modulus_from_area(2, 80),
    "reduced modulus": lambda: reduced_modulus(0.1),
    "Young's modulus": lambda: youngs_modulus(0.1),
    "estimate": lambda: (
        propagate(lambda load: {"double": 2 * load}, Inputs.of(load=(2, 0.1)))["double"].value
    ),
    "uncertainty": lambda: propagate(lambda load: {"double": load}, Inputs.of(load=(2, 0.1)))["double"].std,
    "load at a time": lambda: ForceSignal([0, 1], [0, 1]).load_at(0.5),
    **{
        f"{name} of pad_contact": lambda name=name: getattr(
            pad_contact(PAD, wedge_angle=0.5, load=2, semi_major=7.4, semi_minor=5), name
        )
        for name in ("indentation", "mean_pressure", "predicted_elongation", "radius_from_indentation")
    },
}


@pytest.mark.parametrize("name", SCALARS)
def test_scalars_in_scalars_out(name: str) -> None:
    assert isinstance(SCALARS[name](), float)


def test_image_arguments(tmp_path: Path) -> None:
    truth = render_contact_image(semi_major=5.0, semi_minor=4.0, ppi=250, seed=2)
    path = tmp_path / "contact.png"
    Image.fromarray(truth.pixels).save(path)
    scale = Scale.of_ppi(250)
    wanted = measure_contact_image(truth.pixels, scale).as_record()
    for image in (path, str(path), read_image(path)):
        assert measure_contact_image(image, scale.mm_per_px).as_record() == wanted
    with pytest.raises(ImageError, match="no such file"):
        measure_contact_image(str(tmp_path / "none.png"), scale)
    with pytest.raises(CalibrationError, match="mm_per_px must be between .*found 500"):
        measure_contact_image(path, 500)


def test_photograph_and_coin_by_path(tmp_path: Path) -> None:
    truth = render_finger("palmar", semi_axes=(11.8, 13.8), mm_per_px=0.1, seed=1)
    path = tmp_path / "finger.png"
    Image.fromarray(truth.pixels).save(path)
    found = measure_photograph(str(path), "palmar", 0.1)
    same = measure_photograph(truth.pixels, "palmar", Scale(0.1))
    assert found.semi_axes_mm == same.semi_axes_mm
    coin = render_coin(seed=1)
    Image.fromarray(coin.pixels).save(tmp_path / "coin.png")
    assert measure_coin(str(tmp_path / "coin.png")) == measure_coin(coin.pixels)


def test_loading_curve_by_path(tmp_path: Path) -> None:
    path = tmp_path / "curve.csv"
    path.write_text("force_N,displacement_mm\n0,0\n1,1\n", encoding="utf-8")
    assert read_loading_curve(str(path)).load.tolist() == [0, 1]
    with pytest.raises(FingerpadError, match="none.csv"):
        read_loading_curve(str(tmp_path / "none.csv"))
