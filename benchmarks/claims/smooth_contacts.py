"""Areas of contacts without ridges against their truth, by optics.

The pictures (benchmarks/truth/smooth_contacts.py) come from the gap between an elastic body and the glass,
and from the optics of each device: none of it is shared with the measurement.
"""

import math
from collections import Counter
from typing import Any

import numpy as np

from benchmarks.tables import off, stated, table
from benchmarks.truth.smooth_contacts import KINDS, loading, pictures
from fingerpad.exceptions import ImageError
from fingerpad.image import Frame, measure_contact_image, measure_sequence
from fingerpad.image.levels import luma


def accuracy(kind: str, seeds: range, count: int, *, with_background: bool = True) -> dict[str, Any]:
    """Return errors and stated uncertainties of areas, refusals, flags, and what no contact shows."""
    rows: list[tuple[float, float]] = []
    flags, refused, false = Counter[str](), 0, 0
    for seed in seeds:
        for picture in pictures(seed, count, kind):  # type: ignore[no-untyped-call]
            truth, background = picture["truth"], picture["background"] if with_background else None
            try:
                found = measure_contact_image(
                    picture["image"], picture["mm_per_px"], surface="smooth", background=background
                )
            except ImageError:
                refused += 1
                continue
            flags.update(found.flags)
            false += not truth["contact"]
            if truth["contact"]:
                area = truth["area_mm2"]
                rows.append((found.gross_area / area - 1, found.gross_area_std / area))
    return {"refused": refused, "before touch": false, "missed": 0, "flags": flags, **_errors(rows)}


def sequence_accuracy(kind: str, seeds: range, count: int) -> dict[str, Any]:
    """Return the same of the frames of presses, whose first frame, before touch, is the background."""
    rows: list[tuple[float, float]] = []
    flags, missed, false, refused = Counter[str](), 0, 0, 0
    for seed in seeds:
        press = list(loading(seed, count, kind))  # type: ignore[no-untyped-call]
        frames = [Frame(index=k, pixels=luma(one["image"])) for k, one in enumerate(press)]
        try:
            results = list(measure_sequence(frames, press[0]["mm_per_px"], surface="smooth"))
        except ImageError:
            refused += 1
            continue
        for one, found in zip(press, results, strict=True):
            area = one["truth"]["area_mm2"]
            if found.measures is None or not area:
                missed += bool(area)
                false += found.measures is not None
                continue
            flags.update(found.flags)
            value, std = found.measures["gross_area_mm2"], found.measures["gross_area_mm2_std"]
            rows.append((value / area - 1, std / area))
    return {"refused": refused, "before touch": false, "missed": missed, "flags": flags, **_errors(rows)}


def _errors(rows: list[tuple[float, float]]) -> dict[str, Any]:
    errors, stds = np.array(rows).reshape(-1, 2).T
    rms = 100 * math.sqrt(np.mean(errors**2)) if rows else math.nan
    held = float(np.mean(np.abs(errors) < 1.96 * stds)) if rows else math.nan
    return {"rms": rms, "covered": held, "errors": errors, "stds": stds}


def _cells(name: str, found: dict[str, Any]) -> tuple[object, ...]:
    n, flags = len(found["errors"]), ", ".join(f"`{flag}` {count}" for flag, count in found["flags"].items())
    numbers = (off(found["errors"]), stated(found["errors"], found["stds"])) if n else ("–", "–")
    return name, n, *numbers, found["refused"], found["missed"], found["before touch"], flags


def report(first_seed: int = 200, seeds: int = 4) -> None:
    """Print errors of single contacts by optics, with and without a first picture, and of presses."""
    numbers = range(first_seed, first_seed + seeds)
    head = ("device", "n", "bias, rms error", "stated, held", "refused", "missed", "without contact", "flags")
    for title, with_background in (("With a picture of the empty view", True), ("Without", False)):
        rows = (_cells(k, accuracy(k, numbers, 2, with_background=with_background)) for k in KINDS)
        table(head, rows, title)
    presses = (_cells(k, sequence_accuracy(k, numbers, 6)) for k in KINDS[:5])
    table(head, presses, "Frames of presses")
