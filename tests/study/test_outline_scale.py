"""Outlines in millimetres whose scale has a name: one uncertain number for all of them."""

from pathlib import Path

import numpy as np
import pytest

from fingerpad.exceptions import ManifestError
from fingerpad.simulate import outline_points, simulate_loading_curve
from fingerpad.study.pipeline import run_study
from fingerpad.study.results.study_result import StudyResult

AXES = {"palmar": (11.8, 13.8), "distal": (11.8, 7.9), "radial": (7.9, 13.8)}
PAD = np.array([7.9, 13.8, 11.8])
FACE = '{{ face = "{face}", outline = "{face}.csv", {scale} }}'
STUDY = """
title = "T"
[uncertainty]
wedge_angle_deg_std = 0.3
[scales.camera]
mm_per_px = 0.05
relative_std = 0.03
[[fingers]]
name = "f"
photographs = [{faces}]
[[observations]]
name = "x"
finger = "f"
wedge_angle_deg = 30
load_N = 1
ellipse_mm = {{ semi_major = 7.4, semi_minor = 5.0, std = 0.1 }}
"""


def run(folder: Path, scale: str) -> StudyResult:
    folder.mkdir()
    for face, axes in AXES.items():
        np.savetxt(
            folder / f"{face}.csv", outline_points(*axes), delimiter=",", header="x_mm,y_mm", comments=""
        )
    faces = ", ".join(FACE.format(face=face, scale=scale) for face in AXES)
    (folder / "study.toml").write_text(STUDY.format(faces=faces))
    return run_study(folder / "study.toml", folder / "out")


def test_an_error_of_a_named_scale_moves_all_semi_axes_alike(tmp_path: Path) -> None:
    own, shared = (
        run(tmp_path / name, scale).fingers["f"]
        for name, scale in (("own", "outline_relative_std = 0.03"), ("shared", 'scale = "camera"'))
    )
    assert (own.scale, shared.scale) == (None, "camera")
    relative = np.sqrt(np.diagonal(shared.covariance)) / PAD
    assert (relative > 0.03).all()  # three faces of one scale do not average its error out
    size = np.ones(3) / (3 * PAD)  # of the logarithm of the geometric mean
    assert np.sqrt(size @ shared.covariance @ size) > 0.03 > 1.2 * np.sqrt(size @ own.covariance @ size)


def test_a_named_scale_of_outlines_is_not_taken_as_exact(tmp_path: Path) -> None:
    study = run(tmp_path / "study", 'scale = "camera"').study
    assert not [words for words in study.taken_as_exact() if "outlines" in words or "scale" in words]


def test_a_name_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(ManifestError, match="no scale is named 'other'"):
        run(tmp_path / "study", 'scale = "other"')


CURVE = """[scales.other]
mm_per_px = 0.05
relative_std = 0.03
[[curves]]
finger = "f"
wedge_angle_deg = 30
file = "curve.csv"
scale = "{scale}"
"""


def test_the_scale_that_outlines_and_areas_share_is_one_error_in_their_comparison(tmp_path: Path) -> None:
    spreads = {}
    for scale in ("camera", "other"):
        folder = tmp_path / scale
        run(folder, 'scale = "camera"')
        curve = simulate_loading_curve(force_std=0.004, displacement_std=0.003, area_std=0.8, points=100)
        columns = np.stack([curve.time, curve.load, curve.indentation, curve.area], axis=-1)
        header = "time_s,force_N,displacement_mm,area_mm2"
        np.savetxt(folder / "curve.csv", columns, delimiter=",", header=header, comments="")
        with (folder / "study.toml").open("a") as file:
            file.write(CURVE.format(scale=scale))
        (validity,) = run_study(folder / "study.toml", folder / "out").validities
        (check,) = (one for one in validity.checks if one.name == "radius_against_loading")
        spreads[scale] = check.relative_std
    # The pad's radius goes with the scale of its outlines, R_g with the square of that of the areas.
    first, second = 1 + 0.03 * np.random.default_rng(0).normal(size=(2, 100_000))
    shared, apart = np.log(first / first**2).var(), np.log(first / second**2).var()
    assert spreads["other"] ** 2 - spreads["camera"] ** 2 == pytest.approx(apart - shared, rel=0.05)
