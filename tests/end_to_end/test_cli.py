"""The command line as scripts and people use it."""

import json
import os
import pty
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest
from PIL import Image
from tests.command import printed, refusal, run, run_json
from tests.studies import OUTLINES, contact, finger, picture, write_numbers, write_outlines, write_study

from fingerpad.cli import app
from fingerpad.cli.progress import ProgressDisplay
from fingerpad.simulate import (
    SyntheticSequence,
    render_coin,
    render_contact_image,
    render_finger,
    render_sequence,
)
from fingerpad.study.engine.runner import Progress

ROOT = Path(__file__).parents[2]
FIELDS = "fields --semi-axes-mm 7.9 13.8 11.8 --wedge-deg 30 --youngs-modulus-kpa 70 --grid 64"


def test_geometry() -> None:
    record = run_json("geometry", "--semi-axes-mm", 7.9, 13.8, 11.8, "--wedge-deg", 30)
    expected = {
        "u_deg": 45.243495,
        "v_deg": 90.0,
        "in_plane_radius_mm": 12.954886,
        "transverse_radius_mm": 14.329722,
        "mean_curvature_radius_mm": 13.607666,
        "geometric_mean_radius_mm": 13.624974,
        "mean_curvature_per_mm": 1 / 13.607666,
        "gaussian_curvature_per_mm2": 1 / (12.954886 * 14.329722),
    }
    assert {key: record[key] for key in expected} == pytest.approx(expected, rel=1e-6)
    assert len(record["point_mm"]) == 3
    assert set(record) == {*expected, "point_mm", "principal_radii_mm", "principal_directions"}
    # The widest of a thousand thumbs is some 30 mm wide.
    code, out, err = run("geometry", "--semi-axes-mm", 15, 28.4, 23, "--wedge-deg", 30)
    assert (code, bool(out)) == (0, True)
    assert err.startswith("note: --semi-axes-mm: radial_ulnar 23 mm")


def test_hertz_forwards_and_back() -> None:
    def hertz(first: float, second: float, *given: object) -> dict[str, Any]:
        return run_json("hertz", "--radii-mm", first, second, "--reduced-modulus-kpa", 136.5, *given)

    forward = hertz(12.955, 14.330, "--load-n", 2)
    assert forward["long_axis_along"] == "second"
    assert forward["area_mm2"] == pytest.approx(np.pi * forward["semi_major_mm"] * forward["semi_minor_mm"])
    assert forward["mean_pressure_kpa"] == pytest.approx(2e3 / forward["area_mm2"])
    assert forward["peak_pressure_kpa"] == pytest.approx(1.5 * forward["mean_pressure_kpa"])
    back = hertz(12.955, 14.330, "--indentation-mm", forward["indentation_mm"])
    assert back["load_N"] == pytest.approx(2, rel=1e-12)
    assert hertz(14.330, 12.955, "--load-n", 2)["long_axis_along"] == "first"
    circle = hertz(14, 14, "--load-n", 2)
    assert (circle["F1"], circle["F2"], circle["long_axis_along"]) == (1, 1, "either")


def test_hertz_says_where_a_contact_is_too_large_for_it() -> None:
    pad = ("hertz", "--radii-mm", 12.96, 14.33, "--load-n", 2, "--reduced-modulus-kpa")
    assert "Hertz theory does not hold here" in run(*pad, 0.1365)[1]
    assert "does not hold" not in run(*pad, 136.5)[1]
    assert run_json(*pad, 0.1365)["semi_major_mm"] > 12.96


def test_correct() -> None:
    record = run_json("correct", "--ellipse-mm", 7.4, 5.0, "--radius-mm", 18.7)
    expected = {
        "eccentricity": 0.7371990,
        "K": 1.892759475,
        "E": 1.328427072,
        "F1": 0.995238751,
        "F2": 0.995216154,
        "radius_from_indentation_mm": 18.97096,
        "radius_from_area_mm": 18.43416,
        "radius_from_compliance_mm": 18.61139,
    }
    assert record == pytest.approx(expected, rel=3e-7)


def test_fields() -> None:
    fields = (*FIELDS.split(), "--load-n", 2)
    record = run_json(*fields, "--thickness-mm", 8, "--depth-mm", 2, 0.5, 8)
    hertz = record["hertz"]
    assert record["depth_mm"] == hertz["depth_mm"] == [0.5, 2, 8]
    assert [record["load_N"], hertz["load_N"]] == pytest.approx([2, 2])
    assert record["area_mm2"] < hertz["area_mm2"]
    for one in (record, hertz):
        low, _, high = np.transpose(one["principal_stresses_kpa"])
        np.testing.assert_allclose(one["maximum_shear_kpa"], (high - low) / 2)
        assert max(one["maximum_shear_kpa"]) <= one["highest_shear_on_axis_kpa"]
        # Incompressible: strains are those of the deviatoric stress.
        strain = np.array([one[f"strain_{name}"] for name in ("xx", "yy", "zz")])
        stress = np.array([one[f"stress_{name}_kpa"] for name in ("xx", "yy", "zz")])
        np.testing.assert_allclose(strain, 1.5 * (stress - stress.mean(axis=0)) / 70, atol=1e-12)
        sheared = np.multiply(one["stress_xz_kpa"], one["strain_xz"])
        energy = 0.5 * (stress * strain).sum(axis=0) + sheared
        np.testing.assert_allclose(one["strain_energy_density_kJ_per_m3"], energy, rtol=1e-3)
    repeated = run_json(*fields, "--depth-mm", 2, "--depth-mm", 0.5)
    assert (repeated["depth_mm"], repeated["thickness_mm"]) == ([0.5, 2], None)
    assert repeated["hertz"]["stress_zz_kpa"] == hertz["stress_zz_kpa"][:2]


def test_fields_as_text_and_drawn(tmp_path: Path) -> None:
    out = printed(*FIELDS.split(), "--load-n", 2, "--thickness-mm", 2.2, "--plot", tmp_path / "drawn")
    for words in ("Meissner, Merkel", "2.2 ", "literature"):
        assert words in out
    assert {path.name for path in (tmp_path / "drawn").iterdir()} == {"section.svg", "section.png"}
    assert "maximum shear stress" in (tmp_path / "drawn" / "section.svg").read_text(encoding="utf-8")


PRINT = "measure print x.png"
MODULUS = "modulus --semi-axes-mm 7.9 13.8 11.8 --wedge-deg 30 --load-n 2"
SOLVE = "solve --semi-axes-mm 7.9 13.8 11.8 --wedge-deg 30 --youngs-modulus-kpa 102.375 --grid 64"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("geometry --semi-axes-mm 7.9 nan 11.8 --wedge-deg 30", "--semi-axes-mm must be .* found nan"),
        ("hertz --radii-mm 12 14 --reduced-modulus-kpa 9", "exactly one of --load-n and --indentation-mm"),
        ("hertz --radii-mm 12.9,14.3 --load-n 2 --reduced-modulus-kpa 9", "takes 2 .* found 12.9,14.3 --lo"),
        ("correct --ellipse-mm 7.4 five --radius-mm 18", "--ellipse-mm takes 2 numbers.* found 7.4 five"),
        ("measure photo x.png --face palmar", "give either --ppi, --mm-per-px, .*, --coin or --grid"),
        (f"{PRINT} --ppi 500 --mm-per-px 0.05", "give either .*, found --ppi and --mm-per-px"),
        (f"{PRINT} --ppi 500 --roi-px 0,0,nan,9", "--roi-px takes 4 numbers"),
        (f"{PRINT} --scale-line 5,5,5,5 --line-mm 3", "--scale-line.* two different ends"),
        (f"{PRINT} --scale-line 5,5,5,9", "needs --line-mm"),
        (f"{PRINT} --ppi 500 --coin-mm 3", "belongs to --coin.* beside --ppi"),
        (f"{PRINT} --coin c.png --coin-mm 23", "c.png: no such file"),
        (f"{PRINT} --grid g.png --grid-points 7.5,9 --grid-spacing-mm 1", "--grid-points: .* found 7.5"),
        (f"{PRINT} --scale-relative-std 0.1", "belongs to --ppi or --mm-per-px"),
        (FIELDS, "give exactly one of --load-n, --area-mm2 and --indentation-mm"),
        (f"{FIELDS} --load-n 90", "would flatten the pad to its silhouette"),
        (f"{FIELDS} --load-n 2 --thickness-mm 400", "leave it out"),
        (f"{FIELDS} --load-n 2 --thickness-mm 6 --depth-mm 2 7", "at most --thickness-mm 6, found 7"),
        (MODULUS, "give exactly one of --area-mm2 and --indentation-mm"),
        (f"{MODULUS} --area-mm2 9 --indentation-mm 1", "exactly one of --area-mm2 and --indentation-mm"),
        (f"{MODULUS} --area-mm2 9 --thickness-mm 0", "--thickness-mm must be positive and finite, found 0"),
        (f"{SOLVE} --load-n 200", "200: the load would flatten the pad to its silhouette.*: check load"),
        (f"{SOLVE} --area-mm2 700", "700: the area would flatten the pad to its silhouette"),
        (f"{SOLVE} --load-n 2 --thickness-mm 0.3 --poisson-ratio 0.3", "would press through the .* of 0.3"),
        (f"{SOLVE} --load-n 2 --thickness-mm 0.1", "a tenth of the contact's mean radius 1.2.*, found 0.1"),
        (f"{SOLVE} --load-n 2 --poisson-ratio 0.51", "--poisson-ratio.*less than or equal to 0.5"),
        (f"{SOLVE} --load-n 2 --grid 63", "--grid.*greater than or equal to 64"),
        (f"{SOLVE} --load-n 2 --area-mm2 20", "one of --load-n, --area-mm2 and --indentation-mm"),
        ("run nowhere.toml", "nowhere.toml: no such file; .fingerpad init DIR"),
        ("init --finger x other", "--finger"),
        ("init --scale 500_ppi other", "--scale"),
        ("init --from-files --example other", "--from-files"),
        ("init --from-files --scale fine .", "write it as 500 ppi or 0.05 mm/px"),
    ],
)
def test_invalid_input_exit_code(
    arguments: str, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert re.search(message, refusal(*arguments.split()))
    assert not list(tmp_path.iterdir())


@pytest.fixture(scope="module")
def print_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a contact image of 9.0 × 6.5 mm at 500 ppi, which its file states."""
    path = tmp_path_factory.mktemp("print") / "p.png"
    pixels = render_contact_image(semi_major=9.0, semi_minor=6.5, seed=4).pixels
    Image.fromarray(pixels).save(path, dpi=(500, 500))
    return path


def test_measure_print(print_file: Path, tmp_path: Path) -> None:
    truth = render_contact_image(semi_major=9.0, semi_minor=6.5, seed=4)
    Image.fromarray(np.full((400, 400), 250, np.uint8)).save(tmp_path / "blank.png")
    (tmp_path / "text.png").write_text("no picture")
    files = [print_file, *(tmp_path / name for name in ("blank.png", "text.png", "missing.png"))]
    code, out, err = run(
        "measure", "print", *files, "--ppi", 500, "--overlay-dir", tmp_path / "overlays", "--json"
    )
    assert (code, err) == (3, "")
    good, *bad = json.loads(out)
    assert good["file"] == str(files[0])
    assert (good["semi_major_mm"], good["semi_minor_mm"]) == pytest.approx((9.0, 6.5), rel=0.02)
    assert good["gross_area_mm2"] == pytest.approx(truth.gross_area, rel=0.02)
    assert good["gross_area_mm2"] > good["ridge_area_mm2"] > 0
    assert good["centroid_px"] == pytest.approx(truth.centroid, abs=3)
    assert good["flags"] == []
    assert abs(good["orientation_deg"]) < 2
    for record, path in zip(bad, files[1:], strict=True):
        assert set(record) == {"file", "error"}
        assert record["file"] == str(path)
    with Image.open(tmp_path / "overlays" / "p_overlay.png") as overlay:
        assert overlay.size[0] >= truth.pixels.shape[1]
    assert len(list((tmp_path / "overlays").iterdir())) == 1


def test_measure_print_explains_scale_flags_and_overlays(print_file: Path, tmp_path: Path) -> None:
    out = printed("measure", "print", print_file, "--overlay-dir", tmp_path / "drawn")
    assert re.search(r"^mm_per_px +0\.050800 ± 0\.000029\nscale_from +file$", out, re.M)
    assert "check the scale" not in out
    assert "scale taken as exact" not in out
    assert out.endswith(f"Overlays: {tmp_path / 'drawn'}\n")
    _, out, err = run("measure", "print", print_file, "--ppi", 50)
    assert "p.png: the file states 500 ppi, the scale is 50 ppi: check which is right\n" in err
    assert re.search(r"^scale_from +option$", out, re.M)
    assert "\nscale taken as exact\n" in out
    assert "\nscale_doubtful: the ridge period is not that of a finger, or" in out
    assert "Overlays" not in out


def test_measure_print_seed_and_region(tmp_path: Path) -> None:
    small, large = (render_contact_image(semi_major=a, semi_minor=a / 1.3, seed=4).pixels for a in (5.0, 8.0))
    small = np.pad(small, [(0, len(large) - len(small)), (0, 0)], constant_values=250)
    Image.fromarray(np.hstack([small, large])).save(tmp_path / "two.png")
    rows, columns = 5 * len(large) // 8, small.shape[1]
    for given, found in (
        ((), 8.0),
        (("--seed-px", f"{rows // 2},{columns // 2}"), 5.0),
        (("--roi-px", f"0,0,{rows},{columns}"), 5.0),
    ):
        (record,) = run_json("measure", "print", tmp_path / "two.png", "--ppi", 500, *given)
        assert record["semi_major_mm"] == pytest.approx(found, rel=0.03), given


def test_measure_print_threshold_and_mask(print_file: Path, tmp_path: Path) -> None:
    (tmp_path / "mask.csv").write_text("row_px,column_px\n1,1\n1,330\n230,330\n230,1\n")
    (tmp_path / "line.csv").write_text("row_px,column_px\n1,1\n1,330\n")
    common = ("measure", "print", print_file, "--mm-per-px", 0.0508)
    free, masked, high, low = (
        run_json(*common, *given)[0]
        for given in ((), ("--mask", tmp_path / "mask.csv"), ("--threshold", 150), ("--threshold", 60))
    )
    assert "cut_by_mask" in masked["flags"]
    assert masked["gross_area_mm2"] < 0.7 * free["gross_area_mm2"]
    assert high["ridge_area_mm2"] < low["ridge_area_mm2"]
    said = refusal(*common, "--mask", tmp_path / "line.csv")
    assert "needs three corners or more, found 2" in said


@pytest.mark.parametrize(
    ("drawn", "length"),
    [
        (("--scale-line", "10,20,10,220"), "--line-mm"),
        (("--scale-circle", "0,100,100,0,200,100"), "--circle-mm"),
    ],
)
def test_scale_from_ruler_and_circle(print_file: Path, drawn: tuple[str, ...], length: str) -> None:
    (known,) = json.loads(run("measure", "print", print_file, "--mm-per-px", 0.05, "--json")[1])
    ruler, doubted = (
        json.loads(run("measure", "print", print_file, *drawn, length, 10, *given, "--json")[1])[0]
        for given in ((), (f"{length}-std", 0.2))
    )
    assert ruler == known
    assert (known["mm_per_px_std"], doubted["mm_per_px_std"]) == pytest.approx((0.0, 0.001))
    gained = doubted["semi_major_mm_std"] ** 2 - ruler["semi_major_mm_std"] ** 2
    assert gained == pytest.approx((0.02 * ruler["semi_major_mm"]) ** 2)


def test_scale_from_coin_and_grid(print_file: Path, tmp_path: Path) -> None:
    def measured(*scale: object) -> dict[str, Any]:
        return json.loads(run("measure", "print", print_file, *scale, "--json")[1])[0]

    known = measured("--mm-per-px", 0.05)
    Image.fromarray(render_coin(radius=120.0, shadow=0.0).pixels).save(tmp_path / "coin.png")
    # Dots 20 px apart: 1 mm each.
    row, column = np.indices((200, 240))
    dots = np.where(np.hypot(row % 20 - 10, column % 20 - 10) < 6, 30, 230).astype(np.uint8)
    Image.fromarray(np.pad(dots, 20, constant_values=230)).save(tmp_path / "dots.png")
    coin, grid = ("--coin-mm", 12), ("--grid-points", "10,12", "--grid-spacing-mm", 1)
    by_coin = measured("--coin", tmp_path / "coin.png", *coin)
    by_grid = measured("--grid", tmp_path / "dots.png", *grid, "--grid-pattern", "dots")
    for found in (by_coin, by_grid):
        assert found["semi_major_mm"] == pytest.approx(known["semi_major_mm"], rel=2e-3)
    assert by_coin["semi_major_mm_std"] > known["semi_major_mm_std"]
    other = ("measure", "print", print_file)
    assert re.search(r"--coin.*p\.png: no coin found", refusal(*other, "--coin", print_file, *coin))
    assert re.search(r"--grid.*p\.png: no grid of 10 × 12", refusal(*other, "--grid", print_file, *grid))


def test_progress_bar_on_terminals_only(
    print_file: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for count in (1, 2):
        ours, theirs = pty.openpty()
        with os.fdopen(theirs, "w") as terminal, monkeypatch.context() as patched:
            patched.setattr(sys, "stderr", terminal)
            patched.setenv("TERM", "xterm")  # one that is dumb shows no bar
            with pytest.raises(SystemExit) as end:
                app(["measure", "print", *[str(print_file)] * count, "--ppi", "240", "--json"])
        os.set_blocking(ours, False)
        try:
            bar = os.read(ours, 100_000)
        except (BlockingIOError, OSError):
            bar = b""
        os.close(ours)
        assert end.value.code == 0
        assert len(json.loads(capsys.readouterr().out)) == count
        assert (b"Measuring" in bar) == (count > 1)


def test_run_reports_disagreement_of_faces(tmp_path: Path) -> None:
    faces = write_outlines(
        tmp_path, OUTLINES | {"distal": (12.8, 7.9)}, decimals=3, outline_relative_std=0.01
    )
    stated = {"wedge_angle_deg_std": 0.3}
    study = write_study(tmp_path, finger(photographs=faces), contact(axis=""), uncertainty=stated)
    code, out, err = run("run", study, "--out", tmp_path / "out")
    assert (code, "failed" in err) == (0, False)
    (line,) = (line for line in out.splitlines() if line.startswith("doubtful: f:"))
    words = r"faces disagree \(p = .*palmar face: radial–ulnar −\d\.\d %.*; distal face: .*\+\d"
    assert re.search(words, line)
    assert line.split("): ")[1] in (tmp_path / "out" / "report.html").read_text(encoding="utf-8")


def test_measure_photo(tmp_path: Path) -> None:
    truth = render_finger("palmar", semi_axes=(11.8, 13.8), mm_per_px=0.1, tip="left", seed=3)
    Image.fromarray(truth.pixels).save(tmp_path / "palmar.png")
    photo = ("measure", "photo", "--face", "palmar", "--mm-per-px", 0.1)
    given = ("--tip", "left", "--overlay-dir", tmp_path / "overlays")
    record = run_json(*photo, tmp_path / "palmar.png", *given)
    assert record["semi_axes_mm"] == pytest.approx({"radial_ulnar": 11.8, "distal": 13.8}, rel=0.02)
    assert set(record["semi_axes_mm_std"]) == {"radial_ulnar", "distal"}
    assert record["arc_deg"] > 100
    assert 0 <= record["outlier_fraction"] < 0.3
    assert record["flags"] == []
    assert (tmp_path / "overlays" / "palmar_overlay.png").is_file()
    Image.fromarray(np.full((300, 300, 3), 200, np.uint8)).save(tmp_path / "empty.png")
    code, out, _ = run(*photo, tmp_path / "empty.png", "--json")
    assert code == 3
    assert set(json.loads(out)) == {"file", "error"}


RATE = ("--frames-per-second", 11)


@pytest.fixture(scope="module")
def pressed() -> SyntheticSequence:
    return render_sequence(2 * np.sin(np.pi * np.linspace(0, 1, 12)))


@pytest.fixture(scope="module")
def films(tmp_path_factory: pytest.TempPathFactory, pressed: SyntheticSequence) -> Path:
    """Return a folder with the frames of a press, one of them torn, its forces and its times."""
    folder = tmp_path_factory.mktemp("films")
    (folder / "frames").mkdir()
    for index in range(12):
        Image.fromarray(pressed.pixels(index)).save(folder / "frames" / f"frame{index}.png")
    (folder / "frames" / "frame5.png").write_bytes(b"torn")
    force = [(k / 11, load, load) for k, load in enumerate(pressed.load)]
    for name, header in (("force", "Time (s),Load [N],displacment_mm"), ("other", "Time (s),Fz,z")):
        write_numbers(folder / f"{name}.csv", header, force)
    write_numbers(folder / "times.csv", "Takt", np.arange(12)[:, None] / 11)
    return folder


def of_frames(films: Path, *given: object) -> tuple[object, ...]:
    """Return the command that measures the sequence; files are named by their names in its folder."""
    named = (films / word if str(word).endswith(".csv") else word for word in given)
    return "measure", "sequence", films / "frames", "--ppi", 300, *named, "--json"


def test_measure_sequence(films: Path, pressed: SyntheticSequence) -> None:
    code, out, err = run(*of_frames(films, "--force", "force.csv", *RATE))
    assert code == 3
    assert "displacement: --column displacement=displacment_mm:mm" in err
    frames = json.loads(out)
    assert [frame["frame"] for frame in frames] == list(range(12))
    assert [frame["time_s"] for frame in frames] == pytest.approx(np.arange(12) / 11)
    assert [frame["load_N"] for frame in frames] == pytest.approx(pressed.load, abs=1e-9)
    assert "error" in frames[5]
    assert frames[6]["gross_area_mm2"] == pytest.approx(pressed.gross_area[6], rel=0.03)
    rows, columns = pressed.pixels(0).shape
    half = json.loads(run(*of_frames(films, *RATE, "--roi-px", f"0,0,{rows // 2},{columns}"))[1])[6]
    assert "cut_by_mask" in half["flags"]
    assert half["gross_area_mm2"] == pytest.approx(pressed.gross_area[6] / 2, rel=0.05)
    other = (*RATE, "--force", "other.csv", "--column", "force=Fz:mN")
    named = json.loads(run(*of_frames(films, *other))[1])
    assert [frame["load_N"] for frame in named] == pytest.approx(pressed.load / 1000, abs=1e-12)
    timed = json.loads(run(*of_frames(films, "--times", "times.csv", "--column", "frame_time=Takt:s"))[1])
    assert [frame["time_s"] for frame in timed] == pytest.approx(np.arange(12) / 11)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ((*RATE, "--force", "other.csv"), "--column force=HEADER:UNIT"),
        ((*RATE, "--force", "other.csv", "--column", "area=A:mm2"), "takes QUANTITY=NAME:UNIT with time, "),
        ((*RATE, "--column", "force=Fz:mN"), "--column names columns of --force"),
        ((*RATE, "--column", "frame_time=Takt:s"), "names the column of --times"),
        ((*RATE, "--start-s", 0.1, "--contact-load-n", 1), "give either the time of the first frame or the"),
        ((*RATE, "--times", "force.csv"), "there is no use for --frames-per-second"),
        (("--times", "times.csv"), "--column frame_time=HEADER:UNIT"),
        (("--frames-per-second", -1), "--frames-per-second"),
    ],
)
def test_sequences_refused(films: Path, given: tuple[object, ...], message: str) -> None:
    assert message in refusal(*of_frames(films, *given))


def test_reproduce_lists_every_printed_number(tmp_path: Path) -> None:
    records = run_json("reproduce")
    items = {record["item"]: record for record in records}
    at_30 = items["Table 2, ellipse, u = 30°"]
    assert (at_30["printed"], at_30["unit"]) == (25.3, "mm")
    assert at_30["computed"] == pytest.approx(17.11, abs=5e-3)
    assert {frozenset(record) for record in records} == {frozenset(at_30)}
    out = printed("reproduce", "--figures", tmp_path / "figures")
    assert all(item in out for item in items)
    suffixes = [path.suffix for path in (tmp_path / "figures").iterdir()]
    assert suffixes.count(".svg") == suffixes.count(".png") >= 5


def test_init_then_run(tmp_path: Path) -> None:
    study = tmp_path / "mine"
    out = printed("init", study)
    assert "study.toml" in out
    assert "examples: replace them" in out
    assert run("init", study)[0] == 2
    out = printed("run", study)
    modulus, radius = r"modulus 67.1 ± 5.0 kPa \(2 N\), bone unknown", "corrected radius 13.80 ± 0.90 mm"
    theory = r"Hertz theory fails \(.*\), for the whole pad 60\.\d ± 4\.\d kPa"
    finger = rf"^left_index, 30° \(synthetic\): {modulus}; {theory}; {radius}\.$"
    assert re.search(finger, out, re.M)
    assert "fails where by more than 20 %" in out
    names = {"report.html", "results.csv", "results_columns.csv", "results.json", "summary.json"}
    assert names <= {path.name for path in (study / "results").iterdir()}
    assert {path.name for path in tmp_path.iterdir()} == {"mine"}
    for named in (study, study / "study.toml"):
        assert json.loads(run("status", named, "--json")[1])["done"] == 1
        assert run("verify", named)[0] == 0
    assert "Run it: fingerpad run" in printed("init", "--example", tmp_path / "example")
    assert (tmp_path / "example" / "study.toml").is_file()


def test_pages_say_what_commands_print(run_example: Path, tmp_path: Path) -> None:
    answer, meaning = printed("run", shutil.copytree(run_example, tmp_path / "example")).splitlines()[:2]
    assert answer.startswith("synthetic_pad, 30° (synthetic): modulus")
    index, tutorial, readme = (
        (ROOT / page).read_text(encoding="utf-8")
        for page in ("docs/index.md", "docs/tutorial/command-line.md", "README.md")
    )
    assert f"\n    {answer}\n" in index
    assert f"\n    {answer}\n    {meaning}\n" in tutorial
    area, *_ = (
        line
        for line in printed(
            "measure", "print", ROOT / "examples/dzidek2017/synthetic/synthetic_30deg_2N.png", "--ppi", 500
        ).splitlines()
        if line.startswith("gross_area_mm2 ")
    )
    assert f"`{' '.join(area.split())}`" in readme


def test_init_from_files(run_example: Path, tmp_path: Path) -> None:
    shutil.copy(run_example / "contact_1N.png", tmp_path / "IMG_0033.png")
    shutil.copy(run_example / "photograph_palmar.jpg", tmp_path / "left_index_palmar.jpg")
    out = printed("init", "--from-files", tmp_path)
    assert "left_index_palmar.jpg: photograph" in out
    assert "Not taken:\n  IMG_0033.png: nothing states its finger: give --finger NAME" in out
    assert run("init", "--from-files", tmp_path)[0] == 2  # nothing is overwritten
    (tmp_path / "study.toml").unlink()
    (tmp_path / "study.schema.json").unlink()
    out = printed("init", "--from-files", "--finger", "left_index", tmp_path)
    assert "IMG_0033.png: contact image" in out
    assert "observation IMG_0033: the load is missing" in out
    assert "Not taken" not in out


def test_two_commands_from_prints_to_area_against_load(run_example: Path, tmp_path: Path) -> None:
    for load, written in (("0.5", "0,5"), ("1", "1"), ("2", "2")):
        # What the picture says of its resolution holds less than what the person says.
        print_ = Image.open(run_example / f"contact_{load}N.png")
        print_.save(tmp_path / f"LI_{written}N.png", dpi=(300, 300))
    given = ("--finger", "left_index", "--wedge-deg", 30, "--scale", "500 ppi")
    out = printed("init", "--from-files", *given, tmp_path)
    assert "Run it: " in out
    assert "300 ppi" not in out
    out = printed("run", tmp_path)
    assert re.search(r"^left_index, 30°: contact area 117\.\d ± \d\.\d mm² under 2 N; no modulus", out, re.M)
    by_load = pd.read_csv(tmp_path / "results" / "by_load.csv")
    assert list(by_load["load_N"]) == [0.5, 1.0, 2.0]
    # Of elliptical Hertz theory for the pad and the tissue that the example was rendered with.
    assert np.all(np.abs(by_load["contact_area_mm2"] / [46.39, 73.64, 116.9] - 1) < 0.03)


def test_overlay_names_do_not_collide(tmp_path: Path) -> None:
    pixels = render_contact_image(seed=4).pixels
    files = [tmp_path / name for name in ("1/x.png", "2/x.png", "2/x_overlay.png")]
    for file in files:
        file.parent.mkdir(exist_ok=True)
        Image.fromarray(pixels).save(file)
    before = files[-1].read_bytes()
    assert run("measure", "print", *files, "--ppi", 500, "--overlay-dir", tmp_path / "2")[0] == 0
    assert files[-1].read_bytes() == before
    assert len(list((tmp_path / "2").iterdir())) == 2 + 3


def test_missing_packages_named() -> None:
    """Each is missing in turn, where nothing of the program is imported yet."""
    script = (
        "import sys\n"
        "sys.argv[1:] = ['run', 'x.toml']\n"
        "for package in 'cv2', 'jinja2':\n"
        "    sys.modules[package] = None\n"
        "    from fingerpad.__main__ import main\n"
        "    try:\n"
        "        main()\n"
        "    except SystemExit as end:\n"
        "        print(end.code)\n"
        "    for name in list(sys.modules):\n"
        "        if name.partition('.')[0] in {package, 'fingerpad'}:\n"
        "            del sys.modules[name]\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, 2 * "2\n")
    said = done.stderr.splitlines()
    for line, missing in zip(said, ("cv2", "jinja2"), strict=True):
        assert line.startswith(f"fingerpad: this needs the package {missing}")


@pytest.mark.skipif(sys.platform != "linux", reason="threads are counted as Linux shows them")
def test_linear_algebra_threads() -> None:
    script = (
        "import atexit, os, sys; "
        "sys.argv[1:] = 'hertz --radii-mm 12 14 --load-n 2 --reduced-modulus-kpa 100'.split(); "
        "threads = lambda: os.listdir('/proc/self/task'); "
        "much = lambda: __import__('numpy').ones((900, 900)) @ __import__('numpy').ones((900, 900)); "
        "atexit.register(lambda: (much(), print(len(threads())))); "
        "from fingerpad.__main__ import main; main()"
    )
    mine = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")}
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True, env=mine
    )
    assert int(done.stdout.splitlines()[-1]) == 1


def test_the_shown_rate_is_of_this_run_alone() -> None:
    """Pictures that an earlier run measured are done at once, and tell nothing of the speed."""
    shown: dict[str, str] = {}
    bar = SimpleNamespace(add_task=lambda *_, **__: 0, update=lambda _, **fields: shown.update(fields))
    display = ProgressDisplay(bar, None)
    display.update(Progress(pictures=1_000_000, failed=0, total=1_000_002))
    display.update(Progress(item="a", status="done", pictures=1_000_000, failed=0, total=1_000_002))
    assert shown["rate"] == ""
    time.sleep(0.02)
    display.update(Progress(item="b", status="done", pictures=1_000_001, failed=0, total=1_000_002))
    assert 0 < float(shown["rate"].removesuffix(" pictures/s")) <= 50
    assert shown["completed"] == 1_000_001
    display.finish()
    assert shown["description"] == "Done"


def test_a_run_without_a_result_says_why(tmp_path: Path) -> None:
    pad = finger(semi_axes_mm_std={"palmar": 0.1, "distal": 0.2, "radial_ulnar": 0.3})
    out = printed("run", study := write_study(tmp_path, pad))
    axes = "palmar 7.90 ± 0.10 mm, distal 13.80 ± 0.20 mm, radial–ulnar 11.80 ± 0.30 mm"
    assert f"f: semi-axes {axes}; no contact is given\n" in out
    pixels = render_contact_image(semi_major=4.0, semi_minor=3.0, seed=1).pixels
    for name, shown in (("coarse", pixels), ("empty", np.zeros_like(pixels))):
        Image.fromarray(shown).save(tmp_path / f"{name}.png")
    write_study(tmp_path, pad, *(picture(n, f"{n}.png", 1, scale={"ppi": 50}) for n in ("coarse", "empty")))
    code, out, err = run("run", study)
    assert code == 3
    assert "failed: empty: no contact found: every pixel has the same level" in err
    assert "empty.png" in (tmp_path / "results" / "report.html").read_text(encoding="utf-8")
    assert re.search(r"^f, 30°: 0 of 1 contact pooled: .*the ridge period is not that", out, re.M)
    assert "f, 30°: no modulus and no corrected radius, as none of 1 contact counts.\n" in out
    assert run("status", study)[1].endswith("failed: empty\n")


def test_what_is_complete_is_run_when_asked(tmp_path: Path) -> None:
    study = write_study(tmp_path, finger(), contact(), contact("no_load", load_N="?"))
    assert run("run", study)[0] == 2
    code, out, err = run("run", study, "--incomplete")
    assert (code, out.startswith("f")) == (0, True)
    assert "left out, as it is not complete: " in err
    assert "no_load" in err
