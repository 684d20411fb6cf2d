"""A second operator who does not see the first's outlines: what a run makes of both."""

from pathlib import Path

import numpy as np
import pytest
from tests.studies import correct, rows_by, rows_of, summary_of
from tests.study.small_study import PPI

from fingerpad.report import write_report
from fingerpad.study.corrections.log import SECOND_OPERATOR_NAME
from fingerpad.study.measuring.operators import blind_order
from fingerpad.study.pipeline import run_study
from fingerpad.study.status import verify_study

pytestmark = pytest.mark.usefixtures("small_pieces")
MM = 25.4 / PPI


def ellipse(major: float, minor: float, centre: tuple[float, float] = (60, 60)) -> dict:
    return {"ellipse_px": {"centre": [*centre], "semi_axes": [major, minor], "orientation_deg": 0}}


def second(manifest: Path, item: str, change: dict, who: str = "bob") -> None:
    correct(manifest.parent, item, change, who=who, name=SECOND_OPERATOR_NAME)


def test_two_persons_outlines_are_compared(finished):
    for k in range(3):
        correct(finished.parent, f"o{k}", ellipse(40, 30))
    second(finished, "o0", ellipse(44, 30))
    second(finished, "o1", ellipse(40, 30))
    second(finished, "o2", ellipse(40, 27, centre=(60, 62)))
    out = finished.parent / "out"
    result = run_study(finished, out, write_report=write_report)
    (found,) = result.operators
    assert (found.synthetic, found.count) == (True, 3)
    assert (found.first_operators, found.second_operators) == (["anna"], ["bob"])
    area = found.gross_area_mm2
    ratios = np.log([1.1, 1.0, 0.9])
    assert area.bias == pytest.approx(np.expm1(ratios.mean()), abs=2e-3)
    assert area.std == pytest.approx(ratios.std(ddof=1), rel=0.02)
    assert found.semi_major_mm.limits[1] > 0
    ious = {one.observation: one.iou for one in result.compared_pairs(synthetic=True)}
    assert ious["o0"] == pytest.approx(1 / 1.1, abs=0.01)  # one ellipse inside the other
    assert ious["o1"] == 1
    assert 0.8 < ious["o2"] < 0.9
    # The first operator's outlines are the results.
    assert rows_by(result)["o0"]["semi_major_mm"] == pytest.approx(40 * MM, rel=1e-3)
    lines = rows_of(out / "second_operator.csv")
    assert float(lines[0]["second_semi_major_mm"]) == pytest.approx(44 * MM, rel=1e-3)
    summary = summary_of(out)["second_operator"]
    assert summary[0]["gross_area_mm2"]["count"] == 3
    report = (out / "report.html").read_text()
    assert "Second operator" in report
    assert f"{100 * area.bias:+.1f} %" in report
    assert (out / "figures" / "second_operator_synthetic.svg").is_file()
    verified = verify_study(finished, out)
    assert not verified.faults
    assert SECOND_OPERATOR_NAME in verified.intact


def test_what_is_no_second_opinion_is_left_out(finished):
    correct(finished.parent, "o0", ellipse(40, 30))
    second(finished, "o0", ellipse(41, 30), "anna")  # the same person
    correct(finished.parent, "o1", {"rejected": "smeared"})
    second(finished, "o1", ellipse(41, 30))
    second(finished, "o2", ellipse(41, 30))  # the first has not looked at it
    correct(finished.parent, "o3", {"accepted": True})
    second(finished, "o3", {"rejected": "smeared"})
    result = run_study(finished, finished.parent / "out")
    assert result.operator_pairs == []
    assert not (finished.parent / "out" / "second_operator.csv").exists()
    # What the first accepted as the program measured it counts.
    second(finished, "o3", ellipse(41, 30))
    (pair,) = run_study(finished, finished.parent / "out").operator_pairs
    assert (pair.observation, pair.first_operator) == ("o3", "anna")


def test_random_order_takes_every_part_of_a_study_alike():
    names = [f"print_{k}" for k in range(400)]
    order = blind_order(names)
    assert sorted(order) == sorted(names)
    assert blind_order(names[::-1]) == order
    places = np.array([names.index(name) for name in order[:100]])
    assert places.mean() == pytest.approx(199.5, abs=3 * 115 / 10)
    assert abs(np.corrcoef(np.arange(400), [names.index(name) for name in order])[0, 1]) < 0.15
