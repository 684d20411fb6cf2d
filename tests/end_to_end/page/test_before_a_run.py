"""What the page shows and keeps before the first run."""

import re
import shutil

import numpy as np
import pytest
from playwright.sync_api import expect
from tests.end_to_end.page.browser import Tab, enter, manifest, numbers, require_picture, tab_on, unexplained
from tests.smooth_study import area_at, make_smooth_study

from fingerpad.web.glossary import GLOSSARY

# Of the example's pad, of which the photographs are rendered.
TRUTH_MM = (7.9, 13.8, 11.8)


def test_pad_and_contact_take_the_semi_axes_of_the_photographs(example_tab: Tab) -> None:
    page = example_tab.open("pad")
    numbers(page, "u")
    rows = page.locator(".inspector dl.readings").first.locator("dd").all_inner_texts()
    seen, stds = np.transpose([[float(part) for part in row.split(" mm")[0].split("±")] for row in rows])
    assert stds.min() > 0
    assert seen == pytest.approx(TRUTH_MM, abs=0.3)
    # Entered here, they start from those; without any finger none is assumed.
    page.get_by_label("Finger", exact=True).select_option("")
    numbers(page, "u")
    assert float(page.get_by_label("Distal", exact=True).input_value()) == pytest.approx(13.8, abs=0.3)
    example_tab.go("contacts/images/contact_1N")
    assert "mm" in numbers(page, "radius")
    # Symbols are explained on hover and on focus, in the words of the library.
    assert page.locator(".symbol").count() > 5
    assert unexplained(page) == []
    tip = page.get_by_role("tooltip")
    page.locator(".inspector [data-term=R_Aξ]").hover()
    tip.get_by_text(GLOSSARY["R_Aξ"].meaning).wait_for()
    page.mouse.move(1, 1)
    tip.wait_for(state="hidden")
    page.locator(".inspector [data-term=ξ]").focus()
    tip.get_by_text(GLOSSARY["ξ"].meaning).wait_for()
    page.keyboard.press("Escape")
    tip.wait_for(state="hidden")
    page.get_by_role("button", name="Other studies").click()
    page.get_by_label("Title").fill("Empty")
    page.keyboard.press("Enter")
    page.get_by_role("heading", name="Empty").wait_for()
    example_tab.go("pad")
    page.get_by_role("heading", name="No semi-axes yet").wait_for()
    expect(page.get_by_label("Palmar", exact=True)).to_have_value("")
    expect(page.locator(".pad-scene")).to_be_hidden()


def test_names_of_other_signs_are_refused_in_their_field(example_tab: Tab, example, tmp_path) -> None:
    page = example_tab.open("study")
    before = (example / "study.toml").read_text()
    page.get_by_role("button", name="Add a finger").click()
    name = page.get_by_label("Name of the finger")
    name.fill("left/index")
    page.get_by_role("button", name="Add", exact=True).click()
    page.get_by_role("dialog").wait_for()
    expect(name).to_be_focused()
    assert name.evaluate("field => field.matches(':invalid')")
    assert "as in left_index" in name.get_attribute("title")
    page.get_by_role("button", name="Cancel").click()
    shutil.copy(example / "contact_1N.png", tmp_path / "a print.png")
    page.locator("input[type=file]").set_input_files([tmp_path / "a print.png"])
    finger = page.get_by_label("Finger on a-print.png")
    finger.fill("left/index")
    page.get_by_role("button", name="Add to study").click()
    expect(finger).to_be_focused()
    assert finger.evaluate("field => field.matches(':invalid')")
    assert (example / "study.toml").read_text() == before


# A study that lacks something: its pictures show, and what is missing is entered where it stands


def without(example, pattern: str) -> None:
    """Take the first place of a pattern out of the manifest."""
    manifest = example / "study.toml"
    text, count = re.subn(pattern, "", manifest.read_text(), count=1)
    assert count == 1
    manifest.write_text(text)


def test_a_contact_without_load_or_scale_shows_and_takes_them(example_tab: Tab, example) -> None:
    without(example, r"load_N = 1\n")
    without(example, r'scale = "reader"\n(?=\n\[\[observations\]\]\nname = "contact_1N")')
    example_tab.expected.append("422")
    page = example_tab.open("contacts/images/contact_1N")
    require_picture(page)
    side = page.locator(".inspector")
    assert "Gross area" in numbers(page)
    side.get_by_text("the load is missing").wait_for()
    enter(side.get_by_label(re.compile("the load is missing")), "1")
    side.get_by_text("the load is missing").wait_for(state="detached")
    assert manifest(example)["observations"][1]["load_N"] == 1
    page.keyboard.press("ArrowLeft")
    require_picture(page)
    side.get_by_role("alert").get_by_text("state the scale").wait_for()
    expect(page.locator(".scale-bar")).to_be_hidden()  # not that of the picture before
    # A correction is kept before the entry is complete.
    page.keyboard.press("x")  # which goes on to the next image
    page.wait_for_url(re.compile("contact_1N"))
    assert '"rejected"' in (example / "corrections.jsonl").read_text()
    # And in the list on the study's page.
    example_tab.go("study")
    page.get_by_label(re.compile("its scale is missing .contact_0.5N")).select_option("reader")
    page.get_by_text("Nothing is missing.").wait_for()
    assert manifest(example)["observations"][0]["scale"] == "reader"


# The surface of contacts: chosen on the page for a contact, a sequence and a study, and said above it


@pytest.fixture
def smooth(tmp_path):
    return make_smooth_study(tmp_path / "smooth", None).parent


@pytest.fixture
def page_of(browser, smooth):
    with tab_on(browser, smooth.parent, smooth) as tab:
        yield tab.open


def area(page) -> float:
    return float(re.search(r"Gross area\s+([\d.]+) ±", numbers(page)).group(1))


def test_a_contact_is_said_to_be_smooth(page_of, smooth) -> None:
    page = page_of("contacts/images/contact")
    page.get_by_label("Surface", exact=True).select_option("smooth")
    expect(page.get_by_text("smooth surface", exact=True)).to_be_visible()
    expect(page.locator("[data-live=numbers]")).to_contain_text("Gross area")
    assert area(page) == pytest.approx(area_at(2.0), rel=0.02)
    assert "Ridge" not in numbers(page)
    assert page.get_by_label("Threshold, grey levels").count() == 0
    assert manifest(smooth)["observations"][0]["surface"] == "smooth"
    page.get_by_label("Surface", exact=True).select_option("ridged")
    expect(page.get_by_text("smooth surface", exact=True)).to_have_count(0)
    assert manifest(smooth)["observations"][0]["surface"] == "ridged"
