"""Accessibility, speed, several windows, and a killed server."""

from importlib import resources

import pytest
from PIL import Image
from playwright.sync_api import Page, expect
from tests.end_to_end.page.browser import (
    DEMO,
    Late,
    Tab,
    changed,
    corrections,
    drag,
    focus,
    manifest,
    numbers,
    settle,
    tab_on,
)
from tests.end_to_end.page.test_contacts import PRINT, enter_threshold
from tests.studies import finger, sequence, write_numbers, write_study

# Each step, and what stands there once it is drawn.
STEPS = {
    "study": "#work table",
    "scale": ".scale-item",
    "photographs": "[data-live=finger]",
    "contacts": "[data-live=numbers]",
    "contacts/sequence:synthetic_press_30deg": ".limits .limit",
    "pad": "[data-live=u]",
    "results": ".chart .point",
    "results/table": "tbody tr",
    "results/figures": "figure img",
    "results/budget": ".budget",
    "results/audit": ".audit",
    "run": ".export",
}
AXE = resources.files("axe_playwright_python").joinpath("axe.min.js").read_text()
COLOURS = ["color-contrast", "link-in-text-block"]
# Judge the page, by all rules or some, once its colours have stopped changing; the end of one
# change may begin that of what is inside it.
JUDGE = """async (only) => {
  const changing = () => document.getAnimations().filter(
    (one) => one.playState === 'running' && one.effect.getComputedTiming().endTime < Infinity
  );
  for (let each = changing(); each.length; each = changing()) {
    await Promise.allSettled(each.map((one) => one.finished));
  }
  return axe.run(document, { resultTypes: ['violations'], ...(only && { runOnly: only }) });
}"""
# Scroll the filmstrip by ninety times eighteen pictures.
SCROLL = """async () => {
  const strip = document.querySelector('.filmstrip');
  let most = 0;
  for (let step = 0; step < 90; step += 1) {
    strip.scrollLeft += 1800;
    await new Promise(requestAnimationFrame);
    most = Math.max(most, document.querySelectorAll('.cell').length);
  }
  return most;
}"""


@pytest.mark.nightly
def test_pages_are_accessible(browser, run_demo) -> None:
    with tab_on(browser, run_demo.parent, run_demo, color_scheme="light", bypass_csp=True) as tab:
        page = tab.open()
        page.evaluate(AXE)
        found = {}
        themes = ["light", "dark"]
        for step, there in STEPS.items():
            tab.go(step)
            page.locator(there).first.wait_for()
            # All rules in the theme in which the view is drawn; in the other only colours are other.
            for theme, rules in zip(themes, (None, COLOURS), strict=True):
                page.emulate_media(color_scheme=theme)
                result = page.evaluate(JUDGE, rules)
                serious = [each for each in result["violations"] if each["impact"] in ("serious", "critical")]
                found[step, theme] = [
                    (each["id"], each["nodes"][0]["target"], each["nodes"][0]["any"][:1]) for each in serious
                ]
            themes.reverse()
        page.keyboard.press("?")
        page.get_by_role("dialog", name="Keys").wait_for()
    assert {view: what for view, what in found.items() if what} == {}


def two_windows(tab: Tab) -> tuple[Page, Page]:
    """Open the same contact image in two windows."""
    one, two = tab.open(f"contacts/images/{PRINT}"), tab.context.new_page()
    two.goto(f"{tab.server.host}/#/contacts/images/{PRINT}")
    for page in (one, two):
        numbers(page)
    return one, two


def require_both_kept(page: Page, demo) -> None:
    expect(page.locator(".history li")).to_have_count(2)
    last = corrections(demo)[-1]
    assert set(last["change"]) == {"ellipse_px", "threshold"}


def test_two_windows_do_not_lose_each_others_corrections(tab: Tab, demo) -> None:
    tab.expected.append("409")
    one, two = two_windows(tab)
    before = numbers(two)
    drag(two, two.get_by_role("button", name="End of the semi-major axis", exact=True), -20, 0)
    changed(two, before)
    expect(one.locator(".history li")).to_have_count(1)
    enter_threshold(one, "70")
    require_both_kept(two, demo)


@pytest.mark.nightly
def test_a_window_without_events_asks_about_the_conflict(tab: Tab, demo) -> None:
    tab.expected += ["409", "ERR_FAILED"]
    tab.context.route("**/api/studies/*/events", lambda route: route.abort())
    one, two = two_windows(tab)
    before = numbers(two)
    focus(two, "End of the semi-major axis").press("Shift+ArrowRight")
    changed(two, before)
    enter_threshold(one, "70")
    one.get_by_role("dialog", name="Another window corrected this image").wait_for()
    one.get_by_role("button", name="Apply mine as well").click()
    require_both_kept(one, demo)


@pytest.mark.nightly
def test_two_thousand_frames_open_at_once_and_scroll(browser, tmp_path) -> None:
    study = tmp_path / "long"
    (study / "frames").mkdir(parents=True)
    frame = Image.open(DEMO / "synthetic" / "synthetic_30deg_1N.png").convert("L")
    frame.save(study / "frames" / "f0000.png")
    for number in range(1, 2000):
        (study / "frames" / f"f{number:04d}.png").hardlink_to(study / "frames" / "f0000.png")
    write_numbers(study / "force.csv", "time_s,force_N", [(k / 500, k / 2000) for k in range(2000)])
    timed = {"force": "force.csv", "frames_per_second": 500, "scale": {"ppi": 500}}
    write_study(study, finger(), sequence("long", "frames", **timed))
    with tab_on(browser, tmp_path, study) as tab:
        page = tab.open("contacts/sequence:long")
        page.locator(".filmstrip .cell").first.wait_for()
        expect(page.locator(".track")).to_have_css("width", "200000px")
        most = page.evaluate(SCROLL)
        page.locator(".cell.there").first.wait_for()
        thumbnails = sum("/thumbnail" in url for url in tab.asked)
    assert most < 40
    assert thumbnails < 120


def test_fields_are_not_redrawn_while_typing(tab: Tab, demo) -> None:
    page = tab.open("study")
    late = Late(page, "**/api/studies/*/edits")  # the answer to the first entry is held back
    page.get_by_label("Wedge angle ±").fill("0.6")
    page.keyboard.press("Tab")
    page.keyboard.type("0.")
    late.let_go()
    page.keyboard.type("25")
    expect(page.get_by_label("Roll angle ±")).to_have_value("0.25")
    for key, typed in (("Tab", "0.02"), ("Enter", "")):
        with page.expect_response("**/api/studies/*/edits"):
            page.keyboard.press(key)
        settle(page)
        page.keyboard.type(typed)
    expect(page.get_by_label("Load, relative ±")).to_have_value("0.02")
    expect(page.get_by_label("Load, relative ±")).to_be_focused()
    said = manifest(demo)["uncertainty"]
    assert said == {"wedge_angle_deg_std": 0.6, "roll_angle_deg_std": 0.25, "load_relative_std": 0.02}
