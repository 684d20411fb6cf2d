"""Uploads, imports and downloads, and a study as a ZIP and back."""

import errno
import io
import os
import socket
import stat
import struct
import zipfile
import zlib

import cv2
import numpy as np
import pytest
import tifffile
from tests.study.test_archive import ODD_FILES, contents, write
from tests.study.test_edit import failing_with
from tests.web.conftest import client_of, refused, serving
from tests.workbooks import zipped

from fingerpad.study.manifest.load import load_study
from fingerpad.web.workspace import Workspace


def png(rows=40, columns=60, level=128):
    return cv2.imencode(".png", np.full((rows, columns), level, np.uint8))[1].tobytes()


def huge_png(rows, columns):
    """Return a PNG whose header promises far more pixels than it holds."""

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", columns, rows, 8, 0, 0, 0, 0)
    parts = (chunk(b"IHDR", header), chunk(b"IDAT", zlib.compress(b"\0" * 1000)), chunk(b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(parts)


def upload(client, name, content, **query):
    return client.post(f"/api/studies/{client.study}/files", params={"name": name, **query}, content=content)


def remove(client, name):
    return client.delete("/api/studies/demo/files", params={"file": name})


def test_an_uploaded_image_is_stored_and_described(client, studies_folder):
    answer = upload(client, "a1.png", png())
    assert answer.status_code == 201, answer.text
    described = {"file": "uploads/a1.png", "kind": "picture", "rows_px": 40, "columns_px": 60}
    assert described.items() <= answer.json().items()
    assert (studies_folder / "demo/uploads/a1.png").read_bytes() == png()
    listed = {file["file"]: file for file in client.ask("state")["files"]}
    assert listed["uploads/a1.png"]["used"] is False
    assert listed["synthetic/synthetic_30deg_2N.png"]["used"] is True


def test_the_same_file_is_kept_once_and_another_never_replaces_it(client, studies_folder):
    assert upload(client, "a.png", png()).status_code == 201
    again = upload(client, "a.png", png())
    assert (again.status_code, again.json()["file"]) == (200, "uploads/a.png")
    other = upload(client, "a.png", png(level=3))
    assert (other.status_code, other.json()["file"]) == (201, "uploads/a-2.png")
    assert (studies_folder / "demo/uploads/a.png").read_bytes() == png()
    assert not list((studies_folder / "demo/uploads").glob(".upload*"))


@pytest.mark.parametrize(
    ("name", "kept"),
    [
        ("../../../etc/x.png", "x.png"),
        ("C:\\temp\\x.png", "x.png"),
        ("a\0b.png", "a-b.png"),
        ("Größe.png", "Größe.png"),
        ("x" * 400 + ".png", "x" * 120 + ".png"),
        ("-rf.png", "rf.png"),
        ("con.png:stream.png", "con-png-stream.png"),
    ],
)
def test_names_of_files_never_become_paths(client, studies_folder, name, kept):
    before = set(studies_folder.rglob("*"))
    assert upload(client, name, png()).json()["file"] == f"uploads/{kept}"
    new = set(studies_folder.rglob("*")) - before
    assert new == {studies_folder / "demo/uploads", studies_folder / "demo/uploads" / kept}


@pytest.mark.parametrize(
    ("name", "content", "status"),
    [
        ("x.exe", b"MZ", 415),
        ("study.toml", b"title = 'x'", 415),
        ("x.png", b"", 400),
        ("x.png", b"no picture at all", 422),
        ("x.tif", b"II*\0nonsense", 422),
        ("x.png", huge_png(60_000, 60_000), 422),
    ],
)
def test_unusable_files_are_refused_and_removed(client, studies_folder, name, content, status):
    answer = upload(client, name, content)
    assert refused(answer, status)
    assert status != 415 or name not in answer.text  # the page puts it before what is said
    assert str(studies_folder) not in answer.text
    folder = studies_folder / "demo/uploads"
    assert not folder.exists() or not list(folder.iterdir())


@pytest.mark.parametrize("folder", ["..", "a/b"])
def test_a_sequence_collects_its_frames_in_a_plainly_named_folder(client, folder):
    assert upload(client, "1.png", png(), folder=folder).status_code == 400
    kept = upload(client, "1.png", png(), folder="press1").json()
    assert kept["file"] == "uploads/press1/1.png"


def test_a_file_beyond_the_limit_is_cut_off_whether_it_says_its_size_or_not(studies_folder):
    with client_of(studies_folder / "demo", upload_limit=100_000) as client:
        for content in (b"x" * 100_001, (b"x" * 1000 for _ in range(200))):
            assert upload(client, "a.png", content).status_code == 413
        assert client.get("/api/session").status_code == 200
    assert not list((studies_folder / "demo/uploads").iterdir())


@pytest.mark.parametrize(
    ("shape", "described"),
    [((5, 20, 30), {"kind": "sequence", "frames": 5}), ((20, 30), {"kind": "picture", "rows_px": 20})],
)
def test_sequences_and_images_are_distinguished(client, shape, described):
    file = io.BytesIO()
    tifffile.imwrite(file, np.zeros(shape, np.uint16), photometric="minisblack")
    assert described.items() <= upload(client, "press.tif", file.getvalue()).json().items()


def test_only_unused_uploads_are_removed(client, studies_folder):
    file = upload(client, "a.png", png()).json()["file"]
    for name, status in (
        ("synthetic/synthetic_30deg_2N.png", 409),
        ("synthetic/truth.csv", 409),
        ("../demo/study.toml", 404),
        ("study.toml", 404),
        (file, 200),
    ):
        assert remove(client, name).status_code == status, name
    assert not (studies_folder / "demo" / file).exists()


def test_a_removed_file_is_restored(client, studies_folder):
    folder = studies_folder / "demo/uploads"
    restore = lambda number: client.study_post("files/restore", removed=number)  # noqa: E731
    removed = []
    for level in (1, 2, 3):  # of one name each time
        assert upload(client, "a.png", png(level=level)).json()["file"] == "uploads/a.png"
        removed.append(remove(client, "uploads/a.png").json()["removed"])
        assert "uploads/a.png" not in {file["file"] for file in client.ask("state")["files"]}
    assert not (folder / "a.png").exists()
    folder.rmdir()  # as of a sequence whose frames are all removed
    names = [restore(number).json()["file"] for number in removed]
    assert names == ["uploads/a.png", "uploads/a-2.png", "uploads/a-3.png"]
    for level, name in enumerate(names, 1):
        assert (studies_folder / "demo" / name).read_bytes() == png(level=level)
    assert restore(removed[0]).status_code == 404
    assert not [path for path in (studies_folder / "demo/.removed").rglob("*") if path.is_file()]


def test_files_are_kept_and_restored_where_there_are_no_hard_links(client, studies_folder, monkeypatch):
    monkeypatch.setattr(os, "link", failing_with(errno.EPERM))
    names = [upload(client, "a.png", png(level=level)).json()["file"] for level in (1, 2, 1)]
    assert names == ["uploads/a.png", "uploads/a-2.png", "uploads/a.png"]
    removed = remove(client, "uploads/a.png").json()["removed"]
    assert upload(client, "a.png", png(level=3)).json()["file"] == "uploads/a.png"
    restored = client.tell("files/restore", removed=removed)["file"]
    assert restored not in {"uploads/a.png", "uploads/a-2.png"}
    for name, level in (("uploads/a.png", 3), ("uploads/a-2.png", 2), (restored, 1)):
        assert (studies_folder / "demo" / name).read_bytes() == png(level=level)


def test_an_upload_that_cannot_be_placed_leaves_nothing_behind(client, studies_folder, monkeypatch):
    monkeypatch.setattr("fingerpad.web.api.files.placed", failing_with(errno.ENOSPC))
    assert upload(client, "a.png", png()).status_code >= 400
    assert not list((studies_folder / "demo" / "uploads").iterdir())


def test_a_file_in_use_is_not_removed_by_another_name(client, studies_folder):
    for file in ("a", "linked", "draft"):
        upload(client, f"{file}.png", png(level=len(file)))
    (studies_folder / "demo/link.png").symlink_to("uploads/linked.png")
    files = ("uploads/a.png", "link.png", "uploads/draft.png")
    client.edit(
        *({"kind": "observation", "key": f"x{k}", "set": {"file": file}} for k, file in enumerate(files))
    )
    for name in ("uploads/./a.png", "uploads/linked.png", "uploads/draft.png"):
        assert remove(client, name).status_code == 409, name


@pytest.mark.parametrize("number", ["..", "20240101T000000-00000000", "x"])
def test_nothing_else_is_restored(client, studies_folder, number):
    (studies_folder / "demo/.removed").mkdir()
    (studies_folder / "demo/.removed/x").write_bytes(b"x")
    answer = client.study_post("files/restore", removed=number)
    assert answer.status_code in {400, 404}
    assert (studies_folder / "demo/.removed/x").exists()


STUDY = (
    'title = "t"\n[[fingers]]\nname = "a"\nsemi_axes_mm = { palmar = 8, distal = 14, radial_ulnar = 12 }\n'
    "semi_axes_mm_std = { palmar = 0.1, distal = 0.1, radial_ulnar = 0.1 }\n"
)


def with_study(**files):
    return zipped({"study.toml": STUDY, **files})


def bring(client, content, name="copy"):
    return client.post("/api/session/import", params={"name": name}, content=content)


def symlink():
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        archive.writestr("study.toml", STUDY)
        link = zipfile.ZipInfo("link.png")
        link.external_attr = (stat.S_IFLNK | 0o777) << 16
        archive.writestr(link, "/etc/passwd")
    return buffer.getvalue()


def lying():
    """Return a ZIP whose entry is larger than its directory says."""
    said = struct.pack("<I", 5_000_000)
    return with_study(**{"x.bin": bytes(5_000_000)}).replace(said, struct.pack("<I", 10))


BAD_ZIPS = {
    "traversal": lambda: with_study(**{"../evil.png": b"x"}),
    "absolute": lambda: with_study(**{"/tmp/evil.png": b"x"}),
    "backslash": lambda: with_study(**{"..\\evil.png": b"x"}),
    "bomb": lambda: with_study(**{"bomb.png": bytes(50_000_000)}),
    "symlink": symlink,
    "lying": lying,
    "no study": lambda: zipped({"readme.txt": "x"}),
    "no zip": lambda: b"PK\x03\x04 not really",
    "cut": lambda: with_study(**{"x.png": png()})[:-30],
}


@pytest.mark.parametrize("kind", BAD_ZIPS)
def test_a_harmful_or_broken_zip_unpacks_nothing(client, studies_folder, kind):
    before = set(studies_folder.parent.rglob("*"))
    answer = bring(client, BAD_ZIPS[kind]())
    assert answer.status_code in {400, 422}, answer.text
    assert answer.json()["error"]
    assert set(studies_folder.parent.rglob("*")) == before
    assert client.get("/api/session").json()["study"]["name"] == "demo"


def test_a_zip_of_many_small_files_is_limited_by_what_they_come_to(studies_folder):
    content = with_study(**{f"{k}.bin": bytes(900_000) for k in range(3)})
    with serving(Workspace(studies_folder, import_limit=800_000)) as client:
        assert bring(client, content).status_code == 422
    assert not (studies_folder / "copy").exists()


def test_a_zip_takes_no_others_place(client):
    assert bring(client, with_study(), "demo").status_code == 409
    assert bring(client, with_study(), "new").status_code == 201
    assert bring(client, zipped({"top/study.toml": STUDY}), "second").json()["title"] == "t"


def test_the_bundle_lists_files_left_out_and_is_imported(tmp_path):
    folder = tmp_path / "study"
    write(folder, ODD_FILES, {"empty: folder"}, dict.fromkeys(ODD_FILES, "used"))
    (folder / os.fsdecode(b"\xff.png")).write_bytes(b"no text")
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(str(folder / "socket"))
        with client_of(folder) as client:
            reported = client.ask("bundle")
            left = {one["file"]: one["why"] for one in reported["left_out"]}
            assert {".data/", "socket", "a:b.png", "empty: folder/"} <= set(left)
            assert "=1+1" not in left
            assert len({"a.png", "A.png"} & set(left)) == 1
            archive = client.study_get("download/study.zip")
            assert archive.status_code == 200
            back = client.post("/api/session/import", params={"name": "back"}, content=archive.content)
            assert back.status_code == 201, back.text
            assert back.json()["digest"] == load_study(folder / "study.toml").digest
    (folder / "socket").unlink()
    (folder / os.fsdecode(b"\xff.png")).unlink()  # no text, and left out
    kept = {name: one for name, one in contents(folder).items() if not {name, f"{name}/"} & set(left)}
    assert contents(tmp_path / "back") == kept
    assert reported["files"] == sum(content is not None for content in kept.values())
