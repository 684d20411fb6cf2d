"""Spreadsheets and patterns of names, joined to files."""

from collections import Counter
from pathlib import Path

import cv2
import numpy as np
import pytest
from benchmarks.claims.photographs import random_finger
from PIL import Image
from tests.image.ruler_scenes import KINDS, ruler_scene
from tests.workbooks import MAIN, workbook

from fingerpad.exceptions import ManifestError
from fingerpad.image import guess_subject
from fingerpad.simulate import render_coin, render_contact_image, render_finger
from fingerpad.study.imports.identify import identify_file, join_files, parse_file_table, read_file_table
from fingerpad.study.imports.names import match_file_names, read_file_name

SHEET = f"""<?xml version="1.0"?><worksheet {MAIN}><sheetData>
<row r="1"><c r="A1" t="s"><v>0</v></c><c r="B1" t="s"><v>1</v></c>
<c r="D1" t="inlineStr"><is><t>theta (deg)</t></is></c></row>
<row r="3"><c r="A3" t="s"><v>2</v></c><c r="B3"><v>0.10000000000000001</v></c>
<c r="D3"><f>15*2</f><v>30</v></c></row>
</sheetData></worksheet>"""
SHARED = (
    "<si><t>File</t></si><si><t>Load N</t></si>"
    "<si><r><t>IMG_</t></r><r><t>1.png</t></r><rPh><t>x</t></rPh></si>"
)


def test_workbook(tmp_path):
    path = tmp_path / "a.xlsx"
    path.write_bytes(workbook(SHEET, SHARED))
    (row,) = read_file_table(path).rows
    assert (row.file, row.values) == ("IMG_1.png", {"load_N": 0.1, "wedge_angle_deg": 30.0})


def test_hostile_workbooks(tmp_path):
    entities = '<!DOCTYPE a [<!ENTITY b "bbbb">]>' + SHEET.replace('<?xml version="1.0"?>', "")
    bad = {
        "entities": workbook(entities, SHARED),
        "wide characters": workbook(SHEET.encode("utf-16").decode("latin-1"), SHARED),
        "no zip": b"PK\3\4 nothing",
        "cut": workbook(SHEET, SHARED)[:500],
        "a text beyond the last": workbook(SHEET, "<si><t>File</t></si>"),
        "no sheet": workbook(SHEET, SHARED, **{"xl/workbook.xml": f"<workbook {MAIN}/>".encode()}),
    }
    for what, content in bad.items():
        path = tmp_path / f"{what}.xlsx"
        path.write_bytes(content)
        with pytest.raises(ManifestError) as caught:
            read_file_table(path)
        assert what in str(caught.value)


@pytest.mark.parametrize(
    ("header", "cell", "values"),
    [
        ("Load (mN)", "500", {"load_N": 0.5}),
        ("Normal force [N]", "1,5", {"load_N": 1.5}),
        ("weight, g", "100", {"load_N": 0.980665}),
        ("load", "250 mN", {"load_N": 0.25}),
        ("load (kgf)", "2", {"load_N": 19.6133}),
        ("load_N_std", "0.1", {}),
        ("wedge_angle_deg", "30°", {"wedge_angle_deg": 30.0}),
        ("scale (px/mm)", "20", {"scale": "0.05 mm/px"}),
        ("um per px", "50", {"scale": "0.05 mm/px"}),
        ("PPI", "500", {"scale": "500 ppi"}),
        ("scale", "reader", {"scale": "reader"}),
        ("Participant ID", "S 07", {"person": "S_07"}),
        ("digit", "right ring", {"finger": "right_ring"}),
        ("Face", "Palmar view", {"face": "palmar"}),
        ("type", "ulnar photo", {"use": "photograph", "face": "ulnar"}),
        ("Type", "coin", {"use": ""}),
        ("visit", "2", {"session": "2"}),
        ("temperature", "20", {}),
    ],
)
def test_headers_and_cells(header, cell, values):
    table = parse_file_table(f"Filename\t{header}\na.png\t{cell}")
    assert table.rows[0].values == values
    assert (table.columns[1].meaning is None) == (not values)
    assert not table.rows[0].problems


def test_names_of_files_are_known_without_their_header():
    table = parse_file_table("Bild;Normalkraft [N]\nIMG_0031.JPG;0,50\nIMG_0032.JPG;1,5\n")
    assert [(row.file, row.values) for row in table.rows] == [
        ("IMG_0031.JPG", {"load_N": 0.5}),
        ("IMG_0032.JPG", {"load_N": 1.5}),
    ]
    with pytest.raises(ManifestError, match="no column names the files; found Bild, Kopie, load"):
        parse_file_table("Bild,Kopie,load\na.png,b.png,1\n")


@pytest.mark.parametrize(
    ("header", "cell"),
    [
        *(("load", "heavy"), ("load", "-1"), ("load", "5 kg")),
        *(("wedge", "100"), ("scale", "500"), ("face", "nose")),
    ],
)
def test_a_cell_that_cannot_be_read_is_named(header, cell):
    row = parse_file_table(f"file,{header},session\na,{cell},1").rows[0]
    assert row.values == {"session": "1"}
    assert len(row.problems) == 1
    assert repr(cell) in row.problems[0]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("load,finger\n1,LI", "no column names the files"),
        ("file,load,force\na,1,1", "both state the load"),
        ("file,load\n", "at least one row"),
    ],
)
def test_tables_that_cannot_be_joined(text, words):
    with pytest.raises(ManifestError, match=words):
        parse_file_table(text)


def test_hand_and_digit_in_two_columns():
    table = parse_file_table("hand;digit;image\nL;index;1\nright;Thumb;2")
    assert [row.values["finger"] for row in table.rows] == ["left_index", "right_thumb"]


def test_join_lists_what_is_unmatched_and_what_is_named_twice():
    files = ["uploads/a-1.png", "uploads/b.png", "uploads/b.tif", "uploads/c_0.5N.png", "uploads/d.png"]
    table = parse_file_table(
        "file,load\nA (1).PNG,1\nb,2\nb.tif,3\nc_0.5N,4\nd,5\nD.png,6\nnowhere.png,7\n,8"
    )
    found = join_files(table, files)
    loads = {file: row.values["load_N"] for file, row in found.rows.items()}
    assert loads == {"uploads/a-1.png": 1, "uploads/b.tif": 3, "uploads/c_0.5N.png": 4}
    assert [row.line for row in found.rows_without_file] == [3, 6, 7, 8, 9]  # b is two files, d two rows
    assert found.files_without_row == ["uploads/b.png", "uploads/d.png"]


def test_a_file_taken_for_one_of_another_suffix_is_said():
    found = join_files(parse_file_table("file,load\na.pgn,1\nb,2"), ["a.png", "b.png"])
    assert found.rows["a.png"].problems == ("a.pgn is not there: taken for a.png",)
    assert not found.rows["b.png"].problems


def test_pattern():
    names = "S01_left_index_45deg_500mN.png", "x/s2_right-thumb_0deg_1,5mN_b.tif"
    others = "S1_LI_100deg_5mN.png", "IMG_1.png"
    found = match_file_names("S{person}_{finger}_{wedge}deg_{load}mN*", [*names, *others])
    assert [one.problem == "" for one in found] == [True, True, False, False]
    assert found[0].values == {"person": "01", "finger": "left_index", "wedge_angle_deg": 45.0, "load_N": 0.5}
    assert (found[1].values["finger"], found[1].values["load_N"]) == ("right_thumb", 0.0015)
    assert "100" in found[2].problem


@pytest.mark.parametrize(
    "pattern",
    [
        *("IMG", "{load}_{load}", "{mood}", "{person}{finger}", "*_*_*_*_{load}", "{load}{}", "{roll}"),
        *("*{load}", "{load}" + "x" * 300),
    ],
)
def test_patterns_refused(pattern):
    with pytest.raises(ManifestError):
        match_file_names(pattern, ["a.png"])


# What names of files say, and what they leave open


@pytest.mark.parametrize(
    ("key", "values"),
    [
        ("load_N", {
            "a_0.5N.png": 0.5, "1,5N.png": 1.5, "500mN.png": 0.5, "30deg-2 N.tif": 2.0,
            "left thumb 12N_b.png": 12.0, "45_2N.png": 2.0,
            "0-5N.png": None, "1_5N.png": None, "2Nm.png": None, "N2.png": None, "2n.png": None,
        }),
        ("wedge_angle_deg", {
            "wedge45.png": 45.0, "wedge_angle-30_1N.png": 30.0, "30°_2N.png": 30.0, "22,5 deg.png": 22.5,
            "theta30.png": 30.0, "350deg.png": None, "2-5deg.png": None, "IMG_0045.jpg": None,
        }),
        ("finger", {
            "S01_LI.png": "S01_left_index", "P3 RT 2N.png": "P3_right_thumb",
            "subject12-right-middle_1N.png": "subject12_right_middle", "LeftIndex30deg.png": "left_index",
            "index-left-1N.png": "left_index", "Right Pinky.png": "right_little", "my_pad_2N.png": "my_pad",
            "left.png": None, "MRI.png": None, "a_l_i.png": None, "thumbnail_left.png": None,
        }),
    ],
)  # fmt: skip
def test_what_a_name_says(key, values):
    found = {name: read_file_name(name, "picture", fingers=["my_pad", "pad"]).get(key) for name in values}
    assert found == values


@pytest.mark.parametrize(
    ("name", "kind", "role", "face"),
    [
        ("a.png", "picture", "observation", None),
        ("a_palmar.png", "picture", "photograph", "palmar"),
        ("ruler.png", "picture", None, None),
        ("2_cent.jpg", "picture", None, None),
        ("center.png", "picture", "observation", None),
        ("press.avi", "sequence", "sequence", None),
        ("distal.csv", "table", "outline", "distal"),
        ("loading.csv", "table", "curve", None),
        ("force.csv", "table", None, None),
        ("notes.txt", "other", None, None),
    ],
)
def test_role(name, kind, role, face):
    found = read_file_name(f"folder_2N/{name}", kind)
    assert (found.get("use"), found.get("face"), "load_N" not in found) == (role, face, "2N" not in name)


# What new files are, by content and name: a small seeded table of confusion

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "examples" / "dzidek2017" / "synthetic"


def test_example_files_under_names_that_say_nothing(tmp_path):
    expected = {"*.png": "observation", "*.jpg": "photograph", "*.tif": "sequence"}
    for pattern, content in {**expected, "curve*.csv": "curve", "*force.csv": "force"}.items():
        for number, path in enumerate(sorted(EXAMPLE.glob(pattern))):
            plain = tmp_path / f"IMG_{number:04}{path.suffix}"
            plain.write_bytes(path.read_bytes())
            found = identify_file(plain)
            assert (found.uses[0], found.sure) == (content, True), path.name
            if content == "photograph":
                assert found.face == path.stem.split("_")[1]


def test_subjects_of_pictures():
    """Nothing is taken surely for what it is not; most are recognised."""
    pictures = [
        ("contact", render_contact_image(semi_major=3.2, semi_minor=2.9, seed=1).pixels),
        *(("finger", random_finger(seed, 60).pixels) for seed in range(2)),
        ("coin", render_coin(radius=100, seed=2).pixels),
        *(("ruler", ruler_scene(kind, 3, side=480)) for kind in KINDS[:3]),
        ("blank paper", np.full((80, 90), 200, np.uint8)),
    ]
    recognised: Counter[str] = Counter()
    for subject, pixels in pictures:
        subjects = guess_subject(pixels).subjects
        (best, share), *_ = subjects.items()
        assert sum(subjects.values()) == pytest.approx(1)
        assert best == subject or share < 0.9, (subject, best, share)
        recognised[subject] += best == subject
    assert recognised == {
        "contact": 1,
        "finger": 2,
        "coin": 1,
        "ruler": recognised["ruler"],
        "blank paper": 0,
    }


@pytest.mark.parametrize("tip", ["up", "left"])
def test_a_side_is_told_whichever_way_the_tip_points(tip):
    guess = guess_subject(render_finger("radial", tip=tip, mm_per_px=0.08, seed=2).pixels)
    assert next(iter(guess.subjects)) == "finger"
    assert guess.faces["radial"] == guess.faces["ulnar"] > guess.faces["palmar"]


def test_a_name_says_more_than_pixels_that_are_in_doubt(tmp_path):
    grey = np.full((200, 200), 200, np.uint8)
    cv2.circle(grey, (100, 100), 60, 90, -1)
    for name, content in [("30deg_2N", "observation"), ("palmar", "photograph")]:
        Image.fromarray(cv2.GaussianBlur(grey, (0, 0), 25)).save(tmp_path / f"{name}.png")
        found = identify_file(tmp_path / f"{name}.png")
        assert (found.uses[0], found.sure) == (content, True)
    assert found.face == "palmar"


@pytest.mark.parametrize(
    ("text", "content"),
    [
        ("time_s,force_N,displacement_mm\n0,0,0\n", "curve"),
        ("time_s,force_N,displacement_mm,trigger_V\n0,0,0,0\n", "force"),
        ("Position;Force\n1,5;0,2\n", "curve"),
        ("Time/s;Normal force [mN];Disp / µm\n0;0,1;0\n", "curve"),
        ("Time [s]\tLoad[mN]\n0\t0\n", "force"),
        ("X [µm];Y [µm]\n0;0\n", "outline"),
        ("file,load\nIMG_1,2\n", "sheet"),
        ("a,b\n1,2\n", ""),
        ("", ""),
    ],
)
def test_tables_by_their_headers(tmp_path, text, content):
    path = tmp_path / "data.csv"
    path.write_text(text, encoding="utf-8")
    assert identify_file(path).uses[0] == content


@pytest.mark.parametrize(
    ("name", "content", "is_sure"),
    [
        ("press_force.csv", "force", False),
        ("press.csv", "curve", True),
        ("force_displacement.csv", "curve", True),
    ],
)
def test_a_name_that_says_force_gives_a_table_to_a_sequence(tmp_path, name, content, is_sure):
    (tmp_path / name).write_text("time_s,force_N,displacement_mm\n0,0,0\n")
    found = identify_file(tmp_path / name)
    assert (found.uses[0], found.sure) == (content, is_sure)
