"""Smooth contacts in a study: said once for all, or for one observation or sequence."""

import pytest
from tests.smooth_study import LOADS, area_at, make_smooth_study

from fingerpad.study.manifest.load import load_study
from fingerpad.study.pipeline import run_study
from fingerpad.study.results.table import records
from fingerpad.study.status import study_status


@pytest.fixture(scope="module")
def smooth(tmp_path_factory):
    manifest = make_smooth_study(tmp_path_factory.mktemp("smooth"))
    return manifest, run_study(manifest, manifest.parent / "out")


def test_the_first_frame_is_the_background_of_a_sequence_of_smooth_contacts(smooth):
    rows = {row["observation"]: row for row in records(smooth[1].rows) if row["observation"] != "contact"}
    assert set(rows) == {f"press#{frame}" for frame, load in enumerate(LOADS) if load}
    for name, row in rows.items():
        truth = area_at(LOADS[int(name.removeprefix("press#"))])
        assert abs(row["gross_area_mm2"] - truth) < 2.5 * row["gross_area_mm2_std"]
        assert row["ridge_area_mm2"] is None
    assert any(row["pooled"] for row in rows.values())


def test_the_surface_of_a_study_holds_for_its_pictures(smooth):
    (row,) = (row for row in records(smooth[1].rows) if row["observation"] == "contact")
    assert row["gross_area_mm2"] == pytest.approx(area_at(2.0), rel=0.015)


def test_a_table_overrides_the_surface_of_the_study(tmp_path):
    manifest = make_smooth_study(tmp_path / "a")
    text = manifest.read_text()
    manifest.write_text(text.replace('name = "contact"', 'name = "contact"\nsurface = "ridged"'))
    study = load_study(manifest).complete()
    assert (study.observations[0].surface, study.sequences[0].surface) == ("ridged", "smooth")


def test_another_surface_of_the_study_measures_again(smooth):
    manifest, _ = smooth
    assert study_status(manifest, manifest.parent / "out").stale == 0
    text = manifest.read_text()
    manifest.write_text(text.replace('surface = "smooth"', ""))
    try:
        assert study_status(manifest, manifest.parent / "out").stale > 0
    finally:
        manifest.write_text(text)


def test_an_unknown_surface_is_an_issue(tmp_path):
    loaded = load_study(make_smooth_study(tmp_path / "a", "rough"))
    assert any("surface" in issue and "smooth" in issue for issue in loaded.issues)


def test_a_threshold_of_a_smooth_contact_is_refused_in_words(tmp_path):
    manifest = make_smooth_study(tmp_path / "a")
    text = manifest.read_text()
    manifest.write_text(text.replace('name = "contact"', 'name = "contact"\nthreshold = 20'))
    result = run_study(manifest, manifest.parent / "out")
    (row,) = (row for row in records(result.rows) if row["observation"] == "contact")
    assert "threshold tells ridges from valleys" in row["reason"]
