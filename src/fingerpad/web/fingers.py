"""The fingers of a study as far as they are known without measuring: given, or found by the last run."""

from typing import Any

import numpy as np

from fingerpad.study.fingers import FingerResult
from fingerpad.study.manifest import Finger
from fingerpad.web.open_study import OpenStudy
from fingerpad.web.results import last_results


def known_finger(opened: OpenStudy, name: str) -> FingerResult | None:
    """Return a finger's semi-axes, None where they are not known yet."""
    finger = next((one for one in opened.study().fingers if one.name == name), None)
    if finger is None:
        return None
    common: dict[str, Any] = {
        "name": name,
        "pad_thickness": finger.pad_thickness_mm,
        "synthetic": finger.synthetic or any(one.synthetic for one in finger.photographs),
    }
    if finger.semi_axes_mm is not None and finger.semi_axes_std_mm is not None:
        given, std = finger.semi_axes_mm, finger.semi_axes_std_mm
        return FingerResult(
            semi_axes=np.array([given.palmar, given.distal, given.radial_ulnar]),
            covariance=np.diag(np.square([std.palmar, std.distal, std.radial_ulnar])),
            source="given",
            **common,
        )
    found = last_results(opened)
    record = found and next((one for one in found.summary["fingers"] if one["finger"] == name), None)
    if not record or record["palmar_mm"] is None:
        return None
    return FingerResult(
        semi_axes=np.array([record[f"{axis}_mm"] for axis in ("palmar", "distal", "radial_ulnar")]),
        covariance=np.array(record["covariance_mm2"]),
        source="photographs",
        scale=_shared_scale(finger),
        **common,
    )


def _shared_scale(finger: Finger) -> str | None:
    names = {one.scale if isinstance(one.scale, str) else None for one in finger.photographs}
    return names.pop() if len(names) == 1 else None
