"""What a person enters or sees is what is saved, or the page says why not."""

import re
import shutil
import tomllib
from pathlib import Path

import pytest
from playwright.sync_api import expect
from tests.end_to_end.page.browser import Tab, launched, numbers, served
from tests.end_to_end.page.test_contacts import PRINT, corrections


def manifest(folder) -> dict:
    return tomllib.loads((folder / "study.toml").read_text())


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


def test_a_reason_never_undoes_a_rejection(tab: Tab, demo) -> None:
    page = tab.open(f"contacts/images/{PRINT}")
    numbers(page)
    page.keyboard.press("x")
    page.wait_for_url(re.compile("synthetic_30deg_4N"))
    page.keyboard.press("ArrowLeft")
    page.get_by_text("rejected: no reason given", exact=True).wait_for()
    why = page.get_by_label("Reason to reject")
    why.fill("smeared")
    why.press("Enter")
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
    with served(demo.parent) as server:  # without a study, as fingerpad app is started by default
        tab = Tab(browser, server)
        page = tab.open()
        page.get_by_role("button", name=re.compile("demo")).click()
        tab.go("contacts")
        numbers(page)
        other = page.context.new_page()
        other.goto(server.host)
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
        tab.close()


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
