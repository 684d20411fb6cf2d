"""New files: what each may be, and what a spreadsheet or their names state of them."""

from threading import Lock
from typing import Annotated, Any, Final

from fastapi import Query
from pydantic import Field

from fingerpad.study.imports import (
    FileValues,
    identify_file,
    join_files,
    match_file_names,
    parse_file_table,
    read_file_table,
)
from fingerpad.web.answers import files as answers
from fingerpad.web.api.base import Body, Opened, Params, study_router
from fingerpad.web.errors import RequestError

router = study_router()

FileName = Annotated[str, Field(min_length=1, max_length=1000)]
# One at a time: together pictures could take more memory than the limit of each.
_READING: Final = Lock()
_KEYS: Final = tuple(answers.StatedValues.model_fields)


class FileParams(Params):
    """A file of the study."""

    file: FileName


class TableParams(Params):
    """A spreadsheet, as a file of the study or as pasted text, and the new files."""

    file: FileName | None = None
    text: Annotated[str, Field(max_length=1_000_000)] | None = None
    files: Annotated[list[FileName], Field(max_length=20_000)]


class PatternParams(Params):
    """A pattern of names, and the new files."""

    pattern: Annotated[str, Field(max_length=300)]
    files: Annotated[list[FileName], Field(max_length=20_000)]


@router.get("/files/identity")
def identity(opened: Opened, params: Annotated[FileParams, Query()]) -> answers.FileGuess:
    """Guess what a file is."""
    path = opened.file(params.file)
    with _READING:
        found = identify_file(path, memory_limit=opened.memory_limit)
    return answers.FileGuess.of(
        {
            "file": params.file,
            "contents": list(found.contents),
            "faces": list(found.faces),
            "sure": found.is_sure,
            "face_sure": found.is_face_sure,
        }
    )


@router.post("/files/table")
def join(opened: Opened, params: Body[TableParams]) -> answers.JoinedTable:
    """Join a spreadsheet to new files."""
    if params.file is not None:
        table = read_file_table(opened.file(params.file))
    elif params.text is not None:
        table = parse_file_table(params.text)
    else:
        raise RequestError.impossible("give a file or a text")
    found = join_files(table, params.files)
    problems = {id(row.values): "; ".join(row.problems) for row in table.rows}
    return answers.JoinedTable.of(
        {
            "columns": [column._asdict() for column in table.columns],
            "files": [_stated(file, values, problems[id(values)]) for file, values in found.values.items()],
            "rows_without_file": [{"line": row.line, "file": row.file} for row in found.rows_without_file],
            "files_without_row": found.files_without_row,
        }
    )


@router.post("/files/pattern")
def match(_: Opened, params: Body[PatternParams]) -> answers.PatternMatches:
    """Read the names of new files by a pattern."""
    found = match_file_names(params.pattern, params.files)
    return answers.PatternMatches.of({"files": [_stated(one.file, one.values, one.problem) for one in found]})


def _stated(file: str, values: FileValues, problem: str) -> dict[str, Any]:
    return {"file": file, "values": {key: values.get(key) for key in _KEYS}, "problem": problem}
