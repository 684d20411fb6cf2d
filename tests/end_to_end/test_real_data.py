"""A study of real prints and real curves by the command line, from the manifest to the report."""

import shutil
from pathlib import Path

import pytest
from tests.command import printed
from tests.studies import contact, curve, finger, picture, rows_of, summary_of, write_study

CURVES = Path(__file__).parents[1] / "loading" / "data"
PRINTS = Path(__file__).resolve().parents[3] / "shared" / "data" / "nist_nbis_livescan_slaps"
KNOWN = {"thickness_mm": float("inf"), "stage_compliance_mm_per_N": 0}
# Radius of the sphere, mm, and E*, kPa, in records of soft matter (loading/data/README.md).
RECORDS = {"chiaro_gel.csv": (27.5, 0.1560), "afm_cell.csv": (5.0, 480.3)}


def test_real_curves_in_a_study_have_the_moduli_that_others_find(tmp_path: Path) -> None:
    for name in RECORDS:
        shutil.copy(CURVES / name, tmp_path)
    records = [
        curve(finger=name[:3], file=name, loading_radius_mm=radius, **KNOWN)
        for name, (radius, _) in RECORDS.items()
    ]
    study = write_study(tmp_path, *(finger(name[:3]) for name in RECORDS), *records)
    printed("run", study)
    curves = summary_of(tmp_path / "results")["curves"]
    for found, (name, (_, modulus)) in zip(curves, RECORDS.items(), strict=True):
        low, high = found["fit"]["reduced_modulus_kpa_ci95"]
        assert low < modulus < high or found["fit"]["reduced_modulus_kpa"] == pytest.approx(modulus, rel=0.03)
        assert name in (tmp_path / "results" / "report.html").read_text(encoding="utf-8")


@pytest.mark.skipif(not PRINTS.is_dir(), reason=f"real prints are not in {PRINTS}")
def test_real_prints_become_a_report(tmp_path: Path) -> None:
    names = ("left_index", "left_ring", "right_index")
    for name in names:
        shutil.copy(PRINTS / f"{name}_500ppi.png", tmp_path)
    prints = [picture(name, f"{name}_500ppi.png", 1, finger=name, scale={"ppi": 500}) for name in names]
    by_hand = contact("by_hand", 1, (10.0, 7.0), finger="left_index", axis="")
    study = write_study(tmp_path, *map(finger, names), *prints, by_hand)
    said = printed("run", study)
    rows = {row["observation"]: row for row in rows_of(tmp_path / "results" / "results.csv")}
    for name in names:
        # What one crude threshold finds of these three is 175 to 247 mm².
        assert 150 < float(rows[name]["gross_area_mm2"]) < 270
        assert 0 < float(rows[name]["gross_area_mm2_std"]) < 0.05 * float(rows[name]["gross_area_mm2"])
        assert f"{name}, 30°" in said
        assert list((tmp_path / "results" / "overlays").glob(f"{name}*"))
    report = (tmp_path / "results" / "report.html").read_text(encoding="utf-8")
    assert all(name in report for name in rows)
    printed("verify", tmp_path)
