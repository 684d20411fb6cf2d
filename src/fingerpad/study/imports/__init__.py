"""Files from elsewhere: what new ones are and what is stated of them, and ellipses measured in Fiji."""

from fingerpad.study.imports.fiji import (
    ManualObservation,
    MeasuredEllipse,
    is_roi_file,
    manual_observations,
    read_results_table,
    read_rois,
    write_observations,
)
from fingerpad.study.imports.identify import (
    FileIdentity,
    FileTable,
    JoinedFiles,
    identify_file,
    join_files,
    parse_file_table,
    read_file_table,
)
from fingerpad.study.imports.names import FileValues, PatternMatch, match_file_names

__all__ = [
    "FileIdentity",
    "FileTable",
    "FileValues",
    "JoinedFiles",
    "ManualObservation",
    "MeasuredEllipse",
    "PatternMatch",
    "identify_file",
    "is_roi_file",
    "join_files",
    "manual_observations",
    "match_file_names",
    "parse_file_table",
    "read_file_table",
    "read_results_table",
    "read_rois",
    "write_observations",
]
