"""New files: what each may be, what a spreadsheet or their names state of them, and their edits."""

from collections.abc import Collection
from threading import Lock
from typing import Annotated, Any, Final

from pydantic import Field

from fingerpad.study.editing.propose import (
    NewFile,
    Proposal,
    proposed_edits,
    stated_values,
    with_scales,
    written_scale,
)
from fingerpad.study.imports.identify import (
    FileColumn,
    Guess,
    identify_file,
    join_files,
    parse_file_table,
    read_file_table,
)
from fingerpad.study.imports.names import FileValues, Use, match_file_names
from fingerpad.study.manifest.load import LoadedStudy
from fingerpad.web.answers import Answer, Face
from fingerpad.web.api.base import Body, FileParams, Item, Opened, Params, Query, router
from fingerpad.web.errors import RequestError
from fingerpad.web.pictures import Cache, ImageLocation

NewFiles = Annotated[list[NewFile], Field(max_length=20_000)]
# One at a time: together pictures could take more memory than the limit of each.
_READING: Final = Lock()
_FOUND: Final[Cache[Guess]] = Cache(2000, lambda _: 1)


@router.get("/files/identity")
def identity(opened: Opened, params: Query[FileParams]) -> Guess:
    """Guess what a file is."""
    place = ImageLocation(opened.file(params.file))
    with _READING:
        found = _FOUND.get(place.stamp, lambda: identify_file(place.path, memory_limit=opened.memory_limit))
    return with_scales(found, _scales(opened.read()))


def _scales(loaded: LoadedStudy) -> dict[str, Any]:
    return {one.key: one.content for one in loaded.tables if one.kind == "scale"}


class TableParams(Params):
    """A spreadsheet, as a file of the study or as pasted text, and the new files."""

    file: Item | None = None
    text: Annotated[str, Field(max_length=1_000_000)] | None = None
    files: NewFiles


class StatedValues(Answer):
    """What a spreadsheet or a name states of a file, for a new file; null where nothing."""

    use: Use | None = None
    person: str | None = None
    finger: str | None = None
    face: Face | None = None
    wedge_angle_deg: float | None = None
    load_N: float | None = None  # noqa: N815
    scale: str | None = None
    session: str | None = None
    guessed: list[str]


class StatedFile(Answer):
    """A file, what is stated of it, and what could not be read."""

    file: str
    values: StatedValues
    problem: str


class TableRow(Answer):
    """A row of a spreadsheet that names no new file, or one that another row names too."""

    line: int
    file: str


class JoinedTable(Answer):
    """A spreadsheet joined to new files."""

    columns: tuple[FileColumn, ...]
    files: list[StatedFile]
    rows_without_file: list[TableRow]
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
    new = {one.file: one for one in params.files}
    found = join_files(table, new)
    scales = _scales(opened.read())
    problems = {id(row.values): row.problems for row in table.rows}
    return JoinedTable.of(
        found,
        columns=table.columns,
        files=[
            _stated(scales, new[file], values, problems[id(values)]) for file, values in found.values.items()
        ],
        rows_without_file=[TableRow.of(row) for row in found.rows_without_file],
    )


class PatternParams(Params):
    """A pattern of names, and the new files."""

    pattern: Annotated[str, Field(max_length=300)]
    files: NewFiles


@router.post("/files/pattern")
def match(opened: Opened, params: Body[PatternParams]) -> list[StatedFile]:
    """Read the names of new files by a pattern."""
    found = match_file_names(params.pattern, [one.file for one in params.files])
    scales = _scales(opened.read())
    return [
        _stated(scales, new, one.values, (one.problem,)) for new, one in zip(params.files, found, strict=True)
    ]


def _stated(
    scales: Collection[str], new: NewFile, values: FileValues, problems: tuple[str, ...]
) -> StatedFile:
    taken, problem = stated_values(new, values, scales)
    words = "; ".join(filter(None, (*problems, problem)))
    return StatedFile(file=new.file, values=StatedValues.model_validate(taken), problem=words)


class WrittenParams(Params):
    """A scale as a person writes it."""

    words: Annotated[str, Field(max_length=200)]


class WrittenScale(Answer):
    """A scale in the one way in which a new file has it."""

    scale: str


@router.get("/files/scale")
def scale(opened: Opened, params: Query[WrittenParams]) -> WrittenScale:
    """Read a scale: a number with its unit, or the name of one."""
    return WrittenScale(scale=written_scale(params.words, _scales(opened.read())))


class ProposalParams(Params):
    """New files with all that is known of them, and whether they are rendered or simulated."""

    files: NewFiles
    synthetic: bool = False


@router.post("/files/edits")
def edits(opened: Opened, params: Body[ProposalParams]) -> Proposal:
    """Return the edits that add new files to the study; nothing is written."""
    return proposed_edits(opened.read(), params.files, synthetic=params.synthetic)
