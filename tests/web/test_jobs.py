"""Runs of a study through the API: progress, cancellation, results and downloads."""

import io
import json
import re
import shutil
import sqlite3
import threading
from types import SimpleNamespace

import numpy as np
import pytest
from filelock import FileLock
from PIL import Image
from tests import command
from tests.studies import finger, picture, write_study
from tests.waiting import wait_until
from tests.web.conftest import DEMO, client_of, refused, serving

from fingerpad._files import sha256_of
from fingerpad.exceptions import ManifestError
from fingerpad.report import write_report
from fingerpad.study.engine.runner import Progress
from fingerpad.study.pipeline import run_study
from fingerpad.web import run_job
from fingerpad.web.events import Events
from fingerpad.web.workspace import Workspace

# A run says when it was made; all else must be the same.
MADE = re.compile(r"\d{4}-\d\d-\d\d(T\d\d:\d\d:\d\d(\+00:00|Z)| at \d\d:\d\d UTC)")


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """Return a study of a few observations that runs in seconds."""
    folder = tmp_path_factory.mktemp("small") / "demo"
    (folder / "synthetic").mkdir(parents=True)
    keys = {"finger": "pad", "scale": "reader", "synthetic": True}
    pictures = []
    for load in (1, 2, 4):
        name = f"synthetic/synthetic_30deg_{load}N.png"
        shutil.copy(DEMO / name, folder / "synthetic")
        pictures.append(picture(f"o{load}", name, float(load), **keys))
    stated = {"uncertainty": {"wedge_angle_deg_std": 0.5}, "scales": {"reader": {"ppi": 500}}}
    write_study(folder, finger("pad"), *pictures, title="Small", **stated)
    return folder


@pytest.fixture(scope="module")
def run_small(small, tmp_path_factory):
    """Return the same study with the results of a run, which no test may change."""
    folder = shutil.copytree(small, tmp_path_factory.mktemp("run-small") / "demo")
    run_study(folder / "study.toml", folder / "results", write_report=write_report)
    return folder


@pytest.fixture
def study(small, tmp_path):
    return shutil.copytree(small, tmp_path / "demo")


@pytest.fixture
def finished(run_small, tmp_path):
    """Return the folder of a study that was run."""
    return shutil.copytree(run_small, tmp_path / "demo")


@pytest.fixture
def client(study):
    with client_of(study) as client:
        yield client


@pytest.fixture
def finished_client(finished):
    with client_of(finished) as client:
        yield client


def run_of(client, **params):
    answer = client.study_post("run", **params)
    assert answer.status_code == 202, answer.text
    return ended(client)


def ended(client, timeout_s=120):
    assert wait_until(lambda: client.ask("run")["state"] not in {"running", "cancelling"}, timeout_s)
    return client.ask("run")


def test_the_page_writes_what_the_command_line_writes(client, study, tmp_path):
    live = client.tell("measure/contact", item="o2")
    run = run_of(client)
    assert (run["state"], run["done"], run["failed"], run["error"]) == ("done", 3, 0, None)
    other = tmp_path / "cli" / "demo"
    shutil.copytree(study, other, ignore=shutil.ignore_patterns("results"))
    assert command.run("run", other / "study.toml", "--out", other / "results")[0] == 0
    files = (path for path in (other / "results").rglob("*") if path.is_file())
    names = {path.relative_to(other / "results").as_posix() for path in files}
    names = {name for name in names if not name.startswith(("store.", "SHA256SUMS"))}
    assert {"report.html", "results.csv", "summary.json"} < names
    assert any(name.startswith("figures/") for name in names)
    for name in sorted(names):
        ours, theirs = ((folder / "results" / name).read_bytes() for folder in (study, other))
        if name in {"report.html", "summary.json"}:
            ours, theirs = (MADE.sub("", text.decode()) for text in (ours, theirs))
        assert ours == theirs, name
        if "overlays" not in name:
            assert client.study_get(f"download/{name}").content == (study / "results" / name).read_bytes()
    # And what the page showed before the run.
    row = client.ask("results/rows", text="o2")["rows"][0]
    shown = live["numbers"] | live["model"]["numbers"]
    keys = ("semi_major_mm", "semi_minor_mm", "gross_area_mm2", "ridge_period_mm", "u_deg")
    for key in (*keys, "radius_from_indentation_mm", "youngs_modulus_kpa"):
        assert shown[key]["value"] == pytest.approx(row[key]["value"])
        assert shown[key]["std"] == (row[key]["std"] and pytest.approx(row[key]["std"]))


def test_results_of_another_picture_are_not_up_to_date(finished_client, finished):
    picture = finished / "synthetic" / "synthetic_30deg_2N.png"
    before = picture.read_bytes()
    picture.write_bytes((finished / "synthetic" / "synthetic_30deg_4N.png").read_bytes())
    state = finished_client.ask("state")
    assert (state["counts"]["stale"], state["counts"]["done"], state["results"]["fresh"]) == (1, 2, False)
    picture.write_bytes(before)
    assert finished_client.ask("state")["results"]["fresh"]
    with sqlite3.connect(finished / "results" / "store.sqlite") as store:
        store.execute("DELETE FROM result WHERE task = 'o2'")
    state = finished_client.ask("state")
    assert (state["counts"]["left"], state["results"]["fresh"]) == (1, False)


def test_the_time_left_is_that_of_the_pictures_left(monkeypatch):
    """Ten of fifty were there, and ten more took 20 s: the last thirty take 60 s."""
    now = [100.0]
    monkeypatch.setattr(run_job, "time", SimpleNamespace(monotonic=lambda: now[0]))
    job = run_job.RunJob(Events())
    job._started = now[0]
    job._progress(Progress(pictures=10, failed=0, total=50))
    assert job.describe().seconds_left is None
    now[0] += 20.0
    job._progress(Progress(item="a", status="done", pictures=20, failed=1, total=50))
    assert job.describe().seconds_left == pytest.approx(60)


def test_a_study_with_issues_opens_and_lists_each_but_does_not_run(client, study):
    client.edit(
        {"kind": "observation", "key": "half", "set": {"file": "synthetic/synthetic_30deg_1N.png"}},
        {"kind": "scale", "key": "camera", "set": {"mm_per_px": 7}},
    )
    assert 'name = "half"' in (study / "study.toml").read_text()
    opened = client.ask("state")
    assert [one["item"] for one in opened["observations"] if not one["complete"]] == ["half"]
    words = [one["words"] for one in opened["missing"]]
    answer = client.study_post("run")
    assert refused(answer)
    assert [one["words"] for one in answer.json()["faults"]] == words
    assert {"the load is missing", "the wedge angle is missing", "which finger it is is missing"} <= {*words}
    with pytest.raises(ManifestError) as error:
        run_study(study, study / "results")
    lines = str(error.value).splitlines()
    assert len(lines) == len(words)
    assert lines[0] == "study.toml: scales.camera.mm_per_px: expected less than or equal to 1, found 7"
    assert not (study / "results").exists()


def test_what_is_complete_is_run_without_the_rest(client, study):
    half = {"file": "synthetic/synthetic_30deg_1N.png", "finger": "f", "wedge_angle_deg": 30}
    client.edit({"kind": "observation", "key": "half", "set": half})
    assert run_of(client, incomplete=True)["state"] == "done"
    assert "half" not in {row["observation"] for row in rows(client, limit=2000)["rows"]}
    assert "left out, as it is not complete" in (study / "results" / "report.html").read_text()


def test_one_run_at_a_time_with_events(client):
    heard = []

    def listen():
        with client.stream("GET", "/api/studies/demo/events") as answer:
            assert answer.headers["content-type"].startswith("text/event-stream")
            for line in answer.iter_lines():
                heard.append(line)
                if '"state": "done"' in line:
                    return

    listener = threading.Thread(target=listen)
    listener.start()
    assert wait_until(lambda: heard)
    assert client.study_post("run").status_code == 202
    assert client.study_post("run").status_code == 409
    assert ended(client)["state"] == "done"
    listener.join(20)
    assert not listener.is_alive()
    runs = [json.loads(line.removeprefix("data: ")) for line in heard if line.startswith('data: {"state"')]
    assert (runs[0]["state"], runs[-1]["state"]) == ("running", "done")
    versions = [run["version"] for run in runs]
    assert versions[-1] == max(versions) == client.ask("run")["version"]
    assert {run["phase"] for run in runs} >= {"measuring", "tables", "report"}


def test_a_cancelled_run_keeps_its_measurements_and_resumes(study):
    manifest = study / "study.toml"
    head, *observations = manifest.read_text().split("[[observations]]")
    more = [one.replace('name = "o', f'name = "again_{n}_') for n in range(4) for one in observations]
    manifest.write_text("[[observations]]".join([head, *observations, *more]))
    with client_of(study) as client:
        client.study_post("run")
        assert wait_until(lambda: client.ask("run")["done"])
        assert client.study_post("run/cancel").status_code == 202
        run = ended(client)
        assert (run["state"], run["error"]) == ("cancelled", None)
        assert 0 < run["done"] < run["total"]
        counts = client.ask("state")["counts"]
        assert counts["done"] > 0
        assert counts["left"] > 0
        again = run_of(client)
        assert (again["state"], again["done"]) == ("done", again["total"])


def test_a_run_can_be_stopped_while_its_report_is_drawn(finished):
    for path in (finished / "results").iterdir():
        if path.name != "store.sqlite":
            shutil.rmtree(path) if path.is_dir() else path.unlink()
    with client_of(finished) as client:
        client.study_post("run", workers=2)
        assert wait_until(lambda: (run := client.ask("run"))["phase"] == "report" and run["current"], 120)
        client.study_post("run/cancel")
        assert ended(client)["state"] == "cancelled"
        results = client.ask("state")["results"]
        assert (results["there"], results["report"], results["fresh"]) == (False, False, False)
        assert client.study_get("download/report.html").status_code == 404
        assert run_of(client)["state"] == "done"
        results = client.ask("state")["results"]
        assert (results["report"], results["fresh"]) == (True, True)


def test_the_page_responds_during_a_run_and_closing_the_workspace_stops_it(study):
    workspace = Workspace(study.parent)
    workspace.open_folder(study)
    with serving(workspace) as client:
        client.study_post("run")
        assert client.ask("run")["state"] == "running"
        job = workspace.session("demo").run_job
        workspace.close()
        assert job.describe().state in {"cancelled", "done"}


def test_a_store_locked_by_another_run_is_reported(client, study):
    (study / "results").mkdir()
    with FileLock(study / "results/store.lock"):
        run = run_of(client)
    assert run["state"] == "failed"
    assert "another run" in run["error"]


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_a_bug_in_a_run_is_reported(client, monkeypatch):
    def broken(*_, **__):
        raise KeyError("palmar")

    monkeypatch.setattr(run_job, "write_report", broken)
    run = run_of(client)
    assert run["state"] == "failed"
    assert run["error"] == "the run ended with a fault (KeyError: 'palmar')"


def value(cell):
    """Return what a cell of the results holds, of a quantity its number."""
    return cell["value"] if isinstance(cell, dict) else cell


def rows(client, **params):
    answer = client.study_get("results/rows", **params)
    assert answer.status_code == 200, answer.text
    return answer.json()


def test_rows_are_filtered_sorted_and_paged(done):
    every = rows(done, limit=2000)
    assert every["total"] == every["matching"] == len(every["rows"])
    first = rows(done, sort="load_N", limit=5)["rows"]
    assert rows(done, sort="load_N", offset=2, limit=3)["rows"] == first[2:]
    only = rows(done, finger="synthetic_pad", wedge_angle_deg=45)
    assert only["rows"]
    for row in only["rows"]:
        assert (row["finger"], row["wedge_angle_deg"]["value"]) == ("synthetic_pad", 45.0)
    assert rows(done, text="TABLE3")["matching"] == 4
    assert rows(done, sequence="synthetic_press_30deg")["matching"] > 10
    columns = {one["key"]: one for one in every["columns"]}
    assert "radius_from_indentation_mm_total_std" not in columns
    named = ("mm_per_px", "youngs_modulus_kpa", "aspect_ratio")
    labels = [columns[name]["label"] for name in named]
    assert labels == ["Scale, mm/px", "E, kPa", "ℓ_d/ℓ_e"]
    assert done.study_get("results/rows", sort="nothing").status_code == 422


@pytest.mark.parametrize("key", ["orientation_deg", "sequence", "time_s"])
@pytest.mark.parametrize("falling", [False, True])
def test_rows_without_the_value_come_last_whichever_way_they_are_sorted(done, key, falling):
    values = [value(row[key]) for row in rows(done, sort=f"{'-' * falling}{key}", limit=2000)["rows"]]
    known = [value for value in values if value is not None]
    assert 0 < len(known) < len(values)
    assert values == sorted(known, reverse=falling) + [None] * (len(values) - len(known))


def test_the_budget_adds_up(done):
    for group in done.ask("results/budget"):
        assert sum(group["check"]["shares"].values()) == pytest.approx(1, abs=0.02)
        assert sum(group["pooled"].values()) == pytest.approx(1)


def test_figures_are_listed_with_captions_and_can_be_fetched(done):
    listed = done.ask("results/figures")
    assert listed
    for figure in listed:
        assert figure["caption"] != figure["name"]
        answer = done.get(figure["svg"]).raise_for_status()
        assert answer.headers["content-type"].startswith("image/svg+xml")
        assert done.study_get("results/figure", name=figure["name"]).status_code == 200


def test_figures_are_drawn_for_publication(done):
    names = [figure["name"] for figure in done.ask("results/figures")]
    name = next(name for name in names if name.endswith("corrected_radius"))
    details = done.ask("results/figure", name=name)
    assert details["width_mm"] == 85
    axes = {"x": "normal load W (N)", "y": "corrected radius (mm)"}
    assert details["axes"] == axes

    def file(kind, **settings):
        return done.study_get("results/figure/file", name=name, kind=kind, **settings)

    picture = file("png", width_mm=90, dpi=100, colours="#000000", x_low=0.1, x_scale="log", attachment=True)
    assert picture.headers["content-disposition"] == f'attachment; filename="{name}.png"'
    with Image.open(io.BytesIO(picture.content)) as image:
        assert image.width == round(90 / 25.4 * 100)
    words = "width_mm: a figure is 20 to 500 mm wide and high, found 2000"
    assert refused(file("svg", width_mm=2000)) == words
    assert done.study_get("results/figure", name="../results").status_code == 404
    saved = done.study_get("download/results.csv", attachment=True)
    assert saved.headers["content-disposition"] == 'attachment; filename="results.csv"'


def test_pages_of_fingers_stand_beside_the_report(finished_client, finished):
    page = finished / "results" / "report" / "left_index.html"
    page.parent.mkdir(parents=True)
    page.write_text("<!doctype html>")
    assert finished_client.study_get("download/report/left_index.html").status_code == 404
    with (finished / "results" / "SHA256SUMS").open("a") as sums:
        sums.write(f"{sha256_of(page)}  report/left_index.html\n")
    answer = finished_client.study_get("download/report/left_index.html")
    assert answer.text == "<!doctype html>"
    assert "default-src 'none'" in answer.headers["content-security-policy"]


def test_signal_of_a_sequence_agrees_with_its_frames(done):
    signal = done.ask("signal", sequence="synthetic_press_30deg")
    frames = done.ask("frames", sequence="synthetic_press_30deg")["frames"]
    assert {"none", "measured"} == {frame["status"] for frame in frames}
    timed = [(frame["frame"], frame["time_s"]) for frame in frames if frame["time_s"] is not None]
    assert signal["start_s"] == pytest.approx(timed[0][1] - timed[0][0] / 20)
    assert max(signal["load_N"]) == pytest.approx(2, rel=0.02)
    best = np.argmin([one if one is not None else np.inf for one in signal["area_scatter"]])
    assert signal["shift_s"][best] == pytest.approx(0, abs=0.01)


def test_a_file_that_was_changed_or_lost_after_the_run_is_named(finished_client, finished):
    report = finished / "results" / "report.html"
    assert finished_client.study_get("download/report.html").status_code == 200
    assert finished_client.ask("state")["results"]["faults"] == []
    report.write_text(report.read_text() + "<p>other</p>")
    words = "report.html: is not the file that the last run wrote: run the study"
    assert refused(finished_client.study_get("download/report.html"), 409).startswith(words)
    (finished / "results" / "summary.json").unlink()
    faults = finished_client.ask("state")["results"]["faults"]
    assert faults[1:] == ["summary.json: is missing or cannot be read"]


def test_results_without_a_row_can_be_searched(study):
    manifest = study / "study.toml"
    manifest.write_text(manifest.read_text().partition("[[observations]]")[0])
    run_study(manifest, study / "results")
    with client_of(study) as client:
        for query in ({"text": "a"}, {"flag": "low_contrast"}):
            assert rows(client, **query)["rows"] == []
