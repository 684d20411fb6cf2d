"""Files from elsewhere: what new ones are and what is stated of them, and ellipses measured in Fiji."""

from fingerpad.study.imports.ellipses import MeasuredEllipse, is_roi_file, read_results_table, read_rois
from fingerpad.study.imports.file_table import (
    FileTable,
    JoinedFiles,
    join_files,
    parse_file_table,
    read_file_table,
)
from fingerpad.study.imports.identify import FileIdentity, identify_file
from fingerpad.study.imports.names import PatternMatch, match_file_names
from fingerpad.study.imports.observations import ManualObservation, manual_observations, write_observations
from fingerpad.study.imports.values import FileValues

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
