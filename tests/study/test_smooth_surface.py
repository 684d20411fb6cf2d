"""Smooth contacts in a study: said once for all, or for one observation or sequence."""

import pytest
from tests.smooth_study import LOADS, area_at, make_smooth_study
from tests.studies import rows_by

from fingerpad.exceptions import ManifestError
from fingerpad.study.manifest.load import read_study
from fingerpad.study.pipeline import run_study
from fingerpad.study.status import study_status


@pytest.fixture(scope="module")
def smooth(tmp_path_factory):
    manifest = make_smooth_study(tmp_path_factory.mktemp("smooth"))
    return manifest, run_study(manifest, manifest.parent / "out")


def test_the_first_frame_is_the_background_of_a_sequence_of_smooth_contacts(smooth):
    rows = rows_by(smooth[1])
    assert rows.pop("contact")["gross_area_mm2"] == pytest.approx(area_at(2.0), rel=0.015)
    assert set(rows) == {f"press#{frame}" for frame, load in enumerate(LOADS) if load}
    for name, row in rows.items():
        truth = area_at(LOADS[int(name.removeprefix("press#"))])
        assert abs(row["gross_area_mm2"] - truth) < 2.5 * row["gross_area_mm2_std"]
        assert row["ridge_area_mm2"] is None
    assert any(row["pooled"] for row in rows.values())


def change(manifest, old, new):
    manifest.write_text(manifest.read_text().replace(old, new))


def test_a_table_overrides_the_surface_of_the_study_and_a_threshold_is_refused_in_words(tmp_path):
    manifest = make_smooth_study(tmp_path / "a")
    change(manifest, 'name = "contact"', 'name = "contact"\nsurface = "ridged"')
    study = read_study(manifest)
    assert (study.observations[0].surface, study.sequences[0].surface) == ("ridged", "smooth")
    change(manifest, 'surface = "ridged"', "threshold = 20")
    rows = rows_by(run_study(manifest, manifest.parent / "out"))
    assert "threshold tells ridges from valleys" in rows["contact"]["reason"]
    change(manifest, 'surface = "smooth"', 'surface = "rough"')
    with pytest.raises(ManifestError, match=r"surface.*smooth"):
        read_study(manifest)


def test_another_surface_of_the_study_measures_again(smooth):
    manifest, _ = smooth
    assert study_status(manifest, manifest.parent / "out").stale == 0
    change(manifest, 'surface = "smooth"', "")
    assert study_status(manifest, manifest.parent / "out").stale > 0
