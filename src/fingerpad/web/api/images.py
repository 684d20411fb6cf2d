"""Images of items: size, previews and thumbnails."""

import hashlib
from typing import Annotated, Final
from urllib.parse import urlencode

from fastapi import Response
from pydantic import Field

from fingerpad.web.answers import Answer
from fingerpad.web.api.base import ASK_AGAIN, IMMUTABLE, Item, Opened, router

_THUMBNAIL_PX: Final = 192
_PREVIEW_PX: Final = 2048


class PictureInfo(Answer):
    """Size and depth of a picture, and the address of its preview."""

    rows_px: int
    columns_px: int
    bits: int
    preview: str


@router.get("/picture/info")
def info(opened: Opened, item: Item) -> PictureInfo:
    """Return the size of an image and the address of its preview."""
    place = opened.image_location(item)
    pixels = opened.pictures.grey(place.shown)
    version = hashlib.sha256(repr(place.stamp).encode()).hexdigest()[:16]
    preview = opened.address(f"/picture/preview?{urlencode({'item': item, 'v': version})}")
    rows, columns = pixels.shape
    return PictureInfo(rows_px=rows, columns_px=columns, bits=8 * pixels.itemsize, preview=preview)


@router.get("/picture/preview", response_class=Response)
def preview(opened: Opened, item: Item, v: Annotated[str, Field(max_length=40)] = "") -> Response:
    """Return a preview of an image, of a photograph as JPEG; with a version `v` it is that for ever."""
    place = opened.image_location(item)
    media_type = "image/jpeg" if place.colour else "image/png"
    content = opened.pictures.encoded(place, media_type, _PREVIEW_PX)
    return Response(content, media_type=media_type, headers=IMMUTABLE if v else ASK_AGAIN)


@router.get("/picture/thumbnail", response_class=Response)
def thumbnail(opened: Opened, item: Item) -> Response:
    """Return a thumbnail."""
    content = opened.pictures.encoded(opened.image_location(item), "image/webp", _THUMBNAIL_PX)
    return Response(content, media_type="image/webp", headers=ASK_AGAIN)
