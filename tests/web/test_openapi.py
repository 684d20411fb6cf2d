"""The API fuzzed from its OpenAPI document: no request causes a server error."""

import os
import shutil
from functools import cache

import pytest
import schemathesis
from hypothesis import HealthCheck, Phase, given, settings
from PIL import Image
from schemathesis import GenerationMode
from tests.web.conftest import DEMO, serving, shorten

from fingerpad.web.app import make_api
from fingerpad.web.workspace import Workspace

# They change the open study, start a run, or do not end.
STUDY = "/api/studies/{study}"
STATEFUL = ("/api/session/", f"{STUDY}/run", f"{STUDY}/events")
PARTS = 8  # of the operations, so that several processes can test
# The nightly profile draws more, and others each time.
EXAMPLES = 100 if os.environ.get("HYPOTHESIS_PROFILE") == "nightly" else 2
PATIENCE_S = 120  # test machines may be slow
PHOTO = "synthetic_pad/synthetic/photograph_palmar.jpg"


@cache
def operations():
    """Return the operations of the OpenAPI document: those whose requests are independent, and the others."""
    found = [one.ok() for one in schemathesis.openapi.from_dict(make_api().openapi()).get_all_operations()]
    apart = [one for one in found if not one.path.startswith(STATEFUL)]
    return apart, [one for one in found if one not in apart]


def make_workspace(tmp_path_factory):
    studies_folder = tmp_path_factory.mktemp("fuzzed")
    shutil.copytree(DEMO, studies_folder / "demo")
    shorten(studies_folder / "demo")
    # Smaller pictures are answered sooner.
    for path in (studies_folder / "demo" / "synthetic").glob("*.[jp][pn]g"):
        with Image.open(path) as picture:
            picture.reduce(4).save(path)
    workspace = Workspace(studies_folder, upload_limit=1_000_000)
    workspace.open_folder(studies_folder / "demo")
    return workspace


@pytest.fixture(scope="module")
def fuzzed(tmp_path_factory):
    with serving(make_workspace(tmp_path_factory)) as client:
        yield client


def use_known_names(case):
    """Use names that exist, which fuzzing does not find, and few workers."""
    kind = "photograph" if "photograph" in case.path else "contact"
    known = {
        "item": {"contact": "synthetic_30deg_2N", "photograph": PHOTO}[kind],
        "sequence": "synthetic_press_30deg",
        "finger": "left_index_ellipse",
        "scale": "reader",
        "workers": 2,
        "study": "demo",
    }
    for stated in (case.body, case.query, case.path_parameters):
        if isinstance(stated, dict):
            stated |= {key: value for key, value in known.items() if key in stated}


def fuzz(client, operation, mode):
    """Send requests that the document allows, or that it does not."""
    headers = {"authorization": client.headers["authorization"]}

    @settings(
        max_examples=EXAMPLES,
        deadline=None,
        database=None,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @given(case=operation.as_strategy(mode))
    def ask(case):
        if mode is GenerationMode.POSITIVE:
            use_known_names(case)
        answer = case.call(base_url=str(client.base_url).rstrip("/"), headers=headers, timeout=PATIENCE_S)
        assert answer.status_code < 500, f"{case.as_curl_command()}\n{answer.text}"
        if answer.status_code >= 400:
            assert answer.json()["error"]

    ask()


@pytest.mark.parametrize("mode", list(GenerationMode), ids=lambda mode: mode.value)
@pytest.mark.parametrize("part", range(PARTS))
def test_no_request_causes_a_server_error(fuzzed, part, mode):
    for operation in operations()[0][part::PARTS]:
        fuzz(fuzzed, operation, mode)


@pytest.mark.parametrize("mode", list(GenerationMode), ids=lambda mode: mode.value)
def test_no_order_of_opening_running_and_closing_causes_a_server_error(tmp_path_factory, mode):
    with serving(make_workspace(tmp_path_factory)) as client:
        for operation in operations()[1]:
            if operation.path != f"{STUDY}/events":
                fuzz(client, operation, mode)
        assert client.get("/api/session").status_code == 200


def test_every_answer_in_json_has_a_model():
    document = make_api().openapi()
    for path, methods in document["paths"].items():
        for method, described in methods.items():
            success = next(answer for status, answer in described["responses"].items() if status != "4XX")
            if (content := success.get("content", {}).get("application/json")) is not None:
                of = content["schema"].get("items", content["schema"])
                name = of["$ref"].rpartition("/")[2]
                assert document["components"]["schemas"][name]["properties"], (method, path)
