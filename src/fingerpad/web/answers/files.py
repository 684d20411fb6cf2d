"""Files and pictures."""

from typing import Literal

from fingerpad.study.imports.identify import Content
from fingerpad.study.imports.names import Role
from fingerpad.web.answers.base import Answer


class UploadedFile(Answer):
    """An uploaded file."""

    file: str
    kind: Literal["picture", "sequence", "table", "other"]
    bytes: int
    rows_px: int | None
    columns_px: int | None
    resolution_ppi: float | None
    frames: int | None
    columns: list[str] | None
    problem: str | None


class FileGuess(Answer):
    """What a new file may be, most likely first, and the face that it shows if it is a photograph."""

    file: str
    contents: list[Content]
    faces: list[Literal["palmar", "distal", "radial", "ulnar"]]
    sure: bool
    face_sure: bool


class StatedValues(Answer):
    """What a spreadsheet or a name states of a file; null where it states nothing."""

    role: Role | Literal[""] | None
    person: str | None
    finger: str | None
    face: Literal["palmar", "distal", "radial", "ulnar"] | None
    wedge_angle_deg: float | None
    load_N: float | None  # noqa: N815
    scale: str | None
    ppi: float | None
    mm_per_px: float | None
    session: str | None


class StatedFile(Answer):
    """A file, what is stated of it, and what could not be read."""

    file: str
    values: StatedValues
    problem: str


class TableColumn(Answer):
    """A column of a spreadsheet; its meaning is null where it is not understood."""

    header: str
    meaning: str | None
    unit: str | None


class TableRow(Answer):
    """A row of a spreadsheet that names no new file, or one that another row names too."""

    line: int
    file: str


class JoinedTable(Answer):
    """A spreadsheet joined to new files."""

    columns: list[TableColumn]
    files: list[StatedFile]
    rows_without_file: list[TableRow]
    files_without_row: list[str]


class PatternMatches(Answer):
    """What a pattern gives of the name of each new file."""

    files: list[StatedFile]


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
