"""Ellipses that any program measured become observations of a study."""

import math
from pathlib import Path

import pytest

from fingerpad.exceptions import CalibrationError, FingerpadError, ManifestError
from fingerpad.study.imports.ellipses import (
    ManualObservation,
    MeasuredEllipse,
    manual_observations,
    write_observations,
)
from fingerpad.study.manifest.sheet import Sheet


def ellipse(label: str = "a", semi_major: float = 7.4, semi_minor: float = 5.0, **more: object):
    given = {"source": "t, line 2", "orientation_deg": 0.0, **more}
    return MeasuredEllipse(label=label, semi_major=semi_major, semi_minor=semi_minor, **given)


def observations(*ellipses: MeasuredEllipse, **given: object) -> list[ManualObservation]:
    return manual_observations(ellipses, **{"mm_per_unit": 1, "semi_axis_mm_std": 0.1, **given})


@pytest.mark.parametrize(
    ("pattern", "label", "reported"),
    [
        ("{finger}_{load}N", "ring_2N.tif", {"finger": "ring", "load_N": 2}),
        ("{finger}_{wedge}deg*", "left_ring_4.5deg_x", {"finger": "left_ring", "wedge_angle_deg": 4.5}),
        ("{person}_{finger}_{load}mN", "S1_LI_500mN.TIF:0012", {"finger": "S1_left_index", "load_N": 0.5}),
        ("*_{load}N", "stack.x_0p25N", {"load_N": 0.25}),
        ("{load}N*roll{roll}", "1,5N_xx_roll-10", {"load_N": 1.5, "roll_angle_deg": -10}),
        ("{load} N (a+b)", "2 N (a+b)", {"load_N": 2}),
        ("{load}N", "0.5N", {"load_N": 0.5}),
    ],
)
def test_labels_tell_what_the_pattern_says(pattern: str, label: str, reported: dict[str, object]) -> None:
    found = observations(ellipse(label), ellipse("other"), pattern=pattern)
    assert [row.values for row in found] == [reported, {}]


def test_a_person_in_labels_is_in_front_of_the_finger_of_all() -> None:
    (row,) = observations(ellipse("S7"), pattern="{person}", known={"finger": "index"})
    assert row.values == {"finger": "S7_index"}


@pytest.mark.parametrize(
    ("orientation", "finger_axis", "long_axis"),
    [
        (0, 0, "along"), (90, 0, "across"), (-80, 0, "across"), (80, 90, "along"), (-80, 90, "along"),
        (10, 90, "across"), (None, 0, None),
    ],
)  # fmt: skip
def test_the_long_axis_is_told_from_the_finger(
    orientation: float | None, finger_axis: float, long_axis: str | None
) -> None:
    (row,) = observations(ellipse(orientation_deg=orientation), finger_axis_deg=finger_axis)
    assert row.long_axis == long_axis


def test_a_scale_s_uncertainty_widens_the_axes() -> None:
    given = {"mm_per_unit": 0.05, "semi_axis_mm_std": 0.3, "relative_scale_std": 0.08}
    (row,) = observations(ellipse("a", 100, 100), **given)
    assert (row.semi_major_mm, row.ellipse_mm_std) == pytest.approx((5.0, 0.5))  # 0.3 and 0.4 in quadrature


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"pattern": "{face}"}, "{face} is unknown: a pattern holds {person}, {finger}, {wedge}, {roll}"),
        ({"pattern": "{load}_{load}"}, "{load} stands twice"),
        ({"pattern": "w{load}N"}, "'w{load}N' fits no label, such as '2N'"),
        ({"pattern": "{finger}_{load}N"}, "fits no label.* only hand and digit"),
        ({"pattern": "{load}N", "known": {"load_N": 2}}, "load_N is given for all"),
        ({"semi_axis_mm_std": 0}, "must be positive, found 0 mm"),
        ({"finger_axis_deg": math.nan}, "finger_axis_deg must be a finite number"),
        ({"known": {"load_N": -1}}, "line 2: load_N: expected greater than 0, found -1"),
        ({"known": {"wedge_angle_deg": 100}}, "line 2: wedge_angle_deg: .* 90, found 100"),
        ({"mm_per_unit": 25.4}, "line 2: a semi-major axis of 188 mm is none .* scale$"),
        ({"mm_per_unit": 25.4, "unit_hint": "it measures in px"}, r"the scale \(it measures in px\)$"),
    ],
)
def test_what_cannot_be_meant_is_refused(changed: dict[str, object], message: str) -> None:
    error = CalibrationError if "mm_per_unit" in changed else ManifestError
    with pytest.raises(error, match=message):
        observations(ellipse("2N"), **changed)


def test_names_are_such_as_a_manifest_takes_and_never_the_same(tmp_path: Path) -> None:
    labels = [
        "a b/c.tif:0001-0203",
        "A B C.TIF:0001-0203",
        "",
        "../..",
        "ж" * 90,
        "ж" * 80,
        "a.tif",
        "a",
        "a_2",
    ]
    known = {"finger": "index", "wedge_angle_deg": 30.0, "load_N": 2.0}
    write_observations(tmp_path / "o.csv", observations(*map(ellipse, labels), known=known))
    rows = Sheet.parse("o.csv", (tmp_path / "o.csv").read_bytes()).tables()
    names = [content["name"] for _, content, _ in rows]
    assert names[:2] == ["a_b_c_0001-0203", "A_B_C_0001-0203_2"]
    assert len({name.casefold() for name in names}) == len(labels)


def test_where_nothing_can_be_written_it_is_said(tmp_path: Path) -> None:
    with pytest.raises(FingerpadError, match="o.csv: cannot be written"):
        write_observations(tmp_path / "nowhere" / "o.csv", [])
