"""What `fingerpad init` writes: a manifest with its schema, and an example that runs."""

import json
import re
import shutil
from pathlib import Path

import numpy as np

from fingerpad.study.editing.template import SCHEMA_NAME, manifest_schema, write_template
from fingerpad.study.manifest.models import Study
from fingerpad.study.pipeline import run_study
from fingerpad.study.results.table import records


def test_the_example_runs_and_its_truth_is_covered(run_example: Path, tmp_path: Path) -> None:
    folder = Path(shutil.copytree(run_example, tmp_path / "example"))
    result = run_study(folder / "study.toml", folder / "results")
    assert result.failures == []
    assert all(row["synthetic"] for row in records(result.rows))
    (finger,) = result.fingers.values()
    stds = np.sqrt(np.diag(finger.covariance))
    assert np.abs((finger.semi_axes - (7.9, 13.8, 11.8)) / stds).max() < 3


def test_the_manifest_names_its_schema(tmp_path: Path) -> None:
    manifest = write_template(tmp_path / "new")
    assert manifest.read_text(encoding="utf-8").startswith(f"#:schema ./{SCHEMA_NAME}\n")
    schema = json.loads(manifest.with_name(SCHEMA_NAME).read_text(encoding="utf-8"))
    assert set(schema["properties"]) == set(Study.model_fields)


def test_every_key_of_the_schema_has_a_description() -> None:
    schema = json.loads(manifest_schema())
    for table in (schema, *schema["$defs"].values()):
        assert all("description" in value for value in table["properties"].values()), table["title"]


def test_the_template_counts_the_ways_to_say_a_scale(tmp_path: Path) -> None:
    template = write_template(tmp_path / "new").read_text(encoding="utf-8")
    numbers = ("one", "two", "three", "four", "five", "six", "seven", "eight")
    (said,) = re.findall(r"There are (\w+) ways to say one", template)
    assert numbers.index(said) + 1 == len(re.findall(r"^# \[scales\.", template, re.M))
