"""An edit parses what it looks at, and writes what it would write had it parsed the whole manifest."""

import os

import pytest
import tomlkit

from fingerpad.exceptions import FingerpadError
from fingerpad.study.editing import edit
from fingerpad.study.editing.edit import Edit, change_study, folded, unfolded
from fingerpad.study.manifest.load import STUDY_NAME, load_study

HEAD = """\
# Whose study this is.
title = "Ours"
notes_of_ours = "[[observations]]"

[scales.reader]
ppi = 500        # on the box
[scales."camera"]
mm_per_px = 0.1
"""
FINGERS = """
[[fingers]]  # the first
name = "left"
semi_axes_mm = { palmar = 7.9, distal = 13.8, radial_ulnar = 11.8 }

  [[fingers]]
  name = "right"
  [[fingers.photographs]]
  face = "palmar"
  file = "a.png"
  scale = "camera"
  [[fingers.photographs]]
  face = "distal"
  file = "b.png"
  scale = "reader"
[[fingers]]
name = "middle"
photographs = [
  { face = "palmar", file = "a.png", scale = "camera" },
]
# The end of the fingers.
"""
CURVES = """
[[curves]]
finger = "left"
wedge_angle_deg = 30
loading_radius_mm = 9
[[curves]]
finger = "right"
wedge_angle_deg = 45
loading_radius_mm = 8
"""


def observation(name, more=""):
    return f"""
[[observations]]
name = "{name}"
finger = "left"
wedge_angle_deg = 30
load_N = 2.0     # from the balance
file = "a.png"
scale = "reader"
{more}"""


ALIKE = "".join(observation(f"p{number}") for number in range(5))
HEADERS_IN_TEXT = observation("p0", 'notes = """\n[[observations]]\nname = "p1"\n"""\n')
LISTS_OF_LISTS = observation("p1", "region_of_interest_px = [\n[0],\n[1]\n]\n")
SUBTABLES = "".join(observation(f"p{k}", "[observations.ellipse_mm]\nsemi_major = 7\n") for k in range(3))
MANIFESTS = {
    "no_last_line_break": (HEAD + FINGERS + CURVES + ALIKE).rstrip(),
    "headers_in_text": HEAD + FINGERS + HEADERS_IN_TEXT + observation("p1") + observation("p2") + CURVES,
    "lists_of_lists": HEAD + FINGERS + observation("p0") + LISTS_OF_LISTS + observation("p2") + CURVES,
    "subtables": HEAD + SUBTABLES + FINGERS + CURVES,
    "mixed": HEAD + observation("p0") + FINGERS + observation("p1") + observation("p2") + CURVES,
    "odd_headers": HEAD + FINGERS + ALIKE.replace("[[o", '[["o').replace("ns]]", 'ns"]]'),
    "no_names": HEAD + FINGERS + ALIKE.replace('"p1"', "1").replace('"p2"', '["p2"]') + CURVES,
    "empty_tables": HEAD + "[[observations]]\n[[observations]]\n[[fingers]]\n" + ALIKE,
    "marked": HEAD + "# left out: 0\n" + FINGERS + ALIKE,
    "empty": "",
}
# Of manifests that differ only in what stands elsewhere, these tell all.
TELLING = [("change",), ("rename", "add"), ("change_finger", "remove", "change_curve")]
EDITS = {
    "change": Edit(kind="observation", key="p1", set={"load_N": 3, "notes": "a\n# left out: 0\n"}),
    "add": Edit(kind="observation", key="new", set={"load_N": 3}),
    "remove": Edit(kind="observation", key="p2", set=None),
    "rename": Edit(kind="observation", key="p0", set={"name": "p9"}),
    "change_finger": Edit(kind="finger", key="right", set={"sex": "f"}),
    "remove_finger": Edit(kind="finger", key="middle", set=None),
    "add_photograph": Edit(kind="photograph", key="right/c.png", set={"face": "radial"}),
    "add_inline_photograph": Edit(kind="photograph", key="middle/c.png", set={"face": "radial"}),
    "remove_photograph": Edit(kind="photograph", key="right/b.png", set=None),
    "rename_scale": Edit(kind="scale", key="reader", set={"name": "box"}),
    "title": Edit(kind="study", key="", set={"title": "Others"}),
    "change_curve": Edit(kind="curve", key="1", set={"loading_radius_mm": 7}),
}


def after(folder, edits):
    """Return what the manifest says after some edits, or what is said of them."""
    try:
        change_study(folder, edits, expected=load_study(folder / STUDY_NAME).digest)
    except FingerpadError as error:
        return str(error)
    return (folder / STUDY_NAME).read_bytes()


@pytest.mark.parametrize("manifest", MANIFESTS)
def test_an_edit_writes_what_it_would_write_had_all_been_parsed(tmp_path, monkeypatch, manifest):
    monkeypatch.setattr(edit, "_require_as_complete", lambda *_: None)  # any text will do
    monkeypatch.setattr(os, "fsync", lambda _: None)
    for edits in [*((one,) for one in EDITS if manifest == "mixed"), *TELLING]:
        found = []
        for names in (edit.tables_of, lambda _: None):
            (tmp_path / STUDY_NAME).write_text(MANIFESTS[manifest])
            with monkeypatch.context() as patch:
                patch.setattr(edit, "tables_of", names)
                found.append(after(tmp_path, [EDITS[name] for name in edits]))
        assert found[0] == found[1], edits


@pytest.mark.parametrize("manifest", MANIFESTS.values(), ids=MANIFESTS)
@pytest.mark.parametrize("kept", [(), ("p1",), ("left", "p0")])
def test_what_is_left_out_is_put_back(manifest, kept):
    text, left_out = folded(manifest, kept)
    assert unfolded(tomlkit.dumps(tomlkit.parse(text)), left_out) == tomlkit.dumps(tomlkit.parse(manifest))


def test_an_edit_of_a_large_manifest_parses_little_of_it(tmp_path, monkeypatch):
    text = HEAD + FINGERS + "".join(observation(f"p{number}") for number in range(200)) + CURVES
    (tmp_path / STUDY_NAME).write_text(text)
    (tmp_path / "a.png").touch()
    parse, parsed = tomlkit.parse, []

    def counted(some):
        parsed.append(some.count("[[observations]]\n"))
        return parse(some)

    monkeypatch.setattr(tomlkit, "parse", counted)
    edits = [EDITS["change"], EDITS["add"]]
    change_study(tmp_path, edits, expected=load_study(tmp_path / STUDY_NAME).digest)
    assert (tmp_path / STUDY_NAME).read_text().count("[[observations]]\n") == 201
    assert sum(parsed) <= 5
