"""The command that gives a pad in the numbers of robot simulators."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from tests import command
from tests.studies import contact, finger, write_study

import fingerpad as fp
from fingerpad._rounding import value_with_uncertainty
from fingerpad.study.results import load as of_run
from fingerpad.study.results.summary_file import CurveRecord, SummaryFile, ThicknessFitRecord

pytestmark = pytest.mark.usefixtures("coarse_elements")
PAD = ("--semi-axes-mm", 7.9, 13.8, 11.8, "--wedge-deg", 30)
USUAL = (*PAD, "--youngs-modulus-kpa", 50, "--thickness-mm", 8)
PLACE = fp.Placement(fp.Ellipsoid(7.9, 13.8, 11.8), wedge_angle=math.radians(30))
STDS = {"palmar": 0.1, "distal": 0.2, "radial_ulnar": 0.3}
THICK = {"effective_thickness_mm": 6, "effective_thickness_mm_std": 0.5}


def run_json(*arguments: object):
    """Return what the command prints with ``--json``, and what it notes, on one line."""
    code, out, err = command.run("simulator", *arguments, "--json")
    assert code == 0, err
    return json.loads(out), " ".join(err.split())


@pytest.fixture(scope="module")
def results(tmp_path_factory) -> dict[str, Path]:
    made = {}
    press = contact("press", 2, (6, 5), finger="left_index", axis="")
    for name, thickness in (("deep", {}), ("layer", THICK)):
        folder = tmp_path_factory.mktemp(name)
        pad = finger("left_index", semi_axes_mm_std=STDS, **thickness)
        fp.run_study(
            write_study(folder, pad, press, uncertainty={"wedge_angle_deg_std": 0.3}), folder / "out"
        )
        made[name] = folder / "out"
    return made


def test_json_has_all_targets() -> None:
    record, note = run_json(*USUAL, "--load-n", 0.3, 2, "--mass-kg", 0.2)
    assert note == ""
    law = fp.simulator_law(PLACE, fp.Tissue(0.05, 0.5, 8.0), (0.3, 2.0))
    targets = {
        "pressure_by_depth": law.pressure_by_depth(),
        "newton": law.newton_kh(),
        "drake": law.drake_modulus(),
        "mujoco": law.mujoco(0.2),
        "finite_elements": law.finite_elements(),
    }
    assert set(record) == {*targets, "table"}
    for name, target in targets.items():
        assert record[name]["worst_relative_error"] == pytest.approx(target.worst_relative_error)
        assert record[name]["assumes"] == target.assumes
    assert record["newton"]["kh_N_per_m3"] == pytest.approx(law.newton_kh().kh)
    assert record["mujoco"]["solref"] == pytest.approx(law.mujoco(0.2).solref)
    assert record["mujoco"]["area_factor"] is None
    assert record["table"]["load_N"] == pytest.approx(law.load)
    assert record["table"]["indentation_mm"] == pytest.approx(law.indentation)


def test_text_has_the_same_numbers() -> None:
    stds = ("--youngs-modulus-kpa-std", 5, "--thickness-mm-std", 1, "--semi-axes-mm-std", 0.1)
    out = command.printed("simulator", *USUAL, *stds)
    record, _ = run_json(*USUAL, *stds)
    newton = record["newton"]
    kh = value_with_uncertainty(newton["kh_N_per_m3"] / 1e6, newton["kh_N_per_m3_std"] / 1e6)
    assert f"{kh} MN/m³" in out
    assert "5.7 %" in out
    assert " ".join(f"{number:.6g}" for number in record["mujoco"]["solimp"]) in out


def test_small_mass_is_flagged() -> None:
    record, err = run_json(*USUAL, "--mass-kg", 0.001)
    assert record["mujoco"]["flag"] == "time_step_below_default"
    assert record["mujoco"]["largest_time_step_s"] < 0.002
    assert "default time step of 2 ms is unstable" in err


@pytest.mark.parametrize(("name", "thickness"), [("deep", None), ("layer", 6.0), ("layer", 8.0)])
def test_pad_of_a_run_has_the_area_that_was_seen(results, name, thickness) -> None:
    given = () if thickness in {None, 6.0} else ("--thickness-mm", thickness)
    record, note = run_json(results[name], "--finger", "left_index", "--wedge-deg", 30, *given)
    assert "contact area seen at 2 N" in note
    assert f"{thickness:g} mm of tissue" in note if thickness else "deep tissue" in note
    table = record["table"]
    assert np.interp(2.0, table["load_N"], table["area_mm2"]) == pytest.approx(math.pi * 30, rel=2e-3)
    assert record["newton"]["kh_N_per_m3_std"] > 0


def test_pad_of_a_run_by_its_loading_curve(results, monkeypatch) -> None:
    summary = SummaryFile.read(results["layer"])
    modulus = {"youngs_modulus_kpa": 40.0, "youngs_modulus_kpa_std": 4.0}
    layers = [
        ThicknessFitRecord.model_construct(thickness_mm=thickness, thickness_mm_std=0.5, **modulus)
        for thickness in (5.0, 7.0)
    ]
    of = {"finger": "left_index", "wedge_angle_deg": 30.0, "synthetic": False}
    curves = [CurveRecord.model_construct(**of, layer=layer) for layer in (*layers, None)]
    monkeypatch.setattr(SummaryFile, "read", lambda _: summary.model_copy(update={"curves": curves}))
    pad = of_run.measured_pad(results["layer"], finger=None, wedge_deg=30.0)
    assert (float(pad.tissue.thickness), float(pad.tissue.youngs_modulus)) == (7.0, 0.04)
    assert pad.stds == pytest.approx({**STDS, "youngs_modulus": 0.004, "thickness": 0.5})
    assert "loading curve" in pad.source


BAD = [
    (("--wedge-deg", 30), "give --semi-axes-mm"),
    (PAD, "give --youngs-modulus-kpa"),
    ((*USUAL, "--load-n", 3, 1), "--load-n 3 1: loads must be two that ascend from above zero"),
    ((*PAD, "--youngs-modulus-kpa", 10), "--load-n 0.2 3: no contact under 3 N"),
    ((*USUAL, "--mass-kg", 1e-8), "--mass-kg 1e-08: effective_mass must be at least"),
    ((*PAD, "--youngs-modulus-kpa", 90, "--thickness-mm-std", 1), "-std is that of --thickness-mm"),
    (("nowhere", "--wedge-deg", 30), "nowhere: no finished run there"),
    (("layer", "--wedge-deg", 30, "--finger", "thumb"), "found no finger 'thumb'; it has left_index"),
    (("layer", "--wedge-deg", 20), "left_index was not pressed at 20°; it was at 30°"),
    (("layer", "--wedge-deg", 30, "--youngs-modulus-kpa", 30), "--youngs-modulus-kpa is that of the run"),
    (("layer", "--wedge-deg", 30, "--thickness-mm", 0.1), "neither a loading curve nor a contact"),
]


@pytest.mark.parametrize(("given", "message"), BAD)
def test_bad_input(results, given, message) -> None:
    assert message in command.refusal("simulator", *(results.get(word, word) for word in given))
