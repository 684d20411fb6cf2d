"""New files over the API: what each may be, spreadsheets and patterns of names."""

import pytest
from tests.study.test_file_tables import SHARED, SHEET
from tests.test_tables import mat
from tests.web.conftest import refused
from tests.web.test_files import png, upload
from tests.workbooks import workbook


def test_identity_of_a_file(client) -> None:
    record = upload(client, "IMG_1.csv", b"time_s, force_N,displacement_mm\n0,0,0\n").json()
    assert record["columns"] == ["time_s", "force_N", "displacement_mm"]
    found = client.ask("files/identity", file="uploads/IMG_1.csv")
    assert (found["uses"][0], found["sure"], found["scales"]) == ("curve", True, {})
    record = upload(client, "IMG_2.mat", mat(time_s=[0, 1], force_N=[0, 2])).json()
    assert (record["kind"], record["columns"]) == ("table", ["time_s", "force_N"])
    found = client.ask("files/identity", file=record["file"])
    assert (found["uses"][0], found["sure"]) == ("force", True)
    found = client.ask("files/identity", file="synthetic/photograph_radial.jpg")
    assert (found["uses"][0], found["face"], found["face_sure"]) == ("photograph", "radial", True)
    assert client.study_get("files/identity", file="../../etc/passwd").status_code == 404


def test_a_workbook_is_kept_and_joined(client) -> None:
    record = upload(client, "details.xlsx", workbook(SHEET, SHARED)).json()
    assert (record["kind"], record["columns"]) == ("table", ["File", "Load N", "", "theta (deg)"])
    listed = {file["file"]: file for file in client.ask("state")["files"]}
    assert listed["uploads/details.xlsx"]["used"] is False
    files = ["uploads/IMG_1.png", "uploads/IMG_2.png"]
    asked = {"file": record["file"], "files": [{"file": file} for file in files]}
    joined = client.study_post("files/table", **asked).raise_for_status().json()
    assert [one["file"] for one in joined["files"]] == files[:1]
    assert joined["files"][0]["values"]["load_N"] == 0.1
    assert joined["files_without_row"] == files[1:]


@pytest.mark.parametrize(
    ("path", "body", "words"),
    [
        ("table", {"text": "a,b\n1,2", "files": []}, "no column names the files"),
        ("table", {"files": []}, "give a file or a text"),
        ("pattern", {"pattern": "{mood}", "files": []}, "is unknown"),
    ],
)
def test_refusals_say_why(client, path: str, body: dict, words: str) -> None:
    assert words in refused(client.study_post(f"files/{path}", **body))


def test_edits_are_proposed_and_can_be_made(client) -> None:
    file = upload(client, "LI_30deg_0,5N.png", png()).json()["file"]
    state = client.ask("state")
    reading = next(one["reading"] for one in state["files"] if one["file"] == file)
    assert (reading["finger"], reading["load_N"]) == ("left_index", 0.5)
    scale = client.ask("files/scale", words="500")["scale"]
    asked = {"files": [reading | {"scale": scale}, {"file": "uploads/a.png", "use": "curve"}]}
    found = client.study_post("files/edits", **asked).raise_for_status().json()
    assert (found["added"], found["waiting"]) == (1, ["uploads/a.png"])
    contact = next(one for one in client.edit(*found["edits"])["observations"] if one["file"] == file)
    assert (contact["scale"], contact["scale_words"]) == ({"ppi": 500}, "500 ppi")
