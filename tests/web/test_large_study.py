"""A study of thousands of images opens without decoding any of them."""

import pytest
from tests.web.conftest import serving

from fingerpad.web.workspace import Workspace

COUNT = 2000
HEAD = """title = "Large"
[scales.small]
ppi = 100
[[fingers]]
name = "a"
semi_axes_mm = { palmar = 7.9, distal = 13.8, radial_ulnar = 11.8 }
semi_axes_mm_std = { palmar = 0.1, distal = 0.1, radial_ulnar = 0.1 }
"""
CONTACT = """[[observations]]
name = "f{number}"
finger = "a"
wedge_angle_deg = 30
load_N = 2
file = "frames/{number}.png"
scale = "small"
"""


@pytest.fixture(scope="module")
def large(tmp_path_factory):
    """Return a client of a study of 2,000 files, none of which can be decoded."""
    studies_folder = tmp_path_factory.mktemp("large")
    (studies_folder / "large" / "frames").mkdir(parents=True)
    for number in range(COUNT):
        (studies_folder / "large" / "frames" / f"{number}.png").write_bytes(b"no picture")
    text = HEAD + "".join(CONTACT.format(number=number) for number in range(COUNT))
    (studies_folder / "large" / "study.toml").write_text(text)
    with serving(Workspace(studies_folder)) as client:
        yield client


def test_a_study_of_two_thousand_pictures_opens_without_reading_them(large):
    assert large.post("/api/session/open", json={"name": "large"}).status_code == 200
    state = large.get("/api/studies/large/state")
    found = state.json()
    assert len(found["observations"]) == found["counts"]["left"] == COUNT
    assert found["missing"] == []
    assert len(state.content) < 1_500_000
