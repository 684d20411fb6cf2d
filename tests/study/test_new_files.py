"""What names of files say, and what they leave open."""

import pytest

from fingerpad.study.imports.names import read_file_name


@pytest.mark.parametrize(
    ("name", "load"),
    [
        ("a_0.5N.png", 0.5),
        ("1,5N.png", 1.5),
        ("500mN.png", 0.5),
        ("right_index_30deg_2N.tif", 2.0),
        ("30deg-2 N.tif", 2.0),
        ("left thumb 12N_b.png", 12.0),
        ("45_2N.png", 2.0),
        ("0-5N.png", None),
        ("1_5N.png", None),
        ("2Nm.png", None),
        ("N2.png", None),
        ("IMG_0031.jpg", None),
        ("2n.png", None),
    ],
)
def test_load(name: str, load: float | None) -> None:
    assert read_file_name(name, "picture").get("load_N") == load


@pytest.mark.parametrize(
    ("name", "angle"),
    [
        ("wedge45.png", 45.0),
        ("wedge_angle-30_1N.png", 30.0),
        ("45deg.png", 45.0),
        ("30°_2N.png", 30.0),
        ("22.5deg.png", 22.5),
        ("22,5 deg.png", 22.5),
        ("theta30.png", 30.0),
        ("350deg.png", None),
        ("2-5deg.png", None),
        ("IMG_0045.jpg", None),
    ],
)
def test_wedge_angle(name: str, angle: float | None) -> None:
    assert read_file_name(name, "picture").get("wedge_angle_deg") == angle


@pytest.mark.parametrize(
    ("name", "finger"),
    [
        ("S01_LI.png", "S01_left_index"),
        ("P3 RT 2N.png", "P3_right_thumb"),
        ("subject12-right-middle_1N.png", "subject12_right_middle"),
        ("left_index_palmar.png", "left_index"),
        ("LeftIndex30deg.png", "left_index"),
        ("index-left-1N.png", "left_index"),
        ("Right Pinky.png", "right_little"),
        ("L_index.png", "left_index"),
        ("my_pad_2N.png", "my_pad"),
        ("IMG_0031.jpg", None),
        ("left.png", None),
        ("MRI.png", None),
        ("a_l_i.png", None),
        ("thumbnail_left.png", None),
    ],
)
def test_finger(name: str, finger: str | None) -> None:
    assert read_file_name(name, "picture", fingers=["my_pad", "pad"]).get("finger") == finger


@pytest.mark.parametrize(
    ("name", "kind", "role", "face"),
    [
        ("a.png", "picture", "observation", None),
        ("a_palmar.png", "picture", "photograph", "palmar"),
        ("Ulnar 2.jpg", "picture", "photograph", "ulnar"),
        ("ruler.png", "picture", None, None),
        ("2_cent.jpg", "picture", None, None),
        ("center.png", "picture", "observation", None),
        ("scaled_2N.png", "picture", "observation", None),
        ("press.avi", "sequence", "sequence", None),
        ("distal.csv", "table", "outline", "distal"),
        ("loading.csv", "table", "curve", None),
        ("force.csv", "table", None, None),
        ("notes.txt", "other", None, None),
    ],
)
def test_role(name: str, kind: str, role: str | None, face: str | None) -> None:
    found = read_file_name(f"folder_2N/{name}", kind)
    assert (found.get("role"), found.get("face"), "load_N" not in found) == (role, face, "2N" not in name)
