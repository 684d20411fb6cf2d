"""Results in notebooks: a short repr, a summary, and a drawing."""

import base64
import dataclasses
import io
import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import fingerpad as fp
from fingerpad._display import Displayed, record_text
from fingerpad.figures.marks import Text
from fingerpad.image import BrushStroke, Picture, prepare_contact_image
from fingerpad.simulate import render_contact_image, render_finger, simulate_loading_curve
from fingerpad.uncertainty import sobol_indices

PAD = fp.Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8)
CURVE = simulate_loading_curve(points=200, force_std=0.005, area_std=0.5, seed=1)

SOFT = fp.Tissue(youngs_modulus=0.1)


@cache
def contact():
    return render_contact_image(semi_major=5.0, semi_minor=4.0, ppi=250, seed=2)


@pytest.fixture(scope="module")
def results() -> dict[str, object]:
    finger = render_finger("palmar", semi_axes=(11.8, 13.8), mm_per_px=0.1, seed=1)
    return {
        "contact image": fp.measure_contact_image(contact().pixels, fp.Scale.of_ppi(250)),
        "photograph": fp.measure_photograph(finger.pixels, "palmar", 0.1),
        "fit": fp.fit_loading_curve(CURVE),
        "contact": fp.hertz_contact(fp.Paraboloid(12.955, 14.330), SOFT, load=[1.0, 2.0]),
        "placement": fp.Placement(PAD, wedge_angle=0.5),
        "curve": CURVE,
        "many": fp.Paraboloid(np.linspace(10, 12, 1000), 14.0),
        "many contacts": fp.fast_contact(fp.Placement(PAD, wedge_angle=0.5), SOFT, load=np.ones(1000)),
        "picture": Picture(pixels=contact().pixels, dots_per_inch=250),
        "stroke": BrushStroke(action="add", points=[(row, 10.0) for row in range(1000)], radius=5),
    }


MAX_REPR = 610
DRAWN = ("contact image", "photograph", "fit", "contact", "placement")


def test_reprs_are_short(results: dict[str, object]) -> None:
    assert {name: len(repr(result)) for name, result in results.items() if len(repr(result)) > MAX_REPR} == {}
    assert repr(results["curve"]).startswith("LoadingCurve(load=<array (200,)>, indentation=<array (200,)>")
    assert "_view" not in repr(results["contact image"])


def test_public_dataclasses_have_summaries() -> None:
    classes = [kind for name in fp.__all__ if dataclasses.is_dataclass(kind := getattr(fp, name))]
    assert len(classes) > 10
    own = [kind for kind in classes if not issubclass(kind, Displayed) or "__repr__" in vars(kind)]
    assert own == [fp.FrameRate]  # of a few numbers


def test_numbers_are_shown_by_their_names() -> None:
    inputs = fp.Inputs.of(a=(2.0, 0.3), b=(1.0, 0.5))
    found = sobol_indices(lambda a, b: {"product": a * b}, inputs)["product"]
    assert f"first=(a: {found.first['a']:.6g}, b: {found.first['b']:.6g})" in repr(found)
    assert "groups=(a, b)" in repr(inputs)


def test_uncertain_outputs_print_one_line_each() -> None:
    quantities = {"palmar": (7.9, 0.1), "distal": (13.8, 0.1), "radial_ulnar": (11.8, 0.1)}
    quantities |= {"semi_major": (7.4, 0.1), "semi_minor": (5.0, 0.1)}
    angle = (np.radians(30), np.radians(0.5))
    result = fp.pad_uncertainty(**quantities, load=(2, 0.02), wedge_angle=angle)
    assert str(result).splitlines()[0] == "Propagated"
    assert re.search(r"\n  radius_from_indentation +13\.80 ± 0\.18\n", str(result))
    assert len(str(result).splitlines()) == 1 + len(result.names)
    assert len(repr(result)) < 600
    assert "<pre>Propagated" in result._repr_html_()
    radius = result["radius_from_indentation"]
    assert f"{radius}" == str(radius)
    assert str(radius).startswith("13.80 ± 0.18")
    two = fp.pad_uncertainty(**quantities, load=([1.0, 2.0], 0.02), wedge_angle=0.5)
    assert "\n  indentation " in str(two)
    assert f"{two['indentation']:.1f}" == repr(two["indentation"])  # of several, as without a format


def test_summaries_show_uncertainties(results: dict[str, object]) -> None:
    image, fit = results["contact image"], results["fit"]
    line = next(line for line in image.summary().splitlines() if "gross_area_mm2" in line)
    assert re.fullmatch(r"  gross_area_mm2 +\d+\.\d+ ± \d\.\d+", line)
    assert f"{image.gross_area:.1f}" in line
    assert re.search(r"Young.s modulus E at 2 N +[\d.]+ ± [\d.]+ kPa", fit.summary())
    assert re.search(r"distal_mm +13\.\d+ ± ", results["photograph"].summary())
    assert "indentation" in results["many contacts"].summary()


def test_notebook_drawings(results: dict[str, object]) -> None:
    for name, result in results.items():
        html = result._repr_html_()
        assert "<pre>" in html
        assert ("<img" in html) is (name in DRAWN), name
        assert len(html) < 1_500_000
    data = re.search(r"base64,([^\"]+)", results["contact image"]._repr_html_())[1]
    shown = np.array(Image.open(io.BytesIO(base64.b64decode(data))).convert("RGB")).astype(int)
    green = (abs(shown - (0, 158, 115)) < 60).all(axis=-1)
    assert green.any()  # the outline of the contact


@pytest.mark.parametrize(
    ("name", "file", "start"),
    [
        ("contact image", "a.png", b"\x89PNG"),
        ("photograph", "a.jpg", b"\xff\xd8"),
        ("fit", "a.svg", b"<?xml"),
        ("contact", "a.pdf", b"%PDF"),
        ("placement", "a.png", b"\x89PNG"),
    ],
)
def test_show_saves_by_suffix(results, tmp_path: Path, name: str, file: str, start: bytes) -> None:
    drawing = fp.show(results[name], str(tmp_path / file))
    assert (tmp_path / file).read_bytes().startswith(start)
    assert drawing._repr_png_().startswith(b"\x89PNG")
    assert len(repr(drawing)) < 100


def test_each_of_several_contacts_is_named_by_its_load(results) -> None:
    _, pressures = fp.show(results["contact"]).content.panels
    assert [mark.text for mark in pressures.marks if isinstance(mark, Text)] == ["W = 1", "W = 2"]


def test_show_errors(results, tmp_path: Path) -> None:
    prepared = prepare_contact_image(contact().pixels, fp.Scale.of_ppi(250)).measure()
    many = fp.hertz_contact(fp.Paraboloid(12, 14), SOFT, load=np.ones(30))
    for given, words in (
        ((CURVE,), "no drawing of a LoadingCurve: give a measured image"),
        ((results["fit"], tmp_path / "a.xyz"), r"written as \.svg, .* found a\.xyz"),
        ((results["fit"], tmp_path / "no-folder/a.png"), "no-folder/a.png: cannot be written"),
        ((results["photograph"], tmp_path / "a.xyz"), "a.xyz: cannot be written"),
        ((many,), "up to 20 contacts can be drawn, found 30"),
        ((fp.Placement(PAD, wedge_angle=[0.4, 0.5]),), "one placement can be drawn, found 2"),
        ((prepared,), r"not kept .* draw_overlay\(pixels, result\)"),
    ):
        with pytest.raises(fp.FingerpadError, match=words):
            fp.show(*given)
    assert prepared._repr_html_().startswith("<pre>")


def test_summaries_leave_out_only_what_is_empty() -> None:
    record = {"width_mm": np.float64(1.5), "zero_mm": 0.0, "flags": (), "centre_mm": np.ones(2), "none": None}
    lines = [line.split()[0] for line in record_text("Record", record).splitlines()]
    assert lines == ["Record", "width_mm", "zero_mm", "centre_mm"]
