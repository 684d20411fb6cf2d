"""A server on a copy of the demo study, and a client."""

import shutil
import threading
from contextlib import contextmanager
from pathlib import Path

import httpx
import pytest
import uvicorn
from tests.once import made_once

from fingerpad.report import write_report
from fingerpad.study.pipeline import run_study
from fingerpad.web.app import listening, make_app
from fingerpad.web.security import Access
from fingerpad.web.workspace import Workspace

DEMO = Path(__file__).parents[2] / "examples" / "dzidek2017"
TOKEN = "a-token-of-the-tests"


def shorten(folder):
    """Leave out of the demo study what takes long and shows the page nothing new."""
    manifest = folder / "study.toml"
    head, *curves = manifest.read_text().split("[[curves]]")
    manifest.write_text("[[curves]]".join([head, *(curve for curve in curves if "file =" not in curve)]))
    sheet = folder / "observations.csv"
    rows = sheet.read_text().splitlines(keepends=True)
    sheet.write_text("".join(row for row in rows if "_0." not in row and "_4N" not in row))


class Client(httpx.Client):
    """A client with short words for one study; `ask` and `tell` return what an answer holds."""

    study = "demo"

    def study_get(self, path, **params):
        return self.get(f"/api/studies/{self.study}/{path}", params=params)

    def study_post(self, path, **body):
        return self.post(f"/api/studies/{self.study}/{path}", json=body)

    def ask(self, path, **params):
        return self.study_get(path, **params).json()

    def tell(self, path, **body):
        return self.study_post(path, **body).json()

    def edit(self, *edits):
        """Edit the study, and return its new state."""
        digest = self.ask("state")["digest"]
        return self.study_post("edits", expected=digest, edits=edits).raise_for_status().json()


def refused(answer, status=422):
    """Return what an answer says that refuses with this status."""
    assert answer.status_code == status, answer.text
    return answer.json()["error"]


@contextmanager
def serving(workspace, access=None, port=0):
    """Serve a workspace on a local port, and yield a client with its token."""
    listener = listening(port)
    server = uvicorn.Server(
        uvicorn.Config(
            make_app(workspace, access or Access(TOKEN)), log_level="warning", timeout_graceful_shutdown=1
        )
    )
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]})
    thread.start()
    base = f"http://127.0.0.1:{listener.getsockname()[1]}"
    headers = {"authorization": f"Bearer {TOKEN}"}
    try:
        with Client(base_url=base, headers=headers, timeout=60, trust_env=False, verify=False) as client:
            yield client
    finally:
        server.should_exit = True
        thread.join(20)
        listener.close()
        workspace.close()


@pytest.fixture
def studies_folder(tmp_path):
    shutil.copytree(DEMO, tmp_path / "demo")
    return tmp_path


@contextmanager
def client_of(folder, **limits):
    """Serve the folder around a study, with the study open."""
    workspace = Workspace(folder.parent, **limits)
    workspace.open_folder(folder)
    with serving(workspace) as client:
        client.study = folder.name
        yield client


@pytest.fixture
def client(studies_folder):
    with client_of(studies_folder / "demo") as client:
        yield client


@pytest.fixture(scope="session")
def standing(tmp_path_factory):
    """Return a client on the demo study before a run; tests must not change it."""
    folder = tmp_path_factory.mktemp("standing") / "demo"
    with client_of(shutil.copytree(DEMO, folder)) as client:
        yield client


@pytest.fixture(scope="session")
def run_once(run_demo, session_folder):
    """Run the short demo study, from what is stored, once for all processes; tests only read its results."""

    def make(folder):
        study = shutil.copytree(run_demo, folder / "demo")
        shorten(study)
        run_study(study / "study.toml", study / "results", write_report=write_report)

    return made_once(session_folder / "run-short", make) / "demo"


@pytest.fixture(scope="session")
def done(run_once):
    """Return a client on the demo study after its run; tests must not change it."""
    with client_of(run_once) as client:
        yield client
