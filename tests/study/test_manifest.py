"""The manifest: what is accepted, and what is said of each fault before any work."""

import json
import re
import shutil
from pathlib import Path

import pytest
from tests.studies import Table, contact, curve, finger, picture, sequence, study_of, write_study
from tests.workbooks import sheet_xml, workbook

from fingerpad.exceptions import ManifestError
from fingerpad.study.editing.edit import Edit, change_study
from fingerpad.study.editing.template import SCHEMA_NAME, manifest_schema, write_example, write_template
from fingerpad.study.manifest.load import load_study, read_study
from fingerpad.study.manifest.models import ResolutionScale, Study
from fingerpad.study.manifest.sheet import Sheet
from fingerpad.study.status import missing

FINGER = """
[[fingers]]
name = "index"
semi_axes_mm = { palmar = 7.9, distal = 13.8, radial_ulnar = 11.8 }
semi_axes_mm_std = { palmar = 0.1, distal = 0.1, radial_ulnar = 0.1 }
"""
ROW = """
[[observations]]
name = "a"
finger = "index"
wedge_angle_deg = 30
load_N = 2
ellipse_mm = { semi_major = 7.4, semi_minor = 5.0, std = 0.1 }
"""
PRESS = """
[[sequences]]
name = "p"
finger = "index"
wedge_angle_deg = 30
file = "frames"
force = "force.csv"
"""
VALID = 'title = "T"\n' + FINGER + ROW


BESIDE = 'title = "T"\nobservations_csv = "rows.csv"\n' + FINGER  # observations stand in a spreadsheet
HEADER = "name,finger,wedge_angle_deg,load_N,semi_major_mm,semi_minor_mm,ellipse_mm_std"
CELLS = "b,index,45,2,5,4,.1"


def write(folder: Path, text: str) -> Path:
    path = folder / "study.toml"
    path.write_text(text, encoding="utf-8")
    return path


def beside(folder: Path, *lines: str, encoding: str = "utf-8") -> Path:
    """Write a study whose observations stand in a spreadsheet of these lines; return its manifest."""
    (folder / "rows.csv").write_text("".join(f"{line}\n" for line in lines), encoding=encoding)
    return write(folder, BESIDE)


def test_a_complete_row_of_a_spreadsheet_is_kept_once(tmp_path):
    loaded = load_study(beside(tmp_path, HEADER, "a,index,30,2,7.4,5,0.1", "b,index,30,,7.4,5,0.1"))
    complete, lacking = (one for one in loaded.tables if one.kind == "observation")
    assert (complete.content, complete.model) == ({}, loaded.study.observations[0])
    assert lacking.content["wedge_angle_deg"] == "30"


def test_rows_may_come_from_a_spreadsheet_besides(tmp_path):
    path = beside(
        tmp_path, f"{HEADER},synthetic", f"{CELLS},true", f"{CELLS.replace('b', 'c')},", encoding="utf-8-sig"
    )
    path.write_text(BESIDE + ROW)
    study = read_study(path)
    assert [(row.name, row.synthetic) for row in study.observations] == [
        ("a", False),
        ("b", True),
        ("c", False),
    ]
    assert study.observations[1].ellipse_mm.semi_minor == 4


def changed(old: str, new: str) -> str:
    return VALID.replace(old, new)


def image(keys: str) -> str:
    return changed("ellipse_mm =", f"{keys} #")


def scale(keys: str) -> str:
    return f"{VALID}[scales.s]\n{keys}"


def pad(*keys: str) -> str:
    """Return a finger with photographs."""
    photographs = ", ".join(f"{{ {one} }}" for one in keys)
    return f'title = "T"\n[[fingers]]\nname = "f"\nphotographs = [{photographs}]'


SAME_FILE = 'file = "study.toml", scale = { ppi = 90 }'


def press_curve(keys: str) -> str:
    return f'{VALID}[[curves]]\nfinger = "index"\nwedge_angle_deg = 30\nfile = "study.toml"\n{keys}'


def press(keys: str) -> str:
    return f"{VALID}{PRESS}scale = {{ ppi = 500 }}\n{keys}"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("title = ", "study.toml: not valid TOML: Invalid value"),
        ("\ntitle = Mine", r"\(at line 2, column 9\): 'title = Mine'; text stands in quotes"),
        ('title = "T"', "study.toml: fingers: no finger yet: add one"),
        (VALID + "loadN = 3", "observations.0..loadN: unknown key; did you mean 'load_N'"),
        ("palmar = 3\n" + VALID, "palmar: unknown key; it belongs in another table"),
        (VALID + "strokes = 1", r"strokes: unknown key \(in a\)"),  # of a correction, of no manifest
        (
            "".join(f'[[fingers]]\nname = "f{k}"\n' for k in range(99)) + ROW,
            "there is f0, f1, f2, f3, f4 and 94 more",
        ),
        (changed("= 2\n", "= -2\n"), "observations.0..load_N: expected greater than 0, found -2"),
        (changed("= 2\n", '= "2"\n'), "load_N: expected a number, found '2'; .* without quotes"),
        (
            VALID.partition("{ semi")[0] + "[7.4, 5.0]",
            "ellipse_mm: .* table, as in { semi_major = ..., .* found .7",
        ),
        (image('file = "study.toml"\nscale = { ppi = 500 }\nseed_px = [1]'), "at least 2 values, found .1."),
        (VALID + "synthetic = 'yes'", "synthetic: expected true or false, found 'yes'"),
        (changed("[[fingers]]", "[fingers]"), r"write \[\[fingers\]\] in place of \[fingers\]"),
        (VALID + ROW.replace('"a"', '"A"'), r"observations\[1\].name: 'A' is taken; names must differ"),
        (image('file = "a\\u0000.png"\nscale = { ppi = 500 }'), "is no file name"),
        (pad('face = "palmar", file = "a.png"'), "photographs.0.: an image needs its scale"),
        (
            pad('face = "palmar", outline = "a.csv", tip = "up", scale = { ppi = 500 }'),
            "beside an outline there is no use for tip",
        ),
        (
            pad(*(f'face = "{face}", {SAME_FILE}' for face in ("palmar", "distal"))),
            r"fingers\[0\]: the photograph study.toml is named 2 times: copy",
        ),
        (press_curve("loading_radius_mm_std = 3"), "curves.0.: there is no use for loading_radius_mm_std"),
        (press_curve("thickness_mm = inf\nthickness_mm_std = 1"), "no use for thickness_mm_std"),
        (press_curve('scale = "other"'), "no scale is named 'other'"),
        (press_curve("scale = { ppi = 90 }\narea_relative_std = 0.1"), "no use for area_relative_std"),
        (press_curve('file_columns = { aera = "aera_mm2:mm2" }'), r"curves\[0\]\.file_columns\.aera: "),
        (pad('face = "palmar", outline = "study.toml", scale = "third"'), "no scale is named 'third'"),
        *(
            (f"{VALID}[{table}]\n{key} = {value}", f"{table}.{key}: ")
            for table, key, value in (
                ("uncertainty", "load_gain_relative_std", 1.5),
                ("uncertainty", "jig_angle_deg_std", -1),
                ("apparatus", "dwel_s", 1),
                ("apparatus", "imaging", 3),
            )
        ),
        (changed("semi_minor = 5.0", "semi_minor = 9.0"), "ellipse_mm: semi_minor 9 must not exceed"),
        (changed('finger = "index"', 'finger = "thumb"'), "no finger is named 'thumb'; there is index"),
        (changed('name = "a"', 'name = "../a"'), "observations.0..name: write it with letters"),
        (changed("semi_axes_mm_std", "# "), "semi_axes_mm and semi_axes_mm_std belong together"),
        *(
            (changed("[[observations]]", f"{keys}\n[[observations]]"), f"fingers.0.*{words}.*in index")
            for keys, words in (
                ("effective_thickness_mm = 0.4", "expected greater than or equal to 0.5, found"),
                ("effective_thickness_mm = inf", "leave it out where there is no bone"),
                ("effective_thickness_mm_std = 1.0", "give both"),
                ("effective_thickness_mm = 8\neffective_thickness_mm_std = 8", "uncertainty below the thick"),
            )
        ),
        (VALID + 'file = "x.png"\nscale = { ppi = 500 }', "give either file or ellipse_mm, one of the two"),
        (image('file = "x.png"'), "an image needs its scale"),
        (image('file = "no.png"\nscale = { ppi = 500 }'), "file: no file 'no.png' in the study"),
        (
            image('file = "x.png"\nppi = 500'),
            r"observations.0..ppi: unknown key; write it in the table of a scale, as in scale = \{ ppi",
        ),
        (scale("ppi = 500\nmm_per_px = 0.05"), "scales.s: give one of .*, found ppi and mm_per_px"),
        (VALID + '[scales."a b"]\nppi = 500', "scales.a b.*: write it with letters"),
        (scale("line = [[1, 2], [1, 2]]\nlength_mm = 5"), "scales.s: the line must have two different"),
        (scale('coin = "no.png"\ndiameter_mm = 23.25'), "scales.s.coin: no file 'no.png'"),
        (image('file = "study.toml"\nscale = "s"'), "scale: no scale is named 's'; write a table .scales.s."),
        (VALID + PRESS, "sequences.0.: a sequence needs its scale"),
        (changed("= 2\n", "= -2\n").replace("7.9", "-1"), "-2(.|\n)*found -1|-1(.|\n)*found -2"),
        (press('times = "t.csv"\nframes_per_second = 9'), "no use for frames_per_second"),
        (press("start_s = 1\ncontact_load_N = 1"), "give either start_s or contact"),
        ('title = "T"\nobservations_csv = "no.csv"' + FINGER, "observations_csv: no file 'no.csv'"),
    ],
)
def test_names_file_key_and_what_was_expected(tmp_path, text, message):
    with pytest.raises(ManifestError, match=f"(?m){message}") as caught:
        read_study(write(tmp_path, text))
    assert all(line.startswith(("study.toml: ", str(tmp_path))) for line in str(caught.value).splitlines())


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (f"{HEADER}\nb,index,45,x,5,4,.1", "rows.csv, line 2: load_N: expected a number.*found 'x'"),
        (f"{HEADER}\n\nb,index,45,2,5,4", "rows.csv, line 3: ellipse_mm.std: required, but missing"),
        (f"{HEADER}\n{CELLS},extra", "rows.csv, line 2: more cells than the header has columns"),
        (f"{HEADER.replace(',', ';')}\n{CELLS.replace(',', ';')};x", "line 2: more cells"),
        (CELLS, "rows.csv: no column finger, load_N, name, wedge_angle_deg in the first line; found b"),
        (
            f"{HEADER},file,ppi,mm_per_px\nb,index,45,2,,,,x.png,500,0.05",
            "rows.csv, line 2: scale: give one of .*, found ppi and mm_per_px",
        ),
        (f"{HEADER},file,ppi,scale\nb,index,45,2,,,,x.png,500,reader", "line 2: give either scale or ppi"),
        (f"{HEADER},load_N\n{CELLS},3", "rows.csv: column load_N is there 2 times"),
        (f"{HEADER}\n{CELLS.replace('45', chr(34) + '4,5' + chr(34))}", "found '4,5'; write it with a dec"),
    ],
)
def test_names_the_line_of_a_spreadsheet(tmp_path, text, message):
    with pytest.raises(ManifestError, match=message):
        read_study(beside(tmp_path, text))


@pytest.mark.parametrize("encoding", ["utf-8-sig", "cp1252"])
def test_spreadsheets_as_programs_in_other_languages_save_them(tmp_path, encoding):
    header = "Name;Finger;Wedge angle (deg);Load [N];Semi major (mm);semi_minor_mm;ellipse_mm_std;notes"
    cells = "b;index;22,5;0,5;5,3;4;0,1;größer, als 1,5 N"
    (row,) = read_study(beside(tmp_path, header, cells, encoding=encoding)).observations
    assert (row.wedge_angle_deg, row.load_N, row.ellipse_mm.semi_major) == (22.5, 0.5, 5.3)
    assert row.notes == "größer, als 1,5 N"


def test_the_unknown_columns_of_a_force_are_named(tmp_path):
    study = write_study(
        tmp_path, finger("f"), sequence("s", "frames.tif", force="kraft.csv", scale={"ppi": 500})
    )
    (tmp_path / "frames.tif").touch()
    (tmp_path / "kraft.csv").write_text("t,Kanal (mN)\n0,0\n1,500\n")
    (found,) = missing(load_study(study))
    assert (found.kind, found.place) == ("sequence", "force_columns")
    columns = found.proposed
    edit = Edit(kind="sequence", key=found.key, set={found.place: columns})
    assert change_study(tmp_path, [edit], expected=load_study(study).digest)
    assert missing(load_study(study)) == []


def test_the_unknown_columns_of_a_curve_are_named_with_the_key_that_tells_them(tmp_path):
    study = write_study(tmp_path, finger("f"), curve(file="c.csv"))
    (tmp_path / "c.csv").write_text("Kanal1,Kanal2 (mm)\n0,0\n1,0.5\n2,0.9\n", encoding="utf-8")
    (found,) = missing(load_study(study))
    assert (found.kind, found.key) == ("curve", "0")
    assert "found Kanal1, Kanal2 (mm)" in found.words
    line = 'file_columns = { force = "Kanal1:N", displacement = "Kanal2 (mm):mm" }'
    assert 'file_columns = { force = "HEADER:UNIT", displacement = "Kanal2 (mm):mm" }' in found.words
    assert found.proposed == 'force = "HEADER:UNIT", displacement = "Kanal2 (mm):mm"'

    def name(columns):
        edit = Edit(kind="curve", key="0", set={"file_columns": columns})
        return change_study(tmp_path, [edit], expected=load_study(study).digest)

    with pytest.raises(
        ManifestError, match='file_columns: write force = "HEADER:UNIT", .*found force: Kanal1'
    ):
        name("force: Kanal1")
    assert missing(name(line[17:-2])) == []


PEOPLE, SESSIONS = ("P01", "p01", "P-01", "P1_1", "P11"), ("Day_2", "day2", "1.1", "11")
WEDGES = [("f", 30), ("f", 30.4), ("f", 45), ("g", 30), ("g", 31), ("h", 30.4), ("h", 30.4)]


@pytest.mark.parametrize(
    ("tables", "doubt"),
    [
        (
            map(finger, ("left_index", "leftindex", "right_index")),
            "left_index and leftindex: are these names of one finger? then write one of them everywhere",
        ),
        (
            (finger(f"f{k}", person=name) for k, name in enumerate(PEOPLE)),
            "P01, p01 and P-01: are these names of one person? then write one of them everywhere",
        ),
        (
            (finger(), *(contact(f"c{k}", session=name) for k, name in enumerate(SESSIONS))),
            "Day_2 and day2: are these names of one session? then write one of them everywhere",
        ),
        (
            (
                *map(finger, "fgh"),
                *(contact(f"c{k}", finger=name, wedge=deg) for k, (name, deg) in enumerate(WEDGES)),
            ),
            "f: wedge_angle_deg 30 and 30.4: is this one placement? then write one angle for all its presses",
        ),
        (
            (finger(), contact("heavy", 2000)),
            "heavy: more than 100 N: is load_N in millinewtons, not newtons?",
        ),
        (
            (finger(), contact("a", wedge=1.2), contact("b", 0.5, wedge=0.5)),
            "a and 1 more: less than 1.6°: is wedge_angle_deg in radians, not degrees?",
        ),
        ((finger(), contact("heavy", 100), contact("flat", 0.5, wedge=0)), ""),
        (
            (finger(), contact("a", 2, (7.41, 5)), contact("b", 2, (7.41, 5)), contact("c", 1, (7.41, 5))),
            "a and b: the same ellipse_mm to the last digit: is a press entered twice?",
        ),
        ((finger(), contact("a", 2, (7.4, 5)), contact("b", 2, (7.4, 5))), ""),
    ],
)
def test_what_may_be_meant_otherwise_is_named(tables, doubt):
    assert "\n".join(study_of(*tables).doubts()) == doubt


def test_loads_and_lengths_of_a_spreadsheet_may_be_in_other_units(tmp_path):
    head = "name;finger;wedge_angle_deg;Load (mN);semi_major_um;semi_minor_mm;ellipse_mm_std"
    cells = "b;index;45;300;5301;4,12;0,1"
    path = beside(tmp_path, head, cells, "c;index;45;1500,5;5301;4,12;0,1")
    found = read_study(path)
    assert [row.load_N for row in found.observations] == [0.3, 1.5005]
    assert found.observations[0].ellipse_mm.semi_major == 5.301
    (doubt,) = found.doubts()
    assert doubt == "b and c: the same ellipse_mm to the last digit: is a press entered twice?"
    sheet = Sheet("rows.csv", path.with_name("rows.csv").read_bytes())
    sheet.change("b", {"load_N": 0.2504})
    assert "b;index;45;250,4;5301" in sheet.text()
    with pytest.raises(ManifestError, match=r"rows.csv, line 2: load_N.*'much'"):
        read_study(beside(tmp_path, head, cells.replace("300", "much")))


def test_a_workbook_of_observations_is_refused_since_its_rows_are_edited(tmp_path):
    (tmp_path / "rows.xlsx").write_bytes(workbook(sheet_xml([HEADER.split(","), CELLS.split(",")])))
    with pytest.raises(ManifestError, match="rows.xlsx: is no CSV, the rows of which can be edited: save it"):
        read_study(write(tmp_path, BESIDE.replace("rows.csv", "rows.xlsx")))


def test_spreadsheets_may_be_untidy(tmp_path):
    last = 'c,index,45,2,,,,rows.csv,500,"250, 200"'
    path = beside(tmp_path, f"{HEADER},file,ppi,seed_px,,", f"{CELLS},,,,,", ",,,,,,,,,,", last)
    study = read_study(write(path.parent, "\ufeff" + BESIDE))
    assert [row.name for row in study.observations] == ["b", "c"]
    assert study.observations[1].seed_px == [250, 200]
    assert study.observations[1].scale == ResolutionScale(ppi=500)


@pytest.mark.parametrize("make", [lambda p: None, lambda p: p.write_bytes(b"\xff\xff")])
def test_manifests_that_cannot_be_read(tmp_path, make):
    path = tmp_path / "study.toml"
    make(path)
    with pytest.raises(ManifestError, match="study.toml: (no such file|cannot be read)"):
        read_study(path)


LINE = {"line": [[0, 0], [0, 9]], "length_mm": 1, "ends_px_std": 1}


@pytest.mark.parametrize(
    ("stated", "scale", "exact"),
    [
        ({}, "reader", ["the load", "Poisson's ratio", "the scale “reader”"]),
        (
            {"wedge_angle_deg_std": 0, "roll_angle_deg_std": 0, "load_relative_std": 0.1},
            {"ppi": 500},
            ["the wedge angle", "the roll angle", "Poisson's ratio", "scales of single pictures"],
        ),
        ({"load_relative_std": 0.1, "poisson_ratio_std": 0.02}, LINE, []),
        ({"load_relative_std": 0.1}, {"ppi": 500, "relative_std": 0.01}, ["Poisson's ratio"]),
    ],
)
def test_says_what_is_taken_as_exact(stated, scale, exact):
    def taken(*more: Table, **pad: float) -> list[str]:
        tables = finger(**pad), picture("o", "a.png", scale=scale), *more
        study = study_of(*tables, uncertainty=stated, scales={"reader": {"ppi": 500}})
        return list(study.taken_as_exact())

    thick = {"effective_thickness_mm": 8}
    assert taken() == exact == taken(**thick, effective_thickness_mm_std=1.5)
    assert set(taken(**thick)) == {*exact, "the effective thickness of f"}
    assert set(taken(curve(loading_radius_mm=20.5))) == {*exact, "R_g of f at 30°"}


@pytest.mark.parametrize(
    ("stated", "assumed"),
    [
        ({}, ["the wedge angle to ± 3°", "the roll angle to ± 3°"]),
        ({"wedge_angle_deg_std": 0, "roll_angle_deg_std": 1}, []),
    ],
)
def test_angles_without_an_uncertainty_are_assumed_known_to_3_degrees(stated, assumed):
    assert study_of(finger(), uncertainty=stated).assumed() == assumed


# Nothing outside the study folder is read: a link that leads out is refused, whatever names it

COIN = {"coin": "coin.png", "diameter_mm": 23.25}
PALMAR = {"face": "palmar", "file": "palmar.jpg", "scale": "reader"}
FILES = (
    "coin.png", "palmar.jpg", "distal.csv", "a.png", "background.png", "euro.png", "frames/f1.png",
    "frames/f2.png", "force.csv", "times.csv", "curve.csv", "more.csv",
)  # fmt: skip


@pytest.fixture
def study(tmp_path) -> Path:
    """A study, and a folder `outside` beside it that holds the same files."""
    folder = tmp_path / "study"
    (folder / "frames").mkdir(parents=True)
    for name in FILES:
        (folder / name).write_bytes(b"a file")
    header = "name,finger,wedge_angle_deg,load_N,semi_major_mm,semi_minor_mm,ellipse_mm_std"
    (folder / "more.csv").write_text(f"{header}\nb,index,30,2,7,5,0.1\n")
    shutil.copytree(folder, tmp_path / "outside")
    write_study(
        folder,
        finger("index", photographs=[PALMAR, {"face": "distal", "outline": "distal.csv"}]),
        picture("a", "a.png", finger="index", background="background.png", scale=COIN | {"coin": "euro.png"}),
        sequence("p", "frames", finger="index", force="force.csv", times="times.csv", scale={"ppi": 500}),
        curve(finger="index", file="curve.csv"),
        observations_csv="more.csv",
        scales={"reader": COIN},
    )
    return folder


@pytest.mark.parametrize("file", FILES)
def test_a_link_out_of_the_study_is_refused_by_name(study, file):
    (study / file).unlink()
    (study / file).symlink_to(study.parent / "outside" / file)
    with pytest.raises(ManifestError, match=f"'{file}'.* leaves the study folder; copy the file into it"):
        read_study(study / "study.toml")


@pytest.mark.parametrize("name", [*(file for file in FILES if "/" not in file), "frames"])
def test_a_file_behind_a_linked_folder_is_refused_by_name(study, name):
    (study / "more").symlink_to(study.parent / "outside")
    text = (study / "study.toml").read_text()
    (study / "study.toml").write_text(text.replace(f'"{name}"', f'"more/{name}"'))
    with pytest.raises(ManifestError, match=f"'more/{name}' leaves the study folder; copy the file into it"):
        read_study(study / "study.toml")


# What `fingerpad init` writes: a manifest with its schema, and an example that runs


def test_the_template_overwrites_nothing(tmp_path):
    (tmp_path / "study.toml").write_text("title = 'mine'")
    with pytest.raises(ManifestError, match=r"study\.toml: is there already"):
        write_template(tmp_path)
    with pytest.raises(ManifestError, match="the folder is not empty"):
        write_example(tmp_path)
    assert (tmp_path / "study.toml").read_text() == "title = 'mine'"
    assert [path.name for path in tmp_path.iterdir()] == ["study.toml"]


def test_every_commented_line_of_the_template_is_valid_too(tmp_path):
    path = write_template(tmp_path / "new")
    lines = path.read_text(encoding="utf-8").splitlines()
    opened = [
        line[2:] if re.match(r"# (\[|\]|    \{|(?!observations_csv)\w+ = )", line) else line for line in lines
    ]
    path.write_text("\n".join(opened), encoding="utf-8")
    for name in re.findall(r'"([a-z]+/[\w.]+)"', path.read_text(encoding="utf-8")):
        (path.parent / name).parent.mkdir(exist_ok=True)
        (path.parent / name).touch()
    study = read_study(path)
    assert (len(study.fingers), len(study.observations), len(study.curves)) == (3, 2, 2)
    assert study.observations[1].seed_px == [250, 200]
    assert list(study.scales) == ["reader", "camera", "ruler", "coin", "rim", "board"]
    assert study.sequences[0].contact_load_N == 0.02


def test_the_manifest_names_its_schema(tmp_path):
    manifest = write_template(tmp_path / "new")
    assert manifest.read_text(encoding="utf-8").startswith(f"#:schema ./{SCHEMA_NAME}\n")
    schema = json.loads(manifest.with_name(SCHEMA_NAME).read_text(encoding="utf-8"))
    assert set(schema["properties"]) == set(Study.model_fields)


def test_every_key_of_the_schema_has_a_description():
    schema = json.loads(manifest_schema())
    for table in (schema, *schema["$defs"].values()):
        assert all("description" in value for value in table["properties"].values()), table["title"]
