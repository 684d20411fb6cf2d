"""Images of items: size, previews and thumbnails."""

import hashlib
from typing import Annotated, Final
from urllib.parse import urlencode

from fastapi import Response
from pydantic import Field

from fingerpad.web.answers import Answer
from fingerpad.web.api.base import IMMUTABLE, Item, Opened, Params, Query, router
from fingerpad.web.pictures import PREVIEW_PX, ImageLocation, is_sequence

_NO_CACHE: Final = {"cache-control": "private, no-cache"}


class PictureInfo(Answer):
    """Size and depth of a picture, and the address of its preview."""

    rows_px: int
    columns_px: int
    bits: int
    preview: str


class PictureParams(Params):
    """An item, and the version `v` of its image."""

    item: Item
    v: Annotated[str, Field(max_length=40)] = ""


class PreviewParams(PictureParams):
    """The same, and the size of the preview."""

    longest_px: Annotated[int, Field(ge=16, le=8192)] = PREVIEW_PX


@router.get("/picture/info")
def info(opened: Opened, params: Query[PictureParams]) -> PictureInfo:
    """Return the size of an image and the address of its preview."""
    place = opened.image_location(params.item)
    is_frame = place.colour and is_sequence(place.path)
    picture = opened.pictures.grey(ImageLocation(place.path, frame=0) if is_frame else place)
    rows, columns = picture.pixels.shape
    query = urlencode({"item": params.item, "v": version(place)})
    return PictureInfo(
        rows_px=rows,
        columns_px=columns,
        bits=8 * picture.pixels.itemsize,
        preview=opened.address(f"/picture/preview?{query}"),
    )


def version(place: ImageLocation) -> str:
    """Return the version of an image, a hash of its file's state."""
    return hashlib.sha256(repr(place.stamp).encode()).hexdigest()[:16]


@router.get("/picture/preview", response_class=Response)
def preview(opened: Opened, params: Query[PreviewParams]) -> Response:
    """Return a preview of an image."""
    place = opened.image_location(params.item)
    drawn, kind = opened.pictures.preview(place, params.longest_px)
    return Response(drawn, media_type=kind, headers=IMMUTABLE if params.v else _NO_CACHE)


@router.get("/picture/thumbnail", response_class=Response)
def thumbnail(opened: Opened, params: Query[PictureParams]) -> Response:
    """Return a thumbnail."""
    drawn = opened.pictures.thumbnail(opened.image_location(params.item))
    return Response(drawn, media_type="image/webp", headers=IMMUTABLE if params.v else _NO_CACHE)
