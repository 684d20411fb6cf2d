"""Numbers that each measurement version stands for.

A change that alters one of them must raise its version in `fingerpad.study.engine.task`, so that stored
results are measured again. Record the new numbers with ``python -m tests.study.test_versions``.
"""

import json
import shutil
import tempfile
from pathlib import Path

import pytest
from tests.studies import summary_of
from tests.study.pinned_study import OBSERVATIONS, make_pinned

import fingerpad as fp
from fingerpad.study.engine import task as versions
from fingerpad.study.pipeline import run_study
from fingerpad.study.results import output
from fingerpad.study.results.summary_file import CurveFitRecord, SummaryFile, ThicknessFitRecord
from fingerpad.study.status import study_status

PINNED = Path(__file__).with_name("measured_numbers.json")
FRAMES = ("press#8", "press#12", "press#16")
# Where in summary.json the numbers of each kind of measurement stand.
PLACES = {"image": ("fingers",), "loading": ("curves",), "uncertainty": ("summaries",)}
IMAGE_COLUMNS = (
    "semi_major_mm", "semi_minor_mm", "edge_offset_mm_std", "gross_area_mm2",
    "gross_area_mm2_noise_std", "ridge_area_mm2", "ridge_area_mm2_std", "ridge_period_mm",
)  # fmt: skip


def numbers(value: object, place: str = "") -> dict[str, float]:
    if isinstance(value, dict):
        return {k: v for key, one in value.items() for k, v in numbers(one, f"{place}/{key}").items()}
    if isinstance(value, list):
        return {k: v for index, one in enumerate(value) for k, v in numbers(one, f"{place}/{index}").items()}
    return {place: value} if isinstance(value, float) else {}


def measured(out: Path) -> dict[str, dict[str, float]]:
    """Return the numbers of a run by the version that they stand for."""
    summary = summary_of(out)
    rows = {row["observation"]: row for row in json.loads((out / "results.json").read_text(encoding="utf-8"))}
    found = {kind: numbers({key: summary[key] for key in keys}) for kind, keys in PLACES.items()}
    found["image"] |= numbers(
        {one: {name: rows[one][name] for name in IMAGE_COLUMNS} for one in (*OBSERVATIONS, *FRAMES)},
        "/results",
    )
    return found


@pytest.mark.parametrize("kind", versions.MEASUREMENT_VERSIONS)
def test_a_version_stands_for_its_numbers(pinned_run, kind):
    pinned = json.loads(PINNED.read_text(encoding="utf-8"))
    version = versions.MEASUREMENT_VERSIONS[kind]
    assert pinned[kind]["version"] == version, "record the numbers of the new version"
    found = measured(pinned_run.with_name("out"))[kind]
    assert found == pytest.approx(pinned[kind]["numbers"], rel=1e-5, abs=1e-9), (
        f"raise the version of {kind!r}, and record its numbers"
    )


@pytest.mark.parametrize("kind", ["image", "loading"])
def test_a_new_version_measures_again(pinned_run, monkeypatch, kind):
    assert study_status(pinned_run, pinned_run.with_name("out")).stale == 0
    changed = versions.MEASUREMENT_VERSIONS | {kind: -1}
    monkeypatch.setattr(versions, "MEASUREMENT_VERSIONS", changed)
    assert study_status(pinned_run, pinned_run.with_name("out")).stale > 0


@pytest.mark.parametrize(("library", "stale"), [("opencv", 8), ("imagecodecs", 0)])
def test_another_release_of_a_library_measures_again_but_not_of_lossless_decoders(
    pinned_run, monkeypatch, library, stale
):
    found = versions.library_versions()
    assert library in found  # the record of a run names it
    monkeypatch.setattr(versions, "library_versions", lambda: found | {library: "another"})
    assert study_status(pinned_run, pinned_run.with_name("out")).stale == stale


# The content of summary.json: every key described, nothing lost between writing and reading


@pytest.fixture(scope="module")
def read(pinned_run, tmp_path_factory):
    out = tmp_path_factory.mktemp("summary") / "out"
    return fp.run_study(pinned_run, shutil.copytree(pinned_run.with_name("out"), out)), out


def test_every_key_says_what_it_is():
    schema = SummaryFile.model_json_schema(mode="serialization")
    for name, table in {"SummaryFile": schema, **schema["$defs"]}.items():
        for key, value in table["properties"].items():
            assert value.get("description"), f"{name}.{key}"


def test_what_is_read_is_what_was_written(read):
    found, out = read
    written = (out / "summary.json").read_text(encoding="utf-8")
    summary = fp.load_results(out).summary
    assert summary.text() == written == output.summary_of(found).text()
    (place,) = summary.summaries
    assert place.radius_from_indentation_mm == found.summaries[0].corrected_radius.value
    assert place.on_layer.highest_load.youngs_modulus_on_layer_kpa > 0


def test_nothing_that_a_fit_tells_is_left_out(read):
    (curve,) = read[0].curves
    assert set(curve.fit.as_record()) == set(CurveFitRecord.model_fields)
    assert set(curve.layer.as_record()) == set(ThicknessFitRecord.model_fields)


def test_a_summary_of_another_version_is_read_or_refused(read, tmp_path):
    content = json.loads((read[1] / "summary.json").read_text(encoding="utf-8"))
    path = tmp_path / "summary.json"
    path.write_text(json.dumps({**content, "new": {"key": 1}}), encoding="utf-8")
    assert SummaryFile.read(tmp_path).title == "Pinned numbers"
    del content["summaries"][0]["validity"]
    path.write_text(json.dumps(content), encoding="utf-8")
    message = r"is not understood \(summaries.0.validity: Field required\); run the study again"
    with pytest.raises(fp.FingerpadError, match=message):
        SummaryFile.read(tmp_path)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as scratch:
        run_study(make_pinned(Path(scratch)), Path(scratch) / "out", all_columns=True)
        found = measured(Path(scratch) / "out")
    record = {
        kind: {"version": versions.MEASUREMENT_VERSIONS[kind], "numbers": found[kind]} for kind in found
    }
    PINNED.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
