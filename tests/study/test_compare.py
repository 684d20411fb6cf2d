"""Studies side by side: what is read is what was run, and means over people are what they say."""

import html
import json
import math
import re
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import pytest
from benchmarks.claims import pooling
from numpy.testing import assert_allclose
from tests import command, studies
from tests.studies import PAD, Table, contact, write_sums

from fingerpad.exceptions import FingerpadError
from fingerpad.figures.marks import Figure
from fingerpad.report.compare import forest_plot, write_comparison_page
from fingerpad.simulate import simulate_loading_curve
from fingerpad.study import compare
from fingerpad.study.results.summary_file import (
    CheckRecord,
    FingerRecord,
    HeadlineRecord,
    HighestLoadOnLayer,
    LayerValidityRecord,
    OnLayerRecord,
    PlacementRecord,
    Record,
    SummaryFile,
    ValidityRecord,
)

RecordType = TypeVar("RecordType", bound=Record)


PLACED = {"finger": "index", "wedge_angle_deg": 30.0, "roll_angle_deg": 0.0, "synthetic": False}


def value(value: float, std: float, *, person: str = "P01", named: bool = True, **more: Any) -> compare.Value:
    given = {"quantity": "radius_from_indentation_mm", "study": "A", **PLACED}
    return compare.Value(value=value, std=std, person=compare.Person(person, named), **{**given, **more})


def test_a_finger_under_two_names_counts_once(tmp_path):
    one, other = (studies.finger(name, person="P01", digit="left_index") for name in ("ellipse", "direct"))
    pressed = [contact(name, finger=name) for name in ("ellipse", "direct")]
    studies.run(tmp_path, one, other, *pressed)
    found = compare.compare_studies([tmp_path / "out"])
    assert {value.finger for value in found.values} == {"ellipse", "direct"}
    assert {mean.fingers for mean in found.means} == {1}
    assert all(math.isnan(mean.between_fingers_std) for mean in found.means)


def test_a_curve_given_twice_makes_no_mean_more_certain(tmp_path):
    made = {"points": 100, "force_std": 0.004, "cycles": 2, "unloading": True}
    studies.write_curve(tmp_path / "a.csv", simulate_loading_curve(**made))
    curve, second = (studies.curve(file="a.csv", thickness_mm=np.inf, cycle=cycle) for cycle in (0, 1))

    def moduli(*curves: Table) -> tuple[list[compare.Value], list[compare.Mean]]:
        studies.run(tmp_path, studies.finger(), *curves)
        return compare.compare_studies([tmp_path / "out"]).of("initial_modulus_kpa")

    once, both = moduli(curve), moduli(curve, second)
    assert moduli(curve, curve) == once
    assert [len(values) for values, _ in (once, both)] == [1, 2]


def test_the_interval_of_a_positive_quantity_is_one_of_its_logarithm():
    moduli = [value(e, 0.1 * e, person=f"P{e}", quantity="youngs_modulus_kpa") for e in (20, 45, 130)]
    (mean,) = compare.means_of(moduli)
    low, high = mean.interval
    assert 0 < low < mean.value < high
    assert_allclose(low * high, mean.value**2)
    assert 4.303 * mean.std > mean.value  # ± t times it would reach below zero
    exponents = [value(n, 0.1, person=f"P{n}", quantity="area_exponent") for n in (0.1, 0.5, 0.9)]
    (exponent,) = compare.means_of(exponents)
    assert exponent.interval[0] < 0
    assert_allclose(sum(exponent.interval), 2 * exponent.value)


@pytest.mark.nightly
def test_a_mean_over_people_is_not_pulled_to_those_whose_values_are_small():
    found = pooling.score(pooling.people, 8, 0.1, repeats=200)
    assert abs(found.bias) < 0.2  # known to 0.07; −0.4 with the weights of what is stated
    assert 0.92 <= found.covered <= 0.98


def test_one_person_tells_nothing_of_people():
    (mean,) = compare.means_of([value(13.0, 0.1), value(14.0, 0.1, finger="ring")])
    assert mean.interval is None
    assert math.isnan(mean.between_people_std)
    assert mean.between_fingers_std == pytest.approx(0.7, abs=0.01)  # √(1/2 − 0.1²)
    # Of one value, as others without uncertainty have no weight.
    of_others = value(99.0, math.nan, person="P02"), value(98.0, 0.0, person="P03")
    (single,) = compare.means_of([value(13.0, 0.1), *of_others])
    assert (len(single.people), single.value, single.std) == (1, pytest.approx(13.0), pytest.approx(0.1))
    assert math.isnan(single.between_fingers_std)


def test_the_scatter_between_fingers_is_weighted_by_degrees_of_freedom():
    two = [value(13.0 + offset, 1e-6, finger=f"f{offset}") for offset in (0, 1)]
    four = [value(13.0 + offset, 1e-6, person="P02", finger=f"f{offset}") for offset in (0, 2, 4, 6)]
    (mean,) = compare.means_of([*two, *four])
    variances = [np.var([0, 1], ddof=1), np.var([0, 2, 4, 6], ddof=1)]
    expected = np.sqrt(np.average(variances, weights=[1, 3]))
    assert mean.between_fingers_std == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize(
    ("error", "what"),
    [("shared_std", "study"), ("gain_std", "study"), ("scale_std", "scale"), ("edge_std", "scale")],
)
def test_what_values_of_one_jig_force_scale_or_edge_share_does_not_average_away(error, what):
    def mean_std(names: str) -> float:
        values = [value(14.0, 0.2, person=f"P{n}", **{what: of, error: 0.199}) for n, of in enumerate(names)]
        return compare.means_of(values)[0].std

    assert mean_std("A" * 16) == pytest.approx(0.2, rel=0.01)
    assert mean_std("AB" * 8) == pytest.approx(0.2 / math.sqrt(2), rel=0.01)


def test_real_and_synthetic_angles_and_rolls_never_mix():
    values = [
        value(10.0 + n, 0.1, synthetic=synthetic, wedge_angle_deg=wedge, roll_angle_deg=roll)
        for n, (synthetic, wedge, roll) in enumerate(
            [(False, 30.0, 0.0), (True, 30.0, 0.0), (False, 45.0, 0.0), (False, 30.0, 10.0)]
        )
    ]
    assert [mean.value for mean in compare.means_of(values)] == pytest.approx([10, 11, 12, 13])


def test_a_named_person_s_finger_is_one_in_all_studies():
    twice = [value(13.0, 0.1, study="A"), value(13.4, 0.1, study="B")]
    assert (compare.means_of(twice)[0].fingers, len(compare.means_of(twice)[0].people)) == (1, 1)
    unnamed = [value(13.0, 0.1, study=s, person=s, named=False) for s in ("A", "B")]
    assert (compare.means_of(unnamed)[0].fingers, len(compare.means_of(unnamed)[0].people)) == (2, 2)
    # A person with the name of a study is not that study's unnamed person.
    mixed = [value(13.0, 0.1, person="A"), value(13.0, 0.1, person="A", named=False)]
    assert len(compare.means_of(mixed)[0].people) == 2


# Runs


STATED = {"wedge_angle_deg_std": 0.5, "load_relative_std": 0.01}


def finger(name: str, palmar: float, *, heavy: float = 2, **keys: Any) -> list[Table]:
    """Return a finger and its contacts at two angles and two loads."""
    placed = [
        contact(f"{name}_{wedge}_{load:g}", load, (major, 0.7 * major), finger=name, wedge=wedge, axis="")
        for wedge, load, major in ((30, heavy, 7.4), (45, heavy, 5.3), (30, 1, 5.9))
    ]
    return [studies.finger(name, semi_axes_mm={**PAD, "palmar": palmar}, **keys), *placed]


def ran(folder: Path, title: str, *fingers: list[Table]) -> Path:
    studies.run(folder, *chain(*fingers), title=title, uncertainty=STATED)
    return folder / "out"


@pytest.fixture(scope="module")
def runs(tmp_path_factory) -> list[Path]:
    root = tmp_path_factory.mktemp("runs")
    of_one = finger("l_index", 7.9, person="P01"), finger("l_ring", 7.7, person="P01")
    first = ran(root / "a", "Lab <b>A</b>", *of_one)
    second = ran(root / "b", "Lab B", finger("index", 7.2, person="P02"), finger("pad", 8.2, synthetic=True))
    third = ran(root / "c", "Lab C", finger("index", 8.3))
    return [first, second, third]


def test_every_value_is_that_of_its_run(runs):
    found = compare.compare_studies([runs[0], runs[1] / "results.csv", runs[2] / "summary.json"])
    assert {(v.study, v.finger, v.person) for v in found.values} == {
        ("Lab <b>A</b>", "l_index", compare.Person("P01", True)),
        ("Lab <b>A</b>", "l_ring", compare.Person("P01", True)),
        ("Lab B", "index", compare.Person("P02", True)),
        ("Lab B", "pad", compare.Person("Lab B", False)),
        ("Lab C", "index", compare.Person("Lab C", False)),
    }
    for row in studies.summary_of(runs[0])["summaries"]:
        place = "Lab <b>A</b>", row["finger"], row["wedge_angle_deg"]
        for quantity in ("radius_from_indentation_mm", "mean_curvature_radius_mm"):
            seen = found.of(quantity)[0]
            (one,) = (v for v in seen if (v.study, v.finger, v.wedge_angle_deg) == place)
            assert (one.value, one.std) == (row[quantity], row[f"{quantity}_std"])
    axes = {v.finger: v.value for v in found.of("palmar_mm")[0] if v.study == "Lab <b>A</b>"}
    assert axes == {"l_index": 7.9, "l_ring": 7.7}


def record(model: type[RecordType], **keys: Any) -> RecordType:
    """Return a part of a summary of which nothing else is known."""
    return model.model_construct(**dict.fromkeys(model.model_fields, math.nan) | keys)


def finished(**keys: Any) -> compare.FinishedStudy:
    """Return a study of one finger at one placement."""
    finger = record(
        FingerRecord,
        finger="index",
        person="P01",
        synthetic=False,
        covariance_mm2=np.eye(3).tolist(),
        **{f"{name}_mm": axis for name, axis in PAD.items()},
    )
    validity = record(ValidityRecord, verdict="not tested", headlines={}, checks=[], on_layer=None)
    unknown = {"on_layer": None, "radius_from_indentation_variance_shares": None}
    placement = record(PlacementRecord, **{**PLACED, **unknown, "validity": validity, **keys})
    summary = record(SummaryFile, title="A", fingers=[finger], summaries=[placement], curves=[], by_load=[])
    return compare.FinishedStudy(folder=Path("out"), summary=summary)


def test_fingers_share_the_pose_of_the_jig_but_not_how_each_lies_on_its_wedge():
    shares = {"semi-axes": 0.3, "pad shape": 0.06, "wedge angle": 0.09, "jig angle": 0.04, "roll angle": 0.15}
    study = finished(
        roll_angle_deg=5.0,
        mean_curvature_radius_mm=13.0,
        mean_curvature_radius_mm_std=0.2,
        radius_from_indentation_mm=14.0,
        radius_from_indentation_mm_std=0.3,
        radius_from_indentation_variance_shares=shares | {"contact ellipse": 0.36},
        highest_area_mm2=100.0,
        highest_load_N=2.0,
    )
    shared = {each.quantity: each.shared_std for each in compare.values_of(study)}
    assert shared["radius_from_indentation_mm"] == pytest.approx(0.3 * math.sqrt(0.04))
    assert shared["mean_curvature_radius_mm"] == pytest.approx(13 * 0.3 * math.sqrt(0.04) / 14)
    assert shared["palmar_mm"] == shared["highest_area_mm2"] == 0.0


def test_means_are_over_people_and_say_of_whom(runs):
    found = compare.compare_studies(runs)
    counts = {mean.synthetic: (len(mean.people), mean.fingers) for mean in found.of("palmar_mm")[1]}
    assert counts == {False: (3, 4), True: (1, 1)}
    notes = " | ".join(found.notes)
    assert "Lab C: the manifest names no person for index" in notes
    assert "Lab B: the manifest names no person for pad" in notes
    assert "synthetic fingers were rendered or simulated" in notes
    assert "area_exponent: 5 of 5 values have no uncertainty and stand in no mean" in notes  # two loads each
    assert "versions" not in notes


def test_tables_hold_all_values_and_means(runs, tmp_path):
    found = compare.compare_studies(runs)
    compare.write_comparison(found, tmp_path)
    rows = studies.rows_of(tmp_path / "compare.csv")
    assert [float(row["value"]) for row in rows] == [v.value for v in found.values]
    assert {row["unit"] for row in rows} == {"mm", "mm²", "kPa", "1"}
    record = json.loads((tmp_path / "compare.json").read_text())
    assert len(record["values"]) == len(rows)
    assert [mean["people"] for mean in record["means"]] == [len(mean.people) for mean in found.means]
    # Three semi-axes, and two radii, the area and E at two angles.
    assert sum(mean["synthetic"] for mean in record["means"]) == 11
    compare.write_comparison(replace(found, means=()), tmp_path)
    assert not (tmp_path / "compare_means.csv").exists()  # those of the comparison before


def test_the_page_stands_alone_and_labels_what_is_synthetic(runs, tmp_path):
    page = write_comparison_page(compare.compare_studies(runs), tmp_path).read_text(encoding="utf-8")
    assert "Lab <b>A</b>" not in page
    assert "Lab &lt;b&gt;A&lt;/b&gt;" in page
    assert "<script" not in page
    assert not re.search(r'(?:src|href)="(?!#|data:)', page)
    rows = re.findall(r"<tr>.*?</tr>", page, re.DOTALL)
    of_pad = [row for row in rows if "<td>pad" in row]
    assert len(of_pad) == 14
    assert all('<span class="synthetic">' in row for row in of_pad)
    drawn = (tmp_path / "figures" / "compare_radius_from_indentation_mm.svg").read_text(encoding="utf-8")
    assert "Lab B, pad (synthetic)" in drawn
    figure = Figure.of_json((tmp_path / "figures" / "compare_radius_by_wedge.json").read_text("utf-8"))
    assert figure.panels[0].x.label == "wedge angle (°)"


def test_areas_have_one_mean_at_each_load_that_hands_pressed_about(runs):
    areas = [
        value(area, 2.0, person=f"P{load}", quantity="highest_area_mm2", load=load)
        for load, area in {1.93: 98.0, 1.98: 101.0, 2.06: 104.0, 0.98: 60.0, 1.02: 64.0}.items()
    ]
    means = compare.means_of(areas)
    assert {mean.load: len(mean.people) for mean in means} == {2.0: 3, 1.0: 2}
    assert {mean.load: mean.value for mean in means} == pytest.approx({2.0: 101.0, 1.0: 62.0}, rel=0.01)
    found = replace(compare.compare_studies(runs), values=tuple(areas), means=tuple(means))
    (plot,) = forest_plot(found, "highest_area_mm2")
    assert list(plot.figure.panels[0].y.names)[-2:] == [f"mean over people at {load} N" for load in (1, 2)]


def changed(run: Path, folder: Path, **keys: Any) -> Path:
    folder.mkdir()
    (folder / "summary.json").write_text(json.dumps({**studies.summary_of(run), **keys}))
    return write_sums(folder)


def test_different_versions_and_failures_are_told(runs, tmp_path):
    other = {**studies.summary_of(runs[2])["provenance"], "fingerpad": "0.0.9"}
    older = changed(runs[2], tmp_path / "older", provenance=other, failures=["x"])
    notes = " | ".join(compare.compare_studies([runs[0], older]).notes)
    assert "Lab C by 0.0.9" in notes
    assert "Lab C: 1 could not be measured" in notes


def test_moduli_that_no_finger_has_stand_in_no_mean(runs, tmp_path):
    by_load = studies.summary_of(runs[2])["by_load"]
    for one in by_load:
        one["youngs_modulus_kpa"] *= 1000
    wrong = changed(runs[2], tmp_path / "wrong", title="Lab D", by_load=by_load)
    compared, alone = compare.compare_studies([runs[0], wrong]), compare.compare_studies([runs[0]])
    means, others = ([mean.value for mean in one.of("youngs_modulus_kpa")[1]] for one in (compared, alone))
    assert means == others
    said = r"Lab D, index: youngs_modulus_kpa .* 1–5000 kPa and stands in no mean"
    assert re.search(said, str(compared.notes))
    assert "1–5000 kPa" not in str(alone.notes)


def test_area_and_modulus_of_a_finger_are_means_over_its_repeats(tmp_path):
    rng = np.random.default_rng(1)
    draws = 7.4 * np.exp(rng.normal(0, 0.025, 12)), 5.0 * np.exp(rng.normal(0, 0.025, 12))
    presses = [contact(f"c{n}", ellipse=axes, std=0.02) for n, axes in enumerate(zip(*draws, strict=True))]
    lighter = [contact("light", 0.5, (4.7, 3.2), std=0.02)]
    studies.run(tmp_path, studies.finger(), *presses, *lighter, uncertainty={"load_relative_std": 0.01})
    found = compare.compare_studies([tmp_path / "out"])
    ((area,), _), ((modulus,), _) = found.of("highest_area_mm2"), found.of("youngs_modulus_kpa")
    areas = np.log(np.pi * draws[0] * draws[1])
    assert (area.load, modulus.load) == (2, 2)
    assert area.value == pytest.approx(np.exp(areas.mean()))
    # What scatters decides: all of it is in the uncertainty of the mean.
    assert area.std / area.value == pytest.approx(areas.std(ddof=1) / np.sqrt(12), rel=0.05)
    pooled = studies.summary_of(tmp_path / "out")["by_load"][-1]
    assert (modulus.value, modulus.std) == pytest.approx(
        (pooled["youngs_modulus_kpa"], pooled["youngs_modulus_kpa_std"])
    )


def test_what_is_no_study_or_twice_the_same_is_refused(runs, tmp_path):
    copy = changed(runs[0], tmp_path / "copy", title="Renamed")
    provenance = studies.summary_of(runs[2])["provenance"]
    other = changed(runs[2], tmp_path / "other", provenance={**provenance, "inputs_sha256": {"x": "y"}})
    broken = changed(runs[2], tmp_path / "broken", summaries=[{"finger": "index"}], title="Broken")
    odd = changed(runs[2], tmp_path / "odd", fingers="none", title="Odd")
    failed = changed(runs[2], tmp_path / "failed", summaries=[], fingers=[], title="Failed")
    for paths, message in [
        ([runs[0], runs[0] / "results.csv"], "is the same study as"),
        ([runs[0], copy], "is the same study as"),
        ([runs[2], other], "are both titled 'Lab C'"),
        ([tmp_path / "nowhere"], "no finished run there; `fingerpad run"),
        ([broken], "broken/summary.json: is not understood"),
        ([odd], "odd/summary.json: is not understood"),
        ([failed], "there is nothing to compare"),
        ([], "no study is named"),
    ]:
        with pytest.raises(FingerpadError, match=message):
            compare.compare_studies(paths)


def test_from_the_command_line(runs, tmp_path):
    code, said, error = command.run("compare", *runs, "--out", tmp_path / "out")
    assert (code, error) == (0, "")
    assert "P01, l_index" in said
    assert "Lab B, pad  (synthetic)" in said
    assert "mean of 3 people" in said
    assert f"Page: {tmp_path / 'out' / 'compare.html'}" in said
    compared = command.run_json("compare", *runs)["studies"]
    assert {study["study"] for study in compared} == {"Lab <b>A</b>", "Lab B", "Lab C"}


def test_verdicts_name_the_checks_that_say_so(runs, tmp_path):
    found = compare.compare_studies(runs)
    summaries = [one for run in runs for one in studies.summary_of(run)["summaries"]]
    hertz = [one for one in found.verdicts if one.model == "Hertz theory"]
    assert [one.verdict for one in hertz] == [s["validity"]["verdict"] for s in summaries]
    for one, summary in zip(hertz, summaries, strict=True):
        said = {check["check"]: check["verdict"] for check in summary["validity"]["checks"]}
        assert one.checks
        assert {said[name] for name in one.checks} == {one.verdict}
    compare.write_comparison(found, tmp_path)
    written = studies.rows_of(tmp_path / "compare_validity.csv")
    assert [row["verdict"] for row in written] == [one.verdict for one in found.verdicts]
    page = html.unescape(write_comparison_page(found, tmp_path).read_text(encoding="utf-8"))
    for one in found.verdicts:
        assert f"{one.verdict}</span>" in page
        assert one.compared[0].split(",")[0].replace("R_g", "R<sub>g</sub>") in page


def test_the_discrepancy_of_the_model_does_not_average_away():
    people = [value(14.0, math.hypot(0.2, 3.0), person=f"P{n}", model_std=3.0) for n in range(12)]
    (mean,) = compare.means_of(people)
    assert 3.0 < mean.std < 3.1
    (known,) = compare.means_of([value(14.0, 0.2, person=f"P{n}") for n in range(12)])
    assert mean.between_people_std == pytest.approx(known.between_people_std)


def test_the_modulus_on_the_layer_stands_beside_that_of_hertz_theory():
    headline = record(HeadlineRecord, verdict="fails", value=66.9, value_std=3.7, model_std=20.0)
    checks = [
        record(CheckRecord, check="shape_on_layer", verdict="holds", compared="length over width"),
        record(CheckRecord, check="modulus_on_layer", verdict="not tested", compared="E"),
    ]
    moduli = {"youngs_modulus_on_layer_kpa": 49.2, "youngs_modulus_on_layer_kpa_std": 5.0}
    layer = record(
        OnLayerRecord, effective_thickness_mm=7.9, highest_load=record(HighestLoadOnLayer, **moduli)
    )
    of_layer = record(LayerValidityRecord, verdict="holds", checks=checks)
    known = {"headlines": {"youngs_modulus_kpa": headline}, "checks": [], "on_layer": of_layer}
    study = finished(on_layer=layer, validity=record(ValidityRecord, verdict="fails", **known))
    values = {one.quantity: one for one in compare.values_of(study)}
    modulus = values["youngs_modulus_kpa"]
    assert (modulus.value, modulus.verdict) == (66.9, "fails")
    assert modulus.std == pytest.approx(math.hypot(3.7, 20.0))
    on_layer = values["youngs_modulus_on_layer_kpa"]
    assert (on_layer.value, on_layer.std, on_layer.verdict) == (49.2, 5.0, "holds")
    hertz, layered = compare.verdicts_of(study)
    assert (hertz.verdict, hertz.checks) == ("fails", ())
    assert (layered.model, layered.checks) == ("7.9 mm of tissue over bone", ("shape_on_layer",))
