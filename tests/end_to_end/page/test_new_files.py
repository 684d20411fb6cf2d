"""New files on the page: identified by content, filled in from spreadsheets and names."""

import re
import shutil
from pathlib import Path

import pytest
from PIL import Image
from playwright.sync_api import Page, expect
from tests.end_to_end.page.browser import Tab, enter, manifest, numbers
from tests.end_to_end.page.test_begin import CONTACTS, begin
from tests.studies import append_tables, contact, finger, picture

from fingerpad.simulate import render_coin

LOOKED = re.compile("was read from its content")


@pytest.fixture
def plain_names(written_example, tmp_path):
    """Two faces, three contact images and a coin, under the names of a camera."""
    faces = [written_example / f"photograph_{face}.jpg" for face in ("palmar", "radial")]
    paths = [
        Path(shutil.copy(path, tmp_path / f"IMG_{number:04}{path.suffix}"))
        for number, path in enumerate([*faces, *CONTACTS], 31)
    ]
    # 23.25 mm, at the scale of the photographs, 0.1 mm per pixel.
    coin = render_coin(radius=116.25, shape=(320, 320), seed=3).pixels
    Image.fromarray(coin).save(tmp_path / "IMG_0036.png")
    return [*paths, tmp_path / "IMG_0036.png"]


def drop(page, files) -> None:
    page.set_input_files("input[type=file][multiple]", files)
    page.get_by_text(LOOKED).wait_for()


def test_the_resolution_that_a_contact_image_states_is_a_guess(
    empty_tab: Tab, written_example, tmp_path
) -> None:
    page = empty_tab.open()
    begin(page)
    palmar = written_example / "photograph_palmar.jpg"
    stated = {"IMG_1.png": (CONTACTS[0], 500), "IMG_2.png": (CONTACTS[1], 72), "IMG_3.jpg": (palmar, 300)}
    for name, (path, ppi) in stated.items():
        Image.open(path).save(tmp_path / name, dpi=(ppi, ppi))
    drop(page, [tmp_path / name for name in stated])
    scales = [page.get_by_label(f"Scale of {name}") for name in stated]
    for scale, shown in zip(scales, ["500 ppi", "", ""], strict=True):
        expect(scale).to_have_value(shown)
    expect(page.get_by_text("500 ppi, from the file")).to_have_count(1)
    page.get_by_label("Finger of all new files").fill("left_index")
    page.keyboard.press("Tab")
    page.get_by_role("button", name="Add to study").click()
    page.get_by_text("500 ppi as its file says").wait_for()
    page.get_by_role("button", name="Change").click()
    expect(scales[0]).to_be_focused()
    page.get_by_role("button", name="Add to study").click()
    page.get_by_role("button", name="Yes, add them").click()
    page.get_by_text("3 files added.").wait_for()
    given = {
        one["file"]: one.get("scale") for one in manifest(empty_tab.folder / "index-finger")["observations"]
    }
    assert given == {"uploads/IMG_1.png": {"ppi": 500}, "uploads/IMG_2.png": None}


def test_a_spreadsheet_fills_in_the_files(empty_tab: Tab, plain_names, tmp_path) -> None:
    page = empty_tab.open()
    begin(page)
    sheet = tmp_path / "details.csv"
    sheet.write_text(
        "Picture;Subject;Digit;Theta (deg);Load (mN);mm/px;Mood\n"
        "IMG_0031.JPG;S7;LI;;;0,1;\nIMG_0033;S7;LI;30;500;0,0508;calm\nIMG_0034;S8;RI;45;2 N;0,0508;\n"
        "IMG_0099;S8;RI;45;4000;0,0508;\n"
    )
    page.set_input_files("input[type=file][multiple]", sheet)
    page.get_by_text("1 more file in the study folder, not used").wait_for()
    drop(page, plain_names)
    page.get_by_text("3 of 6 files found in the spreadsheet.").wait_for()
    kinds = [page.get_by_label(f"Type of {path.name}").input_value() for path in plain_names]
    assert kinds == ["photograph"] * 2 + ["observation"] * 3 + ["coin"]
    page.get_by_text("Not used: Mood.").wait_for()
    page.get_by_text("Rows without one file: IMG_0099 (line 5).").wait_for()
    page.get_by_text("Files without a row: IMG_0032.jpg, IMG_0035.png, IMG_0036.png.").wait_for()
    expect(page.get_by_label("Finger on IMG_0034.png")).to_have_value("S8_right_index")
    page.get_by_role("button", name="Fill down: Finger").click()
    expect(page.get_by_label("Finger on IMG_0032.jpg")).to_have_value("S7_left_index")
    expect(page.get_by_label("Finger on IMG_0035.png")).to_have_value("S8_right_index")
    page.get_by_label("Wedge angle of IMG_0035.png, degrees").fill("0")
    page.get_by_label("Load of IMG_0035.png, newtons").fill("4")
    page.get_by_label("Coin on IMG_0036.png", exact=True).select_option("1 euro, 23.25 mm")
    page.get_by_role("button", name="Add to study").click()
    page.get_by_text("6 files added.").wait_for()
    written = manifest(empty_tab.folder / "index-finger")
    assert written["scales"]["coin"]["diameter_mm"] == 23.25
    assert [(one["finger"], one.get("load_N")) for one in written["observations"]] == [
        ("S7_left_index", 0.5),
        ("S8_right_index", 2),
        ("S8_right_index", 4),
    ]
    assert written["observations"][0]["scale"] in written["scales"]  # two share it
    assert {one["name"]: one["person"] for one in written["fingers"]} == {
        "S7_left_index": "S7",
        "S8_right_index": "S8",
    }


def test_a_pattern_is_previewed_and_fills_in_the_files(empty_tab: Tab, tmp_path) -> None:
    empty_tab.expected.append("422")
    page = empty_tab.open()
    begin(page)
    names = ["7-LI-w30-f500", "8-RM-w45-f2000", "odd"]
    files = [shutil.copy(CONTACTS[0], tmp_path / f"{name}.png") for name in names]
    drop(page, files)
    page.get_by_text("Fill in from the file names").click()
    page.get_by_label("Pattern of the names").fill("{person}-{finger}-w{wedge}-f{load}_{mood}")
    page.get_by_text("is unknown").wait_for()
    page.get_by_label("Pattern of the names").fill("{person}-{finger}-w{wedge}-f{load}")
    page.get_by_text("2 of 3 names fit.").wait_for()
    page.get_by_role("row", name=re.compile("odd.*does not fit")).wait_for()
    tools = page.locator(".new-file-tools details").nth(1)
    tools.get_by_role("button", name="Fill in").click()
    page.get_by_text("2 files filled in by the pattern.").wait_for()
    expect(page.get_by_label("Finger on 8-RM-w45-f2000.png")).to_have_value("8_right_middle")
    expect(page.get_by_label("Load of 7-LI-w30-f500.png, newtons")).to_have_value("500")
    expect(page.get_by_label("Finger on odd.png")).to_have_value("")


# The first quarter of an hour with a study: what is typed is taken, and what is shown can be followed


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
    enter(scale, "500")
    expect(page.get_by_label("Scale of all new contact images")).to_have_value("500 ppi")
    page.get_by_role("button", name="Add to study").click()
    page.get_by_text("2 files added.").wait_for()
    study = manifest(example)
    assert [one["name"] for one in study["fingers"]] == ["synthetic_pad", "right_thumb"]
    added = [one for one in study["observations"] if one["finger"] == "right_thumb"]
    assert [study["scales"][one["scale"]] for one in added] == [{"ppi": 500}] * 2
    # Of the finger that was made, the semi-axes are asked for, with the first uncertainty for all of them.
    page.get_by_role("button", name="Semi-axes of right_thumb").click()
    fields = page.locator("dialog input")
    for index, words in enumerate(["7,9", "", "13.8", "", "11.8"]):
        fields.nth(index).fill(words)
    page.get_by_role("button", name="Save", exact=True).click()
    expect(fields.nth(1)).to_be_focused()
    enter(fields.nth(1), "0,2")
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
