"""A study of thousands of images opens without decoding any of them."""

import pytest
from tests.studies import finger, picture, write_study
from tests.web.conftest import serving

from fingerpad.web.workspace import Workspace

COUNT = 2000


@pytest.fixture(scope="module")
def large(tmp_path_factory):
    """Return a client of a study of 2,000 files, none of which can be decoded."""
    studies_folder = tmp_path_factory.mktemp("large")
    (studies_folder / "large" / "frames").mkdir(parents=True)
    for number in range(COUNT):
        (studies_folder / "large" / "frames" / f"{number}.png").write_bytes(b"no picture")
    frames = (picture(f"f{number}", f"frames/{number}.png", scale="small") for number in range(COUNT))
    write_study(studies_folder / "large", finger(), *frames, scales={"small": {"ppi": 100}})
    with serving(Workspace(studies_folder)) as client:
        yield client


def test_a_study_of_two_thousand_pictures_opens_without_reading_them(large):
    assert large.post("/api/session/open", json={"name": "large"}).status_code == 200
    state = large.get("/api/studies/large/state")
    found = state.json()
    assert len(found["observations"]) == found["counts"]["left"] == COUNT
    assert found["missing"] == []
    assert len(state.content) < 1_500_000
