"""Every number that the page is sent has the unit that its key says, as the tables of results have it."""

import math

import numpy as np
import pytest

from fingerpad.study.results.load import load_results
from fingerpad.study.results.table import COLUMNS
from fingerpad.web.answers import Answer, Quantity, semi_axes
from fingerpad.web.api.results import _label
from fingerpad.web.glossary import GLOSSARY

CONTACT = "synthetic_30deg_2N"


def test_numbers_are_those_of_the_tables(done, run_once):
    """A quantity that has a column is the column's value, in its unit; answers are the report's."""
    rows = {row["item"]: row for row in done.ask("results/rows", limit=2000)["rows"]}
    sentences = load_results(run_once / "results")._repr_html_()
    for group in done.ask("results/plot"):
        assert group["answer"][1:].replace("\xa0", " ") in sentences
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


def test_headers_name_the_unit_of_their_column():
    written = {"mm²": "mm2", "°": "deg", "": "1"}
    for column in (one for name, one in COLUMNS.items() if not name.endswith("_std")):
        unit = _label(column.name).partition(", ")[2]
        assert written.get(unit, unit).lower() == (column.unit or "1").lower(), column.name
