"""Results of the last run: rows, plots, uncertainty budgets, and the audit of published numbers."""

import math
import re
from collections import Counter
from collections.abc import Iterable, Mapping
from itertools import islice
from typing import Annotated, Final, Literal, TypeAlias

import numpy as np
import pandas as pd
from pydantic import Field

from fingerpad._arrays import BoolArray
from fingerpad._rounding import value_with_uncertainty
from fingerpad._words import capitalized, unbroken
from fingerpad.flags import FLAGS
from fingerpad.published import audit
from fingerpad.report.plots import group_name
from fingerpad.report.text import check_words, pooling_words, remedies
from fingerpad.study.corrections.log import ActiveCorrection, CorrectedPooling
from fingerpad.study.results import output
from fingerpad.study.results.summary_file import PLACEMENT, PlacementKey, UncertaintyCheckRecord
from fingerpad.study.results.table import COLUMNS, Row, items, records
from fingerpad.web.answers import Answer, Cell, Quantity, RequestError, unit_of, with_unit
from fingerpad.web.api.base import Opened, Params, Query, here, router
from fingerpad.web.glossary import GLOSSARY

_MOST_IN_QUESTION: Final = 200
Plotted: TypeAlias = Literal[
    "gross_area_mm2", "youngs_modulus_kpa", "radius_from_indentation_mm", "indentation_mm", "aspect_ratio"
]


class ColumnEntry(Answer):
    """A column of the results: its label with its unit, its meaning, and the symbol of its glossary."""

    key: str
    label: str
    words: str
    symbol: str | None


class Rows(Answer):
    """Some rows of the results, and the columns to show; quantities in words have no units."""

    total: int
    matching: int
    columns: list[ColumnEntry]
    rows: list[dict[str, Quantity | Cell]]


class Group(Answer):
    """A finger at one placement; `figure` begins the names of its figures in the report."""

    finger: str
    wedge_angle_deg: Quantity
    roll_angle_deg: Quantity
    synthetic: bool
    figure: str


class PooledContact(Answer):
    """A contact that is left out of the pooled radius, or about which a person or a flag has a say.

    `pooled` and `why` are of the last run; `correction` is what is wanted now.
    """

    item: str
    load_N: float | None  # noqa: N815
    pooled: bool
    why: str
    correction: CorrectedPooling | None


class Pooling(Answer):
    """How many contacts and frames of a group count in its pooled radius, and the contacts in question.

    `contacts` is the number of measured and rejected ones.
    """

    contacts: int
    contacts_pooled: int
    contacts_rejected: int
    frames: int
    frames_pooled: int
    in_question: list[PooledContact]


class PlottedGroup(Group):
    """A finger at one placement: what was found, the rows to plot, and whether Hertz theory holds.

    `answer` is the sentence of the report's first page. `points` are the columns that are plotted against
    the load of each item, `doubts` the limits of the model that rows are beyond. `radius_verdict` is that of
    the corrected radius, `radius_of_model` whether its standard uncertainty holds what the model leaves
    uncertain. `checks` are verdicts and words.
    """

    answer: str
    radius_from_indentation_mm: Quantity
    radius_verdict: str
    radius_of_model: bool
    mean_curvature_radius_mm: Quantity
    loading_radius_mm: Quantity
    items: list[str]
    load_N: list[float | None]  # noqa: N815
    pooled: list[bool]
    points: dict[str, list[Quantity]]
    doubts: list[str]
    verdict: str
    checks: list[tuple[str, str]]
    pooling: Pooling


class BudgetGroup(Group):
    """The uncertainty budget of a finger at one placement."""

    pooled: dict[str, float | None] | None
    check_words: str | None
    check: UncertaintyCheckRecord | None


class AuditedNumber(Answer):
    """A number printed by Dzidek et al. (2017), and what the equations give, in words."""

    item: str
    printed: str
    computed: str
    range: str
    with_misprint: str
    verdict: str
    formula: str
    remark: str


class RowsParams(Params):
    """Filters and order of rows, and whether they have the usual columns only."""

    offset: Annotated[int, Field(ge=0, le=10**9)] = 0
    limit: Annotated[int, Field(ge=1, le=2000)] = 100
    sort: Annotated[str, Field(max_length=80)] = ""
    finger: str | None = None
    status: str | None = None
    flag: str | None = None
    sequence: str | None = None
    text: Annotated[str, Field(max_length=200)] = ""
    wedge_angle_deg: float | None = None
    usual: bool = False


@router.get("/results/rows")
def rows(opened: Opened, params: Query[RowsParams]) -> Rows:
    """Return some rows of the results."""
    found = opened.require_results()
    chosen = found.table[_chosen(found.table, params)]
    if params.sort:
        key = params.sort.lstrip("-")
        if key not in found.table:
            raise RequestError.impossible(f"no column is named {key!r}")
        chosen = chosen.sort_values(key, ascending=not params.sort.startswith("-"), kind="stable")
    shown_names = [name for name in found.table if name not in _STDS]  # those stand beside their numbers
    if params.usual:
        layered = any(finger.effective_thickness_mm is not None for finger in opened.study().fingers)
        shown_names = [name for name in _USUAL if name in shown_names and (layered or "layer" not in name)]
    columns = [*dict.fromkeys((*_OF_A_ROW, *shown_names))]
    shown = chosen[params.offset : params.offset + params.limit]
    cells = zip(items(shown["observation"]), records(shown, *_with_stds(columns)), strict=True)
    return Rows.of(
        total=len(found.table),
        matching=len(chosen),
        columns=[
            ColumnEntry(key=name, label=_label(name), words=COLUMNS[name].meaning, symbol=_SYMBOLS.get(name))
            for name in shown_names
        ],
        rows=[{"item": item, **{name: _cell(row, name) for name in columns}} for item, row in cells],
    )


def _cell(row: Row, name: str) -> Quantity | Cell:
    value: Cell = row[name]
    return Quantity.read(row.get, name, "") if isinstance(value, float) else value


def _chosen(table: pd.DataFrame, params: RowsParams) -> BoolArray:
    chosen = np.ones(len(table), dtype=bool)
    for name in ("finger", "status", "sequence", "wedge_angle_deg"):
        if (wanted := getattr(params, name)) is not None:
            chosen &= table[name].to_numpy() == wanted
    if params.flag is not None:
        flagged = [params.flag in (flags or "").split() for flags in items(table["flags"])]
        chosen &= np.array(flagged, dtype=bool)
    if text := params.text.casefold():
        words = zip(*(items(table[name]) for name in ("observation", "finger", "reason")), strict=True)
        found = [text in " ".join(filter(None, each)).casefold() for each in words]
        chosen &= np.array(found, dtype=bool)
    return chosen


# What the page takes of each row, whichever columns it shows.
_OF_A_ROW: Final = ("observation", "synthetic", "flags", "reason", "file", "sequence")
# The usual columns in their order; those of a layer where a finger has a thickness.
_USUAL: Final = (
    *("finger", "wedge_angle_deg", "load_N", "status", "radius_from_indentation_mm", "semi_major_mm"),
    *("semi_minor_mm", "gross_area_mm2", "ridge_area_mm2", "indentation_mm", "youngs_modulus_kpa"),
    *("youngs_modulus_on_layer_kpa", "indentation_on_layer_mm", "loading_radius_on_layer_mm", "layer_flag"),
    *("radius_from_compliance_mm", "mean_curvature_radius_mm", "contact_radius_ratio", "measured_by"),
)
# Columns that are called neither by their symbols nor by their names.
_LABELS: Final = {
    "radius_from_indentation_mm": "Corrected R",
    "youngs_modulus_on_layer_kpa": "E on layer",
    "indentation_on_layer_mm": "ξ on layer",
    "loading_radius_on_layer_mm": "R_g on layer",
    "layer_flag": "Layer out of range",
    "measured_by": "By",
    "mm_per_px": "Scale",
}
_SYMBOLS: Final = {symbol.column: key for key, symbol in GLOSSARY.items() if symbol.column}


def _label(name: str) -> str:
    plain = re.sub(r"_(mm2?|kpa|deg|px|N|s)$", "", name).replace("_", " ").capitalize()
    return ", ".join(filter(None, (_LABELS.get(name) or _SYMBOLS.get(name, plain), unit_of(name))))


_RADIUS: Final = "radius_from_indentation_mm"
_FIXED: Final = "_fixed_geometry"
# What is plotted against load, and what beside it.
_PLOTTED: Final[Mapping[Plotted, tuple[str, ...]]] = {
    "gross_area_mm2": (),
    "youngs_modulus_kpa": ("youngs_modulus_on_layer_kpa",),
    _RADIUS: ("radius_from_compliance_mm", f"{_RADIUS}{_FIXED}"),
    "indentation_mm": ("indentation_on_layer_mm",),
    "aspect_ratio": (),
}
_POINTS: Final = (*_PLOTTED, *(name for beside in _PLOTTED.values() for name in beside))


def _with_stds(names: Iterable[str]) -> list[str]:
    """Return columns and those of their standard uncertainties."""
    return [one for name in names for one in (name, f"{name}_std", f"{name}_total_std") if one in COLUMNS]


# Columns of the standard uncertainty of another, the model's part in it where that is known.
_STDS: Final = frozenset(stds[-1] for name in COLUMNS if (stds := _with_stds([name])[1:]))

# What the plots take of a row.
_OF_ROWS: Final = (
    *(*PLACEMENT, "observation", "status", "frame", "load_N", "range_notes"),
    *("pooled", "excluding_flags", "pooling_corrected_by", "pooling_reason"),
    *_with_stds((*_POINTS, "semi_major_mm", "semi_minor_mm")),
)


@router.get("/results/plot")
def plot(opened: Opened, quantity: Plotted | None = None) -> list[PlottedGroup]:
    """Return the data to plot for each finger and placement, by default of all quantities."""
    found = opened.require_results()
    active = opened.corrections.active_corrections()
    placed: dict[PlacementKey, list[Row]] = {one.key: [] for one in found.summary.summaries}
    # All at once: pandas takes longer to choose the rows of a placement than there is to do with them.
    for row in records(found.table[[*_OF_ROWS]]):
        key = tuple(row[name] for name in PLACEMENT)
        if key in placed:
            # On a given pad only its standard uncertainty differs.
            placed[key].append({**row, f"{_RADIUS}{_FIXED}": row[_RADIUS]})
    answers = output.answers(found.summary.summaries, found.summary.by_load)
    names = (quantity, *_PLOTTED[quantity]) if quantity else _POINTS
    return [_group(one, placed[one.of.key], names, active) for one in answers]


def _group(
    found: output.Answer, placed: list[Row], names: Iterable[str], active: Mapping[str, ActiveCorrection]
) -> PlottedGroup:
    of = found.of
    rows = [row for row in placed if row["status"] == "measured"]
    rejected = sum(row["status"] == "rejected" and row["frame"] is None for row in placed)
    radius = of.validity.headlines[_RADIUS]
    to_do = remedies(of.validity.checks)
    codes = Counter(code for row in rows for code in (row["range_notes"] or "").split())
    return PlottedGroup.of(
        of,
        figure=group_name(of.key),
        answer=unbroken(f"{capitalized(found.text)}."),
        pooling=_pooling(rows, rejected, active),
        items=[row["observation"] for row in rows],
        load_N=[row["load_N"] for row in rows],
        pooled=[row["pooled"] for row in rows],
        points={
            name: [Quantity.read(row.get, name, unit_of(name.removesuffix(_FIXED))) for row in rows]
            for name in names
        },
        doubts=[
            f"{codes[code]} of {len(rows)} contacts and frames: {flag.words}. To do: {flag.to_do}."
            for code, flag in FLAGS["row"].items()
            if code in codes
        ],
        verdict=of.validity.verdict,
        checks=[
            (one.verdict, ". ".join(filter(None, (check_words(one), capitalized(to_do.get(one.check, ""))))))
            for one in of.validity.checks
        ],
        radius_verdict=radius.verdict,
        radius_of_model=not math.isnan(radius.model_std),
        radius_from_indentation_mm_total_std=radius.total_std,
    )


def _pooling(rows: list[Row], rejected: int, active: Mapping[str, ActiveCorrection]) -> Pooling:
    """Return how many measured rows are pooled, and the contacts that are not or about which there is a say.

    `rejected` is the number of the group's contacts that a person rejected.
    """
    contacts, frames = ([row for row in rows if (row["frame"] is None) is one] for one in (True, False))
    corrections = {item: one.pooling for item, one in active.items()}
    asked = (
        row
        for row in contacts
        if not row["pooled"] or row["excluding_flags"] or corrections.get(row["observation"])
    )
    return Pooling(
        contacts=len(contacts) + rejected,
        contacts_pooled=sum(row["pooled"] for row in contacts),
        contacts_rejected=rejected,
        frames=len(frames),
        frames_pooled=sum(row["pooled"] for row in frames),
        in_question=[
            PooledContact.of(row, item=item, why=pooling_words(row), correction=corrections.get(item))
            for row in islice(asked, _MOST_IN_QUESTION)
            for item in [row["observation"]]
        ],
    )


@router.get("/results/budget")
def budget(opened: Opened) -> list[BudgetGroup]:
    """Return the uncertainty budgets of pooled radii and of the highest-load contacts."""
    return [
        BudgetGroup.of(
            one,
            figure=group_name(one.key),
            pooled=one.radius_from_indentation_variance_shares,
            check=(check := one.uncertainty_check),
            check_words=check and f"{check.observation}: {value_with_uncertainty(check.value, check.std)} mm",
        )
        for one in opened.require_results().summary.summaries
    ]


@here.get("/published")
def published() -> list[AuditedNumber]:
    """Return the audit of the numbers that Dzidek et al. (2017) print."""

    def words(value: float | None, unit: str) -> str:
        return "–" if value is None else with_unit(value_with_uncertainty(value), unit)

    return [
        AuditedNumber.of(
            item,
            printed="–" if item.printed is None else with_unit(f"{item.printed:g}", item.unit),
            computed=words(item.computed, item.unit),
            range="–" if item.low is None else f"{words(item.low, '')} to {words(item.high, item.unit)}",
            with_misprint=words(item.with_misprint, item.unit),
        )
        for item in audit()
    ]
