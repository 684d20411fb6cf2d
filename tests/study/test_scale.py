"""Everything after measuring: the same however it is streamed, and never all of it in memory."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from tests.studies import contact, finger, study_of
from tests.study import many_rows
from tests.study.many_rows import measurements_of, sequences_of, study_result

from fingerpad.report import write_report
from fingerpad.study.manifest.models import Contact, Observation, Study
from fingerpad.study.measuring.contacts import Measurement
from fingerpad.study.measuring.fingers import FingerResult
from fingerpad.study.results import rows as rows_module
from fingerpad.study.results.pooling import pool_contacts
from fingerpad.study.results.rows import model_contacts
from fingerpad.study.results.table import COLUMNS


def test_batches_change_nothing(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(many_rows, "FRAMES", 200)
    whole = study_result(300, tmp_path)
    monkeypatch.setattr(rows_module, "_AT_ONCE", 7)
    parted = study_result(300, tmp_path)
    for name, column in COLUMNS.items():
        one, other = whole.rows[name].to_numpy(), parted.rows[name].to_numpy()
        if column.dtype == "text":
            assert one.tolist() == other.tolist()
        else:
            assert_allclose(one, other, rtol=1e-9)
    for one, other in zip(whole.summaries, parted.summaries, strict=True):
        assert one.pooled_from == other.pooled_from
        assert_allclose(one.corrected_radius.std, other.corrected_radius.std, rtol=1e-9)
    assert [check.observation for check in whole.checks] == [check.observation for check in parted.checks]


def test_no_more_than_a_batch_is_held() -> None:
    (sequence,) = sequences_of(1_900)
    alive: set[int] = set()
    most = 0

    class Counted(Measurement):
        def __del__(self) -> None:
            alive.discard(id(self))

    def seen() -> Iterator[tuple[Contact, Measurement]]:
        nonlocal most
        for one in measurements_of(sequence, 1_900):
            counted = Counted(**{name: getattr(one, name) for name in Measurement.__slots__})
            alive.add(id(counted))
            most = max(most, len(alive))
            yield sequence, counted
            del counted

    assert len(model_contacts(_study(), {"finger_0": _finger("finger_0")}, seen()).table) == 1_900
    assert most <= 2 * rows_module._AT_ONCE


def _study() -> Study:
    return study_of(finger(), uncertainty={"wedge_angle_deg_std": 0.5})


def _finger(name: str) -> FingerResult:
    axes, covariance = np.array([7.9, 13.8, 11.8]), 0.01 * np.eye(3)
    return FingerResult(name=name, semi_axes=axes, covariance=covariance, source="given", synthetic=True)


def test_very_many_single_contacts_are_pooled_without_a_matrix() -> None:
    count = 20_000  # whose matrix would take 3 GB
    rng = np.random.default_rng(4)
    noise = rng.normal(0, 0.1, (count, 2))

    def seen() -> Iterator[tuple[Contact, Measurement]]:
        observation = Observation.model_validate(contact("c", 1).keys)
        for number, axes in enumerate(np.add([7.0, 5.0], noise)):
            yield (
                observation,
                Measurement(
                    observation=f"c{number}",
                    load_N=1.0,
                    semi_major_mm=axes[0],
                    semi_minor_mm=axes[1],
                    covariance_mm2=0.01 * np.eye(2) + 0.02**2 * np.outer(axes, axes),
                    scale=f"s{number % 3}",
                    relative_scale_std=0.02,
                ),
            )

    rows = model_contacts(_study(), {"f": _finger("f")}, seen())
    (summary,) = pool_contacts(rows)
    pooled = summary.corrected_radius
    assert pooled is not None
    assert pooled.count == count
    assert pooled.fixed.birge_ratio == pytest.approx(1, abs=0.03)
    # What is left of so many contacts is the pad's own uncertainty.
    assert pooled.std == pytest.approx(rows.table.iloc[0]["mean_curvature_radius_mm_std"], rel=0.02)
    assert pooled.fixed_geometry < 0.01 * pooled.std


def test_a_report_of_many_rows_stays_small_and_says_what_is_left_out(tmp_path: Path) -> None:
    report = write_report(study_result(6_000, tmp_path), tmp_path)
    text = report.read_text(encoding="utf-8")
    assert report.stat().st_size < 2_500_000
    assert "150 of 1980 frames are drawn" in text
    assert "In 20 of its frames the contact is cut by the edge of the picture" in text
    assert "sequence_2</td><td>20 frames; the first: 7: the page is damaged" in text
