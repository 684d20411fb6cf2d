"""Areas of loading curves whose scale has a name: one uncertain number for all of them."""

from pathlib import Path

import numpy as np
import pytest

from fingerpad.exceptions import ManifestError
from fingerpad.simulate import simulate_loading_curve
from fingerpad.study.measuring.curves import CurveResult, loading_radius
from fingerpad.study.pipeline import run_study

STUDY = """
title = "T"
[scales.camera]
mm_per_px = 0.05
relative_std = 0.03
[[fingers]]
name = "f"
semi_axes_mm = { palmar = 7.9, distal = 13.8, radial_ulnar = 11.8 }
semi_axes_mm_std = { palmar = 0.1, distal = 0.1, radial_ulnar = 0.1 }
"""
CURVE = """[[curves]]
finger = "f"
wedge_angle_deg = 30
file = "{file}"
{stated}
"""


def curves(folder: Path, *stated: str) -> list[CurveResult]:
    for seed, _ in enumerate(stated):
        curve = simulate_loading_curve(
            force_std=0.004, displacement_std=0.003, area_std=0.8, points=100, seed=seed
        )
        columns = np.stack([curve.time, curve.load, curve.indentation, curve.area], axis=-1)
        header = "time_s,force_N,displacement_mm,area_mm2"
        np.savetxt(folder / f"{seed}.csv", columns, delimiter=",", header=header, comments="")
    tables = (CURVE.format(file=f"{seed}.csv", stated=words) for seed, words in enumerate(stated))
    (folder / "study.toml").write_text(STUDY + "".join(tables))
    return run_study(folder / "study.toml", folder / "out").curves


def test_radius_and_moduli_are_as_uncertain_as_the_scale_of_the_areas(tmp_path: Path) -> None:
    (plain,) = curves(tmp_path, "")
    (named,) = curves(tmp_path, 'scale = "camera"')
    (stated,) = curves(tmp_path, "area_relative_std = 0.06")
    # R_g goes with the areas, which have twice the scale's uncertainty, and E with its square root.
    for name, added in (("loading_radius", 0.06), ("youngs_modulus", 0.03), ("initial_modulus", 0.03)):
        before, after = (getattr(one.fit, name) for one in (plain, named))
        assert after.value == pytest.approx(before.value, rel=1e-6)
        assert np.sqrt(after.std**2 - before.std**2) / after.value == pytest.approx(added, rel=0.05), name
        assert getattr(stated.fit, name).std == pytest.approx(after.std), name
    before, after = (one.fit.contact_offset for one in (plain, named))
    assert after.std == pytest.approx(before.std, rel=1e-2)
    assert named.layer.radius.std >= plain.layer.radius.std


def test_curves_of_one_scale_do_not_average_its_error_out(tmp_path: Path) -> None:
    two = curves(tmp_path, *2 * ['scale = "camera"'])
    pooled = loading_radius(two, ("f", 30.0, False))
    assert pooled is not None
    assert pooled.std / pooled.value > 0.06


@pytest.mark.parametrize(
    ("stated", "words"),
    [
        ('scale = "other"', "no scale is named 'other'"),
        ('scale = "camera"\narea_relative_std = 0.01', "no use for area_relative_std"),
        ("area_relative_std = 2", "area_relative_std"),
    ],
)
def test_a_scale_that_cannot_be_is_refused(tmp_path: Path, stated: str, words: str) -> None:
    with pytest.raises(ManifestError, match=words):
        curves(tmp_path, stated)


def test_a_scale_that_is_not_found_costs_its_curve(tmp_path: Path) -> None:
    np.savetxt(tmp_path / "none.png", [[0]])
    lost, found = curves(tmp_path, 'scale = { coin = "none.png", diameter_mm = 23.25 }', "")
    assert lost.reason is not None
    assert "none.png" in lost.reason
    assert lost.fit is None
    assert found.fit is not None
