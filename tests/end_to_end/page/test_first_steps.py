"""The first quarter of an hour with a study: what is typed is taken, and what is shown can be followed."""

import shutil
import tomllib
from pathlib import Path

import pytest
from PIL import Image
from playwright.sync_api import Page, expect
from tests.end_to_end.page.browser import Tab, numbers
from tests.studies import append_tables, contact, finger, picture


def manifest(folder: Path) -> dict:
    return tomllib.loads((folder / "study.toml").read_text())


def test_fingers_and_scales_are_typed_once(example_tab: Tab, example, tmp_path) -> None:
    page = example_tab.open()
    for name in ("one.png", "two.png"):
        Image.open(example / "contact_1N.png").save(tmp_path / name)
    page.locator("input[type=file]").first.set_input_files([tmp_path / "one.png", tmp_path / "two.png"])
    page.get_by_label("Finger on two.png").wait_for()
    page.get_by_label("Finger of all new files").fill("right  thumb")
    page.keyboard.press("Tab")
    expect(page.get_by_label("Finger on two.png")).to_have_value("right_thumb")
    scale = page.get_by_label("Scale of all new contact images")
    scale.fill("500")
    scale.press("Enter")
    expect(page.get_by_label("Scale of all new contact images")).to_have_value("500 ppi")
    page.get_by_role("button", name="Add to study").click()
    page.get_by_text("2 files added.").wait_for()
    study = manifest(example)
    assert [one["name"] for one in study["fingers"]] == ["synthetic_pad", "right_thumb"]
    added = [one for one in study["observations"] if one["finger"] == "right_thumb"]
    assert [study["scales"][one["scale"]] for one in added] == [{"ppi": 500}] * 2
    # Of the finger that was made, the semi-axes are asked for, each with its uncertainty.
    page.get_by_role("button", name="Semi-axes of right_thumb").click()
    fields = page.locator("dialog input")
    for index, words in enumerate(["7,9", "0,2", "13.8", "0.2", "11.8"]):
        fields.nth(index).fill(words)
    page.get_by_role("button", name="Save", exact=True).click()
    expect(fields.nth(5)).to_be_focused()
    fields.nth(5).fill("0.2")
    fields.nth(5).press("Enter")
    page.get_by_text("13.80 ± 0.20").wait_for()
    page.get_by_role("button", name="Add a finger").click()
    page.get_by_label("Name of the finger").fill("left index")
    page.keyboard.press("Enter")
    page.get_by_role("heading", name="Semi-axes of left_index").wait_for()


@pytest.fixture
def two_fingers(example) -> Path:
    """The example with contacts of a second finger: some given, one with an image."""
    shutil.copy(example / "contact_1N.png", example / "thumb.png")
    given = (contact(f"given_{k}", k + 1, (5, 4), finger="thumb") for k in range(15))
    image = picture("image_1N", "thumb.png", 1, finger="thumb", scale="reader")
    append_tables(example, finger("thumb"), *given, image)
    return example


def test_contacts_are_found_by_finger(two_fingers, example_tab: Tab) -> None:
    page = example_tab.open()
    find = page.get_by_label("Find contacts")
    rows = page.get_by_role("region", name="Contacts", exact=True).locator("tbody tr")
    expect(rows).to_have_count(19)
    find.press_sequentially("synth")
    expect(rows).to_have_count(3)
    expect(find).to_be_focused()
    find.fill("image")
    expect(rows).to_have_count(1)
    example_tab.go("contacts")
    numbers(page)
    cells = page.locator(".filmstrip .cell")
    expect(cells).to_have_count(4)
    expect(cells.last).to_contain_text("thumb")
    page.get_by_label("Finger", exact=True).select_option("thumb")
    expect(page.get_by_role("heading", name="image_1N")).to_be_visible()
    expect(cells).to_have_count(1)
    page.get_by_label("Show", exact=True).select_option("rejected")
    page.get_by_text("No image matches this filter.").wait_for()
    require_nothing_to_judge(page)
    page.get_by_label("Show", exact=True).select_option("all")
    page.get_by_role("button", name="Accept and next").wait_for()


def require_nothing_to_judge(page: Page) -> None:
    for name in ("Accept and next", "Reject", "Undo", "Redo"):
        expect(page.get_by_role("button", name=name)).to_have_count(0)
    for key in ("Enter", "x", "u", "r", "n", "k"):
        page.keyboard.press(key)
    expect(page.locator(".message.error")).to_have_count(0)


def test_all_columns_of_new_files_are_in_view_and_what_a_file_states_is_read_after_a_reload(
    example_tab: Tab, example
) -> None:
    (example / "uploads").mkdir()
    Image.open(example / "contact_1N.png").save(example / "uploads" / "scan_500ppi.png", dpi=(500, 500))
    page = example_tab.open()
    scale = page.get_by_label("Scale of scan_500ppi.png")
    stated = scale.locator("option", has_text="500 ppi, from the file")
    stated.wait_for(state="attached")
    page.reload()
    stated.wait_for(state="attached")
    expect(scale).to_have_value("reader")
    for width in (1280, 1024, 768):
        page.set_viewport_size({"width": width, "height": 768})
        table = page.get_by_role("group", name="New files")
        assert table.evaluate("one => one.scrollWidth <= one.clientWidth"), width
    page.get_by_label("Finger on scan_500ppi.png").fill("synthetic_pad")
    page.get_by_role("button", name="Add to study").click()
    page.get_by_text("scale reader, with the resolution in its file").wait_for()
