"""Which contacts are pooled: the page says how many, who is left out and why, and takes a correction."""

import json
import re

from PIL import Image
from playwright.sync_api import expect
from tests.end_to_end.page.browser import Tab, numbers

from fingerpad.report import write_report
from fingerpad.study.pipeline import run_study
from fingerpad.study.results.table import records


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
    record = json.loads((example / "corrections.jsonl").read_text().splitlines()[-1])
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
    rows = {row["observation"]: row for row in records(run_study(example / "study.toml", results).rows)}
    assert [rows[f"contact_{load}N"]["pooled"] for load in ("0.5", "1", "2")] == [True, False, False]
    assert rows["contact_2N"]["pooling_corrected_by"] == record["who"]
    assert rows["contact_2N"]["reviewed"] is None
