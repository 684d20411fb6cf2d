"""Areas of contacts without ridges against their truth, by optics.

The pictures (benchmarks/truth/smooth_contacts.py) come from the gap between an elastic body and the glass,
and from the optics of each device: none of it is shared with the measurement.
"""

import math
from typing import Any

import numpy as np

from benchmarks.truth.smooth_contacts import KINDS, loading, pictures
from fingerpad.exceptions import ImageError
from fingerpad.image import Frame, measure_contact_image, measure_sequence
from fingerpad.image.levels import luma


def accuracy(kind: str, seeds: range, count: int) -> dict[str, Any]:
    """Return bias, rms error and stated uncertainty of areas in %, coverage, refusals and flags."""
    rows, flags, refused, silent = [], dict[str, int](), 0, 0
    for seed in seeds:
        for picture in pictures(seed, count, kind):  # type: ignore[no-untyped-call]
            truth = picture["truth"]
            try:
                found = measure_contact_image(
                    picture["image"], picture["mm_per_px"], surface="smooth", background=picture["background"]
                )
            except ImageError:
                refused += 1
                continue
            for flag in found.flags:
                flags[flag] = flags.get(flag, 0) + 1
            off, std = found.gross_area - truth["area_mm2"], found.gross_area_std
            silent += not found.flags and abs(off) > max(1.96 * std, 0.05 * found.gross_area)
            if truth["contact"]:
                percent = 100 / truth["area_mm2"]
                rows.append((off * percent, std * percent, abs(off) < 1.96 * std))
    table = np.array(rows, dtype=float).reshape(-1, 3)
    if not len(table):
        return {"measured": 0, "refused": refused, "flags": flags, "silent": silent}
    return {
        "measured": len(table),
        "refused": refused,
        "bias": float(table[:, 0].mean()),
        "rms": math.sqrt(float((table[:, 0] ** 2).mean())),
        "stated": float(np.median(table[:, 1])),
        "covered": float(table[:, 2].mean()),
        "silent": silent,
        "flags": flags,
    }


def sequence_accuracy(kind: str, seeds: range, count: int) -> dict[str, Any]:
    """Return the same of the frames of presses, whose first frame, before touch, is the background."""
    rows, flags, missed, false, refused = [], dict[str, int](), 0, 0, 0
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
            for flag in found.flags:
                flags[flag] = flags.get(flag, 0) + 1
            off, std = found.measures["gross_area_mm2"] - area, found.measures["gross_area_mm2_std"]
            rows.append((100 * off / area, 100 * std / area, abs(off) < 1.96 * std))
    table = np.array(rows, dtype=float).reshape(-1, 3)
    return {
        "frames": len(table),
        "missed": missed,
        "before touch": false,
        "refused": refused,
        **(
            {
                "bias": float(table[:, 0].mean()),
                "rms": math.sqrt(float((table[:, 0] ** 2).mean())),
                "stated": float(np.median(table[:, 1])),
                "covered": float(table[:, 2].mean()),
            }
            if len(table)
            else {}
        ),
        "flags": flags,
    }


def report(first_seed: int = 200, seeds: int = 4) -> None:
    """Print errors of single contacts by optics, and of presses."""
    for each in KINDS:
        print(each, accuracy(each, range(first_seed, first_seed + seeds), 2), flush=True)
    for each in KINDS[:5]:
        print("press,", each, sequence_accuracy(each, range(first_seed, first_seed + seeds), 6), flush=True)
