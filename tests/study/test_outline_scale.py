"""Outlines in millimetres whose scale has a name: one uncertain number for all of them."""

from pathlib import Path

import numpy as np
import pytest
from tests.studies import PAD, Table, contact, curve, finger, run, write_curve, write_outlines

from fingerpad.exceptions import ManifestError
from fingerpad.simulate import simulate_loading_curve
from fingerpad.study.results.study_result import StudyResult

AXES = np.array(list(PAD.values()))
CAMERA = {"mm_per_px": 0.05, "relative_std": 0.03}


def study(folder: Path, scale: dict[str, object], *more: Table) -> StudyResult:
    folder.mkdir(exist_ok=True)
    return run(
        folder,
        finger(photographs=write_outlines(folder, **scale)),
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
    relative = np.sqrt(np.diagonal(shared.covariance)) / AXES
    assert (relative > 0.03).all()  # three faces of one scale do not average its error out
    size = np.ones(3) / (3 * AXES)  # of the logarithm of the geometric mean
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
        made = simulate_loading_curve(force_std=0.004, displacement_std=0.003, area_std=0.8, points=50)
        write_curve(folder / "curve.csv", made)
        of_areas = curve(file="curve.csv", scale=scale)
        result = study(folder, {"scale": "camera"}, of_areas)
        (validity,), (of_curve,) = result.validities, result.curves
        radii[scale] = of_curve.layer.radius
        (check,) = (one for one in validity.checks if one.check == "radius_against_loading")
        spreads[scale] = check.relative_std
    # The pad's radius goes with the scale of its outlines, R_g with the square of that of the areas.
    first, second = 1 + 0.03 * np.random.default_rng(0).normal(size=(2, 100_000))
    shared, apart = np.log(first / first**2).var(), np.log(first / second**2).var()
    assert spreads["other"] ** 2 - spreads["camera"] ** 2 == pytest.approx(apart - shared, rel=0.05)
    # In the fit of a layer areas that are wrong by the scale tell how wrong the radius is.
    assert radii["camera"].std < 0.95 * radii["other"].std
