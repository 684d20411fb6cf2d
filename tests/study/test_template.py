"""What `fingerpad init` writes: a manifest with its schema, and an example that runs."""

import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from fingerpad.exceptions import ManifestError
from fingerpad.study.editing.template import SCHEMA_NAME, manifest_schema, write_example, write_template
from fingerpad.study.manifest.load import read_study
from fingerpad.study.manifest.models import Study
from fingerpad.study.pipeline import run_study
from fingerpad.study.results.table import records


def test_the_example_runs_and_its_truth_is_covered(run_example, tmp_path):
    folder = Path(shutil.copytree(run_example, tmp_path / "example"))
    result = run_study(folder / "study.toml", folder / "results")
    assert result.failures == []
    assert all(row["synthetic"] for row in records(result.rows))
    (finger,) = result.fingers.values()
    stds = np.sqrt(np.diag(finger.covariance))
    assert np.abs((finger.semi_axes - (7.9, 13.8, 11.8)) / stds).max() < 3


def test_the_template_overwrites_nothing(tmp_path):
    (tmp_path / "study.toml").write_text("title = 'mine'")
    with pytest.raises(ManifestError, match=r"study\.toml: is there already"):
        write_template(tmp_path)
    with pytest.raises(ManifestError, match="the folder is not empty"):
        write_example(tmp_path)
    assert (tmp_path / "study.toml").read_text() == "title = 'mine'"
    assert [path.name for path in tmp_path.iterdir()] == ["study.toml"]


def test_every_commented_line_of_the_template_is_valid_too(tmp_path):
    path = write_template(tmp_path / "new")
    lines = path.read_text(encoding="utf-8").splitlines()
    opened = [
        line[2:] if re.match(r"# (\[|\]|    \{|(?!observations_csv)\w+ = )", line) else line for line in lines
    ]
    path.write_text("\n".join(opened), encoding="utf-8")
    for name in re.findall(r'"([a-z]+/[\w.]+)"', path.read_text(encoding="utf-8")):
        (path.parent / name).parent.mkdir(exist_ok=True)
        (path.parent / name).touch()
    study = read_study(path)
    assert (len(study.fingers), len(study.observations), len(study.curves)) == (3, 2, 2)
    assert study.observations[1].seed_px == [250, 200]
    assert list(study.scales) == ["reader", "camera", "ruler", "coin", "rim", "board"]
    assert study.sequences[0].contact_load_N == 0.02


def test_the_manifest_names_its_schema(tmp_path):
    manifest = write_template(tmp_path / "new")
    assert manifest.read_text(encoding="utf-8").startswith(f"#:schema ./{SCHEMA_NAME}\n")
    schema = json.loads(manifest.with_name(SCHEMA_NAME).read_text(encoding="utf-8"))
    assert set(schema["properties"]) == set(Study.model_fields)


def test_every_key_of_the_schema_has_a_description():
    schema = json.loads(manifest_schema())
    for table in (schema, *schema["$defs"].values()):
        assert all("description" in value for value in table["properties"].values()), table["title"]
