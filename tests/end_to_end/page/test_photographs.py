"""Review of photographs: outline, axes, points, region, lengths, and the combined pad."""

import re
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import expect
from tests.end_to_end.page.browser import Tab, changed, corrections, lift, middle, moving, numbers, stroke


@pytest.fixture(scope="module")
def same_files(run_demo, tmp_path_factory) -> Path:
    return Path(shutil.copytree(run_demo, tmp_path_factory.mktemp("photographs") / "demo"))


@pytest.fixture
def demo(same_files) -> Iterator[Path]:
    """The study without corrections; fits of its photographs, the same files each time, are cached."""
    yield same_files
    (same_files / "corrections.jsonl").unlink(missing_ok=True)


def distal(text: str) -> float:
    return float(re.search(r"Distal semi-axis\s+([\d.]+) ±", text).group(1))


def test_dragged_axis_moves_the_joint_result(tab: Tab, demo) -> None:
    page = tab.open("photographs")
    pad, face = numbers(page, "finger"), numbers(page, "face")
    place = page.get_by_role("button", name="End of the semi-axis along", exact=True)
    x, y = middle(place)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x, y + 25, steps=5)
    held = moving(page, pad, "finger")
    assert not (demo / "corrections.jsonl").exists()
    assert distal(held) < distal(pad) - 0.02
    lift(page)
    assert distal(numbers(page, "finger")) < distal(pad) - 0.02
    expect(page.get_by_text("manual", exact=True)).to_be_visible()
    assert list(corrections(demo)[-1]["change"]) == ["ellipse_px"]
    expect(page.locator(".difference .number").first).to_have_text(re.compile(r"^[+−]\d+\.\d %$"))
    page.keyboard.press("u")
    assert numbers(page, "finger") == pad
    assert numbers(page, "face") == face
    expect(page.get_by_text("automatic", exact=True)).to_be_visible()


def test_points_are_added_moved_and_erased(tab: Tab, demo) -> None:
    page = tab.open("photographs")
    before = numbers(page, "face")
    page.keyboard.press("e")
    for _ in range(6):
        page.keyboard.press("]")
    x, y = middle(page.locator(".stage"))
    stroke(page, (x - 60, y - 170), (x + 60, y - 170))
    fewer = changed(page, before, "face")
    assert set(corrections(demo)[-1]["change"]) == {"erased"}
    page.keyboard.press("b")
    page.mouse.click(x, y - 178)
    changed(page, fewer, "face")
    assert len(corrections(demo)[-1]["change"]["added_points_px"]) == 1
    point = page.get_by_role("button", name=re.compile("^Point 1 added"))
    point.press("Delete")
    assert numbers(page, "face") == fewer
    assert set(corrections(demo)[-1]["change"]) == {"erased"}


def test_semi_axes_of_the_last_run_are_marked_until_the_next(example_tab: Tab, example, results) -> None:
    manifest = example / "study.toml"
    page = example_tab.open("study")
    page.get_by_text("Nothing is missing.").wait_for()
    on_pad = page.locator(".inspector").get_by_text("of the last run, out of date", exact=True)
    fingers = page.get_by_role("group", name="Fingers")
    expect(fingers.get_by_text("out of date")).to_have_count(0)
    text = manifest.read_text()
    manifest.write_text(text.replace("mm_per_px = 0.1\n", "mm_per_px = 0.11\n"))
    page.reload()
    page.get_by_text("Semi-axes of synthetic_pad are out of date.").wait_for()
    expect(fingers.get_by_text("out of date")).to_have_count(1)
    expect(page.get_by_text("Nothing is missing.")).to_have_count(0)
    example_tab.go("contacts/images/contact_1N")
    numbers(page)
    expect(page.locator(".inspector").get_by_text("semi-axes out of date")).to_have_count(2)
    example_tab.go("pad")
    numbers(page, "u")
    expect(on_pad).to_have_count(2)
