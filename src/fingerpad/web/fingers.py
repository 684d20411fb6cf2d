"""The fingers of a study as far as they are known without measuring: given, or found by the last run."""

import numpy as np

from fingerpad.study.measuring.fingers import FingerResult, finger_result
from fingerpad.web.last_results import last_results
from fingerpad.web.study_session import StudySession


def known_finger(opened: StudySession, name: str) -> FingerResult | None:
    """Return a finger's semi-axes, None where they are not known yet."""
    finger = next((one for one in opened.study().fingers if one.name == name), None)
    if finger is None:
        return None
    if finger.semi_axes_mm is not None:
        return finger_result(finger, {}, opened.folder, {})  # nothing to measure
    found = last_results(opened)
    record = found and next((one for one in found.summary["fingers"] if one["finger"] == name), None)
    if not record or record["palmar_mm"] is None:
        return None
    return FingerResult(
        name=name,
        semi_axes=np.array([record[f"{axis}_mm"] for axis in ("palmar", "distal", "radial_ulnar")]),
        covariance=np.array(record["covariance_mm2"]),
        source="photographs",
        scale=record.get("scale"),
        pad_thickness=finger.pad_thickness_mm,
        synthetic=record["synthetic"],
    )
