"""Images of items: size, previews and thumbnails."""

import hashlib
from typing import Annotated, Any, Final
from urllib.parse import urlencode

from pydantic import Field
from starlette.responses import Response

from fingerpad.web.answers import files as answers
from fingerpad.web.endpoints import IMMUTABLE, Item, Params, endpoint
from fingerpad.web.pictures import PREVIEW_PX, ImageLocation, is_sequence
from fingerpad.web.workspace import Workspace

_NO_CACHE: Final = {"cache-control": "private, no-cache"}


class PictureParams(Params):
    """An item, and the version `v` of its image."""

    item: Item
    v: Annotated[str, Field(max_length=40)] = ""


class PreviewParams(PictureParams):
    """The same, and the size of the preview."""

    longest_px: Annotated[int, Field(ge=16, le=8192)] = PREVIEW_PX


@endpoint("GET", "/api/studies/{study}/picture/info", "Size of an image", answers.PictureInfo)
def info(workspace: Workspace, params: PictureParams, _: Any) -> dict[str, Any]:
    """Return the size of an image and the addresses of its previews."""
    opened = workspace.study
    place = opened.image_location(params.item)
    is_frame = place.colour and is_sequence(place.path)
    picture = opened.pictures.grey(ImageLocation(place.path, frame=0) if is_frame else place)
    rows, columns = picture.pixels.shape
    query = urlencode({"item": params.item, "v": version(place)})
    return {
        "item": params.item,
        "rows_px": rows,
        "columns_px": columns,
        "bits": 8 * picture.pixels.itemsize,
        "resolution_ppi": picture.dots_per_inch,
        "preview": opened.address(f"/picture/preview?{query}"),
        "thumbnail": opened.address(f"/picture/thumbnail?{query}"),
    }


def version(place: ImageLocation) -> str:
    """Return the version of an image, a hash of its file's state."""
    return hashlib.sha256(repr(place.stamp).encode()).hexdigest()[:16]


@endpoint("GET", "/api/studies/{study}/picture/preview", "An image in 8 bits", media="image/png")
def preview(workspace: Workspace, params: PreviewParams, _: Any) -> Response:
    """Return a preview of an image."""
    place = workspace.study.image_location(params.item)
    drawn, kind = workspace.study.pictures.preview(place, params.longest_px)
    return Response(drawn, media_type=kind, headers=IMMUTABLE if params.v else _NO_CACHE)


@endpoint("GET", "/api/studies/{study}/picture/thumbnail", "A thumbnail", media="image/webp")
def thumbnail(workspace: Workspace, params: PictureParams, _: Any) -> Response:
    """Return a thumbnail."""
    drawn = workspace.study.pictures.thumbnail(workspace.study.image_location(params.item))
    return Response(drawn, media_type="image/webp", headers=IMMUTABLE if params.v else _NO_CACHE)
