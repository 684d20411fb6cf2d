"""Outlines in millimetres whose scale has a name: one uncertain number for all of them."""

from pathlib import Path

import numpy as np
import pytest
from tests.studies import Table, contact, curve, finger, run, write_curve

from fingerpad.exceptions import ManifestError
from fingerpad.simulate import outline_points, simulate_loading_curve
from fingerpad.study.results.study_result import StudyResult

AXES = {"palmar": (11.8, 13.8), "distal": (11.8, 7.9), "radial": (7.9, 13.8)}
PAD = np.array([7.9, 13.8, 11.8])
CAMERA = {"mm_per_px": 0.05, "relative_std": 0.03}


def study(folder: Path, scale: dict[str, object], *more: Table) -> StudyResult:
    folder.mkdir(exist_ok=True)
    for face, axes in AXES.items():
        np.savetxt(
            folder / f"{face}.csv", outline_points(*axes), delimiter=",", header="x_mm,y_mm", comments=""
        )
    faces = [{"face": face, "outline": f"{face}.csv", **scale} for face in AXES]
    return run(
        folder,
        finger(photographs=faces),
        contact(load=1, axis=""),
        *more,
        uncertainty={"wedge_angle_deg_std": 0.3},
        scales={"camera": CAMERA, "other": CAMERA},
    )


def test_an_error_of_a_named_scale_moves_all_semi_axes_alike(tmp_path: Path) -> None:
    own, shared = (
        study(tmp_path / name, scale).fingers["f"]
        for name, scale in (("own", {"outline_relative_std": 0.03}), ("shared", {"scale": "camera"}))
    )
    assert (own.scale, shared.scale) == (None, "camera")
    relative = np.sqrt(np.diagonal(shared.covariance)) / PAD
    assert (relative > 0.03).all()  # three faces of one scale do not average its error out
    size = np.ones(3) / (3 * PAD)  # of the logarithm of the geometric mean
    assert np.sqrt(size @ shared.covariance @ size) > 0.03 > 1.2 * np.sqrt(size @ own.covariance @ size)


def test_a_named_scale_of_outlines_is_not_taken_as_exact(tmp_path: Path) -> None:
    found = study(tmp_path / "study", {"scale": "camera"}).study
    assert not [words for words in found.taken_as_exact() if "outlines" in words or "scale" in words]


def test_a_name_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(ManifestError, match="no scale is named 'third'"):
        study(tmp_path / "study", {"scale": "third"})


def test_the_scale_that_outlines_and_areas_share_is_one_error(tmp_path: Path) -> None:
    spreads, radii = {}, {}
    for scale in ("camera", "other"):
        (folder := tmp_path / scale).mkdir()
        made = simulate_loading_curve(force_std=0.004, displacement_std=0.003, area_std=0.8, points=100)
        write_curve(folder / "curve.csv", made)
        of_areas = curve(file="curve.csv", scale=scale)
        result = study(folder, {"scale": "camera"}, of_areas)
        (validity,), (of_curve,) = result.validities, result.curves
        radii[scale] = of_curve.layer.radius
        (check,) = (one for one in validity.checks if one.name == "radius_against_loading")
        spreads[scale] = check.relative_std
    # The pad's radius goes with the scale of its outlines, R_g with the square of that of the areas.
    first, second = 1 + 0.03 * np.random.default_rng(0).normal(size=(2, 100_000))
    shared, apart = np.log(first / first**2).var(), np.log(first / second**2).var()
    assert spreads["other"] ** 2 - spreads["camera"] ** 2 == pytest.approx(apart - shared, rel=0.05)
    # In the fit of a layer areas that are wrong by the scale tell how wrong the radius is.
    assert radii["camera"].std < 0.95 * radii["other"].std
