"""Areas of contacts without ridges against their truth, by optics.

The pictures (benchmarks/truth/smooth_contacts.py) come from the gap between an elastic body and the glass,
and from the optics of each device: none of it is shared with the measurement.
"""

import math
from collections import Counter
from functools import partial
from itertools import chain
from typing import Any, Final

import pandas as pd

from benchmarks.tables import off, or_none, stated, table
from benchmarks.truth.smooth_contacts import DEVICES, KINDS, loading, pictures
from fingerpad.exceptions import ImageError
from fingerpad.image import Frame, measure_contact_image, measure_sequence

# True area, area found and its uncertainty, mm², and flags; of a picture that is refused none.
COLUMNS: Final = "area", "found", "std", "flags"
_REFUSED: Final = math.nan, math.nan, math.nan, None


def accuracy(kind: str, seeds: range, count: int, *, with_background: bool = True) -> pd.DataFrame:
    """Measure single pictures."""
    rows: list[tuple[object, ...]] = []
    for picture in (one for seed in seeds for one in pictures(seed, count, kind)):
        known: dict[str, Any] = {"background": picture.background} if with_background else {}
        found = or_none(measure_contact_image, picture.image, picture.mm_per_px, surface="smooth", **known)
        seen = (picture.area, found.gross_area, found.gross_area_std, found.flags) if found else _REFUSED
        rows.append(seen)
    return pd.DataFrame(rows, columns=COLUMNS)


def sequence_accuracy(kind: str, seeds: range, count: int) -> pd.DataFrame:
    """Measure the frames of presses, whose first frame, before touch, is the background."""
    rows: list[tuple[object, ...]] = []
    for seed in seeds:
        press = list(loading(seed, count, kind))
        frames = [Frame(index=k, pixels=one.image) for k, one in enumerate(press)]
        try:
            results = list(measure_sequence(frames, press[0].mm_per_px, surface="smooth"))
        except ImageError:
            rows.append(_REFUSED)
            continue
        for one, found in zip(press, results, strict=True):
            measured = found.measures or {"gross_area_mm2": math.nan, "gross_area_mm2_std": math.nan}
            rows.append((one.area, measured["gross_area_mm2"], measured["gross_area_mm2_std"], found.flags))
    return pd.DataFrame(rows, columns=COLUMNS)


def _cells(kind: str, seen: pd.DataFrame) -> tuple[object, ...]:
    measured = seen[seen["found"].notna()]
    true = measured[measured["area"] > 0]
    errors, stds = true["found"] / true["area"] - 1, true["std"] / true["area"]
    numbers = (off(errors), stated(errors, stds)) if len(true) else ("–", "–")
    missed = (seen["found"].isna() & (seen["area"] > 0)).sum()
    counts = seen["flags"].isna().sum(), missed, len(measured) - len(true)
    flags = Counter(chain.from_iterable(measured["flags"])).items()
    return KINDS[kind], len(true), *numbers, *counts, ", ".join(f"`{flag}` {count}" for flag, count in flags)


def report(first_seed: int = 300, seeds: int = 4) -> None:
    """Print errors of single contacts by optics, with and without a first picture, and of presses."""
    numbers = range(first_seed, first_seed + seeds)
    head = ("device", "n", "bias, rms error", "stated, held", "refused", "missed", "without contact", "flags")
    for title, with_background in (("With a picture of the empty view", True), ("Without", False)):
        singly = partial(accuracy, seeds=numbers, count=2, with_background=with_background)
        table(head, (_cells(kind, singly(kind)) for kind in KINDS), title)
    presses = (_cells(kind, sequence_accuracy(kind, numbers, 6)) for kind in DEVICES)
    table(head, presses, "Frames of presses")
