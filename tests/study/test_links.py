"""Nothing outside the study folder is read: a link that leads out is refused, whatever names it."""

import shutil
from pathlib import Path

import pytest
from tests.studies import curve, finger, picture, sequence, write_study

from fingerpad.exceptions import ManifestError
from fingerpad.study.manifest.load import read_study

COIN = {"coin": "coin.png", "diameter_mm": 23.25}
PALMAR = {"face": "palmar", "file": "palmar.jpg", "scale": "reader"}
FILES = (
    "coin.png", "palmar.jpg", "distal.csv", "a.png", "background.png", "euro.png", "frames/f1.png",
    "frames/f2.png", "force.csv", "times.csv", "curve.csv", "more.csv",
)  # fmt: skip


@pytest.fixture
def study(tmp_path: Path) -> Path:
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
def test_a_link_out_of_the_study_is_refused_by_name(study: Path, file: str) -> None:
    (study / file).unlink()
    (study / file).symlink_to(study.parent / "outside" / file)
    with pytest.raises(ManifestError, match=f"'{file}'.* leaves the study folder; copy the file into it"):
        read_study(study / "study.toml")


@pytest.mark.parametrize("name", [*(file for file in FILES if "/" not in file), "frames"])
def test_a_file_behind_a_linked_folder_is_refused_by_name(study: Path, name: str) -> None:
    (study / "more").symlink_to(study.parent / "outside")
    text = (study / "study.toml").read_text()
    (study / "study.toml").write_text(text.replace(f'"{name}"', f'"more/{name}"'))
    with pytest.raises(ManifestError, match=f"'more/{name}' leaves the study folder; copy the file into it"):
        read_study(study / "study.toml")


def test_links_within_the_study_are_followed(study: Path) -> None:
    (study / ".data").mkdir()
    for name in ("a.png", "frames", "frames/f2.png"):
        stored = study / ".data" / name.replace("/", "-")
        (study / name).rename(stored)
        (study / name).symlink_to(stored)
    assert read_study(study / "study.toml").sequences[0].file == "frames"


def test_a_folder_that_nothing_names_may_link_anywhere(study: Path) -> None:
    (study / "notes").symlink_to(study.parent / "outside")
    assert read_study(study / "study.toml").sequences
    assert (study / "notes").is_dir()
