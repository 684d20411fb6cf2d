"""Damaged studies: every route responds, with a message where it fails."""

import json
import random
import re
import shutil
from functools import cache

import pytest
from tests.damage import damaged
from tests.studies import Table, append_tables, correct, finger, write_sums
from tests.web.conftest import client_of, refused, serving

from fingerpad.exceptions import FingerpadError
from fingerpad.study.corrections.log import CORRECTIONS_NAME
from fingerpad.web.app import make_api
from fingerpad.web.workspace import Workspace

PATIENCE_S = 20
STUDY = "/api/studies/{study}"
PRINT, FRAME = "synthetic_30deg_2N", "synthetic_press_30deg#3"
PHOTOGRAPH = "synthetic_pad/synthetic/photograph_palmar.jpg"
ITEMS = "waiting", PRINT, PHOTOGRAPH, FRAME
# What to ask of routes that need to be asked something.
QUERIES = {
    f"{STUDY}/frames": ({"sequence": "synthetic_press_30deg"},),
    **{
        f"{STUDY}/picture/{kind}": tuple({"item": item, **more} for item in ITEMS)
        for kind, more in (("info", {}), ("preview", {"longest_px": 64}), ("thumbnail", {}))
    },
    f"{STUDY}/corrections": ({"item": PRINT}, {"item": FRAME}),
    f"{STUDY}/results/rows": ({}, {"sort": "load_N", "status": "measured"}, {"sort": "-reason", "text": "a"}),
    f"{STUDY}/results/plot": ({},),
    f"{STUDY}/download/{{path}}": ({"path": "results.csv"}, {"path": "study.zip"}, {"path": "figures/x.svg"}),
}
ENDLESS = "/api/studies/demo/events"
# They cost much, whatever the study says: asked of some studies only.
SLOW = {"/api/published", "/api/studies/demo/download/study.zip"}


@pytest.fixture
def folder(run_once, tmp_path):
    """A copy of the demo study after its run."""
    return shutil.copytree(run_once, tmp_path / "demo")


@pytest.fixture
def client(folder):
    with client_of(folder) as client:
        yield client


@cache
def routes():
    """Return the path and query of each question; to describe the API takes longer than to ask all."""
    found = []
    for path, operations in make_api().openapi()["paths"].items():
        if "get" in operations:
            for query in QUERIES.get(path, ({},)):
                rest = dict(query)
                found.append((path.format(study="demo", path=rest.pop("path", "")), rest))
    return found


def require_words(client, *, skip=SLOW, of=""):
    """Ask every GET route but some; what it refuses, it refuses in words and in time."""
    asked = [(path, query) for path, query in routes() if path != ENDLESS and path not in skip]
    for path, query in asked:
        answer = client.get(path, params=query, timeout=PATIENCE_S)
        assert 200 <= answer.status_code < 500, (of, path, query, answer.text)
        assert answer.status_code < 400 or answer.json()["error"], (of, path, query)
    assert len(asked) > 20


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


# Files of a study, and how often each is chosen.
TARGETS = {
    "study.toml": 15, "observations.csv": 3, CORRECTIONS_NAME: 3, "results/summary.json": 4,
    "results/results.csv": 4, "results/store.sqlite": 1,
}  # fmt: skip


@pytest.fixture
def incomplete(folder):
    """The study with corrections, and with tables that lack something."""
    for item, change in (
        (PRINT, {"threshold": 50.0}),
        (FRAME, {"rejected": "moved"}),
        (PHOTOGRAPH, {"accepted": True}),
    ):
        correct(folder, item, change)
    with (folder / "study.toml").open("a") as file:
        file.write('\n[scales.camera_2]\ncoin = "coin.png"\n')
    of_pad = {"finger": "synthetic_pad", "file": "synthetic/truth.csv"}
    append_tables(
        folder,
        finger("thumb", photographs=[{"file": "synthetic/photograph_palmar.jpg"}]),
        Table("observations", {"name": "waiting", **of_pad}),
        Table("sequences", {"name": "press", "file": "synthetic", "scale": {"coin": "coin.png"}}),
        Table("curves", of_pad),
    )
    return folder


def mutated(originals, seed):
    """Return the new contents of one to three files of a study, None for one that is gone."""
    rng, found = random.Random(seed), {}
    for name in rng.choices([*TARGETS], [*TARGETS.values()], k=rng.choice((1, 1, 2, 3))):
        before = found.get(name, originals[name])
        found[name] = None if before is None or rng.random() < 0.01 else damaged(before, rng)
    return found


def put(folder, contents):
    for name, content in contents.items():
        (folder / name).unlink(missing_ok=True)
        if content is not None:
            (folder / name).write_bytes(content)


@pytest.mark.parametrize("count", [4, pytest.param(50, marks=pytest.mark.nightly)])
def test_studies_mutated_at_random_are_answered(incomplete, count):
    """Every other study is opened before it is changed; one that cannot be opened is refused in words."""
    originals, refused = {name: (incomplete / name).read_bytes() for name in TARGETS}, 0
    for seed in range(count):
        contents, workspace = mutated(originals, seed), Workspace(incomplete.parent)
        if open_before := seed % 2 == 0:
            workspace.open_folder(incomplete)
        put(incomplete, contents)
        try:
            if not open_before:
                workspace.open_folder(incomplete)
            with serving(workspace) as client:
                require_words(client, skip=SLOW if seed else (), of=f"seed {seed}: {contents.keys()}")
        except FingerpadError:
            refused += 1
        put(incomplete, {name: originals[name] for name in contents})
    assert refused < count / 2
