"""Every number that the page is sent has the unit that its key says, as the tables of results have it."""

import math
import re
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from fingerpad.study.results.table import COLUMNS, GLOSSARY
from fingerpad.web.answers import UNITS as WRITTEN
from fingerpad.web.answers import Answer, Quantity, semi_axes
from fingerpad.web.api.results import _label

CONTACT = "synthetic_30deg_2N"
PHOTOGRAPH = "synthetic_pad/synthetic/photograph_palmar.jpg"
# What the page shows a key's unit by: the longest ending counts.
UNITS = {
    "mm_per_px": "mm/px",
    "_mm2": "mm2",
    "_mm": "mm",
    "_kpa": "kPa",
    "_deg": "deg",
    "_px": "px",
    "_ppi": "ppi",
    "_N": "N",
    "_s": "s",
}
# Pure numbers and counts, and what holds numbers that follow units of their own.
PURE = {
    "aspect_ratio", "bits", "bytes", "chi_square", "columns_px", "contact_radius_ratio",
    "degrees_of_freedom", "exponent_std", "relative_difference", "draws", "between_relative_std",
    "ellipse_iou", "frame", "frames", "id", "indentation_over_thickness", "last_id",
    "load_gain_relative_std", "load_relative_std", "matching", "milliseconds", "orientation", "p_value",
    "poisson_ratio", "poisson_ratio_std", "predicted_aspect_ratio", "relative_std", "rows", "rows_px",
    "shares", "pooled", "total", "threshold", "version", "used_by", "corrected", "rejected", "reviewed",
    "contacts", "contacts_pooled", "contacts_rejected", "frames_pooled", "scale", "frames_per_second",
    "flags", "missing", "history",
    "exponent",  # of a superellipse
    "deviations",  # in standard uncertainties
    "difference",  # relative
    "disagreements",  # relative differences, shown in percent
    "table",  # as the manifest states it, under its own keys
} | {"normal", "principal_directions", "range_notes", "wedge_faces", "counts", "run", "limits"}  # fmt: skip
RELATIVE = {"disagreements", "shares"}
# Of a unit that an item beside them names, or that stands in the sentence beside them.
NAMED_BESIDE = {"printed", "computed", "low", "high", "with_misprint", "value", "std"} | {
    *("reference", "reference_std", "value_std", "interval", "simulated_interval", "simulated_std")
}
IN_PIXELS = {"ellipse_px", "semi_axes", "centre"}


def numbers(value: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], float]]:
    if isinstance(value, dict):
        for key, part in value.items():
            yield from numbers(part, (*path, key))
    elif isinstance(value, list):
        for part in value:
            yield from numbers(part, path)
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield path, value


def unit_of(key: str) -> str | None:
    """The unit that a key ends with; `_std` and its kin are in that of their quantity."""
    stem = re.sub(r"(_noise|_edge|_fixed_geometry|_repeatability|_model|_total)?(_std)?$", "", key)
    return next((unit for ending, unit in UNITS.items() if stem.endswith(ending)), None)


def answers(client: Any) -> Iterator[tuple[str, Any]]:
    for path in (
        "/api/studies/demo/state",
        "/api/studies/demo/frames?sequence=synthetic_press_30deg",
        "/api/studies/demo/results/rows",
        "/api/studies/demo/results/plot",
        "/api/studies/demo/results/budget",
        "/api/published",
        f"/api/studies/demo/picture/info?item={CONTACT}",
        f"/api/studies/demo/corrections?item={CONTACT}",
    ):
        yield path, client.get(path).raise_for_status().json()
    for path, body in (
        ("/api/studies/demo/measure/contact", {"item": CONTACT, "change": {"threshold": 100}}),
        ("/api/studies/demo/measure/photograph", {"item": PHOTOGRAPH, "with_finger": True}),
        ("/api/studies/demo/measure/scale", {"table": {"ppi": 500}}),
        ("/api/studies/demo/measure/length", {"scale": {"ppi": 500}, "line_px": [[0, 0], [0, 100]]}),
        ("/api/studies/demo/geometry", {"finger": "synthetic_pad"}),
    ):
        yield path, client.post(path, json=body).raise_for_status().json()


def test_every_number_has_the_unit_of_its_column(done):
    """By the key itself or by one that holds it, as semi_axes_mm; nothing is left without."""
    nameless = set()
    for source, answer in answers(done):
        for found, _ in numbers(answer):
            # A quantity is in the unit of its key.
            is_quantity = found[-1] in {"value", "std"} and found[-2] != "check"
            path = found[:-1] if is_quantity else found
            key = path[-1]
            units = [unit for each in reversed(path) if (unit := unit_of(each)) is not None]
            if key in COLUMNS and COLUMNS[key].unit == "1":
                assert unit_of(key) is None, (source, path)
            elif key in COLUMNS and COLUMNS[key].unit:
                assert units[:1] == [COLUMNS[key].unit], (source, path)
            if not units and {*path}.isdisjoint(PURE | NAMED_BESIDE | IN_PIXELS):
                nameless.add(f"{source}: {'.'.join(path)}")
            if not {*path}.isdisjoint(RELATIVE):
                assert not units, (source, path)
    assert sorted(nameless) == []  # name them by their endings, or list them above


def test_numbers_are_those_of_the_tables(done):
    """A quantity that has a column is the column's value, in its unit."""
    rows = {row["item"]: row for row in done.ask("results/rows", limit=2000)["rows"]}
    for group in done.ask("results/plot"):
        for place, item in enumerate(group["items"]):
            row, point = rows[item], {key: shown[place] for key, shown in group["points"].items()}
            on_given_pad = point.pop("radius_from_indentation_mm_fixed_geometry")
            assert on_given_pad["value"] == point["radius_from_indentation_mm"]["value"]
            if row["gross_area_mm2"] is None:  # no image was measured: that of the ellipse is plotted
                area, axes = point.pop("gross_area_mm2"), (row["semi_major_mm"], row["semi_minor_mm"])
                assert area["value"] == pytest.approx(math.pi * axes[0]["value"] * axes[1]["value"])
                assert 0 < area["std"] < 0.05 * area["value"]
            assert group["load_N"][place] == row["load_N"]["value"]
            for key, quantity in point.items():
                stated = row[key] or {"value": None, "std": None}
                assert (quantity["value"], quantity["std"]) == (stated["value"], stated["std"]), key
    model = done.tell("measure/contact", item=CONTACT)
    found = {**model["numbers"], **model["model"]["numbers"]}
    shared = [key for key in found if key in COLUMNS and found[key] and rows[CONTACT][key]]
    assert len(shared) > 10
    for key in shared:
        for part in ("value", "std"):
            stated = rows[CONTACT][key][part]
            assert found[key][part] == (stated and pytest.approx(stated, rel=1e-3, abs=1e-6)), key


def test_words_have_those_units():
    """Numbers in words and headers of the table name the unit of their key."""
    written = {"mm²": "mm2", "°": "deg"}
    said = {key: written.get(unit, unit) for key, unit in WRITTEN.items() if key != "_per_mm"}
    assert said == UNITS
    for column in (one for name, one in COLUMNS.items() if not name.endswith("_std")):
        unit = _label(column.name).partition(", ")[2]
        assert written.get(unit, unit).lower() == ("" if column.unit == "1" else column.unit.lower()), (
            column.name
        )


def test_quantities_in_words():
    """Rounded by the standard uncertainty, by that with the model's part where there is one."""

    class Some(Answer):
        gross_area_mm2: Quantity
        youngs_modulus_kpa: Quantity
        wedge_angle_deg: Quantity
        ellipse_iou: Quantity

    some = Some.of(
        gross_area_mm2=1234.5,
        gross_area_mm2_std=56.7,
        youngs_modulus_kpa=39.3,
        youngs_modulus_kpa_std=4.1,
        youngs_modulus_kpa_total_std=94.0,
        wedge_angle_deg=30,
        ellipse_iou=None,
    )
    assert some.youngs_modulus_kpa.std == 94.0
    assert {key: quantity.words.replace("\u00a0", " ") for key, quantity in some} == {
        "gross_area_mm2": "1234 ± 57 mm²",
        "youngs_modulus_kpa": "39 ×/÷ 3.4 kPa",
        "wedge_angle_deg": "30°",
        "ellipse_iou": "–",
    }
    axes = semi_axes(np.array([7.9, 13.8, 11.8]), np.array([0.0996, 0.2, 0.3]))
    assert axes["palmar"].words.replace("\u00a0", " ") == "7.90 ± 0.10 mm"


def test_symbols_are_those_of_their_columns():
    written = {"": "1", "°": "deg"}
    for symbol, meaning in GLOSSARY.items():
        if meaning.column:
            unit = COLUMNS[meaning.column].unit
            assert written.get(meaning.unit, meaning.unit) == unit, symbol
