"""What new files are, by content and name: a small seeded table of confusion."""

from collections import Counter
from pathlib import Path

import cv2
import numpy as np
import pytest
from benchmarks.claims.photographs import random_finger
from PIL import Image
from tests.image.ruler_scenes import KINDS, ruler_scene

from fingerpad.image import guess_subject
from fingerpad.simulate import render_coin, render_contact_image, render_finger
from fingerpad.study.imports.identify import identify_file

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "examples" / "dzidek2017" / "synthetic"
REAL = ROOT.parent / "shared" / "data"


def test_example_files_under_names_that_say_nothing(tmp_path) -> None:
    expected = {
        "*.png": "observation",
        "*.jpg": "photograph",
        "*.tif": "sequence",
        "curve*.csv": "curve",
        "*force.csv": "force",
    }
    for pattern, content in expected.items():
        for number, path in enumerate(sorted(EXAMPLE.glob(pattern))):
            plain = tmp_path / f"IMG_{number:04}{path.suffix}"
            plain.write_bytes(path.read_bytes())
            found = identify_file(plain)
            assert (found.uses[0], found.sure) == (content, True), path.name
            if content == "photograph":
                assert found.face == path.stem.split("_")[1]


def test_subjects_of_pictures() -> None:
    """Nothing is taken surely for what it is not; most are recognised."""
    pictures = [
        ("contact", render_contact_image(semi_major=3.2, semi_minor=2.9, seed=1).pixels),
        *(("finger", random_finger(seed, 60).pixels) for seed in range(2)),
        ("coin", render_coin(radius=100, seed=2).pixels),
        *(("ruler", ruler_scene(kind, 3, side=480)) for kind in KINDS[:3]),
    ]
    recognised: Counter[str] = Counter()
    for subject, pixels in pictures:
        (best, share), *_ = guess_subject(pixels).subjects.items()
        assert best == subject or share < 0.9, (subject, best, share)
        recognised[subject] += best == subject
    assert recognised == {"contact": 1, "finger": 2, "coin": 1, "ruler": recognised["ruler"]}
    assert recognised["ruler"] >= 2


@pytest.mark.parametrize("tip", ["up", "left"])
def test_a_side_is_told_whichever_way_the_tip_points(tip: str) -> None:
    guess = guess_subject(render_finger("radial", tip=tip, mm_per_px=0.08, seed=2).pixels)
    assert next(iter(guess.subjects)) == "finger"
    assert guess.faces["radial"] == guess.faces["ulnar"] > guess.faces["palmar"]


def test_shares_sum_to_one_and_fall() -> None:
    guess = guess_subject(np.full((80, 90), 200, np.uint8))
    shares = list(guess.subjects.values())
    assert sum(shares) == pytest.approx(1)
    assert shares == sorted(shares, reverse=True)
    assert shares[0] < 0.9  # blank paper is asked


def test_real_prints_are_contact_images() -> None:
    paths = sorted(REAL.glob("nist_nbis_livescan_slaps/*index*.png")) + sorted(REAL.glob("nist_minex_ink/a*"))
    if not paths:
        pytest.skip("no real prints on this machine")
    for path in paths:
        (best, share), *_ = guess_subject(path).subjects.items()
        assert (best == "contact" and share >= 0.9) or (path.name == "a999_01p.pgm" and share < 0.9), path


def test_a_name_says_more_than_pixels_that_are_in_doubt(tmp_path) -> None:
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
        ("time_s,force_N\n0,0\n", "force"),
        ("Time [s]\tLoad[mN]\n0\t0\n", "force"),
        ("X [µm];Y [µm]\n0;0\n", "outline"),
        ("x_mm,y_mm\n0,0\n", "outline"),
        ("file,load\nIMG_1,2\n", "sheet"),
        ("a,b\n1,2\n", ""),
        ("", ""),
    ],
)
def test_tables_by_their_headers(tmp_path, text: str, content: str) -> None:
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
def test_force_and_displacement_belong_to_a_sequence_if_the_name_says_force(
    tmp_path, name, content, is_sure
) -> None:
    (tmp_path / name).write_text("time_s,force_N,displacement_mm\n0,0,0\n")
    found = identify_file(tmp_path / name)
    assert (found.uses[0], found.sure) == (content, is_sure)
