"""New files on the page: identified by content, filled in from spreadsheets and names."""

import re
import shutil
import tomllib
from pathlib import Path

import pytest
from PIL import Image
from playwright.sync_api import expect
from tests.end_to_end.page.browser import Tab
from tests.end_to_end.page.test_begin import CONTACTS, begin

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


def manifest_of(tab: Tab) -> dict:
    return tomllib.loads((tab.folder / "index-finger" / "study.toml").read_text())


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
    given = {one["file"]: one.get("scale") for one in manifest_of(empty_tab)["observations"]}
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
    written = manifest_of(empty_tab)
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
