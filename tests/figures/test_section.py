"""The section under a contact: what is drawn where, and in which units."""

import re
from functools import cache

import numpy as np
import pytest
from matplotlib.path import Path
from numpy.testing import assert_allclose

from fingerpad import figures
from fingerpad.contact import ContactField, Tissue, solve_contact
from fingerpad.figures.marks import Line, Points, Rule, Text
from fingerpad.figures.publish import FigureSettings, figure_colours, with_settings
from fingerpad.figures.style import BLUE, GREY, VERMILLION
from fingerpad.geometry import Ellipsoid, Placement

PLACEMENT = Placement(Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8), wedge_angle=np.radians(30))
TISSUE = Tissue.of_reduced_modulus(0.09, thickness=4.0)
RECEPTORS = {"Pacinian": (1.5, 2.5), "Merkel": (0.7, 1.0), "deep": (30.0, 40.0)}


@cache
def hertz_field() -> ContactField:
    return ContactField.of_hertz(PLACEMENT, TISSUE, load=2.0)


@cache
def layer_field() -> ContactField:
    return ContactField.of_solution(solve_contact(PLACEMENT, TISSUE, load=2.0, points=64))


def texts(panel) -> list[str]:
    return [mark.text for mark in panel.marks if isinstance(mark, Text)]


def test_pressure_is_in_kpa():
    axes = figures.new_figure()[1][0]
    figures.plot_contact_pressure(
        axes, layer_field().section(points=101, levels=2), hertz=hertz_field().section(levels=2)
    )
    assert axes.get_ylabel() == "pressure (kPa)"
    solved, hertz = axes.get_lines()
    assert solved.get_ydata().max() == pytest.approx(1000 * layer_field().contact.peak_pressure, rel=0.01)
    assert hertz.get_ydata().max() == pytest.approx(1000 * hertz_field().contact.peak_pressure, rel=1e-3)
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["whole pad", "Hertz"]


def test_shear_is_in_kpa_and_its_highest_marked():
    _, (panel,) = figures.new_panels()
    section = hertz_field().section(points=41, levels=31)
    shear, depth = hertz_field().highest_shear_on_axis()
    figures.plot_section(panel, section, highest_shear=(shear, depth))
    levels = [float(mark.label.split()[1]) for mark in panel.marks if mark.label.startswith("_above")]
    assert levels[0] == 0
    assert levels[-1] <= 1000 * section.maximum_shear.max() <= levels[-1] + levels[1]
    (marker,) = [mark for mark in panel.marks if isinstance(mark, Points)]
    assert_allclose((marker.x, marker.y), ([0], [depth]), rtol=1e-6)
    assert texts(panel) == [f"{1000 * shear:.3g} kPa at {depth:.1f} mm"]
    low, high = panel.limits("y")
    assert low > high == 0  # depth grows downwards


def test_contours_enclose_what_is_above_them():
    """Each point is in the outlines of the levels below its stress, islands and holes included."""
    _, (panel,) = figures.new_panels()
    section = layer_field().section(points=41, levels=31)
    figures.plot_section(panel, section)
    shear = 1000 * section.maximum_shear
    inner = np.ix_(range(1, 30), range(1, 40))  # on an edge a point is neither in nor out
    points = np.stack(np.meshgrid(section.along, section.depth), axis=-1)[inner].reshape(-1, 2)
    outlines = [mark for mark in panel.marks if mark.label.startswith("_above")]
    for outline in outlines[1:]:
        level, line = float(outline.label.split()[1]), np.transpose([outline.x, outline.y])
        rings = np.split(line, np.flatnonzero(np.isnan(outline.x)) + 1)
        within = sum(Path(ring[:-1]).contains_points(points).astype(int) for ring in rings[:-1])
        assert ((within % 2 == 1) == (shear[inner].ravel() > level)).all()


def test_bone_lies_under_a_layer_alone():
    panel, other = figures.new_panels(columns=2)[1]
    figures.plot_section(panel, layer_field().section(points=21, levels=9))
    (bone,) = [mark for mark in panel.marks if isinstance(mark, Rule)]
    assert (bone.at, bone.to) == (4.0, pytest.approx(panel.limits("y")[0]))
    assert texts(panel) == ["bone"]
    figures.plot_section(other, hertz_field().section(points=21, levels=9))
    assert not texts(other)


def test_receptors_are_named_in_order_and_apart():
    _, (panel,) = figures.new_panels()
    figures.plot_section(panel, layer_field().section(points=21, levels=9))
    figures.mark_receptors(panel, RECEPTORS, spacing=1.5)
    named = {mark.text: mark for mark in panel.marks if isinstance(mark, Text) and mark.text != "bone"}
    assert list(named) == ["Merkel", "Pacinian"]
    lines = [mark.at for mark in panel.marks if isinstance(mark, Rule) and mark.to is None]
    assert lines == [0.85, 2.0]
    places = [mark.y for mark in named.values()]
    assert places[1] - places[0] >= 1.5
    assert places[0] == 0.85


def test_colours_to_choose_are_few_and_contours_keep_theirs():
    figure = figures.section_figure(layer_field(), hertz=hertz_field(), points=21, levels=9)
    assert figure_colours(figure) == [BLUE, GREY, VERMILLION]
    wanted = with_settings(figure, FigureSettings(colours="black", width_mm=60))
    before, after = (
        [mark.face for mark in one.panels[1].marks if isinstance(mark, Line)] for one in (figure, wanted)
    )
    assert before == after
    assert wanted.panels[0].place == figure.panels[0].place


@pytest.mark.parametrize("width", [85.0, 170.0])
def test_figure_has_equal_scales(width):
    figure = figures.section_figure(layer_field(), hertz=hertz_field(), receptors=RECEPTORS, width_mm=width)
    _, lower, bar = figure.panels
    assert bar.x.label == "maximum shear stress (kPa)"
    sides = np.multiply(lower.place[2:], (figure.width_mm, figure.height_mm))
    spans = [abs(np.subtract(*lower.limits(name))) for name in ("x", "y")]
    assert sides[0] / spans[0] == pytest.approx(sides[1] / spans[1], rel=1e-6)
    frames = [
        re.findall(r'="([-\d.]+)"', one)
        for one in re.findall(r"<clipPath.*?</clipPath>", figures.svg(figure, "s"))
    ]
    (left, _, across, _), (same, _, wide, down), _ = [map(float, one[-4:]) for one in frames]
    assert (left, across) == (same, wide)
    assert [across, down] == pytest.approx(sides * 72 / 25.4, abs=0.01)
