"""The results of the last run, validated on reading, as they may be imported or damaged."""

import math
from pathlib import Path
from typing import Final

import numpy as np
import pandas as pd

from fingerpad.exceptions import FingerpadError
from fingerpad.study.measuring.fingers import FingerResult, finger_result, stated
from fingerpad.study.results.load import Results
from fingerpad.study.results.result_set import (
    RERUN,
    quick_faults,
    result_files,
    result_set_faults,
    result_set_stamp,
)
from fingerpad.study.results.table import Row, records
from fingerpad.web.errors import RequestError
from fingerpad.web.pictures import Cache
from fingerpad.web.study_session import StudySession


def frame_rows(table: pd.DataFrame, sequence: str, *columns: str) -> dict[int, Row]:
    """Return some columns of a sequence's frames, by their numbers."""
    frames = table[(table["sequence"] == sequence) & table["frame"].notna()]
    return {row["frame"]: row for row in records(frames, "frame", *columns)}


# Results of studies that are open in several windows, or what is wrong with them.
_READ: Final[Cache[tuple[Results | None, list[str]]]] = Cache(3, lambda _: 1)


def last_results(opened: StudySession) -> Results | None:
    """Return the tables of the last run, None if there are none or they are damaged."""
    return _reading(opened.out)[0]


def results_faults(opened: StudySession) -> list[str]:
    """Return what was wrong with the files of the last run, except overlays, when its tables were read.

    A file that was changed in place later is named by what reads it, and by ``fingerpad verify``.
    """
    return _reading(opened.out)[1]


def _reading(out: Path) -> tuple[Results | None, list[str]]:
    """Return the results in a folder and their faults, checked and read once for each result set."""
    return _READ.get((out, result_set_stamp(out)), lambda: _read(out))


def _read(out: Path) -> tuple[Results | None, list[str]]:
    faults = quick_faults(out, lambda name: not name.startswith("overlays/"))
    if faults or not result_files(out):
        return None, faults
    try:
        found = Results.read(out)
    except FingerpadError as error:
        return None, [str(error).removesuffix(f"; {RERUN}")]
    found.table.attrs.clear()  # pandas copies all units with each column that is taken, half of a plot's time
    return found, []


def require_file(opened: StudySession, name: str) -> None:
    """Refuse a file of the results that is not what the last run wrote."""
    faults = result_set_faults(opened.out, is_checked=lambda one: one == name)
    if faults:
        raise RequestError.conflict(f"{'; '.join(faults)}: {RERUN}")


def known_finger(opened: StudySession, name: str) -> FingerResult | None:
    """Return a finger's semi-axes, entered or of the last run; None where they are unknown."""
    finger = opened.finger(name)
    if finger is None or not (finger.photographs or finger.semi_axes_mm):
        return None
    if finger.semi_axes_mm is not None:
        return finger_result(finger, {}, opened.folder, {})  # nothing to measure
    found = last_results(opened)
    record = found.summary.finger(name) if found else None
    if record is None or math.isnan(record.palmar_mm):
        return None
    return FingerResult(
        semi_axes=np.array([record.palmar_mm, record.distal_mm, record.radial_ulnar_mm]),
        covariance=np.array(record.covariance_mm2),
        source="photographs",
        outline_radii=tuple(
            tuple(one.outline_radii_deg_mm) for one in record.photographs if one.outline_radii_deg_mm
        ),
        scale=record.scale,
        **(stated(finger) | {"synthetic": record.synthetic}),
    )
