"""Export and import of a study as a ZIP by the page."""

import os
import socket

from tests.study.test_archive import ODD_FILES, contents, write
from tests.web.conftest import client_of

from fingerpad.study.manifest.load import load_study


def test_the_bundle_lists_files_left_out_and_is_imported(tmp_path):
    folder = tmp_path / "study"
    write(folder, ODD_FILES, {"empty: folder"}, dict.fromkeys(ODD_FILES, "used"))
    (folder / os.fsdecode(b"\xff.png")).write_bytes(b"no text")
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(str(folder / "socket"))
        with client_of(folder) as client:
            reported = client.get("/api/studies/study/bundle").json()
            left = {one["file"]: one["why"] for one in reported["left_out"]}
            assert {".data/", "socket", "a:b.png", "empty: folder/"} <= set(left)
            assert "=1+1" not in left
            assert len({"a.png", "A.png"} & set(left)) == 1
            archive = client.get("/api/studies/study/download/study.zip")
            assert archive.status_code == 200
            back = client.post("/api/session/import", params={"name": "back"}, content=archive.content)
            assert back.status_code == 201, back.text
            assert back.json()["digest"] == load_study(folder / "study.toml").digest
    (folder / "socket").unlink()
    (folder / os.fsdecode(b"\xff.png")).unlink()  # no text, and left out
    kept = {name: one for name, one in contents(folder).items() if not {name, f"{name}/"} & set(left)}
    assert contents(tmp_path / "back") == kept
    assert reported["files"] == sum(content is not None for content in kept.values())
