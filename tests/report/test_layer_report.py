"""The report on tissue over bone: both theories side by side, or what a thickness would change."""

import html
import re

import pytest
from tests.studies import contact, curve, finger, page_of, rows_by, run

from fingerpad._rounding import value_with_uncertainty
from fingerpad.report.layer import comparisons
from fingerpad.study.results.study_result import StudyResult


@pytest.fixture(scope="module")
def report(tmp_path_factory) -> tuple[StudyResult, str]:
    folder = tmp_path_factory.mktemp("layer")
    of = {"finger": "thick"}
    result = run(
        folder,
        finger("thick", effective_thickness_mm=8.0, effective_thickness_mm_std=1.5),
        contact("a", 1, (6.0, 5.0), **of),
        contact("b", 2, (7.4, 5.0), **of),
        contact("wide", 2, (14.0, 5.0), wedge=45, **of),
        curve(loading_radius_mm=19.7, loading_radius_mm_std=0.4, **of),
        uncertainty={"wedge_angle_deg_std": 0, "roll_angle_deg_std": 0},
    )
    return result, page_of(result, folder / "out")


def cells(text: str, quantity: str, of: str) -> list[str]:
    """Return the cells of a line of the table as text."""
    for line in re.findall(r"<tr>.*?</tr>", text, flags=re.DOTALL):
        found = [
            html.unescape(re.sub("<.*?>", "", cell)) for cell in re.findall("<td.*?</td>", line, re.DOTALL)
        ]
        if found[:2] == [quantity, of]:
            return found
    raise AssertionError(quantity)


QUANTITIES = {
    "Young's modulus E from load and area (kPa)": ("youngs_modulus_kpa", "youngs_modulus_on_layer_kpa"),
    "indentation ξ from the area (mm)": ("indentation_mm", "indentation_on_layer_mm"),
    "Rg to expect, A/(πξ) (mm)": ("geometric_radius_from_compliance_mm", "loading_radius_on_layer_mm"),
}


def test_both_theories_side_by_side(report):
    result, text = report
    row = rows_by(result)["b"]
    for quantity, names in QUANTITIES.items():
        found = cells(text, quantity, "b, 2 N")
        assert found[2:4] == [value_with_uncertainty(row[name], row[f"{name}_std"]) for name in names]
        assert found[4].startswith("thickness ")


def test_the_mean_and_the_measured_radius(report):
    _, text = report
    assert "on 8.0 ± 1.5 mm" in text
    assert cells(text, "Young's modulus E from load and area (kPa)", "mean of 2 contacts")
    assert "19.70 ± 0.40" in cells(text, "Rg measured (mm)", "loading data")


def test_a_contact_out_of_range_is_named(report):
    _, text = report
    assert "wide is out of the range of the laws: the contact is wider than 0.6 of the pad" in text
    assert cells(text, "Young's modulus E from load and area (kPa)", "wide, 2 N")[3] == "–"
    assert not re.search(r"\bnan\b", re.sub("<svg.*?</svg>", "", text, flags=re.DOTALL), re.IGNORECASE)


def test_one_section_and_no_conditional_figure(report):
    result, text = report
    captions = re.findall("<figcaption>(.*?)</figcaption>", text, flags=re.DOTALL)
    assert sum(caption.startswith("Section along the finger under b") for caption in captions) == 1
    assert not any("Conditional" in caption for caption in captions)
    assert [len(comparisons(result, summary)) for summary in result.summaries] == [4, 3]
