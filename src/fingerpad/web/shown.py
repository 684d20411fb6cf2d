"""The pictures of items: what they are, previews, thumbnails, and overlays as the report shows them."""

import hashlib
from typing import Annotated, Any, Final
from urllib.parse import urlencode

from pydantic import Field
from starlette.responses import FileResponse, Response

from fingerpad.web.asked import Item
from fingerpad.web.bench import Bench
from fingerpad.web.engine import overlay_of
from fingerpad.web.operations import Operation, Question
from fingerpad.web.pictures import PREVIEW_PX, Place, is_film
from fingerpad.web.refusal import Refusal

# Its address changes with the picture.
_FOR_EVER: Final = {"cache-control": "private, max-age=31536000, immutable"}
_NOW: Final = {"cache-control": "private, no-cache"}


class PictureQuestion(Question):
    """Which item; `v` stands for the picture as it was when its address was given."""

    item: Item
    v: Annotated[str, Field(max_length=40)] = ""


class PreviewQuestion(PictureQuestion):
    """The same, and how large."""

    longest_px: Annotated[int, Field(ge=16, le=8192)] = PREVIEW_PX


def info(bench: Bench, asked: PictureQuestion, _: Any) -> dict[str, Any]:
    """Return what a picture is, and where its previews are."""
    opened = bench.study
    place = opened.place_of(asked.item)
    film = place.colour and is_film(place.path)
    picture = opened.pictures.grey(Place(place.path, frame=0) if film else place)
    rows, columns = picture.pixels.shape
    query = urlencode({"item": asked.item, "v": version(place)})
    return {
        "item": asked.item,
        "rows_px": rows,
        "columns_px": columns,
        "bits": 8 * picture.pixels.itemsize,
        "resolution_ppi": picture.dots_per_inch,
        "preview": f"/api/picture/preview?{query}",
        "thumbnail": f"/api/picture/thumbnail?{query}",
    }


def version(place: Place) -> str:
    """Return what stands for a picture as it is now."""
    return hashlib.sha256(repr(place.stamp).encode()).hexdigest()[:16]


def preview(bench: Bench, asked: PreviewQuestion, _: Any) -> Response:
    """Return a picture for the browser."""
    place = bench.study.place_of(asked.item)
    drawn, kind = bench.study.pictures.preview(place, asked.longest_px)
    return Response(drawn, media_type=kind, headers=_FOR_EVER if asked.v else _NOW)


def thumbnail(bench: Bench, asked: PictureQuestion, _: Any) -> Response:
    """Return a small picture."""
    drawn = bench.study.pictures.thumbnail(bench.study.place_of(asked.item))
    return Response(drawn, media_type="image/webp", headers=_FOR_EVER if asked.v else _NOW)


def overlay(bench: Bench, asked: PictureQuestion, _: Any) -> Response:
    """Return the measurement drawn on the picture, as the last run wrote it."""
    opened = bench.study
    path = overlay_of(opened, asked.item)
    if path is None or not path.resolve().is_relative_to(opened.out.resolve()):
        raise Refusal.not_there(f"{asked.item}: no overlay is drawn: run the study")
    return FileResponse(path, media_type="image/png", headers=_NOW)


OPERATIONS: Final = (
    Operation(
        method="GET",
        path="/api/picture/info",
        answer=info,
        query=PictureQuestion,
        summary="What a picture is",
    ),
    Operation(
        method="GET",
        path="/api/picture/preview",
        answer=preview,
        query=PreviewQuestion,
        media="image/png",
        summary="A picture in 8 bits",
    ),
    Operation(
        method="GET",
        path="/api/picture/thumbnail",
        answer=thumbnail,
        query=PictureQuestion,
        media="image/webp",
        summary="A small picture",
    ),
    Operation(
        method="GET",
        path="/api/picture/overlay",
        answer=overlay,
        query=PictureQuestion,
        media="image/png",
        summary="The measurement drawn on the picture",
    ),
)
