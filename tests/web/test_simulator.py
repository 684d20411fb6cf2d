"""A finger of the last run for robot simulators."""

import io
import zipfile
from dataclasses import replace

import pytest
from tests.web.conftest import refused

import fingerpad as fp
from fingerpad.study.results.load import measured_pad
from fingerpad.web.api import simulator

pytestmark = pytest.mark.usefixtures("coarse_elements")
PATH = "/api/studies/demo/results/simulator"


@pytest.fixture(scope="module")
def place(done):
    group = done.ask("results/budget")[0]
    return {"finger": group["finger"], "wedge_angle_deg": group["wedge_angle_deg"]["value"]}


def test_numbers_and_files_of_a_finger(done, place):
    found = done.get(PATH, params=place | {"thickness_mm": 8.0}).json()
    assert "8 mm of tissue" in found["source"]
    names = [target["name"] for target in found["targets"]]
    assert names[1:4] == ["Newton kh", "Drake hydroelastic modulus", "MuJoCo solref"]
    assert "Finite elements" in names[-1]
    assert all(0 <= target["worst_relative_error"] < 1 for target in found["targets"])
    assert found["targets"][3]["area_factor"] is None
    answer = done.get(f"{PATH}/file", params=place | {"thickness_mm": 8.0})
    assert "_simulator.zip" in answer.headers["content-disposition"]
    archive = zipfile.ZipFile(io.BytesIO(answer.content))
    assert {"finger.xml", "finger.sdf", "finger.inp", "README.md"} <= set(archive.namelist())
    assert place["finger"] in archive.read("README.md").decode()


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"mass_kg": 1e-9}, "MuJoCo would need time steps below"),
        ({"finger": "thumb"}, "found no finger 'thumb'"),
    ],
)
def test_what_cannot_be_is_refused(done, place, given, words):
    assert words in refused(done.get(PATH, params=place | given))


def test_tissue_too_thin_for_finite_elements_has_all_other_numbers(done, place, monkeypatch):
    thin = fp.Tissue(0.05, thickness=0.5)
    monkeypatch.setattr(
        simulator, "measured_pad", lambda *at, **by: replace(measured_pad(*at, **by), tissue=thin, stds={})
    )
    asked = place | {"thickness_mm": 8.0, "highest_load_N": 1.0}
    found = done.get(PATH, params=asked).json()
    assert len(found["targets"]) == 5, found
    assert found["notes"][-1].startswith("No finite elements: thickness must be finite and at least")
    assert done.get(f"{PATH}/file", params=asked).status_code == 200
