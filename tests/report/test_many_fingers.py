"""The report of many fingers: a page over all, and one for each finger that is drawn when it must be."""

import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from fingerpad.exceptions import FingerpadError
from fingerpad.loading import simulate_loading_curve
from fingerpad.report import write, write_report
from fingerpad.study.pipeline import run_study
from fingerpad.study.results.study_result import StudyResult

DRAW = """
import sys
from pathlib import Path
from fingerpad.report import write, write_report
from fingerpad.study.pipeline import run_study

write._MOST_GROUPS = 5
manifest, out = map(Path, sys.argv[1:])
write_report(run_study(manifest, out), out, on_drawn=print)
"""
FINGERS, WEDGES, LOADS = ("left", "right", "thumb"), (0, 30), (1, 2)


def of_fingers(told: list[str]) -> list[str]:
    return [what for what in told if what.endswith("fingers")]


@pytest.fixture(autouse=True)
def few_groups(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(write, "_MOST_GROUPS", 5)


def manifest_of(
    folder: Path, *, fingers: tuple[str, ...] = FINGERS, thumb_mm: float = 6.0, curve: bool = False
) -> Path:
    lines = ['title = "Many fingers"']
    for name in fingers:
        lines += [
            "[[fingers]]",
            f'name = "{name}"',
            "semi_axes_mm = { palmar = 7.9, distal = 13.8, radial_ulnar = 11.8 }",
            "semi_axes_std_mm = { palmar = 0.1, distal = 0.1, radial_ulnar = 0.1 }",
        ]
    for name in fingers:
        for wedge in WEDGES:
            for load in LOADS:
                size = (thumb_mm if name == "thumb" else 6.0) * load**0.3
                lines += [
                    "[[observations]]",
                    f'name = "{name}_{wedge}_{load}"',
                    f'finger = "{name}"',
                    f"wedge_angle_deg = {wedge}",
                    f"load_N = {load}",
                    f"ellipse_mm = {{ semi_major = {size:.3f}, semi_minor = 5.0, std = 0.1 }}",
                ]
    folder.mkdir(exist_ok=True)
    if curve:
        press = simulate_loading_curve(effective_radius=15.0, force_std=0.004)
        columns = np.stack([press.time, press.load, press.indentation, press.area], axis=-1)
        header = "time_s,force_N,displacement_mm,area_mm2"
        np.savetxt(folder / "left.csv", columns, delimiter=",", header=header, comments="")
        lines += ["[[curves]]", 'finger = "left"', "wedge_angle_deg = 30", 'file = "left.csv"']
    (folder / "study.toml").write_text("\n".join(lines))
    return folder / "study.toml"


def run(folder: Path, **changes: object) -> StudyResult:
    return run_study(manifest_of(folder / "study", **changes), folder / "out")  # type: ignore[arg-type]


def pages(out: Path) -> dict[str, bytes]:
    return {path.stem: path.read_bytes() for path in (out / "report").glob("*.html")}


def test_every_finger_has_a_page_and_one_leads_to_all(tmp_path: Path) -> None:
    out = tmp_path / "out"
    over = write_report(run(tmp_path), out).read_text()
    assert pages(out).keys() == set(FINGERS)
    for name in FINGERS:
        page = (out / "report" / f"{name}.html").read_text()
        assert f'href="report/{name}.html"' in over
        assert 'href="../report.html"' in page
        assert f"{name}, wedge 30°" in page
        assert not any(f"{other}, wedge" in page for other in FINGERS if other != name)
        # The pad, the radius, the area, the budget at each angle.
        assert page.count("<svg") >= 4 * len(WEDGES)
    assert over.count("<svg") == 1
    assert len(re.findall(r"<td class=\"number\">30°</td>", over)) == len(FINGERS)


def test_only_what_changed_is_drawn_again(tmp_path: Path) -> None:
    out = tmp_path / "out"
    told: list[str] = []
    write_report(run(tmp_path), out, on_drawn=told.append)
    assert of_fingers(told) == ["1 of 3 fingers", "2 of 3 fingers", "3 of 3 fingers"]
    before, figures = pages(out), {path: path.stat().st_mtime_ns for path in out.glob("figures/*")}
    told.clear()
    write_report(run(tmp_path), out, on_drawn=told.append)
    assert of_fingers(told) == []
    assert pages(out) == before
    write_report(run(tmp_path, thumb_mm=6.2), out, on_drawn=told.append)
    assert of_fingers(told) == ["3 of 3 fingers"]
    after = pages(out)
    assert {name for name in after if after[name] != before[name]} == {"thumb"}
    same = {path for path, time in figures.items() if path.stat().st_mtime_ns == time}
    assert {path.name.split("_")[0] for path in same} == {"left", "right"}


def test_another_process_draws_nothing_again(tmp_path: Path) -> None:
    manifest = manifest_of(tmp_path / "study", curve=True)
    told = []
    for seed in ("1", "2"):  # of the order that words have in sets
        command = [sys.executable, "-c", DRAW, str(manifest), str(tmp_path / "out")]
        done = subprocess.run(
            command, capture_output=True, text=True, check=True, env={**os.environ, "PYTHONHASHSEED": seed}
        )
        told.append(of_fingers(done.stdout.splitlines()))
    assert [len(each) for each in told] == [3, 0]


@pytest.mark.parametrize("lost", ["report/left.html", "figures/left_30deg_area.svg"])
def test_a_page_that_lost_a_file_is_drawn_again(tmp_path: Path, lost: str) -> None:
    out = tmp_path / "out"
    write_report(run(tmp_path), out)
    (out / lost).unlink()
    told: list[str] = []
    write_report(run(tmp_path), out, on_drawn=told.append)
    assert of_fingers(told) == ["3 of 3 fingers"]
    assert (out / lost).is_file()


@pytest.mark.parametrize("index", ["", "{", "[]", '{"left": 1}', '{"left": {"key": 1, "files": "report"}}'])
def test_a_damaged_index_costs_the_drawing_only(tmp_path: Path, index: str) -> None:
    out = tmp_path / "out"
    write_report(run(tmp_path), out)
    before = pages(out).keys()
    (out / "report" / "pages.json").write_text(index)
    write_report(run(tmp_path), out)
    assert pages(out).keys() == before


def test_fingers_that_left_the_study_leave_nothing(tmp_path: Path) -> None:
    out = tmp_path / "out"
    write_report(run(tmp_path), out)
    write_report(run(tmp_path, fingers=("left",)), out)
    assert not (out / "report").exists()
    assert all(path.name.startswith("left") for path in out.glob("figures/*"))
    assert "left, wedge 30°" in (out / "report.html").read_text()


def test_two_processes_draw_what_one_draws(tmp_path: Path) -> None:
    result = run(tmp_path, curve=True)
    one, two = tmp_path / "one", tmp_path / "two"
    write_report(result, one)
    write_report(result, two, workers=2)
    files = {path.relative_to(one) for path in one.rglob("*") if path.is_file()}
    assert files == {path.relative_to(two) for path in two.rglob("*") if path.is_file()}
    for file in files - {Path("report/pages.json")}:
        assert (one / file).read_bytes() == (two / file).read_bytes(), file
    assert "left.csv" in pages(one)["left"].decode()
    assert any("curve" in file.name for file in files)


def test_an_interrupt_keeps_what_is_drawn(tmp_path: Path) -> None:
    result, out = run(tmp_path), tmp_path / "out"

    def stop(what: str) -> None:
        if what == "2 of 3 fingers":
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_report(result, out, on_drawn=stop)
    assert len(pages(out)) == 2
    assert not (out / "report.html").exists()
    told: list[str] = []
    write_report(result, out, on_drawn=told.append)
    assert of_fingers(told) == ["3 of 3 fingers"]


def test_a_folder_that_cannot_be_written(tmp_path: Path) -> None:
    result, out = run(tmp_path), tmp_path / "out"
    (out / "report").write_text("in the way")
    with pytest.raises(FingerpadError, match="report"):
        write_report(result, out)
