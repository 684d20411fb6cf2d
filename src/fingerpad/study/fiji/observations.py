"""Manually measured ellipses as observations: the CSV that a manifest names in ``observations_csv``."""

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Self

from fingerpad._csv import write_csv
from fingerpad._display import Displayed
from fingerpad.exceptions import CalibrationError, FingerpadError, ManifestError
from fingerpad.study.fiji.ellipse import MeasuredEllipse
from fingerpad.study.manifest.messages import validated
from fingerpad.study.manifest.models import Load, ManifestModel, Name, RollAngle, WedgeAngle

# What an ellipse does not tell of its contact.
FIELDS: Final = ("finger", "wedge_angle_deg", "load_N", "roll_angle_deg")
_NEEDED: Final = FIELDS[:3]
# Semi-major axes, mm, between which contacts of finger pads lie: beyond, the unit is wrong.
_PLAUSIBLE: Final = (0.5, 40.0)
_HEADER: Final = (
    "name", *FIELDS, "semi_major_mm", "semi_minor_mm", "ellipse_mm_std", "long_axis", "synthetic", "notes",
)  # fmt: skip
_NUMBER: Final = r"-?\d+(?:[.,p]\d+)?"
_LONGEST_NAME: Final = 50


class _LabelValues(ManifestModel):
    """What a manifest takes of it."""

    finger: Name | None = None
    wedge_angle_deg: WedgeAngle | None = None
    load_N: Load | None = None  # noqa: N815 (the unit's own letter)
    roll_angle_deg: RollAngle | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class LabelPattern:
    """How labels tell what an ellipse does not.

    Attributes
    ----------
    text : str
        As the person wrote it.
    expression : re.Pattern
        What it means.
    fields : tuple of str
        The `FIELDS` in it.
    """

    text: str
    expression: re.Pattern[str]
    fields: tuple[str, ...]

    @classmethod
    def of(cls, text: str) -> Self:
        """Make a pattern such as ``{finger}_{wedge_angle_deg}deg_{load_N}N``.

        ``*`` stands for anything; what follows the pattern in a label is left alone. Numbers may have a
        point, a comma or the letter p for the decimal point, as file names do.

        Raises
        ------
        ManifestError
            If a field is not known or stands twice, or there is none.

        Examples
        --------
        >>> pattern = LabelPattern.of("{finger}_{wedge_angle_deg}deg_{load_N}N")
        >>> pattern.values_in("left_index_30deg_0p5N.tif:12")
        {'finger': 'left_index', 'wedge_angle_deg': 30.0, 'load_N': 0.5}
        """
        parts = re.split(r"(\{[^{}]*\}|\*)", text)
        fields = tuple(part[1:-1] for part in parts if part.startswith("{") and part.endswith("}"))
        unknown = sorted(set(fields) - set(FIELDS))
        if unknown or not fields or len(set(fields)) < len(fields):
            found = f"{{{unknown[0]}}}" if unknown else "the same twice" if fields else "none"
            known = ", ".join(f"{{{name}}}" for name in FIELDS)
            raise ManifestError(f"a label pattern takes {known}, each once; found {found} in {text!r}")
        expression = "".join(
            r".*?" if part == "*" else _group(part[1:-1]) if part[1:-1] in fields else re.escape(part)
            for part in parts
        )
        return cls(text=text, expression=re.compile(expression), fields=fields)

    def values_in(self, label: str) -> dict[str, str | float]:
        """Return what a label tells; nothing where it does not begin as the pattern says."""
        match = self.expression.match(label)
        if match is None:
            return {}
        return {
            name: text if name == "finger" else float(text.replace(",", ".").replace("p", "."))
            for name, text in match.groupdict().items()
        }


def _group(name: str) -> str:
    return r"(?P<finger>\w[\w.+-]*?)" if name == "finger" else rf"(?P<{name}>{_NUMBER})"


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class ManualObservation(Displayed):
    """One row of the CSV: an observation whose ellipse a person measured.

    Attributes
    ----------
    name : str
        Made from the label, like no other.
    values : mapping
        Those of `FIELDS` that are known.
    semi_major_mm, semi_minor_mm, ellipse_mm_std : float
        The ellipse, and the standard uncertainty of either semi-axis.
    long_axis : {"along", "across"} or None
        Where it lies, if the picture tells.
    synthetic : bool
        Whether the picture was rendered.
    notes : str
        Where it comes from, and doubts.
    """

    name: str
    values: Mapping[str, str | float]
    semi_major_mm: float
    semi_minor_mm: float
    ellipse_mm_std: float
    long_axis: str | None
    synthetic: bool
    notes: str

    @property
    def missing(self) -> tuple[str, ...]:
        """Columns that a person must fill in before the study can be run."""
        return tuple(name for name in _NEEDED if name not in self.values)

    def as_record(self) -> dict[str, Any]:
        """Return the row, None for what is not known."""
        return {
            "name": self.name,
            **{name: self.values.get(name) for name in FIELDS},
            "semi_major_mm": self.semi_major_mm,
            "semi_minor_mm": self.semi_minor_mm,
            "ellipse_mm_std": self.ellipse_mm_std,
            "long_axis": self.long_axis,
            "synthetic": self.synthetic,
            "notes": self.notes,
        }


def manual_observations(
    ellipses: Sequence[MeasuredEllipse],
    *,
    mm_per_unit: float,
    semi_axis_mm_std: float,
    relative_scale_std: float = 0.0,
    known: Mapping[str, str | float] | None = None,
    pattern: LabelPattern | None = None,
    finger_axis_deg: float = 0.0,
    synthetic: bool = False,
) -> list[ManualObservation]:
    """Turn ellipses into observations.

    Parameters
    ----------
    ellipses : sequence of HandEllipse
        As read, in the unit of their file.
    mm_per_unit : float
        That unit: mm per px, or 1 for a table in mm.
    semi_axis_mm_std : float
        Standard uncertainty of either semi-axis as a person finds it, mm.
    relative_scale_std : float
        That of the scale; it is added to each row as if it were the row's own.
    known : mapping, optional
        Those of `FIELDS` that are the same for all.
    pattern : LabelPattern, optional
        What labels tell.
    finger_axis_deg : float
        The finger's direction in the pictures, from straight up, counter-clockwise.
    synthetic : bool
        Whether the pictures were rendered.

    Raises
    ------
    CalibrationError
        If a semi-axis is none that a contact of a finger has.
    ManifestError
        If no uncertainty is given, something is given twice, a number is none that a manifest takes, or the
        pattern fits no label.
    """
    if not (semi_axis_mm_std > 0 and math.isfinite(semi_axis_mm_std)):
        raise ManifestError(f"the standard uncertainty must be positive, found {semi_axis_mm_std:g} mm")
    known = known or {}
    for name, value in {**known, "finger_axis_deg": finger_axis_deg}.items():
        if not isinstance(value, str) and not math.isfinite(value):
            raise ManifestError(f"{name} must be a finite number, found {value:g}")
    twice = sorted(set(known) & set(pattern.fields if pattern else ()))
    if twice:
        raise ManifestError(
            f"{twice[0]} is given for all rows and by the label pattern; choose one of the two"
        )
    names: set[str] = set()
    rows = []
    for ellipse in ellipses:
        major, minor = mm_per_unit * ellipse.semi_major, mm_per_unit * ellipse.semi_minor
        if not _PLAUSIBLE[0] <= major <= _PLAUSIBLE[1]:
            raise CalibrationError(
                f"{ellipse.place}: a semi-major axis of {major:.3g} mm is none of a finger's contact; "
                "check the unit or the scale (Fiji measures in px until a scale is set)"
            )
        values = {**known, **(pattern.values_in(ellipse.label) if pattern else {})}
        validated(_LabelValues, values, ellipse.place, strict=True)
        rows.append(
            ManualObservation(
                name=_name(ellipse.label, names),
                values=values,
                semi_major_mm=major,
                semi_minor_mm=minor,
                ellipse_mm_std=math.hypot(semi_axis_mm_std, relative_scale_std * math.sqrt(major * minor)),
                long_axis=_long_axis(ellipse, finger_axis_deg),
                synthetic=synthetic,
                notes="; ".join((f"measured manually: {ellipse.place}", *ellipse.doubts)),
            )
        )
    if pattern and rows and not any(pattern.values_in(ellipse.label) for ellipse in ellipses):
        raise ManifestError(
            f"the label pattern {pattern.text!r} fits no label, such as {ellipses[0].label!r}"
        )
    return rows


def _long_axis(ellipse: MeasuredEllipse, finger_axis_deg: float) -> str | None:
    if ellipse.orientation_deg is None or ellipse.semi_major == ellipse.semi_minor:
        return None
    from_finger = (ellipse.orientation_deg - finger_axis_deg + 90) % 180 - 90
    return "along" if abs(from_finger) <= 45 else "across"


def _name(label: str, taken: set[str]) -> str:
    """Return a name that a manifest takes, unlike all others even where case does not count."""
    stem = re.sub(r"\.(tiff?|png|jpe?g|bmp|gif)(?=$|:)", "", label, flags=re.IGNORECASE)
    base = re.sub(r"[^\w.+-]+", "_", stem).strip("_.+-")[:_LONGEST_NAME] or "contact"
    name, number = base, 1
    while name.casefold() in taken:
        number += 1
        name = f"{base}_{number}"
    taken.add(name.casefold())
    return name


def write_observations(path: Path, rows: Iterable[ManualObservation]) -> None:
    """Write the CSV that ``observations_csv`` names; what is there already is never replaced.

    Raises
    ------
    FingerpadError
        If the file exists, or cannot be written.
    """
    try:
        write_csv(path, [_HEADER, *(row.as_record().values() for row in rows)], mode="x")
    except FileExistsError:
        raise FingerpadError(f"{path}: is there already, and may be filled in; name another file") from None
    except OSError as error:
        raise FingerpadError(f"{path}: cannot be written ({error.strerror})") from error
