"""Results of the last run: rows, plots, uncertainty budgets, and the audit of published numbers."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import asdict
from typing import Annotated, Any, Final

import numpy as np
import pandas as pd
from fastapi import Query
from pydantic import Field

from fingerpad._arrays import BoolArray
from fingerpad.flags import FLAGS
from fingerpad.published import audit
from fingerpad.report.plots import group_name
from fingerpad.report.text import pooling_words
from fingerpad.study.corrections.items import ActiveCorrection
from fingerpad.study.results.load import Results
from fingerpad.study.results.result_set import RERUN
from fingerpad.study.results.rows import PLACEMENT
from fingerpad.study.results.summary_file import PlacementRecord
from fingerpad.study.results.table import COLUMNS, Column, items, records
from fingerpad.web.answers import results as answers
from fingerpad.web.api.base import Opened, Params, api_router, study_router
from fingerpad.web.api.corrections import pooling_correction
from fingerpad.web.errors import RequestError
from fingerpad.web.last_results import last_results, results_faults
from fingerpad.web.study_session import StudySession

router = study_router()
here = api_router("/api")

_MOST_IN_QUESTION: Final = 200


def require_results(opened: StudySession) -> Results:
    """Return the results of the last run.

    Raises
    ------
    RequestError
        If there are none, or they are damaged.
    """
    found = last_results(opened)
    if found is None:
        faults = results_faults(opened)
        if faults:
            raise RequestError.conflict(f"{'; '.join(faults[:3])}: {RERUN}")
        raise RequestError.not_there("there are no results yet: run the study")
    return found


class RowsParams(Params):
    """Filters, order and columns of rows."""

    offset: Annotated[int, Field(ge=0, le=10**9)] = 0
    limit: Annotated[int, Field(ge=1, le=2000)] = 100
    sort: Annotated[str, Field(max_length=80)] = ""
    finger: str | None = None
    status: str | None = None
    flag: str | None = None
    sequence: str | None = None
    text: Annotated[str, Field(max_length=200)] = ""
    wedge_angle_deg: float | None = None
    columns: Annotated[str, Field(max_length=4000)] = ""


@router.get("/results/rows")
def rows(opened: Opened, params: Annotated[RowsParams, Query()]) -> answers.Rows:
    """Return some rows of the results."""
    found = require_results(opened)
    chosen = found.table[_chosen(found.table, params)]
    if params.sort:
        key = params.sort.lstrip("-")
        if key not in found.table:
            raise RequestError.impossible(f"no column is named {key!r}")
        chosen = chosen.sort_values(key, ascending=not params.sort.startswith("-"), kind="stable")
    columns = [name for name in params.columns.split(",") if name in found.table] or list(found.table)
    shown = chosen[params.offset : params.offset + params.limit]
    return answers.Rows.of(
        {
            "total": len(found.table),
            "matching": len(chosen),
            "columns": [_column(COLUMNS[name]) for name in columns],
            "rows": [
                {"item": item, **row}
                for item, row in zip(items(shown["observation"]), records(shown, *columns), strict=True)
            ],
        }
    )


def _chosen(table: pd.DataFrame, params: RowsParams) -> BoolArray:
    """Return which rows are asked for."""
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


def _column(column: Column) -> dict[str, Any]:
    stds = [f"{column.name}_total_std", f"{column.name}_std"]
    return {
        "key": column.name,
        "words": column.meaning,
        "unit": column.unit if column.unit not in {"", "1"} else None,
        "std": next((std for std in stds if std in COLUMNS), None),
    }


class PlotParams(Params):
    """A finger."""

    finger: str | None = None


@router.get("/results/plot")
def plot(opened: Opened, params: Annotated[PlotParams, Query()]) -> answers.Plot:
    """Return the data to plot for each finger and placement."""
    found = require_results(opened)
    active_corrections = opened.corrections.active_corrections()
    groups = [
        _group(one, found.table, active_corrections)
        for one in found.summary.summaries
        if params.finger in {None, one.finger}
    ]
    return answers.Plot.of({"groups": groups})


def _placed(of: PlacementRecord) -> dict[str, Any]:
    return {**dict(zip(PLACEMENT, of.key, strict=True)), "figure": group_name(of.key)}


def _group(
    of: PlacementRecord, table: pd.DataFrame, active_corrections: Mapping[str, ActiveCorrection]
) -> dict[str, Any]:
    placement = zip(PLACEMENT, of.key, strict=True)
    placed = np.logical_and.reduce([table[name].to_numpy() == value for name, value in placement])
    rows = table[placed & table["radius_from_indentation_mm"].notna()]
    rejected = placed & (table["status"].to_numpy() == "rejected") & table["frame"].isna()
    codes = Counter(code for notes in items(rows["range_notes"]) for code in (notes or "").split())
    return {
        **_placed(of),
        "radius_from_indentation_mm": of.radius_from_indentation_mm,
        "mean_curvature_radius_mm": of.mean_curvature_radius_mm,
        "mean_curvature_radius_mm_std": of.mean_curvature_radius_mm_std,
        "loading_radius_mm": of.loading_radius_mm,
        "loading_radius_mm_std": of.loading_radius_mm_std,
        "pooling": _pooling(rows, int(rejected.sum()), active_corrections),
        "rows": {
            name: items(rows["observation" if name == "item" else name])
            for name in answers.PlottedRows.model_fields
        },
        "range_notes": [
            {"code": code, "words": flag.words, "to_do": flag.to_do, "rows": codes[code]}
            for code, flag in FLAGS["row"].items()
            if code in codes
        ],
        "validity": of.validity.model_dump(),
    }


def _pooling(
    rows: pd.DataFrame, rejected: int, active_corrections: Mapping[str, ActiveCorrection]
) -> dict[str, Any]:
    """Return how many rows are pooled, and the contacts that are not or about which there is a say.

    Parameters
    ----------
    rows : DataFrame
        The measured rows of a group.
    rejected : int
        The number of its contacts that a person rejected.
    active_corrections : mapping
        What people corrected, by item.
    """
    corrected = {name for name, one in active_corrections.items() if pooling_correction(one)}
    framed = rows["frame"].notna()
    contacts, frames = rows[~framed], rows[framed]
    asked = contacts[
        np.array(
            [
                not row["pooled"] or bool(row["excluding_flags"]) or row["observation"] in corrected
                for row in records(contacts, "observation", "pooled", "excluding_flags")
            ],
            dtype=bool,
        )
    ]
    return {
        "contacts": len(contacts) + rejected,
        "contacts_pooled": int(contacts["pooled"].sum()),
        "contacts_rejected": rejected,
        "frames": len(frames),
        "frames_pooled": int(frames["pooled"].sum()),
        "in_question": [
            {
                "item": row["observation"],
                "load_N": row["load_N"],
                "pooled": row["pooled"],
                "why": pooling_words(row),
                "correction": pooling_correction(active_corrections.get(row["observation"])),
            }
            for row in records(asked[:_MOST_IN_QUESTION])
        ],
    }


@router.get("/results/budget")
def budget(opened: Opened) -> answers.Budget:
    """Return the uncertainty budgets of pooled radii and of the highest-load contacts."""
    return answers.Budget.of(
        {
            "groups": [
                {
                    **_placed(one),
                    "pooled": one.radius_from_indentation_variance_shares,
                    "check": one.uncertainty_check and one.uncertainty_check.model_dump(),
                }
                for one in require_results(opened).summary.summaries
            ]
        }
    )


@here.get("/published")
def published() -> answers.Audit:
    """Return the audit of the numbers that Dzidek et al. (2017) print."""
    return answers.Audit.of({"items": [asdict(item) for item in audit()]})
