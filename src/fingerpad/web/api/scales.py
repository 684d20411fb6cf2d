"""Scales and lengths: the named scales of the study, and measurements that are not stored."""

from pathlib import PurePosixPath
from typing import Annotated, Final

import numpy as np
from PIL import Image
from pydantic import Field

from fingerpad._files import file_stem
from fingerpad.figures.style import PNG_LEVEL
from fingerpad.image import Coin, Grid, ImageEllipse, measure_coin
from fingerpad.image.scale import circle_through
from fingerpad.study.manifest.models import CircleScale, CoinScale, GridScale, ScaleKey
from fingerpad.study.measuring.context import FoundScale, grid_of, require_scale, scale_from, scale_record
from fingerpad.web.answers import Answer, Point, Quantity, RequestError
from fingerpad.web.api.base import Body, Item, Opened, Params, PointParam, router
from fingerpad.web.pictures import Cache, ImageLocation
from fingerpad.web.study_session import StudySession

_FOUND: Final[Cache[FoundScale | str]] = Cache(100)


class GridMeasurement(Answer):
    """A grid found in a picture, how far it is from flat, and the scale of rectified pictures."""

    points_px: list[Point]
    residual_px: float
    anisotropy: float
    variation: float
    unevenness: float
    rectified_mm_per_px: Quantity


class ScaleMeasurement(Answer):
    """The scale that a table gives, and the coin or grid that was found in its picture."""

    mm_per_px: Quantity
    relative_std: float
    resolution_ppi: Quantity
    flags: list[str]
    outline_px: list[Point] | None
    radius_px: Quantity | None
    grid: GridMeasurement | None


class RectifiedPictures(Answer):
    """Files of rectified pictures, by those that they were made of, and the scale of all of them."""

    files: dict[str, str]
    mm_per_px: float
    relative_std: float


class LengthMeasurement(Answer):
    """The length of a line."""

    length_mm: Quantity


def scale_of(opened: StudySession, key: ScaleKey) -> FoundScale:
    """Return the scale that a key of the manifest means."""
    name = key if isinstance(key, str) else None
    table = opened.study().scales.get(key) if isinstance(key, str) else key
    if table is None:
        raise RequestError.not_there(f"no scale is named {name!r}")
    pictures = [file for _, file in table.files()]
    stamps = tuple(ImageLocation(opened.file(file)).stamp for file in pictures)  # files of the study only
    found = _FOUND.get(
        (opened.folder, name, table.model_dump_json(), stamps),
        lambda: scale_from(scale_record(name, table, opened.folder, opened.folder)),
    )
    return require_scale(found)


_OUTLINE_POINTS: Final = 90
_RECTIFIED: Final = "rectified"
_GRIDS: Final[Cache[Grid]] = Cache(20)
_COINS: Final[Cache[Coin]] = Cache(20)


class ScaleParams(Params):
    """A scale's table, or its name."""

    table: ScaleKey


@router.post("/measure/scale")
def scale(opened: Opened, params: Body[ScaleParams]) -> ScaleMeasurement:
    """Return the scale that a table means, and what it was found by in its picture."""
    table, grid = params.table, None
    ellipse: ImageEllipse | None = None
    radius: dict[str, float] = {}
    if isinstance(table, CoinScale):
        place = ImageLocation(opened.file(table.coin))
        coin = _COINS.get(place.stamp, lambda: measure_coin(opened.pictures.grey(place)))
        found = FoundScale(scale=coin.scale(table.diameter_mm, table.diameter_mm_std), flags=coin.flags)
        axes = coin.semi_major, coin.semi_minor
        ellipse = ImageEllipse(centre=coin.centre, semi_axes=axes, orientation=coin.orientation)
        radius = {"radius_px": coin.semi_major, "radius_px_std": coin.semi_major_std}
    elif isinstance(table, GridScale):
        seen = _measured_grid(opened, table)
        found = FoundScale(scale=seen.scale, flags=seen.flags)
        grid = GridMeasurement.of(
            seen,
            points_px=seen.points.reshape(-1, 2).round(2),
            residual_px=seen.residual,
            rectified_mm_per_px=seen.rectified_scale.mm_per_px,
            rectified_mm_per_px_std=seen.rectified_scale.mm_per_px_std,
        )
    else:
        found = scale_of(opened, table)
        if isinstance(table, CircleScale):
            (row, column), size, weights = circle_through([(row, column) for row, column in table.circle])
            ellipse = ImageEllipse(centre=(float(row), float(column)), semi_axes=(size, size))
            std = table.points_px_std * float(np.linalg.norm(weights))
            radius = {"radius_px": size, "radius_px_std": std}
    return ScaleMeasurement.of(
        found.scale,
        resolution_ppi=found.scale.ppi,
        flags=found.flags,
        outline_px=ellipse and ellipse.points(_OUTLINE_POINTS).round(2),
        radius_px=Quantity.read(radius.get, "radius_px") if radius else None,
        grid=grid,
    )


def _measured_grid(opened: StudySession, table: GridScale) -> Grid:
    place = ImageLocation(opened.file(table.grid))
    key = place.stamp, table.model_dump_json()
    return _GRIDS.get(key, lambda: grid_of(table, opened.pictures.grey(place)))


class RectifyParams(Params):
    """The table of a grid, and pictures that the same camera took."""

    table: GridScale
    files: Annotated[list[Item], Field(min_length=1, max_length=2000)]


@router.post("/scale/rectify")
def rectify(opened: Opened, params: Body[RectifyParams]) -> RectifiedPictures:
    """Write pictures as if seen straight on into the folder ``rectified`` of the study."""
    grid = _measured_grid(opened, params.table)
    folder = opened.folder / _RECTIFIED
    folder.mkdir(exist_ok=True)
    written = {}
    for file in params.files:
        pixels, _scale = grid.rectified(opened.pictures.grey(ImageLocation(opened.file(file))))
        name = str(PurePosixPath(file).with_suffix("")).replace("/", "__")
        target = folder / f"{file_stem(name)}.png"
        part = target.with_suffix(".part")
        Image.fromarray(pixels).save(part, "png", compress_level=PNG_LEVEL)
        part.replace(target)
        written[file] = f"{_RECTIFIED}/{target.name}"
    return RectifiedPictures.of(grid.rectified_scale, files=written)


class LengthParams(Params):
    """A line drawn on a picture, and the picture's scale."""

    scale: ScaleKey
    line_px: tuple[PointParam, PointParam]
    ends_px_std: Annotated[float, Field(ge=0, le=1000)] = 1.0


@router.post("/measure/length")
def length(opened: Opened, params: Body[LengthParams]) -> LengthMeasurement:
    """Return the length of a line."""
    start, end = ((row, column) for row, column in params.line_px)
    found, std = scale_of(opened, params.scale).scale.length(start, end, point_px_std=params.ends_px_std)
    return LengthMeasurement.of(length_mm=found, length_mm_std=std)
