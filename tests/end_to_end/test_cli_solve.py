"""The command that solves the contact of a whole pad."""

import math
import re
from functools import partial

import pytest
from tests import command

from fingerpad.contact import Tissue, hertz_contact, solve_contact
from fingerpad.geometry import Ellipsoid, Placement

PAD = ("--semi-axes-mm", 7.9, 13.8, 11.8, "--wedge-deg", 30, "--youngs-modulus-kpa", 102.375)
KEYS = {
    "load_N", "area_mm2", "semi_major_mm", "semi_minor_mm", "aspect_ratio", "long_axis_along",
    "indentation_mm", "area_over_pi_indentation_mm", "peak_pressure_kpa", "relative_error_estimate",
}  # fmt: skip
run, printed = partial(command.run, "solve"), partial(command.printed, "solve")
run_json = partial(command.run_json, "solve")


def test_a_light_touch_is_hertzian() -> None:
    record = run_json(*PAD, "--load-n", 1e-3)
    fast, hertz = record.pop("fast"), record.pop("hertz")
    assert set(hertz) == set(fast) == {*KEYS, "flag"}
    assert set(record) == KEYS
    assert hertz["flag"] is None
    sizes = KEYS - {"long_axis_along", "relative_error_estimate"}
    for found in (record, fast):
        assert {key: found[key] for key in sizes} == pytest.approx(
            {key: hertz[key] for key in sizes}, rel=1e-3
        )
    assert max(record["relative_error_estimate"], hertz["relative_error_estimate"]) < 1e-3


def test_a_layer_is_what_the_library_solves() -> None:
    record = run_json(*PAD, "--load-n", 2, "--thickness-mm", 8, "--grid", 128, "--poisson-ratio", 0.45)
    placement = Placement(Ellipsoid(7.9, 13.8, 11.8), wedge_angle=math.radians(30))
    tissue = Tissue(0.102375, poisson_ratio=0.45, thickness=8.0)
    solution = solve_contact(placement, tissue, load=2.0, points=128)
    expected = {
        "load_N": 2,
        "area_mm2": solution.area,
        "indentation_mm": solution.indentation,
        "aspect_ratio": solution.aspect_ratio,
        "peak_pressure_kpa": 1e3 * solution.peak_pressure,
        "area_over_pi_indentation_mm": solution.area / (math.pi * solution.indentation),
    }
    assert {key: record[key] for key in expected} == pytest.approx(expected)
    hertz = hertz_contact(placement, tissue, load=2.0)
    assert record["hertz"]["area_mm2"] == pytest.approx(float(hertz.area))
    assert record["hertz"]["flag"] == "thickness_ignored"
    off = float(hertz.indentation) / solution.indentation - 1
    assert record["hertz"]["relative_error_estimate"] == pytest.approx(off)


def test_fast_laws_say_nothing_beyond_their_range() -> None:
    arguments = (*PAD, "--load-n", 2, "--thickness-mm", 1, "--grid", 64)
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
    record = run_json(*pad, "--load-n", 0.5, "--grid", 64)
    assert (record["long_axis_along"], record["hertz"]["long_axis_along"]) == (along, along)


def test_people_see_a_column_for_each_answer() -> None:
    out = printed(*PAD, "--load-n", 2, "--grid", 64)
    head, *rows = out.splitlines()
    assert head.split() == ["solved", "fast", "hertz"]
    assert {row.split()[0] for row in rows} >= KEYS
    area = next(row for row in rows if row.startswith("area_mm2")).split()
    assert float(area[1]) < float(area[-1])


def test_what_does_not_converge_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fingerpad.contact.pressure._STEPS", 2)
    words = r"--load-n 2: the contact pressure did not converge in 2 steps: .*; try another --grid"
    assert re.fullmatch(f"fingerpad: {words}", command.refusal("solve", *PAD, "--load-n", 2, "--grid", 64))
