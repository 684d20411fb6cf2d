"""Edge of contacts without ridges, on pictures made from the gap between an elastic body and the glass."""

from collections.abc import Sequence
from itertools import chain, islice
from typing import Any, TypeAlias
from unittest.mock import patch

import numpy as np

from benchmarks.derive.fit import Compared, Problem
from benchmarks.truth.smooth_contacts import DEVICES, KINDS, loading, pictures
from fingerpad.image import Scale
from fingerpad.image.contact_image import smooth
from fingerpad.image.contact_image.calibration import SMOOTH
from fingerpad.image.contact_image.region import Region
from fingerpad.image.contact_image.result import evaluate
from fingerpad.image.contact_image.smooth import Step, find_steps
from fingerpad.image.contact_image.view import View

_NEAR = 0.3  # another patch was found: nothing is learned of the edge


# A view, the step found in it, and the true area in mm².
Seen: TypeAlias = tuple[View, Step, float]


def sample(count: int, seed: int) -> list[Seen]:
    """Return the clearest step of pictures and presses of each device that contain the whole contact."""
    found = []
    for kind in KINDS:
        # A press begins with a small contact, which a film of water widens most.
        pressed = islice(loading(seed, count, kind), 1, None) if kind in DEVICES else ()
        for picture in chain(pictures(seed, count, kind), pressed):
            if not picture.whole:
                continue
            part, values, light = smooth._parts(picture.image, {"background": picture.background})
            inside = np.ones(values.shape[:2], dtype=bool)
            steps = find_steps(values, light, inside)
            if not steps or smooth._problem(steps[0], None):
                continue
            if abs(np.pi * (steps[0].radius * picture.mm_per_px) ** 2 / picture.area - 1) < _NEAR:
                view = smooth._view(part, values, inside, Scale(picture.mm_per_px), steps[0])
                found.append((view, steps[0], picture.area))
    return found


def compare(model: Any, steps: Sequence[Seen]) -> Compared:
    """Place the edge of each step, and state its uncertainty."""
    rows = []
    with patch.object(smooth, "SMOOTH", model):
        for view, step, area in steps:
            region = Region(patch=np.zeros((1, 1), dtype=bool), several=False)
            result = evaluate(view, None, region, smooth._edge(step, view), edited=False)
            rows.append(((result.gross_area - area) / area, result.gross_area_std / area))
    return Compared(*np.transpose(rows))


_LIMITS = (
    "least_contrast", "low_contrast", "crest_contrast", "least_score", "least_score_cut", "least_seen",
    "most_shared", "beyond", "straight", "least_overshoot", "rim", "even_begin", "film_begin", "sharp",
)  # fmt: skip
_KEPT = dict.fromkeys(_LIMITS, "choice: what counts as a contact, or is flagged")
_KEPT["reflected"] = "too few contacts with a reflection over their edge"
_KEPT["cut"] = "the truth of contacts that the frame cuts is not defined"
_PLACES = "crest", "fringe", "fringe_blur", "film"
_EFFECTS = (
    "pixel",
    "by_width",
    "by_wider",
    "by_scatter",
    "second",
    "hidden",
    "crest_std",
    "fringe_std",
    "film_std",
)
_OF = "error of the area, as a share"
PROBLEMS = (Problem(SMOOTH, _OF, sample, compare, places=_PLACES, stds=_EFFECTS, kept=_KEPT),)
