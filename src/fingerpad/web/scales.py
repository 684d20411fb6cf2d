"""Scales and lengths: the named scales of the study, and measurements that are not stored."""

from collections.abc import Mapping
from typing import Annotated, Any, Final

from pydantic import Field

from fingerpad.image import Coin, ImageEllipse, measure_coin
from fingerpad.study.manifest import CoinScale, ScaleKey
from fingerpad.study.measuring.scales import FoundScale, find_scale, named_scales
from fingerpad.web import answers
from fingerpad.web.endpoints import Endpoint, Params, Point
from fingerpad.web.errors import RequestError
from fingerpad.web.pictures import Cache, ImageLocation
from fingerpad.web.study_session import StudySession
from fingerpad.web.workspace import Workspace

_FOUND: Final[Cache[dict[str, FoundScale | str]]] = Cache(20, lambda _: 1)


def scales_of(opened: StudySession) -> Mapping[str, FoundScale | str]:
    """Return each named scale, or why there is none."""
    study = opened.study()
    stamps = [
        (name, table.model_dump_json(), _stamp(opened, table.coin) if isinstance(table, CoinScale) else None)
        for name, table in study.scales.items()
    ]
    return _FOUND.get((str(opened.folder), tuple(stamps)), lambda: named_scales(study, opened.folder))


def scale_of(opened: StudySession, key: ScaleKey) -> FoundScale:
    """Return the scale that a key of the manifest means."""
    if isinstance(key, str):
        known = scales_of(opened)
        if key not in known:
            raise RequestError.not_there(f"no scale is named {key!r}")
        return find_scale(key, known, opened.folder)
    if isinstance(key, CoinScale):
        opened.file(key.coin)  # one of the study's own
    return find_scale(key, {}, opened.folder)


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
