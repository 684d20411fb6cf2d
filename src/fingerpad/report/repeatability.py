"""What the report says of repeats: how quantities scatter, and what each load's mean is uncertain by."""

import math
from collections.abc import Mapping
from typing import Any, Final

from fingerpad._rounding import two_digits
from fingerpad._words import counted
from fingerpad.study.results.study_result import StudyResult
from fingerpad.study.results.summary_file import ScatterLevelRecord, ScatterRecord
from fingerpad.uncertainty.repeats import SAME_LOAD, ContactRepeatability
from fingerpad.uncertainty.scatter import LIMIT_FACTOR, REPEAT

_SCATTER_OF: Final[Mapping[str, str]] = {
    "contact_area": "contact area A",
    "ridge_area": "ridge area",
    "youngs_modulus": "Young's modulus E from load and area",
    "aspect_ratio": "aspect ratio ℓd/ℓe",
    "radius_from_indentation": "corrected radius",
}
_LEVELS: Final[Mapping[str, str]] = {
    "person": "between persons",
    "finger": "between fingers",
    "session": "between sessions",
    REPEAT: "repeats",
}
_MOST_LOADS: Final = 120
_OUTWARDS: Final = tuple(_LEVELS)[::-1]


def repeatability_section(result: StudyResult, *, with_loads: bool = True) -> dict[str, Any]:
    """Return what the template shows of repeats, with a line for each load of each finger or without."""
    kinds = sorted({one.synthetic for one in result.scatter} | {one.synthetic for one in result.by_load})
    loads = result.by_load if with_loads else []
    return {
        "tolerance": f"{100 * SAME_LOAD:g}",
        "kinds": [_kind(result, synthetic) for synthetic in kinds],
        "loads": loads[:_MOST_LOADS],
        "more_loads": max(0, len(loads) - _MOST_LOADS),
        "by_session": any(math.isfinite(one.contact_area_mm2_session_std) for one in result.by_load),
        "sessions": any(one.sessions > 1 for one in result.by_load),
        "on_layer": any(not math.isnan(one.youngs_modulus_on_layer_kpa) for one in result.by_load),
    }


def borrowed(found: ContactRepeatability) -> str:
    """Return what a study's repeats tell of one impression, in words."""
    return (
        f"{percent(found.area_std)} in area and {percent(found.aspect_ratio_std)} in aspect ratio, "
        f"from {found.count} repeats of {found.groups} contact{'s' if found.groups > 1 else ''} "
        f"({counted(found.freedom, 'degree')} of freedom)"
    )


def percent(share: float) -> str:
    """Return a share in percent, with two digits."""
    return f"{two_digits(100 * share)} %" if share > 0 else "0 %"


def _kind(result: StudyResult, synthetic: bool) -> dict[str, Any]:
    found = result.repeatability[synthetic]
    every = [
        (one, {of.level: of for of in one.levels}) for one in result.scatter if one.synthetic == synthetic
    ]
    known = [(one, levels) for one, levels in every if not math.isnan(levels[REPEAT].log_std)]
    unknown = (level for level in _OUTWARDS if all(math.isnan(of[level].log_std) for _, of in known))
    return {
        "synthetic": synthetic,
        "missing": found.missing,
        "borrowed": borrowed(found) if found.known else "",
        "levels": [_LEVELS[level] for level in _OUTWARDS],
        "lines": [_line(one, levels) for one, levels in known],
        "left_out": [_LEVELS[level] for level in unknown if level != REPEAT],
    }


def _line(one: ScatterRecord, levels: Mapping[str, ScatterLevelRecord]) -> dict[str, Any]:
    repeat, (low, high) = levels[REPEAT], one.icc_ci95
    ends = repeat.log_std_ci95_low, repeat.log_std_ci95_high
    return {
        "quantity": _SCATTER_OF[one.quantity],
        "cells": [_cell(levels[level]) for level in _OUTWARDS],
        "limit": percent(math.expm1(LIMIT_FACTOR * repeat.log_std)),
        "limit_range": _range(*(math.expm1(LIMIT_FACTOR * end) for end in ends)),
        "icc": f"{one.icc:.2f} ({low:.2f} to {high:.2f})" if math.isfinite(one.icc) else "missing",
    }


def _cell(one: ScatterLevelRecord) -> dict[str, str]:
    if math.isnan(one.log_std):
        return {"text": "missing", "small": one.missing}
    groups = f"{one.groups} group{'s' if one.groups > 1 else ''}"
    those = " and ".join(_LEVELS[each] for each in one.includes.split())
    interval = _range(one.log_std_ci95_low, one.log_std_ci95_high)
    return {
        "text": percent(one.log_std),
        "small": f"95 %: {interval}; {one.count} in {groups}{those and f', with those {those}'}",
    }


def _range(low: float, high: float) -> str:
    return f"{percent(low).removesuffix(' %')} to {percent(high)}"
