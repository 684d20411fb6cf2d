"""What the page shows and keeps before the first run."""

import shutil

import numpy as np
import pytest
from playwright.sync_api import expect
from tests.end_to_end.page.browser import Tab, numbers, unexplained

from fingerpad.study.results.table import GLOSSARY

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
