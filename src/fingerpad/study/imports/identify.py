"""What a new file is, by its content and its name together."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Final, Literal, TypeAlias

from fingerpad._columns import NAMES
from fingerpad._tables import TABLE_SUFFIXES, Table, read_table
from fingerpad.exceptions import ManifestError
from fingerpad.image import MEMORY_LIMIT, Face, Subject, guess_subject, open_frames, read_colour_image
from fingerpad.image.sequence.frames import PICTURE_SUFFIXES, TIFF_SUFFIXES, VIDEO_SUFFIXES
from fingerpad.study.imports.file_table import file_table
from fingerpad.study.imports.names import Kind, names_a_force, names_a_scale, read_file_name

Content: TypeAlias = Literal[
    "contact image",
    "photograph",
    "coin",
    "ruler",
    "sequence",
    "loading curve",
    "force table",
    "outline",
    "table of files",
    "other",
]

_OF_SUBJECT: Final[Mapping[Subject, Content]] = {
    "contact": "contact image",
    "finger": "photograph",
    "coin": "coin",
    "ruler": "ruler",
    "other": "other",
}
# A name that says what a file is counts as this factor; a likelihood at which a guess need not be asked.
_NAMED: Final = 200.0
SURE: Final = 0.9
_SIDES: Final[tuple[Face, ...]] = ("radial", "ulnar")


@dataclass(frozen=True, slots=True, kw_only=True)
class FileIdentity:
    """What a file may be.

    Attributes
    ----------
    contents : mapping of str to float
        What it may be, most likely first; the numbers sum to 1. They rank, and are no frequencies.
    faces : mapping of str to float
        The face that it shows if it is a photograph, most likely first.
    """

    contents: Mapping[Content, float]
    faces: Mapping[Face, float]

    @property
    def content(self) -> Content:
        """The most likely content."""
        return next(iter(self.contents))

    @property
    def face(self) -> Face | None:
        """The most likely face, None where nothing tells."""
        return next(iter(self.faces), None)

    @property
    def is_sure(self) -> bool:
        """Whether nothing else is at all likely; otherwise it is to be asked."""
        return self.contents[self.content] >= SURE

    @property
    def is_face_sure(self) -> bool:
        """Whether no other face is at all likely; the two sides, which look alike, count as one."""
        sides = sum(self.faces.get(face, 0.0) for face in _SIDES)
        return bool(self.faces) and max(*self.faces.values(), sides) >= SURE


def identify_file(path: str | PathLike[str], *, memory_limit: int = MEMORY_LIMIT) -> FileIdentity:
    r"""Guess what a file is, by its content and its name.

    Pictures are looked at (`fingerpad.image.guess_subject`), tables are known by their headers, and
    sequences by their frames. A name that says it, as ``palmar``, ``30deg_2N`` or ``coin``, counts for much.

    Parameters
    ----------
    path : path-like
        A picture, a sequence, a table or a spreadsheet.
    memory_limit : int
        The most bytes that reading may take, as for `fingerpad.image.read_image`.

    Returns
    -------
    FileIdentity

    Raises
    ------
    ImageError
        If a picture or a sequence cannot be read.
    ManifestError
        If a table cannot be read.

    Examples
    --------
    >>> from pathlib import Path
    >>> import tempfile
    >>> folder = tempfile.TemporaryDirectory()
    >>> path = Path(folder.name, "data_12.csv")
    >>> _ = path.write_text("time_s,force_N,displacement_mm\n0,0,0\n1,0.5,1\n")
    >>> found = identify_file(path)
    >>> found.content, found.is_sure
    ('loading curve', True)
    >>> folder.cleanup()
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix in TABLE_SUFFIXES:
        return _identity(_table_contents(path), path, "table")
    if suffix in VIDEO_SUFFIXES:
        return _identity({"sequence": 1.0}, path, "sequence")
    if suffix in TIFF_SUFFIXES and open_frames(path, memory_limit=memory_limit).count > 1:
        return _identity({"sequence": 1.0}, path, "sequence")
    if suffix not in PICTURE_SUFFIXES:
        return _identity({"other": 1.0}, path, "other")
    guess = guess_subject(read_colour_image(path, memory_limit=memory_limit))
    contents = {_OF_SUBJECT[subject]: share for subject, share in guess.subjects.items()}
    return _identity(contents, path, "picture", guess.faces)


def _identity(
    contents: Mapping[Content, float], path: Path, kind: Kind, faces: Mapping[Face, float] | None = None
) -> FileIdentity:
    """Return what content and name say together."""
    reading = read_file_name(path.name, kind)
    weights, by_face = dict(contents), dict(faces or {})
    if kind == "picture":
        named: list[Content] = []
        if names_a_scale(path.name):
            named = ["coin", "ruler"]
        elif "face" in reading:
            named = ["photograph"]
        elif "load_N" in reading:
            named = ["contact image"]
        for content in named:
            weights[content] *= _NAMED
    if "face" in reading and kind in {"picture", "table"}:
        by_face = {reading["face"]: 1.0, **{face: 0.0 for face in by_face if face != reading["face"]}}
    return FileIdentity(contents=_ranked(weights), faces=by_face)


def _ranked(weights: Mapping[Content, float]) -> dict[Content, float]:
    whole = sum(weights.values())
    return {name: weights[name] / whole for name in sorted(weights, key=lambda name: -weights[name])}


def _table_contents(path: Path) -> dict[Content, float]:
    """Return what a table may be, by its headers."""
    table = read_table(path, ManifestError, head_only=True)
    headers = [cell.casefold() for cell in table.header]
    has = {
        name: any(_begins(header, words) for header in headers)
        for name, words in {
            "force": (*NAMES["force"], "fz", "w"),
            "travel": (*NAMES["displacement"], "travel", "position", "depth", "approach", "z"),
            "time": NAMES["time"],
            "trigger": ("trigger", "ttl", "sync"),
            "x": ("x",),
            "y": ("y",),
        }.items()
    }
    if has["force"] and has["travel"]:
        # Beside a sequence the platen's displacement may be recorded too.
        share = (
            0.04 if not has["time"] else 0.95 if has["trigger"] else 0.7 if names_a_force(path.name) else 0.04
        )
        return {"loading curve": 0.99 - share, "force table": share, "other": 0.01}
    if _names_files(table):
        return {"table of files": 0.95, "other": 0.05}
    if has["force"] and has["time"]:
        return {"force table": 0.95, "loading curve": 0.03, "other": 0.02}
    if has["x"] and has["y"]:
        return {"outline": 0.95, "other": 0.05}
    return {"other": 0.6, "loading curve": 0.2, "force table": 0.1, "outline": 0.1}


def _begins(header: str, words: Iterable[str]) -> bool:
    """Tell whether a header is one of the words, with or without a unit after it."""
    return any(re.match(rf"{word}(?=$|[_ ,/(\[])", header) for word in words)


def _names_files(table: Table) -> bool:
    try:
        return any(row.values for row in file_table(table).rows)
    except ManifestError:
        return False
