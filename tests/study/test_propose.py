"""Proposals for new files: what their names, their content, spreadsheets and written scales make of them."""

import numpy as np
import pytest
from PIL import Image
from tests.image.ruler_scenes import KINDS, ruler_scene

from fingerpad.exceptions import ManifestError
from fingerpad.simulate import render_contact_image
from fingerpad.study.imports.identify import Guess, GuessedScale
from fingerpad.study.manifest.load import LoadedStudy, load_study
from fingerpad.study.manifest.models import Study
from fingerpad.study.new_files import (
    NewFile,
    named_file,
    proposed_edits,
    start_study,
    stated_values,
    with_guess,
    with_scales,
    written_scale,
)


def empty(tmp_path, *, tables=()):
    return LoadedStudy(folder=tmp_path, digests={}, study=Study(title="s"), tables=tables, issues=())


@pytest.mark.parametrize(
    ("file", "kind", "known"),
    [
        ("IMG_0031.jpg", "picture", {"use": "observation"}),
        ("S01_right_thumb_w45_500mN.tif", "picture", {"person": "S01", "finger": "S01_right_thumb"}),
        ("left_index_palmar.jpg", "picture", {"use": "photograph", "face": "palmar"}),
        ("ruler.jpg", "picture", {"use": "", "finger": ""}),
        ("press.avi", "sequence", {"use": "sequence"}),
    ],
)
def test_names(file, kind, known):
    new = named_file(f"uploads/{file}", kind, ())
    assert {key: getattr(new, key) for key in known} == known
    assert new.guessed == ()
    assert named_file("IMG_1.jpg", "picture", ["left_index"]).finger == "left_index"  # the only one
    assert named_file("IMG_1.jpg", "picture", ["left_index", "right_index"]).finger == ""
    assert named_file("P10_30deg_2N.png", "picture", ["P1", "P2"]).finger == ""  # another one
    assert named_file("palmar_B.jpg", "picture", ["A", "B"]).finger == "B"


@pytest.mark.parametrize(
    ("use", "ppi", "scales", "expected"),
    [
        ("observation", 500.0, {}, "500 ppi"),
        ("observation", 72.0, {}, ""),
        ("photograph", 500.0, {}, ""),
        ("observation", 500.0, {"reader": {"ppi": 500}, "b": {"ppi": 1000}}, "reader"),
        ("observation", None, {"reader": {"ppi": 500}}, "reader"),
        ("photograph", None, {"reader": {"ppi": 500}}, ""),  # a scanner's
        ("photograph", None, {"camera": {"coin": "a.png"}}, "camera"),
        ("curve", 500.0, {"reader": {"ppi": 500}}, ""),
    ],
)
def test_guessed_scales(use, ppi, scales, expected):
    guess = with_scales(Guess(kind="picture", uses=(use,), sure=True, dots_per_inch=ppi), scales)
    new = with_guess(NewFile(file="IMG_0031.png"), guess)
    assert (new.use, new.scale) == (use, expected)
    assert new.guessed == (("scale",) if expected else ())


def test_written_scales():
    per_px = dict.fromkeys(("0,05 mm/px", "50 µm/px", "20 px/mm"), "0.05 mm/px")
    known = {"72": "72 ppi", "500 dpi": "500 ppi", "Reader 2": "Reader 2", **per_px}
    assert {words: written_scale(words, ["Reader 2"]) for words in known} == known
    for words in ("0.05", "71", "reader", "1,234 ppi", ""):  # a comma could part two numbers
        with pytest.raises(ManifestError, match=r"500 ppi or 0.05 mm/px"):
            written_scale(words, ["Reader 2"])


def test_what_is_stated_is_no_guess():
    new = NewFile(file="a.png", use="observation", finger="index", guessed=("use", "scale"), scale="500 ppi")
    taken, problem = stated_values(new, {"person": "S7", "face": "distal", "scale": "READER"}, ["reader"])
    known = {"person": "S7", "finger": "S7_index", "face": "distal", "use": "photograph", "scale": "reader"}
    assert (taken, problem) == ({**known, "guessed": ()}, "")
    kept, problem = stated_values(new, {"scale": "other"}, ["reader"])
    assert kept == {"guessed": ("use", "scale")}
    assert problem == "no scale of the study is called other"


def test_edits(tmp_path):
    """Fingers come first, a shared scale has a name, and a file without a finger waits."""
    known = {"finger": "left_index", "use": "observation", "wedge_angle_deg": 30.0}
    face = {"finger": "left_index", "face": "palmar"}
    found = proposed_edits(
        empty(tmp_path),
        [
            NewFile(file="a/IMG 1.png", load_N=1.0, scale="500 ppi", **known),
            NewFile(file="b/img 1.png", scale="500 ppi", session="2", **known),
            NewFile(file="c.png", use="observation"),
            NewFile(file="coin.png", use="coin", diameter_mm=23.25),
            NewFile(file="p.jpg", use="photograph", scale="coin in coin.png", **face),
            NewFile(file="o.csv", use="outline", finger="left_index", face="radial"),
            NewFile(file="film.avi", use="sequence", finger="S7_ring", person="S7", scale="0.05 mm/px"),
            NewFile(file="force.csv", use="force"),
            NewFile(file="curve.csv", use="curve", finger="S7_ring"),
            NewFile(file="ruler.jpg", use="ruler"),
            NewFile(file="odd.bin"),
        ],
        synthetic=True,
    )
    assert (found.added, found.waiting) == (7, ("c.png",))
    made, film = {"synthetic": True}, {"finger": "S7_ring", "scale": {"mm_per_px": 0.05}}
    contact = {"finger": "left_index", "wedge_angle_deg": 30.0, "scale": "500_ppi"}
    assert [(edit.kind, edit.key, edit.set) for edit in found.edits] == [
        ("finger", "left_index", {}),
        ("scale", "500_ppi", {"ppi": 500.0}),
        ("observation", "IMG_1", {**contact, "load_N": 1.0, "file": "a/IMG 1.png", **made}),
        ("observation", "img_1_2", {**contact, "session": "2", "file": "b/img 1.png", **made}),
        ("scale", "coin", {"coin": "coin.png", "diameter_mm": 23.25}),
        ("photograph", "left_index/p.jpg", {"face": "palmar", "scale": "coin", **made}),
        ("photograph", "left_index/o.csv", {"face": "radial", "outline": "o.csv", **made}),
        ("finger", "S7_ring", {"person": "S7"}),
        ("sequence", "film", {**film, "file": "film.avi", "force": "force.csv", **made}),
        ("curve", "0", {"finger": "S7_ring", "file": "curve.csv", **made}),
    ]


@pytest.fixture
def camera_files(tmp_path):
    """Files as a camera, a reader and a load cell name them, with decimal commas in the tables."""

    pixels = render_contact_image(semi_major=6.0, semi_minor=4.0, orientation=0.0, ppi=500, seed=1).pixels
    Image.fromarray(pixels).save(tmp_path / "IMG_0031.png", dpi=(500, 500))
    Image.fromarray(pixels).save(tmp_path / "LI_30deg_0,5N.png")
    (tmp_path / "force.csv").write_text("time (s);force (N)\n0;0,1\n0,5;1,5\n1;2,25\n")
    (tmp_path / "details.csv").write_text(
        "file;wedge (deg);load (N);Ansicht\nIMG_0031;45;1,5;\nIMG_0099;0;2;\n"
    )
    (tmp_path / "odd.csv").write_text("a,b\n1,2\n")
    (tmp_path / "notes.txt").write_text("not of the study")
    return tmp_path


def test_a_study_begins_from_files(camera_files):
    started = start_study(camera_files, finger="right_index")
    study = {one.key: one.content for one in load_study(camera_files / "study.toml").tables}
    contact = study["IMG_0031"]
    assert (contact["finger"], contact["wedge_angle_deg"], contact["load_N"]) == ("right_index", 45, 1.5)
    assert contact["scale"] == {"ppi": 500}
    assert "scale" not in study["LI_30deg_0_5N"]  # nothing is guessed in silence
    assert started.taken["IMG_0031.png"] == "contact image"
    assert any("IMG_0031.png: 500 ppi as its file says" in line for line in started.guesses)
    assert "details.csv, line 3: no one file is called 'IMG_0099'" in started.guesses
    assert any(line.startswith("details.csv: no column for 'Ansicht': known are") for line in started.guesses)
    assert started.left["force.csv"] == "force of a sequence"
    assert started.taken["details.csv"].startswith("what it states of ")
    assert started.guesses[0] == "load_relative_std = 0.01: every load is known within 1 %"
    assert started.left["odd.csv"].startswith("nothing that a study needs, as far as names of columns tell")
    assert "notes.txt" not in started.left
    assert any(one.key == "LI_30deg_0_5N" and one.place == "scale" for one in started.missing)


def test_what_no_finger_is_stated_of_is_left(camera_files):
    started = start_study(camera_files)
    assert started.left["IMG_0031.png"] == "nothing states its finger: give --finger NAME"
    assert "IMG_0031.png" not in started.taken
    (camera_files / "study.toml").unlink()
    (camera_files / "LI_30deg_0,5N.png").rename(camera_files / "IMG_0032.png")
    words = r"IMG_0031\.png shows, nor 1 other file: give --finger left_index"
    with pytest.raises(ManifestError, match=words):
        start_study(camera_files)
    assert not (camera_files / "study.toml").exists()


def test_what_states_a_load_is_a_contact_image(tmp_path):
    """In its name or in a spreadsheet; as such also in a folder that could hold frames."""
    shown = ruler_scene(KINDS[0], 3, side=240)
    for folder, names in {
        "named": [f"P01_LI_{wedge}deg_{load}N" for wedge in range(11) for load in (0.3, 2)],
        "listed": ["a", "b"],
    }.items():
        (tmp_path / folder).mkdir()
        for name in names:
            Image.fromarray(shown).save(tmp_path / folder / f"{name}.png")
    (tmp_path / "list.csv").write_text("file,person,finger,load (N)\na.png,P02,LM,0.3\n")
    started = start_study(tmp_path)
    assert sum(words == "contact image" for words in started.taken.values()) == 23
    people = {one.key: one.content["person"] for one in started.loaded.tables if one.kind == "finger"}
    assert people == {"P01_left_index": "P01", "P02_left_middle": "P02"}
    assert started.left["listed/b.png"] == "ruler, for the scale"
    assert not any("taken as" in line for line in started.guesses)


def test_folders_without_files_and_with_a_study_are_refused(tmp_path):
    with pytest.raises(ManifestError, match="holds no picture"):
        start_study(tmp_path)
    assert not (tmp_path / "study.toml").exists()
    with pytest.raises(ManifestError, match="is no folder"):
        start_study(tmp_path / "none")
    (tmp_path / "a.png").write_bytes(b"no picture")
    Image.fromarray(np.zeros((50, 50), np.uint8)).save(tmp_path / "b.png")
    assert "cannot be read" in start_study(tmp_path).left["a.png"]
    with pytest.raises(ManifestError, match="there is a study already"):
        start_study(tmp_path)


def test_guesses_say_so():
    guess = Guess(
        kind="picture",
        uses=("observation", "photograph"),
        sure=False,
        scales={"observation": GuessedScale("500 ppi", "why")},
    )
    assert with_guess(NewFile(file="a.png"), guess).guessed == ("use", "scale")
    named = NewFile(file="a.png", scale="reader", face="palmar")
    assert with_guess(named, guess).guessed == ("use",)
