"""Ellipses measured by another program, as observations in the CSV that ``observations_csv`` names.

A module beside this one reads the files of one program, and returns `MeasuredEllipse`.
"""

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from pydantic import BaseModel, ConfigDict

from fingerpad._csv import write_csv
from fingerpad._files import explain_write_errors
from fingerpad.exceptions import CalibrationError, FingerpadError, ManifestError
from fingerpad.study.imports.names import Field, NamePattern, free_name, plain_name
from fingerpad.study.manifest.models import Load, Name, RollAngle, WedgeAngle, validated

# What an ellipse does not tell of its contact.
FIELDS: Final = ("finger", "wedge_angle_deg", "load_N", "roll_angle_deg")
# Semi-major axes, mm, between which contacts of finger pads lie: beyond, the unit is wrong.
_PLAUSIBLE: Final = (0.5, 40.0)
# What a pattern of labels may hold.
_LABEL_FIELDS: Final[tuple[Field, ...]] = ("person", "finger", "wedge", "roll", "load")
_SUFFIX: Final = r"\.(?:tiff?|png|jpe?g|bmp|gif)(?=$|:)"
_LONGEST_NAME: Final = 50


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredEllipse:
    """One ellipse, in the unit of its file."""

    label: str  # what it is called there: the picture's name, or the outline's
    source: str  # file and line, or file and outline, for messages
    # Half of the lengths of its axes, which most programs give.
    semi_major: float
    semi_minor: float
    # Of the long axis from straight up in the picture, counter-clockwise, in (−90, 90]; None if unknown.
    orientation_deg: float | None = None
    doubts: tuple[str, ...] = ()  # what should be looked at


def upward_deg(angle_deg: float) -> float:
    """Turn an angle from the horizontal, as programs give it, into one from straight up, in (−90, 90]."""
    return 90 - (180 - angle_deg) % 180


class ManualObservation(BaseModel):
    """One row of the CSV: an observation whose ellipse a person measured; None is left to be filled in."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: str  # made from the label, like no other
    finger: Name | None = None
    wedge_angle_deg: WedgeAngle | None = None
    load_N: Load | None = None  # noqa: N815 (the unit's own letter)
    roll_angle_deg: RollAngle | None = None
    semi_major_mm: float
    semi_minor_mm: float
    ellipse_mm_std: float  # standard uncertainty of either semi-axis, without that of the scale
    mm_per_px: float | None = None  # scale that the lengths were made with, where it is uncertain
    scale_relative_std: float | None = None
    long_axis: str | None  # where it lies, if the picture tells
    synthetic: bool  # whether the picture was rendered
    notes: str  # where it comes from, and doubts

    @property
    def missing(self) -> tuple[str, ...]:
        """Columns that a person must fill in before the study can be run."""
        return tuple(name for name in FIELDS[:3] if getattr(self, name) is None)


def manual_observations(
    ellipses: Sequence[MeasuredEllipse],
    *,
    mm_per_unit: float,
    semi_axis_mm_std: float,
    relative_scale_std: float = 0.0,
    known: Mapping[str, str | float] | None = None,
    pattern: str | None = None,
    finger_axis_deg: float = 0.0,
    synthetic: bool = False,
    unit_hint: str = "",
) -> list[ManualObservation]:
    """Turn ellipses into observations.

    `mm_per_unit` is mm per px, or 1 for a table in mm; `semi_axis_mm_std` that of either semi-axis as a
    person finds it; `relative_scale_std` is that of `mm_per_unit`, which all rows share. `known` are those
    of `FIELDS` that are the same for all; the `pattern` tells others by labels, as of `match_file_names`.
    `finger_axis_deg` is from straight up, counter-clockwise. The `unit_hint` says of an impossible length
    in which unit the program measures.
    """
    if not (semi_axis_mm_std > 0 and math.isfinite(semi_axis_mm_std)):
        raise ManifestError(f"the standard uncertainty must be positive, found {semi_axis_mm_std:g} mm")
    known = known or {}
    for name, value in {**known, "finger_axis_deg": finger_axis_deg}.items():
        if not isinstance(value, str) and not math.isfinite(value):
            raise ManifestError(f"{name} must be a finite number, found {value:g}")
    labels = _values_of_labels(ellipses, pattern)
    twice = sorted(set(known) & {name for stated in labels for name in stated})
    if twice:
        raise ManifestError(
            f"{twice[0]} is given for all rows and by the label pattern; choose one of the two"
        )
    names: set[str] = set()
    rows = []
    for ellipse, stated in zip(ellipses, labels, strict=True):
        major, minor = mm_per_unit * ellipse.semi_major, mm_per_unit * ellipse.semi_minor
        if not _PLAUSIBLE[0] <= major <= _PLAUSIBLE[1]:
            raise CalibrationError(
                f"{ellipse.source}: a semi-major axis of {major:.3g} mm is none of a finger's contact; "
                f"check the unit or the scale{unit_hint and f' ({unit_hint})'}"
            )
        values = {**known, **stated}
        if person := values.pop("person", None):
            values["finger"] = f"{person}_{values['finger']}" if "finger" in values else person
        plain_label = plain_name(re.sub(_SUFFIX, "", ellipse.label, flags=re.IGNORECASE))
        content = {
            **values,
            "name": free_name(plain_label[:_LONGEST_NAME] or "contact", names),  # with room for a number
            "semi_major_mm": major,
            "semi_minor_mm": minor,
            "ellipse_mm_std": semi_axis_mm_std,
            "mm_per_px": mm_per_unit if relative_scale_std else None,
            "scale_relative_std": relative_scale_std or None,
            "long_axis": _long_axis(ellipse, finger_axis_deg),
            "synthetic": synthetic,
            "notes": "; ".join((f"measured manually: {ellipse.source}", *ellipse.doubts)),
        }
        rows.append(validated(ManualObservation, content, ellipse.source, strict=True))
    return rows


def _values_of_labels(ellipses: Sequence[MeasuredEllipse], text: str | None) -> list[dict[str, Any]]:
    """Return what each label states, nothing where it does not fit the pattern."""
    if text is None:
        return [{} for _ in ellipses]
    pattern = NamePattern(text, _LABEL_FIELDS)
    stems = [re.split(f"{_SUFFIX}|:", one.label, maxsplit=1, flags=re.IGNORECASE)[0] for one in ellipses]
    found = [pattern.match(one.source, stem) for one, stem in zip(ellipses, stems, strict=True)]
    for match in found:
        if match.fits and match.problem:
            raise ManifestError(f"{match.file}: {match.problem}")
    if ellipses and not any(match.fits for match in found):
        raise ManifestError(
            f"the label pattern {text!r} fits no label, such as {ellipses[0].label!r}; * is anything, and "
            "only hand and digit of a finger may have an underscore between them"
        )
    return [dict[str, Any](match.values) for match in found]


def _long_axis(ellipse: MeasuredEllipse, finger_axis_deg: float) -> str | None:
    if ellipse.orientation_deg is None or ellipse.semi_major == ellipse.semi_minor:
        return None
    from_finger = (ellipse.orientation_deg - finger_axis_deg + 90) % 180 - 90
    return "along" if abs(from_finger) <= 45 else "across"


def write_observations(path: Path, rows: Iterable[ManualObservation]) -> None:
    """Write the CSV that ``observations_csv`` names; what is there already is never replaced."""
    if path.exists():
        raise FingerpadError(f"{path}: is there already, and may be filled in; name another file")
    with explain_write_errors(path):
        write_csv(path, [ManualObservation.model_fields, *(dict(row).values() for row in rows)], mode="x")
