"""The manifest: what is accepted, and what is said of each fault before any work."""

from pathlib import Path
from typing import Any

import pytest

from fingerpad.exceptions import ManifestError
from fingerpad.study.manifest import read_study
from fingerpad.study.template import write_template

FINGER = """
[[fingers]]
name = "index"
semi_axes_mm = { palmar = 7.9, distal = 13.8, radial_ulnar = 11.8 }
semi_axes_std_mm = { palmar = 0.1, distal = 0.1, radial_ulnar = 0.1 }
"""
ROW = """
[[observations]]
name = "a"
finger = "index"
wedge_angle_deg = 30
load_N = 2
ellipse_mm = { semi_major = 7.4, semi_minor = 5.0, std = 0.1 }
"""
VALID = 'title = "T"\n' + FINGER + ROW


def write(folder: Path, text: str) -> Path:
    path = folder / "study.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_template_is_a_valid_study(tmp_path: Path) -> None:
    study = read_study(write_template(tmp_path / "new"))
    assert study.observations[0].ellipse_mm is not None


def test_template_overwrites_nothing(tmp_path: Path) -> None:
    write(tmp_path, "title = 'mine'")
    with pytest.raises(ManifestError, match="the folder is not empty"):
        write_template(tmp_path)
    assert (tmp_path / "study.toml").read_text() == "title = 'mine'"


def test_every_commented_line_of_the_template_is_valid_too(tmp_path: Path) -> None:
    path = write_template(tmp_path / "new")
    lines = path.read_text(encoding="utf-8").splitlines()
    keys = (
        "[",
        "]",
        "    {",
        "name",
        "finger",
        "wedge",
        "load",
        "image",
        "ppi",
        "scale",
        "background",
        "seed",
    )
    keys += ("dark", "file", "columns", "photographs", "pad_thickness", "effective")
    opened = [line[2:] if line.startswith("# ") and line[2:].startswith(keys) else line for line in lines]
    path.write_text("\n".join(opened), encoding="utf-8")
    for name in ("images/index_30deg_1N.png", "images/background.png", "curves/index_30deg.csv"):
        (path.parent / name).parent.mkdir(exist_ok=True)
        (path.parent / name).touch()
    (path.parent / "outlines").mkdir()
    for face in ("palmar", "distal", "radial"):
        (path.parent / f"outlines/right_index_{face}.csv").touch()
    study = read_study(path)
    assert (len(study.fingers), len(study.observations), len(study.curves)) == (2, 2, 2)
    assert study.observations[1].seed_px == (250, 200)


def test_rows_may_come_from_a_spreadsheet(tmp_path: Path) -> None:
    (tmp_path / "rows.csv").write_text(
        "name,finger,wedge_angle_deg,load_N,semi_major_mm,semi_minor_mm,ellipse_std_mm,synthetic\n"
        "b,index,45,0.5,5.3,4.2,0.1,true\n"
        "c,index,45,1,5.3,4.2,0.1,\n",
        encoding="utf-8-sig",
    )
    study = read_study(write(tmp_path, 'title = "T"\nobservations_csv = "rows.csv"\n' + FINGER + ROW))
    assert [row.name for row in study.observations] == ["a", "b", "c"]
    assert [row.synthetic for row in study.observations] == [False, True, False]
    assert study.observations[1].ellipse_mm.semi_minor == 4.2


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("title = ", "study.toml: not valid TOML: Invalid value"),
        (FINGER + ROW, "study.toml: title: required, but missing"),
        ('title = "T"', "study.toml: fingers: required, but missing"),
        ('title = "T"\nfingers = []', "fingers: List should have at least 1 item"),
        (VALID + "loadN = 3", "observations.0..loadN: unknown key; did you mean 'load_N'"),
        (VALID + "zzz = 3", "observations.0..zzz: unknown key$"),
        (VALID.replace("= 2\n", "= -2\n"), "observations.0..load_N: expected greater than 0, found -2"),
        (VALID.replace("= 2\n", "= 0\n"), "load_N: expected greater than 0, found 0"),
        (VALID.replace("= 2\n", "= nan\n"), "load_N: expected a finite number, found nan"),
        (VALID.replace("= 2\n", "= inf\n"), "load_N: expected a finite number, found inf"),
        (VALID.replace("= 2\n", '= "two"\n'), "load_N: expected a valid number.*found 'two'"),
        (
            VALID.replace("deg = 30", "deg = 91"),
            "wedge_angle_deg: expected less than or equal to 90, found 91",
        ),
        (VALID.replace("deg = 30", "deg = -1"), "wedge_angle_deg: expected greater than or equal to 0"),
        (VALID.replace("deg = 30", "deg = nan"), "wedge_angle_deg: expected .*found nan"),
        (VALID.replace("7.9", "0.0"), "fingers.0..semi_axes_mm.palmar: expected greater than 0, found 0"),
        (VALID.replace("7.9", "inf"), "semi_axes_mm.palmar: expected a finite number, found inf"),
        (VALID.replace("semi_minor = 5.0", "semi_minor = 9.0"), "ellipse_mm: semi_minor 9 must not exceed"),
        (VALID.replace('finger = "index"', 'finger = "thumb"'), "no finger is named 'thumb'; there is index"),
        (VALID.replace('name = "a"', 'name = "../a"'), "observations.0..name: String should match pattern"),
        (VALID + ROW, "observations: the name 'a' is given 2 times"),
        (VALID.replace("semi_axes_std_mm", "# "), "semi_axes_mm and semi_axes_std_mm belong together"),
        (VALID + 'image = "x.png"\nppi = 500', "give either image or ellipse_mm, one of the two"),
        (VALID.replace("ellipse_mm =", "# "), "give either image or ellipse_mm"),
        (VALID.replace("ellipse_mm =", 'image = "x.png" #'), "an image needs its scale"),
        (
            VALID.replace("ellipse_mm =", 'image = "no.png"\nppi = 500 #'),
            "image: no file 'no.png' in the study",
        ),
        (
            VALID.replace("ellipse_mm =", 'image = "../x.png"\nppi = 500 #'),
            "'../x.png' leaves the study folder",
        ),
        (VALID.replace("ellipse_mm =", 'image = "/etc/passwd"\nppi = 500 #'), "leaves the study folder"),
        ('title = "T"\nobservations_csv = "no.csv"' + FINGER, "observations_csv: no file 'no.csv'"),
        ('title = "T"\nobservations_csv = "../no.csv"' + FINGER, "leaves the study folder"),
    ],
)
def test_names_file_key_and_what_was_expected(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(ManifestError, match=f"(?m){message}") as caught:
        read_study(write(tmp_path, text))
    assert all(line.startswith(("study.toml: ", str(tmp_path))) for line in str(caught.value).splitlines())


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("b,index,45,x,5,4,.1", "rows.csv, line 2: load_N: expected a valid number.*found 'x'"),
        ("b,index,45,2,5,4", "rows.csv, line 2: ellipse_mm.std: required, but missing"),
        ("b,index,45,2,5,4,.1,extra", "rows.csv, line 2: more cells than the header has columns"),
    ],
)
def test_names_the_line_of_a_spreadsheet(tmp_path: Path, line: str, message: str) -> None:
    header = "name,finger,wedge_angle_deg,load_N,semi_major_mm,semi_minor_mm,ellipse_std_mm"
    (tmp_path / "rows.csv").write_text(f"{header}\n{line}\n")
    with pytest.raises(ManifestError, match=message):
        read_study(write(tmp_path, 'title = "T"\nobservations_csv = "rows.csv"' + FINGER))


@pytest.mark.parametrize("make", [lambda p: None, lambda p: p.mkdir(), lambda p: p.write_bytes(b"\xff\xff")])
def test_manifests_that_cannot_be_read(tmp_path: Path, make: Any) -> None:
    path = tmp_path / "study.toml"
    make(path)
    with pytest.raises(ManifestError, match="study.toml: (no such file|cannot be read)"):
        read_study(path)


def test_says_every_fault_at_once(tmp_path: Path) -> None:
    text = VALID.replace("= 2\n", "= -2\n").replace("7.9", "-1")
    with pytest.raises(ManifestError) as caught:
        read_study(write(tmp_path, text))
    assert len(str(caught.value).splitlines()) == 2
