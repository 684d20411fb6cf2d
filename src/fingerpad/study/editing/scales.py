"""Scales as people state them: what each way needs, sizes of known things, and a scale in words."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final, get_args

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
COINS: Final = tuple(
    KnownSize(size_mm=size, words=f"{words}, {size:g} mm")
    for words, size in (
        ("1 euro cent", 16.25),
        ("2 euro cent", 18.75),
        ("5 euro cent", 21.25),
        ("10 euro cent", 19.75),
        ("20 euro cent", 22.25),
        ("50 euro cent", 24.25),
        ("1 euro", 23.25),
        ("2 euro", 25.75),
        ("US quarter", 24.26),
        ("UK penny", 20.3),
    )
)
# ISO/IEC 7810, format ID-1: bank cards, most identity cards and driving licences.
CARD: Final = (
    KnownSize(size_mm=85.6, words="a bank card's long side, 85.60 mm"),
    KnownSize(size_mm=53.98, words="a bank card's short side, 53.98 mm"),
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
