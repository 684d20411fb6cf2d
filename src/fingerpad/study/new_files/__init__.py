"""New files of a study: what each is, and what a spreadsheet or their names say of them."""

from fingerpad.study.new_files.file_table import (
    FileTable,
    JoinedFiles,
    join_files,
    parse_file_table,
    read_file_table,
)
from fingerpad.study.new_files.identify import FileIdentity, identify_file
from fingerpad.study.new_files.name_pattern import PatternMatch, match_file_names
from fingerpad.study.new_files.quantities import FileValues

__all__ = [
    "FileIdentity",
    "FileTable",
    "FileValues",
    "JoinedFiles",
    "PatternMatch",
    "identify_file",
    "join_files",
    "match_file_names",
    "parse_file_table",
    "read_file_table",
]
