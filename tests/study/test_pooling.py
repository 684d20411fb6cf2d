"""Pooled radii: what is shared stays, budgets add up, and the close look agrees with itself."""

import math
from copy import copy
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from benchmarks.claims import pooling
from tests import studies
from tests.study.measured import AXES, measured, pad

from fingerpad.image import SEMI_AXES
from fingerpad.report.text import pooled_from
from fingerpad.study.corrections.changes import ContactCorrection
from fingerpad.study.corrections.log import ActiveCorrection, CorrectedPooling
from fingerpad.study.manifest.models import Observation
from fingerpad.study.measuring.contacts import Measurement, excluding_flags, reviewed
from fingerpad.study.measuring.fingers import FingerResult
from fingerpad.study.results.model import GEOMETRY, PART_SOURCES, POOLED_OUTPUTS, contact_inputs
from fingerpad.study.results.pooling import PooledRadius, area_exponent, pool_contacts
from fingerpad.study.results.rows import Rows
from fingerpad.study.results.study_result import StudyResult, check_uncertainty
from fingerpad.study.results.table import record_at, records
from fingerpad.uncertainty import PAD_SOURCES

STATED = {"wedge_angle_deg_std": 1.0, "load_relative_std": 0.02}


def study(
    folder: Path, *, axes_std: float = 0.1, majors=(7.4, 7.0, 6.6), loads=(2, 1, 0.5), std=0.2
) -> StudyResult:
    contacts = (
        studies.contact(f"c{number}", load, (major, 5.0), std=std, axis="")
        for number, (major, load) in enumerate(zip(majors, loads, strict=True))
    )
    return studies.run(folder, studies.finger(std=axes_std), *contacts, uncertainty=STATED)


def test_what_the_pad_is_does_not_average_away(tmp_path):
    one, many = study(tmp_path, majors=[7.0], loads=[1]), study(tmp_path, majors=[7.0] * 30, loads=[1] * 30)
    (alone,), (pooled,) = (result.summaries for result in (one, many))
    geometry = record_at(one.rows)["mean_curvature_radius_mm_std"]
    assert alone.corrected_radius.total_std > pooled.corrected_radius.total_std > 0.98 * geometry
    assert pooled.corrected_radius.fixed_geometry == pytest.approx(
        alone.corrected_radius.fixed_geometry / np.sqrt(30), rel=1e-6
    )


def test_the_budget_adds_up_and_names_the_largest(tmp_path):
    (summary,) = study(tmp_path).summaries
    budget = summary.corrected_radius.budget
    assert set(budget) == {*PAD_SOURCES, "scatter"}
    assert sum(budget.values()) == pytest.approx(1)
    assert max(budget, key=budget.get) == "wedge angle"
    assert budget["load"] == budget["image scale"] == budget["Poisson's ratio"] == 0
    (exact,) = study(tmp_path, axes_std=1e-6).summaries
    assert exact.corrected_radius.budget["semi-axes"] < 1e-6 < budget["semi-axes"]


def test_scatter_enters_the_budget_and_that_of_repeats_and_of_loads_apart(tmp_path):
    (summary,) = study(tmp_path, majors=(9.0, 7.0, 5.2), std=0.001).summaries
    pooled = summary.corrected_radius
    assert pooled.fixed.birge_ratio > 3
    assert pooled.budget["scatter"] > 0.005
    assert pooled.between_std > 0
    (summary,) = study(tmp_path, majors=(7.0, 7.0, 9.0, 9.0), loads=(1, 1, 2, 2)).summaries
    components = summary.corrected_radius.scatter.components
    assert components["repeat"].std == pytest.approx(0, abs=1e-9)
    assert components["load"].std > 0.05


def test_the_pooled_radius_is_that_at_the_mean_elongation(tmp_path):
    """Of two contacts whose elongations scatter as stated: the mean of their radii is larger."""

    def measured(elongations: list[float]) -> StudyResult:
        contacts = []
        for number, elongation in enumerate(elongations):
            major, minor = 6 * math.exp(elongation / 2), 6 * math.exp(-elongation / 2)
            std = 0.1 * math.sqrt(2) / math.hypot(1 / major, 1 / minor)  # √2 · 0.1 of the elongation
            # Under different loads: contacts under one would be repeats.
            contacts.append(studies.contact(f"c{number}", number + 1, (major, minor), std=std, axis=""))
        return studies.run(tmp_path, studies.finger(), *contacts, uncertainty=STATED)

    scattered, mean = measured([0.3, 0.5]), record_at(measured([0.4]).rows)["radius_from_indentation_mm"]
    naive = np.mean([row["radius_from_indentation_mm"] for row in records(scattered.rows)])
    pooled = scattered.summaries[0].corrected_radius
    assert pooled.value == pytest.approx(mean, abs=0.1 * (naive - mean))
    assert naive - mean > 0.005


STUDY = studies.study_of(studies.finger(std=0.5))
OUTPUT = "radius_from_indentation"


def finger(scale: str | None) -> FingerResult:
    """Return a finger whose photographs share a scale known to 4 %, besides 0.5 mm of each axis."""
    covariance = 0.25 * np.eye(3) + (0.04**2 * np.outer(AXES, AXES) if scale else 0.0)
    return pad(covariance=covariance, source="photographs", scale=scale)


def contact(
    number: int, scale: str | None = None, axes: Any = None, **more: Any
) -> tuple[Observation, Measurement]:
    axes = np.array([7.0 + 0.2 * number, 5.0]) if axes is None else axes
    covariance = 0.01 * np.eye(2) + 0.04**2 * np.outer(axes, axes)
    given = {"covariance_mm2": covariance, "scale": scale, "relative_scale_std": 0.04}
    return measured(f"c{number}", axes, **{**given, **more})


def modelled(*seen: tuple[Observation, Measurement], scale: str | None = None) -> Rows:
    """Return the rows of contacts of the finger."""
    return Rows(STUDY, {"f": finger(scale)}, seen)


def with_parts(rows: Rows, parts: dict[tuple[str, int], float], **more: Any) -> Rows:
    """Return rows whose uncertainty comes of these parts alone: of a source's first or last place."""
    every = np.zeros((len(rows.pooled), len(POOLED_OUTPUTS), PART_SOURCES.size))
    for (source, place), part in parts.items():
        every[:, :, np.flatnonzero(source == PART_SOURCES)[place]] = part
    changed = copy(rows)
    for name, of in {"parts": every, **more}.items():
        setattr(changed, name, of)
    return changed


def pooled(rows: Rows, estimate: list[int]) -> PooledRadius:
    return PooledRadius.of(rows, rows.table, np.array(estimate), OUTPUT)


@pytest.mark.parametrize(
    ("of_finger", "of_contact", "is_shared"),
    [("a", "a", True), ("a", "b", False), ("a", None, False), (None, "a", False), (None, None, False)],
)
def test_only_one_and_the_same_named_scale_is_shared(of_finger, of_contact, is_shared):
    inputs = contact_inputs(STUDY, {"f": finger(of_finger)}, [contact(0, of_contact)])
    found = inputs.covariance[0, inputs.places(SEMI_AXES), inputs.places(["image_scale"])]
    np.testing.assert_allclose(found, 0.04**2 * AXES if is_shared else 0.0)


def test_the_close_look_takes_a_shared_scale_as_one_source():
    """Sobol indices are of independent sources, which semi-axes and scale are no longer."""
    rows = modelled(contact(0, "a"), scale="a")
    (highest,) = rows.highest_load.values()
    check = check_uncertainty("c0", highest.inputs)
    assert set(check.shares) == {"semi-axes and scale", *PAD_SOURCES} - {"semi-axes", "image scale"}
    assert sum(check.shares.values()) == pytest.approx(1)
    assert check.std == pytest.approx(rows.table[f"{OUTPUT}_mm_std"].to_numpy()[0])
    assert check.interval == pytest.approx(
        (check.value - 1.96 * check.std, check.value + 1.96 * check.std), rel=1e-4
    )
    assert check.simulated_std == pytest.approx(check.std, rel=0.05)


def test_stated_uncertainties_of_angles_are_degrees():
    stated = {"wedge_angle_deg_std": 0.5, "roll_angle_deg_std": 3.0}
    study = studies.study_of(studies.finger(), uncertainty=stated)
    inputs = contact_inputs(study, {"f": finger(None)}, [contact(0)])
    stds = inputs.std[0, inputs.places(["wedge_angle", "roll_angle"])]
    assert np.degrees(stds) == pytest.approx([0.5, 3.0])


def test_the_scale_is_not_counted_twice_in_the_ellipse():
    inputs = contact_inputs(STUDY, {"f": finger(None)}, [contact(0, "a")])
    places = inputs.places(["contact_radius", "elongation"])
    expected = np.hypot(0.1 / 7, 0.1 / 5)
    np.testing.assert_allclose(inputs.std[0, places], [0.5 * np.sqrt(35) * expected, expected], rtol=1e-9)
    (row,) = records(modelled(contact(0, "a")).table)
    assert [row[f"semi_{axis}_mm_noise_std"] for axis in ("major", "minor")] == pytest.approx([0.1, 0.1])


EDGE = {"covariance_mm2": 0.01 * np.eye(2) + 0.3**2, "relative_scale_std": 0.0, "edge_offset_mm_std": 0.3}


def test_the_edge_is_not_counted_twice_in_the_ellipse():
    inputs = contact_inputs(STUDY, {"f": finger(None)}, [contact(0, "a", **EDGE)])
    assert inputs.std[0, inputs.places(["edge_offset", "elongation"])] == pytest.approx(
        [0.3, np.hypot(0.1 / 7, 0.1 / 5)], rel=1e-9
    )
    (row,) = records(modelled(contact(0, "a", **EDGE)).table)
    assert row["semi_minor_mm_std"] == pytest.approx(np.hypot(0.1, 0.3))
    assert row["semi_minor_mm_noise_std"] == pytest.approx(0.1)
    # E* goes with the cube of the contact's radius.
    assert row["youngs_modulus_kpa_edge_std"] == pytest.approx(
        1.5 * (0.3 / 7 + 0.3 / 5) * row["youngs_modulus_kpa"], rel=0.02
    )


@pytest.mark.parametrize(
    ("scales", "sizes"),
    [("aaa", [3]), ("abb", [1, 2]), ((None, None, None), [3]), (("a", None, None), [1, 2])],
)
def test_images_of_one_device_share_its_edge(scales, sizes):
    seen = [contact(0, scale, **EDGE) for scale in scales]
    exact = replace(finger(None), covariance=1e-12 * np.eye(3))
    rows = Rows(STUDY, {"f": exact}, seen)
    found = pooled(rows, [0, 1, 2])
    alone = rows.table[f"{OUTPUT}_mm_edge_std"].to_numpy()[0]
    expected = alone * np.linalg.norm(sizes) / 3
    share = np.sqrt(found.budget["contact edge"]) * found.total_std
    assert share == pytest.approx(expected, rel=0.02)


@pytest.mark.parametrize(
    ("scales", "sizes"),
    [("aaa", [3]), ("abb", [1, 2]), ((None, None, None), [1, 1, 1]), (("a", None, None), [1, 1, 1])],
)
def test_contacts_share_the_error_of_a_scale_that_they_name(scales, sizes):
    seen = [contact(0, scale, covariance_mm2=0.01 * np.eye(2), relative_scale_std=0.0) for scale in scales]
    rows = with_parts(modelled(*seen), {("image scale", 0): 0.3, ("contact ellipse", 1): 0.4})
    found = pooled(rows, [0, 1, 2]).fixed
    assert found.std == pytest.approx(0.4 / np.sqrt(3))
    shared = 0.3 * np.linalg.norm(sizes) / 3
    assert found.total_std == pytest.approx(np.hypot(found.std, shared))


def test_frames_of_a_sequence_have_the_weights_of_their_own_uncertainties():
    plain, stds = modelled(*map(contact, (0, 4, 8))), np.array([0.01, 0.02, 0.05])
    rows = with_parts(plain, {("contact ellipse", 1): 0.1}, elongation_std=stds)
    radii = rows.table[f"{OUTPUT}_mm"].to_numpy()
    found = pooled(rows, [0, 0, 0])
    assert found.count == 1
    assert found.value == pytest.approx(np.average(radii, weights=[1 / 1, 1 / 4, 1 / 25]))
    assert found.value != pytest.approx(radii.mean(), abs=1e-3)


def test_a_fixed_geometry_leaves_out_the_geometry_only():
    second_order = {(GEOMETRY[0], -1): 0.5, ("Poisson's ratio", -1): 0.3, ("contact ellipse", -1): 0.4}
    rows = with_parts(modelled(contact(0), contact(1)), second_order, elongation_std=np.zeros(2))
    found = pooled(rows, [0, 1])
    assert found.fixed_geometry == pytest.approx(np.hypot(found.fixed.std, 0.3))
    assert found.total_std == pytest.approx(np.sqrt(found.fixed.std**2 + 0.3**2 + 0.5**2))


@pytest.mark.parametrize(
    ("flags", "reviewed", "counts"),
    [
        ((), None, True),
        (("coin_shadow",), None, True),
        (("low_contrast",), None, False),
        (("poor_ellipse",), None, False),
        (("several_regions",), None, False),
        (("several_regions", "poor_ellipse"), "accepted", True),
        (("low_contrast",), "corrected", True),
        (("scale_doubtful",), "accepted", False),
        (("touches_border",), "accepted", False),
        (("not_a_contact_image",), "accepted", False),
        (("low_contrast", "cut_by_mask"), "corrected", False),
    ],
)
def test_flags_keep_contacts_from_being_pooled(flags, reviewed, counts):
    rows = modelled(contact(0), contact(1, flags=flags, reviewed=reviewed))
    assert rows.table["status"].tolist() == ["measured", "measured"]
    assert rows.table["pooled"].tolist() == [True, counts]
    assert rows.pooled.tolist() == [0, 1][: 1 + counts]
    (summary,) = pool_contacts(rows)
    assert pooled_from(summary) == ("2 observations" if counts else "1 of 2 observations")
    assert summary.places.size == 2


@pytest.mark.parametrize(
    ("flags", "wanted", "rejected", "counts"),
    [
        (("touches_border",), None, None, False),
        (("touches_border",), True, None, True),
        ((), False, None, False),
        ((), True, "blurred", False),  # what is rejected never counts
    ],
)
def test_a_person_decides_what_flags_would(flags, wanted, rejected, counts):
    pooling = None if wanted is None else {"include": wanted, "why": "seen"}
    change = ContactCorrection.model_validate({"pooling": pooling, "rejected": rejected})
    by_a = CorrectedPooling(**pooling, who="A", when="") if pooling else None
    said = ActiveCorrection(item="c1", change=change, who="B", when="", pooling=by_a)
    where, measured = contact(1, flags=flags)
    rows = modelled(contact(0), (where, reviewed(measured, said)))
    row = rows.table.iloc[1]
    assert row["pooled"] == counts
    assert row["excluding_flags"] == " ".join(flags)
    assert row["pooling_corrected_by"] == ("A" if pooling else None)
    assert row["reviewed"] == ("rejected" if rejected else None)
    assert rows.pooled.tolist() == [0, 1][: 1 + counts]


@pytest.mark.parametrize(
    ("flags", "counts"), [(("several_regions",), True), (("several_regions", "poor_ellipse"), False)]
)
def test_a_seed_says_which_of_several_regions_is_meant(flags, counts):
    where, measured = contact(0, flags=flags)
    seeded = where.model_copy(update={"seed_px": (5.0, 5.0)})
    assert (excluding_flags(seeded, measured) == frozenset()) == counts
    assert excluding_flags(where, measured) == set(flags)


def test_an_edge_further_out_makes_the_exponent_smaller():
    """The stated uncertainty is the change that an edge displaced by its own makes."""
    loads, edge = np.array([0.25, 1.0, 4.0]), {"scale": "a", "edge_offset_mm_std": 0.1}

    def exponent(offset: float, **more: Any) -> tuple[float, float]:
        sizes = 4.0 * loads**0.3
        axes = np.transpose([1.2 * sizes + offset, sizes + offset])
        seen = [contact(k, axes=axes[k], load=load, **more) for k, load in enumerate(loads)]
        found = area_exponent(modelled(*seen).table)
        return found.value, found.std

    (plain, _), (moved, _) = exponent(0.0), exponent(0.1)
    found, std = exponent(0.0, **edge)
    assert plain == pytest.approx(0.6)
    assert found == plain
    assert std == pytest.approx(plain - moved, rel=0.03)
    # Contacts that lie on a line by chance are no better known than their areas.
    noisy = exponent(0.0, gross_area_mm2=50.0, gross_area_mm2_std=2.0, gross_area_mm2_noise_std=2.0)
    assert noisy == (plain, pytest.approx(0.04 / np.log(4) / 2**0.5))


@pytest.mark.nightly
def test_radii_pooled_over_contacts_are_unbiased_and_their_intervals_hold():
    found = pooling.score(pooling.contacts, 5, 0.03, 0.39, repeats=400)
    assert (np.abs(found.bias) < 0.15).all()  # known to 0.04
    assert ((found.covered > 0.92) & (found.covered < 0.98)).all()


def test_the_interval_of_an_exponent_has_students_t_for_few_contacts():
    rng, loads, held = np.random.default_rng(8), np.array([0.25, 0.5, 1.0, 2.0]), []
    sure = {"covariance_mm2": 1e-6 * np.eye(2)}  # else what is stated of each contact hides their scatter
    for _ in range(100):
        sizes = 4.0 * loads ** (1 / 3) * np.exp(rng.normal(0, 0.0225, 4))
        seen = [contact(k, axes=[1.2 * size, size], load=loads[k], **sure) for k, size in enumerate(sizes)]
        low, high = area_exponent(modelled(*seen).table).interval
        held.append(low < 2 / 3 < high)
    assert 0.9 < np.mean(held) < 0.99


@pytest.mark.parametrize(("loads", "is_known"), [((1, 2), False), ((1, 2, 2), True), ((1, 2, 4), True)])
def test_an_exponent_from_two_contacts_has_no_standard_uncertainty(tmp_path, loads, is_known):
    majors = 6.5 * np.array(loads) ** 0.4
    (summary,) = study(tmp_path, majors=majors + [0, 0, 0.1][: len(loads)], loads=loads).summaries
    exponent = area_exponent(summary.areas)
    assert 0.3 < exponent.value < 0.5
    assert np.isfinite(exponent.std) == is_known
