"""Scales and lengths: the named scales of the study, and measurements that are not stored."""

from typing import Annotated, Any, Final

from pydantic import Field

from fingerpad.image import Coin, ImageEllipse, measure_coin
from fingerpad.study.manifest import CoinScale, ScaleKey
from fingerpad.study.measuring.scales import FoundScale, require_scale, scale_from, scale_record
from fingerpad.web import answers
from fingerpad.web.endpoints import Endpoint, Params, Point
from fingerpad.web.errors import RequestError
from fingerpad.web.pictures import Cache, ImageLocation
from fingerpad.web.study_session import StudySession
from fingerpad.web.workspace import Workspace

_FOUND: Final[Cache[FoundScale | str]] = Cache(100, lambda _: 1)


def scale_of(opened: StudySession, key: ScaleKey) -> FoundScale:
    """Return the scale that a key of the manifest means."""
    name = key if isinstance(key, str) else None
    table = opened.study().scales.get(key) if isinstance(key, str) else key
    if table is None:
        raise RequestError.not_there(f"no scale is named {name!r}")
    coin = table.coin if isinstance(table, CoinScale) else None
    if coin is not None:
        opened.file(coin)  # one of the study's own
    stamp = None if coin is None else _stamp(opened, coin)
    found = _FOUND.get(
        (opened.folder, name, table.model_dump_json(), stamp),
        lambda: scale_from(scale_record(name, table, opened.folder, opened.folder), name),
    )
    return require_scale(found)


def _stamp(opened: StudySession, file: str) -> Any:
    return ImageLocation(opened.folder / file).stamp


_OUTLINE_POINTS: Final = 90
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
    outline = ImageEllipse(
        centre=coin.centre, semi_axes=(coin.semi_major, coin.semi_minor), orientation=coin.orientation
    )
    return {
        "outline_px": outline.points(_OUTLINE_POINTS).round(2),
        "radius_px": coin.semi_major,
        "radius_px_std": coin.semi_major_std,
    }


class LengthParams(Params):
    """A line drawn on a picture, and the picture's scale."""

    scale: ScaleKey
    line_px: tuple[Point, Point]
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
        model=answers.ScaleMeasurement,
        summary="The scale that a table means, without storing it",
        body=ScaleParams,
    ),
    Endpoint(
        method="POST",
        path="/api/measure/length",
        answer=length,
        model=answers.LengthMeasurement,
        summary="The length of a line",
        body=LengthParams,
    ),
)
