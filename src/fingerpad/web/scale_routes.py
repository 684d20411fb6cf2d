"""Scales and lengths, measured without storing anything."""

from typing import Annotated, Any, Final

from pydantic import Field

from fingerpad.image import Coin, measure_coin
from fingerpad.study.manifest import CoinScale, ScaleKey
from fingerpad.study.measuring.scales import FoundScale
from fingerpad.web.endpoints import Endpoint, Params
from fingerpad.web.fields import Line
from fingerpad.web.pictures import Cache, ImageLocation
from fingerpad.web.scales import scale_of
from fingerpad.web.workspace import Workspace

_COINS: Final[Cache[Coin]] = Cache(20, lambda _: 1)


class ScaleParams(Params):
    """A scale's table, or its name."""

    table: ScaleKey


def scale(workspace: Workspace, _: Any, params: ScaleParams) -> dict[str, Any]:
    """Return the scale that a table means."""
    opened = workspace.study
    table = params.table
    coin = None
    if isinstance(table, CoinScale):
        place = ImageLocation(opened.file(table.coin))
        coin = _COINS.get(place.stamp, lambda: measure_coin(opened.pictures.grey(place).pixels))
        found = FoundScale(
            scale=coin.scale(table.diameter_mm, table.diameter_mm_std),
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


class LengthParams(Params):
    """A line drawn on a picture, and the picture's scale."""

    scale: ScaleKey
    line_px: Line
    ends_px_std: Annotated[float, Field(ge=0, le=1000)] = 1.0


def length(workspace: Workspace, _: Any, params: LengthParams) -> dict[str, Any]:
    """Return the length of a line."""
    start, end = ((row, column) for row, column in params.line_px)
    found, std = scale_of(workspace.study, params.scale).scale.length(
        start, end, point_px_std=params.ends_px_std
    )
    return {"length_mm": found, "length_mm_std": std}


ENDPOINTS: Final = (
    Endpoint(
        method="POST",
        path="/api/measure/scale",
        answer=scale,
        summary="The scale that a table means, without storing it",
        body=ScaleParams,
    ),
    Endpoint(
        method="POST",
        path="/api/measure/length",
        answer=length,
        summary="The length of a line",
        body=LengthParams,
    ),
)
