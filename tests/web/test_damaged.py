"""Damaged studies: every route responds, with a message where it fails."""

import json
import re
import shutil

import pytest
from benchmarks.robustness.damaged_studies import SLOW, add_corrections, ask_mutated, routes
from tests.studies import write_sums
from tests.web.conftest import client_of, refused


@pytest.fixture
def folder(run_once, tmp_path):
    """A copy of the demo study after its run."""
    return shutil.copytree(run_once, tmp_path / "demo")


@pytest.fixture
def client(folder):
    with client_of(folder) as client:
        yield client


def require_words(client):
    """Ask every GET route; what it refuses, it refuses in words."""
    for path, query in routes():
        if path != "/api/studies/demo/events" and path not in SLOW:
            answer = client.get(path, params=query)
            assert answer.status_code < 500, (path, query, answer.text)
            assert answer.status_code < 400 or answer.json()["error"]


DAMAGED = [
    ("summary.json", r'"curves":', '"no_curves":', "summary.json: is not understood (curves: Field required"),
    ("summary.json", r'"covariance_mm2": \[\s+\[', '"covariance_mm2": [[1.0], [', "fingers.0.covariance_mm2"),
    ("results.csv", ",30.0,2.0,", ",30.0,x,", "load_N holds what is no float"),
    ("results.csv", r"(?s)\A.*", "\x00", "results.csv: "),
    ("summary.json", r"(?s)\A.*", "[" * 100_000, "summary.json: "),
]


@pytest.mark.parametrize(("name", "was", "instead", "words"), DAMAGED)
def test_damaged_results_are_told_and_every_route_answers(client, folder, name, was, instead, words):
    path = folder / "results" / name
    text, count = re.subn(was, instead, path.read_text(), count=1)
    assert count == 1
    path.write_text(text)
    write_sums(folder / "results")
    found = client.ask("state")["results"]
    assert not found["there"]
    (fault,) = found["faults"]
    assert words in fault
    way_out = "run the study again: nothing that was measured is measured again"
    assert refused(client.study_get("results/rows"), 409) == f"{fault}: {way_out}"
    require_words(client)


def test_an_odd_correction_is_reported_and_every_route_answers(client, folder):
    record = {"id": 1, "item": "a", "when": "", "who": "", "action": ["change"], "change": {}, "picture": ""}
    (folder / "corrections.jsonl").write_text(json.dumps(record) + "\n")
    assert "line 1 is no correction" in client.ask("state")["error"]
    require_words(client)


def test_a_study_that_cannot_be_opened_leaves_the_current_one_open(client, folder):
    shutil.copytree(folder, folder.parent / "other", ignore=shutil.ignore_patterns("results"))
    (folder.parent / "other" / "corrections.jsonl").write_text("{}\n")
    answer = client.post("/api/session/open", json={"name": "other"})
    assert "corrections.jsonl: line 1" in refused(answer)
    assert client.ask("state")["name"] == "demo"


@pytest.mark.parametrize("count", [4, pytest.param(50, marks=pytest.mark.nightly)])
def test_studies_mutated_at_random_are_answered(folder, count):
    add_corrections(folder)
    answers = ask_mutated(folder, count)
    assert answers.faults == []
    assert sum(answers.counts.values()) > 20 * count
