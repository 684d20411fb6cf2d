"""Constructors convert what they are given and refuse what cannot be, at once."""

import dataclasses
import pickle
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from fingerpad.contact import (
    ContactField,
    Counterface,
    ElasticBody,
    EllipsoidContact,
    HertzGeometry,
    HertzPressure,
    PadGap,
    hertz_contact,
    pad_contact,
    reduced_modulus,
    solve_contact,
    youngs_modulus,
)
from fingerpad.exceptions import CalibrationError, FingerpadError, GeometryError, ImageError, LoadingError
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
PADS = Ellipsoid(palmar=[7.9, 8.0], distal=13.8, radial_ulnar=11.8)
SKEW = {"first_skewness": 0.0, "second_skewness": 0.0, "flatness": 0.1}
GAP = {"first_radius": 12.0, "second_radius": 14.0, **SKEW}
PRESSURE = {"peak_pressure": 1, "semi_major": 2, "semi_minor": 1, "long_axis_angle": 0, "centre": (0, 0)}
PRESSED = {
    "gap": lambda x, y: (x**2 + y**2) / 20,
    "body": ElasticBody(reduced_modulus=0.1),
    "half_widths": (3, 3),
    "load": 1.0,
}


def press(pad=PAD, wedge_angle=0.5):
    return EllipsoidContact.of(pad, wedge_angle=wedge_angle, load=2.0, reduced_modulus=0.1, points=64)


INVALID = {
    GeometryError: [
        (lambda: Ellipsoid(palmar=-7.9, distal=13.8, radial_ulnar=11.8), "palmar .*found -7"),
        (lambda: Ellipse(5.0, 7.4), "semi_minor must be no longer"),
        (lambda: HertzGeometry([12, -1], 14), "first_radius .*found -1 at index 1"),
        (lambda: dataclasses.replace(PAD, distal=0), "distal"),
        (lambda: Ellipsoid("a", 13.8, 11.8), "palmar must be numbers, found 'a'"),
        (lambda: Ellipsoid("7.9", 13.8, 11.8), "palmar must be numbers, found '7.9'"),
        (lambda: Ellipsoid([7.9, 8], [13, 14, 15], 11.8), r"palmar \(2,\), distal \(3,\), rad"),
        (lambda: Ellipse([[7], [7, 8]], 5), "semi_major must be numbers"),
        (lambda: HertzGeometry([12, 13], [14, 15, 16]), r"second_radius \(3,\)"),
        (lambda: HertzGeometry(12, "x"), "second_radius must be numbers, found 'x'"),
        (lambda: Placement(PADS, wedge_angle=[0.1, 0.2, 0.3]), r"ellipsoid \(2,\), wedge_angle \(3"),
        (lambda: Placement(PAD, wedge_angle=[0.1, 0.2], roll_angle=[0, 0, 0]), r"roll_angle \(3,\)"),
        (lambda: Placement(PAD, wedge_angle="a"), "wedge_angle must be numbers, found 'a'"),
        (lambda: ElasticBody(reduced_modulus=-1), "reduced_modulus must be positive and finite, fou"),
        (lambda: ElasticBody(reduced_modulus=np.nan), "reduced_modulus must be positive and finite"),
        (lambda: ElasticBody(reduced_modulus="a"), "reduced_modulus must be numbers, found 'a'"),
        (lambda: ElasticBody(reduced_modulus=[1, 2]), r"reduced_modulus must be one number, .*\(2,\)"),
        (lambda: ElasticBody(reduced_modulus=1, thickness=0), "thickness must be positive, found 0"),
        (lambda: ElasticBody(reduced_modulus=1, thickness=5, poisson_ratio=0.7), "poisson_ratio .*0.7"),
        (lambda: Counterface(radius=0), "radius must be positive, found 0"),
        (lambda: Counterface(radius=np.nan), "radius must be positive, found nan"),
        (lambda: Counterface(radius=-5), "radius must be positive, found -5"),
        (lambda: Counterface(radius=5, axis_angle=np.nan), "axis_angle must be finite"),
        (lambda: PadGap(**GAP | {"first_radius": -1}), "first_radius must be positive, found -1"),
        (lambda: PadGap(**GAP | {"second_radius": 0}), "second_radius must be positive, found 0"),
        (lambda: PadGap(**GAP | {"flatness": "x"}), "flatness must be numbers, found 'x'"),
        (lambda: PadGap.paraboloid([1, 2], [1, 2, 3]), r"first_radius \(2,\)"),
        (lambda: PadGap.of(PADS, wedge_angle=[0.1, 0.2, 0.3]), r"pad \(2,\), wedge_angle \(3,\)"),
        (lambda: HertzPressure(**PRESSURE | {"peak_pressure": 0}), "peak_pressure must be positive"),
        (lambda: HertzPressure(**PRESSURE | {"semi_minor": 3}), "semi_minor must be no longer"),
        (lambda: HertzPressure(**PRESSURE | {"centre": 0.0}), "centre must be two finite coord"),
        (lambda: solve_contact(**PRESSED | {"half_widths": (3, 0)}), "half_widths must be two posit"),
        (lambda: press(wedge_angle=3), "wedge_angle must be between 0 and π/2 .*found 3"),
        (lambda: press(wedge_angle=np.nan), "wedge_angle must be finite"),
        (lambda: press(wedge_angle=[0.1, 0.2]), r"one pad in one placement .*found shape \(2,\)"),
        (lambda: press(pad=PADS), r"one pad in one placement .*found shape \(2,\): loop"),
        (lambda: press(pad=(7.9, 13.8, 11.8)), "ellipsoid must be an Ellipsoid, found tuple"),
        (lambda: ContactField.of_hertz(PAD, wedge_angle=3, load=1, reduced_modulus=1), "wedge_angle"),
    ],
    LoadingError: [
        (lambda: LoadingCurve(load=[0, 1], indentation=[0]), "indentation has shape"),
        (lambda: LoadingCurve(load=[0, np.nan], indentation=[0, 1]), "load is not finite"),
        (lambda: ForceSignal([0, 0], [0, 1]), "time must increase"),
        (lambda: ForceSignal([0, 1], [0, 1, 2]), "load must be a row of 2"),
        (lambda: FrameStamps([1, 0]), "must increase"),
        (lambda: FrameRate(0), "frames_per_second must be positive"),
        (lambda: FrameRate(500, anchor_time=np.nan), "anchor_time must be finite"),
    ],
    CalibrationError: [
        (lambda: Scale(0), "mm_per_px must be positive"),
        (lambda: Scale(500), "mm_per_px must be between"),
    ],
}


@pytest.mark.parametrize(
    ("error", "make", "message"), [(error, *row) for error, rows in INVALID.items() for row in rows]
)
def test_invalid_values(error, make, message) -> None:
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
