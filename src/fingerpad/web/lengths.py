"""Scales and lengths, measured without storing anything."""

from typing import Annotated, Any, Final

from pydantic import Field

from fingerpad.image import Coin, measure_coin
from fingerpad.study.manifest import CoinScale, ScaleKey
from fingerpad.study.scales import FoundScale
from fingerpad.web.asked import Line
from fingerpad.web.bench import Bench
from fingerpad.web.operations import Operation, Question
from fingerpad.web.pictures import Cache, Place
from fingerpad.web.scales import scale_of

_COINS: Final[Cache[Coin]] = Cache(20, lambda _: 1)


class ScaleQuestion(Question):
    """A scale's table, or its name."""

    table: ScaleKey


def scale(bench: Bench, _: Any, asked: ScaleQuestion) -> dict[str, Any]:
    """Return the scale that a table means."""
    opened = bench.study
    table = asked.table
    coin = None
    if isinstance(table, CoinScale):
        place = Place(opened.file(table.coin))
        coin = _COINS.get(place.stamp, lambda: measure_coin(opened.pictures.grey(place).pixels))
        found = FoundScale(
            scale=coin.scale(table.diameter_mm, table.diameter_std_mm),
            flags=tuple(f"coin_{flag}" for flag in coin.flags),
        )
    else:
        found = scale_of(opened, table)
    return {
        "mm_per_px": found.scale.mm_per_px,
        "mm_per_px_std": found.scale.mm_per_px_std,
        "relative_std": found.scale.relative_std,
        "resolution_ppi": found.scale.ppi,
        "flags": list(found.flags),
        "coin": coin and _coin(coin),
    }


def _coin(coin: Coin) -> dict[str, Any]:
    return {
        "centre_px": coin.centre,
        "radius_px": coin.semi_major,
        "radius_px_std": coin.semi_major_std,
    }


class LengthQuestion(Question):
    """A line drawn on a picture, and the picture's scale."""

    scale: ScaleKey
    line_px: Line
    ends_std_px: Annotated[float, Field(ge=0, le=1000)] = 1.0


def length(bench: Bench, _: Any, asked: LengthQuestion) -> dict[str, Any]:
    """Return the length of a line."""
    start, end = ((row, column) for row, column in asked.line_px)
    found, std = scale_of(bench.study, asked.scale).scale.length(start, end, point_px_std=asked.ends_std_px)
    return {"length_mm": found, "length_mm_std": std}


OPERATIONS: Final = (
    Operation(
        method="POST",
        path="/api/measure/scale",
        answer=scale,
        summary="The scale that a table means, without storing it",
        body=ScaleQuestion,
    ),
    Operation(
        method="POST",
        path="/api/measure/length",
        answer=length,
        summary="The length of a line",
        body=LengthQuestion,
    ),
)
