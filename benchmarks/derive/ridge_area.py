"""Level of ridges and uncertainty of their area, on three independent renderers.

The errors are those of the ridge area of images in which the outline was found to 5 % of its area, with what
the outline itself adds taken off in proportion.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any
from unittest.mock import patch

import numpy as np

from benchmarks.derive.fit import Compared, Problem
from benchmarks.tables import or_none
from benchmarks.truth.image_sets import images
from fingerpad.image import Scale
from fingerpad.image.contact_image import result, ridges
from fingerpad.image.contact_image.calibration import RIDGE_AREA, RIDGE_LEVEL
from fingerpad.image.contact_image.edge import Edge, trace_edge
from fingerpad.image.contact_image.region import Region, find_region
from fingerpad.image.contact_image.view import View, view_of
from fingerpad.image.ellipse import polygon_moments

_NEAR = 0.05


@dataclass(frozen=True, eq=False)
class Seen:
    """An image with its outline found, and the true ridge area over the gross area."""

    view: View
    ridges: ridges.Ridges
    region: Region
    edge: Edge
    area: float
    share: float


def sample(count: int, seed: int) -> list[Seen]:
    """Return images whose outline is found and whose ridges are resolved."""
    found: list[Seen] = []
    for _, _, image in images(count, seed):
        view = view_of(image.pixels, Scale(image.mm_per_px))
        rough = ridges.find_ridges(view, None)
        if (region := or_none(find_region, view, rough, None)) is None:
            continue
        edge = trace_edge(view, rough, region)
        area = polygon_moments(view.to_picture(edge.points)).area
        if view.resolved and abs(area * image.mm_per_px**2 / image.gross_area - 1) < _NEAR:
            found.append(Seen(view, rough, region, edge, area, image.ridge_area / image.gross_area))
    return found


def _mapped(one: Seen) -> tuple[Any, float]:
    fine = ridges.ridge_map(one.view, one.edge.points, None)
    area, unknown = fine.area(result._blurred_ridges(one.ridges.amount, one.region.patch, one.view.period))
    return fine, area - unknown / 2


_mapped_once = cache(_mapped)


def _compare(images: Sequence[Seen], mapped: Callable[[Seen], tuple[Any, float]]) -> Compared:
    rows = []
    for one in images:
        (fine, known), true = mapped(one), one.share * one.area
        rows.append((known / true - 1, result._ridge_area_std(one.edge, fine, known, one.area) / true))
    return Compared(*np.transpose(rows))


def compare_level(level: Any, images: Sequence[Seen]) -> Compared:
    """Find the ridges again under another level."""
    with patch.object(ridges, "RIDGE_LEVEL", level):
        return _compare(images, _mapped)


def compare_error(stated: Any, images: Sequence[Seen]) -> Compared:
    """State the uncertainty of the ridges of the level in use, found once, under other numbers."""
    with patch.object(result, "RIDGE_AREA", stated):
        return _compare(images, _mapped_once)


_OF = "error of the ridge area inside the outline, as a share"
_PLACES = "reach", "smoothing", "by_blur", "cubic", "usual_grain", "by_grain"
_EFFECTS = "level_std", "by_grain", "least_std", "by_rim", "by_fade", "by_moisture", "by_thinness"
_OF_LEVEL = dict.fromkeys(("direction", "sample"), "choice: the area hardly depends on it") | {
    "filled": "choice: midway between the sets, which differ by pores and sweat",
    "near_half": "choice: the width of a numerical derivative",
    "crest": "choice: what is counted as crest; usual_grain depends on it",
}
_OF_ERROR = {
    "sharp_fade": "choice: where by_fade begins",
    "most_fade": "choice: where by_fade ends",
    "usual_grain": "choice: where by_grain begins",
    "dry_share": "choice: where by_moisture begins",
    "wet_share": "choice: where by_moisture ends",
    "thin_share": "choice: where by_thinness begins",
    "most_grain": "choice: where by_grain ends, as beyond the sets of images only real prints have more",
    "at_rim": "no error inside a given outline depends on it",
}
PROBLEMS = (
    Problem(RIDGE_LEVEL, _OF, sample, compare_level, places=_PLACES, kept=_OF_LEVEL),
    Problem(RIDGE_AREA, _OF, sample, compare_error, stds=_EFFECTS, kept=_OF_ERROR),
)
