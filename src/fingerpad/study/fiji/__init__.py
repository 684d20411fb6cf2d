"""What was measured by hand in Fiji or ImageJ: tables of results and ROIs, as observations of a study."""

from pathlib import Path

from fingerpad.study.fiji.ellipse import HandEllipse
from fingerpad.study.fiji.observations import (
    FIELDS,
    HandObservation,
    LabelPattern,
    hand_observations,
    write_observations,
)
from fingerpad.study.fiji.rois import read_rois
from fingerpad.study.fiji.table import read_results_table

__all__ = [
    "FIELDS",
    "HandEllipse",
    "HandObservation",
    "LabelPattern",
    "hand_observations",
    "is_roi_file",
    "read_results_table",
    "read_rois",
    "write_observations",
]


def is_roi_file(path: Path) -> bool:
    """Tell by its suffix whether a file holds ROIs, which are in pixels, or a table.

    Examples
    --------
    >>> is_roi_file(Path("RoiSet.zip")), is_roi_file(Path("Results.csv"))
    (True, False)
    """
    return path.suffix.lower() in {".roi", ".zip"}
