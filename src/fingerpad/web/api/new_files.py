"""New files: what each may be, what a spreadsheet or their names state of them, and their edits."""

from collections.abc import Collection
from threading import Lock
from typing import Annotated, Any, Final

from pydantic import Field

from fingerpad.study.imports.identify import (
    FileColumn,
    FileRow,
    Guess,
    identify_file,
    join_files,
    parse_file_table,
    read_file_table,
)
from fingerpad.study.imports.names import FileValues, match_file_names
from fingerpad.study.new_files import (
    NewFile,
    Proposal,
    StatedValues,
    proposed_edits,
    stated_values,
    with_scales,
    written_scale,
)
from fingerpad.web.answers import Answer, RequestError
from fingerpad.web.api.base import Body, Item, Opened, Params, router
from fingerpad.web.pictures import Cache, ImageLocation
from fingerpad.web.study_session import StudySession

NewFiles = Annotated[list[NewFile], Field(max_length=20_000)]
# One at a time: together pictures could take more memory than the limit of each.
_READING: Final = Lock()
_FOUND: Final[Cache[Guess]] = Cache(2000)


@router.get("/files/identity")
def identity(opened: Opened, file: Item) -> Guess:
    """Guess what a file is."""
    place, limit = ImageLocation(opened.file(file)), opened.pictures.memory_limit
    with _READING:
        found = _FOUND.get(place.stamp, lambda: identify_file(place.path, memory_limit=limit))
    return with_scales(found, _scales(opened))


def _scales(opened: StudySession) -> dict[str, Any]:
    return {one.key: one.content for one in opened.read().tables if one.kind == "scale"}


class TableParams(Params):
    """A spreadsheet, as a file of the study or as pasted text, and the new files."""

    file: Item | None = None
    text: Annotated[str, Field(max_length=1_000_000)] | None = None
    files: NewFiles


class StatedFile(Answer):
    """A file, what is stated of it, and what could not be read."""

    file: str
    values: StatedValues
    problem: str


class JoinedTable(Answer):
    """A spreadsheet joined to new files; the rows are those that name none, or one that another names too."""

    columns: tuple[FileColumn, ...]
    files: list[StatedFile]
    rows_without_file: list[FileRow]
    files_without_row: list[str]


@router.post("/files/table")
def join(opened: Opened, params: Body[TableParams]) -> JoinedTable:
    """Join a spreadsheet to new files."""
    if params.file is not None:
        table = read_file_table(opened.file(params.file))
    elif params.text is not None:
        table = parse_file_table(params.text)
    else:
        raise RequestError.impossible("give a file or a text")
    new, scales = {one.file: one for one in params.files}, _scales(opened)
    found = join_files(table, new)
    return JoinedTable.of(
        found,
        columns=table.columns,
        files=[_stated(scales, new[file], row.values, row.problems) for file, row in found.rows.items()],
    )


class PatternParams(Params):
    """A pattern of names, and the new files."""

    pattern: Annotated[str, Field(max_length=300)]
    files: NewFiles


@router.post("/files/pattern")
def match(opened: Opened, params: Body[PatternParams]) -> list[StatedFile]:
    """Read the names of new files by a pattern."""
    scales, found = _scales(opened), match_file_names(params.pattern, [one.file for one in params.files])
    pairs = zip(params.files, found, strict=True)
    return [_stated(scales, new, one.values, (one.problem,)) for new, one in pairs]


def _stated(
    scales: Collection[str], new: NewFile, values: FileValues, problems: tuple[str, ...]
) -> StatedFile:
    taken, problem = stated_values(new, values, scales)
    words = "; ".join(filter(None, (*problems, problem)))
    return StatedFile(file=new.file, values=taken, problem=words)


class WrittenScale(Answer):
    """A scale in the one way in which a new file has it."""

    scale: str


@router.get("/files/scale")
def scale(opened: Opened, words: Annotated[str, Field(max_length=200)]) -> WrittenScale:
    """Read a scale: a number with its unit, or the name of one."""
    return WrittenScale(scale=written_scale(words, _scales(opened)))


class ProposalParams(Params):
    """New files with all that is known of them, and whether they are rendered or simulated."""

    files: NewFiles
    synthetic: bool = False


@router.post("/files/edits")
def edits(opened: Opened, params: Body[ProposalParams]) -> Proposal:
    """Return the edits that add new files to the study; nothing is written."""
    return proposed_edits(opened.read(), params.files, synthetic=params.synthetic)
