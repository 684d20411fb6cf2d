"""What is measured in a curve or outline whose scale has a name: one uncertain number for all of them."""

from pathlib import Path

import numpy as np
import pytest
from tests.studies import PAD, Table, contact, curve, finger, run, write_curve, write_outlines

from fingerpad.simulate import simulate_loading_curve
from fingerpad.study.measuring.curves import CurveResult, loading_radius
from fingerpad.study.results.study_result import StudyResult

CAMERA = {"mm_per_px": 0.05, "relative_std": 0.03}
LOST = {"coin": "none.png", "diameter_mm": 23.25}


def curves(folder: Path, *stated: dict[str, object]) -> list[CurveResult]:
    # On a half-space: to fit a layer takes twice the time of all else.
    tables = [curve(thickness_mm=np.inf, **{"file": "0.csv", **keys}) for keys in stated]
    return run(folder, finger(), *tables, scales={"camera": CAMERA}).curves


@pytest.fixture(scope="module")
def fitted(tmp_path_factory) -> list[CurveResult]:
    """Return a curve without a scale, by its name, by its uncertainty and lost; and another by its name."""
    folder = tmp_path_factory.mktemp("fitted")
    for seed in (0, 1):
        made = simulate_loading_curve(
            force_std=0.004, displacement_std=0.003, area_std=0.8, points=100, seed=seed
        )
        write_curve(folder / f"{seed}.csv", made)
    np.savetxt(folder / "none.png", [[0]])
    named, other = {"scale": "camera"}, {"scale": "camera", "file": "1.csv"}
    return curves(folder, {}, named, {"area_relative_std": 0.06}, {"scale": LOST}, other)


def test_radius_and_moduli_are_as_uncertain_as_the_scale_of_the_areas(fitted):
    plain, named, stated, *_ = fitted
    # R_g goes with the areas, which have twice the scale's uncertainty, and E with its square root.
    for name, added in (("loading_radius", 0.06), ("youngs_modulus", 0.03), ("initial_modulus", 0.03)):
        before, after = (getattr(one.fit, name) for one in (plain, named))
        assert after.value == pytest.approx(before.value, rel=1e-6)
        assert np.sqrt(after.std**2 - before.std**2) / after.value == pytest.approx(added, rel=0.05), name
        assert getattr(stated.fit, name).std == pytest.approx(after.std), name
    before, after = (one.fit.contact_offset for one in (plain, named))
    assert after.std == pytest.approx(before.std, rel=1e-2)


def test_curves_of_one_scale_do_not_average_its_error_out(fitted):
    pooled = loading_radius([fitted[1], fitted[4]], ("f", 30.0, False))
    assert pooled is not None
    assert pooled.std / pooled.value > 0.06


def test_a_scale_that_is_not_found_costs_its_curve(fitted):
    assert fitted[3].reason is not None
    assert "none.png" in fitted[3].reason
    assert fitted[3].fit is None
    assert all(one.fit is not None for one in fitted if one is not fitted[3])


# Outlines in millimetres whose scale has a name: one uncertain number for all of them

AXES = np.array(list(PAD.values()))


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


def test_an_error_of_a_named_scale_moves_all_semi_axes_alike(tmp_path):
    own, shared = (
        study(tmp_path / name, scale).fingers["f"]
        for name, scale in (("own", {"outline_relative_std": 0.03}), ("shared", {"scale": "camera"}))
    )
    assert (own.scale, shared.scale) == (None, "camera")
    relative = np.sqrt(np.diagonal(shared.covariance)) / AXES
    assert (relative > 0.03).all()  # three faces of one scale do not average its error out
    size = np.ones(3) / (3 * AXES)  # of the logarithm of the geometric mean
    assert np.sqrt(size @ shared.covariance @ size) > 0.03 > 1.2 * np.sqrt(size @ own.covariance @ size)


def test_a_named_scale_of_outlines_is_not_taken_as_exact(tmp_path):
    found = study(tmp_path / "study", {"scale": "camera"}).study
    assert not [words for words in found.taken_as_exact() if "outlines" in words or "scale" in words]


def test_the_scale_that_outlines_and_areas_share_is_one_error(tmp_path):
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
