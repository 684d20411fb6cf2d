"""``fingerpad fit``: what scripts read, what people see, and what is refused."""

import json
import re
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests import command
from tests.studies import write_curve, write_numbers

from fingerpad.simulate import simulate_loading_curve

run, printed = partial(command.run, "fit"), partial(command.printed, "fit")
# Known to be so, neither a layer nor a yielding stage is fitted as another explanation: three times as fast.
RIGID = "--stage-compliance-mm-per-n", 0
DEEP = (*RIGID, "--thickness-mm", "inf")


def fitted(*arguments: object) -> dict[str, Any]:
    return json.loads(run(*arguments, "--json")[1])


@pytest.fixture
def curve(tmp_path: Path) -> Path:
    record = simulate_loading_curve(
        loading_radius=15.0, initial_modulus=0.04, load_coefficient=0.02, contact_offset=1.0,
        hold=5.0, unloading=True, points=200, force_std=0.004, displacement_std=0.004, area_std=1.0,
    )  # fmt: skip
    write_curve(tmp_path / "press.csv", record)
    return tmp_path / "press.csv"


def test_json_keys(curve: Path) -> None:
    record = fitted(curve)
    truth = {
        "loading_radius_mm": 15,
        "contact_offset_mm": 1.0,
        "initial_modulus_kpa": 40,
        "load_coefficient_kpa_per_N": 20,
    }
    others = ("reduced_modulus_kpa", "youngs_modulus_kpa", "load_exponent", "area_exponent")
    for name in (*truth, *others):
        low, high = record[f"{name}_ci95"]
        assert low < record[name] < high
        assert record[f"{name}_std"] > 0
    for name, true in truth.items():
        assert record[name] == pytest.approx(true, abs=4 * record[f"{name}_std"])
    (segments,) = record["segments"]
    assert list(segments) == ["baseline", "loading", "hold", "unloading"]
    assert (segments["baseline"][0], segments["unloading"][1]) == (0, 199)
    assert isinstance(record["flags"], list)


def test_undetermined_is_null_with_reason(curve: Path, tmp_path: Path) -> None:
    bare = tmp_path / "bare.csv"
    rows = np.loadtxt(curve, delimiter=",", skiprows=1)[:, [1, 2]] * [1000, 1]
    write_numbers(bare, "Fz,stage", rows)
    columns = ("--column", "force=Fz:mN", "--column", "displacement=stage:mm")
    record = fitted(bare, *columns)
    of_area = "loading_radius_mm", "youngs_modulus_kpa", "initial_modulus_kpa", "area_exponent"
    for name in (*of_area, "load_coefficient_kpa_per_N"):
        assert record[name] is record[f"{name}_std"] is record[f"{name}_ci95"] is None
        assert "no contact area" in record["reasons"][name]
    assert record["contact_offset_mm"] == pytest.approx(1.0, abs=4 * record["contact_offset_mm_std"])
    helped = fitted(bare, *columns, "--loading-radius-mm", 15, "--loading-radius-mm-std", 0.5)
    assert helped["initial_modulus_kpa"] == pytest.approx(40, rel=0.1)
    # With a radius it is the areas that an exponent of them lacks.
    reason = helped["reasons"]["area_exponent"]
    assert reason.startswith("no contact area in the curve: give a column area_mm2")


def test_what_is_wrong_with_a_table_is_said_with_the_flag_to_paste(tmp_path: Path) -> None:
    given = simulate_loading_curve(points=200, force_std=0.005, area_std=0.5, seed=1)
    rows = np.column_stack([1000 * given.load, given.indentation, given.area])
    path = tmp_path / "curve.csv"

    def fitted(header: str, *arguments: str) -> tuple[str, str]:
        write_numbers(path, header, rows)
        return run(path, *arguments, *DEEP)[1:]

    out, err = fitted("Fz (mN),Disp (mm),Area (mm2)")
    found = re.search(r"--column '(.*)'", err)
    assert not out
    assert found
    assert found[1] == "force=Fz (mN):mN"
    read, err = fitted("Fz (mN),Disp (mm),Area (mm2)", "--column", found[1])
    assert "loading radius R_g           1" in read
    assert not err

    out, err = fitted("force_mN,displacement_mm,aera_mm2")
    assert err == "note: column 'aera_mm2' was not read; if it is the area: --column area=aera_mm2:mm2\n"
    assert out.count("no contact area in the curve") == out.count("--loading-radius-mm") == 1
    assert fitted("force_mN,displacement_mm,aera_mm2", "--column", "area=aera_mm2:mm2")[0] == read

    out, err = fitted("force_N,displacement_mm,area_mm2")
    assert re.match(r"note: loads up to 20.* N: is the force in millinewtons", err)
    assert re.search(r"flag implausible_modulus", out)


HEAD = "force_N,displacement_mm\n"


@pytest.mark.parametrize(
    ("text", "arguments", "message"),
    [
        (f"{HEAD}0,0\n1,1\n", "", "points|rows"),
        (HEAD + "0.5,1\n" * 40, "", "0.5 N in every row"),
        (HEAD + "\n".join(f"0,{k}" for k in range(40)), "", "no contact|range|load"),
        (HEAD + "\n".join(f"{-k},{k}" for k in range(40)), "", "sign"),
        ("time_s,force_N,displacement_mm\n0,0,0\n2,1,1\n1,2,2\n", "", "time runs backwards"),
        (f"{HEAD}0,0\n1,1\n", "--area-delay-s 0.1", "add its column of time"),
        (None, "--column force=Fz", "QUANTITY=NAME:UNIT"),
        (None, "--column force=force_N:mN", "'force_N' says N, and .* given as mN: .*force=force_N:N$"),
        (None, "--load-range-n 2 1", "two rising loads"),
        (None, "--cycle 7", "cycle"),
        (None, "--area-delay-s-std 1", "goes with --area-delay-s"),
        (None, "--wedge-deg 30", "go with --semi-axes-mm"),
        (None, "--thickness-mm 6 --semi-axes-mm 7.9 13.8 11.8 --wedge-deg 30", "give one of them"),
        (None, "--law ogden", "no contact law 'ogden'"),
        (None, "--law laws.csv:ogden", "cannot be imported"),
    ],
)
def test_invalid_arguments(curve: Path, text: str | None, arguments: str, message: str) -> None:
    if text is not None:
        curve.write_text(text)
    code, out, err = run(curve, *arguments.split(), "--json")
    assert (code, out) == (2, "")
    assert err.startswith("fingerpad: ")
    assert re.search(message, err), err
    assert err.count("\n") == 1


def test_semi_axes_add_the_layer_and_change_nothing_else(curve: Path, tmp_path: Path) -> None:
    pad = "--semi-axes-mm", 7.9, 13.8, 11.8, "--wedge-deg", 30, "--pad-radius-mm-std", 0.5
    plain, whole = fitted(curve, *RIGID), fitted(curve, *pad, *RIGID)
    layer = whole.pop("layer")
    assert whole == plain
    assert layer["radius_mm_std"] < 0.5
    assert "Hertz theory" in layer["reasons"]["thickness_mm"]  # which the curve was made by
    assert sum(layer["weights"].values()) == pytest.approx(1)
    # A pad far from round: the curve asks for another radius.
    out = printed(curve, "--semi-axes-mm", 6, 6, 6, *pad[4:6], "--pad-radius-mm-std", 0.1, *RIGID)
    assert out.startswith("layer: t")
    assert "\nmodulus: " in out  # two moduli never stand without a word which to believe
    flags = [line for line in out.splitlines() if "of the layer" in line]
    assert flags
    assert all(line.startswith("flag ") and "To do: " in line for line in flags)


LAW = """
import numpy as np
import fingerpad as fp

@fp.contact_law(
    parameters={"youngs_modulus": (0, None), "stiffening": (-0.5, 50)},
    units={"youngs_modulus": "MPa", "stiffening": "1/mm"},
)
def stiffening(indentation, *, loading_radius, poisson_ratio, youngs_modulus, stiffening):
    hertz = 4 / 3 * youngs_modulus / (1 - poisson_ratio**2) * np.sqrt(loading_radius) * indentation**1.5
    return hertz * (1 + stiffening * indentation**1.5)
"""


@pytest.mark.usefixtures("own_laws")
def test_own_law(curve: Path) -> None:
    laws = curve.with_name("my_laws.py")
    laws.write_text(LAW)
    law, drawn = ("--law", f"{laws}:stiffening", *DEEP), curve.with_name("figures")
    out = printed(curve, *law, "--plot", drawn)
    assert "law stiffening, fitted to the loading" in out
    assert re.search(r"^  stiffening +[\d.]+ ± [\d.]+ 1/mm +[\d.]+ to [\d.]+ 1/mm$", out, re.MULTILINE)
    assert re.search(r"^  youngs_modulus +[\d.]+ ± [\d.]+ kPa", out, re.MULTILINE)
    assert "stiffening explains the loading" in out
    names = ("load_indentation", "residuals", "compliance", "relaxation")
    names += ("secant_modulus_load", "secant_modulus_indentation")
    assert {path.name for path in drawn.glob("*.svg")} == {f"press_{name}.svg" for name in names}
    assert "stiffening" in (drawn / "press_load_indentation.json").read_text()
    found = fitted(curve, *law)["law"]
    assert [each["name"] for each in found["parameters"]] == ["youngs_modulus", "stiffening"]
    assert set(found["aicc"]) == {"load_dependent", "hertz", "free_exponent", "stiffening"}
