"""The report of many fingers: a page over all, and one for each finger that is drawn when it must be."""

import math
import re
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from tests.studies import contact, curve, finger, write_curve, write_study

from fingerpad.exceptions import FingerpadError
from fingerpad.report import write, write_report
from fingerpad.simulate import simulate_loading_curve
from fingerpad.study.pipeline import run_study
from fingerpad.study.results.result_set import result_files
from fingerpad.study.results.study_result import StudyResult

FINGERS, LOADS = ("left", "right", "thumb"), (1, 2)


def finger_pages(items: list[str]) -> list[str]:
    return [item for item in items if item.startswith("page of ")]


@pytest.fixture(autouse=True)
def few_groups(monkeypatch) -> None:
    monkeypatch.setattr(write, "_MOST_GROUPS", 3)


def manifest_of(folder: Path, *, fingers: tuple[str, ...] = FINGERS, thumb_mm: float = 6.0) -> Path:
    # Angles known so well that few random draws check the uncertainty.
    # Two angles of one finger are the least that is drawn over all.
    places = [(name, wedge) for name in fingers for wedge in ((0, 30) if name == "left" else (30,))]
    contacts = [
        contact(
            f"{name}_{wedge}_{load}",
            load,
            ((thumb_mm if name == "thumb" else 6.0) * load**0.3, 5.0),
            finger=name,
            wedge=wedge,
            axis="",
        )
        for name, wedge in places
        for load in LOADS
    ]
    folder.mkdir(exist_ok=True)
    if not (folder / "left.csv").exists():
        press = simulate_loading_curve(loading_radius=15.0, force_std=0.004, points=100)
        write_curve(folder / "left.csv", press)
    return write_study(
        folder,
        *map(finger, fingers),
        *contacts,
        curve(finger="left", file="left.csv", thickness_mm=math.inf),  # to fit a layer takes long
        uncertainty={"wedge_angle_deg_std": 0.3},
        title="Many fingers",
    )


def run(folder: Path, on_item: Callable[[str], None] = lambda _: None, **changes: object) -> StudyResult:
    manifest = manifest_of(folder / "study", **changes)  # type: ignore[arg-type]
    return run_study(
        manifest,
        folder / "out",
        write_report=write_report,
        on_progress=lambda progress: on_item(progress.item),
    )


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
    assert len(re.findall(r"<td class=\"number\">30°</td>", over)) == len(FINGERS) + 1  # and the curve


def test_only_changed_pages_redrawn(finished):
    out = finished / "out"
    before = pages(out)
    items: list[str] = []
    run(finished, items.append)
    assert finger_pages(items) == []
    assert pages(out) == before
    run(finished, items.append, thumb_mm=6.2)
    assert finger_pages(items) == ["page of thumb"]
    after = pages(out)
    assert {name for name in after if after[name] != before[name]} == {"thumb"}


@pytest.mark.parametrize("lost", ["report/left.html", "figures/left_30deg_area.svg"])
def test_page_with_lost_file_redrawn(finished, lost):
    out = finished / "out"
    (out / lost).unlink()
    items: list[str] = []
    run(finished, items.append)
    assert finger_pages(items) == ["page of left"]
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

    def stop(what: str) -> None:
        drawn.extend(finger_pages([what]))
        if len(drawn) == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run(tmp_path, stop, thumb_mm=6.2)
    assert {name: (out / name).read_bytes() for name in result_files(out)} == before
    items: list[str] = []
    run(tmp_path, items.append, thumb_mm=6.2)
    assert set(finger_pages(items)).isdisjoint(drawn)
    assert pages(out).keys() == set(FINGERS)


def test_unwritable_folder(finished):
    shutil.rmtree(finished / "out" / "report")
    (finished / "out" / "report").write_text("in the way")
    with pytest.raises(FingerpadError, match="report"):
        run(finished)
