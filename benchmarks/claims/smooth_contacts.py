"""Areas of contacts without ridges against their truth, by optics.

The pictures (benchmarks/truth/smooth_contacts.py) come from the gap between an elastic body and the glass,
and from the optics of each device: none of it is shared with the measurement.
"""

import math
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from benchmarks.tables import off, stated, table
from benchmarks.truth.smooth_contacts import DEVICES, KINDS, loading, pictures
from fingerpad.exceptions import ImageError
from fingerpad.image import Frame, measure_contact_image, measure_sequence
from fingerpad.image.levels import luma


@dataclass(slots=True)
class Score:
    """Relative errors and uncertainties of areas, and what else became of pictures."""

    errors: list[float] = field(default_factory=list)
    stds: list[float] = field(default_factory=list)
    flags: Counter[str] = field(default_factory=Counter)
    refused: int = 0
    missed: int = 0
    without_contact: int = 0  # measured where there is none

    def add(self, area: float, found: tuple[float, float] | None, flags: Iterable[str] = ()) -> None:
        """Add a picture with its true area and what was measured."""
        if found is None:
            self.missed += area > 0
            return
        self.flags.update(flags)
        if not area:
            self.without_contact += 1
            return
        self.errors.append(found[0] / area - 1)
        self.stds.append(found[1] / area)

    @property
    def rms(self) -> float:
        """Root mean square error, per cent."""
        return 100 * math.sqrt(np.mean(np.square(self.errors)))

    @property
    def held(self) -> float:
        """Share of the 95 % intervals that hold the truth."""
        return float(np.mean(np.abs(self.errors) < 1.96 * np.array(self.stds)))

    def cells(self) -> tuple[object, ...]:
        """Return the cells of a row."""
        numbers = (off(self.errors), stated(self.errors, self.stds)) if self.errors else ("–", "–")
        flags = ", ".join(f"`{flag}` {count}" for flag, count in self.flags.items())
        return len(self.errors), *numbers, self.refused, self.missed, self.without_contact, flags


def accuracy(kind: str, seeds: range, count: int, *, with_background: bool = True) -> Score:
    """Measure single pictures."""
    score = Score()
    for picture in (one for seed in seeds for one in pictures(seed, count, kind)):
        known: dict[str, Any] = {"background": picture.background} if with_background else {}
        try:
            found = measure_contact_image(picture.image, picture.mm_per_px, surface="smooth", **known)
        except ImageError:
            score.refused += 1
            continue
        score.add(picture.area, (found.gross_area, found.gross_area_std), found.flags)
    return score


def sequence_accuracy(kind: str, seeds: range, count: int) -> Score:
    """Measure the frames of presses, whose first frame, before touch, is the background."""
    score = Score()
    for seed in seeds:
        press = list(loading(seed, count, kind))
        frames = [Frame(index=k, pixels=luma(one.image)) for k, one in enumerate(press)]
        try:
            results = list(measure_sequence(frames, press[0].mm_per_px, surface="smooth"))
        except ImageError:
            score.refused += 1
            continue
        for one, found in zip(press, results, strict=True):
            area = None
            if found.measures is not None:
                area = found.measures["gross_area_mm2"], found.measures["gross_area_mm2_std"]
            score.add(one.area, area, found.flags)
    return score


def report(first_seed: int = 200, seeds: int = 4) -> None:
    """Print errors of single contacts by optics, with and without a first picture, and of presses."""
    numbers = range(first_seed, first_seed + seeds)
    head = ("device", "n", "bias, rms error", "stated, held", "refused", "missed", "without contact", "flags")
    for title, with_background in (("With a picture of the empty view", True), ("Without", False)):
        scores = ((kind, accuracy(kind, numbers, 2, with_background=with_background)) for kind in KINDS)
        table(head, ((KINDS[kind], *score.cells()) for kind, score in scores), title)
    presses = ((KINDS[kind], *sequence_accuracy(kind, numbers, 6).cells()) for kind in DEVICES)
    table(head, presses, "Frames of presses")
