"""What was measured, made up: contacts and frames of known axes, for all that follows from measurements."""

from typing import Any

import numpy as np
from tests.studies import PAD
from tests.studies import sequence as sequence_of_frames

from fingerpad.study.manifest.models import ContactSequence, Finger, Observation
from fingerpad.study.measuring.contacts import Measurement
from fingerpad.study.measuring.fingers import FingerResult

AXES = np.array([*PAD.values()])
SEQUENCE = ContactSequence.model_validate(
    sequence_of_frames("p", "p.tif", force="f.csv", scale={"ppi": 500}).keys
)


def pad(std: float = 0.1, **more: Any) -> FingerResult:
    """Return the finger ``f`` whose semi-axes are independent and so uncertain."""
    given = {
        "manifest": Finger(name="f"),
        "semi_axes": AXES,
        "covariance": std**2 * np.eye(3),
        "source": "given",
    }
    return FingerResult(**{**given, **more})


def measured(name: str, axes: Any, load: float = 1.0, **more: Any) -> tuple[Observation, Measurement]:
    """Return a contact of that finger, and what was measured of it."""
    placed = {
        key: more.pop(key) for key in ("finger", "session", "synthetic", "wedge_angle_deg") if key in more
    }
    where = {"name": name, "finger": "f", "load_N": load, "file": "x.png", "scale": "s"}
    return Observation(**{**where, "wedge_angle_deg": 30, **placed}), _measurement(name, axes, load, more)


def frame(
    number: int, axes: Any, load: float = 1.0, *, of: str = "p", **more: Any
) -> tuple[ContactSequence, Measurement]:
    """Return a frame of a press of that finger, and what was measured of it."""
    place = {"sequence": of, "frame": number, **more}
    return SEQUENCE.model_copy(update={"name": of}), _measurement(f"{of}#{number}", axes, load, place)


def _measurement(name: str, axes: Any, load: float, known: dict[str, Any]) -> Measurement:
    major, minor = axes
    return Measurement(observation=name, load_N=load, semi_major_mm=major, semi_minor_mm=minor, **known)
