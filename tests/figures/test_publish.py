"""Figures for publication: sizes in mm and pixels, data as CSV, axes, colours, and refusals in words."""

import csv
import io
import json
import re
from xml.etree import ElementTree

import numpy as np
import pytest
from numpy.testing import assert_allclose
from PIL import Image
from tests import command

from fingerpad.exceptions import FigureError
from fingerpad.figures import (
    new_panels,
    plot_area_against_load,
    plot_aspect_ratio,
    plot_corrected_radius,
    plot_press,
    publish,
)
from fingerpad.figures.marks import Figure, Points
from fingerpad.figures.mpl import draw_figure

LOAD = np.array([0.25, 0.5, 1.0, 2.0])
VALUE = np.array([13.1, 13.4, 13.25, 13.9])
STD = np.array([0.1, 0.2, 0.15, 0.3])


@pytest.fixture(scope="module")
def figure():
    made, (panel,) = new_panels()
    plot_corrected_radius(panel, LOAD, VALUE, corrected_radius_std=STD, measured_radius=15.0)
    return made


def data_of(figure: Figure) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(publish.figure_csv(figure))))


@pytest.mark.parametrize("width_mm", [89.0, 190.0])
def test_width_as_asked(figure, width_mm):
    settings = publish.FigureSettings(width_mm=width_mm, height_mm=60.0, dpi=150)
    with Image.open(io.BytesIO(publish.figure_file(figure, "png", settings))) as picture:
        assert picture.size == (round(width_mm / 25.4 * 150), round(60 / 25.4 * 150))
        assert_allclose(picture.info["dpi"], 150, atol=0.05)
    box = re.search(rb"/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]", publish.figure_file(figure, "pdf", settings))
    assert_allclose([float(end) / 72 * 25.4 for end in box.groups()], [width_mm, 60.0], atol=0.01)
    root = ElementTree.fromstring(publish.figure_file(figure, "svg", settings))
    assert_allclose(float(root.get("width").removesuffix("pt")) / 72 * 25.4, width_mm, atol=0.01)


def test_csv_has_the_plotted_data(figure):
    rows = data_of(figure)
    points = [row for row in rows if row["series"] == "Rgcorr"]
    for name, expected in (("x", LOAD), ("y", VALUE), ("y_std", STD)):
        assert_allclose([float(row[name]) for row in points], expected, rtol=1e-6)
    assert {row["x_name"] for row in rows} == {"normal load W (N)"}
    assert [row["y"] for row in rows if row["series"] == "level"] == ["15.0"]
    (axes,) = draw_figure(figure).axes
    assert_allclose(axes.containers[0][0].get_xydata(), np.transpose([LOAD, VALUE]))
    made, (panel,) = new_panels()
    plot_area_against_load(panel, [0.5, 1, 2], [46, 74, 117], exponent=0.67, exponent_std=0.01)
    bands = [row for row in data_of(made) if row["series"] == "band"]
    assert bands
    assert all(float(row["y_low"]) <= float(row["y_high"]) for row in bands)


def test_axes_font_and_colours(figure):
    settings = publish.FigureSettings(
        x_low=0.1, x_high=3, y_high=20, x_scale="log", font_pt=10, colours="black,#aa0000"
    )
    wanted = publish.with_settings(figure, settings)
    drawn, (panel,) = draw_figure(wanted), wanted.panels
    drawn.canvas.draw()
    (axes,) = drawn.axes
    assert (axes.get_xscale(), axes.get_xlim(), axes.get_ylim()[1]) == ("log", (0.1, 3.0), 20.0)
    assert_allclose((axes.get_xlim(), axes.get_ylim()), (panel.limits("x"), panel.limits("y")))
    assert axes.containers[0][0].get_color() == "#000000"
    assert axes.xaxis.label.get_fontsize() == 10
    drawing = publish.figure_file(figure, "svg", settings).decode()
    assert re.search(r'font-size="10"[^>]*>normal load W', drawing)
    assert publish.figure_colours(figure)[0].lower() not in drawing.lower()
    linear = publish.with_settings(wanted, publish.FigureSettings(x_scale="linear", x_low=0))
    (axes,) = draw_figure(linear).axes
    assert (axes.get_xscale(), axes.get_xlim()[0]) == ("linear", 0)


def test_one_end_beyond_the_data_is_refused(figure):
    with pytest.raises(FigureError, match="x_range: the axis would end at .* and begin at 7: give both ends"):
        draw_figure(publish.with_settings(figure, publish.FigureSettings(x_low=7)))
    (axes,) = draw_figure(publish.with_settings(figure, publish.FigureSettings(x_low=7, x_high=9))).axes
    assert axes.get_xlim() == (7, 9)


def test_same_bytes_each_time(figure):
    for kind in ("svg", "pdf", "png"):
        settings = publish.FigureSettings(width_mm=60, dpi=60)
        assert publish.figure_file(figure, kind, settings) == publish.figure_file(figure, kind, settings)


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"width_mm": 3.0}, "width_mm: .*20 to 500 mm"),
        ({"height_mm": float("nan")}, "height_mm: "),
        ({"font_pt": 0}, "font_pt: labels have 3 to 30 points"),
        ({"dpi": 1e6}, "dpi: "),
        ({"x_low": 2, "x_high": 1}, "x_range: an axis goes from a smaller to a larger number, found 2 to 1"),
        ({"y_low": float("inf")}, "y_range: "),
        ({"y_low": 0, "y_high": 1, "y_scale": "log"}, "y_range: a logarithmic axis has no zero"),
        ({"x_scale": "cubic"}, "x_scale: an axis is linear or log, found 'cubic'"),
        ({"colours": "blue,no colour"}, "colours: .*'no colour'"),
    ],
)
def test_bad_values_refused_in_words(settings, words):
    with pytest.raises(FigureError, match=words):
        publish.FigureSettings(**settings)


def test_panels_of_several_quantities_keep_their_axes():
    made, panels = new_panels(rows=2, columns=2)
    columns = dict.fromkeys(("time", "load", "area", "semi_major", "semi_minor"), LOAD)
    plot_press(panels, **columns, phase=["loading"] * 4)
    with pytest.raises(FigureError, match="the panels of this figure show 2 quantities"):
        draw_figure(publish.with_settings(made, publish.FigureSettings(x_low=0, x_high=1)))
    assert len(draw_figure(publish.with_settings(made, publish.FigureSettings(width_mm=183))).axes) == 4


def test_from_the_command_line(figure, tmp_path):
    data = tmp_path / "radius.json"
    data.write_text(figure.to_json(), encoding="utf-8")

    def cli(*arguments) -> tuple[int, str]:
        code, _, err = command.run("figure", data, "--out", *arguments)
        return code, err

    out = tmp_path / "radius.png"
    assert cli(out, "--width-mm", 89, "--dpi", 100, "--x-range", "0.1:", "--x-scale", "log") == (0, "")
    with Image.open(out) as picture:
        assert picture.width == round(89 / 25.4 * 100)
    assert cli(tmp_path / "radius.csv") == (0, "")
    assert (tmp_path / "radius.csv").read_text(encoding="utf-8") == publish.figure_csv(figure)
    for arguments, words in (
        (
            (tmp_path / "radius.gif",),
            "a figure is written as .svg, .pdf, .png, .csv or .json, found radius.gif",
        ),
        ((out, "--y-range", "1"), "--y-range: takes two numbers separated by a colon, found '1'"),
        ((out, "--width-mm", 1), "--width-mm: a figure is 20 to 500 mm wide and high, found 1"),
    ):
        code, said = cli(*arguments)
        assert code != 0
        assert words in said
    data.write_text("[]")
    assert "not a figure of a report" in cli(out)[1]


LINE = {"x": [0, 1], "y": [0, 1]}


@pytest.mark.parametrize(
    ("kind", "options", "panel"),
    [
        ("remove", {}, {}),
        ("points", LINE | {"usetex": True}, {}),
        ("points", {"x": [0, 1], "y": [0, 1, 2]}, {}),
        ("points", {"x": [0, 1], "y": ["a", 1]}, {}),
        ("line", LINE | {"colour": '"/><script>'}, {}),
        ("line", LINE | {"dash": [0, [1, 1]]}, {}),
        ("line", LINE | {"width": "1"}, {}),
        ("line", LINE | {"label": {"object": "<b>"}}, {}),
        (["line"], LINE, {}),
        ("text", {"text": 7, "x": 0, "y": 0}, {}),
        ("picture", {"png": '"', "left": 0, "right": 1, "bottom": 0, "top": 1}, {}),
        ("line", LINE, {"transform": 1}),
        ("line", LINE, {"x": {"label": None}}),
        ("line", LINE, {"columns": "2"}),
        ("line", LINE, {"marks": {"line": LINE}}),
        ("line", LINE, {"place": [0.1, 0.1, 0.8]}),
    ],
)
def test_a_file_of_a_figure_can_only_draw(kind, options, panel):
    marks = {"marks": [[kind, options]], "x": {}, "y": {}} | panel
    made = {"width_mm": 85, "height_mm": 64, "rows": 1, "columns": 1, "panels": [marks]}
    with pytest.raises(ValueError, match=r"figure|takes no|could not|broadcast"):
        Figure.of_json(json.dumps(made))


@pytest.mark.parametrize("plot", [plot_corrected_radius, plot_area_against_load, plot_aspect_ratio])
def test_a_contact_left_out_is_faded_and_named_so_in_the_data(plot):
    made, (panel,) = new_panels()
    plot(panel, LOAD, VALUE, left_out=[False, True, False, False], synthetic=[0, 0, 0, 1])
    faded = [mark for mark in panel.marks if isinstance(mark, Points) and mark.alpha < 1]
    assert [mark.x.tolist() for mark in faded] == [[0.5]]
    assert {row["x"] for row in data_of(made) if "left out" in row["series"]} == {"0.5"}
    assert 'opacity="0.4"' in publish.figure_file(made, "svg", publish.FigureSettings()).decode()
    assert 0.4 in [one[0].get_alpha() for one in draw_figure(made).axes[0].containers]
