"""What is clicked twice, held down, or left half-entered is about one item only."""

import re
import tomllib

from playwright.sync_api import Page, expect
from tests.end_to_end.page.browser import Tab, middle, numbers, settle, stroke
from tests.end_to_end.page.test_contacts import corrections


def idle(page: Page) -> None:
    page.wait_for_load_state("networkidle")
    settle(page)


def test_a_double_click_deletes_one_scale_and_opens_one_figure(tab: Tab, demo) -> None:
    with (demo / "study.toml").open("a") as file:
        file.write("\n".join(f"[scales.unused_{name}]\nppi = 500\n" for name in ("a", "b")))
    page = tab.open("scale/unused_a")
    page.get_by_role("heading", name="Scale unused_a").wait_for()
    page.get_by_role("button", name="Delete").dblclick()
    page.locator(".scale-item", has_text="unused_a").wait_for(state="detached")
    idle(page)
    scales = tomllib.loads((demo / "study.toml").read_text())["scales"]
    assert "unused_a" not in scales
    assert "unused_b" in scales
    assert page.locator(".message").count() == 0
    tab.go("results/budget")
    page.get_by_role("button", name=re.compile("^Size, axes and colours")).first.dblclick()
    page.locator("dialog.figure-settings .preview[src]").wait_for()
    idle(page)
    assert page.locator("dialog").count() == 1


def test_a_double_click_and_a_held_key_judge_one_image(tab: Tab, demo) -> None:
    page = tab.open("contacts/images")
    numbers(page)
    (first, second, third) = (page.locator(".cell").nth(place) for place in range(3))
    page.get_by_role("button", name="Reject", exact=True).dblclick()
    expect(second).to_have_attribute("aria-selected", "true")
    numbers(page)
    assert len(corrections(demo)) == 1
    expect(first).to_have_attribute("data-state", "rejected")
    page.locator("h1").click()
    page.keyboard.down("x")
    expect(third).to_have_attribute("aria-selected", "true")
    for _ in range(5):
        page.keyboard.down("x")  # as a key that is held does
        numbers(page)
    page.keyboard.up("x")
    idle(page)
    assert len(corrections(demo)) == 2


def test_settings_that_were_not_saved_are_not_shown_for_the_next_image(tab: Tab, demo) -> None:
    page = tab.open("contacts/images/synthetic_30deg_2N")
    numbers(page)
    page.get_by_label("Threshold, grey levels").fill("none")
    page.get_by_role("checkbox", name="Show the automatic outline").check()
    page.locator("h1").click()
    page.keyboard.press(".")
    page.wait_for_url(re.compile("synthetic_30deg_4N"))
    numbers(page)
    expect(page.get_by_label("Threshold, grey levels")).to_have_value("")
    expect(page.get_by_role("checkbox", name="Show the automatic outline")).not_to_be_checked()
    expect(page.locator(".stage.comparing")).to_have_count(0)


def test_a_length_is_of_its_photograph(tab: Tab, demo) -> None:
    page = tab.open("photographs")
    numbers(page, "finger")
    page.keyboard.press("l")
    x, y = middle(page.locator(".stage"))
    stroke(page, (x - 60, y), (x + 60, y))
    expect(page.locator("[data-live=length]")).to_contain_text("mm")
    page.keyboard.press(".")
    expect(page.locator(".cell").nth(1)).to_have_attribute("aria-selected", "true")
    expect(page.locator("[data-live=length]")).to_have_text("Draw a line on the picture.")


def test_what_was_entered_for_a_missing_entry_is_not_shown_for_the_next(tab: Tab, demo) -> None:
    path = demo / "observations.csv"
    path.write_text(re.sub(r"(?m)^(table3_\w+,\w+,\d+),2,", r"\1,,", path.read_text()))
    page = tab.open("study")
    fields = page.locator(".missing-box").get_by_label(re.compile("the load is missing"))
    count = fields.count()
    assert count > 1
    fields.first.fill("2")
    fields.first.press("Enter")
    expect(fields).to_have_count(count - 1)
    expect(fields.first).to_have_value("")
