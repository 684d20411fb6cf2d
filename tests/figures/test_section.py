"""The section under a contact: what is drawn where, and in which units."""

from functools import cache

import numpy as np
import pytest

from fingerpad.contact import ContactField, Tissue, solve_contact
from fingerpad.figures import mark_receptors, new_figure, plot_contact_pressure, plot_section, section_figure
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


def texts(axes) -> list[str]:
    return [text.get_text() for text in axes.texts]


def test_pressure_is_in_kpa():
    axes = new_figure()[1][0]
    plot_contact_pressure(
        axes, layer_field().section(points=101, levels=2), hertz=hertz_field().section(levels=2)
    )
    assert axes.get_ylabel() == "pressure (kPa)"
    solved, hertz = axes.get_lines()
    assert solved.get_ydata().max() == pytest.approx(1000 * layer_field().contact.peak_pressure, rel=0.01)
    assert hertz.get_ydata().max() == pytest.approx(1000 * hertz_field().contact.peak_pressure, rel=1e-3)
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["whole pad", "Hertz"]


def test_shear_is_in_kpa_and_its_highest_marked():
    axes = new_figure()[1][0]
    section = hertz_field().section(points=41, levels=31)
    shear, depth = hertz_field().highest_shear_on_axis()
    filled = plot_section(axes, section, highest_shear=(shear, depth))
    assert filled.levels[0] == 0
    assert filled.levels[-2] <= 1000 * section.maximum_shear.max() <= filled.levels[-1]
    (marker,) = [line for line in axes.get_lines() if line.get_marker() == "o"]
    assert (marker.get_xdata(), marker.get_ydata()) == ([0], [depth])
    assert texts(axes) == [f"{1000 * shear:.3g} kPa at {depth:.1f} mm"]
    assert axes.get_ylim()[0] > axes.get_ylim()[1] == 0  # depth grows downwards


def test_bone_lies_under_a_layer_alone():
    axes, other = new_figure(columns=2)[1]
    plot_section(axes, layer_field().section(points=21, levels=9))
    (bone,) = axes.patches
    assert bone.get_y() == 4.0
    assert bone.get_y() + bone.get_height() == pytest.approx(axes.get_ylim()[0])
    assert texts(axes) == ["bone"]
    plot_section(other, hertz_field().section(points=21, levels=9))
    assert not other.patches


def test_receptors_are_named_in_order_and_apart():
    axes = new_figure()[1][0]
    plot_section(axes, layer_field().section(points=21, levels=9))
    mark_receptors(axes, RECEPTORS, spacing=1.5)
    named = {text.get_text(): text for text in axes.texts if text.get_text() != "bone"}
    assert list(named) == ["Merkel", "Pacinian"]
    assert [text.xy[1] for text in named.values()] == [0.85, 2.0]
    places = [text.xyann[1] for text in named.values()]
    assert places[1] - places[0] >= 1.5
    assert places[0] == 0.85


@pytest.mark.parametrize("width", [85.0, 170.0])
def test_figure_has_equal_scales(width):
    figure = section_figure(layer_field(), hertz=hertz_field(), receptors=RECEPTORS, width_mm=width)
    _, lower, bar = figure.axes
    assert bar.get_xlabel() == "maximum shear stress (kPa)"
    sides = figure.get_size_inches() * lower.get_position().size
    spans = [abs(np.subtract(*limits)) for limits in (lower.get_xlim(), lower.get_ylim())]
    assert sides[0] / spans[0] == pytest.approx(sides[1] / spans[1], rel=1e-6)
