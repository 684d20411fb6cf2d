"""Constructors convert what they are given and refuse what cannot be, at once."""

import dataclasses
import pickle
from functools import partial
from pathlib import Path

import numpy as np
import pytest
import tifffile
from PIL import Image

from fingerpad import exceptions
from fingerpad._arrays import as_float_array
from fingerpad.contact import (
    Tissue,
    equivalent_radius_from_area,
    equivalent_radius_from_compliance,
    equivalent_radius_from_indentation,
    fast_contact,
    hertz_contact,
    indentation_factor,
    size_factor,
    solve_gap,
    youngs_modulus,
)
from fingerpad.geometry import Counterface, Ellipse, Ellipsoid, Gap, Paraboloid, Placement
from fingerpad.image import (
    BrushStroke,
    FaceSemiAxes,
    ForceSignal,
    Frame,
    FrameRate,
    Grid,
    ImageEllipse,
    PhaseIntervals,
    Picture,
    PlaneEllipse,
    RegionPolygon,
    Scale,
    estimate_settings,
    measure_coin,
    measure_contact_image,
    measure_frames,
    measure_photograph,
    measure_sequence,
    open_frames,
    photograph_from_ellipse,
    prepare_contact_image,
    read_image,
    scan_texture,
)
from fingerpad.loading import LoadingCurve, read_loading_curve, secant_modulus
from fingerpad.simulate import (
    outline_points,
    render_coin,
    render_contact_image,
    render_finger,
    render_sequence,
)
from fingerpad.uncertainty import (
    Inputs,
    pad_model,
    placement_model,
    pool,
    pool_random_effects,
    propagate,
    run_monte_carlo,
)

PAD = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
PADS = Ellipsoid(palmar=[7.9, 8.0], distal=13.8, radial_ulnar=11.8)
GAP = {"second_radius": 14.0, "first_skewness": 0.0, "second_skewness": 0.0, "flatness": 0.1, "angle": 0.0}
GRID = {"spacing_mm": 1, "spacing_mm_std": 0, "homography": np.eye(3)}
FACE = {"face": "palmar", "semi_axes": (11.8, 13.8), "covariance": 0.01 * np.eye(2)}
GAP_TO_SOLVE = {"gap": lambda x, y: (x**2 + y**2) / 20, "tissue": Tissue(0.1), "load": 1.0}
STROKE = {"action": "add", "points": [(9, 9)], "radius": 2}
CENTRE = {"centre": (9, 9)}
MASKED = np.ma.masked_array([10.0, 999.0, 12.0], mask=[False, True, False])
AGAINST_A_BALL = Placement(PAD, wedge_angle=0.5, counterface=Counterface.sphere(10.0))
PLACED, SOFT, BODIES = Placement(PAD, wedge_angle=0.5), Tissue(0.1), Paraboloid(12, 14)


LENGTHS = {"palmar": (7.9, 0.1), "distal": 13.8, "radial_ulnar": 11.8}
# Calls with an angle in degrees.
DEGREES = [
    lambda: Placement(PAD, wedge_angle=[0.5, 3.0]),
    lambda: Placement(PAD, wedge_angle=0.5, roll_angle=5),
    lambda: propagate(placement_model, Inputs.of(**LENGTHS, wedge_angle=30, roll_angle=0)),
    lambda: run_monte_carlo(placement_model, Inputs.of(**LENGTHS, wedge_angle=0.5, roll_angle=(10, 0.1))),
    lambda: PAD.point(45, 1.5),
    lambda: PAD.normal(0.5, 90),
    lambda: PAD.curvature(45, 1.5),
    lambda: Counterface.cylinder(5, axis_angle=45),
    lambda: solve_gap(lambda x, y: (x**2 + y**2) / 20, Tissue(0.1), half_widths=(3, 3), angle=30, load=1.0),
    lambda: ImageEllipse(centre=(1, 1), semi_axes=(9, 8), orientation=20),
    lambda: PlaneEllipse(0, 0, 9, 8, angle=45),
    lambda: outline_points(11.8, 13.8, angle=30),
    lambda: outline_points(11.8, 13.8, arc=(0, 180)),
    lambda: photograph_from_ellipse("palmar", Scale(0.05), centre=(300, 200), semi_axes=(236, 276), tilt=12),
    lambda: render_contact_image(orientation=20),
    lambda: render_coin(orientation=20),
    lambda: render_coin(tilt=10),
]


INVALID = {
    exceptions.ImageError: [
        (lambda: ImageEllipse(**CENTRE, semi_axes=(-1, 2)), r"larger first, found \(-1, 2\)"),
        (lambda: ImageEllipse(**CENTRE, semi_axes=(60, 80)), "larger first"),
        (lambda: BrushStroke(**STROKE | {"action": "paint"}), "a stroke must add or remove, found 'paint'"),
        (lambda: BrushStroke(**STROKE | {"radius": -2}), "radius of a stroke must be positive"),
        (lambda: RegionPolygon(action="add", points=[(9, 9)]), r"3 or more, found shape \(1, 2\)"),
        (lambda: RegionPolygon(action="smear", points=[(9, 9)] * 3), "remove or replace, found 'smear'"),
        (lambda: Picture(pixels="abc", dots_per_inch=500), "pixels must be grey"),
        (lambda: Picture(pixels=np.zeros((2, 2, 2)), dots_per_inch=500), r"found shape \(2, 2, 2\)"),
    ],
    exceptions.FitError: [
        (lambda: FaceSemiAxes(**FACE | {"face": "top"}), "face must be one of palmar.*found 'top'"),
        (lambda: FaceSemiAxes(**FACE | {"semi_axes": (-1, 2)}), "palmar face: semi_axes must be two pos"),
    ],
    exceptions.GeometryError: [
        *((make, r"in radians; for degrees use np.radians\(30\)\), found") for make in DEGREES),
        *(
            (partial(dataclasses.replace, PAD, **{name: bad}), f"semi-axis {name} must be positive")
            for name in ("palmar", "distal", "radial_ulnar")
            for bad in (0, -1.0, np.nan, np.inf)
        ),
        (lambda: Ellipse(4.0, 5.0), "semi_minor must be no longer than semi_major .*, found 5"),
        (lambda: Ellipse(0.0, 0.0), "semi_major must be positive and finite, found 0"),
        (lambda: Ellipse(5.0, -1.0), "semi_minor must be positive and finite, found -1"),
        (lambda: Ellipse(np.inf, 1.0), "semi_major must be positive and finite, found inf"),
        (lambda: Ellipse([5.0, 5.0], [4.0, 6.0]), "found 6 at index 1"),
        (lambda: Placement(PAD, wedge_angle=-1e-9), "wedge_angle must be between 0 and π/2 .*, found"),
        (lambda: Placement(PAD, wedge_angle=np.radians(90.001)), "wedge_angle must be between 0 and π/2"),
        (lambda: Placement(PAD, wedge_angle=np.nan), "wedge_angle must be finite"),
        (lambda: Placement(PAD, wedge_angle=0.5, roll_angle=-np.inf), "roll_angle must be"),
        (lambda: Placement((7.9, 13.8, 11.8), wedge_angle=0.5), "must be an Ellipsoid, found tuple"),
        (lambda: Tissue(0.0), "youngs_modulus must be positive and finite, found 0"),
        (lambda: Tissue([1.0, np.nan]), "youngs_modulus must be .*, found nan at index 1"),
        (lambda: Tissue(1.0, thickness=-2.0), "thickness must be positive, found -2"),
        (lambda: Tissue(1.0, thickness=np.nan), "thickness must be positive, found nan"),
        (lambda: Tissue(1.0, poisson_ratio=0.51), r"poisson_ratio must be within .*0.5\], found 0.51"),
        (lambda: Tissue([1.0, 2.0], thickness=[1.0, 2.0, 3.0]), "shapes must broadcast"),
        (lambda: fast_contact(AGAINST_A_BALL, SOFT, load=1.0), "flat plate"),
        (lambda: youngs_modulus(PLACED, load=2.0), "exactly one"),
        (lambda: youngs_modulus(PLACED, load=2.0, area=110.0, indentation=2.0), "exactly one"),
        (lambda: youngs_modulus(PLACED, load=2, area=110, thickness=-8), "thickness must be .* found -8"),
        (lambda: PlaneEllipse(0, 0, -1, 2), "semi_x must be positive and finite, found -1"),
        (lambda: PlaneEllipse(0, np.nan, 1, 2), "y must be finite, found nan"),
        (lambda: ImageEllipse(**CENTRE, semi_axes=(9, 8), orientation=np.nan), "orientation must be finite"),
        (lambda: render_sequence([0.0, 0.1], ppi=-1), "ppi must be positive and finite, found -1"),
        (lambda: Paraboloid([12, -1], 14), "first_radius .*found -1 at index 1"),
        (lambda: Ellipsoid("a", 13.8, 11.8), "palmar must be numeric, found 'a'"),
        (lambda: Ellipse([[7], [7, 8]], 5), "semi_major must be numeric"),
        (lambda: Paraboloid([12, 13], [14, 15, 16]), r"second_radius \(3,\)"),
        (lambda: Placement(PADS, wedge_angle=[0.1, 0.2, 0.3]), r"ellipsoid \(2,\), wedge_angle \(3"),
        (lambda: Placement(PAD, wedge_angle=[0.1, 0.2], roll_angle=[0, 0, 0]), r"roll_angle \(3,\)"),
        (lambda: Tissue("a"), "youngs_modulus must be numeric, found 'a'"),
        (lambda: Tissue.of_reduced_modulus(-1), "youngs_modulus must be positive and finite, found -0.75"),
        (lambda: Counterface(radius=0), "radius must be positive, found 0"),
        (lambda: Counterface(radius=np.nan), "radius must be positive, found nan"),
        (lambda: Counterface.cylinder(1.0, axis_angle=np.nan), "axis_angle must be finite, found nan"),
        (lambda: Ellipsoid(MASKED, 12.0, 13.0), "found nan"),
        (lambda: Tissue(MASKED), "found nan"),
        (lambda: Gap(first_radius=-1, **GAP), "first_radius must be positive, found -1"),
        (lambda: Gap(first_radius=12, **GAP | {"second_radius": 0}), "second_radius must be positive"),
        (lambda: solve_gap(**GAP_TO_SOLVE, half_widths=(3, 0)), "half_widths must be two posit"),
    ],
    exceptions.LoadingError: [
        (lambda: LoadingCurve(load=[], indentation=[]), "needs one row or more, found none"),
        (lambda: LoadingCurve(load=["a"], indentation=[0]), r"load must be numeric, found \['a'\]"),
        (lambda: LoadingCurve(load=MASKED, indentation=np.arange(3.0)), "load is not finite in row 2"),
        (lambda: ForceSignal([0, 1], ["a", "b"]), "load must be numeric"),
        (lambda: FrameRate("a"), "frames_per_second must be numeric, found 'a'"),
        (lambda: FrameRate(10, anchor_frame=np.nan), "anchor_frame must be a whole number or None"),
        (lambda: PhaseIntervals([0, 1], ["x", "hold"]), "phase must be one of before, loading.*found 'x'"),
        (lambda: PhaseIntervals([0, "b"], ["loading", "hold"]), "start must be numeric"),
    ],
    exceptions.UncertaintyError: [
        (lambda: pool(MASKED, [0.1, 0.1, 0.1]), "value to pool must be finite, found nan at index 1"),
        (
            lambda: pool_random_effects([9.0, 9.0, 9.0], MASKED),
            "standard uncertainty must be .*, found nan at",
        ),
    ],
    # Sequences are refused where they are called, not where they are iterated over.
    exceptions.FingerpadError: [
        (lambda: measure_sequence("none.tif", 0.05), "no such file"),
        (lambda: measure_sequence(1.0, 0.05), "frames must be a path, .*found float"),
        (lambda: measure_sequence(np.zeros((3, 40, 30)), 0.05), "frames must be a path, .*found ndarray"),
        (lambda: measure_sequence((frame for frame in ()), 0.05), "a generator only once"),
        (lambda: measure_sequence([], 500), "mm_per_px must be between"),
        (lambda: measure_frames([], "500", None), "mm_per_px must be numeric, found '500'"),
        (lambda: measure_sequence([], 0.05, force=ForceSignal([0, 1], [0, 1])), "force and phases need"),
    ],
    exceptions.CalibrationError: [
        (lambda: Scale("a"), "mm_per_px must be numeric, found 'a'"),
        (lambda: Scale.of_ppi("500"), "ppi must be numeric, found '500'"),
        (lambda: Picture(pixels=np.zeros((20, 30), np.uint8), dots_per_inch=-1), "dots_per_inch must be pos"),
        (lambda: Grid(points=np.zeros((3, 3)), **GRID), r"rows, columns, 2\), found shape \(3, 3\)"),
        (lambda: Grid(points=np.full((3, 3, 2), np.nan), **GRID), "points must be finite"),
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
    for one in (PAD, placement, Paraboloid(12, [14, 15]), SOFT, ForceSignal([0, 1], [0, 1])):
        again = pickle.loads(pickle.dumps(one))
        assert repr(again) == repr(one)
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(one, dataclasses.fields(one)[0].name, 1)
    moved = dataclasses.replace(placement, wedge_angle=0.5, roll_angle=0.0)
    np.testing.assert_array_equal(moved.point, placement.point[1])


def test_monte_carlo_draws_accepted() -> None:
    pad = {"distal": 13.8, "radial_ulnar": 11.8, "wedge_angle": 0.5, "poisson_ratio": 0.5}
    image = {"image_scale": 1.0, "edge_offset": 0.0, "contact_radius": 6.0, "elongation": 0.3}
    varied = {"palmar": np.array([7.9, np.nan]), "roll_angle": np.array([9.0, 0.0])}
    assert np.isnan(pad_model(**varied, **pad, **image, load=2.0)["indentation"]).tolist() == [False, True]


SCALARS = [
    *(PAD, SOFT, BODIES, BODIES.gap, PLACED, PLACED.gap, PLACED.curvature, Ellipse(7.4, 5)),
    *(model(PLACED, SOFT, load=1) for model in (hertz_contact, fast_contact)),
    hertz_contact(BODIES, SOFT, area=80),
    propagate(lambda load: {"double": 2 * load}, Inputs.of(load=(2, 0.1)))["double"],
]
RESULTS = {
    "parametric angle": lambda: PAD.parametric_angles([1.0, 0, 0])[0],
    "Young's modulus": lambda: youngs_modulus(PLACED, load=2, area=80),
    "F2": lambda: indentation_factor(0.7),
    "F1": lambda: size_factor(0.7),
    "secant modulus": lambda: secant_modulus(2, 1.8, loading_radius=20),
    "equivalent radius from area": lambda: equivalent_radius_from_area(15, 0.7),
    "equivalent radius from compliance": lambda: equivalent_radius_from_compliance(15, 0.7),
    "equivalent radius from indentation": lambda: equivalent_radius_from_indentation(15, 0.7),
    "load at a time": lambda: ForceSignal([0, 1], [0, 1]).load_at(0.5),
}


@pytest.mark.parametrize("made", SCALARS, ids=lambda made: type(made).__name__)
def test_scalars_in_scalars_held(made) -> None:
    held = {name: getattr(made, name) for name in dir(made) if not name.startswith("_")}
    assert [name for name, value in held.items() if isinstance(value, np.ndarray) and value.ndim == 0] == []


@pytest.mark.parametrize("name", RESULTS)
def test_scalars_in_scalars_out(name: str) -> None:
    assert isinstance(RESULTS[name](), float)


def test_image_arguments(tmp_path: Path) -> None:
    truth = render_contact_image(semi_major=5.0, semi_minor=4.0, ppi=250, seed=2)
    path = tmp_path / "contact.png"
    Image.fromarray(truth.pixels).save(path)
    scale = Scale.of_ppi(250)
    wanted = measure_contact_image(truth.pixels, scale).as_record()
    for image in (path, str(path), read_image(path)):
        assert measure_contact_image(image, scale.mm_per_px).as_record() == wanted
    assert prepare_contact_image(truth.pixels, scale.mm_per_px).measure().mm_per_px == scale.mm_per_px
    with pytest.raises(exceptions.ImageError, match="no such file"):
        measure_contact_image(str(tmp_path / "none.png"), scale)
    for wrong, words in ((500, "between .*found 500"), ("500", "numeric, found '500'")):
        with pytest.raises(exceptions.CalibrationError, match=f"mm_per_px must be {words}"):
            measure_contact_image(path, wrong)


def test_sequence_arguments(tmp_path: Path) -> None:
    pressed = render_sequence([0.0, 0.1], seed=2)
    frames = [Frame(index=k, pixels=pressed.pixels(k)) for k in range(2)]
    path = tmp_path / "press.tif"
    tifffile.imwrite(path, np.stack([frame.pixels for frame in frames]), photometric="minisblack")
    size = 25.4 / pressed.ppi
    wanted = [str(result.measures) for result in measure_sequence(frames, Scale(size))]
    assert "gross_area_mm2" in wanted[1]
    for sequence in (path, str(path), open_frames(path)):
        assert [str(result.measures) for result in measure_sequence(sequence, size)] == wanted
    settings = estimate_settings(frames, size)
    assert [str(result.measures) for result in measure_frames(frames, size, settings)] == wanted
    assert scan_texture(frames, size).busiest == (0, 1)


def test_photograph_coin_and_curve_by_path(tmp_path: Path) -> None:
    truth = render_finger("palmar", semi_axes=(11.8, 13.8), mm_per_px=0.1, seed=1)
    Image.fromarray(truth.pixels).save(tmp_path / "finger.png")
    found = measure_photograph(str(tmp_path / "finger.png"), "palmar", 0.1)
    same = measure_photograph(truth.pixels, "palmar", Scale(0.1))
    assert found.semi_axes_mm == same.semi_axes_mm
    coin = render_coin(seed=1)
    Image.fromarray(coin.pixels).save(tmp_path / "coin.png")
    assert measure_coin(str(tmp_path / "coin.png")) == measure_coin(coin.pixels)
    (tmp_path / "curve.csv").write_text("force_N,displacement_mm\n0,0\n1,1\n", encoding="utf-8")
    assert read_loading_curve(str(tmp_path / "curve.csv")).load.tolist() == [0, 1]


# Arrays as they come in: masked entries are missing everywhere


@pytest.mark.parametrize("kind", [int, np.uint8, np.float32, float, complex])
def test_masked_entries_become_nan(kind) -> None:
    values = np.ma.masked_array([1, 2, 3], mask=[False, True, False], dtype=kind)
    found = as_float_array(values)
    assert not isinstance(found, np.ma.MaskedArray)
    assert found.dtype == (complex if kind is complex else float)
    np.testing.assert_array_equal(found, [1, np.nan, 3])
    np.testing.assert_array_equal(values, [1, 2, 3])  # the array given stays as it was
    assert np.isnan(as_float_array(np.ma.masked))


def test_kernels_with_masked_entries() -> None:
    contact = hertz_contact(Paraboloid(10.0, 10.0), Tissue(0.1), load=MASKED)
    assert np.isnan(contact.indentation).tolist() == [False, True, False]


@pytest.mark.parametrize(
    ("make", "of"),
    [
        (lambda a: Paraboloid(a, 14.0), "first_radius"),
        (lambda a: Paraboloid(a, 14.0).gap, "first_radius"),
        (Tissue, "youngs_modulus"),
        (lambda a: Ellipsoid(a, 13.8, 11.8), "palmar"),
        (lambda a: Placement(Ellipsoid(7.9, 13.8, 11.8), wedge_angle=a / 100), "wedge_angle"),
        (lambda a: LoadingCurve(load=a, indentation=a), "load"),
        (lambda a: Inputs(names=("a", "b"), mean=a, covariance=np.eye(2), groups={}), "mean"),
    ],
)
def test_frozen_objects_keep_their_own_values(make, of: str) -> None:
    given = np.array([12.0, 13.0])
    kept = make(given)
    before = getattr(kept, of).copy()
    given[:] = 1.0
    np.testing.assert_array_equal(getattr(kept, of), before)
    with pytest.raises(ValueError, match="read-only"):
        getattr(kept, of)[:] = 1.0
