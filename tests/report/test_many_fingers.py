"""The report of many fingers: a page over all, and one for each finger that is drawn when it must be."""

import math
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from tests.studies import contact, curve, finger, write_curve, write_study

from fingerpad.report import write, write_report
from fingerpad.simulate import simulate_loading_curve
from fingerpad.study.engine.runner import Progress
from fingerpad.study.pipeline import run_study
from fingerpad.study.results.result_set import result_files

FINGERS, LOADS = ("left", "right", "thumb"), (1, 2)


def finger_pages(items: list[str]) -> list[str]:
    return [item for item in items if item.startswith("page of ")]


@pytest.fixture(autouse=True)
def few_groups(monkeypatch) -> None:
    monkeypatch.setattr(write, "_MOST_GROUPS", 3)


def manifest_of(folder: Path, *, fingers: tuple[str, ...] = FINGERS, thumb_mm: float = 6.0) -> Path:
    # Two angles of one finger are the least that is drawn over all.
    places = [(name, wedge) for name in fingers for wedge in ((0, 30) if name == "left" else (30,))]
    majors = dict.fromkeys(fingers, 6.0) | {"thumb": thumb_mm}
    contacts = [
        contact(f"{name}_{wedge}_{load}", load, (majors[name] * load**0.3, 5.0), finger=name, wedge=wedge)
        for name, wedge in places
        for load in LOADS
    ]
    folder.mkdir(exist_ok=True)
    if not (folder / "left.csv").exists():
        press = simulate_loading_curve(loading_radius=15.0, force_std=0.004, points=100)
        write_curve(folder / "left.csv", press)
    pressed = curve(finger="left", file="left.csv", thickness_mm=math.inf)  # to fit a layer takes long
    # Angles known so well that few random draws check the uncertainty.
    stated = {"wedge_angle_deg_std": 0.3}
    return write_study(folder, *map(finger, fingers), *contacts, pressed, uncertainty=stated)


def run(folder: Path, **changes: Any) -> list[str]:
    """Run the study with such changes, and return the fingers whose pages were drawn."""
    items: list[str] = []
    run_study(
        manifest_of(folder / "study", **changes),
        folder / "out",
        write_report=write_report,
        on_progress=lambda progress: items.append(progress.item),
    )
    return finger_pages(items)


def pages(out: Path) -> dict[str, bytes]:
    return {path.stem: path.read_bytes() for path in (out / "report").glob("*.html")}


@pytest.fixture(scope="module")
def drawn(tmp_path_factory) -> Path:
    """Return a folder with the study and its results."""
    folder = tmp_path_factory.mktemp("drawn") / "now"
    folder.mkdir()
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(write, "_MOST_GROUPS", 3)
        run(folder)
    shutil.copytree(folder, folder.with_name("kept"))
    return folder


@pytest.fixture
def finished(drawn) -> Iterator[Path]:
    """Return the same folder, as elsewhere all would be drawn again; a test may change it."""
    yield drawn
    shutil.rmtree(drawn)
    shutil.copytree(drawn.with_name("kept"), drawn)


def test_one_page_per_finger_and_index(drawn):
    out = drawn / "out"
    over = (out / "report.html").read_text()
    assert pages(out).keys() == set(FINGERS)
    for name in FINGERS:
        page = (out / "report" / f"{name}.html").read_text()
        assert f'href="report/{name}.html"' in over
        assert 'href="../report.html"' in page
        assert f"{name}, wedge 30°" in page
        assert not any(f"{other}, wedge" in page for other in FINGERS if other != name)
        # The same of this finger, and the pad, the radius, the area, the budget.
        assert page.count("<svg") >= 3 + 4
    # Area, modulus and radius against load, and the radius against the wedge angle.
    assert over.count("<svg") == 4
    assert over.count('<td class="number" data-label="Wedge">30°</td>') == len(FINGERS)
    assert over.count('<td class="number">30°</td>') == 1  # the curve


def test_only_changed_pages_redrawn(finished):
    out = finished / "out"
    before = pages(out)
    assert run(finished) == []
    assert pages(out) == before
    assert run(finished, thumb_mm=6.2) == ["page of thumb"]
    after = pages(out)
    assert {name for name in after if after[name] != before[name]} == {"thumb"}


@pytest.mark.parametrize("lost", ["report/left.html", "figures/left_30deg_area.svg"])
def test_page_with_lost_file_redrawn(finished, lost):
    out = finished / "out"
    (out / lost).unlink()
    assert run(finished) == ["page of left"]
    assert (out / lost).is_file()


def test_pages_of_removed_fingers_deleted(finished):
    out = finished / "out"
    run(finished, fingers=("left",))
    assert not (out / "report").exists()
    assert not [path.name for path in out.glob("figures/*") if path.name.startswith(("right", "thumb"))]
    assert "left, wedge 30°" in (out / "report.html").read_text()


def without_time(file: Path) -> bytes:
    """Return a file without the time at which it was made."""
    return re.sub(rb"\d{4}-\d\d-\d\d( at |T| )[\d:+]*", b"", file.read_bytes())


@pytest.mark.nightly
def test_two_processes_equal_one(drawn, tmp_path):
    one, two = drawn / "out", tmp_path / "two"
    run_study(drawn / "study" / "study.toml", two, workers=2, write_report=write_report)
    files = result_files(one)
    assert files == result_files(two)
    for file in files:
        assert without_time(one / file) == without_time(two / file), file
    assert "left.csv" in pages(one)["left"].decode()
    assert any("curve" in file for file in files)


def test_interrupt_keeps_drawn_pages_and_previous_results(tmp_path):
    out = tmp_path / "out"
    run(tmp_path, fingers=("left", "right"))
    before = {name: (out / name).read_bytes() for name in result_files(out)}
    drawn: list[str] = []

    def stop(progress: Progress) -> None:
        drawn.extend(finger_pages([progress.item]))
        if len(drawn) == 2:
            raise KeyboardInterrupt

    manifest = manifest_of(tmp_path / "study", thumb_mm=6.2)
    with pytest.raises(KeyboardInterrupt):
        run_study(manifest, out, write_report=write_report, on_progress=stop)
    assert {name: (out / name).read_bytes() for name in result_files(out)} == before
    assert set(run(tmp_path, thumb_mm=6.2)).isdisjoint(drawn)
    assert pages(out).keys() == set(FINGERS)
