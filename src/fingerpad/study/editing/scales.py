"""Scales as people state them: what each way needs, sizes of known things, and a scale in words."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final, get_args

from fingerpad._csv import packaged_lines
from fingerpad.study.manifest.models import ScaleTable


@dataclass(frozen=True, slots=True, kw_only=True)
class ScaleWay:
    """A way to state a scale."""

    needs: list[str]
    may: list[str]
    starts: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class KnownSize:
    """A length that everybody has at hand, mm."""

    size_mm: float
    words: str


# A person draws a line or points to about one pixel.
_STARTS: Final[Mapping[str, Mapping[str, Any]]] = {
    "line": {"ends_px_std": 1},
    "circle": {"points_px_std": 1},
    "grid": {"pattern": "checkerboard"},
}
SCALE_WAYS: Final[Mapping[str, ScaleWay]] = {
    next(iter(model.model_fields)): ScaleWay(
        needs=[name for name, one in model.model_fields.items() if one.is_required()],
        may=[name for name, one in model.model_fields.items() if not one.is_required()],
        starts=_STARTS.get(next(iter(model.model_fields)), {}),
    )
    for model in get_args(ScaleTable)
}
# Cards are ISO/IEC 7810, format ID-1: bank cards, most identity cards and driving licences.
COINS, CARD = (
    tuple(
        KnownSize(size_mm=float(line["size_mm"]), words=f"{line['words']}, {line['size_mm']} mm")
        for line in packaged_lines("fingerpad.study.editing", "known_sizes.csv")
        if line["what"] == what
    )
    for what in ("coin", "card")
)
_SUMMARIES: Final = {
    "line": ("length_mm", "line of {} mm"),
    "coin": ("diameter_mm", "coin of {} mm"),
    "circle": ("diameter_mm", "circle of {} mm"),
    "grid": ("spacing_mm", "grid of {} mm"),
    "ppi": ("ppi", "{} ppi"),
    "mm_per_px": ("mm_per_px", "{} mm/px"),
}


def scale_words(scale: object) -> str:
    """Return a scale of a manifest in words: its name, or how it is stated."""
    if not isinstance(scale, Mapping):
        return scale if isinstance(scale, str) else ""
    way = next((way for way in _SUMMARIES if way in scale), None)
    if way is None:
        return "incomplete"
    key, words = _SUMMARIES[way]
    value = scale.get(key)
    return words.format(f"{value:.12g}") if isinstance(value, int | float) else way
