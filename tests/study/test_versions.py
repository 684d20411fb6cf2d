"""Numbers that each measurement version stands for.

A change that alters one of them must raise its version in `fingerpad.study.engine.task`, so that stored
results are measured again. Record the new numbers with ``python -m tests.study.test_versions``.
"""

import json
import shutil
import tempfile
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image
from tests.studies import correct, curve, finger, picture, sequence, summary_of, write_study

from fingerpad.simulate import render_coin
from fingerpad.study.engine import task as versions
from fingerpad.study.pipeline import run_study
from fingerpad.study.status import study_status

PINNED = Path(__file__).with_name("measured_numbers.json")
DEMO = Path(__file__).parents[2] / "examples" / "dzidek2017" / "synthetic"
SCALES = {
    "camera": {"mm_per_px": 0.05, "relative_std": 0.002},
    "reader": {"ppi": 500},
    "coin": {"coin": "coin.png", "diameter_mm": 20},
    "board": {"grid": "board.png", "points": [5, 6], "spacing_mm": 2},
}
OBSERVATIONS = {"contact": "reader", "corrected": "reader", "by_coin": "coin", "by_grid": "board"}
THICK = {"effective_thickness_mm": 7.9, "effective_thickness_mm_std": 1.1}
IMAGE, FORCE = "synthetic_30deg_2N.png", "synthetic_press_30deg_force.csv"
CORRECTION = {"region_of_interest_px": [60, 60, 420, 330]}
FRAMES = ("press#8", "press#12", "press#16")
# Where in summary.json the numbers of each kind of measurement stand.
PLACES = {"image": ("fingers",), "loading": ("curves",), "uncertainty": ("summaries",)}
IMAGE_COLUMNS = (
    "semi_major_mm", "semi_minor_mm", "edge_offset_mm_std", "gross_area_mm2",
    "gross_area_mm2_noise_std", "ridge_area_mm2", "ridge_area_mm2_std", "ridge_period_mm",
)  # fmt: skip


def make_study(folder: Path) -> Path:
    for file in DEMO.iterdir():
        shutil.copy(file, folder)
    Image.fromarray(render_coin(seed=1).pixels).save(folder / "coin.png")
    board = 60 + 120 * np.pad(
        np.kron(np.indices((6, 7)).sum(axis=0) % 2, np.ones((40, 40))), 40, constant_values=1
    )
    cv2.imwrite(str(folder / "board.png"), cv2.GaussianBlur(board, (0, 0), 1.2).astype(np.uint8))
    drawn = {"finger": "pad", "synthetic": True}
    photographs = [
        {"face": face, "file": f"photograph_{face}.jpg", "scale": "camera", "synthetic": True}
        for face in ("palmar", "distal")
    ]
    press = {"scale": {"ppi": 240, "relative_std": 0.002}, "frames_per_second": 20}
    manifest = write_study(
        folder,
        finger("pad", photographs=photographs, synthetic=True, **THICK),
        sequence("press", "synthetic_press_30deg.tif", force=FORCE, **press, **drawn),
        curve(file="curve_30deg_2mm_per_s.csv", **drawn),
        *(picture(name, IMAGE, scale=scale, **drawn) for name, scale in OBSERVATIONS.items()),
        title="Pinned numbers",
        uncertainty={"wedge_angle_deg_std": 0.5, "load_relative_std": 0.01},
        scales=SCALES,
    )
    correct(folder, "corrected", CORRECTION)
    return manifest


def numbers(value: object, place: str = "") -> dict[str, float]:
    if isinstance(value, dict):
        return {k: v for key, one in value.items() for k, v in numbers(one, f"{place}/{key}").items()}
    if isinstance(value, list):
        return {k: v for index, one in enumerate(value) for k, v in numbers(one, f"{place}/{index}").items()}
    return {place: value} if isinstance(value, float) else {}


def measured(manifest: Path, out: Path) -> dict[str, dict[str, float]]:
    run_study(manifest, out, all_columns=True)
    summary = summary_of(out)
    rows = {row["observation"]: row for row in json.loads((out / "results.json").read_text(encoding="utf-8"))}
    found = {kind: numbers({key: summary[key] for key in keys}) for kind, keys in PLACES.items()}
    found["image"] |= numbers(
        {one: {name: rows[one][name] for name in IMAGE_COLUMNS} for one in (*OBSERVATIONS, *FRAMES)},
        "/results",
    )
    return found


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pinned")
    manifest = make_study(folder)
    return manifest, folder / "out", measured(manifest, folder / "out")


@pytest.mark.parametrize("kind", versions.MEASUREMENT_VERSIONS)
def test_a_version_stands_for_its_numbers(run, kind):
    pinned = json.loads(PINNED.read_text(encoding="utf-8"))
    version = versions.MEASUREMENT_VERSIONS[kind]
    assert pinned[kind]["version"] == version, "record the numbers of the new version"
    found = run[2][kind]
    assert found == pytest.approx(pinned[kind]["numbers"], rel=1e-5, abs=1e-9), (
        f"raise the version of {kind!r}, and record its numbers"
    )


@pytest.mark.parametrize("kind", ["image", "loading"])
def test_a_new_version_measures_again(run, monkeypatch, kind):
    manifest, out, _ = run
    assert study_status(manifest, out).stale == 0
    changed = versions.MEASUREMENT_VERSIONS | {kind: -1}
    monkeypatch.setattr(versions, "MEASUREMENT_VERSIONS", changed)
    assert study_status(manifest, out).stale > 0


def test_another_release_of_a_library_measures_again(run, monkeypatch):
    manifest, out, _ = run
    monkeypatch.setattr(versions, "library_versions", lambda: {"opencv": "another"})
    assert study_status(manifest, out).stale == 8


def test_another_release_of_lossless_decoders_does_not(run, monkeypatch):
    manifest, out, _ = run
    found = versions.library_versions()
    assert "imagecodecs" in found  # the record of a run names it
    monkeypatch.setattr(versions, "library_versions", lambda: found | {"imagecodecs": "another"})
    assert study_status(manifest, out).stale == 0


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as scratch:
        found = measured(make_study(Path(scratch)), Path(scratch) / "out")
    record = {
        kind: {"version": versions.MEASUREMENT_VERSIONS[kind], "numbers": found[kind]} for kind in found
    }
    PINNED.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
