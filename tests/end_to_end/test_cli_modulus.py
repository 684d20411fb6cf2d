"""The commands that find a modulus, apply Hertz theory with a layer, and solve the contact of a whole pad."""

import math
import re

import pytest
from tests.command import printed, refusal, run, run_json

from fingerpad.contact import Tissue, fast_contact, hertz_contact, solve_contact, youngs_modulus
from fingerpad.geometry import Ellipsoid, Paraboloid, Placement

PAD = ("--semi-axes-mm", 7.9, 13.8, 11.8, "--wedge-deg", 30)
PLACEMENT = Placement(Ellipsoid(7.9, 13.8, 11.8), wedge_angle=math.radians(30))
OF_ALL = {"load_N", "area_mm2", "indentation_mm", "area_over_pi_indentation_mm"}
KEYS = OF_ALL | {"reduced_modulus_kpa", "youngs_modulus_kpa"}


@pytest.mark.parametrize(("given", "thickness"), [("area", 8), ("indentation", None)])
def test_both_theories(given: str, thickness: float | None) -> None:
    flag, value = {"area": ("--area-mm2", 100.0), "indentation": ("--indentation-mm", 1.5)}[given]
    layer = () if thickness is None else ("--thickness-mm", thickness)
    press = ("--load-n", 1.5, flag, value, "--poisson-ratio", 0.45)
    record = run_json("modulus", *PAD, *press, *layer)
    tissue = {"poisson_ratio": 0.45, "thickness": thickness or math.inf}
    modulus = youngs_modulus(PLACEMENT, load=1.5, **tissue, **{given: value})
    whole = fast_contact(PLACEMENT, Tissue(modulus, **tissue), load=1.5)
    assert set(record) == {*KEYS, "flag", "thickness_mm", "hertz"}
    assert set(record["hertz"]) == {*KEYS, "flag"}
    assert record["hertz"]["flag"] == (None if thickness is None else "thickness_ignored")
    said = "Hertz theory takes the layer for deep tissue" in run("modulus", *PAD, *press, *layer)[1]
    assert said == (thickness is not None)
    assert record["flag"] is None
    assert record["youngs_modulus_kpa"] == pytest.approx(1000 * modulus, rel=1e-3)
    assert record["area_over_pi_indentation_mm"] == pytest.approx(whole.area_over_pi_indentation, rel=1e-3)
    unit = hertz_contact(PLACEMENT, Tissue.of_reduced_modulus(1.0), **{given: value})
    assert record["hertz"]["reduced_modulus_kpa"] == pytest.approx(1000 * 1.5 / unit.load)


def test_out_of_range_is_said() -> None:
    press = ("modulus", *PAD, "--load-n", 2, "--area-mm2", 300, "--thickness-mm", 8)
    record = run_json(*press)
    assert (record["flag"], record["youngs_modulus_kpa"]) == ("contact_too_wide", None)
    _, out, _ = run(*press)
    assert "The fast laws do not hold here: contact too wide" in out
    assert "nan" not in out
    wide, usual = (run("modulus", *PAD, "--load-n", 2, "--area-mm2", area)[1] for area in (600, 90))
    assert "Hertz theory does not hold here: the contact's radius is 1 times that of curvature" in wide
    assert "does not hold" not in usual


@pytest.mark.parametrize(
    ("pad", "press", "words"),
    [
        (PAD, (2000, 90), "more than 100 N: is the load in millinewtons?"),
        (PAD, (2, 0.09), "outside 1–5000 kPa: check load and units"),
        (("--semi-axes-mm", 13.8, 7.9, 11.8, *PAD[4:]), (2, 90), "palmar 13.8 mm is more than distal"),
        (("--semi-axes-mm", 0.8, 1.4, 1.2, *PAD[4:]), (2, 90), "0.8 mm is less than any pad has"),
        ((*PAD[:5], 0.5236), (2, 90), "--wedge-deg: less than 1.6°: angles are in degrees"),
        ((*PAD, "--thickness-mm", 8000), (2, 90), "8000 mm of tissue over bone, as of no fingertip"),
        ((*PAD, "--thickness-mm", 0.4), (2, 0.9), "--thickness-mm: 0.4 mm of tissue over bone"),
        ((*PAD, "--thickness-mm", 8), (2, 90), ""),
        (PAD, (2, 90), ""),
    ],
)
def test_other_units_and_another_order_are_noted(
    pad: tuple[object, ...], press: tuple[float, float], words: str
) -> None:
    code, _, err = run("modulus", *pad, "--load-n", press[0], "--area-mm2", press[1])
    assert (code, words in err, bool(err)) == (0, True, bool(words))


def test_hertz_has_a_layer_beside_it() -> None:
    press = ("hertz", "--radii-mm", 12.9, 14.3, "--load-n", 1, "--reduced-modulus-kpa", 90)
    record, plain = run_json(*press, "--thickness-mm", 6, "--poisson-ratio", 0.48), run_json(*press)
    tissue = Tissue.of_reduced_modulus(0.09, 0.48, thickness=6.0)
    found = fast_contact(Paraboloid(12.9, 14.3), tissue, load=1.0)
    layer = record.pop("on_layer")
    assert record == plain
    assert layer["area_mm2"] == pytest.approx(found.area)
    assert layer["indentation_mm"] == pytest.approx(found.indentation)
    assert layer["flag"] is None
    assert "flag" not in run(*press, "--thickness-mm", 6)[1]
    assert "flag layer_too_thin" in run(*press, "--thickness-mm", 0.3)[1]


SOLVE = ("solve", *PAD, "--youngs-modulus-kpa", 102.375)
OF_ELLIPSE = {"semi_major_mm", "semi_minor_mm", "aspect_ratio", "long_axis_along"}
SOLVED = OF_ALL | OF_ELLIPSE | {"peak_pressure_kpa", "relative_error_estimate"}


def test_a_light_touch_is_hertzian() -> None:
    record = run_json(*SOLVE, "--load-n", 1e-3)
    fast, hertz = record.pop("fast"), record.pop("hertz")
    assert set(hertz) == set(fast) == {*SOLVED, "flag"}
    assert set(record) == SOLVED
    assert hertz["flag"] is None
    sizes = SOLVED - {"long_axis_along", "relative_error_estimate"}
    for found in (record, fast):
        assert {key: found[key] for key in sizes} == pytest.approx(
            {key: hertz[key] for key in sizes}, rel=1e-3
        )
    assert max(record["relative_error_estimate"], hertz["relative_error_estimate"]) < 1e-3


def test_a_layer_is_what_the_library_solves() -> None:
    record = run_json(*SOLVE, "--load-n", 2, "--thickness-mm", 8, "--grid", 128, "--poisson-ratio", 0.45)
    tissue = Tissue(0.102375, poisson_ratio=0.45, thickness=8.0)
    solution = solve_contact(PLACEMENT, tissue, load=2.0, points=128)
    expected = {
        "load_N": 2,
        "area_mm2": solution.area,
        "indentation_mm": solution.indentation,
        "aspect_ratio": solution.aspect_ratio,
        "peak_pressure_kpa": 1e3 * solution.peak_pressure,
        "area_over_pi_indentation_mm": solution.area / (math.pi * solution.indentation),
    }
    assert {key: record[key] for key in expected} == pytest.approx(expected)
    hertz = hertz_contact(PLACEMENT, tissue, load=2.0)
    assert record["hertz"]["area_mm2"] == pytest.approx(float(hertz.area))
    assert record["hertz"]["flag"] == "thickness_ignored"
    off = float(hertz.indentation) / solution.indentation - 1
    assert record["hertz"]["relative_error_estimate"] == pytest.approx(off)


def test_fast_laws_say_nothing_beyond_their_range() -> None:
    arguments = (*SOLVE, "--load-n", 2, "--thickness-mm", 1, "--grid", 64)
    fast = run_json(*arguments)["fast"]
    assert fast.pop("flag") == "layer_too_thin"
    assert set(fast.values()) == {None}
    assert "The fast laws do not hold here: layer too thin" in run(*arguments)[1]


@pytest.mark.parametrize(
    ("semi_axes", "wedge", "along"),
    [((8, 20, 12), 0, "first"), ((8, 14, 12), 60, "second"), ((9, 9, 9), 20, "either")],
)
def test_long_axis(semi_axes: tuple[float, ...], wedge: float, along: str) -> None:
    pad = ("--semi-axes-mm", *semi_axes, "--wedge-deg", wedge, "--youngs-modulus-kpa", 100)
    record = run_json("solve", *pad, "--load-n", 0.5, "--grid", 64)
    assert (record["long_axis_along"], record["hertz"]["long_axis_along"]) == (along, along)


def test_people_see_a_column_for_each_answer() -> None:
    out = printed(*SOLVE, "--load-n", 2, "--grid", 64)
    head, *rows = out.splitlines()
    assert head.split() == ["solved", "fast", "hertz"]
    assert {row.split()[0] for row in rows} >= SOLVED
    area = next(row for row in rows if row.startswith("area_mm2")).split()
    assert float(area[1]) < float(area[-1])


def test_what_does_not_converge_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fingerpad.contact.pressure._STEPS", 2)
    words = r"--load-n 2: the contact pressure did not converge in 2 steps: .*; try another --grid"
    assert re.fullmatch(f"fingerpad: {words}", refusal(*SOLVE, "--load-n", 2, "--grid", 64))
