"""Areas of contacts without ridges against their truth, by optics: python -m benchmarks.smooth_accuracy.

The pictures (benchmarks/smooth_contacts.py) come from the gap between an elastic body and the glass, and from
the optics of each device: none of it is shared with the measurement.
"""

import math
import sys
from typing import Any

import numpy as np

from benchmarks.smooth_contacts import KINDS, pictures
from fingerpad.exceptions import ImageError
from fingerpad.image import measure_contact_image


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


if __name__ == "__main__":
    first = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    for each in KINDS:
        print(each, accuracy(each, range(first, first + 4), 2))
