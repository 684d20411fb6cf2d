"""Scales by three points on a rim and by a grid, and contact images rectified by it."""

import math
import re
import tomllib

import pytest
from benchmarks.truth.grids import Scene
from PIL import Image
from playwright.sync_api import expect
from tests.end_to_end.page.browser import Tab, box, focus, moving, numbers, require_picture

from fingerpad.simulate import render_coin


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
    page.get_by_text("rectify the pictures by their grid").wait_for()
    page.get_by_label("Name", exact=True).fill("board")
    page.get_by_role("button", name="Only contact images").click()
    page.get_by_role("button", name="Save scale").click()
    page.get_by_role("button", name=re.compile(r"Rectify \d+ contact images")).click()
    page.get_by_role("heading", name="Scale board_rectified").wait_for()
    study = tomllib.loads((demo / "study.toml").read_text())
    assert study["scales"]["board_rectified"]["mm_per_px"] == pytest.approx(found, rel=2e-3)
    assert study["scales"]["board_rectified"]["relative_std"] < 0.005
    tab.go("contacts/images/synthetic_30deg_2N")
    page.locator(".context", has_text="scale board_rectified").wait_for()
    assert (demo / "rectified" / "synthetic__synthetic_30deg_2N.png").is_file()
