"""Results of the last run: rows, plots, uncertainty budgets, figures, and the audit of published numbers."""

import re
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, Final

from pydantic import Field

from fingerpad.published import audit
from fingerpad.study.results.columns import COLUMNS
from fingerpad.study.results.result_set import result_files
from fingerpad.study.results.rows import RANGE_NOTES
from fingerpad.web import answers
from fingerpad.web.endpoints import Endpoint, Params
from fingerpad.web.errors import RequestError
from fingerpad.web.last_results import Results, last_results, results_faults
from fingerpad.web.workspace import Workspace

_UNITS: Final = ("mm2", "mm", "N", "kpa", "deg", "px", "s")
_CAPTION: Final = re.compile(r'aria-label="([^"]*)"')


def _results(workspace: Workspace) -> Results:
    found = last_results(workspace.study)
    if found is None:
        faults = results_faults(workspace.study)
        if faults:
            raise RequestError.conflict(f"{'; '.join(faults[:3])}: run the study again")
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


def rows(workspace: Workspace, params: RowsParams, _: Any) -> dict[str, Any]:
    """Return some rows of the results."""
    found = _results(workspace)
    chosen = [row for row in found.rows if _matches(row, params)]
    if params.sort:
        key, descending = params.sort.lstrip("-"), params.sort.startswith("-")
        if key not in COLUMNS:
            raise RequestError.impossible(f"no column is named {key!r}")
        known = [row for row in chosen if row[key] is not None]
        unknown = [row for row in chosen if row[key] is None]  # last, whichever way
        chosen = sorted(known, key=lambda row: row[key], reverse=descending) + unknown
    columns = [name for name in params.columns.split(",") if name in COLUMNS] or list(COLUMNS)
    return {
        "total": len(found.rows),
        "matching": len(chosen),
        "columns": [_column(name) for name in columns],
        "rows": [
            {name: row[name] for name in ("item", *columns)}
            for row in chosen[params.offset : params.offset + params.limit]
        ],
    }


def _matches(row: Mapping[str, Any], params: RowsParams) -> bool:
    same = (
        ("finger", params.finger),
        ("status", params.status),
        ("sequence", params.sequence),
        ("wedge_angle_deg", params.wedge_angle_deg),
    )
    if any(wanted is not None and row[key] != wanted for key, wanted in same):
        return False
    if params.flag is not None and params.flag not in row["flags"].split():
        return False
    return params.text.casefold() in f"{row['observation']} {row['finger']} {row['reason'] or ''}".casefold()


def _column(name: str) -> dict[str, Any]:
    bare = name.removesuffix("_fixed_geometry_std").removesuffix("_std")
    unit = next((unit for unit in _UNITS if bare.endswith(f"_{unit}")), None)
    std = f"{name}_std" if f"{name}_std" in COLUMNS else None
    return {"key": name, "words": COLUMNS[name], "unit": "kPa" if unit == "kpa" else unit, "std": std}


class PlotParams(Params):
    """A finger."""

    finger: str | None = None


def plot(workspace: Workspace, params: PlotParams, _: Any) -> dict[str, Any]:
    """Return the data to plot for each finger and placement."""
    found = _results(workspace)
    groups = [
        _group(one, found.rows)
        for one in found.summary["summaries"]
        if params.finger in {None, one["finger"]}
    ]
    return {"groups": groups}


def _group(of: Mapping[str, Any], every: list[dict[str, Any]]) -> dict[str, Any]:
    keys = ("finger", "wedge_angle_deg", "roll_angle_deg", "synthetic")
    members = [row for row in every if row["radius_from_indentation_mm"] is not None]
    members = [row for row in members if all(row[key] == of[key] for key in keys)]
    codes = [code for row in members for code in (row["range_notes"] or "").split()]
    return {
        **{name: of.get(name) for name in answers.PlottedGroup.model_fields},
        "rows": {name: [row[name] for row in members] for name in answers.PlottedRows.model_fields},
        "range_notes": [
            {"code": code, "words": RANGE_NOTES[code], "rows": codes.count(code)}
            for code in RANGE_NOTES
            if code in codes
        ],
    }


def budget(workspace: Workspace, _: Any, __: Any) -> dict[str, Any]:
    """Return the uncertainty budgets of pooled radii and of the highest-load contacts."""
    return {
        "groups": [
            {
                **{key: one[key] for key in ("finger", "wedge_angle_deg", "roll_angle_deg", "synthetic")},
                "pooled": one.get("radius_from_indentation_variance_shares"),
                "check": (check := one["uncertainty_check"])
                and {name: check[name] for name in answers.BudgetCheck.model_fields},
            }
            for one in _results(workspace).summary["summaries"]
        ]
    }


def figures(workspace: Workspace, _: Any, __: Any) -> dict[str, Any]:
    """Return the report's figures with their captions."""
    _results(workspace)
    out = workspace.study.out
    names = [name for name in result_files(out) if name.startswith("figures/") and name.endswith(".svg")]
    return {"figures": list(_figures([out / name for name in names]))}


def _figures(drawings: Iterable[Path]) -> Iterator[dict[str, str]]:
    for path in drawings:
        with path.open(encoding="utf-8") as file:
            start = file.read(4000)
        caption = _CAPTION.search(start)
        words = caption[1] if caption else path.stem
        yield {
            "name": path.stem,
            "caption": words.replace("&quot;", '"').replace("&lt;", "<").replace("&amp;", "&"),
            "svg": f"/api/download/figures/{path.name}",
            "png": f"/api/download/figures/{path.stem}.png",
        }


def published(_: Workspace, __: Any, ___: Any) -> dict[str, Any]:
    """Return the audit of the numbers that Dzidek et al. (2017) print."""
    return {"items": [item.as_record() for item in audit()]}


ENDPOINTS: Final = (
    Endpoint(
        method="GET",
        path="/api/results/rows",
        answer=rows,
        model=answers.Rows,
        query=RowsParams,
        summary="Rows of the results",
    ),
    Endpoint(
        method="GET",
        path="/api/results/plot",
        answer=plot,
        model=answers.Plot,
        query=PlotParams,
        summary="Data to plot",
    ),
    Endpoint(
        method="GET",
        path="/api/results/budget",
        answer=budget,
        model=answers.Budget,
        summary="Uncertainty budgets",
    ),
    Endpoint(
        method="GET",
        path="/api/results/figures",
        answer=figures,
        model=answers.Figures,
        summary="The report's figures",
    ),
    Endpoint(
        method="GET",
        path="/api/published",
        answer=published,
        model=answers.Audit,
        summary="Audit of the published tables",
    ),
)
