"""Tables in Markdown, and what they say of errors."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import chain
from typing import ParamSpec, TypeAlias, TypeVar

import numpy as np
import numpy.typing as npt
import pandas as pd

from fingerpad.exceptions import FingerpadError

P = ParamSpec("P")
T = TypeVar("T")
# Relative error, relative standard uncertainty, and whether a flag says that the value is in doubt.
Row: TypeAlias = tuple[float, float, bool]


def rows_of(
    values: npt.ArrayLike, truth: npt.ArrayLike, covariance: npt.ArrayLike, flagged: object
) -> list[Row]:
    """Return relative errors of values with their relative standard uncertainties."""
    errors, stds = values / np.asarray(truth) - 1, np.sqrt(np.diagonal(covariance)) / values
    return [(error, std, bool(flagged)) for error, std in zip(errors, stds, strict=True)]


def or_none(measure: Callable[P, T], *args: P.args, **known: P.kwargs) -> T | None:
    """Return what is measured, None where that is refused."""
    try:
        return measure(*args, **known)
    except FingerpadError:
        return None


def not_refused(
    measure: Callable[[int], Mapping[str, object]], seeds: Iterable[int]
) -> tuple[pd.DataFrame, int]:
    """Return what is measured with each seed, and how many are refused."""
    found = [or_none(measure, seed) for seed in seeds]
    return pd.DataFrame([one for one in found if one is not None]), found.count(None)


def table(columns: Sequence[str], rows: Iterable[Sequence[object]], title: str = "") -> None:
    """Print a table, row by row as they come."""
    if title:
        print(f"\n**{title}**\n")
    print(f"| {' | '.join(columns)} |\n|{'---|' * len(columns)}")
    for row in rows:
        print(f"| {' | '.join(map(str, row))} |", flush=True)


def percent(value: float, sign: str = "") -> str:
    """Return a share as per cent with two significant digits."""
    if not math.isfinite(value):
        return "–"
    size = abs(100 * value)
    digits = 2 if not size > 0.01 else max(0, min(3, 1 - math.floor(math.log10(size))))
    return f"{100 * value:{sign}.{digits}f} %"


def share(held: npt.ArrayLike, digits: int = 0) -> str:
    """Return how many of all are true, in per cent."""
    held = np.asarray(held, dtype=float)
    return f"{100 * held.mean():.{digits}f} %" if held.size else "–"


def off(errors: npt.ArrayLike) -> str:
    """Return bias and root mean square of relative errors."""
    errors = np.asarray(errors)
    return f"{percent(float(np.nanmean(errors)), '+')}, {percent(math.sqrt(np.nanmean(errors**2)))}"


def stated(errors: npt.ArrayLike, stds: npt.ArrayLike) -> str:
    """Return the median stated uncertainty, and the share of 95 % intervals that hold the truth."""
    errors, stds = np.asarray(errors), np.asarray(stds)
    return f"{percent(float(np.nanmedian(stds)))}, {share(np.abs(errors) < 1.96 * stds)}"


def errors_table(title: str, rows: Mapping[str, Sequence[Row]], what: str = "shape") -> None:
    """Print relative errors with what was stated of them, for each name and all together."""

    def cells() -> Iterable[tuple[object, ...]]:
        for name, some in [*rows.items(), ("all", list(chain(*rows.values())))]:
            errors, stds, flagged = np.array(some, dtype=float).T
            silent = (np.abs(errors) > 1.96 * stds) & (flagged == 0)
            yield name, len(some), off(errors), stated(errors, stds), share(flagged), share(silent)

    columns = (what, "n", "bias, rms error", "stated, held", "flagged", "missed without a flag")
    table(columns, cells(), title)
