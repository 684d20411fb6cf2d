"""Repeats in studies: recognised, borrowed by single contacts, and pooled at each load."""

import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from benchmarks.claims.area_exponents import smooth
from tests import studies
from tests.studies import Table, correct, finger, rows_by, rows_of, study_of, summary_of, write_study
from tests.study.measured import AXES, frame, measured, pad

from fingerpad.report.repeatability import repeatability_section
from fingerpad.report.templates import templates
from fingerpad.report.text import presses_unlike_repeats
from fingerpad.study.manifest.models import Contact, Observation
from fingerpad.study.measuring.contacts import Measurement
from fingerpad.study.pipeline import run_study
from fingerpad.study.results.pooling import area_exponent, pool_contacts
from fingerpad.study.results.repeats import contact_repeatability, pool_by_load, study_scatter
from fingerpad.study.results.rows import Rows
from fingerpad.study.results.summary_file import ValidityRecord
from fingerpad.study.results.table import records
from fingerpad.study.results.validity.checks import validity_of
from fingerpad.study.results.validity.model_checks import MODULUS
from fingerpad.uncertainty.repeats import ContactRepeatability

STUDY = study_of(finger(), uncertainty={"wedge_angle_deg_std": 0, "roll_angle_deg_std": 0})
PADS = {"f": pad(1e-9)}
KNOWN = ContactRepeatability(
    covariance=np.array([[0.02**2, 0.0], [0.0, 0.05**2]]), freedom=12, groups=6, count=18
)
NONE = ContactRepeatability(covariance=np.zeros((2, 2)), freedom=0, groups=0, count=0)
BOTH, NEITHER = {False: KNOWN, True: NONE}, {False: NONE, True: NONE}


def contact(
    number: int, radius: float = 6.0, elongation: float = 0.3, *, load: float = 1.0, **more: Any
) -> tuple[Observation, Measurement]:
    axes = radius * np.exp(np.array([0.5, -0.5]) * elongation)
    given = {
        "covariance_mm2": 1e-8 * np.eye(2),
        "gross_area_mm2": np.pi * axes.prod(),
        "gross_area_mm2_std": 0.5,
        "gross_area_mm2_noise_std": 0.3,
        "gross_area_mm2_edge_std": 0.4,
        "scale": "s",
    }
    return measured(f"c{number}", axes, load, **{**given, **more})


def modelled(*seen: tuple[Contact, Measurement], known: Any = None) -> Rows:
    return Rows(STUDY, PADS, seen, *([known] if known else []))


def repeats(count: int = 4) -> list[tuple[Observation, Measurement]]:
    rng = np.random.default_rng(5)
    return [contact(k, 6 * np.exp(rng.normal(0, 0.02)), 0.3) for k in range(count)]


@pytest.mark.parametrize(
    ("other", "are_repeats"),
    [
        ({}, True),
        ({"load": 1.03}, True),
        ({"load": 1.3}, False),
        ({"wedge_angle_deg": 45}, False),
        ({"synthetic": True}, False),
        ({"flags": ("touches_border",)}, False),
        ({"counts": False}, False),
        ({"reason": "no contact"}, False),
        ({"pooling": False}, False),
        ({"flags": ("touches_border",), "pooling": True}, True),
        ({"rejected": "smeared", "pooling": True}, False),
    ],
)
def test_which_contacts_are_repeats(other, are_repeats):
    seen = [contact(0), contact(1, **other)]
    assert contact_repeatability(STUDY, PADS, seen)[False].freedom == are_repeats
    large = {"f": replace(PADS["f"], semi_axes=10 * AXES)}  # of no finger's size
    assert contact_repeatability(STUDY, large, seen)[False].count == 0


def test_sessions_of_one_press_each_are_the_repeats():
    seen = [contact(k, radius, session=f"s{k}") for k, radius in enumerate([6.0, 6.2, 5.9, 6.3])]
    once = contact_repeatability(STUDY, PADS, seen)[False]
    assert (once.freedom, once.count) == (3, 4)
    twice = contact_repeatability(STUDY, PADS, [*seen, contact(4, 6.1, session="s0")])[False]
    assert (twice.freedom, twice.count) == (1, 2)
    areas = [one for one in study_scatter(STUDY, modelled(*seen).table) if one.quantity == "contact_area"]
    levels = {one.level: one for one in areas[0].levels}
    assert levels["repeat"].log_std == pytest.approx(np.log([6.0**2, 6.2**2, 5.9**2, 6.3**2]).std(ddof=1))
    assert levels["repeat"].includes == "session"
    assert levels["session"].missing.startswith("part of the repeats")


def test_repeats_of_one_finger_are_so_whatever_loads_others_have():
    study = study_of(*(finger(f"f{k}") for k in range(8)))
    rng, pads = np.random.default_rng(2), {f"f{k}": pad(1e-9) for k in range(8)}
    seen = [
        contact(3 * k + n, finger=f"f{k}", load=load, radius=6 + 0.1 * rng.normal())
        for k in range(8)
        for n, load in enumerate((1 + 0.015 * (k - 4)) * np.array([0.97, 1, 1.03]))
    ]
    assert contact_repeatability(study, pads, seen)[False].freedom == 16
    found = study_scatter(study, Rows(study, pads, seen).table)
    levels = {one.level: one for one in found[0].levels}
    assert levels["repeat"].degrees_of_freedom == 16


@pytest.mark.parametrize(("count", "quantile"), [(2, 12.706), (3, 4.303)])
def test_few_repeats_at_one_load_widen_its_mean(count, quantile):
    seen = repeats(count)
    known = contact_repeatability(STUDY, PADS, seen)
    (mean,) = pool_by_load(modelled(*seen, known=known))
    spread = np.log([one.gross_area_mm2 for _, one in seen]).std(ddof=1) / np.sqrt(count)
    assert mean.contact_area_mm2_repeatability_std / mean.contact_area_mm2 == pytest.approx(spread, rel=1e-3)
    half = np.log(mean.contact_area_mm2_ci95_high / mean.contact_area_mm2)
    assert half > quantile * spread


@pytest.mark.parametrize("scale", ["camera", {"mm_per_px": 0.05, "relative_std": 0.02}])
def test_repeats_do_not_average_out_the_scale_of_their_ellipses(tmp_path, scale):
    rng = np.random.default_rng(3)
    presses = [
        studies.contact(f"c{k}", ellipse=(7.4 + move, 5 + move), std=0.02, scale=scale)
        for k, move in enumerate(rng.normal(0, 0.05, 16))
    ]
    given = {"wedge_angle_deg_std": 0.0, "roll_angle_deg_std": 0.0}
    manifest = studies.write_study(tmp_path, finger(std=1e-6), *presses, uncertainty=given)
    text = manifest.read_text(encoding="utf-8")
    manifest.write_text(f"{text}\n[scales.camera]\nppi = 500\nrelative_std = 0.02\n", encoding="utf-8")
    result = run_study(manifest, tmp_path / "out")
    (mean,) = result.by_load
    assert 0.04 < mean.contact_area_mm2_std / mean.contact_area_mm2 < 0.042
    assert 0.06 < mean.youngs_modulus_kpa_std / mean.youngs_modulus_kpa < 0.063
    assert mean.contact_area_mm2_other_std / mean.contact_area_mm2 == pytest.approx(0.04, rel=0.01)


def test_repeats_exceed_noise_by_no_more_than_they_scatter():
    """A little less scatter than noise along one axis was a large one along the other."""
    rng = np.random.default_rng(2)
    noise = np.tile(np.diag([0.007**2, 0.014**2]), (12, 1, 1))
    found = []
    for _ in range(300):
        axes = rng.normal(0, [0.007, 0.014], (12, 2))
        of = ContactRepeatability.of(axes, noise, np.zeros(12))
        assert np.linalg.eigvalsh(np.cov(axes.T) - of.covariance).min() > -1e-12
        found.append(of.area_std)
    # Of no scatter beyond noise of 1.4 % in area.
    assert max(found) < 0.03


def test_a_contact_left_out_manually_does_not_scatter_the_others(tmp_path):
    """All that is said of repeats speaks of the contacts that are pooled."""
    out, path = tmp_path / "out", manifest(tmp_path, 6)
    outlier = "c5_1"
    sheet = path.with_name("o.csv")
    lines = sheet.read_text().splitlines()
    wrong = [",".join([*line.split(",")[:5], "9.0", "8.0", "0.05"]) for line in lines if outlier in line]
    sheet.write_text("\n".join([line for line in lines if outlier not in line] + wrong) + "\n")
    correct(tmp_path, outlier, {"pooling": {"include": False, "why": "slipped"}})
    left_out = rows_by(run_study(path, out))
    (found,) = summary_of(out)["repeatability"]["contact"]
    lines = [row for row in rows_of(out / "repeatability.csv") if row["quantity"] == "contact_area"]
    (repeat,) = (row for row in lines if row["level"] == "repeat")
    assert (found["count"], found["degrees_of_freedom"]) == (11, 9)
    assert (int(repeat["count"]), int(repeat["degrees_of_freedom"])) == (11, 9)
    correct(tmp_path, outlier, {"rejected": "slipped"})
    rejected = rows_by(run_study(path, out))
    for name in rejected.keys() - {outlier}:
        stds = (rows[name]["youngs_modulus_kpa_std"] for rows in (left_out, rejected))
        assert next(stds) == pytest.approx(next(stds))


def test_a_press_unlike_its_repeats_is_told_and_one_of_no_finger_moves_no_other(tmp_path):
    """Twelve presses whose areas scatter by 3 %; one has a third less area, one its load in millinewtons."""
    rng = np.random.default_rng(7)
    given = {"axis": "", "std": 0.02}
    presses = [
        studies.contact(f"c{load}_{k}", load, tuple(size * load**0.3 * rng.normal([5, 4], 0.07)), **given)
        for load in (0.5, 1, 2)
        for k, size in enumerate((1, 1, 1, 0.81 if load == 1 else 1))
    ]
    result = studies.run(tmp_path / "a", finger(), *presses)
    (words,) = presses_unlike_repeats(result)
    assert re.fullmatch(
        r"c1_3: 3\d % off the median area of .* one load, where [1-5]\.\d % is usual: .*", words
    )
    wrong = studies.contact("wrong", 700, (5.2, 4.1), **given)
    (of, *_), (beside, *_) = (
        result.summaries,
        studies.run(tmp_path / "b", finger(), *presses, wrong).summaries,
    )
    assert beside.table.set_index("observation").loc["wrong", "excluding_flags"] == "implausible_modulus"
    assert beside.corrected_radius.total_std == pytest.approx(of.corrected_radius.total_std, rel=1e-12)
    # An order of rows that is off by one makes all loads doubtful.
    loads = [2, *(one.keys["load_N"] for one in presses)]
    shifted = [
        Table(one.kind, one.keys | {"load_N": load}) for one, load in zip(presses, loads, strict=False)
    ]
    (words, *_) = presses_unlike_repeats(studies.run(tmp_path / "c", finger(), *shifted))
    assert words.startswith("presses of one finger under one load differ in area by ")


@pytest.mark.parametrize(
    ("factors", "said"),
    [
        ((1, 1, 1, 0.78, 1), "c3: 22 % off the growth of the other areas, where 4.6 % is usual"),
        ((1, 1.3, 1, 1.34, 1), "c1 and c3: 30 to 34 % off the growth of the other areas"),
        ((1, 1.1, 0.93, 1.05, 1), None),
        ((0.9, 1, 1.06, 1.04, 0.9), None),  # a stiffening pad
    ],
)
def test_a_contact_off_the_growth_of_the_others_is_told(tmp_path, factors, said):
    """A load that is mistyped, or another finger, where no load is repeated."""
    loads = (0.5, 1, 2, 3.5, 6)
    contacts = [
        studies.contact(f"c{k}", load, (4 * side, 3.5 * side), axis="", std=0.02)
        for k, (load, side) in enumerate(
            (load, math.sqrt(factor * load**0.58)) for load, factor in zip(loads, factors, strict=True)
        )
    ]
    words = "".join(presses_unlike_repeats(studies.run(tmp_path, finger(), *contacts)))
    assert words.startswith(said) if said else not words


def test_frames_of_a_sequence_are_no_repeats():
    covariance = {"covariance_mm2": 1e-8 * np.eye(2)}
    frames = [frame(k, (6.97 + 0.1 * k, 5.16), **covariance) for k in range(5)]
    assert contact_repeatability(STUDY, PADS, [contact(9), *frames])[False].count == 0
    assert pool_by_load(modelled(*frames, known=BOTH)) == []


def test_repeatability_reaches_modulus_indentation_and_radius():
    """By Hertz theory E goes with the cube of the contact's radius, ξ with its square."""
    (plain,), (row,) = (records(modelled(contact(0), known=known).table) for known in (NEITHER, BOTH))
    exact = replace(KNOWN, covariance=np.diag([0.02**2, 0.0]))
    (radial,) = records(modelled(contact(0), known={False: exact, True: NONE}).table)
    modulus = radial["youngs_modulus_kpa_repeatability_std"] / radial["youngs_modulus_kpa"]
    assert modulus == pytest.approx(3 * 0.02, rel=1e-6)
    indentation = radial["indentation_mm_repeatability_std"] / radial["indentation_mm"]
    assert indentation == pytest.approx(2 * 0.02, rel=1e-6)
    assert radial["gross_area_mm2_repeatability_std"] == pytest.approx(2 * 0.02 * radial["gross_area_mm2"])
    assert radial["radius_from_indentation_mm_repeatability_std"] == pytest.approx(0, abs=1e-9)
    stretched = modelled(*(contact(0, elongation=0.3 + off) for off in (0.001, -0.001)))
    expected = 0.05 * abs(np.diff(stretched.table["radius_from_indentation_mm"])[0]) / 0.002
    assert row["radius_from_indentation_mm_repeatability_std"] == pytest.approx(expected, rel=1e-3)
    for name in ("youngs_modulus_kpa", "indentation_mm"):
        added = row[f"{name}_repeatability_std"]
        assert added > 0 == plain[f"{name}_repeatability_std"]
        assert row[f"{name}_std"] ** 2 - plain[f"{name}_std"] ** 2 == pytest.approx(added**2, rel=0.05)
        assert row[name] == plain[name]


def test_no_contact_counts_for_all_because_of_its_little_noise():
    """Without repeatability the contact of the least noise has almost all weight, unless contacts differ."""
    quiet = contact(0, elongation=0.2)
    others = [contact(k, elongation=0.2, covariance_mm2=0.01 * np.eye(2)) for k in (1, 2, 3, 4)]
    weights = []
    for known in (NEITHER, BOTH):
        (summary,) = pool_contacts(modelled(quiet, *others, known=known))
        assert summary.corrected_radius is not None
        weights.append(summary.corrected_radius.largest_weight)
    assert weights[0] > 0.99
    assert weights[1] < 0.3
    assert summary.corrected_radius.effective_count > 4
    assert summary.corrected_radius.budget["repeatability"] > 0.5


def test_means_at_each_load_state_what_they_are_uncertain_by():
    rows = modelled(*repeats(4), known=BOTH)
    (at,) = pool_by_load(rows)
    areas = rows.table["gross_area_mm2"].to_numpy()
    assert (at.contacts, at.sessions, at.load_N) == (4, 1, 1.0)
    assert at.contact_area_mm2 == pytest.approx(np.exp(np.log(areas).mean()))
    assert at.contact_area_mm2_repeatability_std == pytest.approx(at.contact_area_mm2 * 0.04 / 2)
    assert at.contact_area_mm2_noise_std == pytest.approx(0.3 / 2, rel=0.02)
    assert at.contact_area_mm2_edge_std == pytest.approx(0.4, rel=0.02)
    assert at.contact_area_mm2_other_std == pytest.approx(0, abs=1e-6)
    parts = [
        getattr(at, f"youngs_modulus_kpa_{part}_std") for part in ("noise", "repeatability", "edge", "other")
    ]
    assert at.youngs_modulus_kpa_std == pytest.approx(np.linalg.norm(parts))
    (at,) = pool_by_load(modelled(*repeats(4), known=NEITHER))
    assert np.isnan(at.contact_area_mm2_repeatability_std)


def test_a_mean_of_contacts_that_tell_nothing_has_an_interval_of_all_there_is():
    nothing = [contact(k, gross_area_mm2_std=1e5) for k in range(3)]
    (at,) = pool_by_load(modelled(*nothing, known=BOTH))
    assert np.isfinite(at.contact_area_mm2)
    assert at.contact_area_mm2_ci95_low < 1e-9
    assert at.contact_area_mm2_ci95_high > 1e9


def manifest(folder: Path, count: int) -> Path:
    rng = np.random.default_rng(2)
    lines = ["name,finger,wedge_angle_deg,load_N,session,semi_major_mm,semi_minor_mm,ellipse_mm_std"]
    for load in (1.0, 2.0):
        for k in range(count):
            major, minor = 6 * np.exp(rng.normal(0, 0.03) + np.array([0.15, -0.15]))
            lines.append(f"c{k}_{load:g},f,30,{load},monday,{major:.4f},{minor:.4f},0.05")
    (folder / "o.csv").write_text("\n".join(lines) + "\n")
    return write_study(folder, finger(), observations_csv="o.csv")


@pytest.mark.parametrize(("count", "stated"), [(1, False), (2, False), (3, True)])
def test_a_run_tables_repeatability_or_says_that_it_is_missing(tmp_path, count, stated):
    """From two degrees of freedom the scatter is part of uncertainties, and not yet stated itself."""
    out = tmp_path / "out"
    result = run_study(manifest(tmp_path, count), out)
    known = count > 1
    (borrowed,) = summary_of(out)["repeatability"]["contact"]
    assert (borrowed["contact_area_log_std"] is not None) == known
    assert bool(borrowed["missing"]) != known
    lines = {(row["quantity"], row["level"]): row for row in rows_of(out / "repeatability.csv")}
    repeat = lines["contact_area", "repeat"]
    assert (repeat["log_std"] != "") == stated
    assert int(repeat["degrees_of_freedom"]) == 2 * (count - 1)
    assert lines["contact_area", "person"]["missing"]
    at_loads = rows_of(out / "by_load.csv")
    assert [float(row["load_N"]) for row in at_loads] == [1, 2]
    assert all((row["contact_area_mm2_repeatability_std"] != "") == known for row in at_loads)
    assert {row["session"] for row in records(result.rows)} == {"monday"}
    template = templates().get_template("repeatability.html.jinja")
    section = template.render(repeats=repeatability_section(result))
    assert ("Repeatability is missing" in section) != known
    assert ("Two repeats agree" in section) == stated
    assert ("repeatability missing" in section) != known


def test_limits_of_agreement_add_what_lies_within():
    """Two sessions of a finger differ by what lies between sessions, and between repeats."""
    rng = np.random.default_rng(9)
    seen = [
        contact(10 * s + k, 6 * np.exp(0.1 * s + rng.normal(0, 0.02)), session=f"s{s}")
        for s in range(4)
        for k in range(4)
    ]
    rows = modelled(*seen).table
    found = next(one for one in study_scatter(STUDY, rows) if one.quantity == "contact_area")
    lines = {line.level: line for line in found.levels}
    repeat, session = lines["repeat"], lines["session"]
    assert repeat.log_limit_of_agreement == pytest.approx(1.96 * np.sqrt(2) * repeat.log_std, rel=1e-4)
    both = np.hypot(repeat.log_std, session.log_std)
    assert session.log_limit_of_agreement == pytest.approx(1.96 * np.sqrt(2) * both, rel=1e-4)
    assert session.log_std == pytest.approx(2 * np.std([0, 0.1, 0.2, 0.3], ddof=1), rel=0.2)
    assert np.isnan(lines["finger"].log_limit_of_agreement)
    assert lines["finger"].missing == "no person has two fingers under one load"


def test_a_ridge_area_that_is_an_upper_bound_is_left_out_of_the_scatter():
    rng = np.random.default_rng(3)
    areas = 50 * np.exp(rng.normal(0, 0.02, 8))
    seen = [contact(k, ridge_area_mm2=area) for k, area in enumerate(areas)]
    merged = [contact(8 + k, ridge_area_mm2=90.0, flags=("ridges_merge",)) for k in range(4)]

    def ridge_scatter(some: list[Any]) -> Any:
        rows = modelled(*some).table
        found = next(one for one in study_scatter(STUDY, rows) if one.quantity == "ridge_area")
        return found.model_dump_json()

    assert ridge_scatter(seen + merged) == ridge_scatter(seen)
    areas_of_all = modelled(*seen, *merged).table["ridge_area_mm2"].to_numpy()
    assert np.count_nonzero(areas_of_all == 90) == 4


# The exponent of the area over the frames of presses, whose errors are not independent

STATED = 0.02


def pressed(seed: int, presses: int = 1, frames: int = 40) -> Rows:
    """Return the rows of presses whose areas have a smooth error of 2 %, as they state."""
    rng, seen = np.random.default_rng(seed), []
    for press in range(presses):
        error = 0.5 * STATED * smooth(0.3, rng, frames)
        for k, load in enumerate(np.linspace(0.1, 2, frames)):
            radius = 5 * load ** (1 / 3) * math.exp(error[k])
            axes = radius * np.exp([0.15, -0.15])
            noise = (STATED / 2 * radius) ** 2 * np.ones((2, 2))
            seen.append(frame(k, axes, load, of=f"p{press}", covariance_mm2=noise))
    return modelled(*seen)


def validity(rows: Rows) -> ValidityRecord:
    (found,) = validity_of(rows, pool_contacts(rows), [])
    return found


def test_a_press_is_as_uncertain_in_its_table_and_in_the_check_of_the_model():
    exponents: list[tuple[float, float]] = []
    for seed in range(12):
        rows = pressed(seed)
        exponent = area_exponent(rows.table)
        exponents.append((exponent.value, exponent.std))
        (growth,) = (one for one in validity(rows).checks if one.check == "area_against_load")
        value, std = exponents[-1]
        assert growth.value == pytest.approx(value)
        assert growth.value_std >= 0.4 * std
        assert growth.verdict != "fails"
    values, stds = np.transpose(exponents)
    assert np.all(np.abs(values - 2 / 3) < 3 * stds)
    assert np.mean(np.abs(values - 2 / 3) < 2 * stds) > 0.9
    assert np.all(stds > 0.005)


def test_more_frames_of_one_press_say_no_more():
    few, many = (area_exponent(pressed(1, frames=frames).table) for frames in (40, 160))
    assert many.std > 0.8 * few.std
    model_std = [
        validity(pressed(1, frames=frames)).headlines[MODULUS].model_relative_std for frames in (40, 160)
    ]
    assert model_std[1] == pytest.approx(model_std[0], abs=0.02)
