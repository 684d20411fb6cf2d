"""The page at 1366 px, and on small screens: at 390 px, and at 1366 px with 200 %, which are 683."""

import pytest
from playwright.sync_api import Page, expect
from tests.end_to_end.page.browser import Tab, box, numbers, settle

STEPS = ("study", "scale", "photographs", "contacts", "pad", "results", "run")
# How far the page, or its work area, can be scrolled sideways.
SIDEWAYS = """() => Math.max(...['html', '#work'].map((one) => document.querySelector(one))
  .map((one) => one.scrollWidth - one.clientWidth))"""


def resize(page: Page, width: int, height: int = 800) -> None:
    """Give the window a size, and wait until the page is drawn in it."""
    page.set_viewport_size({"width": width, "height": height})
    page.wait_for_function("width => innerWidth === width", arg=width)
    settle(page)


@pytest.mark.nightly
def test_nothing_scrolls_sideways_and_a_contact_is_accepted(example_tab: Tab) -> None:
    page = example_tab.open()
    for width, item, following in ((390, "contact_0.5N", "contact_1N"), (683, "contact_1N", "contact_2N")):
        resize(page, width, 780)
        for step in STEPS:
            example_tab.go(step)
            page.locator("#work h1").first.wait_for()
            page.wait_for_timeout(200)
            assert page.evaluate(SIDEWAYS) <= 0, (step, width)
            place = box(page.locator("[aria-current=step]"))
            assert place["x"] >= 0, (step, width)
            assert place["x"] + place["width"] <= width, (step, width)
        # What a column of the study's tables holds is named beside it, not beyond the edge.
        example_tab.go("study")
        require_tables_that_fit(page)
        example_tab.go(f"contacts/images/{item}")
        page.get_by_role("heading", name=item).wait_for()
        numbers(page)
        assert box(page.locator(".stage"))["width"] > 0.95 * width
        page.get_by_role("button", name="Accept and next").click()
        page.get_by_role("heading", name=following).wait_for()


def require_tables_that_fit(page: Page) -> None:
    page.locator(".study-grid .table-wrap").first.wait_for()
    for each in page.locator(".study-grid .table-wrap").all():
        if each.is_visible():
            name = each.get_attribute("aria-label")
            assert each.evaluate("one => one.scrollWidth <= one.clientWidth"), name


def test_tables_and_names_on_the_pad_fit(tab: Tab) -> None:
    page = tab.open()
    require_tables_that_fit(page)
    assert page.locator("#sidebar").evaluate("one => one.scrollWidth <= one.clientWidth")
    tab.go("pad")
    page.get_by_text("u = 0°", exact=True).wait_for()
    expect(page.locator(".pad-caption")).to_contain_text("parametric angle u")
    names = page.locator(".pad-scene svg text")
    for width, height in ((390, 780), (683, 384), (1366, 768)):
        resize(page, width, height)
        names.first.wait_for()
        texts = names.all_text_contents()
        assert any(each.startswith("across") for each in texts)
        assert any(each.startswith("along") for each in texts)
        boxes = names.evaluate_all(
            """(all) => all.map((one) => one.getBBox())
              .map(({ x, y, width, height }) => [x, x + width, y, y + height])"""
        )
        for place, (left, right, top, bottom) in enumerate(boxes):
            for start, end, above, below in boxes[:place]:
                assert left >= end or start >= right or top >= below or above >= bottom, (width, texts)
