"""What `fingerpad.testing` writes is read back with its truth."""

from pathlib import Path

import pytest
from PIL import Image

import fingerpad as fp
from fingerpad.testing import write_contact_image, write_loading_curve, write_study


def test_a_small_study_runs_and_finds_its_truth(tmp_path: Path) -> None:
    study = write_study(tmp_path / "study")
    table = fp.run_study(study.path, tmp_path / "out").rows
    assert (table["status"] == "measured").all()
    assert (table["long_axis"] == table["predicted_long_axis"]).all()
    for _, row in table.iterrows():
        true = study.truth[f"{row['observation']}.gross_area_mm2"]
        assert row["gross_area_mm2"] == pytest.approx(true, abs=3 * row["gross_area_mm2_std"])
        modulus = study.truth["youngs_modulus_kpa"]
        assert row["youngs_modulus_kpa"] == pytest.approx(modulus, abs=3 * row["youngs_modulus_kpa_std"])


def test_a_curve_gives_its_truth(tmp_path: Path) -> None:
    curve = write_loading_curve(tmp_path / "curve.csv", loading_radius=12.0)
    fit = fp.fit_loading_curve(fp.read_loading_curve(curve.path))
    assert fit.loading_radius.value == pytest.approx(12.0, abs=4 * fit.loading_radius.std)


def test_an_image_says_that_it_is_synthetic(tmp_path: Path) -> None:
    image = write_contact_image(tmp_path / "contact.png", semi_major=4.0, semi_minor=3.5)
    assert "synthetic" in Image.open(image.path).text["Description"]
    assert image.truth["gross_area_mm2"] == pytest.approx(43.98, abs=0.01)
