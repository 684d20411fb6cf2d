"""What a person enters or sees is what is saved, or the page says why not."""

import re
import shutil
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect
from tests.end_to_end.page.browser import (
    Tab,
    corrections,
    enter,
    launched,
    manifest,
    middle,
    numbers,
    press,
    settle,
    stroke,
    tab_on,
)
from tests.end_to_end.page.test_contacts import PRINT


def test_a_decimal_comma_is_a_decimal_point_or_is_refused(example_tab: Tab, example) -> None:
    page = example_tab.open()
    load = page.get_by_label("Load of contact_1N", exact=True)

    def enter(words: str) -> str:
        load.fill("")
        load.press_sequentially(words)
        load.press("Enter")
        return load.evaluate("field => field.validationMessage")

    for typed in ("0,5", "0.25", ",75", "1,5e-1"):
        with page.expect_response("**/api/studies/*/edits"):
            assert enter(typed) == ""
        expect(load).to_have_value(str(float(typed.replace(",", "."))))
        (saved,) = [one for one in manifest(example)["observations"] if one["name"] == "contact_1N"]
        assert saved["load_N"] == float(typed.replace(",", "."))
    # What could be read in two ways is refused, not guessed.
    assert enter("12,125") == '"12,125" could be 12.125 or 12125: write which.'
    for typed in ("1.234,5", "1,234.5", "1 234", "1'234", "0.5.5", "0,5 0,6", "five"):
        assert enter(typed).startswith(f'"{typed}" is not a number')
    (saved,) = [one for one in manifest(example)["observations"] if one["name"] == "contact_1N"]
    assert saved["load_N"] == 0.15


def test_what_is_proposed_for_foreign_headers_is_used_as_it_is(example_tab: Tab, example) -> None:
    curve = example / "loading_curve.csv"
    curve.write_text(curve.read_text().replace("force_N,displacement_mm", "Zelle (N),Traverse (mm)", 1))
    page = example_tab.open()
    page.get_by_role("button", name="Use", exact=True).click()
    page.get_by_text("no column force_N").wait_for(state="detached")
    (saved,) = manifest(example)["curves"]
    assert saved["file_columns"] == {"force": "Zelle (N):N", "displacement": "Traverse (mm):mm"}


def test_a_reason_never_undoes_a_rejection(tab: Tab, demo) -> None:
    page = tab.open(f"contacts/images/{PRINT}")
    numbers(page)
    page.keyboard.press("x")
    page.wait_for_url(re.compile("synthetic_30deg_4N"))
    page.keyboard.press("ArrowLeft")
    page.get_by_text("rejected: no reason given", exact=True).wait_for()
    why = page.get_by_label("Reason to reject")
    enter(why, "smeared")
    page.wait_for_url(re.compile("synthetic_30deg_4N"))
    assert corrections(demo)[-1]["change"]["rejected"] == "smeared"
    page.keyboard.press("ArrowLeft")
    page.get_by_text("rejected: smeared", exact=True).wait_for()
    page.keyboard.press("x")
    expect(page.get_by_text("rejected: smeared", exact=True)).to_have_count(0)


@pytest.mark.nightly
def test_the_page_stays_where_saving_failed_and_goes_on_once_the_server_is_back(browser, demo) -> None:
    with launched(demo) as (server, process):
        tab = Tab(browser, server)
        tab.expected += ["Failed to load resource", "ERR_"]
        page = tab.open(f"contacts/images/{PRINT}")
        numbers(page)
        process.kill()
        process.wait()
        banner = page.locator("#link")
        expect(banner).to_contain_text("fingerpad does not respond. Confirmed changes are saved")
        page.keyboard.press("Enter")
        page.locator(".message.error").first.wait_for()
        expect(page).to_have_url(re.compile(PRINT))
        page.keyboard.press("x")
        page.wait_for_timeout(300)
        expect(page).to_have_url(re.compile(PRINT))
        assert not corrections(demo)
        page.keyboard.press("ArrowRight")
        result = page.locator("[data-part=numbers]")
        expect(result).to_contain_text("fingerpad does not respond")
        expect(result).not_to_contain_text("reject the image")
        page.keyboard.press("Enter")
        expect(page.locator("#messages")).not_to_contain_text("No contact was found")
        page.keyboard.press("ArrowLeft")
        port = int(server.host.rpartition(":")[2])
        with launched(demo, port) as (again, _):
            expect(banner).to_contain_text("fingerpad was started again: open the address")
            other = page.context.new_page()
            other.goto(again.address)
            expect(banner).to_be_hidden()
            numbers(page)
            page.keyboard.press("Enter")
            page.wait_for_url(re.compile("synthetic_30deg_4N"))
            assert corrections(demo)[-1]["change"]["accepted"] is True
            other.context.clear_cookies()
            other.goto(again.host)
            other.get_by_text("Open the address that fingerpad app printed").wait_for()
        tab.close()


def test_an_address_opens_its_study(browser, demo) -> None:
    last = Path(shutil.copytree(demo, demo.with_name("last")))
    text = (last / "study.toml").read_text()
    (last / "study.toml").write_text(re.sub("(?m)^title = .*", "title = 'Opened last'", text))
    with tab_on(browser, demo.parent) as tab:  # without a study, as fingerpad app is started by default
        page = tab.open()
        page.get_by_role("button", name=re.compile("demo")).click()
        tab.go("contacts")
        numbers(page)
        other = page.context.new_page()
        other.goto(tab.server.host)
        other.get_by_role("button", name="Other studies").click()
        other.get_by_role("button", name="Opened last").click()
        expect(other.locator("#sidebar")).to_contain_text("Opened last")
        other.goto(page.url)
        numbers(other)
        expect(other.locator("#sidebar")).to_contain_text("Left index finger pad")
        assert other.url == page.url
        page.get_by_role("button", name="Other studies").click()
        page.get_by_role("heading", name="Open study").wait_for()
        page.reload()
        page.get_by_role("heading", name="Open study").wait_for()
        other.close()


def test_a_list_shows_what_it_holds_when_its_options_move(tab: Tab) -> None:
    shown = tab.open().evaluate(
        """async () => {
          const { h, update } = await import("/static/-/core/dom.js");
          const { choose } = await import("/static/-/parts/forms.js");
          const root = document.body.appendChild(h("div"));
          const values = [["x", "z"], ["z"], ["a", "z", "b"], ["b", "z", "a"], ["z", "x"]].map((options) => {
            update(root, choose({ value: "z", options: [["", "later"], ...options] }));
            return root.firstChild.value;
          });
          root.remove();
          return values;
        }"""
    )
    assert shown == 5 * ["z"]


# What is clicked twice, held down, or left half-entered is about one item only


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
    scales = manifest(demo)["scales"]
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
    press(page, ".")
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
    enter(fields.first, "2")
    expect(fields).to_have_count(count - 1)
    expect(fields.first).to_have_value("")
