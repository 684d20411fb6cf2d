"""New studies: files, scale, run, export and import."""

import math
import re
import shutil
import zipfile
from pathlib import Path

import pytest
from benchmarks.truth.grids import Scene
from PIL import Image
from playwright.sync_api import Locator, Page, expect
from tests.end_to_end.page.browser import (
    DEMO,
    Tab,
    box,
    drag,
    enter,
    focus,
    manifest,
    middle,
    moving,
    numbers,
    press,
    require_picture,
    settle,
    stroke,
)

from fingerpad.simulate import render_coin

CONTACTS = [DEMO / "synthetic" / f"synthetic_30deg_{load}N.png" for load in (0.5, 2, 4)]


def begin(page, title: str = "Index finger") -> None:
    page.get_by_label("Title").fill(title)
    page.keyboard.press("Enter")
    page.get_by_role("heading", name=title).wait_for()


def paste(field: Locator, words: str) -> None:
    field.evaluate(
        """(input, words) => {
          const clipboardData = new DataTransfer();
          clipboardData.setData("text", words);
          input.dispatchEvent(new ClipboardEvent("paste", { clipboardData, cancelable: true }));
        }""",
        words,
    )


def say_scale(page, name: str, way: str, field: str, value: str) -> None:
    """Save a scale for the images that it offers: those of the first kind that lacks one."""
    press(page, "n")
    page.get_by_role("radio", name=way, exact=True).click()
    enter(page.get_by_label(field), value)
    page.get_by_label("Name", exact=True).fill(name)
    page.get_by_role("button", name="Save scale").click()
    page.get_by_role("heading", name=f"Scale {name}").wait_for()


def test_six_files_become_a_plot(empty_tab: Tab, written_example) -> None:
    page = empty_tab.open()
    begin(page)
    page.get_by_role("heading", name="Missing").wait_for()
    photographs = [written_example / f"photograph_{face}.jpg" for face in ("palmar", "distal", "radial")]
    page.set_input_files("input[type=file][multiple]", [*photographs, *CONTACTS])
    page.get_by_role("heading", name="6 new files").wait_for()
    half, two, four = (page.get_by_label(f"Load of {path.name}, newtons") for path in CONTACTS)
    expect(page.get_by_label("Face on photograph_distal.jpg")).to_have_value("distal")
    expect(four).to_have_value("4")
    expect(half).to_have_value("0.5")
    page.get_by_label("Finger of all new files").fill("left_index")
    paste(half, "0,5\n2\n4")
    expect(half).to_have_value("0.5")
    paste(two, "1\n2\n3")
    page.get_by_text("3 values for 2 fields from here down: nothing was pasted.").wait_for()
    expect(four).to_have_value("4")
    page.mouse.click(*middle(four))
    page.keyboard.press("End")
    page.keyboard.type("0")  # into the field that was clicked
    expect(four).to_have_value("40")
    page.keyboard.press("Backspace")
    page.get_by_label("These files are synthetic (rendered or simulated)").check()
    page.get_by_role("button", name="Add to study").click()
    page.get_by_text("6 files added.").wait_for()  # once all are looked at
    press(page, "2")
    say_scale(page, "camera", "mm/px", "Millimetres per pixel", "0.1")
    expect(page.get_by_role("link", name="Run the study")).to_have_count(0)
    say_scale(page, "reader", "ppi", "Pixels per inch", "500")
    page.get_by_role("link", name="Run the study").wait_for()  # the last that was missing
    tops = page.get_by_role("radiogroup", name="Type of scale").get_by_role("radio").all()
    assert len({box(radio)["y"] for radio in tops}) == 1
    press(page, "1")
    page.get_by_text("Nothing is missing.").wait_for()
    enter(page.get_by_label("Wedge angle ±"), "0.5")
    press(page, "6")
    page.get_by_role("heading", name="Run & export").wait_for()
    page.keyboard.press("Enter")
    page.get_by_role("link", name="See the results").click()
    page.locator(".chart .scatterlayer .point").first.wait_for()
    radius = float(page.locator(".main-fact dd").first.inner_text().split()[0])
    assert radius == pytest.approx(13.61, abs=0.15)
    require_plot_in_view(page)
    manifest = (empty_tab.folder / "index-finger" / "study.toml").read_text()
    assert manifest.count("[[observations]]") == 3
    assert manifest.count("synthetic = true") == 6
    assert "wedge_angle_deg_std = 0.5" in manifest


def test_area_against_load_of_six_prints_takes_at_most_20_actions(empty_tab: Tab, tmp_path) -> None:
    """Cameras name pictures by number, the finger's semi-axes are not known, and loads are written down."""
    page = empty_tab.open()
    files = [Path(shutil.copy(CONTACTS[k % 3], tmp_path / f"IMG_{k}.png")) for k in range(6)]
    actions = [
        (page.get_by_label("Title").fill, "Prints"),
        (page.keyboard.press, "Enter"),
        (page.locator("input[type=file][multiple]").set_input_files, files),
        (page.get_by_label("Finger of all new files").fill, "left_index"),
        (page.get_by_label("Wedge angle of all new files, degrees").fill, "30"),
        (page.get_by_label("Scale of all new contact images").fill, "500 ppi"),
        *((page.get_by_label(f"Load of IMG_{k}.png, newtons").fill, str(k + 1)) for k in range(6)),
        (page.get_by_role("button", name="Add to study").click,),
        (page.get_by_role("link", name="Run the study").click,),
        (page.get_by_role("link", name="See the results").click,),
    ]
    assert len(actions) <= 20
    for do, *what in actions:
        do(*what)
    expect(page.locator(".chart .ytitle")).to_contain_text("contact area")
    expect(page.locator(".chart .scatterlayer .point")).to_have_count(6)


def require_plot_in_view(page) -> None:
    """The plot of one finger and angle is seen whole on the first screen."""
    place = box(page.locator(".chart .xtitle"))
    assert place["y"] + place["height"] < page.viewport_size["height"]


def drop(page: Page, target: str, name: str) -> bool:
    """Drop a file on an element; whether the page keeps the browser from showing it."""
    return page.locator(target).evaluate(
        """(element, name) => {
          const dataTransfer = new DataTransfer();
          dataTransfer.items.add(new File(["time_s,force_N,displacement_mm\\n0,0,0\\n1,1,1\\n"], name));
          const what = { bubbles: true, cancelable: true, dataTransfer };
          return ["dragover", "drop"].every((type) => !element.dispatchEvent(new DragEvent(type, what)));
        }""",
        name,
    )


def test_a_dropped_file_is_sent_once_wherever_it_falls(empty_tab: Tab) -> None:
    page = empty_tab.open()
    begin(page)
    for _ in range(2):
        empty_tab.go("pad")
        empty_tab.go("study")
    for place, target in enumerate(("#work", "#sidebar")):
        assert drop(page, target, f"curve{place}.csv")
        page.get_by_role("heading", name=f"{place + 1} new file").wait_for()
    assert not page.locator(".drop.over").count()
    empty_tab.go("pad")
    assert drop(page, "#work", "curve2.csv")
    settle(page)
    sent = [re.sub(".*name=", "", url) for url in empty_tab.asked if "/files?name=" in url]
    assert sent == ["curve0.csv", "curve1.csv"]


def test_entered_semi_axes_are_removed_to_give_photographs(empty_tab: Tab) -> None:
    page = empty_tab.open()
    begin(page)
    page.get_by_role("button", name="Add a finger").click()
    enter(page.get_by_label("Name of the finger"), "thumb")
    dialog = page.get_by_role("dialog", name="Semi-axes of thumb")
    axes = [dialog.get_by_label(name) for name in ("Palmar", "Distal", "Radial–ulnar")]
    for field, value in zip(axes, ("7,9", "13,8", "11,8"), strict=True):
        field.fill(value)
    dialog.get_by_label("± (needed)").fill("0,2")
    dialog.get_by_role("button", name="Save").click()
    page.get_by_role("cell", name="13.80 ± 0.20").wait_for()
    page.get_by_role("button", name="Semi-axes of thumb").click()
    for field in axes:  # by keys: a field that is left must not take the focus back
        field.click()
        page.keyboard.press("Control+A")
        page.keyboard.press("Delete")
    dialog.get_by_role("button", name="Save").click()
    page.get_by_role("cell", name="13.80 ± 0.20").wait_for(state="detached")
    assert manifest(empty_tab.folder / "index-finger")["fingers"] == [{"name": "thumb"}]


def test_an_assumed_uncertainty_is_no_entry(empty_tab: Tab) -> None:
    page = empty_tab.open()
    begin(page)
    wedge = page.get_by_label("Wedge angle ±")
    expect(page.get_by_label("Load, relative ±")).to_have_value("0.01")
    manifest = empty_tab.folder / "index-finger" / "study.toml"
    for shown, entered in (("", "0.5"), ("0.5", "")):
        expect(wedge).to_have_value(shown)
        wedge.fill(entered)
        with page.expect_response("**/api/studies/*/edits"):
            wedge.press("Enter")
        settle(page)
        assert ("wedge_angle_deg_std" in manifest.read_text()) is bool(entered)
    expect(wedge).to_have_value("")
    expect(wedge).to_have_attribute("placeholder", "3 assumed")


def upload_print(page: Page, demo: Path, tmp_path: Path) -> Path:
    """Upload print.png, of the finger synthetic_pad."""
    file = Path(shutil.copy(demo / "synthetic" / "synthetic_30deg_1N.png", tmp_path / "print.png"))
    page.locator("input[type=file]").set_input_files([file])
    page.get_by_label("Finger on print.png").fill("synthetic_pad")
    return file


def test_removed_file_is_restored_with_its_entries_and_run_once_it_is_complete(
    tab: Tab, demo, tmp_path
) -> None:
    page = tab.open()
    file = upload_print(page, demo, tmp_path)
    page.get_by_role("button", name="Remove print.png").click()
    page.get_by_text("print.png was removed.").wait_for()
    page.locator(".new-files").wait_for(state="hidden")
    assert not (demo / "uploads" / "print.png").exists()
    page.get_by_role("button", name="Undo").click()
    page.get_by_text("print.png was restored.").wait_for()
    expect(page.get_by_label("Finger on print.png")).to_have_value("synthetic_pad")
    assert (demo / "uploads" / "print.png").read_bytes() == file.read_bytes()
    wedge = page.get_by_label("Wedge angle of print.png, degrees")
    wedge.fill("200")
    page.get_by_role("button", name="Add to study").click()
    assert wedge.evaluate("field => !field.validity.valid")
    page.get_by_role("heading", name="1 new file").wait_for()  # not used
    wedge.fill("30")
    page.get_by_label("Scale of print.png").select_option("reader")
    page.get_by_role("button", name="Add to study").click()
    page.get_by_role("heading", name="Missing").wait_for()
    page.get_by_text("the load is missing").wait_for()
    page.get_by_text("Not ready to run").wait_for()
    assert 'file = "uploads/print.png"' in (demo / "study.toml").read_text()
    tab.go("run")
    page.get_by_text("The study is incomplete").wait_for()
    page.locator(".missing").get_by_text("the load is missing").wait_for()
    expect(page.get_by_role("button", name="Run what is complete")).to_be_enabled()
    tab.go("study")
    page.get_by_label("Load of print", exact=True).fill("1")
    page.keyboard.press("Tab")
    page.get_by_role("link", name="Run the study").wait_for()


def test_wrong_value_is_refused_and_a_finger_is_renamed_with_its_contacts(tab: Tab, demo) -> None:
    tab.expected.append("422")
    before = (demo / "study.toml").read_text()
    page = tab.open()
    enter(page.get_by_label("Load of synthetic_30deg_2N", exact=True), "20000")
    refused = page.get_by_role("alert").filter(has_text="load_N")
    expect(refused).to_contain_text("synthetic_30deg_2N: load_N")
    expect(refused).to_contain_text("less than or equal to 10000, found '20000'")
    expect(refused).not_to_contain_text("observations[")
    assert (demo / "study.toml").read_text() == before
    renamed = page.get_by_role("button", name="Rename right_middle")
    for name, answered in (
        ("synthetic_pad", page.get_by_role("alert").filter(has_text="synthetic_pad")),  # another finger's
        ("right_middle", renamed),
    ):
        page.get_by_role("button", name="Rename left_index_ellipse").click()
        page.get_by_label("Name of the finger").fill(name)
        page.keyboard.press("Enter")
        answered.wait_for()
    names = {finger["name"] for finger in manifest(demo)["fingers"]}
    assert names == {"right_middle", "left_index_direct", "synthetic_pad"}
    rows = (demo / "observations.csv").read_text()
    assert "left_index_ellipse" not in rows
    assert rows.count(",right_middle,") == 2


def test_line_on_a_ruler_by_pointer_then_by_keyboard(tab: Tab, demo) -> None:
    page = tab.open("scale")
    page.get_by_role("button", name="+ New scale").click()
    page.get_by_role("radio", name="Ruler").click()
    page.get_by_label("Image", exact=True).select_option("synthetic/photograph_palmar.jpg")
    require_picture(page)
    x, y = middle(page.locator(".stage"))
    stroke(page, (x - 150, y), (x + 150, y))
    page.get_by_text("Enter the length of the line.").wait_for()
    enter(page.get_by_label("Length of the line"), "20")
    first = numbers(page, "scale")
    assert "±" in first
    focus(page, "End of the line").press("Shift+ArrowRight")
    moving(page, first, "scale")
    drag(page, page.get_by_role("button", name="End of the line"), -40, 0)
    page.get_by_label("Name", exact=True).fill("ruler")
    page.keyboard.press("Tab")
    press(page, "Control+Enter")
    page.get_by_role("heading", name="Scale ruler").wait_for()
    manifest = (demo / "study.toml").read_text()
    assert re.search(r"\[scales\.ruler\][^[]*line = ", manifest)
    assert "length_mm = 20" in manifest
    assert "# Scales that several pictures share" in manifest


def test_run_names_its_file_and_can_be_stopped(tab: Tab) -> None:
    page = tab.open("run")
    run = page.locator(".run-status button.primary")
    page.get_by_label("Re-measure all").check()
    run.click()
    page.get_by_role("progressbar").wait_for()
    page.keyboard.press("c")
    page.get_by_role("heading", name="Stopped. Finished measurements are kept").wait_for()
    page.get_by_label("Re-measure all").check()
    run.press("Enter")
    expect(page.locator("[data-live=file]")).to_have_text(re.compile(r"\.(png|jpg|tif)"))


def test_report_and_study_folder_are_exported(tab: Tab, run_demo, tmp_path) -> None:
    page = tab.open("run")
    with page.expect_download() as report:
        page.get_by_role("link", name="Download Report").click()
    assert report.value.path().read_bytes() == (run_demo / "results" / "report.html").read_bytes()
    with page.expect_download() as folder:
        page.get_by_role("link", name="Download Study folder").click()
    names = zipfile.ZipFile(folder.value.path()).namelist()
    assert any(name.endswith("study.toml") for name in names)
    assert any(name.endswith("synthetic_30deg_2N.png") for name in names)
    page.get_by_role("button", name="Other studies").click()
    page.get_by_label("ZIP file of a study").set_input_files(folder.value.path())
    page.get_by_role("heading", name="Left index finger pad of Dzidek et al. 2017").wait_for()
    expect(tab.page.locator("#sidebar .step-state.good").first).to_have_text("complete")


# Scales by three points on a rim and by a grid, and contact images rectified by it


def new_scale(page, way: str, file: str) -> None:
    page.get_by_role("button", name="New scale").first.click()
    page.get_by_role("radio", name=way, exact=True).click()
    page.get_by_label("Image", exact=True).select_option(file)


def scale_of(text: str) -> tuple[float, float]:
    value, std = re.search(r"([\d.]+) ± ([\d.]+)", text).groups()
    return float(value), float(std)


def test_three_points_on_the_rim_of_a_coin(tab: Tab, demo) -> None:
    coin = render_coin(seed=1)
    Image.fromarray(coin.pixels).save(demo / "some_coin.png")
    page = tab.open("scale")
    new_scale(page, "Circle", "some_coin.png")
    require_picture(page)
    place = box(page.locator(".stage .picture"))
    zoom = place["width"] / coin.pixels.shape[1]
    (row, column), radius = coin.centre, float(coin.ellipse.semi_major)
    for turn in (0.3, 2.4, 4.5):
        page.mouse.click(
            place["x"] + zoom * (column + 0.5 + radius * math.cos(turn)),
            place["y"] + zoom * (row + 0.5 + radius * math.sin(turn)),
        )
    page.get_by_label("Diameter", exact=True).fill("20")
    page.keyboard.press("Tab")
    before = numbers(page, "scale")
    found, std = scale_of(before)
    assert found == pytest.approx(10 / radius, rel=0.02)
    assert std > 0
    expect(page.locator("path.coin")).to_have_attribute("d", re.compile("."))
    focus(page, "Point 1 on the rim").press("Shift+ArrowRight")
    moving(page, before, "scale")


def test_a_grid_shows_a_tilt_and_rectifies_contact_images(tab: Tab, demo) -> None:
    board = Scene(tilt=0.35, turn=0.5).picture((7, 9), 4.0, "checkerboard")
    Image.fromarray(board).save(demo / "board.png")
    page = tab.open("scale")
    new_scale(page, "Grid", "board.png")
    for name, value in {"Points down": "7", "Points along": "9", "Spacing": "4"}.items():
        page.get_by_label(name).fill(value)
    page.keyboard.press("Tab")
    found, std = scale_of(numbers(page, "scale"))
    assert std > 0.05 * found
    page.get_by_text("rectify contact images by their grid").wait_for()
    page.get_by_label("Name", exact=True).fill("board")
    page.get_by_role("button", name="Only contact images").click()
    page.get_by_role("button", name="Save scale").click()
    page.get_by_role("button", name=re.compile(r"Rectify \d+ contact images")).click()
    page.get_by_role("heading", name="Scale board_rectified").wait_for()
    study = manifest(demo)
    assert study["scales"]["board_rectified"]["mm_per_px"] == pytest.approx(found, rel=2e-3)
    assert study["scales"]["board_rectified"]["relative_std"] < 0.005
    tab.go("contacts/images/synthetic_30deg_2N")
    page.locator(".context", has_text="scale board_rectified").wait_for()
    assert (demo / "rectified" / "synthetic__synthetic_30deg_2N.png").is_file()
