"""The page on small screens: at 390 px, and at 1366 px with 200 %, which are 683."""

import pytest
from playwright.sync_api import expect
from tests.end_to_end.page.browser import Tab, numbers

STEPS = ("study", "scale", "photographs", "contacts", "pad", "results", "run")
# How far the page, or its work area, can be scrolled sideways.
SIDEWAYS = """() => Math.max(...['html', '#work'].map((one) => document.querySelector(one))
  .map((one) => one.scrollWidth - one.clientWidth))"""


@pytest.mark.parametrize("width", [390, 683])
def test_nothing_scrolls_sideways_and_a_contact_is_accepted(example_tab: Tab, width: int) -> None:
    page = example_tab.open()
    page.set_viewport_size({"width": width, "height": 780})
    for step in STEPS:
        example_tab.go(step)
        page.locator("#work h1").first.wait_for()
        page.wait_for_timeout(200)
        assert page.evaluate(SIDEWAYS) <= 0, step
        box = page.locator("[aria-current=step]").bounding_box()
        assert box["x"] >= 0, step
        assert box["x"] + box["width"] <= width, step
    # What a column of the study's tables holds is named beside it, not beyond the edge.
    example_tab.go("study")
    tables = page.locator(".study-grid .table-wrap")
    tables.first.wait_for()
    assert all(
        each.evaluate("one => one.scrollWidth <= one.clientWidth")
        for each in tables.all()
        if each.is_visible()
    )
    example_tab.go("contacts/images/contact_1N")
    numbers(page)
    assert page.locator(".stage").bounding_box()["width"] > 0.95 * width
    page.get_by_role("button", name="Accept and next").click()
    page.get_by_role("heading", name="contact_2N").wait_for()


@pytest.mark.parametrize("study", ["example_tab", "tab"])
def test_tables_of_the_study_fit_beside_what_is_shared(request, study: str) -> None:
    page = request.getfixturevalue(study).open()
    page.set_viewport_size({"width": 1280, "height": 800})
    page.locator(".study-grid .table-wrap").first.wait_for()
    for each in page.locator(".study-grid .table-wrap").all():
        assert each.evaluate("one => one.scrollWidth <= one.clientWidth"), each.get_attribute("aria-label")


@pytest.mark.parametrize(("width", "size"), [(1366, "11.06px"), (2560, "13.43px")])
def test_text_is_larger_on_the_widest_screens(example_tab: Tab, width: int, size: str) -> None:
    page = example_tab.open()
    page.set_viewport_size({"width": width, "height": 800})
    expect(page.locator(".step-state").first).to_have_css("font-size", size)


@pytest.mark.parametrize(("width", "height"), [(390, 780), (683, 384), (1366, 768)])
def test_names_on_the_pad_do_not_cover_each_other(tab: Tab, width: int, height: int) -> None:
    page = tab.open()
    page.set_viewport_size({"width": width, "height": height})
    tab.go("pad")
    names = page.locator(".pad-scene svg text")
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
            assert left >= end or start >= right or top >= below or above >= bottom, texts
