"""A study that lacks something: its pictures show, and what is missing is entered where it stands."""

import re
import tomllib

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
