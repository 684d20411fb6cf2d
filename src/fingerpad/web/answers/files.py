"""Files and pictures."""

from typing import Literal

from fingerpad.web.answers.base import Answer


class UploadedFile(Answer):
    """An uploaded file."""

    file: str
    kind: Literal["picture", "film", "table", "other"]
    bytes: int
    rows_px: int | None
    columns_px: int | None
    resolution_ppi: float | None
    frames: int | None
    columns: list[str] | None
    problem: str | None


class LeftOutFile(Answer):
    """A file that the ZIP does not hold, and why."""

    file: str
    why: str


class BundleContents(Answer):
    """What the ZIP of the study holds."""

    files: int
    bytes: int
    left_out: list[LeftOutFile]


class PictureInfo(Answer):
    """Size and depth of a picture, and the addresses of its previews."""

    item: str
    rows_px: int
    columns_px: int
    bits: int
    resolution_ppi: float | None
    preview: str
    thumbnail: str
