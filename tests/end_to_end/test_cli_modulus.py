"""The command that finds a modulus, and Hertz theory with a layer beside it."""

import math

import pytest
from tests.command import run, run_json

from fingerpad.contact import Tissue, fast_contact, hertz_contact, youngs_modulus
from fingerpad.geometry import Ellipsoid, Paraboloid, Placement

PAD = ("--semi-axes-mm", 7.9, 13.8, 11.8, "--wedge-deg", 30)
PLACEMENT = Placement(Ellipsoid(7.9, 13.8, 11.8), wedge_angle=math.radians(30))
KEYS = {
    "load_N",
    "area_mm2",
    "indentation_mm",
    "area_over_pi_indentation_mm",
    "reduced_modulus_kpa",
    "youngs_modulus_kpa",
}


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
    assert set(record["hertz"]) == KEYS
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
