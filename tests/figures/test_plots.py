"""Figures: what they say, what they show, and files that do not change from one writing to the next."""

from functools import partial
from itertools import cycle

import numpy as np
import pytest
from numpy.testing import assert_allclose as assert_close

import fingerpad as fp
from fingerpad.figures import (
    new_figure,
    new_panels,
    plot_agreement,
    plot_area_against_indentation,
    plot_area_against_load,
    plot_aspect_ratio,
    plot_contact_compliance,
    plot_corrected_radius,
    plot_initial_modulus,
    plot_layer_effect,
    plot_load_indentation,
    plot_pad,
    plot_pad_with_contact,
    plot_press,
    plot_relaxation,
    plot_secant_modulus,
    plot_simulated_load,
    plot_wedge,
    plot_wedge_in_pad_axes,
    svg,
)
from fingerpad.figures.compare import Series, plot_over_load
from fingerpad.figures.marks import Band, Line, Points
from fingerpad.figures.pad import Camera
from fingerpad.figures.publish import figure_csv
from fingerpad.geometry import Ellipse, Ellipsoid, Placement
from fingerpad.published import dzidek2017
from fingerpad.simulator import simulator_law
from fingerpad.uncertainty import agreement

assert_allclose = partial(assert_close, rtol=1e-6, atol=1e-9)  # marks keep seven digits
PAD = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
LOAD = np.array([0.2, 0.5, 1.0, 2.0])
VALUE = np.array([1.2, 1.3, 1.25, 1.4])
WEDGE = np.radians(30)

RESULTS = [plot_corrected_radius, plot_area_against_load, plot_aspect_ratio, plot_contact_compliance]


@pytest.fixture
def axes():
    return new_figure()[1][0]


def texts(axes) -> str:
    legend = axes.get_legend()
    inside = [] if legend is None else legend.get_texts()
    return "\n".join(text.get_text() for text in (*axes.texts, *inside, axes.title, axes._left_title))


def is_marked_synthetic(axes) -> bool:
    return any(text.get_text() == "synthetic" for text in axes.texts)


def bars(axes) -> list[np.ndarray]:
    """Return the vertical error bars as arrays of their two ends."""
    return [segment[:, 1] for container in axes.containers for segment in container[2][0].get_segments()]


@pytest.mark.parametrize(
    ("plot", "keyword", "x_unit", "y_unit"),
    [
        (plot_corrected_radius, "corrected_radius_std", "N", "mm"),
        (plot_area_against_load, "area_std", "N", "mm²"),
        (plot_aspect_ratio, "aspect_ratio_std", "N", "–"),
        (plot_contact_compliance, "area_std", "mm", "mm²"),
    ],
)
@pytest.mark.parametrize("synthetic", [False, [False, True, False, True]])
def test_error_bars_are_one_std_and_labels_have_units(axes, plot, keyword, x_unit, y_unit, synthetic):
    std = np.array([0.1, 0.2, 0.3, 0.4])
    assert plot(axes, LOAD, VALUE, synthetic=synthetic, **{keyword: std}) is axes
    low, high = np.array(sorted(bars(axes), key=np.ptp)).T
    assert_allclose(high - low, 2 * std)
    assert_allclose((high + low) / 2, VALUE)
    assert f"({x_unit})" in axes.get_xlabel()
    assert axes.get_ylabel().endswith(f"({y_unit})")


@pytest.mark.parametrize("plot", RESULTS)
def test_synthetic_points_hollow_and_labelled(axes, plot):
    plot(axes, LOAD, VALUE, synthetic=[False, True, False, False])
    assert is_marked_synthetic(axes)
    real, made = (container[0] for container in axes.containers)
    assert (len(real.get_xdata()), len(made.get_xdata())) == (3, 1)
    assert (made.get_markerfacecolor(), real.get_markerfacecolor() == "white") == ("white", False)
    assert made.get_ydata() == VALUE[1]


@pytest.mark.parametrize("plot", [plot_wedge, plot_wedge_in_pad_axes, plot_pad_with_contact])
@pytest.mark.parametrize("wedge_deg", [0, 30, 90])
def test_scales_are_equal_and_nothing_is_cut_off(axes, plot, wedge_deg):
    shown = {"measured": Ellipse(14.0, 7.0)} if plot is plot_pad_with_contact else {}
    plot(axes, PAD, wedge_angle=np.radians(wedge_deg), synthetic=True, **shown)
    axes.figure.canvas.draw()
    assert axes.get_aspect() == 1
    assert is_marked_synthetic(axes)
    if shown:
        require_whole_lines(axes)


def require_whole_lines(axes) -> None:
    points = np.concatenate([line.get_xydata() for line in axes.lines if len(line.get_xydata()) > 2])
    low, high = np.sort([axes.get_xlim(), axes.get_ylim()]).T
    assert (low <= np.nanmin(points, axis=0)).all()
    assert (np.nanmax(points, axis=0) <= high).all()


def markers(axes, marker="o") -> list[np.ndarray]:
    return [np.ravel(line.get_xydata()) for line in axes.lines if line.get_marker() == marker]


def test_wedge_in_pad_axes(axes):
    plot_wedge_in_pad_axes(axes, PAD, wedge_angle=WEDGE)
    point = Placement(PAD, wedge_angle=WEDGE).point[:2]
    assert_allclose(markers(axes), [point])
    slopes = [
        np.diff(line.get_ydata())[0] / np.diff(line.get_xdata())[0]
        for line in axes.lines
        if line.get_linewidth() == 1.4
    ]
    assert_allclose(slopes, [-1 / np.tan(WEDGE)])
    assert "= −1.73" in texts(axes)
    assert "u = 45.2°" in texts(axes)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x, palmar (mm)", "y, distal (mm)")


def test_finger_touches_platen_and_wedge(axes):
    plot_wedge(axes, PAD, wedge_angle=WEDGE)
    finger, wedge, platen = (patch.get_path().vertices for patch in axes.patches)
    level = platen[:, 1].min()
    assert_allclose(finger[:, 1].max(), level, atol=1e-3)
    assert_allclose(markers(axes)[0][1], level)
    incline = wedge[1] - wedge[0]
    assert_allclose(np.arctan2(incline[1], incline[0]), WEDGE)
    height = (finger - wedge[0]) @ np.array([-np.sin(WEDGE), np.cos(WEDGE)])
    assert_allclose(height.min(), 0, atol=1e-5)


def test_pad_point_colours(axes):
    plot_pad(axes, PAD)
    view = Camera.of(towards=(0.55, 0.5, 0.95), up=(1, 0, 0))
    spots = view.project(PAD.point(np.radians([0, 30, 45, 60, 90]), np.pi / 2))
    assert_allclose(markers(axes), spots)
    colours = [line.get_color() for line in axes.lines if line.get_marker() == "o"]
    assert colours == ["#F0E442", "#009E73", "#0072B2", "#E69F00", "#D55E00"]
    assert {"0°", "30°", "45°", "60°", "90°", "x, palmar", "y, distal", "5 mm"} <= set(
        texts(axes).split("\n")
    )
    require_whole_lines(axes)


def test_contact_ellipse_size_and_direction(axes):
    plot_pad_with_contact(
        axes,
        PAD,
        wedge_angle=WEDGE,
        predicted=Ellipse(5.5, 5.1),
        measured=Ellipse(7.4, 5.0),
        measured_long_axis_angle=np.radians(30),
    )
    drawn = {line.get_label()[:11]: line.get_xydata() for line in axes.lines}
    across, along = np.ptp(drawn["Hertz shape"], axis=0)
    assert_allclose([across, along], [11.0, 10.2], rtol=1e-3)  # at 30° the larger radius lies across
    measured = drawn["contact mea"] - drawn["contact mea"].mean(axis=0)
    tip = measured[np.argmax(np.linalg.norm(measured, axis=1) * (measured[:, 1] > 0))]
    assert_allclose(np.degrees(np.arctan2(-tip[0], tip[1])), 30, atol=1)  # to the left of the fingertip
    assert "R across\n14.3 mm" in texts(axes)
    assert "R along 13.0 mm" in texts(axes)


def test_rolled_finger_axis_upright(axes):
    roll = np.radians(25)
    plot_pad_with_contact(axes, PAD, wedge_angle=WEDGE, roll_angle=roll, predicted=Ellipse(6.0, 3.0))
    placement = Placement(PAD, wedge_angle=WEDGE, roll_angle=roll)
    # Angle on the platen from the finger's axis to the larger radius' direction, without any view.
    upright = np.array([0, 1, 0]) - placement.normal[1] * placement.normal
    long_axis = placement.curvature.principal_directions[np.argmax(placement.curvature.principal_radii)]
    turn = np.arctan2(np.cross(upright, long_axis) @ placement.normal, upright @ long_axis)
    (drawn,) = (line.get_xydata() for line in axes.lines if line.get_label().startswith("Hertz shape"))
    tip = drawn[0] - drawn[:-1].mean(axis=0)
    assert_allclose(np.hypot(*tip), 6.0)
    assert_allclose(np.tan(np.arctan2(-tip[0], tip[1])), np.tan(turn))
    assert abs(np.tan(turn)) > 0.1
    assert "roll φ = 25°" in texts(axes)


def test_corrected_radius_lines(axes):
    wedge = dzidek2017().wedges[30]
    plot_corrected_radius(axes, [], [], measured_radius=20.5, mean_curvature_radius=18.7, printed=wedge)
    styles = {
        line.get_linestyle(): line.get_ydata()[0] for line in axes.lines if line.get_linestyle() != "None"
    }
    assert styles == {"--": 20.5, ":": 18.7}
    assert_allclose(markers(axes, "D"), [[2, 19.9]])
    low, high = axes.get_ylim()
    assert low < 18.7 < 20.5 < high
    assert "printed in Dzidek et al. (2017)" in texts(axes)


def test_corrected_radius_has_inner_bars_and_a_band(axes):
    plot_corrected_radius(
        axes,
        LOAD,
        VALUE,
        corrected_radius_std=0.8,
        fixed_geometry_std=0.1,
        measured_radius=VALUE[0] + 5,
        measured_radius_std=0.5,
    )
    bars = [np.diff([end[:, 1] for end in one.get_segments()]) for one in axes.collections]
    assert_allclose([one[0] / 2 for one in bars], [[0.1], [0.8]])  # behind the points
    (band,) = axes.patches
    assert_allclose(
        band.get_extents().transformed(axes.transData.inverted()).intervaly,
        VALUE[0] + 5 + np.array([-0.5, 0.5]),
    )


def test_power_laws_through_mean(axes):
    area = 80 * LOAD**0.4
    plot_area_against_load(axes, LOAD, area, exponent=0.4, exponent_std=0.03)
    fit, hertz = (line for line in axes.lines if line.get_marker() == "None" and len(line.get_xdata()) == 50)
    for line, slope in ((fit, 0.4), (hertz, 2 / 3)):
        x, y = np.log(line.get_xdata()), np.log(line.get_ydata())
        assert_allclose(np.diff(y) / np.diff(x), slope, rtol=1e-4)
        assert_allclose(np.interp(np.log(LOAD).mean(), x, y), np.log(area).mean())
    assert "0.400 ± 0.030" in texts(axes)
    band = axes.collections[-1].get_paths()[0].vertices
    end = band[np.isclose(band[:, 0], band[:, 0].max()), 1]
    lever = np.log(band[:, 0].max()) - np.log(LOAD).mean()
    assert_allclose(np.log(end.max() / end.min()), 2 * 0.03 * lever, rtol=1e-4)


def test_nonpositive_area_left_out(axes):
    plot_area_against_load(axes, [0, 1, 2], [0, 10, 20], area_std=[1, 2, 3])
    assert_allclose(axes.containers[0][0].get_xdata(), [1, 2])
    assert_allclose(sorted(np.ptp(bars(axes), axis=1)), [4, 6])


def test_contact_shapes_and_directions(axes):
    plot_aspect_ratio(axes, [1, 2], [1.5, 2.0], long_axis_angle=[0, np.pi / 2], predicted_aspect_ratio=1.07)
    real, predicted = axes.collections[-2:]
    assert_allclose(real.get_widths() / real.get_heights(), [1.5, 2.0])
    assert_allclose(real.get_angles(), [90, 180])  # upwards, then across
    assert_allclose(predicted.get_widths() / predicted.get_heights(), [1.07])
    assert "Hertz\n1.07" in texts(axes)


def test_loop_phases_and_fit(axes):
    phase = np.array(["baseline", "loading", "hold", "unloading"])
    fit = (np.array([0.0, 1.4]), np.array([0.0, 2.0]))
    plot_load_indentation(axes, VALUE, LOAD, phase=phase, fits={"Hertz, E* = 136 kPa": fit}, synthetic=True)
    assert {"baseline", "loading", "hold", "unloading"} <= set(texts(axes).split("\n"))
    (line,) = (line for line in axes.lines if line.get_label().startswith("Hertz"))
    assert_allclose(line.get_xydata(), np.transpose(fit))
    assert is_marked_synthetic(axes)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("indentation ξ (mm)", "normal load W (N)")


def test_secant_modulus_unit_and_fitted_points(axes):
    modulus = np.array([5.0, 0.06, 0.08, 0.10])
    fitted = [False, True, True, True]
    plot_secant_modulus(axes, LOAD, modulus, against="load", fitted_points=fitted, fit=(LOAD, modulus))
    grey, blue, line = (line.get_ydata() for line in axes.lines)
    assert_allclose(grey, [5000])
    assert_allclose(blue, [60, 80, 100])
    assert_allclose(line, 1000 * modulus)
    assert axes.get_ylim()[1] < 200  # what is left out does not set the scale
    assert axes.get_xlabel() == "normal load W (N)"


def test_relaxation_marks_ramp(axes):
    time = np.array([-1.0, 0.1, 1.0, 10.0])
    plot_relaxation(axes, time, VALUE, ramp_time=0.5, time_constants=[2.0])
    assert len(axes.lines[0].get_xdata()) == 3
    assert "hidden by the ramp" in texts(axes)
    assert any(np.allclose(line.get_xdata(), 2.0) for line in axes.lines if len(line.get_xdata()))


def test_initial_modulus_against_velocity(axes):
    plot_initial_modulus(axes, [0.2, 2.0], [0.04, 0.06], initial_modulus_std=[0.002, 0.003])
    assert sorted(map(tuple, bars(axes))) == [(38.0, 42.0), (57.0, 63.0)]
    assert axes.get_xscale() == "log"


def test_compliance_slope_and_band(axes):
    depth = np.array([0.0, 1.0, 2.0])
    plot_contact_compliance(axes, depth, 13.4 * np.pi * depth, loading_radius=13.4, loading_radius_std=0.5)
    (line,) = (line for line in axes.lines if line.get_linestyle() == "-" and len(line.get_xdata()) == 2)
    assert_allclose(np.diff(line.get_ydata()) / np.diff(line.get_xdata()), 13.4)
    assert line.get_ydata()[0] == 0
    fan = axes.collections[-1].get_paths()[0].vertices
    at_end = fan[np.isclose(fan[:, 0], 2 * np.pi), 1]
    assert_allclose(np.ptp(at_end), 2 * 0.5 * np.pi)
    assert "13.40 ± 0.50 mm" in texts(axes)


PRESS = {
    "time": [0.0, 0.1, 0.2, 0.3, 0.4],
    "load": [0.5, 2.0, 2.0, 1.0, 0.4],
    "phase": ["loading", "loading", "hold", "unloading", "unloading"],
    "area": [40.0, 110.0, 115.0, 80.0, 45.0],
    "semi_major": [4.0, 6.5, 6.6, 5.5, 4.2],
    "semi_minor": [3.2, 5.4, 5.5, 4.6, 3.4],
}


@pytest.mark.parametrize("count", [0, 1])
def test_press_of_one_frame_or_none(count):
    figure, panels = new_panels(rows=2, columns=2)
    plot_press(panels, **{name: values[:count] for name, values in PRESS.items()})
    assert "<svg" in svg(figure, "press")


@pytest.mark.parametrize("synthetic", [False, True])
def test_press_marks_unloading(synthetic):
    panels = plot_press(new_figure(rows=2, columns=2)[1], **PRESS, synthetic=synthetic)
    for panel, x, y in zip(panels, 2 * ["time", "load"], 2 * ["area"] + 2 * ["semi_major"], strict=True):
        lines = {one.get_label(): one[0] for one in panel.containers}
        for phase in ("loading", "hold", "unloading"):
            chosen = np.array(PRESS["phase"]) == phase
            assert_allclose(lines[phase].get_xdata(), np.array(PRESS[x])[chosen])
            assert_allclose(lines[phase].get_ydata(), np.array(PRESS[y])[chosen])
            assert (lines[phase].get_markerfacecolor() == "white") == synthetic
        assert len({lines[phase].get_marker() for phase in ("loading", "hold", "unloading")}) == 3
        assert panel.get_ylim()[0] == 0
    assert is_marked_synthetic(panels[1]) == synthetic


@pytest.mark.parametrize("synthetic", [False, True])
def test_area_against_indentation_marks_phases(axes, synthetic):
    indentation = [0.2, 1.1, 1.1, 0.7, 0.3]
    plot_area_against_indentation(axes, indentation, PRESS["area"], phase=PRESS["phase"], synthetic=synthetic)
    lines = {one.get_label(): one[0] for one in axes.containers}
    assert_allclose(lines["unloading"].get_xdata(), [0.7, 0.3])
    assert_allclose(lines["unloading"].get_ydata(), [80.0, 45.0])
    assert axes.get_xlim()[0] == 0
    assert is_marked_synthetic(axes) == synthetic


def test_layer_effect_marks_what_is_known(axes):
    plot_layer_effect(axes, [2, 4, 8], modulus_ratio=[np.nan, 0.5, 0.74], radius_ratio=[np.nan, 1.9, 1.5])
    modulus, radius = (line for line in axes.lines if line.get_label().startswith(("E from", "$R")))
    assert_allclose(modulus.get_ydata()[1:], [0.5, 0.74])
    assert_allclose(radius.get_ydata()[1:], [1.9, 1.5])
    assert [text.get_text() for text in axes.texts] == ["Hertz", "0.50", "0.74", "1.9", "1.5"]
    assert axes.get_ylim()[1] > 2


@pytest.mark.parametrize("fingers", [2, 12])
def test_moduli_of_two_kinds_differ_in_mark_and_in_words(fingers):
    kinds = ("by Hertz theory", "o"), ("on the layer over bone", "s")
    lines = [
        Series(name=f"f{k}", colour="red", x=[1, 2], value=[60, 70], std=[2, 3], kind=kind, marker=marker)
        for k, (kind, marker) in zip(range(fingers), cycle(kinds))
    ]
    figure, (panel,) = new_panels()
    plot_over_load(panel, lines, label="Young's modulus E (kPa)")
    drawn = {mark.label.rpartition(", ")[2]: mark.marker for mark in panel.marks if mark.label[0] == "_"}
    legend = {mark.label: mark.marker for mark in panel.marks if mark.label[0] != "_"}
    assert drawn == dict(kinds)
    assert dict(kinds).items() <= legend.items()
    assert all(f", {kind}" in figure_csv(figure) for kind, _ in kinds)
    assert "on the layer over bone" in svg(figure, "moduli")


def test_agreement_shows_bias_and_limits(axes):
    first, second = [100, 120, 140, 90], [101, 119, 143, 91]
    found = agreement(first, second)
    plot_agreement(axes, first, second, found, quantity="gross area (mm²)")
    assert axes.get_xlabel() == "gross area (mm²), mean of both"
    assert f"bias {100 * found.bias:+.1f} %" in texts(axes)
    assert f"limit −{-100 * found.limits[0]:.1f} %" in texts(axes)
    assert texts(axes).count("limit") == 2


# The law over a loading curve: what is drawn, and the numbers behind it

PLACE = fp.Placement(fp.Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8), wedge_angle=np.radians(30))


def test_law_targets_and_points():
    law = simulator_law(PLACE, fp.Tissue(0.05, thickness=8.0), stds={"youngs_modulus": 0.005})
    figure, (panel,) = new_panels()
    plot_simulated_load(
        panel,
        law.indentation,
        law.load,
        load_std=law.load_std,
        simulated=law.simulated_loads(),
        measured=([0.5, 1.0], [0.2, 0.7]),
    )
    kinds = [type(mark) for mark in panel.marks]
    assert kinds == [Points, Band, Line, Line, Line, Line]
    assert [mark.label for mark in panel.marks[2:]] == ["law of the pad", "Newton kh", "Drake", "MuJoCo"]
    assert "measured,0.5,0.2" in figure_csv(figure)


@pytest.mark.parametrize("name", ["Newton kh", "Drake", "MuJoCo"])
def test_simulated_loads_are_as_far_off_as_their_targets_say(name):
    law = simulator_law(PLACE, fp.Tissue(0.05, thickness=8.0))
    target = {"Newton kh": law.newton_kh(), "Drake": law.drake_modulus(), "MuJoCo": law.mujoco(0.1)}[name]
    error = np.abs(law.simulated_loads()[name] / law.load - 1).max()
    assert error == pytest.approx(target.worst_relative_error, rel=0.02)
    paraboloid = simulator_law(fp.Paraboloid(12.0, 14.0), fp.Tissue(0.05, thickness=8.0), (0.2, 2.0))
    assert "Drake" not in paraboloid.simulated_loads()
