"""Manual measurements from Fiji or ImageJ: tables of results and ROIs, as observations of a study."""

from pathlib import Path

from fingerpad.study.fiji.ellipse import MeasuredEllipse
from fingerpad.study.fiji.observations import (
    ManualObservation,
    manual_observations,
    write_observations,
)
from fingerpad.study.fiji.rois import read_rois
from fingerpad.study.fiji.table import read_results_table

__all__ = [
    "ManualObservation",
    "MeasuredEllipse",
    "is_roi_file",
    "manual_observations",
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
