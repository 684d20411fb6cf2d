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

import numpy as np
import pandas as pd
import pytest
from PIL import Image
from tests.command import run, run_json
from tests.studies import OUTLINES, contact, finger, picture, summary_of, write_outlines, write_study

from fingerpad.cli import app
from fingerpad.cli.progress import ProgressDisplay
from fingerpad.simulate import (
    render_coin,
    render_contact_image,
    render_finger,
    render_sequence,
)
from fingerpad.study.engine.runner import Progress

FIELDS = "fields --semi-axes-mm 7.9 13.8 11.8 --wedge-deg 30 --youngs-modulus-kpa 70 --grid 64"
EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "dzidek2017"


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


@pytest.mark.parametrize(
    ("axes", "noted"),
    [
        ((15, 28.4, 23), "radial_ulnar 23 mm"),
        ((16, 20, 12), "palmar 16 mm"),
    ],
)
def test_semi_axes_that_look_like_widths_are_noted(axes: tuple[float, ...], noted: str) -> None:
    # The widest of a thousand thumbs is some 30 mm wide.
    code, out, err = run("geometry", "--semi-axes-mm", *axes, "--wedge-deg", 30)
    assert (code, bool(out)) == (0, True)
    assert err.startswith(f"note: --semi-axes-mm: {noted}") if noted else not err


def test_hertz_forwards_and_back() -> None:
    forward = run_json("hertz", "--radii-mm", 12.955, 14.330, "--load-n", 2, "--reduced-modulus-kpa", 136.5)
    assert forward["long_axis_along"] == "second"
    assert forward["area_mm2"] == pytest.approx(np.pi * forward["semi_major_mm"] * forward["semi_minor_mm"])
    assert forward["mean_pressure_kpa"] == pytest.approx(2e3 / forward["area_mm2"])
    assert forward["peak_pressure_kpa"] == pytest.approx(1.5 * forward["mean_pressure_kpa"])
    back = run_json(
        "hertz",
        *("--radii-mm", 12.955, 14.330, "--reduced-modulus-kpa", 136.5),
        *("--indentation-mm", forward["indentation_mm"]),
    )
    assert back["load_N"] == pytest.approx(2, rel=1e-12)
    swapped = run_json("hertz", "--radii-mm", 14.330, 12.955, "--load-n", 2, "--reduced-modulus-kpa", 136.5)
    assert swapped["long_axis_along"] == "first"
    circle = run_json("hertz", "--radii-mm", 14, 14, "--load-n", 2, "--reduced-modulus-kpa", 136.5)
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
    record = run_json(*FIELDS.split(), "--load-n", 2, "--thickness-mm", 8, "--depth-mm", 2, 0.5, 8)
    hertz = record["hertz"]
    assert record["depth_mm"] == hertz["depth_mm"] == [0.5, 2, 8]
    assert record["load_N"] == pytest.approx(2)
    assert hertz["load_N"] == pytest.approx(2)
    assert record["area_mm2"] < hertz["area_mm2"]
    for one in (record, hertz):
        low, _, high = np.transpose(one["principal_stresses_kpa"])
        np.testing.assert_allclose(one["maximum_shear_kpa"], (high - low) / 2)
        assert max(one["maximum_shear_kpa"]) <= one["highest_shear_on_axis_kpa"]
        # Incompressible: strains without change of volume, and their energy by the deviatoric stress alone.
        strain = np.array([one[f"strain_{name}"] for name in ("xx", "yy", "zz")])
        stress = np.array([one[f"stress_{name}_kpa"] for name in ("xx", "yy", "zz")])
        np.testing.assert_allclose(strain.sum(axis=0), 0, atol=1e-12)
        np.testing.assert_allclose(strain, 1.5 * (stress - stress.mean(axis=0)) / 70, atol=1e-12)
        np.testing.assert_allclose(
            one["strain_energy_density_kJ_per_m3"],
            0.5 * (stress * strain).sum(axis=0) + np.multiply(one["stress_xz_kpa"], one["strain_xz"]),
            rtol=1e-3,
        )
    repeated = run_json(*FIELDS.split(), "--load-n", 2, "--depth-mm", 2, "--depth-mm", 0.5)
    assert (repeated["depth_mm"], repeated["thickness_mm"]) == ([0.5, 2], None)
    assert repeated["hertz"]["stress_zz_kpa"] == hertz["stress_zz_kpa"][:2]


def test_fields_as_text_and_drawn(tmp_path: Path) -> None:
    code, out, _ = run(*FIELDS.split(), "--load-n", 2, "--thickness-mm", 2.2, "--plot", tmp_path / "drawn")
    assert code == 0
    assert "Meissner, Merkel" in out
    assert "2.2 " in out
    assert "literature" in out
    assert {path.name for path in (tmp_path / "drawn").iterdir()} == {"section.svg", "section.png"}
    assert "maximum shear stress" in (tmp_path / "drawn" / "section.svg").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("geometry --semi-axes-mm 7.9 nan 11.8 --wedge-deg 30", "--semi-axes-mm must be .* found nan"),
        (
            "hertz --radii-mm 12 14 --reduced-modulus-kpa 9",
            "give exactly one of --load-n and --indentation-mm",
        ),
        ("correct --ellipse-mm 7.4 five --radius-mm 18", "--ellipse-mm takes 2 numbers.* found 7.4 five"),
        (
            "measure photo x.png --face palmar",
            "give either --ppi, --mm-per-px, --scale-line, --scale-circle, --coin or --grid",
        ),
        ("measure print x.png --ppi 500 --mm-per-px 0.05", "give either .*, found --ppi and --mm-per-px"),
        ("measure print x.png --ppi 500 --roi-px 0,0,nan,9", "--roi-px takes 4 numbers"),
        ("measure print x.png --scale-line 5,5,5,5 --line-mm 3", "--scale-line.* two different ends"),
        (f"{FIELDS}", "give exactly one of --load-n, --area-mm2 and --indentation-mm"),
        (f"{FIELDS} --load-n 90", "would flatten the pad to its silhouette"),
        (f"{FIELDS} --load-n 2 --thickness-mm 400", "leave it out"),
        (
            f"{FIELDS} --load-n 2 --thickness-mm 6 --depth-mm 2 7",
            "--depth-mm must be at least 0 and at most --thickness-mm 6, found 7",
        ),
        ("measure print x.png --scale-line 5,5,5,9", "needs --line-mm"),
        ("measure print x.png --ppi 500 --coin-mm 3", "belongs to --coin.* beside --ppi"),
        ("measure print x.png --coin c.png --coin-mm 23", "c.png: no such file"),
        (
            "measure print x.png --grid g.png --grid-points 7.5,9 --grid-spacing-mm 1",
            "--grid-points: expected a valid integer.* found 7.5",
        ),
        ("measure print x.png --scale-relative-std 0.1", "belongs to --ppi or --mm-per-px"),
        ("run nowhere.toml", "nowhere.toml: no such file; .fingerpad init DIR"),
    ],
)
def test_invalid_input_exit_code(
    arguments: str, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    code, out, err = run(*arguments.split())
    assert code == 2
    assert out == ""
    assert "Traceback" not in err
    assert re.search(message, " ".join(err.replace("│", " ").split()))


def test_measure_print(tmp_path: Path) -> None:
    truth = render_contact_image(semi_major=9.0, semi_minor=6.5, seed=4)
    Image.fromarray(truth.pixels).save(tmp_path / "good.png")
    Image.fromarray(np.full((400, 400), 250, np.uint8)).save(tmp_path / "blank.png")
    (tmp_path / "text.png").write_text("no picture")
    files = [tmp_path / name for name in ("good.png", "blank.png", "text.png", "missing.png")]
    code, out, err = run(
        "measure", "print", *files, "--ppi", 500, "--overlay-dir", tmp_path / "overlays", "--json"
    )
    assert (code, err) == (3, "")
    good, *bad = json.loads(out)
    assert good["file"] == str(files[0])
    assert good["semi_major_mm"] == pytest.approx(9.0, rel=0.02)
    assert good["semi_minor_mm"] == pytest.approx(6.5, rel=0.02)
    assert good["gross_area_mm2"] == pytest.approx(truth.gross_area, rel=0.02)
    assert good["gross_area_mm2"] > good["ridge_area_mm2"] > 0
    assert good["centroid_px"] == pytest.approx(truth.centroid, abs=3)
    assert good["flags"] == []
    assert abs(good["orientation_deg"]) < 2
    for record, path in zip(bad, files[1:], strict=True):
        assert set(record) == {"file", "error"}
        assert record["file"] == str(path)
    with Image.open(tmp_path / "overlays" / "good_overlay.png") as overlay:
        assert overlay.size[0] >= truth.pixels.shape[1]
    assert len(list((tmp_path / "overlays").iterdir())) == 1


def test_help_shows_options_and_commands_in_full() -> None:
    code, out, _ = run("measure", "print", "--help")
    assert code == 0
    assert "  --scale-relative-std <" in out
    code, out, _ = run("--help")
    assert code == 0
    assert (
        out.index("Studies:") < out.index("  init ") < out.index("Single questions:") < out.index("  hertz ")
    )
    text = " ".join(out.split())
    for command in ("run", "geometry", "reproduce", "measure"):
        _, shown, _ = run(command, "--help")
        assert " ".join(shown.split("\n\n")[1].split()) in text


@pytest.mark.parametrize(
    ("given", "found"),
    [(("12.9,14.3",), "12.9,14.3 --load-n"), (("a", "b"), "a b")],
)
def test_numbers_of_one_flag_are_separated_by_spaces(given: tuple[str, ...], found: str) -> None:
    code, _, err = run("hertz", "--radii-mm", *given, "--load-n", 2, "--reduced-modulus-kpa", 100)
    assert code == 2
    assert f"--radii-mm takes 2 numbers separated by spaces, found {found}\n" in err


def test_measure_print_explains_scale_flags_and_overlays(tmp_path: Path) -> None:
    picture = Image.fromarray(render_contact_image(semi_major=9.0, semi_minor=6.5, seed=4).pixels)
    picture.save(tmp_path / "stated.png", dpi=(500, 500))
    code, out, _ = run("measure", "print", tmp_path / "stated.png", "--overlay-dir", tmp_path / "drawn")
    assert code == 0
    assert re.search(r"^mm_per_px +0\.050800 ± 0\.000029\nscale_from +file$", out, re.M)
    assert "check the scale" not in out
    assert "scale taken as exact" not in out
    assert out.endswith(f"Overlays: {tmp_path / 'drawn'}\n")
    code, out, err = run("measure", "print", tmp_path / "stated.png", "--ppi", 50)
    assert "stated.png: the file states 500 ppi, the scale is 50 ppi: check which is right\n" in err
    assert re.search(r"^scale_from +option$", out, re.M)
    assert "\nscale taken as exact\n" in out
    assert "\nscale_doubtful: the ridge period is not that of a finger, or" in out
    assert "Overlays" not in out


def test_measure_print_scale_from_file(tmp_path: Path) -> None:
    picture = Image.fromarray(render_contact_image(semi_major=9.0, semi_minor=6.5, seed=4).pixels)
    picture.save(tmp_path / "stated.png", dpi=(500, 500))
    picture.save(tmp_path / "placeholder.png", dpi=(72, 72))
    picture.save(tmp_path / "silent.png")
    code, out, _ = run("measure", "print", *sorted(tmp_path.glob("*.png")), "--json")
    assert code == 3
    placeholder, silent, stated = json.loads(out)
    assert stated["semi_major_mm"] == pytest.approx(9.0, rel=0.02)
    assert (
        "give either --ppi, --mm-per-px, --scale-line, --scale-circle, --coin or --grid "
        "(the picture's file states 72 dots per inch" in placeholder["error"]
    )
    assert "states no resolution" in silent["error"]


def test_measure_print_seed_and_region(tmp_path: Path) -> None:
    small, large = (render_contact_image(semi_major=a, semi_minor=a / 1.3, seed=4).pixels for a in (5.0, 8.0))
    pixels = np.full((large.shape[0], small.shape[1] + large.shape[1]), 250, np.uint8)
    pixels[: small.shape[0], : small.shape[1]] = small
    pixels[:, small.shape[1] :] = large
    Image.fromarray(pixels).save(tmp_path / "two.png")
    at = f"{small.shape[0] // 2},{small.shape[1] // 2}"
    (free,) = run_json("measure", "print", tmp_path / "two.png", "--ppi", 500)
    (seeded,) = run_json("measure", "print", tmp_path / "two.png", "--ppi", 500, "--seed-px", at)
    roi = f"0,0,{small.shape[0]},{small.shape[1]}"
    (windowed,) = run_json("measure", "print", tmp_path / "two.png", "--ppi", 500, "--roi-px", roi)
    assert free["semi_major_mm"] == pytest.approx(8.0, rel=0.03)
    assert seeded["semi_major_mm"] == pytest.approx(5.0, rel=0.03)
    assert windowed["semi_major_mm"] == pytest.approx(5.0, rel=0.03)


@pytest.fixture
def print_file(tmp_path: Path) -> Path:
    Image.fromarray(render_contact_image(semi_major=9.0, semi_minor=6.5, seed=4).pixels).save(
        tmp_path / "p.png"
    )
    return tmp_path / "p.png"


def test_measure_print_threshold_and_mask(print_file: Path, tmp_path: Path) -> None:
    (tmp_path / "mask.csv").write_text("row_px,column_px\n1,1\n1,330\n230,330\n230,1\n")
    (tmp_path / "line.csv").write_text("row_px,column_px\n1,1\n1,330\n")
    common = ("measure", "print", print_file, "--ppi", 500)
    (free,) = run_json(*common)
    (masked,) = run_json(*common, "--mask", tmp_path / "mask.csv")
    assert "cut_by_mask" in masked["flags"]
    assert masked["gross_area_mm2"] < 0.7 * free["gross_area_mm2"]
    (high,) = run_json(*common, "--threshold", 150)
    (low,) = run_json(*common, "--threshold", 60)
    assert high["ridge_area_mm2"] < low["ridge_area_mm2"]
    code, _, err = run(*common, "--mask", tmp_path / "line.csv")
    assert (code, "needs three corners or more, found 2" in err) == (2, True)


def test_scale_from_ruler_and_coin(print_file: Path, tmp_path: Path) -> None:
    common = ("measure", "print", print_file)
    (known,) = run_json(*common, "--mm-per-px", 0.05)
    line = ("--scale-line", "10,20,10,220", "--line-mm", 10)
    (ruler,) = run_json(*common, *line)
    assert ruler == known
    (doubted,) = run_json(*common, *line, "--line-mm-std", 0.2)
    assert (known["mm_per_px_std"], doubted["mm_per_px_std"]) == pytest.approx((0.0, 0.001))
    gained = doubted["semi_major_mm_std"] ** 2 - ruler["semi_major_mm_std"] ** 2
    assert gained == pytest.approx((0.02 * ruler["semi_major_mm"]) ** 2)
    Image.fromarray(render_coin(radius=120.0, shadow=0.0).pixels).save(tmp_path / "coin.png")
    (coin,) = run_json(*common, "--coin", tmp_path / "coin.png", "--coin-mm", 12)
    assert coin["semi_major_mm"] == pytest.approx(known["semi_major_mm"], rel=2e-3)
    assert coin["semi_major_mm_std"] > known["semi_major_mm_std"]
    code, _, err = run(*common, "--coin", print_file, "--coin-mm", 12)
    assert code == 2
    assert re.search(r"--coin.*p\.png: no coin found", err)


def test_scale_from_circle_and_grid(print_file: Path, tmp_path: Path) -> None:
    common = ("measure", "print", print_file)
    (known,) = run_json(*common, "--mm-per-px", 0.05)
    circle = ("--scale-circle", "0,100,100,0,200,100", "--circle-mm", 10)
    assert run_json(*common, *circle) == [known]
    (doubted,) = run_json(*common, *circle, "--circle-mm-std", 0.2)
    gained = doubted["semi_major_mm_std"] ** 2 - known["semi_major_mm_std"] ** 2
    assert gained == pytest.approx((0.02 * known["semi_major_mm"]) ** 2)
    # Dots 20 px apart: 1 mm each.
    row, column = np.indices((200, 240))
    dots = np.where(np.hypot(row % 20 - 10, column % 20 - 10) < 6, 30, 230).astype(np.uint8)
    dots = np.pad(dots, 20, constant_values=230)
    Image.fromarray(dots).save(tmp_path / "dots.png")
    grid = ("--grid", tmp_path / "dots.png", "--grid-points", "10,12", "--grid-spacing-mm", 1)
    (found,) = run_json(*common, *grid, "--grid-pattern", "dots")
    assert found["semi_major_mm"] == pytest.approx(known["semi_major_mm"], rel=2e-3)
    code, _, err = run(*common, "--grid", print_file, "--grid-points", "7,9", "--grid-spacing-mm", 1)
    assert code == 2
    assert re.search(r"--grid.*p\.png: no grid of 7 × 9 inner corners found", err)


def test_progress_bar_on_terminals_only(
    print_file: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    sequence = EXAMPLE / "synthetic" / "synthetic_press_30deg.tif"
    for command, count in (
        (["print", print_file], 1),
        (["print", print_file, print_file], 2),
        (["sequence", sequence], 24),
    ):
        ours, theirs = pty.openpty()
        with os.fdopen(theirs, "w") as terminal, monkeypatch.context() as patched:
            patched.setattr(sys, "stderr", terminal)
            patched.setenv("TERM", "xterm")  # one that is dumb shows no bar
            with pytest.raises(SystemExit) as end:
                app(["measure", *map(str, command), "--ppi", "240", "--json"])
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
    # As they come out of a drawing program, to a micrometre.
    drawn = {"decimals": 3, "outline_relative_std": 0.01}
    faces = write_outlines(tmp_path, OUTLINES | {"distal": (12.8, 7.9)}, **drawn)
    stated = {"wedge_angle_deg_std": 0.3}
    study = write_study(tmp_path, finger(photographs=faces), contact(axis=""), uncertainty=stated)
    code, out, err = run("run", study, "--out", tmp_path / "out")
    assert (code, "failed" in err) == (0, False)
    (line,) = (line for line in out.splitlines() if line.startswith("doubtful: f:"))
    assert re.search(
        r"faces disagree \(p = .*palmar face: radial–ulnar −\d\.\d %.*; distal face: .*\+\d", line
    )
    (joint,) = summary_of(tmp_path / "out")["fingers"]
    assert 11.8 < joint["radial_ulnar_mm"] < 12.8
    assert joint["p_value"] < 0.01 < joint["between_faces_relative_std"]
    palmar, distal, _ = joint["faces"]
    assert palmar["radial_ulnar_mm"] == pytest.approx(11.8, abs=1e-3)
    assert distal["radial_ulnar_relative_difference"] == pytest.approx(
        12.8 / joint["radial_ulnar_mm"] - 1, abs=1e-4
    )
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "the faces disagree" in page
    assert line.split("): ")[1] in page


def test_measure_photo(tmp_path: Path) -> None:
    truth = render_finger("palmar", semi_axes=(11.8, 13.8), mm_per_px=0.1, tip="left", seed=3)
    Image.fromarray(truth.pixels).save(tmp_path / "palmar.png")
    record = run_json(
        *("measure", "photo", tmp_path / "palmar.png", "--face", "palmar", "--tip", "left"),
        *("--mm-per-px", truth.mm_per_px, "--overlay-dir", tmp_path / "overlays"),
    )
    assert record["semi_axes_mm"] == pytest.approx({"radial_ulnar": 11.8, "distal": 13.8}, rel=0.02)
    assert set(record["semi_axes_mm_std"]) == {"radial_ulnar", "distal"}
    assert record["arc_deg"] > 100
    assert 0 <= record["outlier_fraction"] < 0.3
    assert record["flags"] == []
    assert (tmp_path / "overlays" / "palmar_overlay.png").is_file()
    Image.fromarray(np.full((300, 300, 3), 200, np.uint8)).save(tmp_path / "empty.png")
    code, out, _ = run("measure", "photo", tmp_path / "empty.png", "--face", "palmar", "--ppi", 500, "--json")
    assert code == 3
    assert set(json.loads(out)) == {"file", "error"}


def test_measure_sequence(tmp_path: Path) -> None:
    time = np.linspace(0, 1, 12)
    load = 2 * np.sin(np.pi * time)
    press = render_sequence(load)
    folder = tmp_path / "frames"
    folder.mkdir()
    for index in range(load.size):
        Image.fromarray(press.pixels(index)).save(folder / f"frame{index}.png")
    (folder / "frame5.png").write_bytes(b"torn")
    rows = "\n".join(f"{t},{w},{w}" for t, w in zip(time, load, strict=True))
    (tmp_path / "force.csv").write_text(f"Time (s),Load [N],displacment_mm\n{rows}\n")
    code, out, err = run(
        *("measure", "sequence", folder, "--force", tmp_path / "force.csv", "--frames-per-second", 11),
        *("--ppi", press.ppi, "--json"),
    )
    assert code == 3
    assert "displacement: --column displacement=displacment_mm:mm" in err
    frames = json.loads(out)
    assert [frame["frame"] for frame in frames] == list(range(12))
    assert [frame["time_s"] for frame in frames] == pytest.approx(time)
    assert [frame["load_N"] for frame in frames] == pytest.approx(load, abs=1e-9)
    assert "error" in frames[5]
    assert frames[6]["gross_area_mm2"] == pytest.approx(press.gross_area[6], rel=0.03)
    common = ("measure", "sequence", folder, "--ppi", press.ppi, "--frames-per-second", 11, "--json")
    rows, columns = press.pixels(0).shape
    _, out, _ = run(*common, "--roi-px", f"0,0,{rows // 2},{columns}")
    halves = json.loads(out)
    assert "cut_by_mask" in halves[6]["flags"]
    assert halves[6]["gross_area_mm2"] == pytest.approx(press.gross_area[6] / 2, rel=0.05)
    table = (tmp_path / "force.csv").read_text().replace("Load [N],displacment_mm", "Fz,z")
    (tmp_path / "other.csv").write_text(table)
    other = ("--force", tmp_path / "other.csv", "--column")
    assert "--column force=HEADER:UNIT" in run(*common, *other[:2])[2]
    named = [frame["load_N"] for frame in json.loads(run(*common, *other, "force=Fz:mN")[1])]
    assert named == pytest.approx(load / 1000, abs=1e-12)
    assert (
        "--column takes QUANTITY=NAME:UNIT with time, force, trigger" in run(*common, *other, "area=A:mm2")[2]
    )
    assert "--column names columns of --force" in run(*common, "--column", "force=Fz:mN")[2]
    code, _, err = run(*common, "--start-s", 0.1, "--contact-load-n", 1)
    assert (code, "give either the time of the first frame or the load" in err) == (2, True)
    (tmp_path / "times.csv").write_text("time_s\n0\n1\n")
    code, _, err = run(*common, "--times", tmp_path / "times.csv")
    assert (code, "there is no use for --frames-per-second" in err) == (2, True)
    stamps = "\n".join(f"{k / 11}" for k in range(load.size))
    (tmp_path / "zeiten.csv").write_text(f"Zeit\n{stamps}\n")
    timed = (*common[:5], "--json", "--times", tmp_path / "zeiten.csv")
    code, _, err = run(*timed)
    assert (code, "--column frame_time=HEADER:UNIT" in err) == (2, True)
    named = json.loads(run(*timed, "--column", "frame_time=Zeit:s")[1])
    assert [frame["time_s"] for frame in named] == pytest.approx(np.arange(load.size) / 11)
    assert "names the column of --times" in run(*common, "--column", "frame_time=Zeit:s")[2]
    code, out, err = run("measure", "sequence", folder, "--ppi", 300, "--frames-per-second", -1)
    assert code == 2
    assert "--frames-per-second" in err


def test_reproduce_lists_every_printed_number(tmp_path: Path) -> None:
    records = run_json("reproduce")
    items = {record["item"]: record for record in records}
    table2 = [record for record in records if record["item"].startswith("Table 2")]
    assert len(table2) == 10
    assert {record["verdict"] for record in table2} == {"reproduced", "reproduced with the known misprint"}
    at_30 = items["Table 2, ellipse, u = 30°"]
    assert at_30["printed"] == 25.3
    assert at_30["computed"] == pytest.approx(17.11, abs=5e-3)
    assert at_30["unit"] == "mm"
    thickness = items["One layer, effective thickness t"]
    assert (thickness["printed"], thickness["unit"]) == (None, "mm")
    assert thickness["computed"] == pytest.approx(7.93, abs=5e-3)
    assert {frozenset(record) for record in records} == {frozenset(thickness)}
    code, out, _ = run("reproduce", "--figures", tmp_path / "figures")
    assert code == 0
    assert all(item in out for item in items)
    names = {path.name for path in (tmp_path / "figures").iterdir()}
    assert len(names) >= 2 * 5
    assert {Path(name).suffix for name in names} == {".svg", ".png"}


def test_init_then_run(tmp_path: Path) -> None:
    code, out, _ = run("init", tmp_path / "mine")
    assert code == 0
    assert "study.toml" in out
    assert "examples: replace them" in out
    assert run("init", tmp_path / "mine")[0] == 2
    code, out, _ = run("run", tmp_path / "mine" / "study.toml", "--out", tmp_path / "results")
    assert code == 0
    modulus, radius = r"modulus 67.1 ± 5.0 kPa \(2 N\), bone unknown", "corrected radius 13.80 ± 0.90 mm"
    assert re.search(
        rf"^left_index, 30° \(synthetic\): {modulus}; Hertz theory fails \(.*\); {radius}\.$", out, re.M
    )
    assert "fails where by more than 20%" in out
    names = {"report.html", "results.csv", "results_columns.csv", "results.json", "summary.json"}
    assert names <= {path.name for path in (tmp_path / "results").iterdir()}


def test_init_from_files(tmp_path: Path) -> None:
    files = tmp_path / "photos"
    run("init", "--example", tmp_path / "example")
    files.mkdir()
    shutil.copy(tmp_path / "example" / "contact_1N.png", files / "IMG_0033.png")
    shutil.copy(tmp_path / "example" / "photograph_palmar.jpg", files / "left_index_palmar.jpg")
    code, out, _ = run("init", "--from-files", files)
    assert code == 0
    assert "left_index_palmar.jpg: photograph" in out
    assert "Not taken:\n  IMG_0033.png: nothing states its finger: give --finger NAME" in out
    assert run("init", "--from-files", files)[0] == 2  # nothing is overwritten
    (files / "study.toml").unlink()
    (files / "study.schema.json").unlink()
    code, out, _ = run("init", "--from-files", "--finger", "left_index", files)
    assert "IMG_0033.png: contact image" in out
    assert "observation IMG_0033: the load is missing" in out
    assert "Not taken" not in out
    for wrong in (("--finger", "x"), ("--scale", "500 ppi"), ("--from-files", "--example")):
        assert run("init", *wrong, tmp_path / "other")[0] == 2


def test_two_commands_from_prints_to_area_against_load(tmp_path: Path) -> None:
    run("init", "--example", tmp_path / "example")
    files = tmp_path / "prints"
    files.mkdir()
    for load, written in (("0.5", "0,5"), ("1", "1"), ("2", "2")):
        # What the picture says of its resolution holds less than what the person says.
        print_ = Image.open(tmp_path / "example" / f"contact_{load}N.png")
        print_.save(files / f"LI_{written}N.png", dpi=(300, 300))
    begin = ("init", "--from-files", "--finger", "left_index", "--wedge-deg", 30, files)
    code, _, err = run(*begin, "--scale", "fine")
    assert (code, (files / "study.toml").exists()) == (2, False)
    assert "write it as 500 ppi or 0.05 mm/px" in err
    code, out, _ = run(*begin, "--scale", "500 ppi")
    assert code == 0
    assert "Run it: " in out
    assert "300 ppi" not in out
    code, out, _ = run("run", files)
    assert code == 0
    assert re.search(r"^left_index, 30°: contact area 116\.\d ± \d\.\d mm² under 2 N; no modulus", out, re.M)
    by_load = pd.read_csv(files / "results" / "by_load.csv")
    assert list(by_load["load_N"]) == [0.5, 1.0, 2.0]
    # Of elliptical Hertz theory for the pad and the tissue that the example was rendered with.
    assert np.all(np.abs(by_load["contact_area_mm2"] / [46.39, 73.64, 116.9] - 1) < 0.03)


def test_results_beside_manifest(tmp_path: Path) -> None:
    run("init", tmp_path / "mine")
    assert run("run", tmp_path / "mine")[0] == 0
    assert {path.name for path in tmp_path.iterdir()} == {"mine"}
    for study in (tmp_path / "mine", tmp_path / "mine" / "study.toml"):
        assert json.loads(run("status", study, "--json")[1])["done"] == 1
        assert run("verify", study)[0] == 0


def test_run_reports_failures_and_continues(run_demo: Path, tmp_path: Path) -> None:
    study = Path(shutil.copytree(run_demo, tmp_path / "study"))
    head, *curves = (study / "study.toml").read_text(encoding="utf-8").split("[[curves]]")
    kept = [curve for curve in curves if "file =" not in curve]  # they take long to fit
    (study / "study.toml").write_text("[[curves]]".join([head, *kept]), encoding="utf-8")
    (study / "synthetic" / "synthetic_30deg_1N.png").write_bytes(b"\x89PNG")
    out = study / "results"  # what is stored there is not measured again
    code, stdout, err = run("run", study / "study.toml", "--out", out)
    assert code == 3
    assert "failed: synthetic_30deg_1N: synthetic/synthetic_30deg_1N.png" in err
    assert "synthetic_pad, 30° (synthetic): modulus " in stdout
    assert "synthetic_30deg_1N" in (out / "report.html").read_text(encoding="utf-8")


def test_invalid_manifest_stops_run(tmp_path: Path) -> None:
    study = Path(shutil.copytree(EXAMPLE, tmp_path / "study"))
    text = (study / "study.toml").read_text(encoding="utf-8").replace("poisson_ratio = 0.5", "poisson = 0.5")
    (study / "study.toml").write_text(text, encoding="utf-8")
    code, _, err = run("run", study / "study.toml", "--out", tmp_path / "out")
    assert code == 2
    assert "study.toml: poisson: unknown key; did you mean 'poisson_ratio'?" in err
    assert not err.startswith("\n")
    assert not (tmp_path / "out").exists()


def test_uncreatable_output_folder(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    code, _, err = run("run", EXAMPLE / "study.toml", "--out", tmp_path / "file" / "out")
    assert code == 2
    assert "cannot make this folder" in err


def test_overlay_names_do_not_collide(tmp_path: Path) -> None:
    pixels = render_contact_image(seed=4).pixels
    for name in ("1/x.png", "2/x.png", "2/x_overlay.png"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        Image.fromarray(pixels).save(tmp_path / name)
    before = (tmp_path / "2" / "x_overlay.png").read_bytes()
    files = [tmp_path / name for name in ("1/x.png", "2/x.png", "2/x_overlay.png")]
    assert run("measure", "print", *files, "--ppi", 500, "--overlay-dir", tmp_path / "2")[0] == 0
    assert (tmp_path / "2" / "x_overlay.png").read_bytes() == before
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


def test_console_encodings(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "fingerpad", "reproduce"],
        capture_output=True,
        env={**os.environ, "PYTHONIOENCODING": "cp1252"},
    )
    assert done.returncode == 0
    assert b"Table 4" in done.stdout


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


@pytest.mark.parametrize(
    ("package", "heavy"),
    [
        ("fingerpad.contact", "matplotlib, cv2, PIL, pydantic, typer, rich, jinja2, tifffile"),
        ("fingerpad.cli", "matplotlib, cv2, PIL, pydantic, scipy, pandas, jinja2, tifffile"),
    ],
)
def test_import_is_light(package: str, heavy: str) -> None:
    script = f"import sys, {package}; print([m for m in '{heavy}'.split(', ') if m in sys.modules])"
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True, env={**os.environ}
    )
    assert done.stdout.strip() == "[]"


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
    code, out, _ = run("run", study := write_study(tmp_path, pad))
    assert code == 0
    axes = "palmar 7.90 ± 0.10 mm, distal 13.80 ± 0.20 mm, radial–ulnar 11.80 ± 0.30 mm"
    assert f"f: semi-axes {axes}; no contact is given\n" in out
    pixels = render_contact_image(semi_major=4.0, semi_minor=3.0, seed=1).pixels
    for name, shown in (("coarse", pixels), ("empty", np.zeros_like(pixels))):
        Image.fromarray(shown).save(tmp_path / f"{name}.png")
    write_study(tmp_path, pad, *(picture(n, f"{n}.png", 1, scale={"ppi": 50}) for n in ("coarse", "empty")))
    code, out, _ = run("run", study)
    assert code == 3
    assert re.search(r"^f, 30°: 0 of 1 contact pooled: .*the ridge period is not that", out, re.M)
    assert "f, 30°: no modulus and no corrected radius, as none of 1 contact counts.\n" in out
    assert run("status", study)[1].endswith("failed: empty\n")
