"""Rows: each stated uncertainty reaches the numbers it must, and directions and labels are kept."""

import shutil
from pathlib import Path
from typing import Any

import pytest
from PIL import Image
from tests.studies import Table, contact, correct, finger, picture, run

from fingerpad.image.read import read_resolution
from fingerpad.simulate import render_coin, render_contact_image
from fingerpad.study.engine.store import STORE_NAME, Store
from fingerpad.study.results.table import Row, record_at, records

EXACT = {"wedge_angle_deg_std": 0, "roll_angle_deg_std": 0, "load_relative_std": 0}


def given(**keys: Any) -> Table:
    return contact(std=1e-9, **keys)


def shown(name: str = "x", load: float = 2, **keys: Any) -> Table:
    return picture(name, keys.pop("file", "print.png"), load, **{"scale": {"ppi": 500}, **keys})


def row_of(folder: Path, pressed: Table | None = None, *, pad: Table | None = None, **stated: Any) -> Row:
    """Return the row of one contact; all is exact but for what is stated."""
    tables = pad or finger(std=1e-9), pressed or given()
    scales = {"s": {"ppi": 500, "relative_std": 0.05}}
    (row,) = records(run(folder, *tables, uncertainty={**EXACT, **stated}, scales=scales).rows)
    assert row["status"] == "measured"
    return row


@pytest.fixture(scope="module")
def drawn(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("drawn") / "print.png"
    Image.fromarray(render_contact_image(semi_major=8.0, semi_minor=6.0, seed=2).pixels).save(path)
    return path


@pytest.fixture
def folder(drawn, tmp_path) -> Path:
    """Return a folder with a contact image."""
    shutil.copy(drawn, tmp_path)
    return tmp_path


def test_one_picture_under_two_names_or_at_two_loads_counts_once_or_not_at_all(folder):
    shutil.copy(folder / "print.png", folder / "copy.png")
    copied = shown("y", file="copy.png")
    at_two = run(folder, finger(), shown(), shown("y", 3))
    assert at_two.notes == (
        "x and y are one picture, of different presses, none of which counts: does it show another contact?",
    )
    twice = run(folder, finger(), shown(), copied)
    assert twice.notes[0].startswith("x and y are one picture, which counts once")
    part = run(folder, finger(), shown(), shown("y", file="copy.png", region_of_interest_px=[0, 0, 300, 300]))
    assert part.notes == ()
    repeated = [
        ["repeated_picture" in flags for flags in result.rows["excluding_flags"]]
        for result in (at_two, twice, part)
    ]
    assert repeated == [[True, True], [False, True], [False, False]]
    assert list(twice.rows["pooled"]) == [True, False]
    correct(folder, "x", {"rejected": "the wrong file"})
    assert list(run(folder, finger(), shown(), shown("y", 3)).rows["pooled"]) == [False, True]


def test_a_file_that_states_another_resolution_than_its_scale_is_noted(folder):
    drawn, stated = Image.open(folder / "print.png"), {"ppi": 500}
    for file, ppi in {"a.png": 1000, "b.tif": 1000, "c.bmp": 1000, "d.png": 300, "e.png": 505}.items():
        drawn.save(folder / file, dpi=(ppi, ppi))
    by_name = [
        picture(file, file, 2 + 0.1 * k, scale="s") for k, file in enumerate(("b.tif", "d.png", "e.png"))
    ]
    pitch = picture("c", "c.bmp", 2.4, scale={"mm_per_px": 0.0508})
    tables = finger(), picture("a", "a.png", 2.5, scale=stated), *by_name, pitch
    notes = [note for note in run(folder, *tables, scales={"s": stated}).notes if "ppi" in note]
    said = "the file states 1000 ppi, the scale is 500 ppi: check which is right"
    assert notes == [f"a.png and 2 more: {said}"]
    assert [read_resolution(folder / file) for file in ("a.png", "b.tif", "c.bmp")] == [1000] * 3
    (folder / "a.png").write_bytes(b"II*\0 no picture")
    assert read_resolution(folder / "a.png") is None


@pytest.mark.parametrize(
    ("stated", "moved", "unmoved"),
    [
        # E goes with the load, and as 1 − ν²: dE/E = 2ν dν/(1 − ν²) at ν = ½.
        (
            {"load_relative_std": 0.03},
            {"reduced_modulus_kpa": 0.03, "youngs_modulus_kpa": 0.03, "mean_pressure_kpa": 0.03},
            "indentation_mm",
        ),
        ({"poisson_ratio_std": 0.02}, {"youngs_modulus_kpa": 0.02 / 0.75}, "reduced_modulus_kpa"),
    ],
)
def test_a_stated_uncertainty_moves_what_it_must_and_no_other(tmp_path, stated, moved, unmoved):
    row = row_of(tmp_path, **stated)
    for name, relative_std in moved.items():
        assert row[f"{name}_std"] / row[name] == pytest.approx(relative_std, rel=1e-3)
    assert row[f"{unmoved}_std"] < 1e-6


def test_wedge_angle_by_first_order_and_by_monte_carlo(tmp_path):
    # dR_0g/dθ by the reference numbers: (9.982357 − 13.607666) mm over 15°, steeper than the mean at 30°.
    thick = finger(std=1e-9, effective_thickness_mm=8, effective_thickness_mm_std=0.8)
    row, drawn = (
        row_of(tmp_path, pad=thick, wedge_angle_deg_std=1, **how) for how in ({}, {"method": "monte_carlo"})
    )
    at_30 = {"u_deg": 45.243495, "v_deg": 90, "in_plane_radius_mm": 12.955, "transverse_radius_mm": 14.330}
    at_30 |= {"mean_curvature_radius_mm": 13.607666, "geometric_mean_radius_mm": 13.625}
    assert {name: row[name] for name in at_30} == pytest.approx(at_30, abs=6e-4)
    assert 0.2 < row["mean_curvature_radius_mm_std"] < 0.35
    assert row["radius_from_indentation_mm_fixed_geometry_std"] < 1e-6
    assert row_of(tmp_path)["mean_curvature_radius_mm_std"] < 1e-6
    of_layer = ("youngs_modulus_on_layer_kpa", "indentation_on_layer_mm", "loading_radius_on_layer_mm")
    of_hertz = ("mean_curvature_radius_mm", "radius_from_indentation_mm", "youngs_modulus_kpa")
    for name in of_hertz + of_layer:
        assert drawn[name] == row[name]
        assert drawn[f"{name}_std"] != row[f"{name}_std"]
        assert drawn[f"{name}_std"] == pytest.approx(row[f"{name}_std"], rel=0.03)


def test_a_named_scale_moves_both_axes_together_and_is_kept_on_the_row(folder):
    exact, named = row_of(folder, shown()), row_of(folder, shown(scale="s"))
    alone = row_of(folder, shown(scale={"ppi": 500, "relative_std": 0.05}))
    # Area and pressure go with the square of the scale; the axis ratio and the corrected radius not at all.
    assert named["mean_pressure_kpa_std"] / named["mean_pressure_kpa"] == pytest.approx(0.1, rel=0.03)
    name = "radius_from_indentation_mm_fixed_geometry_std"
    assert named[name] == pytest.approx(exact[name], rel=0.05)
    assert (named["scale"], alone["scale"]) == ("s", None)
    assert named["mm_per_px_std"] == pytest.approx(0.05 * named["mm_per_px"])
    assert {**named, "scale": None} == alone


def test_four_ways_to_say_a_scale(folder):
    Image.fromarray(render_coin(radius=120.0, shadow=0.0).pixels).save(folder / "coin.png")
    known, ruler, coined = (
        row_of(folder, shown(scale=scale))
        for scale in (
            {"mm_per_px": 0.05, "relative_std": 0.02},
            {"line": [[10, 20], [10, 220]], "length_mm": 10, "length_mm_std": 0.2},
            {"coin": "coin.png", "diameter_mm": 12, "diameter_mm_std": 0.24},
        )
    )
    assert ruler["semi_major_mm_std"] == pytest.approx(known["semi_major_mm_std"])
    assert coined["semi_major_mm"] == pytest.approx(known["semi_major_mm"], rel=2e-3)
    assert coined["semi_major_mm_std"] == pytest.approx(known["semi_major_mm_std"], rel=0.05)
    assert coined["mm_per_px_std"] > 0.02 * coined["mm_per_px"]


def test_a_coin_in_many_tables_is_measured_once_in_a_run(folder):
    Image.fromarray(render_coin(radius=120.0, shadow=0.0).pixels).save(folder / "coin.png")
    coin = {"coin": "coin.png", "diameter_mm": 12}
    rows = run(folder, finger(), *(shown(name, scale=coin) for name in "xyz")).rows
    assert rows["mm_per_px"].nunique() == 1
    with Store.reading(folder / "out" / STORE_NAME) as store:
        tasks = [name for name in store.statuses() if not name.startswith("/check")]
    assert len(tasks) == 4
    assert sum(name.startswith("/scale") for name in tasks) == 1


def test_a_coin_that_is_not_there_costs_its_rows(folder):
    scales = {"euro": {"coin": "print.png", "diameter_mm": 23.25}}
    result = run(folder, finger(), shown(scale="euro"), scales=scales)
    assert record_at(result.rows)["reason"].startswith("scale euro: print.png: no coin found")
    assert [failure.partition(": ")[0] for failure in result.failures] == ["x"]


@pytest.mark.parametrize(("turn", "side"), [(0, "along"), (30, "along"), (90, "across"), (-80, "across")])
def test_long_axis_is_told_from_the_finger_not_from_the_picture(folder, turn, side):
    row = row_of(folder, shown(finger_axis_deg=turn))
    assert row["long_axis"] == side
    assert (row["orientation_deg"] + turn + 90) % 180 - 90 == pytest.approx(0, abs=1.5)


@pytest.mark.parametrize("pad", [False, True])
@pytest.mark.parametrize("seen", [False, True])
def test_synthetic_if_anything_is(tmp_path, pad, seen):
    row = row_of(tmp_path, given(synthetic=seen), pad=finger(synthetic=pad))
    assert row["synthetic"] == (pad or seen)


@pytest.mark.parametrize(
    "keys",
    [
        {},
        {"threshold": 60},
        {"mask_px": [[5, 5], [5, 300], [420, 300], [420, 5]]},
    ],
)
def test_says_who_measured(folder, keys):
    row = row_of(folder, shown(**keys))
    assert row["measured_by"] == ("corrected" if keys else "automatic")
    assert row["semi_major_mm"] == pytest.approx(8.0, rel=0.03)


@pytest.mark.parametrize(("load", "notes"), [(0.01, True), (0.03, False), (90, False), (200, True)])
def test_a_modulus_is_plausible_from_1_to_5000_kpa(tmp_path, load, notes):
    row = row_of(tmp_path, given(load=load), pad=finger(pad_thickness_mm=6))
    assert (not 1 < row["youngs_modulus_kpa"] < 5000) == notes
    assert ("implausible_modulus" in row["range_notes"]) == notes
    assert row["measured_by"] == "manual"
    assert row["indentation_over_thickness"] == pytest.approx(row["indentation_mm"] / 6)


def test_an_entered_ellipse_has_the_area_of_both_axes_under_one_scale(tmp_path):
    alike = contact(std=0.1, scale={"mm_per_px": 0.05, "relative_std": 0.05})
    result = run(tmp_path, finger(), alike)
    area_std = result.rows["gross_area_mm2_std"]
    (at_load,) = result.by_load
    # By load there is the error of the load beside it.
    of_load = at_load.contact_area_mm2 * 2 / 3 * result.study.uncertainty.load_relative_std
    expected = (at_load.contact_area_mm2_std**2 - of_load**2) ** 0.5
    assert area_std.item() == pytest.approx(expected, rel=0.01)
    assert area_std.item() > 0.1 * at_load.contact_area_mm2


@pytest.mark.parametrize(("axis", "noted"), [("across", True), ("along", False)])
def test_a_contact_is_as_wide_as_the_pad_by_its_axis_across_the_finger(tmp_path, axis, noted):
    (row,) = records(run(tmp_path, finger(), contact(ellipse=(11.5, 5.0), axis=axis)).rows)
    assert ("as_wide_as_pad" in (row["range_notes"] or "")) == noted
