"""Review of contact images and frames by pointer and by keyboard."""

import json
import re

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Page, expect
from tests.end_to_end.page.browser import (
    Late,
    Tab,
    changed,
    corrections,
    drag,
    enter,
    focus,
    lift,
    manifest,
    middle,
    numbers,
    press,
    stroke,
)

from fingerpad.report import write_report
from fingerpad.study.pipeline import run_study

PRINT = "synthetic_30deg_2N"
PRESS = "contacts/sequence:synthetic_press_30deg"


def value(text: str, unit: str) -> float:
    return float(re.search(rf"([\d.]+) ± [\d.]+ {unit}", text).group(1))


def encircle(page: Page, across: float, down: float) -> None:
    """Draw an ellipse around the middle of the picture."""
    x, y = middle(page.locator(".stage"))
    page.mouse.move(x + across, y)
    page.mouse.down()
    for turn in np.linspace(0.1, 2 * np.pi, 40):
        page.mouse.move(x + across * np.cos(turn), y + down * np.sin(turn))
    lift(page)


def enter_threshold(page: Page, level: str) -> None:
    enter(page.get_by_label("Threshold, grey levels"), level)


def test_handles_by_pointer_and_by_keyboard_give_numbers_beside_the_automatic_ones(tab: Tab, demo) -> None:
    page = tab.open(f"contacts/images/{PRINT}")
    before = numbers(page)
    page.get_by_text("Brightness and contrast, for looking only").click()
    page.get_by_role("slider", name="Contrast").fill("250")
    expect(page.locator(".stage .picture")).to_have_attribute("style", re.compile(r"contrast\(250%\)"))
    assert numbers(page) == before
    assert corrections(demo) == []
    page.get_by_role("button", name="Reset", exact=True).click()
    expect(page.locator(".stage .picture")).not_to_have_attribute("style", re.compile("contrast"))
    drag(page, page.get_by_role("button", name="End of the semi-major axis", exact=True), -30, 0)
    after = changed(page, before)
    assert value(after, "mm²") > value(before, "mm²") * 1.03
    program = re.search(r"ℓd\s+[\d.]+ ± [\d.]+ mm\s+.*?([\d.]+) ± ", after, re.DOTALL).group(1)
    assert float(program) == value(before, "mm")
    expect(page.get_by_text("manual", exact=True)).to_be_visible()
    (record,) = corrections(demo)
    assert (record["item"], list(record["change"])) == (PRINT, ["ellipse_px"])
    expect(page.locator(".history")).to_contain_text(record["who"], use_inner_text=True)
    page.keyboard.press("u")
    assert numbers(page) == before
    page.keyboard.press("r")
    assert numbers(page) == after
    saved = corrections(demo)
    page.keyboard.press("ArrowRight")  # after a drag it goes to the next image
    page.wait_for_url(re.compile("synthetic_30deg_4N"))
    page.keyboard.press("ArrowLeft")
    page.wait_for_url(re.compile(PRINT))
    assert corrections(demo) == saved
    after = numbers(page)
    handle = focus(page, "End of the semi-minor axis")
    for _ in range(3):
        handle.press("Shift+ArrowRight")
    changed(page, after)
    page.keyboard.press("Enter")
    page.wait_for_url(re.compile("synthetic_30deg_4N"))
    accepted = corrections(demo)[-1]
    assert (accepted["item"], accepted["change"]["accepted"]) == (PRINT, True)
    page.keyboard.press("ArrowLeft")
    page.get_by_text("accepted", exact=True).wait_for()


def test_brush_and_lasso_by_pointer_change_the_region(tab: Tab, demo) -> None:
    page = tab.open(f"contacts/images/{PRINT}")
    before = numbers(page)
    page.keyboard.press("e")
    page.keyboard.press("]")
    x, y = middle(page.locator(".stage"))
    stroke(page, (x + 180, y - 150), (x + 180, y + 150))
    less = changed(page, before)
    assert value(less, "mm²") < value(before, "mm²") * 0.99
    page.keyboard.press("b")
    stroke(page, (x + 180, y - 150), (x + 180, y + 150))
    more = changed(page, less)
    assert value(more, "mm²") > value(less, "mm²")
    assert [stroke["action"] for stroke in corrections(demo)[-1]["change"]["strokes"]] == ["remove", "add"]
    page.keyboard.press("l")
    encircle(page, 90, 60)
    inside = changed(page, more)
    area = corrections(demo)[-1]["change"]["strokes"][-1]
    assert (area["action"], "radius_px" in area) == ("replace", False)
    rows, columns = np.array(area["points_px"]).T
    drawn = abs(np.sum(rows * np.roll(columns, 1) - columns * np.roll(rows, 1))) / 2 * 0.0508**2
    assert value(inside, "mm²") == pytest.approx(drawn, rel=0.01)
    for earlier in (more, less, before):
        page.keyboard.press("u")
        assert numbers(page) == earlier


def test_threshold_slides_on_the_histogram_with_the_outline(tab: Tab, demo) -> None:
    page = tab.open(f"contacts/images/{PRINT}")
    before = numbers(page)
    page.keyboard.press("t")
    page.wait_for_function("() => document.querySelector('.levels path.bars').getAttribute('d')")
    outline = page.locator("path.region").get_attribute("d")
    x, y = middle(page.locator(".levels svg"))
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 60, y, steps=3)
    expect(page.locator("path.region")).not_to_have_attribute("d", outline)
    assert corrections(demo) == []  # nothing is kept while it moves
    lift(page)
    less = changed(page, before)
    assert value(less, "mm²") < value(before, "mm²")
    (record,) = corrections(demo)
    assert record["change"].keys() == {"threshold"}
    page.get_by_role("slider", name="Threshold").press("ArrowLeft")
    changed(page, less)
    assert corrections(demo)[-1]["change"]["threshold"] < record["change"]["threshold"]
    page.keyboard.press("u")
    assert numbers(page) == less


def test_second_operator_sees_no_outline_but_their_own(tab: Tab, demo) -> None:
    page = tab.open(f"contacts/images/{PRINT}")
    before = numbers(page)
    focus(page, "End of the semi-major axis").press("Shift+ArrowUp")
    first = changed(page, before)
    page.evaluate("localStorage.setItem('fingerpad.who', 'bob')")
    tab.go("contacts/second")
    page.get_by_text("No other outline is shown").wait_for()
    expect(page.locator("path.region")).to_have_attribute("d", "")
    expect(page.get_by_label("Show the automatic outline")).to_have_count(0)
    page.keyboard.press("Enter")  # nothing to accept yet
    page.get_by_text("Outline the contact first").wait_for()
    encircle(page, 200, 190)
    assert value(numbers(page), "mm²") != value(first, "mm²")
    expect(page.locator("[data-part=numbers]")).not_to_contain_text("automatic")
    page.keyboard.press("Enter")
    page.get_by_text("This was the last image").wait_for()
    line = json.loads((demo / "second_operator.jsonl").read_text().splitlines()[-1])
    assert (line["who"], line["change"]["accepted"]) == ("bob", True)
    assert [record["who"] for record in corrections(demo)] != ["bob"]


def test_threshold_polarity_seed_and_region_of_interest(tab: Tab, demo) -> None:
    page = tab.open(f"contacts/images/{PRINT}")
    before = numbers(page)
    enter_threshold(page, "60")
    thinner = changed(page, before)
    press(page, "s")
    x, y = middle(page.locator(".stage"))
    page.mouse.click(x + 10, y)
    page.get_by_role("button", name="Reset seed point").wait_for()
    page.keyboard.press("o")
    stroke(page, (x - 120, y - 120), (x + 120, y + 120))
    page.get_by_text("The contact is cut by the mask or region of interest. To do:").wait_for()
    page.locator(".pooling-note").get_by_text("Left out of the pooled radius").wait_for()
    assert value(numbers(page), "mm²") < value(thinner, "mm²")
    assert {"threshold", "seed_px", "region_of_interest_px"} <= set(corrections(demo)[-1]["change"])
    page.get_by_label("Polarity").select_option("false")
    page.wait_for_selector(".stack[aria-busy=false]")
    assert corrections(demo)[-1]["change"]["dark_on_light"] is False
    page.get_by_role("button", name="Reset to automatic").click()
    assert numbers(page) == before
    expect(page.get_by_text("automatic", exact=True)).to_be_visible()


def test_an_image_is_judged_by_its_own_corrections(tab: Tab, demo) -> None:
    page = tab.open(f"contacts/images/{PRINT}")
    numbers(page)
    press(page, "x")
    page.get_by_role("heading", name="synthetic_30deg_4N").wait_for()
    numbers(page)
    # A key that comes before the corrections undoes the rejection they tell of.
    late = Late(page, "**/api/studies/*/corrections?*", lambda asked: PRINT in asked.url)
    page.keyboard.press("ArrowLeft")
    late.wait()
    page.keyboard.press("x")
    late.let_go()
    expect(page.locator(".history li")).to_have_count(2)
    assert corrections(demo)[-1]["change"] == {}
    # An image is not shown as rejected because the one before it is.
    page.keyboard.press("x")
    page.wait_for_url(re.compile("synthetic_30deg_4N"))
    page.keyboard.press("ArrowLeft")
    page.locator(".stage.rejected").wait_for()
    late = Late(page, "**/api/studies/*/corrections?*", lambda asked: "synthetic_30deg_4N" in asked.url)
    page.keyboard.press("ArrowRight")
    late.wait()
    assert page.locator(".stage.rejected").count() == 0
    late.let_go()


def test_key_frames_carry_their_ellipses_to_those_between(tab: Tab, demo) -> None:
    page = tab.open(f"{PRESS}/synthetic_press_30deg%234")
    program = numbers(page)
    grown = page.get_by_label("Aspect ratio against force, up to the current frame").locator("path.grown")
    first = grown.get_attribute("d")
    press(page, "k")
    page.get_by_text("manual", exact=True).wait_for()
    for _ in range(4):
        page.keyboard.press(".")
        numbers(page)
    expect(grown).to_have_attribute("d", re.compile(f"{first}."))
    focus(page, "End of the semi-major axis").press("Shift+ArrowUp")
    key = page.get_by_role("checkbox", name="Key frame")
    key.check()
    page.locator(".cell[data-index='6'] .dot[data-kind='interpolated']").wait_for()
    page.keyboard.press(",")
    page.get_by_text("the ellipse is interpolated between two key frames").wait_for()
    assert numbers(page) != program
    assert page.url.endswith("%237")
    marked = [record["item"] for record in corrections(demo) if record["change"].get("key_frame")]
    assert [item[-2:] for item in marked] == ["#4", "#8"]
    expect(key).not_to_be_checked()
    # One that was not waited for is none of the next frame.
    late = Late(page, "**/api/studies/*/measure/contact*")
    key.check()
    late.wait()
    press(page, ",")
    page.wait_for_url(re.compile("%236$"))
    numbers(page)
    expect(key).not_to_be_checked()


def test_sequence_is_scrubbed_and_aligned(tab: Tab, demo) -> None:
    page = tab.open(PRESS)
    numbers(page)
    trace = page.get_by_role("slider", name="Time of the frame")
    expect(trace).to_have_attribute("aria-valuetext", re.compile("."))
    x, y = middle(trace)
    stroke(page, (x - 100, y), (x, y))
    page.wait_for_url(re.compile(r"%23\d+$"))
    before = numbers(page)
    assert page.url.endswith(re.search(r"frame (\d+)", trace.get_attribute("aria-valuetext")).group(1))
    trace.press("End")
    changed(page, before)
    page.get_by_label("Drag the area to align it with the force").check()
    stroke(page, (x, y), (x + 40, y))
    page.get_by_text(re.compile(r"areas scatter \d+\.\d % about a power of the force; least, 0\.")).wait_for()
    page.get_by_role("button", name="Keep this alignment").click()
    page.get_by_text("The alignment is saved").wait_for()
    (press,) = manifest(demo)["sequences"]
    assert 0.05 < press["start_s"] < 0.3


@pytest.mark.nightly
def test_limits_of_phases_are_moved_manually(tab: Tab, demo) -> None:
    page = tab.open(PRESS)
    numbers(page)
    hold = page.get_by_role("slider", name="Start of hold")
    found = float(hold.get_attribute("aria-valuenow"))
    drag(page, hold, 40, 0)
    page.get_by_text("Phases set manually by").wait_for()
    moved = float(hold.get_attribute("aria-valuenow"))
    assert moved > found + 0.05
    record = corrections(demo)[-1]
    phases = record["change"]["phases"]
    assert (record["item"], phases["why"]) == ("synthetic_press_30deg#phases", "no reason given")
    assert {one["phase"]: one["start_s"] for one in phases["starts"]}["hold"] == moved
    # By keys no further than the next limit; what was done can be undone after a reload.
    hold.press("End")
    ends = page.get_by_role("slider", name="Start of unloading").get_attribute("aria-valuenow")
    expect(hold).to_have_attribute("aria-valuenow", ends)
    hold.blur()
    reason = page.get_by_label("Reason of the phases")
    enter(reason, "the pad slipped")
    expect(reason).to_be_focused()
    page.reload()
    numbers(page)
    for _ in range(2):
        page.get_by_role("button", name="Undo the change of phases").click()
    expect(hold).to_have_attribute("aria-valuenow", str(moved))
    page.get_by_role("button", name="Redo the change of phases").click()
    expect(hold).to_have_attribute("aria-valuenow", ends)
    page.get_by_role("button", name="Reset the phases to automatic").click()
    expect(hold).to_have_attribute("aria-valuenow", str(found))
    page.get_by_text("Phases follow from the force").wait_for()


# Which contacts are pooled: the page says how many, who is left out and why, and takes a correction


def test_an_accepted_contact_that_a_flag_leaves_out_is_named_and_included(
    example_tab: Tab, example, results
) -> None:
    picture = Image.open(example / "contact_1N.png")
    box = (0, 0, picture.width // 2, picture.height)  # half of it: the contact touches the border
    picture.crop(box).save(example / "contact_1N.png", dpi=(500, 500))
    run_study(example / "study.toml", results)
    page = example_tab.open("contacts/images/contact_1N")
    numbers(page)
    page.get_by_text("Left out of the pooled radius").wait_for()
    page.get_by_role("button", name="Accept and next").click()
    page.get_by_role("heading", name="contact_2N").wait_for()
    page.keyboard.press("ArrowLeft")
    page.get_by_role("heading", name="contact_1N").wait_for()
    numbers(page)
    page.get_by_text("Left out of the pooled radius").wait_for()  # though accepted
    example_tab.go("results")
    card = page.locator(".plot-card").first
    card.get_by_text("2 of 3 contacts pooled").wait_for()
    words = card.locator(".pooling-list li").first.inner_text()
    assert "contact_1N, 1 N is left out: the contact is cut by the edge of the picture" in words
    before = card.locator(".main-fact dd").first.inner_text()
    card.get_by_label("Reason of the correction").fill("shown whole enough")
    card.get_by_role("button", name="Include contact_1N").click()
    card.get_by_text(re.compile("included by .+, just now: shown whole enough")).wait_for()
    record = corrections(example)[-1]
    assert record["change"] == {"accepted": True, "pooling": {"include": True, "why": "shown whole enough"}}
    assert record["who"]
    assert record["when"]
    run_study(example / "study.toml", results, write_report=write_report)
    page.reload()
    card.get_by_text("3 of 3 contacts pooled").wait_for()
    expect(card.locator(".main-fact dd").first).not_to_have_text(before)
    report = re.sub(r"\s+", " ", (example / "results" / "report.html").read_text())
    assert "3 of 3 contacts pooled" in report
    assert f"contact_1N is included by {record['who']}: shown whole enough (the contact is cut" in report
    # Back to the rule, and one that nothing speaks against left out by its picture.
    card.get_by_text("3 of 3 contacts pooled").click()
    card.get_by_role("button", name="Undo the correction of contact_1N").click()
    card.get_by_text(re.compile("included by .+, just now")).wait_for(state="detached")
    example_tab.go("contacts/images/contact_2N")
    numbers(page)
    page.get_by_text("Counts in the pooled radius").wait_for()
    page.get_by_role("button", name="Leave out").click()
    page.get_by_text("Left out of the pooled radius").wait_for()
    left_out = corrections(example)[-1]
    assert (left_out["item"], left_out["change"]["pooling"]["include"]) == ("contact_2N", False)
