"""The content of summary.json: every key described, nothing lost between writing and reading."""

import json
import shutil
from pathlib import Path

import pytest

import fingerpad as fp
from fingerpad.study.results.output import summary_of
from fingerpad.study.results.study_result import StudyResult
from fingerpad.study.results.summary_file import CurveFitRecord, SummaryFile, ThicknessFitRecord


def keys(content: object, place: str = "") -> set[str]:
    if isinstance(content, dict):
        return {place, *(key for name, one in content.items() for key in keys(one, f"{place}/{name}"))}
    return {key for one in content for key in keys(one, place)} if isinstance(content, list) else {place}


@pytest.fixture(scope="module")
def result(pinned_run, tmp_path_factory):
    out = tmp_path_factory.mktemp("summary") / "out"
    return fp.run_study(pinned_run, shutil.copytree(pinned_run.with_name("out"), out)), out


def test_every_key_says_what_it_is() -> None:
    schema = SummaryFile.model_json_schema(mode="serialization")
    for name, table in {"SummaryFile": schema, **schema["$defs"]}.items():
        for key, value in table["properties"].items():
            assert value.get("description"), f"{name}.{key}"


def test_what_is_read_is_what_was_written(result: tuple[StudyResult, Path]) -> None:
    found, out = result
    written = (out / "summary.json").read_text(encoding="utf-8")
    summary = fp.load_results(out).summary
    assert summary.text() == written == summary_of(found).text()
    (place,) = summary.summaries
    assert place.radius_from_indentation_mm == found.summaries[0].corrected_radius.value
    assert place.on_layer.highest_load.youngs_modulus_on_layer_kpa > 0


def test_nothing_that_a_fit_tells_is_left_out(result: tuple[StudyResult, Path]) -> None:
    (curve,) = result[0].curves
    assert set(curve.fit.as_record()) == set(CurveFitRecord.model_fields)
    assert set(curve.layer.as_record()) == set(ThicknessFitRecord.model_fields)


def test_a_summary_of_another_version_is_read_or_refused(
    result: tuple[StudyResult, Path], tmp_path: Path
) -> None:
    content = json.loads((result[1] / "summary.json").read_text(encoding="utf-8"))
    path = tmp_path / "summary.json"
    path.write_text(json.dumps({**content, "new": {"key": 1}}), encoding="utf-8")
    assert SummaryFile.read(tmp_path).title == "Pinned numbers"
    del content["summaries"][0]["validity"]
    path.write_text(json.dumps(content), encoding="utf-8")
    message = r"is not understood \(summaries.0.validity: Field required\); run the study again"
    with pytest.raises(fp.FingerpadError, match=message):
        SummaryFile.read(tmp_path)
