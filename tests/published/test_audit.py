"""The audit: no printed number missing, each with the right verdict, and nothing tuned to get it."""

import tomllib
from collections import Counter
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fingerpad.geometry import Ellipsoid
from fingerpad.published import AuditItem, audit, dzidek2017
from fingerpad.published.audit import radius_with_misprint
from fingerpad.published.dzidek2017 import Printed

REPRODUCED = "reproduced"
MISPRINT = "reproduced with the known misprint"
NOT = "not reproducible from what is printed"


@pytest.fixture(scope="module")
def items() -> dict[str, AuditItem]:
    found = audit()
    named = {item.item: item for item in found}
    assert len(named) == len(found)
    return named


def printed_numbers(table: object, path: tuple[str, ...] = ()) -> list[float]:
    """Return every number of the data file but the load, which only says where others hold."""
    if isinstance(table, dict):
        return [number for key, part in table.items() for number in printed_numbers(part, (*path, key))]
    if path == ("table3", "load_N"):
        return []
    return [float(number) for number in (table if isinstance(table, list) else [table])]


def test_each_printed_number_audited_once(items) -> None:
    text = files("fingerpad.published").joinpath("dzidek2017.toml").read_text(encoding="utf-8")
    expected = printed_numbers(tomllib.loads(text))
    assert len(expected) == 36
    measured = [item for item in items.values() if item.computed is None]
    assert len(measured) == 12
    assert all(item.verdict == NOT and "measured input" in item.remark for item in measured)
    assert sorted(item.printed for item in items.values()) == sorted(expected)


@pytest.mark.parametrize(
    ("method", "printed", "true"),
    [
        ("direct", [41.0, 30.2, 20.5, 12.2, 5.5], [22.58, 18.72, 14.57, 10.12, 5.45]),
        ("ellipse", [33.3, 25.3, 18.0, 11.6, 6.2], [20.36, 17.11, 13.67, 10.03, 6.25]),
    ],
)
def test_table_2(items, method, printed, true) -> None:
    row = [items[f"Table 2, {method}, u = {u}°"] for u in (0, 30, 45, 60, 90)]
    assert [item.printed for item in row] == printed
    assert_allclose([item.computed for item in row], true, atol=5e-3)
    assert_allclose([item.with_misprint for item in row], printed, atol=0.05)
    assert [item.verdict for item in row] == [MISPRINT] * 4 + [REPRODUCED]
    assert {item.unit for item in row} == {"mm"}


@pytest.mark.parametrize(
    ("name", "printed", "computed", "tolerance", "verdict"),
    [
        ("Text, ellipse, θ = 30°, R_0g", 18.7, 13.607666, 6e-7, NOT),
        ("Text, ellipse, θ = 45°, R_0g", 13.2, 9.982357, 6e-7, NOT),
        ("Table 3, θ = 30°, area", 116.3, np.pi * 7.4 * 5.0, 1e-12, REPRODUCED),
        ("Table 3, θ = 45°, area", 69.4, np.pi * 5.3 * 4.2, 1e-12, REPRODUCED),
        ("Table 3, θ = 30°, u", 47.6, 45.243495, 6e-7, NOT),
        ("Table 3, θ = 45°, u", 68.3, 60.210426, 6e-7, NOT),
        ("Table 4, θ = 30°, R_0g", 18.7, 13.607666, 6e-7, NOT),
        ("Table 4, θ = 45°, R_0g", 13.2, 9.982357, 6e-7, NOT),
        ("Table 4, θ = 30°, R_corr", 19.9, 18.7 / 0.995216154**3, 1e-6, NOT),
        ("Table 4, θ = 45°, R_corr", 14.0, 13.2 / 0.998311346**3, 1e-6, NOT),
        ("Pooled, θ = 30°, R_corr", 20.2, 18.97, 5e-3, NOT),
        ("Pooled, θ = 45°, R_corr", 14.2, 13.27, 5e-3, NOT),
        ("Pooled, θ = 30°, uncertainty of R_corr", 1.5, 0.02, 5e-3, NOT),
        ("Pooled, θ = 45°, uncertainty of R_corr", 0.6, 0.01, 5e-3, NOT),
    ],
)
def test_other_computed_values(items, name, printed, computed, tolerance, verdict) -> None:
    item = items[name]
    assert (item.printed, item.verdict) == (printed, verdict)
    assert_allclose(item.computed, computed, atol=tolerance)
    assert item.formula


def test_misprint_does_not_explain_wedge_radii(items) -> None:
    found = [items[f"Table 4, θ = {angle}°, R_0g"].with_misprint for angle in (30, 45)]
    assert_allclose(found, [17.89, 11.55], atol=5e-3)


def test_range_covers_rounding(items) -> None:
    item = items["Table 2, ellipse, u = 30°"]
    steps = np.linspace(-0.05, 0.05, 11)
    a, b, c = np.meshgrid(7.9 + steps, 13.8 + steps, 11.8 + steps)
    radii = Ellipsoid(a, b, c).curvature(np.radians(30), np.pi / 2).mean_curvature_radius
    assert_allclose([item.low, item.high], [radii.min(), radii.max()], rtol=1e-9)


def test_misprint_without_effect_at_fingertip() -> None:
    pad = dzidek2017().semi_axes["direct"].ellipsoid
    true = pad.curvature(np.pi / 2, np.pi / 2).mean_curvature_radius
    assert_allclose(radius_with_misprint(pad, np.pi / 2), true, rtol=1e-14)
    assert radius_with_misprint(pad, 0.0) > 1.5 * pad.curvature(0.0, np.pi / 2).mean_curvature_radius


@pytest.mark.parametrize(
    ("digits", "value", "rounding"), [("5.0", 5.0, 0.05), ("5", 5.0, 0.5), ("116.30", 116.3, 0.005)]
)
def test_rounding_from_last_digit(digits, value, rounding) -> None:
    assert Printed.of(digits) == Printed(value, rounding)


def test_the_docs_count_the_misprints() -> None:
    radii = [item for item in audit() if item.item.startswith("Table 2")]
    counts = Counter(item.verdict for item in radii)
    assert counts == {MISPRINT: 8, REPRODUCED: 2}
    root = Path(__file__).parents[2]
    page = (root / "docs/explanation/dzidek2017.md").read_text(encoding="utf-8")
    assert "Eight of the ten radii that it tabulates contain a misprint" in " ".join(page.split())
    paper = (root / "paper" / "paper.md").read_text(encoding="utf-8")
    assert "eight of ten tabulated radii contain a misprint" in paper
