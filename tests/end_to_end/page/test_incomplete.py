"""A study that lacks something: its pictures show, and what is missing is entered where it stands."""

import re
import tomllib

import pytest
from playwright.sync_api import expect
from tests.end_to_end.page.browser import Tab, numbers, require_picture


def without(example, pattern: str) -> None:
    """Take the first place of a pattern out of the manifest."""
    manifest = example / "study.toml"
    text, count = re.subn(pattern, "", manifest.read_text(), count=1)
    assert count == 1
    manifest.write_text(text)


def stated(example) -> dict:
    return tomllib.loads((example / "study.toml").read_text())


@pytest.mark.nightly
def test_a_photograph_without_face_shows_and_takes_its_face(example_tab: Tab, example) -> None:
    without(example, r'face = "palmar", ')
    example_tab.expected.append("422")
    page = example_tab.open("photographs")
    require_picture(page)
    side = page.locator(".inspector")
    side.get_by_role("alert").get_by_text("state which face").wait_for()
    expect(page.get_by_role("alert")).to_have_count(1)
    expect(page.get_by_text("state which face")).to_have_count(1)  # not on the picture as well
    expect(page.locator("#work")).not_to_contain_text("null")
    expect(page.locator("#work")).not_to_contain_text("scale no scale")
    # The other faces of the finger measure, and the contacts too, though no model applies yet.
    page.keyboard.press("ArrowRight")
    numbers(page, "face")
    example_tab.go("contacts")
    require_picture(page)
    assert "Gross area" in numbers(page)
    example_tab.go("photographs")
    side.get_by_label(re.compile("which face it shows is missing")).select_option("palmar")
    numbers(page, "finger")
    assert stated(example)["fingers"][0]["photographs"][0]["face"] == "palmar"
    # One that is of no use goes, and the finger stays.
    example_tab.go("study")
    page.get_by_role("button", name="Remove the photograph photograph_radial.jpg").click()
    page.get_by_role("button", name="Remove", exact=True).click()
    page.get_by_role("button", name="Remove the photograph photograph_radial.jpg").wait_for(state="detached")
    assert [one["face"] for one in stated(example)["fingers"][0]["photographs"]] == ["palmar", "distal"]


def test_a_photograph_that_is_gone_is_named_and_frames_are_counted(tab: Tab, demo) -> None:
    (demo / "synthetic" / "photograph_palmar.jpg").unlink()
    tab.expected.append("404")
    page = tab.open()
    page.get_by_text("photograph_palmar.jpg is missing or cannot be shown.").wait_for()
    expect(page.locator("h1 + p")).to_contain_text("1 sequence of 24 frames")
    expect(page.get_by_role("region", name="Contacts", exact=True)).to_contain_text("1 sequence of 24 frames")


def test_a_curve_is_missed_by_its_file_and_a_new_scale_is_begun(example_tab: Tab, example) -> None:
    without(example, r'wedge_angle_deg = 30\nsynthetic = true\n(?=file = "loading)')
    without(example, r', scale = "camera"')
    page = example_tab.open()
    missing = page.get_by_role("group", name="Missing entries").locator("li")
    expect(missing.filter(has_text="the wedge angle is missing")).to_contain_text("loading_curve.csv")
    missing.get_by_role("link", name="New scale").click()
    expect(page.get_by_label("Name", exact=True)).to_have_value("")


def test_a_contact_without_load_or_scale_shows_and_takes_them(example_tab: Tab, example) -> None:
    without(example, r"load_N = 1\n")
    without(example, r'scale = "reader"\n(?=\n\[\[observations\]\]\nname = "contact_1N")')
    example_tab.expected.append("422")
    page = example_tab.open("contacts/images/contact_1N")
    require_picture(page)
    side = page.locator(".inspector")
    assert "Gross area" in numbers(page)
    side.get_by_text("the load is missing").wait_for()
    side.get_by_label(re.compile("the load is missing")).fill("1")
    side.get_by_label(re.compile("the load is missing")).press("Enter")
    side.get_by_text("the load is missing").wait_for(state="detached")
    assert stated(example)["observations"][1]["load_N"] == 1
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
    assert stated(example)["observations"][0]["scale"] == "reader"
