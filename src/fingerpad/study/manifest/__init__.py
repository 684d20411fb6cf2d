"""The study manifest: a TOML file that says what was observed, and where images, sequences and curves lie."""

from fingerpad.study.manifest.contacts import (
    CORRECTIONS,
    Contact,
    ContactSequence,
    Direction,
    Observation,
)
from fingerpad.study.manifest.curves import Curve
from fingerpad.study.manifest.fingers import Finger, Photograph
from fingerpad.study.manifest.load import LoadedStudy, load_study, manifest_in, read_study
from fingerpad.study.manifest.scales import (
    CircleScale,
    CoinScale,
    GridScale,
    LineScale,
    PitchScale,
    ResolutionScale,
    ScaleKey,
    ScaleTable,
)
from fingerpad.study.manifest.study import Study, Uncertainty

__all__ = [
    "CORRECTIONS",
    "CircleScale",
    "CoinScale",
    "Contact",
    "ContactSequence",
    "Curve",
    "Direction",
    "Finger",
    "GridScale",
    "LineScale",
    "LoadedStudy",
    "Observation",
    "Photograph",
    "PitchScale",
    "ResolutionScale",
    "ScaleKey",
    "ScaleTable",
    "Study",
    "Uncertainty",
    "load_study",
    "manifest_in",
    "read_study",
]
