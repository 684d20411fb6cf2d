"""SVG of panels: the limits of Matplotlib, data where the ticks say, text inside the figure."""

import re
from xml.etree import ElementTree

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fingerpad import figures
from fingerpad.exceptions import FingerpadError
from fingerpad.figures.marks import Axis, Figure, Points
from fingerpad.figures.svg_text import line_width, runs
from fingerpad.geometry import Ellipse, Ellipsoid

SVG = "{http://www.w3.org/2000/svg}"
LOAD = np.array([0.2, 0.5, 1.0, 2.0])
VALUE = np.array([12.0, 30.0, 55.0, 80.0])
STD = np.array([1.0, 2.0, 2.5, 3.0])
PLOTS = {
    "radius": lambda axes: figures.plot_corrected_radius(
        axes,
        LOAD,
        VALUE,
        corrected_radius_std=STD,
        fixed_geometry_std=STD / 10,
        measured_radius=90.0,
        measured_radius_std=5.0,
        mean_curvature_radius=70.0,
    ),
    "area": lambda axes: figures.plot_area_against_load(
        axes, LOAD, VALUE, area_std=STD, exponent=0.8, exponent_std=0.05, synthetic=True
    ),
    "aspect ratio": lambda axes: figures.plot_aspect_ratio(
        axes, LOAD, 1 + VALUE / 100, aspect_ratio_std=STD / 100, predicted_aspect_ratio=1.1
    ),
    "budget": lambda axes: figures.plot_uncertainty_budget(
        axes, {"wedge angle": 0.7, "load": 0.3}, total={"load": 0.3, "wedge angle": 0.8}
    ),
    "layer": lambda axes: figures.plot_layer_effect(
        axes, [3, 4, 8, 12], modulus_ratio=[0.4, 0.5, 0.7, 0.8], radius_ratio=[2.2, 2, 1.5, 1.4]
    ),
    "compliance": lambda axes: figures.plot_contact_compliance(
        axes, LOAD, VALUE, area_std=STD, loading_radius=12.0, loading_radius_std=0.5
    ),
    "load": lambda axes: figures.plot_load_indentation(
        axes, LOAD, VALUE, phase=["loading"] * LOAD.size, fits={"Hertz": (LOAD, VALUE)}
    ),
    "velocity": lambda axes: figures.plot_initial_modulus(
        axes, LOAD, VALUE / 1000, initial_modulus_std=STD / 1000
    ),
    "relaxation": lambda axes: figures.plot_relaxation(
        axes, [0.01, 0.1, 1, 10], VALUE, time_constants=[0.5], ramp_time=0.05
    ),
}


def drawn(plot) -> tuple[Figure, ElementTree.Element]:
    figure, (panel,) = figures.new_panels()
    plot(panel)
    return figure, ElementTree.fromstring(figures.svg(figure, "test"))


def texts(root: ElementTree.Element) -> list[tuple[str, float, float, ElementTree.Element]]:
    return [
        ("".join(each.itertext()), float(each.get("x")), float(each.get("y")), each)
        for each in root.iter(f"{SVG}text")
    ]


def ticks(root: ElementTree.Element) -> tuple[np.ndarray, np.ndarray]:
    """Return values and places of the ticks, in x and in y, from the figure alone."""
    path = next(each.get("d") for each in root.iter(f"{SVG}path") if re.search(r"v3\.5", each.get("d")))
    x = [float(found) for found in re.findall(r"M([\d.]+) [\d.]+v3\.5", path)]
    y = [float(found) for found in re.findall(r"M[\d.]+ ([\d.]+)h-3\.5", path)]
    found = [
        one for one in texts(root) if one[3].get("font-size") == "7" and re.fullmatch(r"−?[\d.]+", one[0])
    ]
    return tuple(
        np.array(
            [
                (float(text.replace("−", "-")), place)
                for place in places
                for text, a, b, each in found
                if re.fullmatch(r"−?[\d.]+", text)
                and each.get("text-anchor") == anchor
                and abs((a, b - 2.66)[axis] - place) < 0.1
            ]
        ).T
        for axis, (places, anchor) in enumerate(((x, "middle"), (y, "end")))
    )


def scaled(values, scale: str) -> np.ndarray:
    return np.log(values) if scale == "log" else np.asarray(values)


def markers(root: ElementTree.Element) -> np.ndarray:
    path = next(each.get("d") for each in root.iter(f"{SVG}path") if each.get("d").count("z") >= LOAD.size)
    return np.array(re.findall(r"M([\d.]+) ([\d.]+)m", path), dtype=float).T


@pytest.mark.parametrize("name", PLOTS)
def test_limits_are_those_of_matplotlib(name):
    _, (axes,) = figures.new_figure()
    PLOTS[name](axes)
    _, root = drawn(PLOTS[name])
    frame = next(root.iter(f"{SVG}clipPath"))[0]
    sides = [
        (float(frame.get(low)), float(frame.get(size))) for low, size in (("x", "width"), ("y", "height"))
    ]
    limits, scales = (axes.get_xlim(), axes.get_ylim()), (axes.get_xscale(), axes.get_yscale())
    if name == "budget":  # its y axis has names
        sides, limits = sides[:1], limits[:1]
    for (values, places), ends, scale, (begin, extent) in zip(
        ticks(root), limits, scales, sides, strict=False
    ):
        line = np.polyfit(scaled(values, scale), places, 1)
        assert_allclose(np.polyval(line, scaled(values, scale)), places, atol=0.02)
        assert_allclose(sorted(np.polyval(line, scaled(ends, scale))), [begin, begin + extent], atol=0.1)


@pytest.mark.parametrize("name", ["radius", "area", "compliance", "load"])
def test_points_stand_where_the_ticks_say(name):
    _, root = drawn(PLOTS[name])
    x, y = (LOAD, VALUE) if name != "compliance" else (np.pi * LOAD, VALUE)
    scale = "log" if name == "area" else "linear"
    for data, drawn_at, (values, places) in zip((x, y), markers(root), ticks(root), strict=True):
        line = np.polyfit(scaled(values, scale), places, 1)
        assert_allclose(drawn_at, np.polyval(line, scaled(data, scale)), atol=0.05)


@pytest.mark.parametrize("name", PLOTS)
def test_text_stays_inside(name):
    _, root = drawn(PLOTS[name])
    _, _, width, height = map(float, root.get("viewBox").split())
    for text, x, y, element in texts(root):
        if element.get("transform"):
            continue
        size = float(element.get("font-size"))
        long = line_width(text, size)
        left = x - long * {"start": 0, "middle": 0.5, "end": 1}[element.get("text-anchor", "start")]
        assert left >= -0.5, text
        assert left + long <= width + 4, text  # scripts are narrower than measured here
        assert 0 <= y - 0.7 * size <= y <= height, text


def test_a_bar_to_below_zero_leaves_a_logarithmic_frame():
    _, root = drawn(lambda axes: figures.plot_area_against_load(axes, LOAD, VALUE, area_std=[1, 2, 60, 3]))
    frame = next(root.iter(f"{SVG}clipPath"))[0]
    bottom = float(frame.get("y")) + float(frame.get("height"))
    bars = next(one.get("d") for one in root.iter(f"{SVG}path") if one.get("d").count("L") == 3 * LOAD.size)
    ends = [float(end) for end in re.findall(r"M[\d.]+ (-?[\d.]+)", bars)]
    assert [end > bottom + 10 for end in ends] == [False] * 6 + [True, True, False] + [False] * 3


@pytest.mark.parametrize("low", [0.7, 1.0, 20.1, 300.0])
@pytest.mark.parametrize("ratio", [1.05, 1.5, 3.0, 4.9, 5.1, 9.0, 19.0, 21.0, 99.0, 199.0, 201.0, 999.0])
def test_logarithmic_axes_have_some_ticks_and_not_too_many(low, ratio):
    def plot(axes):
        axes.add(Points([low, ratio * low], [1.0, 2.0]))
        axes.x = Axis(log=True, margin=0)

    (values, places), _ = ticks(drawn(plot)[1])
    assert 3 <= len(values) <= 9
    assert_allclose(np.polyval(np.polyfit(np.log(values), places, 1), np.log(values)), places, atol=0.1)


@pytest.mark.parametrize("wedge_deg", [0, 30, 45])
def test_samples_of_a_legend_wider_than_its_frame_stay_inside(wedge_deg):
    pad = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
    shown = {"measured": Ellipse(7.9, 6.1), "predicted": Ellipse(8.0, 6.1)}
    _, root = drawn(
        lambda axes: figures.plot_pad_with_contact(axes, pad, wedge_angle=np.radians(wedge_deg), **shown)
    )
    lines = [re.fullmatch(r"M(-?[\d.]+) [\d.]+h[\d.]+", one.get("d")) for one in root.iter(f"{SVG}path")]
    begins = [float(line[1]) for line in lines if line]
    assert len(begins) == 2
    assert min(begins) >= -0.5


def test_pad_has_equal_scales():
    pad = Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
    _, root = drawn(
        lambda axes: figures.plot_pad_with_contact(axes, pad, wedge_angle=0.0, measured=Ellipse(8.0, 4.0))
    )
    outline = next(root.iter(f"{SVG}image"))
    assert_allclose(float(outline.get("height")) / float(outline.get("width")), 13.8 / 11.8, rtol=1e-3)


def test_formulas_become_text():
    found = runs(r"fit, $A \propto W^{0.60 ± 0.02}$ and $R_\mathrm{g}^\mathrm{corr}$")
    assert [(run.text, run.script, run.slanted) for run in found] == [
        ("fit, ", 0, False), ("A", 0, True), (" ∝ ", 0, False), ("W", 0, True),
        *((sign, 1, False) for sign in ("0", ".", "6", "0", " ± ", "0", ".", "0", "2")),
        (" and ", 0, False), ("R", 0, True), ("g", -1, False), ("corr", 1, False),
    ]  # fmt: skip


def test_data_survive_the_file_and_nothing_changes_from_one_writing_to_the_next(tmp_path):
    figure, _ = drawn(PLOTS["radius"])
    for folder in (tmp_path / "a", tmp_path / "b"):
        folder.mkdir()
        drawing = figures.save_figure(figure, folder / "radius.v2.svg", description='R < 2 & "more"')
        data = figures.save_figure(figure, folder / "radius.v2.json")
        figure = Figure.of_json(data.read_text("utf-8"))
    for name in ("radius.v2.svg", "radius.v2.json"):
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()
    assert ElementTree.parse(drawing).getroot().get("aria-label") == 'R < 2 & "more"'


@pytest.mark.parametrize("values", [[], [np.nan, np.nan], [np.nan, 1.0]])
@pytest.mark.parametrize(
    "plot", [figures.plot_corrected_radius, figures.plot_area_against_load, figures.plot_aspect_ratio]
)
def test_missing_values(plot, values):
    figure, root = drawn(lambda axes: plot(axes, values, values, synthetic=True))
    assert "nan" not in ElementTree.tostring(root, encoding="unicode")
    points = [mark.y for mark in figure.panels[0].marks if isinstance(mark, Points)]
    shown = np.concatenate([*points, []])
    assert shown[np.isfinite(shown)].tolist() == [value for value in values if np.isfinite(value)]


def test_ids_are_those_of_one_figure_and_found():
    drawings = [figures.svg(drawn(PLOTS["radius"])[0], name) for name in ("a", "b")]
    ids = [re.findall(r'\bid="([^"]+)"', one) for one in drawings]
    assert set(ids[0]).isdisjoint(ids[1])
    for one, found in zip(drawings, ids, strict=True):
        assert len(found) == len(set(found)) > 1
        assert {a or b for a, b in re.findall(r'href="#([^"]+)"|url\(#([^)]+)\)', one)} <= set(found)


def test_a_full_disk_is_named_with_the_way_out(tmp_path):
    (tmp_path / "drawn.svg").symlink_to("/dev/full")
    figure, _ = figures.new_panels()
    with pytest.raises(FingerpadError, match=r"drawn\.svg: cannot be written \(No space left .* make room"):
        figures.save_figure(figure, tmp_path / "drawn.svg")
