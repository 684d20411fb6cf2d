"""Rows: each stated uncertainty reaches the numbers it must, and directions and labels are kept."""

from pathlib import Path

import pytest
from PIL import Image

from fingerpad.simulate import render_coin, render_contact_image
from fingerpad.study.engine.store import STORE_NAME, Store
from fingerpad.study.pipeline import run_study
from fingerpad.study.results.table import first_record, records

MANIFEST = """
title = "T"
{top}
[uncertainty]
wedge_angle_deg_std = {wedge_std}
roll_angle_deg_std = 0
load_relative_std = {load_std}
{more}
[[fingers]]
name = "f"
semi_axes_mm = {{ palmar = 7.9, distal = 13.8, radial_ulnar = 11.8 }}
semi_axes_mm_std = {{ palmar = 1e-9, distal = 1e-9, radial_ulnar = 1e-9 }}
{finger}
[[observations]]
name = "x"
finger = "f"
wedge_angle_deg = 30
load_N = {load}
{row}
"""
ELLIPSE = "ellipse_mm = { semi_major = 7.4, semi_minor = 5.0, std = 1e-9, long_axis = 'along' }"
IMAGE = "file = 'print.png'\nscale = { ppi = 500 }\n"


def row_of(
    folder: Path,
    *,
    row: str = ELLIPSE,
    finger: str = "",
    wedge_std=0.0,
    load_std=0.0,
    top: str = "",
    more: str = "",
    load: float = 2,
):
    (folder / "study.toml").write_text(
        MANIFEST.format(
            row=row, finger=finger, wedge_std=wedge_std, load_std=load_std, top=top, more=more, load=load
        )
    )
    (row,) = records(run_study(folder / "study.toml", folder / "out").rows)
    assert row["status"] == "measured"
    return row


@pytest.fixture
def picture(tmp_path: Path) -> Path:
    truth = render_contact_image(semi_major=8.0, semi_minor=6.0, seed=2)
    Image.fromarray(truth.pixels).save(tmp_path / "print.png")
    return tmp_path


def test_one_picture_at_two_loads_is_noted(picture: Path) -> None:
    row_of(picture, row=IMAGE)
    text = (picture / "study.toml").read_text()
    again = text[text.index("[[observations]]") :].replace("load_N = 2", "load_N = 3").replace('"x"', '"y"')
    (picture / "study.toml").write_text(text + again)
    notes = run_study(picture / "study.toml", picture / "out").notes
    assert notes == ("x and y: print.png at different loads: is one another contact's?",)


def test_wedge_angle(tmp_path: Path) -> None:
    # dR_0g/dθ by the reference numbers: (9.982357 − 13.607666) mm over 15°, steeper than the mean at 30°.
    row = row_of(tmp_path, wedge_std=1.0)
    assert 0.2 < row["mean_curvature_radius_mm_std"] < 0.35
    assert row["radius_from_indentation_mm_fixed_geometry_std"] < 1e-6
    assert row_of(tmp_path)["mean_curvature_radius_mm_std"] < 1e-6


def test_load(tmp_path: Path) -> None:
    row = row_of(tmp_path, load_std=0.03)
    for name in ("reduced_modulus_kpa", "youngs_modulus_kpa", "mean_pressure_kpa"):
        assert row[f"{name}_std"] / row[name] == pytest.approx(0.03, rel=1e-6)
    assert row["indentation_mm_std"] < 1e-6


def test_poisson_ratio_std(tmp_path: Path) -> None:
    row = row_of(tmp_path, more="poisson_ratio_std = 0.02")
    # E = E*(1 − ν²): dE/E = 2ν dν/(1 − ν²) at ν = ½.
    assert row["youngs_modulus_kpa_std"] / row["youngs_modulus_kpa"] == pytest.approx(0.02 / 0.75, rel=1e-3)
    assert row["reduced_modulus_kpa_std"] < 1e-6


def test_monte_carlo_by_one_key(tmp_path: Path) -> None:
    first = row_of(tmp_path, wedge_std=1.0, load_std=0.03)
    drawn = row_of(tmp_path, wedge_std=1.0, load_std=0.03, more='method = "monte_carlo"')
    for name in ("mean_curvature_radius_mm", "radius_from_indentation_mm", "youngs_modulus_kpa"):
        assert drawn[name] == first[name]
        assert drawn[f"{name}_std"] != first[f"{name}_std"]
        assert drawn[f"{name}_std"] == pytest.approx(first[f"{name}_std"], rel=0.03)


def test_scale_moves_both_axes_together(picture: Path) -> None:
    exact = row_of(picture, row=IMAGE)
    row = row_of(picture, row=IMAGE.replace("500", "500, relative_std = 0.05"))
    # Area and pressure go with the square of the scale; the axis ratio and the corrected radius not at all.
    assert row["mean_pressure_kpa_std"] / row["mean_pressure_kpa"] == pytest.approx(0.1, rel=0.03)
    name = "radius_from_indentation_mm_fixed_geometry_std"
    assert row[name] == pytest.approx(exact[name], rel=0.05)


def test_a_named_scale_is_kept_on_the_row_and_one_of_its_own_is_not(picture: Path) -> None:
    named = row_of(picture, row='file = "print.png"\nscale = "s"\n[scales.s]\nppi = 500\nrelative_std = 0.05')
    alone = row_of(picture, row=IMAGE.replace("500", "500, relative_std = 0.05"))
    assert (named["scale"], alone["scale"]) == ("s", None)
    assert named["mm_per_px_std"] == pytest.approx(0.05 * named["mm_per_px"])
    assert {**named, "scale": None} == alone


def test_four_ways_to_say_a_scale(picture: Path) -> None:
    known = row_of(picture, row=IMAGE.replace("ppi = 500", "mm_per_px = 0.05, relative_std = 0.02"))
    line = "line = [[10, 20], [10, 220]], length_mm = 10, length_mm_std = 0.2"
    ruler = row_of(picture, row=IMAGE.replace("ppi = 500", line))
    assert ruler["semi_major_mm_std"] == pytest.approx(known["semi_major_mm_std"])
    coin = render_coin(radius=120.0, shadow=0.0)
    Image.fromarray(coin.pixels).save(picture / "coin.png")
    way = 'coin = "coin.png", diameter_mm = 12, diameter_mm_std = 0.24'
    coined = row_of(picture, row=IMAGE.replace("ppi = 500", way))
    assert coined["semi_major_mm"] == pytest.approx(known["semi_major_mm"], rel=2e-3)
    assert coined["semi_major_mm_std"] == pytest.approx(known["semi_major_mm_std"], rel=0.05)
    assert coined["mm_per_px_std"] > 0.02 * coined["mm_per_px"]


def test_a_coin_in_many_tables_is_measured_once_in_a_run(picture: Path) -> None:
    Image.fromarray(render_coin(radius=120.0, shadow=0.0).pixels).save(picture / "coin.png")
    coin = 'scale = { coin = "coin.png", diameter_mm = 12 }'
    contacts = "".join(
        f'[[observations]]\nname = "{name}"\nfinger = "f"\nwedge_angle_deg = 30\nload_N = 2\n'
        f'file = "print.png"\n{coin}\n'
        for name in "yz"
    )
    text = MANIFEST.format(
        row=f'file = "print.png"\n{coin}\n{contacts}',
        finger="",
        wedge_std=0,
        load_std=0,
        top="",
        more="",
        load=2,
    )
    (picture / "study.toml").write_text(text)
    rows = records(run_study(picture / "study.toml", picture / "out").rows)
    assert len({row["mm_per_px"] for row in rows}) == 1
    with Store.reading(picture / "out" / STORE_NAME) as store:
        tasks = [name for name in store.statuses() if not name.startswith("/check")]
    assert len(tasks) == 4
    assert sum(name.startswith("/scale") for name in tasks) == 1


def test_a_coin_that_is_not_there_costs_its_rows(picture: Path) -> None:
    shared = 'file = "print.png"\nscale = "euro"\n[scales.euro]\ncoin = "print.png"\ndiameter_mm = 23.25'
    (picture / "study.toml").write_text(
        MANIFEST.format(row=shared, finger="", wedge_std=0.0, load_std=0.0, top="", more="", load=2)
    )
    result = run_study(picture / "study.toml", picture / "out")
    assert first_record(result.rows)["reason"].startswith("scale euro: print.png: no coin found")
    assert [failure.partition(": ")[0] for failure in result.failures] == ["x"]


@pytest.mark.parametrize(("turn", "side"), [(0, "along"), (30, "along"), (90, "across"), (-80, "across")])
def test_long_axis_is_told_from_the_finger_not_from_the_picture(
    picture: Path, turn: float, side: str
) -> None:
    row = row_of(picture, row=IMAGE + f"finger_axis_deg = {turn}")
    assert row["long_axis"] == side
    assert (row["orientation_deg"] + turn + 90) % 180 - 90 == pytest.approx(0, abs=1.5)


@pytest.mark.parametrize("finger", ["", "synthetic = true"])
@pytest.mark.parametrize("row", ["", "\nsynthetic = true"])
def test_synthetic_if_anything_is(tmp_path: Path, finger: str, row: str) -> None:
    assert row_of(tmp_path, finger=finger, row=ELLIPSE + row)["synthetic"] == bool(finger or row)


@pytest.mark.parametrize(
    ("keys", "who"),
    [
        ("", "automatic"),
        ("threshold = 60", "corrected"),
        ("mask_px = [[5, 5], [5, 300], [420, 300], [420, 5]]", "corrected"),
        ("region_of_interest_px = [5, 5, 380, 300]", "corrected"),
        ("seed_px = [200, 150]", "corrected"),
    ],
)
def test_says_who_measured(picture: Path, keys: str, who: str) -> None:
    row = row_of(picture, row=IMAGE + keys)
    assert row["measured_by"] == who
    assert row["semi_major_mm"] == pytest.approx(8.0, rel=0.03)
    assert row_of(picture)["measured_by"] == "manual"


def test_indentation_over_thickness(tmp_path: Path) -> None:
    thin = row_of(tmp_path, finger="pad_thickness_mm = 6")
    assert thin["indentation_over_thickness"] == pytest.approx(thin["indentation_mm"] / 6)


@pytest.mark.parametrize(("load", "notes"), [(0.01, True), (0.03, False), (90, False), (200, True)])
def test_a_modulus_is_plausible_from_1_to_5000_kpa(tmp_path: Path, load: float, notes: bool) -> None:
    row = row_of(tmp_path, load=load)
    assert (not 1 < row["youngs_modulus_kpa"] < 5000) == notes
    assert ("implausible_modulus" in row["range_notes"]) == notes
