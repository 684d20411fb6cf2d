"""What the report says of repeats: how quantities scatter, and what each load's mean is uncertain by."""

import math
from typing import Any, Final

from fingerpad._rounding import two_digits
from fingerpad.study.results.repeats import LEVELS, SCATTER_OF, StudyScatter
from fingerpad.study.results.study_result import StudyResult
from fingerpad.uncertainty import ScatterComponent
from fingerpad.uncertainty.repeats import SAME_LOAD, ContactRepeatability
from fingerpad.uncertainty.scatter import LIMIT_FACTOR, REPEAT

_MOST_LOADS: Final = 120
_OUTWARDS: Final = tuple(LEVELS)[::-1]


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
        f"({found.freedom} degrees of freedom)"
    )


def percent(share: float) -> str:
    """Return a share in percent, with two digits."""
    return f"{two_digits(100 * share)} %" if share > 0 else "0 %"


def _kind(result: StudyResult, synthetic: bool) -> dict[str, Any]:
    found = result.repeatability[synthetic]
    known = [
        one for one in result.scatter if one.synthetic == synthetic and one.scatter.components[REPEAT].known
    ]
    unknown = (
        level
        for level in _OUTWARDS
        if level != REPEAT and not any(one.scatter.components[level].known for one in known)
    )
    return {
        "synthetic": synthetic,
        "missing": found.missing,
        "borrowed": borrowed(found) if found.known else "",
        "levels": [LEVELS[level] for level in _OUTWARDS],
        "lines": [_line(one) for one in known],
        "left_out": [LEVELS[level] for level in unknown],
    }


def _line(one: StudyScatter) -> dict[str, Any]:
    scatter, repeat = one.scatter, one.scatter.components[REPEAT]
    low, high = scatter.icc_interval
    return {
        "quantity": SCATTER_OF[one.quantity],
        "cells": [_cell(scatter.components[level], one.missing.get(level, "")) for level in _OUTWARDS],
        "limit": percent(math.expm1(repeat.limit_of_agreement)),
        "limit_range": _range(*(math.expm1(LIMIT_FACTOR * end) for end in repeat.interval)),
        "icc": f"{scatter.icc:.2f} ({low:.2f} to {high:.2f})" if math.isfinite(scatter.icc) else "missing",
    }


def _cell(one: ScatterComponent, missing: str) -> dict[str, str]:
    if not one.known:
        return {"text": "missing", "small": missing}
    groups = f"{one.groups} group{'s' if one.groups > 1 else ''}"
    with_those = f", with those {' and '.join(LEVELS[each] for each in one.includes)}" if one.includes else ""
    return {
        "text": percent(one.std),
        "small": f"95 %: {_range(*one.interval)}; {one.count} in {groups}{with_those}",
    }


def _range(low: float, high: float) -> str:
    return f"{percent(low).removesuffix(' %')} to {percent(high)}"
