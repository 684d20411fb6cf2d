"""Verdicts on the results of a finger at an angle, and what the model adds to their uncertainty."""

import math
from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType

import numpy as np
import pandas as pd

from fingerpad._words import counted
from fingerpad.study.manifest.models import Study
from fingerpad.study.measuring.curves import CurveResult
from fingerpad.study.measuring.fingers import FingerResult
from fingerpad.study.results.pooling import Summary
from fingerpad.study.results.repeats import ContactRepeatability
from fingerpad.study.results.rows import Rows
from fingerpad.study.results.summary_file import HeadlineRecord, LayerValidityRecord, ValidityRecord
from fingerpad.study.results.table import COLUMNS
from fingerpad.study.results.validity.checks import (
    GROWTH,
    area_checks,
    contact_shape_check,
    layer_checks,
    loading_checks,
    size_checks,
)
from fingerpad.study.results.validity.model_checks import (
    HEADLINES,
    HOLDS,
    MODULUS,
    NOT_TESTED,
    RADIUS,
    ROUTES,
    FingerAtAngle,
    ModelDiscrepancy,
    ValidityCheck,
    judge_together,
    model_discrepancy,
    overall_verdict,
)

_NOT_ESTIMATED = "not estimated: there are no loading data"
Discrepancies = Mapping[str, ModelDiscrepancy | None]


def validity_of(
    study: Study,
    fingers: Mapping[str, FingerResult],
    rows: Rows,
    summaries: Sequence[Summary],
    curves: Sequence[CurveResult],
    *,
    repeatability: Mapping[bool, ContactRepeatability] = MappingProxyType({}),
) -> list[ValidityRecord]:
    """Check Hertz theory at each finger and angle; its discrepancy is that of all real or synthetic."""
    cases = [
        FingerAtAngle.of(study, fingers, rows, one, curves, repeatability=repeatability) for one in summaries
    ]
    checks = [_checks(case) for case in cases]
    routes = {
        synthetic: {
            name: _discrepancy(
                found
                for one, all_of_one in zip(summaries, checks, strict=True)
                for found in all_of_one
                if one.synthetic == synthetic and found.check == route
            )
            for name, route in ROUTES.items()
        }
        for synthetic in (False, True)
    }
    of_layers = [judge_together(tuple(layer_checks(case, curves))) for case in cases]
    return [
        _validity(case, found, routes[case.summary.synthetic], of_layer)
        for case, found, of_layer in zip(cases, checks, of_layers, strict=True)
    ]


def _checks(case: FingerAtAngle) -> tuple[ValidityCheck, ...]:
    """Return all checks of Hertz theory at a place."""
    found = (*loading_checks(case), contact_shape_check(case), *area_checks(case), *size_checks(case))
    # R_g alone makes one comparison of three.
    return judge_together(found, same=() if case.fits else tuple(ROUTES.values()))


def _discrepancy(checks: Iterable[ValidityCheck]) -> ModelDiscrepancy | None:
    """Return the discrepancy that comparisons of two ways to a result show; None without any."""
    pairs = [
        (ratio := math.log1p(one.relative_difference), ratio / one.deviations)
        for one in checks
        if one.deviations and math.isfinite(one.relative_difference)
    ]
    return model_discrepancy(*np.transpose(pairs)) if pairs else None


def _validity(
    case: FingerAtAngle,
    checks: Sequence[ValidityCheck],
    routes: Discrepancies,
    of_layer: Sequence[ValidityCheck],
) -> ValidityRecord:
    """Return the checks of a place with the headlines that they concern."""
    over_loads = _change_over_loads(case, checks)
    headlines = {}
    for name in HEADLINES:
        parts, words = [], []
        if (route := routes[name]) is not None:
            parts.append(route.relative_std)
            words.append(f"{counted(route.count, 'comparison')} of images with loading data")
        if name == MODULUS and not math.isnan(over_loads):
            parts.append(over_loads)
            words.append("its change over loads")
        relative = math.hypot(*parts) if parts else math.nan
        value, std = _result(case, name)
        headlines[name] = HeadlineRecord(
            value=value,
            value_std=std,
            model_std=value * relative,
            total_std=math.hypot(std, value * relative) if parts else std,
            model_relative_std=relative,
            model_from=" and ".join(words) or _NOT_ESTIMATED,
            verdict=overall_verdict(one.verdict for one in checks if name in one.headlines),
        )
    worst = overall_verdict(one.verdict for one in checks)
    on_layer = LayerValidityRecord(
        verdict=overall_verdict(one.verdict for one in of_layer), checks=list(of_layer)
    )
    return ValidityRecord(
        model="Hertz theory",
        # An exponent alone, of a finger without semi-axes, tests no theory.
        verdict=NOT_TESTED if worst == HOLDS and not case.highest else worst,
        observation=case.highest.observation if case.highest else "",
        load_N=case.highest.load if case.highest else math.nan,
        headlines=headlines,
        checks=list(checks),
        on_layer=on_layer if of_layer else None,
    )


def _result(case: FingerAtAngle, name: str) -> tuple[float, float]:
    """Return a headline and its standard uncertainty from what was measured, NaN without one."""
    row, pooled = case.highest_row, case.summary.corrected_radius
    if name == RADIUS:
        return (pooled.value, pooled.std) if pooled else (math.nan, math.nan)
    return (row[name], row[f"{name}_std"]) if row else (math.nan, math.nan)


def _change_over_loads(case: FingerAtAngle, checks: Iterable[ValidityCheck]) -> float:
    """Return the standard deviation of ln E that its trend over loads makes; NaN at one load."""
    (growth,) = (one for one in checks if one.check == GROWTH)
    if math.isnan(growth.value):
        return math.nan
    excess = growth.difference**2 - growth.value_std**2
    return 1.5 * math.sqrt(max(excess, 0.0)) * float(np.log(case.loaded["load_N"].to_numpy()).std())


def with_verdicts(
    table: pd.DataFrame, summaries: Iterable[Summary], validities: Iterable[ValidityRecord]
) -> pd.DataFrame:
    """Return the table with the columns of the verdict, of what the model adds, and of the total."""
    stds = [f"{name}_{part}_std" for name in HEADLINES for part in ("model", "total")]
    columns = {name: table[name].to_numpy(copy=True) for name in ("model_verdict", *stds)}
    for summary, validity in zip(summaries, validities, strict=True):
        places = summary.places
        columns["model_verdict"][places] = validity.verdict
        for name in HEADLINES:
            model_std = validity.headlines[name].model_relative_std * summary.column(name).to_numpy()
            columns[f"{name}_model_std"][places] = model_std
            std = summary.column(f"{name}_std")
            columns[f"{name}_total_std"][places] = np.hypot(std, np.nan_to_num(model_std))
    return table.assign(**{name: COLUMNS[name].series(array) for name, array in columns.items()})
